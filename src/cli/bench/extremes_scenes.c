// SPDX-License-Identifier: MIT
// Scenes of vpl bench --extremes whose pictures have closed forms, or must not depend on the unit of length.
#include "cli/bench/extremes.h"

#include <math.h>
#include <stdlib.h>
#include <unistd.h>

#define REFLECTANCE 0.5

static vplResult addMaterial(vplScene* scene, double rho, double emission)
{
    vplMaterialDef material = vplDefaultMaterialDef();
    material.name = "m";
    material.diffuse = (vplRgb){(float)rho, (float)rho, (float)rho};
    material.emission = (vplRgb){(float)emission, (float)emission, (float)emission};
    return vplScene_AddMaterial(scene, &material, NULL);
}

static vplResult addPointLight(vplScene* scene, const double at[3], double intensity)
{
    vplEmitterDef light = vplDefaultEmitterDef();
    light.position = (vplVec3){(float)at[0], (float)at[1], (float)at[2]};
    light.intensity = (vplRgb){(float)intensity, (float)intensity, (float)intensity};
    return vplScene_AddEmitter(scene, &light, NULL);
}

// Adds an object of the first material; turns are about x, then y, in degrees.
static vplResult addObject(vplScene* scene, vplObjectType type, const double at[3], const double turn[2],
                           const double size[3])
{
    vplObjectDef def = vplDefaultObjectDef();
    const double rotate[3] = {turn[0] * VPL_PI / 180, turn[1] * VPL_PI / 180, 0};
    def.type = type;
    def.transform = vplMat4_FromParts((vplVec3){(float)at[0], (float)at[1], (float)at[2]}, rotate,
                                      (vplVec3){(float)size[0], (float)size[1], (float)size[2]});
    return vplScene_AddObject(scene, &def, NULL);
}

// ---- a floor under a point light

FloorScene plainFloor(void)
{
    return (FloorScene){.light = {0.5, 2, -0.25},
                        .intensity = 3,
                        .eyeHeight = 4,
                        .fov = 40 * VPL_PI / 180,
                        .nearPlane = 0.1,
                        .size = 10,
                        .width = 24,
                        .height = 24};
}

vplResult buildFloor(vplContext* context, const FloorScene* f, vplScene** sceneOut)
{
    vplCameraDef camera = vplDefaultCameraDef();
    camera.eye = (vplVec3){0, (float)f->eyeHeight, 0};
    camera.target = (vplVec3){0, 0, 0};
    camera.up = (vplVec3){0, 0, -1};
    camera.fovY = f->fov;
    camera.nearPlane = f->nearPlane;
    camera.farPlane = 1000 * f->nearPlane;
    const double middle[3] = {0, 0, 0}, down[2] = {-90, 0}, size[3] = {f->size, f->size, 1};
    TRY(vplScene_Create(context, sceneOut));
    TRY(vplScene_AddCamera(*sceneOut, &camera, NULL));
    TRY(addMaterial(*sceneOut, REFLECTANCE, 0));
    TRY(addObject(*sceneOut, VPL_OBJECT_QUAD, middle, down, size));
    if (f->blocker > 0) {
        const double at[3] = {f->light[0], 1.5, f->light[2]}, sides[3] = {f->blocker, f->blocker, 1};
        TRY(addObject(*sceneOut, VPL_OBJECT_QUAD, at, down, sides));
    }
    return addPointLight(*sceneOut, f->light, f->intensity);
}

double floorRadiance(const FloorScene* f, double column, double row)
{
    const double half = tan(f->fov / 2) * f->eyeHeight,
                 x = (2 * column / f->width - 1) * half * f->width / f->height,
                 z = (2 * row / f->height - 1) * half;
    const double dx = x - (double)(float)f->light[0], dz = z - (double)(float)f->light[2],
                 h = (double)(float)f->light[1], square = dx * dx + h * h + dz * dz;
    const double t = (h - 1.5) / h; // of the way from the light to the point, where the square lies
    if (fabs(x) > f->size / 2 || fabs(z) > f->size / 2 ||
        (f->blocker > 0 && fabs(t * dx) < f->blocker / 2 && fabs(t * dz) < f->blocker / 2)) {
        return 0;
    }
    return REFLECTANCE / VPL_PI * (double)(float)f->intensity * (h / sqrt(square)) / square;
}

// ---- a room that must look the same in every unit of length and at every place

typedef struct Thing {
    vplObjectType type;
    double at[3], turn[2], size[3];
} Thing;

static const Thing THINGS[] = {
    {VPL_OBJECT_QUAD, {0, 0, 0}, {-90, 0}, {4, 4, 1}},
    {VPL_OBJECT_QUAD, {0, 3, 0}, {90, 0}, {4, 4, 1}},
    {VPL_OBJECT_QUAD, {0, 1.5, -2}, {0, 0}, {4, 3, 1}},
    {VPL_OBJECT_QUAD, {0, 1.5, 2}, {0, 180}, {4, 3, 1}},
    {VPL_OBJECT_QUAD, {-2, 1.5, 0}, {0, 90}, {4, 3, 1}},
    {VPL_OBJECT_QUAD, {2, 1.5, 0}, {0, -90}, {4, 3, 1}},
    {VPL_OBJECT_BOX, {0.6, 0.5, -0.3}, {0, 20}, {0.8, 1, 0.9}},
};
static const double EYE[3] = {-0.3, 1.4, 1.9}, TARGET[3] = {0.1, 1, -1}, LAMP[3] = {-0.5, 2.6, 0.2};

