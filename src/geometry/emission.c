// SPDX-License-Identifier: MIT
// Based on: Matt Pharr, Wenzel Jakob and Greg Humphreys, Physically Based Rendering, 4th edition 2023,
// chapter 12, for the powers and the spot's falloff.
#include "geometry/emission.h"
#include "base/arena.h"
#include "geometry/triangle.h"
#include "math/scalar.h"
#include "math/vec.h"

vplRgb vplScaleRadiometric(double s, vplRgb c)
{
    const double most = 0x1.fffffep+127;
    double r = s * c.r, g = s * c.g, b = s * c.b;
    return (vplRgb){(float)(r < most ? r : most), (float)(g < most ? g : most), (float)(b < most ? b : most)};
}

// ---- spots

static void spotCosines(const vplEmitterDef* spot, double* inner, double* outer)
{
    double sine;
    vplSinCos(spot->innerAngle, &sine, inner);
    vplSinCos(spot->outerAngle, &sine, outer);
}

double vplSpot_Falloff(const vplEmitterDef* spot, double cosine)
{
    double inner, outer;
    spotCosines(spot, &inner, &outer);
    if (cosine >= inner) {
        return 1;
    }
    if (cosine <= outer) {
        return 0;
    }
    double x = (cosine - outer) / (inner - outer);
    return x * x * (3 - 2 * x);
}

// The smooth step is symmetric, so the ring between the two angles counts half.
double vplSpot_SolidAngle(const vplEmitterDef* spot)
{
    double inner, outer;
    spotCosines(spot, &inner, &outer);
    return 2 * VPL_PI * ((1 - inner) + (inner - outer) / 2);
}

double vplSpot_SampleCosine(const vplEmitterDef* spot, double u)
{
    double inner, outer;
    spotCosines(spot, &inner, &outer);
    double plain = 1 - inner, ring = (inner - outer) / 2;
    double at = u * (plain + ring);
    if (at <= plain || ring <= 0) {
        return 1 - at;
    }
    // In the ring the integral of the smooth step from the outer edge to x is x^3 - x^4/2. Bisection inverts
    // it to the last bit of a float, always along the same path.
    double wanted = (plain + ring - at) / (2 * ring), low = 0, high = 1;
    for (int i = 0; i < 30; i++) {
        double x = (low + high) / 2;
        *(x * x * x * (1 - x / 2) < wanted ? &low : &high) = x;
    }
    return outer + (low + high) / 2 * (inner - outer);
}

vplRgb vplEmitter_Intensity(const vplEmitterDef* emitter, vplVec3 direction)
{
    if (emitter->type != VPL_EMITTER_SPOT) {
        return emitter->intensity;
    }
    double cosine = vplDot(vplNormalize(emitter->direction), direction);
    return vplRgbScale((float)vplSpot_Falloff(emitter, cosine), emitter->intensity);
}

// ---- the list of sources

// The arrays of an emission while they are filled.
typedef struct Lister {
    vplEmissionSource* sources;
    double* sums;
    int count;
} Lister;

static void list(Lister* l, int emitter, int triangle, double factor, vplRgb light)
{
    double power = factor * vplRgbMean(light);
    if (power > 0) {
        l->sources[l->count] = (vplEmissionSource){emitter, triangle, vplScaleRadiometric(factor, light)};
        l->sums[l->count + 1] = l->sums[l->count] + power;
        l->count++;
    }
}

static vplRgb radianceOf(const vplGeometry* g, int triangle)
{
    return g->materials[g->triangleMaterials[triangle]].emission;
}

static void listSources(vplEmission* e, Lister* l)
{
    const vplGeometry* g = e->geometry;
    l->sums[0] = 0;
    for (int i = 0; i < e->emitterCount; i++) {
        const vplEmitterDef* emitter = &e->emitters[i];
        double factor = emitter->type == VPL_EMITTER_POINT  ? 4 * VPL_PI
                        : emitter->type == VPL_EMITTER_SPOT ? vplSpot_SolidAngle(emitter)
                                                            : VPL_PI * e->radius * e->radius;
        list(l, i, -1, factor, emitter->intensity);
    }
    if (g->environment != NULL) {
        const int before = l->count;
        list(l, -1, -1, VPL_PI * e->radius * e->radius, g->environment->irradiance);
        e->environment = l->count > before ? before : -1;
    }
    e->firstTriangle = l->count;
    for (int i = 0; g->emits && i < g->triangleCount; i++) {
        if (vplRgbMean(radianceOf(g, i)) > 0) {
            list(l, -1, i, VPL_PI * vplGeometry_TriangleArea(g, i), radianceOf(g, i));
        }
    }
    e->sourceCount = l->count;
}

