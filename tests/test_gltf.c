// SPDX-License-Identifier: MIT
// Tests of glTF files: damaged and odd ones, accessors of every form, primitives, nodes.
#include "gltf_support.h"

#include "base/bytes.h"
#include "math/vec.h"

#include <unistd.h>

// ---- damaged and odd files

TEST_ALONE(EveryBrokenGltfSaysWhatIsWrongWhere)
{
    Desk d;
    openDesk(&d);
    Table t = loadTable("gltf/broken/expected.csv");
    assert_true(t.rows >= 85);
    for (int row = 0; row < t.rows; row++) {
        char path[256], start[400];
        vplScene* scene = NULL;
        const char *where = cell(&t, row, "where"), *error;
        snprintf(path, sizeof path, "tests/data/gltf/broken/%s", cell(&t, row, "file"));
        snprintf(start, sizeof start, "error: %s:%s%s: ", path, strncmp(where, "byte", 4) == 0 ? " " : "",
                 where);
        d.said[0] = 0;
        const vplResult result = vplScene_Load(d.context, path, &scene);
        if (result != VPL_PARSE_ERROR || scene != NULL) {
            fail_msg("%s: %s instead of a parse error", path, vplResult_GetName(result));
        }
        error = strstr(d.said, "error: ");
        if (strncmp(error, start, strlen(start)) != 0 || countOf(d.said, "error: ") != 1 ||
            strstr(error, cell(&t, row, "found")) == NULL ||
            strstr(error, cell(&t, row, "expected")) == NULL) {
            fail_msg("\"%s\" instead of \"%s%s, %s\"", d.said, start, cell(&t, row, "found"),
                     cell(&t, row, "expected"));
        }
    }
    freeTable(&t);
    closeDesk(&d);
}

TEST_ALONE(OddGltfFilesAreReadWithOneWarning)
{
    Desk d;
    openDesk(&d);
    Table t = loadTable("gltf/odd/expected.csv");
    assert_true(t.rows >= 21);
    for (int row = 0; row < t.rows; row++) {
        char path[256], sentence[400];
        const char* warned = cell(&t, row, "warned");
        vplObjectDef def = vplDefaultObjectDef();
        vplScene* scene = NULL;
        snprintf(path, sizeof path, "tests/data/gltf/odd/%s", cell(&t, row, "file"));
        snprintf(sentence, sizeof sentence, "warning: %s: %s", path, warned);
        d.said[0] = 0;
        if (vplScene_Load(d.context, path, &scene) != VPL_SUCCESS) {
            fail_msg("%s: %s", path, d.said);
        }
        const vplMeshDef* mesh = vplScene_GetMesh(scene, 0);
        assert_true(mesh->triangleCount == 1 && mesh->vertexCount == 3);
        assertPoint(meshCorner(mesh, 0, 1), 1, 0, 0);
        const int own = countOf(d.said, "has no camera") + countOf(d.said, "grey ground") +
                        countOf(d.said, "nothing emits");
        if (countOf(d.said, "\n") != own + (warned[0] != 0) ||
            (warned[0] != 0 && strstr(d.said, sentence) == NULL)) {
            fail_msg("\"%s\" instead of \"%s\"", d.said, sentence);
        }
        vplScene_Destroy(scene);
        def.material = -1; // the same file as objects of another scene
        assert_int_equal(vplScene_LoadModel(d.scene, path, &def, NULL, NULL), VPL_SUCCESS);
    }
    assert_int_equal(vplScene_GetObjectCount(d.scene), t.rows);
    freeTable(&t);
    closeDesk(&d);
}

// ---- accessors

// A quad of two triangles whose points and indices are stored in other ways.
#define QUAD_HEAD                                                                                            \
    "\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{"       \
    "\"attributes\":{\"POSITION\":0},\"indices\":1}]}],"

static const float SQUARE[12] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
static const unsigned SQUARE_INDICES[6] = {0, 1, 2, 0, 2, 3};

