// SPDX-License-Identifier: MIT
// What is in a scene, and what a render with the same options would need. Nothing is rendered: counts follow
// from floor(rho^k N) and from the passes over the objects, as --stats reports them afterwards.
#include "cli/cli.h"
#include "cli/info_patches.h"

#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { OBJECT_TYPES = VPL_OBJECT_MESH + 1, POINTS = 0, SPOTS, DIRECTIONALS, EMITTER_TYPES };

typedef struct Info {
    const char* path;
    int paths;                    // of cameras and lights
    double firstFrame, lastFrame; // of their keys; 0 where there are none
    int cameras, materials, objects, emitters, triangles, meshes;
    int64_t meshVertices, meshTriangles;
    int objectsOfType[OBJECT_TYPES], emittersOfType[EMITTER_TYPES];
    vplVec3 low, high;
    double diagonal, area, reflectance;
    int lampTriangles; // that emit
    double lampArea;   // square metres
    // of a render
    const Arguments* arguments;
    char method[32], pipeline[32]; // as in the options
    double reflectivity;
    int steps, particlesPerStep[VPL_MAX_STEPS_REPORTED];
    int64_t virtualLights, drawCalls;
    int64_t shadowMapBytes, lightBytes, pictureBytes;
    PatchInfo patches;   // radiosity
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

static void addPath(Info* info, double first, double last)
{
    info->firstFrame = info->paths == 0 || first < info->firstFrame ? first : info->firstFrame;
    info->lastFrame = info->paths == 0 || last > info->lastFrame ? last : info->lastFrame;
    info->paths++;
}

static void describePaths(const vplScene* scene, Info* info)
{
    int count;
    for (int i = 0; i < info->cameras; i++) {
        const vplCameraKey* keys = vplScene_GetCameraPath(scene, i, &count);
        if (keys != NULL) {
            addPath(info, keys[0].frame, keys[count - 1].frame);
        }
    }
    for (int i = 0; i < info->emitters; i++) {
        const vplEmitterKey* keys = vplScene_GetEmitterPath(scene, i, &count);
        if (keys != NULL) {
            addPath(info, keys[0].frame, keys[count - 1].frame);
        }
    }
}

static vplResult describeGeometry(const vplScene* scene, const vplRenderOptions* o, Info* info)
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
        vplEmission* emission = NULL;
        result = vplEmission_Create(geometry, NULL, 0, &emission);
        if (result == VPL_SUCCESS) {
            info->lampTriangles = emission->sourceCount;
            info->lampArea = vplEmission_Area(emission);
            vplEmission_Destroy(emission);
        }
        if (result == VPL_SUCCESS && o->method == VPL_METHOD_RADIOSITY) {
            result = measurePatches(scene, o, geometry, &info->patches);
        }
        vplGeometry_Destroy(geometry);
    }
    return result;
}

static const char* findProblem(const Info* info, const vplRenderOptions* o)
{
    const bool keller = o->method == VPL_METHOD_KELLER;
    const bool documented = o->lighting == VPL_LIGHTING_DOCUMENTED && !keller;
    if (documented && o->method == VPL_METHOD_PATH) {
        return "the path tracer knows physical lighting only";
    }
    if (documented && o->method == VPL_METHOD_SSVP) {
        return "ssvp knows physical lighting only";
    }
    if (documented && o->method == VPL_METHOD_RADIOSITY) {
        return "radiosity knows physical lighting only";
    }
    if (o->method == VPL_METHOD_RADIOSITY && !info->patches.linked &&
        info->patches.formFactorBytes > VPL_MAX_FORM_FACTOR_BYTES) {
        return "form factors of all pairs take more memory than is allowed; use --hierarchy on";
    }
    if (documented && info->emittersOfType[SPOTS] + info->emittersOfType[DIRECTIONALS] > 0) {
        return "documented lighting knows point lights only";
    }
    const bool shines = info->emitters > 0 || (info->lampTriangles > 0 && !documented);
    return !shines && (keller || o->method == VPL_METHOD_INSTANT_RADIOSITY)
               ? "there is no light to shoot particles from"
               : NULL;
}

// Of a light in the tree of lightcuts.
enum { LIGHT_TREE_BYTES = 104 };

