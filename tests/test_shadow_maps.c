// SPDX-License-Identifier: MIT
// Tests of properties that shadow maps of all kinds share: cube maps (hard and soft), hemi-octahedral maps,
// paraboloid maps and reflective maps as shadow maps.
#include "failing.h"
#include "shadow_maps.h"

#include "bench/band.h"

#include "base/hash.h"
#include "math/vec.h"

// Makes a square of 98 triangles through `middle`, perpendicular to `n`, 12 m per side.
static vplGeometry* plane(vplContext* context, int turn, vplVec3 offset, vplVec3* nOut, vplVec3* middleOut)
{
    vplScene* scene = sceneOf(context, 0.5f);
    Shape square = {0};
    for (int i = 0; i < 7 * 7; i++) {
        const float x = (float)(i % 7) - 3.5f, y = (float)(i / 7) - 3.5f;
        addTriangle(&square, vplVec(x, y, 0), vplVec(x + 1, y, 0), vplVec(x + 1, y + 1, 0));
        addTriangle(&square, vplVec(x, y, 0), vplVec(x + 1, y + 1, 0), vplVec(x, y + 1, 0));
    }
    const double rotate[3] = {turn * 1.1, turn * 0.7, turn * 2.3};
    placeShape(&square, 1.7f, rotate, offset);
    addShape(scene, &square, false, NULL);
    freeShape(&square);
    vplGeometry* g = buildGeometry(scene);
    *nOut = g->normals[0];
    *middleOut = g->positions[3 * 48];
    return g;
}

// Returns a random point of a triangle, rounded to floats.
static vplVec3 rollOn(const vplGeometry* g, Dice* dice)
{
    const int triangle = (int)roll(dice, 0, (float)g->triangleCount);
    return vplGeometry_SampleTriangle(g, triangle, roll(dice, 0, 1), roll(dice, 0, 1)).position;
}

// The plane has arbitrary rotation and lies near the origin or far away. Light comes from 15 m at angles down
// to a hundredth of a degree above the plane, into maps of one texel and of many.
TEST(APlaneNeverShadowsItself, 2, SLOW)
{
    static const double degrees[] = {0, 30, 60, 80, 88, 89.5, 89.9, 89.99};
    static const int sizes[] = {1, 3, 64, 400};
    Dice dice = {11, 0};
    for (int turn = 0; turn < 6; turn++) {
        vplVec3 n, middle, tangent, bitangent;
        vplGeometry* g = plane(context, turn, rollVec(&dice, turn < 3 ? 3 : 300), &n, &middle);
        vplTangentFrame(n, &tangent, &bitangent);
        for (int k = 0; k < 4 * MAP_KINDS; k++) {
            // Hemi-octahedral, paraboloid and cube maps store distances, whose rounding error at 300 m is a
            // hundredth of the light's 2.6 mm above the plane.
            const bool rounded = turn >= 3 && k / 4 < MAP_REFLECTIVE_POINT;
            for (size_t d = 0; d < sizeof degrees / sizeof *degrees - rounded; d++) {
                const double angle = degrees[d] * VPL_PI / 180;
                const vplVec3 from =
                    vplAdd(vplScale((float)cos(angle), n), vplScale((float)sin(angle), tangent));
                ShadowMap m = openMap((MapKind)(k / 4), g, vplAdd(middle, vplScale(15, from)),
                                      vplNegate(from), sizes[k % 4]);
                for (int i = 0; i < 200; i++) {
                    const vplVec3 p = rollOn(g, &dice);
                    if (isInView(&m, p) && factorAt(&m, p, n) != 0) {
                        fail_msg("%s of %d^2 texels, plane %d, %g degrees: %g", nameOfKind(m.kind),
                                 sizes[k % 4], turn, degrees[d], (double)factorAt(&m, p, n));
                    }
                }
                closeMap(&m);
            }
        }
        vplGeometry_Destroy(g);
    }
}

