// SPDX-License-Identifier: MIT
// Tests of OBJ and MTL files: valid files arrive as they were written, damaged ones are reported by file,
// line and column.
#include "math/vec.h"
#include "obj_support.h"

// ---- damaged files

TEST_ALONE(EveryBrokenObjSaysWhatIsWrongWhere)
{
    Desk d;
    openDesk(&d);
    Table t = loadTable("obj/broken/expected.csv");
    assert_true(t.rows >= 45);
    for (int row = 0; row < t.rows; row++) {
        char path[256], start[300];
        int mesh = -7;
        snprintf(path, sizeof path, "tests/data/obj/broken/%s", cell(&t, row, "file"));
        snprintf(start, sizeof start, "error: tests/data/obj/broken/%s:%s:%s: ", cell(&t, row, "where"),
                 cell(&t, row, "line"), cell(&t, row, "column"));
        d.said[0] = 0;
        vplResult result = vplScene_LoadObj(d.scene, path, &mesh);
        if (result != VPL_PARSE_ERROR || mesh != -7 || vplScene_GetMaterialCount(d.scene) != 0) {
            fail_msg("%s: %s instead of a parse error", path, vplResult_GetName(result));
        }
        if (strncmp(d.said, start, strlen(start)) != 0 || countOf(d.said, "\n") != 1 ||
            strstr(d.said, cell(&t, row, "found")) == NULL ||
            strstr(d.said, cell(&t, row, "expected")) == NULL) {
            fail_msg("\"%s\" instead of \"%s%s, %s\"", d.said, start, cell(&t, row, "found"),
                     cell(&t, row, "expected"));
        }
    }
    freeTable(&t);
    closeDesk(&d);
}

// ---- odd files

TEST_ALONE(OddStatementsAreWarnedOfAndHaveNoEffect)
{
    Desk d;
    openDesk(&d);
    Table t = loadTable("obj/odd/expected.csv");
    assert_true(t.rows >= 16);
    for (int row = 0; row < t.rows; row++) {
        char path[256], start[400];
        int mesh = -7;
        const char* where = cell(&t, row, "where");
        snprintf(path, sizeof path, "tests/data/obj/odd/%s", cell(&t, row, "file"));
        snprintf(start, sizeof start, "warning: tests/data/obj/odd/%s:%s:%s: %s", where,
                 cell(&t, row, "line"), cell(&t, row, "column"), cell(&t, row, "warned"));
        d.said[0] = 0;
        if (vplScene_LoadObj(d.scene, path, &mesh) != VPL_SUCCESS ||
            vplScene_GetMesh(d.scene, mesh)->triangleCount != 1) {
            fail_msg("%s: %s", path, d.said);
        }
        if (where[0] == 0 ? d.said[0] != 0
                          : strncmp(d.said, start, strlen(start)) != 0 || countOf(d.said, "\n") != 1) {
            fail_msg("\"%s\" instead of \"%s\"", d.said, start);
        }
    }
    freeTable(&t);
    closeDesk(&d);
}

TEST(WhatIsNoFileIsAFileError, 1)
{
    vplScene* scene = NULL;
    const char* const paths[] = {"tests/data/none.obj", "tests/data/obj/square.obj/x.obj", ".obj"};
    for (size_t i = 0; i < sizeof paths / sizeof *paths; i++) {
        assert_int_equal(vplScene_Load(context, paths[i], &scene), VPL_FILE_ERROR);
        assert_true(strncmp(takeMessage(), paths[i], strlen(paths[i])) == 0);
        assert_null(scene);
    }
}

TEST_ALONE(AFailureLeavesTheSceneAsItWas)
{
    Desk d;
    openDesk(&d);
    writeText(d.mtl, "newmtl red\nKd 1 0 0\n");
    writeText(d.obj, "mtllib a.mtl\nusemtl red\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 4\n");
    vplMaterialDef material = vplDefaultMaterialDef();
    material.name = "red";
    assert_int_equal(vplScene_AddMaterial(d.scene, &material, NULL), VPL_SUCCESS);
    int mesh = -7;
    assert_int_equal(vplScene_LoadObj(d.scene, d.obj, &mesh), VPL_PARSE_ERROR);
    assert_int_equal(mesh, -7);
    assert_int_equal(vplScene_GetMaterialCount(d.scene), 1);
    assert_int_equal(vplScene_GetMeshCount(d.scene), 0);
    closeDesk(&d);
}

