// SPDX-License-Identifier: MIT
// Tests of the rasterizer's properties that hold for any triangles.
#include "failing.h"
#include "raster_support.h"

#include "base/hash.h"

#include <stdlib.h>

// X082: a pass with EQUAL finds the bits that LESS left, on every instruction set.
static void checkEqual(vplContext* context)
{
    for (uint64_t seed = 0; seed < 100; seed++) {
        ClipVertex* v = makeSoup(seed, 120);
        uint32_t indices[360];
        for (uint32_t i = 0; i < 360; i++) {
            indices[i] = i;
        }
        vplMesh mesh = {indices, 360, 120};
        Canvas c = makeCanvas(90, 70, 0);
        c.framebuffer.planes[0].clear = -1;
        vplPipeline less = showPipeline(v), equal = showPipeline(v);
        less.planeMask = 2; // writes the owner to plane 1
        equal.depthCompare = VPL_DEPTH_EQUAL;
        equal.depthWrite = false;
        equal.blend = VPL_BLEND_ADD;
        equal.planeMask = 1; // adds one per pass to plane 0, from -1
        vplRaster* raster;
        assert_int_equal(vplRaster_Create(context, &c.framebuffer, &raster), VPL_SUCCESS);
        assert_int_equal(vplRaster_Draw(raster, &mesh, &less), VPL_SUCCESS);
        for (int pass = 0; pass < 3; pass++) {
            equal.ownerTest = pass == 2; // without and with the owner test
            assert_int_equal(vplRaster_Draw(raster, &mesh, &equal), VPL_SUCCESS);
        }
        assert_int_equal(vplRaster_Run(raster, NULL, NULL, NULL), VPL_SUCCESS);
        for (int i = 0; i < 90 * 70; i++) {
            float wanted = c.depth[i] < 1 ? 2 : -1;
            if (c.planes[0][i] != wanted) {
                fail_msg("seed %d, pixel (%d, %d): EQUAL passes left %g, wanted %g", (int)seed, i % 90,
                         i / 90, (double)c.planes[0][i], (double)wanted);
            }
        }
        vplRaster_Destroy(raster);
        freeCanvas(&c);
        free(v);
    }
}

// X082
TEST_ALONE(EqualTouchesExactlyWhatLessLeft)
{
    for (vplIsa isa = VPL_ISA_SCALAR; isa < VPL_ISA_COUNT; isa++) {
        vplContext* context = openIsaContext(2, isa);
        if (context != NULL) {
            checkEqual(context);
            closeTestContext(context);
        }
    }
}

// X083: of surfaces at equal depths, EQUAL alone lets all pass; the owner test only the first that was drawn.
TEST(OfCoplanarSurfacesOneIsTheOwner, 1)
{
    static const uint32_t indices[9] = {0, 1, 2, 1, 2, 0, 0, 1, 2}; // thrice the same triangle
    ClipVertex* v = makeSoup(7, 1);
    for (int i = 0; i < 3; i++) { // covers the picture
        const float x = i == 1 ? 3 : -1, y = i == 2 ? 3 : -1;
        v[i] = (ClipVertex){.x = x, .y = y, .z = 0.4f + 0.1f * x + 0.05f * y, .w = 1};
    }
    for (int owned = 0; owned < 2; owned++) {
        Canvas c = makeCanvas(90, 70, 0);
        vplPipeline less = showPipeline(v), equal = showPipeline(v);
        less.planeMask = 2;
        equal.depthCompare = VPL_DEPTH_EQUAL;
        equal.depthWrite = false;
        equal.blend = VPL_BLEND_ADD;
        equal.planeMask = 1;
        equal.ownerTest = owned;
        vplRaster* raster;
        assert_int_equal(vplRaster_Create(context, &c.framebuffer, &raster), VPL_SUCCESS);
        vplMesh mesh = {indices, .vertexCount = 3, .triangleCount = 3};
        assert_int_equal(vplRaster_Draw(raster, &mesh, &less), VPL_SUCCESS);
        assert_int_equal(vplRaster_Draw(raster, &mesh, &equal), VPL_SUCCESS);
        assert_int_equal(vplRaster_Run(raster, NULL, NULL, NULL), VPL_SUCCESS);
        for (int i = 0; i < 90 * 70; i++) {
            assertNear((double)c.planes[0][i], owned ? 1 : 3, 0, "surfaces", i);
            assertNear((double)c.planes[1][i], (double)c.planes[1][0], 0, "owner", i);
        }
        vplRaster_Destroy(raster);
        freeCanvas(&c);
    }
    free(v);
}

