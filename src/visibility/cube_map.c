// SPDX-License-Identifier: MIT
// Based on: Franchi and Ferrante, Virtual Point Lights, "Rendering the Cube Shadow Map": six views with 90
// degrees each, depth = world distance / far. Departs: the view depth w is turned into a distance by the
// texel's own direction instead of interpolating world positions; distances are not clamped at far.
#include <vpl/visibility.h>

#include "base/arena.h"
#include "math/vec.h"
#include "visibility/cube_texel.h"
#include "visibility/drawing.h"

#include <string.h>

enum { CUBE_COOKIE = 0x56504c50 };

vplCubeMapDef vplDefaultCubeMapDef(void)
{
    return (vplCubeMapDef){{0, 0, 0}, 1024, 0, 0, CUBE_COOKIE};
}

vplCubeFrame vplCube_GetFrame(int face)
{
    static const vplCubeFrame frames[6] = {
        {{0, 0, -1}, {0, 1, 0}, {1, 0, 0}}, {{0, 0, 1}, {0, 1, 0}, {-1, 0, 0}},
        {{1, 0, 0}, {0, 0, -1}, {0, 1, 0}}, {{1, 0, 0}, {0, 0, 1}, {0, -1, 0}},
        {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},  {{-1, 0, 0}, {0, 1, 0}, {0, 0, -1}},
    };
    return frames[face >= 0 && face < 6 ? face : 0];
}

bool vplCube_Find(vplVec3 direction, int size, vplCubePoint* pointOut)
{
    const float sum = fabsf(direction.x) + fabsf(direction.y) + fabsf(direction.z);
    if (!(sum > 0) || size < 1) { // also NaN
        return false;
    }
    const vplCubeTexel texel = vplCubeTexelOf(direction.x, direction.y, direction.z);
    *pointOut = (vplCubePoint){texel.face, texel.s, texel.t, vplTexelIndex(texel.s, (float)size, size - 1),
                               vplTexelIndex(texel.t, (float)size, size - 1)};
    return true;
}

// Uniforms of the vertex shader, for one object on one face.
typedef struct ObjectUniforms {
    vplCubeFrame frame;
    vplVec3 light;
    float near;
    const vplVec3* positions;
} ObjectUniforms;

static void faceVertices(const void* uniforms, int first, int count, const vplVertices* out)
{
    const ObjectUniforms* u = uniforms;
    const vplCubeFrame* frame = &u->frame;
    for (int i = 0; i < count; i++) {
        vplVec3 p = vplSub(u->positions[first + i], u->light);
        out->x[i] = vplDot(frame->right, p); // 90 degrees and aspect 1: the scale is exactly 1
        out->y[i] = vplDot(frame->up, p);
        out->w[i] = vplDot(frame->forward, p);
        out->z[i] = out->w[i] - u->near; // no far plane: every caster counts
    }
}

// The six faces, drawn side by side.
typedef struct Faces {
    vplRaster* rasters[6];
    vplMesh* meshes;         // one per object
    ObjectUniforms* objects; // one per object and face
} Faces;

static vplResult recordFace(Faces* f, const vplGeometry* g, const vplCubeMap* map, int face)
{
    vplFramebuffer framebuffer = vplDefaultFramebuffer(map->size, map->size);
    framebuffer.depth.clear = INFINITY;
    framebuffer.depth.pixels = map->texels + (size_t)face * (size_t)map->size * (size_t)map->size;
    TRY(vplRaster_Create(g->context, &framebuffer, &f->rasters[face]));
    for (int i = 0; i < g->objectCount; i++) {
        ObjectUniforms* object = &f->objects[face * g->objectCount + i];
        *object = (ObjectUniforms){vplCube_GetFrame(face), map->position, map->nearPlane,
                                   g->positions + g->objects[i].firstVertex};
        vplPipeline pipeline = vplDefaultPipeline();
        pipeline.vertex = faceVertices;
        pipeline.vertexUniforms = object;
        pipeline.distanceScale = 1 / map->farPlane;
        TRY(vplRaster_Draw(f->rasters[face], &f->meshes[i], &pipeline));
    }
    return VPL_SUCCESS;
}

static vplResult runFaces(Faces* f, const vplGeometry* g, vplCubeMap* map, vplProgressFcn* progress,
                          void* user)
{
    vplRasterStats stats[6];
    for (int i = 0; i < g->objectCount; i++) {
        f->meshes[i] = vplMeshOfObject(g, i);
    }
    for (int face = 0; face < 6; face++) {
        TRY(recordFace(f, g, map, face));
    }
    TRY(vplRaster_RunAll(f->rasters, 6, progress, user, stats));
    for (int face = 0; face < 6; face++) {
        vplRasterStats_Add(&map->stats, &stats[face]);
    }
    return VPL_SUCCESS;
}

