// SPDX-License-Identifier: MIT
// Tests of radiosity in rooms that are lit from outside, and in rooms whose walls meet in T-junctions.
#include "radiosity_pictures.h"

// ---- light from outside

// A room of 4 m x 2.6 m x 4 m with an opening in its east wall, of boxes 0.1 m thick that overlap. width 0: none.
static vplScene* roomWithWindow(vplContext* context, float width, float height)
{
    vplScene* scene = sceneOf(context, 0.6f);
    const float side = 2 - 0.5f * width, below = 1.4f - 0.5f * height, above = 1.2f - 0.5f * height;
    addThing(scene, VPL_OBJECT_QUAD, 0, vplVec(2, 0, 2), -VPL_PI / 2, 0, vplVec(4, 4, 1));
    addThing(scene, VPL_OBJECT_QUAD, 0, vplVec(2, 2.6f, 2), VPL_PI / 2, 0, vplVec(4, 4, 1));
    addThing(scene, VPL_OBJECT_QUAD, 0, vplVec(2, 1.3f, 0), 0, 0, vplVec(4, 2.6f, 1));
    addThing(scene, VPL_OBJECT_QUAD, 0, vplVec(2, 1.3f, 4), 0, VPL_PI, vplVec(4, 2.6f, 1));
    addThing(scene, VPL_OBJECT_QUAD, 0, vplVec(0, 1.3f, 2), 0, VPL_PI / 2, vplVec(4, 2.6f, 1));
    addThing(scene, VPL_OBJECT_BOX, 0, vplVec(4.05f, 1.3f, 0.5f * side - 0.05f), 0, 0,
             vplVec(0.1f, 2.8f, side + 0.1f));
    addThing(scene, VPL_OBJECT_BOX, 0, vplVec(4.05f, 1.3f, 4.05f - 0.5f * side), 0, 0,
             vplVec(0.1f, 2.8f, side + 0.1f));
    if (width > 0) {
        addThing(scene, VPL_OBJECT_BOX, 0, vplVec(4.05f, 0.5f * below - 0.1f, 2), 0, 0,
                 vplVec(0.1f, below, width + 0.02f));
        addThing(scene, VPL_OBJECT_BOX, 0, vplVec(4.05f, 2.7f - 0.5f * above, 2), 0, 0,
                 vplVec(0.1f, above, width + 0.02f));
    }
    addThing(scene, VPL_OBJECT_BOX, 0, vplVec(1.5f, 0.3f, 1.2f), 0, 0.35, vplVec(0.8f, 0.7f, 0.8f));
    aim(scene, vplVec(3.6f, 1.7f, 3.6f), vplVec(0.5f, 0.9f, 0.8f));
    return scene;
}

// Fails unless the mean of indirect light by radiosity is that of paths to 3 %.
static void compareEnergy(const vplScene* scene, const vplImage* truth, int patches, int row)
{
    vplImage* image = showOf(scene, radiosityOptions(patches), VPL_SHOW_INDIRECT);
    assertNear(meanOf(image) / meanOf(truth), 1, 0.03, "energy", row);
    vplImage_Destroy(image);
}

TEST(LightComesInThroughAWindow, 2, SLOW)
{
    for (int sun = 0; sun < 2; sun++) {
        vplScene* scene = roomWithWindow(context, 1.2f, 1);
        addEmitter(scene, sun ? VPL_EMITTER_DIRECTIONAL : VPL_EMITTER_POINT, vplVec(6.5f, 3, 2.6f),
                   vplVec(-1, -0.6f, -0.2f), 60);
        vplImage* truth = pathsOf(scene, VPL_SHOW_INDIRECT, 1024);
        compareEnergy(scene, truth, 1000, sun);
        compareEnergy(scene, truth, 4000, sun);
        vplImage_Destroy(truth);
        vplScene_Destroy(scene);
    }
}

// A lamp outside a closed room leaves it black.
TEST(LightStaysOutsideAClosedRoom, 2, SLOW)
{
    vplScene* scene = roomWithWindow(context, 0, 0);
    addEmitter(scene, VPL_EMITTER_POINT, vplVec(5.5f, 1.6f, 2.2f), vplVec(-1, 0, 0), 100);
    const vplRenderOptions o = radiosityOptions(500);
    vplImage* image = renderScene(scene, &o, NULL);
    assert_true(meanOf(image) == 0);
    vplImage_Destroy(image);
    vplScene_Destroy(scene);
}

// ---- T-junctions

