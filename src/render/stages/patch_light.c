// SPDX-License-Identifier: MIT
// The direct light of patches, which emitters send.
#include "base/rng.h"
#include "geometry/triangle.h"
#include "math/scalar.h"
#include "radiosity/sides/side.h"
#include "render/stages/make.h"
#include "render/stages/results.h"

#include <math.h>

// Sets of points in a chunk, and the most that take the place of a group's first set.
enum { PATCH_LIGHT_STREAM = 0x706c6974, CHUNK_SETS = 4096, MOST_SETS = 64 };

// A set of points on a side.
typedef struct PointSet {
    int side, number; // each number draws other points
} PointSet;

// Sets of one chunk, their points, and what these receive.
typedef struct Chunk {
    vplSurfacePoint* points;
    vplRgb* irradiance;
    vplPatchLight* light; // of all sides
    int room;             // for sets
    int firstPoint[CHUNK_SETS + 1];
} Chunk;

// Places one point in each of `samples` open cells, spread evenly over their numbers. A single point is the
// incentre if all cells are open. Returns the number of points.
static int placePoints(const vplRun* run, PointSet set, int samples, vplSurfacePoint* points)
{
    const vplPatchSides* sides = run->results[VPL_STAGE_SIDES];
    const vplPatchSide* p = &sides->sides[set.side];
    const int open = __builtin_popcount(p->open), count = open < samples ? open : samples;
    for (int i = 0; i < count; i++) {
        const int k = vplPatchSide_OpenCell(p, (2 * i + 1) * open / (2 * count));
        const vplRandom4 r = vplRandomAt(run->plan->options.seed, PATCH_LIGHT_STREAM + (uint32_t)set.number,
                                         (uint64_t)set.side * VPL_PATCH_CELLS + (uint64_t)k);
        const vplSidePoint at =
            vplPatchSide_SampleCell(sides, p, k, vplUnitFloat(r.v[0]), vplUnitFloat(r.v[1]));
        points[i] = (vplSurfacePoint){at.at, at.normal, at.triangle};
    }
    if (samples == 1 && open == VPL_PATCH_CELLS && !vplPatches_IsGroup(sides->patches, p->patch)) {
        points[0].position = p->incentre;
    }
    return count;
}

// Makes a mean over `before` values one over these and one more.
static void addToMean(vplRgb* mean, int before, vplRgb value)
{
    const float n = (float)(before + 1);
    if (before == 0) {
        *mean = value; // exactly
        return;
    }
    mean->r += (value.r - mean->r) / n;
    mean->g += (value.g - mean->g) / n;
    mean->b += (value.b - mean->b) / n;
}

// Keeps the light of each open cell; where they have no point each, the side's own.
static void keepCells(const vplPatchSide* side, const vplRgb* irradiance, int count, vplRgb mean, int before,
                      vplRgb* cells)
{
    const int open = __builtin_popcount(side->open);
    for (int k = 0; k < VPL_PATCH_CELLS && before == 0; k++) {
        cells[k] = mean;
    }
    for (int i = 0; i < count && count == open; i++) {
        addToMean(&cells[vplPatchSide_OpenCell(side, i)], before, irradiance[i]);
    }
}

static void sumSet(const Chunk* chunk, int i, vplRgb* meanOut, float* spreadOut)
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

// Set 0 gives the light of a side and its spread. Where more sets follow, the light is the mean of those from set 1 on.
static void keepSet(const vplPatchSides* sides, const Chunk* chunk, int i, PointSet set)
{
    vplPatchLight* light = chunk->light;
    const int first = chunk->firstPoint[i], before = set.number > 1 ? set.number - 1 : 0;
    vplRgb mean;
    float spread;
    sumSet(chunk, i, &mean, &spread);
    addToMean(&light->direct[set.side], before, mean);
    light->spread[set.side] = set.number == 0 ? spread : light->spread[set.side];
    if (light->cells != NULL) {
        keepCells(&sides->sides[set.side], chunk->irradiance + first, chunk->firstPoint[i + 1] - first, mean,
                  before, light->cells + (size_t)set.side * VPL_PATCH_CELLS);
    }
}

static vplResult lightChunk(const vplRun* run, const vplShadeDef* def, const PointSet* sets, int count,
                            Chunk* chunk)
{
    chunk->firstPoint[0] = 0;
    for (int i = 0; i < count; i++) {
        const int at = chunk->firstPoint[i];
        chunk->firstPoint[i + 1] =
            at + placePoints(run, sets[i], run->plan->options.radiosity.lightSamples, chunk->points + at);
    }
    TRY(vplShadePoints(run->results[VPL_STAGE_GEOMETRY], def, chunk->points, chunk->firstPoint[count],
                       chunk->irradiance, &run->stats->rays));
    for (int i = 0; i < count; i++) {
        keepSet(run->results[VPL_STAGE_SIDES], chunk, i, sets[i]);
    }
    return VPL_SUCCESS;
}

static vplResult lightSets(const vplRun* run, const vplShadeDef* def, const PointSet* sets, int count,
                           Chunk* chunk)
{
    for (int first = 0; first < count; first += chunk->room) {
        TRY(lightChunk(run, def, sets + first, vplMini(count - first, chunk->room), chunk));
    }
    return VPL_SUCCESS;
}

// ---- groups
//
// The light of a lamp differs over a group more than over a triangle. With one set of points for each side, all of Sibenik had 0.960 to
// 0.995 of the lamp's light (three seeds, 5,000 patches), and the picture followed. So the first set only tells where light differs. Each
// side of a group then gets a new set, and as many sets as there are such sides are shared out in proportion to area times spread, which
// leaves the least variance (Neyman, 1934). If the first set stayed in the mean, sides whose light it missed would have too little.

