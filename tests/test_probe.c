// SPDX-License-Identifier: MIT
// Tests of the statistics that estimates of a plan's time are made with.
#include "shapes.h"

#include "math/vec.h"
#include "render/probe.h"

static vplView viewFrom(vplVec3 eye, vplVec3 target)
{
    vplCameraDef camera = vplDefaultCameraDef();
    camera.eye = eye;
    camera.target = target;
    camera.fovY = 1.2; // a sphere of radius 1, 2 m away, is 1.05 radians wide
    return vplView_Create(&camera, 64, 64);
}

// Half of a sphere is seen from afar, a quarter from twice its radius, and nothing where the camera looks away or a box is between.
TEST(VerticesThatTheCameraSeesAreCounted, 1)
{
    static const struct {
        float eye, target;
        bool hidden;
        double least, most;
    } ROWS[] = {
        {40, 0, false, 0.4, 0.55}, {2, 0, false, 0.2, 0.28}, {40, 80, false, 0, 0}, {40, 0, true, 0, 0.07}};
    for (size_t i = 0; i < sizeof ROWS / sizeof *ROWS; i++) {
        vplScene* scene = sceneOf(context, 0.5f);
        Shape sphere = icosphere(4), box = gridBox(4);
        addShape(scene, &sphere, true, NULL);
        placeShape(&box, 2, (double[3]){0, 0, 0}, vplVec(0, 0, ROWS[i].hidden ? 5.0f : -5.0f));
        addShape(scene, &box, true, NULL);
        freeShape(&sphere);
        freeShape(&box);
        vplGeometry* g = buildGeometry(scene);
        const vplView view = viewFrom(vplVec(0, 0, ROWS[i].eye), vplVec(0, 0, ROWS[i].target));
        const double share = vplProbe_SeenVertices(g, &view) / g->vertexCount;
        if (!(share >= ROWS[i].least && share <= ROWS[i].most)) {
            fail_msg("row %zu: %g of the vertices", i, share);
        }
        vplGeometry_Destroy(g);
    }
}