static void coverGeometry(vplEmission* e)
{
    vplVec3 low = e->geometry->boundsMin, high = e->geometry->boundsMax;
    e->centre = vplScale(0.5f, vplAdd(low, high));
    double x = (double)high.x - low.x, y = (double)high.y - low.y, z = (double)high.z - low.z;
    e->radius = 0.5 * sqrt(x * x + y * y + z * z);
}

static vplResult fill(vplEmission* e, const vplEmitterDef* emitters)
{
    const vplGeometry* g = e->geometry;
    int capacity = e->emitterCount + (g->environment != NULL);
    for (int i = 0; g->emits && i < g->triangleCount; i++) {
        capacity += vplRgbMean(radianceOf(g, i)) > 0;
    }
    vplEmitterDef* copies = vplArena_Alloc(e->arena, (size_t)e->emitterCount, sizeof *copies);
    Lister lister = {.sources = vplArena_Alloc(e->arena, (size_t)capacity, sizeof *lister.sources),
                     .sums = vplArena_Alloc(e->arena, (size_t)capacity + 1, sizeof *lister.sums)};
    TRY(vplArena_Check(e->arena));
    for (int i = 0; i < e->emitterCount; i++) {
        copies[i] = emitters[i];
        copies[i].direction = vplNormalize(emitters[i].direction);
    }
    e->emitters = copies;
    e->sources = lister.sources;
    e->cumulative = lister.sums;
    coverGeometry(e);
    listSources(e, &lister);
    return VPL_SUCCESS;
}

vplResult vplEmission_Create(const vplGeometry* geometry, const vplEmitterDef* emitters, int emitterCount,
                             vplEmission** emissionOut)
{
    REQUIRE(CONTEXT_OF(geometry), geometry, emissionOut);
    REQUIRE_ARRAY(CONTEXT_OF(geometry), emitters, emitterCount);
    vplArena* arena = vplArena_Create(geometry->context);
    vplEmission* e = vplArena_AllocZero(arena, 1, sizeof *e);
    vplResult result = vplArena_Check(arena);
    if (result == VPL_SUCCESS) {
        *e = (vplEmission){.geometry = geometry,
                           .emitterCount = emitterCount,
                           .environment = -1,
                           .arena = arena,
                           .context = geometry->context};
        result = fill(e, emitters);
    }
    return vplArena_Deliver(arena, result, e, emissionOut);
}

void vplEmission_Destroy(vplEmission* emission)
{
    vplArena_Destroy(emission != NULL ? emission->arena : NULL);
}

double vplEmission_Area(const vplEmission* emission)
{
    if (emission == NULL) {
        return 0;
    }
    double area = 0;
    for (int i = emission->firstTriangle; i < emission->sourceCount; i++) {
        area += vplGeometry_TriangleArea(emission->geometry, emission->sources[i].triangle);
    }
    return area;
}

double vplEmission_Power(const vplEmission* emission)
{
    if (emission == NULL) {
        return 0;
    }
    return emission->cumulative[emission->sourceCount];
}

int vplEmission_Choose(const vplEmission* e, int first, double choice, double* restOut)
{
    const double* sums = e->cumulative;
    double start = sums[first], place = start + choice * (sums[e->sourceCount] - start);
    int low = first, high = e->sourceCount - 1; // sums[low] <= place < sums[high + 1], to rounding
    while (low < high) {
        int middle = low + (high - low) / 2;
        if (place < sums[middle + 1]) {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    while (low > first && sums[low + 1] == sums[low]) {
        low--; // skips sources too weak to change the sum; reached when `place` was rounded up to the total
    }
    double rest = (place - sums[low]) / (sums[low + 1] - sums[low]);
    *restOut = rest > 0 ? (rest < 1 ? rest : 0x1.fffffep-1) : 0;
    return low;
}
