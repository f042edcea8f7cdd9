// SPDX-License-Identifier: MIT
// Tests of first-bounce lights from reflective shadow maps: the positions of the Hammersley points, and the
// total reflected flux.
#include "shapes.h"

#include "geometry/triangle.h"
#include "math/vec.h"

#include <stdlib.h>

static vplLightSet* sample(const vplGeometry* g, const vplReflectiveMap* const* maps, int mapCount, int count,
                           uint64_t shift)
{
    vplRsmSampleDef def = vplDefaultRsmSampleDef();
    vplLightSet* set = NULL;
    def.count = count;
    def.shift = shift;
    if (vplSampleReflectiveMaps(g, maps, mapCount, &def, &set) != VPL_SUCCESS) {
        fail_msg("%s", takeMessage());
    }
    return set;
}

static vplEmitterDef someEmitter(int k)
{
    vplEmitterDef e = vplDefaultEmitterDef();
    e.type = (vplEmitterType)k;
    e.position = vplVec(0.4f, 4.1f, 1.2f);
    e.direction = k == VPL_EMITTER_DIRECTIONAL ? vplVec(-0.3f, -0.5f, -1) : vplVec(-0.3f, -1, -0.2f);
    e.intensity = (vplRgb){1, 2, 3};
    e.outerAngle = 1.1;
    return e;
}

// Returns the green flux of the lights that belong to particles first .. end - 1, in W.
static double fluxOf(const vplLightSet* set, int first, int end)
{
    double sum = 0;
    for (int i = 0; i < set->lightCount; i++) {
        const vplVirtualLight* v = &set->lights[i];
        if (v->particle >= first && v->particle < end) {
            sum += (double)v->light.g * (double)v->weight / set->particleCount;
        }
    }
    return sum;
}

static double reflectedBy(const vplGeometry* g, const vplReflectiveMap* map)
{
    double sum = 0;
    for (int64_t i = 0; i < (int64_t)map->faceCount * map->size * map->size; i++) {
        vplReflectiveTexel t;
        sum += vplReflectiveMap_GetTexel(map, g, i, &t) ? (double)t.flux.g * (double)t.albedo.g : 0;
    }
    return sum;
}

// With as many points as texels, in a square map of a power of two, each texel is sampled once.
TEST(AsManyPointsAsTexelsMeetEachOnce, 2)
{
    vplGeometry* room = tableRoom(context);
    for (int k = 0; k < 3; k++) {
        for (int size = 1; size <= 32; size *= 2) {
            const vplEmitterDef e = someEmitter(k);
            vplReflectiveMap* map = mapOf(room, &e, size);
            const int texels = map->faceCount * size * size;
            vplLightSet* set = sample(room, (const vplReflectiveMap* const*)&map, 1, texels, 0);
            int lit = 0;
            for (int i = 0; i < texels; i++) {
                vplReflectiveTexel t;
                lit += vplReflectiveMap_GetTexel(map, room, i, &t) && t.flux.g > 0;
            }
            assert_int_equal(set->lightCount, lit);
            assertNear(fluxOf(set, 0, texels), reflectedBy(room, map), 1e-5 * reflectedBy(room, map), "flux",
                       size);
            vplLightSet_Destroy(set);
            vplReflectiveMap_Destroy(map);
        }
    }
    vplGeometry_Destroy(room);
}

// Measured: 0.025 % too much with 256 points, 0.00004 % with 4096.
TEST(AClosedRoomReflectsPowerTimesAlbedo, 2)
{
    vplGeometry* cube = closedCube(context, 0.8f);
    vplEmitterDef e = someEmitter(VPL_EMITTER_POINT);
    e.position = vplVec(0.3f, -0.2f, 0.55f);
    const double wanted = 0.8 * 4 * VPL_PI * 2;
    vplReflectiveMap* map = mapOf(cube, &e, 128);
    for (int n = 256; n <= 4096; n *= 16) {
        vplLightSet* set = sample(cube, (const vplReflectiveMap* const*)&map, 1, n, 0);
        assert_int_equal(set->lightCount, n);
        assert_int_equal(set->particleCount, n);
        assertNear(fluxOf(set, 0, n) / wanted, 1, n == 256 ? 0.0005 : 1e-5, "flux", n);
        vplLightSet_Destroy(set);
    }
    vplReflectiveMap_Destroy(map);
    vplGeometry_Destroy(cube);
}

