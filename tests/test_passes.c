// SPDX-License-Identifier: MIT
// Tests of rasterizer optimisations: work that is done once for many passes must give the bits of doing it in
// every pass.
#include "raster_support.h"

#include <stdlib.h>

enum { TRIANGLES = 150, PASSES = 21 };

static const uint32_t* ascending(void)
{
    static uint32_t indices[3 * TRIANGLES];
    for (uint32_t i = 0; i < 3 * TRIANGLES; i++) {
        indices[i] = i;
    }
    return indices;
}

// Adds a value that depends on the pass, the position and the varyings.
static void addNumber(const void* uniforms, vplFragments* f)
{
    const float number = *(const float*)uniforms;
    for (int k = 0; k < 3; k++) {
        for (int l = 0; l < VPL_LANES; l++) {
            f->plane[k][l] = number * f->varying[k][l] + f->depth[l];
        }
    }
}

static void addNumbers(const void* const* uniforms, int count, vplFragments* f)
{
    for (int i = 0; i < count; i++) {
        const float number = *(const float*)uniforms[i];
        for (int k = 0; k < 3; k++) {
            for (int l = 0; l < VPL_LANES; l++) {
                f->plane[k][l] += number * f->varying[k][l] + f->depth[l];
            }
        }
    }
}

typedef enum Way { PLAIN, KEPT, FUSED, MIXED } Way;

// Draws a soup in two meshes, then passes over both, as draws that are not recognised as passes, draws that
// are, fused passes, and draws that only different masks keep from being passes.
static uint64_t drawPasses(vplContext* context, const ClipVertex* v, Way way, int64_t* fragments)
{
    static const float numbers[PASSES] = {1, 0.1f, 0.3f, 2, 7, 0.7f, 1e-3f, 5, 3, 11, 0.01f};
    const vplMesh meshes[2] = {{ascending(), 3 * TRIANGLES, TRIANGLES / 2},
                               {ascending() + 3 * (TRIANGLES / 2), 3 * TRIANGLES, TRIANGLES - TRIANGLES / 2}};
    Canvas c = makeCanvas(150, 90, 0);
    vplRaster* raster;
    assert_int_equal(vplRaster_Create(context, &c.framebuffer, &raster), VPL_SUCCESS);
    vplPipeline less = showPipeline(v);
    less.planeMask = 0;
    for (int m = 0; m < 2; m++) {
        assert_int_equal(vplRaster_Draw(raster, &meshes[m], &less), VPL_SUCCESS);
    }
    for (int i = 0; i < PASSES; i++) {
        vplPipeline pass = showPipeline(v);
        pass.fragment = way == PLAIN || way == KEPT ? addNumber : NULL;
        pass.passes = way == FUSED || way == MIXED ? addNumbers : NULL;
        pass.fragmentUniforms = &numbers[i];
        pass.depthCompare = way == PLAIN ? VPL_DEPTH_LESS_EQUAL : VPL_DEPTH_EQUAL;
        pass.depthWrite = false;
        pass.ownerTest = true;
        pass.blend = VPL_BLEND_ADD;
        pass.planeMask = way == MIXED && i == 7 ? 15 : 7;
        for (int m = 0; m < 2; m++) {
            assert_int_equal(vplRaster_Draw(raster, &meshes[m], &pass), VPL_SUCCESS);
        }
    }
    vplRasterStats stats;
    assert_int_equal(vplRaster_Run(raster, NULL, NULL, &stats), VPL_SUCCESS);
    *fragments = stats.fragments;
    vplRaster_Destroy(raster);
    memset(c.planes[3], 0, 150 * 90 * sizeof(float)); // only MIXED draws there
    const uint64_t hash = hashCanvas(&c);
    freeCanvas(&c);
    return hash;
}

TEST_ALONE(FusedPassesGiveTheBitsOfDraws)
{
    for (int threads = 1; threads <= 3; threads += 2) {
        vplContext* context = openTestContext(threads);
        for (uint64_t seed = 0; seed < 12; seed++) {
            ClipVertex* v = makeSoup(500 + seed, TRIANGLES);
            int64_t plain, fragments;
            const uint64_t expected = drawPasses(context, v, PLAIN, &plain);
            for (Way way = KEPT; way <= MIXED; way++) {
                assert_true(drawPasses(context, v, way, &fragments) == expected);
                assert_int_equal(fragments, plain);
            }
            assert_true(plain > 1000);
            free(v);
        }
        closeTestContext(context);
    }
}

static void doubleVaryings(const void* uniforms, vplFragments* f)
{
    (void)uniforms;
    for (int l = 0; l < VPL_LANES; l++) {
        f->varying[3][l] = 2 * f->varying[0][l];
        f->varying[0][l] = f->w[l];
    }
}

