// SPDX-License-Identifier: MIT
// Based on: Carsten Dachsbacher and Marc Stamminger, Reflective Shadow Maps, I3D 2005: the scene seen from the light,
// each texel with position, normal and flux. Departs: a point light has the six faces of a cube; only depth and the
// triangle are drawn, as fast as depth alone, and the rest is found for the texels that are asked for: SSVP asks for
// 256 of a million (see rsm_texels.c).
#include <vpl/lights.h>

#include "base/context.h"
#include "math/scalar.h"
#include "math/vec.h"
#include "visibility/drawing.h"

enum { RSM_COOKIE = 0x56504c62 };

vplReflectiveMapDef vplDefaultReflectiveMapDef(void)
{
    return (vplReflectiveMapDef){vplDefaultEmitterDef(), 256, RSM_COOKIE};
}

// ---- the view

// Returns what is nearer than it sees, metres.
static float aimPerspective(vplReflectiveMap* map, const vplGeometry* g)
{
    const vplEmitterDef* e = &map->emitter;
    map->origin = e->position;
    map->extent[0] = map->extent[1] = 1;
    if (e->type == VPL_EMITTER_SPOT) {
        double sine, cosine;
        vplSinCos(e->outerAngle, &sine, &cosine);
        map->extent[0] = map->extent[1] = sine / cosine;
        map->forward[0] = vplNormalize(e->direction);
        vplTangentFrame(map->forward[0], &map->right[0], &map->up[0]);
        map->right[0] = vplNegate(map->right[0]); // a frame is right-handed
    } else {
        for (int i = 0; i < 6; i++) {
            const vplCubeFrame frame = vplCube_GetFrame(i);
            map->right[i] = frame.right;
            map->up[i] = frame.up;
            map->forward[i] = frame.forward;
        }
    }
    map->unit = 1;
    return vplFarthestVertex(g, map->origin) * 0x1p-20f;
}

// The box around all vertices, along the light and across. A hair wider, so that its edges are within the view.
static void aimParallel(vplReflectiveMap* map, const vplGeometry* g)
{
    map->forward[0] = vplNormalize(map->emitter.direction);
    vplTangentFrame(map->forward[0], &map->right[0], &map->up[0]);
    map->right[0] = vplNegate(map->right[0]);
    const vplVec3 axes[3] = {map->right[0], map->up[0], map->forward[0]};
    const vplVec3 centre = vplScale(0.5f, vplAdd(g->boundsMin, g->boundsMax));
    double middle[3], half[3], largest = 0;
    for (int k = 0; k < 3; k++) {
        double low = INFINITY, high = -INFINITY;
        for (int i = 0; i < g->vertexCount; i++) {
            const double at = (double)vplDot(axes[k], vplSub(g->positions[i], centre));
            low = at < low ? at : low;
            high = at > high ? at : high;
        }
        middle[k] = g->vertexCount > 0 ? 0.5 * (low + high) : 0;
        half[k] = g->vertexCount > 0 ? 0.5 * (high - low) : 0;
        largest = half[k] > largest ? half[k] : largest;
    }
    for (int k = 0; k < 3; k++) { // what is seen edge-on has no width of its own
        half[k] += (largest > 0 ? largest : 1) * 0x1p-16;
    }
    map->extent[0] = half[0];
    map->extent[1] = half[1];
    map->origin = vplAdd(centre, vplAdd(vplScale((float)middle[0], axes[0]),
                                        vplAdd(vplScale((float)middle[1], axes[1]),
                                               vplScale((float)(middle[2] - half[2]), axes[2]))));
    map->unit = (float)(2 * half[2]);
}

// One object on one face.
typedef struct ObjectUniforms {
    const vplReflectiveMap* map;
    int face;
    float near;               // metres; parallel: 0
    const vplVec3* positions; // of the object's vertices
} ObjectUniforms;

static void shadeVertices(const void* uniforms, int first, int count, const vplVertices* out)
{
    const ObjectUniforms* u = uniforms;
    const vplReflectiveMap* m = u->map;
    const bool parallel = m->emitter.type == VPL_EMITTER_DIRECTIONAL;
    const float acrossScale = (float)(1 / m->extent[0]), upScale = (float)(1 / m->extent[1]);
    const float inverseFar = 1 / m->unit;
    for (int i = 0; i < count; i++) {
        const vplVec3 p = vplSub(u->positions[first + i], m->origin);
        const float depth = vplDot(m->forward[u->face], p);
        out->x[i] = acrossScale * vplDot(m->right[u->face], p);
        out->y[i] = upScale * vplDot(m->up[u->face], p);
        out->w[i] = parallel ? 1 : depth;
        out->z[i] = parallel ? depth * inverseFar : depth - u->near; // no far plane: everything counts
    }
}

