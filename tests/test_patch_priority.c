// SPDX-License-Identifier: MIT
// Tests of adaptive patches: the priorities of vplFindPatchPriority, and the gain from refining by them.
#include "patch_support.h"

#include "radiosity/sides/side.h"
#include "math/vec.h"

#include <stdlib.h>
#include <string.h>

// Irradiance cos^4 / height^2 of a floor below a light that is much nearer to one point than to others.
static double irradianceAt(vplVec3 p)
{
    const double x = (double)p.x - 0.7, z = (double)p.z + 0.4, height = 0.5;
    const double square = x * x + z * z + height * height;
    return height * height / (square * square);
}

typedef struct Field {
    vplContext* context;
    vplGeometry* geometry;
    vplPatches* patches;
    vplPatchSides* sides;
    vplPatchMesh* mesh;
    vplRgb *values, *corners;
    float* worth;
} Field;

static const vplVec3 EMITTER = {0, 5, 0};

static double meanOver(const vplPatchSide* side, double (*at)(vplVec3))
{
    double sum = 0;
    for (int i = 0; i < 16 * VPL_PATCH_CELLS; i++) {
        sum += at(vplCell_Point(side->corners, i / 16, ((float)(i % 4) + 0.5f) / 4,
                                ((float)(i / 4 % 4) + 0.5f) / 4));
    }
    return sum / (16 * VPL_PATCH_CELLS);
}

// Makes sides, mesh and values for the patches, and takes ownership of them.
static void fillField(Field* f, vplPatches* patches, double (*at)(vplVec3))
{
    f->patches = patches;
    f->sides = sidesOf(patches, &EMITTER);
    assert_int_equal(vplPatchMesh_Create(f->sides, &f->mesh), VPL_SUCCESS);
    f->values = malloc((size_t)f->sides->count * sizeof *f->values);
    f->corners = malloc(2 * (size_t)f->mesh->vertexCount * sizeof *f->corners);
    f->worth = malloc((size_t)patches->patchCount * sizeof *f->worth);
    for (int i = 0; i < f->sides->count; i++) {
        const float e = (float)meanOver(&f->sides->sides[i], at);
        f->values[i] = (vplRgb){e, 0.5f * e, 0.25f * e};
    }
    assert_int_equal(vplPatchMesh_Interpolate(f->mesh, VPL_VERTEX_WEIGHT_ANGLE, f->values, f->corners),
                     VPL_SUCCESS);
}

static Field openField(float size, double (*at)(vplVec3))
{
    Field f = {.context = openTestContext(1)};
    Shape shape = {0};
    addTriangle(&shape, vplVec(-2, 0, -2), vplVec(-2, 0, 2), vplVec(2, 0, 2));
    addTriangle(&shape, vplVec(-2, 0, -2), vplVec(2, 0, 2), vplVec(2, 0, -2));
    f.geometry = geometryOf(f.context, &shape, 0.5f, 0);
    freeShape(&shape);
    fillField(&f, openPatches(f.geometry, size, VPL_MAX_PATCH_ROUNDS), at);
    return f;
}

static void emptyField(Field* f)
{
    free(f->values);
    free(f->corners);
    free(f->worth);
    vplPatchMesh_Destroy(f->mesh);
    vplPatchSides_Destroy(f->sides);
    vplPatches_Destroy(f->patches);
}

static void closeField(Field* f)
{
    emptyField(f);
    vplGeometry_Destroy(f->geometry);
    closeTestContext(f->context);
}

static vplPatchPriorityDef defOf(const Field* f)
{
    vplPatchPriorityDef def = vplDefaultPatchPriorityDef();
    def.irradiance = f->values;
    def.vertexIrradiance = f->corners;
    return def;
}

static void findWorth(Field* f)
{
    const vplPatchPriorityDef def = defOf(f);
    assert_int_equal(vplFindPatchPriority(f->mesh, &def, f->worth), VPL_SUCCESS);
}

