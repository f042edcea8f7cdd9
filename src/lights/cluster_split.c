// SPDX-License-Identifier: MIT
// Splits clusters of lights by what the lights see. A cluster sees by the map of one of its lights; where a
// door is ajar, lights side by side see different parts of a room, and the distance of k-means knows nothing
// of that.
// Based on: Dong, Grosch, Ritschel, Kautz and Seidel, Real-time Indirect Illumination with Clustered
// Visibility, VMV 2009 (one map per cluster); Gonzalez, Clustering to Minimize the Maximum Intercluster
// Distance, 1985 (the member that is worst off starts a cluster).
// Departs: the distance of two lights is the light at points of the camera's paths that one sees and the other
// does not.
#include "lights/placement.h"

#include "lights/kernels.h"
#include "lights/light_set.h"

#include <math.h>

enum {
    SPLIT_COOKIE = 0x56504c6d,
    CHUNK = 16,     // lights per task
    CANDIDATES = 8, // lights that are tried as the viewpoint of a new cluster
};

vplClusterSplitDef vplDefaultClusterSplitDef(void)
{
    vplClusterSplitDef def = {.view = vplDefaultPlacementDef(), .maxCount = 64, .wrong = 0.02};
    def.view.pointCount = 64;
    def.cookie = SPLIT_COOKIE;
    return def;
}

typedef struct Splitting {
    const vplGeometry* geometry;
    const vplLightSet* set;
    const vplClusterSplitDef* def;
    const vplViewBlock* blocks;
    int blockCount;
    vplReflectFcn* reflect;
    float inverseClamp;
    double* share; // of each point [block][lane]: 1 / its light, right or wrong; 0 where no light comes
    double points; // that light comes to
    // Per light.
    uint16_t* seen; // [light][block]: bit of each point that it sees
    double* wrong;  // its light that is wrong
    int* rays;      // per chunk
    int* of;
    // Per cluster, with room for def->maxCount.
    vplLightCluster* clusters;
    double* wrongOf; // sum over its lights
    int count;
} Splitting;

// ---- what each light sees

static vplShadeLight lightOf(const Splitting* s, int i)
{
    return vplPrepareLight(&s->set->lights[i], s->set->particleCount, VPL_LIGHTING_PHYSICAL);
}

// Casts rays to the points of a block that lie before the light and face it.
static uint16_t look(const Splitting* s, const vplViewBlock* b, const vplShadeLight* light, int* rays)
{
    vplRayPacket packet = b->rays;
    packet.active = 0;
    for (int l = 0; l < VPL_LANES; l++) {
        const vplVec3 origin = {packet.origin[0][l], packet.origin[1][l], packet.origin[2][l]};
        const vplVec3 way = vplWayTo(light, origin), plane = {b->plane[0][l], b->plane[1][l], b->plane[2][l]};
        const bool faces = vplDot(way, plane) > 0 && vplDot(way, vplVec(light->nx, light->ny, light->nz)) < 0;
        packet.direction[0][l] = way.x;
        packet.direction[1][l] = way.y;
        packet.direction[2][l] = way.z;
        packet.active |= (uint32_t)(faces && (b->rays.active & 1u << l) != 0) << l;
    }
    *rays += __builtin_popcount(packet.active);
    return packet.active == 0 ? 0
                              : (uint16_t)(packet.active & ~vplGeometry_AreOccluded(s->geometry, &packet, 1));
}

// Sum of the light that a light sends to the points of a block whose bits are set.
static double sumOf(const Splitting* s, int block, const vplShadeLight* light, unsigned bits)
{
    float reflected[VPL_LANES];
    double sum = 0;
    s->reflect(&s->blocks[block], light, s->inverseClamp, reflected);
    for (; bits != 0; bits &= bits - 1) {
        const int l = __builtin_ctz(bits);
        sum += (double)reflected[l] * s->share[block * VPL_LANES + l];
    }
    return sum;
}