// X071
// A grid of jittered vertices fills a rectangle: every pixel centre inside is covered by exactly one
// triangle, whatever the jitter, the diagonals and the windings.
TEST(SharedEdgeIsCoveredOnce, 1)
{
    enum { N = 9 };
    for (uint64_t seed = 0; seed < 60; seed++) {
        ClipVertex v[N * N];
        uint32_t indices[6 * (N - 1) * (N - 1)];
        int count = 0;
        for (int i = 0; i < N * N; i++) {
            int x = i % N, y = i / N;
            bool inner = x > 0 && y > 0 && x < N - 1 && y < N - 1;
            double jx = inner ? uniformAt(seed, (uint64_t)i * 4) - 0.5 : 0;
            double jy = inner ? uniformAt(seed, (uint64_t)i * 4 + 1) - 0.5 : 0;
            int step = seed % 2 ? 8 * 256 : 8 * 256 + 37; // vertices on pixel centres, or off them
            v[i] = fixedVertex(128 + (int)(step * (x + 0.45 * jx)), 128 + (int)(step * (y + 0.45 * jy)), 0.5f,
                               80, 80);
        }
        for (int i = 0; i < (N - 1) * (N - 1); i++) {
            uint32_t a = (uint32_t)(i / (N - 1) * N + i % (N - 1)), b = a + 1, c = a + N, d = c + 1;
            bool flip = uniformAt(seed, 1000 + (uint64_t)i) < 0.5;
            const uint32_t tris[2][6] = {{a, b, c, b, d, c}, {a, d, c, a, d, b}};
            memcpy(indices + 6 * i, tris[flip], sizeof tris[0]);
            count += 2;
        }
        Canvas c = makeCanvas(80, 80, 0);
        vplPipeline p = showPipeline(v);
        p.blend = VPL_BLEND_ADD;
        p.depthCompare = VPL_DEPTH_ALWAYS;
        drawList(context, &c, &p, indices, N * N, count);
        int side = seed % 2 ? 64 : 66; // pixel centres inside; the fill rule excludes right and bottom edges
        for (int i = 0; i < 80 * 80; i++) {
            bool inside = i % 80 < side && i / 80 < side;
            assertNear((double)c.planes[0][i], inside, 0, "times drawn", i);
        }
        freeCanvas(&c);
    }
}

static uint64_t soupHash(vplContext* context, uint64_t seed)
{
    enum { TRIANGLES = 3000 };
    ClipVertex* v = makeSoup(seed, TRIANGLES);
    Canvas c = makeCanvas(217, 131, 0);
    vplPipeline p = showPipeline(v);
    vplRasterStats stats = drawList(context, &c, &p, NULL, 3 * TRIANGLES, TRIANGLES);
    uint64_t hash = hashCanvas(&c) ^ (uint64_t)stats.fragments;
    freeCanvas(&c);
    free(v);
    return hash;
}

TEST_ALONE(BitsDoNotDependOnThreadsOrInstructionSet)
{
    for (uint64_t seed = 0; seed < 3; seed++) {
        uint64_t wanted = 0;
        const int workers[] = {1, 2, 3, 7};
        for (int i = 0; i < 4; i++) {
            vplContext* context = openTestContext(workers[i]);
            uint64_t hash = soupHash(context, seed);
            wanted = i == 0 ? hash : wanted;
            assert_true(hash == wanted);
            closeTestContext(context);
        }
        for (int isa = VPL_ISA_SCALAR; isa < VPL_ISA_COUNT; isa++) {
            vplContext* context = openIsaContext(2, (vplIsa)isa);
            if (context != NULL) {
                assert_true(soupHash(context, seed) == wanted);
                closeTestContext(context);
            }
        }
    }
}

// The expected hash is fixed: compiler, optimisation level and architecture must not change it.
TEST(BitsOfASoupArePinned, 2)
{
    uint64_t hash = soupHash(context, 1);
    if (hash != 0x550d0e9675ed53fa) {
        fail_msg("hash %016llx", (unsigned long long)hash);
    }
}

TEST(CullingKeepsOneSide, 1)
{
    ClipVertex v[6] = {fixedVertex(0, 0, 0.5f, 16, 16),       fixedVertex(0, 4096, 0.5f, 16, 16),
                       fixedVertex(2048, 0, 0.5f, 16, 16), // counter-clockwise as seen
                       fixedVertex(4096, 4096, 0.5f, 16, 16), fixedVertex(2048, 4096, 0.5f, 16, 16),
                       fixedVertex(4096, 0, 0.5f, 16, 16)}; // clockwise as seen
    int64_t fragments[3];
    for (int cull = 0; cull < 3; cull++) {
        Canvas c = makeCanvas(16, 16, 0);
        vplPipeline p = showPipeline(v);
        p.cull = (vplCull)cull;
        fragments[cull] = drawList(context, &c, &p, NULL, 6, 2).fragments;
        bool left = c.planes[0][16] == 1, right = c.planes[0][14 * 16 + 14] == 1;
        assert_int_equal(left, cull != VPL_CULL_FRONT);
        assert_int_equal(right, cull != VPL_CULL_BACK);
        freeCanvas(&c);
    }
    assert_true(fragments[0] == fragments[1] + fragments[2]);
}

