// SPDX-License-Identifier: MIT
// Tests of what glTF files say besides geometry: materials, textures, cameras, lights and their motion.
#include "gltf_support.h"

#include "math/vec.h"

#include <unistd.h>

#define TRIANGLE                                                                                             \
    "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"},{"               \
    "\"bufferView\":0,\"componentType\":"                                                                    \
    "5126,\"count\":3,\"type\":\"VEC2\"}"

#define VIEWS "],\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}"

static const float POINTS[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};

static void assertAround(double value, double wanted, double tolerance)
{
    if (!(fabs(value - wanted) <= tolerance)) {
        fail_msg("%.9g instead of %.9g", value, wanted);
    }
}

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

// ---- cameras and lights

#define NODES_HEAD "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],"

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

// ---- motion

#define CURVE(path, node)                                                                                    \
    "\"animations\":[{\"samplers\":[{\"input\":2,\"output\":3,\"interpolation\":\"%s\"}],\"channels\":[{"    \
    "\"sampler\":0,\"target\":{"                                                                             \
    "\"node\":" node ",\"path\":\"" path "\"}}]}],"

#define CURVE_VIEWS(count, values, type)                                                                     \
    ",{\"bufferView\":1,\"componentType\":5126,\"count\":" count                                             \
    ",\"type\":\"SCALAR\"},{\"bufferView\":2,\"componentType\":5126,"                                        \
    "\"count\":" values ",\"type\":\"" type "\"}" VIEWS                                                      \
    ",{\"buffer\":0,\"byteOffset\":%d,\"byteLength\":%d},{\"buffer\":0,"                                     \
    "\"byteOffset\":%d,\"byteLength\":%d}],"

static const char POINT_LIGHT[] =
    "\"extensions\":{\"KHR_lights_punctual\":{\"lights\":[{\"type\":\"spot\"}]}}";

static const char LIGHT_NODES[] =
    "{\"children\":[2]},{\"translation\":[0,0,-1],\"extensions\":{\"KHR_lights_punctual\":{\"light\":0}}}";

// A light one metre before a node, which moves from x = 0 to x = 8 within a second, by each kind of curve.
TEST_ALONE(CurvesMoveLights)
{
    static const float times[2] = {0, 1}, linear[6] = {0, 0, 0, 8, 0, 0};
    static const float cubic[18] = {9, 9, 9, 0, 0, 0, 16, 0, 0, 0, 8, 0, 8, 0, 0, 9, 9, 9};
    static const char* const forms[] = {"LINEAR", "STEP", "CUBICSPLINE"};
    Desk d;
    openDesk(&d);
    for (int form = 0; form < 3; form++) {
        Blob blob = {.size = 0};
        addFloats(&blob, POINTS, 9);
        const int input = addFloats(&blob, times, 2);
        const int output = addFloats(&blob, form == 2 ? cubic : linear, form == 2 ? 18 : 6);
        writeGltf(
            deskPath(&d, "a.gltf"), &blob,
            NODES_HEAD "\"nodes\":[{\"mesh\":0},%s]," CURVE("translation", "1") TRIANGLE
            ",{\"bufferView\":1,\"componentType\":5126,\"count\":2,\"type\":\"SCALAR\"},{\"bufferView\":2,"
            "\"componentType\":5126,\"count\":%d,\"type\":\"VEC3\"}" VIEWS
            ",{\"buffer\":0,\"byteOffset\":%d,\"byteLength\":8},{\"buffer\":0,\"byteOffset\":%d,"
            "\"byteLength\":%d}],%s",
            LIGHT_NODES, forms[form], form == 2 ? 6 : 2, input, output, form == 2 ? 72 : 24, POINT_LIGHT);
        vplScene* scene = loadGltf(&d, "a.gltf");
        int count;
        vplScene_GetEmitterPath(scene, 0, &count);
        assert_int_equal(count, 25);
        for (int frame = -3; frame <= 30; frame += 3) {
            vplEmitterDef def;
            const double t = fmin(fmax(frame / 24.0, 0), 1), t2 = t * t, t3 = t2 * t;
            const double x = form == 0   ? 8 * t
                             : form == 1 ? (t < 1 ? 0 : 8)
                                         : 16 * (t3 - 2 * t2 + t) + 8 * (3 * t2 - 2 * t3);
            const double y = form == 2 ? 8 * (t3 - t2) : 0;
            assert_int_equal(vplScene_PoseEmitter(scene, 0, frame, &def), VPL_SUCCESS);
            assertAround((double)def.position.x, x, 1e-6);
            assertAround((double)def.position.y, y, 1e-6);
            assertAround((double)def.position.z, -1, 1e-6);
        }
        vplScene_Destroy(scene);
    }
    closeDesk(&d);
}

// A node turns by 90 degrees about y in half a second; the light before it goes round with even speed.
TEST_ALONE(TurnsAreSphericalAndGoTheShorterWay)
{
    static const float times[2] = {0.5f, 1}, h = 0.70710678f;
    Desk d;
    openDesk(&d);
    for (int sign = -1; sign <= 1; sign += 2) { // both quaternions are the same turn
        const float turns[8] = {0, 0, 0, 1, 0, (float)sign * h, 0, (float)sign * h};
        Blob blob = {.size = 0};
        addFloats(&blob, POINTS, 9);
        const int input = addFloats(&blob, times, 2), output = addFloats(&blob, turns, 8);
        writeGltf(deskPath(&d, "a.gltf"), &blob,
                  NODES_HEAD "\"nodes\":[{\"mesh\":0},%s]," CURVE("rotation", "1")
                      TRIANGLE CURVE_VIEWS("2", "2", "VEC4") "%s",
                  LIGHT_NODES, "LINEAR", input, 8, output, 32, POINT_LIGHT);
        vplScene* scene = loadGltf(&d, "a.gltf");
        for (int frame = 12; frame <= 24; frame += 4) {
            vplEmitterDef def;
            const double angle = (frame - 12) / 12.0 * VPL_PI / 2;
            assert_int_equal(vplScene_PoseEmitter(scene, 0, frame, &def), VPL_SUCCESS);
            assertAround((double)def.position.x, -sin(angle), 1e-6);
            assertAround((double)def.position.z, -cos(angle), 1e-6);
            assertAround((double)def.direction.x, -sin(angle), 1e-6);
        }
        vplScene_Destroy(scene);
    }
    closeDesk(&d);
}

TEST_ALONE(CamerasMoveAndMeshesThatHaveNoCurveStandStill)
{
    static const float times[3] = {0, 1, 2}, places[9] = {0, 0, 4, 0, 0, 6, 3, 0, 6};
    Blob blob = {.size = 0};
    addFloats(&blob, POINTS, 9);
    const int input = addFloats(&blob, times, 3), output = addFloats(&blob, places, 9);
    Desk d;
    openDesk(&d);
    writeGltf(
        deskPath(&d, "a.gltf"), &blob,
        NODES_HEAD
        "\"nodes\":[{\"mesh\":0},{\"camera\":0,\"children\":[2]},{\"mesh\":0}]," CURVE("translation", "1")
            TRIANGLE CURVE_VIEWS(
                "3", "3",
                "VEC3") "\"cameras\":[{\"type\":\"perspective\",\"perspective\":{\"yfov\":1,\"znear\":0.1}}]",
        "LINEAR", input, 12, output, 36);
    vplScene* scene = loadGltf(&d, "a.gltf");
    vplCameraDef def;
    assert_int_equal(vplScene_PoseCamera(scene, 0, 36, &def), VPL_SUCCESS);
    assertAround((double)def.eye.x, 1.5, 1e-6);
    assertAround((double)def.eye.z, 6, 1e-6);
    assertAround((double)def.target.x, 1.5, 1e-6);
    assert_true(def.target.z < def.eye.z);
    assert_null(vplScene_GetObjectPath(scene, 0, &(int){0}));
    assert_non_null(vplScene_GetObjectPath(scene, 1, &(int){0}));
    vplScene_Destroy(scene);
    closeDesk(&d);
}

// Writes a triangle that three keys move by a curve, below a node that is turned, and a second one that stands.
static void writeMover(const char* path, const char* form, const float* values, int count)
{
    static const float times[3] = {0, 1, 1.5f};
    Blob blob = {.size = 0};
    addFloats(&blob, POINTS, 9);
    const int input = addFloats(&blob, times, 3), output = addFloats(&blob, values, 3 * count);
    char views[16];
    snprintf(views, sizeof views, "%d", count);
    writeGltf(path, &blob,
              NODES_HEAD
              "\"nodes\":[{\"mesh\":0},{\"rotation\":[0,0.6,0,0.8],\"children\":[2]},{\"mesh\":0}]," CURVE(
                  "translation", "2") TRIANGLE
              ",{\"bufferView\":1,\"componentType\":5126,\"count\":3,\"type\":\"SCALAR\"},{\"bufferView\":2,"
              "\"componentType\":5126,\"count\":%s,\"type\":\"VEC3\"}" VIEWS
              ",{\"buffer\":0,\"byteOffset\":%d,\"byteLength\":12},{\"buffer\":0,\"byteOffset\":%d,"
              "\"byteLength\":%d}],%s",
              form, views, input, output, 12 * count, POINT_LIGHT);
}

// By the formula of glTF 2.0, appendix C, written out for each of the two pieces: at its second piece, too, a spline begins
// with the tangent behind the key and ends with the one before the next.
static double expectedAt(int form, const float* v, int axis, double time)
{
    const int stride = form == 2 ? 9 : 3, offset = form == 2 ? 3 : 0, piece = time < 1 ? 0 : 1;
    const double length = piece == 0 ? 1 : 0.5, t = fmin((time - piece) / length, 1), t2 = t * t, t3 = t2 * t;
    const float *a = v + piece * stride, *b = a + stride;
    const double from = (double)a[offset + axis], to = (double)b[offset + axis];
    return form == 0   ? from + t * (to - from)
           : form == 1 ? (t < 1 ? from : to)
                       : (2 * t3 - 3 * t2 + 1) * from + length * (t3 - 2 * t2 + t) * (double)a[6 + axis] +
                             (3 * t2 - 2 * t3) * to + length * (t3 - t2) * (double)b[axis];
}

TEST_ALONE(CurvesMoveObjects)
{
    static const float straight[9] = {0, 0, 0, 8, 1, 2, -3, 4, 5},
                       cubic[27] = {9, 9, 9,  0, 0,  0,  16, 1,  2, 3, -4, 5, 8, 1,
                                    2, 6, -7, 8, -9, 10, 11, -3, 4, 5, 9,  9, 9};
    static const char* const forms[] = {"LINEAR", "STEP", "CUBICSPLINE"};
    Desk d;
    openDesk(&d);
    for (int form = 0; form < 3; form++) {
        const float* values = form == 2 ? cubic : straight;
        writeMover(deskPath(&d, "a.gltf"), forms[form], values, form == 2 ? 9 : 3);
        vplScene* scene = loadGltf(&d, "a.gltf");
        int count;
        assert_non_null(vplScene_GetObjectPath(scene, 1, &count));
        assert_int_equal(count, 37);
        for (int frame = 0; frame <= 36; frame++) {
            double p[3];
            assert_int_equal(vplScene_SetFrame(scene, frame), VPL_SUCCESS);
            for (int k = 0; k < 3; k++) {
                p[k] = expectedAt(form, values, k, frame / 24.0);
            }
            const float* m = vplScene_GetObject(scene, 1)->transform.m; // 0.6, 0.8: cosine 0.28, sine 0.96
            assertAround((double)m[12], 0.28 * p[0] + 0.96 * p[2], 1e-5);
            assertAround((double)m[13], p[1], 1e-5);
            assertAround((double)m[14], -0.96 * p[0] + 0.28 * p[2], 1e-5);
            assertAround((double)m[0], 0.28, 1e-6);
        }
        vplScene_Destroy(scene);
    }
    closeDesk(&d);
}

TEST_ALONE(EndlessAnimationsAreRefused)
{
    static const float times[2] = {0, 1e9f}, places[6] = {0};
    Blob blob = {.size = 0};
    addFloats(&blob, POINTS, 9);
    const int input = addFloats(&blob, times, 2), output = addFloats(&blob, places, 6);
    vplScene* scene = NULL;
    Desk d;
    openDesk(&d);
    writeGltf(deskPath(&d, "a.gltf"), &blob,
              NODES_HEAD "\"nodes\":[{\"mesh\":0},%s]," CURVE("translation", "1")
                  TRIANGLE CURVE_VIEWS("2", "2", "VEC3") "%s",
              LIGHT_NODES, "LINEAR", input, 8, output, 24, POINT_LIGHT);
    assert_int_equal(vplScene_Load(d.context, deskPath(&d, "a.gltf"), &scene), VPL_LIMIT);
    assert_null(scene);
    assert_int_equal(countOf(d.said, "an animation of 1e+09 s is longer than 100000 frames"), 1);
    unlink(deskPath(&d, "a.gltf"));
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