static void lookChunk(void* data, int chunk, int worker)
{
    (void)worker;
    const Splitting* s = data;
    int rays = 0;
    for (int i = chunk * CHUNK; i < (chunk + 1) * CHUNK && i < s->set->lightCount; i++) {
        const vplShadeLight light = lightOf(s, i);
        for (int k = 0; k < s->blockCount; k++) {
            s->seen[(size_t)i * (size_t)s->blockCount + (size_t)k] = look(s, &s->blocks[k], &light, &rays);
        }
    }
    s->rays[chunk] = rays;
}

// ---- agreement

// The light of light i that is wrong if it sees by light v.
static double wrongBy(const Splitting* s, int i, int v)
{
    const size_t blocks = (size_t)s->blockCount;
    const uint16_t *mine = s->seen + (size_t)i * blocks, *its = s->seen + (size_t)v * blocks;
    const vplShadeLight light = lightOf(s, i);
    double sum = 0;
    for (int k = 0; k < s->blockCount; k++) {
        const unsigned differ = mine[k] ^ its[k];
        sum += differ != 0 ? sumOf(s, k, &light, differ) : 0;
    }
    return sum;
}

static void addTo(const Splitting* s, int block, const vplShadeLight* light, unsigned bits)
{
    float reflected[VPL_LANES];
    if (bits != 0) {
        s->reflect(&s->blocks[block], light, s->inverseClamp, reflected);
    }
    for (; bits != 0; bits &= bits - 1) {
        const int l = __builtin_ctz(bits);
        s->share[block * VPL_LANES + l] += (double)reflected[l];
    }
}

// Sums up the light of each point that some light sends there, or would by its cluster.
static void measurePoints(Splitting* s)
{
    const size_t blocks = (size_t)s->blockCount;
    for (int p = 0; p < s->blockCount * VPL_LANES; p++) {
        s->share[p] = 0;
    }
    for (int i = 0; i < s->set->lightCount; i++) {
        const uint16_t *mine = s->seen + (size_t)i * blocks,
                       *its = s->seen + (size_t)s->clusters[s->of[i]].nearest * blocks;
        const vplShadeLight light = lightOf(s, i);
        for (int k = 0; k < s->blockCount; k++) {
            addTo(s, k, &light, mine[k] | its[k]);
        }
    }
    for (int p = 0; p < s->blockCount * VPL_LANES; p++) {
        s->points += s->share[p] > 0;
        s->share[p] = s->share[p] > 0 ? 1 / s->share[p] : 0;
    }
}

static void judge(Splitting* s)
{
    measurePoints(s);
    for (int j = 0; j < s->count; j++) {
        s->wrongOf[j] = 0;
    }
    for (int i = 0; i < s->set->lightCount; i++) {
        s->wrong[i] = wrongBy(s, i, s->clusters[s->of[i]].nearest);
        s->wrongOf[s->of[i]] += s->wrong[i];
    }
}

static double sum(const double* values, int count)
{
    double all = 0;
    for (int i = 0; i < count; i++) {
        all += values[i];
    }
    return all;
}

// ---- splitting

// Lists the lights of a cluster that are worst off, in the order of their wrong light.
static int findWorst(const Splitting* s, int cluster, int worst[CANDIDATES])
{
    int count = 0;
    for (int i = 0; i < s->set->lightCount; i++) {
        if (s->of[i] != cluster || !(s->wrong[i] > 0) ||
            (count == CANDIDATES && !(s->wrong[i] > s->wrong[worst[count - 1]]))) {
            continue;
        }
        int at = count < CANDIDATES ? count++ : CANDIDATES - 1;
        for (; at > 0 && s->wrong[i] > s->wrong[worst[at - 1]]; at--) {
            worst[at] = worst[at - 1];
        }
        worst[at] = i;
    }
    return count;
}

// The wrong light that becomes right if light v is the viewpoint of a new cluster.
static double gainOf(const Splitting* s, int cluster, int v)
{
    double gain = 0;
    for (int i = 0; i < s->set->lightCount; i++) {
        if (s->of[i] == cluster && s->wrong[i] > 0) {
            const double wrong = wrongBy(s, i, v);
            gain += wrong < s->wrong[i] ? s->wrong[i] - wrong : 0;
        }
    }
    return gain;
}

