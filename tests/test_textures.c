// SPDX-License-Identifier: MIT
// Tests of textures: what is refused, what the pyramid averages, and what surfaces show.
#include "failing.h"
#include "geometry/paint.h"
#include "obj_support.h"
#include "scene/texture.h"
#include "scenes.h"

#include <stdlib.h>
#include <unistd.h>

static vplScene* emptyScene(vplContext* context)
{
    vplScene* scene;
    assert_int_equal(vplScene_Create(context, &scene), VPL_SUCCESS);
    return scene;
}

// A chessboard of 2 x 2 texels.
static vplTextureDef smallTexture(void)
{
    static const unsigned char codes[12] = {255, 255, 255, 0, 0, 0, 0, 0, 0, 255, 255, 255};
    vplTextureDef def = vplDefaultTextureDef();
    def.texels = codes;
    def.width = def.height = 2;
    return def;
}

TEST(TexturesAreChecked, 1)
{
    vplScene* scene = emptyScene(context);
    const float linear[3] = {0.5f, 1, 1.25f};
    vplTextureDef none = smallTexture(), both = none, empty = none, large = none, bright = none, wrap = none;
    vplTextureDef channels = none, unset = none;
    none.texels = NULL;
    both.linear = linear;
    empty.width = 0;
    large.height = VPL_MAX_IMAGE_SIZE + 1;
    channels.channels = 5;
    wrap.wrapV = (vplTextureWrap)3;
    unset.cookie = 0;
    bright.texels = NULL;
    bright.linear = linear;
    bright.width = bright.height = 1;
    assertRefused(vplScene_AddTexture(scene, &none, NULL), VPL_INVALID_ARGUMENT,
                  "vplTextureDef.texels or linear must be given");
    assertRefused(vplScene_AddTexture(scene, &both, NULL), VPL_INVALID_ARGUMENT,
                  "vplTextureDef.texels or linear must be given");
    assertRefused(vplScene_AddTexture(scene, &empty, NULL), VPL_INVALID_ARGUMENT,
                  "vplTextureDef.width and height are 0 and 2");
    assertRefused(vplScene_AddTexture(scene, &large, NULL), VPL_INVALID_ARGUMENT,
                  "are 2 and 16385, must be in [1, 16384]");
    assertRefused(vplScene_AddTexture(scene, &channels, NULL), VPL_INVALID_ARGUMENT,
                  "vplTextureDef.channels is 5");
    assertRefused(vplScene_AddTexture(scene, &wrap, NULL), VPL_INVALID_ARGUMENT, "vplTextureDef.wrapV is 3");
    assertRefused(vplScene_AddTexture(scene, &bright, NULL), VPL_INVALID_ARGUMENT,
                  "vplTextureDef.linear[2] is 1.25");
    assertRefused(vplScene_AddTexture(scene, &unset, NULL), VPL_INVALID_ARGUMENT,
                  "vplTextureDef was not made by its default");
    assert_int_equal(vplScene_GetTextureCount(scene), 0);
    vplScene_Destroy(scene);
}

TEST(MaterialsRefuseTexturesThatAreNotThere, 1)
{
    vplScene* scene = emptyScene(context);
    vplMaterialDef material = vplDefaultMaterialDef();
    material.texture = 0;
    assertRefused(vplScene_AddMaterial(scene, &material, NULL), VPL_INVALID_ARGUMENT,
                  "vplMaterialDef.texture is 0");
    material.texture = -1;
    material.alphaTexture = 1;
    assertRefused(vplScene_AddMaterial(scene, &material, NULL), VPL_INVALID_ARGUMENT,
                  "vplMaterialDef.alphaTexture is 1");
    material.alphaTexture = -2;
    assertRefused(vplScene_AddMaterial(scene, &material, NULL), VPL_INVALID_ARGUMENT,
                  "vplMaterialDef.alphaTexture is -2");
    material.alphaTexture = -1;
    material.alphaFromTexture = true;
    assertRefused(vplScene_AddMaterial(scene, &material, NULL), VPL_INVALID_ARGUMENT,
                  "vplMaterialDef.alphaFromTexture is true");
    const vplTextureDef texture = smallTexture();
    int index = -1;
    assert_int_equal(vplScene_AddTexture(scene, &texture, &index), VPL_SUCCESS);
    material.texture = index;
    assert_int_equal(vplScene_AddMaterial(scene, &material, NULL), VPL_SUCCESS);
    vplScene_Destroy(scene);
}

