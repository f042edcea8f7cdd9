// SPDX-License-Identifier: MIT
// Tests of groups: patches of many small triangles.
#include "patch_support.h"
#include "radiosity_pictures.h"

#include "geometry/triangle.h"
#include "math/vec.h"
#include "radiosity/sides/side.h"
#include "render/renderer.h"
#include "render/stages/results.h"

#include <stdlib.h>

// ---- scenes

static void addBall(vplScene* scene, Shape* ball)
{
    vplObjectDef object = vplDefaultObjectDef();
    object.material = 1;
    assert_int_equal(tryAddShape(scene, ball, false, &object), VPL_SUCCESS);
    freeShape(ball);
}

// A closed cube with balls of 20 times 4^levels triangles in it. `emission`: of all surfaces.
static vplScene* ballRoom(vplContext* context, int balls, int levels, float rho, float emission)
{
    Dice dice = {7, 0};
    vplScene* scene = closedCubeScene(context, rho, emission);
    for (int i = 0; i < balls; i++) {
        const double turn[3] = {(double)roll(&dice, 0, 3), (double)roll(&dice, 0, 3), 0};
        Shape ball = icosphere(levels);
        placeShape(&ball, balls > 1 ? roll(&dice, 0.1f, 0.3f) : 0.4f, turn,
                   balls > 1 ? rollVec(&dice, 0.6f) : vplVec(0.1f, -0.5f, -0.2f));
        addBall(scene, &ball);
    }
    return scene;
}

static vplPatches* groupsOf(const vplGeometry* g, int count, float size, bool cut)
{
    vplPatchDef def = vplDefaultPatchDef();
    vplPatches* p = NULL;
    def.count = count;
    def.size = size;
    def.cut = cut;
    def.group = true;
    assert_int_equal(vplPatches_Create(g, &def, &p), VPL_SUCCESS);
    return p;
}

// ---- patches

// Each triangle is the part of one patch, or divided into patches; areas are those of the triangles.
static void assertWhole(const vplGeometry* g, const vplPatches* p)
{
    double area = 0;
    int* found = calloc((size_t)g->triangleCount, sizeof *found);
    assert_non_null(found);
    for (int i = 0; i < p->patchCount; i++) {
        const vplPatchParts parts = vplPatches_GetParts(p, i);
        assert_true(parts.count > 1 ? i >= p->patchCount - p->groupCount : parts.count == 1);
        double sum = 0;
        for (int k = 0; k < parts.count; k++) {
            const vplPatchNode* node = &p->nodes[parts.nodes[k]];
            const vplTriangleCorners c = vplCornersOf(p->positions, node->corners);
            const vplVec3 middle = vplScale(1 / 3.0f, vplAdd(c.corner[0], vplAdd(c.corner[1], c.corner[2])));
            assert_int_equal(node->patch, i);
            assert_int_equal(vplPatches_Find(p, node->triangle, middle), i);
            found[node->triangle] += parts.count > 1 ? 1000000 : 1;
            sum += vplTriangle_Area(&c);
        }
        assertNear(vplPatches_Area(p, i), sum, 1e-9, "area of patch", i);
        area += sum;
    }
    for (int i = 0; i < g->triangleCount; i++) {
        assert_true(found[i] == 1000000 || (found[i] > 0 && found[i] < 1000000));
    }
    assertNear(area, vplGeometry_Area(g), 1e-5 * vplGeometry_Area(g), "area", 0);
    free(found);
}

TEST(EveryTriangleIsInOnePatch, 1)
{
    static const int counts[] = {1, 30, 100, 500, 3000};
    vplGeometry* g = buildGeometry(ballRoom(context, 5, 3, 0.5f, 0));
    for (int i = 0; i < 10; i++) {
        vplPatches* p = groupsOf(g, counts[i / 2], 0, i % 2 == 1);
        assert_true(p->groupCount > 0);
        assertWhole(g, p);
        vplPatches_Destroy(p);
    }
    vplGeometry_Destroy(g);
}

