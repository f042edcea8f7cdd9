// SPDX-License-Identifier: MIT
// Tests of the light tree and of the bounds on its clusters' light.
#include "tree_lights.h"

#include "shading/light_block.h"

// ---- the tree

static void checkContents(const vplLightTree* tree, vplCluster c)
{
    const vplLightNode* node = &tree->nodes[c.node];
    double rgb[3] = {0};
    for (int i = c.first; i < c.first + c.count; i++) {
        const vplShadeLight* l = &tree->lights[i].light;
        const float p[3] = {l->px, l->py, l->pz};
        const double dot = (double)node->axis[0] * (double)l->nx + (double)node->axis[1] * (double)l->ny +
                           (double)node->axis[2] * (double)l->nz;
        for (int k = 0; k < 3; k++) {
            assert_true(p[k] >= node->low[k] && p[k] <= node->high[k]);
        }
        assert_true(dot >= (double)node->cosine);
        rgb[0] += (double)l->r;
        rgb[1] += (double)l->g;
        rgb[2] += (double)l->b;
    }
    for (int k = 0; k < 3; k++) {
        assertNear((double)node->rgb[k], rgb[k], 1e-5 * rgb[k], "rgb", c.node);
    }
    assertNear((double)node->intensity, rgb[0] + rgb[1] + rgb[2], 1e-5 * (rgb[0] + rgb[1] + rgb[2]), "sum",
               c.node);
}

// Checks a subtree and returns its depth.
static int checkTree(const vplLightTree* tree, vplCluster c)
{
    if (c.count == 1) {
        return 0;
    }
    checkContents(tree, c);
    vplCluster halves[2];
    vplLightTree_Halves(tree, c, halves);
    assert_true(halves[0].count > 0 && halves[1].count > 0);
    const int own = vplLightTree_Representative(tree, c);
    assert_true(own == vplLightTree_Representative(tree, halves[0]) ||
                own == vplLightTree_Representative(tree, halves[1]));
    const vplShadeLight* light = &tree->lights[own].light;
    assert_true(light->r + light->g + light->b > 0 || tree->nodes[c.node].intensity == 0);
    const int a = checkTree(tree, halves[0]), b = checkTree(tree, halves[1]);
    return 1 + (a > b ? a : b);
}

TEST(EveryClusterHoldsItsLights, 2)
{
    static const int counts[] = {1, 2, 3, 17, 400, 5000};
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        for (int k = 0; k < 6; k++) {
            const int count = counts[k];
            vplShadeLight* lights = rollTreeLights((Kind)kind, count, (uint64_t)kind);
            vplLightTree* tree = plant(context, lights, count);
            assert_in_range(checkTree(tree, vplLightTree_Root(tree)), 0, 64 + 13);
            char* seen = calloc((size_t)count, 1);
            for (int i = 0; i < count; i++) {
                const vplTreeLight* l = &tree->lights[i];
                assert_memory_equal(&l->light, &lights[l->index], sizeof l->light);
                assert_int_equal(seen[l->index]++, 0);
            }
            free(seen);
            vplLightTree_Destroy(tree);
            free(lights);
        }
    }
}

static uint64_t hashTree(vplContext* context, int count)
{
    vplShadeLight* lights = rollTreeLights(KIND_WALLS, count, 5);
    vplLightTree* tree = plant(context, lights, count);
    const uint64_t hash = vplHashWords(
        vplHashWords(0, (const uint32_t*)(const void*)tree->nodes,
                     (size_t)(count - 1) * sizeof *tree->nodes / sizeof(uint32_t)),
        (const uint32_t*)(const void*)tree->lights, (size_t)count * sizeof *tree->lights / sizeof(uint32_t));
    vplLightTree_Destroy(tree);
    free(lights);
    closeTestContext(context);
    return hash;
}

TEST_ALONE(TreesAreTheSameForAnyNumberOfWorkers)
{
    enum { COUNT = 50000 };
    const uint64_t wanted = hashTree(openTestContext(1), COUNT);
    assert_true(hashTree(openTestContext(2), COUNT) == wanted);
    assert_true(hashTree(openTestContext(3), COUNT) == wanted);
    assert_true(hashTree(openTestContext(7), COUNT) == wanted);
}

