// SPDX-License-Identifier: MIT
// Reads a model file as a whole scene. Most have no camera, no ground and no light: we add them and log each.
//
// Let c be the centre of the bounds. Two square lamps with sides of LAMP_SIDE d at the distance d from c face
// it: the key lamp above the camera's left shoulder and the weak fill lamp to the right. d is LAMP_FAR times
// the distance from c to the eye, or more where a lamp would otherwise be in the picture. The key lamp's
// radiance pi / LAMP_SIDE^2 gives a surface at c that faces it the irradiance pi (less by the angle that the
// lamp fills), so that white there has the radiance 1.
#include "base/file.h"
#include "math/double3.h"
#include "math/scalar.h"
#include "scene/model.h"
#include "scene/model_look.h"

static const double LAMP_FAR = 0.6, LAMP_SIDE = 0.5;
static const vplRgb GROUND = {0.3f, 0.3f, 0.3f}; // darker than materials that are not known

typedef struct Lamp {
    const char* name;
    double to[3]; // from the centre, of any length
    double share; // of the irradiance pi
} Lamp;

static const Lamp LAMPS[2] = {{"key lamp", {-0.40, 0.75, 0.60}, 1},
                              {"fill lamp", {0.60, 0.80, 0.30}, 0.08}}; // or shadows would be black

enum { MODEL_SCENE_COOKIE = 0x56504f53 };

vplModelSceneDef vplDefaultModelSceneDef(void)
{
    return (vplModelSceneDef){
        .aspect = 16.0 / 9, .ground = true, .areaLight = true, .cookie = MODEL_SCENE_COOKIE};
}

typedef struct Adder {
    vplScene* scene;
    const char* path;
    const vplModelLook* look;
} Adder;

// Fails if there is a fault in what was to be added: "a camera can look at: its".
static vplResult requireFit(const Adder* a, const char* purpose, vplFault fault)
{
    const double* c = a->look->centre;
    return fault.field == NULL
               ? VPL_SUCCESS
               : vplFail(a->scene->context, VPL_PARSE_ERROR,
                         "%s:1:1: found bounds around (%g, %g, %g) with radius %g, expected some that %s %s "
                         "%s",
                         a->path, c[0], c[1], c[2], a->look->radius, purpose, fault.field, fault.text);
}

static vplResult addCamera(const Adder* a, const vplModelGround* ground)
{
    const vplModelLook* l = a->look;
    double eye[3], target[3], nearest = l->nearest - l->eye[2], most = l->farthest - l->eye[2];
    vplModelLook_Place(l, l->eye, eye);
    vplModelLook_Place(l, (double[3]){l->eye[0], l->eye[1], 0}, target);
    if (ground != NULL) {
        nearest = fmin(nearest, ground->nearest);
        most = fmax(most, ground->most);
    }
    vplCameraDef def = vplDefaultCameraDef();
    def.eye = vplRound3(eye);
    def.target = vplRound3(target);
    def.fovY = VPL_MODEL_FIELD;
    def.nearPlane = 0.5 * nearest;
    def.farPlane = 1.1 * most;
    TRY(requireFit(a, "a camera can look at: its", vplCheckCamera(&def)));
    vplLog(a->scene->context, VPL_LOG_WARNING,
           "%s: the file has no camera; one looks from (%g, %g, %g) at (%g, %g, %g)", a->path, eye[0], eye[1],
           eye[2], target[0], target[1], target[2]);
    return vplScene_AddCamera(a->scene, &def, NULL);
}

// Adds a quad around `centre` that spans [-x, x] and [-y, y] and faces x cross y.
static vplResult addQuad(const Adder* a, const char* name, const double centre[3], const double x[3],
                         const double y[3], vplMaterialDef material)
{
    vplObjectDef object = vplDefaultObjectDef();
    double front[3];
    vplCross3(x, y, front);
    vplNormalize3(front, front);
    for (int k = 0; k < 3; k++) {
        object.transform.m[k] = (float)(2 * x[k]);
        object.transform.m[4 + k] = (float)(2 * y[k]);
        object.transform.m[8 + k] = (float)front[k];
        object.transform.m[12 + k] = (float)centre[k];
    }
    TRY(requireFit(a, "a ground and a lamp fit: their", vplCheckTransform(&object.transform)));
    object.name = material.name = name;
    TRY(vplScene_AddMaterial(a->scene, &material, &object.material));
    return vplScene_AddObject(a->scene, &object, NULL);
}

