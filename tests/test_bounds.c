// SPDX-License-Identifier: MIT
// Tests of cube map bounds: they are valid for every texel, and never change a shadow.
#include "scenes.h"
#include "shapes.h"

#include "math/vec.h"
#include "visibility/blocks.h"
#include "visibility/cube_bounds.h"
#include "base/context.h"
#include "visibility/kernels.h"

#include <stdlib.h>

// Metres that a map reaches, and that of a small scene.
static const float FAR = 7, NEAR = 0.25f;

// Fills a face with random planes cut by random lines, with noise, with holes to infinity, or with rough
// patches.
static void fillFace(float* texels, int size, uint64_t seed, int kind)
{
    double n[4][6]; // a plane, and the line that clips it
    for (uint64_t k = 0; k < 24; k++) {
        n[k / 6][k % 6] = 2 * uniformAt(seed, k) - 1;
    }
    for (int j = 0; j < size; j++) {
        for (int i = 0; i < size; i++) {
            double s = (2 * i + 1.0) / size - 1, u = 1 - (2 * j + 1.0) / size, inverse = 0;
            for (int k = 0; k < 4; k++) {
                double plane = n[k][0] * s + n[k][1] * u + n[k][2] + 1.3;
                bool shown = kind == 0 || n[k][3] * s + n[k][4] * u + n[k][5] / 2 > 0;
                inverse = shown && plane > inverse ? plane : inverse;
            }
            if (kind == 2) {
                inverse *= 1 + 0.5 * uniformAt(seed + 1, (uint64_t)(j * size + i));
            }
            texels[j * size + i] = (float)(sqrt(1 + s * s + u * u) / inverse / (double)FAR);
        }
    }
}

static vplCubeMap* makeRandomMap(vplContext* context, int size, float reach, uint64_t seed)
{
    vplGeometry* g = tableRoom(context);
    vplCubeMapDef def = vplDefaultCubeMapDef();
    vplCubeMap* map;
    def.position = (vplVec3){0.25f, 1, -0.5f};
    def.size = size;
    def.farPlane = reach;
    assert_int_equal(vplCubeMap_Create(g, &def, NULL, NULL, &map), VPL_SUCCESS);
    for (int face = 0; face < 6; face++) {
        fillFace((float*)map->texels + face * size * size, size, seed + (uint64_t)face, face % 3);
    }
    vplGeometry_Destroy(g);
    assert_null(map->bounds);
    assert_int_equal(vplCubeMap_FindBounds(map), VPL_SUCCESS);
    return map;
}

static void checkRegion(const vplCubeMap* map, int face, int column, int row, int width, const float* least)
{
    const int size = map->size;
    for (int j = row; j < row + width && j < size; j++) {
        for (int i = column; i < column + width && i < size; i++) {
            const float stored = map->texels[(face * size + j) * size + i];
            const double s = (2 * i + 1.0) / size - 1, u = 1 - (2 * j + 1.0) / size;
            const double z = (double)stored * (double)map->farPlane / sqrt(1 + s * s + u * u);
            const double point[3] = {s * z, u * z, z};
            for (int k = 0; k < 3 && isfinite(stored); k++) {
                assert_true((double)least[VPL_LEAST_POINT + k] <= point[k]);
                assert_true((double)least[VPL_LEAST_NEGATED + k] <= -point[k]);
            }
            assert_true(least[VPL_LEAST_DISTANCE] <= stored);
            assert_true(least[VPL_LEAST_NEGATED_DISTANCE] <= -stored);
        }
    }
}

TEST(BoundsHoldForEveryTexel, 3, SLOW)
{
    const int sizes[] = {1, 2, 7, 15, 16, 17, 33, 64, 100, 257, 1025};
    for (int k = 0; k < 11; k++) {
        vplCubeMap* map = makeRandomMap(context, sizes[k], FAR, (uint64_t)(100 * k));
        const vplCubeBounds* bounds = map->bounds;
        assert_int_equal(bounds->side[bounds->levelCount - 1], 1);
        for (int level = 0; level < bounds->levelCount; level++) {
            const int side = bounds->side[level], step = VPL_REGION_SIDE << level;
            for (int i = 0; i < 6 * side * side; i++) {
                checkRegion(map, i / (side * side), i % side * step, i / side % side * step, step,
                            bounds->regions[bounds->first[level] + i].least);
            }
        }
        vplCubeMap_Destroy(map);
    }
}

