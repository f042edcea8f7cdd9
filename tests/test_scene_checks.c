// SPDX-License-Identifier: MIT
// Tests of scenes made by hand: each bad number is refused by name, and a refusal changes nothing.
#include "test.h"

// A numeric field of a def, the bad value to set, and the text of the refusal.
typedef struct BadNumber {
    size_t offset;
    bool wide; // a double
    double value;
    const char* text;
} BadNumber;

static const float BEYOND = 2 * VPL_MAX_MAGNITUDE;

#define FLOAT(type, field)  offsetof(type, field), false
#define DOUBLE(type, field) offsetof(type, field), true

static void setNumber(void* def, const BadNumber* bad)
{
    char* place = (char*)def + bad->offset;
    float narrow = (float)bad->value;
    memcpy(place, bad->wide ? (const void*)&bad->value : (const void*)&narrow, bad->wide ? 8 : 4);
}

enum { UNTOUCHED = -7 }; // an index output's value before the call, and after a refusal

static void assertUntouched(vplResult result, const char* text, int index)
{
    assertRefused(result, VPL_INVALID_ARGUMENT, text);
    assert_int_equal(index, UNTOUCHED);
}

static vplScene* emptyScene(vplContext* context)
{
    vplScene* scene;
    assert_int_equal(vplScene_Create(context, &scene), VPL_SUCCESS);
    return scene;
}

