// SPDX-License-Identifier: MIT
// Particles that only mark where they come to.
// Based on: Alexander Keller, Instant Radiosity, SIGGRAPH 1997, for particles; departs in letting all go on, since they
// carry nothing: rooms behind rooms are met as often as can be.
#include "geometry/triangle.h"
#include "base/context.h"
#include "base/rng.h"
#include "math/sampling.h"
#include "math/scalar.h"
#include "math/vec.h"
#include "radiosity/open_cells.h"

enum {
    BATCH = 1024, // particles
    TASK = BATCH / VPL_REACH_PARTICLE_TASKS,
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

// Half of the particles take a source by its power, half all of them in turn: a lamp alone in its room may be the
// weakest.
static double chooseSource(const vplEmission* e, int64_t particle, float u)
{
    if (particle % 2 == 0) {
        return (double)u;
    }
    const int source = (int)(particle / 2 % e->sourceCount);
    return 0.5 * (e->cumulative[source] + e->cumulative[source + 1]) / e->cumulative[e->sourceCount];
}

// Where a particle leaves a surface light is, too. False where it starts under something.
static bool start(const vplReach* reach, const vplEmission* e, const vplParticle* p, int64_t* rays,
                  vplLanding* landing)
{
    const int triangle = e->sources[p->source].triangle;
    *landing = (vplLanding){p->ray.origin, p->normal, -1};
    if (triangle < 0) {
        return true;
    }
    landing->side = 2 * vplPatches_Find(reach->patches, triangle, p->ray.origin);
    return vplReach_Rise(reach, landing->side, p->ray.origin, rays, &landing->place);
}

static bool isBlack(const vplReach* reach, int side)
{
    const vplGeometry* g = reach->geometry;
    const int triangle = vplPatches_TriangleOf(reach->patches, side / 2);
    const vplRgb rho = g->materials[g->triangleMaterials[triangle]].diffuse;
    return !(rho.r > 0 || rho.g > 0 || rho.b > 0);
}

// Follows a particle from its first stop. Returns how many stops there are.
static int follow(const Batch* b, uint64_t particle, vplVec3 direction, vplLanding* stops, int64_t* rays)
{
    int count = 1;
    while (count < STOPS && vplReach_Land(b->reach, stops[count - 1].place, direction, rays, &stops[count]) &&
           !isBlack(b->reach, stops[count++].side)) {
        const vplRandom4 turn = vplRandomAt(b->reach->def->seed, STREAM, particle * STOPS + (uint64_t)count);
        direction =
            vplSampleCosineAround(stops[count - 1].normal, vplUnitFloat(turn.v[0]), vplUnitFloat(turn.v[1]));
    }
    return count;
}

// Points near edges may round to the wrong side of a wall, and all that follows is false: before a stop counts that is
// news, the way to it is gone again from place to place. Stops that are no news are dropped.
static void confirm(const vplReach* reach, vplLanding* stops, int count, int64_t* rays)
{
    for (int i = 0, sure = 0; i < count; i++) {
        if (stops[i].side < 0 || reach->open[stops[i].side] != 0) {
            stops[i].side = -1;
            continue;
        }
        while (sure < i && vplReach_IsFree(reach, stops[sure].place, stops[sure + 1].place, rays)) {
            sure++;
        }
        if (sure < i) {
            count = i; // that the others are seen from here is of no worth
            stops[i].side = -1;
        } else {
            vplReach_Settle(reach, &stops[i], rays);
        }
    }
    for (int i = count; i < STOPS; i++) {
        stops[i].side = -1;
    }
}

static void shoot(const Batch* b, int index, int64_t* rays)
{
    const uint64_t seed = b->reach->def->seed, particle = (uint64_t)(b->first + index);
    vplLanding* stops = &b->landings[(size_t)index * STOPS];
    const vplRandom4 r = vplRandomAt(seed, STREAM, particle * STOPS),
                     more = vplRandomAt(seed, STREAM + 1, particle);
    const float u[4] = {vplUnitFloat(r.v[0]), vplUnitFloat(r.v[1]), vplUnitFloat(r.v[2]),
                        vplUnitFloat(r.v[3])};
    const double choice = chooseSource(b->emission, (int64_t)particle, vplUnitFloat(more.v[0]));
    vplParticle p;
    int count = 0;
    if (vplEmission_SampleParticle(b->emission, choice, u, &p) &&
        start(b->reach, b->emission, &p, rays, &stops[0])) {
        count = follow(b, particle, p.ray.direction, stops, rays);
    }
    confirm(b->reach, stops, count, rays);
}

static void shootSome(void* data, int task, int worker)
{
    (void)worker;
    const Batch* b = data;
    int64_t rays = 0;
    for (int i = task * TASK; i < (task + 1) * TASK; i++) {
        shoot(b, i, &rays);
    }
    b->reach->taskRays[task] = rays;
}

// In the order of particles. Returns how many sides are new.
static int markAll(const Batch* b)
{
    vplReach* reach = b->reach;
    int fresh = 0;
    for (int i = 0; i < BATCH * STOPS; i++) {
        const vplLanding* landing = &b->landings[i];
        if (landing->side >= 0 && reach->open[landing->side] == 0) {
            reach->known[landing->side] = landing->place;
            reach->open[landing->side] = 0xffff;
            fresh++;
        }
    }
    for (int i = 0; i < VPL_REACH_PARTICLE_TASKS; i++) {
        reach->rays += reach->taskRays[i];
    }
    return fresh;
}

// Particles go on while each finds a side that is new, and until each source had its turn, be it one of 2^18. The rest is
// cheaper for vplReach_Explore: four rays find most sides in the light, and a particle takes twice as many.
vplResult vplReach_ShootParticles(vplReach* reach)
{
    const vplEmission* emission = reach->emission;
    const int turns = 1 + 2 * vplMini(emission->sourceCount, 1 << 18) / BATCH;
    const int most = vplMaxi(turns, 1 + 2 * reach->patches->patchCount / BATCH);
    Batch b = {.reach = reach, .emission = emission};
    b.landings = vplAlloc(reach->context, (size_t)BATCH * STOPS, sizeof *b.landings);
    vplResult result = b.landings ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
    for (int i = 0, fresh = BATCH; i < most && result == VPL_SUCCESS && (i < turns || fresh >= BATCH); i++) {
        b.first = (int64_t)i * BATCH;
        result = vplParallelForProgress(reach->context, VPL_REACH_PARTICLE_TASKS, shootSome, &b,
                                        reach->def->progress, reach->def->progressUser, 0.3 * i / most,
                                        0.3 * (i + 1) / most);
        if (result == VPL_SUCCESS) {
            fresh = markAll(&b);
        }
    }
    vplFree(reach->context, b.landings);
    return result;
}