// ---- statements

TEST_ALONE(EveryFormOfAFaceGivesTheSameTriangle)
{
#define POINTS "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
    static const char* const texts[] = {
        POINTS "f 1 2 3",
        POINTS "f 1/1 2/2 3/3\n",
        POINTS "vn 0 0 1\nf 1//1 2//1 3//1\n",
        POINTS "vn 0 0 1\nf 1/7/1 2/8/1 3/-9/-1\n",
        POINTS "f -3 -2 -1\n",
        POINTS "f +1 02 3\n",
        POINTS "f -3 -2 -1\nv 5 5 5\nv 6 6 6\n", // negative indices count from the line, not from the end
        "f 1 2 3\n" POINTS,                      // points may follow the face
        "v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nf 1 2 3\r\n",
        "v 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3",
        "v 0 0 0\nv 1 0 0\rv 0 1 0\r\n\r\n\n\rf 1 2 3\r",
        "\tv\t0 0\t0\t\n  v 1  0 0  \n v 0 1 0\n\t f \t1 2 3 \t",
        "v 0 0 \\\n0\nv 1 0 \\\r\n 0\nv \\\r0 1 0\nf 1 \\\n\\\n 2 3 \\",
        "# v 9 9 9 \\\nv 0 0 0 # f 3 2 1\nv 1 0 0 #\nv 0 1 0#1\n",
        "# C:\\models\\\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 # last \\\n",
        "\xEF\xBB\xBFv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
        "v -0 0.0 0e5\nv 1.0 -0.0 0\nv .0 10e-1 0.\nf 1 2 3\n",
        "v 0 0 0 1\nv 1 0 0 0.5 0.5 0.5\nv 0 1 0 1 0.5 0.5 0.5\nf 1 2 3\n",
        "o a\ng b c\ns off\nvt 0\nvt 0 0 0\n" POINTS "s 1\ng\nf 1 2 3\n",
    };
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        Desk d;
        openDesk(&d);
        if (strstr(texts[i], "0#1") != NULL) { // a comment needs a blank before "#": a bad number
            writeText(d.obj, texts[i]);
            assert_int_equal(vplScene_LoadObj(d.scene, d.obj, NULL), VPL_PARSE_ERROR);
            assert_non_null(strstr(d.said, ":4:7: found \"0#1\""));
            closeDesk(&d);
            continue;
        }
        const vplMeshDef* mesh = readText(&d, texts[i]);
        assert_true(mesh->triangleCount == 1 && mesh->vertexCount == 3 && d.said[0] == 0);
        assertPoint(meshCorner(mesh, 0, 0), 0, 0, 0);
        assertPoint(meshCorner(mesh, 0, 1), 1, 0, 0);
        assertPoint(meshCorner(mesh, 0, 2), 0, 1, 0);
        assert_true((mesh->normals != NULL) ==
                    (strstr(texts[i], "vn") != NULL || strstr(texts[i], "s 1") != NULL));
        closeDesk(&d);
    }
}

static double areaOf(const vplMeshDef* mesh, int material)
{
    double area = 0;
    for (int i = 0; i < mesh->triangleCount; i++) {
        vplVec3 a = meshCorner(mesh, i, 0), b = meshCorner(mesh, i, 1), c = meshCorner(mesh, i, 2);
        double u[3] = {b.x - a.x, b.y - a.y, b.z - a.z}, v[3] = {c.x - a.x, c.y - a.y, c.z - a.z};
        double x = u[1] * v[2] - u[2] * v[1], y = u[2] * v[0] - u[0] * v[2], z = u[0] * v[1] - u[1] * v[0];
        area += mesh->materials[i] == material ? 0.5 * sqrt(x * x + y * y + z * z) : 0;
    }
    return area;
}