// Seen straight from above, light k lies in the texel that contains (k/n, vdc(k)).
TEST(PointsAreThoseOfTheDocument, 1)
{
    enum { SIZE = 512 };
    vplGeometry* ground = floorQuad(context, vplVec(1, 2, 3), 8, 0.5f);
    Table t = loadTable("hammersley.csv");
    const vplEmitterDef e = {
        .type = VPL_EMITTER_DIRECTIONAL, .direction = {0, -1, 0}, .intensity = {1, 1, 1}};
    vplReflectiveMap* map = mapOf(ground, &e, SIZE);
    for (int row = 0; row < t.rows; row++) {
        const int n = (int)number(&t, row, "n"), k = (int)number(&t, row, "k");
        vplLightSet* set = sample(ground, (const vplReflectiveMap* const*)&map, 1, n, 0);
        const vplVirtualLight* light = NULL;
        for (int i = 0; i < set->lightCount; i++) {
            light = set->lights[i].particle == k ? &set->lights[i] : light;
        }
        const double x = number(&t, row, "k/n") * SIZE, y = number(&t, row, "vdc") * SIZE;
        if (light != NULL) { // the view is slightly wider than the floor
            const vplVec3 p = vplSub(light->position, map->origin);
            const double column = (vplDot(p, map->right[0]) / map->extent[0] + 1) * SIZE / 2;
            const double line = (1 - vplDot(p, map->up[0]) / map->extent[1]) * SIZE / 2;
            assertNear(column, floor(x) + 0.5, 0.02, "column", row);
            assertNear(line, floor(y) + 0.5, 0.02, "row", row);
        }
        assert_true(light != NULL || x < 1 || y < 1 || x >= SIZE - 1 || y >= SIZE - 1);
        vplLightSet_Destroy(set);
    }
    freeTable(&t);
    vplReflectiveMap_Destroy(map);
    vplGeometry_Destroy(ground);
}

// Each light lies in a triangle that the emitter sees, faces the emitter, and refers to its object.
TEST(LightsLieOnWhatIsLit, 2)
{
    vplGeometry* room = tableRoom(context);
    for (int k = 0; k < 3; k++) {
        const vplEmitterDef e = someEmitter(k);
        vplReflectiveMap* map = mapOf(room, &e, 100);
        vplLightSet* set = sample(room, (const vplReflectiveMap* const*)&map, 1, 500, 0);
        int blocked = 0;
        assert_true(set->stepCount == 1 && set->lightsInStep[0] == set->lightCount &&
                    set->stepCounts[0] == 500);
        assert_true(set->lightCount > 100 && set->rays == 0);
        for (int i = 0; i < set->lightCount; i++) {
            const vplVirtualLight* v = &set->lights[i];
            const vplVec3 way = k == VPL_EMITTER_DIRECTIONAL ? vplScale(-20, vplNormalize(e.direction))
                                                             : vplSub(e.position, v->position);
            const vplRay ray = {vplAdd(v->position, vplScale(1e-5f, v->normal)), way, {0, 0}};
            const vplGeometryObject* object = &room->objects[v->object];
            bool on = false;
            for (int t = 0; t < object->triangleCount && !on; t++) {
                const int triangle = object->firstTriangle + t;
                const vplVec3 inside = vplGeometry_Inside(room, triangle, v->position);
                const vplVec3 corner = vplGeometry_Corners(room, triangle).corner[0];
                on = vplLength(vplSub(inside, v->position)) < 1e-5f &&
                     fabsf(vplDot(vplSub(inside, corner), room->normals[triangle])) < 1e-5f;
            }
            assert_true(on && v->step == 0 && v->weight == 1 && vplDot(v->normal, way) >= 0);
            assert_true(i == 0 || v->particle > set->lights[i - 1].particle);
            blocked += vplGeometry_IsOccluded(room, &ray, 0.9999f);
        }
        assert_true(blocked <= set->lightCount / 50); // texels at edges
        vplLightSet_Destroy(set);
        vplReflectiveMap_Destroy(map);
    }
    vplGeometry_Destroy(room);
}