// One triangle faces the eye, one faces away, one lies beside the picture, one has no area. The memory around what is counted holds junk.
TEST_ALONE(OnlyTrianglesOnScreenAreBinned)
{
    Failing junk = {.failAt = -1};
    vplContext* context = openFailing(&junk);
    static const int at[12][2] = {{0, 0},    {0, 4096},    {2048, 0}, {4096, 4096}, {2048, 4096}, {4096, 0},
                                  {8192, 0}, {8192, 4096}, {9216, 0}, {0, 0},       {0, 4096},    {0, 2048}};
    ClipVertex v[12];
    for (int i = 0; i < 12; i++) {
        v[i] = fixedVertex(at[i][0], at[i][1], 0.5f, 16, 16);
    }
    Canvas c = makeCanvas(16, 16, 0);
    const vplPipeline p = showPipeline(v);
    const vplRasterStats stats = drawList(context, &c, &p, NULL, 12, 4);
    assert_int_equal(stats.drawCalls, 1);
    assert_int_equal(stats.trianglesIn, 4);
    assert_int_equal(stats.trianglesBinned, 2);
    freeCanvas(&c);
    vplContext_Destroy(context);
    assert_int_equal(junk.held, 0);
}

// Draws two overlapping rectangles with each depth compare mode, with depth writes on and off.
TEST(DepthComparesAndWritesAsAsked, 1)
{
    const float depths[3] = {0.5f, 0.25f, 0.75f}; // equal to, nearer than, farther than 0.5
    const bool passes[4][3] = {{0, 1, 0}, {1, 1, 0}, {1, 0, 0}, {1, 1, 1}};
    for (int compare = 0; compare < 4; compare++) {
        for (int i = 0; i < 3; i++) {
            for (int write = 0; write < 2; write++) {
                ClipVertex v[3] = {fixedVertex(-9000, -9000, depths[i], 8, 8),
                                   fixedVertex(9000, 0, depths[i], 8, 8),
                                   fixedVertex(0, 9000, depths[i], 8, 8)};
                Canvas c = makeCanvas(8, 8, 0);
                c.framebuffer.depth.load = true;
                for (int k = 0; k < 64; k++) {
                    c.depth[k] = 0.5f;
                }
                vplPipeline p = showPipeline(v);
                p.depthCompare = (vplDepthCompare)compare;
                p.depthWrite = write;
                drawList(context, &c, &p, NULL, 3, 1);
                assert_int_equal(c.planes[0][9] == 1, passes[compare][i]);
                assertNear((double)c.depth[9], passes[compare][i] && write ? (double)depths[i] : 0.5, 0,
                           "depth", i);
                freeCanvas(&c);
            }
        }
    }
}

TEST(LoadKeepsAndClearReplacesWhatWasThere, 1)
{
    ClipVertex v[3] = {fixedVertex(0, 0, 0.5f, 70, 66), fixedVertex(2560, 0, 0.5f, 70, 66),
                       fixedVertex(0, 2560, 0.5f, 70, 66)};
    for (int load = 0; load < 2; load++) {
        Canvas c = makeCanvas(70, 66, 3);
        c.framebuffer.planes[0].load = load;
        for (int i = 0; i < 70 * 66; i++) {
            c.planes[0][i] = (float)i;
        }
        vplPipeline p = showPipeline(v);
        p.blend = VPL_BLEND_ADD;
        drawList(context, &c, &p, NULL, 3, 1);
        assertNear((double)c.planes[0][0], load ? 1 : 4, 0, "inside", load);
        int last = 70 * 66 - 1;
        assertNear((double)c.planes[0][last], load ? last : 3, 0, "outside", load);
        freeCanvas(&c);
    }
}

