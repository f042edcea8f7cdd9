// SPDX-License-Identifier: MIT
// Tests of cube maps, bias and PCF. Covers extremes X049 to X070.
#include "scenes.h"

#include "math/vec.h"

#include <stdlib.h>

TEST_ALONE(FramesAreThoseOfTheTable)
{
    Table t = loadTable("cube_frames.csv");
    for (int face = 0; face < 6; face++) {
        vplCubeFrame f = vplCube_GetFrame(face);
        const vplVec3 rows[3] = {f.right, f.up, f.forward};
        const char* const names[3] = {"right_", "up_", "fwd_"};
        for (int i = 0; i < 3; i++) {
            assertNear((double)vplLength(vplSub(rows[i], vectorOf(&t, face, names[i]))), 0, 0, names[i],
                       face);
        }
        vplVec3 cross = vplCross(f.right, f.up); // left-handed: right x up = +forward
        assertNear((double)vplDot(cross, f.forward), 1, 0, "hand", face);
    }
    freeTable(&t);
}

TEST_ALONE(EveryDirectionOfTheTableFindsItsTexel)
{
    static const char* const faces[6] = {"+x", "-x", "+y", "-y", "+z", "-z"};
    static const int sizes[4] = {1, 2, 16, 1024};
    Table t = loadTable("cube_dirs.csv");
    int zeros = 0;
    for (int row = 0; row < t.rows; row++) {
        vplVec3 d = vectorOf(&t, row, "d");
        vplCubePoint p;
        for (int k = 0; k < 4; k++) {
            char column[8];
            bool found = vplCube_Find(d, sizes[k], &p);
            if (!found) {
                assert_true(d.x == 0 && d.y == 0 && d.z == 0); // X050
                zeros++;
                continue;
            }
            assert_string_equal(faces[p.face], cell(&t, row, "face_zyx"));
            assertNear((double)p.s, number(&t, row, "s"), 1e-7, "s", row);
            assertNear((double)p.t, number(&t, row, "t"), 1e-7, "t", row);
            snprintf(column, sizeof column, "i%d", sizes[k]);
            int wantedI = (int)number(&t, row, column);
            *column = 'j';
            int wantedJ = (int)number(&t, row, column);
            // Rounding may put s into the neighbouring texel only if s * size is an integer up to rounding.
            bool edgeI = fabs((double)p.s * sizes[k] - rint((double)p.s * sizes[k])) < 1e-7 * sizes[k];
            bool edgeJ = fabs((double)p.t * sizes[k] - rint((double)p.t * sizes[k])) < 1e-7 * sizes[k];
            assert_true(p.column == wantedI || (edgeI && abs(p.column - wantedI) == 1));
            assert_true(p.row == wantedJ || (edgeJ && abs(p.row - wantedJ) == 1));
        }
    }
    assert_true(zeros <= 4);
    freeTable(&t);
}

static vplCubeMap* makeMap(const vplGeometry* g, vplVec3 position, int size)
{
    vplCubeMapDef def = vplDefaultCubeMapDef();
    def.position = position;
    def.size = size;
    vplCubeMap* map;
    assert_int_equal(vplCubeMap_Create(g, &def, NULL, NULL, &map), VPL_SUCCESS);
    return map;
}

// X053 to X056: in the cube [-1, 1]^3 the distance along any direction is known, and every texel is drawn.
TEST(TexelsHoldTheDistanceOfTheWall, 2)
{
    vplGeometry* cube = closedCube(context, 0.5f);
    const int sizes[] = {1, 2, 7, 64, 257};
    for (int k = 0; k < 5; k++) {
        vplVec3 light = {0.3f, -0.2f, 0.5f};
        int n = sizes[k];
        vplCubeMap* map = makeMap(cube, light, n);
        assert_int_equal(map->stats.drawCalls, 36);
        for (int i = 0; i < 6 * n * n; i++) {
            vplCubeFrame f = vplCube_GetFrame(i / (n * n));
            float s = 2 * ((float)(i % n) + 0.5f) / (float)n - 1,
                  t = 1 - 2 * ((float)(i / n % n) + 0.5f) / (float)n;
            vplVec3 d = vplNormalize(vplAdd(f.forward, vplAdd(vplScale(s, f.right), vplScale(t, f.up))));
            double distance = INFINITY;
            for (int axis = 0; axis < 3; axis++) {
                double da = (double)vplComponent(d, axis), la = (double)vplComponent(light, axis);
                distance = da != 0 ? fmin(distance, ((da > 0 ? 1 : -1) - la) / da) : distance;
            }
            assertNear((double)map->texels[i] * (double)map->far, distance, 1e-6 * distance, "distance", i);
        }
        vplCubeMap_Destroy(map);
    }
    vplGeometry_Destroy(cube);
}

