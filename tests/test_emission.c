// SPDX-License-Identifier: MIT
// Tests of the list of emission sources: powers against integrals, particles against the light that they
// represent.
#include "shapes.h"

#include "geometry/emission.h"
#include "math/vec.h"

typedef struct World {
    vplContext* context;
    vplScene* scene;
    vplGeometry* geometry;
    vplEmission* emission;
} World;

static World openWorld(void)
{
    World w = {.context = openTestContext(1)};
    assert_int_equal(vplScene_Create(w.context, &w.scene), VPL_SUCCESS);
    return w;
}

static void addAreaLight(const World* w, vplObjectType type, vplVec3 place, const double rotate[3],
                         vplVec3 scale, vplRgb radiance)
{
    vplMaterialDef material = vplDefaultMaterialDef();
    vplObjectDef object = vplDefaultObjectDef();
    material.emission = radiance;
    object.type = type;
    object.transform = vplMat4_FromParts(place, rotate, scale);
    assert_int_equal(vplScene_AddMaterial(w->scene, &material, &object.material), VPL_SUCCESS);
    assert_int_equal(vplScene_AddObject(w->scene, &object, NULL), VPL_SUCCESS);
}

static vplEmitterDef emitterOf(vplEmitterType type, vplRgb intensity)
{
    vplEmitterDef def = vplDefaultEmitterDef();
    def.type = type;
    def.intensity = intensity;
    def.position = (vplVec3){1, 2, 3};
    def.direction = (vplVec3){1, -2, 2}; // its length is 3
    return def;
}

static void freeze(World* w, const vplEmitterDef* emitters, int count)
{
    assert_int_equal(vplGeometry_Create(w->scene, &w->geometry), VPL_SUCCESS);
    assert_int_equal(vplEmission_Create(w->geometry, emitters, count, &w->emission), VPL_SUCCESS);
}

static void closeWorld(World* w)
{
    vplEmission_Destroy(w->emission);
    vplGeometry_Destroy(w->geometry);
    vplScene_Destroy(w->scene);
    closeTestContext(w->context);
}

static vplParticle particleAt(const World* w, uint64_t index)
{
    float u[4];
    for (int i = 0; i < 4; i++) {
        u[i] = (float)uniformAt(7, 8 * index + (uint64_t)i) * 0x1.fffffep-1f;
    }
    vplParticle p;
    assert_true(vplEmission_SampleParticle(w->emission, uniformAt(7, 8 * index + 4), u, &p));
    return p;
}

static double dot(vplVec3 a, vplVec3 b)
{
    return (double)a.x * b.x + (double)a.y * b.y + (double)a.z * b.z;
}

TEST_ALONE(PowersAreTheIntegralsOfTheirLight)
{
    const vplRgb light = {2, 1, 0.5f};
    World w = openWorld();
    vplEmitterDef emitters[5];
    for (int i = 0; i < 5; i++) {
        emitters[i] = emitterOf(VPL_EMITTER_SPOT, light);
    }
    emitters[0].type = VPL_EMITTER_POINT;
    emitters[2].innerAngle = emitters[2].outerAngle; // a sharp edge
    emitters[3].intensity = (vplRgb){0, 0, 0};       // not a source
    emitters[4].type = VPL_EMITTER_DIRECTIONAL;
    addAreaLight(&w, VPL_OBJECT_QUAD, (vplVec3){4, 5, 6}, (double[3]){1, 2, 3}, (vplVec3){2, 3, 1}, light);
    addAreaLight(&w, VPL_OBJECT_BOX, (vplVec3){-4, 5, 6}, (double[3]){3, 2, 1}, (vplVec3){1, 2, 3}, light);
    addAreaLight(&w, VPL_OBJECT_BOX, (vplVec3){0, 0, 0}, (double[3]){3, 2, 1}, (vplVec3){1, 2, 3},
                 (vplRgb){0, 0, 0});
    freeze(&w, emitters, 5);
    const vplEmission* e = w.emission;
    assert_int_equal(e->sourceCount, 4 + 2 + 12);
    assert_int_equal(e->firstTriangle, 4);
    double spot = 0; // the falloff, integrated by the midpoint rule
    const int steps = 100000;
    for (int i = 0; i < steps; i++) {
        double cosine = 1 - (i + 0.5) / steps;
        spot += 2 * VPL_PI * vplSpot_Falloff(&emitters[1], cosine) / steps;
    }
    vplVec3 d = {e->geometry->boundsMax.x - e->geometry->boundsMin.x,
                 e->geometry->boundsMax.y - e->geometry->boundsMin.y,
                 e->geometry->boundsMax.z - e->geometry->boundsMin.z};
    const double wanted[4] = {4 * VPL_PI, spot, 2 * VPL_PI * (1 - cos(emitters[2].outerAngle)),
                              VPL_PI * dot(d, d) / 4};
    double sum = 0;
    for (int i = 0; i < 4; i++) {
        assertNear((double)e->sources[i].power.r, 2 * wanted[i], 2e-6 * 2 * wanted[i], "red", i);
        assertNear((double)e->sources[i].power.b, wanted[i] / 2, 1e-6 * wanted[i], "blue", i);
        sum += wanted[i] * 3.5 / 3;
    }
    double quad = 0, box = 0;
    for (int i = 4; i < e->sourceCount; i++) {
        *(i < 6 ? &quad : &box) += (double)e->sources[i].power.g;
    }
    assertNear(quad, VPL_PI * 6, 1e-5, "quad", 0);
    assertNear(box, VPL_PI * 22, 1e-4, "box", 0);
    sum += (quad + box) * 3.5 / 3;
    assertNear(vplEmission_Power(e), sum, 2e-6 * sum, "all", 0);
    closeWorld(&w);
}

