// SPDX-License-Identifier: MIT
// Hemi-octahedral shadow maps, many at once: one task draws one map.
#include "visibility/hemi_map.h"
#include "base/arena.h"
#include "geometry/bvh.h"
#include "visibility/kernels.h"

#include <string.h>

size_t vplHemiMaps_BytesPerMap(int size)
{
    return vplHemiMap_Texels(size) * sizeof(float) + sizeof(vplHemiMap);
}

vplResult vplHemiMaps_Create(vplContext* context, int size, int capacity, vplHemiMaps** mapsOut)
{
    REQUIRE(context, context, mapsOut);
    if (size < 1 || size > VPL_MAX_SHADOW_MAP || capacity < 0) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "%d hemi-octahedral maps of %d texels a side: must be 0 or more of [1, %d]", capacity,
                       size, VPL_MAX_SHADOW_MAP);
    }
    vplArena* arena = vplArena_Create(context);
    vplHemiMaps* maps = vplArena_Alloc(arena, 1, sizeof *maps);
    vplHemiMap* list = vplArena_AllocZero(arena, (size_t)capacity, sizeof *list);
    float* texels = vplArena_Alloc(arena, (size_t)capacity, vplHemiMap_Texels(size) * sizeof *texels);
    const vplResult result = vplArena_Check(arena);
    if (result == VPL_SUCCESS) {
        *maps = (vplHemiMaps){.maps = list, .capacity = capacity, .size = size, .texels = texels};
        maps->context = context;
        maps->arena = arena;
    }
    return vplArena_Deliver(arena, result, maps, mapsOut);
}

void vplHemiMaps_Destroy(vplHemiMaps* maps)
{
    vplArena_Destroy(maps != NULL ? maps->arena : NULL);
}

typedef struct Drawing {
    const vplHemiMaps* maps;
    const vplBvh* bvh;
} Drawing;

static void drawMap(void* data, int index, int worker)
{
    (void)worker;
    const Drawing* d = data;
    const vplHemiMap* map = &d->maps->maps[index];
    float* texels = d->maps->texels + (size_t)index * vplHemiMap_Texels(map->size);
    memset(texels, 0, vplHemiMap_Texels(map->size) * sizeof *texels);
    vplVisibilityKernels_Get(d->maps->context->isa)->drawHemiMap(d->bvh, map, texels);
}

vplResult vplHemiMaps_Draw(vplHemiMaps* maps, const vplGeometry* geometry, const vplHemiMapPlace* places,
                           int count, vplProgressFcn* progress, void* user)
{
    REQUIRE(CONTEXT_OF(maps) ?: CONTEXT_OF(geometry), maps, geometry);
    REQUIRE_ARRAY(CONTEXT_OF(maps) ?: CONTEXT_OF(geometry), places, count);
    if (count < 0 || count > maps->capacity) {
        return vplFail(maps->context, VPL_INVALID_ARGUMENT,
                       "%d hemi-octahedral maps are asked for, there is room for %d", count, maps->capacity);
    }
    Drawing drawing = {maps, geometry->rayTree};
    if (drawing.bvh == NULL) {
        return vplFail(maps->context, VPL_INVALID_ARGUMENT,
                       "these maps are drawn through the ray tree; call vplGeometry_BuildRayTree first");
    }
    maps->count = count;
    for (int i = 0; i < count; i++) {
        vplHemiMap* map = &maps->maps[i];
        const float lift = vplLightLift(vplLargestOf(places[i].position));
        map->position = vplAdd(places[i].position, vplScale(lift, places[i].normal));
        map->forward = places[i].normal;
        vplTangentFrame(map->forward, &map->right, &map->up);
        map->size = maps->size;
        map->texels = maps->texels + (size_t)i * vplHemiMap_Texels(maps->size);
        map->context = maps->context;
    }
    return vplParallelForProgress(maps->context, count, drawMap, &drawing,
                                  (vplProgressRange){progress, user, 0, 1});
}

int64_t vplHemiMap_TrianglesAbove(const vplGeometry* geometry, const vplHemiMapPlace* place)
{
    const vplBvh* bvh = geometry->rayTree;
    if (bvh == NULL || bvh->nodes == NULL) {
        return geometry->triangleCount;
    }
    int32_t stack[VPL_BVH_DEPTH * VPL_BVH_WIDTH];
    int64_t blocks = 0;
    int depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
        const vplBvhNode* node = &bvh->nodes[stack[--depth]];
        for (uint32_t above = vplChildrenAbove(node, place->position, place->normal); above != 0;
             above &= above - 1) {
            const int32_t child = node->child[__builtin_ctz(above)];
            if (child >= 0) {
                stack[depth++] = child;
            } else {
                blocks++;
            }
        }
    }
    return blocks * geometry->triangleCount / (bvh->blockCount > 0 ? bvh->blockCount : 1);
}

void vplHemiMap_FactorBlock(const vplHemiMap* map, const vplSurface* surface, float factorOut[VPL_LANES])
{
    vplVisibilityKernels_Get(map->context->isa)->hemiMapFactor(map, surface, factorOut);
}

float vplHemiMap_Factor(const vplHemiMap* map, vplVec3 position, vplVec3 normal)
{
    const vplSurface surface = vplSurface_OfPoint(position, normal);
    float factor[VPL_LANES];
    vplHemiMap_FactorBlock(map, &surface, factor);
    return factor[0];
}
