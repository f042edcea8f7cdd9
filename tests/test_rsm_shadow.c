// SPDX-License-Identifier: MIT
// Reflective maps as shadow maps: planes do not shadow themselves, and rays say the same but near edges.
#include "shapes.h"

#include "bench/rsm_band.h"

static vplEmitterDef emitterOf(vplEmitterType type, vplVec3 position, vplVec3 direction)
{
    vplEmitterDef e = vplDefaultEmitterDef();
    e.type = type;
    e.position = position;
    e.direction = direction;
    e.outerAngle = 1.1;
    return e;
}

static void setPoint(vplSurface* s, int lane, vplVec3 p, vplVec3 n)
{
    s->px[lane] = p.x;
    s->py[lane] = p.y;
    s->pz[lane] = p.z;
    s->nx[lane] = n.x;
    s->ny[lane] = n.y;
    s->nz[lane] = n.z;
}

// A point of a triangle, as floats round it.
static vplVec3 rollOn(const vplGeometry* g, int triangle, Dice* dice)
{
    return vplGeometry_SampleTriangle(g, triangle, roll(dice, 0, 1), roll(dice, 0, 1)).position;
}

// A square of many triangles, turned anyhow; emitters that shine on it at all angles, down to a hundredth of a degree.
TEST(NoPlaneShadowsItselfAtAnyAngle, 2, SLOW)
{
    static const double degrees[] = {0, 30, 60, 80, 88, 89.5, 89.9, 89.99};
    static const int sizes[] = {1, 3, 64, 1000};
    Dice dice = {11, 0};
    for (int turn = 0; turn < 6; turn++) {
        vplScene* scene = sceneOf(context, 0.5f);
        Shape square = {0};
        for (int i = 0; i < 7 * 7; i++) {
            const float x = (float)(i % 7) - 3.5f, y = (float)(i / 7) - 3.5f;
            addTriangle(&square, vplVec(x, y, 0), vplVec(x + 1, y, 0), vplVec(x + 1, y + 1, 0));
            addTriangle(&square, vplVec(x, y, 0), vplVec(x + 1, y + 1, 0), vplVec(x, y + 1, 0));
        }
        const double rotate[3] = {turn * 1.1, turn * 0.7, turn * 2.3};
        placeShape(&square, 1.7f, rotate, rollVec(&dice, turn < 3 ? 3 : 300));
        addShape(scene, &square, false, NULL);
        vplGeometry* plane = freezeScene(scene);
        const vplVec3 n = plane->normals[0], middle = plane->positions[3 * 48];
        vplVec3 tangent, bitangent;
        vplFrame(n, &tangent, &bitangent);
        for (size_t d = 0; d < sizeof degrees / sizeof *degrees; d++) {
            const double angle = degrees[d] * VPL_PI / 180;
            const vplVec3 from = vplAdd(vplScale((float)cos(angle), n), vplScale((float)sin(angle), tangent));
            for (size_t k = 0; k < 3 * sizeof sizes / sizeof *sizes; k++) {
                const vplEmitterDef e =
                    emitterOf((vplEmitterType)(k % 3), vplAdd(middle, vplScale(15, from)), vplNegate(from));
                vplReflectiveMap* map = mapOf(plane, &e, sizes[k / 3]);
                for (int block = 0; block < 60; block++) {
                    vplSurface s;
                    float factor[VPL_LANES];
                    for (int l = 0; l < VPL_LANES; l++) {
                        const int triangle = (block * VPL_LANES + l) % plane->triangleCount;
                        setPoint(&s, l, rollOn(plane, triangle, &dice), block % 2 ? n : vplNegate(n));
                    }
                    vplReflectiveMap_FactorBlock(map, &s, factor);
                    for (int l = 0; l < VPL_LANES; l++) {
                        assertNear((double)factor[l], 0, 0, "factor", (int)(100 * d + k));
                    }
                }
                vplReflectiveMap_Destroy(map);
            }
        }
        vplGeometry_Destroy(plane);
        freeShape(&square);
    }
}

static vplEmitterDef someEmitter(int k)
{
    const vplVec3 direction =
        k == VPL_EMITTER_DIRECTIONAL ? vplVec(-0.3f, -0.5f, -1) : vplVec(-0.3f, -1, -0.2f);
    return emitterOf((vplEmitterType)k, vplVec(0.4f, 4.1f, 1.2f), direction); // the room is open in front
}