TEST_ALONE(AFileOfEverythingIsRead)
{
    Desk d;
    int mesh;
    openDesk(&d);
    assert_int_equal(vplScene_LoadObj(d.scene, "tests/data/obj/everything.obj", &mesh), VPL_SUCCESS);
    assert_string_equal(d.said, "info: tests/data/obj/everything.obj: left out 1 triangles without area\n");
    const vplMeshDef* m = vplScene_GetMesh(d.scene, mesh);
    assert_int_equal(m->triangleCount, 2 + 2 + 3 + 1 + 1);
    assert_int_equal(vplScene_GetMaterialCount(d.scene), 3); // the unused one is left out
    static const char* const names[] = {"everything.obj:brick", "everything.obj:fine paint",
                                        "everything.obj:lamp # hot"};
    for (int i = 0; i < 3; i++) {
        assert_string_equal(vplScene_GetMaterial(d.scene, i)->name, names[i]);
    }
    assertColour(vplScene_GetMaterial(d.scene, 0)->diffuse, 0.5, 0.25, 0.125);
    assertColour(vplScene_GetMaterial(d.scene, 0)->emission, 0, 0, 0);
    assertColour(vplScene_GetMaterial(d.scene, 1)->diffuse, 0.75, 0.75, 0.75);
    assertColour(vplScene_GetMaterial(d.scene, 2)->diffuse, 0, 0, 0);
    assertColour(vplScene_GetMaterial(d.scene, 2)->emission, 10, 20, 30);
    assertNear(areaOf(m, 0), 4 + 8 + 2, 1e-12, "brick", 0);
    assertNear(areaOf(m, 1), 2 * sqrt(5), 1e-12, "fine paint", 0);
    assertNear(areaOf(m, 2), 16 - 6, 1e-12, "lamp", 0); // (0,0) (4,0) (4,4) (2,1) (0,4)
    closeDesk(&d);
}

// ---- vertices

#define CUBE                                                                                                 \
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"                               \
    "vn 0 0 -3\nvn 0 0 3\nvn 0 -3 0\nvn 0 3 0\nvn -3 0 0\nvn 3 0 0\n"

TEST_ALONE(CornersWithTheSamePointAndNormalShareAVertex)
{
    Desk d;
    openDesk(&d);
    const vplMeshDef* flat =
        readText(&d, CUBE "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 4 8 7 3\nf 1 5 8 4\nf 2 3 7 6\n");
    assert_true(flat->vertexCount == 8 && flat->triangleCount == 12 && flat->normals == NULL);
    const vplMeshDef* edged =
        readText(&d, CUBE "f 1//1 4//1 3//1 2//1\nf 5//2 6//2 7//2 8//2\nf 1//3 2//3 6//3 5//3\n"
                          "f 4//4 8//4 7//4 3//4\nf 1//5 5//5 8//5 4//5\nf 2//6 3//6 7//6 6//6\n");
    assert_true(edged->vertexCount == 24 && edged->triangleCount == 12);
    for (int i = 0; i < edged->vertexCount; i++) {
        vplVec3 n = edged->normals[i];
        assert_true(fabsf(n.x) + fabsf(n.y) + fabsf(n.z) == 1); // normalized
    }
    const vplMeshDef* repeated = readText(&d, "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n"
                                              "v 0 -0 0\nv 1 1 0\nv 0 1 0\nvn 7 7 7\nf 4 5 6\n");
    assert_true(repeated->vertexCount == 4 && repeated->triangleCount == 2 && repeated->normals == NULL);
    closeDesk(&d);
}

TEST_ALONE(PointsWithoutTrianglesAreLeftOut)
{
    Desk d;
    openDesk(&d);
    const vplMeshDef* mesh =
        readText(&d, "v 1e9 0 0\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nf 2 3 4\nf 2 3 5\n");
    assert_true(mesh->vertexCount == 3 && mesh->triangleCount == 1);
    assertPoint(mesh->positions[0], 0, 0, 0);
    assert_true(countOf(d.said, "info: ") == 1 &&
                strstr(d.said, "left out 1 triangles without area") != NULL);
    closeDesk(&d);
}

// The reader detects collinear corners also if coordinates are not round numbers; the tiniest triangle with
// an area stays.
TEST_ALONE(OnlyTrianglesWithoutAreaAreLeftOut)
{
    Desk d;
    openDesk(&d);
    const vplMeshDef* mesh =
        readText(&d, "v 1640.1 0.4 -1000.3\nv 1640.1001 0.4 -1000.3\nv 1640.1 0.40000001 -1000.3\n"
                     "v 1640.1 0.4000001 -1000.3\nv 0.1 0.1 0.1\nv 0.3 0.3 0.3\nv 0.7 0.7 0.7\n"
                     "v 0 0 0\nv 1e-45 0 0\nv 0 1e-45 0\n"
                     "f 1 2 3\nf 1 2 4\nf 5 6 7\nf 8 9 10\nf 1 1 2\n");
    assert_int_equal(mesh->triangleCount, 2);
    assert_non_null(strstr(d.said, "left out 3 triangles without area"));
    closeDesk(&d);
}