static void assertSquare(const vplScene* scene)
{
    const vplMeshDef* mesh = vplScene_GetMesh(scene, 0);
    assert_int_equal(mesh->triangleCount, 2);
    assert_int_equal(mesh->vertexCount, 4);
    for (int i = 0; i < 6; i++) {
        const float* p = SQUARE + 3 * SQUARE_INDICES[i];
        assertPoint(mesh->positions[mesh->indices[i]], (double)p[0], (double)p[1], (double)p[2]);
    }
}

// Appends the square's coordinates times a factor as a type of component; `gap` bytes follow each point.
static int addPoints(Blob* blob, int type, float factor, int gap)
{
    unsigned char bytes[400];
    size_t size = 0;
    for (int i = 0; i < 12; i++) {
        const float value = factor * SQUARE[i];
        const size_t width = type <= 5121 ? 1 : type <= 5123 ? 2 : 4;
        uint8_t little[4];
        vplPutWord(little, (uint32_t)(int64_t)value);
        if (type == 5126) {
            vplPutFloats(little, &value, 1);
        }
        memcpy(bytes + size, little, width);
        size += width + (i % 3 == 2 ? (size_t)gap : 0);
    }
    return addBytes(blob, bytes, size);
}

static int addIndices(Blob* blob, int type)
{
    unsigned char bytes[24];
    const size_t width = type == 5121 ? 1 : type == 5123 ? 2 : 4;
    memset(bytes, 0, sizeof bytes);
    for (size_t i = 0; i < 6; i++) {
        bytes[i * width] = (unsigned char)SQUARE_INDICES[i];
    }
    return addBytes(blob, bytes, 6 * width);
}

TEST_ALONE(EveryTypeOfComponentGivesTheSameSquare)
{
    static const struct {
        int type;
        bool normalized;
        float factor;
    } types[] = {{5120, false, 1},    {5121, false, 1},   {5122, false, 1},  {5123, false, 1},
                 {5125, false, 1},    {5126, false, 1},   {5120, true, 127}, {5121, true, 255},
                 {5122, true, 32767}, {5123, true, 65535}};
    static const int indexTypes[] = {5121, 5123, 5125};
    Desk d;
    openDesk(&d);
    for (int i = 0; i < 10 * 3 * 2 * 2; i++) {
        const int type = types[i % 10].type, index = indexTypes[i / 10 % 3], gap = i / 30 % 2 ? 8 : 0;
        const int width = type <= 5121 ? 1 : type <= 5123 ? 2 : 4, stride = 3 * width + gap;
        const char* name = i / 60 ? "a.glb" : "a.gltf";
        Blob blob = {.size = 5};
        const int points = addPoints(&blob, type, types[i % 10].factor, gap),
                  indices = addIndices(&blob, index);
        char strides[40] = "";
        if (gap > 0) {
            snprintf(strides, sizeof strides, ",\"byteStride\":%d", stride);
        }
        writeGltf(
            deskPath(&d, name), &blob,
            QUAD_HEAD
            "\"accessors\":[{\"bufferView\":0,\"byteOffset\":4,\"componentType\":%d,\"count\":4,\"type\":"
            "\"VEC3\",\"normalized\":%s},{\"bufferView\":1,\"componentType\":%d,\"count\":6,\"type\":"
            "\"SCALAR\"}],\"bufferViews\":[{\"buffer\":0,\"byteOffset\":%d,\"byteLength\":%d%s},{"
            "\"buffer\":0,\"byteOffset\":%d,\"byteLength\":%d}]",
            type, types[i % 10].normalized ? "true" : "false", index, points - 4, 4 + 3 * stride + 3 * width,
            strides, indices,
            6 * (index == 5121   ? 1
                 : index == 5123 ? 2
                                 : 4));
        vplScene* scene = loadGltf(&d, name);
        assertSquare(scene);
        vplScene_Destroy(scene);
    }
    closeDesk(&d);
}