static double one(vplVec3 p)
{
    (void)p;
    return 1;
}

static double none(vplVec3 p)
{
    (void)p;
    return 0;
}

static double ramp(vplVec3 p)
{
    return 1 + (p.x > 0 ? (double)p.x : 0);
}

TEST_ALONE(NoLightAndEvenLightNeedNoPatches)
{
    for (int i = 0; i < 2; i++) {
        Field f = openField(0.5f, i ? none : one);
        findWorth(&f);
        for (int k = 0; k < f.patches->patchCount; k++) {
            assertNear((double)f.worth[k], 0, 1e-12, "worth", k);
        }
        closeField(&f);
    }
}

// Light increases from the centre on: every patch on the slope has a higher priority than any other.
TEST_ALONE(SlopesHaveAHigherPriorityThanPlains)
{
    Field f = openField(0.5f, ramp);
    float most = 0, least = INFINITY;
    findWorth(&f);
    for (int i = 0; i < f.patches->patchCount; i++) {
        const vplPatchSide* s = &f.sides->sides[f.sides->ofPatch[2 * i]];
        const float low = fminf(s->corners[0].x, fminf(s->corners[1].x, s->corners[2].x)),
                    high = fmaxf(s->corners[0].x, fmaxf(s->corners[1].x, s->corners[2].x));
        most = high < -0.4f ? fmaxf(most, f.worth[i]) : most;
        least = low > 0 ? fminf(least, f.worth[i]) : least;
    }
    assert_true(least > 1.3f * most); // a patch with even light has the priority of its area alone
    closeField(&f);
}

TEST_ALONE(AShadowsBoundaryHasAHighPriority)
{
    Field f = openField(0.5f, one);
    vplPatchPriorityDef def = defOf(&f);
    float* spread = calloc((size_t)f.sides->count, sizeof *spread);
    spread[5] = 0.2f;
    spread[9] = 0.4f;
    def.directSpread = spread;
    assert_int_equal(vplFindPatchPriority(f.mesh, &def, f.worth), VPL_SUCCESS);
    const float plain = f.worth[f.sides->sides[0].patch];
    for (int i = 0; i < f.sides->count; i++) {
        assert_int_equal(f.worth[f.sides->sides[i].patch] > 1.01f * plain, i == 5 || i == 9);
    }
    assert_true(f.worth[f.sides->sides[9].patch] - plain > 2 * (f.worth[f.sides->sides[5].patch] - plain));
    free(spread);
    closeField(&f);
}

// Direct light that varies across a patch causes an error in the light that the patch reflects; even light,
// however bright, does not.
TEST_ALONE(ChangesOfDirectLightHaveAHighPriority)
{
    Field f = openField(0.5f, one);
    const size_t corners = 2 * (size_t)f.mesh->vertexCount;
    vplRgb* direct = malloc(corners * sizeof *direct);
    float* plain = malloc((size_t)f.patches->patchCount * sizeof *plain);
    vplPatchPriorityDef def = defOf(&f);
    findWorth(&f);
    memcpy(plain, f.worth, (size_t)f.patches->patchCount * sizeof *plain);
    def.vertexDirect = direct;
    for (int slope = 0; slope < 2; slope++) {
        for (size_t i = 0; i < corners; i++) {
            const float x = f.mesh->positions[i / 2].x, e = 10 + (slope ? fmaxf(x, 0) : 0);
            direct[i] = (vplRgb){e, e, e};
        }
        assert_int_equal(vplFindPatchPriority(f.mesh, &def, f.worth), VPL_SUCCESS);
        for (int i = 0; i < f.patches->patchCount; i++) {
            const vplPatchSide* s = &f.sides->sides[f.sides->ofPatch[2 * i]];
            const bool changes = slope && (s->corners[0].x > 0 || s->corners[1].x > 0 || s->corners[2].x > 0);
            if (changes) {
                assert_true(f.worth[i] > 1.5f * plain[i]);
            } else {
                assertNear((double)f.worth[i], (double)plain[i], 1e-5 * (double)plain[i], "worth", i);
            }
        }
    }
    free(direct);
    free(plain);
    closeField(&f);
}

