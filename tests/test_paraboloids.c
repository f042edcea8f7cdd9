// SPDX-License-Identifier: MIT
// Tests of paraboloid maps: the projection, the content of texels, agreement with rays, and extremes.
#include "bench/band.h"
#include "shadow_maps.h"

#include "base/hash.h"
#include "geometry/triangle.h"
#include "math/vec.h"

static vplParaboloidMaps* drawMaps(const vplGeometry* g, int size, const vplParaboloidPlace* places,
                                   int count)
{
    vplParaboloidMaps* maps;
    assert_int_equal(vplParaboloidMaps_Create(g->context, size, count, true, &maps), VPL_SUCCESS);
    assert_int_equal(vplParaboloidMaps_Draw(maps, g, places, count, NULL, NULL), VPL_SUCCESS);
    return maps;
}

static size_t placeOf(const vplParaboloidMap* map, int hemisphere, int i)
{
    return (size_t)hemisphere * vplParaboloidMap_Texels(map->size) +
           vplParaboloidMap_Place(map->size, i % map->size, i / map->size);
}

// Returns the direction of texel i in the map's frame; its length is 1 + p^2.
static vplVec3 localOf(const vplParaboloidMap* map, int hemisphere, int i)
{
    const float x = (float)(2 * (i % map->size) + 1) / (float)map->size - 1;
    const float y = (float)(2 * (i / map->size) + 1) / (float)map->size - 1;
    const float z = 1 - x * x - y * y;
    return vplVec(2 * x, 2 * y, hemisphere == 0 ? z : -z);
}

static vplVec3 toWorld(const vplParaboloidMap* map, vplVec3 d)
{
    return vplAdd(vplAdd(vplScale(d.x, map->right), vplScale(d.y, map->up)), vplScale(d.z, map->forward));
}

// ---- the projection

// X102: directions straight back and of length 0 are refused, and those of the rim have length 1.
TEST_ALONE(ProjectionFollowsTheTable)
{
    Table t = loadTable("paraboloid.csv");
    int refused = 0, onRim = 0;
    for (int row = 0; row < t.rows; row++) {
        const vplVec3 d = vectorOf(&t, row, "d");
        double x = 7, y = 7;
        const bool projects = vplParaboloid_Project(d, &x, &y);
        if (isEmpty(&t, row, "px")) {
            assert_false(projects);
            assert_true(x == 7 && y == 7);
            refused++;
            continue;
        }
        assert_true(projects);
        const double square = x * x + y * y, squared = number(&t, row, "r2");
        assertNear(square, squared, 1e-15 * (1 + squared), "r2", row);
        assertNear(4 / ((1 + square) * (1 + square)), number(&t, row, "dw_dA"), 2e-15, "dw_dA", row);
        assertNear((x + 1) / 2, number(&t, row, "u"), 1e-15 * (1 + fabs(x)), "u", row);
        assertNear((y + 1) / 2, number(&t, row, "v"), 1e-15 * (1 + fabs(y)), "v", row);
        if (d.z == 0) {
            assert_true(square == 1 && vplParaboloid_Weight(x, y) == 0);
            onRim++;
        }
        assertNear(x, number(&t, row, "px"), 1e-15 * (1 + fabs(x)), "x", row);
        assertNear(y, number(&t, row, "py"), 1e-15 * (1 + fabs(y)), "y", row);
        if (!isEmpty(&t, row, "cosine_weight_W")) {
            assertNear(vplParaboloid_Weight(x, y), number(&t, row, "cosine_weight_W"), 2e-15, "weight", row);
        } else {
            assert_true(vplParaboloid_Weight(x, y) == 0);
        }
    }
    assert_true(t.rows > 30 && refused == 2 && onRim == 2);
    freeTable(&t);
    double x, y;
    assert_false(vplParaboloid_Project(vplVec(INFINITY, 0, 1), &x, &y));
    assert_false(vplParaboloid_Project(vplVec(0, NAN, 1), &x, &y));
    assert_true(vplParaboloid_Project(vplVec(3e38f, 0, 3e38f), &x, &y));
    assertNear(x, sqrt(2) - 1, 1e-15, "huge", 0);
    assert_true(vplParaboloid_Project(vplVec(0, 1e-45f, 1e-45f), &x, &y));
    assertNear(y, sqrt(2) - 1, 1e-15, "tiny", 0);
    assert_true(vplParaboloid_Project(vplVec(1e-8f, 0, -1), &x, &y));
    assertNear(x / 2e8, 1, 1e-7, "almost behind", 0);
}

