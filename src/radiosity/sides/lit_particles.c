// SPDX-License-Identifier: MIT
// Particles that mark the sides they hit.
// Based on: Alexander Keller, Instant Radiosity, SIGGRAPH 1997 (the particles). Departs: particles carry
// nothing, so that all go on after a hit and come as far as possible into rooms behind rooms.
#include "base/context.h"
#include "base/rng.h"
#include "geometry/triangle.h"
#include "math/sampling.h"
#include "math/scalar.h"
#include "math/vec.h"
#include "radiosity/sides/lit_search.h"
#include "radiosity/sides/side.h"

enum {
    BATCH = 1024, // particles
    TASK = BATCH / VPL_LIT_PARTICLE_TASKS,
    BOUNCES = 8,
    VERTICES = BOUNCES + 1, // of a path; the first is its start
    STREAM = 0x5ead0001     // of random numbers
};

typedef struct Batch {
    vplLitSearch* search;
    vplLitHit* vertices; // [particle][VERTICES]
    int64_t first;       // particle
} Batch;

// Even particles choose a light source by its power, odd ones take the sources in turn: the only light of a
// room may be the weakest of all.
static double chooseSource(const vplEmission* e, int64_t particle, float u)
{
    if (particle % 2 == 0) {
        return (double)u;
    }
    const int source = (int)(particle / 2 % e->sourceCount);
    return 0.5 * (e->cumulative[source] + e->cumulative[source + 1]) / e->cumulative[e->sourceCount];
}

// The first vertex of a path; it is on a side if a surface emits the particle. False if something covers that
// surface.
static bool start(const vplLitSearch* s, const vplParticle* p, int64_t* rays, vplLitHit* vertex)
{
    const int triangle = s->emission->sources[p->source].triangle;
    *vertex = (vplLitHit){.point = p->position, .normal = p->normal, .side = -1, .triangle = triangle};
    if (triangle < 0) {
        return true;
    }
    vertex->side = 2 * vplPatches_Find(s->patches, triangle, p->position);
    return vplLitSearch_Offset(s, vertex->side, triangle, p->position, rays, &vertex->point);
}

static bool isBlack(const vplLitSearch* s, int triangle)
{
    const vplRgb rho = vplReflectanceOfTriangle(s->geometry, triangle);
    return !(rho.r > 0 || rho.g > 0 || rho.b > 0);
}

// Traces a path from its first vertex. Returns how many vertices there are.
static int tracePath(const Batch* b, uint64_t particle, vplVec3 direction, vplLitHit* path, int64_t* rays)
{
    int count = 1;
    while (count < VERTICES &&
           vplLitSearch_Trace(b->search, path[count - 1].point, direction, rays, &path[count]) &&
           !isBlack(b->search, path[count++].triangle)) {
        const vplRandom4 r = vplRandomAt(b->search->def->seed, STREAM, particle * VERTICES + (uint64_t)count);
        direction = vplSampleCosineAround(path[count - 1].normal, vplUnitFloat(r.v[0]), vplUnitFloat(r.v[1]));
    }
    return count;
}

// Finds the vertices on sides that are not lit yet. A hit near an edge may round to the wrong side of a wall, which makes the rest
// of the path wrong, so each segment up to a new side is tested again between offset points, and the rest is dropped.
static void confirm(const vplLitSearch* s, vplLitHit* path, int count, int64_t* rays)
{
    for (int i = 0, sure = 0; i < count; i++) {
        path[i].isSure = false;
        if (path[i].side < 0 || s->open[path[i].side] != 0) {
            continue;
        }
        while (sure < i && vplLitSearch_IsVisible(s, path[sure].point, path[sure + 1].point, rays)) {
            sure++;
        }
        if (sure < i) {
            count = i;
        } else {
            vplLitSearch_ResolveOverlap(s, &path[i], rays);
            path[i].isSure = true;
        }
    }
    for (int i = count; i < VERTICES; i++) {
        path[i].side = -1;
    }
}

static void shoot(const Batch* b, int index, int64_t* rays)
{
    const uint64_t seed = b->search->def->seed, particle = (uint64_t)(b->first + index);
    vplLitHit* path = &b->vertices[(size_t)index * VERTICES];
    const vplRandom4 r = vplRandomAt(seed, STREAM, particle * VERTICES),
                     more = vplRandomAt(seed, STREAM + 1, particle);
    const float u[4] = {vplUnitFloat(r.v[0]), vplUnitFloat(r.v[1]), vplUnitFloat(r.v[2]),
                        vplUnitFloat(r.v[3])};
    const double choice = chooseSource(b->search->emission, (int64_t)particle, vplUnitFloat(more.v[0]));
    vplParticle p;
    int count = 0;
    if (vplEmission_SampleParticle(b->search->emission, choice, u, &p) &&
        start(b->search, &p, rays, &path[0])) {
        count = tracePath(b, particle, p.ray.direction, path, rays);
    }
    confirm(b->search, path, count, rays);
}

static void shootTask(void* data, int task, int worker)
{
    (void)worker;
    const Batch* b = data;
    int64_t rays = 0;
    for (int i = task * TASK; i < (task + 1) * TASK; i++) {
        shoot(b, i, &rays);
    }
    b->search->taskRays[task] = rays;
}

// Marks sides as lit, in the order of particles. Returns how many are new.
static int markLit(const Batch* b)
{
    vplLitSearch* s = b->search;
    int added = 0;
    for (int i = 0; i < BATCH * VERTICES; i++) {
        const vplLitHit* hit = &b->vertices[i];
        if (hit->side < 0) {
            continue;
        }
        s->hits[hit->side] += i % VERTICES > 0; // the first vertex is a start, not a hit
        if (hit->isSure && s->open[hit->side] == 0) {
            s->litPoint[hit->side] = hit->point;
            s->open[hit->side] = VPL_ALL_CELLS;
            added++;
        }
    }
    for (int i = 0; i < VPL_LIT_PARTICLE_TASKS; i++) {
        s->rays += s->taskRays[i];
    }
    return added;
}

static vplResult shootBatches(Batch* b)
{
    vplLitSearch* s = b->search;
    const int turns = 1 + 2 * vplMini(s->emission->sourceCount, 1 << 18) / BATCH;
    const int most = vplMaxi(turns, 1 + 2 * s->patches->patchCount / BATCH);
    for (int i = 0, added = BATCH; i < most && (i < turns || added >= BATCH); i++) {
        b->first = (int64_t)i * BATCH;
        TRY(vplParallelForProgress(s->context, VPL_LIT_PARTICLE_TASKS, shootTask, b,
                                   (vplProgressRange){s->def->progress, s->def->progressUser, 0.3 * i / most,
                                                      0.3 * (i + 1) / most}));
        added = markLit(b);
    }
    return VPL_SUCCESS;
}

// Shoots batches while each particle finds a new side, and until each of up to 2^18 light sources had its
// turn. vplLitSearch_FindSides finds the rest for less: four rays find most lit sides, and a particle casts
// twice as many.
vplResult vplLitSearch_ShootParticles(vplLitSearch* s)
{
    Batch b = {.search = s};
    b.vertices = vplAlloc(s->context, (size_t)BATCH * VERTICES, sizeof *b.vertices);
    const vplResult result = b.vertices != NULL ? shootBatches(&b) : VPL_OUT_OF_MEMORY;
    vplFree(s->context, b.vertices);
    return result;
}
