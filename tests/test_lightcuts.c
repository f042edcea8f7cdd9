// SPDX-License-Identifier: MIT
// The light tree, the bound of what its clusters can give, and pictures by cuts through it.
#include "shapes.h"

#include "base/hash.h"
#include "lights/light_tree.h"
#include "math/vec.h"
#include "shading/shading.h"

#include <stdlib.h>

// ---- lights that are hard to put into a tree

typedef enum Kind {
    KIND_CLOUD,   // anywhere, facing anywhere
    KIND_WALLS,   // on the inside of a cube
    KIND_FAR,     // in a small box 1000 km from the origin
    KIND_SERIES,  // 2^-i m from a corner: each half holds all but one
    KIND_POINT,   // all at one place
    KIND_SAME,    // and all facing one way
    KIND_HUGE,    // up to 1e17 m apart
    KIND_UNEQUAL, // a few are brighter by 1e12, some are black
    KIND_BACK,    // pairs of opposite normals
    KIND_COUNT
} Kind;

static vplShadeLight rollLight(Dice* dice, Kind kind, int i)
{
    vplVec3 p = rollVec(dice, 2), n = rollUnit(dice);
    if (kind == KIND_WALLS) {
        const int axis = (int)roll(dice, 0, 2.999f);
        const float side = roll(dice, -1, 1) > 0 ? 1.0f : -1.0f;
        float at[3] = {p.x, p.y, p.z}, to[3] = {0, 0, 0};
        at[axis] = 2 * side;
        to[axis] = -side;
        p = vplVec(at[0], at[1], at[2]);
        n = vplVec(to[0], to[1], to[2]);
    }
    p = kind == KIND_FAR ? vplAdd(vplScale(0.01f, p), vplVec(1e6f, -1e6f, 1e6f)) : p;
    p = kind == KIND_SERIES ? vplScale(ldexpf(1, -(i % 140)), vplVec(1, 1, 1)) : p;
    p = kind == KIND_POINT || kind == KIND_SAME ? vplVec(0.3f, 0.7f, 0.1f) : p;
    p = kind == KIND_HUGE ? vplScale(1e17f, p) : p;
    n = kind == KIND_SAME ? vplVec(0, 1, 0) : n;
    n = kind == KIND_BACK ? vplVec(0, i % 2 ? 1.0f : -1.0f, 0) : n;
    float r = roll(dice, 0, 1), g = roll(dice, 0, 1), b = roll(dice, 0, 1);
    if (kind == KIND_UNEQUAL) {
        const float scale = i % 100 == 0 ? 1e12f : i % 3 == 0 ? 0 : 1;
        r *= scale, g *= scale, b *= scale;
    }
    return (vplShadeLight){p.x, p.y, p.z, n.x, n.y, n.z, r, g, b};
}

static vplShadeLight* rollLights(Kind kind, int count, uint64_t seed)
{
    Dice dice = {seed, 0};
    vplShadeLight* lights = malloc((size_t)count * sizeof *lights);
    for (int i = 0; i < count; i++) {
        lights[i] = rollLight(&dice, kind, i);
    }
    return lights;
}

static vplLightTree* plant(vplContext* context, const vplShadeLight* lights, int count)
{
    vplLightTree* tree = NULL;
    assert_int_equal(vplLightTree_Create(context, lights, count, NULL, NULL, &tree), VPL_SUCCESS);
    return tree;
}

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

// Returns how deep it goes.
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

