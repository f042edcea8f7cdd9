// SPDX-License-Identifier: MIT
// vpl info: what is in a scene, and the plan of a render with the same options. Nothing is rendered.
#include "cli/cli.h"

#include <stdio.h>

enum { OBJECT_TYPES = VPL_OBJECT_MESH + 1, EMITTER_TYPES = VPL_EMITTER_DIRECTIONAL + 1 };

typedef struct Info {
    const vplScene* scene;
    vplGeometry* geometry;
    vplEmission* emission; // of area lights
    vplPlan* plan;
    int64_t meshVertices, meshTriangles;
    int objectsOfType[OBJECT_TYPES], emittersOfType[EMITTER_TYPES];
    int paths;                    // of cameras, lights and objects
    double firstFrame, lastFrame; // of their keys; 0 where there are none
} Info;

static void addPath(Info* info, double first, double last)
{
    info->firstFrame = info->paths == 0 || first < info->firstFrame ? first : info->firstFrame;
    info->lastFrame = info->paths == 0 || last > info->lastFrame ? last : info->lastFrame;
    info->paths++;
}

static void countScene(Info* info)
{
    const vplScene* scene = info->scene;
    int keys;
    for (int i = 0; i < vplScene_GetObjectCount(scene); i++) {
        const vplTransformKey* path = vplScene_GetObjectPath(scene, i, &keys);
        info->objectsOfType[vplScene_GetObject(scene, i)->type]++;
        if (path != NULL) {
            addPath(info, path[0].frame, path[keys - 1].frame);
        }
    }
    for (int i = 0; i < vplScene_GetMeshCount(scene); i++) {
        info->meshVertices += vplScene_GetMesh(scene, i)->vertexCount;
        info->meshTriangles += vplScene_GetMesh(scene, i)->triangleCount;
    }
    for (int i = 0; i < vplScene_GetCameraCount(scene); i++) {
        const vplCameraKey* path = vplScene_GetCameraPath(scene, i, &keys);
        if (path != NULL) {
            addPath(info, path[0].frame, path[keys - 1].frame);
        }
    }
    for (int i = 0; i < vplScene_GetEmitterCount(scene); i++) {
        const vplEmitterKey* path = vplScene_GetEmitterPath(scene, i, &keys);
        info->emittersOfType[vplScene_GetEmitter(scene, i)->type]++;
        if (path != NULL) {
            addPath(info, path[0].frame, path[keys - 1].frame);
        }
    }
}

static int lampTriangles(const Info* info)
{
    return info->emission->sourceCount - info->emission->firstTriangle;
}

// ---- text

