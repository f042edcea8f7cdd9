// SPDX-License-Identifier: MIT
// Tests of irradiance at the vertices of patches, gathered by rays.
#include "patch_support.h"

#include "base/hash.h"
#include "math/vec.h"
#include "radiosity/mesh/patch_mesh.h"

#include <stdlib.h>
#include <string.h>

static void addQuad(Shape* shape, vplVec3 a, vplVec3 b, vplVec3 c, vplVec3 d)
{
    addTriangle(shape, a, b, c);
    addTriangle(shape, a, c, d);
}

// Makes a floor and a wall behind it, 2 m by 2 m each, whose fronts face each other.
static vplPatchMesh* openCorner(vplContext* context, float size)
{
    Shape shape = {0};
    addQuad(&shape, vplVec(-1, 0, 0), vplVec(-1, 0, 2), vplVec(1, 0, 2), vplVec(1, 0, 0));
    addQuad(&shape, vplVec(-1, 0, 0), vplVec(1, 0, 0), vplVec(1, 2, 0), vplVec(-1, 2, 0));
    vplGeometry* g = geometryOf(context, &shape, 0.5f, 0);
    freeShape(&shape);
    return meshOf(openSides(openPatches(g, size, VPL_MAX_PATCH_ROUNDS), frontsOpen));
}

static bool isWall(const vplPatchSide* side)
{
    return side->normal.z > 0.5f;
}

// Sets the radiosity of the wall to 1 W/m^2 in red, half of it in green, a quarter in blue.
static vplRgb* lightWall(const vplPatchMesh* m)
{
    vplRgb* values = calloc((size_t)m->sides->count, sizeof *values);
    for (int i = 0; i < m->sides->count; i++) {
        const float b = isWall(&m->sides->sides[i]) ? 1 : 0;
        values[i] = (vplRgb){b, 0.5f * b, 0.25f * b};
    }
    return values;
}

static vplRgb* gatherOf(const vplPatchMesh* m, const vplRgb* values, int rays, int64_t* cast)
{
    vplRgb* out = malloc(2 * (size_t)m->vertexCount * sizeof *out);
    if (vplPatchMesh_Gather(m, &(vplVertexGather){.radiosity = values, .rays = rays}, out, cast) !=
        VPL_SUCCESS) {
        fail_msg("%s", takeMessage());
    }
    return out;
}

// Returns the form factor from a point of the floor to the lit wall.
static double shareOf(const vplPatchMesh* m, vplVec3 point)
{
    double sum = 0;
    for (int i = 0; i < m->sides->count; i++) {
        const vplPatchSide* s = &m->sides->sides[i];
        sum += isWall(s) ? vplPointFormFactor(point, vplVec(0, 1, 0), s->corners) : 0;
    }
    return sum;
}

static bool isInside(vplVec3 p)
{
    return p.y == 0 && p.z > 0.01f && p.z < 1.99f && fabsf(p.x) < 0.99f;
}

// Inside the floor, the closed form gives a vertex' irradiance. The error must be smaller than that of as
// many independent random rays.
TEST(VerticesOfAFloorGetWhatAWallSendsThere, 2)
{
    enum { RAYS = 256 };
    vplPatchMesh* m = openCorner(context, 0.3f);
    vplRgb* values = lightWall(m);
    int64_t cast = 0;
    vplRgb* e = gatherOf(m, values, RAYS, &cast);
    double squares = 0;
    int count = 0;
    for (int v = 0; v < m->vertexCount; v++) {
        if (isInside(m->positions[v])) {
            const vplRgb here = e[2 * v];
            const double f = shareOf(m, m->positions[v]), error = (double)here.r - f;
            squares += error * error / (f * (1 - f) / RAYS);
            assertNear((double)here.g, 0.5 * (double)here.r, 1e-6, "green", v);
            assertNear((double)here.b, 0.25 * (double)here.r, 1e-6, "blue", v);
            assert_true(e[2 * v + 1].r == 0); // no light comes from below the floor
            count++;
        }
    }
    assert_true(count > 50);
    assert_true(sqrt(squares / count) < 0.5);
    assert_int_equal(cast, (int64_t)RAYS * m->vertexCount); // only fronts cast rays
    free(e);
    free(values);
    closeMesh(m);
}

// A vertex where floor and wall meet belongs to both. At the foot of the wall, the floor receives nearly half
// of all the light that it could. Means over the patches there do not show this.
TEST(TheFootOfAWallIsLitByTheWall, 1)
{
    vplPatchMesh* m = openCorner(context, 0.8f);
    vplRgb *values = lightWall(m), *e = gatherOf(m, values, 1024, NULL);
    int feet = 0;
    for (int v = 0; v < m->vertexCount; v++) {
        const vplVec3 p = m->positions[v];
        const bool ofFloor =
            vplPatches_TriangleOf(m->sides->patches, m->around->list[m->around->first[v]].patch) < 2;
        if (ofFloor && p.z == 0 && fabsf(p.x) < 0.9f) {
            assert_true(e[2 * v].r > 0.49f && e[2 * v].r < 0.5f);
            feet++;
        }
    }
    assert_true(feet > 2);
    free(e);
    free(values);
    closeMesh(m);
}

