// SPDX-License-Identifier: MIT
// Tests of the rasterizer against tables of exact answers: coverage bit for bit, interpolation within documented errors;
// test_clip_tables.c has clipping. Covers extremes X071 to X081.
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

// X073 to X075
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

// X071, X072, X078
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

// X077
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

// The three corners of a row of persp.csv; `values` get attr0 to attr2.
static void loadPerspective(const Table* t, int row, ClipVertex v[3], double values[3])
{
    for (int i = 0; i < 3; i++) {
        char names[5][6] = {"x?", "y?", "z?", "w?", "attr?"};
        float number5[5];
        for (int k = 0; k < 5; k++) {
            *strchr(names[k], '?') = (char)('0' + i);
            number5[k] = (float)number(t, row, names[k]);
        }
        v[i] = (ClipVertex){number5[0], number5[1], number5[2], number5[3], {i == 0, i == 1, i == 2}};
        values[i] = (double)number5[4];
    }
}

// X081
// Perspective barycentrics carry a few roundings, and varyings are differences from corner 0, so errors scale
// with the spread of the corners' values. Barycentrics on the screen, b, are perspective ones times w of the
// corner over w of the pixel, and weigh `attr_affine`.
TEST(VaryingsBarycentricsDepthAndWAreThoseOfTheTable, 1)
{
    Table t = loadTable("persp.csv");
    ClipVertex v[3] = {{0}};
    Canvas canvas[2] = {makeCanvas(64, 64, 0), makeCanvas(64, 64, 0)}; // attributes, barycentrics
    int triangle = -1;
    double attribute[3] = {0};
    for (int row = 0; row < t.rows; row++) {
        if ((int)number(&t, row, "tri") != triangle) {
            triangle = (int)number(&t, row, "tri");
            loadPerspective(&t, row, v, attribute);
            vplPipeline p = showPipeline(v);
            drawList(context, &canvas[1], &p, NULL, 3, 1);
            for (int i = 0; i < 3; i++) {
                v[i].varying[0] = (float)attribute[i];
            }
            drawList(context, &canvas[0], &p, NULL, 3, 1);
        }
        const int at = (int)number(&t, row, "py") * 64 + (int)number(&t, row, "px");
        double largest = 0, affine = 0, spread = 0;
        assert_true(canvas[0].planes[0][at] == 1);
        for (int i = 0; i < 3; i++) {
            char lam[8], b[8];
            snprintf(lam, sizeof lam, "lam%d", i);
            snprintf(b, sizeof b, "b%d", i);
            const double weight = (double)canvas[1].planes[2 + i][at],
                         over = (double)v[i].w / (double)canvas[1].planes[5][at];
            assertNear(weight, number(&t, row, lam), 4e-7, lam, row);
            assertNear(weight * over, number(&t, row, b), 4e-7 * over + 2e-7, b, row);
            affine += weight * over * attribute[i];
            largest = fmax(largest, fabs(attribute[i]) * fmax(over, 1));
            spread = fmax(spread, fabs(attribute[i] - attribute[0]));
        }
        assertNear((double)canvas[0].planes[2][at], number(&t, row, "attr_persp"), 4e-7 * (spread + largest),
                   "attr", row);
        assertNear(affine, number(&t, row, "attr_affine"), 1.2e-6 * largest, "affine", row);
        for (int k = 0; k < 2; k++) {
            assertNear((double)canvas[k].depth[at], number(&t, row, "z_ndc"), 1.5e-7, "z", row);
            assertNear((double)canvas[k].planes[5][at] / number(&t, row, "w"), 1, 5e-7, "w", row);
        }
    }
    assert_int_equal(t.rows, 286);
    freeCanvas(&canvas[0]);
    freeCanvas(&canvas[1]);
    freeTable(&t);
}
