// SPDX-License-Identifier: MIT
// Tests of particles from all emitter types, and of scenes that combine all types.
#include "emitter_scenes.h"

// ---- all emitter types at once

static void checkAccumulations(vplContext* context, int shadows, uint64_t wanted)
{
    vplScene* scene = zoo(context, 1);
    vplRenderOptions o = zooOptions(shadows);
    for (int way = VPL_ACCUMULATE_MULTIPASS; way <= VPL_ACCUMULATE_DEFERRED; way++) {
        o.pipeline.kind = (vplAccumulation)way;
        o.pipeline.batch = 13;
        assert_true(renderHash(scene, &o) == wanted);
    }
    vplScene_Destroy(scene);
    closeTestContext(context);
}

TEST_ALONE(AccumulationsAgreeWithEveryShadow, SLOW)
{
    static const int workers[] = {1, 2, 3, 7};
    uint64_t hashes[1 + VPL_LIGHT_SHADOWS_RAY];
    for (int shadows = VPL_LIGHT_SHADOWS_NONE; shadows <= VPL_LIGHT_SHADOWS_RAY; shadows++) {
        vplContext* context = openTestContext(1);
        vplScene* scene = zoo(context, 1);
        vplRenderOptions o = zooOptions(shadows);
        hashes[shadows] = renderHash(scene, &o);
        vplScene_Destroy(scene);
        closeTestContext(context);
        for (int i = 0; i < 4; i++) {
            checkAccumulations(openTestContext(workers[i]), shadows, hashes[shadows]);
        }
        for (int isa = VPL_ISA_SCALAR; isa < VPL_ISA_COUNT; isa++) {
            context = openIsaContext(2, (vplIsa)isa);
            if (context != NULL) {
                checkAccumulations(context, shadows, hashes[shadows]);
            }
        }
    }
    assert_true(hashes[1] != hashes[2] && hashes[2] != hashes[3] && hashes[1] != hashes[3]);
}

TEST(DoublingEmittersDoublesEveryBit, 2)
{
    for (int shadows = 0; shadows < 3; shadows++) {
        vplScene *one = zoo(context, 1), *two = zoo(context, 2), *small = zoo(context, 0x1p-40f);
        const vplRenderOptions o = zooOptions(shadows);
        vplImage *a = renderScene(one, &o, NULL), *b = renderScene(two, &o, NULL),
                 *c = renderScene(small, &o, NULL);
        int lit = 0;
        for (int i = 0; i < 3 * o.output.width * o.output.height; i++) {
            assert_true(b->pixels[i] == 2 * a->pixels[i] && c->pixels[i] == 0x1p-40f * a->pixels[i]);
            lit += a->pixels[i] > 0;
        }
        assert_true(lit > 1000);
        vplImage_Destroy(a);
        vplImage_Destroy(b);
        vplImage_Destroy(c);
        vplScene_Destroy(one);
        vplScene_Destroy(two);
        vplScene_Destroy(small);
    }
}

TEST(DocumentedLightingRefusesOtherEmitters, 1)
{
    for (int type = VPL_EMITTER_SPOT; type <= VPL_EMITTER_DIRECTIONAL; type++) {
        vplScene* scene = sceneOf(context, 0.5f);
        addLevel(scene, vplVec(0, 0, 0), 10, false, 0);
        lookDown(scene, 4, 0.3);
        addColoured(scene, VPL_EMITTER_POINT, vplVec(0, 2, 0), vplVec(0, -1, 0), 1);
        addColoured(scene, (vplEmitterType)type, vplVec(0, 2, 0), vplVec(0, -1, 0), 1);
        vplRenderOptions o = zooOptions(0);
        for (int direct = 0; direct < 2; direct++) {
            vplImage* image = NULL;
            o.method = direct ? VPL_METHOD_DIRECT : VPL_METHOD_INSTANT_RADIOSITY;
            o.lighting = VPL_LIGHTING_DOCUMENTED;
            assert_int_equal(vplRender(scene, &o, &image, NULL), VPL_INVALID_ARGUMENT);
            assert_null(image);
            assert_string_equal(takeMessage(),
                                "light 1 is not a point light, and documented lighting knows no "
                                "others; use physical");
            o.lighting = VPL_LIGHTING_PHYSICAL;
            vplImage_Destroy(renderScene(scene, &o, NULL));
        }
        vplScene_Destroy(scene);
    }
}

// ---- particles

static vplLightSet* simulate(const vplGeometry* g, int particles, vplParticleGeometry geometry)
{
    vplParticleDef def = vplDefaultParticleDef();
    def.particleCount = particles;
    def.geometry = geometry;
    vplLightSet* set;
    if (vplSimulateParticles(g, NULL, 0, &def, &set) != VPL_SUCCESS) {
        fail_msg("%s", takeMessage());
    }
    return set;
}

