// SPDX-License-Identifier: MIT
// What is in a scene, and what a render with the same options would need. Nothing is rendered: counts follow
// from floor(rho^k N) and from the passes over the objects, as --stats reports them afterwards.
#include "cli/cli.h"

#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>

enum { OBJECT_TYPES = VPL_OBJECT_MESH + 1, POINTS = 0, SPOTS, DIRECTIONALS, EMITTER_TYPES };

static const char* const METHODS[] = {"instant-radiosity", "direct"};
static const char* const PIPELINES[] = {"multipass", "batched", "deferred"};

typedef struct Info {
    const char* path;
    int cameras, materials, objects, emitters, triangles, meshes;
    int64_t meshVertices, meshTriangles;
    int objectsOfType[OBJECT_TYPES], emittersOfType[EMITTER_TYPES];
    vplVec3 low, high;
    double diagonal, area, reflectance;
    // of a render
    const Arguments* arguments;
    double reflectivity;
    int steps, particlesPerStep[VPL_MAX_STEPS_REPORTED];
    int64_t virtualLights, drawCalls;
    int64_t shadowMapBytes, lightBytes, pictureBytes;
    const char* problem; // why it cannot be rendered; NULL: it can
} Info;

static void describeScene(const vplScene* scene, Info* info)
{
    info->cameras = vplScene_GetCameraCount(scene);
    info->materials = vplScene_GetMaterialCount(scene);
    info->objects = vplScene_GetObjectCount(scene);
    info->emitters = vplScene_GetEmitterCount(scene);
    for (int i = 0; i < info->objects; i++) {
        info->objectsOfType[vplScene_GetObject(scene, i)->type]++;
    }
    info->meshes = vplScene_GetMeshCount(scene);
    for (int i = 0; i < info->meshes; i++) {
        info->meshVertices += vplScene_GetMesh(scene, i)->vertexCount;
        info->meshTriangles += vplScene_GetMesh(scene, i)->triangleCount;
    }
    for (int i = 0; i < info->emitters; i++) {
        vplEmitterType type = vplScene_GetEmitter(scene, i)->type;
        info->emittersOfType[type == VPL_EMITTER_POINT  ? POINTS
                             : type == VPL_EMITTER_SPOT ? SPOTS
                                                        : DIRECTIONALS]++;
    }
}

static vplResult describeGeometry(const vplScene* scene, Info* info)
{
    vplGeometry* geometry;
    vplResult result = vplGeometry_Create(scene, &geometry);
    if (result == VPL_SUCCESS) {
        info->triangles = geometry->triangleCount;
        info->low = geometry->boundsMin;
        info->high = geometry->boundsMax;
        info->diagonal = (double)vplGeometry_Diagonal(geometry);
        info->area = vplGeometry_Area(geometry);
        info->reflectance = vplGeometry_MeanReflectance(geometry);
        vplGeometry_Destroy(geometry);
    }
    return result;
}

static const char* findProblem(const Info* info, vplMethod method)
{
    if (info->emittersOfType[SPOTS] + info->emittersOfType[DIRECTIONALS] > 0) {
        return "only point lights can be rendered so far";
    }
    return info->emitters == 0 && method != VPL_METHOD_DIRECT ? "there is no light to shoot particles from"
                                                              : NULL;
}

static vplResult describeRender(vplContext* context, const Arguments* a, Info* info)
{
    const vplRenderOptions* o = &a->render;
    info->arguments = a;
    info->reflectivity = o->reflectivity >= 0 ? o->reflectivity : info->reflectance;
    if (o->method != VPL_METHOD_DIRECT) {
        vplResult result =
            vplCountParticles(context, o->particles, info->reflectivity, info->particlesPerStep,
                              VPL_MAX_STEPS_REPORTED, &info->steps, &info->virtualLights);
        if (result != VPL_SUCCESS) {
            return result;
        }
    }
    int64_t perPass = o->accumulation == VPL_ACCUMULATE_BATCHED ? o->batch : 1;
    int64_t passes =
        o->accumulation == VPL_ACCUMULATE_DEFERRED ? 0 : (info->virtualLights + perPass - 1) / perPass;
    int64_t texels = 6 * (int64_t)o->shadowMapSize * o->shadowMapSize;
    info->drawCalls = info->objects * (6 * (int64_t)info->emitters + 1 + passes);
    info->shadowMapBytes = info->emitters * texels * (int64_t)sizeof(float);
    info->lightBytes = info->virtualLights * (int64_t)(sizeof(vplVirtualLight) + sizeof(vplShadeLight));
    info->pictureBytes = 3 * (int64_t)sizeof(float) * o->width * o->height;
    info->problem = findProblem(info, o->method);
    return VPL_SUCCESS;
}

static void printBytes(const char* name, int64_t bytes)
{
    bool large = bytes >= 1 << 20;
    printf("  %-16s %.1f %s\n", name, (double)bytes / (large ? 1 << 20 : 1 << 10), large ? "MiB" : "KiB");
}

static void printSteps(const Info* info)
{
    printf("  %-16s %lld", "virtual lights", (long long)info->virtualLights);
    for (int i = 0; i < info->steps && i < 12; i++) {
        printf("%s%d", i ? ", " : " (", info->particlesPerStep[i]);
    }
    printf("%s\n", info->steps > 12 ? ", ...)" : info->steps > 0 ? ")" : "");
}

