// SPDX-License-Identifier: MIT
// Based on: Franchi and Ferrante, Virtual Point Lights, "Rendering the Cube Shadow Map": six views with 90
// degrees each, depth = world distance / far. Departs: the view depth w is turned into a distance by the
// texel's own direction instead of interpolating world positions; distances are not clamped at far.
#include "base/context.h"
#include "math/vec.h"
#include "visibility/cube_texel.h"
#include "visibility/shadow.h"

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

// What the shaders of one face need.
typedef struct FaceUniforms {
    const vplVec3* positions;
    vplVec3 light;
    vplCubeFrame frame;
    float near, inverseFar;
    float texel; // 2 / size
} FaceUniforms;

// What the vertex shader of one object on one face needs.
typedef struct ObjectUniforms {
    const FaceUniforms* face;
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

static void faceDistance(const void* uniforms, vplFragments* f)
{
    const FaceUniforms* u = uniforms;
    for (int l = 0; l < VPL_LANES; l++) {
        float s = ((float)(f->x + (l & 3)) + 0.5f) * u->texel - 1;
        float t = 1 - ((float)(f->y + (l >> 2)) + 0.5f) * u->texel;
        f->depth[l] = f->w[l] * sqrtf(1 + s * s + t * t) * u->inverseFar;
    }
}

// One face's share of the progress of all six.
typedef struct FaceProgress {
    vplProgressFcn* progress;
    void* user;
    int face;
} FaceProgress;

static bool reportFace(void* user, double fraction)
{
    const FaceProgress* p = user;
    return p->progress(p->user, (p->face + fraction) / 6);
}

static vplResult drawFace(const vplGeometry* g, vplCubeMap* map, float* texels, int face,
                          const vplMesh* meshes, vplProgressFcn* progress, void* user)
{
    vplContext* context = g->context;
    FaceUniforms faceUniforms = {g->positions, map->position, vplCube_GetFrame(face),
                                 map->near,    1 / map->far,  2.0f / (float)map->size};
    ObjectUniforms* objects = vplAlloc(context, (size_t)g->objectCount, sizeof *objects);
    if (objects == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    vplFramebuffer framebuffer = vplDefaultFramebuffer(map->size, map->size);
    framebuffer.depth.clear = INFINITY;
    framebuffer.depth.pixels = texels + (size_t)face * (size_t)map->size * (size_t)map->size;
    vplRaster* raster = NULL;
    vplResult result = vplRaster_Create(context, &framebuffer, &raster);
    for (int i = 0; i < g->objectCount && result == VPL_SUCCESS; i++) {
        objects[i] = (ObjectUniforms){&faceUniforms, g->positions + g->objects[i].firstVertex};
        vplPipeline pipeline = vplDefaultPipeline();
        pipeline.vertex = faceVertices;
        pipeline.vertexUniforms = &objects[i];
        pipeline.fragment = faceDistance;
        pipeline.fragmentUniforms = &faceUniforms;
        pipeline.writesDepth = true;
        pipeline.needsW = true;
        pipeline.planeMask = 0;
        result = vplRaster_Draw(raster, &meshes[i], &pipeline);
    }
    vplRasterStats stats = {0};
    if (result == VPL_SUCCESS) {
        FaceProgress faceProgress = {progress, user, face};
        result = vplRaster_Run(raster, progress ? reportFace : NULL, &faceProgress, &stats);
    }
    map->stats.drawCalls += stats.drawCalls;
    map->stats.fragments += stats.fragments;
    map->stats.trianglesIn += stats.trianglesIn;
    map->stats.trianglesBinned += stats.trianglesBinned;
    map->stats.vertexMs += stats.vertexMs;
    map->stats.tilesMs += stats.tilesMs;
    vplRaster_Destroy(raster);
    vplFree(context, objects);
    return result;
}

static float farthestVertex(const vplGeometry* g, vplVec3 from)
{
    float farthest = 0;
    for (int i = 0; i < g->vertexCount; i++) {
        farthest = fmaxf(farthest, vplLength(vplSub(g->positions[i], from)));
    }
    return farthest > 0 ? farthest * 1.0001f : 1;
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

// One mesh per object. They must outlive the runs that draw them.
static vplMesh* makeMeshes(const vplGeometry* g)
{
    vplMesh* meshes = vplAlloc(g->context, (size_t)g->objectCount, sizeof *meshes);
    for (int i = 0; meshes != NULL && i < g->objectCount; i++) {
        const vplGeometryObject* o = &g->objects[i];
        meshes[i] = (vplMesh){g->indices + 3 * (size_t)o->firstTriangle, o->vertexCount, o->triangleCount};
    }
    return meshes;
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
    vplMesh* meshes = makeMeshes(geometry);
    if (map == NULL || texels == NULL || meshes == NULL) {
        vplFree(context, map);
        vplFree(context, texels);
        vplFree(context, meshes);
        return VPL_OUT_OF_MEMORY;
    }
    map->context = context;
    map->texels = texels;
    map->position = def->position;
    map->size = def->size;
    map->far = def->far > 0 ? def->far : farthestVertex(geometry, def->position);
    map->near = def->near > 0 ? def->near : map->far * 0x1p-20f;
    for (int face = 0; face < 6 && result == VPL_SUCCESS; face++) {
        result = drawFace(geometry, map, texels, face, meshes, progress, user);
    }
    vplFree(context, meshes);
    if (result != VPL_SUCCESS) {
        vplCubeMap_Destroy(map);
        return result;
    }
    *mapOut = map;
    return VPL_SUCCESS;
}

void vplCubeMap_Destroy(vplCubeMap* map)
{
    if (map != NULL) {
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
