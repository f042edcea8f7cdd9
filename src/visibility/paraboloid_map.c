// SPDX-License-Identifier: MIT
// Paraboloid maps, many at once: one task draws one hemisphere, from start to end.
#include "visibility/paraboloid_map.h"
#include "base/context.h"
#include "base/isa.h"
#include "geometry/bvh.h"
#include "geometry/triangle.h"

VPL_KERNEL_TABLE(DRAW, vplDrawParaboloidFcn, vplDrawParaboloid);
VPL_KERNEL_TABLE(FACTOR, vplParaboloidFactorFcn, vplParaboloidFactor);

vplResult vplParaboloidMaps_Create(vplContext* context, int size, int capacity, bool triangles,
                                   vplParaboloidMaps** mapsOut)
{
    if (size < 1 || size > VPL_MAX_SHADOW_MAP || capacity < 0) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "%d paraboloid maps of %d texels a side: must be 0 or more of [1, %d]", capacity, size,
                       VPL_MAX_SHADOW_MAP);
    }
    const size_t texels = 2 * vplParaboloidMap_Texels(size);
    vplParaboloidMaps* maps = vplAllocZero(context, 1, sizeof *maps);
    if (maps == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    maps->maps = vplAllocZero(context, (size_t)capacity, sizeof *maps->maps);
    maps->texels = vplAlloc(context, (size_t)capacity, texels * sizeof *maps->texels);
    maps->triangles =
        triangles ? vplAlloc(context, (size_t)capacity, texels * sizeof *maps->triangles) : NULL;
    maps->scratch = vplAlloc(context, (triangles ? 2 : 1) * (size_t)context->workerCount,
                             vplParaboloidMap_Drawn(size) * sizeof *maps->scratch);
    maps->capacity = capacity;
    maps->size = size;
    maps->context = context;
    if (maps->maps == NULL || maps->texels == NULL || maps->scratch == NULL ||
        (triangles && maps->triangles == NULL)) {
        vplParaboloidMaps_Destroy(maps);
        return VPL_OUT_OF_MEMORY;
    }
    *mapsOut = maps;
    return VPL_SUCCESS;
}

void vplParaboloidMaps_Destroy(vplParaboloidMaps* maps)
{
    if (maps != NULL) {
        vplContext* context = maps->context;
        vplFree(context, maps->scratch);
        vplFree(context, maps->triangles);
        vplFree(context, maps->texels);
        vplFree(context, (void*)maps->maps);
        vplFree(context, maps);
    }
}

typedef struct Drawing {
    const vplParaboloidMaps* maps;
    const vplBvh* bvh;
} Drawing;

// Front hemispheres first: all of them are drawn, and workers end together.
static void drawHemisphere(void* data, int index, int worker)
{
    const Drawing* d = data;
    const int hemisphere = index / d->maps->count;
    const vplParaboloidMap* map = &d->maps->maps[index % d->maps->count];
    const size_t first = (size_t)hemisphere * vplParaboloidMap_Texels(map->size),
                 drawn = vplParaboloidMap_Drawn(map->size);
    const bool ids = map->triangles != NULL;
    float* scratch = d->maps->scratch + (ids ? 2 : 1) * (size_t)worker * drawn;
    if (hemisphere < map->hemispheres) {
        DRAW[map->context->isa](d->bvh, map, hemisphere,
                                (vplParaboloidTexels){scratch, ids ? (int32_t*)(scratch + drawn) : NULL},
                                (vplParaboloidTexels){(float*)map->texels + first,
                                                      ids ? (int32_t*)map->triangles + first : NULL});
    }
}

static void place(const vplParaboloidMaps* maps, int index, const vplParaboloidPlace* p)
{
    vplParaboloidMap* map = (vplParaboloidMap*)&maps->maps[index];
    const float lift = p->onSurface ? vplLightLift(vplLargestOf(p->position)) : 0;
    const size_t first = (size_t)index * 2 * vplParaboloidMap_Texels(maps->size);
    map->position = vplAdd(p->position, vplScale(lift, p->normal));
    map->forward = p->normal;
    vplTangentFrame(map->forward, &map->right, &map->up);
    map->size = maps->size;
    map->hemispheres = p->hemispheres;
    map->texels = maps->texels + first;
    map->triangles = maps->triangles ? maps->triangles + first : NULL;
    map->context = maps->context;
}

vplResult vplParaboloidMaps_Draw(vplParaboloidMaps* maps, const vplGeometry* geometry,
                                 const vplParaboloidPlace* places, int count, vplProgressFcn* progress,
                                 void* user)
{
    if (count < 0 || count > maps->capacity) {
        return vplFail(maps->context, VPL_INVALID_ARGUMENT,
                       "%d paraboloid maps are asked for, there is room for %d", count, maps->capacity);
    }
    for (int i = 0; i < count; i++) {
        if (places[i].hemispheres < 1 || places[i].hemispheres > 2) {
            return vplFail(maps->context, VPL_INVALID_ARGUMENT,
                           "vplParaboloidPlace.hemispheres of place %d is %d, must be 1 or 2", i,
                           places[i].hemispheres);
        }
    }
    vplResult result = vplGeometry_PrepareRays(geometry);
    if (result != VPL_SUCCESS) {
        return result;
    }
    maps->count = count;
    for (int i = 0; i < count; i++) {
        place(maps, i, &places[i]);
    }
    Drawing drawing = {maps, geometry->rayTree};
    return vplParallelForProgress(maps->context, 2 * count, drawHemisphere, &drawing, progress, user, 0, 1);
}

bool vplParaboloidMap_GetHit(const vplParaboloidMap* map, const vplGeometry* geometry, int hemisphere,
                             int column, int row, vplHit* hitOut, vplVec3* directionOut)
{
    const double x = (2 * column + 1.0) / map->size - 1, y = (2 * row + 1.0) / map->size - 1;
    if (hemisphere >= map->hemispheres || !(x * x + y * y <= 1)) {
        return false;
    }
    const size_t at = (size_t)hemisphere * vplParaboloidMap_Texels(map->size) +
                      vplParaboloidMap_Place(map->size, column, row);
    const int triangle = map->triangles[at];
    if (triangle < 0) {
        return false;
    }
    const vplVec3 d = vplParaboloid_Unproject(x, y);
    const vplVec3 direction = vplAdd(vplAdd(vplScale(d.x, map->right), vplScale(d.y, map->up)),
                                     vplScale(hemisphere == 0 ? d.z : -d.z, map->forward));
    vplHit hit = {.t = 1 / map->texels[at],
                  .object = geometry->owners[triangle],
                  .face = vplGeometry_FaceOf(geometry, triangle),
                  .triangle = triangle,
                  .normal = geometry->normals[triangle]};
    hit.position = vplGeometry_InsideAt(geometry, triangle, vplAdd(map->position, vplScale(hit.t, direction)),
                                        &hit.u, &hit.v);
    *hitOut = hit;
    *directionOut = direction;
    return true;
}

void vplParaboloidMap_FactorBlock(const vplParaboloidMap* map, const vplSurface* surface,
                                  float factorOut[VPL_LANES])
{
    FACTOR[map->context->isa](map, surface, factorOut);
}