TEST_ALONE(UnprojectionIsTheInverse)
{
    Table t = loadTable("paraboloid_inverse.csv");
    for (int row = 0; row < t.rows; row++) {
        const double px = number(&t, row, "px"), py = number(&t, row, "py");
        const vplVec3 d = vplParaboloid_Unproject(px, py);
        double x, y;
        assertNear((double)vplLength(vplSub(d, vectorOf(&t, row, "w"))), 0, 1e-7, "direction", row);
        assert_true(vplParaboloid_Project(d, &x, &y));
        assertNear(hypot(x - px, y - py), 0, 2e-7, "back", row);
    }
    freeTable(&t);
}

// X043: the samples include the first Hammersley point and points next to 1; X104: the mean weight over the
// disk is 1.
TEST_ALONE(WeightsOfDiskSamplesFollowTheTable)
{
    Table t = loadTable("disk_maps.csv");
    for (int row = 0; row < t.rows; row++) {
        const double x = number(&t, row, "polar_x"), y = number(&t, row, "polar_y");
        assertNear(vplParaboloid_Weight(x, y), number(&t, row, "W_polar"), 1e-14, "polar", row);
        const double cx = number(&t, row, "concentric_x"), cy = number(&t, row, "concentric_y");
        assertNear(vplParaboloid_Weight(cx, cy), number(&t, row, "W_concentric"), 1e-14, "concentric", row);
    }
    freeTable(&t);
    double sum = 0;
    for (int i = 0; i < 1000000; i++) {
        sum += vplParaboloid_Weight(sqrt((i + 0.5) * 1e-6), 0);
    }
    assertNear(sum * 1e-6, 1, 1e-9, "mean weight", 0);
}

// ---- texels

static vplParaboloidPlace rollPlaceOf(const vplGeometry* g, Dice* dice, bool onSurface)
{
    vplHit hit;
    const vplHemiMapPlace at = rollPlace(g, dice, &hit);
    const vplVec3 inside = vplAdd(vplScale(0.87f, at.position), vplVec(0.01f, 0.02f, 0.03f));
    return onSurface ? (vplParaboloidPlace){at.position, at.normal, 1, true}
                     : (vplParaboloidPlace){inside, rollUnit(dice), 2, false};
}

