// SPDX-License-Identifier: MIT
// Tests of textures: what is refused, what the pyramid averages, and what surfaces show.
#include "scene/texture.h"

#include "test.h"

static vplScene* emptyScene(vplContext* context)
{
    vplScene* scene;
    assert_int_equal(vplScene_Create(context, &scene), VPL_SUCCESS);
    return scene;
}

static void assertRefused(vplResult result, const char* text)
{
    const char* message = takeMessage();
    if (result != VPL_INVALID_ARGUMENT || strstr(message, text) == NULL) {
        fail_msg("%s, \"%s\" instead of a refusal with \"%s\"", vplResult_GetName(result), message, text);
    }
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
    assertRefused(vplScene_AddTexture(scene, &none, NULL), "vplTextureDef.texels or linear must be given");
    assertRefused(vplScene_AddTexture(scene, &both, NULL), "vplTextureDef.texels or linear must be given");
    assertRefused(vplScene_AddTexture(scene, &empty, NULL), "vplTextureDef.width and height are 0 and 2");
    assertRefused(vplScene_AddTexture(scene, &large, NULL), "are 2 and 16385, must be in [1, 16384]");
    assertRefused(vplScene_AddTexture(scene, &channels, NULL), "vplTextureDef.channels is 5");
    assertRefused(vplScene_AddTexture(scene, &wrap, NULL), "vplTextureDef.wrapV is 3");
    assertRefused(vplScene_AddTexture(scene, &bright, NULL), "vplTextureDef.linear[2] is 1.25");
    assertRefused(vplScene_AddTexture(scene, &unset, NULL), "vplTextureDef was not made by its default");
    assert_int_equal(vplScene_GetTextureCount(scene), 0);
    vplScene_Destroy(scene);
}

TEST(MaterialsRefuseTexturesThatAreNotThere, 1)
{
    vplScene* scene = emptyScene(context);
    vplMaterialDef material = vplDefaultMaterialDef();
    material.texture = 0;
    assertRefused(vplScene_AddMaterial(scene, &material, NULL), "vplMaterialDef.texture is 0");
    material.texture = -1;
    material.alphaTexture = 1;
    assertRefused(vplScene_AddMaterial(scene, &material, NULL), "vplMaterialDef.alphaTexture is 1");
    material.alphaTexture = -2;
    assertRefused(vplScene_AddMaterial(scene, &material, NULL), "vplMaterialDef.alphaTexture is -2");
    material.alphaTexture = -1;
    material.alphaFromTexture = true;
    assertRefused(vplScene_AddMaterial(scene, &material, NULL), "vplMaterialDef.alphaFromTexture is true");
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
    assertRefused(vplScene_AddMesh(scene, &def, NULL), "vplMeshDef.texcoords[2] is nan");
    def.texcoords = NULL;
    def.colors = colours;
    assertRefused(vplScene_AddMesh(scene, &def, NULL), "vplMeshDef.colors[1] is 1.5");
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
