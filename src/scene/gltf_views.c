// SPDX-License-Identifier: MIT
// Cameras and lights of glTF files. Both look along -z of their node.
#include "scene/gltf.h"

#include "math/double3.h"
#include "scene/scene_json.h"

#include <string.h>

// Lumens per watt at 555 nm: candela / this = W/sr, lux / this = W/m^2.
static const double LUMENS = 683;

// ---- places

// Finds the place and the unit axes ahead (-z) and up (y) of a node; false if it is scaled to nothing.
static bool findView(const vplAffine* a, double place[3], double ahead[3], double up[3])
{
    double lengths[2] = {0, 0};
    for (int k = 0; k < 3; k++) {
        place[k] = a->m[k][3];
        ahead[k] = -a->m[k][2];
        up[k] = a->m[k][1];
        lengths[0] += ahead[k] * ahead[k];
        lengths[1] += up[k] * up[k];
    }
    for (int k = 0; k < 3; k++) {
        ahead[k] /= sqrt(lengths[0]);
        up[k] /= sqrt(lengths[1]);
    }
    return lengths[0] > 1e-24 && lengths[1] > 1e-24 && lengths[0] < INFINITY && lengths[1] < INFINITY;
}

// ---- cameras

// The target is so far ahead that rounding it to float turns the view by 1e-7 at most.
static bool poseCamera(const vplAffine* a, vplVec3* eye, vplVec3* target, vplVec3* up)
{
    double place[3], ahead[3], above[3], to[3], distance = 1;
    const bool good = findView(a, place, ahead, above);
    for (int k = 0; k < 3; k++) {
        distance = fmax(distance, fabs(place[k]));
    }
    for (int k = 0; k < 3; k++) {
        to[k] = place[k] + distance * ahead[k];
    }
    *eye = vplRound3(place);
    *target = vplRound3(to);
    *up = vplRound3(above);
    return good;
}

// The distance from an eye to the farthest corner of the boxes around the meshes of a model.
static double farthest(const vplScene* scene, const vplModel* model, vplVec3 eye)
{
    double from[3], most = 0;
    vplToDouble3(eye, from);
    for (size_t i = 0; i < model->count; i++) {
        const vplMeshDef* mesh = &scene->meshes[model->parts[i].mesh];
        const vplAffine* a = &model->parts[i].toModel;
        double middle[3], reach = 0;
        vplVec3 low = mesh->positions[0], high = low;
        for (int v = 1; v < mesh->vertexCount; v++) {
            const vplVec3 p = mesh->positions[v];
            low = vplVec(fminf(low.x, p.x), fminf(low.y, p.y), fminf(low.z, p.z));
            high = vplVec(fmaxf(high.x, p.x), fmaxf(high.y, p.y), fmaxf(high.z, p.z));
        }
        const double half[3] = {0.5 * ((double)high.x - (double)low.x),
                                0.5 * ((double)high.y - (double)low.y),
                                0.5 * ((double)high.z - (double)low.z)};
        const double centre[3] = {(double)low.x + half[0], (double)low.y + half[1], (double)low.z + half[2]};
        for (int k = 0; k < 3; k++) {
            middle[k] = a->m[k][3] + vplDot3(a->m[k], centre) - from[k];
            const double row[3] = {fabs(a->m[k][0]), fabs(a->m[k][1]), fabs(a->m[k][2])};
            const double side = fabs(middle[k]) + vplDot3(row, half);
            reach += side * side;
        }
        most = fmax(most, sqrt(reach));
    }
    return most;
}

