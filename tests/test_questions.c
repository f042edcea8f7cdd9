// SPDX-License-Identifier: MIT
// Tests that long work asks whether it goes on, by the work between two questions and not by the clock.
#include "test.h"

#include "lights/clusters.h"

// Counts questions, and says no at one of them.
typedef struct Questions {
    int count, refuseAt;
} Questions;

static bool answer(void* user, double fraction)
{
    Questions* q = user;
    assert_true(fraction >= 0 && fraction <= 1);
    return ++q->count != q->refuseAt;
}

// ---- long paths

// A closed room that reflects all but a millionth.
static vplScene* openWhiteRoom(vplContext* context)
{
    static const char text[] =
        "{ \"camera\": { \"eye\": [0, 0, 0.4], \"target\": [0, 0, 0] },"
        " \"materials\": { \"white\": { \"diffuse\": [0.999999, 0.999999, 0.999999] } },"
        " \"objects\": [{ \"type\": \"box\", \"material\": \"white\" }],"
        " \"lights\": [{ \"type\": \"point\", \"position\": [0.1, 0.2, 0], "
        "\"intensity\": [1, 1, 1] }] }";
    const vplMemoryFile file = {"white.json", text, sizeof text - 1};
    const vplModelSceneDef def = vplDefaultModelSceneDef();
    vplScene* scene = NULL;
    assert_int_equal(vplScene_LoadMemory(context, &file, 1, &def, &scene), VPL_SUCCESS);
    return scene;
}

// Each bounce has a ray along the path, one to the lamp and one to the light path.
TEST(PathsInAWhiteRoomAskEvery512Bounces, 1)
{
    enum { BOUNCES = 10000, EACH = 3 * 512 };
    vplScene* scene = openWhiteRoom(context);
    vplRenderOptions o = plainOptions();
    vplRenderStats stats;
    Questions q = {0, 0};
    o.method = VPL_METHOD_PATH;
    o.output.width = o.output.height = 2;
    o.path.samples = 1;
    o.maxBounces = BOUNCES;
    o.progress = answer;
    o.progressUser = &q;
    vplImage_Destroy(renderScene(scene, &o, &stats));
    assert_true(stats.rays > 4 * BOUNCES); // paths are as long as they may be
    if (q.count < stats.rays / EACH) {
        fail_msg("%d questions in %lld rays", q.count, (long long)stats.rays);
    }
    const int last = q.count;
    for (int at = 1; at <= last; at += 1 + at / 4) {
        vplImage* image = NULL;
        q = (Questions){0, at};
        assert_int_equal(vplRender(scene, &o, &image, NULL), VPL_CANCELLED);
        assert_int_equal(q.count, at); // nothing that asks was begun after the answer
    }
    vplScene_Destroy(scene);
}

// ---- clusters of lights

// Finds clusters while `q` is asked.
static vplResult findClusters(vplContext* context, const vplLightSet* set, int count, Questions* q,
                              int* iterationsOut)
{
    vplClusterDef def = vplDefaultClusterDef();
    vplLightClusters* clusters = NULL;
    def.count = count;
    vplContext_SetProgress(context, answer, q);
    const vplResult result = vplFindClusters(set, &def, &clusters);
    vplContext_SetProgress(context, NULL, NULL);
    *iterationsOut = clusters != NULL ? clusters->iterations : 0;
    vplLightClusters_Destroy(clusters);
    return result;
}

// Lights on the floor of a room.
static vplLightSet spreadLights(vplContext* context, vplVirtualLight* lights, int count)
{
    for (int i = 0; i < count; i++) {
        const double x = uniformAt(1, 2 * (uint64_t)i), y = uniformAt(1, 2 * (uint64_t)i + 1);
        lights[i] = (vplVirtualLight){.position = {(float)x, 0, (float)y}, .normal = {0, 1, 0}, .weight = 1};
    }
    return (vplLightSet){.lights = lights, .lightCount = count, .particleCount = count, .context = context};
}

// Counts the questions of a clustering that nothing cancels and that takes some iterations.
static int countQuestions(vplContext* context, const vplLightSet* set, int clusters, int* iterationsOut)
{
    Questions q = {0, 0};
    assert_int_equal(findClusters(context, set, clusters, &q, iterationsOut), VPL_SUCCESS);
    assert_true(*iterationsOut > 4);
    return q.count;
}

// Each cluster that is placed is compared with all lights, and each search compares all lights with clusters that moved.
TEST(ClusteringOfManyLightsAsksForEachClusterAndEachTask, 1)
{
    enum { LIGHTS = 5000, CLUSTERS = 100, TASKS = (LIGHTS + VPL_CLUSTER_TASK - 1) / VPL_CLUSTER_TASK };
    static vplVirtualLight lights[LIGHTS];
    const vplLightSet set = spreadLights(context, lights, LIGHTS);
    int iterations;
    const int last = countQuestions(context, &set, CLUSTERS, &iterations);
    assert_true(last >= CLUSTERS + TASKS * (iterations + 1));
    for (int at = 1; at <= last; at += 1 + at / 4) {
        Questions q = {0, at};
        assert_int_equal(findClusters(context, &set, CLUSTERS, &q, &iterations), VPL_CANCELLED);
        assert_int_equal(q.count, at);
    }
}

// So few pairs of a light and a cluster that each search is one task.
TEST(ClusteringOfFewLightsAsksInEachIteration, 1)
{
    enum { LIGHTS = 300, CLUSTERS = 20 };
    static vplVirtualLight lights[LIGHTS];
    const vplLightSet set = spreadLights(context, lights, LIGHTS);
    int iterations;
    const int count = countQuestions(context, &set, CLUSTERS, &iterations);
    assert_true(count >= CLUSTERS + iterations);
}