TEST_ALONE(CornersWithoutANormalGetTheTriangles)
{
    Desk d;
    openDesk(&d);
    const vplMeshDef* mesh =
        readText(&d, "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvn 0 0 0\nvn 1 0 0\nvn 3e38 3e38 0\n"
                     "f 1//2 2//1 3\nf 1 4 2\nf 1//3 2//3 3//3\nvn 1e-40 0 0\nf 1//4 2//4 3//4\n");
    assert_int_equal(mesh->triangleCount, 4);
    static const double wanted[4][3][3] = {{{1, 0, 0}, {0, 0, 1}, {0, 0, 1}},
                                           {{0, 1, 0}, {0, 1, 0}, {0, 1, 0}}};
    for (int i = 0; i < 6; i++) {
        const double* n = wanted[i / 3][i % 3];
        assertPoint(mesh->normals[mesh->indices[i]], n[0], n[1], n[2]);
    }
    vplVec3 large = mesh->normals[mesh->indices[6]], small = mesh->normals[mesh->indices[9]];
    assertNear((double)large.x, sqrt(0.5), 1e-7, "x", 0);
    assertNear((double)large.y, sqrt(0.5), 1e-7, "y", 0);
    assertPoint(small, 1, 0, 0);
    closeDesk(&d);
}

// A grid of floats written with nine digits is read back bit for bit, in little memory.
TEST_ALONE(AGridComesBackAsItWasWritten)
{
    enum { SIDE = 150 };
    Desk d;
    openDesk(&d);
    static vplVec3 points[SIDE * SIDE];
    FILE* file = fopen(d.obj, "w");
    assert_non_null(file);
    for (int i = 0; i < SIDE * SIDE; i++) {
        double height = 0.05 * uniformAt(1, (uint64_t)i); // so flat that all squares become fans
        points[i] = (vplVec3){(float)(i % SIDE) / 7, (float)height, (float)(i / SIDE) * 0.11f};
        fprintf(file, "v %.9g %.9g %.9g\n", (double)points[i].x, (double)points[i].y, (double)points[i].z);
    }
    for (int i = 0; i < SIDE * SIDE; i++) {
        if (i % SIDE < SIDE - 1 && i / SIDE < SIDE - 1) {
            fprintf(file, "f %d %d %d %d\n", i + 1, i + SIDE + 1, i + SIDE + 2, i + 2);
        }
    }
    fclose(file);
    int index;
    vplContext_ResetPeakBytes(d.context);
    assert_int_equal(vplScene_LoadObj(d.scene, d.obj, &index), VPL_SUCCESS);
    const vplMeshDef* mesh = vplScene_GetMesh(d.scene, index);
    assert_int_equal(mesh->vertexCount, SIDE * SIDE);
    assert_int_equal(mesh->triangleCount, 2 * (SIDE - 1) * (SIDE - 1));
    for (int i = 0; i < SIDE * SIDE; i++) { // vertices are numbered by their first use
        int row = i / SIDE, column = i % SIDE, square = row * (SIDE - 1) + column;
        if (row < SIDE - 1 && column < SIDE - 1) {
            vplVec3 p = meshCorner(mesh, 2 * square, 0);
            assert_memory_equal(&p, &points[i], sizeof p);
        }
    }
    size_t bytes =
        (size_t)mesh->vertexCount * sizeof(vplVec3) + (size_t)mesh->triangleCount * 4 * sizeof(int);
    assert_true(vplContext_GetPeakBytes(d.context) < 4 * bytes);
    closeDesk(&d);
}

// ---- smoothing groups