// The map lies 0.1 mm to 4 m above a floor and points in any direction at it.
TEST(AFloorThatLightGrazesDoesNotShadowItself, 1)
{
    vplGeometry* g = floorQuad(context, vplVec(3, 0.25f, -2), 10, 0.5f);
    Dice dice = {3, 0};
    for (int i = 0; i < 300 * MAP_KINDS; i++) {
        const float high = 0.25f + 4 * powf(10, roll(&dice, -5, 0));
        const vplVec3 at = vplVec(3 + roll(&dice, -4, 4), high, -2 + roll(&dice, -4, 4));
        ShadowMap m =
            openMap((MapKind)(i % MAP_KINDS), g, at,
                    vplNormalize(vplAdd(vplVec(0, -1.01f, 0), rollUnit(&dice))), 1 + i / MAP_KINDS % 33);
        for (int k = 0; k < 20; k++) {
            const vplVec3 p = vplVec(3 + roll(&dice, -4.9f, 4.9f), 0.25f, -2 + roll(&dice, -4.9f, 4.9f));
            if (isInView(&m, p) && factorAt(&m, p, vplVec(0, 1, 0)) != 0) {
                fail_msg("%s of %d^2 texels, %g m above: %g", nameOfKind(m.kind), 1 + i / MAP_KINDS % 33,
                         (double)(at.y - 0.25f), (double)factorAt(&m, p, vplVec(0, 1, 0)));
            }
        }
        closeMap(&m);
    }
    vplGeometry_Destroy(g);
}

typedef struct Tally {
    int pairs, dark, sure, apart;
} Tally;

// Compares a map with rays at random points of the scene.
static void compareWithRays(const ShadowMap* m, Dice* dice, int points, Tally* tally)
{
    for (int i = 0; i < points; i++) {
        vplHit hit;
        const vplHemiMapPlace at = rollPlace(m->geometry, dice, &hit);
        const vplVec3 way = wayToMap(m, at.position);
        if (!isInView(m, at.position) || !(vplDot(way, at.normal) > 0.01f * vplLength(way))) {
            continue;
        }
        const vplRay ray = vplGeometry_Leave(m->geometry, &hit, way);
        const bool dark = vplGeometry_IsOccluded(m->geometry, &ray, 1 - 0x1p-16f);
        const float factor = factorAt(m, at.position, at.normal);
        assert_true(factor >= 0 && factor <= 1 + 1e-6f);
        const bool sure = isSureAt(m, at.position, at.normal, dark);
        tally->pairs++;
        tally->dark += dark;
        tally->sure += sure;
        tally->apart += dark != (factor > 0.5f);
        if (sure && fabsf(factor - (float)dark) > 1e-6f) {
            fail_msg("%s, point %d: the ray says %d, the map %g", nameOfKind(m->kind), i, dark,
                     (double)factor);
        }
    }
}

// Maps are at random places among the room's objects, around a sphere in a box, and in an empty cube without
// shadows. Directional light needs a scene that is open on one side.
TEST(MapsAndRaysAgreeOutsideTheBand, 2)
{
    for (int k = 0; k < 3 * MAP_KINDS; k++) {
        const MapKind kind = (MapKind)(k / 3);
        const int which = k % 3;
        const bool directional = kind == MAP_REFLECTIVE_DIRECTIONAL;
        if (directional && which > 0) {
            continue;
        }
        vplGeometry* g = which == 2 ? closedCube(context, 0.5f) : clutter(context, which);
        Dice dice = {11, 0};
        Tally t = {0};
        for (int i = 0; i < 40; i++) {
            vplHit hit;
            const vplHemiMapPlace place = rollPlace(g, &dice, &hit);
            const bool onSurface = kind == MAP_HEMI || kind == MAP_PARABOLOID;
            const vplVec3 inside = vplAdd(vplScale(0.87f, place.position), vplVec(0.01f, 0.02f, 0.03f));
            ShadowMap m = openMap(kind, g, onSurface ? place.position : inside,
                                  directional ? vplVec(-0.3f + 0.02f * (float)i, -0.5f, -1) : place.normal,
                                  16 << i % 4);
            compareWithRays(&m, &dice, 200, &t);
            closeMap(&m);
        }
        printf("# %s, scene %d: %d pairs, %d dark, %d sure, %d apart\n", nameOfKind(kind), which, t.pairs,
               t.dark, t.sure, t.apart);
        assert_true(t.pairs > 1000 && t.apart < t.pairs / 12);
        assert_true(which == 2 ? t.dark == 0 : t.dark > t.pairs / 100);
        assert_true(t.sure > t.pairs / 2);
        vplGeometry_Destroy(g);
    }
}

