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

// ---- a stand-in for vplPatches_Create

typedef struct Tree {
    vplVec3* positions;
    vplPatchNode* nodes;
    int* patches;
    int positionCount, nodeCount, patchCount;
} Tree;

static uint32_t intern(Tree* t, vplVec3 p)
{
    for (int i = 0; i < t->positionCount; i++) {
        if (t->positions[i].x == p.x && t->positions[i].y == p.y && t->positions[i].z == p.z) {
            return (uint32_t)i;
        }
    }
    t->positions = realloc(t->positions, (size_t)(t->positionCount + 1) * sizeof *t->positions);
    t->positions[t->positionCount] = p;
    return (uint32_t)t->positionCount++;
}

static void addNode(Tree* t, uint32_t a, uint32_t b, uint32_t c, int triangle, int parent)
{
    const uint32_t in[3] = {a, b, c};
    float length[3];
    for (int k = 0; k < 3; k++) {
        const vplVec3 d = vplSub(t->positions[in[k]], t->positions[in[(k + 1) % 3]]);
        length[k] = vplDot(d, d);
    }
    const int k = length[0] >= length[1] && length[0] >= length[2] ? 0 : length[1] >= length[2] ? 1 : 2;
    t->nodes = realloc(t->nodes, (size_t)(t->nodeCount + 1) * sizeof *t->nodes);
    t->nodes[t->nodeCount++] =
        (vplPatchNode){{in[(k + 2) % 3], in[k], in[(k + 1) % 3]}, triangle, parent, -1, -1};
}

static float longestOf(const Tree* t, const vplPatchNode* n)
{
    return vplLength(vplSub(t->positions[n->corners[1]], t->positions[n->corners[2]]));
}

static void bisect(Tree* t, int node)
{
    const vplPatchNode n = t->nodes[node];
    const uint32_t middle = intern(
        t, vplAdd(vplScale(0.5f, t->positions[n.corners[1]]), vplScale(0.5f, t->positions[n.corners[2]])));
    t->nodes[node].children = t->nodeCount;
    addNode(t, n.corners[0], n.corners[1], middle, n.triangle, node);
    addNode(t, n.corners[0], middle, n.corners[2], n.triangle, node);
}

static vplPatches* finish(Tree* t, const vplGeometry* g)
{
    vplPatches* patches = calloc(1, sizeof *patches);
    t->patches = malloc((size_t)t->nodeCount * sizeof *t->patches);
    for (int i = 0; i < t->nodeCount; i++) {
        if (t->nodes[i].children < 0) {
            t->nodes[i].patch = t->patchCount;
            t->patches[t->patchCount++] = i;
        }
    }
    *patches = (vplPatches){.geometry = g,
                            .positions = t->positions,
                            .positionCount = t->positionCount,
                            .nodes = t->nodes,
                            .nodeCount = t->nodeCount,
                            .patches = t->patches,
                            .patchCount = t->patchCount,
                            .context = g->context};
    return patches;
}

static Tree plant(const vplGeometry* g)
{
    Tree t = {0};
    for (int i = 0; i < g->triangleCount; i++) {
        const vplTriangleCorners c = vplGeometry_Corners(g, i);
        const uint32_t a = intern(&t, c.corner[0]), b = intern(&t, c.corner[1]), d = intern(&t, c.corner[2]);
        addNode(&t, a, b, d, i, -1);
    }
    return t;
}

vplPatches* openPatches(const vplGeometry* geometry, float size, int rounds)
{
    Tree t = plant(geometry);
    for (int round = 0; round < rounds; round++) {
        for (int i = 0, end = t.nodeCount; i < end; i++) {
            if (t.nodes[i].children < 0 && longestOf(&t, &t.nodes[i]) > size) {
                bisect(&t, i);
            }
        }
    }
    return finish(&t, geometry);
}

vplPatches* openUnevenPatches(const vplGeometry* geometry, int rounds, uint64_t seed)
{
    Tree t = plant(geometry);
    Dice dice = {seed, 0};
    for (int round = 0; round < rounds; round++) {
        for (int i = 0, end = t.nodeCount; i < end; i++) {
            if (t.nodes[i].children < 0 && roll(&dice, 0, 1) < 0.5f) {
                bisect(&t, i);
            }
        }
    }
    return finish(&t, geometry);
}

void closePatches(vplPatches* patches)
{
    free((void*)patches->positions);
    free((void*)patches->nodes);
    free((void*)patches->patches);
    free(patches);
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
    closePatches(patches);
    vplGeometry_Destroy(geometry);
}
