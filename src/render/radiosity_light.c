// SPDX-License-Identifier: MIT
// One frame's light for patches: what emitters give to them, and what they then exchange.
#include "base/rng.h"
#include "geometry/triangle.h"
#include "radiosity/sides/side.h"
#include "render/history.h"
#include "render/radiosity.h"

#include <math.h>
#include <string.h>

enum { PATCH_LIGHT_STREAM = 0x706c6974, CHUNK_SIDES = 4096 };

static bool makeArrays(vplRadiosityState* s)
{
    const size_t count = (size_t)s->sides->count;
    vplRgb** const colours[] = {&s->direct, &s->source, &s->radiosity, &s->irradiance};
    bool made = true;
    for (size_t i = 0; i < sizeof colours / sizeof *colours; i++) {
        *colours[i] = vplAllocZero(s->context, count, sizeof(vplRgb));
        made = made && *colours[i] != NULL;
    }
    s->spread = vplAllocZero(s->context, count, sizeof(float));
    s->corners = vplAlloc(s->context, 2 * (size_t)s->mesh->vertexCount, sizeof(vplRgb));
    return made && s->spread != NULL && s->corners != NULL;
}

// ---- emitters' light

// Sides of one chunk, the points where their light is found, and what these get.
typedef struct Chunk {
    vplSurfacePoint* points;
    vplRgb* irradiance;
    int firstPoint[CHUNK_SIDES + 1];
} Chunk;

static int samplesOf(const vplRenderOptions* o)
{
    return o->patchLightSamples > 0                      ? o->patchLightSamples
           : o->formFactors == VPL_FORM_FACTORS_INCENTRE ? 1
                                                         : VPL_PATCH_CELLS;
}

// Points of `samples` open cells, spread evenly over their numbers; of one, the incentre where it can be reached.
static int placePoints(const vplRadiosityState* s, int side, int samples, uint64_t seed,
                       vplSurfacePoint* points)
{
    const vplPatchSide* p = &s->sides->sides[side];
    const int triangle = vplPatches_TriangleOf(s->patches, p->patch);
    const int open = __builtin_popcount(p->open), count = open < samples ? open : samples;
    for (int i = 0; i < count; i++) {
        const int k = vplPatchSide_OpenCell(p, (2 * i + 1) * open / (2 * count));
        const vplRandom4 r =
            vplRandomAt(seed, PATCH_LIGHT_STREAM, (uint64_t)side * VPL_PATCH_CELLS + (uint64_t)k);
        points[i] = (vplSurfacePoint){
            vplPatchSide_SampleCell(p, k, vplUnitFloat(r.v[0]), vplUnitFloat(r.v[1])), p->normal, triangle};
    }
    if (samples == 1 && open == VPL_PATCH_CELLS) {
        points[0].position = p->incentre;
    }
    return count;
}

static void sumSide(const Chunk* chunk, int i, vplRgb* meanOut, float* spreadOut)
{
    const int first = chunk->firstPoint[i], count = chunk->firstPoint[i + 1] - first;
    double sum[3] = {0, 0, 0}, squares = 0;
    for (int k = 0; k < count; k++) {
        const vplRgb e = chunk->irradiance[first + k];
        const double mean = ((double)e.r + e.g + e.b) / 3;
        sum[0] += (double)e.r;
        sum[1] += (double)e.g;
        sum[2] += (double)e.b;
        squares += mean * mean;
    }
    const double mean = (sum[0] + sum[1] + sum[2]) / (3 * count), variance = squares / count - mean * mean;
    *meanOut = (vplRgb){(float)(sum[0] / count), (float)(sum[1] / count), (float)(sum[2] / count)};
    *spreadOut = variance > 0 ? (float)sqrt(variance) : 0;
}

