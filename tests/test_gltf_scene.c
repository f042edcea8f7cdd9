// SPDX-License-Identifier: MIT
// Tests of what glTF files say besides geometry: materials, textures, cameras, lights and their motion.
#include "gltf_support.h"

#include "math/vec.h"

#include <unistd.h>

// ---- materials

// Loads a triangle with a material and further members of the file.
static vplScene* loadMaterial(Desk* d, const Blob* more, const char* material, const char* members)
{
    Blob blob = {.size = 0};
    addFloats(&blob, POINTS, 9);
    if (more != NULL) {
        addBytes(&blob, more->bytes, more->size);
    }
    writeGltf(deskPath(d, "a.glb"), &blob,
              "\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,"
              "\"TEXCOORD_0\":1},"
              "\"material\":0}]}],\"materials\":[%s]," TRIANGLE VIEWS
              ",{\"buffer\":0,\"byteOffset\":36,\"byteLength\":%zu}]%s",
              material, blob.size - 36, members);
    return loadGltf(d, "a.glb");
}

TEST_ALONE(MaterialsBecomeReflectanceRadianceAndOpacity)
{
    static const struct {
        const char* json;
        double diffuse, emission, opacity, cutoff;
    } cases[] = {
        {"{}", 0.5, 0, 1, 0},
        {"{\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.8,0.8,0.8,0.5],\"metallicFactor\":0}}", 0.8, 0, 1,
         0},
        {"{\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.8,0.8,0.8,1],\"metallicFactor\":0.25}}", 0.7, 0,
         1, 0},
        {"{\"emissiveFactor\":[0.5,0.5,0.5],\"extensions\":{\"KHR_materials_emissive_strength\":{"
         "\"emissiveStrength\":20}}}",
         0.5, 10, 1, 0},
        {"{\"emissiveFactor\":[1,1,1]}", 0.5, 1, 1, 0},
        {"{\"alphaMode\":\"BLEND\",\"pbrMetallicRoughness\":{\"baseColorFactor\":[1,1,1,0.25],"
         "\"metallicFactor\":0}}",
         1, 0, 0.25, 0},
        {"{\"alphaMode\":\"MASK\",\"alphaCutoff\":0.75,\"pbrMetallicRoughness\":{\"metallicFactor\":0}}", 1,
         0, 1, 0.75},
        {"{\"alphaMode\":\"MASK\",\"pbrMetallicRoughness\":{\"metallicFactor\":0}}", 1, 0, 1, 0.5},
        {"{\"alphaMode\":\"MASK\",\"alphaCutoff\":2,\"pbrMetallicRoughness\":{\"metallicFactor\":0}}", 1, 0,
         0, 0},
        {"{\"alphaMode\":\"MASK\",\"alphaCutoff\":0,\"pbrMetallicRoughness\":{\"baseColorFactor\":[1,1,1,0],"
         "\"metallicFactor\":0}}",
         1, 0, 1, 0},
        {"{\"extensions\":{\"KHR_materials_transmission\":{\"transmissionFactor\":0.75}},"
         "\"pbrMetallicRoughness\":{"
         "\"metallicFactor\":0}}",
         1, 0, 0.25, 0},
        {"{\"extensions\":{\"KHR_materials_pbrSpecularGlossiness\":{\"diffuseFactor\":[0.25,0.25,0.25,1]}}}",
         0.25, 0, 1, 0}};
    Desk d;
    openDesk(&d);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        vplScene* scene = loadMaterial(&d, NULL, cases[i].json, "");
        const vplMaterialDef* m = vplScene_GetMaterial(scene, 0);
        const double v = (double)(float)cases[i].diffuse;
        assertColour(m->diffuse, v, v, v);
        assertColour(m->emission, cases[i].emission, cases[i].emission, cases[i].emission);
        assertAround((double)m->opacity, cases[i].opacity, 1e-7);
        assertAround((double)m->alphaCutoff, cases[i].cutoff, 1e-7);
        assert_true(m->texture == -1 && !m->alphaFromTexture);
        assert_string_equal(m->name, "a.glb:material 0");
        vplScene_Destroy(scene);
    }
    closeDesk(&d);
}