// The ground is 4 m wide and 4 km: the shadow of a box 1 m high is as sharp.
TEST(ShadowsAreAsSharpAsTheMapHoweverFarTheSceneReaches, 2)
{
    for (float side = 4; side <= 4096; side *= 32) {
        vplScene* scene = sceneOf(context, 0.5f);
        addThing(scene, VPL_OBJECT_QUAD, 0, vplVec(0, 0, 0), -VPL_PI / 2, 0, vplVec(side, side, 1));
        addThing(scene, VPL_OBJECT_BOX, 0, vplVec(0, 0.5f, 0), 0, 0.4, vplVec(1, 1, 1));
        vplGeometry* g = buildGeometry(scene);
        ShadowMap m = openMap(MAP_SOFT_CUBE, g, vplVec(2, 4, 1.5f), vplVec(0, -1, 0), 1024);
        Dice dice = {21, 0};
        int dark = 0, sure = 0;
        for (int i = 0; i < 4000; i++) {
            const vplVec3 p = vplVec(roll(&dice, -2, 2), 0, roll(&dice, -2, 2)), n = vplVec(0, 1, 0);
            const vplVec3 way = vplScale(1 - 0x1p-14f, vplSub(p, m.position));
            const bool hidden = isDarkBetween(g, m.position, vplAdd(m.position, way));
            if (isSureAt(&m, p, n, hidden)) {
                assertNear((double)factorAt(&m, p, n), hidden, 0, "shadow", i);
                dark += hidden;
                sure++;
            }
        }
        printf("# ground of %g m: %d sure, %d dark\n", (double)side, sure, dark);
        assert_true(sure > 3800 && dark > 200);
        closeMap(&m);
        vplGeometry_Destroy(g);
    }
}

// Everything outside a closed box must be dark for a map inside it, also where faces, hemispheres and texels
// meet.
TEST(NoLightGoesThroughSeams, 1)
{
    vplGeometry* g = closedCube(context, 0.5f);
    for (int k = 0; k < 3 * MAP_KINDS; k++) {
        static const int sizes[] = {8, 33, 128};
        Dice dice = {5, 0};
        const bool directional = k / 3 == MAP_REFLECTIVE_DIRECTIONAL;
        for (int turn = 0; turn < 8; turn++) {
            const vplVec3 forward = turn < 3 ? vplVec(turn == 0, turn == 1, turn == 2) : rollUnit(&dice);
            ShadowMap m = openMap((MapKind)(k / 3), g, vplVec(0, 0, 0), forward, sizes[k % 3]);
            for (int i = 0; i < 400; i++) {
                vplVec3 d = rollUnit(&dice);
                if (i % 2) { // on the seams of a cube map's faces, along their edges
                    d = vplVec(i & 2 ? 1 : -1, i & 4 ? 1 : -1, roll(&dice, -1, 1));
                    d = i % 3 == 0 ? d : i % 3 == 1 ? vplVec(d.z, d.x, d.y) : vplVec(d.y, d.z, d.x);
                }
                if (i % 5 == 0) { // on the seam of the hemispheres
                    d = vplCross(forward, d);
                }
                const vplVec3 p = vplScale(directional ? 0.5f : 6, vplNormalize(d));
                const vplVec3 n = vplNormalize(wayToMap(&m, p));
                if (isInView(&m, p) && factorAt(&m, p, n) < 1 - 1e-6f) {
                    fail_msg("%s of %d^2 texels: %g in (%g, %g, %g)", nameOfKind(m.kind), sizes[k % 3],
                             (double)factorAt(&m, p, n), (double)p.x, (double)p.y, (double)p.z);
                }
            }
            closeMap(&m);
        }
    }
    vplGeometry_Destroy(g);
}