static void showSurface(const void* uniforms, vplFragments* f)
{
    (void)uniforms;
    for (int l = 0; l < VPL_LANES; l++) {
        f->plane[0][l] = f->varying[0][l];
        f->plane[1][l] = f->varying[3][l];
    }
}

static void showBoth(const void* uniforms, vplFragments* f)
{
    doubleVaryings(uniforms, f);
    showSurface(uniforms, f);
}

TEST(SurfaceShadersRunBeforeFragmentShaders, 1)
{
    ClipVertex* v = makeSoup(77, TRIANGLES);
    Canvas one = makeCanvas(100, 60, 0), two = makeCanvas(100, 60, 0);
    vplPipeline p = showPipeline(v);
    p.planeMask = 3;
    p.fragment = showBoth;
    drawList(context, &one, &p, ascending(), 3 * TRIANGLES, TRIANGLES);
    p.surface = doubleVaryings;
    p.surfaceCount = 4;
    p.fragment = showSurface;
    drawList(context, &two, &p, ascending(), 3 * TRIANGLES, TRIANGLES);
    assert_true(hashCanvas(&one) == hashCanvas(&two));
    freeCanvas(&one);
    freeCanvas(&two);
    free(v);
}

static void makeVaryings(const void* uniforms, vplFragments* f)
{
    (void)uniforms;
    for (int l = 0; l < VPL_LANES; l++) {
        f->varying[0][l] = (float)(f->x + l % 4);
        f->varying[3][l] = (float)(f->y + l / 4);
    }
}

static void placeVertices(const void* uniforms, int first, int count, const vplVertices* out)
{
    const ClipVertex* v = (const ClipVertex*)uniforms + first;
    for (int i = 0; i < count; i++) {
        out->x[i] = v[i].x;
        out->y[i] = v[i].y;
        out->z[i] = v[i].z;
        out->w[i] = v[i].w;
    }
}

// Surface shaders also work without varyings to interpolate.
TEST(SurfaceShadersMayMakeAllVaryings, 1)
{
    const ClipVertex v[3] = {{-1, -1, 0.5f, 1, {0}}, {3, -1, 0.5f, 1, {0}}, {-1, 3, 0.5f, 1, {0}}};
    Canvas c = makeCanvas(30, 20, -1);
    vplPipeline p = vplDefaultPipeline();
    p.vertex = placeVertices;
    p.vertexUniforms = v;
    p.surface = makeVaryings;
    p.surfaceCount = 4;
    p.fragment = showSurface;
    p.planeMask = 3;
    drawList(context, &c, &p, ascending(), 3, 1);
    for (int i = 0; i < 30 * 20; i++) {
        assert_true(c.planes[0][i] == (float)(i % 30) && c.planes[1][i] == (float)(i / 30));
    }
    freeCanvas(&c);
}

// One draw of all triangles, which skips hidden blocks, must equal one draw per triangle, which knows of no
// hidden blocks.
TEST(HiddenBlocksAreHidden, 1)
{
    for (uint64_t seed = 0; seed < 20; seed++) {
        ClipVertex* v = makeSoup(900 + seed, TRIANGLES);
        for (vplDepthCompare compare = VPL_DEPTH_LESS; compare <= VPL_DEPTH_LESS_EQUAL; compare++) {
            Canvas together = makeCanvas(200, 140, 0), apart = makeCanvas(200, 140, 0);
            vplPipeline p = showPipeline(v);
            p.depthCompare = compare;
            drawList(context, &together, &p, ascending(), 3 * TRIANGLES, TRIANGLES);
            for (int i = 0; i < TRIANGLES; i++) {
                vplPipeline own = showPipeline(v + 3 * i);
                own.depthCompare = compare;
                drawList(context, &apart, &own, ascending(), 3, 1);
                apart.framebuffer.depth.load = true;
                for (int k = 0; k < SHOWN_PLANES; k++) {
                    apart.framebuffer.planes[k].load = true;
                }
            }
            for (int k = 0; k < SHOWN_PLANES; k++) {
                if (k != 1) { // the primitive is 0 in draws of one triangle
                    assert_memory_equal(together.planes[k], apart.planes[k], 200 * 140 * sizeof(float));
                }
            }
            assert_memory_equal(together.depth, apart.depth, 200 * 140 * sizeof(float));
            freeCanvas(&together);
            freeCanvas(&apart);
        }
        free(v);
    }
}