TEST(MeshesRefuseTexcoordsAndColoursOutOfRange, 1)
{
    vplScene* scene = emptyScene(context);
    const vplVec3 positions[3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    const uint32_t indices[3] = {0, 1, 2};
    const float texcoords[6] = {0, 0, 1, 0, 0, NAN};
    const vplRgb colours[3] = {{1, 1, 1}, {1, 1.5f, 1}, {0, 0, 0}};
    vplMeshDef def = vplDefaultMeshDef();
    def.positions = positions;
    def.indices = indices;
    def.vertexCount = 3;
    def.triangleCount = 1;
    def.texcoords = texcoords;
    assertRefused(vplScene_AddMesh(scene, &def, NULL), VPL_INVALID_ARGUMENT,
                  "vplMeshDef.texcoords[2] is nan");
    def.texcoords = NULL;
    def.colors = colours;
    assertRefused(vplScene_AddMesh(scene, &def, NULL), VPL_INVALID_ARGUMENT, "vplMeshDef.colors[1] is 1.5");
    def.colors = NULL;
    assert_int_equal(vplScene_AddMesh(scene, &def, NULL), VPL_SUCCESS);
    vplScene_Destroy(scene);
}

// A scene of one material with a small texture.
static uint64_t hashOf(vplContext* context, vplTextureDef texture, vplMaterialDef material)
{
    vplScene* scene = emptyScene(context);
    assert_int_equal(vplScene_AddTexture(scene, &texture, &material.texture), VPL_SUCCESS);
    assert_int_equal(vplScene_AddMaterial(scene, &material, NULL), VPL_SUCCESS);
    const uint64_t hash = vplScene_GetHash(scene);
    vplScene_Destroy(scene);
    return hash;
}

TEST(TheHashOfASceneKnowsTexturesAndOpacity, 1)
{
    const vplMaterialDef material = vplDefaultMaterialDef();
    vplTextureDef flipped = smallTexture(), clamped = flipped;
    static const unsigned char codes[12] = {0, 0, 0, 255, 255, 255, 255, 255, 255, 0, 0, 0};
    flipped.texels = codes;
    clamped.wrapU = VPL_WRAP_CLAMP;
    vplMaterialDef glass = material, turned = material, leaf = material;
    glass.opacity = 0.5f;
    turned.textureRotation = 1;
    leaf.alphaFromTexture = true;
    const uint64_t hashes[] = {
        hashOf(context, smallTexture(), material), hashOf(context, flipped, material),
        hashOf(context, clamped, material),        hashOf(context, smallTexture(), glass),
        hashOf(context, smallTexture(), turned),   hashOf(context, smallTexture(), leaf)};
    for (size_t i = 0; i < sizeof hashes / sizeof *hashes; i++) {
        for (size_t k = 0; k < i; k++) {
            assert_true(hashes[i] != hashes[k]);
        }
    }
}

// ---- the pyramid

static vplTexture* makeTexture(vplContext* context, const float* greys, int width, int height,
                               vplTextureWrap wrap)
{
    vplTexture* texture;
    vplTextureDef def = vplDefaultTextureDef();
    def.linear = greys;
    def.width = width;
    def.height = height;
    def.channels = 1;
    def.wrapU = def.wrapV = wrap;
    assert_int_equal(vplTexture_Create(context, &def, &texture), VPL_SUCCESS);
    return texture;
}

static double lookUp(const vplTexture* texture, double u, double v, float width)
{
    float rgba[4];
    const vplTextureArea area = {.u = u, .v = v, .longU = width, .shortV = width};
    vplTexture_Lookup(texture, &area, rgba);
    return (double)rgba[0];
}

// A footprint that is longer along v filters a picture as one that is longer along u does its transpose.
TEST(BothDirectionsAreFilteredAlike, 1)
{
    enum { SIDE = 64, AT = 200 };
    static float greys[SIDE * SIDE], turned[SIDE * SIDE];
    for (int i = 0; i < SIDE * SIDE; i++) {
        greys[i] = (float)uniformAt(5, (uint64_t)i);
        turned[i % SIDE * SIDE + i / SIDE] = greys[i];
    }
    vplTexture* across = makeTexture(context, greys, SIDE, SIDE, VPL_WRAP_REPEAT);
    vplTexture* down = makeTexture(context, turned, SIDE, SIDE, VPL_WRAP_REPEAT);
    for (uint64_t i = 0; i < AT; i++) {
        const double u = uniformAt(6, 2 * i), v = uniformAt(6, 2 * i + 1);
        const float longer = (float)(0.02 + 0.2 * uniformAt(7, i)), shorter = 0.02f;
        // Rows of a texture begin at the top, where v is 1.
        const vplTextureArea a = {.u = u, .v = v, .longU = longer, .shortV = shorter},
                             b = {.u = 1 - v, .v = 1 - u, .longV = longer, .shortU = shorter};
        float first[4], second[4];
        vplTexture_Lookup(across, &a, first);
        vplTexture_Lookup(down, &b, second);
        assertNear((double)first[0], (double)second[0], 1e-4, "transposed", (int)i);
    }
    vplTexture_Release(across);
    vplTexture_Release(down);
}

TEST(EveryLevelOfThePyramidHasTheMeanOfThePicture, 2)
{
    static const int sizes[][2] = {{1, 1}, {2, 2}, {3, 5}, {7, 1}, {64, 64}, {100, 37}, {13, 129}};
    for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
        const int count = sizes[k][0] * sizes[k][1];
        float* greys = malloc((size_t)count * sizeof *greys);
        double mean = 0;
        for (int i = 0; i < count; i++) {
            greys[i] = (float)uniformAt(k, (uint64_t)i);
            mean += (double)greys[i] / count;
        }
        vplTexture* t = makeTexture(context, greys, sizes[k][0], sizes[k][1], VPL_WRAP_REPEAT);
        const vplTextureLevel* last = &t->levels[t->levelCount - 1];
        assert_true(last->width == 1 && last->height == 1);
        // Each level rounds to 1 / 65535.
        assertNear(last->texels[0] / 65535.0, mean, 0.5 * t->levelCount / 65535, "mean", (int)k);
        assertNear(lookUp(t, 0.3, 0.4, 1e30f), mean, t->levelCount / 65535.0, "infinite footprint", (int)k);
        vplTexture_Release(t);
        free(greys);
    }
}