// Points of all triangles that face the emitter. Where all rays nearby agree so does the map; elsewhere rarely not.
TEST(RaysSayTheSameBeyondTheBand, 2)
{
    enum { SIZE = 200, BLOCKS = 400 };
    vplGeometry* room = tableRoom(context);
    for (int k = 0; k < 3; k++) {
        const vplEmitterDef e = someEmitter(k);
        vplReflectiveMap* map = mapOf(room, &e, SIZE);
        Dice dice = {5, 0};
        int points = 0, sure = 0, other = 0, darkOnes = 0;
        for (int block = 0; block < BLOCKS; block++) {
            vplSurface s;
            bool dark[VPL_LANES];
            float factor[VPL_LANES];
            for (int l = 0; l < VPL_LANES;) {
                const int triangle = (int)roll(&dice, 0, (float)room->triangleCount);
                const vplVec3 p = rollOn(room, triangle, &dice), n = room->normals[triangle];
                const vplVec3 way =
                    k == VPL_EMITTER_DIRECTIONAL ? vplScale(-20, e.direction) : vplSub(e.position, p);
                const vplVec3 lit = vplDot(way, n) > 0 ? n : vplNegate(n);
                const vplRay ray = {vplAdd(p, vplScale(1e-5f, lit)), way, {0, 0}};
                if (vplDot(way, lit) > 0.01f * vplLength(way) &&
                    (k != VPL_EMITTER_SPOT ||
                     vplDot(way, e.direction) < -0.5f * vplLength(way) * vplLength(e.direction))) {
                    dark[l] = vplGeometry_IsOccluded(room, &ray, 1);
                    setPoint(&s, l++, p, lit);
                }
            }
            vplReflectiveMap_FactorBlock(map, &s, factor);
            for (int l = 0; l < VPL_LANES; l++) {
                const vplVec3 p = {s.px[l], s.py[l], s.pz[l]}, n = {s.nx[l], s.ny[l], s.nz[l]};
                assert_true(factor[l] >= 0 && factor[l] <= 1);
                points++;
                darkOnes += dark[l];
                other += fabsf(factor[l] - (dark[l] ? 1.0f : 0.0f)) > 0.5f;
                if (isSure(room, map, p, n, dark[l])) {
                    sure++;
                    assertNear((double)factor[l], dark[l] ? 1 : 0, 0, "factor", k);
                }
            }
        }
        assert_true(darkOnes > points / 100);
        assert_true(sure > points * 8 / 10);
        assert_true(other < points * 3 / 100);
        vplReflectiveMap_Destroy(map);
    }
    vplGeometry_Destroy(room);
}

// Behind a spot, outside of its square and beyond everything; also for points that are no numbers.
TEST(NothingIsShadowedOutsideOfTheView, 1)
{
    vplGeometry* floor = floorQuad(context, vplVec(0, 0, 0), 10, 0.5f);
    for (int k = 0; k < 3; k++) {
        const vplEmitterDef e = emitterOf((vplEmitterType)k, vplVec(0, 2, 0), vplVec(0, -1, 0));
        vplReflectiveMap* map = mapOf(floor, &e, 16);
        const vplVec3 places[4] = {{0, 3, 0},
                                   {100, 3, 0},
                                   {0, 2, 0},
                                   {NAN, INFINITY, -INFINITY}}; // above, aside, at the emitter, nowhere
        vplSurface s;
        float factor[VPL_LANES];
        for (int l = 0; l < VPL_LANES; l++) {
            setPoint(&s, l, l < 12 ? places[l % 4] : vplVec(0, -1, 0), vplVec(0, 1, 0));
        }
        vplReflectiveMap_FactorBlock(map, &s, factor);
        for (int l = 0; l < VPL_LANES; l++) {
            assertNear((double)factor[l], l < 12 ? 0 : 1, 0, "factor", l); // below the floor it is dark
        }
        vplReflectiveMap_Destroy(map);
    }
    vplGeometry_Destroy(floor);
}