// Signed components are negative; the smallest normalized one is -1, too.
TEST_ALONE(SignedComponentsKeepTheirSigns)
{
    static const signed char points[9] = {-128, 0, 0, 127, 0, 0, 0, -127, 64};
    Desk d;
    openDesk(&d);
    Blob blob = {.size = 0};
    addBytes(&blob, points, sizeof points);
    for (int normalized = 0; normalized < 2; normalized++) {
        writeGltf(
            deskPath(&d, "a.gltf"), &blob,
            "\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],"
            "\"accessors\":[{\"bufferView\":0,\"componentType\":5120,\"count\":3,\"type\":\"VEC3\","
            "\"normalized\":"
            "%s}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":9}]",
            normalized ? "true" : "false");
        vplScene* scene = loadGltf(&d, "a.gltf");
        const vplMeshDef* mesh = vplScene_GetMesh(scene, 0);
        assertPoint(meshCorner(mesh, 0, 0), normalized ? -1 : -128, 0, 0);
        assertPoint(meshCorner(mesh, 0, 1), normalized ? 1 : 127, 0, 0);
        assertPoint(meshCorner(mesh, 0, 2), 0, normalized ? -1 : -127,
                    normalized ? (double)(64 / 127.0f) : 64);
        vplScene_Destroy(scene);
    }
    closeDesk(&d);
}

// Points are zeros, or other points, of which a sparse accessor replaces some; so are indices.
TEST_ALONE(SparseAccessorsReplaceElements)
{
    static const unsigned char bytes[] = {1, 2, 3}, shorts[] = {1, 0, 2, 0, 3, 0};
    static const float wrong[12] = {0, 0, 0, 9, 9, 9, 8, 8, 8, 7, 7, 7};
    static const unsigned char last[8] = {2, 0, 0, 0, 3}, after[8] = {4, 0, 0, 0, 5};
    Desk d;
    openDesk(&d);
    for (int i = 0; i < 4; i++) {
        Blob blob = {.size = 0};
        const int base = addFloats(&blob, wrong, 12), values = addFloats(&blob, SQUARE + 3, 9);
        const int one = addBytes(&blob, bytes, 3), two = addBytes(&blob, shorts, 6),
                  tail = addBytes(&blob, last, 8);
        const int fours = addBytes(&blob, after, 8), indices = addIndices(&blob, 5125);
        memset(blob.bytes + indices + 16, 0, 8); // the last two indices come from the sparse part
        writeGltf(
            deskPath(&d, "a.gltf"), &blob,
            QUAD_HEAD
            "\"accessors\":[{%s\"componentType\":5126,\"count\":4,\"type\":\"VEC3\",\"sparse\":{\"count\":3,"
            "\"indices\":{\"bufferView\":%d,\"componentType\":%d},\"values\":{\"bufferView\":1}}},"
            "{\"bufferView\":4,\"componentType\":5125,\"count\":6,\"type\":\"SCALAR\",\"sparse\":{\"count\":"
            "2,"
            "\"indices\":{\"bufferView\":6,\"componentType\":5125},\"values\":{\"bufferView\":5}}}],"
            "\"bufferViews\":[{\"buffer\":0,\"byteOffset\":%d,\"byteLength\":48},{\"buffer\":0,"
            "\"byteOffset\":%d,\"byteLength\":36},{\"buffer\":0,\"byteOffset\":%d,\"byteLength\":3},{"
            "\"buffer\":0,\"byteOffset\":%d,\"byteLength\":6},{\"buffer\":0,\"byteOffset\":%d,"
            "\"byteLength\":24},{\"buffer\":0,\"byteOffset\":%d,\"byteLength\":8},{\"buffer\":0,"
            "\"byteOffset\":%d,\"byteLength\":8}]",
            i % 2 ? "\"bufferView\":0," : "", i / 2 ? 3 : 2, i / 2 ? 5123 : 5121, base, values, one, two,
            indices, tail, fours);
        vplScene* scene = loadGltf(&d, "a.gltf");
        assertSquare(scene);
        vplScene_Destroy(scene);
    }
    closeDesk(&d);
}

// ---- primitives