TEST(CamerasAreChecked, 1)
{
    vplScene* scene = emptyScene(context);
    const BadNumber cases[] = {
        {FLOAT(vplCameraDef, eye.y), (double)NAN, "vplCameraDef.eye[1] is nan"},
        {FLOAT(vplCameraDef, eye.x), (double)INFINITY, "vplCameraDef.eye[0] is inf"},
        {FLOAT(vplCameraDef, target.z), (double)-BEYOND, "vplCameraDef.target[2] is -2e+15"},
        {FLOAT(vplCameraDef, target.z), 5, "vplCameraDef.target equals the eye"},
        {FLOAT(vplCameraDef, up.x), (double)NAN, "vplCameraDef.up[0]"},
        {FLOAT(vplCameraDef, up.y), 0, "vplCameraDef.up is the zero vector"},
        {DOUBLE(vplCameraDef, fovY), 0, "vplCameraDef.fovY is 0"},
        {DOUBLE(vplCameraDef, fovY), VPL_PI, "vplCameraDef.fovY is 3.14159"},
        {DOUBLE(vplCameraDef, fovY), (double)NAN, "vplCameraDef.fovY is nan"},
        {DOUBLE(vplCameraDef, nearPlane), 0, "vplCameraDef.nearPlane is 0"},
        {DOUBLE(vplCameraDef, nearPlane), -1, "vplCameraDef.nearPlane is -1"},
        {DOUBLE(vplCameraDef, nearPlane), (double)NAN, "vplCameraDef.nearPlane is nan"},
        {DOUBLE(vplCameraDef, farPlane), 0.1, "vplCameraDef.farPlane is 0.1"},
        {DOUBLE(vplCameraDef, farPlane), (double)INFINITY, "vplCameraDef.farPlane is inf"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        vplCameraDef def = vplDefaultCameraDef();
        int index = UNTOUCHED;
        setNumber(&def, &cases[i]);
        assertUntouched(vplScene_AddCamera(scene, &def, &index), cases[i].text, index);
    }
    vplCameraDef def = vplDefaultCameraDef();
    def.up = (vplVec3){0, 0, -3};
    assertUntouched(vplScene_AddCamera(scene, &def, NULL), "vplCameraDef.up is parallel", UNTOUCHED);
    assert_int_equal(vplScene_GetCameraCount(scene), 0);
    vplScene_Destroy(scene);
}

// X042
TEST(MaterialsAreChecked, 1)
{
    vplScene* scene = emptyScene(context);
    const BadNumber cases[] = {
        {FLOAT(vplMaterialDef, diffuse.r), -0.01, "vplMaterialDef.diffuse[0] is -0.01"},
        {FLOAT(vplMaterialDef, diffuse.g), 1.0001, "vplMaterialDef.diffuse[1] is 1.0001"},
        {FLOAT(vplMaterialDef, diffuse.b), (double)NAN, "vplMaterialDef.diffuse[2] is nan"},
        {FLOAT(vplMaterialDef, emission.r), -1, "vplMaterialDef.emission[0] is -1"},
        {FLOAT(vplMaterialDef, emission.b), (double)BEYOND, "vplMaterialDef.emission[2] is 2e+15"},
        {FLOAT(vplMaterialDef, textureScale[1]), (double)NAN, "vplMaterialDef.textureScale[1] is nan"},
        {FLOAT(vplMaterialDef, textureOffset[0]), (double)BEYOND, "vplMaterialDef.textureOffset[0] is 2e+15"},
        {DOUBLE(vplMaterialDef, textureRotation), (double)INFINITY, "vplMaterialDef.textureRotation is inf"},
        {FLOAT(vplMaterialDef, opacity), 1.5, "vplMaterialDef.opacity is 1.5"},
        {FLOAT(vplMaterialDef, alphaCutoff), -0.1, "vplMaterialDef.alphaCutoff is -0.1"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        vplMaterialDef def = vplDefaultMaterialDef();
        int index = UNTOUCHED;
        setNumber(&def, &cases[i]);
        assertUntouched(vplScene_AddMaterial(scene, &def, &index), cases[i].text, index);
    }
    vplMaterialDef def = vplDefaultMaterialDef();
    int first = -1, second = -1;
    assert_int_equal(vplScene_AddMaterial(scene, &def, &first), VPL_SUCCESS);
    assert_int_equal(vplScene_AddMaterial(scene, &def, &second), VPL_SUCCESS); // unnamed ones do not collide
    def.name = "wood";
    assert_int_equal(vplScene_AddMaterial(scene, &def, NULL), VPL_SUCCESS);
    assertUntouched(vplScene_AddMaterial(scene, &def, NULL), "vplMaterialDef.name \"wood\" is taken",
                    UNTOUCHED);
    assert_true(first == 0 && second == 1 && vplScene_GetMaterialCount(scene) == 3);
    vplScene_Destroy(scene);
}

// X001, X008
TEST(ObjectsAreChecked, 1)
{
    vplScene* scene = emptyScene(context);
    vplMaterialDef material = vplDefaultMaterialDef();
    assert_int_equal(vplScene_AddMaterial(scene, &material, NULL), VPL_SUCCESS);
    const BadNumber cases[] = {
        {FLOAT(vplObjectDef, transform.m[0]), (double)NAN, "vplObjectDef.transform[0] is nan"},
        {FLOAT(vplObjectDef, transform.m[13]), (double)BEYOND, "vplObjectDef.transform[13] is 2e+15"},
        {FLOAT(vplObjectDef, transform.m[3]), 1, "vplObjectDef.transform has the last row (1, 0, 0, 1)"},
        {FLOAT(vplObjectDef, transform.m[15]), 0, "vplObjectDef.transform has the last row (0, 0, 0, 0)"},
        {FLOAT(vplObjectDef, transform.m[5]), 0, "vplObjectDef.transform scales the y axis to nothing"},
        {FLOAT(vplObjectDef, transform.m[10]), 1e-20, "vplObjectDef.transform scales the z axis to nothing"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        vplObjectDef def = vplDefaultObjectDef();
        int index = UNTOUCHED;
        setNumber(&def, &cases[i]);
        assertUntouched(vplScene_AddObject(scene, &def, &index), cases[i].text, index);
    }
    vplObjectDef flat = vplDefaultObjectDef(), unknown = flat, before = flat, beyond = flat;
    flat.transform.m[0] = flat.transform.m[1] = flat.transform.m[4] = flat.transform.m[5] = 1;
    assertUntouched(vplScene_AddObject(scene, &flat, NULL), "vplObjectDef.transform is singular", UNTOUCHED);
    unknown.type = (vplObjectType)7;
    assertUntouched(vplScene_AddObject(scene, &unknown, NULL), "vplObjectDef.type is 7", UNTOUCHED);
    before.material = -1;
    assertUntouched(vplScene_AddObject(scene, &before, NULL), "vplObjectDef.material is -1", UNTOUCHED);
    beyond.material = 1;
    assertUntouched(vplScene_AddObject(scene, &beyond, NULL), "vplObjectDef.material is 1", UNTOUCHED);
    assert_int_equal(vplScene_GetObjectCount(scene), 0);
    vplScene_Destroy(scene);
}

TEST(EmittersAreChecked, 1)
{
    vplScene* scene = emptyScene(context);
    const BadNumber cases[] = {
        {FLOAT(vplEmitterDef, position.x), (double)NAN, "vplEmitterDef.position[0] is nan"},
        {FLOAT(vplEmitterDef, position.z), (double)BEYOND, "vplEmitterDef.position[2] is 2e+15"},
        {FLOAT(vplEmitterDef, direction.y), 0, "vplEmitterDef.direction is the zero vector"},
        {FLOAT(vplEmitterDef, direction.x), (double)INFINITY, "vplEmitterDef.direction[0] is inf"},
        {FLOAT(vplEmitterDef, intensity.g), -1, "vplEmitterDef.intensity[1] is -1"},
        {FLOAT(vplEmitterDef, intensity.b), (double)NAN, "vplEmitterDef.intensity[2] is nan"},
        {DOUBLE(vplEmitterDef, outerAngle), 0, "vplEmitterDef.outerAngle is 0"},
        {DOUBLE(vplEmitterDef, outerAngle), VPL_PI / 2, "vplEmitterDef.outerAngle is 1.5708"},
        {DOUBLE(vplEmitterDef, innerAngle), -0.1, "vplEmitterDef.innerAngle is -0.1"},
        {DOUBLE(vplEmitterDef, innerAngle), 0.6, "vplEmitterDef.innerAngle is 0.6"},
        {DOUBLE(vplEmitterDef, innerAngle), (double)NAN, "vplEmitterDef.innerAngle is nan"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        vplEmitterDef def = vplDefaultEmitterDef();
        int index = UNTOUCHED;
        def.type = VPL_EMITTER_SPOT;
        setNumber(&def, &cases[i]);
        assertUntouched(vplScene_AddEmitter(scene, &def, &index), cases[i].text, index);
    }
    vplEmitterDef def = vplDefaultEmitterDef();
    def.type = (vplEmitterType)9;
    assertUntouched(vplScene_AddEmitter(scene, &def, NULL), "vplEmitterDef.type is 9", UNTOUCHED);
    assert_int_equal(vplScene_GetEmitterCount(scene), 0);
    vplScene_Destroy(scene);
}

TEST(DefsThatWereNeverFilledInAreRefused, 1)
{
    vplScene* scene = emptyScene(context);
    vplCameraDef camera = {.eye = {0, 0, 5}, .up = {0, 1, 0}, .fovY = 1, .nearPlane = 1, .farPlane = 2};
    vplMaterialDef material = {0};
    vplObjectDef object = {.transform = vplMat4_Identity()};
    vplEmitterDef emitter = {0};
    assertUntouched(vplScene_AddCamera(scene, &camera, NULL), "vplCameraDef was not made by its default",
                    UNTOUCHED);
    assertUntouched(vplScene_AddMaterial(scene, &material, NULL),
                    "vplMaterialDef was not made by its default", UNTOUCHED);
    assertUntouched(vplScene_AddObject(scene, &object, NULL), "vplObjectDef was not made by its default",
                    UNTOUCHED);
    assertUntouched(vplScene_AddEmitter(scene, &emitter, NULL), "vplEmitterDef was not made by its default",
                    UNTOUCHED);
    camera = vplDefaultCameraDef();
    camera.cookie++; // as that of a def of another type
    assertUntouched(vplScene_AddCamera(scene, &camera, NULL), "vplCameraDef was not made by its default",
                    UNTOUCHED);
    vplScene_Destroy(scene);
}

TEST(ScenesKeepTheirOwnNames, 1)
{
    vplScene* scene = emptyScene(context);
    char name[] = "oak";
    vplMaterialDef material = vplDefaultMaterialDef();
    vplObjectDef object = vplDefaultObjectDef();
    material.name = object.name = name;
    assert_int_equal(vplScene_AddMaterial(scene, &material, NULL), VPL_SUCCESS);
    assert_int_equal(vplScene_AddObject(scene, &object, NULL), VPL_SUCCESS);
    memcpy(name, "elm", 3);
    assert_string_equal(vplScene_GetMaterial(scene, 0)->name, "oak");
    assert_string_equal(vplScene_GetObject(scene, 0)->name, "oak");
    vplScene_Destroy(scene);
    vplScene_Destroy(NULL);
}