TEST_ALONE(FactorsDoNotDependOnIsa)
{
    for (int k = 0; k < 3; k++) {
        float wanted[100][VPL_LANES];
        for (int i = VPL_ISA_SCALAR; i < VPL_ISA_COUNT; i++) {
            vplContext* context = openIsaContext(2, (vplIsa)i);
            if (context == NULL) {
                continue;
            }
            vplGeometry* room = tableRoom(context);
            const vplEmitterDef e = someEmitter(k);
            vplReflectiveMap* map = mapOf(room, &e, 50);
            Dice dice = {3, 0};
            int between = 0;
            for (int block = 0; block < 100; block++) {
                vplSurface s;
                float factor[VPL_LANES];
                for (int l = 0; l < VPL_LANES; l++) {
                    const int triangle = (int)roll(&dice, 0, (float)room->triangleCount);
                    setPoint(&s, l, rollOn(room, triangle, &dice), room->normals[triangle]);
                }
                vplReflectiveMap_FactorBlock(map, &s, factor);
                if (i == VPL_ISA_SCALAR) {
                    memcpy(wanted[block], factor, sizeof factor);
                }
                assert_memory_equal(factor, wanted[block], sizeof factor);
                for (int l = 0; l < VPL_LANES; l++) {
                    between += factor[l] > 0 && factor[l] < 1;
                }
            }
            assert_true(between > 0);
            vplReflectiveMap_Destroy(map);
            vplGeometry_Destroy(room);
            closeTestContext(context);
        }
    }
}

static vplImage* shaded(const vplGeometry* g, const vplShadeDef* def, vplShadeStats* stats)
{
    vplCameraDef camera = vplDefaultCameraDef();
    camera.eye = vplVec(0.3f, 2.4f, 6);
    camera.target = vplVec(0, 2.2f, 0);
    const vplView view = vplView_Create(&camera, 90, 60);
    vplImage* image = NULL;
    if (vplImage_Create(g->context, 90, 60, &image) != VPL_SUCCESS ||
        vplShadeView(g, &view, def, NULL, NULL, image, stats) != VPL_SUCCESS) {
        fail_msg("%s", takeMessage());
    }
    return image;
}

// Direct light by the map: no ray, no cube map, the same bits in all pipelines, and little that differs from rays.
TEST(EmittersTakeTheirShadowsFromTheirMaps, 2)
{
    vplGeometry* room = tableRoom(context);
    for (int k = 0; k < 3; k++) {
        const vplEmitterDef e = someEmitter(k);
        vplReflectiveMap* map = mapOf(room, &e, 512);
        const vplReflectiveMap* const maps[] = {map};
        const vplShadow none = {0};
        vplShadeDef def = {.batch = 1, .emitters = &e, .shadows = &none, .emitterCount = 1};
        vplShadeStats stats;
        def.accumulation = VPL_ACCUMULATE_DEFERRED;
        vplImage* byRays = shaded(room, &def, &stats);
        assert_true(stats.shadowRays > 0);
        def.emitterMaps = maps;
        vplImage* byMap = shaded(room, &def, &stats);
        assert_int_equal(stats.shadowRays, 0);
        def.accumulation = VPL_ACCUMULATE_MULTIPASS;
        vplImage* multipass = shaded(room, &def, &stats);
        assert_true(vplImage_Hash(multipass) == vplImage_Hash(byMap));
        def.accumulation = VPL_ACCUMULATE_DEFERRED;
        def.output = VPL_OUTPUT_SHADOW_FACTOR;
        vplImage* factor = shaded(room, &def, &stats);
        int lit = 0, differ = 0, dark = 0;
        for (int i = 0; i < 90 * 60; i++) {
            const float a = byRays->pixels[3 * i], b = byMap->pixels[3 * i], s = factor->pixels[3 * i];
            lit += a > 0;
            dark += s == 1;
            differ += fabsf(a - b) > 0.05f * fmaxf(a, b);
            assert_true(s >= 0 && s <= 1 && !(s == 1 && b > 0));
        }
        assert_true(lit > 500 && dark > 20);
        assert_true(differ < 90 * 60 / 100);
        vplImage_Destroy(byRays);
        vplImage_Destroy(byMap);
        vplImage_Destroy(multipass);
        vplImage_Destroy(factor);
        vplReflectiveMap_Destroy(map);
    }
    vplGeometry_Destroy(room);
}
