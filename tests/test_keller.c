// SPDX-License-Identifier: MIT
// Tests of Keller's Instant Radiosity against tables and closed forms: counts, weights, radiance in closed
// rooms, and the distribution of particles over emitters.
#include "shapes.h"

#include "math/vec.h"
#include "shading/light_block.h"

#include <stdlib.h>

static int addGlow(vplScene* scene, float rho, float emission)
{
    vplMaterialDef material = vplDefaultMaterialDef();
    material.diffuse = (vplRgb){rho, rho, rho};
    material.emission = (vplRgb){emission, 0.5f * emission, 0.25f * emission};
    int index;
    assert_int_equal(vplScene_AddMaterial(scene, &material, &index), VPL_SUCCESS);
    return index;
}

// Adds a one-sided area light that faces down.
static void addAreaLight(vplScene* scene, vplVec3 centre, float size, float emission)
{
    vplObjectDef object = vplDefaultObjectDef();
    object.material = addGlow(scene, 0.5f, emission);
    object.transform = vplMat4_FromParts(centre, (double[3]){VPL_PI / 2, 0, 0}, vplVec(size, size, 1));
    assert_int_equal(vplScene_AddObject(scene, &object, NULL), VPL_SUCCESS);
}

static void addCamera(vplScene* scene)
{
    vplCameraDef camera = vplDefaultCameraDef();
    camera.eye = vplVec(0.1f, -0.2f, 0.9f);
    camera.target = vplVec(0, -0.3f, -1);
    camera.fovY = 1.2;
    camera.nearPlane = 0.01;
    assert_int_equal(vplScene_AddCamera(scene, &camera, NULL), VPL_SUCCESS);
}

// Makes the cube [-1, 1]^3 with an area light of half its width below its ceiling.
static vplScene* areaLightRoom(vplContext* context, float rho)
{
    vplScene* scene = closedCubeScene(context, rho, 0);
    addAreaLight(scene, vplVec(0, 0.99f, 0), 1, 3);
    addCamera(scene);
    return scene;
}

static vplParticleDef kellerDef(int count, double reflectivity)
{
    vplParticleDef def = vplDefaultParticleDef();
    def.start = VPL_START_EMITTER;
    def.particleCount = count;
    def.reflectivity = reflectivity;
    return def;
}

static vplLightSet* simulate(const vplGeometry* geometry, vplParticleDef def)
{
    vplLightSet* set;
    assert_int_equal(vplSimulateParticles(geometry, NULL, 0, &def, &set), VPL_SUCCESS);
    return set;
}

// counts_totals.csv: N lights on the emitter, then floor(rho N), floor(rho^2 N) and so on, each step after
// one more ray: 10 particles at rho = 0.5 leave 18 lights and cast 8 rays. The 76 rows of more than 20,000 lights take
// seconds; test_totals.c compares them, with particles from a point.
TEST(CountsAndRaysAreThoseOfTheTable, 1)
{
    vplGeometry* room = buildGeometry(areaLightRoom(context, 0.5f));
    Table t = loadTable("counts_totals.csv");
    int checked = 0, large = 0;
    for (int row = 0; row < t.rows; row++) {
        if (number(&t, row, "total_sum_k>=0") > 20000) {
            large++;
            continue;
        }
        const int n = (int)number(&t, row, "N");
        vplLightSet* set = simulate(room, kellerDef(n, number(&t, row, "rho")));
        assert_int_equal(set->stepCount, (int)number(&t, row, "steps"));
        assert_int_equal(set->rays, (int64_t)number(&t, row, "keller_rays_sum_k>=1"));
        assert_int_equal(set->rayObjectTests, 7 * set->rays);
        assert_int_equal(set->lightCount, (int64_t)number(&t, row, "total_sum_k>=0"));
        assert_int_equal(set->escaped, 0);
        for (int i = 0; i < set->lightCount; i++) {
            const vplVirtualLight* v = &set->lights[i];
            const bool onAreaLight =
                v->object == 6 && fabsf(v->position.y - 0.99f) < 1e-6f && v->normal.y < -0.999f;
            assert_true(v->step > 0 || onAreaLight);
        }
        vplLightSet_Destroy(set);
        checked++;
    }
    assert_int_equal(checked, 285);
    assert_int_equal(large, 76);
    freeTable(&t);
    vplGeometry_Destroy(room);
}

