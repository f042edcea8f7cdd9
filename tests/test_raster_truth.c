// SPDX-License-Identifier: MIT
// Tests of the rasterizer against tables of exact answers: coverage bit for bit, interpolation and clipping
// within documented errors. Covers extremes X071 to X081.
#include "raster_support.h"

#include "raster/raster.h"

#include <jansson.h>
#include <stdlib.h>

static uint32_t crc32Of(const uint8_t* bytes, size_t count)
{
    uint32_t crc = 0xffffffffu;
    for (size_t i = 0; i < count; i++) {
        crc ^= bytes[i];
        for (int k = 0; k < 8; k++) {
            crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0);
        }
    }
    return ~crc;
}

TEST(EveryTriangleOfTheTableFillsBitForBit, 1)
{
    Table t = loadTable("fill_tris.csv");
    for (int row = 0; row < t.rows; row++) {
        int width = (int)number(&t, row, "W"), height = (int)number(&t, row, "H");
        ClipVertex v[3];
        for (int i = 0; i < 3; i++) {
            char nx[3] = {'x', (char)('0' + i), 0}, ny[3] = {'y', (char)('0' + i), 0};
            v[i] = fixedVertex((int)number(&t, row, nx), (int)number(&t, row, ny), 0.5f, width, height);
        }
        Canvas c = makeCanvas(width, height, 0);
        vplPipeline p = showPipeline(v);
        drawList(context, &c, &p, NULL, 3, 1);
        size_t pixels = (size_t)width * (size_t)height;
        uint8_t* bytes = malloc(pixels);
        int covered = 0;
        for (size_t i = 0; i < pixels; i++) {
            bytes[i] = c.planes[0][i] == 1;
            covered += bytes[i];
        }
        if (covered != (int)number(&t, row, "covered") ||
            crc32Of(bytes, pixels) != (uint32_t)number(&t, row, "crc32_of_W*H_bytes_0/1")) {
            fail_msg("row %d (%s): %d pixels covered, wanted %s, or others", row, cell(&t, row, "cat"),
                     covered, cell(&t, row, "covered"));
        }
        free(bytes);
        freeCanvas(&c);
    }
    freeTable(&t);
}

// Expands a run-length code such as "-1*64 3*2" into owner[64].
static void expandRow(const char* runs, int* owner, int width)
{
    int at = 0;
    while (*runs) {
        char* end;
        long value = strtol(runs, &end, 10), count = strtol(end + 1, &end, 10);
        for (long i = 0; i < count; i++) {
            assert_true(at < width);
            owner[at++] = (int)value;
        }
        runs = *end == ' ' ? end + 1 : end;
    }
    assert_int_equal(at, width);
}

static void checkMesh(vplContext* context, const char* name, json_t* mesh)
{
    int width = (int)json_integer_value(json_object_get(mesh, "W"));
    int height = (int)json_integer_value(json_object_get(mesh, "H"));
    json_t* vertices = json_object_get(mesh, "vertices");
    json_t* triangles = json_object_get(mesh, "triangles");
    int vertexCount = (int)json_array_size(vertices), triangleCount = (int)json_array_size(triangles);
    ClipVertex* v = malloc((size_t)vertexCount * sizeof *v);
    uint32_t* indices = malloc(3 * (size_t)triangleCount * sizeof *indices);
    for (int i = 0; i < vertexCount; i++) {
        json_t* p = json_array_get(vertices, (size_t)i);
        v[i] = fixedVertex((int)json_integer_value(json_array_get(p, 0)),
                           (int)json_integer_value(json_array_get(p, 1)), 0.5f, width, height);
    }
    for (int i = 0; i < 3 * triangleCount; i++) {
        json_t* p = json_array_get(triangles, (size_t)i / 3);
        indices[i] = (uint32_t)json_integer_value(json_array_get(p, (size_t)i % 3));
    }
    Canvas c = makeCanvas(width, height, 0);
    vplPipeline p = showPipeline(v);
    p.blend = VPL_BLEND_ADD;
    p.depthCompare = VPL_DEPTH_ALWAYS;
    drawList(context, &c, &p, indices, vertexCount, triangleCount);
    json_t* rows = json_object_get(mesh, "owner_rle_rows");
    int* owner = malloc((size_t)width * sizeof *owner);
    for (int y = 0; y < height; y++) {
        expandRow(json_string_value(json_array_get(rows, (size_t)y)), owner, width);
        for (int x = 0; x < width; x++) {
            int wanted = owner[x], at = y * width + x;
            if (c.planes[0][at] != (wanted >= 0 ? 1 : 0) ||
                (wanted >= 0 && c.planes[1][at] != (float)wanted)) {
                fail_msg("%s at (%d, %d): drawn %g times, sum of owners %g, wanted owner %d", name, x, y,
                         (double)c.planes[0][at], (double)c.planes[1][at], wanted);
            }
        }
    }
    free(owner);
    free(v);
    free(indices);
    freeCanvas(&c);
}

TEST(EveryMeshOfTheTableIsOwnedBitForBit, 2)
{
    json_error_t error;
    json_t* meshes = json_load_file("tests/data/fill_meshes.json", 0, &error);
    assert_non_null(meshes);
    const char* name;
    json_t* mesh;
    json_object_foreach(meshes, name, mesh)
    {
        checkMesh(context, name, mesh);
    }
    json_decref(meshes);
}

