// SPDX-License-Identifier: MIT
// Tests of drawing patches: flat, interpolated and with outlines.
#include "patch_support.h"
#include "stage.h"

#include "math/vec.h"
#include "radiosity/mesh/patch_mesh.h"
#include "shading/shading.h"

#include <stdlib.h>

typedef struct Canvas {
    const vplPatchMesh* mesh;
    vplView view;
    vplImage* image;
    float (*clip)[4];
} Canvas;

static Canvas openCanvas(const vplPatchMesh* mesh, const vplCameraDef* camera, int width, int height)
{
    Canvas c = {.mesh = mesh, .view = vplView_Create(camera, width, height)};
    assert_int_equal(vplImage_Create(mesh->context, width, height, &c.image), VPL_SUCCESS);
    c.clip = malloc((size_t)mesh->vertexCount * sizeof *c.clip);
    vplView_ToClip(&c.view, mesh->positions, mesh->vertexCount, c.clip);
    return c;
}

static void closeCanvas(Canvas* c)
{
    vplImage_Destroy(c->image);
    free(c->clip);
}

static vplRasterStats draw(Canvas* c, vplPatchDraw patches)
{
    vplRasterStats stats;
    patches.mesh = c->mesh;
    if (vplDrawPatches(&patches, c->clip, NULL, NULL, c->image, &stats) != VPL_SUCCESS) {
        fail_msg("%s", takeMessage());
    }
    return stats;
}

static vplRgb* listOf(int count, vplRgb value)
{
    vplRgb* values = malloc(((size_t)count + 1) * sizeof *values);
    for (int i = 0; i < count; i++) {
        values[i] = value;
    }
    return values;
}

static float* pixelOf(const Canvas* c, int i)
{
    return c->image->pixels + 3 * (size_t)i;
}

static int pixelsOf(const Canvas* c)
{
    return c->image->width * c->image->height;
}

// Returns a camera at a random position in the box [-1, 1]^3 with a random direction.
static vplCameraDef insideCamera(Dice* dice)
{
    vplCameraDef camera = vplDefaultCameraDef();
    camera.eye = rollVec(dice, 0.8f);
    camera.target = vplAdd(camera.eye, rollUnit(dice));
    camera.up = rollUnit(dice);
    camera.nearPlane = 0.05;
    camera.farPlane = 10;
    camera.fovY = 1.5;
    return camera;
}

static vplPatchMesh* cubeMesh(vplContext* context, int rounds, uint64_t seed, OpenFcn* open)
{
    return meshOf(openSides(openUnevenPatches(closedCube(context, 0.5f), rounds, seed), open));
}

// ---- clip space

TEST_ALONE(ClipCoordinatesAreThoseOfTheCamera)
{
    Dice dice = {4, 0};
    for (int i = 0; i < 1000; i++) {
        const vplCameraDef camera = insideCamera(&dice);
        const vplView view = vplView_Create(&camera, 33, 20);
        const vplShading shading = {.view = &view};
        const vplVec3 point = rollVec(&dice, 3);
        const vplObjectUniforms uniforms = {&shading, &point, NULL, 0};
        float wanted[4], world[3], clip[1][4];
        const vplVertices out = {
            &wanted[0], &wanted[1], &wanted[2], &wanted[3], {&world[0], &world[1], &world[2]}};
        vplCameraVertices(&uniforms, 0, 1, &out);
        vplView_ToClip(&view, &point, 1, clip);
        assert_memory_equal(clip[0], wanted, sizeof wanted);
    }
}

// ---- coverage