// vpl_weights.csv: the weights are N/M_k, and the lights of step k carry the area light's power times rho^k
// (documented: (rho/pi)^k).
TEST(FluxOfEachStepIsThatOfTheTable, 2)
{
    Table t = loadTable("vpl_weights.csv");
    for (int row = 0; row < 2 * t.rows; row++) {
        const int r = row / 2, documented = row % 2, k = (int)number(&t, r, "k");
        const float rho = (float)number(&t, r, "rho");
        vplGeometry* cube = buildGeometry(closedCubeScene(context, rho, 3));
        vplParticleDef def = kellerDef((int)number(&t, r, "N"), number(&t, r, "rho"));
        def.lighting = documented ? VPL_LIGHTING_DOCUMENTED : VPL_LIGHTING_PHYSICAL;
        vplLightSet* set = simulate(cube, def);
        double flux = 0;
        for (int i = 0; i < set->lightCount; i++) {
            const vplVirtualLight* v = &set->lights[i];
            flux += v->step == k ? (double)v->light.r * (double)v->weight / def.particleCount : 0;
            if (v->step == k) {
                assertNear((double)v->weight, number(&t, r, "N/M_k"), 1e-6 * number(&t, r, "N/M_k"), "weight",
                           r);
            }
        }
        const double wanted = 3 * VPL_PI * 24 * pow((double)rho / (documented ? VPL_PI : 1), k);
        assertNear(flux, wanted, 1e-5 * wanted, "flux", r);
        assert_int_equal(set->lightsInStep[k], (int)number(&t, r, "M_k"));
        vplLightSet_Destroy(set);
        vplGeometry_Destroy(cube);
    }
    assert_int_equal(t.rows, 61);
    freeTable(&t);
}

// X090
// The three rows on Keller in estimator_factors.csv: the lightings agree on the emitter and differ by pi^j after
// j bounces, so that a closed room of Le = 1 and rho = 0.5 has 1.5946399 instead of 2.
TEST(BothLightingsDifferByTheFactorsOfTheTable, 2)
{
    Table t = loadTable("estimator_factors.csv");
    double flux[2][64] = {{0}}, sums[2] = {0};
    vplGeometry* cube = buildGeometry(closedCubeScene(context, 0.5f, 1));
    for (int documented = 0; documented < 2; documented++) {
        vplParticleDef def = kellerDef(1 << 15, 0.5);
        def.lighting = documented ? VPL_LIGHTING_DOCUMENTED : VPL_LIGHTING_PHYSICAL;
        vplLightSet* set = simulate(cube, def);
        for (int i = 0; i < set->lightCount; i++) {
            const vplVirtualLight* v = &set->lights[i];
            flux[documented][v->step] += (double)v->light.r * (double)v->weight / def.particleCount;
        }
        vplLightSet_Destroy(set);
        for (int k = 0; k < 64; k++) {
            sums[documented] += flux[documented][k] / flux[documented][0];
        }
    }
    int rows = 0;
    for (int row = 0; row < t.rows; row++) {
        const char *term = cell(&t, row, "term"), *factor = cell(&t, row, "physical/documented");
        if (strncmp(term, "Keller step 0", 13) == 0) {
            assert_string_equal(factor, "1 (supp Le = A)");
            assertNear(flux[0][0] / flux[1][0], 1, 1e-6, term, row);
            rows++;
        } else if (strcmp(term, "Keller step j") == 0) {
            assert_string_equal(factor, "pi^j");
            for (int j = 0; j < 16; j++) {
                assertNear(flux[0][j] / flux[1][j] / pow(VPL_PI, j), 1, 1e-5, term, row);
            }
            rows++;
        } else if (strncmp(term, "Keller furnace", 14) == 0) {
            assert_non_null(strstr(factor, "documented 1.5946399 vs 2"));
            assertNear(1 + 0.5 * sums[1], 1.5946399, 1e-5, term, row);
            assertNear(sums[0], 2, 1e-4, term, row); // 16 steps: 2^-15 is cut off
            rows++;
        }
    }
    assert_int_equal(rows, 3);
    vplGeometry_Destroy(cube);
    freeTable(&t);
}