static void printScene(const char* path, const Info* info)
{
    const vplScene* scene = info->scene;
    const vplGeometry* g = info->geometry;
    const int *objects = info->objectsOfType, *emitters = info->emittersOfType;
    const int meshes = vplScene_GetMeshCount(scene);
    const vplVec3 a = g->boundsMin, b = g->boundsMax;
    const double* o = g->origin;
    const int digits = o[0] != 0 || o[1] != 0 || o[2] != 0 ? 12 : 6;
    printf("%s\n", path);
    printf("  %-16s %d\n", "cameras", vplScene_GetCameraCount(scene));
    printf("  %-16s %d\n", "materials", vplScene_GetMaterialCount(scene));
    printf("  %-16s %d (%d quads, %d boxes, %d meshes)\n", "objects", vplScene_GetObjectCount(scene),
           objects[VPL_OBJECT_QUAD], objects[VPL_OBJECT_BOX], objects[VPL_OBJECT_MESH]);
    if (meshes > 0) {
        printf("  %-16s %d (%lld vertices, %lld triangles)\n", "mesh files", meshes,
               (long long)info->meshVertices, (long long)info->meshTriangles);
    }
    printf("  %-16s %d (%d point, %d spot, %d directional)\n", "lights", vplScene_GetEmitterCount(scene),
           emitters[VPL_EMITTER_POINT], emitters[VPL_EMITTER_SPOT], emitters[VPL_EMITTER_DIRECTIONAL]);
    if (info->paths > 0) {
        printf("  %-16s %d, frames %g to %g\n", "paths", info->paths, info->firstFrame, info->lastFrame);
    }
    const vplEnvironmentDef* environment = vplScene_GetEnvironment(scene);
    if (environment->type != VPL_ENVIRONMENT_NONE) {
        const vplRgb e = g->environment != NULL ? g->environment->irradiance : (vplRgb){0, 0, 0};
        printf("  %-16s %s, %dx%d, mean radiance (%.4g, %.4g, %.4g) W/(m^2 sr)\n", "environment",
               describeEnvironment(scene), g->environment != NULL ? g->environment->width : 1,
               g->environment != NULL ? g->environment->height : 1, (double)e.r / (4 * VPL_PI),
               (double)e.g / (4 * VPL_PI), (double)e.b / (4 * VPL_PI));
    }
    if (lampTriangles(info) > 0) {
        printf("  %-16s %d triangles, %g m^2\n", "area lights", lampTriangles(info),
               vplEmission_Area(info->emission));
    }
    printf("  %-16s %d\n", "triangles", g->triangleCount);
    printf("  %-16s (%.*g, %.*g, %.*g) to (%.*g, %.*g, %.*g) m\n", "bounds", digits, o[0] + (double)a.x,
           digits, o[1] + (double)a.y, digits, o[2] + (double)a.z, digits, o[0] + (double)b.x, digits,
           o[1] + (double)b.y, digits, o[2] + (double)b.z);
    printf("  %-16s %g m\n", "diagonal", (double)vplGeometry_Diagonal(g));
    printf("  %-16s %g m^2\n", "area", vplGeometry_Area(g));
    printf("  %-16s %.4f (mean over the area)\n\n", "reflectance", vplGeometry_MeanReflectance(g));
}

// ---- JSON

static json_t* position(const vplGeometry* g, vplVec3 p)
{
    return json_pack("[f, f, f]", g->origin[0] + (double)p.x, g->origin[1] + (double)p.y,
                     g->origin[2] + (double)p.z);
}

static json_t* decisionsJson(const vplDecision* decisions, int count)
{
    json_t* array = json_array();
    for (int i = 0; i < count; i++) {
        const vplDecision* d = &decisions[i];
        json_array_append_new(
            array, json_pack("{s:s, s:s, s:s}", "name", d->name, "value", d->value, "why", d->why));
    }
    return array;
}

static json_t* planJson(const vplPlan* p)
{
    const vplRenderOptions* o = &p->options;
    char method[32] = "", pipeline[32] = "";
    vplRenderOptions_Get(o, "method", method, sizeof method);
    vplRenderOptions_Get(o, "pipeline", pipeline, sizeof pipeline);
    const int steps = p->stepCount < VPL_MAX_STEPS_REPORTED ? p->stepCount : VPL_MAX_STEPS_REPORTED;
    json_t* stages = json_array();
    for (int i = 0; i < p->stageCount; i++) {
        const vplPlanStage* s = &p->stages[i];
        json_array_append_new(stages,
                              json_pack("{s:s, s:s, s:s, s:I, s:f}", "name", s->name, "inputs", s->inputs,
                                        "why", s->why, "bytes", (json_int_t)s->bytes, "ms", s->ms));
    }
    return json_pack("{s:s, s:s, s:i, s:i, s:f, s:i, s:o, s:I, s:I, s:I, s:I, s:I, s:i, s:i, s:I, s:I, s:o, "
                     "s:o, s:o, s:f, s:f, s:f, s:b, s:s?, s:i}",
                     "method", method, "pipeline", pipeline, "width", o->output.width, "height",
                     o->output.height, "reflectivity", o->particles.reflectivity, "steps", p->stepCount,
                     "lights_per_step", integersJson(p->particlesPerStep, steps), "virtual_lights",
                     (json_int_t)p->virtualLights, "draw_calls", (json_int_t)p->drawCalls, "shadow_map_bytes",
                     (json_int_t)p->shadowMapBytes, "light_bytes", (json_int_t)p->lightBytes, "picture_bytes",
                     (json_int_t)p->pictureBytes, "patches", p->patches, "patch_sides", p->patchSides,
                     "form_factor_bytes", (json_int_t)(p->linked ? 0 : p->formFactorBytes), "peak_bytes",
                     (json_int_t)p->peakBytes, "stages", stages, "decisions",
                     decisionsJson(p->decisions, p->decisionCount), "left_out",
                     decisionsJson(p->leftOut, p->leftOutCount), "predicted_ms", p->predictedMs, "first_ms",
                     p->firstMs, "pass_ms", p->passMs, "usual_speeds", p->usualSpeeds, "problem",
                     p->problem[0] != 0 ? p->problem : NULL, "lit_patches", p->litPatches);
}

