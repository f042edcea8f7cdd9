// SPDX-License-Identifier: MIT
// Multisampling: each sample of a pixel shows exactly the triangle that a pixel's centre there would show.
#include "raster_support.h"

#include "base/hash.h"

#include <stdlib.h>
#include <string.h>

enum { WIDTH = 90, HEIGHT = 70, PIXELS = WIDTH * HEIGHT };

// ---- reading samples

typedef struct Samples {
    int32_t triangle[VPL_MAX_SAMPLES_PER_PIXEL][PIXELS];
} Samples;

static void storeSamples(void* data, vplTile* tile, int worker)
{
    (void)worker;
    Samples* to = data;
    for (int y = 0; y < tile->height; y++) {
        for (int x = 0; x < tile->width; x++) {
            const int element = ((y / 4) * VPL_TILE_BLOCKS + x / 4) * VPL_LANES + y % 4 * 4 + x % 4;
            for (int i = 0; i < tile->sampleCount; i++) {
                to->triangle[i][(tile->y + y) * WIDTH + tile->x + x] = tile->samples[i][element];
            }
        }
    }
}

static void drawSamples(vplContext* context, const vplPipeline* p, int triangles, int count, Samples* out)
{
    uint32_t* indices = malloc(3 * (size_t)triangles * sizeof *indices);
    for (int i = 0; i < 3 * triangles; i++) {
        indices[i] = (uint32_t)i;
    }
    const vplMesh mesh = {indices, 3 * triangles, triangles};
    vplFramebuffer f = vplDefaultFramebuffer(WIDTH, HEIGHT);
    f.samples = count;
    vplRaster* raster;
    assert_int_equal(vplRaster_Create(context, &f, &raster), VPL_SUCCESS);
    assert_int_equal(vplRaster_Draw(raster, &mesh, p), VPL_SUCCESS);
    assert_int_equal(vplRaster_TileTask(raster, storeSamples, out), VPL_SUCCESS);
    assert_int_equal(vplRaster_Run(raster, NULL, NULL, NULL), VPL_SUCCESS);
    vplRaster_Destroy(raster);
    free(indices);
}

static vplPipeline depthPipeline(const ClipVertex* v)
{
    vplPipeline p = vplDefaultPipeline();
    p.vertex = passVertices;
    p.vertexUniforms = v;
    p.varyingCount = 3;
    return p;
}

// ---- nasty triangles, in 1/256 pixel

typedef struct Corner {
    int x, y;
    float z;
} Corner;

// Slivers, triangles smaller than a pixel, corners on samples and edges through samples, and large ones.
static void rollTriangle(uint64_t seed, int i, int samples, Corner out[3])
{
    const uint64_t at = 64 * (uint64_t)i;
    const int kind = i % 5;
    const double sizes[] = {0.4, 3, 20, 90, 8}, size = 256 * sizes[kind];
    const double x = 256 * WIDTH * uniformAt(seed, at), y = 256 * HEIGHT * uniformAt(seed, at + 1);
    for (int k = 0; k < 3; k++) {
        const vplSubPixel s = vplSubPixel_OfSample((i + k) % samples, samples);
        int px = (int)(x + size * (uniformAt(seed, at + 2 + (uint64_t)k) - 0.5));
        int py = (int)(y + size * (uniformAt(seed, at + 8 + (uint64_t)k) - 0.5));
        if (kind == 4 || uniformAt(seed, at + 16 + (uint64_t)k) < 0.3) { // exactly on a sample
            px = px / 256 * 256 + 128 + s.x;
            py = py / 256 * 256 + 128 + s.y;
        }
        out[k] = (Corner){px, py, (float)uniformAt(seed, at + 24 + (uint64_t)k)};
    }
    if (kind == 1) { // a sliver
        out[2].x = (out[0].x + out[1].x) / 2 + i % 3 - 1;
        out[2].y = (out[0].y + out[1].y) / 2 + i % 2;
    }
}

