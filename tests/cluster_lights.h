// SPDX-License-Identifier: MIT
// Makes lights by hand for tests of clusters, and clusters them.
#ifndef VPL_TESTS_CLUSTER_LIGHTS_H
#define VPL_TESTS_CLUSTER_LIGHTS_H

#include "test.h"

#include "lights/clusters.h"

#include <jansson.h>
#include <stdlib.h>

enum { MOST_LIGHTS = 256 };

typedef struct Lights {
    vplVirtualLight lights[MOST_LIGHTS];
    vplLightSet set;
} Lights;

void beginLights(Lights* l, vplContext* context, int count);

vplLightClusters* find(const vplLightSet* set, const vplClusterDef* def);

vplClusterMetric metricOf(const char* name);

// Places lights on the walls of a box of about 4 x 3 x 5 metres.
void fillRoom(Lights* l, uint64_t room);

// Asserts that two clusterings are equal to the bit.
void assertSame(const vplLightClusters* a, const vplLightClusters* b);

#endif
