// SPDX-License-Identifier: MIT
// Traces the same rays with Intel Embree 3, if it was found at build time.
#ifndef VPL_BENCH_EMBREE_H
#define VPL_BENCH_EMBREE_H

#ifdef HAVE_EMBREE

#include <vpl/stages.h>

#include <embree3/rtcore.h>
#include <math.h>
#include <string.h>

static inline RTCScene makeEmbree(RTCDevice device, const vplGeometry* g, enum RTCBuildQuality quality)
{
    RTCScene scene = rtcNewScene(device);
    RTCGeometry mesh = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    float* vertices = rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                              3 * sizeof(float), (size_t)g->vertexCount);
    uint32_t* indices = rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                3 * sizeof(uint32_t), (size_t)g->triangleCount);
    memcpy(vertices, g->positions, (size_t)g->vertexCount * sizeof *g->positions);
    for (int i = 0; i < g->triangleCount; i++) {
        for (int k = 0; k < 3; k++) {
            indices[3 * i + k] = g->indices[3 * i + k] + (uint32_t)g->objects[g->owners[i]].firstVertex;
        }
    }
    rtcCommitGeometry(mesh);
    rtcAttachGeometry(scene, mesh);
    rtcReleaseGeometry(mesh);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(scene, quality);
    return scene;
}

static inline struct RTCRay toEmbree(const vplRay* r, float limit)
{
    return (struct RTCRay){.org_x = r->origin.x,
                           .org_y = r->origin.y,
                           .org_z = r->origin.z,
                           .dir_x = r->direction.x,
                           .dir_y = r->direction.y,
                           .dir_z = r->direction.z,
                           .tnear = 1e-5f,
                           .tfar = limit,
                           .mask = ~0u};
}

static inline int tracePackets(RTCScene scene, struct RTCIntersectContext* context, const vplRay* rays,
                               int count)
{
    int hits = 0;
    for (int i = 0; i < count; i += 16) {
        struct RTCRay16 p;
        __attribute__((aligned(64))) int valid[16];
        memset(&p, 0, sizeof p);
        for (int lane = 0; lane < 16; lane++) {
            valid[lane] = i + lane < count ? -1 : 0;
            const vplRay* r = &rays[i + lane < count ? i + lane : i];
            p.org_x[lane] = r->origin.x;
            p.org_y[lane] = r->origin.y;
            p.org_z[lane] = r->origin.z;
            p.dir_x[lane] = r->direction.x;
            p.dir_y[lane] = r->direction.y;
            p.dir_z[lane] = r->direction.z;
            p.tnear[lane] = 1e-5f;
            p.tfar[lane] = 1;
            p.mask[lane] = ~0u;
        }
        rtcOccluded16(valid, scene, context, &p);
        for (int lane = 0; lane < 16; lane++) {
            hits += valid[lane] && p.tfar[lane] < 0;
        }
    }
    return hits;
}

typedef struct EmbreeWay {
    bool any;      // any hit before t = 1 instead of the closest
    bool packets;  // packets of 16 rays
    bool coherent; // passes Embree the hint that rays are coherent
} EmbreeWay;

// Traces all rays and returns the number of hits.
static inline int traceEmbree(RTCScene scene, const vplRay* rays, int count, EmbreeWay way)
{
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags =
        way.coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    if (way.packets) {
        return tracePackets(scene, &context, rays, count);
    }
    int hits = 0;
    for (int i = 0; i < count; i++) {
        if (way.any) {
            struct RTCRay ray = toEmbree(&rays[i], 1);
            rtcOccluded1(scene, &context, &ray);
            hits += ray.tfar < 0;
        } else {
            struct RTCRayHit q = {.ray = toEmbree(&rays[i], INFINITY)};
            q.hit.geomID = RTC_INVALID_GEOMETRY_ID;
            rtcIntersect1(scene, &context, &q);
            hits += q.hit.geomID != RTC_INVALID_GEOMETRY_ID;
        }
    }
    return hits;
}

#endif

#endif