static void printText(const Info* info)
{
    const vplRenderOptions* o = &info->arguments->render;
    printf("%s\n", info->path);
    printf("  %-16s %d\n", "cameras", info->cameras);
    printf("  %-16s %d\n", "materials", info->materials);
    printf("  %-16s %d (%d quads, %d boxes, %d meshes)\n", "objects", info->objects,
           info->objectsOfType[VPL_OBJECT_QUAD], info->objectsOfType[VPL_OBJECT_BOX],
           info->objectsOfType[VPL_OBJECT_MESH]);
    if (info->meshes > 0) {
        printf("  %-16s %d (%lld vertices, %lld triangles)\n", "mesh files", info->meshes,
               (long long)info->meshVertices, (long long)info->meshTriangles);
    }
    printf("  %-16s %d (%d point, %d spot, %d directional)\n", "lights", info->emitters,
           info->emittersOfType[POINTS], info->emittersOfType[SPOTS], info->emittersOfType[DIRECTIONALS]);
    printf("  %-16s %d\n", "triangles", info->triangles);
    printf("  %-16s (%g, %g, %g) to (%g, %g, %g) m\n", "bounds", (double)info->low.x, (double)info->low.y,
           (double)info->low.z, (double)info->high.x, (double)info->high.y, (double)info->high.z);
    printf("  %-16s %g m\n", "diagonal", info->diagonal);
    printf("  %-16s %g m^2\n", "area", info->area);
    printf("  %-16s %.4f (mean over the area)\n", "reflectance", info->reflectance);
    printf("\nto render it by %s, %s, at %dx%d\n", METHODS[o->method], PIPELINES[o->accumulation], o->width,
           o->height);
    printSteps(info);
    printf("  %-16s %lld\n", "draw calls", (long long)info->drawCalls);
    printBytes("shadow maps", info->shadowMapBytes);
    printBytes("lights", info->lightBytes);
    printBytes("picture", info->pictureBytes);
    if (info->problem != NULL) {
        printf("  %-16s %s\n", "not possible:", info->problem);
    }
}

static json_t* vector(vplVec3 v)
{
    return json_pack("[f, f, f]", (double)v.x, (double)v.y, (double)v.z);
}

static json_t* renderJson(const Info* info)
{
    const vplRenderOptions* o = &info->arguments->render;
    json_t* steps = json_array();
    for (int i = 0; i < info->steps && i < VPL_MAX_STEPS_REPORTED; i++) {
        json_array_append_new(steps, json_integer(info->particlesPerStep[i]));
    }
    return json_pack("{s:s, s:s, s:i, s:i, s:f, s:i, s:o, s:I, s:I, s:I, s:I, s:I, s:s?}", "method",
                     METHODS[o->method], "pipeline", PIPELINES[o->accumulation], "width", o->width, "height",
                     o->height, "reflectivity", info->reflectivity, "steps", info->steps, "lights_per_step",
                     steps, "virtual_lights", (json_int_t)info->virtualLights, "draw_calls",
                     (json_int_t)info->drawCalls, "shadow_map_bytes", (json_int_t)info->shadowMapBytes,
                     "light_bytes", (json_int_t)info->lightBytes, "picture_bytes",
                     (json_int_t)info->pictureBytes, "problem", info->problem);
}

static bool printJson(const Info* info)
{
    json_t* root = json_pack(
        "{s:i, s:i, s:{s:i, s:i, s:i, s:i}, s:{s:i, s:I, s:I}, s:{s:i, s:i, s:i, s:i}, s:i, s:o, s:o, s:f, "
        "s:f, s:f, s:o}",
        "cameras", info->cameras, "materials", info->materials, "objects", "total", info->objects, "quad",
        info->objectsOfType[VPL_OBJECT_QUAD], "box", info->objectsOfType[VPL_OBJECT_BOX], "mesh",
        info->objectsOfType[VPL_OBJECT_MESH], "meshes", "total", info->meshes, "vertices",
        (json_int_t)info->meshVertices, "triangles", (json_int_t)info->meshTriangles, "lights", "total",
        info->emitters, "point", info->emittersOfType[POINTS], "spot", info->emittersOfType[SPOTS],
        "directional", info->emittersOfType[DIRECTIONALS], "triangles", info->triangles, "bounds_min",
        vector(info->low), "bounds_max", vector(info->high), "diagonal", info->diagonal, "area", info->area,
        "mean_reflectance", info->reflectance, "render", renderJson(info));
    char* text = root ? json_dumps(root, JSON_INDENT(2) | JSON_REAL_PRECISION(9)) : NULL;
    if (text != NULL) {
        puts(text);
    }
    free(text);
    json_decref(root);
    return text != NULL;
}

int runInfo(const Arguments* a)
{
    vplContext* context = openContext(a);
    if (context == NULL) {
        return EXIT_USAGE;
    }
    Info info = {.path = a->positionals[0]};
    vplScene* scene = NULL;
    vplResult result = vplScene_Load(context, info.path, &scene);
    if (result == VPL_SUCCESS) {
        describeScene(scene, &info);
        result = describeGeometry(scene, &info);
    }
    if (result == VPL_SUCCESS) {
        result = describeRender(context, a, &info);
    }
    int code = exitCode(result, true);
    if (code == EXIT_DONE && !a->json) {
        printText(&info);
    } else if (code == EXIT_DONE && !printJson(&info)) {
        complain("out of memory while writing JSON");
        code = EXIT_COULD_NOT;
    }
    vplScene_Destroy(scene);
    vplContext_Destroy(context);
    return code;
}