// shadow_distance.csv: the map stores the distance of a small quad at the point that faces the light.
TEST(StoredDistancesAreRadialAndUnclamped, 1)
{
    Table t = loadTable("shadow_distance.csv");
    static const char* const faces[6] = {"+x", "-x", "+y", "-y", "+z", "-z"};
    int clamped = 0;
    for (int row = 0; row < t.rows; row++) {
        vplVec3 p = vectorOf(&t, row, "p"), l = vectorOf(&t, row, "l"), d = vplSub(p, l);
        vplCubePoint at;
        assert_true(vplCube_Find(d, 64, &at));
        assert_string_equal(faces[at.face], cell(&t, row, "face"));
        assertNear((double)at.s, number(&t, row, "s"), 3e-6, "s", row);
        assertNear((double)at.t, number(&t, row, "t"), 3e-6, "t", row);
        // One quad perpendicular to the ray and two texels wide is enough to cover the texel.
        double dist = number(&t, row, "dist");
        vplScene* scene;
        vplGeometry* g;
        assert_int_equal(vplScene_Create(context, &scene), VPL_SUCCESS);
        vplMaterialDef material = vplDefaultMaterialDef();
        vplScene_AddMaterial(scene, &material, NULL);
        vplObjectDef object = vplDefaultObjectDef();
        vplVec3 n = vplNormalize(d), tangent, bitangent;
        vplTangentFrame(n, &tangent, &bitangent);
        float size = (float)dist * 0.2f;
        const vplVec3 columns[4] = {vplScale(size, tangent), vplScale(size, bitangent), vplScale(size, n), p};
        for (int c = 0; c < 4; c++) {
            object.transform.m[4 * c] = columns[c].x;
            object.transform.m[4 * c + 1] = columns[c].y;
            object.transform.m[4 * c + 2] = columns[c].z;
        }
        assert_int_equal(vplScene_AddObject(scene, &object, NULL), VPL_SUCCESS);
        assert_int_equal(vplGeometry_Create(scene, &g), VPL_SUCCESS);
        vplCubeMapDef def = vplDefaultCubeMapDef();
        def.position = l;
        def.size = 64;
        def.far = (float)number(&t, row, "far");
        vplCubeMap* map;
        assert_int_equal(vplCubeMap_Create(g, &def, NULL, NULL, &map), VPL_SUCCESS);
        // The texel's own ray deviates by up to half a texel's diagonal, 1.27 degrees: 1 - cos is 2.5e-4.
        assertNear((double)vplCubeMap_Distance(map, d), dist, 3e-4 * dist, "distance", row);
        clamped += number(&t, row, "clamped") == 1;
        vplCubeMap_Destroy(map);
        vplGeometry_Destroy(g);
        vplScene_Destroy(scene);
    }
    assert_true(clamped > 0);
    freeTable(&t);
}

// A map whose six texels all store the same value.
typedef struct FlatMap {
    vplCubeMap map;
    float texels[6];
} FlatMap;

static void makeFlatMap(FlatMap* flat, vplContext* context, vplVec3 light, float far, float stored)
{
    for (int i = 0; i < 6; i++) {
        flat->texels[i] = stored;
    }
    flat->map =
        (vplCubeMap){.position = light, .size = 1, .far = far, .texels = flat->texels, .context = context};
}