// Patches must cover exactly the pixels in which shading sees a surface, here of a room with boxes.
TEST(UndividedPatchesCoverWhatTheViewCovers, 2)
{
    vplScene* scene = loadScene(context, "room.json");
    vplCameraDef camera = *vplScene_GetCamera(scene, 0);
    vplPatchMesh* m = meshOf(openSides(openPatches(buildGeometry(scene), 1e9f, 0), allOpen));
    Canvas c = openCanvas(m, &camera, 161, 93);
    vplShadeDef def = stageDef(NULL, 0, 0);
    def.output = VPL_OUTPUT_DEPTH;
    vplImage* depth = shadeStage(m->sides->patches->geometry, &c.view, &def);
    vplRgb* values = listOf(m->sides->count, (vplRgb){1, 2, 3});
    draw(&c, (vplPatchDraw){.values = values});
    int covered = 0;
    for (int i = 0; i < pixelsOf(&c); i++) {
        const bool seen = depth->pixels[3 * i] > 0;
        covered += seen;
        assert_true(pixelOf(&c, i)[0] == (seen ? 1 : 0) && pixelOf(&c, i)[2] == (seen ? 3 : 0));
    }
    assert_true(covered > 1000 && covered < pixelsOf(&c));
    free(values);
    vplImage_Destroy(depth);
    closeCanvas(&c);
    closeMesh(m);
}

// X100: no pixel shows the background where a large patch meets small ones, from any angle.
TEST(ClosedRoomHasNoHoles, 2)
{
    Dice dice = {1, 0};
    for (uint64_t seed = 0; seed < 12; seed++) {
        vplPatchMesh* m = cubeMesh(context, 10, seed, frontsOpen);
        const vplCameraDef camera = insideCamera(&dice);
        Canvas c = openCanvas(m, &camera, 200, 150);
        vplRgb* values = listOf(m->sides->count, (vplRgb){1, 1, 1});
        draw(&c, (vplPatchDraw){.values = values});
        int holes = 0;
        for (int i = 0; i < pixelsOf(&c); i++) {
            holes += pixelOf(&c, i)[0] != 1;
        }
        assert_int_equal(holes, 0);
        assert_true(m->hangingVertices > 50);
        free(values);
        closeCanvas(&c);
        closeMesh(m);
    }
}

// ---- values

TEST(EqualCornersGiveThatValueToAllPixels, 2)
{
    Dice dice = {2, 0};
    vplPatchMesh* m = cubeMesh(context, 6, 1, frontsOpen);
    const vplCameraDef camera = insideCamera(&dice);
    Canvas c = openCanvas(m, &camera, 100, 80);
    vplRgb* values = listOf(2 * m->vertexCount, (vplRgb){0.1f, 0.7f, 1e-20f});
    draw(&c, (vplPatchDraw){.vertexValues = values});
    for (int i = 0; i < pixelsOf(&c); i++) {
        assert_memory_equal(pixelOf(&c, i), values, sizeof *values);
    }
    free(values);
    closeCanvas(&c);
    closeMesh(m);
}

// Returns the point of the closed cube that the centre of a pixel sees.
static vplVec3 seenFrom(const vplView* v, const vplGeometry* g, int x, int y)
{
    const double across = ((x + 0.5) * 2 / v->width - 1) / v->scaleX,
                 up = (1 - (y + 0.5) * 2 / v->height) / v->scaleY;
    const vplVec3 d =
        vplAdd(v->forward, vplAdd(vplScale((float)across, v->right), vplScale((float)up, v->up)));
    const vplRay ray = {v->eye, d, {0, 0}};
    vplHit hit;
    assert_true(vplGeometry_ClosestHit(g, &ray, &hit));
    return hit.position;
}

// Red, green and blue are the x, y and z of the visible point, which tests perspective interpolation, also
// for patches that the near plane clips. Errors are rounding, 8e-8 on average; at most 1.1e-4, where snapping
// to 1/256 pixel covers a pixel whose centre is outside.
TEST(LinearValuesAreReproduced, 2)
{
    Dice dice = {7, 0};
    vplPatchMesh* m = cubeMesh(context, 4, 3, frontsOpen);
    vplRgb* values = listOf(2 * m->vertexCount, (vplRgb){9, 9, 9});
    for (int v = 0; v < m->vertexCount; v++) {
        const vplVec3 p = m->positions[v];
        values[2 * v] = (vplRgb){p.x, p.y, p.z};
    }
    double worst = 0, mean = 0;
    for (int view = 0; view < 8; view++) {
        const vplCameraDef camera = insideCamera(&dice);
        Canvas c = openCanvas(m, &camera, 120, 90);
        draw(&c, (vplPatchDraw){.vertexValues = values});
        for (int i = 0; i < pixelsOf(&c); i++) {
            const vplVec3 p = seenFrom(&c.view, m->sides->patches->geometry, i % 120, i / 120);
            const float* got = pixelOf(&c, i);
            const vplVec3 off = vplSub(vplVec(got[0], got[1], got[2]), p);
            mean += (double)vplLength(off) / (8 * 120 * 90);
            worst = fmax(worst, (double)vplLength(off));
        }
        closeCanvas(&c);
    }
    assert_true(mean < 1e-6 && worst < 5e-4);
    free(values);
    closeMesh(m);
}

