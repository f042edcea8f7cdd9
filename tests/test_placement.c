// SPDX-License-Identifier: MIT
// Tests of choosing virtual lights for what a camera sees: correct weights, unbiased choice, the same for any
// number of threads.
#include "scenes.h"

#include "base/arena.h"
#include "lights/placement.h"
#include "math/vec.h"

#include <stdlib.h>

// ---- contributions of lights

// Returns a camera four metres above a floor that sees almost only the point below it.
static vplPlacementDef narrowDef(void)
{
    vplPlacementDef def = vplDefaultPlacementDef();
    def.camera.eye = vplVec(0, 4, 0);
    def.camera.target = vplVec(0, 0, 0);
    def.camera.up = vplVec(0, 0, -1);
    def.camera.fovY = 1e-4;
    def.pointCount = 16;
    def.width = def.height = 1;
    return def;
}

static vplVirtualLight lightAt(vplVec3 position, vplVec3 normal, float flux)
{
    return (vplVirtualLight){
        .position = position, .normal = normal, .light = {flux, 2 * flux, 3 * flux}, .weight = 1};
}

static float worthOf(const vplGeometry* g, const vplVirtualLight* light, const vplPlacementDef* def)
{
    const vplLightSet set = {.lights = light, .lightCount = 1, .particleCount = 1, .context = g->context};
    float worth = -1;
    if (vplMeasureLights(g, &set, def, &worth, NULL) != VPL_SUCCESS) {
        fail_msg("%s", takeMessage());
    }
    return worth;
}

// A picture four times as wide as high, 4 m above a floor with 90 degrees from top to bottom: 16 m to either side, 4 m up
// and down, up to the outermost cells.
TEST(PointsOfTheViewReachTheSidesOfThePicture, 2)
{
    vplGeometry* floor = floorQuad(context, vplVec(0, 0, 0), 50, 0.25f);
    vplArena* arena = vplArena_Create(context);
    vplPlacementDef def = narrowDef();
    def.camera.fovY = VPL_PI / 2;
    def.pointCount = 4096;
    def.width = 400;
    def.height = 100;
    const vplViewBlock* blocks;
    int count;
    double x = 0, z = 0;
    assert_int_equal(vplSampleView(floor, &def, arena, &blocks, &count), VPL_SUCCESS);
    for (int i = 0; i < count; i++) {
        for (int l = 0; l < VPL_LANES; l++) {
            x = fmax(x, fabs((double)blocks[i].surface.px[l]));
            z = fmax(z, fabs((double)blocks[i].surface.pz[l]));
        }
    }
    assertNear(x, 16, 0.3, "half the width", 0);
    assertNear(z, 4, 0.1, "half the height", 0);
    vplArena_Destroy(arena);
    vplGeometry_Destroy(floor);
}

// The contribution is rho sum(flux)/pi cos cos / d^2, clamped; documented: rho sum(L) cos. Lights below the
// floor or behind a wall contribute nothing.
TEST(ALightsWeightIsWhatTheFloorReflects, 2)
{
    vplGeometry* floor = floorQuad(context, vplVec(0, 0, 0), 10, 0.25f);
    vplPlacementDef def = narrowDef();
    const vplVirtualLight slant =
        lightAt(vplVec(3, 4, 0), vplVec(0, -1, 0), 10); // 5 m away, both cosines 0.8
    const double wanted = 0.25 * 60 / VPL_PI * 0.8 * 0.8 / 25;
    assertNear((double)worthOf(floor, &slant, &def), wanted, 2e-4 * wanted, "worth", 0);
    def.minDistance = 10;
    assertNear((double)worthOf(floor, &slant, &def), wanted / 4, 2e-4 * wanted, "bounded worth", 0);
    def.lighting = VPL_LIGHTING_DOCUMENTED;
    assertNear((double)worthOf(floor, &slant, &def), 0.25 * 60 * 0.8, 2e-3, "documented worth", 0);
    def = narrowDef();
    const vplVirtualLight below = lightAt(vplVec(3, -4, 0), vplVec(0, 1, 0), 10);
    assert_true(worthOf(floor, &below, &def) == 0);
    def.camera.farPlane = 3.9; // beyond this far plane the floor is cut away
    assert_true(worthOf(floor, &slant, &def) == 0);
    vplGeometry_Destroy(floor);
}