TEST(EveryShadowVerdictOfTheTable, 1)
{
    Table t = loadTable("shadow_compare.csv");
    for (int row = 0; row < t.rows; row++) {
        FlatMap flat;
        makeFlatMap(&flat, context, vectorOf(&t, row, "l"), (float)number(&t, row, "far"),
                    (float)number(&t, row, "stored"));
        vplShadowDef def = vplDefaultShadowDef();
        def.biasRule = VPL_BIAS_PAIR;
        def.biasStatic = (float)number(&t, row, "b_s");
        def.biasDynamic = (float)number(&t, row, "b_dmax");
        def.pcfSamples = 1;
        vplShadow shadow;
        assert_int_equal(vplShadow_Create(&flat.map, &def, &shadow), VPL_SUCCESS);
        vplVec3 n = vplNormalize(vectorOf(&t, row, "n"));
        double s = (double)vplShadow_Factor(&shadow, (vplVec3){0, 0, 0}, n);
        assertNear(s, number(&t, row, "s_clamped"), 0, "s", row);
        double cosine = fmax(number(&t, row, "n_dot_lhat"), 0), dist = number(&t, row, "dist");
        assertNear((double)vplShadow_Bias(&shadow, (float)dist, (float)cosine),
                   number(&t, row, "bias_clamped"), 2e-8, "bias", row);
    }
    freeTable(&t);
}

static vplShadow exactShadow(const vplCubeMap* map, int samples, float offset)
{
    vplShadowDef def = vplDefaultShadowDef();
    def.biasRule = VPL_BIAS_EXACT;
    def.pcfSamples = samples;
    def.pcfOffset = offset;
    vplShadow shadow;
    assert_int_equal(vplShadow_Create(map, &def, &shadow), VPL_SUCCESS);
    return shadow;
}

TEST(ExactBiasIsThatOfTheTable, 1)
{
    Table t = loadTable("bias_angle.csv");
    FlatMap flat;
    makeFlatMap(&flat, context, (vplVec3){0, 0, 0}, 10, 0.5f);
    vplShadow shadow = exactShadow(&flat.map, 1, 0);
    for (int row = 0; row < t.rows; row++) {
        shadow.texelTangent = (float)tan(number(&t, row, "alpha"));
        double wanted = number(&t, row, "bias_over_r_exact"), cosine = number(&t, row, "n_dot_l");
        double bias = (double)vplShadow_Bias(&shadow, 3, (float)cosine) / 3 - 0x1p-20;
        // Near 90 degrees a float cosine is known only to 6e-8, which changes the bias by that over alpha.
        assertNear(bias, wanted, 4e-7 + 6e-8 / number(&t, row, "alpha"), "bias", row);
    }
    freeTable(&t);
}

// bias_texel.csv compares a fragment at the worst corner of a texel with the distance at the texel's centre.
// Our bias must suffice (no acne), and must not exceed the table's closed form with the largest texel's
// angle.
TEST(ExactBiasIsEnoughInEveryTexelOfTheTable, 1)
{
    Table t = loadTable("bias_texel.csv");
    FlatMap flat;
    makeFlatMap(&flat, context, (vplVec3){0, 0, 0}, 10, 0.5f);
    int tested = 0;
    for (int row = 0; row < t.rows; row++) {
        if (!isfinite(number(&t, row, "r_max_corner"))) {
            continue; // X067: a corner lies beyond the plane's horizon
        }
        flat.map.size = (int)number(&t, row, "R");
        vplShadow shadow = exactShadow(&flat.map, 1, 0);
        double r = number(&t, row, "r_max_corner"), h = number(&t, row, "h");
        double bias = (double)vplShadow_Bias(&shadow, (float)r, (float)(h / r));
        assert_true(bias >= number(&t, row, "bias_exact"));
        assert_true(bias <= r);
        tested++;
    }
    assert_true(tested > 200);
    freeTable(&t);
}