// Five points of a zigzag as a list, strip or fan, with and without indices.
TEST_ALONE(StripsAndFansAreTurnedIntoTriangles)
{
    static const float points[15] = {0, 0, 0, 0, 1, 0, 1, 0, 0, 1, 1, 0, 2, 0, 0};
    static const float fan[15] = {0, 0, 0, 2, 0, 0, 2, 1, 0, 1, 2, 0, 0, 2, 0};
    static const unsigned char order[5] = {0, 1, 2, 3, 4};
    static const double areas[] = {-0.5, -1.5, 3.5}; // y grows up: the zigzag is seen from behind
    Desk d;
    openDesk(&d);
    for (int i = 0; i < 6; i++) {
        Blob blob = {.size = 0};
        const int mode = 4 + i % 3;
        double area = 0;
        addFloats(&blob, mode == 6 ? fan : points, 15);
        const int indices = addBytes(&blob, order, 5);
        writeGltf(deskPath(&d, "a.gltf"), &blob,
                  "\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},"
                  "\"mode\":%d%s}]}],"
                  "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":5,\"type\":\"VEC3\"},{"
                  "\"bufferView\":1,"
                  "\"componentType\":5121,\"count\":5,\"type\":\"SCALAR\"}],\"bufferViews\":[{\"buffer\":0,"
                  "\"byteLength\":60},{\"buffer\":0,\"byteOffset\":%d,\"byteLength\":5}]",
                  mode, i / 3 ? ",\"indices\":1" : "", indices);
        vplScene* scene = loadGltf(&d, "a.gltf");
        const vplMeshDef* mesh = vplScene_GetMesh(scene, 0);
        assert_int_equal(mesh->triangleCount, mode == 4 ? 1 : 3);
        for (int t = 0; t < mesh->triangleCount; t++) {
            const vplVec3 a = meshCorner(mesh, t, 0);
            const vplVec3 n = vplCross(vplSub(meshCorner(mesh, t, 1), a), vplSub(meshCorner(mesh, t, 2), a));
            assert_true((n.z > 0) == (areas[mode - 4] > 0)); // all triangles turn the same way
            area += 0.5 * (double)n.z;
        }
        assert_true(area == areas[mode - 4]);
        vplScene_Destroy(scene);
    }
    closeDesk(&d);
}

// Two primitives of one mesh: one with normals, colours and a material, one without; they share no arrays.
TEST_ALONE(PrimitivesBecomeOneMeshWithTheirMaterials)
{
    static const float points[18] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 5, 1, 0, 5, 0, 1, 5};
    static const float normals[9] = {0, 0, 2, 0, 3, 4, 0, 0, 0};
    static const float colours[12] = {0.25f, 0.5f, 1, 0.5f, 2, 0, 0, 1, 0, 0, 0, 1};
    Desk d;
    openDesk(&d);
    Blob blob = {.size = 0};
    addFloats(&blob, points, 18);
    addFloats(&blob, normals, 9);
    addFloats(&blob, colours, 12);
    writeGltf(
        deskPath(&d, "a.glb"), &blob,
        "\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"NORMAL\":2,"
        "\"COLOR_0\":3},\"material\":0},{\"attributes\":{\"POSITION\":1}}]}],\"materials\":[{\"name\":"
        "\"red\","
        "\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.5,0.25,0,1],\"metallicFactor\":0}}],"
        "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"},"
        "{\"bufferView\":0,\"byteOffset\":36,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"},"
        "{\"bufferView\":0,\"byteOffset\":72,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"},"
        "{\"bufferView\":0,\"byteOffset\":108,\"componentType\":5126,\"count\":3,\"type\":\"VEC4\"}],"
        "\"bufferViews\":[{\"buffer\":0,\"byteLength\":156}]");
    vplScene* scene = loadGltf(&d, "a.glb");
    const vplMeshDef* mesh = vplScene_GetMesh(scene, 0);
    assert_int_equal(mesh->triangleCount, 2);
    assert_int_equal(mesh->vertexCount, 6);
    assertPoint(mesh->normals[mesh->indices[0]], 0, 0, 1);
    assertPoint(mesh->normals[mesh->indices[1]], 0, (double)0.6f, (double)0.8f);
    assertPoint(mesh->normals[mesh->indices[2]], 0, 0, 1); // has no direction: the triangle's
    assertPoint(mesh->normals[mesh->indices[5]], 0, 0, 1); // there is none
    assertColour(mesh->colors[mesh->indices[0]], 0.25, 0.5, 1);
    assertColour(mesh->colors[mesh->indices[1]], 1, 0, 0);
    assertColour(mesh->colors[mesh->indices[3]], 1, 1, 1);
    const vplMaterialDef *red = vplScene_GetMaterial(scene, mesh->materials[0]),
                         *grey = vplScene_GetMaterial(scene, mesh->materials[1]);
    assert_string_equal(red->name, "a.glb:red");
    assertColour(red->diffuse, 0.5, 0.25, 0);
    assertColour(grey->diffuse, 0.5, 0.5, 0.5); // white metal
    vplScene_Destroy(scene);
    closeDesk(&d);
}

