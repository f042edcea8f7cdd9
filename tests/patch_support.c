// SPDX-License-Identifier: MIT
#include "patch_support.h"

#include "geometry/triangle.h"
#include "math/vec.h"

#include <stdlib.h>

vplGeometry* openTestModel(vplContext* context)
{
    Table t = loadTable("cornell_testmodel.csv");
    Shape shape = {0};
    for (int i = 0; i < t.rows; i++) {
        addTriangle(&shape, vectorOf(&t, i, "v0"), vectorOf(&t, i, "v1"), vectorOf(&t, i, "v2"));
    }
    vplScene* scene = sceneOf(context, 0.5f);
    addShape(scene, &shape, false, NULL);
    freeShape(&shape);
    freeTable(&t);
    return freezeScene(scene);
}

// ---- patches

vplPatches* openPatches(const vplGeometry* geometry, float size, int rounds)
{
    vplPatchDef def = vplDefaultPatchDef();
    vplPatches* patches = NULL;
    def.size = size;
    def.rounds = rounds;
    if (vplPatches_Create(geometry, &def, &patches) != VPL_SUCCESS) {
        fail_msg("%s", takeMessage());
    }
    return patches;
}

vplPatches* openUnevenPatches(const vplGeometry* geometry, int rounds, uint64_t seed)
{
    vplPatches* patches = openPatches(geometry, 1, 0);
    Dice dice = {seed, 0};
    for (int round = 0; round < rounds; round++) {
        float* priorities = calloc((size_t)patches->patchCount + 1, sizeof *priorities);
        vplPatches* refined = NULL;
        for (int i = 0; i < patches->patchCount; i++) {
            priorities[i] = roll(&dice, 0, 1) < 0.5f;
        }
        if (vplPatches_Refine(patches, priorities, VPL_MAX_PATCHES, &refined) != VPL_SUCCESS) {
            fail_msg("%s", takeMessage());
        }
        free(priorities);
        vplPatches_Destroy(patches);
        patches = refined;
    }
    return patches;
}

// ---- sides

uint16_t allOpen(const vplPatches* patches, int patch, int face)
{
    (void)patches;
    (void)patch;
    (void)face;
    return 0xffff;
}

uint16_t frontsOpen(const vplPatches* patches, int patch, int face)
{
    (void)patches;
    (void)patch;
    return face == 0 ? 0xffff : 0;
}

static vplPatchSide sideOf(const vplPatches* p, int patch, int face, uint16_t open)
{
    const vplPatchNode* n = &p->nodes[p->patches[patch]];
    const vplMaterialDef* material = &p->geometry->materials[p->geometry->triangleMaterials[n->triangle]];
    const vplVec3 normal = p->geometry->normals[n->triangle];
    const vplTriangleCorners c = vplCornersOf(p->positions, n->corners);
    return (vplPatchSide){.patch = patch,
                          .back = face == 1,
                          .open = open,
                          .area = (float)(vplTriangle_Area(&c) * __builtin_popcount(open) / 16),
                          .corners = {p->positions[n->corners[0]],
                                      p->positions[n->corners[face == 0 ? 1 : 2]],
                                      p->positions[n->corners[face == 0 ? 2 : 1]]},
                          .normal = face == 0 ? normal : vplNegate(normal),
                          .reflectance = material->diffuse};
}

vplPatchSides* openSides(const vplPatches* patches, OpenFcn* open)
{
    const size_t most = 2 * (size_t)patches->patchCount;
    vplPatchSides* sides = calloc(1, sizeof *sides);
    vplPatchSide* list = malloc(most * sizeof *list);
    int* ofPatch = malloc(most * sizeof *ofPatch);
    for (int i = 0; i < 2 * patches->patchCount; i++) {
        const uint16_t cells = open(patches, i / 2, i % 2);
        ofPatch[i] = cells != 0 ? sides->count : -1;
        if (cells != 0) {
            list[sides->count++] = sideOf(patches, i / 2, i % 2, cells);
        }
    }
    sides->patches = patches;
    sides->sides = list;
    sides->ofPatch = ofPatch;
    sides->context = patches->context;
    return sides;
}

void closeSides(vplPatchSides* sides)
{
    free((void*)sides->sides);
    free((void*)sides->ofPatch);
    free(sides);
}

vplPatchMesh* meshOf(const vplPatchSides* sides)
{
    vplPatchMesh* mesh = NULL;
    if (vplPatchMesh_Create(sides, &mesh) != VPL_SUCCESS) {
        fail_msg("%s", takeMessage());
    }
    return mesh;
}

void closeMesh(vplPatchMesh* mesh)
{
    vplPatchSides* sides = (vplPatchSides*)mesh->sides;
    vplPatches* patches = (vplPatches*)sides->patches;
    vplGeometry* geometry = (vplGeometry*)patches->geometry;
    vplPatchMesh_Destroy(mesh);
    closeSides(sides);
    vplPatches_Destroy(patches);
    vplGeometry_Destroy(geometry);
}
