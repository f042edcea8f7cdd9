// SPDX-License-Identifier: MIT
#include "patch_support.h"

#include "geometry/triangle.h"
#include "math/vec.h"

#include <stdlib.h>

vplGeometry* geometryOf(vplContext* context, const Shape* shape, float rho, float emission)
{
    vplScene* scene;
    vplMaterialDef material = vplDefaultMaterialDef();
    material.diffuse = (vplRgb){rho, rho, rho};
    material.emission = (vplRgb){emission, emission, emission};
    assert_int_equal(vplScene_Create(context, &scene), VPL_SUCCESS);
    assert_int_equal(vplScene_AddMaterial(scene, &material, NULL), VPL_SUCCESS);
    addShape(scene, shape, false, NULL);
    return buildGeometry(scene);
}

static vplVec3 place(vplVec3 p, ModelUnit unit)
{
    if (unit == MODEL_SCALED) {
        return vplVec(p.x * 2 / 555 - 1, p.y * 2 / 555 - 1, p.z * 2 / 555 - 1);
    }
    return vplScale(unit == MODEL_METRES ? 0.01f : 1, p);
}

vplGeometry* testModel(vplContext* context, ModelUnit unit, float rho)
{
    Table t = loadTable("cornell_testmodel.csv");
    Shape shape = {0};
    for (int row = 0; row < t.rows; row++) {
        addTriangle(&shape, place(vectorOf(&t, row, "v0"), unit), place(vectorOf(&t, row, "v2"), unit),
                    place(vectorOf(&t, row, "v1"), unit));
    }
    vplGeometry* geometry = geometryOf(context, &shape, rho, 0);
    freeShape(&shape);
    freeTable(&t);
    return geometry;
}

vplPatchSides* sidesOf(const vplPatches* patches, const vplVec3* position)
{
    vplPatchSidesDef def = vplDefaultPatchSidesDef();
    vplEmitterDef emitter = vplDefaultEmitterDef();
    vplPatchSides* sides = NULL;
    if (position != NULL) {
        emitter.position = *position;
        def.emitters = &emitter;
        def.emitterCount = 1;
    }
    if (vplPatchSides_Create(patches, &def, &sides) != VPL_SUCCESS) {
        fail_msg("%s", takeMessage());
    }
    return sides;
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

// Returns the incentre: corners weighted by the lengths of the opposite edges.
static vplVec3 incentreOf(const vplVec3 p[3])
{
    double edge[3], centre[3] = {0};
    for (int k = 0; k < 3; k++) {
        const vplVec3 along = vplSub(p[(k + 2) % 3], p[(k + 1) % 3]);
        edge[k] = sqrt((double)along.x * (double)along.x + (double)along.y * (double)along.y +
                       (double)along.z * (double)along.z);
    }
    for (int k = 0; k < 9; k++) {
        centre[k % 3] += edge[k / 3] / (edge[0] + edge[1] + edge[2]) * (double)vplComponent(p[k / 3], k % 3);
    }
    return vplVec((float)centre[0], (float)centre[1], (float)centre[2]);
}

static vplPatchSide sideOf(const vplPatches* p, int patch, int face, uint16_t open)
{
    const vplPatchNode* n = &p->nodes[p->patches[patch]];
    const vplMaterialDef* material = &p->geometry->materials[p->geometry->triangleMaterials[n->triangle]];
    const vplVec3 normal = p->geometry->normals[n->triangle];
    const vplTriangleCorners c = vplCornersOf(p->positions, n->corners);
    vplPatchSide side = {.patch = patch,
                         .back = face == 1,
                         .open = open,
                         .area = (float)(vplTriangle_Area(&c) * __builtin_popcount(open) / 16),
                         .corners = {p->positions[n->corners[0]], p->positions[n->corners[face == 0 ? 1 : 2]],
                                     p->positions[n->corners[face == 0 ? 2 : 1]]},
                         .normal = face == 0 ? normal : vplNegate(normal),
                         .reflectance = material->diffuse};
    side.incentre = incentreOf(side.corners);
    return side;
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

SidesFixture openFronts(vplContext* context, const vplVec3* corners, int triangleCount, float size,
                        int rounds)
{
    SidesFixture f;
    Shape shape = {0};
    for (int i = 0; i < triangleCount; i++) {
        addTriangle(&shape, corners[3 * i], corners[3 * i + 1], corners[3 * i + 2]);
    }
    f.geometry = geometryOf(context, &shape, 0.5f, 0);
    f.patches = openPatches(f.geometry, size > 0 ? size : 1e-6f, rounds);
    f.sides = openSides(f.patches, frontsOpen);
    freeShape(&shape);
    return f;
}

void closeFronts(SidesFixture* f)
{
    closeSides(f->sides);
    vplPatches_Destroy(f->patches);
    vplGeometry_Destroy(f->geometry);
}

void boxCorners(float x, float y, float z, vplVec3 corners[36])
{
    // Each face has an origin and two axes whose cross product points inwards.
    static const int faces[6][3][3] = {{{0, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{1, 0, 0}, {0, 0, 1}, {0, 1, 0}},
                                       {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}}, {{0, 1, 0}, {1, 0, 0}, {0, 0, 1}},
                                       {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 0, 1}, {0, 1, 0}, {1, 0, 0}}};
    // Diagonals of opposite faces cross, as in the cube of tests/data/incentre_estimator.csv.
    static const int order[2][6][2] = {{{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}},
                                       {{1, 0}, {1, 1}, {0, 1}, {1, 0}, {0, 1}, {0, 0}}};
    for (int i = 0; i < 36; i++) {
        const int(*f)[3] = faces[i / 6];
        const int a = order[i / 6 % 2][i % 6][0], b = order[i / 6 % 2][i % 6][1];
        corners[i] = (vplVec3){x * (float)(f[0][0] + a * f[1][0] + b * f[2][0]),
                               y * (float)(f[0][1] + a * f[1][1] + b * f[2][1]),
                               z * (float)(f[0][2] + a * f[1][2] + b * f[2][2])};
    }
}
