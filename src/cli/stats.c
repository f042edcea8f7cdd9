// SPDX-License-Identifier: MIT
#include "cli/cli.h"

#include <stdio.h>

static void addRadiosity(json_t* root, const vplRenderStats* stats)
{
    if (stats->patches == 0) {
        return;
    }
    const vplSolveStats* s = &stats->solve;
    json_object_set_new(root, "lit_patches", json_integer(stats->litPatches));
    json_object_set_new(root, "patch_sides", json_integer(stats->patchSides));
    if (stats->patchGroups > 0) {
        json_object_set_new(root, "patch_groups", json_integer(stats->patchGroups));
        json_object_set_new(root, "grouped_triangles", json_integer(stats->groupedTriangles));
    }
    json_object_set_new(root, stats->linked ? "links" : "form_factors", json_integer(stats->formFactors));
    if (s->rowSumMax == 0) {
        return; // no light was exchanged, or no statistics were asked for
    }
    json_object_set_new(root, "iterations", json_integer(s->iterations));
    json_object_set_new(root, "residual", json_real(s->residual));
    json_object_set_new(root, "spectral_radius", json_real(s->spectralRadius));
    json_object_set_new(
        root, "form_factor_sums",
        json_pack("{s:f, s:f, s:f}", "min", s->rowSumMin, "mean", s->rowSumMean, "max", s->rowSumMax));
}

// Figures that only some methods have.
static void addSome(json_t* root, const vplRenderStats* s)
{
    static const char* const shadows[] = {"", "none", "map", "ray", "auto", "cluster"};
    if (s->clusters > 0) {
        json_object_set_new(root, "clusters", json_integer(s->clusters));
        json_object_set_new(root, "cluster_iterations", json_integer(s->clusterIterations));
        json_object_set_new(root, "all_clusters", json_integer(s->allClusters));
        json_object_set_new(root, "cluster_disagreement",
                            s->clusterDisagreement < 0 ? json_null() : json_real(s->clusterDisagreement));
    }
    if (s->cutPixels > 0) {
        json_object_set_new(root, "light_evaluations", json_integer(s->lightEvaluations));
        json_object_set_new(root, "light_evaluations_per_pixel",
                            json_real((double)s->lightEvaluations / (double)s->cutPixels));
        json_object_set_new(root, "largest_cut", json_integer(s->largestCut));
    }
    if (s->lightShadows != VPL_LIGHT_SHADOWS_USUAL) {
        json_object_set_new(root, "light_shadows", json_string(shadows[s->lightShadows]));
    }
    if (s->shadowRayEstimateMs > 0) {
        json_object_set_new(
            root, "light_shadows_expected_ms",
            json_pack("{s:f, s:f}", "map", s->shadowMapEstimateMs, "ray", s->shadowRayEstimateMs));
    }
    if (s->clampLoss >= 0) {
        json_object_set_new(root, "clamp_loss", json_real(s->clampLoss));
    }
    if (s->errorEstimate >= 0) {
        json_object_set_new(root, "error_estimate", json_real(s->errorEstimate));
        json_object_set_new(root, "relative_error_estimate", json_real(s->relativeErrorEstimate));
    }
    if (s->relativeErrorBound >= 0) {
        json_object_set_new(root, "relative_error_bound", json_real(s->relativeErrorBound));
    }
    if (s->relativeNoise >= 0) {
        json_object_set_new(root, "relative_noise", json_real(s->relativeNoise));
    }
    if (s->relativeBias >= 0) {
        json_object_set_new(root, "relative_bias", json_real(s->relativeBias));
    }
    if (s->truthPaths > 0) {
        json_object_set_new(root, "truth_paths_per_pixel", json_integer(s->truthPaths));
    }
}

int writeStats(vplContext* context, const char* path, const vplRenderStats* s)
{
    char hash[17];
    snprintf(hash, sizeof hash, "%016llx", (unsigned long long)s->imageHash);
    json_t* stages = json_object();
    for (int i = 0; i < s->stageCount; i++) {
        json_object_set_new(stages, s->stages[i].name, json_real(s->stages[i].ms));
    }
    json_t* root =
        json_pack("{s:o, s:f, s:f, s:I, s:I, s:i, s:o, s:o, s:i, s:I, s:I, s:i, s:i, s:i, s:f, s:f, s:i, "
                  "s:i, s:s, s:I, s:s}",
                  "stages_ms", stages, "total_ms", s->totalMs, "cpu_ms", s->cpuMs, "draw_calls",
                  (json_int_t)s->drawCalls, "fragments", (json_int_t)s->fragments, "virtual_lights",
                  s->virtualLights, "lights_per_step", integersJson(s->particlesPerStep, s->stepCount),
                  "lights_left_per_step", integersJson(s->lightsPerStep, s->stepCount), "escaped", s->escaped,
                  "ray_object_tests", (json_int_t)s->rayObjectTests, "rays", (json_int_t)s->rays, "objects",
                  s->objects, "triangles", s->triangles, "patches", s->patches, "min_distance",
                  (double)s->minDistance, "reflectivity", s->reflectivity, "passes", s->passes, "threads",
                  vplContext_GetWorkerCount(context), "isa", vplIsa_GetName(vplContext_GetIsa(context)),
                  "peak_bytes", (json_int_t)s->peakBytes, "image_hash", hash);
    addRadiosity(root, s);
    addSome(root, s);
    return writeJson(root, 9, path);
}