// Two balls, one just around the other, of which one emits: their triangles lie between each other, but share no patch.
TEST(GroupsHaveOneEmission, 1)
{
    vplScene* scene = ballRoom(context, 0, 0, 0.5f, 0);
    int materials[2];
    for (int i = 0; i < 2; i++) {
        vplMaterialDef m = vplDefaultMaterialDef();
        m.emission = (vplRgb){(float)i, (float)i, (float)i};
        assert_int_equal(vplScene_AddMaterial(scene, &m, &materials[i]), VPL_SUCCESS);
        Shape ball = icosphere(3);
        placeShape(&ball, 0.4f + 0.001f * (float)i, (const double[3]){0.1 * i, 0.2 * i, 0}, vplVec(0, 0, 0));
        vplObjectDef object = vplDefaultObjectDef();
        object.material = materials[i];
        assert_int_equal(tryAddShape(scene, &ball, false, &object), VPL_SUCCESS);
        freeShape(&ball);
    }
    vplGeometry* g = buildGeometry(scene);
    vplPatches* p = groupsOf(g, 100, 0, false);
    int groups[2] = {0, 0};
    assertWhole(g, p);
    for (int i = p->patchCount - p->groupCount; i < p->patchCount; i++) {
        const vplPatchParts parts = vplPatches_GetParts(p, i);
        float emission[2] = {0, 0};
        for (int k = 0; k < parts.count; k++) {
            emission[k > 0] =
                g->materials[g->triangleMaterials[p->nodes[parts.nodes[k]].triangle]].emission.r;
            assert_true(k == 0 || emission[0] == emission[1]);
        }
        groups[emission[0] > 0]++;
    }
    assert_true(groups[0] > 1 && groups[1] > 1);
    vplPatches_Destroy(p);
    vplGeometry_Destroy(g);
}

// The number of patches is the one asked for within 20 %, from what normals alone demand to four times the triangles.
TEST(TheCountHolds, 1)
{
    vplGeometry* g[2] = {buildGeometry(ballRoom(context, 12, 3, 0.5f, 0)), clutter(context, 1)};
    for (int which = 0; which < 2; which++) {
        const int triangles = g[which]->triangleCount;
        for (int count = 100; count < 4 * triangles; count += count / 3) {
            vplPatches* p = groupsOf(g[which], count, 0, true);
            if (abs(p->patchCount - count) > count / 5) {
                fail_msg("%d patches instead of %d (scene %d)", p->patchCount, count, which);
            }
            vplPatches_Destroy(p);
        }
        vplGeometry_Destroy(g[which]);
    }
}

// Light reaches as many patches as --patches asks for, within 20 %, even where most pieces of triangles are inside walls. With
// groups all patches count.
static void expectLit(vplScene* scene, int count, bool grouped)
{
    vplRenderOptions o = radiosityOptions(count);
    vplRenderStats stats;
    o.output.width = o.output.height = 8;
    o.radiosity.gather = 0;
    vplImage_Destroy(renderScene(scene, &o, &stats));
    const int made = stats.patchGroups > 0 ? stats.patches : stats.litPatches;
    printf("# %d patches are %d, %d of them lit, %d groups\n", count, stats.patches, stats.litPatches,
           stats.patchGroups);
    assert_true(made >= count - count / 5 && made <= count + count / 5);
    assert_true((stats.patchGroups > 0) == grouped);
    assert_true(stats.litPatches <= stats.patches && stats.litPatches <= stats.patchSides);
}

TEST(PatchesThatLightReachesAreCounted, 2, SLOW)
{
    static const char* const NAMES[] = {"room", "thin-boxes", "six-rooms", "flat", "loft"};
    for (int i = 0; i < 5; i++) {
        char path[64];
        snprintf(path, sizeof path, "examples/scenes/%s.json", NAMES[i]);
        vplScene* scene = openScene(context, path);
        expectLit(scene, 600, i == 4);
        expectLit(scene, 2000, false);
        vplScene_Destroy(scene);
    }
    vplScene* balls = ballRoom(context, 12, 2, 0.5f, 0);
    addEmitter(balls, VPL_EMITTER_POINT, vplVec(0, 0.9f, 0), vplVec(0, -1, 0), 1);
    aim(balls, vplVec(0, 0, 0.95f), vplVec(0, 0, 0));
    expectLit(balls, 3000, true);
    expectLit(balls, 3900, false);
    vplScene_Destroy(balls);
}