static void checkTexels(const vplGeometry* g, const vplParaboloidMap* map, int which, int place)
{
    const float rim = vplParaboloidMap_Rim(map->size, map->hemispheres);
    const vplVec3 from[] = {map->position, map->right, map->up};
    for (int i = 0; i < map->hemispheres * map->size * map->size; i++) {
        const int hemisphere = i / (map->size * map->size), texel = i % (map->size * map->size);
        const vplVec3 local = localOf(map, hemisphere, texel), d = toWorld(map, local);
        const float length = vplLength(d);
        const double p = hypot((2 * (texel % map->size) + 1.0) / map->size - 1,
                               (2 * (texel / map->size) + 1.0) / map->size - 1);
        const float stored = map->texels[placeOf(map, hemisphere, texel)];
        const int triangle = map->triangles[placeOf(map, hemisphere, texel)];
        assert_true((stored > 0) == (triangle >= 0) && stored >= 0 && stored < INFINITY);
        if (fabs(p - rim) < 1e-5) {
            continue; // rounding decides between inside and outside
        }
        if (p > rim) {
            assert_true(stored == 0);
            continue;
        }
        // At the horizon, rounding decides whether the ray hits the place's own surface.
        const bool own = map->hemispheres == 1 && local.z < 2e-3f;
        if (!own && !holdsRay(g, from, d, stored * length)) {
            fail_msg("scene %d, place %d, hemisphere %d, texel %d of %d^2: 1/distance is %.9g", which, place,
                     hemisphere, texel, map->size, (double)stored);
        }
        vplHit hit;
        vplVec3 direction;
        const int n = map->size;
        const bool got = vplParaboloidMap_GetHit(
            map, g, (vplParaboloidTexel){hemisphere, texel % n, texel / n}, &hit, &direction);
        assert_true(got == (stored > 0 && p <= 1));
        if (got) {
            const vplVec3 way = vplSub(hit.position, map->position);
            assertNear((double)vplDot(direction, d) / (double)length, 1, 1e-5, "direction", texel);
            assertNear((double)(vplLength(way) * stored), 1, 1e-3, "distance", texel);
            assert_true(hit.triangle == triangle && hit.object == g->owners[triangle]);
        }
    }
}

TEST(EachTexelHoldsWhatARayThroughItsCentreMeets, 2)
{
    for (int which = 0; which < 2; which++) {
        vplGeometry* g = clutter(context, which);
        Dice dice = {7, 0};
        for (int i = 0; i < 40; i++) {
            const vplParaboloidPlace place = rollPlaceOf(g, &dice, i % 2);
            vplParaboloidMaps* maps = drawMaps(g, 1 + i, &place, 1); // full and partial blocks
            checkTexels(g, &maps->maps[0], which, i);
            vplParaboloidMaps_Destroy(maps);
        }
        vplGeometry_Destroy(g);
    }
}

// ---- bounds: a triangle covers all texels whose directions hit it, and no others

static vplVec3 nastyCorner(Dice* dice, int kind)
{
    const vplVec3 p = rollVec(dice, 1);
    switch (kind % 6) {
    case 0: // anywhere, also behind the map
        return p;
    case 1: // huge
        return vplScale(1000, p);
    case 2: // across the horizon
        return vplVec(p.x, p.y, 0.02f * p.z);
    case 3: // close to the axis, in front or behind
        return vplVec(0.01f * p.x, 0.01f * p.y, p.z);
    case 4: // near
        return vplScale(0.01f, p);
    default: // on the horizon and on the axes
        return vplVec(roundf(2 * p.x), roundf(2 * p.y), 0);
    }
}

