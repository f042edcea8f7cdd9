// SPDX-License-Identifier: MIT
#include "cli/cli.h"

#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>

static json_t* intArray(const int* values, int count)
{
    json_t* array = json_array();
    for (int i = 0; i < count; i++) {
        json_array_append_new(array, json_integer(values[i]));
    }
    return array;
}

static void addRadiosity(json_t* root, const vplRenderStats* stats)
{
    if (stats->patches == 0) {
        return;
    }
    const vplSolveStats* s = &stats->solve;
    json_object_set_new(root, "patch_sides", json_integer(stats->patchSides));
    json_object_set_new(root, stats->linked ? "links" : "form_factors", json_integer(stats->formFactors));
    if (s->rowSumMax == 0) {
        return; // nothing was exchanged, or asked for
    }
    json_object_set_new(root, "iterations", json_integer(s->iterations));
    json_object_set_new(root, "residual", json_real(s->residual));
    json_object_set_new(root, "spectral_radius", json_real(s->spectralRadius));
    json_object_set_new(
        root, "form_factor_sums",
        json_pack("{s:f, s:f, s:f}", "min", s->rowSumMin, "mean", s->rowSumMean, "max", s->rowSumMax));
}

vplResult writeStats(vplContext* context, const char* path, const vplRenderStats* stats)
{
    char hash[17];
    snprintf(hash, sizeof hash, "%016llx", (unsigned long long)stats->imageHash);
    json_t* stages = json_object();
    for (int i = 0; i < stats->stageCount; i++) {
        json_object_set_new(stages, stats->stages[i].name, json_real(stats->stages[i].ms));
    }
    json_t* root = json_object();
    json_object_set_new(root, "stages_ms", stages);
    json_object_set_new(root, "total_ms", json_real(stats->totalMs));
    json_object_set_new(root, "cpu_ms", json_real(stats->cpuMs));
    json_object_set_new(root, "draw_calls", json_integer(stats->drawCalls));
    json_object_set_new(root, "fragments", json_integer(stats->fragments));
    json_object_set_new(root, "virtual_lights", json_integer(stats->virtualLights));
    if (stats->clusters > 0) {
        json_object_set_new(root, "clusters", json_integer(stats->clusters));
        json_object_set_new(root, "cluster_iterations", json_integer(stats->clusterIterations));
    }
    if (stats->cutPixels > 0) {
        json_object_set_new(root, "light_evaluations", json_integer(stats->lightEvaluations));
        json_object_set_new(root, "light_evaluations_per_pixel",
                            json_real((double)stats->lightEvaluations / (double)stats->cutPixels));
        json_object_set_new(root, "largest_cut", json_integer(stats->largestCut));
    }
    json_object_set_new(root, "lights_per_step", intArray(stats->particlesPerStep, stats->stepCount));
    json_object_set_new(root, "lights_left_per_step", intArray(stats->lightsPerStep, stats->stepCount));
    json_object_set_new(root, "escaped", json_integer(stats->escaped));
    json_object_set_new(root, "ray_object_tests", json_integer(stats->rayObjectTests));
    json_object_set_new(root, "rays", json_integer(stats->rays));
    json_object_set_new(root, "objects", json_integer(stats->objects));
    json_object_set_new(root, "triangles", json_integer(stats->triangles));
    json_object_set_new(root, "patches", json_integer(stats->patches));
    addRadiosity(root, stats);
    json_object_set_new(root, "min_distance", json_real(stats->minDistance));
    static const char* const shadows[] = {"", "none", "map", "ray", "auto", "cluster"};
    if (stats->lightShadows != VPL_LIGHT_SHADOWS_USUAL) {
        json_object_set_new(root, "light_shadows", json_string(shadows[stats->lightShadows]));
    }
    if (stats->shadowRayEstimateMs > 0) {
        json_object_set_new(
            root, "light_shadows_expected_ms",
            json_pack("{s:f, s:f}", "map", stats->shadowMapEstimateMs, "ray", stats->shadowRayEstimateMs));
    }
    json_object_set_new(root, "reflectivity", json_real(stats->reflectivity));
    json_object_set_new(root, "passes", json_integer(stats->passes));
    if (stats->clampLoss >= 0) {
        json_object_set_new(root, "clamp_loss", json_real(stats->clampLoss));
    }
    if (stats->errorEstimate >= 0) {
        json_object_set_new(root, "error_estimate", json_real(stats->errorEstimate));
        json_object_set_new(root, "relative_error_estimate", json_real(stats->relativeErrorEstimate));
    }
    json_object_set_new(root, "threads", json_integer(vplContext_GetWorkerCount(context)));
    json_object_set_new(root, "isa", json_string(vplIsa_GetName(vplContext_GetIsa(context))));
    json_object_set_new(root, "peak_bytes", json_integer((json_int_t)stats->peakBytes));
    json_object_set_new(root, "image_hash", json_string(hash));
    char* text = json_dumps(root, JSON_INDENT(2) | JSON_REAL_PRECISION(9));
    json_decref(root);
    vplResult result = VPL_OUT_OF_MEMORY;
    if (text == NULL) {
        complain("%s: out of memory while writing JSON", path);
    } else {
        result = writeTextFile(path, text) ? VPL_SUCCESS : VPL_FILE_ERROR;
        free(text);
    }
    return result;
}
