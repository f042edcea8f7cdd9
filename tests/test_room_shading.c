// SPDX-License-Identifier: MIT
// Tests of direct light and the light kernel in the room of room_shading.csv, by both lightings, with and
// without visibility.
#include "scenes.h"

#include "math/vec.h"
#include "lights/light_set.h"
#include "shading/light_block.h"
#include "shading/shading.h"

// Returns the virtual lights of set A of room_particles.csv in the kernel's form.
static int tableLights(vplShadeLight* lights)
{
    Table t = loadTable("room_particles.csv");
    int count = 0;
    for (int row = 0; row < t.rows; row++) {
        if (strcmp(cell(&t, row, "set"), "A") == 0 && !isEmpty(&t, row, "px")) {
            vplVec3 n = vectorOf(&t, row, "n");
            float weight = 1 / (float)number(&t, row, "count_at_step");
            const vplVec3 p = vectorOf(&t, row, "p");
            lights[count] = (vplShadeLight){p.x, p.y, p.z, n.x, n.y, n.z, 0, 0, 0};
            lights[count].r = weight * (float)number(&t, row, "Lr");
            lights[count].g = weight * (float)number(&t, row, "Lg");
            lights[count].b = weight * (float)number(&t, row, "Lb");
            count++;
        }
    }
    freeTable(&t);
    return count;
}

static void checkRgb(const Table* t, int row, const char* prefix, const float e[3][VPL_LANES], vplRgb rho)
{
    const float* reflectance = &rho.r;
    for (int c = 0; c < 3; c++) {
        char column[24];
        snprintf(column, sizeof column, "%s_%c", prefix, "rgb"[c]);
        double wanted = number(t, row, column);
        assertNear((double)reflectance[c] / VPL_PI * (double)e[c][0], wanted, 1e-5 * wanted + 1e-9, column,
                   row);
    }
}

// True if a ray from a point of a surface, to a light on another or in the air, meets nothing between them.
static bool sees(const vplGeometry* room, vplVec3 from, vplVec3 n, vplVec3 to)
{
    const vplVec3 lifted = vplAdd(from, vplScale(1e-4f, n));
    const vplRay ray = {lifted, vplSub(to, lifted), {0, 0}};
    return vplDot(ray.direction, n) > 0 && !vplGeometry_IsOccluded(room, &ray, 0.9999f);
}

// The columns on geometry, and the physical kernel with visibility.
static void checkRow(const vplGeometry* room, const Table* t, int row, const vplShadeLight* lights, int count,
                     const vplSurface* surface, vplRgb rho)
{
    const vplVec3 light = {0, 4.5f, 0}, way = vplSub(light, vectorOf(t, row, "p"));
    const vplVec3 n = vectorOf(t, row, "n");
    const double dist = number(t, row, "dist"), facing = number(t, row, "n_dot_l");
    assertNear((double)vplLength(way), dist, 1e-6 * dist, "dist", row);
    assertNear(fmax((double)vplDot(n, vplNormalize(way)), 0), facing, 3e-7, "n_dot_l", row);
    assert_true(sees(room, vectorOf(t, row, "p"), n, light) ==
                (number(t, row, "visible_from_light") == 1 && facing > 0));
    vplShadeLight seen[18];
    int seenCount = 0;
    for (int i = 0; i < count; i++) {
        if (sees(room, vectorOf(t, row, "p"), n, vplVec(lights[i].px, lights[i].py, lights[i].pz))) {
            seen[seenCount++] = lights[i];
        }
    }
    float e[3][VPL_LANES] = {{0}};
    vplAccumulateLights(room->context, (vplLightFormula){VPL_LIGHTING_PHYSICAL, 0}, surface, seen, seenCount,
                        e);
    checkRgb(t, row, "kernelGV", e, rho);
}

TEST(EveryPointOfTheRoomIsLitAsTheTableSays, 2)
{
    Table t = loadTable("room_shading.csv"), objects = loadTable("room_objects.csv");
    vplGeometry* room = tableRoom(context);
    vplShadeLight lights[18];
    int count = tableLights(lights);
    vplEmitterDef emitter = vplDefaultEmitterDef();
    emitter.position = vplVec(0, 4.5f, 0);
    emitter.intensity = (vplRgb){10, 10, 10};
    vplCubeMapDef mapDef = vplDefaultCubeMapDef();
    mapDef.position = emitter.position;
    vplCubeMap* map;
    assert_int_equal(vplCubeMap_Create(room, &mapDef, NULL, NULL, &map), VPL_SUCCESS);
    vplShadowDef shadowDef = vplDefaultShadowDef();
    shadowDef.pcfSamples = 1;
    vplShadow shadow;
    assert_int_equal(vplShadow_Create(map, &shadowDef, &shadow), VPL_SUCCESS);
    for (int row = 0; row < t.rows; row++) {
        vplSurface surface;
        for (int l = 0; l < VPL_LANES; l++) {
            vplSurface_Put(&surface, l, vectorOf(&t, row, "p"), vectorOf(&t, row, "n"));
        }
        vplRgb rho = {0, 0, 0};
        for (int i = 0; i < objects.rows; i++) {
            if (strcmp(cell(&objects, i, "name"), cell(&t, row, "object")) == 0) {
                rho = (vplRgb){(float)number(&objects, i, "rho_r"), (float)number(&objects, i, "rho_g"),
                               (float)number(&objects, i, "rho_b")};
            }
        }
        vplShadeDef def = vplDefaultShadeDef();
        def.lighting = VPL_LIGHTING_DOCUMENTED;
        def.emitters = &emitter;
        def.shadows = &shadow;
        def.emitterCount = 1;
        def.particleCount = 10;
        vplEmitterRay ray = {.position = emitter.position};
        vplShading shading = vplShading_Make(room, NULL, &def);
        shading.direct.rays = &ray;
        vplPoints points = {.surface = &surface, .plane = &surface};
        int64_t rays = 0;
        float e[3][VPL_LANES];
        vplDirectIrradiance(&shading, &shading.direct, &points, e, &rays);
        checkRgb(&t, row, "doc_direct", e, rho);
        def.lighting = VPL_LIGHTING_PHYSICAL;
        shading = vplShading_Make(room, NULL, &def);
        shading.direct.rays = &ray;
        ray.falloff = true;
        vplDirectIrradiance(&shading, &shading.direct, &points, e, &rays);
        checkRgb(&t, row, "phys_direct", e, rho);
        memset(e, 0, sizeof e);
        vplAccumulateLights(context, (vplLightFormula){VPL_LIGHTING_DOCUMENTED, 0}, &surface, lights, count,
                            e);
        checkRgb(&t, row, "doc_indirect", e, rho);
        memset(e, 0, sizeof e);
        vplAccumulateLights(context, (vplLightFormula){VPL_LIGHTING_PHYSICAL, 0}, &surface, lights, count, e);
        checkRgb(&t, row, "kernelG", e, rho);
        checkRow(room, &t, row, lights, count, &surface, rho);
    }
    assert_int_equal(t.rows, 14);
    vplCubeMap_Destroy(map);
    vplGeometry_Destroy(room);
    freeTable(&objects);
    freeTable(&t);
}
