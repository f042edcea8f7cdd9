// SPDX-License-Identifier: MIT
// Particles that only mark where they come to.
// Based on: Alexander Keller, Instant Radiosity, SIGGRAPH 1997, for particles; departs in letting all go on, since they
// carry nothing: rooms behind rooms are met as often as can be.
#include "base/context.h"
#include "base/rng.h"
#include "math/sampling.h"
#include "math/scalar.h"
#include "radiosity/cells.h"
#include "radiosity/open_cells.h"

enum {
    BATCH = 4096, // particles
    TASK = 64,    // particles
    BOUNCES = 8,
    STOPS = BOUNCES + 1, // one at the start of those that leave a surface
    STREAM = 0x5ead0001  // of random numbers
};

typedef struct Batch {
    vplReach* reach;
    const vplEmission* emission;
    vplLanding* landings; // [particle][stop]
    int64_t first;        // particle
} Batch;

// Half of the particles take a source by its power, half any: a lamp alone in its room may be the weakest.
static double chooseSource(const vplEmission* e, int64_t particle, float u)
{
    if (particle % 2 == 0) {
        return (double)u;
    }
    const int source = vplMini((int)((double)u * e->sourceCount), e->sourceCount - 1);
    return 0.5 * (e->cumulative[source] + e->cumulative[source + 1]) / e->cumulative[e->sourceCount];
}

// Where a particle leaves a surface light is, too.
static bool markStart(const vplReach* reach, const vplEmission* e, const vplParticle* p, int64_t* rays,
                      vplLanding* start)
{
    const int triangle = e->sources[p->source].triangle;
    vplVec3 corners[3];
    start->place = p->ray.origin;
    start->side = -1;
    if (triangle < 0) {
        return true;
    }
    const int patch = vplPatches_Find(reach->patches, triangle, p->ray.origin);
    vplSide_GetCorners(reach->patches, patch, false, corners);
    start->cell = vplCell_Find(corners, p->ray.origin);
    start->normal = p->normal;
    if (!vplReach_Rise(reach, 2 * patch, p->ray.origin, rays, &start->place)) {
        return false;
    }
    start->side = 2 * patch;
    return true;
}

static bool isBlack(const vplReach* reach, int side)
{
    const vplGeometry* g = reach->geometry;
    const int triangle = reach->patches->nodes[reach->patches->patches[side / 2]].triangle;
    const vplRgb rho = g->materials[g->triangleMaterials[triangle]].diffuse;
    return !(rho.r > 0 || rho.g > 0 || rho.b > 0);
}

static void follow(const Batch* b, int index, int64_t* rays)
{
    const vplReach* reach = b->reach;
    const uint64_t seed = reach->def->seed, particle = (uint64_t)(b->first + index);
    vplLanding* stops = &b->landings[(size_t)index * STOPS];
    const vplRandom4 r = vplRandomAt(seed, STREAM, particle * STOPS),
                     more = vplRandomAt(seed, STREAM + 1, particle);
    const float u[4] = {vplUnitFloat(r.v[0]), vplUnitFloat(r.v[1]), vplUnitFloat(r.v[2]),
                        vplUnitFloat(r.v[3])};
    const double choice = chooseSource(b->emission, b->first + index, vplUnitFloat(more.v[0]));
    vplParticle p;
    for (int i = 0; i < STOPS; i++) {
        stops[i].side = -1;
    }
    if (!vplEmission_SampleParticle(b->emission, choice, u, &p) ||
        !markStart(reach, b->emission, &p, rays, &stops[0])) {
        return;
    }
    vplVec3 direction = p.ray.direction;
    for (int i = 1; i < STOPS; i++) {
        vplLanding next;
        if (!vplReach_Land(reach, stops[i - 1].place, direction, rays, &next)) {
            return;
        }
        stops[i] = next;
        if (isBlack(reach, next.side)) {
            return;
        }
        const vplRandom4 turn = vplRandomAt(seed, STREAM, particle * STOPS + (uint64_t)i);
        direction = vplSampleCosineAround(next.normal, vplUnitFloat(turn.v[0]), vplUnitFloat(turn.v[1]));
    }
}

static void followSome(void* data, int task, int worker)
{
    (void)worker;
    const Batch* b = data;
    int64_t rays = 0;
    for (int i = task * TASK; i < (task + 1) * TASK; i++) {
        follow(b, i, &rays);
    }
    b->reach->taskRays[task] = rays;
}

// In the order of particles. Returns how many sides are new, and the number of landings.
static int markAll(const Batch* b, int* landingsOut)
{
    vplReach* reach = b->reach;
    int fresh = 0, landings = 0;
    for (int i = 0; i < BATCH * STOPS; i++) {
        const vplLanding* landing = &b->landings[i];
        if (landing->side >= 0) {
            fresh += reach->open[landing->side] == 0;
            landings++;
            vplReach_Mark(reach, landing);
        }
    }
    for (int i = 0; i < BATCH / TASK; i++) {
        reach->rays += reach->taskRays[i];
    }
    *landingsOut = landings;
    return fresh;
}

// Particles find quickly what is easily found: batches go on while one landing in 128 is on a side not met before. The
// rest is what vplReach_Explore is cheaper for.
vplResult vplReach_ShootParticles(vplReach* reach, const vplEmission* emission)
{
    const int most = 1 + reach->patches->patchCount / (BATCH / 4);
    Batch b = {.reach = reach, .emission = emission};
    b.landings = vplAlloc(reach->context, (size_t)BATCH * STOPS, sizeof *b.landings);
    vplResult result = b.landings ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
    for (int i = 0, fresh = 1, landings = 1;
         i < most && result == VPL_SUCCESS && fresh * 128LL >= landings && landings > 0; i++) {
        b.first = (int64_t)i * BATCH;
        result = vplParallelForProgress(reach->context, BATCH / TASK, followSome, &b, reach->def->progress,
                                        reach->def->progressUser, 0.5 * i / most, 0.5 * (i + 1) / most);
        if (result == VPL_SUCCESS) {
            fresh = markAll(&b, &landings);
        }
    }
    vplFree(reach->context, b.landings);
    return result;
}