TEST(WhatIsBetweenStopsOnlyLightsWithShadows, 1)
{
    vplScene* scene = sceneOf(context, 0.5f);
    vplObjectDef object = vplDefaultObjectDef();
    object.transform = vplMat4_FromParts(vplVec(0, 0, 0), (double[3]){-VPL_PI / 2, 0, 0}, vplVec(10, 10, 1));
    assert_int_equal(vplScene_AddObject(scene, &object, NULL), VPL_SUCCESS);
    object.transform = vplMat4_FromParts(vplVec(1.5f, 2, 0), (double[3]){0, 0, 0}, vplVec(1, 1, 1));
    object.type = VPL_OBJECT_BOX;
    assert_int_equal(vplScene_AddObject(scene, &object, NULL), VPL_SUCCESS);
    vplGeometry* geometry;
    assert_int_equal(vplGeometry_Create(scene, &geometry), VPL_SUCCESS);
    vplPlacementDef def = narrowDef();
    const vplVirtualLight behind = lightAt(vplVec(3, 4, 0), vplVec(0, -1, 0), 10);
    assert_true(worthOf(geometry, &behind, &def) == 0);
    def.shadows = false;
    assert_true(worthOf(geometry, &behind, &def) > 0);
    vplGeometry_Destroy(geometry);
    vplScene_Destroy(scene);
}

// ---- the choice

static vplLightSet* candidatesOf(const vplGeometry* g, int particles)
{
    vplEmitterDef emitter = vplDefaultEmitterDef();
    vplParticleDef def = vplDefaultParticleDef();
    vplLightSet* set = NULL;
    def.particleCount = particles;
    assert_int_equal(vplSimulateParticles(g, &emitter, 1, &def, &set), VPL_SUCCESS);
    return set;
}

// Makes contributions that are zero, small and large.
static float* someContributions(const vplLightSet* set)
{
    float* c = malloc((size_t)set->lightCount * sizeof *c);
    for (int i = 0; c != NULL && i < set->lightCount; i++) {
        c[i] = i % 3 == 0 ? 0 : (float)(i % 7 == 0 ? 50 : uniformAt(3, (uint64_t)i));
    }
    assert_non_null(c);
    return c;
}

static vplLightSet* chooseSome(const vplLightSet* from, const float* contributions, double count,
                               int64_t index)
{
    vplPlacementDef def = vplDefaultPlacementDef();
    vplLightSet* set = NULL;
    def.index = index;
    assert_int_equal(vplChooseLights(from, contributions, count, &def, &set), VPL_SUCCESS);
    return set;
}

// A light's weight, summed over all choices that include it, must be its original weight times the number of
// choices.
TEST(EachLightKeepsItsWeightInTheMean, 1)
{
    enum { CHOICES = 20000 };
    vplGeometry* cube = closedCube(context, 0.5f);
    vplLightSet* all = candidatesOf(cube, 100);
    float* contributions = someContributions(all);
    double* sums = calloc((size_t)all->lightCount, sizeof *sums);
    assert_non_null(sums);
    for (int k = 0; k < CHOICES; k++) {
        vplLightSet* set = chooseSome(all, contributions, 40, k);
        assert_true(abs(set->lightCount - 40) <= 1);
        for (int i = 0, at = 0; i < set->lightCount; i++, at++) { // in their original order, none twice
            while (at < all->lightCount && (all->lights[at].step != set->lights[i].step ||
                                            all->lights[at].particle != set->lights[i].particle)) {
                at++;
            }
            assert_true(at < all->lightCount);
            sums[at] += (double)set->lights[i].weight / (double)all->lights[at].weight;
        }
        vplLightSet_Destroy(set);
    }
    for (int i = 0; i < all->lightCount; i++) {
        // The least probability is a tenth of a share of the flux, 40 * 0.1 / 198 or more; the bound is 4
        // deviations.
        assertNear(sums[i] / CHOICES, 1, 4 * sqrt(50.0 / CHOICES), "weight", i);
    }
    free(sums);
    free(contributions);
    vplLightSet_Destroy(all);
    vplGeometry_Destroy(cube);
}

