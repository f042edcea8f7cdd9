// SPDX-License-Identifier: MIT
// Tests of the connections of paths from the camera with the vertices of paths from lights.
#include "path_scenes.h"

#include "reference/light_path.h"

#include <string.h>

static const char HARD_ROOM[] = "tests/data/shade.json"; // a lamp in a box with a slit

// Pictures, and their means, differ by no more than their error estimates allow. Spheres of few triangles have normals far from those of
// their triangles, so that a light path that forgets this has another mean.
TEST(LightPathsOfAnyLengthFindTheSameLight, 2, SLOW)
{
    static const int VERTICES[] = {0, 2, 3, VPL_MOST_LIGHT_VERTICES};
    vplScene* scene = addAllLights(newScene(context), 2);
    vplGeometry* geometry;
    vplPathStats stats, other;
    assert_int_equal(vplGeometry_Create(scene, &geometry), VPL_SUCCESS);
    for (int bounces = 3; bounces < 8; bounces += 4) { // shorter and longer than most light paths
        vplPathDef def = vplDefaultPathDef();
        def.emission = false; // aliasing at visible emitters would dominate the error
        def.lastBounce = def.mostBounces = bounces;
        def.firstBounce = 1;
        vplImage* first = traceWith(scene, geometry, &def, 1024, &stats);
        for (size_t i = 0; i < sizeof VERTICES / sizeof *VERTICES; i++) {
            def.seed = 1 + (uint64_t)i;
            def.lightVertices = VERTICES[i];
            vplImage* image = traceWith(scene, geometry, &def, 512, &other);
            const double predicted =
                stats.errorEstimate * stats.errorEstimate + other.errorEstimate * other.errorEstimate;
            assert_true(other.relativeErrorEstimate < 0.06); // else the rest proves nothing
            assertNear(sqrt(squaredDifference(first, image) / predicted), 1, 0.2, "found / predicted",
                       (int)i);
            for (int c = 0; c < 2; c++) { // mean of 576 pixels: three standard deviations; red is less noisy
                assertNear(meanOfImage(image, c), meanOfImage(first, c), 2 * 3 * sqrt(predicted) / 24, "mean",
                           (int)i);
            }
            vplImage_Destroy(image);
        }
        vplImage_Destroy(first);
    }
    vplGeometry_Destroy(geometry);
    vplScene_Destroy(scene);
}

// A ceiling whose normals to shade with lean to a side by 75 degrees.
static void addLeaningCeiling(vplScene* scene, int material)
{
    static const vplVec3 POSITIONS[] = {{-1, 0.9f, -1}, {1, 0.9f, -1}, {1, 0.9f, 1}, {-1, 0.9f, 1}};
    static const vplVec3 LEANING = {-0.9659258f, -0.2588190f, 0};
    static const uint32_t INDICES[] = {0, 1, 2, 0, 2, 3};
    const vplVec3 normals[] = {LEANING, LEANING, LEANING, LEANING};
    vplMeshDef mesh = vplDefaultMeshDef();
    mesh.positions = POSITIONS;
    mesh.normals = normals;
    mesh.indices = INDICES;
    mesh.vertexCount = 4;
    mesh.triangleCount = 2;
    vplObjectDef def = vplDefaultObjectDef();
    def.type = VPL_OBJECT_MESH;
    def.material = material;
    assert_int_equal(vplScene_AddMesh(scene, &mesh, &def.mesh), VPL_SUCCESS);
    assert_int_equal(vplScene_AddObject(scene, &def, NULL), VPL_SUCCESS);
}