// Draws and shadow maps of the rasterizing methods: directional emitters, and all where rays are asked for, have
// no map.
static void countDraws(const vplRenderOptions* o, Info* info)
{
    const int64_t perPass = o->pipeline.kind == VPL_ACCUMULATE_BATCHED ? o->pipeline.batch : 1;
    // Keller's lights of step 0 are drawn where they lie on lamps; elsewhere they are the emitter itself.
    const bool asEmitters = o->method == VPL_METHOD_KELLER && info->lampTriangles == 0;
    const int64_t drawn = info->virtualLights - (asEmitters ? info->particlesPerStep[0] : 0);
    const int64_t passes = o->pipeline.kind >= VPL_ACCUMULATE_DEFERRED ? 0 : (drawn + perPass - 1) / perPass;
    const int64_t maps =
        o->lights.shadows == VPL_LIGHT_SHADOWS_RAY ? 0 : info->emitters - info->emittersOfType[DIRECTIONALS];
    const int64_t lightMaps = o->lights.shadows == VPL_LIGHT_SHADOWS_MAP ? drawn : 0;
    const int64_t size = o->shadow.mapSize, lightSize = o->lights.mapSize;
    const int64_t patchDraws = o->method == VPL_METHOD_RADIOSITY ? 2 : 0; // of fronts and of backs
    info->drawCalls =
        info->objects * (6 * maps + (1 + passes) * o->output.antialias) + patchDraws * o->output.antialias;
    const int64_t lightMapBytes = lightMaps * lightSize * lightSize * (int64_t)sizeof(float);
    info->shadowMapBytes = 6 * maps * size * size * (int64_t)sizeof(float) +
                           (lightMapBytes < VPL_LIGHT_MAP_BYTES ? lightMapBytes : VPL_LIGHT_MAP_BYTES);
    const int64_t lamps =
        info->lampTriangles > 0 && o->method != VPL_METHOD_KELLER ? o->lights.areaLightSamples : 0;
    const int64_t each = (int64_t)(sizeof(vplVirtualLight) + sizeof(vplShadeLight)) +
                         (o->pipeline.kind == VPL_ACCUMULATE_LIGHTCUTS ? LIGHT_TREE_BYTES : 0);
    info->lightBytes = info->virtualLights * each + lamps * (int64_t)sizeof(vplShadeLight);
}

// SSVP draws every object once per face of its reflective maps and once for the camera; what paraboloid maps draw is
// not counted as draws. Lights that meet nothing are left out later.
static void countSsvp(const vplRenderOptions* o, Info* info)
{
    const bool clusters =
        o->lights.shadows == VPL_LIGHT_SHADOWS_USUAL || o->lights.shadows == VPL_LIGHT_SHADOWS_CLUSTER;
    const int bounces = o->maxBounces < 0 || o->maxBounces > 2 ? 2 : o->maxBounces;
    const int lights[2] = {bounces > 0 ? o->ssvp.firstBounce : 0, bounces > 1 ? o->ssvp.secondBounce : 0};
    const int64_t faces = info->emitters + 5 * info->emittersOfType[POINTS];
    const int64_t rsm = o->shadow.rsmSize > 0 ? o->shadow.rsmSize : 1024, map = o->ssvp.paraboloidSize;
    int64_t texels = faces * rsm * rsm * 2; // distance and triangle
    for (int i = 0; i < 2; i++) {
        const int64_t count = lights[i] < o->ssvp.clusters ? lights[i] : o->ssvp.clusters;
        const bool sampled = i == 0 && lights[1] > 0;
        info->steps += lights[i] > 0;
        info->particlesPerStep[i] = lights[i];
        info->virtualLights += lights[i];
        texels += clusters || sampled ? count * o->ssvp.hemispheres * map * map * (sampled ? 2 : 1) : 0;
    }
    info->drawCalls = info->objects * (faces + o->output.antialias);
    info->shadowMapBytes = texels * (int64_t)sizeof(float);
    info->lightBytes = info->virtualLights * (int64_t)(sizeof(vplVirtualLight) + sizeof(vplShadeLight));
}