// Makes a closed cube of 2 m with one or two area lights of different colours in it, at various rotations.
static vplScene* areaLightCube(vplContext* context, int areaLights, float rho)
{
    vplScene* scene = sceneOf(context, rho);
    vplObjectDef object = vplDefaultObjectDef();
    object.type = VPL_OBJECT_BOX;
    object.transform = vplMat4_FromParts(vplVec(0, 0, 0), (double[3]){0.2, 0.1, 0.3}, vplVec(2, 2, 2));
    assert_int_equal(vplScene_AddObject(scene, &object, NULL), VPL_SUCCESS);
    for (int i = 0; i < areaLights; i++) {
        object.type = i == 0 ? VPL_OBJECT_QUAD : VPL_OBJECT_BOX;
        object.material = addGlow(scene, i == 0 ? (vplRgb){8, 1, 0.5f} : (vplRgb){0, 1, 3}, rho);
        object.transform = vplMat4_FromParts(vplVec(0.3f * (float)(2 * i - 1), 0.2f, 0.1f),
                                             (double[3]){0.5, 0.6, 0.7 + i}, vplVec(0.4f, 0.3f, 0.2f));
        assert_int_equal(vplScene_AddObject(scene, &object, NULL), VPL_SUCCESS);
    }
    return scene;
}

// All light of the area lights reaches a wall, which reflects rho of it. The channels' mean flux of lights of
// step 0 is exact for every single particle; the flux of a colour is random, because N particles choose their
// sources.
TEST(AreaLightsShootTheirPower, 2)
{
    enum { N = 20000 };
    for (int areaLights = 1; areaLights <= 2; areaLights++) {
        vplGeometry* g = buildGeometry(areaLightCube(context, areaLights, 0.5f));
        vplEmission* emission;
        assert_int_equal(vplEmission_Create(g, NULL, 0, &emission), VPL_SUCCESS);
        const double power = vplEmission_Power(emission);
        double wanted[3] = {0}, sums[3] = {0}, first = 0;
        for (int i = 0; i < emission->sourceCount; i++) {
            const vplEmissionSource* s = &emission->sources[i];
            wanted[0] += (double)s->power.r;
            wanted[1] += (double)s->power.g;
            wanted[2] += (double)s->power.b;
            const bool red = s->power.r > s->power.b;
            first += red ? ((double)s->power.r + (double)s->power.g + (double)s->power.b) / 3 / power : 0;
        }
        vplLightSet* set = simulate(g, N, VPL_PARTICLE_GEOMETRY_EXACT);
        assert_int_equal(set->escaped, 0);
        assert_int_equal(set->lightsInStep[0], N);
        for (int i = 0; i < N; i++) {
            const vplVirtualLight* l = &set->lights[i];
            const double mean = ((double)l->light.r + (double)l->light.g + (double)l->light.b) / 3;
            assertNear(mean, 0.5 * power, 1e-6 * power, "flux", i);
            sums[0] += (double)l->light.r * (double)l->weight / N;
            sums[1] += (double)l->light.g * (double)l->weight / N;
            sums[2] += (double)l->light.b * (double)l->weight / N;
        }
        const double sigma =
            sqrt(fmax(first * (1 - first), 0) / N); // of the share of the first area light's colour
        for (int c = 0; c < 3; c++) {
            assertNear(sums[c], 0.5 * wanted[c], (1e-5 + 4 * sigma) * 3 * power, "power", c);
        }
        vplLightSet_Destroy(set);
        vplEmission_Destroy(emission);
        vplGeometry_Destroy(g);
    }
}

// The bounding boxes of boxes and quads are the objects themselves.
TEST(BoxesInsteadOfBoxesGiveTheSameLights, 2)
{
    vplGeometry* g = buildGeometry(areaLightCube(context, 2, 0.5f));
    vplLightSet* exact = simulate(g, 5000, VPL_PARTICLE_GEOMETRY_EXACT);
    vplLightSet* boxes = simulate(g, 5000, VPL_PARTICLE_GEOMETRY_OBB);
    assert_int_equal(exact->lightCount, boxes->lightCount);
    assert_int_equal(exact->escaped, boxes->escaped);
    for (int i = 0; i < exact->lightCount; i++) {
        const vplVirtualLight *a = &exact->lights[i], *b = &boxes->lights[i];
        if (a->object != b->object || memcmp(&a->position, &b->position, sizeof a->position) != 0) {
            fail_msg("light %d of step %d, particle %d: on object %d, with boxes on %d", i, a->step,
                     a->particle, a->object, b->object);
        }
        assert_memory_equal(&a->normal, &b->normal, sizeof a->normal);
        assert_memory_equal(&a->light, &b->light, sizeof a->light);
    }
    vplLightSet_Destroy(exact);
    vplLightSet_Destroy(boxes);
    vplGeometry_Destroy(g);
}

