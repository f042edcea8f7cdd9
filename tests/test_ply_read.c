// SPDX-License-Identifier: MIT
// Tests of PLY and STL files that are read: the three formats arrive as they were written, damaged ones are reported
// by file and place.
#include "obj_support.h"

#include "math/vec.h"

#include <unistd.h>

// ---- damaged and odd files

static void checkBroken(const char* kind, int atLeast)
{
    Desk d;
    char table[64];
    openDesk(&d);
    snprintf(table, sizeof table, "%s/broken/expected.csv", kind);
    Table t = loadTable(table);
    assert_true(t.rows >= atLeast);
    for (int row = 0; row < t.rows; row++) {
        char path[256], start[400];
        int mesh = -7;
        const char* where = cell(&t, row, "where");
        snprintf(path, sizeof path, "tests/data/%s/broken/%s", kind, cell(&t, row, "file"));
        snprintf(start, sizeof start, "error: %s:%s%s: ", path, strncmp(where, "byte", 4) == 0 ? " " : "",
                 where);
        d.said[0] = 0;
        const vplResult result = vplScene_LoadMesh(d.scene, path, &mesh);
        if (result != VPL_PARSE_ERROR || mesh != -7 || vplScene_GetMaterialCount(d.scene) != 0 ||
            vplScene_GetMeshCount(d.scene) != 0) {
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

TEST_ALONE(EveryBrokenPlySaysWhatIsWrongWhere)
{
    checkBroken("ply", 38);
}

TEST_ALONE(EveryBrokenStlSaysWhatIsWrongWhere)
{
    checkBroken("stl", 8);
}

TEST_ALONE(OddPlyFilesAreReadAsTheirTriangle)
{
    Desk d;
    openDesk(&d);
    Table t = loadTable("ply/odd/expected.csv");
    assert_true(t.rows >= 13);
    for (int row = 0; row < t.rows; row++) {
        char path[256], start[400];
        int mesh = -7;
        const char *where = cell(&t, row, "where"), *warned = cell(&t, row, "warned");
        snprintf(path, sizeof path, "tests/data/ply/odd/%s", cell(&t, row, "file"));
        snprintf(start, sizeof start, "warning: %s:%s%s %s", path, where, where[0] ? ":" : "", warned);
        d.said[0] = 0;
        if (vplScene_LoadMesh(d.scene, path, &mesh) != VPL_SUCCESS ||
            vplScene_GetMesh(d.scene, mesh)->triangleCount != 1 ||
            vplScene_GetMesh(d.scene, mesh)->vertexCount != 3) {
            fail_msg("%s: %s", path, d.said);
        }
        if (warned[0] == 0 ? d.said[0] != 0 : strncmp(d.said, start, strlen(start)) != 0) {
            fail_msg("\"%s\" instead of \"%s\"", d.said, start);
        }
    }
    freeTable(&t);
    closeDesk(&d);
}

TEST_ALONE(OddStlFilesAreReadAsTheirTriangle)
{
    static const char* const files[] = {"solid-binary.stl", "trailing-bytes.stl", "upper-case-name.STL"};
    Desk d;
    openDesk(&d);
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        char path[128];
        int index;
        snprintf(path, sizeof path, "tests/data/stl/odd/%s", files[i]);
        assert_int_equal(vplScene_LoadMesh(d.scene, path, &index), VPL_SUCCESS);
        const vplMeshDef* mesh = vplScene_GetMesh(d.scene, index);
        assert_int_equal(mesh->triangleCount, 1);
        assert_null(mesh->normals);
        assertPoint(meshCorner(mesh, 0, 0), 0, 0, 0);
        assertPoint(meshCorner(mesh, 0, 1), 1, 0, 0);
        assertPoint(meshCorner(mesh, 0, 2), 0, 1, 0);
    }
    assert_int_equal(d.said[0], 0);
    closeDesk(&d);
}

TEST(AnotherEndingIsNoMesh, 1)
{
    vplScene* scene;
    vplScene* other = NULL;
    assert_int_equal(vplScene_Create(context, &scene), VPL_SUCCESS);
    assert_int_equal(vplScene_LoadMesh(scene, "a.glb", NULL), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "a.glb: a file of one mesh must end in .obj, .ply or .stl"));
    assert_int_equal(vplScene_Load(context, "a.FBX", &other), VPL_PARSE_ERROR);
    assert_non_null(
        strstr(takeMessage(), "a.FBX: .fbx files are not read; a scene is a JSON file, or a model"));
    assert_int_equal(vplScene_LoadMesh(scene, "none.ply", NULL), VPL_FILE_ERROR);
    takeMessage();
    assert_null(other);
    vplScene_Destroy(scene);
}

// ---- the three formats

// A file under construction, in any of the formats.
typedef struct Writer {
    FILE* file;
    int format; // ascii, little, big
} Writer;

static void put(const Writer* w, const void* value, int size, const char* text)
{
    const uint16_t one = 1;
    const bool little = *(const uint8_t*)&one == 1; // as this machine's own numbers are
    unsigned char bytes[8];
    memcpy(bytes, value, (size_t)size);
    if (w->format == 0) {
        fprintf(w->file, "%s ", text);
    }
    for (int i = 0; i < size && w->format > 0; i++) {
        fputc(bytes[(w->format == 2) == little ? size - 1 - i : i], w->file);
    }
}

// Writes a number as one of the types of PLY.
static void putNumber(const Writer* w, const char* type, double number)
{
    const int8_t i8 = (int8_t)number;
    const uint8_t u8 = (uint8_t)(int)number;
    const int16_t i16 = (int16_t)number;
    const uint16_t u16 = (uint16_t)(int)number;
    const int32_t i32 = (int32_t)number;
    const uint32_t u32 = (uint32_t)(int64_t)number;
    const float f = (float)number;
    const struct {
        const char* name;
        const void* value;
        int size;
    } types[] = {{"char", &i8, 1}, {"uchar", &u8, 1}, {"short", &i16, 2}, {"ushort", &u16, 2},
                 {"int", &i32, 4}, {"uint", &u32, 4}, {"float", &f, 4},   {"double", &number, 8}};
    char text[40];
    snprintf(text, sizeof text, "%.9g", number);
    for (int i = 0; i < 8; i++) {
        if (strcmp(types[i].name, type) == 0) {
            put(w, types[i].value, types[i].size, text);
        }
    }
}

// Five points with normals and colours; a quad and a triangle, whose indices have the given types.
static void writePly(const char* path, int format, const char* coordinate, const char* count,
                     const char* index)
{
    static const char* const formats[] = {"ascii", "binary_little_endian", "binary_big_endian"};
    static const int points[5][3] = {{0, 0, 0}, {4, 0, 0}, {4, 3, 0}, {0, 3, 0}, {2, 5, 0}};
    static const int faces[2][5] = {{4, 0, 1, 2, 3}, {3, 3, 2, 4}};
    const Writer w = {fopen(path, "wb"), format};
    assert_non_null(w.file);
    fprintf(w.file,
            "ply\nformat %s 1.0\nelement vertex 5\nproperty %s x\nproperty %s y\nproperty %s z\n"
            "property float nx\nproperty float ny\nproperty float nz\n"
            "property uchar red\nproperty uchar green\nproperty uchar blue\n"
            "element face 2\nproperty list %s %s vertex_indices\nend_header\n",
            formats[format], coordinate, coordinate, coordinate, count, index);
    for (int i = 0; i < 5; i++) {
        for (int k = 0; k < 3; k++) {
            putNumber(&w, coordinate, points[i][k]);
        }
        putNumber(&w, "float", 0);
        putNumber(&w, "float", 0);
        putNumber(&w, "float", i == 4 ? 2.5 : 1);
        putNumber(&w, "uchar", 51 * i);
        putNumber(&w, "uchar", 255);
        putNumber(&w, "uchar", 188);
    }
    for (int f = 0; f < 2; f++) {
        for (int k = 0; k <= faces[f][0]; k++) {
            putNumber(&w, k == 0 ? count : index, faces[f][k]);
        }
    }
    fclose(w.file);
}

static void assertHouse(const vplMeshDef* mesh)
{
    static const double corners[3][3][2] = {
        {{0, 0}, {4, 0}, {4, 3}}, {{0, 0}, {4, 3}, {0, 3}}, {{0, 3}, {4, 3}, {2, 5}}};
    assert_int_equal(mesh->triangleCount, 3);
    assert_int_equal(mesh->vertexCount, 5);
    double area = 0;
    for (int t = 0; t < 3; t++) {
        const vplVec3 a = meshCorner(mesh, t, 0), b = meshCorner(mesh, t, 1), c = meshCorner(mesh, t, 2);
        area += 0.5 * (double)vplCross(vplSub(b, a), vplSub(c, a)).z;
    }
    assert_true(area == 16);
    for (int k = 0; k < 3; k++) {
        assertPoint(meshCorner(mesh, 2, k), corners[2][k][0], corners[2][k][1], 0);
    }
    for (int i = 0; i < 5; i++) {
        assertPoint(mesh->normals[i], 0, 0, 1);
        assert_true(mesh->colors[i].g == 1 && mesh->colors[i].b == vplSrgb_Decode(188 / 255.0f));
    }
    const uint32_t top = mesh->indices[8];
    assert_true(mesh->colors[top].r == vplSrgb_Decode(204 / 255.0f));
}

TEST_ALONE(EveryFormatAndTypeGivesTheSameMesh)
{
    static const char* const coordinates[] = {"char", "uchar", "short", "ushort",
                                              "int",  "uint",  "float", "double"};
    Desk d;
    openDesk(&d);
    char path[128];
    snprintf(path, sizeof path, "%s/a.ply", d.folder);
    for (int i = 0; i < 3 * 8; i++) {
        int index = -1;
        writePly(path, i / 8, coordinates[i % 8], coordinates[i % 6], coordinates[(i + 3) % 6]);
        if (vplScene_LoadMesh(d.scene, path, &index) != VPL_SUCCESS) {
            fail_msg("format %d, %s: %s", i / 8, coordinates[i % 8], d.said);
        }
        assertHouse(vplScene_GetMesh(d.scene, index));
        const vplMaterialDef* material =
            vplScene_GetMaterial(d.scene, vplScene_GetMesh(d.scene, index)->materials[0]);
        assertColour(material->diffuse, 1, 1, 1);
    }
    assert_int_equal(d.said[0], 0);
    unlink(path);
    closeDesk(&d);
}

// The colours of vertices in a text: 16-bit codes, real numbers (linear, clamped), and none.
TEST_ALONE(ColoursOfVerticesAreReflectances)
{
    static const struct {
        const char *type, *values;
        double red;
    } cases[] = {{"ushort", "65535 0 0", 1}, {"float", "0.25 0 0", 0.25}, {"float", "7 0 0", 1},
                 {"float", "nan 0 0", 0},    {"int", "300 0 0", 1},       {"char", "-5 0 0", 0}};
    Desk d;
    openDesk(&d);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[600], path[128];
        int index = -1;
        snprintf(path, sizeof path, "%s/a.ply", d.folder);
        snprintf(
            text, sizeof text,
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
            "property %s red\nproperty %s green\nproperty %s blue\nelement face 1\n"
            "property list int int vertex_indices\nend_header\n0 0 0 %s\n1 0 0 %s\n0 1 0 %s\n3 0 1 2\n",
            cases[i].type, cases[i].type, cases[i].type, cases[i].values, cases[i].values, cases[i].values);
        writeText(path, text);
        assert_int_equal(vplScene_LoadMesh(d.scene, path, &index), VPL_SUCCESS);
        assertColour(vplScene_GetMesh(d.scene, index)->colors[0], cases[i].red, 0, 0);
        unlink(path);
    }
    closeDesk(&d);
}

