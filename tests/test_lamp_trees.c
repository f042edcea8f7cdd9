// SPDX-License-Identifier: MIT
// Tests of trees of emitters as pictures use them: triangles that emit, the stage that makes trees, and their memory.
#include "geometry/emission.h"
#include "geometry/emitter_tree.h"
#include "geometry/triangle.h"
#include "lights/light_set.h"
#include "path_scenes.h"
#include "render/plan.h"
#include "render/runner.h"
#include "shading/shading.h"

enum { LAMPS = 100, CLOSE = 1024, SAMPLES = 64 };

static vplVec3 pointAt(uint64_t index, float size)
{
    const double u[3] = {uniformAt(73, 3 * index), uniformAt(73, 3 * index + 1),
                         uniformAt(73, 3 * index + 2)};
    return vplVec(size * (float)(2 * u[0] - 1), size * (float)(2 * u[1] - 1), size * (float)(2 * u[2] - 1));
}

// A room with small quads that emit, and points.
static vplScene* hall(vplContext* context, int quads, int points)
{
    vplScene* scene = newScene(context);
    addRoom(scene, addGrey(scene, 0.5f, 0));
    const int glow = addGrey(scene, 0.2f, 2);
    for (int i = 0; i < quads; i++) {
        addQuad(scene, glow, pointAt((uint64_t)i, 0.8f), i % 2, 0.05f + 0.0005f * (float)i);
    }
    for (int i = 0; i < points; i++) {
        addEmitter(scene, VPL_EMITTER_POINT, pointAt(5000 + (uint64_t)i, 0.9f), vplVec(0, -1, 0), 0.01f);
    }
    addCamera(scene, vplVec(0, 0, 0.9f), vplVec(0, -0.1f, -1), 1.4);
    return scene;
}

// Blocks of points, every third of which is on no triangle, with every instruction set.
static void checkBlocks(const vplEmitterTree* tree)
{
    enum { BLOCKS = 60 };
    for (uint64_t i = 0; i < BLOCKS * VPL_ISA_COUNT; i++) {
        const vplIsa isa = (vplIsa)(i % VPL_ISA_COUNT);
        vplSurface s;
        vplPoints points = {.surface = &s, .plane = &s};
        vplVec3 p[VPL_LANES], n[VPL_LANES];
        double choice[VPL_LANES];
        vplChosenSource chosen[VPL_LANES];
        for (uint64_t l = 0, k = VPL_LANES * (i / VPL_ISA_COUNT); l < VPL_LANES; l++, k++) {
            p[l] = pointAt(20000 + k, 1);
            n[l] = vplNormalize(pointAt(30000 + k, 1));
            s.px[l] = p[l].x, s.py[l] = p[l].y, s.pz[l] = p[l].z;
            s.nx[l] = n[l].x, s.ny[l] = n[l].y, s.nz[l] = n[l].z;
            points.triangle[l] = k % 3 > 0 ? 0 : -1;
            choice[l] = uniformAt(72, k);
        }
        if (vplHasIsa(isa)) {
            vplGetShadingKernels(isa, VPL_LIGHTING_PHYSICAL)->chooseSources(tree, &points, choice, chosen);
        }
        for (int l = 0; l < VPL_LANES && vplHasIsa(isa); l++) {
            const vplChosenSource alone = vplEmitterTree_Choose(tree, p[l], n[l], choice[l]);
            assert_int_equal(chosen[l].source, points.triangle[l] == 0 ? alone.source : -1);
            if (chosen[l].source >= 0) {
                assert_memory_equal(&chosen[l].probability, &alone.probability, sizeof alone.probability);
                assert_memory_equal(&chosen[l].rest, &alone.rest, sizeof alone.rest);
            }
        }
    }
}

