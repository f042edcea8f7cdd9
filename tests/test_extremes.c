// SPDX-License-Identifier: MIT
// Rows of the catalogue of extremes, tests/data/extremes.csv, that are asserted in no other file.
#include "shadow_maps.h"

#include "math/matrix.h"
#include "math/vec.h"
#include "shading/light_block.h"
#include "shading/shading.h"

// ---- rays and particles

// X019
TEST(ARayWithoutADirectionHitsNothing, 1)
{
    vplGeometry* cube = closedCube(context, 0.5f);
    const vplVec3 origins[] = {{0, 0, 0}, {1, 0, 0}, {0.25f, -1, 1}}; // inside, on a wall, on an edge
    for (int i = 0; i < 3; i++) {
        const vplRay ray = {origins[i], {0, -0.0f, 0}, {0, 0}};
        vplHit hit;
        assert_false(vplGeometry_ClosestHit(cube, &ray, &hit));
    }
    vplGeometry_Destroy(cube);
}

static vplLightSet* shoot(const vplGeometry* g, vplVec3 from, const vplParticleDef* def)
{
    vplEmitterDef emitter = vplDefaultEmitterDef();
    emitter.position = from;
    vplLightSet* set;
    assert_int_equal(vplSimulateParticles(g, &emitter, 1, def, &set), VPL_SUCCESS);
    return set;
}

// X018: light from below a floor that faces up. A physical light shines back to where its particle came from;
// the documented one keeps the quad's own normal.
TEST(AParticleFromBehindLeavesALightOnItsOwnSide, 1)
{
    vplGeometry* ground = floorQuad(context, (vplVec3){0, 0, 0}, 1e6f, 0.5f);
    vplParticleDef def = vplDefaultParticleDef();
    def.particleCount = 100;
    for (int side = -1; side <= 1; side += 2) {
        for (int lighting = 0; lighting < 2; lighting++) {
            def.lighting = (vplLighting)lighting;
            vplLightSet* set = shoot(ground, (vplVec3){0, (float)side, 0}, &def);
            assert_true(set->lightCount > 30);
            for (int i = 0; i < set->lightCount; i++) {
                const float up = lighting == VPL_LIGHTING_PHYSICAL ? (float)side : 1;
                assertNear((double)set->lights[i].normal.y, (double)up, 1e-6, "normal", side);
                assertNear((double)set->lights[i].position.y, 0, 1e-6, "height", side);
            }
            vplLightSet_Destroy(set);
        }
    }
    vplGeometry_Destroy(ground);
}

// X029: a cube whose floor is there twice. No particle that leaves the floor meets the other one, which is in
// the same place.
TEST(TwoFloorsInOnePlaceCatchNoLightBetweenThem, 1)
{
    vplScene* scene = closedCubeScene(context, 0.5f, 0);
    const vplObjectDef again = *vplScene_GetObject(scene, 3); // at y = -1
    assert_int_equal(vplScene_AddObject(scene, &again, NULL), VPL_SUCCESS);
    vplGeometry* cube = buildGeometry(scene);
    vplParticleDef def = vplDefaultParticleDef();
    def.particleCount = 2000;
    def.reflectivity = 0.9;
    vplLightSet* set = shoot(cube, (vplVec3){0.1f, 0.2f, -0.3f}, &def);
    int below[2000], onFloor = 0; // the last step in which each particle was on the floor
    memset(below, -1, sizeof below);
    for (int i = 0; i < set->lightCount; i++) {
        const vplVirtualLight* v = &set->lights[i];
        assert_int_not_equal(v->object, 6); // the second floor: the first wins
        if (v->object == 3) {
            assert_true(below[v->particle] < 0 || below[v->particle] < v->step - 1);
            below[v->particle] = v->step;
            onFloor++;
        }
    }
    assert_int_equal(set->escaped, 0);
    assert_true(onFloor > set->lightCount / 10);
    vplLightSet_Destroy(set);
    vplGeometry_Destroy(cube);
}