// The edge between two faces at a right angle is smooth if both are in one group, and sharp between groups, outside
// them, and where the file has normals.
TEST_ALONE(SmoothingGroupsGiveNormals)
{
    static const char* const points = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
    static const struct {
        const char* faces;
        bool smooth;
    } cases[] = {{"s 1\nf 1 2 3\nf 1 3 4\n", true},       {"s on\nf 1 2 3\nf 1 3 4\n", true},
                 {"s 1\nf 1 2 3\ns 2\nf 1 3 4\n", false}, {"s 1\nf 1 2 3\ns off\nf 1 3 4\n", false},
                 {"s 1\nf 1 2 3\ns 0\nf 1 3 4\n", false}, {"s 7\nf 1 2 3\ns 1\ns 7\nf 1 3 4\n", true}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        Desk d;
        char text[256];
        openDesk(&d);
        snprintf(text, sizeof text, "%s%s", points, cases[i].faces);
        const vplMeshDef* m = readText(&d, text);
        const double half = sqrt(0.5);
        assert_int_equal(m->triangleCount, 2);
        assert_int_equal(m->vertexCount, cases[i].smooth ? 4 : 6);
        const vplVec3 n =
            m->normals[m->indices[0]]; // of point 1, where both faces have an angle of 90 degrees
        assertNear((double)n.z, cases[i].smooth ? half : 1, 1e-6, "z", (int)i);
        assertNear((double)n.x, cases[i].smooth ? half : 0, 1e-6, "x", (int)i);
        closeDesk(&d);
    }
    Desk d;
    openDesk(&d);
    const vplMeshDef* m = readText(&d, "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\ns off\nf 1 2 3\nf 1 3 4\n");
    assert_null(m->normals);
    m = readText(&d, "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvn 0 1 0\ns 1\nf 1//1 2 3\nf 1 3 4\n");
    assertNear((double)m->normals[m->indices[0]].y, 1, 0, "y", 0);
    assertNear((double)m->normals[m->indices[1]].z, 1, 0, "z", 0);
    closeDesk(&d);
}

enum { ARCH_PARTS = 8 };

// Half a cylinder of radius 1 around the y axis, of quads that are wound outwards, inwards where `inwards` says so.
static void writeArch(char* text, size_t size, bool (*inwards)(int part), bool doubled)
{
    size_t length = 0;
    for (int i = 0; i <= ARCH_PARTS; i++) {
        const double angle = VPL_PI * i / ARCH_PARTS;
        length += (size_t)snprintf(text + length, size - length, "v %.6f 0 %.6f\nv %.6f 1 %.6f\n", cos(angle),
                                   sin(angle), cos(angle), sin(angle));
    }
    length += (size_t)snprintf(text + length, size - length, "s 1\n");
    for (int i = 0; i < ARCH_PARTS; i++) {
        const int a = 2 * i + 1, b = a + 1, c = a + 3, d = a + 2;
        const char* one = "f %d %d %d %d\n";
        if (doubled || !inwards(i)) {
            length += (size_t)snprintf(text + length, size - length, one, a, b, c, d);
        }
        if (doubled || inwards(i)) {
            length += (size_t)snprintf(text + length, size - length, one, d, c, b, a);
        }
    }
}

static bool never(int part)
{
    return part < 0;
}

static bool everySecond(int part)
{
    return part % 2 == 1;
}

// The normals of an arch are those of the cylinder, on the side of each triangle's own, however its triangles are wound, and
// where each is there twice.
TEST_ALONE(SmoothNormalsDoNotDependOnTheWindingOfNeighbours)
{
    static const struct {
        bool (*inwards)(int part);
        bool doubled;
    } cases[] = {{never, false}, {everySecond, false}, {never, true}};
    for (int i = 0; i < 3; i++) {
        Desk d;
        char text[4096];
        openDesk(&d);
        writeArch(text, sizeof text, cases[i].inwards, cases[i].doubled);
        const vplMeshDef* m = readText(&d, text);
        assert_int_equal(m->triangleCount, (cases[i].doubled ? 4 : 2) * ARCH_PARTS);
        for (int k = 0; k < 3 * m->triangleCount; k++) {
            const uint32_t* triangle = m->indices + k / 3 * 3;
            const vplVec3 p = m->positions[m->indices[k]], n = m->normals[m->indices[k]];
            const vplVec3 own = vplCross(vplSub(m->positions[triangle[1]], m->positions[triangle[0]]),
                                         vplSub(m->positions[triangle[2]], m->positions[triangle[0]]));
            assert_true(vplDot(n, own) > 0);
            // Ends of the arch have one neighbour only, and their normal is half a part from the cylinder's.
            const bool end = fabsf(p.z) < 1e-5f;
            assert_true(fabsf(n.x * p.x + n.z * p.z) > (end ? 0.98f : 0.9999f));
        }
        closeDesk(&d);
    }
}