// A spot lights the floor, which lights the ceiling, which lights the floor that the camera sees. A light path leaves the ceiling by the cosine of
// its plane's normal, a path from the camera by that of the normal to shade with: to take the one for the other changes the mean by 13
// standard deviations.
TEST(LightPathsKnowBothNormalsOfASurface, 2)
{
    vplScene* scene = newScene(context);
    vplGeometry* geometry;
    vplPathStats stats[2];
    vplImage* images[2];
    addRoom(scene, addGrey(scene, 0.1f, 0));
    addLeaningCeiling(scene, addGrey(scene, 0.95f, 0));
    addWhite(scene, VPL_EMITTER_SPOT, (vplVec3){0, -0.5f, 0}, 1);
    addCamera(scene, (vplVec3){0, 0.8f, 0}, (vplVec3){0.001f, -1, 0}, 1);
    assert_int_equal(vplGeometry_Create(scene, &geometry), VPL_SUCCESS);
    for (int i = 0; i < 2; i++) {
        vplPathDef def = vplDefaultPathDef();
        def.firstBounce = def.lastBounce = def.mostBounces = 2;
        def.seed = (uint64_t)i;
        def.lightVertices = 1 + i;
        images[i] = traceWith(scene, geometry, &def, 1024, &stats[i]);
    }
    const double predicted = sqrt(stats[0].errorEstimate * stats[0].errorEstimate +
                                  stats[1].errorEstimate * stats[1].errorEstimate);
    assertNear(meanOfImage(images[1], 1), meanOfImage(images[0], 1), 2 * 3 * predicted / 24, "mean", 0);
    vplImage_Destroy(images[0]);
    vplImage_Destroy(images[1]);
    vplGeometry_Destroy(geometry);
    vplScene_Destroy(scene);
}

// If all walls reflect rho and emit E, radiance is E / (1 - rho) everywhere.
TEST(AFurnaceGlowsAlikeByLongLightPaths, 2)
{
    vplScene* scene = newScene(context);
    addRoom(scene, addGrey(scene, 0.5f, 2));
    addCamera(scene, (vplVec3){0.3f, 0.1f, 0.2f}, (vplVec3){-1, -0.4f, -0.8f}, 1.5);
    vplRenderOptions options = pathOptions(8, 256);
    options.path.lightVertices = VPL_MAX_LIGHT_VERTICES;
    vplImage* image = renderScene(scene, &options, NULL);
    assertNear(meanOfImage(image, 0), 4, 4 * 0.0045, "mean",
               0); // with one vertex five standard deviations are 0.0045
    vplImage_Destroy(image);
    vplScene_Destroy(scene);
}

// All outputs follow the same paths and connect them alike, so single bounces add up except for rounding.
TEST(BouncesOfLongLightPathsAddUp, 2)
{
    enum { BOUNCES = 5, SIZE = 16 };
    vplScene* scene = openScene(context, HARD_ROOM);
    vplRenderOptions options = pathOptions(SIZE, 16);
    options.maxBounces = BOUNCES;
    options.path.lightVertices = VPL_MAX_LIGHT_VERTICES;
    vplImage* all = renderScene(scene, &options, NULL);
    static double sums[3 * SIZE * SIZE];
    memset(sums, 0, sizeof sums);
    options.output.show = VPL_SHOW_BOUNCE;
    for (int k = 0; k <= BOUNCES; k++) {
        options.output.showIndex = k;
        vplImage* bounce = renderScene(scene, &options, NULL);
        for (int i = 0; i < 3 * SIZE * SIZE; i++) {
            sums[i] += (double)bounce->pixels[i];
        }
        vplImage_Destroy(bounce);
    }
    for (int i = 0; i < 3 * SIZE * SIZE; i++) {
        assertNear(sums[i], (double)all->pixels[i], 1e-6 * (double)all->pixels[i], "sum of bounces", i);
    }
    vplImage_Destroy(all);
    vplScene_Destroy(scene);
}

// The error by one vertex is several times as large, for less than twice the rays.
TEST(LongLightPathsFindTheWayThroughASlit, 2, SLOW)
{
    vplScene* scene = openScene(context, HARD_ROOM);
    vplGeometry* geometry;
    vplPathStats stats[2];
    assert_int_equal(vplGeometry_Create(scene, &geometry), VPL_SUCCESS);
    double variance[2] = {0};
    for (int i = 0; i < 2; i++) {
        vplPathDef def = vplDefaultPathDef();
        def.lightVertices = i == 0 ? 1 : VPL_MOST_LIGHT_VERTICES;
        vplImage* images[2];
        for (int k = 0; k < 2; k++) {
            def.seed = (uint64_t)k;
            images[k] = traceWith(scene, geometry, &def, 256, &stats[i]);
        }
        variance[i] = squaredDifference(images[0], images[1]);
        vplImage_Destroy(images[0]);
        vplImage_Destroy(images[1]);
    }
    assert_true(stats[1].rays < 2 * stats[0].rays);
    assert_true(variance[1] < variance[0] / 5); // a twentieth to a fortieth was measured
    vplGeometry_Destroy(geometry);
    vplScene_Destroy(scene);
}