// A closed cube whose floor, ceiling and walls are two triangles each, and across it, at x = 0, a thin wall of small triangles. They
// are grouped, so that they do not cut what they stand on.
static vplGeometry* halvedCube(vplContext* context)
{
    vplScene* scene = closedCubeScene(context, 0.5f, 0);
    vplMat4 thin = {{0}};
    Shape wall = gridBox(15);
    thin.m[0] = 0.01f;
    thin.m[5] = thin.m[10] = 1.05f;
    thin.m[15] = 1;
    addShape(scene, &wall, false, &thin);
    freeShape(&wall);
    return buildGeometry(scene);
}

// Triangles on both sides of the wall are lit up to it, as seen from a corner in the lit room, in whichever room their first patch lies.
TEST(TrianglesOnBothSidesOfAWallNameALitCorner, 2)
{
    vplGeometry* g = halvedCube(context);
    vplPatches* p = groupsOf(g, 500, 0, true);
    vplEmitterDef emitter = vplDefaultEmitterDef();
    vplPatchSidesDef def = vplDefaultPatchSidesDef();
    vplPatchSides* s;
    const vplVec3 eye = vplVec(-0.5f, 0.2f, 0.1f); // in the dark
    emitter.position = vplVec(0.5f, 0.3f, -0.2f);
    def.emitters = &emitter;
    def.viewpoints = &eye;
    def.emitterCount = def.viewpointCount = 1;
    assert_int_equal(vplPatchSides_Create(p, &def, &s), VPL_SUCCESS);
    assert_non_null(s->dark);
    int inDark = 0, onBoth = 0;
    for (int t = 0; t < 12; t++) { // of the cube
        const vplTriangleCorners c = vplCornersOf(p->positions, p->nodes[t].corners);
        const int code = s->dark[t] & 15; // of its front
        const bool lit[3] = {c.corner[0].x > 0, c.corner[1].x > 0, c.corner[2].x > 0};
        if (lit[0] || lit[1] || lit[2]) {
            onBoth += code > 0;
            assert_true(code == 0 ? lit[0] && lit[1] && lit[2] : code >= 2 && lit[code - 2]);
        } else {
            inDark++;
            assert_int_equal(code, 1);
        }
    }
    assert_true(inDark == 2 && onBoth == 8);
    vplPatchSides_Destroy(s);
    vplPatches_Destroy(p);
    vplGeometry_Destroy(g);
}

// Groups for a length T fit into boxes of that diagonal, and their normals are near the mean. Emitters have their own.
TEST(GroupsAreSmallAndFaceOneWay, 1)
{
    vplScene* scene = ballRoom(context, 5, 3, 0.5f, 0);
    Shape lamp = icosphere(2);
    vplObjectDef object = vplDefaultObjectDef();
    placeShape(&lamp, 0.05f, (double[3]){0, 0, 0}, vplVec(0.3f, 0.3f, 0.3f));
    object.material = addMaterial(scene, (vplRgb){0.5f, 0.5f, 0.5f}, 10);
    assert_int_equal(tryAddShape(scene, &lamp, false, &object), VPL_SUCCESS);
    freeShape(&lamp);
    vplGeometry* g = buildGeometry(scene);
    for (int i = 0; i < 5; i++) {
        const float size = ldexpf(1.5f, -i);
        vplPatches* p = groupsOf(g, 1, size, false);
        assert_true(p->groupCount > 10 && p->groupCount < 2000);
        for (int k = p->patchCount - p->groupCount; k < p->patchCount; k++) {
            const vplPatchParts parts = vplPatches_GetParts(p, k);
            vplVec3 low = {9, 9, 9}, high = {-9, -9, -9}, mean = {0, 0, 0};
            for (int t = 0; t < parts.count; t++) {
                const vplTriangleCorners c = vplGeometry_Corners(g, parts.nodes[t]);
                mean = vplAdd(mean, vplScale((float)vplTriangle_Area(&c), g->normals[parts.nodes[t]]));
                for (int j = 0; j < 3; j++) {
                    low = vplVec(fminf(low.x, c.corner[j].x), fminf(low.y, c.corner[j].y),
                                 fminf(low.z, c.corner[j].z));
                    high = vplVec(fmaxf(high.x, c.corner[j].x), fmaxf(high.y, c.corner[j].y),
                                  fmaxf(high.z, c.corner[j].z));
                }
                assert_int_equal(g->triangleMaterials[parts.nodes[t]] == object.material,
                                 g->triangleMaterials[parts.nodes[0]] == object.material);
            }
            assert_true(vplLength(vplSub(high, low)) <= size * 1.0001f);
            for (int t = 0; t < parts.count; t++) {
                assert_true((double)vplDot(vplNormalize(mean), g->normals[parts.nodes[t]]) >
                            VPL_PATCH_GROUP_COSINE - 1e-5);
            }
        }
        vplPatches_Destroy(p);
    }
    vplGeometry_Destroy(g);
}