// X057
TEST(WithNothingThereAllIsLit, 1)
{
    vplGeometry* below = floorQuad(context, vplVec(0, -5, 0), 2, 0.5f);
    Dice dice = {1, 0};
    for (int k = 0; k < MAP_KINDS; k++) {
        const float up = k == MAP_REFLECTIVE_DIRECTIONAL ? -1 : 1; // from below, the floor would be dark
        ShadowMap m = openMap((MapKind)k, below, vplVec(0.3f, 0, 0.2f), vplVec(0, up, 0), 5);
        for (int i = 0; i < 100; i++) {
            const vplVec3 p = vplVec(roll(&dice, -9, 9), roll(&dice, 0.1f, 9), roll(&dice, -9, 9));
            if (factorAt(&m, p, vplNormalize(wayToMap(&m, p))) != 0) {
                fail_msg("%s, (%g, %g, %g)", nameOfKind(m.kind), (double)p.x, (double)p.y, (double)p.z);
            }
        }
        closeMap(&m);
    }
    vplGeometry_Destroy(below);
}

// The half space that a map does not draw is dark, because its light does not shine there. Beyond a spot's
// cone nothing is drawn either, but points count as unshadowed, because the spot's own falloff ends its
// light.
TEST(WhatIsBehindAMapOfAHalfSpaceIsDark, 1)
{
    vplGeometry* g = floorQuad(context, vplVec(0, 0, 0), 2, 0.5f);
    Dice dice = {1, 0};
    static const MapKind kinds[] = {MAP_HEMI, MAP_PARABOLOID, MAP_REFLECTIVE_SPOT};
    for (int k = 0; k < 3; k++) {
        ShadowMap m = openMap(kinds[k], g, vplVec(0.3f, 0, 0.2f), vplVec(0, 1, 0), 5);
        for (int i = 0; i < 100; i++) {
            const vplVec3 p = vplVec(roll(&dice, -9, 9), roll(&dice, -9, -0.1f), roll(&dice, -9, 9));
            assert_true(factorAt(&m, p, vplVec(0, 1, 0)) == (k < 2));
        }
        closeMap(&m);
    }
    vplGeometry_Destroy(g);
}

TEST(OddPointsGetAShareOfLight, 1)
{
    vplGeometry* g = closedCube(context, 0.5f);
    const vplVec3 odd[] = {{0.1f, 0.2f, 0.3f}, {NAN, 0, 0},       {INFINITY, 0, -INFINITY},
                           {0, 1e30f, 0},      {3e38f, 3e38f, 0}, {1e-30f, 0, 0},
                           {1, 1, 1}};
    for (int k = 0; k < MAP_KINDS; k++) {
        ShadowMap m = openMap((MapKind)k, g, odd[0], vplVec(0, -1, 0), 16);
        for (size_t i = 0; i < sizeof odd / sizeof *odd; i++) {
            if (m.cube != NULL && !isfinite(odd[i].x)) {
                continue; // cube maps require finite points
            }
            const float factor = factorAt(&m, odd[i], vplVec(0, -1, 0));
            assert_true(factor >= 0 && factor <= 1 + 1e-6f);
        }
        closeMap(&m);
    }
    vplGeometry_Destroy(g);
}

static void rollBlock(const vplGeometry* g, Dice* dice, vplSurface* s)
{
    for (int l = 0; l < VPL_LANES; l++) {
        vplHit hit;
        const vplHemiMapPlace at = rollPlace(g, dice, &hit);
        setPoint(s, l, at.position, at.normal);
    }
}

// Lanes do not affect each other.
TEST(ABlockHasTheBitsOfSingleLookups, 1)
{
    vplGeometry* g = clutter(context, 0);
    for (int k = 0; k < MAP_KINDS; k++) {
        Dice dice = {7, 0};
        ShadowMap m = openMap((MapKind)k, g, vplVec(0.4f, 2.1f, 0.2f), vplVec(-0.28f, -0.96f, 0), 60);
        int between = 0;
        for (int block = 0; block < 60; block++) {
            vplSurface s;
            float factor[VPL_LANES];
            rollBlock(g, &dice, &s);
            factorBlock(&m, &s, factor);
            for (int l = 0; l < VPL_LANES; l++) {
                const vplVec3 p = {s.px[l], s.py[l], s.pz[l]}, n = {s.nx[l], s.ny[l], s.nz[l]};
                const float single = factorAt(&m, p, n);
                assert_memory_equal(&single, &factor[l], sizeof single);
                assert_true(m.cube == NULL || vplShadow_Factor(&m.shadow, p, n) == single);
                between += single > 0 && single < 1;
            }
        }
        assert_true((between > 0) == (k != MAP_CUBE && k != MAP_HEMI)); // these two kinds give only 0 or 1
        closeMap(&m);
    }
    vplGeometry_Destroy(g);
}