// Stops at the call that `left` counts down to.
static bool stopAtCall(void* user, double fraction)
{
    int* left = user;
    return fraction >= 0 && --*left != 0;
}

// Decoding and each level of the pyramid ask while they run: a picture of 2^28 texels takes seconds.
TEST(LargeTexturesCanBeCancelled, 1)
{
    enum { SIZE = 512 };
    vplScene* scene = emptyScene(context);
    vplTextureDef def = vplDefaultTextureDef();
    unsigned char* codes = calloc(SIZE, 3 * SIZE);
    def.texels = codes;
    def.width = def.height = SIZE;
    const size_t bytes = vplContext_GetBytes(context);
    const int stops[] = {1, SIZE, SIZE + 1, 2 * SIZE - 1}; // the last row, of one texel, is call 2 SIZE - 1
    for (int i = 0; i < 4; i++) {
        int left = stops[i];
        vplContext_SetProgress(context, stopAtCall, &left);
        assert_int_equal(vplScene_AddTexture(scene, &def, NULL), VPL_CANCELLED);
        assert_true(left == 0 && vplScene_GetTextureCount(scene) == 0);
        assert_true(vplContext_GetBytes(context) == bytes);
    }
    vplContext_SetProgress(context, NULL, NULL);
    assert_int_equal(vplScene_AddTexture(scene, &def, NULL), VPL_SUCCESS);
    vplScene_Destroy(scene);
    free(codes);
}

TEST(TexelsLieWhereObjFilesPutThem, 1)
{
    static const float greys[4] = {0.1f, 0.2f, 0.3f, 0.4f}; // top row first
    vplTexture* t = makeTexture(context, greys, 2, 2, VPL_WRAP_REPEAT);
    const double tolerance = 1e-5;
    assertNear(lookUp(t, 0.25, 0.75, 0), 0.1, tolerance, "top left", 0);
    assertNear(lookUp(t, 0.75, 0.75, 0), 0.2, tolerance, "top right", 0);
    assertNear(lookUp(t, 0.25, 0.25, 0), 0.3, tolerance, "bottom left", 0);
    assertNear(lookUp(t, 0.75, 0.25, 0), 0.4, tolerance, "bottom right", 0);
    assertNear(lookUp(t, 0.5, 0.5, 0), 0.25, tolerance, "middle", 0);
    assertNear(lookUp(t, -3.75, 12.75, 0), 0.1, tolerance, "repeated", 0);
    assertNear(lookUp(t, 0, 0.75, 0), 0.15, tolerance, "across the edge", 0);
    vplTexture_Release(t);
    t = makeTexture(context, greys, 2, 2, VPL_WRAP_CLAMP);
    assertNear(lookUp(t, -5, 0.75, 0), 0.1, tolerance, "clamped", 0);
    assertNear(lookUp(t, 1e15, -1e15, 0), 0.4, tolerance, "clamped", 1);
    vplTexture_Release(t);
    t = makeTexture(context, greys, 2, 2, VPL_WRAP_MIRROR);
    assertNear(lookUp(t, 1.25, 0.75, 0), 0.2, tolerance, "mirrored", 0);
    assertNear(lookUp(t, 1.75, 0.75, 0), 0.1, tolerance, "mirrored", 1);
    assertNear(lookUp(t, -0.25, 1.75, 0), 0.3, tolerance, "mirrored", 2);
    vplTexture_Release(t);
}