TEST(SixteenPointsChooseSourcesAsEachAlone, 1)
{
    vplScene* scene = hall(context, LAMPS, LAMPS);
    vplEmitterDef emitters[LAMPS];
    vplGeometry* g;
    assert_int_equal(vplGeometry_Create(scene, &g), VPL_SUCCESS);
    for (int k = 0; k < 3; k++) { // points, points and spots, triangles
        for (int i = 0; i < LAMPS; i++) {
            emitters[i] = *vplScene_GetEmitter(scene, i);
            emitters[i].type = k == 1 && i % 3 == 0 ? VPL_EMITTER_SPOT : VPL_EMITTER_POINT;
        }
        vplEmission* e;
        vplEmitterTree* tree;
        vplArena* arena = vplArena_Create(context);
        assert_int_equal(vplEmission_Create(g, emitters, LAMPS, &e), VPL_SUCCESS);
        assert_int_equal(vplEmitterTree_Create(arena, e, k == 2 ? e->firstTriangle : 0,
                                               k == 2 ? e->sourceCount : e->firstTriangle, &tree),
                         VPL_SUCCESS);
        checkBlocks(tree);
        vplArena_Destroy(arena);
        vplEmission_Destroy(e);
    }
    vplGeometry_Destroy(g);
    vplScene_Destroy(scene);
}

// Points of a wall so close to each other that they receive the same light; each chooses for itself.
static void lightClosePoints(const vplGeometry* g, const vplShadeDef* def, int triangle, double sumsOut[2])
{
    static vplSurfacePoint points[CLOSE];
    static vplRgb irradiance[CLOSE];
    const vplTriangleCorners t = vplGeometry_Corners(g, triangle);
    const vplVec3 centre = vplScale(1.0f / 3, vplAdd(t.corner[0], vplAdd(t.corner[1], t.corner[2]))),
                  n = g->normals[triangle];
    for (int i = 0; i < CLOSE; i++) {
        vplVec3 offset = pointAt(9000 + (uint64_t)i, 0.001f);
        offset = vplSub(offset, vplScale(vplDot(offset, n), n));
        points[i] = (vplSurfacePoint){vplAdd(centre, offset), n, triangle};
    }
    sumsOut[0] = sumsOut[1] = 0;
    assert_int_equal(vplShadePoints(g, def, points, CLOSE, irradiance, NULL), VPL_SUCCESS);
    for (int i = 0; i < CLOSE; i++) {
        sumsOut[0] += (double)irradiance[i].r / CLOSE;
        sumsOut[1] += (double)irradiance[i].r * (double)irradiance[i].r / CLOSE;
    }
}

// The mean over many choices is the light of all triangles, for which 64 points on each lamp stand, with their shadows.
TEST(ChosenTrianglesHaveTheMeanOfAll, 2)
{
    static vplShadeLight all[LAMPS * SAMPLES];
    vplScene* scene = hall(context, LAMPS, 0);
    vplGeometry* g;
    vplEmission* emission;
    int checked = 0;
    double squares = 0;
    assert_int_equal(vplGeometry_Create(scene, &g), VPL_SUCCESS);
    assert_int_equal(vplEmission_Create(g, NULL, 0, &emission), VPL_SUCCESS);
    vplShadeDef chosenDef = vplDefaultShadeDef(), allDef = vplDefaultShadeDef();
    chosenDef.trianglesPerPoint = 4;
    allDef.areaLights = all;
    allDef.areaLightCount = vplSampleAreaLights(emission, LAMPS * SAMPLES, all);
    for (int triangle = 0; triangle < 12; triangle++) { // the walls
        double sum[2], chosen[2];
        lightClosePoints(g, &allDef, triangle, sum);
        lightClosePoints(g, &chosenDef, triangle, chosen);
        const double error = sqrt(fmax(chosen[1] - chosen[0] * chosen[0], 0) / CLOSE);
        assertNear(chosen[0], sum[0], 4 * error + 0.003 * sum[0], "irradiance", triangle);
        squares += error > 0 ? (chosen[0] - sum[0]) * (chosen[0] - sum[0]) / (error * error) : 0;
        checked += error > 0;
    }
    printf("# %d places, mean square of the difference in standard errors %.2f\n", checked,
           squares / checked);
    assert_true(checked >= 8 && squares < 2.5 * checked);
    vplEmission_Destroy(emission);
    vplGeometry_Destroy(g);
    vplScene_Destroy(scene);
}