enum { MIDDLE_CELL = 15 };

// The cell in the middle of a triangle alone, or all of them: both have the same centroid.
static uint16_t middleOpen(const vplPatches* patches, int patch, int face)
{
    const bool floor = vplPatches_TriangleOf(patches, patch) == 0;
    return face > 0 ? 0 : floor ? 1 << MIDDLE_CELL : 0xffff;
}

// Light falls on a vertex from the same place however many cells are open around one centroid. A wall that is as low as that
// place is far from it tells small distances apart.
TEST(TheNumberOfOpenCellsDoesNotMoveAVertex, 1)
{
    static OpenFcn* const open[2] = {frontsOpen, middleOpen};
    double received[2];
    for (int i = 0; i < 2; i++) {
        Shape shape = {0};
        addTriangle(&shape, vplVec(0, 0, 0), vplVec(-3, 0, 3), vplVec(3, 0, 3));
        addQuad(&shape, vplVec(-9, 0, -0.01f), vplVec(9, 0, -0.01f), vplVec(9, 0.1f, -0.01f),
                vplVec(-9, 0.1f, -0.01f));
        vplGeometry* g = geometryOf(context, &shape, 0.5f, 0);
        freeShape(&shape);
        vplPatchMesh* m = meshOf(openSides(openPatches(g, 100, 0), open[i]));
        vplRgb *values = lightWall(m), *e = gatherOf(m, values, 4096, NULL);
        received[i] = -1;
        for (int v = 0; v < m->vertexCount; v++) {
            const vplVec3 p = m->positions[v];
            received[i] = p.x == 0 && p.z == 0 ? (double)e[2 * v].r : received[i];
        }
        free(e);
        free(values);
        closeMesh(m);
    }
    assert_true(received[0] > 0.1 && received[0] < 0.4);
    assertNear(received[1], received[0], 0.002, "of the middle cell", 0);
}

static uint16_t backsOpen(const vplPatches* patches, int patch, int face)
{
    (void)patches;
    (void)patch;
    return face == 1 ? 0xffff : 0;
}

// In a closed room whose patches all have the same radiosity, every ray hits a patch.
TEST(InAFurnaceEveryVertexGetsAll, 2)
{
    Shape shape = gridBox(2);
    const vplGeometry* g = geometryOf(context, &shape, 0.5f, 0);
    freeShape(&shape);
    vplPatchMesh* m = meshOf(openSides(openPatches(g, 0.7f, VPL_MAX_PATCH_ROUNDS), backsOpen));
    vplRgb* values = malloc((size_t)m->sides->count * sizeof *values);
    for (int i = 0; i < m->sides->count; i++) {
        values[i] = (vplRgb){3, 2, 1};
    }
    vplRgb* e = gatherOf(m, values, 64, NULL);
    for (int v = 0; v < m->vertexCount; v++) {
        const vplRgb here = e[2 * v + 1];
        assert_true(here.r == 3 && here.g == 2 && here.b == 1);
    }
    free(e);
    free(values);
    closeMesh(m);
}

TEST_ALONE(GathersAreTheSameBitsEverywhere)
{
    static const int workers[] = {1, 3};
    static const vplIsa isas[] = {VPL_ISA_SCALAR, VPL_ISA_AUTO};
    uint64_t hash = 0;
    for (int i = 0; i < 4; i++) {
        vplContext* context = openIsaContext(workers[i % 2], isas[i / 2]);
        vplPatchMesh* m = openCorner(context, 0.2f);
        vplRgb *values = lightWall(m), *e = gatherOf(m, values, 16, NULL);
        const uint64_t h = vplHashFloats(0, &e->r, 6 * (size_t)m->vertexCount);
        assert_true(i == 0 || h == hash);
        hash = h;
        free(e);
        free(values);
        closeMesh(m);
        closeTestContext(context);
    }
}

static bool refuse(void* user, double fraction)
{
    (void)user;
    (void)fraction;
    return false;
}

TEST(WrongGathersAreRefused, 1)
{
    vplPatchMesh* m = openCorner(context, 1);
    vplRgb* values = lightWall(m);
    vplRgb* out = malloc(2 * (size_t)m->vertexCount * sizeof *out);
    assert_int_equal(vplPatchMesh_Gather(m, &(vplVertexGather){.radiosity = values, .rays = 0}, out, NULL),
                     VPL_INVALID_ARGUMENT);
    assert_string_equal(takeMessage(), "rays is 0, must be in [1, 65536]");
    assert_int_equal(
        vplPatchMesh_Gather(m, &(vplVertexGather){.radiosity = values, .rays = 65537}, out, NULL),
        VPL_INVALID_ARGUMENT);
    values[1].g = NAN;
    assert_int_equal(vplPatchMesh_Gather(m, &(vplVertexGather){.radiosity = values, .rays = 1}, out, NULL),
                     VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "radiosity[1]"));
    values[1].g = 0;
    assert_int_equal(
        vplPatchMesh_Gather(m, &(vplVertexGather){.radiosity = values, .rays = 1, .progress = refuse}, out,
                            NULL),
        VPL_CANCELLED);
    free(out);
    free(values);
    closeMesh(m);
}