TEST_ALONE(VerticesSnapToNearestEven)
{
    Table t = loadTable("snap.csv");
    vplRaster raster = {.framebuffer = {.width = 2, .height = 2}};
    for (int row = 0; row < t.rows; row++) {
        double x = number(&t, row, "x");
        vplScreenVertex v = vplProject(&raster, x - 1, 0, 0.5, 1);
        assert_int_equal(v.x, (int)number(&t, row, "fixed_n8"));
    }
    freeTable(&t);
}

// The tolerance is the table's: perspective barycentrics carry a few roundings, and varyings are differences
// from corner 0, so errors scale with the spread of the corners' values.
TEST(VaryingsDepthAndWAreThoseOfTheTable, 1)
{
    Table t = loadTable("persp.csv");
    ClipVertex v[3] = {{0}};
    Canvas c = makeCanvas(64, 64, 0);
    int triangle = -1;
    double spread = 0, largest = 0;
    for (int row = 0; row < t.rows; row++) {
        if ((int)number(&t, row, "tri") != triangle) {
            triangle = (int)number(&t, row, "tri");
            spread = largest = 0;
            for (int i = 0; i < 3; i++) {
                char names[5][6] = {"x?", "y?", "z?", "w?", "attr?"};
                float values[5];
                for (int k = 0; k < 5; k++) {
                    *strchr(names[k], '?') = (char)('0' + i);
                    values[k] = (float)number(&t, row, names[k]);
                }
                v[i] = (ClipVertex){values[0], values[1], values[2], values[3], {values[4], 0, 0}};
                largest = fmax(largest, fabs((double)values[4]));
            }
            for (int i = 0; i < 3; i++) {
                spread = fmax(spread, fabs((double)v[i].varying[0] - v[0].varying[0]));
            }
            vplPipeline p = showPipeline(v);
            drawList(context, &c, &p, NULL, 3, 1);
        }
        int at = (int)number(&t, row, "py") * 64 + (int)number(&t, row, "px");
        assert_true(c.planes[0][at] == 1);
        assertNear((double)c.planes[2][at], number(&t, row, "attr_persp"), 4e-7 * (spread + largest), "attr",
                   row);
        assertNear((double)c.depth[at], number(&t, row, "z_ndc"), 1.5e-7, "z", row);
        assertNear((double)c.planes[5][at] / number(&t, row, "w"), 1, 5e-7, "w", row);
    }
    freeCanvas(&c);
    freeTable(&t);
}

static void loadClipTriangle(const Table* t, int row, ClipVertex v[3])
{
    for (int i = 0; i < 3; i++) {
        char names[4][3] = {"x?", "y?", "z?", "w?"};
        float values[4];
        for (int k = 0; k < 4; k++) {
            names[k][1] = (char)('0' + i);
            values[k] = (float)number(t, row, names[k]);
        }
        v[i] = (ClipVertex){values[0], values[1], values[2], values[3], {i == 0, i == 1, i == 2}};
    }
}

TEST(NearClipCoversWhatTheHomogeneousTestSays, 1)
{
    Table t = loadTable("clip_near.csv"), pixels = loadTable("clip_pixels.csv");
    Canvas c = makeCanvas(32, 32, 0);
    int tested = 0;
    for (int row = 0; row < t.rows; row++) {
        ClipVertex v[3];
        loadClipTriangle(&t, row, v);
        vplPipeline p = showPipeline(v);
        drawList(context, &c, &p, NULL, 3, 1);
        const char* map = cell(&t, row, "map_rle");
        int at = 0;
        while (*map) {
            char value = *map;
            char* end;
            long count = strtol(map + 2, &end, 10);
            for (long i = 0; i < count; i++, at++) {
                if (value != '?' && (c.planes[0][at] == 1) != (value == '1')) {
                    fail_msg("row %d, pixel (%d, %d): %g, wanted %c", row, at % 32, at / 32,
                             (double)c.planes[0][at], value);
                }
            }
            map = *end == ' ' ? end + 1 : end;
        }
        assert_int_equal(at, 1024);
        // Barycentrics refer to the original corners after clipping, and snapping does not move them.
        for (int pixelRow = 0; pixelRow < pixels.rows; pixelRow++) {
            if (strcmp(cell(&pixels, pixelRow, "tri"), cell(&t, row, "tri")) != 0) {
                continue;
            }
            int pixel = (int)number(&pixels, pixelRow, "py") * 32 + (int)number(&pixels, pixelRow, "px");
            if (c.planes[0][pixel] != 1) {
                continue; // nearer to the outline than 1/64 pixel
            }
            const char* names[3] = {"lam0", "lam1", "lam2"};
            for (int i = 0; i < 3; i++) {
                assertNear((double)c.planes[2 + i][pixel], number(&pixels, pixelRow, names[i]), 1e-5,
                           names[i], pixelRow);
            }
            tested++;
        }
    }
    assert_true(tested > 100); // each table is a random subset of its own
    freeCanvas(&c);
    freeTable(&pixels);
    freeTable(&t);
}