TEST_ALONE(MaterialsOfOneNameStayApart)
{
    Desk d;
    openDesk(&d);
    Blob blob = {.size = 0};
    addFloats(&blob, POINTS, 9);
    writeGltf(deskPath(&d, "a.glb"), &blob,
              "\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},"
              "\"material\":1},{"
              "\"attributes\":{\"POSITION\":0},\"material\":0}]}],\"materials\":[{\"name\":\"m\"},{\"name\":"
              "\"m\"}]," TRIANGLE VIEWS "]");
    vplScene* scene = loadGltf(&d, "a.glb");
    assert_string_equal(vplScene_GetMaterial(scene, 0)->name, "a.glb:m"); // in the order of their first use
    assert_string_not_equal(vplScene_GetMaterial(scene, 1)->name, "a.glb:m");
    vplScene_Destroy(scene);
    closeDesk(&d);
}

// ---- a file with all of it

TEST_ALONE(EverythingIsTheSameInBothForms)
{
    Desk d;
    vplScene *text = NULL, *binary = NULL;
    openDesk(&d);
    assert_int_equal(vplScene_Load(d.context, "tests/data/gltf/everything.gltf", &text), VPL_SUCCESS);
    assert_int_equal(vplScene_Load(d.context, "tests/data/gltf/everything.glb", &binary), VPL_SUCCESS);
    if (d.said[0] != 0) {
        fail_msg("%s", d.said);
    }
    assert_true(vplScene_GetHash(text) == vplScene_GetHash(binary));
    assert_int_equal(vplScene_GetMeshCount(text), 4);
    assert_int_equal(vplScene_GetObjectCount(text), 6);
    assert_int_equal(vplScene_GetTextureCount(text), 2);
    assert_int_equal(vplScene_GetEmitterCount(text), 1);
    int keys;
    vplScene_GetCameraPath(text, 0, &keys);
    assert_int_equal(keys, 49);
    vplScene_Destroy(text);
    vplScene_Destroy(binary);
    closeDesk(&d);
}

// ---- textures

// A TGA picture of 2x1 texels, blue green red alpha each.
static Blob pictureOf(const unsigned char texels[8])
{
    static const unsigned char head[18] = {0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 1, 0, 32, 0x28};
    Blob blob = {.size = 0};
    addBytes(&blob, head, 18);
    memcpy(blob.bytes + 18, texels, 8);
    blob.size = 26;
    return blob;
}

static const char TEXTURE[] =
    ",\"textures\":[{\"source\":0,\"sampler\":0}],\"samplers\":[{\"wrapS\":33071,\"wrapT\":33648}],"
    "\"images\":[{\"bufferView\":1,\"mimeType\":\"image/png\"}]";

TEST_ALONE(TexturesComeFromBufferViews)
{
    const Blob picture = pictureOf((unsigned char[8]){0, 0, 255, 255, 255, 255, 255, 0});
    Desk d;
    openDesk(&d);
    vplScene* scene = loadMaterial(&d, &picture,
                                   "{\"alphaMode\":\"MASK\",\"pbrMetallicRoughness\":{\"metallicFactor\":0,"
                                   "\"baseColorTexture\":{\"index\":0}}}",
                                   TEXTURE);
    const vplMaterialDef* m = vplScene_GetMaterial(scene, 0);
    assert_int_equal(vplScene_GetTextureCount(scene), 1);
    const vplTextureDef* t = vplScene_GetTexture(scene, 0);
    assert_true(m->texture == 0 && m->alphaFromTexture && m->alphaCutoff == 0.5f);
    assert_true(t->width == 2 && t->height == 1 && t->channels == 4);
    assert_true(t->wrapU == VPL_WRAP_CLAMP && t->wrapV == VPL_WRAP_MIRROR);
    const vplMeshDef* mesh = vplScene_GetMesh(scene, 0);
    const float* uv = mesh->texcoords + 2 * mesh->indices[0];
    assert_true(uv[0] == 0 && uv[1] == 1); // v grows downwards in glTF
    vplScene_Destroy(scene);
    closeDesk(&d);
}

