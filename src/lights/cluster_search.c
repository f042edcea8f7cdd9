// SPDX-License-Identifier: MIT
// K-means by Lloyd's algorithm: assigns each light to its nearest cluster, then moves each cluster to the
// mean of its lights, in turn. The mean does not minimise these distances, so the search may return to an
// earlier assignment: it ends then. A light is compared only with clusters that moved since the last
// assignment, unless its own moved away from it: the same answer in less time.
#include "lights/clusters.h"

#include "base/arena.h"
#include "base/hash.h"
#include "math/scalar.h"

#include <math.h>
#include <string.h>

// With fewer pairs of a light and a cluster, waking threads (0.1 ms) takes longer than the work.
static const double FEW_PAIRS = 1 << 15;

// ---- distance

double vplClusterDistance_Below(const vplClusterDistance* distance, const vplClusterPoint* a,
                                const vplClusterPoint* b, double best)
{
    const double dx = a->p[0] - b->p[0], dy = a->p[1] - b->p[1], dz = a->p[2] - b->p[2];
    const double along = a->n[0] * b->n[0] + a->n[1] * b->n[1] + a->n[2] * b->n[2];
    const double cosine = along < -1 ? -1 : along > 1 ? 1 : along; // no term is below 0
    double term = 1 - cosine;                                      // a lower bound of the angle
    if (distance->metric == VPL_CLUSTER_PRINTED) {
        term = cosine > 0 ? cosine : 0;
    } else if (distance->metric == VPL_CLUSTER_ONE_MINUS_CLAMPED) {
        term = cosine > 0 ? 1 - cosine : 1;
    }
    // Saves root and angle where the square is too large already. 1e-12 is more than all rounding.
    const double square = distance->w1 * distance->w1 * (dx * dx + dy * dy + dz * dz);
    const double left = best - distance->w2 * term;
    if (!(left >= 0 && square <= left * left * (1 + 1e-12))) {
        return INFINITY;
    }
    if (distance->metric == VPL_CLUSTER_ANGLE) {
        term = vplAcos(cosine);
    }
    return distance->w1 * sqrt(dx * dx + dy * dy + dz * dz) + distance->w2 * term;
}

// ---- each light to its nearest cluster

// Equal distances go to the lowest index.
static void offer(const vplClusterSearch* s, const vplClusterPoint* point, int cluster, double* best,
                  int* winner)
{
    const double d = vplClusterDistance_Below(&s->distance, point, &s->centres[cluster], *best);
    if (d < *best || (d == *best && cluster < *winner)) {
        *best = d;
        *winner = cluster;
    }
}

static void compareWithAll(const vplClusterSearch* s, const vplClusterPoint* point, double* best, int* winner)
{
    for (int j = 0; j < s->count; j++) {
        offer(s, point, j, best, winner);
    }
}

// Clusters that did not move are no nearer than before, and the light's own was the nearest: unless that
// moved away, only clusters that moved can win.
static int findCluster(const vplClusterSearch* s, int light, double* best)
{
    const vplClusterPoint* point = &s->points[light];
    int winner = s->of[light];
    *best = s->distances[light];
    if (s->moved[winner]) {
        const double now = vplClusterDistance_Below(&s->distance, point, &s->centres[winner], INFINITY);
        const bool away = now > *best;
        *best = now;
        if (away) {
            compareWithAll(s, point, best, &winner);
            return winner;
        }
    }
    for (int k = 0; k < s->movedCount; k++) {
        offer(s, point, s->movedList[k], best, &winner);
    }
    return winner;
}

static void assignSome(void* data, int task, int worker)
{
    (void)worker;
    vplClusterSearch* s = data;
    const int first = task * VPL_CLUSTER_TASK;
    const int end = vplMini(first + VPL_CLUSTER_TASK, s->lightCount);
    bool changed = false;
    for (int i = first; i < end; i++) {
        int cluster = 0;
        double best = INFINITY;
        if (s->first) {
            compareWithAll(s, &s->points[i], &best, &cluster);
        } else {
            cluster = findCluster(s, i, &best);
        }
        changed = changed || cluster != s->of[i];
        s->of[i] = cluster;
        s->distances[i] = best;
    }
    s->changed[task] = changed;
}

static vplResult assign(vplClusterSearch* s, bool* changedOut)
{
    if ((double)s->lightCount * s->count < FEW_PAIRS) {
        for (int i = 0; i < s->taskCount; i++) {
            assignSome(s, i, 0);
        }
    } else {
        TRY(vplParallelForAsking(s->context, s->taskCount, assignSome, s));
    }
    *changedOut = false;
    for (int i = 0; i < s->taskCount; i++) {
        *changedOut = *changedOut || s->changed[i];
    }
    s->first = false;
    return VPL_SUCCESS;
}

// ---- each cluster to the mean of its lights

// Keeps the normal if the sum of unit normals is so small that only rounding is left.
static void pointAlong(double n[3], const double sum[3], double weight)
{
    const double length = sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
    for (int k = 0; k < 3 && length > 1e-6 * weight; k++) {
        n[k] = sum[k] / length;
    }
}

static void update(vplClusterSearch* s)
{
    memset(s->tallies, 0, (size_t)s->count * sizeof *s->tallies);
    for (int i = 0; i < s->lightCount; i++) {
        vplClusterTally* tally = &s->tallies[s->of[i]];
        const double weight = vplClusterSearch_Weight(s, i);
        for (int k = 0; k < 3; k++) {
            tally->sum.p[k] += weight * s->points[i].p[k];
            tally->sum.n[k] += weight * s->points[i].n[k];
        }
        tally->weight += weight;
        tally->lightCount++;
    }
    s->movedCount = 0;
    for (int j = 0; j < s->count; j++) {
        const vplClusterTally* tally = &s->tallies[j];
        vplClusterPoint mean = s->centres[j];
        for (int k = 0; k < 3 && tally->weight > 0; k++) {
            mean.p[k] = tally->sum.p[k] / tally->weight;
        }
        pointAlong(mean.n, tally->sum.n, tally->weight);
        s->moved[j] = memcmp(&mean, &s->centres[j], sizeof mean) != 0;
        s->centres[j] = mean;
        if (s->moved[j]) {
            s->movedList[s->movedCount++] = j;
        }
    }
}

// ---- both in turn

static uint64_t hashAssignment(const vplClusterSearch* s)
{
    return vplHashWords(0, (const uint32_t*)s->of, (size_t)s->lightCount);
}

static bool repeatsEarlier(const vplClusterSearch* s, int iterations)
{
    for (int i = 0; i < iterations; i++) {
        if (s->hashes[i] == s->hashes[iterations]) {
            return true;
        }
    }
    return false;
}

vplResult vplClusterSearch_Run(vplClusterSearch* s, vplLightClusters* clusters)
{
    bool changed;
    s->first = true;
    TRY(assign(s, &changed));
    s->hashes[0] = hashAssignment(s);
    clusters->end = VPL_CLUSTERS_STOPPED;
    while (clusters->end == VPL_CLUSTERS_STOPPED && clusters->iterations < s->maxIterations) {
        TRY(vplAsk(s->context)); // assign asks between tasks, and few pairs are one task
        update(s);
        clusters->iterations++;
        TRY(assign(s, &changed));
        if (!changed) {
            clusters->end = VPL_CLUSTERS_CONVERGED;
            continue;
        }
        s->hashes[clusters->iterations] = hashAssignment(s);
        if (repeatsEarlier(s, clusters->iterations)) {
            clusters->end = VPL_CLUSTERS_CYCLE;
        }
    }
    update(s); // the last assignment may have changed clusters
    return VPL_SUCCESS;
}
