// SPDX-License-Identifier: MIT
// Based on: Vitor Aranha, Marcio Macedo and Antonio Apolinario, Screen-Space Virtual Point Light Propagation
// for Real-Time Global Illumination: reflective shadow maps, samples of them as first-bounce lights, k-means
// clusters of these, a paraboloid map per cluster, samples of those as second-bounce lights; then interleaved
// shading of the camera's view.
// Departs: second-bounce lights are weighted, and have clusters and maps of their own to see by; a cluster
// that may shine behind its plane can have a second hemisphere; light of area lights, of which there are no
// reflective maps, comes by particles.
#include "render/stage.h"

const vplStageId VPL_SSVP_RECIPE[] = {
    VPL_STAGE_GEOMETRY,        VPL_STAGE_REFLECTIVE_MAPS,
    VPL_STAGE_FIRST_BOUNCE,    VPL_STAGE_CLUSTERS,
    VPL_STAGE_PARABOLOIDS,     VPL_STAGE_SECOND_BOUNCE,
    VPL_STAGE_SECOND_CLUSTERS, VPL_STAGE_SECOND_PARABOLOIDS,
    VPL_STAGE_FURTHER_BOUNCES, VPL_STAGE_CLUSTERED_LIGHTS,
    VPL_STAGE_EMITTER_TREES,   VPL_STAGE_AREA_LIGHTS,
    VPL_STAGE_NEAR_DISTANCE,   VPL_STAGE_VIRTUAL_LIGHTS,
    VPL_STAGE_GBUFFER,         VPL_STAGE_PICTURE,
    VPL_STAGE_COUNT,
};