// ---- surfaces

// A quad of 1 m that faces +z, or a box, with a texture of four greys, top row first.
static vplGeometry* paintedObject(vplContext* context, vplObjectType type, vplMaterialDef material)
{
    static const float greys[4] = {0.1f, 0.2f, 0.3f, 0.4f};
    vplScene* scene = emptyScene(context);
    vplGeometry* g;
    vplTextureDef texture = vplDefaultTextureDef();
    vplObjectDef object = vplDefaultObjectDef();
    texture.linear = greys;
    texture.width = texture.height = 2;
    texture.channels = 1;
    object.type = type;
    material.diffuse = (vplRgb){1, 0.5f, 0.25f};
    assert_int_equal(vplScene_AddTexture(scene, &texture, &material.texture), VPL_SUCCESS);
    assert_int_equal(vplScene_AddMaterial(scene, &material, NULL), VPL_SUCCESS);
    assert_int_equal(vplScene_AddObject(scene, &object, NULL), VPL_SUCCESS);
    assert_int_equal(vplGeometry_Create(scene, &g), VPL_SUCCESS);
    vplScene_Destroy(scene); // the geometry keeps the texture
    return g;
}

// The reflectance where a ray hits.
static vplRgb seen(const vplGeometry* g, vplVec3 origin, vplVec3 direction)
{
    const vplFootprint point = {.width = 0};
    const vplRay ray = {origin, direction, {0, 0}};
    vplHit hit;
    assert_true(vplGeometry_ClosestHit(g, &ray, &hit));
    return vplGeometry_Reflectance(g, hit.triangle, hit.position, &point);
}

TEST(QuadsShowPicturesUpright, 1)
{
    vplGeometry* g = paintedObject(context, VPL_OBJECT_QUAD, vplDefaultMaterialDef());
    const vplVec3 towards = {0, 0, -1};
    assertNear((double)seen(g, (vplVec3){-0.25f, 0.25f, 1}, towards).r, 0.1, 1e-5, "top left", 0);
    assertNear((double)seen(g, (vplVec3){0.25f, 0.25f, 1}, towards).r, 0.2, 1e-5, "top right", 0);
    assertNear((double)seen(g, (vplVec3){0.25f, -0.25f, 1}, towards).b, 0.1, 1e-5, "times diffuse", 0);
    assertNear((double)g->objects[0].reflectance.r, 0.25, 1e-4, "mean", 0);
    assertNear(g->meanReflectance, 0.25 * 1.75 / 3, 1e-4, "mean of the geometry", 0);
    vplGeometry_Destroy(g);
    vplMaterialDef turned = vplDefaultMaterialDef();
    turned.textureRotation = VPL_PI / 2; // u' = -v, v' = u
    g = paintedObject(context, VPL_OBJECT_QUAD, turned);
    assertNear((double)seen(g, (vplVec3){-0.25f, 0.25f, 1}, towards).r, 0.3, 1e-5, "turned", 0);
    assertNear((double)seen(g, (vplVec3){0.25f, 0.25f, 1}, towards).r, 0.1, 1e-5, "turned", 1);
    vplGeometry_Destroy(g);
    vplMaterialDef moved = vplDefaultMaterialDef();
    moved.textureScale[0] = 2;
    moved.textureOffset[1] = 0.5f;
    g = paintedObject(context, VPL_OBJECT_QUAD, moved);
    assertNear((double)seen(g, (vplVec3){-0.375f, 0.25f, 1}, towards).r, 0.3, 1e-5, "moved", 0);
    assertNear((double)seen(g, (vplVec3){-0.125f, -0.25f, 1}, towards).r, 0.2, 1e-5, "scaled", 0);
    vplGeometry_Destroy(g);
}

TEST(EachFaceOfABoxShowsItsPictureUpright, 1)
{
    vplGeometry* g = paintedObject(context, VPL_OBJECT_BOX, vplDefaultMaterialDef());
    // From outside: the axes to the right and up.
    static const vplVec3 normal[6] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    static const vplVec3 right[6] = {{0, 0, -1}, {0, 0, 1}, {1, 0, 0}, {1, 0, 0}, {1, 0, 0}, {-1, 0, 0}};
    static const vplVec3 up[6] = {{0, 1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}, {0, 1, 0}, {0, 1, 0}};
    for (int face = 0; face < 6; face++) {
        for (int corner = 0; corner < 4; corner++) {
            const float x = corner % 2 ? 0.25f : -0.25f, y = corner < 2 ? 0.25f : -0.25f;
            const vplVec3 at =
                vplAdd(vplScale(2, normal[face]), vplAdd(vplScale(x, right[face]), vplScale(y, up[face])));
            assertNear((double)seen(g, at, vplNegate(normal[face])).r, 0.1 * (corner + 1), 1e-5, "face",
                       4 * face + corner);
        }
    }
    vplGeometry_Destroy(g);
}

