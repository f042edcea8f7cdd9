// SPDX-License-Identifier: MIT
// Reads an OBJ file as a whole scene. It has no camera and seldom a light: we add both and log them.
//
// Let c be the centre of the bounds and r half their diagonal. The camera is at c + 3.2 r along (0.3, 0.25,
// 1) and looks at c with a field of view of 40 degrees. From there the bounding sphere is 36 degrees wide and
// fits the picture. The light is at c + 2 r along (1, 2, 2), above the camera's shoulder. Its intensity gives
// a surface at c the irradiance pi, so a white surface there has the radiance 1.
#include "base/file.h"
#include "math/vec.h"
#include "scene/scene.h"

typedef struct Bounds {
    vplVec3 centre;
    float radius;
} Bounds;

static Bounds boundsOf(const vplMeshDef* mesh)
{
    vplVec3 low = mesh->positions[0], high = low;
    for (int i = 1; i < mesh->vertexCount; i++) {
        vplVec3 p = mesh->positions[i];
        low = vplVec(fminf(low.x, p.x), fminf(low.y, p.y), fminf(low.z, p.z));
        high = vplVec(fmaxf(high.x, p.x), fmaxf(high.y, p.y), fmaxf(high.z, p.z));
    }
    return (Bounds){vplScale(0.5f, vplAdd(low, high)), 0.5f * vplLength(vplSub(high, low))};
}

static bool emits(const vplScene* scene)
{
    for (int i = 0; i < scene->materialCount; i++) {
        vplRgb e = scene->materials[i].emission;
        if (e.r > 0 || e.g > 0 || e.b > 0) {
            return true;
        }
    }
    return false;
}

static vplVec3 pointAround(const Bounds* b, float distance, vplVec3 direction)
{
    return vplAdd(b->centre, vplScale(distance * b->radius, vplNormalize(direction)));
}

static vplResult addCamera(vplScene* scene, const char* path, const Bounds* b)
{
    vplCameraDef def = vplDefaultCameraDef();
    def.eye = pointAround(b, 3.2f, vplVec(0.3f, 0.25f, 1));
    def.target = b->centre;
    def.near = 1.1 * (double)b->radius; // half way to the sphere
    def.far = 4.4 * (double)b->radius;
    vplFault fault = vplCheckCamera(&def);
    if (fault.field != NULL) {
        return vplFail(scene->context, VPL_PARSE_ERROR,
                       "%s:1:1: found bounds around (%g, %g, %g) with radius %g, expected some that a camera "
                       "can look at: its %s %s",
                       path, (double)b->centre.x, (double)b->centre.y, (double)b->centre.z, (double)b->radius,
                       fault.field, fault.text);
    }
    vplLog(scene->context, VPL_LOG_WARNING,
           "%s: an OBJ file has no camera; it looks from (%g, %g, %g) at (%g, %g, %g)", path,
           (double)def.eye.x, (double)def.eye.y, (double)def.eye.z, (double)def.target.x,
           (double)def.target.y, (double)def.target.z);
    return vplScene_AddCamera(scene, &def, NULL);
}

static vplResult addLight(vplScene* scene, const char* path, const Bounds* b)
{
    float distance = 2 * b->radius;
    float intensity = fminf((float)VPL_PI * distance * distance, VPL_MAX_MAGNITUDE);
    vplEmitterDef def = vplDefaultEmitterDef();
    def.position = pointAround(b, 2, vplVec(1, 2, 2));
    def.intensity = (vplRgb){intensity, intensity, intensity};
    vplLog(scene->context, VPL_LOG_WARNING,
           "%s: nothing emits light; a point light of %g W/sr stands at (%g, %g, %g)", path,
           (double)intensity, (double)def.position.x, (double)def.position.y, (double)def.position.z);
    return vplScene_AddEmitter(scene, &def, NULL);
}

static vplResult fill(vplScene* scene, const char* path)
{
    vplObjectDef object = vplDefaultObjectDef();
    TRY(vplScene_LoadObj(scene, path, &object.mesh));
    object.name = vplBaseName(path);
    object.type = VPL_OBJECT_MESH;
    object.material = -1;
    TRY(vplScene_AddObject(scene, &object, NULL));
    const Bounds bounds = boundsOf(&scene->meshes[object.mesh]);
    TRY(addCamera(scene, path, &bounds));
    return emits(scene) ? VPL_SUCCESS : addLight(scene, path, &bounds);
}

vplResult vplScene_LoadObjAlone(vplContext* context, const char* path, vplScene** sceneOut)
{
    vplScene* scene;
    TRY(vplScene_Create(context, &scene));
    return vplArena_Deliver(scene->arena, fill(scene, path), scene, sceneOut);
}