static bool hasStage(const vplPlan* plan, vplStageId id)
{
    for (int i = 0; i < plan->stageCount; i++) {
        if (plan->stages[i].id == (int)id) {
            return true;
        }
    }
    return false;
}

// What lights pixels.
typedef enum Lighting { SAMPLES_BY_POWER, POINT_PER_FACE, POINTS_ON_MESH, CHOSEN } Lighting;

static void checkPlan(const vplScene* scene, const vplRenderOptions* o, Lighting lighting, int points)
{
    vplPlan* plan;
    assert_int_equal(vplPlan_Create(scene, o, NULL, &plan), VPL_SUCCESS);
    assert_int_equal(plan->options.lights.areaLightSamples, points);
    assert_int_equal(plan->trianglesPerPoint, lighting != SAMPLES_BY_POWER ? SAMPLES : 0);
    assert_int_equal(vplPixelsChooseTriangles(plan), lighting == CHOSEN);
    const bool hits = plan->trianglesPerPoint > 0 && (plan->gathers || plan->compensates);
    assert_int_equal(hasStage(plan, VPL_STAGE_EMITTER_TREES), lighting == CHOSEN || hits);
    assert_int_equal(hasStage(plan, VPL_STAGE_AREA_LIGHTS),
                     lighting != CHOSEN && o->method != VPL_METHOD_KELLER);
    vplPlan_Destroy(plan);
}

// Also where the samples that were decided are given as an option.
static void checkMethods(const vplScene* scene, Lighting lighting, int points)
{
    static const vplMethod methods[] = {VPL_METHOD_DIRECT, VPL_METHOD_INSTANT_RADIOSITY, VPL_METHOD_RADIOSITY,
                                        VPL_METHOD_SSVP, VPL_METHOD_KELLER};
    for (int i = 0; i < 5; i++) {
        const bool keller = methods[i] == VPL_METHOD_KELLER; // whose lights lie on lamps
        vplRenderOptions o = plainOptions();
        o.method = methods[i];
        checkPlan(scene, &o, keller ? SAMPLES_BY_POWER : lighting, keller ? SAMPLES : points);
        o.lights.areaLightSamples = points;
        checkPlan(scene, &o, keller ? SAMPLES_BY_POWER : lighting, points);
    }
}

TEST(EachOfManyLampsHasAPointAndATreeChoosesAmongMoreThanAThousand, 1)
{
    const struct {
        int quads, points;
        Lighting lighting;
    } cases[] = {{SAMPLES, SAMPLES, SAMPLES_BY_POWER},
                 {SAMPLES + 1, SAMPLES + 1, POINT_PER_FACE},
                 {VPL_MOST_EMITTERS, VPL_MOST_EMITTERS, POINT_PER_FACE},
                 {VPL_MOST_EMITTERS + 1, SAMPLES, CHOSEN}};
    for (int i = 0; i < 4; i++) {
        vplScene* scene = hall(context, cases[i].quads, 0);
        checkMethods(scene, cases[i].lighting, cases[i].points);
        vplScene_Destroy(scene);
    }
}

enum { RINGS = 24, AROUND = 32, GLOWING = 2 * RINGS * AROUND };

