// SPDX-License-Identifier: MIT
// Tests of counts_totals.csv: steps, lights, rays, tests of objects and draw calls of 361 particle simulations. Six columns
// are not compared, because they show what other rules would give: misreading_N+floor(rho^2N)+.. leaves out floor(rho N)
// as the document's prose does, and total_dbl_exact, total_flt_exact, total_pow, total_iter and total_nest are plain floors
// of a binary rho, of pow, of repeated products and of floors of floors. counts.csv has the rule that is ours.
#include "scenes.h"

#include "math/vec.h"

// Rows of up to QUICK lights are simulated in 0.2 s, those of up to CAST in 4 s. Rays of the other 25 are not cast: 20 would
// take half a minute, and 5 are refused. Their rays and tests follow from the lights, which are counted in all rows.
enum { ROWS = 361, QUICK_ROWS = 285, CAST_ROWS = 336, REFUSED_ROWS = 5 };
static const double QUICK = 20000, CAST = 1e6;

static vplParticlePass passOf(const Table* t, int row)
{
    return (vplParticlePass){0, (int)number(t, row, "N"), number(t, row, "rho")};
}

// Counts the lights of more than VPL_MAX_LIGHTS in 64 passes, which add up to one walk.
static vplStepTotals countInPasses(vplContext* context, const vplParticlePass* whole)
{
    vplStepTotals sum = {0, 0};
    for (int64_t i = 0; i < 64; i++) {
        const int64_t first = i * whole->count / 64, end = (i + 1) * whole->count / 64;
        const vplParticlePass pass = {first, (int)(end - first), whole->reflectivity};
        vplStepTotals totals;
        assert_int_equal(vplCountParticles(context, &pass, NULL, 0, &totals), VPL_SUCCESS);
        sum.stepCount = totals.stepCount; // the last pass goes as far as the walk
        sum.lightCount += totals.lightCount;
    }
    return sum;
}

// X034. Rows that are more lights than a simulation may have are refused, and counted by passes.
TEST(EveryTotalOfTheTable, 1)
{
    Table t = loadTable("counts_totals.csv");
    int refused = 0;
    for (int row = 0; row < t.rows; row++) {
        const vplParticlePass pass = passOf(&t, row);
        const double total = number(&t, row, "total_sum_k>=0");
        vplStepTotals totals;
        const vplResult result = vplCountParticles(context, &pass, NULL, 0, &totals);
        if (total > VPL_MAX_LIGHTS) {
            assert_int_equal(result, VPL_LIMIT);
            totals = countInPasses(context, &pass);
            refused++;
        } else {
            assert_int_equal(result, VPL_SUCCESS);
        }
        assert_int_equal(totals.stepCount, (int)number(&t, row, "steps"));
        assert_int_equal(totals.lightCount, (int64_t)total);
        assert_int_equal(totals.lightCount - pass.count, (int64_t)number(&t, row, "keller_rays_sum_k>=1"));
        assert_int_equal(7 * totals.lightCount, (int64_t)number(&t, row, "ray_object_tests_B7"));
        const double bound = 7 * pass.count / (1 - pass.reflectivity);
        assertNear(bound, number(&t, row, "bound_BN/(1-rho)_B7"), 1e-12 * bound, "bound", row);
        assert_true(7 * (double)totals.lightCount <= bound);
    }
    assert_int_equal(t.rows, ROWS);
    assert_int_equal(refused, REFUSED_ROWS);
    freeTable(&t);
}

// The cube [-1, 1]^3 with a light in its centre, and a quad far outside as the seventh object.
static vplScene* sevenObjects(vplContext* context)
{
    vplScene* scene = closedCubeScene(context, 0.5f, 0);
    addThing(scene, VPL_OBJECT_QUAD, 0, vplVec(50, 0, 0), 0, 0, vplVec(1, 1, 1));
    addEmitter(scene, VPL_EMITTER_POINT, vplVec(0, 0, 0), vplVec(0, -1, 0), 1);
    aim(scene, vplVec(0.5f, 0.5f, 0.5f), vplVec(0, -1, 0));
    return scene;
}