// Over many trees, the mean position of the root's representative is the mean of all positions weighted by
// intensity.
TEST(RepresentativesAreDrawnByIntensity, 1)
{
    enum { COUNT = 64, TREES = 4000 };
    int bright = 0;
    for (int t = 0; t < TREES; t++) {
        vplShadeLight* lights = rollTreeLights(KIND_CLOUD, COUNT, 100 + (uint64_t)t);
        for (int i = 0; i < COUNT; i++) {
            lights[i].r = lights[i].g = lights[i].b = i < 16 ? 3 : 1;
        }
        vplLightTree* tree = plant(context, lights, COUNT);
        bright += tree->lights[tree->nodes[0].representative].index < 16;
        vplLightTree_Destroy(tree);
        free(lights);
    }
    // Half of the light is theirs; four standard deviations are 0.032.
    assertNear((double)bright / TREES, 0.5, 0.032, "share", 0);
}

// ---- the bound

// Makes points that are hard to bound: on lights, near them, inside and outside the box, and with tangential
// normals.
static vplSurface rollPoints(Dice* dice, const vplLightTree* tree, vplCluster c)
{
    vplSurface s;
    for (int l = 0; l < VPL_LANES; l++) {
        const vplShadeLight* light =
            &tree->lights[c.first + (int)roll(dice, 0, (float)c.count - 0.001f)].light;
        const float reach = ldexpf(1, (int)roll(dice, -12, 6));
        vplVec3 p = l % 8 == 0 ? vplVec(0, 0, 0) : rollVec(dice, reach), n = rollUnit(dice);
        p = vplAdd(p, vplVec(light->px, light->py, light->pz));
        n = l % 5 == 1 ? vplVec(light->nx, light->ny, light->nz) : n;
        n = l % 5 == 2 ? vplVec(-light->nx, -light->ny, -light->nz) : n;
        n = l % 5 == 3 ? vplVec(0, 0, l % 2 ? 1.0f : -1.0f) : n;
        s.px[l] = p.x, s.py[l] = p.y, s.pz[l] = p.z;
        s.nx[l] = n.x, s.ny[l] = n.y, s.nz[l] = n.z;
    }
    return s;
}

static float inverseSquare(float distance)
{
    return distance > 0 ? 1 / (distance * distance) : INFINITY;
}

// Asserts that no light of the cluster exceeds the bound, by not even one bit.
static void checkBound(vplContext* context, const vplLightTree* tree, vplCluster c, const vplSurface* s,
                       vplLighting lighting, float minDistance)
{
    float bound[VPL_LANES];
    vplGetShadingKernels(context->isa, lighting)
        ->clusterBound(s, &tree->nodes[c.node], inverseSquare(minDistance), bound);
    for (int i = c.first; i < c.first + c.count; i++) {
        vplShadeLight light = tree->lights[i].light;
        light.r = light.g = light.b = 1;
        float part[3][VPL_LANES] = {{0}};
        vplAccumulateLights(context, (vplLightFormula){lighting, minDistance}, s, &light, 1, part);
        for (int l = 0; l < VPL_LANES; l++) {
            if (!(part[0][l] <= bound[l])) {
                fail_msg("cluster %d of %d lights, light %d, lane %d: %.9g is more than %.9g", c.node,
                         c.count, i, l, (double)part[0][l], (double)bound[l]);
            }
        }
    }
}

TEST(NoLightGivesMoreThanTheBoundOfItsCluster, 1)
{
    enum { COUNT = 300, ROUNDS = 400 };
    static const float distances[] = {0, 1e-6f, 0.3f, 1e3f};
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        vplShadeLight* lights = rollTreeLights((Kind)kind, COUNT, 7);
        vplLightTree* tree = plant(context, lights, COUNT);
        Dice dice = {(uint64_t)kind, 0};
        for (int round = 0; round < ROUNDS; round++) {
            vplCluster c = vplLightTree_Root(tree);
            for (int steps = (int)roll(&dice, 0, 9); steps > 0 && c.count > 2; steps--) {
                vplCluster halves[2];
                vplLightTree_Halves(tree, c, halves);
                c = halves[roll(&dice, 0, 1) < 0.5f ? 0 : 1].count > 1 ? halves[0] : halves[1];
                c = c.count > 1 ? c : halves[1].count > 1 ? halves[1] : halves[0];
            }
            if (c.count > 1) {
                const vplSurface s = rollPoints(&dice, tree, c);
                checkBound(context, tree, c, &s, VPL_LIGHTING_PHYSICAL, distances[round % 4]);
                checkBound(context, tree, c, &s, VPL_LIGHTING_DOCUMENTED, 0);
            }
        }
        vplLightTree_Destroy(tree);
        free(lights);
    }
}