// A concave polygon of five corners is covered without overlap, a vertex that no face names is left out.
TEST_ALONE(PolygonsAreCutIntoEars)
{
    static const char text[] =
        "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
        "0 0 0\n4 0 0\n4 4 0\n2 1 0\n99 99 99\n0 4 0\n5 0 1 2 3 5\n";
    Desk d;
    openDesk(&d);
    char path[128];
    int index = -1;
    double area = 0;
    snprintf(path, sizeof path, "%s/a.ply", d.folder);
    writeText(path, text);
    assert_int_equal(vplScene_LoadMesh(d.scene, path, &index), VPL_SUCCESS);
    const vplMeshDef* mesh = vplScene_GetMesh(d.scene, index);
    assert_int_equal(mesh->vertexCount, 5);
    for (int t = 0; t < mesh->triangleCount; t++) {
        const vplVec3 a = meshCorner(mesh, t, 0);
        const vplVec3 cross = vplCross(vplSub(meshCorner(mesh, t, 1), a), vplSub(meshCorner(mesh, t, 2), a));
        assert_true(cross.z > 0);
        area += 0.5 * (double)cross.z;
    }
    assert_true(area == 10);
    unlink(path);
    closeDesk(&d);
}

// ---- as a scene

// A PLY file alone has the camera, the ground and the lamps that the same OBJ file gets.
TEST_ALONE(APlyFileIsASceneLikeAnObjFile)
{
    Desk d;
    openDesk(&d);
    vplScene *ply = NULL, *obj = NULL, *stl = NULL;
    writeText(d.obj, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    assert_int_equal(vplScene_Load(d.context, d.obj, &obj), VPL_SUCCESS);
    assert_int_equal(vplScene_Load(d.context, "tests/data/ply/odd/crlf.ply", &ply), VPL_SUCCESS);
    assert_int_equal(vplScene_Load(d.context, "tests/data/stl/odd/solid-binary.stl", &stl), VPL_SUCCESS);
    assert_true(vplScene_GetHash(ply) == vplScene_GetHash(obj));
    assert_true(vplScene_GetHash(stl) == vplScene_GetHash(obj));
    assert_int_equal(countOf(d.said, "the file has no camera; one looks from"), 3);
    vplScene_Destroy(ply);
    vplScene_Destroy(obj);
    vplScene_Destroy(stl);
    closeDesk(&d);
}

TEST_ALONE(ModelsBecomeObjects)
{
    Desk d;
    int first = -1, count = -1;
    openDesk(&d);
    vplObjectDef def = vplDefaultObjectDef();
    def.material = -1;
    def.transform.m[13] = 7;
    assert_int_equal(vplScene_LoadModel(d.scene, "tests/data/ply/odd/crlf.ply", &def, &first, &count),
                     VPL_SUCCESS);
    assert_int_equal(vplScene_LoadModel(d.scene, "tests/data/stl/odd/solid-binary.stl", &def, &first, &count),
                     VPL_SUCCESS);
    assert_int_equal(first, 1);
    assert_int_equal(count, 1);
    const vplObjectDef* object = vplScene_GetObject(d.scene, 1);
    assert_true(object->type == VPL_OBJECT_MESH && object->mesh == 1 && object->transform.m[13] == 7);
    def.material = 9;
    assert_int_equal(vplScene_LoadModel(d.scene, "tests/data/ply/odd/crlf.ply", &def, &first, &count),
                     VPL_INVALID_ARGUMENT);
    assert_int_equal(vplScene_GetMeshCount(d.scene), 2);
    assert_int_equal(vplScene_GetObjectCount(d.scene), 2);
    assert_int_equal(vplScene_LoadModel(d.scene, "a.png", &def, &first, &count), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(d.said, "a.png: must end in .obj, .ply, .stl, .gltf or .glb"));
    closeDesk(&d);
}