// Opens only the fronts of patches left of x = 0.
static uint16_t leftOpen(const vplPatches* patches, int patch, int face)
{
    const vplPatchNode* n = &patches->nodes[patches->patches[patch]];
    float x = 0;
    for (int k = 0; k < 3; k++) {
        x += patches->positions[n->corners[k]].x;
    }
    return face == 0 && x < 0 ? 0xffff : 0;
}

static vplCameraDef lookAtOrigin(vplVec3 eye)
{
    vplCameraDef camera = vplDefaultCameraDef();
    camera.eye = eye;
    camera.target = vplVec(0, 0, 0);
    camera.up = vplVec(0, 1, 0);
    camera.nearPlane = 0.1;
    camera.farPlane = 20;
    return camera;
}

// Makes the square [-1, 1]^2 at z = 0 that faces +z, as four triangles around its centre, with a wall behind
// it.
static vplPatchMesh* screenMesh(vplContext* context, bool wall, OpenFcn* open)
{
    vplScene* scene = sceneOf(context, 0.5f);
    const vplVec3 p[4] = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    Shape shape = {0};
    for (int i = 0; i < 4; i++) {
        addTriangle(&shape, vplVec(0, 0, 0), p[i], p[(i + 1) % 4]);
    }
    if (wall) {
        addTriangle(&shape, vplVec(-90, -90, -3), vplVec(90, -90, -3), vplVec(0, 90, -3));
    }
    addShape(scene, &shape, false, NULL);
    freeShape(&shape);
    return meshOf(openSides(openPatches(buildGeometry(scene), 1000, 0), open));
}

static uint16_t wallOpen(const vplPatches* patches, int patch, int face)
{
    return patch == patches->patchCount - 1 && face == 0 ? 0xffff : 0;
}

// Unlit sides are drawn black, from both directions, and hide the bright wall behind them.
TEST(DarkSidesHideWhatIsBehindThem, 1)
{
    vplPatchMesh* m = screenMesh(context, true, wallOpen);
    const vplCameraDef camera = lookAtOrigin(vplVec(0, 0, 4));
    Canvas c = openCanvas(m, &camera, 64, 64);
    vplRgb* values = listOf(1, (vplRgb){5, 5, 5});
    draw(&c, (vplPatchDraw){.values = values});
    assert_true(pixelOf(&c, 32 * 64 + 32)[0] == 0);
    assert_true(pixelOf(&c, 2 * 64 + 2)[0] == 5);
    free(values);
    closeCanvas(&c);
    closeMesh(m);
}

// The value is 1 seen from the front, 10 seen from behind.
TEST(EachSideHasItsOwnValues, 1)
{
    vplPatchMesh* m = screenMesh(context, false, allOpen);
    for (int smooth = 0; smooth < 2; smooth++) {
        for (int behind = 0; behind < 2; behind++) {
            const vplCameraDef camera = lookAtOrigin(vplVec(0, 0, behind ? -4 : 4));
            Canvas c = openCanvas(m, &camera, 64, 64);
            vplRgb *values = listOf(m->sides->count, (vplRgb){0}),
                   *corners = listOf(2 * m->vertexCount, (vplRgb){0});
            for (int i = 0; i < m->sides->count; i++) {
                values[i].g = m->sides->sides[i].back ? 10 : 1;
            }
            for (int v = 0; v < 2 * m->vertexCount; v++) {
                corners[v].g = v % 2 ? 10 : 1;
            }
            draw(&c, (vplPatchDraw){.values = values, .vertexValues = smooth ? corners : NULL});
            const float* middle = pixelOf(&c, 32 * 64 + 32);
            assert_true(middle[0] == 0 && middle[1] == (behind ? 10 : 1) && middle[2] == 0);
            free(values);
            free(corners);
            closeCanvas(&c);
        }
    }
    closeMesh(m);
}