// Depth-only draws, which have code of their own, give the depth of shaded draws, also for triangles of a few
// pixels.
TEST(DepthAloneIsTheDepthOfShadedDraws, 1)
{
    for (uint64_t seed = 0; seed < 60; seed++) {
        const int width = 20 + (int)(seed * 7), height = 200 - (int)(seed * 3); // pictures of many sizes
        ClipVertex* v = makeSoup(2100 + seed, TRIANGLES);
        Canvas one = makeCanvas(width, height, 0), two = makeCanvas(width, height, 0);
        vplPipeline p = showPipeline(v);
        const vplRasterStats shaded = drawList(context, &one, &p, ascending(), 3 * TRIANGLES, TRIANGLES);
        p.fragment = NULL;
        const vplRasterStats alone = drawList(context, &two, &p, ascending(), 3 * TRIANGLES, TRIANGLES);
        assert_memory_equal(one.depth, two.depth, (size_t)width * (size_t)height * sizeof(float));
        assert_int_equal(shaded.fragments, alone.fragments);
        freeCanvas(&one);
        freeCanvas(&two);
        free(v);
    }
}

// The document's shader: the distance from the eye, for a 90 degree view, relative to far.
static void writeDistance(const void* uniforms, vplFragments* f)
{
    const float scale = *(const float*)uniforms;
    for (int l = 0; l < VPL_LANES; l++) {
        const float s = ((float)(f->x + l % 4) + 0.5f) * (2.0f / 100) - 1;
        const float t = 1 - ((float)(f->y + l / 4) + 0.5f) * (2.0f / 100);
        f->depth[l] = f->w[l] * sqrtf(1 + s * s + t * t) * scale;
    }
}

TEST(DistancesNeedNoShader, 1)
{
    const float scale = 0.125f;
    for (uint64_t seed = 0; seed < 20; seed++) {
        ClipVertex* v = makeSoup(1300 + seed, TRIANGLES);
        Canvas one = makeCanvas(100, 100, 0), two = makeCanvas(100, 100, 0);
        one.framebuffer.depth.clear = two.framebuffer.depth.clear = INFINITY;
        vplPipeline p = showPipeline(v);
        p.planeMask = 0;
        p.fragment = writeDistance;
        p.fragmentUniforms = &scale;
        p.writesDepth = true;
        const vplRasterStats shaded = drawList(context, &one, &p, ascending(), 3 * TRIANGLES, TRIANGLES);
        p.fragment = NULL;
        p.writesDepth = false;
        p.distanceScale = scale;
        const vplRasterStats direct = drawList(context, &two, &p, ascending(), 3 * TRIANGLES, TRIANGLES);
        assert_memory_equal(one.depth, two.depth, 100 * 100 * sizeof(float));
        assert_int_equal(shaded.fragments, direct.fragments);
        freeCanvas(&one);
        freeCanvas(&two);
        free(v);
    }
}

// Writes the triangle's index over all meshes to plane 1, and w to depth.
static void nameFragments(const void* uniforms, vplFragments* f)
{
    for (int l = 0; l < VPL_LANES; l++) {
        f->plane[1][l] = (float)(*(const int*)uniforms + f->primitive);
        f->depth[l] = f->w[l];
    }
}

// Draws the soup as two meshes.
static vplRasterStats drawNamed(vplContext* context, const Canvas* canvas, const vplPipeline* pipeline,
                                int split)
{
    const int firsts[2] = {0, split};
    const vplMesh meshes[2] = {{ascending(), 3 * TRIANGLES, split},
                               {ascending() + 3 * split, 3 * TRIANGLES, TRIANGLES - split}};
    vplRaster* raster;
    vplRasterStats stats;
    assert_int_equal(vplRaster_Create(context, &canvas->framebuffer, &raster), VPL_SUCCESS);
    for (int i = 0; i < 2; i++) {
        vplPipeline p = *pipeline;
        p.fragmentUniforms = &firsts[i];
        assert_int_equal(vplRaster_Draw(raster, &meshes[i], &p), VPL_SUCCESS);
    }
    assert_int_equal(vplRaster_Run(raster, NULL, NULL, &stats), VPL_SUCCESS);
    vplRaster_Destroy(raster);
    return stats;
}