// X029: a cube that is rotated, so that rounding moves its planes; floor and ceiling are there twice. Half of the rays that
// left one were blocked by its copy.
TEST(AWallThatIsThereTwiceIsLitAsOnce, 1)
{
    static const struct {
        const char* words;
        double most; // mean difference over the mean
    } cases[] = {
        {"--method direct --light-shadows ray", 1e-5},
        {"--method path --spp 4 --max-bounces 1", 1e-5},
        {"--method keller --particles 20 --compensation none --min-distance 0.1 --light-shadows ray", 1e-5},
        {"--method keller --particles 20 --compensation none --min-distance 0.1 --light-shadows map", 1e-5},
        {"--method ssvp --min-distance 0.1", 2e-3}, // by which lights are chosen, too
        {"--method radiosity --patch-size 0.2 --patch-cuts on --light-shadows ray", 2e-3}};
    const vplMat4 turn =
        vplMat4_FromParts((vplVec3){3, 1, 2}, (double[3]){0.3, 0.5, 0.7}, (vplVec3){1, 1, 1});
    for (int m = 0; m < (int)(sizeof cases / sizeof *cases); m++) {
        vplImage* pictures[2];
        for (int twice = 0; twice < 2; twice++) {
            vplScene* cube = closedCubeScene(context, 0.5f, 0);
            vplScene* scene = sceneOf(context, 0.5f);
            for (int i = 0; i < 6 + 2 * twice; i++) {
                vplObjectDef def = *vplScene_GetObject(cube, i < 6 ? i : i - 4); // floor and ceiling again
                def.material = 0;
                def.transform = vplMat4_Multiply(&turn, &def.transform);
                assert_int_equal(vplScene_AddObject(scene, &def, NULL), VPL_SUCCESS);
            }
            aim(scene, vplMat4_TransformPoint(&turn, (vplVec3){0.5f, 0.9f, 0.8f}),
                vplMat4_TransformPoint(&turn, (vplVec3){0, -1, 0}));
            addEmitter(scene, VPL_EMITTER_POINT, vplMat4_TransformPoint(&turn, (vplVec3){0.1f, 0.3f, 0}),
                       (vplVec3){0, 0, 0}, 1);
            vplRenderOptions o = plainOptions();
            assert_int_equal(vplRenderOptions_SetAll(&o, cases[m].words), VPL_SUCCESS);
            o.output.width = o.output.height = 48;
            pictures[twice] = renderScene(scene, &o, NULL);
            vplScene_Destroy(scene);
            vplScene_Destroy(cube);
        }
        double sum = 0, off = 0;
        for (int i = 0; i < 3 * 48 * 48; i++) {
            sum += (double)pictures[0]->pixels[i];
            off += fabs((double)pictures[0]->pixels[i] - (double)pictures[1]->pixels[i]);
        }
        assertNear(off / sum, 0, cases[m].most, cases[m].words, m);
        vplImage_Destroy(pictures[0]);
        vplImage_Destroy(pictures[1]);
    }
}

// X041: floor(0.9) is 0.
TEST(OneParticleAtNineTenthsLeavesOneLight, 1)
{
    vplGeometry* cube = closedCube(context, 0.9f);
    vplParticleDef def = vplDefaultParticleDef();
    def.particleCount = 1;
    def.reflectivity = 0.9;
    vplLightSet* set = shoot(cube, (vplVec3){0, 0, 0}, &def);
    assert_int_equal(set->lightCount, 1);
    assert_int_equal(set->stepCount, 1);
    assert_true(set->lights[0].weight == 1);
    vplLightSet_Destroy(set);
    vplGeometry_Destroy(cube);
}