// Splits a cluster whose wrong light is above 0, which one of its lights then loses.
static void split(Splitting* s, int cluster)
{
    int worst[CANDIDATES];
    const int candidates = findWorst(s, cluster, worst), made = s->count++;
    int viewpoint = candidates > 0 ? worst[0] : s->clusters[cluster].nearest;
    double most = -1;
    for (int k = 0; k < candidates; k++) {
        const double gain = gainOf(s, cluster, worst[k]);
        viewpoint = gain > most ? worst[k] : viewpoint;
        most = gain > most ? gain : most;
    }
    s->clusters[made] = s->clusters[cluster];
    s->clusters[made].nearest = viewpoint;
    s->wrongOf[cluster] = s->wrongOf[made] = 0;
    for (int i = 0; i < s->set->lightCount; i++) {
        if (s->of[i] == cluster) {
            const double wrong = s->wrong[i] > 0 ? wrongBy(s, i, viewpoint) : 0;
            if (wrong < s->wrong[i]) {
                s->of[i] = made;
                s->wrong[i] = wrong;
            }
            s->wrongOf[s->of[i]] += s->wrong[i];
        }
    }
}

static int findWrongest(const Splitting* s)
{
    int wrongest = 0;
    for (int j = 1; j < s->count; j++) {
        wrongest = s->wrongOf[j] > s->wrongOf[wrongest] ? j : wrongest;
    }
    return wrongest;
}

// Adds up the lights of a cluster that lost or got some. Its axis is its viewpoint's normal.
static void addUp(const Splitting* s, int cluster)
{
    vplLightCluster* c = &s->clusters[cluster];
    double p[3] = {0, 0, 0}, flux[3] = {0, 0, 0};
    c->lightCount = 0;
    for (int i = 0; i < s->set->lightCount; i++) {
        const vplVirtualLight* v = &s->set->lights[i];
        const double share = (double)v->weight / s->set->particleCount;
        if (s->of[i] == cluster) {
            p[0] += (double)v->position.x;
            p[1] += (double)v->position.y;
            p[2] += (double)v->position.z;
            flux[0] += share * (double)v->light.r;
            flux[1] += share * (double)v->light.g;
            flux[2] += share * (double)v->light.b;
            c->lightCount++;
        }
    }
    const double n = c->lightCount;
    c->position = vplVec((float)(p[0] / n), (float)(p[1] / n), (float)(p[2] / n));
    c->normal = s->set->lights[c->nearest].normal;
    c->flux = (vplRgb){(float)flux[0], (float)flux[1], (float)flux[2]};
}

// Lights only move to clusters that splitting made.
static void summarize(const Splitting* s, const int* before, int beforeCount)
{
    for (int j = 0; j < s->count; j++) {
        bool changed = j >= beforeCount;
        for (int i = 0; i < s->set->lightCount && !changed; i++) {
            changed = before[i] == j && s->of[i] != j;
        }
        if (changed) {
            addUp(s, j);
        }
    }
}

// ---- setting up

static vplResult splitAll(Splitting* s, const vplLightClusters* from, vplArena* scratch,
                          vplClusterAgreement* agreementOut)
{
    const size_t lights = (size_t)s->set->lightCount;
    const int chunks = (s->set->lightCount + CHUNK - 1) / CHUNK;
    const float distance = s->def->view.minDistance;
    s->reflect = vplGetLightsKernels(s->geometry->context->isa)->reflectPhysical;
    s->inverseClamp = distance > 0 ? 1 / (distance * distance) : INFINITY;
    TRY(vplSampleView(s->geometry, &s->def->view, scratch, &s->blocks, &s->blockCount));
    s->seen = vplArena_Alloc(scratch, lights, (size_t)s->blockCount * sizeof *s->seen);
    s->share = vplArena_Alloc(scratch, (size_t)s->blockCount, VPL_LANES * sizeof *s->share);
    s->wrong = vplArena_Alloc(scratch, lights, sizeof *s->wrong);
    s->rays = vplArena_Alloc(scratch, (size_t)chunks, sizeof *s->rays);
    TRY(vplArena_Check(scratch));
    TRY(vplParallelForAsking(s->geometry->context, chunks, lookChunk, s));
    judge(s);
    while (s->count < s->def->maxCount && sum(s->wrongOf, s->count) > s->def->wrong * s->points) {
        split(s, findWrongest(s));
        TRY(vplAsk(s->geometry->context));
    }
    summarize(s, from->of, from->count);
    *agreementOut = (vplClusterAgreement){s->points, sum(s->wrongOf, s->count), 0};
    for (int i = 0; i < chunks; i++) {
        agreementOut->rays += s->rays[i];
    }
    return VPL_SUCCESS;
}

