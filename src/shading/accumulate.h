// SPDX-License-Identifier: MIT
// Adds virtual lights to blocks of the G-buffer, for kernels: group by group, without culled lights, and with
// the visibility of clusters.
//
// Lights of one cluster share a paraboloid map (Aranha et al., SSVP): a run of them is summed, then
// multiplied by visibility once. The sum of a group is (run 0) v0 + (run 1) v1 + ..., in this order, in
// float; a run begins where the list changes cluster and where a group begins. Hence one cluster that is
// visible everywhere gives the bits of lights without shadows, and one cluster per light gives those of
// lights with a map each.
#ifndef VPL_SHADING_ACCUMULATE_H
#define VPL_SHADING_ACCUMULATE_H

#include "shading/gbuffer.h"

// Blocks that meet the same lights.
typedef struct vplLitBlocks {
    vplBlock* blocks;
    const int* lit; // indices of the blocks that show something
    int count;
    vplBounds bounds;
    bool culls; // lights are tested against the bounds
} vplLitBlocks;

// Consecutive lights of a list that share a cluster.
typedef struct vplLightRun {
    int first, count;
    int cluster; // -1: casts no shadow
} vplLightRun;

// The lights of a group that are left after culling.
typedef struct vplFacingLights {
    vplShadeLight lights[VPL_LIGHT_GROUP];
    vplLightRun runs[VPL_LIGHT_GROUP];
    int count, runCount; // one run where lights have no clusters
} vplFacingLights;

static inline void vplAddGroup(vplBlock* b, float part[3][VPL_LANES])
{
    for (int c = 0; c < 3; c++) {
        for (int l = 0; l < VPL_LANES; l++) {
            b->sums[c][l] += (double)part[c][l];
        }
    }
}

// Culls lights first .. first + count - 1 that face away from all points, or have them all behind their
// plane. Runs are not joined where all lights between them are culled: bits must not depend on what is
// culled.
static inline void vplCullLights(const vplShading* s, const vplBounds* bounds, int first, int count,
                                 vplFacingLights* out)
{
    int32_t facing[VPL_LIGHT_GROUP];
    s->kernels.cull(bounds, s->lights.columns, first, count, facing);
    const int* clusters = s->lights.clusters ? s->lights.clusters + first : NULL;
    out->count = out->runCount = 0;
    for (int i = 0; i < count; i++) {
        if (i == 0 || (clusters != NULL && clusters[i] != clusters[i - 1])) {
            // Overwrites the last run if it is empty.
            out->runCount += out->runCount > 0 && out->runs[out->runCount - 1].count == 0 ? 0 : 1;
            out->runs[out->runCount - 1] = (vplLightRun){out->count, 0, clusters ? clusters[i] : -1};
        }
        out->lights[out->count] = s->lights.lights[first + i];
        out->count += facing[i];
        out->runs[out->runCount - 1].count += facing[i];
    }
}

// Tests whether any lane receives light.
static inline bool vplAnyLit(float part[3][VPL_LANES])
{
    // Nothing is negative, so light is a set bit. 64 bits at a time are reduced in fewer steps than
    // comparisons.
    uint64_t bits[3][VPL_LANES / 2], any = 0;
    memcpy(bits, part, sizeof bits);
    for (int i = 0; i < VPL_LANES / 2; i++) {
        any |= bits[0][i] | bits[1][i] | bits[2][i];
    }
    return any != 0;
}

// Looks up a cluster's visibility, once for consecutive runs of the cluster.
static inline void vplFindVisibility(const vplShading* s, vplBlock* b, int cluster)
{
    if (b->cluster == cluster) {
        return;
    }
    float hidden[VPL_LANES] = {0};
    if (cluster >= 0) {
        vplParaboloidMap_FactorBlock(&s->def->clusterShadows[cluster], b->points.plane, hidden);
    }
    b->cluster = cluster;
    for (int l = 0; l < VPL_LANES; l++) {
        b->visible[l] = 1 - hidden[l];
    }
    if (cluster >= 0 && s->geometry->cutOuts != NULL) { // maps show what is solid
        vplVeilFromPoint(s->geometry, &b->points, s->def->clusterShadows[cluster].position, b->visible);
    }
}

static inline void vplAddClusters(const vplShading* s, const vplFacingLights* facing, vplBlock* b)
{
    _Alignas(64) float sum[3][VPL_LANES] = {{0}};
    for (int i = 0; i < facing->runCount; i++) {
        const vplLightRun* run = &facing->runs[i];
        if (run->count == 0) {
            continue;
        }
        _Alignas(64) float part[3][VPL_LANES] = {{0}};
        s->kernels.addLights(&b->surface, facing->lights + run->first, run->count, s->lights.inverseClamp,
                             part);
        if (vplAnyLit(part)) {
            vplFindVisibility(s, b, run->cluster);
            for (int c = 0; c < 3; c++) {
                for (int l = 0; l < VPL_LANES; l++) {
                    sum[c][l] += b->visible[l] * part[c][l];
                }
            }
        }
    }
    vplAddGroup(b, sum);
}

static inline void vplAddFacing(const vplShading* s, const vplFacingLights* facing, vplBlock* b)
{
    _Alignas(64) float part[3][VPL_LANES] = {{0}};
    s->kernels.addLights(&b->surface, facing->lights, facing->count, s->lights.inverseClamp, part);
    vplAddGroup(b, part);
}

static inline void vplAddShadowed(const vplShading* s, vplBlock* b, int first, int count, int64_t* rays)
{
    _Alignas(64) float part[3][VPL_LANES] = {{0}};
    vplIndirectIrradiance(s, &b->points, first, count, part, rays);
    vplAddGroup(b, part);
}

// Groups between two questions whether the task goes on: with rays they take about 50 ms.
enum { VPL_GROUPS_PER_QUESTION = 64 };

// Adds virtual lights first .. first + count - 1, in groups. Lights with clusters are always culled.
static inline void vplAddLights(const vplShading* s, const vplLitBlocks* to, int first, int count,
                                int64_t* rays)
{
    vplFacingLights facing;
    int groups = 0;
    for (const int end = first + count; first < end; first += VPL_LIGHT_GROUP) {
        if (++groups % VPL_GROUPS_PER_QUESTION == 0 && !vplTask_GoesOn(s->geometry->context)) {
            return;
        }
        const int group = end - first < VPL_LIGHT_GROUP ? end - first : VPL_LIGHT_GROUP;
        if (to->culls) {
            vplCullLights(s, &to->bounds, first, group, &facing);
        }
        for (int i = 0; i < to->count; i++) {
            vplBlock* b = &to->blocks[to->lit[i]];
            if (!to->culls) {
                vplAddShadowed(s, b, first, group, rays);
            } else if (facing.count > 0 && s->lights.clusters != NULL) {
                vplAddClusters(s, &facing, b);
            } else if (facing.count > 0) {
                vplAddFacing(s, &facing, b);
            }
        }
    }
}

// Adds all virtual lights to one block; a vplAddToBlockFcn.
static inline void vplAddAllLights(const vplShading* s, void* user, vplBlock* b, int64_t* rays)
{
    (void)user;
    static const int first = 0;
    vplLitBlocks to = {.blocks = b, .lit = &first, .count = 1, .culls = s->lights.columns[0] != NULL};
    if (to.culls) {
        to.bounds = vplFindBounds(b, &first, 1);
    }
    vplAddLights(s, &to, 0, s->lights.count, rays);
}

#endif
