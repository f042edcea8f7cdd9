// SPDX-License-Identifier: MIT
// Tests of depth_precision.csv: what the library's depths store at 42 view distances, and what rounding hides there. The
// library has two kinds of depth: z/w, which pictures reverse, and the distance over the farthest one, in cube maps. The
// columns half_step_unorm24 and half_step_unorm16 are of formats that it does not have: table against formula.
#include "raster_support.h"
#include "shapes.h"

#include "math/vec.h"
#include "raster/raster.h"

#define UNIT 0x1p-24 // of float's rounding

enum { ROWS = 42, SIDE = 4 };

// A row: planes, the distance z along the view axis, z/w reversed, and the growth of z/w with z.
typedef struct Depths {
    double near, far, z, reversed, slope;
} Depths;

static Depths depthsOf(const Table* t, int row)
{
    Depths d = {number(t, row, "near"), number(t, row, "far"), number(t, row, "view_z"), 0, 0};
    d.reversed = d.near / (d.far - d.near) * (d.far - d.z) / d.z;
    d.slope = d.far / (d.far - d.near) * d.near / (d.z * d.z);
    return d;
}

static vplView viewOf(const Depths* d)
{
    vplCameraDef camera = vplDefaultCameraDef();
    camera.eye = vplVec(0, 0, 0);
    camera.target = vplVec(0, 0, -1);
    camera.nearPlane = d->near;
    camera.farPlane = d->far;
    return vplView_Create(&camera, SIDE, SIDE);
}

// The depth that the rasterizer stores for a triangle that faces the camera at z and fills the picture.
static double drawnDepth(vplContext* context, const vplView* view, float z)
{
    const float wide = 4 * z;
    const vplVec3 points[3] = {{-wide, -wide, -z}, {3 * wide, -wide, -z}, {-wide, 3 * wide, -z}};
    ClipVertex v[3] = {{0}};
    float clip[3][4];
    vplView_ToClip(view, points, 3, clip);
    for (int i = 0; i < 3; i++) {
        v[i].x = clip[i][0], v[i].y = clip[i][1], v[i].z = clip[i][2], v[i].w = clip[i][3];
    }
    Canvas c = makeCanvas(SIDE, SIDE, 0);
    c.framebuffer.reversedDepth = true;
    const vplPipeline p = showPipeline(v);
    drawList(context, &c, &p, NULL, 3, 1);
    const double depth = (double)c.depth[0];
    assert_true(depth == (double)c.depth[SIDE * SIDE - 1] && c.planes[0][0] == 1);
    freeCanvas(&c);
    return -depth;
}

// X084
// What the view and the rasterizer make of a point is the table's depth. z_ndc is 1 less the reversed depth: table against
// formula, because no picture has it. At the planes themselves a rounding more or less would clip the triangle.
TEST(DepthIsReversedAndThatOfTheTable, 1)
{
    Table t = loadTable("depth_precision.csv");
    int drawn = 0, onPlanes = 0;
    for (int row = 0; row < t.rows; row++) {
        const Depths d = depthsOf(&t, row);
        const vplView view = viewOf(&d);
        const vplVec3 point = vplVec(0, 0, -(float)d.z);
        float clip[1][4];
        vplView_ToClip(&view, &point, 1, clip);
        // The view depth is a float: half an ulp of it changes z/w by slope times that.
        const double ratio = (double)clip[0][2] / (double)clip[0][3],
                     slack = 1.5e-7 * d.reversed + UNIT * d.z * d.slope;
        assertNear(ratio, d.reversed, slack, "z/w", row);
        assertNear(number(&t, row, "z_ndc"), 1 - d.reversed, 1e-12, "z_ndc", row);
        if (d.z == d.near || d.z == d.far) {
            onPlanes++;
            continue;
        }
        assertNear(drawnDepth(context, &view, (float)d.z), (double)(float)ratio, 0, "stored", row);
        drawn++;
    }
    assert_int_equal(drawn, 34);
    assert_int_equal(onPlanes, 8);
    assert_int_equal(t.rows, ROWS);
    freeTable(&t);
}

// The depth that the rasterizer stores at the view distance z + step, by its own projection and rounding.
static float storedDepth(const Depths* d, bool reversed, double step)
{
    const vplRaster raster = {.framebuffer = {.width = SIDE, .height = SIDE, .reversedDepth = reversed}};
    const double share = 1 / (d->far - d->near);
    const double z =
        reversed ? d->near * share * (d->far - d->z - step) : d->far * share * (d->z - d->near + step);
    return vplProject(&raster, 0, 0, z, d->z + step).z;
}