enum { THING_COUNT = sizeof THINGS / sizeof *THINGS };

RoomScene plainRoom(void)
{
    return (RoomScene){.scale = 1, .farOverNear = 1000, .intensity = 10};
}

static void placeAt(const RoomScene* room, const double p[3], double out[3])
{
    for (int axis = 0; axis < 3; axis++) {
        out[axis] = room->scale * p[axis] + room->offset[axis];
    }
}

vplResult buildRoomAt(vplContext* context, const RoomScene* room, vplScene** sceneOut)
{
    double eye[3], target[3], lamp[3];
    placeAt(room, EYE, eye);
    placeAt(room, TARGET, target);
    placeAt(room, LAMP, lamp);
    vplCameraDef camera = vplDefaultCameraDef();
    camera.eye = (vplVec3){(float)eye[0], (float)eye[1], (float)eye[2]};
    camera.target = (vplVec3){(float)target[0], (float)target[1], (float)target[2]};
    camera.fovY = 70 * VPL_PI / 180;
    camera.farPlane = 20 * room->scale;
    camera.nearPlane = camera.farPlane / room->farOverNear;
    TRY(vplScene_Create(context, sceneOut));
    TRY(vplScene_AddCamera(*sceneOut, &camera, NULL));
    TRY(addMaterial(*sceneOut, REFLECTANCE, 0));
    for (int i = 0; i < THING_COUNT; i++) {
        const Thing* thing = &THINGS[i];
        double at[3];
        placeAt(room, thing->at, at);
        const double size[3] = {room->scale * thing->size[0], room->scale * thing->size[1],
                                room->scale * thing->size[2]};
        TRY(addObject(*sceneOut, thing->type, at, thing->turn, size));
    }
    return addPointLight(*sceneOut, lamp, room->intensity);
}

static json_t* vectorJson(const RoomScene* room, const double p[3])
{
    double at[3];
    placeAt(room, p, at);
    return json_pack("[f, f, f]", at[0], at[1], at[2]);
}

static json_t* roomJson(const RoomScene* room)
{
    json_t* objects = json_array();
    for (int i = 0; i < THING_COUNT; i++) {
        const Thing* t = &THINGS[i];
        json_array_append_new(objects, json_pack("{s:s, s:s, s:o, s:[f, f, i], s:[f, f, f]}", "type",
                                                 t->type == VPL_OBJECT_QUAD ? "quad" : "box", "material", "m",
                                                 "translate", vectorJson(room, t->at), "rotate", t->turn[0],
                                                 t->turn[1], 0, "scale", t->size[0], t->size[1], t->size[2]));
    }
    return json_pack("{s:{s:o, s:o, s:i, s:f, s:i}, s:{s:{s:[f, f, f]}}, s:o, s:[{s:s, s:o, s:[i, i, i]}]}",
                     "camera", "eye", vectorJson(room, EYE), "target", vectorJson(room, TARGET), "fov_y", 70,
                     "near", 0.02, "far", 20, "materials", "m", "diffuse", REFLECTANCE, REFLECTANCE,
                     REFLECTANCE, "objects", objects, "lights", "type", "point", "position",
                     vectorJson(room, LAMP), "intensity", 10, 10, 10);
}

vplResult loadRoomAt(vplContext* context, const RoomScene* room, vplScene** sceneOut)
{
    char path[] = EXTREME_FILE "XXXXXX";
    const int file = mkstemp(path);
    json_t* root = roomJson(room);
    vplResult result = VPL_FILE_ERROR;
    if (root != NULL && file >= 0 && json_dumpfd(root, file, 0) == 0) {
        result = vplScene_Load(context, path, sceneOut);
    }
    json_decref(root);
    if (file >= 0) {
        close(file);
        unlink(path);
    }
    return result;
}

// ---- a furnace: every point sends 1 / (1 - rho)

vplResult buildFurnace(vplContext* context, double rho, double fov, vplScene** sceneOut)
{
    vplCameraDef camera = vplDefaultCameraDef();
    camera.eye = (vplVec3){-0.3f, 0.2f, 0.9f};
    camera.nearPlane = 1e-7; // of 179.9 degrees, 1 m away on the axis is 1e-3 m away at the border
    camera.fovY = fov;
    TRY(vplScene_Create(context, sceneOut));
    TRY(vplScene_AddCamera(*sceneOut, &camera, NULL));
    TRY(addMaterial(*sceneOut, rho, 1));
    for (int i = 0; i < 6; i++) {
        const double side = i % 2 ? 1 : -1,
                     at[3] = {i / 2 == 0 ? side : 0, i / 2 == 1 ? side : 0, i / 2 == 2 ? side : 0};
        const double turn[2] = {i / 2 == 1 ? 90 * side : 0, i / 2 == 0 ? -90 * side : i == 5 ? 180 : 0};
        const double size[3] = {2, 2, 1};
        TRY(addObject(*sceneOut, VPL_OBJECT_QUAD, at, turn, size));
    }
    return VPL_SUCCESS;
}
