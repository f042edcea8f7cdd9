// SPDX-License-Identifier: MIT
// Tests of hemi-octahedral shadow maps: the content of texels, agreement with rays, and extremes.
#include "bench/band.h"
#include "shadow_maps.h"

#include "base/hash.h"
#include "base/rng.h"
#include "math/vec.h"

static vplHemiMaps* drawMaps(const vplGeometry* g, int size, const vplHemiMapPlace* places, int count)
{
    vplHemiMaps* maps;
    assert_int_equal(vplHemiMaps_Create(g->context, size, count, &maps), VPL_SUCCESS);
    assert_int_equal(vplHemiMaps_Draw(maps, g, places, count, NULL, NULL), VPL_SUCCESS);
    return maps;
}

// Returns the direction of a texel's centre.
static vplVec3 directionOf(const vplHemiMap* map, int column, int row)
{
    const float u = (float)(2 * column + 1) / (float)map->size - 1;
    const float v = (float)(2 * row + 1) / (float)map->size - 1;
    const float p = 0.5f * (u + v), q = 0.5f * (u - v);
    return vplAdd(vplAdd(vplScale(p, map->right), vplScale(q, map->up)),
                  vplScale(1 - fabsf(p) - fabsf(q), map->forward));
}

TEST(EachTexelHoldsWhatARayThroughItsCentreMeets, 2)
{
    for (int which = 0; which < 2; which++) {
        vplGeometry* g = clutter(context, which);
        Dice dice = {7, 0};
        for (int light = 0; light < 40; light++) {
            vplHit hit;
            const vplHemiMapPlace place = rollPlace(g, &dice, &hit);
            const int size = 1 + light; // sizes that are multiples of a block, and sizes that are not
            vplHemiMaps* maps = drawMaps(g, size, &place, 1);
            const vplHemiMap* map = &maps->maps[0];
            const vplVec3 from[] = {map->position, map->right, map->up};
            for (int i = 0; i < size * size; i++) {
                const vplVec3 d = directionOf(map, i % size, i / size);
                const float stored =
                    map->texels[vplHemiMap_Place(vplHemiMap_Blocks(size), i % size, i / size)];
                // At the horizon, rounding decides whether the ray hits the light's own surface.
                if (vplDot(d, map->forward) > 1e-3f && !holdsRay(g, from, d, stored)) {
                    fail_msg("scene %d, light %d, texel %d of %d^2: 1/t is %.9g", which, light, i, size,
                             (double)stored);
                }
            }
            vplHemiMaps_Destroy(maps);
        }
        vplGeometry_Destroy(g);
    }
}

// In a convex room no wall occludes another, at any position of the room: neither the surface that the light
// lies on, nor surfaces that share an edge or a corner with it.
TEST(LightsOnWallsEdgesAndCornersSeeTheWholeRoom, 1)
{
    static const vplVec3 offsets[] = {{0, 0, 0}, {1, 1, 1}, {-1, 1, 0}, {300, -20, 7}};
    for (int o = 0; o < 4; o++) {
        vplScene* scene = sceneOf(context, 0.5f);
        Shape box = gridBox(3);
        placeShape(&box, 1, (const double[]){0, 0, 0}, offsets[o]);
        addShape(scene, &box, false, NULL);
        freeShape(&box);
        vplGeometry* g = buildGeometry(scene);
        Dice dice = {5, 0};
        for (int light = 0; light < 300; light++) {
            vplVec3 at = rollVec(&dice, 1), n = {0, light & 1 ? 1 : -1, 0};
            at.y = -n.y;
            at.x = light % 3 ? at.x : at.x > 0 ? 1 : -1; // on an edge
            at.z = light % 6 ? at.z : at.z > 0 ? 1 : -1; // in a corner
            const vplHemiMapPlace place = {vplAdd(at, offsets[o]), n};
            const vplShadeLight shade = {
                place.position.x, place.position.y, place.position.z, n.x, n.y, n.z, 1, 1, 1};
            vplHemiMaps* maps = drawMaps(g, 64, &place, 1);
            for (int k = 0; k < 40; k++) {
                vplHit hit;
                const vplHemiMapPlace p = rollPlace(g, &dice, &hit);
                const vplVec3 local = vplSub(p.position, offsets[o]),
                              way = vplSub(place.position, p.position);
                // Two coordinates near 1 mean that the point lies at an edge, within the map's band. A light
                // in the plane of the point does not light it.
                float band, footprint;
                band = hemiMapBand(&maps->maps[0], p.position, p.normal, &footprint);
                const int close =
                    (fabsf(local.x) > 1 - band) + (fabsf(local.y) > 1 - band) + (fabsf(local.z) > 1 - band);
                if (vplDot(way, p.normal) > 1e-3f && vplDot(way, n) < -1e-3f) {
                    assert_false(isDark(g, &hit, &shade));
                    assert_true(close > 1 || vplHemiMap_Factor(&maps->maps[0], p.position, p.normal) == 0);
                }
            }
            vplHemiMaps_Destroy(maps);
        }
        vplGeometry_Destroy(g);
    }
}

