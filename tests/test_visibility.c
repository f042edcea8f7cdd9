// SPDX-License-Identifier: MIT
// Tests of cube maps, and of shadows in general. Covers extremes X049 to X060 and X067 to X070.
#include "shadow_maps.h"

#include "math/vec.h"

#include <stdlib.h>

// X053
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

// X049, X051, X052
// All columns but face_xyz, the faces of another order of ties.
TEST_ALONE(EveryDirectionOfTheTableFindsItsTexel)
{
    static const char* const faces[6] = {"+x", "-x", "+y", "-y", "+z", "-z"};
    static const int sizes[4] = {1, 2, 16, 1024};
    Table t = loadTable("cube_dirs.csv");
    int zeros = 0, ties = 0;
    for (int row = 0; row < t.rows; row++) {
        const vplVec3 d = vectorOf(&t, row, "d");
        vplCubePoint p;
        if (strcmp(cell(&t, row, "face_zyx"), "none") == 0) { // X050
            assert_true(d.x == 0 && d.y == 0 && d.z == 0 && !vplCube_Find(d, 16, &p));
            zeros++;
            continue;
        }
        for (int k = 0; k < 4; k++) {
            char column[8], line[8];
            snprintf(column, sizeof column, "i%d", sizes[k]);
            snprintf(line, sizeof line, "j%d", sizes[k]);
            assert_true(vplCube_Find(d, sizes[k], &p));
            assert_string_equal(faces[p.face], cell(&t, row, "face_zyx"));
            assertNear((double)p.s, number(&t, row, "s"), 1e-7, "s", row);
            assertNear((double)p.t, number(&t, row, "t"), 1e-7, "t", row);
            assertNear(p.column, number(&t, row, column), 0, column, row);
            assertNear(p.row, number(&t, row, line), 0, line, row);
        }
        const float a[3] = {fabsf(d.x), fabsf(d.y), fabsf(d.z)}, most = fmaxf(a[0], fmaxf(a[1], a[2]));
        const bool tie = (a[0] == most) + (a[1] == most) + (a[2] == most) > 1;
        assert_int_equal(tie, (int)number(&t, row, "tie"));
        ties += tie;
    }
    assert_int_equal(t.rows, 137);
    assert_int_equal(zeros, 1);
    assert_int_equal(ties, 30);
    freeTable(&t);
}

// X053 to X056: in the cube [-1, 1]^3 the distance along any direction is known, and every texel is drawn.
TEST(TexelsHoldTheDistanceOfTheWall, 2)
{
    vplGeometry* cube = closedCube(context, 0.5f);
    const int sizes[] = {1, 2, 7, 64, 257};
    for (int k = 0; k < 5; k++) {
        vplVec3 light = {0.3f, -0.2f, 0.5f};
        int n = sizes[k];
        vplCubeMap* map = makeCubeMap(cube, light, n);
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
            assertNear((double)map->texels[i] * (double)map->farPlane, distance, 1e-6 * distance, "distance",
                       i);
        }
        vplCubeMap_Destroy(map);
    }
    vplGeometry_Destroy(cube);
}

// X056
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
        def.farPlane = (float)number(&t, row, "far");
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

// X050, X057, X059, X067: an empty map, a fragment at the light, one texel.
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
    assert_true(isinf(vplCubeMap_Distance(&flat.map, (vplVec3){0, 0, 0})));
}

// X069: a kernel 500 times as wide as the distance looks sideways: its samples share the face that the point
// lies in and the four beside it, in opposite pairs, and none points backwards.
TEST(AKernelWiderThanTheDistanceNeverLooksBack, 1)
{
    for (int ahead = 0; ahead < 6; ahead++) {
        const vplVec3 axis = vplCube_GetFrame(ahead).forward;
        for (int samples = 2; samples <= VPL_MAX_PCF_SAMPLES; samples *= 2) {
            double shares[6], sum = 0;
            for (int near = 0; near < 6; near++) { // something hides the light in this face only
                FlatMap flat;
                makeFlatMap(&flat, context, (vplVec3){1, 2, 3}, 10, 0.5f);
                flat.texels[near] = 0.0005f;
                vplShadowDef def = vplDefaultShadowDef();
                vplShadow shadow;
                def.biasRule = VPL_BIAS_PAIR;
                def.biasStatic = def.biasDynamic = 0;
                def.pcfSamples = samples;
                def.pcfOffset = 5;
                assert_int_equal(vplShadow_Create(&flat.map, &def, &shadow), VPL_SUCCESS);
                const vplVec3 at = vplAdd(vplScale(0.01f, axis), flat.map.position);
                shares[near] = (double)vplShadow_Factor(&shadow, at, vplNegate(axis));
                sum += shares[near];
            }
            assert_true(sum == 1 && shares[ahead ^ 1] == 0);
            for (int face = 0; face < 6; face++) {
                assertNear(shares[face], shares[face ^ 1], face / 2 == ahead / 2 ? 1 : 0, "pairs", samples);
                if (samples >= 16 && face / 2 != ahead / 2) {
                    assertNear(shares[face], 0.25, 1.0 / 16, "a quarter", samples);
                }
            }
        }
    }
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
    def.nearPlane = 2;
    def.farPlane = 1;
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
    assert_true(moved->farPlane == fresh->farPlane && moved->nearPlane == fresh->nearPlane &&
                moved->position.x == 0.3f);
    assert_int_equal(moved->stats.fragments, fresh->stats.fragments);
    assert_null(moved->bounds);
    def.size = 64;
    assert_int_equal(vplCubeMap_Redraw(moved, room, &def, NULL, NULL), VPL_INVALID_ARGUMENT);
    vplCubeMap_Destroy(moved);
    vplCubeMap_Destroy(fresh);
    vplGeometry_Destroy(room);
}
