// SPDX-License-Identifier: MIT
// Clusters start at lights far from each other. Starting from every n/C-th light ends with 1.00 to
// 1.36 times the sum of distances from lights to clusters (bench/clusters), because samples of a reflective
// map are sorted by a coordinate of the map.
// Based on: Gonzalez, Clustering to Minimize the Maximum Intercluster Distance, Theoretical Computer Science
// 1985.
// Departs: the first is the light nearest to the mean.
#include "lights/clusters.h"

#include "base/arena.h"

#include <math.h>

static int findMiddle(const vplClusterSearch* s, const vplClusterDistance* distance)
{
    vplClusterPoint mean = {{0, 0, 0}, {0, 0, 0}};
    double sum = 0;
    for (int i = 0; i < s->lightCount; i++) {
        sum += vplClusterSearch_Weight(s, i);
    }
    for (int i = 0; i < s->lightCount && sum > 0; i++) {
        const double share = vplClusterSearch_Weight(s, i) / sum;
        for (int k = 0; k < 3; k++) {
            mean.p[k] += s->points[i].p[k] * share;
            mean.n[k] += s->points[i].n[k] * share;
        }
    }
    int middle = 0;
    double best = INFINITY;
    for (int i = 0; i < s->lightCount; i++) {
        const double d = vplClusterDistance_Below(distance, &s->points[i], &mean, best);
        if (d < best) {
            best = d;
            middle = i;
        }
    }
    return middle;
}

static int findFarthest(const vplClusterSearch* s)
{
    int farthest = 0;
    double most = -1;
    for (int i = 0; i < s->lightCount; i++) {
        const double far = vplClusterSearch_Weight(s, i) * s->distances[i];
        farthest = far > most ? i : farthest;
        most = far > most ? far : most;
    }
    return farthest;
}

static vplResult spreadOut(vplClusterSearch* s, int placed)
{
    vplClusterDistance distance = s->distance;
    if (distance.metric == VPL_CLUSTER_PRINTED) { // by this metric a light is far from itself
        distance.metric = VPL_CLUSTER_ONE_MINUS;
    }
    if (placed == 0) {
        s->centres[placed++] = s->points[findMiddle(s, &distance)];
    }
    for (int i = 0; i < s->lightCount; i++) {
        s->distances[i] = INFINITY;
    }
    for (int j = 0; j < s->count; j++) {
        if (j >= placed) {
            s->centres[j] = s->points[findFarthest(s)];
        }
        for (int i = 0; i < s->lightCount; i++) {
            const double d =
                vplClusterDistance_Below(&distance, &s->points[i], &s->centres[j], s->distances[i]);
            s->distances[i] = d < s->distances[i] ? d : s->distances[i];
        }
        TRY(vplAsk(s->context));
    }
    return VPL_SUCCESS;
}

vplResult vplClusterSearch_Place(vplClusterSearch* s, const vplClusterDef* def)
{
    const vplLightClusters* last = def->last;
    int placed = 0;
    for (int j = 0; last != NULL && j < last->count && placed < s->count; j++) {
        const vplLightCluster* c = &last->clusters[j];
        if (c->lightCount > 0) {
            s->centres[placed++] = vplClusterPoint_Make(c->position, c->normal);
        }
    }
    if (last == NULL && (def->seeds != NULL || s->count == s->lightCount)) { // as many clusters as lights
        for (; placed < s->count; placed++) {
            s->centres[placed] = s->points[def->seeds != NULL ? def->seeds[placed] : placed];
        }
    }
    return placed < s->count ? spreadOut(s, placed) : VPL_SUCCESS;
}
