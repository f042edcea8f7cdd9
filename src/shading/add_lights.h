// SPDX-License-Identifier: MIT
// Virtual lights for blocks of the G-buffer, for kernels: group by group, without those that give nothing, and with
// the visibility of clusters.
//
// Lights of one cluster share what their cluster sees (Aranha et al., SSVP: one
// paraboloid map per cluster): a run of lights is summed first, then multiplied by visibility once. The sum of a group
// is (run 0) v0 + (run 1) v1 + ..., in this order, in float; runs begin where the list changes cluster, and where groups
// begin. So one cluster that sees all has the bits of lights without shadows, and as many clusters as lights have
// those of lights with a map each.
#ifndef VPL_SHADING_ADD_LIGHTS_H
#define VPL_SHADING_ADD_LIGHTS_H

#include "shading/gbuffer.h"

static inline void vplAddGroup(vplBlock* b, float part[3][VPL_LANES])
{
    for (int c = 0; c < 3; c++) {
        for (int l = 0; l < VPL_LANES; l++) {
            b->sums[c][l] += (double)part[c][l];
        }
    }
}

// Consecutive lights of a list that share a cluster.
typedef struct vplLightRun {
    int first, count;
    int cluster; // -1: casts no shadow
} vplLightRun;

// The lights of a group that may give something to some blocks.
typedef struct vplKeptLights {
    vplShadeLight lights[VPL_LIGHT_GROUP];
    vplLightRun runs[VPL_LIGHT_GROUP];
    int count, runCount; // one run where lights have no clusters
} vplKeptLights;

// Of virtual lights first .. first + count - 1 those that do not face away from all points within the bounds, nor these
// from them. Runs are not joined where all between them is left out, so that bits do not depend on what is.
static inline void vplKeepLights(const vplShading* s, const vplBounds* bounds, int first, int count,
                                 vplKeptLights* kept)
{
    int32_t keep[VPL_LIGHT_GROUP];
    s->cull(bounds, s->columns, first, count, keep);
    const int* clusters = s->def->lightClusters ? s->def->lightClusters + first : NULL;
    kept->count = kept->runCount = 0;
    for (int i = 0; i < count; i++) {
        if (i == 0 || (clusters != NULL && clusters[i] != clusters[i - 1])) {
            // The last run is written over where nothing was kept of it.
            kept->runCount += kept->runCount > 0 && kept->runs[kept->runCount - 1].count == 0 ? 0 : 1;
            kept->runs[kept->runCount - 1] = (vplLightRun){kept->count, 0, clusters ? clusters[i] : -1};
        }
        kept->lights[kept->count] = s->def->lights[first + i];
        kept->count += keep[i];
        kept->runs[kept->runCount - 1].count += keep[i];
    }
}

// What a cluster's lights give to a block may be 0 in all lanes: then nobody asks what the cluster sees.
static inline bool vplAnyLit(float part[3][VPL_LANES])
{
    // Nothing is negative: some bit is set, then. 64 bits at a time are reduced in fewer steps than comparisons.
    uint64_t bits[3][VPL_LANES / 2], any = 0;
    memcpy(bits, part, sizeof bits);
    for (int i = 0; i < VPL_LANES / 2; i++) {
        any |= bits[0][i] | bits[1][i] | bits[2][i];
    }
    return any != 0;
}

// Looks up what a cluster sees of a block, once for all runs of the cluster that follow each other.
static inline void vplSeeCluster(const vplShading* s, vplBlock* b, int cluster)
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
}

static inline void vplAddClusters(const vplShading* s, const vplKeptLights* kept, vplBlock* b)
{
    _Alignas(64) float sum[3][VPL_LANES] = {{0}};
    for (int i = 0; i < kept->runCount; i++) {
        const vplLightRun* run = &kept->runs[i];
        if (run->count == 0) {
            continue;
        }
        _Alignas(64) float part[3][VPL_LANES] = {{0}};
        s->lightKernel(&b->surface, kept->lights + run->first, run->count, s->inverseBound, part);
        if (vplAnyLit(part)) {
            vplSeeCluster(s, b, run->cluster);
            for (int c = 0; c < 3; c++) {
                for (int l = 0; l < VPL_LANES; l++) {
                    sum[c][l] += b->visible[l] * part[c][l];
                }
            }
        }
    }
    vplAddGroup(b, sum);
}

static inline void vplAddKeptLights(const vplShading* s, const vplKeptLights* kept, vplBlock* b)
{
    _Alignas(64) float part[3][VPL_LANES] = {{0}};
    s->lightKernel(&b->surface, kept->lights, kept->count, s->inverseBound, part);
    vplAddGroup(b, part);
}

static inline void vplAddShadowedLights(const vplShading* s, vplBlock* b, int first, int count, int64_t* rays)
{
    _Alignas(64) float part[3][VPL_LANES] = {{0}};
    vplIndirectIrradiance(s, &b->points, first, count, part, rays);
    vplAddGroup(b, part);
}

// Virtual lights first .. first + count - 1, in groups. Without bounds none is left out; those of clusters have bounds.
static inline void vplAddLights(const vplShading* s, vplBlock* blocks, const int* lit, int litCount,
                                const vplBounds* bounds, int first, int count, int64_t* rays)
{
    vplKeptLights kept;
    for (const int end = first + count; first < end; first += VPL_LIGHT_GROUP) {
        const int group = end - first < VPL_LIGHT_GROUP ? end - first : VPL_LIGHT_GROUP;
        if (bounds != NULL) {
            vplKeepLights(s, bounds, first, group, &kept);
        }
        for (int i = 0; i < litCount; i++) {
            vplBlock* b = &blocks[lit[i]];
            if (bounds == NULL) {
                vplAddShadowedLights(s, b, first, group, rays);
            } else if (kept.count > 0 && s->def->lightClusters != NULL) {
                vplAddClusters(s, &kept, b);
            } else if (kept.count > 0) {
                vplAddKeptLights(s, &kept, b);
            }
        }
    }
}

#endif