// ---- sides

// Points of the cells of a group lie on its triangles, as many as their area says.
TEST(CellsShareTheAreaOfAGroup, 1)
{
    vplGeometry* g = buildGeometry(ballRoom(context, 1, 3, 0.5f, 0));
    vplPatches* p = groupsOf(g, 1, 2, false);
    vplPatchSides* s = sidesOf(p, &(vplVec3){0.2f, 0.8f, 0.5f});
    int groups = 0;
    for (int i = 0; i < s->count; i++) {
        const vplPatchSide* side = &s->sides[i];
        const vplPatchParts parts = vplPatches_GetParts(p, side->patch);
        if (!vplPatches_IsGroup(p, side->patch)) {
            continue;
        }
        assertNear((double)side->area,
                   vplPatches_Area(p, side->patch) * __builtin_popcount(side->open) / VPL_PATCH_CELLS, 1e-6,
                   "area", i);
        assert_true(!side->back && parts.count > 20);
        vplVec3 mean = {0, 0, 0};
        for (int k = 0; k < 16 * 256; k++) {
            const vplSidePoint at = vplPatchSide_SampleCell(
                s, side, k % 16, ((float)(k / 16 % 16) + 0.5f) / 16, ((float)(k / 256) + 0.5f) / 16);
            const vplTriangleCorners c = vplGeometry_Corners(g, at.triangle);
            double w[3];
            vplTriangle_Barycentrics(c.corner, at.at, w);
            assert_true(w[0] > -1e-5 && w[1] > -1e-5 && w[2] > -1e-5);
            assert_true(fabsf(vplDot(at.normal, vplSub(at.at, c.corner[0]))) < 1e-6f);
            assert_int_equal(p->nodes[at.triangle].patch, side->patch);
            mean = vplAdd(mean, vplScale(1 / 4096.0f, at.at));
        }
        assertNear((double)vplLength(vplSub(mean, side->incentre)), 0, 0.01, "mean of points", i);
        groups++;
    }
    assert_true(groups > 8);
    vplPatchSides_Destroy(s);
    vplPatches_Destroy(p);
    vplGeometry_Destroy(g);
}