// Each patch shows rho / pi times irradiance with its own rho: interpolated light at shared corners does not
// carry colour to neighbours. The result is added to the picture's previous value.
TEST(IrradianceIsReflectedAndAdded, 1)
{
    vplPatchMesh* m = screenMesh(context, false, leftOpen);
    for (int i = 0; i < m->sides->count; i++) {
        ((vplPatchSide*)m->sides->sides)[i].reflectance = (vplRgb){0.5f, 0.25f, 0};
    }
    const vplCameraDef camera = lookAtOrigin(vplVec(0, 0, 4));
    for (int smooth = 0; smooth < 2; smooth++) {
        Canvas c = openCanvas(m, &camera, 64, 64);
        for (int i = 0; i < 3 * pixelsOf(&c); i++) {
            c.image->pixels[i] = 2;
        }
        vplRgb *values = listOf(m->sides->count, (vplRgb){8, 8, 8}),
               *corners = listOf(2 * m->vertexCount, (vplRgb){8, 8, 8});
        draw(&c, (vplPatchDraw){.values = values, .vertexValues = smooth ? corners : NULL, .reflect = true});
        const float *left = pixelOf(&c, 32 * 64 + 28), *right = pixelOf(&c, 32 * 64 + 36),
                    *out = pixelOf(&c, 0);
        assertNear((double)left[0], 2 + 8 * 0.5 / 3.14159265358979, 1e-6, "red", smooth);
        assertNear((double)left[1], 2 + 8 * 0.25 / 3.14159265358979, 1e-6, "green", smooth);
        assert_true(left[2] == 2 && out[0] == 2);
        // The right half has no side: flat drawing adds nothing there, and interpolated drawing reflects its
        // corners' irradiance with its material.
        assertNear((double)right[0], smooth ? 2 + 8 * 0.5 / 3.14159265358979 : 2, 1e-6, "right", smooth);
        free(values);
        free(corners);
        closeCanvas(&c);
    }
    closeMesh(m);
}

// Outlines are dark within a pixel of the edges between patches, and the full value elsewhere; the cuts that
// join a hanging vertex to a corner are not drawn.
TEST(OutlinesAreAtEdgesOfPatches, 1)
{
    vplPatchMesh* m = screenMesh(context, false, frontsOpen);
    const vplCameraDef camera = lookAtOrigin(vplVec(0, 0, 4));
    vplRgb* values = listOf(m->sides->count, (vplRgb){1, 1, 1});
    int dark[2] = {0, 0};
    for (int cut = 0; cut < 2; cut++) {
        if (cut) { // the line from lower left to the centre is no edge
            uint8_t* edges = (uint8_t*)m->edges;
            for (int i = 0; i < 3 * m->triangleCount; i++) {
                const vplVec3 a = m->positions[m->indices[i]],
                              b = m->positions[m->indices[i / 3 * 3 + (i + 1) % 3]];
                if (a.x == a.y && a.x <= 0 && b.x == b.y && b.x <= 0) {
                    edges[i / 3] &= (uint8_t) ~(1u << i % 3);
                }
            }
        }
        Canvas c = openCanvas(m, &camera, 64, 64);
        draw(&c, (vplPatchDraw){.values = values, .outlines = true});
        for (int i = 0; i < pixelsOf(&c); i++) {
            const int x = i % 64, y = i / 64;
            const bool inside = x > 20 && x < 43 && y > 20 && y < 43;
            const int off =
                abs(x - y) < abs(x + y - 63) ? abs(x - y) : abs(x + y - 63); // in pixels along a row
            if (inside && off >= 2) {
                assert_true(pixelOf(&c, i)[0] == 1);
            } else if (inside && off == 0) {
                dark[cut] += pixelOf(&c, i)[0] < 0.1f;
            }
        }
        closeCanvas(&c);
    }
    assert_int_equal(dark[0], 44);
    assert_in_range(dark[1], 32, 34); // near the centre other edges are close
    free(values);
    closeMesh(m);
}