static vplResult addGround(const Adder* a, const vplModelGround* g)
{
    double x[3], y[3];
    for (int k = 0; k < 3; k++) {
        x[k] = g->halfWidth * a->look->right[k];
        y[k] = g->halfLength * g->ahead[k];
    }
    vplLog(a->scene->context, VPL_LOG_WARNING, "%s: it stands on a grey ground of %g by %g m at y = %g",
           a->path, 2 * g->halfWidth, 2 * g->halfLength, g->centre[1]);
    vplMaterialDef material = vplDefaultMaterialDef();
    material.diffuse = GROUND;
    return addQuad(a, "ground", g->centre, x, y, material);
}

// Adds a point light that gives surfaces that face it, at the distance, the irradiance pi.
static vplResult addPoint(const Adder* a, const double position[3], double distance)
{
    const float intensity = (float)fmin(VPL_PI * distance * distance, (double)VPL_MAX_MAGNITUDE);
    vplEmitterDef def = vplDefaultEmitterDef();
    def.position = vplRound3(position);
    def.intensity = (vplRgb){intensity, intensity, intensity};
    TRY(requireFit(a, "a point light fits: its", vplCheckEmitter(&def)));
    vplLog(a->scene->context, VPL_LOG_WARNING,
           "%s: nothing emits light; a point light of %g W/sr stands at (%g, %g, %g)", a->path,
           (double)intensity, position[0], position[1], position[2]);
    return vplScene_AddEmitter(a->scene, &def, NULL);
}

// Adds a point light in place of the key lamp.
static vplResult addPointLamp(const Adder* a, double distance)
{
    double position[3];
    vplNormalize3(LAMPS[0].to, position);
    for (int k = 0; k < 3; k++) {
        position[k] = a->look->centre[k] + distance * position[k];
    }
    return addPoint(a, position, distance);
}

// Adds a point light at the file's own camera: what it sees is lit, be it inside a room or outside.
static vplResult addHeadlight(const Adder* a)
{
    double eye[3], way[3];
    vplToDouble3(a->scene->cameras[0].def.eye, eye);
    for (int k = 0; k < 3; k++) {
        way[k] = a->look->centre[k] - eye[k];
    }
    return addPoint(a, eye, fmax(sqrt(vplDot3(way, way)), 0.1 * a->look->radius));
}

// Unit vectors of a lamp: to it, and along its sides; x cross y points to the centre.
typedef struct Axes {
    double to[3], x[3], y[3];
} Axes;

static Axes axesOf(const Lamp* lamp)
{
    Axes a;
    vplNormalize3(lamp->to, a.to);
    vplNormalize3((double[3]){-a.to[2], 0, a.to[0]}, a.x);
    vplCross3(a.x, a.to, a.y);
    return a;
}

// The least distance of the lamps at which all their corners are above the upper edge of the picture. That
// edge is a plane through the eye, and a corner's height above it grows with the lamp's distance.
static double leastDistance(const vplModelLook* l, double slope)
{
    double normal[3], least = 0;
    for (int k = 0; k < 3; k++) {
        normal[k] = l->up[k] - slope * l->ahead[k];
    }
    for (int i = 0; i < 2; i++) {
        const Axes a = axesOf(&LAMPS[i]);
        const double corner = 0.5 * LAMP_SIDE * (fabs(vplDot3(a.x, normal)) + fabs(vplDot3(a.y, normal)));
        const double growth = vplDot3(a.to, normal) - corner;
        least = fmax(least, (l->eye[1] - slope * l->eye[2]) / growth);
    }
    return least;
}