// This holds for depth from a shader and for the rasterizer's own, which is w along the axis.
TEST(FramebuffersNameWhoWroteDepthLast, 2)
{
    enum { SPLIT = 17 };
    for (uint64_t seed = 0; seed < 40; seed++) {
        const int width = 20 + (int)(seed * 9), height = 200 - (int)(seed * 4), pixels = width * height;
        ClipVertex* v = makeSoup(2100 + seed, TRIANGLES);
        int32_t *shaded = malloc((size_t)pixels * sizeof *shaded),
                *alone = malloc((size_t)pixels * sizeof *alone);
        for (int axis = 0; axis < 2; axis++) {
            Canvas one = makeCanvas(width, height, -1), two = makeCanvas(width, height, 0);
            one.framebuffer.depth.clear = two.framebuffer.depth.clear = INFINITY;
            one.framebuffer.triangles = shaded;
            two.framebuffer.triangles = alone;
            vplPipeline p = showPipeline(v);
            p.fragment = nameFragments;
            p.writesDepth = axis;
            const int64_t fragments = drawNamed(context, &one, &p, SPLIT).fragments;
            p.fragment = NULL;
            p.writesDepth = false;
            p.distanceScale = (float)axis;
            p.distanceAlongAxis = axis;
            const int64_t fragmentsAlone = drawNamed(context, &two, &p, SPLIT).fragments;
            int named = 0;
            for (int i = 0; i < pixels; i++) {
                assert_int_equal(shaded[i], (int)one.planes[1][i]);
                assert_true((alone[i] >= 0) == isfinite(two.depth[i]));
                named += shaded[i] >= 0;
                assert_int_equal(shaded[i], alone[i]);
                assert_true(one.depth[i] == two.depth[i]);
            }
            assert_true(named > pixels / 4 && fragments == fragmentsAlone);
            freeCanvas(&one);
            freeCanvas(&two);
        }
        free(shaded);
        free(alone);
        free(v);
    }
}

TEST(RastersSideBySideGiveTheBitsOfEachAlone, 3)
{
    ClipVertex* v[3];
    Canvas alone[3], together[3];
    vplRaster* rasters[3];
    vplRasterStats stats[3];
    const vplMesh mesh = {ascending(), 3 * TRIANGLES, TRIANGLES};
    for (int i = 0; i < 3; i++) {
        v[i] = makeSoup(1700 + (uint64_t)i, TRIANGLES);
        alone[i] = makeCanvas(70 + 90 * i, 130 - 40 * i, 0);
        together[i] = makeCanvas(70 + 90 * i, 130 - 40 * i, 0);
        const vplPipeline p = showPipeline(v[i]);
        assert_int_equal(vplRaster_Create(context, &together[i].framebuffer, &rasters[i]), VPL_SUCCESS);
        assert_int_equal(vplRaster_Draw(rasters[i], &mesh, &p), VPL_SUCCESS);
    }
    assert_int_equal(vplRaster_RunAll(rasters, 3, NULL, NULL, stats), VPL_SUCCESS);
    for (int i = 0; i < 3; i++) {
        const vplPipeline p = showPipeline(v[i]);
        const vplRasterStats own = drawList(context, &alone[i], &p, ascending(), 3 * TRIANGLES, TRIANGLES);
        assert_true(hashCanvas(&alone[i]) == hashCanvas(&together[i]));
        assert_int_equal(own.fragments, stats[i].fragments);
        assert_int_equal(own.trianglesBinned, stats[i].trianglesBinned);
        vplRaster_Destroy(rasters[i]);
        freeCanvas(&alone[i]);
        freeCanvas(&together[i]);
        free(v[i]);
    }
}

TEST(DrawsThatAreNoPassesAreRefused, 1)
{
    vplFramebuffer f = vplDefaultFramebuffer(4, 4);
    vplRaster* raster;
    assert_int_equal(vplRaster_Create(context, &f, &raster), VPL_SUCCESS);
    const vplMesh mesh = {NULL, 0, 0};
    vplPipeline p = vplDefaultPipeline();
    p.vertex = passVertices;
    p.passes = addNumbers;
    assert_int_equal(vplRaster_Draw(raster, &mesh, &p), VPL_INVALID_ARGUMENT);
    p.depthCompare = VPL_DEPTH_EQUAL;
    p.depthWrite = false;
    p.ownerTest = true;
    assert_int_equal(vplRaster_Draw(raster, &mesh, &p), VPL_INVALID_ARGUMENT);
    p.blend = VPL_BLEND_ADD;
    assert_int_equal(vplRaster_Draw(raster, &mesh, &p), VPL_SUCCESS);
    p.cull = VPL_CULL_BACK;
    assert_int_equal(vplRaster_Draw(raster, &mesh, &p), VPL_INVALID_ARGUMENT);
    p = vplDefaultPipeline();
    p.vertex = passVertices;
    p.distanceScale = 1;
    assert_int_equal(vplRaster_Draw(raster, &mesh, &p), VPL_SUCCESS);
    p.depthCompare = VPL_DEPTH_EQUAL;
    assert_int_equal(vplRaster_Draw(raster, &mesh, &p), VPL_INVALID_ARGUMENT);
    vplRaster_Destroy(raster);
    vplFramebuffer naming = vplDefaultFramebuffer(8, 8);
    int32_t triangles[64];
    naming.triangles = triangles;
    assert_int_equal(vplRaster_Create(context, &naming, &raster), VPL_SUCCESS);
    p = vplDefaultPipeline();
    p.vertex = passVertices;
    p.ownerTest = true;
    assert_int_equal(vplRaster_Draw(raster, &mesh, &p), VPL_INVALID_ARGUMENT);
    vplRaster_Destroy(raster);
}