// A torus in the hall, or its triangles far from each other, as one mesh.
static vplScene* glow(vplContext* context, bool scattered)
{
    static vplVec3 positions[3 * GLOWING];
    static uint32_t indices[3 * GLOWING];
    for (int i = 0; i < 3 * GLOWING; i++) {
        const int square = i / 6, k = (int[]){0, 2, 1, 1, 2, 3}[i % 6]; // a corner of a square
        const double u = 2 * VPL_PI * (square / AROUND + (k & 1)) / RINGS,
                     v = 2 * VPL_PI * (square % AROUND + (k >> 1)) / AROUND, r = 0.25 + 0.1 * cos(v);
        const vplVec3 p = vplVec((float)(r * cos(u)), (float)(0.1 * sin(v)), (float)(r * sin(u)));
        positions[i] = scattered ? vplAdd(vplScale(0.02f, p), pointAt((uint64_t)i / 3, 0.8f)) : p;
        indices[i] = (uint32_t)i;
    }
    vplScene* scene = hall(context, 0, 0);
    vplMeshDef mesh = vplDefaultMeshDef();
    mesh.positions = positions;
    mesh.vertexCount = 3 * GLOWING;
    mesh.indices = indices;
    mesh.triangleCount = GLOWING;
    vplObjectDef object = vplDefaultObjectDef();
    object.type = VPL_OBJECT_MESH;
    object.material = addGrey(scene, 0.2f, 2);
    assert_int_equal(vplScene_AddMesh(scene, &mesh, &object.mesh), VPL_SUCCESS);
    assert_int_equal(vplScene_AddObject(scene, &object, NULL), VPL_SUCCESS);
    return scene;
}

TEST(PointsLieOnCompactMeshesAndATreeChoosesFromScatteredOnes, 1)
{
    for (int scattered = 0; scattered < 2; scattered++) {
        vplScene* scene = glow(context, scattered);
        checkMethods(scene, scattered ? CHOSEN : POINTS_ON_MESH, scattered ? SAMPLES : 256);
        vplScene_Destroy(scene);
    }
}

// Quads of different sizes: each has a point, a large one several, and together they have the power of all.
TEST(EachFaceThatEmitsHasAPoint, 1)
{
    enum { COUNT = 2 * LAMPS };
    static vplShadeLight lights[COUNT + LAMPS + 1];
    vplScene* scene = hall(context, LAMPS, 0);
    addQuad(scene, addGrey(scene, 0.2f, 2), vplVec(0, 0.9f, 0), 1, 1);
    vplGeometry* g;
    vplEmission* e;
    int most = 0, total = 0;
    double power = 0;
    assert_int_equal(vplGeometry_Create(scene, &g), VPL_SUCCESS);
    assert_int_equal(vplEmission_Create(g, NULL, 0, &e), VPL_SUCCESS);
    assert_int_equal(vplCountEmittingFaces(e), LAMPS + 1);
    const int count = vplSampleEmittingFaces(e, COUNT, lights);
    for (int quad = 0; quad < LAMPS + 1; quad++) {
        const int triangle = e->sources[e->firstTriangle + 2 * quad].triangle;
        const vplTriangleCorners t = vplGeometry_Corners(g, triangle); // the quad's diagonal is an edge
        int on = 0;
        for (int i = 0; i < count; i++) {
            const vplVec3 p = vplVec(lights[i].px, lights[i].py, lights[i].pz);
            const double height = vplDot(vplSub(p, t.corner[0]), g->normals[triangle]);
            on += i >= total && on == i - total && fabs(height) < 1e-6;
        }
        assert_true(on >= 1);
        total += on;
        most = on > most ? on : most;
    }
    for (int i = 0; i < count; i++) {
        power += VPL_PI * (double)lights[i].r;
    }
    printf("# %d points, %d on the large quad\n", count, most);
    assert_int_equal(total, count);
    assert_true(most > 10);
    assertNear(power, vplEmission_Power(e), 1e-5 * power, "power", 0);
    vplEmission_Destroy(e);
    vplGeometry_Destroy(g);
    vplScene_Destroy(scene);
}