static void EveryClusterHoldsItsLights(void** state)
{
    (void)state;
    vplContext* context = openTestContext(2);
    static const int counts[] = {1, 2, 3, 17, 400, 5000};
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        for (int k = 0; k < 6; k++) {
            const int count = counts[k];
            vplShadeLight* lights = rollLights((Kind)kind, count, (uint64_t)kind);
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
    closeTestContext(context);
}

static uint64_t hashTree(vplContext* context, int count)
{
    vplShadeLight* lights = rollLights(KIND_WALLS, count, 5);
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

static void TreesAreTheSameForAnyNumberOfWorkers(void** state)
{
    (void)state;
    enum { COUNT = 50000 };
    const uint64_t wanted = hashTree(openTestContext(1), COUNT);
    assert_true(hashTree(openTestContext(2), COUNT) == wanted);
    assert_true(hashTree(openTestContext(3), COUNT) == wanted);
    assert_true(hashTree(openTestContext(7), COUNT) == wanted);
}

// Over many trees, the
// place of the root's representative is the mean of all places by intensity.
static void RepresentativesAreDrawnByIntensity(void** state)
{
    (void)state;
    enum { COUNT = 64, TREES = 4000 };
    vplContext* context = openTestContext(1);
    int bright = 0;
    for (int t = 0; t < TREES; t++) {
        vplShadeLight* lights = rollLights(KIND_CLOUD, COUNT, 100 + (uint64_t)t);
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
    closeTestContext(context);
}

// ---- the bound

// Points that are hard to bound: on lights, near them, within and beyond the box, and facing along it.
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

// No light of the cluster gives more than the bound, not by one bit.
static void checkBound(vplContext* context, const vplLightTree* tree, vplCluster c, const vplSurface* s,
                       vplLighting lighting, float minDistance)
{
    float bound[VPL_LANES];
    vplGetShadingKernels(context->isa, lighting)
        .clusterBound(s, &tree->nodes[c.node], inverseSquare(minDistance), bound);
    for (int i = c.first; i < c.first + c.count; i++) {
        vplShadeLight light = tree->lights[i].light;
        light.r = light.g = light.b = 1;
        float part[3][VPL_LANES] = {{0}};
        vplAccumulateLights(context, lighting, minDistance, s, &light, 1, part);
        for (int l = 0; l < VPL_LANES; l++) {
            if (!(part[0][l] <= bound[l])) {
                fail_msg("cluster %d of %d lights, light %d, lane %d: %.9g is more than %.9g", c.node,
                         c.count, i, l, (double)part[0][l], (double)bound[l]);
            }
        }
    }
}

static void NoLightGivesMoreThanTheBoundOfItsCluster(void** state)
{
    (void)state;
    enum { COUNT = 300, ROUNDS = 400 };
    vplContext* context = openTestContext(1);
    static const float distances[] = {0, 1e-6f, 0.3f, 1e3f};
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        vplShadeLight* lights = rollLights((Kind)kind, COUNT, 7);
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
    closeTestContext(context);
}

// Two lights 1 cm apart, seen from a metre and more: the bound is at most 8 % above what they give, and 0 behind
// them and where they are behind.
static void BoundsOfSmallClustersAreTight(void** state)
{
    (void)state;
    vplContext* context = openTestContext(1);
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
            .clusterBound(&s, &tree->nodes[0], INFINITY, bound);
        vplAccumulateLights(context, VPL_LIGHTING_PHYSICAL, 0, &s, lights, 1, part);
        for (int l = 0; l < VPL_LANES; l++) {
            const float d2 = s.px[l] * s.px[l] + s.py[l] * s.py[l] + s.pz[l] * s.pz[l];
            const float most = part[0][l] * d2; // cos cos
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
    closeTestContext(context);
}

static void InstructionSetsBoundAlike(void** state)
{
    (void)state;
    vplContext* context = openTestContext(1);
    vplShadeLight* lights = rollLights(KIND_CLOUD, 50, 9);
    vplLightTree* tree = plant(context, lights, 50);
    Dice dice = {11, 0};
    for (int round = 0; round < 300; round++) {
        const vplSurface s = rollPoints(&dice, tree, vplLightTree_Root(tree));
        const vplLightNode* node = &tree->nodes[(int)roll(&dice, 0, 48.9f)];
        for (int isa = VPL_ISA_SCALAR; isa < VPL_ISA_COUNT; isa++) {
            vplContext* other = openIsaContext(1, (vplIsa)isa);
            for (int lighting = 0; lighting < 2 && other != NULL; lighting++) {
                float a[VPL_LANES], b[VPL_LANES];
                vplGetShadingKernels(VPL_ISA_SCALAR, (vplLighting)lighting).clusterBound(&s, node, 25, a);
                vplGetShadingKernels((vplIsa)isa, (vplLighting)lighting).clusterBound(&s, node, 25, b);
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

// ---- clusters with shadows

// 16 points on triangles of the geometry, facing either way.
static void rollSeen(Dice* dice, const vplGeometry* g, vplSurface* s, vplPoints* points)
{
    for (int l = 0; l < VPL_LANES; l++) {
        const int t = (int)roll(dice, 0, (float)g->triangleCount - 0.01f);
        const vplVec3* corner[3];
        const int object = g->owners[t];
        for (int k = 0; k < 3; k++) {
            corner[k] = &g->positions[g->objects[object].firstVertex + g->indices[3 * t + k]];
        }
        float u = roll(dice, 0, 1), v = roll(dice, 0, 1);
        v = u + v > 1 ? 1 - v : v;
        u = u + v > 1 ? 1 - u : u;
        const vplVec3 p = vplAdd(*corner[0], vplAdd(vplScale(u, vplSub(*corner[1], *corner[0])),
                                                    vplScale(v, vplSub(*corner[2], *corner[0]))));
        const vplVec3 n = roll(dice, 0, 1) < 0.5f ? g->normals[t] : vplNegate(g->normals[t]);
        s->px[l] = p.x, s->py[l] = p.y, s->pz[l] = p.z;
        s->nx[l] = n.x, s->ny[l] = n.y, s->nz[l] = n.z;
        points->triangle[l] = t;
    }
    points->surface = points->plane = s;
}

// What a cluster's lights give, what its representative gives for them, and its bound: r + g + b of a lane.
typedef struct Judged {
    double all[VPL_LANES], one[VPL_LANES], bound[VPL_LANES];
} Judged;

static void judge(const vplShading* s, const vplLightTree* tree, vplCluster c, const vplPoints* points,
                  Judged* j)
{
    const vplLightNode* node = &tree->nodes[c.node];
    vplRayStarts starts;
    vplFindRayStarts(s, points, &starts);
    memset(j, 0, sizeof *j);
    float bound[VPL_LANES];
    s->kernels.clusterBound(points->surface, node, s->lights.inverseClamp, bound);
    for (int i = c.first; i < c.first + c.count; i++) {
        const vplShadeLight* light = &tree->lights[i].light;
        vplReceived received;
        int64_t rays = 0;
        const vplReceiver receiver = {s, points, &starts, &rays};
        if (!vplReceiveLight(&receiver, light, NULL, s->lights.inverseClamp, &received)) {
            continue;
        }
        const double scale = (double)node->intensity / (double)(light->r + light->g + light->b);
        for (int l = 0; l < VPL_LANES; l++) {
            const double given = (double)received.visible[l] *
                                 (double)(received.open[0][l] + received.open[1][l] + received.open[2][l]);
            j->all[l] += given;
            j->one[l] += i == node->representative ? scale * given : 0;
        }
    }
    for (int l = 0; l < VPL_LANES; l++) {
        j->bound[l] = (double)node->intensity * (double)bound[l];
    }
}

static void RepresentativesErrByLessThanTheBoundAlsoInShadow(void** state)
{
    (void)state;
    enum { COUNT = 600, ROUNDS = 150 };
    vplContext* context = openTestContext(2);
    vplScene* scene = loadScene(context, "room.json");
    vplGeometry* g;
    assert_int_equal(vplGeometry_Create(scene, &g), VPL_SUCCESS);
    assert_int_equal(vplGeometry_PrepareRays(g), VPL_SUCCESS);
    Dice dice = {21, 0};
    double worst = 0;
    for (int kind = 0; kind < KIND_FAR; kind++) {
        vplShadeLight* lights = rollLights((Kind)kind, COUNT, 3);
        vplLightTree* tree = plant(context, lights, COUNT);
        const vplShading s = {.geometry = g,
                              .kernels = vplGetShadingKernels(context->isa, VPL_LIGHTING_PHYSICAL),
                              .lights = {.inverseClamp = 1 / 0.04f}};
        for (int round = 0; round < ROUNDS; round++) {
            vplSurface surface;
            vplPoints points;
            rollSeen(&dice, g, &surface, &points);
            vplCluster c = vplLightTree_Root(tree), halves[2];
            for (int steps = round % 16; steps > 0 && c.count > 2; steps--) {
                vplLightTree_Halves(tree, c, halves);
                c = halves[halves[0].count > halves[1].count ? 0 : 1];
            }
            Judged j;
            judge(&s, tree, c, &points, &j);
            for (int l = 0; l < VPL_LANES; l++) {
                // 1e-5: rounding of the sum of 600 lights.
                assert_true(fabs(j.one[l] - j.all[l]) <= j.bound[l] + 1e-5 * j.all[l]);
                const double share = j.bound[l] > 0 ? fabs(j.one[l] - j.all[l]) / j.bound[l] : 0;
                worst = share > worst ? share : worst;
            }
        }
        vplLightTree_Destroy(tree);
        free(lights);
    }
    assert_true(worst > 0.25); // the bound is worth something
    vplGeometry_Destroy(g);
    vplScene_Destroy(scene);
    closeTestContext(context);
}

// ---- pictures

static vplScene* openScene(vplContext* context, const char* path)
{
    vplScene* scene = NULL;
    assert_int_equal(vplScene_Load(context, path, &scene), VPL_SUCCESS);
    return scene;
}

static const char* const SCENES[] = {"examples/scenes/room.json", "examples/scenes/room-area.json"};

static vplRenderOptions optionsOf(int particles, vplLightShadows shadows)
{
    vplRenderOptions o = vplDefaultRenderOptions();
    o.output.width = 68;
    o.output.height = 51;
    o.particles.count = particles;
    o.particles.sampler = VPL_SAMPLER_HALTON;
    o.lights.shadows = shadows;
    o.shadow.mapSize = 32;
    o.lights.mapSize = 16;
    o.lights.areaLightSamples = 4;
    o.pipeline.kind = VPL_ACCUMULATE_LIGHTCUTS;
    o.lights.compensation = VPL_COMPENSATION_NONE; // its rays depend on how lights are added up
    return o;
}

static double sumOf(const vplImage* image, int i)
{
    return (double)image->pixels[3 * i] + (double)image->pixels[3 * i + 1] + (double)image->pixels[3 * i + 2];
}

// Largest error of a pixel as a share of its light, or of a sixteenth of what it would be without shadows.
static double worstPixel(const vplImage* image, const vplImage* truth, const vplImage* open)
{
    double worst = 0;
    for (int i = 0; i < image->width * image->height; i++) {
        const double all = sumOf(truth, i), dark = sumOf(open, i) / 16, of = all > dark ? all : dark;
        const double error = of > 0 ? fabs(sumOf(image, i) - all) / of : 0;
        worst = error > worst ? error : worst;
    }
    return worst;
}

// Every pixel, each kind of shadow, both models of lighting, three errors.
static void NoPixelErrsByMoreThanAsked(void** state)
{
    (void)state;
    static const float errors[] = {0.01f, 0.02f, 0.1f};
    vplContext* context = openTestContext(2);
    for (int k = 0; k < 12; k++) {
        const vplLightShadows shadows = (vplLightShadows)(1 + k / 2 % 3);
        vplRenderOptions o = optionsOf(shadows == VPL_LIGHT_SHADOWS_MAP ? 80 : 2000, shadows), plain;
        o.method = k % 2 ? VPL_METHOD_KELLER : VPL_METHOD_INSTANT_RADIOSITY;
        o.lighting = k >= 6 && k % 2 == 0 ? VPL_LIGHTING_DOCUMENTED : VPL_LIGHTING_PHYSICAL;
        vplScene* scene = openScene(context, SCENES[k % 2]);
        o.output.width = 40;
        o.output.height = 30;
        o.output.show = VPL_SHOW_INDIRECT;
        plain = o;
        plain.pipeline.kind = VPL_ACCUMULATE_DEFERRED;
        vplImage* truth = renderScene(scene, &plain, NULL);
        plain.lights.shadows = VPL_LIGHT_SHADOWS_NONE;
        vplImage* open = renderScene(scene, &plain, NULL);
        for (int e = 0; e < 3; e++) {
            o.pipeline.cutError = errors[e];
            vplImage* image = renderScene(scene, &o, NULL);
            const double worst = worstPixel(image, truth, open);
            if (!(worst <= (double)o.pipeline.cutError)) {
                fail_msg("case %d: a pixel is off by %g, not %g", k, worst, (double)o.pipeline.cutError);
            }
            vplImage_Destroy(image);
        }
        vplImage_Destroy(open);
        vplImage_Destroy(truth);
        vplScene_Destroy(scene);
    }
    closeTestContext(context);
}

// With next to no error every light is reached, also where the cut's memory ends first: 40,000 lights are more than
// twice what it holds.
static void NoErrorIsTheSumOfAllLights(void** state)
{
    (void)state;
    vplContext* context = openTestContext(2);
    vplScene* scene = loadScene(context, "room.json");
    vplRenderOptions o = optionsOf(27000, VPL_LIGHT_SHADOWS_NONE);
    o.output.width = o.output.height = 12;
    o.output.show = VPL_SHOW_INDIRECT;
    o.pipeline.cutError = 1e-6f;
    vplRenderStats stats;
    vplImage* image = renderScene(scene, &o, &stats);
    o.pipeline.kind = VPL_ACCUMULATE_DEFERRED;
    vplImage* truth = renderScene(scene, &o, NULL);
    assert_true(stats.virtualLights > 40000 && stats.largestCut > 36000);
    assert_true(stats.largestCut <= stats.virtualLights);
    for (int i = 0; i < 3 * 12 * 12; i++) {
        const double wanted = (double)truth->pixels[i];
        assertNear((double)image->pixels[i], wanted, 3e-6 * wanted, "radiance", i);
    }
    vplImage_Destroy(truth);
    vplImage_Destroy(image);
    vplScene_Destroy(scene);
    closeTestContext(context);
}

static void TenfoldLightsAreLessThanTwofoldWork(void** state)
{
    (void)state;
    vplContext* context = openTestContext(2);
    for (int k = 0; k < 2; k++) {
        vplScene* scene = openScene(context, SCENES[k]);
        double before = 0;
        for (int particles = 1000; particles <= 100000; particles *= 10) {
            vplRenderOptions o = optionsOf(particles, VPL_LIGHT_SHADOWS_RAY);
            o.method = k ? VPL_METHOD_KELLER : VPL_METHOD_INSTANT_RADIOSITY;
            vplRenderStats stats;
            vplImage_Destroy(renderScene(scene, &o, &stats));
            const double now = (double)stats.lightEvaluations / (double)stats.cutPixels;
            assert_true(stats.virtualLights >= particles && stats.largestCut >= now);
            assert_true(before == 0 || now < 2 * before);
            before = now;
        }
        vplScene_Destroy(scene);
    }
    closeTestContext(context);
}

// Doubling all lights doubles every bit: errors are shares.
static void TwiceTheLightIsTwiceThePicture(void** state)
{
    (void)state;
    enum { COUNT = 3000, SIZE = 24 };
    vplContext* context = openTestContext(2);
    vplGeometry* g = closedCube(context, 0.5f);
    vplCameraDef camera = vplDefaultCameraDef();
    camera.eye = vplVec(0, 0, 0.9f);
    camera.target = vplVec(0, 0, 0);
    const vplView view = vplView_Create(&camera, SIZE, SIZE);
    vplShadeLight* lights = rollLights(KIND_WALLS, COUNT, 4);
    vplImage* images[2];
    for (int k = 0; k < 2; k++) {
        for (int i = 0; i < COUNT; i++) {
            const float at = k ? 1 : 0.5f, scale = k ? 2 : 1;
            lights[i].px *= at, lights[i].py *= at, lights[i].pz *= at;
            lights[i].r *= scale, lights[i].g *= scale, lights[i].b *= scale;
        }
        vplShadeDef def = {.lighting = VPL_LIGHTING_PHYSICAL, .minDistance = 0.1f, .cutError = 0.02f};
        def.accumulation = VPL_ACCUMULATE_LIGHTCUTS;
        def.lights = lights;
        def.lightCount = COUNT;
        def.lightRays = true;
        assert_int_equal(vplImage_Create(context, SIZE, SIZE, &images[k]), VPL_SUCCESS);
        assert_int_equal(vplShadeView(g, &view, &def, NULL, NULL, images[k], NULL), VPL_SUCCESS);
    }
    for (int i = 0; i < 3 * SIZE * SIZE; i++) {
        assert_true(images[0]->pixels[i] > 0 && images[1]->pixels[i] == 2 * images[0]->pixels[i]);
    }
    vplImage_Destroy(images[1]);
    vplImage_Destroy(images[0]);
    free(lights);
    vplGeometry_Destroy(g);
    closeTestContext(context);
}

// Every kind of lights, unbounded, some of them on what they light: finite, not negative, and where a picture by all
// lights is 0 so is this.
static void NastyLightsLeaveNoNan(void** state)
{
    (void)state;
    enum { COUNT = 500, SIZE = 20 };
    vplContext* context = openTestContext(2);
    vplGeometry* g = closedCube(context, 0.5f);
    vplCameraDef camera = vplDefaultCameraDef();
    camera.eye = vplVec(0.2f, 0.1f, 0.9f);
    camera.target = vplVec(0, 0, 0);
    const vplView view = vplView_Create(&camera, SIZE, SIZE);
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        vplShadeLight* lights = rollLights((Kind)kind, COUNT, 6);
        for (int i = 0; i < COUNT && kind == KIND_WALLS; i++) {
            lights[i].px *= 0.5f, lights[i].py *= 0.5f, lights[i].pz *= 0.5f;
        }
        vplImage* images[2];
        for (int k = 0; k < 2; k++) {
            vplShadeDef def = {.lighting = VPL_LIGHTING_PHYSICAL, .cutError = 0.02f};
            def.accumulation = k ? VPL_ACCUMULATE_DEFERRED : VPL_ACCUMULATE_LIGHTCUTS;
            def.lights = lights;
            def.lightCount = COUNT;
            def.lightRays = true;
            assert_int_equal(vplImage_Create(context, SIZE, SIZE, &images[k]), VPL_SUCCESS);
            assert_int_equal(vplShadeView(g, &view, &def, NULL, NULL, images[k], NULL), VPL_SUCCESS);
        }
        for (int i = 0; i < 3 * SIZE * SIZE; i++) {
            assert_true(isfinite(images[0]->pixels[i]) && images[0]->pixels[i] >= 0);
            assert_true(images[1]->pixels[i] > 0 || images[0]->pixels[i] == 0);
        }
        vplImage_Destroy(images[1]);
        vplImage_Destroy(images[0]);
        free(lights);
    }
    vplGeometry_Destroy(g);
    closeTestContext(context);
}

static uint64_t hashOf(vplContext* context, const vplRenderOptions* o)
{
    vplRenderStats stats;
    vplScene* scene = loadScene(context, "room.json");
    vplImage_Destroy(renderScene(scene, o, &stats));
    vplScene_Destroy(scene);
    closeTestContext(context);
    return stats.imageHash ^ (uint64_t)stats.lightEvaluations << 20 ^ (uint64_t)stats.largestCut;
}

static void ThreadsAndInstructionSetsChangeNoBit(void** state)
{
    (void)state;
    static const int workers[] = {2, 3, 7};
    for (int i = 0; i < 4; i++) {
        vplRenderOptions o = optionsOf(i == 1 ? 60 : 3000, (vplLightShadows)(1 + i % 3));
        o.lighting = i == 3 ? VPL_LIGHTING_DOCUMENTED : VPL_LIGHTING_PHYSICAL;
        const uint64_t wanted = hashOf(openTestContext(1), &o);
        for (int k = 0; k < 3; k++) {
            assert_true(hashOf(openTestContext(workers[k]), &o) == wanted);
        }
        for (int isa = VPL_ISA_SCALAR; isa < VPL_ISA_COUNT; isa++) {
            vplContext* context = openIsaContext(2, (vplIsa)isa);
            assert_true(context == NULL || hashOf(context, &o) == wanted);
        }
    }
}

static void NoLightsAndOneLightAreDeferred(void** state)
{
    (void)state;
    vplContext* context = openTestContext(2);
    vplScene* scene = loadScene(context, "room.json");
    for (int particles = 0; particles < 2; particles++) {
        vplRenderOptions o = optionsOf(particles, VPL_LIGHT_SHADOWS_RAY);
        vplImage* image = renderScene(scene, &o, NULL);
        o.pipeline.kind = VPL_ACCUMULATE_DEFERRED;
        vplImage* truth = renderScene(scene, &o, NULL);
        for (int i = 0; i < 3 * o.output.width * o.output.height; i++) {
            const double wanted = (double)truth->pixels[i];
            assertNear((double)image->pixels[i], wanted, 1e-6 * wanted, "radiance", i);
        }
        vplImage_Destroy(truth);
        vplImage_Destroy(image);
    }
    vplScene_Destroy(scene);
    closeTestContext(context);
}

static bool stopAtOnce(void* user, double fraction)
{
    (void)fraction;
    ++*(int*)user;
    return false;
}

static void CutsCanBeCancelledAndWrongErrorsAreRefused(void** state)
{
    (void)state;
    vplContext* context = openTestContext(1);
    vplGeometry* g = closedCube(context, 0.5f);
    vplCameraDef camera = vplDefaultCameraDef();
    camera.eye = vplVec(0, 0, 0.9f);
    camera.target = vplVec(0, 0, 0);
    const vplView view = vplView_Create(&camera, 8, 8);
    vplShadeLight* lights = rollLights(KIND_CLOUD, 5000, 1);
    vplImage* image;
    assert_int_equal(vplImage_Create(context, 8, 8, &image), VPL_SUCCESS);
    vplShadeDef def = {.lighting = VPL_LIGHTING_PHYSICAL, .accumulation = VPL_ACCUMULATE_LIGHTCUTS};
    def.lights = lights;
    def.lightCount = 5000;
    static const float wrong[] = {0, -1, 1.5f, NAN};
    for (int i = 0; i < 4; i++) {
        def.cutError = wrong[i];
        assert_int_equal(vplShadeView(g, &view, &def, NULL, NULL, image, NULL), VPL_INVALID_ARGUMENT);
        assert_true(strstr(takeMessage(), "vplShadeDef.cutError is ") != NULL);
    }
    def.cutError = 0.02f;
    int asked = 0;
    assert_int_equal(vplShadeView(g, &view, &def, stopAtOnce, &asked, image, NULL), VPL_CANCELLED);
    assert_int_equal(asked, 1);
    vplImage_Destroy(image);
    free(lights);
    vplGeometry_Destroy(g);
    closeTestContext(context);
}

// Light that the bound takes away comes back in cuts, too: by the same short rays as in deferred shading.
static void CompensatedCutsKeepTheLight(void** state)
{
    (void)state;
    vplContext* context = openTestContext(2);
    vplScene* scene = loadScene(context, "room.json");
    vplRenderOptions o = vplDefaultRenderOptions();
    o.method = VPL_METHOD_KELLER;
    o.output.width = 48;
    o.output.height = 36;
    o.shadow.mapSize = 64;
    o.particles.count = 300;
    o.lights.minDistance = 3; // nearly all that virtual lights give
    o.lights.shadows = VPL_LIGHT_SHADOWS_RAY;
    o.output.show = VPL_SHOW_INDIRECT;
    vplImage* deferred = renderScene(scene, &o, NULL);
    o.pipeline.kind = VPL_ACCUMULATE_LIGHTCUTS;
    vplImage* cut = renderScene(scene, &o, NULL);
    o.lights.compensation = VPL_COMPENSATION_NONE;
    vplImage* clamped = renderScene(scene, &o, NULL);
    vplComparison same, less;
    assert_int_equal(vplImage_Compare(cut, deferred, &same), VPL_SUCCESS);
    assert_int_equal(vplImage_Compare(clamped, deferred, &less), VPL_SUCCESS);
    assertNear(same.energyRatio, 1, 0.005, "energy", 0);
    assert_true(less.energyRatio < 0.8);
    vplImage_Destroy(deferred);
    vplImage_Destroy(cut);
    vplImage_Destroy(clamped);
    vplScene_Destroy(scene);
    closeTestContext(context);
}

TEST_SUITE(lightcuts, cmocka_unit_test(CompensatedCutsKeepTheLight),
           cmocka_unit_test(EveryClusterHoldsItsLights),
           cmocka_unit_test(TreesAreTheSameForAnyNumberOfWorkers),
           cmocka_unit_test(RepresentativesAreDrawnByIntensity),
           cmocka_unit_test(NoLightGivesMoreThanTheBoundOfItsCluster),
           cmocka_unit_test(BoundsOfSmallClustersAreTight), cmocka_unit_test(InstructionSetsBoundAlike),
           cmocka_unit_test(RepresentativesErrByLessThanTheBoundAlsoInShadow),
           slow_unit_test(NoPixelErrsByMoreThanAsked), cmocka_unit_test(NoErrorIsTheSumOfAllLights),
           slow_unit_test(TenfoldLightsAreLessThanTwofoldWork),
           cmocka_unit_test(TwiceTheLightIsTwiceThePicture), cmocka_unit_test(NastyLightsLeaveNoNan),
           cmocka_unit_test(ThreadsAndInstructionSetsChangeNoBit),
           cmocka_unit_test(NoLightsAndOneLightAreDeferred),
           cmocka_unit_test(CutsCanBeCancelledAndWrongErrorsAreRefused));