TEST_ALONE(AMissingPictureIsGreyWithOneWarning)
{
    Desk d;
    openDesk(&d);
    vplScene* scene = loadMaterial(
        &d, NULL, "{\"pbrMetallicRoughness\":{\"metallicFactor\":0,\"baseColorTexture\":{\"index\":0}}}",
        ",\"textures\":[{\"source\":0}],\"images\":[{\"uri\":\"no%20such.png\"}]");
    assert_int_equal(vplScene_GetTexture(scene, 0)->width, 1);
    assert_int_equal(countOf(d.said, "no such.png"), 1);
    vplScene_Destroy(scene);
    closeDesk(&d);
}

// The transform of texture coordinates, which glTF defines with v downwards, moves points to the same texels.
TEST_ALONE(TextureTransformsMoveToTheSameTexels)
{
    static const double offset[2] = {0.25, -0.5}, scale[2] = {2, 0.5}, turn = 0.7;
    const Blob picture = pictureOf((unsigned char[8]){0, 0, 255, 255, 255, 255, 255, 0});
    Desk d;
    openDesk(&d);
    vplScene* scene =
        loadMaterial(&d, &picture,
                     "{\"pbrMetallicRoughness\":{\"metallicFactor\":0,\"baseColorTexture\":{\"index\":0,"
                     "\"extensions\":{\"KHR_texture_transform\":{\"offset\":[0.25,-0.5],\"scale\":[2,0.5],"
                     "\"rotation\":0.7}}}}}",
                     TEXTURE);
    const vplMaterialDef* m = vplScene_GetMaterial(scene, 0);
    for (int i = 0; i < 9; i++) {
        const double u = i % 3, v = i / 3; // as in the file
        const double su = scale[0] * u, sv = scale[1] * v;
        const double gu = cos(turn) * su + sin(turn) * sv + offset[0],
                     gv = -sin(turn) * su + cos(turn) * sv + offset[1];
        const double a = (double)m->textureScale[0] * u, b = (double)m->textureScale[1] * (1 - v);
        const double c = cos(m->textureRotation), s = sin(m->textureRotation);
        assertAround(c * a - s * b + (double)m->textureOffset[0], gu, 1e-6);
        assertAround(s * a + c * b + (double)m->textureOffset[1], 1 - gv, 1e-6);
    }
    vplScene_Destroy(scene);
    closeDesk(&d);
}

// Metalness is the mean of a map's blue, emission the mean of linear light.
TEST_ALONE(MapsOfMetalnessAndEmissionAreAveraged)
{
    const Blob picture = pictureOf((unsigned char[8]){51, 0, 255, 255, 153, 0, 0, 255});
    Desk d;
    openDesk(&d);
    vplScene* scene = loadMaterial(
        &d, &picture,
        "{\"emissiveFactor\":[4,4,4],\"emissiveTexture\":{\"index\":0},\"pbrMetallicRoughness\":{"
        "\"metallicRoughnessTexture\":{\"index\":0}}}",
        TEXTURE);
    const vplMaterialDef* m = vplScene_GetMaterial(scene, 0);
    assertAround((double)m->diffuse.r, 0.8, 1e-6); // metalness (0.2 + 0.6) / 2
    assertAround((double)m->emission.r, 2, 1e-6);
    assertAround((double)m->emission.g, 0, 1e-6);
    assert_int_equal(vplScene_GetTextureCount(scene), 0);
    vplScene_Destroy(scene);
    closeDesk(&d);
}