// Makes a sphere of radius 1 that emits radiance 1 inwards.
static vplGeometry* glowingSphere(vplContext* context, float rho)
{
    vplScene* scene;
    assert_int_equal(vplScene_Create(context, &scene), VPL_SUCCESS);
    addGlow(scene, rho, 1);
    Shape shape = icosphere(4);
    for (int i = 0; i < shape.triangleCount; i++) {
        vplVec3* corners = shape.corners + 3 * i;
        const vplVec3 first = corners[0];
        corners[0] = corners[1];
        corners[1] = first;
    }
    addShape(scene, &shape, false, NULL);
    freeShape(&shape);
    return buildGeometry(scene);
}

// Returns the red irradiance at a point of the unit sphere from lights moved onto the sphere: each
// contributes a quarter of its intensity.
static double irradianceOnSphere(vplContext* context, const vplLightSet* set)
{
    const vplVec3 at = vplNormalize(vplVec(0.3f, -0.5f, 0.8f));
    vplSurface surface;
    for (int l = 0; l < VPL_LANES; l++) {
        surface.px[l] = at.x, surface.py[l] = at.y, surface.pz[l] = at.z;
        surface.nx[l] = -at.x, surface.ny[l] = -at.y, surface.nz[l] = -at.z;
    }
    vplShadeLight* lights = malloc((size_t)set->lightCount * sizeof *lights);
    assert_non_null(lights);
    assert_int_equal(vplPrepareLights(set, VPL_LIGHTING_PHYSICAL, lights), set->lightCount);
    double sum = 0;
    for (int i = 0; i < set->lightCount; i++) {
        const vplVec3 d = vplNormalize(set->lights[i].position);
        float e[3][VPL_LANES] = {{0}};
        lights[i] = (vplShadeLight){d.x, d.y, d.z, -d.x, -d.y, -d.z, lights[i].r, lights[i].g, lights[i].b};
        vplAccumulateLights(context, (vplLightFormula){VPL_LIGHTING_PHYSICAL, 0}, &surface, &lights[i], 1, e);
        sum += (double)e[0][0];
    }
    free(lights);
    return sum;
}

// estimator_factors.csv, "Keller furnace": walls that emit Le and reflect rho have radiance Le / (1 - rho);
// as printed, Le (1 + rho / (1 - rho/pi)). On a sphere a light has the same effect on every point, so the sum
// is exact apart from the steps that floor(rho^j N) = 0 cuts off.
TEST_ALONE(ClosedRoomsGlowAsTheFormulasSay, SLOW)
{
    static const struct {
        float rho;
        int particles;
    } cases[] = {{0.1f, 100}, {0.5f, 1 << 16}, {0.9f, 20000}};
    for (int i = 0; i < 6; i++) {
        const double rho = (double)cases[i / 2].rho;
        const bool documented = i % 2;
        vplContext* context = openTestContext(2);
        vplGeometry* sphere = glowingSphere(context, cases[i / 2].rho);
        vplParticleDef def = kellerDef(cases[i / 2].particles, rho);
        def.lighting = documented ? VPL_LIGHTING_DOCUMENTED : VPL_LIGHTING_PHYSICAL;
        vplLightSet* set = simulate(sphere, def);
        const double share = vplGeometry_Area(sphere) / (4 * VPL_PI); // flat triangles are a little smaller
        const double kept = documented ? rho / VPL_PI : rho;
        const double wanted = 1 + rho * share * (1 - pow(kept, set->stepCount)) / (1 - kept);
        assertNear(1 + rho / VPL_PI * irradianceOnSphere(context, set), wanted, 2e-5 * wanted, "glow", i);
        const double limit = documented ? 1 + rho / (1 - rho / VPL_PI) : 1 / (1 - rho);
        assertNear(wanted, limit, (1 - share + pow(kept, set->stepCount)) * limit, "limit", i);
        vplLightSet_Destroy(set);
        vplGeometry_Destroy(sphere);
        closeTestContext(context);
    }
}