// bias_pair.csv: our automatic pair, b_s = alpha r and b_dmax = 5.6 b_s, suffices up to 80 degrees.
TEST(AutomaticPairIsEnoughUpTo80Degrees, 1)
{
    Table t = loadTable("bias_pair.csv");
    int tested = 0;
    for (int row = 0; row < t.rows; row++) {
        if (number(&t, row, "theta_max_deg") <= 80 && number(&t, row, "bs_over_r_in_units_of_alpha") == 1) {
            assert_true(number(&t, row, "bdmax_over_r_in_alpha") <= 5.62);
            tested++;
        }
    }
    assert_int_equal(tested, 6);
    FlatMap flat;
    makeFlatMap(&flat, context, (vplVec3){0, 0, 0}, 10, 0.5f);
    flat.map.size = 512;
    vplShadowDef def = vplDefaultShadowDef();
    def.biasRule = VPL_BIAS_PAIR;
    def.pcfSamples = 1;
    vplShadow shadow;
    assert_int_equal(vplShadow_Create(&flat.map, &def, &shadow), VPL_SUCCESS);
    assertNear((double)shadow.def.biasStatic, 10 * sqrt(2) / 512, 3e-4, "b_s", 0);
    assertNear((double)(shadow.def.biasDynamic / shadow.def.biasStatic), 5.6, 1e-5, "b_dmax", 0);
    freeTable(&t);
}

// Makes a floor and a wall that stands on it at x = x0.
static vplGeometry* wallOnFloor(vplContext* context, float x0)
{
    vplScene* scene;
    vplGeometry* g;
    assert_int_equal(vplScene_Create(context, &scene), VPL_SUCCESS);
    vplMaterialDef material = vplDefaultMaterialDef();
    vplScene_AddMaterial(scene, &material, NULL);
    vplObjectDef object = vplDefaultObjectDef();
    object.transform =
        vplMat4_FromParts((vplVec3){0, 0, 0}, (double[3]){-VPL_PI / 2, 0, 0}, (vplVec3){20, 20, 1});
    vplScene_AddObject(scene, &object, NULL);
    object.transform =
        vplMat4_FromParts((vplVec3){x0, 0, 0}, (double[3]){0, VPL_PI / 2, 0}, (vplVec3){20, 1, 1});
    vplScene_AddObject(scene, &object, NULL);
    assert_int_equal(vplGeometry_Create(scene, &g), VPL_SUCCESS);
    vplScene_Destroy(scene);
    return g;
}

// peter_panning.csv: the width of the light leak behind a wall, to the size of a texel on the floor.
TEST(LightLeaksBehindAWallAsFarAsTheTableSays, 2)
{
    Table t = loadTable("peter_panning.csv");
    enum { SIZE = 1024 };
    int tested = 0;
    for (int row = 0; row < t.rows; row++) {
        double h = number(&t, row, "light_height"), x0 = number(&t, row, "occluder_x0"),
               gap = number(&t, row, "gap_exact");
        double theta = atan2(x0 + gap, h), texel = 2 * h / SIZE * (1 + pow((x0 + gap) / h, 2));
        if (h != 1 || x0 + gap > 5) {
            continue; // the table is for h = 1, and the floor is finite
        }
        vplGeometry* g = wallOnFloor(context, (float)x0);
        vplCubeMap* map = makeMap(g, (vplVec3){0, (float)h, 0.01f}, SIZE);
        vplShadowDef def = vplDefaultShadowDef();
        def.biasRule = VPL_BIAS_PAIR;
        def.biasStatic = (float)number(&t, row, "bias");
        def.biasDynamic = 0;
        def.pcfSamples = 1;
        vplShadow shadow;
        assert_int_equal(vplShadow_Create(map, &def, &shadow), VPL_SUCCESS);
        double step = texel / 16, x = x0 + step;
        while (x < x0 + 20 &&
               vplShadow_Factor(&shadow, (vplVec3){(float)x, 0, 0.01f}, (vplVec3){0, 1, 0}) == 0) {
            x += step;
        }
        // The stored distance is that of a texel's centre: it is off by half a texel, in the slope as well.
        assertNear(x - x0, gap, 1.5 * texel * (1 + tan(theta)), "gap", row);
        tested++;
        vplCubeMap_Destroy(map);
        vplGeometry_Destroy(g);
    }
    assert_true(tested >= 6);
    freeTable(&t);
}

// Draws the map of a quad, halfway down, that shadows the half-plane x < edge of the floor 2 below the light.
static vplCubeMap* halfPlaneMap(vplContext* context, float edge, int size, vplGeometry** geometryOut)
{
    vplGeometry* g = floorQuad(context, (vplVec3){edge / 2 - 5, -1, 0}, 10, 0.5f);
    *geometryOut = g;
    return makeMap(g, (vplVec3){0, 0, 0}, size);
}

