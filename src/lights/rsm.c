// SPDX-License-Identifier: MIT
// Reflective shadow maps.
// Based on: Carsten Dachsbacher and Marc Stamminger, Reflective Shadow Maps, I3D 2005: the scene seen from
// the light, each texel with position, normal and flux. Departs: a point light has the six faces of a cube;
// only depth and triangle are drawn, as fast as depth alone, and the rest is found for the texels that are
// read, 256 of a million in SSVP (see rsm_texels.c).
#include <vpl/lights.h>

#include "base/arena.h"
#include "math/scalar.h"
#include "math/vec.h"
#include "visibility/drawing.h"

enum { RSM_COOKIE = 0x56504c62 };

vplReflectiveMapDef vplDefaultReflectiveMapDef(void)
{
    return (vplReflectiveMapDef){vplDefaultEmitterDef(), 256, RSM_COOKIE};
}

// ---- the view

// Returns the near distance, metres.
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
    return vplFarthestVertex(g, map->origin) * 0x1p-64f;
}

// The box around all vertices in the light's frame. Slightly larger, so that its edges are within the view.
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
    for (int k = 0; k < 3; k++) { // a flat scene seen edge-on has no width
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
        out->z[i] = parallel ? depth * inverseFar : depth - u->near; // no far plane
    }
}

// ---- drawing

// A map while it is drawn.
typedef struct Drawing {
    vplReflectiveMap* map;
    const vplGeometry* geometry;
    float near;
    float* depth; // the map's, as it is drawn
    int32_t* triangle;
    ObjectUniforms* uniforms; // of every object on every face
    vplMesh* meshes;          // of every object
    vplRaster* rasters[6];
} Drawing;

// Creates the raster of a face. Depth is z/w in parallel views, where that is linear, else the distance along
// the axis.
static vplResult recordFace(Drawing* d, int face)
{
    const vplReflectiveMap* map = d->map;
    const vplGeometry* g = d->geometry;
    vplFramebuffer framebuffer = vplDefaultFramebuffer(map->size, map->size);
    const size_t first = (size_t)face * (size_t)map->size * (size_t)map->size;
    framebuffer.depth.clear = INFINITY;
    framebuffer.depth.pixels = d->depth + first;
    framebuffer.triangles = d->triangle + first;
    TRY(vplRaster_Create(g->context, &framebuffer, &d->rasters[face]));
    for (int i = 0; i < g->objectCount; i++) {
        ObjectUniforms* u = &d->uniforms[face * g->objectCount + i];
        *u = (ObjectUniforms){map, face, d->near, g->positions + g->objects[i].firstVertex};
        vplPipeline pipeline = vplDefaultPipeline();
        pipeline.vertex = shadeVertices;
        pipeline.vertexUniforms = u;
        pipeline.distanceScale = map->emitter.type == VPL_EMITTER_DIRECTIONAL ? 0 : 1;
        pipeline.distanceAlongAxis = pipeline.distanceScale != 0;
        TRY(vplRaster_Draw(d->rasters[face], &d->meshes[i], &pipeline));
    }
    return VPL_SUCCESS;
}

static vplResult recordFaces(Drawing* d, vplArena* scratch)
{
    const vplGeometry* g = d->geometry;
    const size_t objects = (size_t)g->objectCount;
    d->uniforms = vplArena_Alloc(scratch, objects * (size_t)d->map->faceCount, sizeof *d->uniforms);
    d->meshes = vplArena_Alloc(scratch, objects, sizeof *d->meshes);
    TRY(vplArena_Check(scratch));
    for (int i = 0; i < g->objectCount; i++) {
        d->meshes[i] = vplMeshOfObject(g, i);
    }
    for (int face = 0; face < d->map->faceCount; face++) {
        TRY(recordFace(d, face));
    }
    return VPL_SUCCESS;
}

static vplResult draw(Drawing* d, vplProgressFcn* progress, void* user)
{
    vplReflectiveMap* map = d->map;
    vplRasterStats stats[6];
    if (map->emitter.type == VPL_EMITTER_DIRECTIONAL) {
        aimParallel(map, d->geometry);
    } else {
        d->near = aimPerspective(map, d->geometry);
    }
    vplArena* scratch = vplArena_Create(d->geometry->context);
    vplResult result = recordFaces(d, scratch);
    if (result == VPL_SUCCESS) {
        result = vplRaster_RunAll(d->rasters, map->faceCount, progress, user, stats);
    }
    for (int face = 0; face < map->faceCount; face++) {
        if (result == VPL_SUCCESS) {
            vplRasterStats_Add(&map->stats, &stats[face]);
        }
        vplRaster_Destroy(d->rasters[face]);
    }
    vplArena_Destroy(scratch);
    return result;
}

// ---- the map

vplResult vplReflectiveMap_Create(const vplGeometry* geometry, const vplReflectiveMapDef* def,
                                  vplProgressFcn* progress, void* user, vplReflectiveMap** mapOut)
{
    REQUIRE(CONTEXT_OF(geometry), geometry, def, mapOut);
    vplContext* context = geometry->context;
    if (def->cookie != RSM_COOKIE) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "vplReflectiveMapDef was not made by vplDefaultReflectiveMapDef");
    }
    if (def->size < 1 || def->size > VPL_MAX_SHADOW_MAP) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplReflectiveMapDef.size is %d, must be in [1, %d]",
                       def->size, VPL_MAX_SHADOW_MAP);
    }
    const int faces = def->emitter.type == VPL_EMITTER_POINT ? 6 : 1;
    const size_t texels = (size_t)faces * (size_t)def->size * (size_t)def->size;
    vplArena* arena = vplArena_Create(context);
    vplReflectiveMap* map = vplArena_AllocZero(arena, 1, sizeof *map);
    Drawing d = {.map = map,
                 .geometry = geometry,
                 .depth = vplArena_Alloc(arena, texels, sizeof *d.depth),
                 .triangle = vplArena_Alloc(arena, texels, sizeof *d.triangle)};
    vplResult result = vplArena_Check(arena);
    if (result == VPL_SUCCESS) {
        *map = (vplReflectiveMap){.emitter = def->emitter,
                                  .size = def->size,
                                  .faceCount = faces,
                                  .depth = d.depth,
                                  .triangle = d.triangle,
                                  .context = context,
                                  .arena = arena};
        result = draw(&d, progress, user);
    }
    return vplArena_Deliver(arena, result, map, mapOut);
}

void vplReflectiveMap_Destroy(vplReflectiveMap* map)
{
    vplArena_Destroy(map != NULL ? map->arena : NULL);
}
