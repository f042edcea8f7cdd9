// SPDX-License-Identifier: MIT
// vpl info: what is in a scene, and the plan of a render with the same options. Nothing is rendered.
#include "cli/cli.h"

#include <stdio.h>

enum { OBJECT_TYPES = VPL_OBJECT_MESH + 1, EMITTER_TYPES = VPL_EMITTER_DIRECTIONAL + 1 };

typedef struct Info {
    int paths;                    // of cameras and lights
    double firstFrame, lastFrame; // of their keys; 0 where there are none
    int cameras, materials, objects, emitters, meshes;
    int64_t meshVertices, meshTriangles;
    int objectsOfType[OBJECT_TYPES], emittersOfType[EMITTER_TYPES];
    int triangles;
    vplVec3 low, high;
    double diagonal, area, reflectance;
    int areaLightTriangles;
    double areaLightArea; // square metres
} Info;

static void addPath(Info* info, double first, double last)
{
    info->firstFrame = info->paths == 0 || first < info->firstFrame ? first : info->firstFrame;
    info->lastFrame = info->paths == 0 || last > info->lastFrame ? last : info->lastFrame;
    info->paths++;
}

static void countScene(const vplScene* scene, Info* info)
{
    int keys;
    info->cameras = vplScene_GetCameraCount(scene);
    info->materials = vplScene_GetMaterialCount(scene);
    info->objects = vplScene_GetObjectCount(scene);
    info->emitters = vplScene_GetEmitterCount(scene);
    info->meshes = vplScene_GetMeshCount(scene);
    for (int i = 0; i < info->objects; i++) {
        info->objectsOfType[vplScene_GetObject(scene, i)->type]++;
    }
    for (int i = 0; i < info->meshes; i++) {
        info->meshVertices += vplScene_GetMesh(scene, i)->vertexCount;
        info->meshTriangles += vplScene_GetMesh(scene, i)->triangleCount;
    }
    for (int i = 0; i < info->cameras; i++) {
        const vplCameraKey* path = vplScene_GetCameraPath(scene, i, &keys);
        if (path != NULL) {
            addPath(info, path[0].frame, path[keys - 1].frame);
        }
    }
    for (int i = 0; i < info->emitters; i++) {
        const vplEmitterKey* path = vplScene_GetEmitterPath(scene, i, &keys);
        info->emittersOfType[vplScene_GetEmitter(scene, i)->type]++;
        if (path != NULL) {
            addPath(info, path[0].frame, path[keys - 1].frame);
        }
    }
}

static vplResult measureScene(const vplScene* scene, Info* info)
{
    vplGeometry* geometry;
    vplEmission* emission = NULL;
    vplResult result = vplGeometry_Create(scene, &geometry);
    if (result != VPL_SUCCESS) {
        return result;
    }
    info->triangles = geometry->triangleCount;
    info->low = geometry->boundsMin;
    info->high = geometry->boundsMax;
    info->diagonal = (double)vplGeometry_Diagonal(geometry);
    info->area = vplGeometry_Area(geometry);
    info->reflectance = vplGeometry_MeanReflectance(geometry);
    result = vplEmission_Create(geometry, NULL, 0, &emission);
    if (result == VPL_SUCCESS) {
        info->areaLightTriangles = emission->sourceCount;
        info->areaLightArea = vplEmission_Area(emission);
        vplEmission_Destroy(emission);
    }
    vplGeometry_Destroy(geometry);
    return result;
}

// ---- text

static void printScene(const char* path, const Info* info)
{
    const int* objects = info->objectsOfType;
    const int* emitters = info->emittersOfType;
    const vplVec3 a = info->low, b = info->high;
    printf("%s\n", path);
    printf("  %-16s %d\n", "cameras", info->cameras);
    printf("  %-16s %d\n", "materials", info->materials);
    printf("  %-16s %d (%d quads, %d boxes, %d meshes)\n", "objects", info->objects, objects[VPL_OBJECT_QUAD],
           objects[VPL_OBJECT_BOX], objects[VPL_OBJECT_MESH]);
    if (info->meshes > 0) {
        printf("  %-16s %d (%lld vertices, %lld triangles)\n", "mesh files", info->meshes,
               (long long)info->meshVertices, (long long)info->meshTriangles);
    }
    printf("  %-16s %d (%d point, %d spot, %d directional)\n", "lights", info->emitters,
           emitters[VPL_EMITTER_POINT], emitters[VPL_EMITTER_SPOT], emitters[VPL_EMITTER_DIRECTIONAL]);
    if (info->paths > 0) {
        printf("  %-16s %d, frames %g to %g\n", "paths", info->paths, info->firstFrame, info->lastFrame);
    }
    if (info->areaLightTriangles > 0) {
        printf("  %-16s %d triangles, %g m^2\n", "area lights", info->areaLightTriangles,
               info->areaLightArea);
    }
    printf("  %-16s %d\n", "triangles", info->triangles);
    printf("  %-16s (%g, %g, %g) to (%g, %g, %g) m\n", "bounds", (double)a.x, (double)a.y, (double)a.z,
           (double)b.x, (double)b.y, (double)b.z);
    printf("  %-16s %g m\n", "diagonal", info->diagonal);
    printf("  %-16s %g m^2\n", "area", info->area);
    printf("  %-16s %.4f (mean over the area)\n\n", "reflectance", info->reflectance);
}