// Area, point, spot and directional lights get particles in proportion to power. If a particle starts from no
// surface, its first virtual light is at the emitter.
TEST(EmittersOfAllKindsShareByPower, 2)
{
    vplScene* scene = areaLightRoom(context, 0.5f);
    vplEmitterDef emitters[3];
    for (int i = 0; i < 3; i++) {
        emitters[i] = vplDefaultEmitterDef();
        emitters[i].type =
            (vplEmitterType[]){VPL_EMITTER_POINT, VPL_EMITTER_SPOT, VPL_EMITTER_DIRECTIONAL}[i];
        emitters[i].intensity = (vplRgb){1, 1, 1};
        emitters[i].direction = vplVec(0.1f, -1, 0.2f);
    }
    vplGeometry* room = buildGeometry(scene);
    vplEmission* emission;
    assert_int_equal(vplEmission_Create(room, emitters, 3, &emission), VPL_SUCCESS);
    for (int sampler = VPL_SAMPLER_AUTO; sampler <= VPL_SAMPLER_HAMMERSLEY; sampler++) {
        enum { N = 4000 };
        vplParticleDef def = kellerDef(N, 0);
        def.sampler = (vplSampler)sampler;
        vplLightSet* set;
        assert_int_equal(vplSimulateParticles(room, emitters, 3, &def, &set), VPL_SUCCESS);
        assert_int_equal(set->lightCount, N);
        assert_int_equal(set->rays, 0);
        int onAreaLight = 0, atPoint = 0;
        for (int i = 0; i < N; i++) {
            onAreaLight += set->lights[i].object == 6;
            atPoint += set->lights[i].object < 0 && vplLength(set->lights[i].position) == 0;
        }
        const double* sums = emission->cumulative;
        const double total = sums[emission->sourceCount], slack = sampler == VPL_SAMPLER_RANDOM ? 100 : 3;
        assertNear(onAreaLight, N * (total - sums[3]) / total, slack, "on the area light", sampler);
        assertNear(atPoint, N * sums[2] / total, slack, "at point and spot", sampler); // both at the origin
        vplShadeLight lights[N];
        assert_int_equal(vplPrepareLights(set, VPL_LIGHTING_PHYSICAL, lights), onAreaLight);
        vplLightSet_Destroy(set);
    }
    vplEmission_Destroy(emission);
    vplGeometry_Destroy(room);
}

// Later passes continue the sequence: two passes of N particles are the first 2 N of the sequence.
TEST(LaterPassesGoOnWithTheSequence, 1)
{
    vplGeometry* room = buildGeometry(areaLightRoom(context, 0.5f));
    for (int sampler = VPL_SAMPLER_RANDOM; sampler <= VPL_SAMPLER_HAMMERSLEY; sampler++) {
        enum { N = 50 };
        vplParticleDef def = kellerDef(2 * N, 0);
        def.sampler = (vplSampler)sampler;
        vplLightSet* all = simulate(room, def);
        def.particleCount = N;
        def.firstParticle = N;
        vplLightSet* second = simulate(room, def);
        int same = 0;
        for (int i = 0; i < N; i++) {
            same += memcmp(&all->lights[N + i].position, &second->lights[i].position, sizeof(vplVec3)) == 0;
        }
        // A Hammersley set depends on N: another pass is the same set, shifted.
        assert_int_equal(same, sampler == VPL_SAMPLER_HAMMERSLEY ? 0 : N);
        vplLightSet_Destroy(all);
        vplLightSet_Destroy(second);
    }
    vplGeometry_Destroy(room);
}

