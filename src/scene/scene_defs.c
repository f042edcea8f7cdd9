// SPDX-License-Identifier: MIT
// What a scene is made of: the defs' defaults, and their checks.
#include "scene/scene.h"

#include <stdio.h>
#include <string.h>

enum {
    CAMERA_COOKIE = 0x56504c34,
    MATERIAL_COOKIE,
    OBJECT_COOKIE,
    EMITTER_COOKIE,
    MESH_COOKIE,
    TEXTURE_COOKIE
};

static const double DEGREE = VPL_PI / 180;

vplCameraDef vplDefaultCameraDef(void)
{
    return (vplCameraDef){{0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 40 * DEGREE, 0.1, 100, CAMERA_COOKIE};
}

vplMaterialDef vplDefaultMaterialDef(void)
{
    return (vplMaterialDef){.diffuse = {0.5f, 0.5f, 0.5f},
                            .texture = -1,
                            .textureScale = {1, 1},
                            .alphaTexture = -1,
                            .opacity = 1,
                            .cookie = MATERIAL_COOKIE};
}

vplTextureDef vplDefaultTextureDef(void)
{
    return (vplTextureDef){.channels = 3, .cookie = TEXTURE_COOKIE};
}

vplMeshDef vplDefaultMeshDef(void)
{
    return (vplMeshDef){.cookie = MESH_COOKIE};
}

vplObjectDef vplDefaultObjectDef(void)
{
    return (vplObjectDef){NULL, VPL_OBJECT_QUAD, 0, 0, vplMat4_Identity(), OBJECT_COOKIE};
}

vplEmitterDef vplDefaultEmitterDef(void)
{
    return (vplEmitterDef){.type = VPL_EMITTER_POINT,
                           .direction = {0, -1, 0},
                           .intensity = {1, 1, 1},
                           .innerAngle = 20 * DEGREE,
                           .outerAngle = 30 * DEGREE,
                           .cookie = EMITTER_COOKIE};
}

// ---- checks

vplResult vplScene_ReportFault(const vplScene* scene, const char* subject, vplFault fault)
{
    if (fault.field == NULL) {
        return VPL_SUCCESS;
    }
    char component[16] = "";
    if (fault.index >= 0) {
        snprintf(component, sizeof component, "[%d]", fault.index);
    }
    return vplFail(scene->context, VPL_INVALID_ARGUMENT, "%s%s%s %s", subject, fault.field, component,
                   fault.text);
}

static vplResult requireCookie(const vplScene* scene, const char* type, bool present)
{
    return present ? VPL_SUCCESS
                   : vplFail(scene->context, VPL_INVALID_ARGUMENT, "%s was not made by its default function",
                             type);
}

vplResult vplScene_CheckIndex(const vplScene* scene, const char* what, int index, int count)
{
    return index >= 0 && index < count
               ? VPL_SUCCESS
               : vplFail(scene->context, VPL_INVALID_ARGUMENT, "%s %d does not exist, the scene has %d", what,
                         index, count);
}

vplResult vplScene_CheckCamera(const vplScene* scene, const char* subject, const vplCameraDef* def)
{
    TRY(requireCookie(scene, "vplCameraDef", def->cookie == CAMERA_COOKIE));
    return vplScene_ReportFault(scene, subject, vplCheckCamera(def));
}

vplResult vplScene_CheckTexture(const vplScene* scene, const vplTextureDef* def)
{
    TRY(requireCookie(scene, "vplTextureDef", def->cookie == TEXTURE_COOKIE));
    return vplScene_ReportFault(scene, "vplTextureDef.", vplCheckTexture(def));
}

vplResult vplScene_CheckMaterial(const vplScene* scene, const vplMaterialDef* def, int index)
{
    TRY(requireCookie(scene, "vplMaterialDef", def->cookie == MATERIAL_COOKIE));
    TRY(vplScene_ReportFault(scene, "vplMaterialDef.", vplCheckMaterial(def, scene->textureCount)));
    for (int i = 0; def->name != NULL && i < scene->materialCount; i++) {
        const char* taken = scene->materials[i].name;
        if (i != index && taken != NULL && strcmp(taken, def->name) == 0) {
            return vplFail(scene->context, VPL_INVALID_ARGUMENT,
                           "vplMaterialDef.name \"%s\" is taken, must be unique", def->name);
        }
    }
    return VPL_SUCCESS;
}

vplResult vplScene_CheckMesh(const vplScene* scene, const vplMeshDef* def)
{
    TRY(requireCookie(scene, "vplMeshDef", def->cookie == MESH_COOKIE));
    return vplScene_ReportFault(scene, "vplMeshDef.", vplCheckMesh(def, scene->materialCount));
}

vplResult vplScene_CheckObjectMaterial(const vplScene* scene, vplObjectType type, int mesh, int material)
{
    const bool own = type == VPL_OBJECT_MESH && material == -1 && scene->meshes[mesh].materials != NULL;
    return own || (material >= 0 && material < scene->materialCount)
               ? VPL_SUCCESS
               : vplFail(scene->context, VPL_INVALID_ARGUMENT,
                         "vplObjectDef.material is %d, must be one of the scene's %d materials", material,
                         scene->materialCount);
}

vplResult vplScene_CheckObject(const vplScene* scene, const vplObjectDef* def)
{
    TRY(requireCookie(scene, "vplObjectDef", def->cookie == OBJECT_COOKIE));
    TRY(vplScene_ReportFault(scene, "vplObjectDef.", vplCheckTransform(&def->transform)));
    if (def->type != VPL_OBJECT_QUAD && def->type != VPL_OBJECT_BOX && def->type != VPL_OBJECT_MESH) {
        return vplFail(scene->context, VPL_INVALID_ARGUMENT,
                       "vplObjectDef.type is %d, must be a vplObjectType", (int)def->type);
    }
    bool mesh = def->type == VPL_OBJECT_MESH;
    if (mesh && (def->mesh < 0 || def->mesh >= scene->meshCount)) {
        return vplFail(scene->context, VPL_INVALID_ARGUMENT,
                       "vplObjectDef.mesh is %d, must be one of the scene's %d meshes", def->mesh,
                       scene->meshCount);
    }
    return vplScene_CheckObjectMaterial(scene, def->type, def->mesh, def->material);
}

vplResult vplScene_CheckEmitter(const vplScene* scene, const vplEmitterDef* def)
{
    TRY(requireCookie(scene, "vplEmitterDef", def->cookie == EMITTER_COOKIE));
    return vplScene_ReportFault(scene, "vplEmitterDef.", vplCheckEmitter(def));
}