// Lights are shared in proportion to power and add up to n; each map's flux is right whatever its share; a
// NULL map gets none.
TEST(MapsShareTheLightsByPower, 2)
{
    vplGeometry* cube = closedCube(context, 0.5f);
    vplEmitterDef e = someEmitter(VPL_EMITTER_POINT);
    e.position = vplVec(0, 0, 0);
    vplReflectiveMap* weak = mapOf(cube, &e, 64);
    e.intensity = (vplRgb){3, 6, 9};
    vplReflectiveMap* strong = mapOf(cube, &e, 64);
    e.intensity = (vplRgb){0, 0, 0};
    vplReflectiveMap* black = mapOf(cube, &e, 64);
    const vplReflectiveMap* const maps[] = {NULL, weak, black, strong, NULL};
    for (int n = 2; n <= 4096; n *= 2) {
        vplLightSet* set = sample(cube, maps, 5, n, 0);
        assert_int_equal(set->lightCount, n);
        int first = 1; // the stronger emitter's
        while (first < n && set->lights[first].weight == set->lights[0].weight) {
            first++;
        }
        if (n >= 512) {
            assertNear((double)first / n, 0.25, 0.01, "share", n);
            assertNear(fluxOf(set, 0, n / 4 + 1) / (4 * VPL_PI), 1, 0.02, "weak flux", n);
        }
        if (n >= 64) {
            assertNear(fluxOf(set, 0, n) / (16 * VPL_PI), 1, 0.1, "flux", n);
        }
        vplLightSet_Destroy(set);
    }
    vplLightSet* one = sample(cube, maps, 5, 1, 0); // for the stronger emitter
    assert_true(one->lightCount == 1 && one->lights[0].weight == 1);
    vplLightSet_Destroy(one);
    vplReflectiveMap_Destroy(weak);
    vplReflectiveMap_Destroy(strong);
    vplReflectiveMap_Destroy(black);
    vplGeometry_Destroy(cube);
}

// The mean over many shifts is the light of all texels, with far fewer points than texels.
TEST(ShiftedPointsAreRightOnAverage, 2)
{
    enum { SHIFTS = 600, COUNT = 7 };
    vplGeometry* room = tableRoom(context);
    for (int k = 0; k < 3; k++) {
        const vplEmitterDef e = someEmitter(k);
        vplReflectiveMap* map = mapOf(room, &e, 50);
        const double wanted = reflectedBy(room, map);
        double sum = 0, squares = 0;
        for (uint64_t shift = 1; shift <= SHIFTS; shift++) {
            vplLightSet* set = sample(room, (const vplReflectiveMap* const*)&map, 1, COUNT, shift);
            const double flux = fluxOf(set, 0, COUNT) / wanted;
            sum += flux;
            squares += flux * flux;
            vplLightSet_Destroy(set);
        }
        const double mean = sum / SHIFTS, deviation = sqrt((squares / SHIFTS - mean * mean) / SHIFTS);
        assert_true(deviation > 0); // shifts must differ
        assertNear(mean, 1, 4 * deviation, "mean", k);
        vplReflectiveMap_Destroy(map);
    }
    vplGeometry_Destroy(room);
}

TEST(LightlessMapsGiveNoLights, 1)
{
    vplGeometry* black = closedCube(context, 0);
    vplGeometry* floor = floorQuad(context, vplVec(0, -5, 0), 1, 0.5f);
    const vplReflectiveMap* const none[] = {NULL};
    vplEmitterDef e = someEmitter(VPL_EMITTER_SPOT);
    e.position = vplVec(0, 0, 0);
    e.direction = vplVec(0, 1, 0); // away from the floor
    vplReflectiveMap* away = mapOf(floor, &e, 1);
    vplReflectiveMap* dark = mapOf(black, &e, 1);
    struct Case {
        const vplGeometry* geometry;
        const vplReflectiveMap* const* maps;
        int mapCount, count, escaped;
    } cases[] = {{black, (const vplReflectiveMap* const*)&dark, 1, 100, 0},   // X: black albedo
                 {floor, (const vplReflectiveMap* const*)&away, 1, 100, 100}, // the light hits nothing
                 {floor, none, 1, 100, 0},
                 {floor, NULL, 0, 100, 0},
                 {black, (const vplReflectiveMap* const*)&dark, 1, 0, 0}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        vplLightSet* set = sample(cases[i].geometry, cases[i].maps, cases[i].mapCount, cases[i].count, 0);
        assert_true(set->lightCount == 0 && set->escaped == cases[i].escaped);
        assert_int_equal(set->particleCount, cases[i].count);
        vplLightSet_Destroy(set);
    }
    vplReflectiveMap_Destroy(away);
    vplReflectiveMap_Destroy(dark);
    vplGeometry_Destroy(black);
    vplGeometry_Destroy(floor);
}