// Without places, a triangle is chosen by its power: of one radiance, by its area.
TEST(PowerAloneChoosesTrianglesByArea, 1)
{
    vplScene* scene = hall(context, LAMPS, 0);
    vplGeometry* g;
    vplEmission* e;
    vplEmitterTree* tree;
    vplArena* arena = vplArena_Create(context);
    double area = 0;
    assert_int_equal(vplGeometry_Create(scene, &g), VPL_SUCCESS);
    assert_int_equal(vplEmission_Create(g, NULL, 0, &e), VPL_SUCCESS);
    const int first = e->firstTriangle, end = first + 2 * LAMPS;
    assert_int_equal(vplEmitterTree_Create(arena, e, first, end, &tree), VPL_SUCCESS);
    vplEmitterTree_ForgetPlaces(tree);
    for (int i = first; i < end; i++) {
        area += vplGeometry_TriangleArea(g, e->sources[i].triangle);
    }
    for (int i = first; i < end; i++) {
        const double share = vplGeometry_TriangleArea(g, e->sources[i].triangle) / area;
        const vplVec3 from = vplVec(0, 0, 0.9f), normal = vplVec(0, 0, -1);
        assertNear(vplEmitterTree_Probability(tree, from, normal, i) / share, 1, 1e-5, "share", i);
    }
    vplArena_Destroy(arena);
    vplEmission_Destroy(e);
    vplGeometry_Destroy(g);
    vplScene_Destroy(scene);
}

// Passes, frames and other stages share the trees, until an emitter moves.
TEST(TreesOfEmittersAreMadeOnce, 1)
{
    vplScene* scene = hall(context, 0, 1100);
    vplHistory* history;
    assert_int_equal(vplHistory_Create(context, &history), VPL_SUCCESS);
    vplRenderOptions o = plainOptions();
    o.output.width = o.output.height = 8;
    o.method = VPL_METHOD_KELLER;
    o.stop.passes = 3;
    o.sequence.history = history;
    for (int frame = 0; frame < 3; frame++) {
        if (frame == 2) {
            vplEmitterDef moved = *vplScene_GetEmitter(scene, 7);
            moved.position.x += 0.01f;
            assert_int_equal(vplScene_SetEmitter(scene, 7, &moved), VPL_SUCCESS);
        }
        vplImage_Destroy(renderScene(scene, &o, NULL));
        assert_int_equal(history->slots[VPL_STAGE_EMITTER_TREES].build, frame < 2 ? 1 : 2);
    }
    vplHistory_Destroy(history);
    vplScene_Destroy(scene);
}

static double peakOf(vplContext* context, vplMethod method, int points, double* plannedOut)
{
    vplScene* scene = hall(context, 0, points);
    vplRenderOptions o = plainOptions();
    vplRenderStats stats;
    vplPlan* plan;
    o.method = method;
    o.output.width = o.output.height = 8;
    o.path.samples = 1;
    o.particles.count = 16;
    assert_int_equal(vplPlan_Create(scene, &o, NULL, &plan), VPL_SUCCESS);
    *plannedOut = (double)plan->peakBytes;
    vplPlan_Destroy(plan);
    vplImage_Destroy(renderScene(scene, &o, &stats));
    vplScene_Destroy(scene);
    return (double)stats.peakBytes;
}

// A description of a shadow map for each lamp took 1,800 bytes of each of 100,000, although rays cast all shadows.
TEST(LampsNeedFewBytesEach, 1)
{
    enum { FEW = 2000, MANY = 12000 };
    static const vplMethod methods[] = {VPL_METHOD_DIRECT, VPL_METHOD_KELLER, VPL_METHOD_PATH};
    for (int i = 0; i < 3; i++) {
        double planned[2];
        const double few = peakOf(context, methods[i], FEW, &planned[0]),
                     many = peakOf(context, methods[i], MANY, &planned[1]);
        const double each = (many - few) / (MANY - FEW), foretold = (planned[1] - planned[0]) / (MANY - FEW);
        printf("# method %d: %.0f bytes per lamp, planned %.0f\n", methods[i], each, foretold);
        assert_true(each < 650);
        assertNear(foretold, each, 0.3 * each, "planned", i);
    }
}