// ---- JSON

static json_t* vector(vplVec3 v)
{
    return json_pack("[f, f, f]", (double)v.x, (double)v.y, (double)v.z);
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
    json_t *steps = json_array(), *stages = json_array();
    for (int i = 0; i < p->stepCount && i < VPL_MAX_STEPS_REPORTED; i++) {
        json_array_append_new(steps, json_integer(p->particlesPerStep[i]));
    }
    for (int i = 0; i < p->stageCount; i++) {
        const vplPlanStage* s = &p->stages[i];
        json_array_append_new(stages, json_pack("{s:s, s:s, s:s, s:I}", "name", s->name, "inputs", s->inputs,
                                                "why", s->why, "bytes", (json_int_t)s->bytes));
    }
    return json_pack("{s:s, s:s, s:i, s:i, s:f, s:i, s:o, s:I, s:I, s:I, s:I, s:I, s:i, s:i, s:I, s:I, s:o, "
                     "s:o, s:o, s:s?}",
                     "method", method, "pipeline", pipeline, "width", o->output.width, "height",
                     o->output.height, "reflectivity", o->particles.reflectivity, "steps", p->stepCount,
                     "lights_per_step", steps, "virtual_lights", (json_int_t)p->virtualLights, "draw_calls",
                     (json_int_t)p->drawCalls, "shadow_map_bytes", (json_int_t)p->shadowMapBytes,
                     "light_bytes", (json_int_t)p->lightBytes, "picture_bytes", (json_int_t)p->pictureBytes,
                     "patches", p->patches, "patch_sides", p->patchSides, "form_factor_bytes",
                     (json_int_t)(p->linked ? 0 : p->formFactorBytes), "peak_bytes", (json_int_t)p->peakBytes,
                     "stages", stages, "decisions", decisionsJson(p->decisions, p->decisionCount), "left_out",
                     decisionsJson(p->leftOut, p->leftOutCount), "problem",
                     p->problem[0] != 0 ? p->problem : NULL);
}

static json_t* sceneJson(const Info* info, const vplPlan* plan)
{
    const int* objects = info->objectsOfType;
    const int* emitters = info->emittersOfType;
    return json_pack("{s:i, s:i, s:{s:i, s:i, s:i, s:i}, s:{s:i, s:I, s:I}, s:{s:i, s:i, s:i, s:i}, s:{s:i, "
                     "s:f, s:f}, s:i, s:i, s:f, s:o, s:o, s:f, s:f, s:f, s:o}",
                     "cameras", info->cameras, "materials", info->materials, "objects", "total",
                     info->objects, "quad", objects[VPL_OBJECT_QUAD], "box", objects[VPL_OBJECT_BOX], "mesh",
                     objects[VPL_OBJECT_MESH], "meshes", "total", info->meshes, "vertices",
                     (json_int_t)info->meshVertices, "triangles", (json_int_t)info->meshTriangles, "lights",
                     "total", info->emitters, "point", emitters[VPL_EMITTER_POINT], "spot",
                     emitters[VPL_EMITTER_SPOT], "directional", emitters[VPL_EMITTER_DIRECTIONAL], "paths",
                     "total", info->paths, "first_frame", info->firstFrame, "last_frame", info->lastFrame,
                     "triangles", info->triangles, "lamp_triangles", info->areaLightTriangles, "lamp_area",
                     info->areaLightArea, "bounds_min", vector(info->low), "bounds_max", vector(info->high),
                     "diagonal", info->diagonal, "area", info->area, "mean_reflectance", info->reflectance,
                     "render", planJson(plan));
}

static int showInfo(const Arguments* a, vplContext* context, const vplScene* scene)
{
    (void)context;
    Info info = {0};
    vplPlan* plan = NULL;
    countScene(scene, &info);
    int code = exitCode(measureScene(scene, &info), true);
    if (code == EXIT_DONE) {
        code = exitCode(vplPlan_Create(scene, &a->render, NULL, &plan), true);
    }
    if (code == EXIT_DONE && a->json) {
        code = writeJson(sceneJson(&info, plan), 9, NULL);
    } else if (code == EXIT_DONE) {
        printScene(a->positionals[0], &info);
        code = printPlan(plan, stdout);
    }
    vplPlan_Destroy(plan);
    return code;
}

int runInfo(const Arguments* a)
{
    return runOnScene(a, showInfo);
}