// In closed form, step k carries 4 pi I rho^(k+1). The mean over choices must agree.
TEST(ChosenFluxIsThatOfAClosedRoom, 1)
{
    enum { CHOICES = 2000 };
    vplGeometry* cube = closedCube(context, 0.5f);
    vplLightSet* all = candidatesOf(cube, 1000);
    float* contributions = someContributions(all);
    double flux[3] = {0}, squares[3] = {0};
    for (int k = 0; k < CHOICES; k++) {
        vplLightSet* set = chooseSome(all, contributions, 200, k);
        double mine[3] = {0};
        for (int i = 0; i < set->lightCount; i++) {
            const vplVirtualLight* v = &set->lights[i];
            if (v->step < 3) {
                mine[v->step] += (double)v->light.r * (double)v->weight / set->particleCount;
            }
        }
        for (int s = 0; s < 3; s++) {
            flux[s] += mine[s] / CHOICES;
            squares[s] += mine[s] * mine[s] / CHOICES;
        }
        vplLightSet_Destroy(set);
    }
    for (int s = 0; s < 3; s++) {
        const double wanted = 4 * VPL_PI * pow(0.5, s + 1), deviation = sqrt(squares[s] - flux[s] * flux[s]);
        assert_true(deviation > 0 && deviation < wanted);
        assertNear(flux[s], wanted, 4 * deviation / sqrt(CHOICES) + 1e-5 * wanted, "flux", s);
    }
    free(contributions);
    vplLightSet_Destroy(all);
    vplGeometry_Destroy(cube);
}

TEST(AllAreKeptWhereAllAreWanted, 1)
{
    vplGeometry* cube = closedCube(context, 0.5f);
    vplLightSet* all = candidatesOf(cube, 50);
    float* contributions = someContributions(all);
    vplLightSet* set = chooseSome(all, contributions, all->lightCount, 0);
    assert_int_equal(set->lightCount, all->lightCount);
    assert_memory_equal(set->lights, all->lights, (size_t)all->lightCount * sizeof *all->lights);
    vplLightSet_Destroy(set);
    for (int i = 0; i < all->lightCount;
         i++) { // no surface is seen: the choice uses flux alone, equal within a step
        contributions[i] = 0;
    }
    set = chooseSome(all, contributions, 30, 0);
    assert_true(abs(set->lightCount - 30) <= 1);
    vplLightSet_Destroy(set);
    set = chooseSome(all, contributions, 0, 0);
    assert_int_equal(set->lightCount, 0);
    vplLightSet_Destroy(set);
    free(contributions);
    vplLightSet_Destroy(all);
    vplGeometry_Destroy(cube);
}

// ---- in a render

static vplRenderOptions viewOptions(int particles)
{
    vplRenderOptions o = plainOptions();
    o.output.width = o.output.height = 16;
    o.particles.count = particles;
    o.particles.placement = VPL_PLACEMENT_VIEW;
    o.lights.shadows = VPL_LIGHT_SHADOWS_RAY;
    o.lights.minDistance = 0.5f;
    o.output.show = VPL_SHOW_INDIRECT;
    return o;
}

static vplLightSet* lightsOf(const vplScene* scene, const vplRenderOptions* o)
{
    vplLightSet* set = NULL;
    if (vplMakeLights(scene, o, &set) != VPL_SUCCESS) {
        fail_msg("%s", takeMessage());
    }
    return set;
}

static double energyOf(const vplScene* scene, const vplRenderOptions* options)
{
    vplImage* image = renderScene(scene, options, NULL);
    double sum = 0;
    for (int i = 0; i < 3 * image->width * image->height; i++) {
        sum += (double)image->pixels[i];
    }
    vplImage_Destroy(image);
    return sum;
}

// Returns the mean of the picture's sum over many seeds, and its standard deviation.
static double meanEnergy(const vplScene* scene, vplRenderOptions o, double* deviation)
{
    enum { SEEDS = 40 };
    double sum = 0, squares = 0;
    for (int seed = 1; seed <= SEEDS; seed++) {
        o.seed = (uint64_t)seed;
        const double energy = energyOf(scene, &o);
        sum += energy / SEEDS;
        squares += energy * energy / SEEDS;
    }
    *deviation = sqrt((squares - sum * sum) / SEEDS);
    return sum;
}