// A map that cannot be read changes nothing, as one of white texels would.
TEST_ALONE(FactorsStayWhereTheirMapCannotBeRead)
{
    static const char MATERIAL[] =
        "{\"emissiveFactor\":[4,2,0],\"emissiveTexture\":{\"index\":0},\"pbrMetallicRoughness\":{"
        "\"metallicFactor\":0.4,\"metallicRoughnessTexture\":{\"index\":0}}}";
    static const char MISSING[] = ",\"textures\":[{\"source\":0}],\"images\":[{\"uri\":\"none.png\"}]";
    Blob noise = {.size = 0};
    addBytes(&noise, "this is no picture", 18);
    Desk d;
    openDesk(&d);
    for (int missing = 0; missing < 2; missing++) {
        vplScene* scene =
            missing ? loadMaterial(&d, NULL, MATERIAL, MISSING) : loadMaterial(&d, &noise, MATERIAL, TEXTURE);
        const vplMaterialDef* m = vplScene_GetMaterial(scene, 0);
        assertColour(m->emission, 4, 2, 0);
        assertAround((double)m->diffuse.r, 0.8, 1e-6); // of metalness 0.4
        vplScene_Destroy(scene);
    }
    closeDesk(&d);
}

// ---- cameras and lights

static vplScene* loadNodes(Desk* d, const Blob* blob, const char* nodes, const char* members)
{
    writeGltf(deskPath(d, "a.gltf"), blob, NODES_HEAD "\"nodes\":[{\"mesh\":0},%s],%s", nodes, members);
    return loadGltf(d, "a.gltf");
}

static const char CAMERA[] =
    "\"cameras\":[{\"type\":\"perspective\",\"perspective\":{\"yfov\":0.5,\"znear\":0.25}},{\"type\":"
    "\"perspective\",\"perspective\":{\"yfov\":1,\"znear\":0.5,\"zfar\":77,\"aspectRatio\":3}}]," TRIANGLE
        VIEWS "]";

TEST_ALONE(CamerasLookAlongTheirNode)
{
    Blob blob = {.size = 0};
    addFloats(&blob, POINTS, 9);
    Desk d;
    openDesk(&d);
    vplScene* scene = loadNodes(
        &d, &blob,
        "{\"camera\":0,\"translation\":[0,0,8]},{\"camera\":1,\"translation\":[4,0,0],\"rotation\":[0,"
        "0.70710678,0,0.70710678],\"scale\":[3,3,3]}",
        CAMERA);
    assert_int_equal(vplScene_GetCameraCount(scene), 2);
    const vplCameraDef *a = vplScene_GetCamera(scene, 0), *b = vplScene_GetCamera(scene, 1);
    assertPoint(a->eye, 0, 0, 8);
    assertPoint(a->target, 0, 0, 0);
    assertPoint(a->up, 0, 1, 0);
    assert_true(a->fovY == 0.5 && a->nearPlane == 0.25);
    assert_true(a->farPlane > 8.1 && a->farPlane < 100); // behind the mesh
    assert_true(b->target.x < 0.001f && fabsf(b->target.z) < 1e-6f && b->fovY == 1 && b->nearPlane == 0.5 &&
                b->farPlane == 77);
    // Its own camera: no ground, and a light at the camera.
    assert_int_equal(vplScene_GetObjectCount(scene), 1);
    assert_int_equal(vplScene_GetEmitterCount(scene), 1);
    assertPoint(vplScene_GetEmitter(scene, 0)->position, 0, 0, 8);
    assert_int_equal(countOf(d.said, "warning"), 1);
    vplScene_Destroy(scene);
    closeDesk(&d);
}

// The light at the camera gives surfaces at the middle of the mesh, (0.5, 0.5, 0), that face it the irradiance pi.
TEST_ALONE(TheLightAtTheCameraLightsTheMesh)
{
    Blob blob = {.size = 0};
    addFloats(&blob, POINTS, 9);
    Desk d;
    openDesk(&d);
    vplScene* scene = loadNodes(&d, &blob, "{\"camera\":0,\"translation\":[3,0,8]},{\"camera\":1}", CAMERA);
    const vplEmitterDef* light = vplScene_GetEmitter(scene, 0);
    assertPoint(light->position, 3, 0, 8);
    assertAround((double)light->intensity.r / (2.5 * 2.5 + 0.5 * 0.5 + 8 * 8), VPL_PI, 1e-5);
    vplScene_Destroy(scene);
    closeDesk(&d);
}

