// SPDX-License-Identifier: MIT
// Shadow maps of half spaces, many at once: one task draws one map, from start to end.
#include "visibility/hemi_map.h"
#include "base/context.h"
#include "base/isa.h"
#include "geometry/bvh.h"

#include <string.h>

VPL_KERNEL_TABLE(DRAW, vplDrawHemiMapFcn, vplDrawHemiMap);
VPL_KERNEL_TABLE(FACTOR, vplHemiMapFactorFcn, vplHemiMapFactor);

static size_t texelsOf(int size)
{
    const size_t blocks = (size_t)vplHemiMap_Blocks(size);
    return blocks * blocks * VPL_LANES;
}

size_t vplHemiMaps_BytesPerMap(int size)
{
    return texelsOf(size) * sizeof(float) + sizeof(vplHemiMap);
}

vplResult vplHemiMaps_Create(vplContext* context, int size, int capacity, vplHemiMaps** mapsOut)
{
    if (size < 1 || size > VPL_MAX_SHADOW_MAP || capacity < 0) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "%d half-space maps of %d texels a side: must be 0 or more of [1, %d]", capacity, size,
                       VPL_MAX_SHADOW_MAP);
    }
    vplHemiMaps* maps = vplAllocZero(context, 1, sizeof *maps);
    vplHemiMap* list = vplAllocZero(context, (size_t)capacity, sizeof *list);
    float* texels = vplAlloc(context, (size_t)capacity, texelsOf(size) * sizeof *texels);
    if (maps == NULL || list == NULL || texels == NULL) {
        vplFree(context, maps);
        vplFree(context, list);
        vplFree(context, texels);
        return VPL_OUT_OF_MEMORY;
    }
    *maps =
        (vplHemiMaps){.maps = list, .capacity = capacity, .size = size, .texels = texels, .context = context};
    *mapsOut = maps;
    return VPL_SUCCESS;
}

void vplHemiMaps_Destroy(vplHemiMaps* maps)
{
    if (maps != NULL) {
        vplContext* context = maps->context;
        vplFree(context, maps->texels);
        vplFree(context, (void*)maps->maps);
        vplFree(context, maps);
    }
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
    float* texels = d->maps->texels + (size_t)index * texelsOf(map->size);
    memset(texels, 0, texelsOf(map->size) * sizeof *texels);
    DRAW[d->maps->context->isa](d->bvh, map, texels);
}

vplResult vplHemiMaps_Draw(vplHemiMaps* maps, const vplGeometry* geometry, const vplHemiMapPlace* places,
                           int count, vplProgressFcn* progress, void* user)
{
    if (count < 0 || count > maps->capacity) {
        return vplFail(maps->context, VPL_INVALID_ARGUMENT,
                       "%d half-space maps are asked for, there is room for %d", count, maps->capacity);
    }
    vplResult result = vplGeometry_PrepareRays(geometry);
    if (result != VPL_SUCCESS) {
        return result;
    }
    maps->count = count;
    vplHemiMap* list = (vplHemiMap*)maps->maps;
    for (int i = 0; i < count; i++) {
        vplHemiMap* map = &list[i];
        const float lift = vplLightLift(vplLargestOf(places[i].position));
        map->position = vplAdd(places[i].position, vplScale(lift, places[i].normal));
        map->forward = places[i].normal;
        vplTangentFrame(map->forward, &map->right, &map->up);
        map->size = maps->size;
        map->texels = maps->texels + (size_t)i * texelsOf(maps->size);
        map->context = maps->context;
    }
    Drawing drawing = {maps, geometry->rayTree};
    return vplParallelForProgress(maps->context, count, drawMap, &drawing, progress, user, 0, 1);
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
    FACTOR[map->context->isa](map, surface, factorOut);
}
