// SPDX-License-Identifier: MIT
// The objects of scene files: quads, boxes and meshes with their materials and transforms.
#include "base/file.h"
#include "math/matrix.h"
#include "scene/scene_json.h"

#include <string.h>

static vplResult readMaterialReference(const vplSceneLoader* l, const vplJson* object, int* out)
{
    const char* name = NULL;
    TRY(vplJson_ReadString(object, "material", &name));
    for (int i = 0; name != NULL && i < l->materialCount; i++) {
        if (strcmp(l->scene->materials[i].name, name) == 0) {
            *out = i;
            return VPL_SUCCESS;
        }
    }
    const vplJson member = vplJson_Member(object, "material");
    return vplJson_Fail(&member, "is \"%.80s\", which is not among the materials", name ? name : "");
}

static vplResult readScale(const vplJson* object, vplVec3* out)
{
    if (json_is_number(json_object_get(object->value, "scale"))) {
        double uniform = 1;
        TRY(vplJson_ReadNumber(object, "scale", &uniform));
        *out = (vplVec3){(float)uniform, (float)uniform, (float)uniform};
        return VPL_SUCCESS;
    }
    return vplJson_ReadFloats(object, "scale", 3, out);
}

// Reads "rotate", degrees, into quarter turns.
static vplResult readRotation(const vplJson* object, double quarters[3])
{
    const vplJson rotate = vplJson_Member(object, "rotate");
    TRY(vplJson_ReadDoubles(object, "rotate", 3, quarters));
    for (int i = 0; i < 3; i++) {
        if (!(quarters[i] >= -1e6 && quarters[i] <= 1e6)) {
            const vplJson angle = vplJson_Element(&rotate, i);
            return vplJson_Fail(&angle, "is %g, must be in [-1e6, 1e6] degrees", quarters[i]);
        }
        quarters[i] /= 90;
    }
    return VPL_SUCCESS;
}

static vplResult readTransform(const vplJson* object, vplMat4* out)
{
    const vplJson matrix = vplJson_Member(object, "matrix");
    const double* origin = object->file->origin;
    if (matrix.value != NULL) {
        if (json_object_get(object->value, "translate") || json_object_get(object->value, "rotate") ||
            json_object_get(object->value, "scale")) {
            return vplJson_Fail(&matrix, "excludes \"translate\", \"rotate\" and \"scale\"");
        }
        double m[16];
        TRY(vplJson_ReadDoubles(object, "matrix", 16, m));
        for (int i = 0; i < 16; i++) {
            const bool translation = i >= 12 && i < 15;
            out->m[i] = (float)(translation ? m[i] - origin[i - 12] : m[i]);
        }
        return vplJson_ReportFault(object, vplCheckTransform(out));
    }
    vplVec3 translate = {(float)-origin[0], (float)-origin[1], (float)-origin[2]}, scale = {1, 1, 1};
    double quarters[3] = {0, 0, 0};
    TRY(vplJson_ReadPosition(object, "translate", &translate));
    TRY(readRotation(object, quarters));
    TRY(readScale(object, &scale));
    const vplAffine a = vplAffine_FromParts(translate, quarters, scale);
    *out = vplAffine_ToMat4(&a);
    vplFault fault = vplCheckTransform(out);
    if (fault.field != NULL) {
        const bool translation = fault.index >= 12; // in the last column; otherwise the scale is at fault
        fault.field = translation ? "translate" : "scale";
        fault.index = translation ? fault.index - 12 : -1;
    }
    return vplJson_ReportFault(object, fault);
}

// Reads a model file, unless an earlier object named the same file; *out is its number.
static vplResult readModelFile(vplSceneLoader* l, const char* path, int* out)
{
    const size_t length = strlen(path), count = l->modelFiles.index.count;
    *out = vplNames_Find(&l->modelFiles, path, length);
    if (*out >= 0) {
        return VPL_SUCCESS;
    }
    vplModel model = {.arena = l->scratch};
    TRY(vplScene_ReadModel(l->scene, path, false, &model));
    TRY(vplArena_Reserve(l->scratch, &l->models, &l->modelCapacity, count + 1, sizeof model));
    l->models[count] = model;
    return vplNames_Add(&l->modelFiles, path, length, out);
}

static vplResult readModel(vplSceneLoader* l, const vplJson* object, int* out)
{
    const char* name = NULL;
    const vplJson member = vplJson_Member(object, "file");
    TRY(vplJson_ReadString(object, "file", &name));
    char* path = vplPathBeside(l->json.context, l->json.name, name, strlen(name));
    if (path == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    vplResult result;
    if (!vplIsRegularFile(l->json.context, path)) {
        result = vplJson_Fail(&member, "is \"%.80s\", but there is no file %.200s", name, path);
    } else if (!vplIsModelPath(path)) {
        result = vplJson_Fail(&member, "is \"%.80s\", must end in " VPL_MODEL_ENDINGS, name);
    } else {
        result = readModelFile(l, path, out);
    }
    vplFree(l->json.context, path);
    return result;
}

// Adds an object for each part of the model, with the same name and material.
static vplResult addParts(vplSceneLoader* l, const vplJson* object, vplObjectDef* def)
{
    int number = 0;
    TRY(readModel(l, object, &number));
    const vplModel* model = &l->models[number];
    const vplAffine outer = vplAffine_FromMat4(&def->transform);
    for (size_t i = 0; i < model->count; i++) {
        const vplAffine whole = vplAffine_Multiply(&outer, &model->parts[i].toModel);
        const vplMat4 transform = vplAffine_ToMat4(&whole);
        TRY(vplJson_ReportFault(object, vplCheckTransform(&transform)));
        TRY(vplScene_AddPart(l->scene, &outer, &model->parts[i], def));
    }
    return VPL_SUCCESS;
}

vplResult vplSceneLoader_ReadObject(vplSceneLoader* l, const vplJson* object)
{
    static const char* const types[] = {"quad", "box", "mesh", NULL};
    static const char* const shapeKeys[] = {"!type",  "name",  "!material", "translate",
                                            "rotate", "scale", "matrix",    NULL};
    static const char* const meshKeys[] = {"!type",  "name",  "material", "!file", "translate",
                                           "rotate", "scale", "matrix",   NULL};
    vplObjectDef def = vplDefaultObjectDef();
    int type;
    TRY(vplJson_ReadType(object, types, "\"quad\", \"box\" or \"mesh\"", &type));
    def.type = (vplObjectType)type;
    const bool mesh = def.type == VPL_OBJECT_MESH;
    TRY(vplJson_CheckKeys(object, mesh ? meshKeys : shapeKeys));
    TRY(vplJson_ReadString(object, "name", &def.name));
    def.material = -1;
    if (!mesh || json_object_get(object->value, "material") != NULL) {
        TRY(readMaterialReference(l, object, &def.material));
    }
    TRY(readTransform(object, &def.transform));
    return mesh ? addParts(l, object, &def) : vplScene_AddObject(l->scene, &def, NULL);
}