// X076, X073, X079: invalid triangles are dropped and affect nothing else.
TEST(BadTrianglesDrawNothing, 1)
{
    const float bad[] = {NAN, INFINITY, -INFINITY};
    for (int component = 0; component < 4; component++) {
        for (int kind = 0; kind < 3; kind++) {
            ClipVertex v[3] = {{0, 0, 0.5f, 1, {0}}, {1, 0, 0.5f, 1, {0}}, {0, 1, 0.5f, 1, {0}}};
            (&v[1].x)[component] = bad[kind];
            Canvas c = makeCanvas(8, 8, 0);
            vplPipeline p = showPipeline(v);
            assert_int_equal(drawList(context, &c, &p, NULL, 3, 1).fragments, 0);
            freeCanvas(&c);
        }
    }
    const ClipVertex dull[4][3] = {
        {{0, 0, 0.5f, 1, {0}}, {1, 1, 0.5f, 1, {0}}, {0.5f, 0.5f, 0.5f, 1, {0}}}, // a line
        {{0, 0, 0.5f, 1, {0}}, {0, 0, 0.5f, 1, {0}}, {1, 1, 0.5f, 1, {0}}},       // a repeated vertex
        {{0, 0, -1, -1, {0}}, {1, 0, -1, -1, {0}}, {0, 1, -1, -1, {0}}},          // all behind the eye
        {{0, 0, 0, 0, {0}}, {0, 0, 0, 0, {0}}, {0, 0, 0, 0, {0}}},                // w = 0
    };
    for (int i = 0; i < 4; i++) {
        Canvas c = makeCanvas(8, 8, 0);
        vplPipeline p = showPipeline(dull[i]);
        assert_int_equal(drawList(context, &c, &p, NULL, 3, 1).fragments, 0);
        freeCanvas(&c);
    }
}

// X075, X076
// Huge but finite coordinates are clipped to the guard band and do not wrap around.
TEST(HugeTrianglesCoverThePicture, 1)
{
    const float sizes[] = {10, 1e4f, 1e10f, 1e30f};
    for (int i = 0; i < 4; i++) {
        float s = sizes[i];
        ClipVertex v[3] = {{-3 * s, -s, 0.5f, 1, {1, 0, 0}},
                           {3 * s, -s, 0.5f, 1, {1, 0, 0}},
                           {0, 3 * s, 0.5f, 1, {1, 0, 0}}};
        Canvas c = makeCanvas(33, 17, 0);
        vplPipeline p = showPipeline(v);
        assert_int_equal(drawList(context, &c, &p, NULL, 3, 1).fragments, 33 * 17);
        assertNear((double)c.planes[2][100], 1, 0, "constant varying", i);
        freeCanvas(&c);
    }
}

TEST(WrongArgumentsAreRefusedWithASentence, 1)
{
    vplRaster* raster = NULL;
    vplFramebuffer f = vplDefaultFramebuffer(0, 5);
    assert_int_equal(vplRaster_Create(context, &f, &raster), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "0x5"));
    f = vplDefaultFramebuffer(4, 5);
    f.planeCount = 99;
    assert_int_equal(vplRaster_Create(context, &f, &raster), VPL_INVALID_ARGUMENT);
    f = (vplFramebuffer){0};
    assert_int_equal(vplRaster_Create(context, &f, &raster), VPL_INVALID_ARGUMENT);
    assert_null(raster);
    f = vplDefaultFramebuffer(4, 5);
    assert_int_equal(vplRaster_Create(context, &f, &raster), VPL_SUCCESS);
    vplMesh mesh = {NULL, 0, 0};
    vplPipeline p = vplDefaultPipeline();
    assert_int_equal(vplRaster_Draw(raster, &mesh, &p), VPL_INVALID_ARGUMENT);
    p.vertex = passVertices;
    p.varyingCount = VPL_MAX_VARYINGS + 1;
    assert_int_equal(vplRaster_Draw(raster, &mesh, &p), VPL_INVALID_ARGUMENT);
    p.varyingCount = 2;
    p.surface = showFragments;
    p.surfaceCount = 1;
    assert_int_equal(vplRaster_Draw(raster, &mesh, &p), VPL_INVALID_ARGUMENT);
    p.surfaceCount = VPL_MAX_VARYINGS + 1;
    assert_int_equal(vplRaster_Draw(raster, &mesh, &p), VPL_INVALID_ARGUMENT);
    p.surface = NULL;
    p.varyingCount = 0;
    p.writesDepth = true; // without a fragment shader
    assert_int_equal(vplRaster_Draw(raster, &mesh, &p), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "writesDepth"));
    p.writesDepth = false;
    assert_int_equal(vplRaster_Draw(raster, &mesh, &p), VPL_SUCCESS); // an empty mesh is valid
    assert_int_equal(vplRaster_Run(raster, NULL, NULL, NULL), VPL_SUCCESS);
    vplRaster_Destroy(raster);
}

static bool stopAtOnce(void* user, double fraction)
{
    ++*(int*)user;
    return fraction < 0;
}

TEST(ProgressCanCancel, 1)
{
    vplFramebuffer f = vplDefaultFramebuffer(640, 640);
    vplRaster* raster;
    int asked = 0;
    assert_int_equal(vplRaster_Create(context, &f, &raster), VPL_SUCCESS);
    assert_int_equal(vplRaster_Run(raster, stopAtOnce, &asked, NULL), VPL_CANCELLED);
    assert_int_equal(asked, 1);
    vplRaster_Destroy(raster);
}