TEST_ALONE(LightsAreConvertedToWatts)
{
    static const char lights[] = "\"extensions\":{\"KHR_lights_punctual\":{\"lights\":[{\"type\":\"point\","
                                 "\"intensity\":1366,\"color\":[1,0.5,0]},{"
                                 "\"type\":\"directional\",\"intensity\":683},{\"type\":\"spot\","
                                 "\"intensity\":683,\"spot\":{\"innerConeAngle\":0.1,"
                                 "\"outerConeAngle\":0.4}},{\"type\":\"spot\"},{\"type\":\"spot\",\"spot\":{"
                                 "\"outerConeAngle\":1.5707963}}]}}," TRIANGLE VIEWS "]";
    static const char nodes[] = "{\"translation\":[1,2,3],\"extensions\":{\"KHR_lights_punctual\":{\"light\":"
                                "0}}},{\"rotation\":[-0.70710678,0,0,"
                                "0.70710678],\"extensions\":{\"KHR_lights_punctual\":{\"light\":1}}},{"
                                "\"extensions\":{\"KHR_lights_punctual\":{\"light\":"
                                "2}}},{\"extensions\":{\"KHR_lights_punctual\":{\"light\":3}}},{"
                                "\"extensions\":{\"KHR_lights_punctual\":{\"light\":4}}}";
    Blob blob = {.size = 0};
    addFloats(&blob, POINTS, 9);
    Desk d;
    openDesk(&d);
    vplScene* scene = loadNodes(&d, &blob, nodes, lights);
    assert_int_equal(vplScene_GetEmitterCount(scene), 5);
    const vplEmitterDef *point = vplScene_GetEmitter(scene, 0), *sun = vplScene_GetEmitter(scene, 1),
                        *spot = vplScene_GetEmitter(scene, 2), *usual = vplScene_GetEmitter(scene, 3),
                        *wide = vplScene_GetEmitter(scene, 4);
    assert_int_equal(point->type, VPL_EMITTER_POINT);
    assertPoint(point->position, 1, 2, 3);
    assertColour(point->intensity, 2, 1, 0);
    assert_int_equal(sun->type, VPL_EMITTER_DIRECTIONAL);
    assertColour(sun->intensity, 1, 1, 1);
    assert_true(sun->direction.y < -0.999999f);
    assert_int_equal(spot->type, VPL_EMITTER_SPOT);
    assertPoint(spot->direction, 0, 0, -1);
    assertAround(spot->innerAngle, 0.1, 1e-9);
    assertAround(spot->outerAngle, 0.4, 1e-9);
    assertAround(usual->innerAngle, 0, 0);
    assertAround(usual->outerAngle, VPL_PI / 4, 1e-9);
    assertAround(wide->outerAngle, VPL_PI / 2, 2e-4);
    vplScene_Destroy(scene);
    closeDesk(&d);
}

// A model that glows a little gets lamps; one that shines, or has lights, does not.
TEST_ALONE(GlowingModelsAreLitShiningOnesAreNot)
{
    Desk d;
    openDesk(&d);
    for (int i = 1; i <= 2; i++) {
        char material[64];
        snprintf(material, sizeof material, "{\"emissiveFactor\":[%d,0,0]}", i);
        vplScene* scene = loadMaterial(&d, NULL, material, "");
        assert_int_equal(countOf(d.said, "nothing emits light"), i == 1 ? 2 : 0);
        assert_int_equal(vplScene_GetObjectCount(scene), i == 1 ? 4 : 2);
        vplScene_Destroy(scene);
    }
    closeDesk(&d);
}