// In a closed room that emits E everywhere and reflects half, all radiosities are 2 E: by form factors and by links, as
// they are, whose rows sum to 1 within some percent, and with corrected rows.
TEST(AFurnaceWithAGroupedBall, 2)
{
    vplGeometry* g = buildGeometry(ballRoom(context, 1, 4, 0.5f, 1));
    vplPatches* p = groupsOf(g, 300, 0, true);
    vplPatchSides* s = sidesOf(p, NULL);
    assert_int_equal(g->triangleCount, 12 + 5120);
    assert_true(p->groupCount > 30 && s->count <= p->patchCount);
    for (int way = 0; way < 4; way++) {
        const bool corrected = way & 1, linked = way & 2;
        vplLinkDef def = vplDefaultLinkDef();
        vplFormFactorDef all = vplDefaultFormFactorDef();
        vplLinks* links = NULL;
        vplFormFactors* factors = NULL;
        def.rowSums = all.rowSums = corrected ? VPL_ROW_SUMS_USUAL : VPL_ROW_SUMS_KEEP;
        def.samples = 16;
        assert_int_equal(linked ? vplLinks_Create(s, &def, &links) : vplFormFactors_Create(s, &all, &factors),
                         VPL_SUCCESS);
        const vplTransport transport = {.sides = s, .links = links, .factors = factors};
        vplRgb *source = calloc((size_t)s->count, sizeof *source), *b = calloc((size_t)s->count, sizeof *b);
        double sum = 0, area = 0, worst = 0;
        for (int i = 0; i < s->count; i++) {
            b[i] = source[i] = s->sides[i].emission;
            assertNear((double)source[i].r, VPL_PI, 1e-5, "emission", i);
        }
        const vplSolveDef solve = vplDefaultSolveDef();
        assert_int_equal(vplSolveRadiosity(&transport, &solve, source, b, NULL), VPL_SUCCESS);
        for (int i = 0; i < s->count; i++) {
            const double off = (double)b[i].r / (2 * VPL_PI) - 1;
            sum += (double)s->sides[i].area * off;
            area += (double)s->sides[i].area;
            worst = fmax(worst, fabs(off));
        }
        assertNear(sum / area, 0, corrected ? 1e-3 : 0.02, "mean error", way);
        assertNear(worst, 0, corrected ? 0.01 : 0.15, "largest error", way);
        free(source);
        free(b);
        vplLinks_Destroy(links);
        vplFormFactors_Destroy(factors);
    }
    vplPatchSides_Destroy(s);
    vplPatches_Destroy(p);
    vplGeometry_Destroy(g);
}

// ---- pictures

static vplScene* litBall(vplContext* context)
{
    vplScene* scene = ballRoom(context, 1, 4, 0.7f, 0);
    aim(scene, vplVec(0.1f, -0.2f, 0.9f), vplVec(0, -0.3f, -1));
    addEmitter(scene, VPL_EMITTER_POINT, vplVec(-0.3f, 0.6f, 0.2f), vplVec(0, -1, 0), 3);
    return scene;
}

static uint64_t hashOfBall(vplContext* context)
{
    vplScene* scene = litBall(context);
    vplRenderOptions o = radiosityOptions(120);
    vplRenderStats stats;
    uint64_t hash = 0;
    for (int i = 0; i < 2; i++) {
        o.radiosity.hierarchy = i == 0 ? VPL_HIERARCHY_OFF : VPL_HIERARCHY_ON;
        vplImage_Destroy(renderScene(scene, &o, &stats));
        hash = 31 * hash + stats.imageHash;
    }
    assert_true(stats.patchGroups > 10 && stats.groupedTriangles > 5000);
    vplScene_Destroy(scene);
    closeTestContext(context);
    return hash;
}

TEST_ALONE(GroupsHaveTheSameBitsEverywhere)
{
    assertSameEverywhere(hashOfBall);
}

// Indirect light on a ball of 5,120 triangles in 600 patches, against paths.
TEST(AGroupedBallLooksLikePaths, 2, SLOW)
{
    vplScene* scene = litBall(context);
    vplImage *truth = pathsOf(scene, VPL_SHOW_INDIRECT, 256),
             *image = showOf(scene, radiosityOptions(600), VPL_SHOW_INDIRECT);
    const vplComparison c = compare(truth, image);
    assertNear(meanOf(image) / meanOf(truth), 1, 0.03, "energy", 0);
    assertNear(c.rmse / meanOf(truth), 0, 0.08, "relative rmse", 0);
    vplImage_Destroy(truth);
    vplImage_Destroy(image);
    vplScene_Destroy(scene);
}