static vplResult check(const vplLightSet* lights, const vplLightClusters* clusters,
                       const vplClusterSplitDef* def)
{
    vplContext* context = lights->context;
    if (def->cookie != SPLIT_COOKIE) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "vplClusterSplitDef was not made by vplDefaultClusterSplitDef");
    }
    if (clusters->lightCount != lights->lightCount) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "clusters of %d lights cannot be split by %d lights",
                       clusters->lightCount, lights->lightCount);
    }
    if (def->maxCount < 1 || def->maxCount > VPL_MAX_LIGHTS) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplClusterSplitDef.maxCount is %d, must be in [1, %d]",
                       def->maxCount, VPL_MAX_LIGHTS);
    }
    if (!(def->wrong >= 0 && def->wrong <= 1)) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplClusterSplitDef.wrong is %g, must be in [0, 1]",
                       def->wrong);
    }
    return vplPlacementDef_Check(context, &def->view);
}

static vplResult splitInto(vplArena* arena, Splitting* s, const vplLightClusters* from,
                           vplLightClusters* made, vplClusterAgreement* agreementOut)
{
    const int most = from->count > s->def->maxCount ? from->count : s->def->maxCount;
    vplArena* scratch = vplArena_Create(from->context);
    const size_t room =
        (size_t)(most < from->count + from->lightCount ? most : from->count + from->lightCount);
    s->clusters = vplArena_Alloc(arena, room, sizeof *s->clusters);
    s->of = vplArena_Alloc(arena, (size_t)from->lightCount, sizeof *s->of);
    s->wrongOf = vplArena_Alloc(scratch, room, sizeof *s->wrongOf);
    vplResult result = vplArena_Check(arena);
    result = result == VPL_SUCCESS ? vplArena_Check(scratch) : result;
    if (result == VPL_SUCCESS) {
        memcpy(s->clusters, from->clusters, (size_t)from->count * sizeof *s->clusters);
        memcpy(s->of, from->of, (size_t)from->lightCount * sizeof *s->of);
        s->count = from->count;
        result = splitAll(s, from, scratch, agreementOut);
        *made = *from;
        made->clusters = s->clusters;
        made->of = s->of;
        made->count = s->count;
        made->arena = arena;
    }
    vplArena_Destroy(scratch);
    return result;
}

vplResult vplSplitClusters(const vplGeometry* geometry, const vplLightSet* lights,
                           const vplLightClusters* clusters, const vplClusterSplitDef* def,
                           vplLightClusters** clustersOut, vplClusterAgreement* agreementOut)
{
    REQUIRE(CONTEXT_OF(geometry) ?: CONTEXT_OF(lights) ?: CONTEXT_OF(clusters), geometry, lights, clusters,
            def, clustersOut, agreementOut);
    TRY(check(lights, clusters, def));
    Splitting s = {.geometry = geometry, .set = lights, .def = def};
    vplClusterAgreement agreement = {0, 0, 0};
    vplArena* arena = vplArena_Create(clusters->context);
    vplLightClusters* made = vplArena_Alloc(arena, 1, sizeof *made);
    vplResult result = vplArena_Check(arena);
    result = result == VPL_SUCCESS ? splitInto(arena, &s, clusters, made, &agreement) : result;
    *agreementOut = agreement;
    return vplArena_Deliver(arena, result, made, clustersOut);
}