static json_t* sceneJson(const Info* info)
{
    const vplScene* scene = info->scene;
    const vplGeometry* g = info->geometry;
    const int *objects = info->objectsOfType, *emitters = info->emittersOfType;
    return json_pack("{s:i, s:i, s:{s:i, s:i, s:i, s:i}, s:{s:i, s:I, s:I}, s:{s:i, s:i, s:i, s:i}, s:{s:i, "
                     "s:f, s:f}, s:s, s:i, s:i, s:f, s:o, s:o, s:f, s:f, s:f, s:o}",
                     "cameras", vplScene_GetCameraCount(scene), "materials", vplScene_GetMaterialCount(scene),
                     "objects", "total", vplScene_GetObjectCount(scene), "quad", objects[VPL_OBJECT_QUAD],
                     "box", objects[VPL_OBJECT_BOX], "mesh", objects[VPL_OBJECT_MESH], "meshes", "total",
                     vplScene_GetMeshCount(scene), "vertices", (json_int_t)info->meshVertices, "triangles",
                     (json_int_t)info->meshTriangles, "lights", "total", vplScene_GetEmitterCount(scene),
                     "point", emitters[VPL_EMITTER_POINT], "spot", emitters[VPL_EMITTER_SPOT], "directional",
                     emitters[VPL_EMITTER_DIRECTIONAL], "paths", "total", info->paths, "first_frame",
                     info->firstFrame, "last_frame", info->lastFrame, "environment",
                     describeEnvironment(scene), "triangles", g->triangleCount, "lamp_triangles",
                     lampTriangles(info), "lamp_area", vplEmission_Area(info->emission), "bounds_min",
                     position(g, g->boundsMin), "bounds_max", position(g, g->boundsMax), "diagonal",
                     (double)vplGeometry_Diagonal(g), "area", vplGeometry_Area(g), "mean_reflectance",
                     vplGeometry_MeanReflectance(g), "render", planJson(info->plan));
}

static vplResult examine(const Arguments* a, Info* info)
{
    countScene(info);
    TRY(vplGeometry_Create(info->scene, &info->geometry));
    TRY(vplEmission_Create(info->geometry, NULL, 0, &info->emission));
    return planRender(a, info->scene, &info->plan);
}

static int showInfo(const Arguments* a, vplScene* scene)
{
    Info info = {.scene = scene};
    int code = exitCode(examine(a, &info), true);
    if (code == EXIT_DONE && a->planOut != NULL) {
        catchInterrupts();
        code = exitCode(vplPlan_Write(info.plan, scene, a->planOut), false);
    }
    if (code == EXIT_DONE && a->json) {
        code = writeJson(sceneJson(&info), 9, NULL);
    } else if (code == EXIT_DONE) {
        printScene(a->positionals[0], &info);
        code = printPlan(info.plan, stdout);
    }
    vplPlan_Destroy(info.plan);
    vplEmission_Destroy(info.emission);
    vplGeometry_Destroy(info.geometry);
    return code;
}

int runInfo(const Arguments* a)
{
    return runOnScene(a, showInfo);
}