// Passes add up to one random walk: their counts sum to floor(rho^k P N), including steps that a single pass
// of N would not reach, and lights of step k have weight rho^-k, so that they carry power rho^k on average.
TEST(PassesAddUpToOneWalk, 2)
{
    enum { PASSES = 64, N = 7 };
    vplGeometry* cube = buildGeometry(closedCubeScene(context, 0.7f, 3));
    int counts[64], sums[64] = {0};
    vplStepTotals totals;
    double flux[64] = {0};
    assert_int_equal(vplCountParticles(context, &(vplParticlePass){0, PASSES * N, 0.7}, counts, 64, &totals),
                     VPL_SUCCESS);
    for (int pass = 0; pass < PASSES; pass++) {
        vplParticleDef def = kellerDef(N, 0.7);
        def.pass = true;
        def.firstParticle = pass * N;
        vplLightSet* set = simulate(cube, def);
        for (int i = 0; i < set->lightCount; i++) {
            const vplVirtualLight* v = &set->lights[i];
            assertNear((double)v->weight, pow(0.7, -v->step), 1e-6 * pow(0.7, -v->step), "weight", v->step);
            flux[v->step] += (double)v->weight * (double)v->light.r / (N * PASSES);
            sums[v->step]++;
        }
        vplLightSet_Destroy(set);
    }
    for (int k = 0; k < totals.stepCount; k++) {
        assert_int_equal(sums[k], counts[k]);
        const double wanted = 3 * VPL_PI * 24 * pow(0.7, k);
        assertNear(flux[k], wanted * counts[k] / (PASSES * N * pow(0.7, k)), 1e-4 * wanted, "flux", k);
    }
    vplParticleDef def = kellerDef(N, 0.7);
    def.firstParticle = -1;
    vplLightSet* set = NULL;
    assert_int_equal(vplSimulateParticles(cube, NULL, 0, &def, &set), VPL_INVALID_ARGUMENT);
    assert_null(set);
    vplGeometry_Destroy(cube);
}

static vplRenderOptions smallOptions(void)
{
    vplRenderOptions o = plainOptions();
    o.method = VPL_METHOD_KELLER;
    o.output.width = 37;
    o.output.height = 29;
    o.shadow.mapSize = 64;
    return o;
}

// If no particle bounces, a point light's picture is its direct light bit for bit: N virtual lights at one
// position are merged.
TEST(PointEmittersAreDrawnAsThemselves, 2)
{
    vplScene* scene = loadScene(context, "room.json");
    vplRenderOptions o = smallOptions();
    o.particles.reflectivity = 0;
    o.lights.shadows = VPL_LIGHT_SHADOWS_RAY;
    vplImage* keller = renderScene(scene, &o, NULL);
    o.method = VPL_METHOD_DIRECT;
    vplImage* direct = renderScene(scene, &o, NULL);
    assert_true(vplImage_Hash(keller) == vplImage_Hash(direct));
    vplImage_Destroy(keller);
    vplImage_Destroy(direct);
    vplScene_Destroy(scene);
}

// Direct and indirect light add up to the picture.
TEST(PartsAddUp, 2)
{
    vplScene* scene = areaLightRoom(context, 0.7f);
    vplRenderOptions o = smallOptions();
    o.particles.count = 40;
    o.lights.compensation = VPL_COMPENSATION_NONE;
    o.lights.minDistance = 0.1f;
    vplImage* images[3];
    static const vplShow shows[3] = {VPL_SHOW_PICTURE, VPL_SHOW_DIRECT, VPL_SHOW_INDIRECT};
    for (int i = 0; i < 3; i++) {
        o.output.show = shows[i];
        images[i] = renderScene(scene, &o, NULL);
    }
    for (int k = 0; k < 3 * 37 * 29; k++) {
        const float sum = images[1]->pixels[k] + images[2]->pixels[k];
        assertNear((double)images[0]->pixels[k], (double)sum, 2e-6 * (double)sum, "sum", k);
        assert_true(images[1]->pixels[k] >= 0 && images[2]->pixels[k] > 0);
    }
    for (int i = 0; i < 3; i++) {
        vplImage_Destroy(images[i]);
    }
    vplScene_Destroy(scene);
}

// X031, X036, X040: no particles, one particle, a black room, an area light that faces away from the room.
TEST(OddRoomsGiveFinitePictures, 2)
{
    for (int i = 0; i < 4; i++) {
        vplScene* scene = areaLightRoom(context, i == 2 ? 0.0f : 0.9f);
        if (i == 3) {
            addAreaLight(scene, vplVec(0, -50, 0), 1, 1e6f); // outside, faces away: takes all particles
        }
        vplRenderOptions o = smallOptions();
        o.particles.count = i == 0 ? 0 : i == 1 ? 1 : 20;
        vplRenderStats stats;
        vplImage* image = renderScene(scene, &o, &stats);
        for (int k = 0; k < 3 * 37 * 29; k++) {
            assert_true(isfinite(image->pixels[k]) && image->pixels[k] >= 0);
        }
        assert_int_equal(stats.escaped > 0, i == 3);
        vplImage_Destroy(image);
        vplScene_Destroy(scene);
    }
}
