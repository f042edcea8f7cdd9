// SPDX-License-Identifier: MIT
// Tests of reflective shadow maps used for shadows: planes do not shadow themselves, and rays agree except
// near edges.
#include "shadow_maps.h"

#include "lights/kernels.h"
#include "math/vec.h"

static vplEmitterDef emitterOf(vplEmitterType type, vplVec3 position, vplVec3 direction)
{
    vplEmitterDef e = vplDefaultEmitterDef();
    e.type = type;
    e.position = position;
    e.direction = direction;
    e.outerAngle = 1.1;
    return e;
}

static vplEmitterDef someEmitter(int k)
{
    const vplVec3 direction =
        k == VPL_EMITTER_DIRECTIONAL ? vplVec(-0.3f, -0.5f, -1) : vplVec(-0.3f, -1, -0.2f);
    return emitterOf((vplEmitterType)k, vplVec(0.4f, 4.1f, 1.2f), direction); // the room is open in front
}

// Points behind a spot, outside its square or beyond all surfaces are lit; so are positions that are not
// finite.
TEST(NothingIsShadowedOutsideOfTheView, 1)
{
    vplGeometry* floor = floorQuad(context, vplVec(0, 0, 0), 10, 0.5f);
    for (int k = 0; k < 3; k++) {
        const vplEmitterDef e = emitterOf((vplEmitterType)k, vplVec(0, 2, 0), vplVec(0, -1, 0));
        vplReflectiveMap* map = mapOf(floor, &e, 16);
        const vplVec3 places[4] = {{0, 3, 0},
                                   {100, 3, 0},
                                   {0, 2, 0},
                                   {NAN, INFINITY, -INFINITY}}; // above, beside, at the emitter, not finite
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

static vplImage* shaded(const vplGeometry* g, const vplShadeDef* def, vplShadeStats* stats)
{
    vplCameraDef camera = vplDefaultCameraDef();
    camera.eye = vplVec(0.3f, 2.4f, 6);
    camera.target = vplVec(0, 2.2f, 0);
    const vplView view = vplView_Create(&camera, 90, 60);
    vplImage* image = NULL;
    if (vplImage_Create(g->context, 90, 60, &image) != VPL_SUCCESS ||
        vplShadeView(g, &view, def, image, stats) != VPL_SUCCESS) {
        fail_msg("%s", takeMessage());
    }
    return image;
}

// Direct light by the map casts no rays and draws no cube map, has the same bits in all pipelines, and
// differs little from ray-traced shadows.
TEST(EmittersTakeTheirShadowsFromTheirMaps, 2)
{
    vplGeometry* room = tableRoom(context);
    for (int k = 0; k < 3; k++) {
        const vplEmitterDef e = someEmitter(k);
        vplReflectiveMap* map = mapOf(room, &e, 512);
        const vplReflectiveMap* const maps[] = {map};
        const vplShadow none = {0};
        vplShadeDef def = vplDefaultShadeDef();
        def.emitters = &e;
        def.shadows = &none;
        def.emitterCount = 1;
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