static void castRow(const vplGeometry* g, const Table* t, int row, vplParticleStart start)
{
    const bool keller = start == VPL_START_EMITTER;
    const vplEmitterDef emitter = vplDefaultEmitterDef();
    vplParticleDef def = vplDefaultParticleDef();
    def.particleCount = (int)number(t, row, "N");
    def.reflectivity = number(t, row, "rho");
    def.start = start;
    vplLightSet* set = NULL;
    assert_int_equal(vplSimulateParticles(g, &emitter, 1, &def, &set), VPL_SUCCESS);
    const int64_t total = (int64_t)number(t, row, "total_sum_k>=0"),
                  rays = keller ? (int64_t)number(t, row, "keller_rays_sum_k>=1") : total,
                  tests = keller ? 7 * rays : (int64_t)number(t, row, "ray_object_tests_B7");
    assert_int_equal(set->stepCount, (int)number(t, row, "steps"));
    assert_int_equal(set->lightCount, total);
    assert_int_equal(set->escaped, 0);
    assert_int_equal(set->rays, rays);
    assert_int_equal(set->rayObjectTests, tests);
    vplLightSet_Destroy(set);
}

// Simulates the rows of more than `above` and up to `most` lights by both walks; returns how many they are.
static int castRows(vplContext* context, double above, double most)
{
    Table t = loadTable("counts_totals.csv");
    vplScene* scene = sevenObjects(context);
    vplGeometry* g;
    assert_int_equal(vplGeometry_Create(scene, &g), VPL_SUCCESS);
    int cast = 0;
    for (int row = 0; row < t.rows; row++) {
        const double total = number(&t, row, "total_sum_k>=0");
        if (total > above && total <= most) {
            castRow(g, &t, row, VPL_START_FIRST_HIT);
            castRow(g, &t, row, VPL_START_EMITTER);
            cast++;
        }
    }
    vplGeometry_Destroy(g);
    vplScene_Destroy(scene);
    freeTable(&t);
    return cast;
}

TEST(RaysOfTheTotalsAreThoseOfTheTable, 1)
{
    assert_int_equal(castRows(context, 0, QUICK), QUICK_ROWS);
}

TEST(RaysOfLargeTotalsAreThoseOfTheTable, 2, SLOW)
{
    assert_int_equal(castRows(context, QUICK, CAST), CAST_ROWS - QUICK_ROWS);
}

// (7 + M) B draw calls for M lights and B = 7 objects, one pass per light as printed. Plans know them without rendering.
// DrawCallsAreThoseOfTheDocument in test_render.c renders some.
TEST(DrawCallsOfTheTotalsAreThoseOfTheTable, 1)
{
    Table t = loadTable("counts_totals.csv");
    vplScene* scene = sevenObjects(context);
    int planned = 0;
    for (int row = 0; row < t.rows; row++) {
        vplRenderOptions o = plainOptions();
        o.output.width = o.output.height = 8;
        o.pipeline.kind = VPL_ACCUMULATE_MULTIPASS;
        o.particles.count = (int)number(&t, row, "N");
        o.particles.reflectivity = number(&t, row, "rho");
        vplPlan* plan = NULL;
        const vplResult result = vplPlan_Create(scene, &o, NULL, &plan);
        if (number(&t, row, "total_sum_k>=0") > VPL_MAX_LIGHTS) {
            assert_int_equal(result, VPL_LIMIT); // no picture, so no draws
            continue;
        }
        assert_int_equal(result, VPL_SUCCESS);
        assert_int_equal(plan->virtualLights, (int64_t)number(&t, row, "total_sum_k>=0"));
        assert_int_equal(plan->stepCount, (int)number(&t, row, "steps"));
        assert_int_equal(plan->drawCalls, (int64_t)number(&t, row, "draw_calls_(7+M)B_B7"));
        vplPlan_Destroy(plan);
        planned++;
    }
    assert_int_equal(planned, ROWS - REFUSED_ROWS);
    vplScene_Destroy(scene);
    freeTable(&t);
}
