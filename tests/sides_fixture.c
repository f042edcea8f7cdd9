// SPDX-License-Identifier: MIT
#include "sides_fixture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct Piece {
    double p[3][3];
    int triangle;
} Piece;

static double distance2(const double a[3], const double b[3])
{
    double sum = 0;
    for (int k = 0; k < 3; k++) {
        sum += (a[k] - b[k]) * (a[k] - b[k]);
    }
    return sum;
}

// The first of the longest edges, in the order 01, 12, 20.
static int longestEdge(const Piece* piece, double* length2)
{
    int longest = 0;
    *length2 = 0;
    for (int e = 0; e < 3; e++) {
        const double length = distance2(piece->p[e], piece->p[(e + 1) % 3]);
        if (length > *length2 * (1 + 1e-12)) {
            *length2 = length;
            longest = e;
        }
    }
    return longest;
}

static Piece* bisectAll(Piece* pieces, int* count, double size, int rounds)
{
    for (int round = 0; round < rounds; round++) {
        Piece* next = malloc((size_t)(*count ? 2 * *count : 1) * sizeof *next);
        int nextCount = 0;
        for (int i = 0; i < *count; i++) {
            double length2;
            const int e = longestEdge(&pieces[i], &length2), f = (e + 1) % 3;
            next[nextCount++] = pieces[i];
            if (length2 > size * size) {
                Piece other = pieces[i];
                for (int k = 0; k < 3; k++) {
                    other.p[e][k] = next[nextCount - 1].p[f][k] =
                        0.5 * (pieces[i].p[e][k] + pieces[i].p[f][k]);
                }
                next[nextCount++] = other;
            }
        }
        free(pieces);
        pieces = next;
        *count = nextCount;
    }
    return pieces;
}

static vplPatchSide sideOf(const Piece* piece, int patch)
{
    vplPatchSide side = {.patch = patch, .open = 0xffff};
    double u[3], v[3], edge[3], all = 0, centre[3] = {0};
    for (int k = 0; k < 3; k++) {
        u[k] = piece->p[1][k] - piece->p[0][k];
        v[k] = piece->p[2][k] - piece->p[0][k];
        edge[k] = sqrt(distance2(piece->p[(k + 1) % 3], piece->p[(k + 2) % 3]));
        all += edge[k];
    }
    const double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    const double twice = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int k = 0; k < 9; k++) {
        centre[k % 3] += edge[k / 3] / all * piece->p[k / 3][k % 3];
    }
    for (int c = 0; c < 3; c++) {
        side.corners[c] = (vplVec3){(float)piece->p[c][0], (float)piece->p[c][1], (float)piece->p[c][2]};
    }
    side.normal = (vplVec3){(float)(n[0] / twice), (float)(n[1] / twice), (float)(n[2] / twice)};
    side.incentre = (vplVec3){(float)centre[0], (float)centre[1], (float)centre[2]};
    side.area = (float)(0.5 * twice);
    side.reflectance = (vplRgb){0.5f, 0.5f, 0.5f};
    return side;
}

static bool makeGeometry(vplContext* context, const vplVec3* corners, int triangleCount, SidesFixture* f)
{
    uint32_t* indices = malloc(((size_t)triangleCount * 3 + 1) * sizeof *indices);
    for (int i = 0; i < 3 * triangleCount; i++) {
        indices[i] = (uint32_t)i;
    }
    vplMeshDef mesh = vplDefaultMeshDef();
    mesh.positions = corners;
    mesh.indices = indices;
    mesh.vertexCount = 3 * triangleCount;
    mesh.triangleCount = triangleCount;
    vplObjectDef object = vplDefaultObjectDef();
    object.type = VPL_OBJECT_MESH;
    vplMaterialDef material = vplDefaultMaterialDef();
    int index;
    const bool done = vplScene_Create(context, &f->scene) == VPL_SUCCESS &&
                      vplScene_AddMaterial(f->scene, &material, &object.material) == VPL_SUCCESS &&
                      vplScene_AddMesh(f->scene, &mesh, &object.mesh) == VPL_SUCCESS &&
                      vplScene_AddObject(f->scene, &object, &index) == VPL_SUCCESS &&
                      vplGeometry_Create(f->scene, &f->geometry) == VPL_SUCCESS;
    free(indices);
    return done;
}

bool makeSides(vplContext* context, const vplVec3* corners, int triangleCount, double size, int rounds,
               SidesFixture* f)
{
    memset(f, 0, sizeof *f);
    f->context = context;
    if (!makeGeometry(context, corners, triangleCount, f)) {
        freeSides(f);
        return false;
    }
    int count = triangleCount;
    Piece* pieces = malloc((size_t)(count + 1) * sizeof *pieces);
    for (int i = 0; i < count; i++) {
        pieces[i].triangle = i;
        for (int c = 0; c < 3; c++) {
            const vplVec3 v = corners[3 * i + c];
            memcpy(pieces[i].p[c], (const double[3]){(double)v.x, (double)v.y, (double)v.z},
                   sizeof pieces[i].p[c]);
        }
    }
    pieces = bisectAll(pieces, &count, size, rounds);
    vplPatchNode* nodes = calloc((size_t)count + 1, sizeof *nodes);
    int* patches = calloc((size_t)count + 1, sizeof *patches);
    int* ofPatch = calloc(2 * (size_t)count + 1, sizeof *ofPatch);
    vplPatchSide* sides = calloc((size_t)count + 1, sizeof *sides);
    for (int i = 0; i < count; i++) {
        nodes[i] = (vplPatchNode){.triangle = pieces[i].triangle, .parent = -1, .children = -1, .patch = i};
        patches[i] = i;
        ofPatch[2 * i] = i;
        ofPatch[2 * i + 1] = -1;
        sides[i] = sideOf(&pieces[i], i);
    }
    free(pieces);
    f->patches = (vplPatches){.geometry = f->geometry,
                              .nodes = nodes,
                              .nodeCount = count,
                              .patches = patches,
                              .patchCount = count,
                              .context = context};
    f->sides = (vplPatchSides){
        .patches = &f->patches, .sides = sides, .count = count, .ofPatch = ofPatch, .context = context};
    return true;
}

void freeSides(SidesFixture* f)
{
    free((void*)f->patches.nodes);
    free((void*)f->patches.patches);
    free((void*)f->sides.ofPatch);
    free((void*)f->sides.sides);
    vplGeometry_Destroy(f->geometry);
    vplScene_Destroy(f->scene);
    memset(f, 0, sizeof *f);
}

void boxCorners(float x, float y, float z, vplVec3 corners[36])
{
    // Of each face: where it is, and two ways along it whose cross product leads inside.
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
