// SPDX-License-Identifier: MIT
// A glTF file as a model: the meshes that its nodes place, and as a scene also its cameras and lights.
#include "scene/gltf.h"

#include "scene/obj.h"

#include <stdio.h>

// One warning for each kind of loss; %lld is their number.
static const char* const SENTENCES[VPL_GLTF_LOSSES] = {
    [VPL_GLTF_POINTS] = "%lld primitives of points, lines or without positions are left out",
    [VPL_GLTF_EMPTY] = "%lld meshes without any triangle that has area are left out",
    [VPL_GLTF_METALS] =
        "%lld materials are metals: half of their base colour is taken as diffuse reflectance",
    [VPL_GLTF_SKINS] = "%lld nodes have skins, which are not read: their meshes stand as they were modelled",
    [VPL_GLTF_MORPHS] = "%lld primitives have morph targets, which are not read",
    [VPL_GLTF_FLAT] = "%lld nodes are scaled to nothing and left out",
    [VPL_GLTF_RANGES] =
        "%lld lights have a range, which has no effect: light falls off with the square of the distance",
    [VPL_GLTF_ORTHOGRAPHIC] = "%lld cameras are orthographic, which is not supported, and left out",
    [VPL_GLTF_NO_CAMERA] = "%lld cameras and lights of nodes that are scaled to nothing are left out",
    [VPL_GLTF_UNUSED] = "%lld cameras and lights have no effect in a model that is part of a scene file",
    [VPL_GLTF_FLAT_FRAMES] =
        "%lld nodes with meshes are scaled to nothing at some frames: they stay as at the frame before",
    [VPL_GLTF_EMITS_ONE_SIDED] = "%lld double-sided materials emit light: from their front sides only",
    [VPL_GLTF_EMISSIVE_TEXTURES] = "%lld materials have emissive textures: they emit the mean of it evenly",
    [VPL_GLTF_NO_PICTURE] = "%lld textures name no PNG or JPEG picture: without them",
    [VPL_GLTF_OTHER_SET] = "%lld textures use other coordinates than TEXCOORD_0: without them",
};

static void warn(const vplGltf* g)
{
    for (int i = 0; i < VPL_GLTF_LOSSES; i++) {
        if (g->losses[i] > 0) {
            char sentence[200];
            snprintf(sentence, sizeof sentence, SENTENCES[i], g->losses[i]);
            vplLog(g->context, VPL_LOG_WARNING, "%s: %s", g->path, sentence);
        }
    }
}

// Lists where a part stands at each whole frame.
static vplResult movePart(vplGltf* g, const vplGltfMotion* motion, int node, vplModel* model,
                          vplModelPart* part)
{
    int64_t first, last;
    bool moves, flat = false;
    TRY(vplGltfMotion_FindFrames(g, motion, node, &first, &last, &moves));
    if (!moves) {
        return VPL_SUCCESS;
    }
    vplAffine* places = vplArena_Alloc(model->arena, (size_t)(last - first) + 1, sizeof *places);
    TRY(vplArena_Check(model->arena));
    for (int i = 0; i <= last - first; i++) {
        places[i] = vplGltfMotion_Place(g, motion, node, (double)(first + i));
        const vplMat4 matrix = vplAffine_ToMat4(&places[i]);
        const vplFault fault = vplCheckTransform(&matrix);
        if (fault.field != NULL && fault.index < 0) {
            places[i] = i > 0 ? places[i - 1] : part->toModel;
            flat = true;
        }
    }
    g->losses[VPL_GLTF_FLAT_FRAMES] += flat;
    part->places = places;
    part->placeCount = (int)(last - first) + 1;
    part->firstFrame = first;
    return VPL_SUCCESS;
}

// Adds the part of a node that has a mesh.
static vplResult addPart(vplGltf* g, const vplGltfMotion* motion, int node, vplModel* model)
{
    const vplGltfNode* n = &g->nodes[node];
    const vplJson item = vplGltf_Item(g, VPL_GLTF_NODES, node),
                  mesh = vplGltf_Item(g, VPL_GLTF_MESHES, n->mesh);
    vplModelPart part = {.toModel = n->toModel};
    const char* name = NULL;
    const vplMat4 matrix = vplAffine_ToMat4(&n->toModel);
    const vplFault fault = vplCheckTransform(&matrix);
    if (fault.field != NULL && fault.index >= 0) { // a number too large
        return vplJson_Fail(&item, "has a place in the model that %s", fault.text);
    }
    TRY(vplGltf_GetMesh(g, n->mesh, &part.mesh));
    if (fault.field != NULL || part.mesh < 0) {
        g->losses[VPL_GLTF_FLAT] += fault.field != NULL;
        return VPL_SUCCESS;
    }
    g->losses[VPL_GLTF_SKINS] += json_object_get(item.value, "skin") != NULL;
    TRY(movePart(g, motion, node, model, &part));
    TRY(vplJson_ReadString(&mesh, "name", &name));
    TRY(vplJson_ReadString(&item, "name", &name));
    part.name = name != NULL ? vplArena_CopyString(model->arena, name) : NULL;
    TRY(vplArena_Check(model->arena));
    TRY(vplArena_Reserve(model->arena, &model->parts, &model->capacity, model->count + 1, sizeof part));
    model->parts[model->count++] = part;
    return VPL_SUCCESS;
}

static vplResult readModel(vplGltf* g, bool whole, vplModel* model)
{
    vplGltfMotion motion;
    const int count = vplGltf_Count(g, VPL_GLTF_NODES);
    TRY(vplGltf_ReadNodes(g));
    TRY(vplGltf_ReadMotion(g, &motion));
    for (int i = 0; i < count; i++) {
        if (g->nodes[i].inScene && g->nodes[i].mesh >= 0) {
            TRY(addPart(g, &motion, i, model));
        }
        const bool other = g->nodes[i].camera >= 0 || g->nodes[i].light >= 0;
        g->losses[VPL_GLTF_UNUSED] += g->nodes[i].inScene && other && !whole;
    }
    if (model->count == 0) {
        return vplJson_Fail(&g->root, "places no mesh with triangles that have area, must have one");
    }
    TRY(whole ? vplGltf_AddCameras(g, model, &motion) : VPL_SUCCESS);
    TRY(whole ? vplGltf_AddLights(g, &motion) : VPL_SUCCESS);
    warn(g);
    return VPL_SUCCESS;
}

static vplResult readFile(vplGltf* g, bool whole, vplModel* model)
{
    TRY(vplArena_Check(g->scratch));
    g->prefix = vplScene_MakePrefix(g->scene, g->path, g->scratch);
    TRY(vplArena_Check(g->scratch));
    TRY(vplGltf_Open(g));
    return readModel(g, whole, model);
}

vplResult vplScene_ReadGltf(vplScene* scene, const char* path, bool whole, vplModel* model)
{
    vplArena* scratch = vplArena_Create(scene->context);
    const vplScene before = *scene;
    vplGltf g = {.scene = scene,
                 .context = scene->context,
                 .scratch = scratch,
                 .path = path,
                 .names = {.index = {.arena = scratch}}};
    const vplResult result = readFile(&g, whole, model);
    vplGltf_Close(&g);
    vplArena_Destroy(scratch);
    if (result != VPL_SUCCESS) { // what was added is freed with the scene
        scene->cameraCount = before.cameraCount;
        scene->materialCount = before.materialCount;
        scene->meshCount = before.meshCount;
        scene->emitterCount = before.emitterCount;
        vplScene_DropTextures(scene, before.textureCount);
    }
    return result;
}