// X042: where walls reflect all, every light of every step sends out what the emitter did, 4 pi W; where they
// reflect nothing, none sends anything.
TEST(WhiteWallsKeepTheFluxAndBlackOnesKeepNone, 1)
{
    for (int white = 0; white < 2; white++) {
        vplGeometry* cube = closedCube(context, (float)white);
        vplParticleDef def = vplDefaultParticleDef();
        def.particleCount = 64;
        def.reflectivity = 0.99;
        vplLightSet* set = shoot(cube, (vplVec3){0.3f, 0.1f, 0}, &def);
        assert_true(set->stepCount > 300);
        for (int i = 0; i < set->lightCount; i++) {
            assertNear((double)set->lights[i].light.r, white ? 4 * VPL_PI : 0, 1e-5, "flux", i);
        }
        vplLightSet_Destroy(set);
        vplGeometry_Destroy(cube);
    }
}

// ---- shadows

// X058: a square of the size of its distance hides the wall behind it, from 1e-9 m to 0.1 m from a light in a
// room of 2 m; beside the square the wall is lit.
TEST(ACasterHoweverNearToTheLightCastsItsShadow, 1)
{
    for (int exponent = -9; exponent < 0; exponent++) {
        const float d = powf(10, (float)exponent);
        vplScene* scene = closedCubeScene(context, 0.5f, 0);
        addThing(scene, VPL_OBJECT_QUAD, 0, (vplVec3){d, 0, 0}, 0, VPL_PI / 2, (vplVec3){d, d, 1});
        vplGeometry* g = buildGeometry(scene);
        for (int kind = 0; kind < MAP_KINDS; kind++) {
            if (kind != MAP_CUBE && kind != MAP_SOFT_CUBE && kind != MAP_REFLECTIVE_POINT) {
                continue; // maps of lights on surfaces begin above them
            }
            ShadowMap map = openMap((MapKind)kind, g, (vplVec3){0, 0, 0}, (vplVec3){1, 0, 0}, 64);
            assertNear((double)factorAt(&map, (vplVec3){1, 0, 0}, (vplVec3){-1, 0, 0}), 1, 0,
                       nameOfKind((MapKind)kind), exponent);
            assertNear((double)factorAt(&map, (vplVec3){1, 0.9f, 0}, (vplVec3){-1, 0, 0}), 0, 0,
                       nameOfKind((MapKind)kind), exponent);
            assertNear((double)factorAt(&map, (vplVec3){-1, 0, 0}, (vplVec3){1, 0, 0}), 0, 0,
                       nameOfKind((MapKind)kind), exponent);
            closeMap(&map);
        }
        vplGeometry_Destroy(g);
    }
}

// X060: planes at 1 m, 1e3 m and 1e7 m, seen by a map that begins at 1 m.
TEST(DistancesOfAMapAreRightWithNearPlanesOfATenMillionth, 1)
{
    vplScene* scene = sceneOf(context, 0.5f);
    const float x[3] = {1.0001f, -1e3f, 1e7f};
    for (int i = 0; i < 3; i++) {
        const vplVec3 place = i < 2 ? (vplVec3){x[i], 0, 0} : (vplVec3){0, x[i], 0};
        addThing(scene, VPL_OBJECT_QUAD, 0, place, i < 2 ? 0 : VPL_PI / 2, i < 2 ? VPL_PI / 2 : 0,
                 (vplVec3){fabsf(x[i]), fabsf(x[i]), 1});
    }
    vplGeometry* g = buildGeometry(scene);
    vplCubeMapDef def = vplDefaultCubeMapDef();
    def.size = 256;
    def.farPlane = 1e7f;
    def.nearPlane = 1;
    vplCubeMap* map;
    assert_int_equal(vplCubeMap_Create(g, &def, NULL, NULL, &map), VPL_SUCCESS);
    for (int i = 0; i < 3; i++) {
        const vplVec3 d = {i < 2 ? x[i] : x[i] / 512, i < 2 ? x[i] / 512 : x[i],
                           x[i] / 512}; // a texel's centre
        vplCubePoint at;
        assert_true(vplCube_Find(d, 256, &at));
        const double u = 2 * ((double)at.column + 0.5) / 256 - 1, v = 2 * ((double)at.row + 0.5) / 256 - 1;
        const double wanted = (double)fabsf(x[i]) * sqrt(1 + u * u + v * v);
        assertNear((double)vplCubeMap_Distance(map, d), wanted, 2e-7 * wanted, "distance", i);
    }
    vplCubeMap_Destroy(map);
    vplGeometry_Destroy(g);
}