static const vplDecision* decisionOn(const vplPlan* plan, const char* name)
{
    for (int i = 0; i < plan->decisionCount; i++) {
        if (strcmp(plan->decisions[i].name, name) == 0) {
            return &plan->decisions[i];
        }
    }
    return NULL;
}

// Long light paths where a few hundred paths say that they pay, else one vertex; what is given stays.
TEST(PlansFollowLightAsFarAsTheSceneRequires, 2)
{
    static const struct {
        const char* scene;
        const char* words;
        int vertices;
        const char* why;
    } ROWS[] = {{HARD_ROOM, "", VPL_MAX_LIGHT_VERTICES,
                 "of reflected light is found at later vertices of light paths"},
                {HARD_ROOM, "--seed 77", VPL_MAX_LIGHT_VERTICES, "of reflected light is found"},
                {HARD_ROOM, "--light-vertices 3", 3, NULL},
                {HARD_ROOM, "--spp 1", 1, "there are few paths"},
                {HARD_ROOM, "--max-bounces 0", 1, "the picture shows no reflected light"},
                {HARD_ROOM, "--show direct", 1, "the picture shows no reflected light"},
                {ROOM, "", 1, "of reflected light is found"},
                {AREA_ROOM, "", 1, "of reflected light is found"}};
    for (size_t i = 0; i < sizeof ROWS / sizeof *ROWS; i++) {
        vplScene* scene = openScene(context, ROWS[i].scene);
        vplRenderOptions o = pathOptions(48, 64);
        char words[64];
        snprintf(words, sizeof words, "%s", ROWS[i].words);
        o.maxBounces = -1;
        if (words[0] != 0) {
            char* value = strchr(words, ' ');
            *value++ = 0;
            assert_int_equal(vplRenderOptions_Set(&o, words + 2, value), VPL_SUCCESS);
        }
        vplPlan* plan;
        assert_int_equal(vplPlan_Create(scene, &o, NULL, &plan), VPL_SUCCESS);
        assert_int_equal(plan->options.path.lightVertices, ROWS[i].vertices);
        const vplDecision* d = decisionOn(plan, "light-vertices");
        assert_true((d == NULL) == (ROWS[i].why == NULL));
        assert_true(d == NULL || strstr(d->why, ROWS[i].why) != NULL);
        vplPlan_Destroy(plan);
        vplScene_Destroy(scene);
    }
}

// The share is that of the light and not of the seed; it is 0 where no light is reflected.
TEST(TheShareOfLaterVerticesIsMeasured, 2)
{
    static const struct {
        const char* scene;
        double least, most;
    } ROWS[] = {{HARD_ROOM, 0.5, 0.75}, {"tests/data/hall.json", 0, 1}, {ROOM, 0.1, 0.25}};
    for (size_t i = 0; i < sizeof ROWS / sizeof *ROWS; i++) {
        vplScene* scene = openScene(context, ROWS[i].scene);
        vplGeometry* geometry;
        assert_int_equal(vplGeometry_Create(scene, &geometry), VPL_SUCCESS);
        vplPathDef def = vplDefaultPathDef();
        def.camera = vplScene_GetCamera(scene, 0);
        def.emitterCount = vplScene_GetEmitterCount(scene);
        def.emitters = vplScene_GetEmitter(scene, 0);
        def.width = 64;
        def.height = 36;
        double share[2] = {-1, -1}, dark = -1;
        for (int k = 0; k < 2; k++) {
            def.seed = (uint64_t)k;
            assert_int_equal(vplMeasureFurther(geometry, &def, &share[k]), VPL_SUCCESS);
        }
        assert_true(share[0] == share[1] && share[0] >= ROWS[i].least && share[0] <= ROWS[i].most);
        def.mostBounces = 0;
        assert_int_equal(vplMeasureFurther(geometry, &def, &dark), VPL_SUCCESS);
        assert_true(dark == 0);
        vplGeometry_Destroy(geometry);
        vplScene_Destroy(scene);
    }
}