static vplResult describeRender(vplContext* context, const Arguments* a, Info* info)
{
    const vplRenderOptions* o = &a->render;
    info->arguments = a;
    vplRenderOptions_Get(o, "method", info->method, sizeof info->method);
    vplRenderOptions_Get(o, "pipeline", info->pipeline, sizeof info->pipeline);
    if (o->pipeline.kind == VPL_ACCUMULATE_USUAL) {
        strcpy(info->pipeline, o->method == VPL_METHOD_SSVP ? "interleaved" : "deferred");
    }
    info->reflectivity = o->particles.reflectivity >= 0 ? o->particles.reflectivity : info->reflectance;
    if (o->method == VPL_METHOD_INSTANT_RADIOSITY || o->method == VPL_METHOD_KELLER) {
        vplResult result =
            vplCountParticles(context, o->particles.count, info->reflectivity, info->particlesPerStep,
                              VPL_MAX_STEPS_REPORTED, &info->steps, &info->virtualLights);
        if (result != VPL_SUCCESS) {
            return result;
        }
    }
    if (o->method == VPL_METHOD_SSVP) {
        countSsvp(o, info);
    } else if (o->method != VPL_METHOD_PATH) {
        countDraws(o, info);
    }
    info->pictureBytes = 3 * (int64_t)sizeof(float) * o->output.width * o->output.height;
    info->problem = findProblem(info, o);
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

static void printPatches(const PatchInfo* p)
{
    printf("  %-16s %d, edges up to %g m\n", "patches", p->patches, p->longestEdge);
    printf("  %-16s %d of %d that light reaches\n", "sides", p->sides, 2 * p->patches);
    if (p->linked) {
        printf("  %-16s by links between groups of patches\n", "form factors");
    } else {
        printBytes("form factors", p->formFactorBytes);
    }
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
    if (info->paths > 0) {
        printf("  %-16s %d, frames %g to %g\n", "paths", info->paths, info->firstFrame, info->lastFrame);
    }
    if (info->lampTriangles > 0) {
        printf("  %-16s %d triangles, %g m^2\n", "lamps", info->lampTriangles, info->lampArea);
    }
    printf("  %-16s %d\n", "triangles", info->triangles);
    printf("  %-16s (%g, %g, %g) to (%g, %g, %g) m\n", "bounds", (double)info->low.x, (double)info->low.y,
           (double)info->low.z, (double)info->high.x, (double)info->high.y, (double)info->high.z);
    printf("  %-16s %g m\n", "diagonal", info->diagonal);
    printf("  %-16s %g m^2\n", "area", info->area);
    printf("  %-16s %.4f (mean over the area)\n", "reflectance", info->reflectance);
    if (o->method == VPL_METHOD_PATH) {
        printf("\nto render it by path, at %dx%d\n", o->output.width, o->output.height);
        printf("  %-16s %lld\n", "paths", (long long)o->output.width * o->output.height * o->path.samples);
    } else {
        printf("\nto render it by %s, %s, at %dx%d\n", info->method, info->pipeline, o->output.width,
               o->output.height);
        if (o->method == VPL_METHOD_RADIOSITY) {
            printPatches(&info->patches);
        } else {
            printSteps(info);
        }
        printf("  %-16s %lld\n", "draw calls", (long long)info->drawCalls);
        printBytes("shadow maps", info->shadowMapBytes);
        printBytes("lights", info->lightBytes);
    }
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
    return json_pack(
        "{s:s, s:s, s:i, s:i, s:f, s:i, s:o, s:I, s:I, s:I, s:I, s:I, s:i, s:i, s:I, s:s?}", "method",
        info->method, "pipeline", info->pipeline, "width", o->output.width, "height", o->output.height,
        "reflectivity", info->reflectivity, "steps", info->steps, "lights_per_step", steps, "virtual_lights",
        (json_int_t)info->virtualLights, "draw_calls", (json_int_t)info->drawCalls, "shadow_map_bytes",
        (json_int_t)info->shadowMapBytes, "light_bytes", (json_int_t)info->lightBytes, "picture_bytes",
        (json_int_t)info->pictureBytes, "patches", info->patches.patches, "patch_sides", info->patches.sides,
        "form_factor_bytes", (json_int_t)(info->patches.linked ? 0 : info->patches.formFactorBytes),
        "problem", info->problem);
}

static bool printJson(const Info* info)
{
    json_t* root = json_pack(
        "{s:i, s:i, s:{s:i, s:i, s:i, s:i}, s:{s:i, s:I, s:I}, s:{s:i, s:i, s:i, s:i}, s:{s:i, s:f, s:f}, "
        "s:i, s:i, s:f, s:o, "
        "s:o, s:f, s:f, s:f, s:o}",
        "cameras", info->cameras, "materials", info->materials, "objects", "total", info->objects, "quad",
        info->objectsOfType[VPL_OBJECT_QUAD], "box", info->objectsOfType[VPL_OBJECT_BOX], "mesh",
        info->objectsOfType[VPL_OBJECT_MESH], "meshes", "total", info->meshes, "vertices",
        (json_int_t)info->meshVertices, "triangles", (json_int_t)info->meshTriangles, "lights", "total",
        info->emitters, "point", info->emittersOfType[POINTS], "spot", info->emittersOfType[SPOTS],
        "directional", info->emittersOfType[DIRECTIONALS], "paths", "total", info->paths, "first_frame",
        info->firstFrame, "last_frame", info->lastFrame, "triangles", info->triangles, "lamp_triangles",
        info->lampTriangles, "lamp_area", info->lampArea, "bounds_min", vector(info->low), "bounds_max",
        vector(info->high), "diagonal", info->diagonal, "area", info->area, "mean_reflectance",
        info->reflectance, "render", renderJson(info));
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
        describePaths(scene, &info);
        result = describeGeometry(scene, &a->render, &info);
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