// X066: the biases of a scene are those of the scene in another unit of length.
TEST(BiasGrowsWithTheScene, 1)
{
    FlatMap one, large;
    makeFlatMap(&one, context, (vplVec3){0, 0, 0}, 10, 0.5f);
    makeFlatMap(&large, context, (vplVec3){0, 0, 0}, 10000, 0.5f);
    const vplShadow shadows[4] = {exactShadow(&one.map, 16, -1), exactShadow(&large.map, 16, -1),
                                  pairShadow(&one.map, -1, -1), pairShadow(&large.map, -1, -1)};
    for (int i = 1; i <= 20; i++) {
        const float distance = 0.5f * (float)i, cosine = 0.05f * (float)i;
        for (int rule = 0; rule < 4; rule += 2) {
            const double wanted = 1000 * (double)vplShadow_Bias(&shadows[rule], distance, cosine);
            assertNear((double)vplShadow_Bias(&shadows[rule + 1], 1000 * distance, cosine), wanted,
                       3e-6 * wanted, "bias", i);
        }
    }
}

// ---- lights and pictures

// X086: the cosines at the light and at the point are rounding errors; over r^2 they would be spikes.
TEST(ALightInThePlaneOfItsReceiverGivesNothing, 1)
{
    for (int i = 0; i < 64; i++) {
        const double angle = 0.1 * i, r = pow(10, -8 + i % 16);
        const vplVec3 n = vplNormalize((vplVec3){(float)cos(angle), 0.3f, (float)sin(angle)});
        vplVec3 tangent, bitangent;
        vplTangentFrame(n, &tangent, &bitangent);
        const vplVec3 y = vplScale((float)r, vplNormalize(vplAdd(tangent, vplScale(0.7f, bitangent))));
        const vplShadeLight light = {y.x, y.y, y.z, n.x, n.y, n.z, 1, 1, 1};
        vplSurface surface;
        for (int l = 0; l < VPL_LANES; l++) {
            setPoint(&surface, l, (vplVec3){0, 0, 0}, n);
        }
        for (int bounded = 0; bounded < 2; bounded++) {
            float e[3][VPL_LANES] = {{0}};
            const vplLightFormula formula = {VPL_LIGHTING_PHYSICAL, bounded ? (float)r : 0};
            vplAccumulateLights(context, formula, &surface, &light, 1, e);
            assertNear((double)e[0][0], 0, 1e-13 / (r * r), "irradiance", i); // product of two roundings
        }
    }
}

// X112: one pixel shows the middle of the picture, by every method that lights points.
TEST(APictureOfOnePixelIsTheMiddleOfALargerOne, 1)
{
    static const vplMethod methods[] = {VPL_METHOD_DIRECT, VPL_METHOD_INSTANT_RADIOSITY,
                                        VPL_METHOD_RADIOSITY};
    vplScene* scene = loadScene(context, "room-closed.json");
    for (int m = 0; m < 3; m++) {
        for (int pipeline = 0; pipeline < 3; pipeline++) {
            vplRenderOptions o = plainOptions();
            o.method = methods[m];
            o.pipeline.kind = (vplAccumulation)pipeline;
            o.shadow.mapSize = 64;
            o.radiosity.patches = 100;
            o.output.width = o.output.height = 9;
            vplImage* nine = renderScene(scene, &o, NULL);
            o.output.width = o.output.height = 1;
            vplImage* one = renderScene(scene, &o, NULL);
            const float *wanted = &nine->pixels[3 * 40], *found = one->pixels;
            assert_true(wanted[0] > 0);
            for (int c = 0; c < 3; c++) {
                assertNear((double)found[c], (double)wanted[c], 2e-6 * (double)wanted[c], "colour",
                           3 * m + pipeline);
            }
            vplImage_Destroy(nine);
            vplImage_Destroy(one);
        }
    }
    vplScene_Destroy(scene);
}