static vplResult drawFaces(const vplGeometry* g, vplCubeMap* map, vplProgressFcn* progress, void* user)
{
    const size_t count = (size_t)g->objectCount;
    vplArena* scratch = vplArena_Create(g->context);
    Faces f = {.meshes = vplArena_Alloc(scratch, count, sizeof *f.meshes),
               .objects = vplArena_Alloc(scratch, 6 * count, sizeof *f.objects)};
    map->stats = (vplRasterStats){0};
    vplResult result = vplArena_Check(scratch);
    if (result == VPL_SUCCESS) {
        result = runFaces(&f, g, map, progress, user);
    }
    for (int face = 0; face < 6; face++) {
        vplRaster_Destroy(f.rasters[face]);
    }
    vplArena_Destroy(scratch);
    return result;
}

static vplResult checkDef(const vplContext* context, const vplCubeMapDef* def)
{
    if (def->cookie != CUBE_COOKIE) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplCubeMapDef was not made by vplDefaultCubeMapDef");
    }
    if (def->size < 1 || def->size > VPL_MAX_SHADOW_MAP) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplCubeMapDef.size is %d, must be in [1, %d]",
                       def->size, VPL_MAX_SHADOW_MAP);
    }
    if (!(def->farPlane >= 0 && def->nearPlane >= 0 && isfinite(def->farPlane) &&
          (def->farPlane == 0 || def->nearPlane < def->farPlane))) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "vplCubeMapDef.nearPlane and farPlane are %g and %g, must be 0 (automatic) or 0 < "
                       "nearPlane < farPlane",
                       (double)def->nearPlane, (double)def->farPlane);
    }
    return VPL_SUCCESS;
}

static void place(vplCubeMap* map, const vplGeometry* geometry, const vplCubeMapDef* def)
{
    map->position = def->position;
    map->farPlane = def->farPlane > 0 ? def->farPlane : vplFarthestVertex(geometry, def->position);
    map->nearPlane = def->nearPlane > 0 ? def->nearPlane : map->farPlane * 0x1p-64f;
}

vplResult vplCubeMap_Create(const vplGeometry* geometry, const vplCubeMapDef* def, vplProgressFcn* progress,
                            void* user, vplCubeMap** mapOut)
{
    REQUIRE(CONTEXT_OF(geometry), geometry, def, mapOut);
    vplContext* context = geometry->context;
    TRY(checkDef(context, def));
    vplArena* arena = vplArena_Create(context);
    vplCubeMap* map = vplArena_AllocZero(arena, 1, sizeof *map);
    float* texels = vplArena_Alloc(arena, 6 * (size_t)def->size * (size_t)def->size, sizeof *texels);
    vplResult result = vplArena_Check(arena);
    if (result == VPL_SUCCESS) {
        *map = (vplCubeMap){.size = def->size, .texels = texels, .context = context, .arena = arena};
        place(map, geometry, def);
        result = drawFaces(geometry, map, progress, user);
    }
    return vplArena_Deliver(arena, result, map, mapOut);
}

vplResult vplCubeMap_Redraw(vplCubeMap* map, const vplGeometry* geometry, const vplCubeMapDef* def,
                            vplProgressFcn* progress, void* user)
{
    REQUIRE(CONTEXT_OF(map) ?: CONTEXT_OF(geometry), map, geometry, def);
    TRY(checkDef(map->context, def));
    if (def->size != map->size) {
        return vplFail(map->context, VPL_INVALID_ARGUMENT, "vplCubeMapDef.size is %d, must be the map's %d",
                       def->size, map->size);
    }
    vplArena_Free(map->arena, map->bounds);
    map->bounds = NULL;
    place(map, geometry, def);
    return drawFaces(geometry, map, progress, user);
}

void vplCubeMap_Destroy(vplCubeMap* map)
{
    vplArena_Destroy(map != NULL ? map->arena : NULL);
}

float vplCubeMap_Distance(const vplCubeMap* map, vplVec3 direction)
{
    const size_t size = (size_t)map->size;
    vplCubePoint p;
    if (!vplCube_Find(direction, map->size, &p)) {
        return INFINITY;
    }
    return map->texels[((size_t)p.face * size + (size_t)p.row) * size + (size_t)p.column] * map->farPlane;
}