static vplResult lightChunk(vplJob* job, const vplShadeDef* def, vplRadiosityState* s, int first, int count,
                            Chunk* chunk)
{
    const int samples = samplesOf(&job->options);
    chunk->firstPoint[0] = 0;
    for (int i = 0; i < count; i++) {
        const int at = chunk->firstPoint[i];
        chunk->firstPoint[i + 1] =
            at + placePoints(s, first + i, samples, job->options.seed, chunk->points + at);
    }
    vplResult result = vplShadePoints(job->geometry, def, chunk->points, chunk->firstPoint[count],
                                      chunk->irradiance, &job->stats.rays);
    for (int i = 0; i < count && result == VPL_SUCCESS; i++) {
        sumSide(chunk, i, &s->direct[first + i], &s->spread[first + i]);
    }
    return result;
}

// Shadows by rays: of patches there are fewer than texels.
static vplResult lightSides(vplJob* job, vplRadiosityState* s)
{
    const int sides = s->sides->count < CHUNK_SIDES ? s->sides->count : CHUNK_SIDES;
    const size_t points = (size_t)sides * (size_t)samplesOf(&job->options);
    vplShadow* shadows = vplAllocZero(job->context, (size_t)job->emitterCount, sizeof *shadows);
    Chunk* chunk = vplAllocZero(job->context, 1, sizeof *chunk);
    vplResult result = shadows != NULL && chunk != NULL ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
    if (result == VPL_SUCCESS) {
        chunk->points = vplAlloc(job->context, points, sizeof *chunk->points);
        chunk->irradiance = vplAlloc(job->context, points, sizeof *chunk->irradiance);
        result = chunk->points != NULL && chunk->irradiance != NULL ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
    }
    const vplShadeDef def = {.lighting = VPL_LIGHTING_PHYSICAL,
                             .emitters = job->emitters,
                             .shadows = shadows,
                             .emitterCount = job->emitterCount};
    for (int first = 0; first < s->sides->count && result == VPL_SUCCESS; first += CHUNK_SIDES) {
        const int left = s->sides->count - first;
        result = lightChunk(job, &def, s, first, left < CHUNK_SIDES ? left : CHUNK_SIDES, chunk);
    }
    if (chunk != NULL) {
        vplFree(job->context, chunk->points);
        vplFree(job->context, chunk->irradiance);
    }
    vplFree(job->context, chunk);
    vplFree(job->context, shadows);
    return result;
}

static void findSource(vplRadiosityState* s)
{
    for (int i = 0; i < s->sides->count; i++) {
        const vplPatchSide* p = &s->sides->sides[i];
        s->source[i] = (vplRgb){p->emission.r + p->reflectance.r * s->direct[i].r,
                                p->emission.g + p->reflectance.g * s->direct[i].g,
                                p->emission.b + p->reflectance.b * s->direct[i].b};
    }
}

// ---- exchange

// Of a draft, which is not asked how fast light dies away either: solutions of drafts take a fifth of the time. With 0.01
// patches are not so well placed.
static const double DRAFT_RESIDUAL = 0.003;

// How fast light dies away is asked once: it depends on form factors alone, which are kept.
static vplResult solve(vplJob* job, vplRadiosityState* s, bool first)
{
    const vplRenderOptions* o = &job->options;
    const vplTransport transport = vplRadiosity_Transport(s);
    const vplSolveStats last = s->solve;
    vplSolveDef def = vplDefaultSolveDef();
    def.solver = s->links != NULL ? VPL_SOLVER_JACOBI : o->solver;
    def.iterations = o->iterations;
    def.residual = s->draft ? fmax(o->residual, DRAFT_RESIDUAL) : o->residual;
    def.spectrum = first && !s->draft;
    def.continues = o->history != NULL || s->draft;
    def.progress = vplJob_GetProgress(job);
    def.progressUser = job;
    vplResult result = vplSolveRadiosity(&transport, &def, s->source, s->radiosity, &s->solve);
    if (result == VPL_SUCCESS && !first) {
        s->solve.spectralRadius = last.spectralRadius;
        s->solve.rowSumMin = last.rowSumMin;
        s->solve.rowSumMean = last.rowSumMean;
        s->solve.rowSumMax = last.rowSumMax;
    }
    return result;
}