TEST(PicturesAreThoseOfPlainParticlesInTheMean, 2, SLOW)
{
    // Variants: instant radiosity and Keller's, with rays and without shadows, and documented lighting.
    for (int variant = 0; variant < 5; variant++) {
        vplScene* scene =
            loadScene(context, variant == 1 ? "../../examples/scenes/room-area.json" : "room.json");
        vplRenderOptions o = viewOptions(16);
        double apart[2], mean[2];
        o.method = variant == 1 || variant == 2 ? VPL_METHOD_KELLER : VPL_METHOD_INSTANT_RADIOSITY;
        o.output.show = variant == 1 ? VPL_SHOW_PICTURE : VPL_SHOW_INDIRECT;
        o.lights.shadows = variant == 3 ? VPL_LIGHT_SHADOWS_NONE : VPL_LIGHT_SHADOWS_RAY;
        o.lighting = variant == 4 ? VPL_LIGHTING_DOCUMENTED : VPL_LIGHTING_PHYSICAL;
        o.lights.compensation = VPL_COMPENSATION_NONE;
        for (int view = 0; view < 2; view++) {
            o.particles.placement = view ? VPL_PLACEMENT_VIEW : VPL_PLACEMENT_PARTICLES;
            mean[view] = meanEnergy(scene, o, &apart[view]);
        }
        assert_true(apart[1] < 0.03 * mean[1]);
        assertNear(mean[1], mean[0], 3.5 * hypot(apart[0], apart[1]), "energy", variant);
        vplScene_Destroy(scene);
    }
}

// In a flat whose area lights are in seven other rooms, nearly all chosen lights are ones that reach the
// camera's room.
TEST(LightsBehindWallsAreLeftOut, 2, SLOW)
{
    vplScene* scene;
    assert_int_equal(vplScene_Load(context, "examples/scenes/flat.json", &scene), VPL_SUCCESS);
    double share[2], count[2];
    for (int view = 0; view < 2; view++) {
        vplRenderOptions o = viewOptions(500);
        o.particles.placement = view ? VPL_PLACEMENT_VIEW : VPL_PLACEMENT_PARTICLES;
        vplLightSet* set = lightsOf(scene, &o);
        int near = 0;
        for (int i = 0; i < set->lightCount; i++) {
            const vplVec3 p = set->lights[i].position;
            near += p.x < 4.05f && p.z < 4.05f;
        }
        count[view] = set->lightCount;
        share[view] = (double)near / set->lightCount;
        vplLightSet_Destroy(set);
    }
    assertNear(count[1], count[0], 2, "lights", 0);
    assert_true(share[0] < 0.01 && share[1] > 30 * share[0]);
    vplScene_Destroy(scene);
}

static uint64_t hashOf(const vplScene* scene, const vplRenderOptions* o)
{
    vplImage* image = renderScene(scene, o, NULL);
    const uint64_t hash = vplImage_Hash(image);
    vplImage_Destroy(image);
    return hash;
}

TEST_ALONE(ChoicesDoNotDependOnThreadsOrIsa, SLOW)
{
    for (int placement = VPL_PLACEMENT_RSM; placement <= VPL_PLACEMENT_VIEW; placement++) {
        for (int sampler = VPL_SAMPLER_RANDOM; sampler <= VPL_SAMPLER_HAMMERSLEY; sampler++) {
            uint64_t wanted = 0;
            for (int i = 0; i < 8; i += 1 + (sampler != VPL_SAMPLER_RANDOM && i > 0)) {
                const int workers[] = {1, 2, 3, 7};
                vplContext* context =
                    i < 4 ? openTestContext(workers[i]) : openIsaContext(2, (vplIsa)(VPL_ISA_SCALAR + i - 4));
                if (context == NULL) {
                    continue;
                }
                vplScene* scene = loadScene(context, "room.json");
                vplRenderOptions o = viewOptions(20);
                o.particles.placement = (vplLightPlacement)placement;
                o.particles.sampler = (vplSampler)sampler;
                o.stop.passes = 2;
                o.shadow.mapSize = 64;
                const uint64_t hash = hashOf(scene, &o);
                wanted = i == 0 ? hash : wanted;
                assert_true(hash == wanted);
                vplScene_Destroy(scene);
                closeTestContext(context);
            }
        }
    }
}

static vplScene* pointInCube(vplContext* context, float intensity, float rho)
{
    vplScene* scene = sceneOf(context, rho);
    vplObjectDef object = vplDefaultObjectDef();
    vplEmitterDef emitter = vplDefaultEmitterDef();
    vplCameraDef camera = vplDefaultCameraDef();
    object.type = VPL_OBJECT_BOX;
    object.transform = vplMat4_FromParts(vplVec(0, 0, 0), (double[3]){0, 0, 0}, vplVec(2, 2, 2));
    emitter.position = vplVec(0.2f, 0.3f, 0.1f);
    emitter.intensity = (vplRgb){intensity, 0.5f * intensity, 0.25f * intensity};
    camera.eye = vplVec(0.5f, 0, 0.5f);
    camera.target = vplVec(-1, 0.1f, 0);
    camera.nearPlane = 0.01;
    assert_int_equal(vplScene_AddObject(scene, &object, NULL), VPL_SUCCESS);
    assert_int_equal(vplScene_AddEmitter(scene, &emitter, NULL), VPL_SUCCESS);
    assert_int_equal(vplScene_AddCamera(scene, &camera, NULL), VPL_SUCCESS);
    return scene;
}