static ClipVertex* placeTriangles(uint64_t seed, int triangles, int samples, vplSubPixel shift)
{
    ClipVertex* v = malloc(3 * (size_t)triangles * sizeof *v);
    for (int i = 0; i < triangles; i++) {
        Corner c[3];
        rollTriangle(seed, i, samples, c);
        for (int k = 0; k < 3; k++) {
            v[3 * i + k] = fixedVertex(c[k].x - shift.x, c[k].y - shift.y, c[k].z, WIDTH, HEIGHT);
        }
    }
    return v;
}

// The picture is moved so that each sample in turn lies in the pixels' centres.
TEST(ASampleShowsWhatACentreThereShows, 2)
{
    enum { TRIANGLES = 150 };
    static Samples samples;
    static int32_t centres[PIXELS];
    const int counts[] = {1, 4, 5, 8, 16};
    for (uint64_t seed = 0; seed < 20; seed++) {
        const int count = counts[seed % 5];
        ClipVertex* v = placeTriangles(seed, TRIANGLES, count, (vplSubPixel){0, 0});
        vplPipeline p = depthPipeline(v);
        p.cull = seed % 3 == 0 ? VPL_CULL_BACK : VPL_CULL_NONE;
        drawSamples(context, &p, TRIANGLES, count, &samples);
        free(v);
        for (int i = 0; i < count; i++) {
            v = placeTriangles(seed, TRIANGLES, count, vplSubPixel_OfSample(i, count));
            p.vertexUniforms = v;
            Canvas c = makeCanvas(WIDTH, HEIGHT, 0);
            c.framebuffer.triangles = centres;
            drawList(context, &c, &p, NULL, 3 * TRIANGLES, TRIANGLES);
            for (int k = 0; k < PIXELS; k++) {
                if (centres[k] != samples.triangle[i][k]) {
                    fail_msg("seed %d, sample %d, pixel (%d, %d): triangle %d, not %d", (int)seed, i,
                             k % WIDTH, k / WIDTH, samples.triangle[i][k], centres[k]);
                }
            }
            freeCanvas(&c);
            free(v);
        }
    }
}

// The triangles of a jittered grid are drawn one by one: each sample inside lies in one of them.
TEST(SamplesOnSharedEdgesAreCoveredOnce, 1)
{
    enum { N = 5, STEP = 11 * 256 };
    static Samples samples;
    for (uint64_t seed = 0; seed < 8; seed++) {
        static int covered[8][PIXELS];
        memset(covered, 0, sizeof covered);
        Corner grid[N * N];
        for (int i = 0; i < N * N;
             i++) { // every corner lies on a sample, and so do the edges between equal ones
            const vplSubPixel s = vplSubPixel_OfSample((int)(8 * uniformAt(seed, (uint64_t)i)), 8);
            const int x = i % N, y = i / N;
            const bool inner = x > 0 && y > 0 && x < N - 1 && y < N - 1;
            grid[i] = (Corner){128 + STEP * x + (inner ? s.x : 0), 128 + STEP * y + (inner ? s.y : 0), 0.5f};
        }
        for (int i = 0; i < 2 * (N - 1) * (N - 1); i++) {
            const int a = i / 2 / (N - 1) * N + i / 2 % (N - 1);
            const int corners[2][3] = {{a, a + 1, a + N}, {a + 1, a + N + 1, a + N}};
            ClipVertex v[3];
            for (int k = 0; k < 3; k++) {
                const Corner* c = &grid[corners[i % 2][k]];
                v[k] = fixedVertex(c->x, c->y, c->z, WIDTH, HEIGHT);
            }
            const vplPipeline p = depthPipeline(v);
            drawSamples(context, &p, 1, 8, &samples);
            for (int s = 0; s < 8; s++) {
                for (int k = 0; k < PIXELS; k++) {
                    covered[s][k] += samples.triangle[s][k] == 0;
                }
            }
        }
        const int side = STEP * (N - 1) / 256; // pixels; those along the border are cut by it
        for (int s = 0; s < 8; s++) {
            for (int k = 0; k < PIXELS; k++) {
                const int x = k % WIDTH, y = k / WIDTH;
                if (x > 0 && y > 0 && x < side && y < side) {
                    assert_int_equal(covered[s][k], 1);
                } else {
                    assert_true(covered[s][k] <= 1 && (covered[s][k] == 0 || (x <= side && y <= side)));
                }
            }
        }
    }
}

