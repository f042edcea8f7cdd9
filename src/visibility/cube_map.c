// SPDX-License-Identifier: MIT
// Based on: Franchi and Ferrante, Virtual Point Lights, "Rendering the Cube Shadow Map": six views with 90
// degrees each, depth = world distance / far. Departs: the view depth w is turned into a distance by the
// texel's own direction instead of interpolating world positions; distances are not clamped at far.
#include "base/context.h"
#include "math/vec.h"
#include "visibility/cube_texel.h"
#include "visibility/drawing.h"
#include "visibility/shadow.h"

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
    return frames[face];
}

bool vplCube_Find(vplVec3 direction, int size, int* face, float* s, float* t, int* i, int* j)
{
    if (direction.x == 0 && direction.y == 0 && direction.z == 0) {
        return false;
    }
    vplCubeTexel texel = vplCubeTexelOf(direction.x, direction.y, direction.z);
    *face = texel.face;
    *s = texel.s;
    *t = texel.t;
    *i = vplTexelIndex(texel.s, (float)size, size - 1);
    *j = vplTexelIndex(texel.t, (float)size, size - 1);
    return true;
}

typedef struct Face {
    vplVec3 light;
    vplCubeFrame frame;
    float near;
} Face;

// What the vertex shader of one object on one face needs.
typedef struct ObjectUniforms {
    const Face* face;
    const vplVec3* positions;
} ObjectUniforms;

static void faceVertices(const void* uniforms, int first, int count, const vplVertices* out)
{
    const ObjectUniforms* u = uniforms;
    const vplCubeFrame* frame = &u->face->frame;
    for (int i = 0; i < count; i++) {
        vplVec3 p = vplSub(u->positions[first + i], u->face->light);
        out->x[i] = vplDot(frame->right, p); // 90 degrees and aspect 1: the scale is exactly 1
        out->y[i] = vplDot(frame->up, p);
        out->w[i] = vplDot(frame->forward, p);
        out->z[i] = out->w[i] - u->face->near; // no far plane: every caster counts
    }
}

// The six faces, drawn side by side.
typedef struct Faces {
    Face faces[6];
    vplRaster* rasters[6];
    vplMesh* meshes;         // one per object
    ObjectUniforms* objects; // one per object and face
} Faces;

static vplResult recordFace(Faces* f, const vplGeometry* g, const vplCubeMap* map, float* texels, int face)
{
    vplFramebuffer framebuffer = vplDefaultFramebuffer(map->size, map->size);
    framebuffer.depth.clear = INFINITY;
    framebuffer.depth.pixels = texels + (size_t)face * (size_t)map->size * (size_t)map->size;
    f->faces[face] = (Face){map->position, vplCube_GetFrame(face), map->near};
    vplResult result = vplRaster_Create(g->context, &framebuffer, &f->rasters[face]);
    for (int i = 0; i < g->objectCount && result == VPL_SUCCESS; i++) {
        ObjectUniforms* object = &f->objects[face * g->objectCount + i];
        *object = (ObjectUniforms){&f->faces[face], g->positions + g->objects[i].firstVertex};
        vplPipeline pipeline = vplDefaultPipeline();
        pipeline.vertex = faceVertices;
        pipeline.vertexUniforms = object;
        pipeline.distanceScale = 1 / map->far;
        result = vplRaster_Draw(f->rasters[face], &f->meshes[i], &pipeline);
    }
    return result;
}

static vplResult drawFaces(const vplGeometry* g, vplCubeMap* map, vplProgressFcn* progress, void* user)
{
    vplContext* context = g->context;
    const size_t count = (size_t)g->objectCount;
    Faces f = {.meshes = vplAlloc(context, count, sizeof *f.meshes),
               .objects = vplAlloc(context, 6 * count, sizeof *f.objects)};
    vplResult result = f.meshes && f.objects ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
    for (int i = 0; result == VPL_SUCCESS && i < g->objectCount; i++) {
        f.meshes[i] = vplMeshOfObject(g, i);
    }
    for (int face = 0; face < 6 && result == VPL_SUCCESS; face++) {
        result = recordFace(&f, g, map, (float*)map->texels, face);
    }
    vplRasterStats stats[6];
    if (result == VPL_SUCCESS) {
        result = vplRaster_RunAll(f.rasters, 6, progress, user, stats);
    }
    memset(&map->stats, 0, sizeof map->stats);
    for (int face = 0; face < 6; face++) {
        if (result == VPL_SUCCESS) {
            vplRasterStats_Add(&map->stats, &stats[face]);
        }
        vplRaster_Destroy(f.rasters[face]);
    }
    vplFree(context, f.objects);
    vplFree(context, f.meshes);
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
    if (!(def->far >= 0 && def->near >= 0 && isfinite(def->far) && (def->far == 0 || def->near < def->far))) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "vplCubeMapDef.near and far are %g and %g, must be 0 (automatic) or 0 < near < far",
                       (double)def->near, (double)def->far);
    }
    return VPL_SUCCESS;
}

static void place(vplCubeMap* map, const vplGeometry* geometry, const vplCubeMapDef* def)
{
    map->position = def->position;
    map->far = def->far > 0 ? def->far : vplFarthestVertex(geometry, def->position);
    map->near = def->near > 0 ? def->near : map->far * 0x1p-20f;
}

vplResult vplCubeMap_Create(const vplGeometry* geometry, const vplCubeMapDef* def, vplProgressFcn* progress,
                            void* user, vplCubeMap** mapOut)
{
    vplContext* context = geometry->context;
    vplResult result = checkDef(context, def);
    if (result != VPL_SUCCESS) {
        return result;
    }
    vplCubeMap* map = vplAllocZero(context, 1, sizeof *map);
    float* texels = vplAlloc(context, 6 * (size_t)def->size * (size_t)def->size, sizeof(float));
    if (map == NULL || texels == NULL) {
        vplFree(context, map);
        vplFree(context, texels);
        return VPL_OUT_OF_MEMORY;
    }
    map->context = context;
    map->texels = texels;
    map->size = def->size;
    place(map, geometry, def);
    result = drawFaces(geometry, map, progress, user);
    if (result != VPL_SUCCESS) {
        vplCubeMap_Destroy(map);
        return result;
    }
    *mapOut = map;
    return VPL_SUCCESS;
}

vplResult vplCubeMap_Redraw(vplCubeMap* map, const vplGeometry* geometry, const vplCubeMapDef* def,
                            vplProgressFcn* progress, void* user)
{
    const vplResult result = checkDef(map->context, def);
    if (result != VPL_SUCCESS) {
        return result;
    }
    if (def->size != map->size) {
        return vplFail(map->context, VPL_INVALID_ARGUMENT, "vplCubeMapDef.size is %d, must be the map's %d",
                       def->size, map->size);
    }
    vplFree(map->context, map->bounds);
    map->bounds = NULL;
    place(map, geometry, def);
    return drawFaces(geometry, map, progress, user);
}

void vplCubeMap_Destroy(vplCubeMap* map)
{
    if (map != NULL) {
        vplFree(map->context, map->bounds);
        vplFree(map->context, (void*)map->texels);
        vplFree(map->context, map);
    }
}

float vplCubeMap_Distance(const vplCubeMap* map, vplVec3 direction)
{
    int face, i, j;
    float s, t;
    if (!vplCube_Find(direction, map->size, &face, &s, &t, &i, &j)) {
        return INFINITY;
    }
    return map->texels[((size_t)face * (size_t)map->size + (size_t)j) * (size_t)map->size + (size_t)i] *
           map->far;
}