static vplResult addLamp(const Adder* a, const Lamp* lamp, double distance)
{
    Axes axes = axesOf(lamp);
    const float radiance = (float)(lamp->share * VPL_PI / (LAMP_SIDE * LAMP_SIDE));
    vplMaterialDef material = vplDefaultMaterialDef();
    material.diffuse = (vplRgb){0, 0, 0};
    material.emission = (vplRgb){radiance, radiance, radiance};
    for (int k = 0; k < 3; k++) {
        axes.to[k] = a->look->centre[k] + distance * axes.to[k];
        axes.x[k] *= 0.5 * LAMP_SIDE * distance;
        axes.y[k] *= 0.5 * LAMP_SIDE * distance;
    }
    vplLog(a->scene->context, VPL_LOG_WARNING,
           "%s: nothing emits light; a square %s of %g by %g m is at (%g, %g, %g)", a->path, lamp->name,
           LAMP_SIDE * distance, LAMP_SIDE * distance, axes.to[0], axes.to[1], axes.to[2]);
    return addQuad(a, lamp->name, axes.to, axes.x, axes.y, material);
}

static vplResult addLight(const Adder* a, double slope, bool areaLight)
{
    const vplModelLook* l = a->look;
    const double distance =
        fmax(fmax(LAMP_FAR * sqrt(vplDot3(l->eye, l->eye)), 2 * l->radius), 1.01 * leastDistance(l, slope));
    if (!areaLight) {
        return addPointLamp(a, distance);
    }
    TRY(addLamp(a, &LAMPS[0], distance));
    return addLamp(a, &LAMPS[1], distance);
}

// True if a material's radiance is above a limit, or there are lights.
static bool emits(const vplScene* scene, float limit)
{
    for (int i = 0; i < scene->materialCount; i++) {
        vplRgb e = scene->materials[i].emission;
        if (e.r > limit || e.g > limit || e.b > limit) {
            return true;
        }
    }
    return scene->emitterCount > 0;
}

// Adds an object for each place of a mesh in the file.
static vplResult addObjects(vplScene* scene, const char* path, vplModel* model)
{
    static const vplAffine same = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    TRY(vplScene_ReadModel(scene, path, true, model));
    for (size_t i = 0; i < model->count; i++) {
        const vplModelPart* part = &model->parts[i];
        vplObjectDef object = vplDefaultObjectDef();
        object.name = part->name != NULL ? part->name : vplBaseName(path);
        object.material = -1;
        TRY(vplScene_AddPart(scene, &same, part, &object));
    }
    return VPL_SUCCESS;
}

static vplResult fill(vplScene* scene, const char* path, const vplModelSceneDef* def)
{
    vplModel model = {.arena = vplArena_Create(scene->context)};
    const vplResult result = addObjects(scene, path, &model);
    vplArena_Destroy(model.arena);
    TRY(result);
    const bool camera = scene->cameraCount == 0, ground = camera && def->ground;
    // Displays and signal lamps of a glTF model glow with 1 at most; they do not light it.
    const bool light = !def->unlit && !emits(scene, camera && vplModelKindOf(path) == VPL_MODEL_GLTF ? 1 : 0);
    const vplModelField field = vplModelField_Find(def->aspect);
    if (!light && !camera) {
        return VPL_SUCCESS;
    }
    const vplModelLook look = vplModelLook_Find(scene, &field);
    const vplModelGround under = vplModelGround_Find(&look, &field);
    const Adder adder = {scene, path, &look};
    TRY(camera ? addCamera(&adder, ground ? &under : NULL) : VPL_SUCCESS);
    TRY(ground ? addGround(&adder, &under) : VPL_SUCCESS);
    if (light && !camera) {
        return addHeadlight(&adder);
    }
    return light ? addLight(&adder, field.slopes[1], def->areaLight) : VPL_SUCCESS;
}

vplResult vplScene_LoadModelAlone(vplContext* context, const char* path, const vplModelSceneDef* def,
                                  vplScene** sceneOut)
{
    if (def->cookie != MODEL_SCENE_COOKIE) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "vplModelSceneDef was not made by its default function");
    }
    if (!(def->aspect >= 1e-6 && def->aspect <= 1e6)) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplModelSceneDef.aspect is %g, must be in [1e-6, 1e6]",
                       def->aspect);
    }
    vplScene* scene;
    TRY(vplScene_Create(context, &scene));
    return vplScene_Deliver(scene, fill(scene, path, def), sceneOut);
}