// With one texel per face, all of a face's lights lie at one point.
TEST(OneTexelIsEnough, 1)
{
    vplGeometry* cube = closedCube(context, 0.5f);
    vplEmitterDef e = someEmitter(VPL_EMITTER_POINT);
    e.position = vplVec(0, 0, 0);
    vplReflectiveMap* map = mapOf(cube, &e, 1);
    vplLightSet* set = sample(cube, (const vplReflectiveMap* const*)&map, 1, 60, 0);
    assert_int_equal(set->lightCount, 60);
    assertNear(fluxOf(set, 0, 60), 0.5 * 8 * VPL_PI, 1e-4, "flux", 0);
    for (int i = 0; i < 60; i++) {
        assertNear((double)vplLength(vplSub(set->lights[i].position, set->lights[i / 10 * 10].position)), 0,
                   0, "place", i);
    }
    vplLightSet_Destroy(set);
    vplReflectiveMap_Destroy(map);
    vplGeometry_Destroy(cube);
}

TEST_ALONE(LightsDoNotDependOnThreadsOrIsa)
{
    vplVirtualLight* wanted = NULL;
    int count = 0;
    for (int i = 0; i < 8; i++) {
        const int workers[] = {1, 2, 3, 7};
        vplContext* context =
            i < 4 ? openTestContext(workers[i]) : openIsaContext(2, (vplIsa)(VPL_ISA_SCALAR + i - 4));
        if (context == NULL) {
            continue;
        }
        vplGeometry* room = tableRoom(context);
        vplReflectiveMap* maps[3];
        for (int k = 0; k < 3; k++) {
            const vplEmitterDef e = someEmitter(k);
            maps[k] = mapOf(room, &e, 60);
        }
        vplLightSet* set = sample(room, (const vplReflectiveMap* const*)maps, 3, 2000, 9);
        float* worth = malloc((size_t)set->lightCount * sizeof *worth);
        assert_non_null(worth);
        assert_int_equal(vplMeasureUse(room, set, 7, worth), VPL_SUCCESS);
        for (int k = 0; k < set->lightCount; k++) {
            ((vplVirtualLight*)set->lights)[k].light.r += worth[k];
        }
        free(worth);
        if (wanted == NULL) {
            count = set->lightCount;
            wanted = malloc((size_t)count * sizeof *wanted);
            assert_non_null(wanted);
            memcpy(wanted, set->lights, (size_t)count * sizeof *wanted);
        }
        assert_int_equal(set->lightCount, count);
        assert_memory_equal(set->lights, wanted, (size_t)count * sizeof *wanted);
        vplLightSet_Destroy(set);
        for (int k = 0; k < 3; k++) {
            vplReflectiveMap_Destroy(maps[k]);
        }
        vplGeometry_Destroy(room);
        closeTestContext(context);
    }
    free(wanted);
}