TEST(ColoursOfVerticesMultiplyTheReflectance, 1)
{
    vplScene* scene = sceneOf(context, 0.5f);
    vplGeometry* g;
    const vplVec3 positions[3] = {{0, 0, 0}, {3, 0, 0}, {0, 3, 0}};
    const uint32_t indices[3] = {0, 1, 2};
    const vplRgb colours[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    vplMeshDef mesh = vplDefaultMeshDef();
    vplObjectDef object = vplDefaultObjectDef();
    mesh.positions = positions;
    mesh.indices = indices;
    mesh.vertexCount = 3;
    mesh.triangleCount = 1;
    mesh.colors = colours;
    object.type = VPL_OBJECT_MESH;
    assert_int_equal(vplScene_AddMesh(scene, &mesh, &object.mesh), VPL_SUCCESS);
    assert_int_equal(vplScene_AddObject(scene, &object, NULL), VPL_SUCCESS);
    assert_int_equal(vplGeometry_Create(scene, &g), VPL_SUCCESS);
    const vplRgb c = seen(g, (vplVec3){0.75f, 1.5f, 1}, (vplVec3){0, 0, -1});
    assertNear((double)c.r, 0.125, 1e-6, "red", 0);
    assertNear((double)c.g, 0.125, 1e-6, "green", 0);
    assertNear((double)c.b, 0.25, 1e-6, "blue", 0);
    assertNear((double)g->objects[0].reflectance.g, 0.5 / 3, 1e-6, "mean", 0);
    vplGeometry_Destroy(g);
    vplScene_Destroy(scene);
}

TEST(GeometriesWithoutTexturesHaveNoPaint, 1)
{
    vplScene* scene = loadScene(context, "room.json");
    vplGeometry* g;
    const vplTextureDef unused = smallTexture();
    assert_int_equal(vplScene_AddTexture(scene, &unused, NULL), VPL_SUCCESS);
    assert_int_equal(vplGeometry_Create(scene, &g), VPL_SUCCESS);
    assert_null(g->paint);
    vplGeometry_Destroy(g);
    vplScene_Destroy(scene);
}

// ---- filtering

enum { VIEW_WIDTH = 64, VIEW_HEIGHT = 48, CELLS = 400 };

// A chessboard of 1 m fields on the ground, 400 m wide, seen from 1.7 m above it.
static vplGeometry* chessboard(vplContext* context)
{
    vplScene* scene = emptyScene(context);
    vplGeometry* g;
    vplMaterialDef material = vplDefaultMaterialDef();
    vplTextureDef texture = smallTexture();
    unsigned char codes[32 * 32];
    for (int i = 0; i < 32 * 32; i++) {
        codes[i] = (i / 16 + i / 512) % 2 ? 0 : 255;
    }
    texture.texels = codes;
    texture.width = texture.height = 32;
    texture.channels = 1;
    vplObjectDef object = vplDefaultObjectDef();
    const double turn[3] = {-VPL_PI / 2, 0, 0};
    material.diffuse = (vplRgb){1, 1, 1};
    material.textureScale[0] = material.textureScale[1] = CELLS / 2;
    object.transform = vplMat4_FromParts((vplVec3){0, 0, 0}, turn, (vplVec3){CELLS, CELLS, 1});
    assert_int_equal(vplScene_AddTexture(scene, &texture, &material.texture), VPL_SUCCESS);
    assert_int_equal(vplScene_AddMaterial(scene, &material, NULL), VPL_SUCCESS);
    assert_int_equal(vplScene_AddObject(scene, &object, NULL), VPL_SUCCESS);
    assert_int_equal(vplGeometry_Create(scene, &g), VPL_SUCCESS);
    vplScene_Destroy(scene);
    return g;
}

// The point of the ground that is seen through (x, y) of the picture; false above the horizon.
static bool pointSeen(double x, double y, double out[2])
{
    const double up = 0.5 * (1 - 2 * y / VIEW_HEIGHT) - 0.15, right = 0.5 * (2 * x / VIEW_WIDTH - 1) * 4 / 3;
    const double far = up < 0 ? 1.7 / -up : INFINITY;
    out[0] = right * far;
    out[1] = -far;
    return far < CELLS / 2.0 - 1 && fabs(out[0]) < CELLS / 2.0 - 1;
}

// The mean of 1024 points of a pixel; negative if not all of them show the ground.
static double truthOf(int x, int y)
{
    double sum = 0, at[2];
    for (int i = 0; i < 1024; i++) {
        if (!pointSeen(x + (i % 32 + 0.5) / 32, y + (i / 32 + 0.5) / 32, at)) {
            return -1;
        }
        const double u = at[0] / 2 + CELLS, v = -at[1] / 2 + CELLS; // of the texture
        sum += ((u - floor(u) >= 0.5) + (v - floor(v) < 0.5)) % 2 == 0;
    }
    return sum / 1024;
}

TEST(AChessboardToTheHorizonIsFilteredLike1024Samples, 1)
{
    vplGeometry* g = chessboard(context);
    double error = 0, bias = 0, unfiltered = 0;
    int count = 0;
    for (int i = 0; i < VIEW_WIDTH * VIEW_HEIGHT; i++) {
        const int x = i % VIEW_WIDTH, y = i / VIEW_WIDTH;
        const double truth = truthOf(x, y);
        double at[2];
        if (truth < 0 || !pointSeen(x + 0.5, y + 0.5, at)) {
            continue;
        }
        const vplVec3 way = vplVec((float)at[0], -1.7f, (float)at[1]);
        const vplRay ray = {vplVec(0, 1.7f, 0), way, {0, 0}};
        const vplFootprint f = {vplNormalize(way), (float)(-at[1] / VIEW_HEIGHT)}, point = {.width = 0};
        vplHit hit;
        assert_true(vplGeometry_ClosestHit(g, &ray, &hit));
        const double grey = (double)vplGeometry_Reflectance(g, hit.triangle, hit.position, &f).r;
        const double sharp = (double)vplGeometry_Reflectance(g, hit.triangle, hit.position, &point).r;
        error += (grey - truth) * (grey - truth);
        unfiltered += (sharp - truth) * (sharp - truth);
        bias += grey - truth;
        count++;
    }
    assert_true(count > 1000);
    error = sqrt(error / count);
    unfiltered = sqrt(unfiltered / count);
    // 0.035; one lookup instead of up to four along the longer side: 0.104; eight: 0.030.
    if (!(error < 0.04 && unfiltered > 0.2 && fabs(bias / count) < 0.01)) {
        fail_msg("%d pixels: rmse %g, without filter %g, mean difference %g", count, error, unfiltered,
                 bias / count);
    }
    vplGeometry_Destroy(g);
}

// ---- files

TEST_ALONE(VerticesAreSplitWherePicturesNeedIt)
{
    // Two triangles share an edge; their texture coordinates differ there.
    static const char faces[] = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0.5 0.5 0\nvt 9 9\n"
                                "usemtl a\nf 1/1 2/2 3/3\nf 1/4 3/4 4/4\n";
    Desk d;
    openDesk(&d);
    char text[400];
    snprintf(text, sizeof text, "mtllib a.mtl\n%s", faces);
    writeText(d.mtl, "newmtl a\nKd 1 1 1\nmap_Kd -s 2 3 1 -o 0.5 -clamp on b c.png\n");
    const vplMeshDef* mesh = readText(&d, text);
    const vplMaterialDef* material = vplScene_GetMaterial(d.scene, 0);
    assert_int_equal(mesh->vertexCount, 6);
    assert_non_null(mesh->texcoords);
    assert_null(mesh->normals);
    assertNear((double)mesh->texcoords[4], 0.5, 0, "u", 2);
    assertNear((double)mesh->texcoords[11], 9, 0, "v", 5);
    assert_true(material->textureScale[0] == 2 && material->textureScale[1] == 3);
    assert_true(material->textureOffset[0] == 0.5f && material->textureOffset[1] == 0);
    assert_int_equal(vplScene_GetTexture(d.scene, material->texture)->wrapU, VPL_WRAP_CLAMP);
    assert_int_equal(countOf(d.said, "b c.png: there is no such file; it is taken as grey"), 1);
    assert_int_equal(countOf(d.said, "warning: "), 1);
    closeDesk(&d);
    openDesk(&d);
    writeText(d.mtl, "newmtl a\nKd 1 1 1\n");
    mesh = readText(&d, text);
    assert_int_equal(mesh->vertexCount, 4); // without a picture the file is read as before
    assert_null(mesh->texcoords);
    closeDesk(&d);
}

TEST_ALONE(TextureCoordinatesThatAreNotThereAreZero)
{
    Desk d;
    openDesk(&d);
    writeText(d.mtl, "newmtl a\nmap_Kd x.png\nd 0.25\nmap_d y.png\n");
    const vplMeshDef* mesh = readText(&d, "mtllib a.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 1 1 0\nvt nan 1\n"
                                          "f 1/1 2/7 3/-4\nf 1/1 2 3/-1\n");
    assert_int_equal(
        countOf(d.said, "a.obj:6:4: there is no such texture coordinate: 0 is taken (3 such places)"), 1);
    assert_true(mesh->texcoords[0] == 0 && mesh->texcoords[1] == 1);
    assert_true(mesh->texcoords[2] == 0 && mesh->texcoords[3] == 0);
    const vplMaterialDef* material = vplScene_GetMaterial(d.scene, 0);
    assert_true(material->opacity == 0.25f && material->alphaTexture == 1 && !material->alphaFromTexture);
    assert_int_equal(countOf(d.said, "y.png: there is no such file; it is taken as white"), 1);
    closeDesk(&d);
}

static vplScene* sceneWithPicture(vplContext* context, const char* folder, const char* name)
{
    char path[160], text[1000];
    snprintf(path, sizeof path, "%s/scene.json", folder);
    snprintf(text, sizeof text,
             "{\"camera\": {\"eye\": [0, 0, 2], \"target\": [0, 0, 0]}, \"materials\": {\"a\": {\"diffuse\": "
             "[1, 1, 1], \"texture\": \"%s\"}, \"b\": {\"texture\": {\"file\": \"%s\", \"scale\": [2, 2]}}}, "
             "\"objects\": [{\"type\": \"quad\", \"material\": \"a\"}]}",
             name, name);
    writeText(path, text);
    vplScene* scene = openScene(context, path);
    unlink(path);
    return scene;
}

TEST(PicturesThatCannotBeReadAreGreyWithOneWarning, 1)
{
    char folder[] = "/tmp/vpl-textures-XXXXXX", path[160];
    assert_non_null(mkdtemp(folder));
    static const struct {
        const char *name, *bytes;
        size_t size;
        const char* reason;
    } cases[] = {
        {"missing.png", NULL, 0, "there is no such file"},
        {"empty.png", "", 0, "cannot read the picture"},
        {"text.jpg", "this is no picture", 18, "cannot read the picture"},
        {"cut.png", "\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\1\0\0\0\1\0\10\2\0\0\0", 29,
         "cannot read the picture"},
        {"huge.png", "\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\1\0\0\0\1\0\0\10\2\0\0\0\0\0\0\0", 33, "too large"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        snprintf(path, sizeof path, "%s/%s", folder, cases[i].name);
        if (cases[i].bytes != NULL) {
            FILE* file = fopen(path, "wb");
            assert_non_null(file);
            fwrite(cases[i].bytes, 1, cases[i].size, file);
            fclose(file);
        }
        takeMessage();
        vplScene* scene = sceneWithPicture(context, folder, cases[i].name);
        const char* message = takeMessage();
        if (strstr(message, cases[i].reason) == NULL || strstr(message, "scene.json:1:") == NULL ||
            strstr(message, "taken as grey") == NULL) {
            fail_msg("%s: \"%s\"", cases[i].name, message);
        }
        assert_int_equal(vplScene_GetTextureCount(scene), 1); // both materials share it
        vplGeometry* g;
        assert_int_equal(vplGeometry_Create(scene, &g), VPL_SUCCESS);
        assertNear((double)seen(g, (vplVec3){0, 0, 1}, (vplVec3){0, 0, -1}).g, 0.5, 1e-4, "grey", (int)i);
        vplGeometry_Destroy(g);
        vplScene_Destroy(scene);
        unlink(path);
    }
    rmdir(folder);
}

// Reflectances are the floats of the picture, clamped to 1; NaN becomes 0.
TEST(PicturesOfFloatsAreReflectances, 1)
{
    static const char* const NAMES[] = {"a.pfm", "a.hdr", "a.exr", "nan.pfm", "cut.pfm"};
    static const float NOT_A_NUMBER[3] = {0.25f, NAN, 3};
    static const double WANTED[][3] = {
        {0.25, 0.5, 1}, {0.25, 0.5, 1}, {0.25, 0.5, 1}, {0.25, 0, 1}, {0.5, 0.5, 0.5}};
    char folder[] = "/tmp/vpl-textures-XXXXXX", path[160];
    vplImage* image;
    assert_non_null(mkdtemp(folder));
    assert_int_equal(vplImage_Create(context, 1, 1, &image), VPL_SUCCESS);
    memcpy(image->pixels, (const float[3]){0.25f, 0.5f, 3}, 3 * sizeof(float));
    for (int i = 0; i < 5; i++) {
        snprintf(path, sizeof path, "%s/%s", folder, NAMES[i]);
        if (i < 3) {
            if (vplImage_Write(image, path, NULL) == VPL_INVALID_ARGUMENT && i == 2) {
                continue; // EXR was not built in
            }
        } else {
            FILE* file = fopen(path, "wb");
            assert_non_null(file);
            fputs("PF\n1 1\n-1.0\n", file);
            fwrite(NOT_A_NUMBER, 4, i == 3 ? 3 : 2, file);
            fclose(file);
        }
        takeMessage();
        vplGeometry* g;
        vplScene* scene = sceneWithPicture(context, folder, NAMES[i]);
        assert_true((strstr(takeMessage(), "see above; it is taken as grey") != NULL) == (i == 4));
        assert_int_equal(vplGeometry_Create(scene, &g), VPL_SUCCESS);
        const vplRgb rgb = seen(g, (vplVec3){0, 0, 1}, (vplVec3){0, 0, -1});
        assertNear((double)rgb.r, WANTED[i][0], 2e-3, "red", i);
        assertNear((double)rgb.g, WANTED[i][1], 2e-3, "green", i);
        assertNear((double)rgb.b, WANTED[i][2], 2e-3, "blue", i);
        vplGeometry_Destroy(g);
        vplScene_Destroy(scene);
        unlink(path);
    }
    vplImage_Destroy(image);
    rmdir(folder);
}

static vplResult loadAndBuild(Attempt* a)
{
    TRY(vplScene_Load(a->context, "examples/scenes/textured-room.json", &a->scene));
    return vplGeometry_Create(a->scene, &a->geometry);
}

TEST_ALONE(TexturesSurviveEveryFailedAllocation)
{
    failSomeAllocations("textured room", loadAndBuild, 1);
}

// ---- methods

static vplImage* texturedRoom(vplContext* context, const char* words)
{
    vplScene* scene = openScene(context, "examples/scenes/textured-room.json");
    vplRenderOptions o = vplDefaultRenderOptions();
    assert_int_equal(vplRenderOptions_SetAll(&o, words), VPL_SUCCESS);
    vplImage* image = renderScene(scene, &o, NULL);
    vplScene_Destroy(scene);
    return image;
}

static uint64_t hashOfRoom(vplContext* context, const char* words)
{
    vplImage* image = texturedRoom(context, words);
    const uint64_t hash = vplImage_Hash(image);
    vplImage_Destroy(image);
    closeTestContext(context);
    return hash;
}

static uint64_t hashOfKeller(vplContext* context)
{
    return hashOfRoom(context, "--method keller --particles 64 --size 48x32 --antialias 8");
}

static uint64_t hashOfPaths(vplContext* context)
{
    return hashOfRoom(context, "--method path --spp 4 --size 48x32");
}

static uint64_t hashOfRadiosity(vplContext* context)
{
    return hashOfRoom(context, "--method radiosity --patches 200 --size 48x32");
}

TEST_ALONE(TexturedPicturesAreTheSameEverywhere)
{
    assertSameEverywhere(hashOfKeller);
    assertSameEverywhere(hashOfPaths);
    assertSameEverywhere(hashOfRadiosity);
}

// Multipass, deferred and interleaved shading find the reflectance from other data.
TEST(PipelinesShowTheSameTextures, 2)
{
    static const char common[] = "--method keller --particles 64 --size 48x32 --antialias 1 --pipeline ";
    static const char* const pipelines[] = {"deferred", "multipass", "batched"};
    uint64_t hashes[3];
    for (int i = 0; i < 3; i++) {
        char words[200];
        snprintf(words, sizeof words, "%s%s", common, pipelines[i]);
        vplImage* image = texturedRoom(context, words);
        hashes[i] = vplImage_Hash(image);
        vplImage_Destroy(image);
    }
    assert_true(hashes[0] == hashes[1] && hashes[0] == hashes[2]);
}

static double meanOf(const vplImage* image)
{
    double sum = 0;
    for (int i = 0; i < 3 * image->width * image->height; i++) {
        sum += (double)image->pixels[i];
    }
    return sum / (3 * image->width * image->height);
}

TEST(MethodsAgreeInATexturedRoom, 2, SLOW)
{
    static const struct {
        const char* words;
        double tolerance;
    } methods[] = {
        // In the same room without textures the ratios are 0.989, 0.993 and 0.988.
        {"--method keller --show indirect --size 64x48 --antialias 8 --particles 4096", 0.02},
        {"--method radiosity --show indirect --size 64x48 --antialias 8", 0.01},
        {"--method ssvp --show indirect --size 64x48 --antialias 8", 0.03},
    };
    vplImage* truth = texturedRoom(context, "--method path --show indirect --size 64x48 --spp 256");
    for (size_t i = 0; i < sizeof methods / sizeof *methods; i++) {
        vplImage* image = texturedRoom(context, methods[i].words);
        assertNear(meanOf(image) / meanOf(truth), 1, methods[i].tolerance, methods[i].words, (int)i);
        vplImage_Destroy(image);
    }
    vplImage_Destroy(truth);
}
