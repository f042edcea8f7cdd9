// SPDX-License-Identifier: MIT
// Tests of writing lit meshes as PLY files, which are read back byte by byte.
#include "patch_support.h"

#include "base/bytes.h"
#include "math/vec.h"
#include "radiosity/mesh/patch_mesh.h"

#include <stdlib.h>
#include <unistd.h>

enum { VERTEX_BYTES = 39, FACE_BYTES = 13 };

typedef struct Ply {
    uint8_t* bytes;
    size_t size, head;
    int vertexCount, faceCount;
} Ply;

static float floatAt(const uint8_t* at)
{
    const uint32_t bits = vplTakeWord(at);
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static const uint8_t* vertexOf(const Ply* ply, int i)
{
    assert_in_range(i, 0, ply->vertexCount - 1);
    return ply->bytes + ply->head + (size_t)i * VERTEX_BYTES;
}

static int cornerOf(const Ply* ply, int face, int corner)
{
    const uint8_t* at =
        ply->bytes + ply->head + (size_t)ply->vertexCount * VERTEX_BYTES + (size_t)face * FACE_BYTES;
    assert_int_equal(at[0], 3);
    return (int)vplTakeWord(at + 1 + 4 * corner);
}

static vplVec3 vecAt(const Ply* ply, int vertex, int offset)
{
    const uint8_t* at = vertexOf(ply, vertex) + offset;
    return vplVec(floatAt(at), floatAt(at + 4), floatAt(at + 8));
}

// Reads a file; its header must be exactly this text.
static Ply readPly(const char* path)
{
    Ply ply = {0};
    char wanted[600];
    FILE* file = fopen(path, "rb");
    assert_non_null(file);
    ply.bytes = malloc(1 << 20);
    ply.size = fread(ply.bytes, 1, (1 << 20) - 1, file);
    ply.bytes[ply.size] = 0;
    fclose(file);
    const char* text = strstr((char*)ply.bytes, "element vertex");
    assert_non_null(text);
    assert_int_equal(sscanf(text, "element vertex %d", &ply.vertexCount), 1);
    text = strstr((char*)ply.bytes, "element face");
    assert_non_null(text);
    assert_int_equal(sscanf(text, "element face %d", &ply.faceCount), 1);
    ply.head = (size_t)snprintf(wanted, sizeof wanted,
                                "ply\nformat binary_little_endian 1.0\n"
                                "comment radiosity in W/m^2, linear in r g b\nelement vertex %d\n"
                                "property float x\nproperty float y\nproperty float z\n"
                                "property float nx\nproperty float ny\nproperty float nz\n"
                                "property uchar red\nproperty uchar green\nproperty uchar blue\n"
                                "property float r\nproperty float g\nproperty float b\nelement face %d\n"
                                "property list uchar int vertex_indices\nend_header\n",
                                ply.vertexCount, ply.faceCount);
    assert_memory_equal(ply.bytes, wanted, ply.head);
    assert_int_equal(ply.size,
                     ply.head + (size_t)ply.vertexCount * VERTEX_BYTES + (size_t)ply.faceCount * FACE_BYTES);
    return ply;
}

// Makes the square [0, 1]^2 at z = 0 in two triangles, and a third triangle beside it that no light reaches.
static vplPatchMesh* flatMesh(vplContext* context, OpenFcn* open)
{
    vplScene* scene = sceneOf(context, 0.5f);
    Shape shape = {0};
    addTriangle(&shape, vplVec(0, 0, 0), vplVec(1, 0, 0), vplVec(1, 1, 0));
    addTriangle(&shape, vplVec(0, 0, 0), vplVec(1, 1, 0), vplVec(0, 1, 0));
    addTriangle(&shape, vplVec(1, 0, 0), vplVec(2, 0, 0), vplVec(1, 1, 0));
    addShape(scene, &shape, false, NULL);
    freeShape(&shape);
    return meshOf(openSides(openPatches(buildGeometry(scene), 100, 0), open));
}

// Opens the fronts of the first two patches and the back of the second.
static uint16_t someOpen(const vplPatches* patches, int patch, int face)
{
    (void)patches;
    return patch == 1 || (patch == 0 && face == 0) ? 0xffff : 0;
}

static Ply writeAndRead(const vplPatchMesh* m, const vplRgb* irradiance, float scale)
{
    char folder[] = "/tmp/vpl-ply-XXXXXX", path[64];
    assert_non_null(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/a.ply", folder);
    if (vplPatchMesh_WritePly(m, irradiance, scale, path) != VPL_SUCCESS) {
        fail_msg("%s", takeMessage());
    }
    const Ply ply = readPly(path);
    unlink(path);
    assert_int_equal(rmdir(folder), 0);
    return ply;
}

// Writes a file with irradiance x + 2 at fronts, 8 at backs; the two lit patches have different reflectances.
static Ply bake(vplContext* context, vplPatchMesh** meshOut)
{
    vplPatchMesh* m = *meshOut = flatMesh(context, someOpen);
    vplRgb irradiance[40];
    for (int v = 0; v < m->vertexCount; v++) {
        const float front = m->positions[v].x + 2;
        irradiance[2 * v] = (vplRgb){front, front, front};
        irradiance[2 * v + 1] = (vplRgb){8, 8, 8};
    }
    for (int i = 0; i < m->sides->count; i++) {
        vplPatchSide* side = (vplPatchSide*)&m->sides->sides[i];
        side->reflectance = side->patch == 0 ? (vplRgb){0.5f, 0, 0.25f} : (vplRgb){0.125f, 0.5f, 0};
    }
    return writeAndRead(m, irradiance, 0.25f);
}

// The file has three fronts (the third with its material's colour) and one back; where two reflectances meet,
// each has a vertex of its own.
TEST(FileHasAllFrontsAndTheLitBacks, 1)
{
    vplPatchMesh* m;
    Ply ply = bake(context, &m);
    assert_int_equal(ply.faceCount, 4);
    assert_int_equal(ply.vertexCount, 12);
    for (int f = 0; f < 4; f++) {
        const vplVec3 a = vecAt(&ply, cornerOf(&ply, f, 0), 0), b = vecAt(&ply, cornerOf(&ply, f, 1), 0),
                      c = vecAt(&ply, cornerOf(&ply, f, 2), 0), n = vplCross(vplSub(b, a), vplSub(c, a));
        assert_true(n.z == (f < 3 ? 1 : -1)); // twice the area; the back is wound to be seen from behind
        for (int k = 0; k < 3; k++) {
            assert_true(vecAt(&ply, cornerOf(&ply, f, k), 12).z == n.z);
        }
    }
    free(ply.bytes);
    closeMesh(m);
}

TEST(ColoursAreRadiosity, 1)
{
    vplPatchMesh* m;
    Ply ply = bake(context, &m);
    const float rho[4][3] = {{0.5f, 0, 0.25f}, {0.125f, 0.5f, 0}, {0.5f, 0.5f, 0.5f}, {0.125f, 0.5f, 0}};
    for (int i = 0; i < 12; i++) {
        const int face = i / 3, vertex = cornerOf(&ply, face, i % 3);
        const vplVec3 p = vecAt(&ply, vertex, 0), colour = vecAt(&ply, vertex, 27);
        for (int k = 0; k < 3; k++) {
            const float wanted = rho[face][k] * (face == 3 ? 8 : p.x + 2);
            assert_true(vplComponent(colour, k) == wanted);
            assert_int_equal(vertexOf(&ply, vertex)[24 + k], vplSrgb_Code(0.25f * wanted));
        }
    }
    free(ply.bytes);
    closeMesh(m);
}

// With one reflectance for all, the file's vertices are those of the mesh.
TEST(VerticesAreSharedWhereColoursAgree, 1)
{
    vplPatchMesh* m = flatMesh(context, frontsOpen);
    const vplRgb irradiance[40] = {{0, 0, 0}};
    Ply ply = writeAndRead(m, irradiance, 1);
    assert_int_equal(ply.vertexCount, 5);
    assert_int_equal(ply.faceCount, 3);
    free(ply.bytes);
    closeMesh(m);
}

// The reader takes the file as a mesh: its triangles, normals and sRGB colours.
TEST(WhatIsWrittenIsReadBack, 1)
{
    vplPatchMesh* m;
    char folder[] = "/tmp/vpl-ply-XXXXXX", path[64];
    Ply ply = bake(context, &m);
    vplScene* scene = NULL;
    int index = -1;
    assert_non_null(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/a.ply", folder);
    FILE* file = fopen(path, "wb");
    assert_int_equal(fwrite(ply.bytes, 1, ply.size, file), ply.size);
    fclose(file);
    assert_int_equal(vplScene_Create(context, &scene), VPL_SUCCESS);
    assert_int_equal(vplScene_LoadMesh(scene, path, &index), VPL_SUCCESS);
    const vplMeshDef* mesh = vplScene_GetMesh(scene, index);
    assert_int_equal(mesh->triangleCount, ply.faceCount);
    for (int i = 0; i < 3 * mesh->triangleCount; i++) {
        const int from = cornerOf(&ply, i / 3, i % 3);
        const uint32_t to = mesh->indices[i];
        const vplVec3 p = vecAt(&ply, from, 0), n = vecAt(&ply, from, 12);
        assert_memory_equal(&mesh->positions[to], &p, sizeof p);
        assert_memory_equal(&mesh->normals[to], &n, sizeof n);
        const uint8_t* code = vertexOf(&ply, from) + 24;
        assert_true(mesh->colors[to].r == vplSrgb_Decode(code[0] / 255.0f));
        assert_true(mesh->colors[to].b == vplSrgb_Decode(code[2] / 255.0f));
    }
    vplScene_Destroy(scene);
    unlink(path);
    assert_int_equal(rmdir(folder), 0);
    free(ply.bytes);
    closeMesh(m);
}

TEST(FilesThatCannotBeAreRefused, 1)
{
    vplPatchMesh* m = flatMesh(context, frontsOpen);
    vplRgb irradiance[40] = {{0, 0, 0}};
    assert_int_equal(vplPatchMesh_WritePly(m, irradiance, 1, "/nowhere/a.ply"), VPL_FILE_ERROR);
    assert_int_equal(vplPatchMesh_WritePly(m, irradiance, -1, "/tmp/a.ply"), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "is -1, must be finite and at least 0"));
    irradiance[3].b = NAN;
    assert_int_equal(vplPatchMesh_WritePly(m, irradiance, 1, "/tmp/a.ply"), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "vertexIrradiance[3]"));
    closeMesh(m);
}