// ---- extremes

TEST(WrongDrawsAreRefused, 1)
{
    vplPatchMesh* m = screenMesh(context, false, frontsOpen);
    const vplCameraDef camera = lookAtOrigin(vplVec(0, 0, 4));
    Canvas c = openCanvas(m, &camera, 8, 8);
    vplRgb values[4] = {{1, 1, 1}, {1, 1, INFINITY}, {1, 1, 1}, {1, 1, 1}};
    vplPatchDraw d = {.mesh = m};
    assert_int_equal(vplDrawPatches(&d, c.clip, NULL, NULL, c.image, NULL), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "neither values nor vertexValues"));
    d.values = values;
    assert_int_equal(vplDrawPatches(&d, c.clip, NULL, NULL, c.image, NULL), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "vplPatchDraw.values[1] is (1, 1, inf)"));
    assert_true(c.image->pixels[3 * 36] == 0);
    closeCanvas(&c);
    closeMesh(m);
}

TEST(DrawsCanBeCancelled, 1)
{
    vplPatchMesh* m = screenMesh(context, false, frontsOpen);
    const vplCameraDef camera = lookAtOrigin(vplVec(0, 0, 4));
    Canvas c = openCanvas(m, &camera, 512, 512);
    vplRgb* values = listOf(m->sides->count, (vplRgb){1, 1, 1});
    const vplPatchDraw d = {.mesh = m, .values = values};
    int asked = 0;
    assert_int_equal(vplDrawPatches(&d, c.clip, refuseThird, &asked, c.image, NULL), VPL_CANCELLED);
    free(values);
    closeCanvas(&c);
    closeMesh(m);
}

// A scene without triangles gives a valid picture.
TEST(SceneWithoutTrianglesDrawsNothing, 1)
{
    vplPatchMesh* m = meshOf(openSides(openPatches(buildGeometry(sceneOf(context, 0.5f)), 1, 1), frontsOpen));
    assert_true(m->vertexCount == 0 && m->triangleCount == 0);
    const vplCameraDef camera = lookAtOrigin(vplVec(0, 0, 4));
    Canvas c = openCanvas(m, &camera, 8, 8);
    vplRgb none[1];
    draw(&c, (vplPatchDraw){.values = none});
    assert_true(c.image->pixels[0] == 0);
    closeCanvas(&c);
    closeMesh(m);
}

static uint64_t hashOfDraw(vplContext* context)
{
    if (context == NULL) {
        return 0;
    }
    Dice dice = {11, 0};
    vplPatchMesh* m = cubeMesh(context, 8, 4, allOpen);
    const vplCameraDef camera = insideCamera(&dice);
    vplRgb *values = listOf(m->sides->count, (vplRgb){0}), *corners = listOf(2 * m->vertexCount, (vplRgb){0});
    for (int i = 0; i < m->sides->count; i++) {
        values[i] = (vplRgb){roll(&dice, 0, 1), roll(&dice, 0, 1), roll(&dice, 0, 1)};
    }
    assert_int_equal(vplPatchMesh_Interpolate(m, VPL_VERTEX_WEIGHT_ANGLE, values, corners), VPL_SUCCESS);
    Canvas c = openCanvas(m, &camera, 131, 77);
    draw(&c, (vplPatchDraw){.values = values, .outlines = true});
    draw(&c, (vplPatchDraw){.vertexValues = corners, .reflect = true});
    const uint64_t hash = vplImage_Hash(c.image);
    free(values);
    free(corners);
    closeCanvas(&c);
    closeMesh(m);
    closeTestContext(context);
    return hash;
}

TEST_ALONE(DrawsAreTheSameBitsEverywhere)
{
    assertSameEverywhere(hashOfDraw);
}