static void cross(const double a[3], const double b[3], double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void widen(const vplVec3 corner[3], double p[3][3])
{
    for (int k = 0; k < 3; k++) {
        p[k][0] = (double)corner[k].x;
        p[k][1] = (double)corner[k].y;
        p[k][2] = (double)corner[k].z;
    }
}

// Returns the least sine of the angles between a direction and the planes of a triangle's edges; positive
// inside.
static double depthIn(const vplVec3 corner[3], vplVec3 direction)
{
    double p[3][3], e[3], least = INFINITY;
    const double d[3] = {(double)direction.x, (double)direction.y, (double)direction.z};
    widen(corner, p);
    for (int k = 0; k < 3; k++) {
        cross(p[k], p[(k + 1) % 3], e);
        const double side = dot(e, p[(k + 2) % 3]) > 0 ? 1 : -1;
        const double at = side * dot(e, d) / sqrt(dot(e, e) * dot(d, d));
        least = at < least ? at : least;
    }
    return least;
}

// Returns the distance of the triangle's plane relative to that of its nearest corner.
static double heightOf(const vplVec3 corner[3])
{
    double p[3][3], a[3], b[3], n[3];
    widen(corner, p);
    for (int k = 0; k < 3; k++) {
        a[k] = p[1][k] - p[0][k];
        b[k] = p[2][k] - p[0][k];
    }
    cross(a, b, n);
    const double nearest = fmin(dot(p[0], p[0]), fmin(dot(p[1], p[1]), dot(p[2], p[2])));
    return nearest > 0 ? fabs(dot(n, p[0])) / sqrt(dot(n, n) * nearest) : 0;
}

// X103
TEST(BoundsOfTrianglesLoseNoTexel, 1)
{
    Dice dice = {21, 0};
    int64_t inside = 0, outside = 0;
    for (int i = 0; i < 6000; i++) {
        vplVec3 corner[3];
        for (int k = 0; k < 3; k++) {
            corner[k] = nastyCorner(&dice, i + k * (i / 6 % 6));
        }
        if (i % 4 == 0) { // a needle
            corner[2] = vplAdd(corner[1], vplScale(0.02f, rollVec(&dice, 1)));
        }
        for (int k = 1; k < 3 && i % 7 == 0; k++) { // a small triangle
            corner[k] = vplAdd(corner[0], vplScale(0.4f * vplLength(corner[0]), rollVec(&dice, 1)));
        }
        vplScene* scene = sceneOf(context, 0.5f);
        Shape one = {0};
        addTriangle(&one, corner[0], corner[1], corner[2]);
        addShape(scene, &one, false, NULL);
        freeShape(&one);
        vplGeometry* g = buildGeometry(scene);
        const double height = heightOf(corner);
        const vplParaboloidPlace place = {vplVec(0, 0, 0), vplVec(0, 0, 1), 1 + i % 2, false};
        vplParaboloidMaps* maps = drawMaps(g, 5 + i % 60, &place, 1);
        const vplParaboloidMap* map = &maps->maps[0];
        const float rim = vplParaboloidMap_Rim(map->size, map->hemispheres);
        for (int t = 0; t < map->hemispheres * map->size * map->size; t++) {
            const int h = t / (map->size * map->size), texel = t % (map->size * map->size);
            const vplVec3 d = toWorld(map, localOf(map, h, texel));
            const bool covered = map->texels[placeOf(map, h, texel)] > 0;
            const double depth = depthIn(corner, d);
            // Seen edge-on, a triangle may be covered or not.
            if (height > 1e-5 && vplLength(d) - 1 < rim * rim - 1e-5f && covered != (depth > 0) &&
                fabs(depth) > 1e-5) {
                for (int k = 0; k < 3; k++) {
                    printf("# corner %.9g %.9g %.9g\n", (double)corner[k].x, (double)corner[k].y,
                           (double)corner[k].z);
                }
                fail_msg("triangle %d, hemisphere %d, texel %d of %d^2: %d, depth %.3g", i, h, texel,
                         map->size, covered, depth);
            }
            inside += covered;
            outside += !covered;
        }
        vplParaboloidMaps_Destroy(maps);
        vplGeometry_Destroy(g);
    }
    printf("# %lld texels covered, %lld not\n", (long long)inside, (long long)outside);
    assert_true(inside > 100000 && outside > 100000);
}

TEST(SharedEdgesLeaveNoHoles, 2)
{
    Dice dice = {13, 0};
    for (int i = 0; i < 24; i++) {
        Shape shape = i % 3 == 0 ? icosphere(i / 3 % 4) : i % 3 == 1 ? ringSphere(20 + i) : gridBox(1 + i);
        const double turned[3] = {(double)roll(&dice, 0, 3), (double)roll(&dice, 0, 3), 0};
        placeShape(&shape, 1 + (float)(i % 5), turned, vplVec(0.1f, 0.2f, -0.1f));
        vplScene* scene = sceneOf(context, 0.5f);
        addShape(scene, &shape, false, NULL);
        freeShape(&shape);
        vplGeometry* g = buildGeometry(scene);
        const vplParaboloidPlace place = {rollVec(&dice, 0.3f), i % 4 ? rollUnit(&dice) : vplVec(0, 0, 1), 2,
                                          false};
        vplParaboloidMaps* maps = drawMaps(g, 64 + i, &place, 1);
        const vplParaboloidMap* map = &maps->maps[0];
        for (int t = 0; t < 2 * map->size * map->size; t++) {
            const int h = t / (map->size * map->size), texel = t % (map->size * map->size);
            if (vplLength(localOf(map, h, texel)) < 2) {
                assert_true(map->texels[placeOf(map, h, texel)] > 0);
            }
        }
        vplParaboloidMaps_Destroy(maps);
        vplGeometry_Destroy(g);
    }
}

// X103: a thin band along an edge must cover the projection of its midpoint, but not the midpoint of the
// chord between its projected ends, which is up to 169 texels (of 512) away.
TEST(EdgesBendAsTheyShould, 1)
{
    Table t = loadTable("paraboloid_edge_error.csv");
    int bent = 0;
    for (int row = 0; row < t.rows; row++) {
        enum { MAP = 512 };
        const vplVec3 a = vectorOf(&t, row, "a"), b = vectorOf(&t, row, "b");
        const vplVec3 points[3] = {a, b, vplScale(0.5f, vplAdd(a, b))};
        static const char* const columns[3][2] = {{"pa_x", "pa_y"}, {"pb_x", "pb_y"}, {"pmid_x", "pmid_y"}};
        double image[3][2];
        for (int i = 0; i < 3; i++) {
            assert_true(vplParaboloid_Project(points[i], &image[i][0], &image[i][1]));
            assertNear(image[i][0], number(&t, row, columns[i][0]), 1e-15, columns[i][0], row);
            assertNear(image[i][1], number(&t, row, columns[i][1]), 1e-15, columns[i][1], row);
        }
        const double ux = image[1][0] - image[0][0], uy = image[1][1] - image[0][1],
                     mx = image[2][0] - image[0][0], my = image[2][1] - image[0][1],
                     off = fabs(ux * my - uy * mx) / hypot(ux, uy);
        assertNear(off, number(&t, row, "offset_from_chord"), 1e-14, "offset", row);
        assertNear(off * MAP / 2, number(&t, row, "offset_in_texels_of_512"), 1e-11, "texels", row);
        const vplVec3 across = vplScale(0.01f, vplNormalize(vplCross(a, b)));
        vplScene* scene = sceneOf(context, 0.5f);
        Shape band = {0};
        const vplVec3 c[4] = {vplAdd(a, across), vplAdd(b, across), vplSub(b, across), vplSub(a, across)};
        addTriangle(&band, c[0], c[1], c[2]);
        addTriangle(&band, c[0], c[2], c[3]);
        addShape(scene, &band, false, NULL);
        freeShape(&band);
        vplGeometry* g = buildGeometry(scene);
        const vplParaboloidPlace place = {vplVec(0, 0, 0), vplVec(0, 0, 1), 1, false};
        vplParaboloidMaps* maps = drawMaps(g, MAP, &place, 1);
        const vplParaboloidMap* map = &maps->maps[0];
        const float frame[2][2] = {{map->right.x, map->right.y}, {map->up.x, map->up.y}};
        const double middle[2] = {number(&t, row, "pmid_x"), number(&t, row, "pmid_y")};
        const double chord[2] = {0.5 * (number(&t, row, "pa_x") + number(&t, row, "pb_x")),
                                 0.5 * (number(&t, row, "pa_y") + number(&t, row, "pb_y"))};
        for (int which = 0; which < 2; which++) {
            const double* p = which ? chord : middle;
            int at[2];
            for (int k = 0; k < 2; k++) { // the map's axes may be rotated
                const double x = (double)frame[k][0] * p[0] + (double)frame[k][1] * p[1];
                at[k] = (int)((x + 1) * 0.5 * MAP);
            }
            const bool covered = map->texels[placeOf(map, 0, at[1] * MAP + at[0])] > 0;
            if (which == 0) {
                assert_true(covered);
            } else if (number(&t, row, "offset_in_texels_of_512") > 10) {
                assert_false(covered);
                bent++;
            }
        }
        vplParaboloidMaps_Destroy(maps);
        vplGeometry_Destroy(g);
    }
    assert_true(bent >= 4);
    freeTable(&t);
}

// ---- shadows

// Means of clusters may lie anywhere: inside a solid, on a vertex, an edge or a surface.
TEST(PlacesInMidAirGiveNumbersAnywhere, 2)
{
    vplGeometry* g = clutter(context, 1);
    Dice dice = {17, 0};
    for (int i = 0; i < 60; i++) {
        const vplTriangleCorners c = vplGeometry_Corners(g, (int)roll(&dice, 0, (float)g->triangleCount));
        const vplVec3 middle = vplScale(0.5f, vplAdd(c.corner[0], c.corner[1]));
        const vplVec3 at = i % 3 == 0   ? c.corner[0]
                           : i % 3 == 1 ? middle
                                        : vplScale(1 / 3.0f, vplAdd(vplScale(2, middle), c.corner[2]));
        const vplParaboloidPlace place = {at, i % 2 ? rollUnit(&dice) : vplVec(0, 0, 1), 2, i % 5 == 0};
        vplParaboloidMaps* maps = drawMaps(g, 33, &place, 1);
        const vplParaboloidMap* map = &maps->maps[0];
        for (int t = 0; t < 2 * 33 * 33; t++) {
            const float stored = map->texels[placeOf(map, t / (33 * 33), t % (33 * 33))];
            assert_true(stored >= 0 && stored < INFINITY);
        }
        for (int k = 0; k < 20; k++) {
            vplHit hit;
            const vplHemiMapPlace p = rollPlace(g, &dice, &hit);
            const float factor = vplParaboloidMap_Factor(map, p.position, p.normal);
            assert_true(factor >= 0 && factor <= 1 + 1e-6f);
        }
        vplParaboloidMaps_Destroy(maps);
    }
    vplGeometry_Destroy(g);
}

// ---- refusals, determinism, extremes

TEST(MapsCanBeRefusedAndCancelled, 1)
{
    vplGeometry* g = closedCube(context, 0.5f);
    vplParaboloidMaps* maps = NULL;
    assert_int_equal(vplParaboloidMaps_Create(context, 0, 1, false, &maps), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "0 texels"));
    assert_int_equal(vplParaboloidMaps_Create(context, VPL_MAX_SHADOW_MAP + 1, 1, false, &maps),
                     VPL_INVALID_ARGUMENT);
    assert_int_equal(vplParaboloidMaps_Create(context, 8, -1, false, &maps), VPL_INVALID_ARGUMENT);
    assert_null(maps);
    assert_int_equal(vplParaboloidMaps_Create(context, 8, 8, false, &maps), VPL_SUCCESS);
    vplParaboloidPlace places[9];
    for (int i = 0; i < 9; i++) {
        places[i] = (vplParaboloidPlace){vplVec(0, -1, 0), vplVec(0, 1, 0), 1, true};
    }
    assert_int_equal(vplParaboloidMaps_Draw(maps, g, places, 9, NULL, NULL), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "room for 8"));
    places[3].hemispheres = 3;
    assert_int_equal(vplParaboloidMaps_Draw(maps, g, places, 8, NULL, NULL), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "place 3 is 3"));
    places[3].hemispheres = 1;
    int asked = 0;
    assert_int_equal(vplParaboloidMaps_Draw(maps, g, places, 8, refuseThird, &asked), VPL_CANCELLED);
    assert_true(asked == 3);
    assert_int_equal(vplParaboloidMaps_Draw(maps, g, places, 0, NULL, NULL), VPL_SUCCESS);
    vplParaboloidMaps_Destroy(maps);
    vplParaboloidMaps_Destroy(NULL);
    vplGeometry_Destroy(g);
}