static uint64_t hashSamples(vplContext* context)
{
    enum { TRIANGLES = 2000 };
    static Samples samples;
    ClipVertex* v = makeSoup(3, TRIANGLES); // some are clipped
    const vplPipeline p = depthPipeline(v);
    drawSamples(context, &p, TRIANGLES, 8, &samples);
    free(v);
    return vplHashWords(0, (const uint32_t*)samples.triangle, 8 * (size_t)PIXELS);
}

TEST_ALONE(SamplesDoNotDependOnThreadsOrInstructionSet)
{
    uint64_t wanted = 0;
    for (int workers = 1; workers < 4; workers++) {
        vplContext* context = openTestContext(workers);
        const uint64_t hash = hashSamples(context);
        wanted = workers == 1 ? hash : wanted;
        assert_true(hash == wanted);
        closeTestContext(context);
    }
    for (int isa = VPL_ISA_SCALAR; isa < VPL_ISA_COUNT; isa++) {
        vplContext* context = openIsaContext(2, (vplIsa)isa);
        if (context != NULL) {
            assert_true(hashSamples(context) == wanted);
            closeTestContext(context);
        }
    }
    if (wanted != 0x66167dccdca564f8) { // pinned for all compilers and machines
        fail_msg("hash %016llx", (unsigned long long)wanted);
    }
}

// ---- resolving

TEST(CoverageListsEachTriangleOnce, 1)
{
    (void)context;
    int32_t shown[8] = {5, -1, 5, 7, 7, -1, 5, 9};
    vplTile tile = {.sampleCount = 8};
    for (int i = 0; i < 8; i++) {
        tile.samples[i] = &shown[i];
    }
    vplCoverage coverage[VPL_MAX_SAMPLES_PER_PIXEL];
    assert_int_equal(vplTile_GetCoverage(&tile, 0, coverage), 4);
    const vplCoverage wanted[] = {{5, 0x45}, {-1, 0x22}, {7, 0x18}, {9, 0x80}};
    for (int i = 0; i < 4; i++) {
        assert_int_equal(coverage[i].triangle, wanted[i].triangle);
        assert_int_equal(coverage[i].samples, wanted[i].samples);
    }
}

// Each row and each column of 1/N pixel has one of N samples, if N is a power of two.
TEST(SamplesAreStratifiedBothWays, 1)
{
    (void)context;
    for (int count = 1; count <= VPL_MAX_SAMPLES_PER_PIXEL; count *= 2) {
        uint32_t columns = 0, rows = 0;
        for (int i = 0; i < count; i++) {
            const vplSubPixel s = vplSubPixel_OfSample(i, count);
            assert_true(s.x >= -128 && s.x < 128 && s.y >= -128 && s.y < 128);
            columns |= 1u << (s.x + 128) * count / 256;
            rows |= 1u << (s.y + 128) * count / 256;
        }
        assert_int_equal(columns, (1ull << count) - 1);
        assert_int_equal(rows, (1ull << count) - 1);
    }
}

TEST(WhatSamplesCannotShowIsRefused, 1)
{
    const ClipVertex v[3] = {{0}};
    const uint32_t indices[3] = {0, 1, 2};
    const vplMesh mesh = {indices, 3, 1};
    vplRaster* raster;
    vplFramebuffer f = vplDefaultFramebuffer(8, 8);
    f.samples = VPL_MAX_SAMPLES_PER_PIXEL + 1;
    assert_int_equal(vplRaster_Create(context, &f, &raster), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "vplFramebuffer.samples is 17, must be in [0, 16]"));
    f.samples = 4;
    assert_int_equal(vplRaster_Create(context, &f, &raster), VPL_SUCCESS);
    vplPipeline p = depthPipeline(v);
    p.depthCompare = VPL_DEPTH_ALWAYS;
    assert_int_equal(vplRaster_Draw(raster, &mesh, &p), VPL_INVALID_ARGUMENT);
    p.depthWrite = false; // leaves the depths of samples as they are
    assert_int_equal(vplRaster_Draw(raster, &mesh, &p), VPL_SUCCESS);
    vplRaster_Destroy(raster);
}