// Two lights are 1 cm apart, seen from a metre or more: the bound is at most 8 % above their light, and 0 for
// points behind the lights or with the lights behind them.
TEST(BoundsOfSmallClustersAreTight, 1)
{
    vplShadeLight lights[2] = {{0, 0, 0, 0, 1, 0, 1, 1, 1}, {0.01f, 0, 0, 0, 1, 0, 1, 1, 1}};
    vplLightTree* tree = plant(context, lights, 2);
    Dice dice = {3, 0};
    int lit = 0, dark = 0;
    for (int round = 0; round < 200; round++) {
        vplSurface s;
        for (int l = 0; l < VPL_LANES; l++) {
            const vplVec3 way = rollUnit(&dice), p = vplScale(roll(&dice, 1, 5), way), n = rollUnit(&dice);
            s.px[l] = p.x, s.py[l] = p.y, s.pz[l] = p.z;
            s.nx[l] = n.x, s.ny[l] = n.y, s.nz[l] = n.z;
        }
        float bound[VPL_LANES], part[3][VPL_LANES] = {{0}};
        vplGetShadingKernels(context->isa, VPL_LIGHTING_PHYSICAL)
            ->clusterBound(&s, &tree->nodes[0], INFINITY, bound);
        vplAccumulateLights(context, (vplLightFormula){VPL_LIGHTING_PHYSICAL, 0}, &s, lights, 1, part);
        for (int l = 0; l < VPL_LANES; l++) {
            const float d2 = s.px[l] * s.px[l] + s.py[l] * s.py[l] + s.pz[l] * s.pz[l];
            const float most = part[0][l] * d2; // the product of the two cosines
            lit += most > 0.3f;
            assert_true(!(most > 0.3f) || bound[l] <= 1.08f * part[0][l]);
            const float here = -(s.nx[l] * s.px[l] + s.ny[l] * s.py[l] + s.nz[l] * s.pz[l]);
            const bool behind = s.py[l] < -0.01f || here < -0.02f;
            dark += behind;
            assert_true(!behind || bound[l] == 0);
        }
    }
    assert_true(lit > 100 && dark > 100);
    vplLightTree_Destroy(tree);
}

TEST_ALONE(InstructionSetsBoundAlike)
{
    vplContext* context = openTestContext(1);
    vplShadeLight* lights = rollTreeLights(KIND_CLOUD, 50, 9);
    vplLightTree* tree = plant(context, lights, 50);
    Dice dice = {11, 0};
    for (int round = 0; round < 300; round++) {
        const vplSurface s = rollPoints(&dice, tree, vplLightTree_Root(tree));
        const vplLightNode* node = &tree->nodes[(int)roll(&dice, 0, 48.9f)];
        for (int isa = VPL_ISA_SCALAR; isa < VPL_ISA_COUNT; isa++) {
            vplContext* other = openIsaContext(1, (vplIsa)isa);
            for (int lighting = 0; lighting < 2 && other != NULL; lighting++) {
                float a[VPL_LANES], b[VPL_LANES];
                vplGetShadingKernels(VPL_ISA_SCALAR, (vplLighting)lighting)->clusterBound(&s, node, 25, a);
                vplGetShadingKernels((vplIsa)isa, (vplLighting)lighting)->clusterBound(&s, node, 25, b);
                assert_memory_equal(a, b, sizeof a);
            }
            if (other != NULL) {
                closeTestContext(other);
            }
        }
    }
    vplLightTree_Destroy(tree);
    free(lights);
    closeTestContext(context);
}
