// SPDX-License-Identifier: MIT
// Tests of points on area lights in pictures: what is symmetric is as bright on the left as on the right.
#include "scenes.h"

#include "math/vec.h"

enum { SIDE = 64 };

enum { CEILING, BOX, PAIR, LAMPS };

// A grey cube [-1, 1]^3 with a block on its floor. Its lamps, too, are mirror images of each other or of themselves in x. The camera is
// below the ceiling and sees the floor, or in the front wall and sees the back wall.
static vplScene* mirrorRoom(vplContext* context, int lamps, bool fromAbove)
{
    vplScene* scene = closedCubeScene(context, 0.5f, 0);
    const int lamp = addMaterial(scene, (vplRgb){0, 0, 0}, 5);
    addThing(scene, VPL_OBJECT_BOX, 0, vplVec(0, -0.75f, 0), 0, 0, vplVec(0.5f, 0.5f, 0.5f));
    if (fromAbove) {
        vplCameraDef camera = vplDefaultCameraDef();
        camera.eye = vplVec(0, 0.98f, 0);
        camera.target = vplVec(0, -1, 0);
        camera.up = vplVec(0, 0, -1);
        camera.nearPlane = 0.6; // below the lamps
        assert_int_equal(vplScene_AddCamera(scene, &camera, NULL), VPL_SUCCESS);
    } else {
        aim(scene, vplVec(0, 0, 0.99f), vplVec(0, 0, -1));
    }
    if (lamps == CEILING) {
        addThing(scene, VPL_OBJECT_QUAD, lamp, vplVec(0, 0.99f, 0), VPL_PI / 2, 0, vplVec(0.8f, 0.6f, 1));
    } else if (lamps == BOX) {
        addThing(scene, VPL_OBJECT_BOX, lamp, vplVec(0, 0.7f, 0), 0, 0, vplVec(0.4f, 0.2f, 0.3f));
    }
    for (int side = -1; side <= 1 && lamps == PAIR; side += 2) {
        addThing(scene, VPL_OBJECT_QUAD, lamp, vplVec(0.5f * (float)side, 0.99f, 0), VPL_PI / 2, 0,
                 vplVec(0.4f, 0.6f, 1));
    }
    return scene;
}

// Renders direct light; returns by which part the left half is brighter than the right one.
static double excess(vplContext* context, int lamps, bool fromAbove, int points)
{
    vplScene* scene = mirrorRoom(context, lamps, fromAbove);
    vplRenderOptions o = plainOptions();
    o.method = VPL_METHOD_DIRECT;
    o.lights.areaLightSamples = points;
    o.output.width = o.output.height = SIDE;
    vplImage* image = renderScene(scene, &o, NULL);
    double halves[2] = {0, 0};
    for (int i = 0; i < SIDE * SIDE; i++) {
        halves[i % SIDE >= SIDE / 2] += (double)image->pixels[3 * i];
    }
    vplImage_Destroy(image);
    vplScene_Destroy(scene);
    assert_true(halves[1] > 0);
    return halves[0] / halves[1] - 1;
}

// The points of a lamp are symmetric about its middle, and so is the floor as seen from above: both halves are equal. The faces of
// a box, each with points of its own, leave a small difference. Points are no mirror image of themselves: of what the camera sees
// along z one side is brighter by their covariance.
TEST(ASymmetricRoomIsAsBrightOnTheLeftAsOnTheRight, 2)
{
    static const struct {
        int points;
        double above[LAMPS], along; // most that one half may be brighter
    } cases[] = {
        {16, {1e-6, 1e-3, 1e-6}, 0.02}, {64, {1e-6, 1e-3, 1e-6}, 8e-3}, {256, {1e-6, 1e-4, 1e-6}, 2e-3}};
    for (int i = 0; i < 3; i++) {
        for (int lamps = 0; lamps < LAMPS; lamps++) {
            assertNear(excess(context, lamps, true, cases[i].points), 0, cases[i].above[lamps], "from above",
                       cases[i].points);
            assertNear(excess(context, lamps, false, cases[i].points), 0, cases[i].along, "along z",
                       cases[i].points);
        }
    }
}