// The number of sets that take the place of the first one on a side.
static int countSets(const vplPatchSides* sides, const vplPatchLight* light, int side, double share)
{
    const vplPatchSide* p = &sides->sides[side];
    if (!vplPatches_IsGroup(sides->patches, p->patch)) {
        return 0;
    }
    const double more = share * (double)p->area * (double)light->spread[side];
    return 1 + (int)(more < MOST_SETS - 1 ? more : MOST_SETS - 1);
}

// The number of sets that are shared out, over the sum of area times spread of all sides of groups. 0: no side's light differs.
static double findShare(const vplPatchSides* sides, const vplPatchLight* light)
{
    double spread = 0;
    int groups = 0;
    for (int i = 0; i < sides->count; i++) {
        const bool group = vplPatches_IsGroup(sides->patches, sides->sides[i].patch);
        spread += group ? (double)sides->sides[i].area * (double)light->spread[i] : 0;
        groups += group;
    }
    return spread > 0 ? groups / spread : 0;
}

static vplResult lightGroups(const vplRun* run, const vplShadeDef* def, Chunk* chunk)
{
    const vplPatchSides* sides = run->results[VPL_STAGE_SIDES];
    const vplPatchLight* light = chunk->light;
    const double share = findShare(sides, light);
    int count = 0;
    for (int i = 0; i < sides->count && share > 0; i++) {
        count += countSets(sides, light, i, share);
    }
    PointSet* sets = vplArena_Alloc(run->scratch, (size_t)count, sizeof *sets);
    TRY(vplArena_Check(run->scratch));
    for (int i = 0, at = 0; i < sides->count && share > 0; i++) {
        const int ofSide = countSets(sides, light, i, share);
        for (int k = 1; k <= ofSide; k++) {
            sets[at++] = (PointSet){i, k};
        }
    }
    return lightSets(run, def, sets, count, chunk);
}

// Casts shadows by rays, because there are fewer patches than shadow maps have texels.
static vplResult lightSides(const vplRun* run, int sideCount, vplPatchLight* light)
{
    const int room = vplMini(sideCount, CHUNK_SETS);
    const size_t points = (size_t)room * (size_t)run->plan->options.radiosity.lightSamples;
    Chunk* chunk = vplArena_AllocZero(run->scratch, 1, sizeof *chunk);
    PointSet* sets = vplArena_Alloc(run->scratch, (size_t)sideCount, sizeof *sets);
    vplSurfacePoint* places = vplArena_Alloc(run->scratch, points, sizeof *places);
    vplRgb* irradiance = vplArena_Alloc(run->scratch, points, sizeof *irradiance);
    TRY(vplArena_Check(run->scratch));
    *chunk = (Chunk){.points = places, .irradiance = irradiance, .light = light, .room = room};
    // The points of a side share their noise, so few choices at each of them are enough.
    const int samples = run->plan->options.radiosity.lightSamples;
    const int chosen = (run->plan->emittersPerPoint + samples - 1) / samples;
    const vplAreaLights* area = run->results[VPL_STAGE_AREA_LIGHTS];
    const int sky = area != NULL ? area->skyCount : 0; // area lights are patches that emit
    vplShadeDef def = vplDefaultShadeDef();
    def.emitters = run->plan->emitters;
    def.emitterCount = run->plan->emitterCount;
    def.emittersPerPoint = chosen;
    def.emitterTrees = run->results[VPL_STAGE_EMITTER_TREES];
    def.areaLights = sky > 0 ? area->lights + (area->count - sky) : NULL;
    def.areaLightCount = sky;
    for (int i = 0; i < sideCount; i++) {
        sets[i] = (PointSet){i, 0};
    }
    TRY(lightSets(run, &def, sets, sideCount, chunk));
    return lightGroups(run, &def, chunk);
}

static void findSource(const vplPatchSides* sides, vplPatchLight* light)
{
    for (int i = 0; i < sides->count; i++) {
        const vplPatchSide* p = &sides->sides[i];
        const vplRgb d = light->direct[i];
        light->source[i] =
            (vplRgb){p->emission.r + p->reflectance.r * d.r, p->emission.g + p->reflectance.g * d.g,
                     p->emission.b + p->reflectance.b * d.b};
    }
}

vplResult vplMakePatchLight(const vplRun* run, void** resultOut)
{
    const vplPatchSides* sides = run->results[VPL_STAGE_SIDES];
    const size_t count = (size_t)sides->count;
    vplPatchLight* light = vplArena_Alloc(run->arena, 1, sizeof *light);
    vplRgb* direct = vplArena_AllocZero(run->arena, count, sizeof *direct);
    float* spread = vplArena_AllocZero(run->arena, count, sizeof *spread);
    vplRgb* source = vplArena_AllocZero(run->arena, count, sizeof *source);
    const size_t cellCount = run->plan->gathers && !run->draft ? count * VPL_PATCH_CELLS : 0;
    vplRgb* cells = vplArena_Alloc(run->arena, cellCount, sizeof *cells);
    TRY(vplArena_Check(run->arena));
    *light = (vplPatchLight){direct, spread, source, cellCount > 0 ? cells : NULL};
    *resultOut = light;
    TRY(lightSides(run, sides->count, light));
    findSource(sides, light);
    return VPL_SUCCESS;
}
