// SPDX-License-Identifier: MIT
// Paraboloid maps, many at once: one task draws one hemisphere.
// Based on: Wolfgang Heidrich and Hans-Peter Seidel, View-independent Environment Maps, Graphics Hardware
// 1998.
#include "visibility/paraboloid_map.h"
#include "base/arena.h"
#include "geometry/bvh.h"
#include "geometry/cut_outs.h"
#include "geometry/triangle.h"
#include "visibility/kernels.h"

bool vplParaboloid_Project(vplVec3 direction, double* x, double* y)
{
    const double dx = (double)direction.x, dy = (double)direction.y, dz = (double)direction.z;
    // The largest component is brought to 1, so that no square underflows or overflows.
    const double largest = fmax(fabs(dx), fmax(fabs(dy), fabs(dz)));
    if (!(largest > 0) || !isfinite(dx + dy + dz)) {
        return false;
    }
    const double a = dx / largest, b = dy / largest, c = dz / largest;
    const double across = a * a + b * b, length = sqrt(across + c * c);
    if (!(across > 0) && c < 0) {
        return false;
    }
    // 1 / (|d| + z); behind the plane the difference would cancel, and (|d| - z) / (|d|^2 - z^2) does not.
    const double scale = c >= 0 ? 1 / (length + c) : (length - c) / across;
    *x = a * scale;
    *y = b * scale;
    return true;
}

vplVec3 vplParaboloid_Unproject(double x, double y)
{
    const double r2 = x * x + y * y, scale = 1 / (1 + r2);
    return (vplVec3){(float)(2 * x * scale), (float)(2 * y * scale), (float)((1 - r2) * scale)};
}

double vplParaboloid_Weight(double x, double y)
{
    const double r2 = x * x + y * y, s = 1 + r2;
    return r2 < 1 ? 4 * (1 - r2) / (s * s * s) : 0;
}

vplResult vplParaboloidMaps_Create(vplContext* context, int size, int capacity, bool triangles,
                                   vplParaboloidMaps** mapsOut)
{
    REQUIRE(context, context, mapsOut);
    if (size < 1 || size > VPL_MAX_SHADOW_MAP || capacity < 0) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "%d paraboloid maps of %d texels a side: must be 0 or more of [1, %d]", capacity, size,
                       VPL_MAX_SHADOW_MAP);
    }
    const size_t texels = 2 * vplParaboloidMap_Texels(size);
    vplArena* arena = vplArena_Create(context);
    vplParaboloidMaps* maps = vplArena_Alloc(arena, 1, sizeof *maps);
    vplParaboloidMaps made = {.capacity = capacity, .size = size, .context = context, .arena = arena};
    made.maps = vplArena_AllocZero(arena, (size_t)capacity, sizeof *made.maps);
    made.texels = vplArena_Alloc(arena, (size_t)capacity, texels * sizeof *made.texels);
    if (triangles) {
        made.triangles = vplArena_Alloc(arena, (size_t)capacity, texels * sizeof *made.triangles);
    }
    made.scratch = vplArena_Alloc(arena, (triangles ? 2 : 1) * (size_t)context->workerCount,
                                  vplHemiMap_Texels(size) * sizeof *made.scratch);
    const vplResult result = vplArena_Check(arena);
    if (result == VPL_SUCCESS) {
        *maps = made;
    }
    return vplArena_Deliver(arena, result, maps, mapsOut);
}

void vplParaboloidMaps_Destroy(vplParaboloidMaps* maps)
{
    vplArena_Destroy(maps != NULL ? maps->arena : NULL);
}

typedef struct Drawing {
    const vplParaboloidMaps* maps;
    const vplBvh* bvh;
} Drawing;

// All front hemispheres come first: these are always drawn, so that workers end at about the same time.
static void drawHemisphere(void* data, int index, int worker)
{
    const Drawing* d = data;
    const vplParaboloidMaps* maps = d->maps;
    const int hemisphere = index / maps->count, which = index % maps->count;
    const vplParaboloidMap* map = &maps->maps[which];
    if (hemisphere >= map->hemispheres) {
        return;
    }
    const size_t first = (2 * (size_t)which + (size_t)hemisphere) * vplParaboloidMap_Texels(map->size);
    const size_t drawn = vplHemiMap_Texels(map->size);
    const bool ids = maps->triangles != NULL;
    float* scratch = maps->scratch + (ids ? 2 : 1) * (size_t)worker * drawn;
    vplVisibilityKernels_Get(map->context->isa)
        ->drawParaboloid(d->bvh, map, hemisphere,
                         (vplParaboloidTexels){scratch, ids ? (int32_t*)(scratch + drawn) : NULL},
                         (vplParaboloidTexels){maps->texels + first, ids ? maps->triangles + first : NULL});
}

static void place(const vplParaboloidMaps* maps, int index, const vplParaboloidPlace* p)
{
    vplParaboloidMap* map = &maps->maps[index];
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
    REQUIRE(CONTEXT_OF(maps) ?: CONTEXT_OF(geometry), maps, geometry);
    REQUIRE_ARRAY(CONTEXT_OF(maps) ?: CONTEXT_OF(geometry), places, count);
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
    Drawing drawing = {maps, geometry->rayTree};
    if (drawing.bvh == NULL) {
        return vplFail(maps->context, VPL_INVALID_ARGUMENT,
                       "these maps are drawn through the ray tree; call vplGeometry_BuildRayTree first");
    }
    maps->count = count;
    for (int i = 0; i < count; i++) {
        place(maps, i, &places[i]);
    }
    return vplParallelForProgress(maps->context, 2 * count, drawHemisphere, &drawing,
                                  (vplProgressRange){progress, user, 0, 1});
}

bool vplParaboloidMap_GetHit(const vplParaboloidMap* map, const vplGeometry* geometry,
                             vplParaboloidTexel texel, vplHit* hitOut, vplVec3* directionOut)
{
    const double x = (2 * texel.column + 1.0) / map->size - 1, y = (2 * texel.row + 1.0) / map->size - 1;
    if (texel.hemisphere >= map->hemispheres || !(x * x + y * y <= 1)) {
        return false;
    }
    const size_t at = (size_t)texel.hemisphere * vplParaboloidMap_Texels(map->size) +
                      vplParaboloidMap_Place(map->size, texel.column, texel.row);
    const int triangle = map->triangles[at];
    const vplVec3 d = vplParaboloid_Unproject(x, y);
    const vplVec3 direction = vplAdd(vplAdd(vplScale(d.x, map->right), vplScale(d.y, map->up)),
                                     vplScale(texel.hemisphere == 0 ? d.z : -d.z, map->forward));
    const vplRay ray = {map->position, direction, {0, 0}};
    if (geometry->cutOuts != NULL && // the map shows what is solid
        vplCutOuts_ClosestHit(geometry, &ray, triangle < 0 ? INFINITY : 1 / map->texels[at], hitOut)) {
        *directionOut = direction;
        return true;
    }
    if (triangle < 0) {
        return false;
    }
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
    vplVisibilityKernels_Get(map->context->isa)->paraboloidFactor(map, surface, factorOut);
}

float vplParaboloidMap_Factor(const vplParaboloidMap* map, vplVec3 position, vplVec3 normal)
{
    const vplSurface surface = vplSurface_OfPoint(position, normal);
    float factor[VPL_LANES];
    vplParaboloidMap_FactorBlock(map, &surface, factor);
    return factor[0];
}