// Returns the mean over the floor of the squared relative error of the interpolated values.
static double errorOf(const Field* f)
{
    double sum = 0, total = 0;
    for (int t = 0; t < f->mesh->triangleCount; t++) {
        const uint32_t* index = f->mesh->indices + 3 * (size_t)t;
        vplPatchSide s = {.open = 0xffff};
        double values[3];
        for (int k = 0; k < 3; k++) {
            s.corners[k] = f->mesh->positions[index[k]];
            values[k] = (double)f->corners[2 * (size_t)index[k]].r;
        }
        const double area = (double)vplLength(
            vplCross(vplSub(s.corners[1], s.corners[0]), vplSub(s.corners[2], s.corners[0])));
        for (int i = 0; i < 64; i++) {
            const float u = ((float)(i % 8) + 0.5f) / 8, v = ((float)(i / 8) + 0.5f) / 8;
            const float b = v > u ? 0.5f * u : u - 0.5f * v, c = v > u ? v - 0.5f * u : 0.5f * v,
                        a = 1 - b - c;
            const vplVec3 p = vplAdd(vplScale(a, s.corners[0]),
                                     vplAdd(vplScale(b, s.corners[1]), vplScale(c, s.corners[2])));
            const double truth = irradianceAt(p),
                         drawn = (double)a * values[0] + (double)b * values[1] + (double)c * values[2];
            sum += area * (drawn - truth) * (drawn - truth) / ((truth + 0.05) * (truth + 0.05));
            total += area;
        }
    }
    return sum / total;
}

static void refineTo(Field* f, int count)
{
    while (f->patches->patchCount < count) {
        vplPatches* next;
        const int more = f->patches->patchCount * 3 / 2;
        findWorth(f);
        assert_int_equal(vplPatches_Refine(f->patches, f->worth, more < count ? more : count, &next),
                         VPL_SUCCESS);
        assert_true(next->patchCount > f->patches->patchCount);
        emptyField(f);
        fillField(f, next, irradianceAt);
    }
}

// Patches placed by priority have less than half the squared error of as many patches of one size.
TEST_ALONE(PatchesByPriorityHalveTheError)
{
    for (float size = 0.36f; size > 0.1f; size *= 0.5f) {
        Field uniform = openField(size, irradianceAt), adaptive = openField(4 * size, irradianceAt);
        refineTo(&adaptive, uniform.patches->patchCount);
        assert_int_equal(adaptive.patches->patchCount, uniform.patches->patchCount);
        const double a = errorOf(&adaptive), u = errorOf(&uniform);
        assert_true(a < 0.5 * u);
        closeField(&uniform);
        closeField(&adaptive);
    }
}

static void expectFailure(const Field* f, vplPatchPriorityDef def, const char* sentence)
{
    f->worth[0] = 7;
    takeMessage();
    assert_int_equal(vplFindPatchPriority(f->mesh, &def, f->worth), VPL_INVALID_ARGUMENT);
    assert_string_equal(takeMessage(), sentence);
    assert_true(f->worth[0] == 7);
}

TEST_ALONE(WrongDefsAreRefused)
{
    Field f = openField(1, one);
    vplPatchPriorityDef def = defOf(&f);
    def.irradiance = NULL;
    expectFailure(
        &f, def,
        "vplPatchPriorityDef.irradiance and vertexIrradiance are NULL, must be given where there are sides");
    def = defOf(&f);
    def.cookie = 1;
    expectFailure(&f, def, "vplPatchPriorityDef was not made by vplDefaultPatchPriorityDef");
    closeField(&f);
}