// ---- nodes

#define PLACED_TRIANGLE                                                                                      \
    "\"meshes\":[{\"name\":\"tri\",\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],\"accessors\":[{"    \
    "\"bufferView\":0,"                                                                                      \
    "\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":"  \
    "36}]"

static Blob triangleBlob(void)
{
    Blob blob = {.size = 0};
    addFloats(&blob, SQUARE, 9);
    return blob;
}

static void assertPlace(const vplMat4* m, const double wanted[16])
{
    for (int i = 0; i < 16; i++) {
        if (!(fabs((double)m->m[i] - wanted[i]) < 1e-6)) {
            fail_msg("element %d is %g instead of %g", i, (double)m->m[i], wanted[i]);
        }
    }
}

// A quarter turn about z, a scale and a translation: as parts, as a matrix, and as three nodes.
TEST_ALONE(PartsMatricesAndParentsGiveTheSamePlace)
{
    static const char* const nodes[] = {
        "{\"mesh\":0,\"translation\":[1,2,3],\"rotation\":[0,0,1.4142135,1.4142135],\"scale\":[2,3,4]}",
        "{\"mesh\":0,\"matrix\":[0,2,0,0, -3,0,0,0, 0,0,4,0, 1,2,3,1]}",
        "{\"translation\":[1,2,3],\"children\":[1]},{\"rotation\":[0,0,0.70710678,0.70710678],\"children\":["
        "2]},"
        "{\"scale\":[2,3,4],\"mesh\":0}"};
    static const double wanted[16] = {0, 2, 0, 0, -3, 0, 0, 0, 0, 0, 4, 0, 1, 2, 3, 1};
    const Blob blob = triangleBlob();
    Desk d;
    openDesk(&d);
    for (int i = 0; i < 3; i++) {
        writeGltf(deskPath(&d, "a.gltf"), &blob, "\"nodes\":[%s]," PLACED_TRIANGLE, nodes[i]);
        vplScene* scene = loadGltf(&d, "a.gltf");
        assertPlace(&vplScene_GetObject(scene, 0)->transform, wanted);
        vplScene_Destroy(scene);
    }
    closeDesk(&d);
}

// Many nodes place one mesh: the scene holds it once. Nodes of other scenes are left out; their order is the file's.
TEST_ALONE(NodesShareTheirMesh)
{
    const Blob blob = triangleBlob();
    Desk d;
    openDesk(&d);
    writeGltf(deskPath(&d, "a.glb"), &blob,
              "\"scene\":1,\"scenes\":[{\"nodes\":[3]},{\"nodes\":[0,2]}],\"nodes\":[{\"mesh\":0,\"name\":"
              "\"first\",\"children\":["
              "1]},{\"mesh\":0,\"translation\":[0,5,0]},{\"mesh\":0,\"scale\":[-1,1,1]},{\"mesh\":0}]"
              "," PLACED_TRIANGLE);
    vplScene* scene = loadGltf(&d, "a.glb");
    assert_int_equal(vplScene_GetMeshCount(scene), 1);
    assert_string_equal(vplScene_GetObject(scene, 0)->name, "first");
    assert_string_equal(vplScene_GetObject(scene, 1)->name, "tri");
    assert_true(vplScene_GetObject(scene, 1)->transform.m[13] == 5);
    assert_true(vplScene_GetObject(scene, 2)->transform.m[0] == -1);
    assert_int_equal(vplScene_GetObject(scene, 3)->type, VPL_OBJECT_QUAD); // the ground
    vplScene_Destroy(scene);
    closeDesk(&d);
}