static uint64_t hashOf(vplContext* context)
{
    uint64_t hash = 0;
    for (int k = 0; k < 2 * MAP_KINDS; k++) {
        vplGeometry* g = clutter(context, k % 2);
        Dice dice = {9, 0};
        vplHit hit;
        const vplHemiMapPlace place = rollPlace(g, &dice, &hit);
        ShadowMap m = openMap((MapKind)(k / 2), g, vplScale(0.9f, place.position), place.normal, 52);
        const uint64_t texels = hashMap(&m);
        hash = vplHashWords(hash, (const uint32_t*)&texels, 2);
        for (int block = 0; block < 40; block++) {
            vplSurface s;
            float factor[VPL_LANES];
            rollBlock(g, &dice, &s);
            factorBlock(&m, &s, factor);
            hash = vplHashFloats(hash, factor, VPL_LANES);
        }
        closeMap(&m);
        vplGeometry_Destroy(g);
    }
    closeTestContext(context);
    return hash;
}

TEST_ALONE(MapsAndFactorsHaveTheSameBitsEverywhere)
{
    assertSameEverywhere(hashOf);
}

// X067
// Maps of all sizes except the coarsest find a wall between map and point, and leave a point beside the wall
// lit.
TEST(MapsOfAllSizesTellAWallFromNone, 2)
{
    static const int sizes[] = {1, 2, 3, 5, 7, 16, 64, 257, 1024};
    vplGeometry* g = floorQuad(context, vplVec(0, 0, 0), 2, 0.5f);
    for (int k = 0; k < MAP_KINDS; k++) {
        for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
            ShadowMap m = openMap((MapKind)k, g, vplVec(0, 2, 0), vplVec(0, -1, 0), sizes[i]);
            const float dark = factorAt(&m, vplVec(0.1f, -30, 0.1f), vplVec(0, 1, 0));
            const float lit = factorAt(&m, vplVec(0.1f, 1, 0.1f), vplVec(0, 1, 0));
            const float least = sizes[i] < 5 ? 0 : sizes[i] < 16 ? 0.5f : 1;
            if (lit != 0 || dark < least) {
                fail_msg("%s of %d^2 texels: %g and %g", nameOfKind(m.kind), sizes[i], (double)lit,
                         (double)dark);
            }
            closeMap(&m);
        }
    }
    vplGeometry_Destroy(g);
}

TEST(SizesOutOfRangeAreRefused, 1)
{
    vplGeometry* g = floorQuad(context, vplVec(0, 0, 0), 2, 0.5f);
    static const int sizes[] = {-1, 0, VPL_MAX_SHADOW_MAP + 1};
    for (int k = 0; k < 3 * MAP_KINDS; k++) {
        ShadowMap m;
        char number[16];
        snprintf(number, sizeof number, "%d", sizes[k % 3]);
        assert_int_equal(tryOpenMap(&m, (MapKind)(k / 3), g, vplVec(0, 1, 0), vplVec(0, 1, 0), sizes[k % 3]),
                         VPL_INVALID_ARGUMENT);
        assert_non_null(strstr(takeMessage(), number));
        assert_true(m.cube == NULL && m.hemi == NULL && m.paraboloids == NULL && m.reflective == NULL);
    }
    vplGeometry_Destroy(g);
}

static vplResult openInRoom(Attempt* a)
{
    TRY(vplScene_Load(a->context, "tests/data/room.json", &a->scene));
    TRY(vplGeometry_Create(a->scene, &a->geometry));
    return tryOpenMap(&a->map, (MapKind)a->variant, a->geometry, vplVec(0, 1, 0), vplVec(0, 1, 0), 8);
}

TEST_ALONE(EveryFailedAllocationOfAMapIsReported)
{
    failEveryAllocation("ShadowMaps", openInRoom, "png", MAP_KINDS);
}