// In a closed room all rays hit a wall, under an open sky none does, and beside a tall wall half of them do.
TEST(LightsAreWeightedByWhatTheySee, 3)
{
    vplGeometry* cube = closedCube(context, 0.5f);
    vplGeometry* ground = floorQuad(context, vplVec(0, 0, 0), 10, 0.5f);
    vplScene* scene = sceneOf(context, 0.5f);
    vplObjectDef wall = vplDefaultObjectDef(); // at z = 0
    wall.transform = vplMat4_FromParts(vplVec(0, 0, 0), (double[3]){0, 0, 0}, vplVec(1e5f, 1e5f, 1));
    assert_int_equal(vplScene_AddObject(scene, &wall, NULL), VPL_SUCCESS);
    vplGeometry* half = buildGeometry(scene);
    vplEmitterDef e = someEmitter(VPL_EMITTER_POINT);
    e.position = vplVec(0.1f, 0.5f, -0.2f);
    vplReflectiveMap *inside = mapOf(cube, &e, 16), *outside = mapOf(ground, &e, 16);
    vplLightSet* closed = sample(cube, (const vplReflectiveMap* const*)&inside, 1, 99, 0);
    vplLightSet* open = sample(ground, (const vplReflectiveMap* const*)&outside, 1, 99, 0);
    float worth[99];
    assert_int_equal(vplMeasureUse(cube, closed, 5, worth), VPL_SUCCESS);
    for (int i = 0; i < closed->lightCount; i++) {
        assertNear((double)worth[i], 1, 0, "closed", i);
    }
    assert_int_equal(vplMeasureUse(ground, open, 5, worth), VPL_SUCCESS);
    assert_true(open->lightCount > 10);
    for (int i = 0; i < open->lightCount; i++) {
        assertNear((double)worth[i], 0, 0, "open", i);
    }
    const vplVirtualLight beside = {
        .position = {0, 3, 0.01f}, .normal = {0, 1, 0}, .light = {1, 2, 3}, .weight = 1};
    const vplLightSet one = {.lights = &beside, .lightCount = 1, .particleCount = 1, .context = context};
    assert_int_equal(vplMeasureUse(half, &one, 1024, worth), VPL_SUCCESS);
    assertNear((double)worth[0], 0.5, 0.01, "half", 0);
    assert_int_equal(vplMeasureUse(half, &one, 0, worth), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "rayCount is 0"));
    vplLightSet_Destroy(closed);
    vplLightSet_Destroy(open);
    vplReflectiveMap_Destroy(inside);
    vplReflectiveMap_Destroy(outside);
    vplGeometry_Destroy(cube);
    vplGeometry_Destroy(ground);
    vplGeometry_Destroy(half);
}

// The selected lights have, on average over shifts, the weight of all lights; in a closed room nothing
// changes.
TEST(UsefulLightsStandForAll, 2)
{
    vplGeometry* cube = closedCube(context, 0.5f);
    vplEmitterDef e = someEmitter(VPL_EMITTER_POINT);
    vplReflectiveMap* map = mapOf(cube, &e, 32);
    vplLightSet* all = sample(cube, (const vplReflectiveMap* const*)&map, 1, 500, 0);
    float use[500];
    for (int i = 0; i < all->lightCount; i++) {
        use[i] = 1;
    }
    vplLightSet* same;
    assert_int_equal(vplKeepUseful(all, use, 0, &same), VPL_SUCCESS);
    assert_int_equal(same->lightCount, all->lightCount);
    assert_memory_equal(same->lights, all->lights, (size_t)all->lightCount * sizeof *all->lights);
    vplLightSet_Destroy(same);
    double flux = 0, count = 0;
    for (int i = 0; i < all->lightCount; i++) {
        use[i] = (float)(i % 17) / 16;
    }
    for (uint64_t shift = 0; shift < 1024; shift++) {
        vplLightSet* kept;
        assert_int_equal(vplKeepUseful(all, use, shift, &kept), VPL_SUCCESS);
        for (int i = 0; i < kept->lightCount; i++) {
            flux += (double)kept->lights[i].weight / 1024;
        }
        count += kept->lightCount / 1024.0;
        vplLightSet_Destroy(kept);
    }
    assertNear(flux / all->lightCount, 1, 0.02, "weights", 0);
    assertNear(count / vplCountUseful(all, use), 1, 0.01, "count", 0);
    vplLightSet_Destroy(all);
    vplReflectiveMap_Destroy(map);
    vplGeometry_Destroy(cube);
}

TEST(BadSamplesAreRefused, 1)
{
    vplGeometry* cube = closedCube(context, 0.5f);
    vplRsmSampleDef def = {.count = 4};
    vplLightSet* set = NULL;
    assert_int_equal(vplSampleReflectiveMaps(cube, NULL, 0, &def, &set), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "vplDefaultRsmSampleDef"));
    def = vplDefaultRsmSampleDef();
    assert_int_equal(def.count, 256);
    def.count = -1;
    assert_int_equal(vplSampleReflectiveMaps(cube, NULL, 0, &def, &set), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "count is -1"));
    def.count = VPL_MAX_LIGHTS + 1;
    assert_int_equal(vplSampleReflectiveMaps(cube, NULL, 0, &def, &set), VPL_INVALID_ARGUMENT);
    assert_null(set);
    vplGeometry_Destroy(cube);
}