TEST(AnEmptyHalfSpaceIsLitAndWhatLiesBehindIsNot, 1)
{
    vplGeometry* g = floorQuad(context, vplVec(0, 0, 0), 2, 0.5f);
    const vplHemiMapPlace place = {vplVec(0.3f, 0, 0.2f), vplVec(0, 1, 0)};
    vplHemiMaps* maps = drawMaps(g, 5, &place, 1);
    for (int i = 0; i < 25; i++) {
        assert_true(maps->maps[0].texels[vplHemiMap_Place(2, i % 5, i / 5)] == 0);
    }
    Dice dice = {1, 0};
    for (int i = 0; i < 100; i++) {
        const vplVec3 p = vplVec(roll(&dice, -9, 9), roll(&dice, 0.1f, 9), roll(&dice, -9, 9));
        assert_true(vplHemiMap_Factor(&maps->maps[0], p, vplNormalize(vplSub(place.position, p))) == 0);
        assert_true(vplHemiMap_Factor(&maps->maps[0], vplVec(p.x, -p.y, p.z), vplVec(0, 1, 0)) == 1);
    }
    // The light's own position must give a number, not NaN.
    const float self = vplHemiMap_Factor(&maps->maps[0], maps->maps[0].position, vplVec(0, -1, 0));
    assert_true(self == 0 || self == 1);
    vplHemiMaps_Destroy(maps);
    vplGeometry_Destroy(g);
    // An empty scene gives an empty map.
    g = buildGeometry(sceneOf(context, 0.5f));
    maps = drawMaps(g, 1, &place, 1);
    assert_true(maps->maps[0].texels[0] == 0);
    vplHemiMaps_Destroy(maps);
    vplGeometry_Destroy(g);
}

// The map's single texel looks straight up.
TEST(AMapOfOneTexelKnowsWhatIsStraightAbove, 1)
{
    for (int side = -1; side <= 1; side += 2) {
        vplGeometry* g = floorQuad(context, vplVec(0, 1, 0), 0.5f, 0.5f);
        const vplHemiMapPlace place = {vplVec(0, (float)(1 - side), 0), vplVec(0, (float)side, 0)};
        vplHemiMaps* maps = drawMaps(g, 1, &place, 1);
        assert_true(fabsf(maps->maps[0].texels[0] - 1) < 1e-5f);
        const vplVec3 n = vplVec(0, (float)-side, 0);
        assert_true(vplHemiMap_Factor(&maps->maps[0], vplVec(0, (float)(1 + 30 * side), 0), n) == 1);
        assert_true(vplHemiMap_Factor(&maps->maps[0], vplVec(0, (float)(1 - 0.5f * (float)side), 0), n) == 0);
        vplHemiMaps_Destroy(maps);
        vplGeometry_Destroy(g);
    }
}

TEST(MapsCanBeRefusedAndCancelled, 1)
{
    vplGeometry* g = closedCube(context, 0.5f);
    vplHemiMaps* maps = NULL;
    assert_int_equal(vplHemiMaps_Create(context, 0, 1, &maps), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "0 texels"));
    assert_int_equal(vplHemiMaps_Create(context, VPL_MAX_SHADOW_MAP + 1, 1, &maps), VPL_INVALID_ARGUMENT);
    assert_int_equal(vplHemiMaps_Create(context, 8, -1, &maps), VPL_INVALID_ARGUMENT);
    assert_null(maps);
    assert_int_equal(vplHemiMaps_Create(context, 8, 8, &maps), VPL_SUCCESS);
    vplHemiMapPlace places[9];
    for (int i = 0; i < 9; i++) {
        places[i] = (vplHemiMapPlace){vplVec(0, -1, 0), vplVec(0, 1, 0)};
    }
    assert_int_equal(vplHemiMaps_Draw(maps, g, places, 9, NULL, NULL), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "room for 8"));
    int asked = 0;
    assert_int_equal(vplHemiMaps_Draw(maps, g, places, 8, refuseThird, &asked), VPL_CANCELLED);
    assert_true(asked == 3);
    assert_int_equal(vplHemiMaps_Draw(maps, g, places, 0, NULL, NULL), VPL_SUCCESS);
    vplHemiMaps_Destroy(maps);
    vplHemiMaps_Destroy(NULL);
    vplGeometry_Destroy(g);
}