// Scenes that reach the number of patches by bisection have no groups, and keep every bit.
TEST(ScenesWithFewTrianglesHaveNoGroups, 2)
{
    vplScene* scene = boxRoom(context, 0.7f, false);
    uint64_t hashes[2];
    for (int i = 0; i < 2; i++) {
        vplRenderOptions o = radiosityOptions(200);
        vplRenderStats stats;
        o.radiosity.groups = i == 0 ? VPL_PATCH_GROUPS_AUTO : VPL_PATCH_GROUPS_OFF;
        vplImage_Destroy(renderScene(scene, &o, &stats));
        assert_int_equal(stats.patchGroups, 0);
        hashes[i] = stats.imageHash;
    }
    assert_true(hashes[0] == hashes[1]);
    vplScene_Destroy(scene);
}

// A closed cube with one ball of this radius.
static vplScene* cubeWithBall(vplContext* context, int levels, float radius)
{
    vplScene* scene = closedCubeScene(context, 0.7f, 0);
    Shape ball = icosphere(levels);
    placeShape(&ball, radius, (double[3]){0, 0, 0}, vplVec(0.1f, -0.5f, -0.2f));
    addBall(scene, &ball);
    aim(scene, vplVec(0.1f, -0.2f, 0.9f), vplVec(0, -0.3f, -1));
    return scene;
}

// Groups are less than a seventh of the patches, but a large ball of them is an eighth of all surfaces, a small one 2 %.
TEST(PixelsGatherTheirLightWhereGroupsAreLarge, 2)
{
    static const struct {
        float radius;
        bool gathers;
    } cases[] = {{0.5f, true}, {0.2f, false}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        vplScene* scene = cubeWithBall(context, 4, cases[i].radius);
        vplRenderOptions o = radiosityOptions(4000);
        vplPlan* plan = NULL;
        assert_int_equal(vplPlan_Create(scene, &o, NULL, &plan), VPL_SUCCESS);
        assert_true(plan->patchGroups > 0 && 7 * (int64_t)plan->patchGroups < plan->patches);
        assert_true(plan->gathers == cases[i].gathers);
        vplPlan_Destroy(plan);
        vplScene_Destroy(scene);
    }
}

// Thousands of triangles that are far smaller than patches share patches, even where there are fewer triangles than patches: links
// between all of them would take hours. Triangles as large as patches stay single, and so do a few thousand small ones.
TEST(ManySmallTrianglesAreGrouped, 2)
{
    static const struct {
        int levels;
        float radius;
        int patches;
        vplPatchGroups groups;
    } cases[] = {{5, 0.02f, 30000, VPL_PATCH_GROUPS_ON},   // 20,480 of less than 1/1,000 of a patch
                 {5, 0.02f, 163000, VPL_PATCH_GROUPS_ON},  // just over an eighth of the patches
                 {5, 0.02f, 165000, VPL_PATCH_GROUPS_OFF}, // just under an eighth
                 {5, 0.4f, 30000, VPL_PATCH_GROUPS_OFF},   // 0.11 of a patch
                 {4, 0.02f, 6000, VPL_PATCH_GROUPS_OFF}};  // all pairs of 5,120 are fast
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        vplScene* scene = cubeWithBall(context, cases[i].levels, cases[i].radius);
        vplRenderOptions o = radiosityOptions(cases[i].patches);
        vplPlan* plan = NULL;
        o.output.show = VPL_SHOW_NORMALS; // how patches are made is decided, but none is made
        assert_int_equal(vplPlan_Create(scene, &o, NULL, &plan), VPL_SUCCESS);
        assert_int_equal(plan->options.radiosity.groups, cases[i].groups);
        vplPlan_Destroy(plan);
        vplScene_Destroy(scene);
    }
    vplGeometry* g = buildGeometry(cubeWithBall(context, 5, 0.02f));
    vplPatches* p = groupsOf(g, 30000, 0, true);
    assert_true(p->groupCount > 20 && p->groupCount < 1000);
    assertNear(p->patchCount / 30000.0, 1, 0.1, "patches", 0);
    vplPatches_Destroy(p);
    vplGeometry_Destroy(g);
}