TEST(DoublingTheEmitterChoosesTheSameLights, 1)
{
    vplScene *one = pointInCube(context, 3, 0.5f), *two = pointInCube(context, 6, 0.5f);
    vplRenderOptions o = viewOptions(100);
    vplLightSet *a = lightsOf(one, &o), *b = lightsOf(two, &o);
    assert_int_equal(a->lightCount, b->lightCount);
    for (int i = 0; i < a->lightCount; i++) {
        assert_true(a->lights[i].weight == b->lights[i].weight &&
                    a->lights[i].particle == b->lights[i].particle);
        assert_true(2 * a->lights[i].light.g == b->lights[i].light.g);
    }
    vplLightSet_Destroy(a);
    vplLightSet_Destroy(b);
    vplScene_Destroy(one);
    vplScene_Destroy(two);
}

// X040 and beyond: no particles; walls that reflect nothing; the brightest and the dimmest emitters; a camera
// that sees only the background.
TEST(ExtremesStayFinite, 1)
{
    const float intensities[] = {VPL_MAX_MAGNITUDE, 1e-30f, 0};
    for (int i = 0; i < 3; i++) {
        vplScene* scene = pointInCube(context, intensities[i], 0.9f);
        vplRenderOptions o = viewOptions(30);
        o.lights.minDistance = 0;
        vplLightSet* set = lightsOf(scene, &o);
        assert_true(intensities[i] > 0 ? abs(set->lightCount - 56) <= 1 : set->lightCount == 0);
        for (int k = 0; k < set->lightCount; k++) {
            assert_true(isfinite(set->lights[k].weight) && set->lights[k].weight > 0);
        }
        vplLightSet_Destroy(set);
        assert_true(isfinite(energyOf(scene, &o)));
        o.particles.count = 0;
        assert_true(energyOf(scene, &o) == 0);
        vplScene_Destroy(scene);
    }
    vplScene* black = pointInCube(context, 1, 0);
    vplRenderOptions o = viewOptions(30);
    assert_true(energyOf(black, &o) == 0);
    vplCameraDef away = vplDefaultCameraDef();
    away.eye = vplVec(50, 0, 0);
    away.target = vplVec(100, 0, 0);
    assert_int_equal(vplScene_AddCamera(black, &away, &o.output.camera), VPL_SUCCESS);
    assert_true(energyOf(black, &o) == 0);
    vplScene_Destroy(black);
}

TEST(BadPlacementsAreRefused, 1)
{
    vplGeometry* cube = closedCube(context, 0.5f);
    const vplLightSet none = {.context = context};
    float worth;
    for (int i = 0; i < 6; i++) {
        vplPlacementDef def = vplDefaultPlacementDef();
        static const char* const words[] = {"width is 0",     "pointCount is 0",   "oversampling is 5000",
                                            "fluxShare is 0", "minDistance is -1", "vplDefaultPlacementDef"};
        def.width = i == 0 ? 0 : def.width;
        def.pointCount = i == 1 ? 0 : def.pointCount;
        def.oversampling = i == 2 ? 5000 : def.oversampling;
        def.fluxShare = i == 3 ? 0 : def.fluxShare;
        def.minDistance = i == 4 ? -1 : def.minDistance;
        def.cookie = i == 5 ? 0 : def.cookie;
        assert_int_equal(vplMeasureLights(cube, &none, &def, &worth, NULL), VPL_INVALID_ARGUMENT);
        assert_non_null(strstr(takeMessage(), words[i]));
    }
    vplPlacementDef def = vplDefaultPlacementDef();
    vplLightSet* set = NULL;
    assert_int_equal(vplChooseLights(&none, &worth, NAN, &def, &set), VPL_INVALID_ARGUMENT);
    assert_null(set);
    takeMessage();
    vplGeometry_Destroy(cube);
}