TEST(PcfGivesTheExpectationOfADisc, 2)
{
    Table t = loadTable("pcf_halfplane.csv");
    const float e = 0.2f;
    for (int row = 0; row < t.rows; row++) {
        // Positive x: the edge is moved so that it covers less of the kernel.
        double x = number(&t, row, "x_over_e"), wanted = number(&t, row, "disk");
        vplGeometry* g;
        vplCubeMap* map = halfPlaneMap(context, (float)-x * e, 1024, &g);
        const int samples[] = {4, 16, 64, 256};
        for (int k = 0; k < 4; k++) {
            vplShadow shadow = exactShadow(map, samples[k], e);
            double s = (double)vplShadow_Factor(&shadow, (vplVec3){0, -2, 0}, (vplVec3){0, 1, 0});
            double count = s * samples[k];
            assertNear(count, rint(count), 1e-5, "k/S", row);
            // Low-discrepancy points stay below the 2 standard deviations of random ones. The tolerance also
            // allows for the texels along the edge (a texel is 1/102 of the kernel's radius).
            double slack = x == 0 ? 2.0 / samples[k] : 2 * sqrt(number(&t, row, "varS_disk") / samples[k]);
            assertNear(s, wanted, slack + 0.015, "s", row);
        }
        vplCubeMap_Destroy(map);
        vplGeometry_Destroy(g);
    }
    freeTable(&t);
}

// pcf_grid.csv: the table's own offsets replace ours, and counts must be exact.
TEST(PcfCountsTheGridsOfTheTable, 2)
{
    Table t = loadTable("pcf_grid.csv");
    const float e = 0.2f;
    for (int row = 0; row < t.rows; row++) {
        int samples = (int)number(&t, row, "S"), side = (int)rint(sqrt(samples));
        vplGeometry* g;
        vplCubeMap* map = halfPlaneMap(context, (float)-number(&t, row, "x_over_e") * e, 1024, &g);
        vplShadow shadow = exactShadow(map, samples, e);
        bool onEdge = false;
        for (int i = 0; i < samples; i++) {
            shadow.offsets[i][0] = (2 * (float)(i % side) + 1) / (float)side - 1;
            shadow.offsets[i][1] = (2 * (float)(i / side) + 1) / (float)side - 1;
            onEdge |= fabs((double)shadow.offsets[i][0] + number(&t, row, "x_over_e")) < 0.015;
        }
        double s = (double)vplShadow_Factor(&shadow, (vplVec3){0, -2, 0}, (vplVec3){0, 1, 0});
        if (!onEdge) { // a sample on the edge may fall on either side of a texel's boundary
            assertNear(s, number(&t, row, "factor"), 0, "s", row);
        }
        vplCubeMap_Destroy(map);
        vplGeometry_Destroy(g);
    }
    freeTable(&t);
}

// X057, X059, X067, X069: an empty map, a fragment at the light, one texel, a kernel wider than the distance.
TEST(DegenerateShadowsAreDefined, 1)
{
    FlatMap flat;
    makeFlatMap(&flat, context, (vplVec3){0, 0, 0}, 10, INFINITY);
    vplShadow shadow = exactShadow(&flat.map, 16, 0.1f);
    assertNear((double)vplShadow_Factor(&shadow, (vplVec3){1e6f, 0, 0}, (vplVec3){-1, 0, 0}), 0, 0, "nothing",
               0);
    makeFlatMap(&flat, context, (vplVec3){0, 0, 0}, 10, 1e-3f);
    shadow = exactShadow(&flat.map, 16, 5);
    double in = (double)vplShadow_Factor(&shadow, (vplVec3){0, 0, 0}, (vplVec3){0, 1, 0});
    assertNear(in, 0, 0, "in the light", 0);
    double wide = (double)vplShadow_Factor(&shadow, (vplVec3){0.01f, 0, 0}, (vplVec3){-1, 0, 0});
    assert_true(wide >= 0 && wide <= 1);
    assert_true(isinf(vplCubeMap_Distance(&flat.map, (vplVec3){0, 0, 0})));
}