// One patch is too few for any scene; as few as normals allow are made, adaptive ones too.
TEST(OnePatchIsAsFewAsPossible, 2)
{
    vplScene* scene = litBall(context);
    for (int adaptive = 0; adaptive < 2; adaptive++) {
        vplRenderOptions o = radiosityOptions(adaptive ? 60 : 1);
        vplRenderStats stats;
        o.radiosity.placement = adaptive ? VPL_PATCHES_ADAPTIVE : VPL_PATCHES_UNIFORM;
        vplImage* image = renderScene(scene, &o, &stats);
        assert_true(stats.patchGroups > 5 && stats.patches < 100 && meanOf(image) > 0);
        vplImage_Destroy(image);
    }
    vplScene_Destroy(scene);
}

// Groups have no incentre, and without their unoccluded form factors those of samples alone are refused.
TEST(GroupsHaveNoIncentre, 2)
{
    vplScene* scene = litBall(context);
    vplRenderOptions o = radiosityOptions(120);
    vplImage* image = NULL;
    o.radiosity.groups = VPL_PATCH_GROUPS_ON;
    o.radiosity.formFactors = VPL_FORM_FACTORS_INCENTRE;
    assert_int_equal(vplRender(scene, &o, &image, NULL), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "--patch-groups off"));
    vplGeometry* g = buildGeometry(scene);
    vplPatches* p = groupsOf(g, 100, 0, false);
    vplPatchSides* s = sidesOf(p, &(vplVec3){0, 0.8f, 0});
    for (int i = 0; i < 2; i++) {
        vplFormFactorDef def = vplDefaultFormFactorDef();
        vplFormFactors* f = NULL;
        def.kind = i == 0 ? VPL_FORM_FACTORS_INCENTRE : VPL_FORM_FACTORS_MONTE_CARLO;
        def.analytic = false;
        assert_int_equal(vplFormFactors_Create(s, &def, &f), VPL_INVALID_ARGUMENT);
        assert_null(f);
    }
    vplPatchSides_Destroy(s);
    vplPatches_Destroy(p);
    vplGeometry_Destroy(g);
}

// ---- direct light

// The power of a lamp that arrives at patches.
static double directPower(const vplScene* scene, const vplRenderOptions* o)
{
    vplRenderer* r;
    double power = 0;
    assert_int_equal(vplRenderer_Create(scene, o, &r), VPL_SUCCESS);
    assert_int_equal(vplRunner_RunPlan(&r->runner, r->plan, VPL_STAGE_PATCH_LIGHT), VPL_SUCCESS);
    const vplPatchSides* sides = r->runner.run.results[VPL_STAGE_SIDES];
    const vplPatchLight* light = r->runner.run.results[VPL_STAGE_PATCH_LIGHT];
    assert_true(sides->patches->groupCount * 2 > sides->patches->patchCount);
    for (int i = 0; i < sides->count; i++) {
        power += (double)sides->sides[i].area * vplRgbMean(light->direct[i]);
    }
    vplRenderer_Destroy(r);
    return power;
}

// A lamp stands 20 cm from a wall of a closed cube of 2 m, whose faces are meshes. About 80 groups receive 4 pi of its 1 W/sr. With one
// set of 16 points for each of them they had 0.984 to 1.020 of it.
TEST(TheLightOfALampIsAllOnGroups, 2)
{
    vplScene* scene = sceneOf(context, 0.5f);
    Shape box = gridBox(15);
    double sum = 0;
    addShape(scene, &box, false, NULL);
    freeShape(&box);
    aim(scene, vplVec(-0.8f, 0.5f, 0.5f), vplVec(0.5f, 0, 0));
    addEmitter(scene, VPL_EMITTER_POINT, vplVec(0.8f, 0.1f, -0.2f), vplVec(0, -1, 0), 1);
    for (uint64_t seed = 0; seed < 16; seed++) {
        vplRenderOptions o = radiosityOptions(100);
        o.seed = seed;
        const double share = directPower(scene, &o) / (4 * (double)VPL_PI);
        assertNear(share, 1, 0.01, "power", (int)seed);
        sum += share;
    }
    assertNear(sum / 16, 1, 0.004, "mean of seeds", 0);
    vplScene_Destroy(scene);
}