// Particles hit a sphere at its bounding box, from all sides; a sphere that emits lets its own particles out
// of the box.
TEST(ParticlesStopAtTheBoxOfAMesh, 2)
{
    for (int glows = 0; glows < 2; glows++) {
        vplScene* scene = areaLightCube(context, glows ? 0 : 1, 0.5f);
        Shape ball = icosphere(2);
        vplMeshDef mesh = vplDefaultMeshDef();
        vplObjectDef object = vplDefaultObjectDef();
        uint32_t indices[3 * 320];
        for (uint32_t i = 0; i < 3 * 320; i++) {
            indices[i] = i;
        }
        mesh.positions = ball.corners;
        mesh.indices = indices;
        mesh.vertexCount = 3 * (mesh.triangleCount = ball.triangleCount);
        object.type = VPL_OBJECT_MESH;
        object.material = glows ? addGlow(scene, (vplRgb){1, 1, 1}, 0.5f) : 0;
        object.transform =
            vplMat4_FromParts(vplVec(0.3f, -0.2f, 0.1f), (double[3]){0.4, 0, 0}, vplVec(0.4f, 0.3f, 0.3f));
        assert_int_equal(vplScene_AddMesh(scene, &mesh, &object.mesh), VPL_SUCCESS);
        int index;
        assert_int_equal(vplScene_AddObject(scene, &object, &index), VPL_SUCCESS);
        vplGeometry* g = buildGeometry(scene);
        vplLightSet* set = simulate(g, 4000, VPL_PARTICLE_GEOMETRY_OBB);
        int on = 0, first = 0;
        for (int i = 0; i < set->lightCount; i++) {
            const vplVirtualLight* l = &set->lights[i];
            if (l->object != index) {
                continue;
            }
            double largest = 0;
            for (int row = 0; row < 3; row++) {
                const double* m = g->objects[index].bounds.toLocal[row];
                largest = fmax(largest, fabs(m[0] * (double)l->position.x + m[1] * (double)l->position.y +
                                             m[2] * (double)l->position.z + m[3]));
            }
            assertNear(largest, 0.5, 1e-6, "distance from the box", i);
            first += l->step == 0;
            on++;
        }
        assert_true(on > 100 && (first > 0) == !glows);
        assert_int_equal(set->escaped, 0);
        vplLightSet_Destroy(set);
        vplGeometry_Destroy(g);
        freeShape(&ball);
    }
}

static double energyOf(const vplScene* scene, const vplRenderOptions* options)
{
    vplImage* image;
    double sum = 0;
    assert_int_equal(vplRender(scene, options, &image, NULL), VPL_SUCCESS);
    for (int i = 0; i < 3 * image->width * image->height; i++) {
        sum += (double)image->pixels[i];
    }
    vplImage_Destroy(image);
    return sum;
}

// Virtual lights with ray-traced shadows and path tracing estimate the same picture. Four seeds of 512
// particles leave about 1 % of noise in the mean (tests/bench/energy.sh: larger pictures, more particles).
TEST(EnergyIsThatOfPathTracing, 2, SLOW)
{
    static const char* const scenes[] = {"examples/scenes/room.json", "examples/scenes/room-area.json"};
    for (int i = 0; i < 2; i++) {
        vplScene* scene;
        assert_int_equal(vplScene_Load(context, scenes[i], &scene), VPL_SUCCESS);
        vplRenderOptions o = plainOptions();
        o.output.width = o.output.height = 16;
        o.path.pixel = VPL_PIXEL_CENTRE;
        o.method = VPL_METHOD_PATH;
        o.path.samples = 1024;
        const double truth = energyOf(scene, &o);
        o.method = VPL_METHOD_INSTANT_RADIOSITY;
        o.lights.shadows = VPL_LIGHT_SHADOWS_RAY;
        o.particles.sampler = VPL_SAMPLER_HALTON;
        o.particles.count = 512;
        double sum = 0;
        for (o.seed = 1; o.seed <= 4; o.seed++) {
            sum += energyOf(scene, &o);
        }
        assertNear(sum / 4 / truth, 1, 0.025, scenes[i], i);
        o.lights.shadows = VPL_LIGHT_SHADOWS_NONE; // shows light through boxes
        assert_true(energyOf(scene, &o) > 1.01 * sum / 4);
        vplScene_Destroy(scene);
    }
}