// Finds the least step of the sign of `limit` that changes the stored depth; `limit` does.
static double leastStep(const Depths* d, bool reversed, double limit)
{
    const float own = storedDepth(d, reversed, 0);
    double same = 0, other = limit;
    assert_true(storedDepth(d, reversed, limit) != own);
    for (int i = 0; i < 60; i++) {
        const double middle = same + (other - same) / 2;
        *(storedDepth(d, reversed, middle) == own ? &same : &other) = middle;
    }
    return fabs(other);
}

static bool isPowerOfTwo(float x)
{
    int exponent;
    return fabsf(frexpf(x, &exponent)) == 0.5f;
}

// A power of two has two steps, half of the one beyond it and, half as long, half of the one before it. The table has
// either.
static double eitherStep(float depth, double longer, double wanted)
{
    return isPowerOfTwo(depth) && wanted < 0.75 * longer ? longer / 2 : longer;
}

// Half of the distances that have the same stored depth.
static double hiddenBy(const Depths* d, bool reversed, double wanted)
{
    const float own = storedDepth(d, reversed, 0);
    const double half = (leastStep(d, reversed, 4 * wanted) + leastStep(d, reversed, -4 * wanted)) / 2;
    return eitherStep(own, isPowerOfTwo(own) ? half * 4 / 3 : half, wanted);
}

// What rounding to float hides is found with the library's projection. The growth of depth changes over a step, and so
// does the step's length, by twice its share of the distance. Beyond 1/1000 of the distance the table's steps are those of
// the growth at z, and so are ours: 8 of 84, none of them reversed.
TEST_ALONE(RoundingHidesTheStepsOfTheTable)
{
    static const char* const columns[2] = {"half_step_float32", "half_step_float32_reversed"};
    Table t = loadTable("depth_precision.csv");
    int found = 0, tangents = 0;
    for (int row = 0; row < t.rows; row++) {
        const Depths d = depthsOf(&t, row);
        for (int k = 0; k < 2; k++) {
            const double half = number(&t, row, columns[k]);
            if (half > 0.001 * d.z) {
                const float own = storedDepth(&d, false, 0);
                assert_int_equal(k, 0);
                const double longer = (double)(nextafterf(own, 2) - own) / 2 / d.slope;
                assertNear(eitherStep(own, longer, half), half, 1e-6 * half, columns[k], row);
                tangents++;
                continue;
            }
            assertNear(hiddenBy(&d, k == 1, half), half, half * (1e-7 + 2 * half / d.z), columns[k], row);
            found++;
        }
        const double steps[2] = {0x1p-25 / d.slope, 0x1p-17 / d.slope}; // no format of the library's
        assertNear(steps[0], number(&t, row, "half_step_unorm24"), 1e-5 * steps[0], "half_step_unorm24", row);
        assertNear(steps[1], number(&t, row, "half_step_unorm16"), 1e-5 * steps[1], "half_step_unorm16", row);
    }
    assert_int_equal(found, 76);
    assert_int_equal(tangents, 8);
    assert_int_equal(t.rows, ROWS);
    freeTable(&t);
}

// A cube map of one texel a side, whose ray meets a wall at a right angle, stores the distance over the farthest one, and
// floats of that size hide what the table says.
TEST(CubeMapsHideTheDistancesOfTheTable, 1)
{
    Table t = loadTable("depth_precision.csv");
    for (int row = 0; row < t.rows; row++) {
        const Depths d = depthsOf(&t, row);
        const float z = (float)d.z;
        vplScene* scene = sceneOf(context, 0.5f);
        addThing(scene, VPL_OBJECT_QUAD, 0, vplVec(0, 0, -z), 0, 0, vplVec(4 * z, 4 * z, 1));
        vplGeometry* g = buildGeometry(scene);
        vplCubeMapDef def = vplDefaultCubeMapDef();
        def.position = vplVec(0, 0, 0);
        def.size = 1;
        def.nearPlane = (float)d.near / 2;
        def.farPlane = (float)d.far;
        vplCubeMap* map;
        assert_int_equal(vplCubeMap_Create(g, &def, NULL, NULL, &map), VPL_SUCCESS);
        vplCubePoint point;
        assert_true(vplCube_Find(vplVec(0, 0, -1), 1, &point));
        const float stored = map->texels[point.face];
        // Six roundings: distance, far plane, its inverse, the wall's corners, their w, and the product.
        assertNear((double)stored, d.z / d.far, 6 * UNIT * d.z / d.far, "stored", row);
        const double half = number(&t, row, "half_step_float32_distance_over_far");
        assertNear((double)(nextafterf(stored, 2) - stored) / 2 * d.far, half, 1e-15 * half, "half step",
                   row);
        vplCubeMap_Destroy(map);
        vplGeometry_Destroy(g);
    }
    assert_int_equal(t.rows, ROWS);
    freeTable(&t);
}