// Each source gets its share of the particles, and their total flux is its power.
TEST_ALONE(ParticlesShareThePowerAmongTheSources)
{
    World w = openWorld();
    vplEmitterDef emitters[2] = {emitterOf(VPL_EMITTER_POINT, (vplRgb){1, 0, 0}),
                                 emitterOf(VPL_EMITTER_SPOT, (vplRgb){0, 9, 3})};
    addAreaLight(&w, VPL_OBJECT_QUAD, (vplVec3){0, 0, 0}, (double[3]){0, 0, 0}, (vplVec3){1, 1, 1},
                 (vplRgb){1, 1, 4});
    freeze(&w, emitters, 2);
    enum { COUNT = 200000 };
    double flux[4] = {0};
    for (int i = 0; i < COUNT; i++) {
        vplParticle p = particleAt(&w, (uint64_t)i);
        double mean = ((double)p.flux.r + (double)p.flux.g + (double)p.flux.b) / 3;
        assertNear(mean, vplEmission_Power(w.emission), 1e-6 * mean, "mean flux", i);
        flux[p.source] += mean / COUNT;
    }
    for (int i = 0; i < 4; i++) {
        double power = w.emission->cumulative[i + 1] - w.emission->cumulative[i];
        assertNear(flux[i], power, 0.02 * power, "source", i);
    }
    closeWorld(&w);
}

TEST_ALONE(SpotParticlesFollowTheFalloff)
{
    World w = openWorld();
    vplEmitterDef spot = emitterOf(VPL_EMITTER_SPOT, (vplRgb){1, 1, 1});
    freeze(&w, &spot, 1);
    enum { COUNT = 200000, BINS = 10 };
    const double outer = cos(spot.outerAngle), solid = vplSpot_SolidAngle(&spot);
    double shares[BINS] = {0};
    vplVec3 mean = {0, 0, 0};
    for (int i = 0; i < COUNT; i++) {
        vplVec3 d = particleAt(&w, (uint64_t)i).ray.direction;
        double cosine = dot(d, w.emission->emitters[0].direction);
        assertNear(dot(d, d), 1, 1e-6, "length", i);
        assert_true(cosine > outer - 1e-6);
        int bin = (int)((cosine - outer) / (1 - outer) * BINS);
        shares[bin < 0 ? 0 : bin < BINS ? bin : BINS - 1] += 1.0 / COUNT;
        mean = (vplVec3){mean.x + d.x / COUNT, mean.y + d.y / COUNT, mean.z + d.z / COUNT};
    }
    double along = 0;
    for (int i = 0; i < BINS; i++) {
        double wanted = 0;
        for (int k = 0; k < 1000; k++) {
            double cosine = outer + (i + (k + 0.5) / 1000) / BINS * (1 - outer);
            double density = 2 * VPL_PI * vplSpot_Falloff(&spot, cosine) / solid * (1 - outer) / BINS / 1000;
            wanted += density;
            along += density * cosine;
        }
        assertNear(shares[i], wanted, 0.003, "share", i);
    }
    const float* axis = &w.emission->emitters[0].direction.x; // azimuth is uniform
    assertNear((double)mean.x, along * (double)axis[0], 3e-3, "x", 0);
    assertNear((double)mean.y, along * (double)axis[1], 3e-3, "y", 0);
    assertNear((double)mean.z, along * (double)axis[2], 3e-3, "z", 0);
    closeWorld(&w);
}