// ---- drawing

// In parallel views z/w is linear and what is wanted. In others it would crowd where everything is: depths are those
// along the axis.
static vplResult recordFace(const vplReflectiveMap* map, const vplGeometry* g, float near, int face,
                            ObjectUniforms* uniforms, const vplMesh* meshes, vplRaster** rasterOut)
{
    vplFramebuffer framebuffer = vplDefaultFramebuffer(map->size, map->size);
    const size_t first = (size_t)face * (size_t)map->size * (size_t)map->size;
    framebuffer.depth.clear = INFINITY;
    framebuffer.depth.pixels = (float*)map->depth + first;
    framebuffer.triangles = (int32_t*)map->triangle + first;
    vplResult result = vplRaster_Create(g->context, &framebuffer, rasterOut);
    for (int i = 0; i < g->objectCount && result == VPL_SUCCESS; i++) {
        ObjectUniforms* u = &uniforms[face * g->objectCount + i];
        *u = (ObjectUniforms){map, face, near, g->positions + g->objects[i].firstVertex};
        vplPipeline pipeline = vplDefaultPipeline();
        pipeline.vertex = shadeVertices;
        pipeline.vertexUniforms = u;
        pipeline.distanceScale = map->emitter.type == VPL_EMITTER_DIRECTIONAL ? 0 : 1;
        pipeline.distanceAlongAxis = pipeline.distanceScale != 0;
        result = vplRaster_Draw(*rasterOut, &meshes[i], &pipeline);
    }
    return result;
}

static vplResult draw(vplReflectiveMap* map, const vplGeometry* g, vplProgressFcn* progress, void* user)
{
    vplContext* context = g->context;
    const size_t objects = (size_t)g->objectCount;
    float near = 0;
    if (map->emitter.type == VPL_EMITTER_DIRECTIONAL) {
        aimParallel(map, g);
    } else {
        near = aimPerspective(map, g);
    }
    ObjectUniforms* uniforms = vplAlloc(context, objects * (size_t)map->faceCount, sizeof *uniforms);
    vplMesh* meshes = vplAlloc(context, objects, sizeof *meshes);
    vplRaster* rasters[6] = {NULL};
    vplRasterStats stats[6];
    vplResult result = uniforms && meshes ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
    for (int i = 0; result == VPL_SUCCESS && i < g->objectCount; i++) {
        meshes[i] = vplMeshOfObject(g, i);
    }
    for (int face = 0; face < map->faceCount && result == VPL_SUCCESS; face++) {
        result = recordFace(map, g, near, face, uniforms, meshes, &rasters[face]);
    }
    if (result == VPL_SUCCESS) {
        result = vplRaster_RunAll(rasters, map->faceCount, progress, user, stats);
    }
    for (int face = 0; face < map->faceCount; face++) {
        if (result == VPL_SUCCESS) {
            vplRasterStats_Add(&map->stats, &stats[face]);
        }
        vplRaster_Destroy(rasters[face]);
    }
    vplFree(context, meshes);
    vplFree(context, uniforms);
    return result;
}

// ---- the map

vplResult vplReflectiveMap_Create(const vplGeometry* geometry, const vplReflectiveMapDef* def,
                                  vplProgressFcn* progress, void* user, vplReflectiveMap** mapOut)
{
    vplContext* context = geometry->context;
    if (def->cookie != RSM_COOKIE) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "vplReflectiveMapDef was not made by vplDefaultReflectiveMapDef");
    }
    if (def->size < 1 || def->size > VPL_MAX_SHADOW_MAP) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplReflectiveMapDef.size is %d, must be in [1, %d]",
                       def->size, VPL_MAX_SHADOW_MAP);
    }
    vplReflectiveMap* map = vplAllocZero(context, 1, sizeof *map);
    if (map == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    map->context = context;
    map->emitter = def->emitter;
    map->size = def->size;
    map->faceCount = def->emitter.type == VPL_EMITTER_POINT ? 6 : 1;
    const size_t texels = (size_t)map->faceCount * (size_t)map->size * (size_t)map->size;
    map->depth = vplAlloc(context, texels, sizeof *map->depth);
    map->triangle = map->depth ? vplAlloc(context, texels, sizeof *map->triangle) : NULL;
    vplResult result = map->triangle ? draw(map, geometry, progress, user) : VPL_OUT_OF_MEMORY;
    if (result != VPL_SUCCESS) {
        vplReflectiveMap_Destroy(map);
        return result;
    }
    *mapOut = map;
    return VPL_SUCCESS;
}

void vplReflectiveMap_Destroy(vplReflectiveMap* map)
{
    if (map != NULL) {
        vplFree(map->context, (void*)map->triangle);
        vplFree(map->context, (void*)map->depth);
        vplFree(map->context, map);
    }
}