static double pick(uint64_t seed, uint64_t* index)
{
    return uniformAt(seed, (*index)++);
}

// Returns the normal of the surface in the map around a direction, from the plane through three texels; zero
// if a texel is infinite.
static vplVec3 shownNormal(const vplCubeMap* map, vplVec3 direction)
{
    vplVec3 p[3];
    for (int k = 0; k < 3; k++) {
        vplVec3 d = direction;
        d.x += k == 1 ? 0.05f : 0;
        d.y += k == 2 ? 0.05f : 0;
        d.z += k == 0 ? 0.05f : 0;
        d = vplNormalize(d);
        p[k] = vplScale(vplCubeMap_Distance(map, d), d);
    }
    return vplNormalize(vplCross(vplSub(p[1], p[0]), vplSub(p[2], p[0])));
}

// Makes sixteen points near each other at a random position, mostly close to the depth that the map stores in
// their direction.
static void randomBlock(const vplCubeMap* map, uint64_t seed, vplSurface* surface)
{
    uint64_t at = 0;
    vplVec3 way = {(float)pick(seed, &at) - 0.5f, (float)pick(seed, &at) - 0.5f,
                   (float)pick(seed, &at) - 0.5f};
    if (seed % 5 == 0) { // near an edge of the cube
        way.y = way.x * (1 + 0.01f * (float)(pick(seed, &at) - 0.5));
    }
    const double extent = pow(10, -4 * pick(seed, &at)), how = pick(seed, &at);
    const double scale = how < 0.8 ? 1 : pow(10, 40 * pick(seed, &at) - 20);
    const vplVec3 axis = {(float)pick(seed, &at) - 0.5f, (float)pick(seed, &at) - 0.5f,
                          (float)pick(seed, &at) - 0.5f};
    const vplVec3 normal = seed % 3 == 0 ? shownNormal(map, way) : vplNormalize(axis);
    for (int l = 0; l < VPL_LANES; l++) {
        vplVec3 d = way;
        d.x += (float)(0.3 * extent * (pick(seed, &at) - 0.5));
        d.y += (float)(0.3 * extent * (pick(seed, &at) - 0.5));
        d.z += (float)(0.3 * extent * (pick(seed, &at) - 0.5));
        d = vplNormalize(d);
        float stored = vplCubeMap_Distance(map, d);
        double r = isfinite(stored) ? (double)stored : 5;
        r *= scale * (1 + 0.1 * pow(pick(seed, &at), 4) * (how < 0.4 ? 1 : -1));
        surface->px[l] = map->position.x + (float)r * d.x;
        surface->py[l] = map->position.y + (float)r * d.y;
        surface->pz[l] = map->position.z + (float)r * d.z;
        surface->nx[l] = normal.x;
        surface->ny[l] = normal.y;
        surface->nz[l] = normal.z;
    }
}

// Compares with shadows that take all samples; counts the points that needed none, and how many of those are
// in shadow.
static void compareShadows(const vplShadow* shadow, const vplSurface* surface, int64_t told[2])
{
    vplCubeMap bare = *shadow->map;
    vplShadow without = *shadow;
    float wanted[VPL_LANES], factor[VPL_LANES];
    bare.bounds = NULL;
    without.map = &bare;
    vplShadow_FactorBlock(&without, surface, wanted);
    const vplVisibilityKernels* kernels = vplVisibilityKernels_Get(bare.context->isa);
    const int count = kernels->shadowFactor(shadow, surface, factor);
    assert_memory_equal(factor, wanted, sizeof factor);
    if (count == VPL_LANES) {
        for (int l = 0; l < VPL_LANES; l++) {
            told[factor[l] > 0]++;
        }
    }
}