// Reads a perspective camera; its far plane, if it has none, is behind the model.
static vplResult readLens(vplGltf* g, const vplJson* camera, const vplModel* model, vplCameraDef* def,
                          bool* usable)
{
    const vplJson lens = vplJson_Member(camera, "perspective"), angle = vplJson_Member(&lens, "yfov");
    *usable = lens.value != NULL;
    if (!*usable) {
        g->losses[VPL_GLTF_ORTHOGRAPHIC]++;
        return VPL_SUCCESS;
    }
    TRY(vplJson_RequireObject(&lens));
    TRY(vplJson_ReadNumber(&lens, "yfov", &def->fovY));
    TRY(vplJson_ReadNumber(&lens, "znear", &def->nearPlane));
    if (!(def->fovY > 0 && def->fovY < VPL_PI)) {
        return vplJson_Fail(&angle, "is %g, must be in (0, pi) radians", def->fovY);
    }
    def->farPlane = fmax(1.1 * farthest(g->scene, model, def->eye), 100 * def->nearPlane);
    TRY(vplJson_ReadNumber(&lens, "zfar", &def->farPlane));
    const vplFault fault = vplCheckCamera(def);
    if (fault.field == NULL) {
        return VPL_SUCCESS;
    }
    const char* key = strcmp(fault.field, "nearPlane") == 0  ? "znear"
                      : strcmp(fault.field, "farPlane") == 0 ? "zfar"
                                                             : fault.field;
    return vplJson_Fail(&lens, "makes no camera: its %s %s", key, fault.text);
}

static vplResult addCameraPath(vplGltf* g, const vplGltfMotion* motion, int node, int camera)
{
    int64_t first, last;
    bool moves;
    TRY(vplGltfMotion_FindFrames(g, motion, node, &first, &last, &moves));
    if (!moves) {
        return VPL_SUCCESS;
    }
    const size_t count = (size_t)(last - first) + 1;
    vplCameraKey* keys = vplArena_Alloc(g->scratch, count, sizeof *keys);
    TRY(vplArena_Check(g->scratch));
    for (size_t i = 0; i < count; i++) {
        const double frame = (double)(first + (int64_t)i);
        const vplAffine place = vplGltfMotion_Place(g, motion, node, frame);
        keys[i] = vplMakeCameraKey(vplScene_GetCamera(g->scene, camera), frame);
        poseCamera(&place, &keys[i].eye, &keys[i].target, &keys[i].up);
    }
    return vplScene_SetCameraPath(g->scene, camera, keys, (int)count);
}

static vplResult addCamera(vplGltf* g, const vplModel* model, const vplGltfMotion* motion, int node)
{
    const vplJson camera = vplGltf_Item(g, VPL_GLTF_CAMERAS, g->nodes[node].camera);
    vplCameraDef def = vplDefaultCameraDef();
    bool usable;
    int index;
    if (!poseCamera(&g->nodes[node].toModel, &def.eye, &def.target, &def.up)) {
        g->losses[VPL_GLTF_NO_CAMERA]++;
        return VPL_SUCCESS;
    }
    TRY(readLens(g, &camera, model, &def, &usable));
    if (!usable) {
        return VPL_SUCCESS;
    }
    TRY(vplScene_AddCamera(g->scene, &def, &index));
    return addCameraPath(g, motion, node, index);
}

vplResult vplGltf_AddCameras(vplGltf* g, const vplModel* model, const vplGltfMotion* motion)
{
    for (int i = 0; i < vplGltf_Count(g, VPL_GLTF_NODES); i++) {
        if (g->nodes[i].inScene && g->nodes[i].camera >= 0) {
            TRY(addCamera(g, model, motion, i));
        }
    }
    return VPL_SUCCESS;
}

// ---- lights

static vplResult readCone(const vplJson* light, vplEmitterDef* def)
{
    const vplJson spot = vplJson_Member(light, "spot"), outer = vplJson_Member(&spot, "outerConeAngle");
    def->innerAngle = 0;
    def->outerAngle = VPL_PI / 4;
    if (spot.value == NULL) {
        return VPL_SUCCESS;
    }
    TRY(vplJson_RequireObject(&spot));
    TRY(vplJson_ReadNumber(&spot, "innerConeAngle", &def->innerAngle));
    TRY(vplJson_ReadNumber(&spot, "outerConeAngle", &def->outerAngle));
    if (!(def->outerAngle > 0 && def->outerAngle <= VPL_PI / 2 + 1e-6)) {
        return vplJson_Fail(&outer, "is %g, must be in (0, pi/2] radians", def->outerAngle);
    }
    def->outerAngle = fmin(def->outerAngle, 0.9999 * VPL_PI / 2); // a spotlight is less than a hemisphere
    if (!(def->innerAngle >= 0)) {
        const vplJson inner = vplJson_Member(&spot, "innerConeAngle");
        return vplJson_Fail(&inner, "is %g, must be in [0, outerConeAngle] radians", def->innerAngle);
    }
    def->innerAngle = fmin(def->innerAngle, def->outerAngle);
    return VPL_SUCCESS;
}