TEST_ALONE(AGlbFileIsTheSameScene)
{
    const Blob blob = triangleBlob();
    Desk d;
    openDesk(&d);
    uint64_t hashes[2];
    for (int i = 0; i < 2; i++) {
        const char* name = i ? "a.glb" : "a.gltf";
        writeGltf(deskPath(&d, name), &blob,
                  "\"nodes\":[{\"mesh\":0,\"rotation\":[0.1,0.2,0.3,0.4]}]," PLACED_TRIANGLE);
        vplScene* scene = loadGltf(&d, name);
        hashes[i] = vplScene_GetHash(scene);
        vplScene_Destroy(scene);
    }
    assert_true(hashes[0] == hashes[1]);
    closeDesk(&d);
}

// A buffer in a file beside, whose name has a blank, is the same as one in base64.
TEST_ALONE(BuffersMayBeFilesBeside)
{
    const Blob blob = triangleBlob();
    char bin[160];
    Desk d;
    openDesk(&d);
    snprintf(bin, sizeof bin, "%s", deskPath(&d, "a b.bin"));
    FILE* file = fopen(bin, "wb");
    fwrite(blob.bytes, 1, blob.size, file);
    fclose(file);
    writeText(deskPath(&d, "a.gltf"),
              "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":36,"
              "\"uri\":\"a%20b.bin\"}],\"nodes\":[{\"mesh\":0}]," PLACED_TRIANGLE "}");
    vplScene* scene = loadGltf(&d, "a.gltf");
    assertPoint(meshCorner(vplScene_GetMesh(scene, 0), 0, 2), 1, 1, 0);
    vplScene_Destroy(scene);
    unlink(bin);
    closeDesk(&d);
}

// In a scene file the nodes' places are inside the object's; the file is read once for two objects.
TEST_ALONE(AGltfFileIsAMeshOfASceneFile)
{
    const Blob blob = triangleBlob();
    char json[160];
    vplScene* scene = NULL;
    Desk d;
    openDesk(&d);
    snprintf(json, sizeof json, "%s", deskPath(&d, "s.json"));
    writeGltf(
        deskPath(&d, "a.glb"), &blob,
        "\"nodes\":[{\"mesh\":0,\"translation\":[1,0,0]},{\"mesh\":0,\"translation\":[0,1,0],\"extensions\":{"
        "\"KHR_lights_punctual\":{\"light\":0}}}],\"extensions\":{\"KHR_lights_punctual\":{\"lights\":[{"
        "\"type\":"
        "\"point\"}]}}," PLACED_TRIANGLE);
    writeText(json, "{\"camera\":{\"eye\":[0,0,5],\"target\":[0,0,0]},\"materials\":{\"own\":{}},\"objects\":"
                    "[{\"type\":\"mesh\","
                    "\"file\":\"a.glb\",\"scale\":2,\"translate\":[0,0,7]},{\"type\":\"mesh\",\"file\":\"a."
                    "glb\",\"material\":"
                    "\"own\"}]}");
    assert_int_equal(vplScene_Load(d.context, json, &scene), VPL_SUCCESS);
    assert_int_equal(vplScene_GetMeshCount(scene), 1);
    assert_int_equal(vplScene_GetObjectCount(scene), 4);
    assert_int_equal(vplScene_GetEmitterCount(scene), 0);
    assert_int_equal(
        countOf(d.said, "1 cameras and lights have no effect in a model that is part of a scene file"), 1);
    assertPlace(&vplScene_GetObject(scene, 1)->transform,
                (double[16]){2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 2, 7, 1});
    assertPlace(&vplScene_GetObject(scene, 2)->transform,
                (double[16]){1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 1});
    assert_int_equal(vplScene_GetObject(scene, 3)->material, 0);
    vplScene_Destroy(scene);
    unlink(json);
    unlink(deskPath(&d, "a.glb"));
    closeDesk(&d);
}