TEST(OffsetsLieOnTheDiscInPairs, 1)
{
    FlatMap flat;
    makeFlatMap(&flat, context, (vplVec3){0, 0, 0}, 10, 0.5f);
    for (int samples = 1; samples <= VPL_MAX_PCF_SAMPLES; samples++) {
        vplShadow shadow = exactShadow(&flat.map, samples, 1);
        double mean[2] = {0, 0}, square = 0;
        for (int i = 0; i < samples; i++) {
            double x = (double)shadow.offsets[i][0], y = (double)shadow.offsets[i][1];
            assert_true(x * x + y * y <= 1 + 1e-6);
            mean[0] += x;
            mean[1] += y;
            square += (x * x + y * y) / samples;
        }
        assertNear(mean[0], 0, 1e-5, "mean x", samples);
        assertNear(mean[1], 0, 1e-5, "mean y", samples);
        if (samples >= 16) {
            assertNear(square, 0.5, 0.08, "mean square of the uniform disc", samples);
        }
    }
}

TEST(ShadowMapsRefuseBadDefs, 1)
{
    vplGeometry* g = floorQuad(context, (vplVec3){0, 0, 0}, 1, 0.5f);
    vplCubeMap* map = NULL;
    vplCubeMapDef def = vplDefaultCubeMapDef();
    def.size = 0;
    assert_int_equal(vplCubeMap_Create(g, &def, NULL, NULL, &map), VPL_INVALID_ARGUMENT);
    def.size = VPL_MAX_SHADOW_MAP + 1;
    assert_int_equal(vplCubeMap_Create(g, &def, NULL, NULL, &map), VPL_INVALID_ARGUMENT);
    def.size = 4;
    def.near = 2;
    def.far = 1;
    assert_int_equal(vplCubeMap_Create(g, &def, NULL, NULL, &map), VPL_INVALID_ARGUMENT);
    assert_null(map);
    FlatMap flat;
    makeFlatMap(&flat, context, (vplVec3){0, 0, 0}, 1, 1);
    vplShadow shadow;
    vplShadowDef shadowDef = vplDefaultShadowDef();
    shadowDef.pcfSamples = 0; // X068
    assert_int_equal(vplShadow_Create(&flat.map, &shadowDef, &shadow), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "pcfSamples is 0"));
    shadowDef = vplDefaultShadowDef();
    shadowDef.biasStatic = NAN;
    assert_int_equal(vplShadow_Create(&flat.map, &shadowDef, &shadow), VPL_INVALID_ARGUMENT);
    vplGeometry_Destroy(g);
}

// The bits also agree with bounds, which redrawing must invalidate.
TEST(RedrawnMapsAreThoseOfNewOnes, 2)
{
    vplGeometry* room = wallOnFloor(context, 0.5f);
    const size_t texels = (size_t)6 * 100 * 100;
    vplCubeMapDef def = vplDefaultCubeMapDef();
    def.position = (vplVec3){0, 4.5f, 0};
    def.size = 100;
    vplCubeMap *moved, *fresh;
    assert_int_equal(vplCubeMap_Create(room, &def, NULL, NULL, &moved), VPL_SUCCESS);
    assert_int_equal(vplCubeMap_FindBounds(moved), VPL_SUCCESS);
    def.position = (vplVec3){0.3f, 2.5f, 1.7f};
    assert_int_equal(vplCubeMap_Create(room, &def, NULL, NULL, &fresh), VPL_SUCCESS);
    assert_true(memcmp(moved->texels, fresh->texels, texels * sizeof(float)) != 0);
    assert_int_equal(vplCubeMap_Redraw(moved, room, &def, NULL, NULL), VPL_SUCCESS);
    assert_memory_equal(moved->texels, fresh->texels, texels * sizeof(float));
    assert_true(moved->far == fresh->far && moved->near == fresh->near && moved->position.x == 0.3f);
    assert_int_equal(moved->stats.fragments, fresh->stats.fragments);
    assert_null(moved->bounds);
    def.size = 64;
    assert_int_equal(vplCubeMap_Redraw(moved, room, &def, NULL, NULL), VPL_INVALID_ARGUMENT);
    vplCubeMap_Destroy(moved);
    vplCubeMap_Destroy(fresh);
    vplGeometry_Destroy(room);
}