static vplResult readLight(vplGltf* g, const vplJson* light, vplEmitterDef* def)
{
    static const char* const types[] = {"point", "spot", "directional", NULL};
    int type = 0;
    double colour[3] = {1, 1, 1}, intensity = 1;
    TRY(vplJson_ReadType(light, types, "\"point\", \"spot\" or \"directional\"", &type));
    TRY(vplJson_ReadDoubles(light, "color", 3, colour));
    TRY(vplJson_ReadNumber(light, "intensity", &intensity));
    def->type = (vplEmitterType)type;
    g->losses[VPL_GLTF_RANGES] += json_object_get(light->value, "range") != NULL;
    intensity /= LUMENS;
    def->intensity = (vplRgb){(float)(colour[0] * intensity), (float)(colour[1] * intensity),
                              (float)(colour[2] * intensity)};
    TRY(def->type == VPL_EMITTER_SPOT ? readCone(light, def) : VPL_SUCCESS);
    const vplFault fault = vplCheckEmitter(def);
    return fault.field != NULL ? vplJson_Fail(light, "makes no light: its %s %s", fault.field, fault.text)
                               : VPL_SUCCESS;
}

static bool poseLight(const vplAffine* a, vplVec3* position, vplVec3* direction)
{
    double place[3], ahead[3], up[3];
    const bool good = findView(a, place, ahead, up);
    *position = vplRound3(place);
    *direction = vplRound3(ahead);
    return good;
}

static vplResult addLightPath(vplGltf* g, const vplGltfMotion* motion, int node, int emitter)
{
    int64_t first, last;
    bool moves;
    TRY(vplGltfMotion_FindFrames(g, motion, node, &first, &last, &moves));
    if (!moves) {
        return VPL_SUCCESS;
    }
    const size_t count = (size_t)(last - first) + 1;
    vplEmitterKey* keys = vplArena_Alloc(g->scratch, count, sizeof *keys);
    TRY(vplArena_Check(g->scratch));
    for (size_t i = 0; i < count; i++) {
        const double frame = (double)(first + (int64_t)i);
        const vplAffine place = vplGltfMotion_Place(g, motion, node, frame);
        keys[i] = vplMakeEmitterKey(vplScene_GetEmitter(g->scene, emitter), frame);
        poseLight(&place, &keys[i].position, &keys[i].direction);
    }
    return vplScene_SetEmitterPath(g->scene, emitter, keys, (int)count);
}

vplResult vplGltf_AddLights(vplGltf* g, const vplGltfMotion* motion)
{
    for (int i = 0; i < vplGltf_Count(g, VPL_GLTF_NODES); i++) {
        vplEmitterDef def = vplDefaultEmitterDef();
        int index;
        if (!g->nodes[i].inScene || g->nodes[i].light < 0) {
            continue;
        }
        if (!poseLight(&g->nodes[i].toModel, &def.position, &def.direction)) {
            g->losses[VPL_GLTF_NO_CAMERA]++;
            continue;
        }
        const vplJson light = vplGltf_Item(g, VPL_GLTF_LIGHTS, g->nodes[i].light);
        TRY(readLight(g, &light, &def));
        TRY(vplScene_AddEmitter(g->scene, &def, &index));
        TRY(addLightPath(g, motion, i, index));
    }
    return VPL_SUCCESS;
}