void vplRadiosity_FindReflected(const vplRadiosityState* s, vplRgb* reflectedOut)
{
    for (int i = 0; i < s->sides->count; i++) {
        const vplRgb b = s->radiosity[i], e = s->sides->sides[i].emission;
        reflectedOut[i] = (vplRgb){b.r - e.r, b.g - e.g, b.b - e.b};
    }
}

vplResult vplRadiosity_Receive(const vplRadiosityState* s, const vplRgb* sent, vplRgb* irradianceOut)
{
    const vplTransport transport = vplRadiosity_Transport(s);
    const vplResult result = vplGatherRadiosity(&transport, sent, irradianceOut);
    for (int i = 0; i < s->sides->count && result == VPL_SUCCESS; i++) {
        const vplRgb e = irradianceOut[i], d = s->direct[i];
        irradianceOut[i] = (vplRgb){e.r + d.r, e.g + d.g, e.b + d.b};
    }
    return result;
}

// What was reflected at least once arrives here; lamps' own light is direct.
static vplResult gather(vplRadiosityState* s)
{
    const vplTransport transport = vplRadiosity_Transport(s);
    const size_t count = (size_t)s->sides->count;
    vplRgb* reflected = vplAlloc(s->context, count, sizeof *reflected);
    if (reflected == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    vplRadiosity_FindReflected(s, reflected);
    vplResult result = vplGatherRadiosity(&transport, reflected, s->irradiance);
    vplFree(s->context, reflected);
    return result;
}

static vplResult keepEmitters(vplJob* job, vplRadiosityState* s)
{
    if (s->emitters == NULL) {
        s->emitters = vplAlloc(job->context, (size_t)job->emitterCount, sizeof *s->emitters);
    }
    for (int i = 0; s->emitters != NULL && i < job->emitterCount; i++) {
        s->emitters[i] = job->emitters[i];
    }
    return s->emitters != NULL ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
}

// The document's "slight lag": radiosities of the frame before are where this frame's sweeps begin.
static vplResult findLight(vplJob* job, vplRadiosityState* s, bool first)
{
    bool moved = first;
    for (int i = 0; i < job->emitterCount && !moved; i++) {
        moved = !vplIsSameEmitter(&s->emitters[i], &job->emitters[i]);
    }
    vplResult result = VPL_SUCCESS;
    if (moved) {
        vplJob_BeginStage(job, 0.65);
        result = lightSides(job, s);
        vplJob_EndStage(job, "patch light");
        findSource(s);
        if (result == VPL_SUCCESS) {
            result = keepEmitters(job, s);
        }
    }
    if (first || job->options.coherence == VPL_COHERENCE_OFF) {
        memcpy(s->radiosity, s->source, (size_t)s->sides->count * sizeof *s->source);
    }
    vplJob_BeginStage(job, 0.7);
    if (result == VPL_SUCCESS) {
        result = solve(job, s, first);
    }
    if (result == VPL_SUCCESS) {
        result = gather(s);
    }
    vplJob_EndStage(job, "solve");
    return result;
}

vplResult vplRadiosity_Light(vplJob* job, vplRadiosityState* s)
{
    const bool first = s->direct == NULL;
    vplResult result = !first || makeArrays(s) ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
    if (result == VPL_SUCCESS) {
        result = findLight(job, s, first);
    }
    vplJob_BeginStage(job, 0.71);
    if (result == VPL_SUCCESS) {
        result = vplPatchMesh_Interpolate(s->mesh, job->options.vertexWeight, s->irradiance, s->corners);
    }
    if (result == VPL_SUCCESS) {
        result = vplPatchMesh_Sharpen(s->mesh, job->options.vertexWeight, s->irradiance, job->options.sharpen,
                                      s->corners);
    }
    vplJob_EndStage(job, "corners");
    job->stats.solve = s->solve;
    return result;
}