static vplShadow makeShadow(const vplCubeMap* map, int variant)
{
    static const int samples[] = {8, 16, 17, 64, 256, 16};
    static const float offsets[] = {0.02f, 0.05f, 0.1f, 0.002f, 1, 0, -1};
    vplShadowDef def = vplDefaultShadowDef();
    def.pcfSamples = samples[variant % 6];
    def.pcfOffset = offsets[variant / 6 % 7];
    def.biasRule = variant % 7 == 0 ? VPL_BIAS_PAIR : VPL_BIAS_EXACT;
    if (variant % 14 == 0) {
        def.biasStatic = def.biasDynamic = 0;
    }
    vplShadow shadow;
    assert_int_equal(vplShadow_Create(map, &def, &shadow), VPL_SUCCESS);
    return shadow;
}

static void compareRandomBlocks(vplCubeMap* map, int count, int64_t told[2])
{
    for (int i = 0; i < count; i++) {
        vplSurface surface;
        vplShadow shadow = makeShadow(map, i);
        randomBlock(map, (uint64_t)i, &surface);
        compareShadows(&shadow, &surface, told);
    }
}

TEST_ALONE(BoundsNeverChangeAShadowOfRandomMaps, SLOW)
{
    const int sizes[] = {1, 40, 128, 300, 1024};
    for (int isa = VPL_ISA_SCALAR; isa < VPL_ISA_COUNT; isa++) {
        vplContext* context = openIsaContext(2, (vplIsa)isa);
        int64_t told[2] = {0, 0};
        for (int k = 0; k < 5 && context != NULL; k++) {
            vplCubeMap* map = makeRandomMap(context, sizes[k], FAR, (uint64_t)(1000 + 10 * k));
            compareRandomBlocks(map, 2000, told);
            vplCubeMap_Destroy(map);
        }
        if (context != NULL) {
            assert_true(told[0] > 20000 && told[1] > 4000);
            closeTestContext(context);
        }
    }
}

// In a map that reaches less than a metre, distances in metres are smaller than the shares of the reach that are stored.
TEST(BoundsNeverChangeAShadowOfASmallScene, 1)
{
    int64_t told[2] = {0, 0};
    vplCubeMap* map = makeRandomMap(context, 128, NEAR, 3000);
    compareRandomBlocks(map, 4000, told);
    vplCubeMap_Destroy(map);
    assert_true(told[0] > 4000 && told[1] > 1000);
}

// Uses the surfaces of a real room: bounds must decide for planes where samples differ from the limit only by
// rounding.
TEST(BoundsTellMostOfARoom, 2)
{
    vplGeometry* g = tableRoom(context);
    vplCubeMapDef def = vplDefaultCubeMapDef();
    vplCubeMap* map;
    def.position = (vplVec3){0.3f, 3.5f, 0.2f};
    assert_int_equal(vplCubeMap_Create(g, &def, NULL, NULL, &map), VPL_SUCCESS);
    assert_int_equal(vplCubeMap_FindBounds(map), VPL_SUCCESS);
    int64_t told[2] = {0, 0}, all = 0;
    for (int i = 0; i < 6000; i++) {
        vplHit hit = vplGeometry_SampleTriangle(g, i % g->triangleCount, (float)uniformAt(1, (uint64_t)i),
                                                (float)uniformAt(2, (uint64_t)i));
        const vplVec3 n = hit.normal;
        const vplVec3 a = vplNormalize(vplCross(n, (vplVec3){0.3f, 0.5f, 0.8f})), b = vplCross(n, a);
        if (!(vplDot(n, vplSub(def.position, hit.position)) > 0)) {
            continue;
        }
        vplSurface s;
        for (int l = 0; l < VPL_LANES; l++) {
            vplVec3 p = vplAdd(hit.position, vplAdd(vplScale(0.004f * (float)(l & 3), a),
                                                    vplScale(0.004f * (float)(l >> 2), b)));
            s.px[l] = p.x, s.py[l] = p.y, s.pz[l] = p.z;
            s.nx[l] = n.x, s.ny[l] = n.y, s.nz[l] = n.z;
        }
        vplShadow shadow = makeShadow(map, 1 + 12 * (i % 2));
        compareShadows(&shadow, &s, told);
        all += VPL_LANES;
    }
    assert_true(all > 16 * 1000 && 2 * (told[0] + told[1]) > all);
    assert_int_equal(vplCubeMap_Redraw(map, g, &def, NULL, NULL), VPL_SUCCESS);
    assert_null(map->bounds); // they belonged to the old texels
    vplCubeMap_Destroy(map);
    vplGeometry_Destroy(g);
}