TEST_ALONE(AreaLightParticlesLeaveTheFrontByTheCosine)
{
    World w = openWorld();
    addAreaLight(&w, VPL_OBJECT_QUAD, (vplVec3){5, 0, 0}, (double[3]){0, VPL_PI / 2, 0}, (vplVec3){2, 4, 1},
                 (vplRgb){1, 1, 1}); // faces +x
    freeze(&w, NULL, 0);
    enum { COUNT = 100000 };
    double cosines = 0, y = 0, z = 0, yy = 0, zz = 0;
    for (int i = 0; i < COUNT; i++) {
        vplParticle p = particleAt(&w, (uint64_t)i);
        assert_true(p.ray.direction.x >= 0 && p.ray.skip.count == 2);
        assertNear((double)p.position.x, 5, 1e-6, "x", i);
        assertNear((double)p.normal.x, 1, 1e-6, "normal", i);
        assert_true(fabsf(p.position.y) <= 2 && fabsf(p.position.z) <= 1.000001f);
        cosines += (double)p.ray.direction.x / COUNT;
        y += (double)p.position.y / COUNT;
        z += (double)p.position.z / COUNT;
        yy += (double)p.position.y * (double)p.position.y / COUNT;
        zz += (double)p.position.z * (double)p.position.z / COUNT;
    }
    assertNear(cosines, 2.0 / 3, 0.003, "mean cosine", 0);
    assertNear(y, 0, 0.015, "y", 0);
    assertNear(z, 0, 0.008, "z", 0);
    assertNear(yy, 16.0 / 12, 0.02, "y^2", 0);
    assertNear(zz, 4.0 / 12, 0.005, "z^2", 0);
    closeWorld(&w);
}

// The flux on a floor is the directional light's irradiance times the floor's projected area.
TEST_ALONE(SunParticlesFallEvenlyOnAllThereIs)
{
    World w = openWorld();
    vplEmitterDef sun = emitterOf(VPL_EMITTER_DIRECTIONAL, (vplRgb){3, 3, 3});
    addAreaLight(&w, VPL_OBJECT_QUAD, (vplVec3){7, 8, 9}, (double[3]){-VPL_PI / 2, 0, 0}, (vplVec3){2, 2, 1},
                 (vplRgb){0, 0, 0});
    freeze(&w, &sun, 1);
    enum { COUNT = 100000 };
    double landed = 0, left = 0;
    for (int i = 0; i < COUNT; i++) {
        vplParticle p = particleAt(&w, (uint64_t)i);
        vplHit hit;
        if (vplGeometry_ClosestHit(w.geometry, &p.ray, &hit)) {
            landed += (double)p.flux.r / COUNT;
            left += hit.position.x < 7 ? (double)p.flux.r / COUNT : 0;
        }
    }
    const double wanted = 3 * 4 * 2.0 / 3; // the cosine to the light's direction is 2/3
    assertNear(landed, wanted, 0.01 * wanted, "flux", 0);
    assertNear(left, wanted / 2, 0.015 * wanted, "flux on one half", 0);
    closeWorld(&w);
}

TEST_ALONE(AnyNumbersTakeASource)
{
    World w = openWorld();
    vplEmitterDef emitters[4];
    for (int i = 0; i < 4; i++) {
        emitters[i] = emitterOf(VPL_EMITTER_POINT, (vplRgb){i & 1 ? 1e15f : 1e-15f, 0, 0});
    }
    emitters[3].intensity.r = 1e-15f; // last in the list, and below one ulp of the sum
    freeze(&w, emitters, 4);
    static const double choices[] = {0, 1e-300, 0.5, 1 - 0x1p-53};
    static const float numbers[] = {0, 0.5f, 0x1.fffffep-1f};
    for (int i = 0; i < 4; i++) {
        for (int k = 0; k < 3; k++) {
            const float u[4] = {numbers[k], numbers[k], numbers[k], numbers[k]};
            vplParticle p;
            assert_true(vplEmission_SampleParticle(w.emission, choices[i], u, &p));
            assert_true(p.source == 1 || p.source == (i < 2 ? 0 : 1));
            assert_true(isfinite(p.flux.r) && p.flux.r > 0);
            assertNear(dot(p.ray.direction, p.ray.direction), 1, 1e-6, "length", i);
        }
    }
    closeWorld(&w);
    w = openWorld();
    freeze(&w, NULL, 0);
    vplParticle p;
    assert_false(vplEmission_SampleParticle(w.emission, 0.5, (float[4]){0, 0, 0, 0}, &p));
    assertNear(vplEmission_Power(w.emission), 0, 0, "power of nothing", 0);
    closeWorld(&w);
}

// Sums of points, weighted by power: red and green of the lamps below are 3 and 2.
typedef struct PowerSum {
    double power, mean[3];
} PowerSum;

static void addPoint(PowerSum* s, const vplShadeLight* p)
{
    const double power = (double)p->g / 2;
    s->power += power;
    s->mean[0] += power * (double)p->px;
    s->mean[1] += power * (double)p->py;
    s->mean[2] += power * (double)p->pz;
}