// A closed room whose floor is one quad, or six of different sizes, and whose back wall is one quad or three.
static vplScene* tiledRoom(vplContext* context, bool tiled)
{
    static const float Z[] = {-1, -0.3f, 1}, X[][4] = {{-1, -0.5f, 0.35f, 1}, {-1, -0.2f, 0.6f, 1}};
    vplScene* scene = sceneOf(context, 0.6f);
    for (int i = 0; i < 2 && tiled; i++) {
        for (int k = 0; k < 3; k++) {
            const float x = 0.5f * (X[i][k] + X[i][k + 1]), z = 0.5f * (Z[i] + Z[i + 1]);
            addThing(scene, VPL_OBJECT_QUAD, 0, vplVec(x, -1, z), -VPL_PI / 2, 0,
                     vplVec(X[i][k + 1] - X[i][k], Z[i + 1] - Z[i], 1));
            addThing(scene, VPL_OBJECT_QUAD, 0, vplVec(x, i == 0 ? -0.35f : 0.65f, -1), 0, 0,
                     vplVec(X[i][k + 1] - X[i][k], i == 0 ? 1.3f : 0.7f, 1));
        }
    }
    if (!tiled) {
        addThing(scene, VPL_OBJECT_QUAD, 0, vplVec(0, -1, 0), -VPL_PI / 2, 0, vplVec(2, 2, 1));
        addThing(scene, VPL_OBJECT_QUAD, 0, vplVec(0, 0, -1), 0, 0, vplVec(2, 2, 1));
    }
    addThing(scene, VPL_OBJECT_QUAD, 0, vplVec(0, 1, 0), VPL_PI / 2, 0, vplVec(2, 2, 1));
    addThing(scene, VPL_OBJECT_QUAD, 0, vplVec(0, 0, 1), 0, VPL_PI, vplVec(2, 2, 1));
    addThing(scene, VPL_OBJECT_QUAD, 0, vplVec(-1, 0, 0), 0, VPL_PI / 2, vplVec(2, 2, 1));
    addThing(scene, VPL_OBJECT_QUAD, 0, vplVec(1, 0, 0), 0, -VPL_PI / 2, vplVec(2, 2, 1));
    addThing(scene, VPL_OBJECT_BOX, 0, vplVec(0.2f, -0.8f, -0.3f), 0, 0.4, vplVec(0.4f, 0.5f, 0.4f));
    addEmitter(scene, VPL_EMITTER_POINT, vplVec(-0.4f, 0.5f, 0.3f), vplVec(0, -1, 0), 3);
    aim(scene, vplVec(0.1f, 0.3f, 0.9f), vplVec(0, -0.6f, -0.6f));
    return scene;
}

// Junctions neither leak nor darken: a tiled room has the picture of the room whose floor and wall are whole.
TEST(TJunctionsAreNotSeen, 2)
{
    vplImage* images[2];
    for (int tiled = 0; tiled < 2; tiled++) {
        vplScene* scene = tiledRoom(context, tiled);
        images[tiled] = showOf(scene, radiosityOptions(1500), VPL_SHOW_INDIRECT);
        vplScene_Destroy(scene);
    }
    const vplComparison c = compare(images[1], images[0]);
    printf("# tiled: mean %.5f, relmse %.6f, largest %.4f\n", meanOf(images[1]) / meanOf(images[0]), c.relmse,
           c.maxDifference / meanOf(images[0]));
    assertNear(meanOf(images[1]) / meanOf(images[0]), 1, 0.003, "mean", 0);
    assert_true(c.relmse < 2e-4);
    assert_true(c.maxDifference < 0.1 * meanOf(images[0]));
    vplImage_Destroy(images[0]);
    vplImage_Destroy(images[1]);
}

// ---- cuts with incentres, and too many cuts

// Form factors between incentres, as the document has them, may be asked for together with cuts.
TEST(CutsWorkWithIncentres, 2, SLOW)
{
    vplScene* scene = openScene(context, "examples/scenes/sunken-boxes.json");
    vplRenderOptions o = radiosityOptions(920);
    o.radiosity.formFactors = VPL_FORM_FACTORS_INCENTRE;
    o.radiosity.rowSums = VPL_ROW_SUMS_CLAMP;
    o.radiosity.cuts = VPL_PATCH_CUTS_ON;
    vplImage *cut = showOf(scene, o, VPL_SHOW_INDIRECT), *truth = pathsOf(scene, VPL_SHOW_INDIRECT, 256);
    assertNear(meanOf(cut) / meanOf(truth), 1, 0.03, "energy", 0); // 1.0075
    vplImage_Destroy(cut);
    vplImage_Destroy(truth);
    vplScene_Destroy(scene);
}

// A grid of 2 x 130 walls on a floor asks for more cuts than are made: patches remain, and a warning says how many
// lines are not resolved.
TEST(TooManyCutsAreCounted, 2, SLOW)
{
    enum { WALLS = 130 };
    vplScene* scene = sceneOf(context, 0.5f);
    addThing(scene, VPL_OBJECT_QUAD, 0, vplVec(0, 0, 0), -VPL_PI / 2, 0, vplVec(2, 2, 1));
    for (int i = 0; i < WALLS; i++) {
        const float at = -0.9f + 1.8f * (float)i / (WALLS - 1);
        addThing(scene, VPL_OBJECT_QUAD, 0, vplVec(at, 0, 0), 0, VPL_PI / 2, vplVec(1.9f, 0.2f, 1));
        addThing(scene, VPL_OBJECT_QUAD, 0, vplVec(0, 0, at), 0, 0, vplVec(1.9f, 0.2f, 1));
    }
    vplGeometry* g = buildGeometry(scene);
    vplPatchDef def = vplDefaultPatchDef();
    vplPatches* p = NULL;
    def.cut = true;
    def.count = 1000;
    takeMessage();
    assert_int_equal(vplPatches_Create(g, &def, &p), VPL_SUCCESS);
    assert_true(p->unresolvedCuts > 0);
    assert_non_null(strstr(takeMessage(), "do not divide all patches that they cross"));
    double area = 0;
    for (int i = 0; i < p->patchCount; i++) {
        area += vplPatches_Area(p, i);
    }
    assertNear(area, vplGeometry_Area(g), 1e-4 * vplGeometry_Area(g), "area", 0);
    printf("# %d patches, %d unresolved\n", p->patchCount, p->unresolvedCuts);
    vplPatches_Destroy(p);
    vplGeometry_Destroy(g);
}