static void checkCentred(const PowerSum* s, double area, vplVec3 place, int n)
{
    assertNear(s->power, area, 1e-5 * area, "power", n);
    assertNear(s->mean[0] / s->power, (double)place.x, 1e-5, "x", n);
    assertNear(s->mean[1] / s->power, (double)place.y, 1e-5, "y", n);
    assertNear(s->mean[2] / s->power, (double)place.z, 1e-5, "z", n);
}

static const vplVec3 LAMP_PLACES[3] = {{1, 2, 3}, {-4, 1, 0}, {0, -2, 5}},
                     LAMP_SIZES[3] = {{1, 2, 1}, {3, 0.125f, -1}, {1, 1, 1}};
static const double LAMP_AREAS[3] = {2, 0.375, 6}; // the last is a box

static void addLamp(const World* w, int i)
{
    addAreaLight(w, i == 2 ? VPL_OBJECT_BOX : VPL_OBJECT_QUAD, LAMP_PLACES[i], (double[3]){0.3 * i, 0.2, 0.1},
                 LAMP_SIZES[i], (vplRgb){3, 2, 1});
}

// Of any number of points, each lamp's carry its power, and their mean is its middle, so that a room with a
// lamp in the middle is as bright on the left as on the right. The faces of a box have numbers of points that differ by one,
// but the same power.
TEST_ALONE(PointsOnAreaLightsAreCentredForEveryNumber)
{
    World w = openWorld();
    for (int i = 0; i < 3; i++) {
        addLamp(&w, i);
    }
    freeze(&w, NULL, 0);
    static vplShadeLight points[600];
    for (int n = 24; n <= 600; n++) { // fewer may leave the smallest lamp without a point
        assert_int_equal(vplSampleAreaLights(w.emission, n, points), n);
        PowerSum sums[3] = {{0}};
        for (int i = 0; i < n; i++) {
            const vplVec3 at = {points[i].px, points[i].py, points[i].pz};
            int near = 0;
            for (int lamp = 1; lamp < 3; lamp++) {
                near = vplLength(vplSub(at, LAMP_PLACES[lamp])) < vplLength(vplSub(at, LAMP_PLACES[near]))
                           ? lamp
                           : near;
            }
            addPoint(&sums[near], &points[i]);
        }
        for (int lamp = 0; lamp < 3; lamp++) {
            checkCentred(&sums[lamp], LAMP_AREAS[lamp], LAMP_PLACES[lamp], n);
        }
    }
    closeWorld(&w);
}

// A lamp alone: a quad from one point on, a box from one point on each of its faces on.
TEST_ALONE(PointsOnALampAloneAreCentredFromTheFirstOn)
{
    for (int lamp = 0; lamp < 3; lamp++) {
        World w = openWorld();
        addLamp(&w, lamp);
        freeze(&w, NULL, 0);
        vplShadeLight points[64];
        for (int n = lamp < 2 ? 1 : 6; n <= 64; n++) {
            PowerSum sum = {0};
            assert_int_equal(vplSampleAreaLights(w.emission, n, points), n);
            for (int i = 0; i < n; i++) {
                addPoint(&sum, &points[i]);
            }
            checkCentred(&sum, LAMP_AREAS[lamp], LAMP_PLACES[lamp], n);
        }
        closeWorld(&w);
    }
}

// The same for a triangle, down to one point. All points are inside, and no two coincide.
TEST_ALONE(PointsOnATriangleAreCentredForEveryNumber)
{
    World w = openWorld();
    Shape shape = {0};
    vplMaterialDef material = vplDefaultMaterialDef();
    material.emission = (vplRgb){1, 1, 1};
    assert_int_equal(vplScene_AddMaterial(w.scene, &material, NULL), VPL_SUCCESS);
    addTriangle(&shape, vplVec(0, 0, 0), vplVec(3, 0, 0), vplVec(0, 6, 0));
    addShape(w.scene, &shape, false, NULL);
    freeShape(&shape);
    freeze(&w, NULL, 0);
    static vplShadeLight points[200];
    for (int n = 1; n <= 200; n++) {
        assert_int_equal(vplSampleAreaLights(w.emission, n, points), n);
        double x = 0, y = 0, power = 0;
        for (int i = 0; i < n; i++) {
            const vplShadeLight* p = &points[i];
            x += (double)p->px / n;
            y += (double)p->py / n;
            power += (double)p->r;
            assert_true(p->px >= 0 && p->py >= 0 && 2 * p->px + p->py <= 6 + 1e-5f && p->pz == 0);
            for (int k = 0; k < i; k++) {
                assert_true(points[k].px != p->px || points[k].py != p->py);
            }
        }
        assertNear(x, 1, 1e-6, "x", n);
        assertNear(y, 2, 1e-6, "y", n);
        assertNear(power, 9, 1e-5, "power", n);
    }
    closeWorld(&w);
}
