// SPDX-License-Identifier: MIT
#include "emitter_scenes.h"

uint64_t renderHash(const vplScene* scene, const vplRenderOptions* options)
{
    vplImage* image = renderScene(scene, options, NULL);
    uint64_t hash = vplImage_Hash(image);
    vplImage_Destroy(image);
    return hash;
}

void lookDown(vplScene* scene, float height, double half)
{
    vplCameraDef camera = vplDefaultCameraDef();
    camera.eye = vplVec(0, height, 0);
    camera.target = vplVec(0, 0, 0);
    camera.up = vplVec(0, 0, -1);
    camera.fovY = 2 * atan(half);
    camera.nearPlane = 0.05;
    assert_int_equal(vplScene_AddCamera(scene, &camera, NULL), VPL_SUCCESS);
}

void floorPoint(int pixel, int size, double height, double half, double* x, double* z)
{
    *x = (2 * (pixel % size + 0.5) / size - 1) * half * height;
    *z = (2 * (pixel / size + 0.5) / size - 1) * half * height;
}

void addLevel(vplScene* scene, vplVec3 centre, float size, bool down, int material)
{
    vplObjectDef object = vplDefaultObjectDef();
    object.material = material;
    object.transform =
        vplMat4_FromParts(centre, (double[3]){(down ? 1 : -1) * VPL_PI / 2, 0, 0}, vplVec(size, size, 1));
    assert_int_equal(vplScene_AddObject(scene, &object, NULL), VPL_SUCCESS);
}

int addGlow(vplScene* scene, vplRgb emission, float rho)
{
    vplMaterialDef material = vplDefaultMaterialDef();
    int index;
    material.emission = emission;
    material.diffuse = (vplRgb){rho, rho, rho};
    assert_int_equal(vplScene_AddMaterial(scene, &material, &index), VPL_SUCCESS);
    return index;
}

void addColoured(vplScene* scene, vplEmitterType type, vplVec3 position, vplVec3 direction, float intensity)
{
    vplEmitterDef emitter = vplDefaultEmitterDef();
    emitter.type = type;
    emitter.position = position;
    emitter.direction = direction;
    emitter.intensity = (vplRgb){intensity, 0.5f * intensity, 0.75f * intensity};
    assert_int_equal(vplScene_AddEmitter(scene, &emitter, NULL), VPL_SUCCESS);
}

vplScene* zoo(vplContext* context, float factor)
{
    vplScene* scene = sceneOf(context, 0.6f);
    const int areaLight = addGlow(scene, (vplRgb){2 * factor, 3 * factor, factor}, 0.25f);
    addLevel(scene, vplVec(0, 0, 0), 4, false, 0);
    addLevel(scene, vplVec(0.5f, 2, 0.1f), 0.5f, true, areaLight);
    vplObjectDef object = vplDefaultObjectDef();
    object.transform = vplMat4_FromParts(vplVec(0, 1, -1), (double[3]){0.1, 0.2, 0}, vplVec(4, 3, 1));
    assert_int_equal(vplScene_AddObject(scene, &object, NULL), VPL_SUCCESS);
    object.type = VPL_OBJECT_BOX;
    object.material = areaLight;
    object.transform =
        vplMat4_FromParts(vplVec(-1, 0.5f, 0.3f), (double[3]){0.3, 0.4, 0.5}, vplVec(0.4f, 0.3f, 0.5f));
    assert_int_equal(vplScene_AddObject(scene, &object, NULL), VPL_SUCCESS);
    Shape ball = icosphere(1);
    const vplMat4 place =
        vplMat4_FromParts(vplVec(0.5f, 0.6f, 0.2f), (double[3]){0, 0, 0}, vplVec(0.5f, 0.4f, 0.5f));
    addShape(scene, &ball, true, &place);
    freeShape(&ball);
    addColoured(scene, VPL_EMITTER_POINT, vplVec(-0.5f, 1.5f, 0.5f), vplVec(0, -1, 0), 2 * factor);
    addColoured(scene, VPL_EMITTER_SPOT, vplVec(0.5f, 2.5f, 1), vplVec(0, -2, -0.7f), 5 * factor);
    addColoured(scene, VPL_EMITTER_DIRECTIONAL, vplVec(0, 0, 0), vplVec(-0.3f, -1, -0.4f), factor);
    vplCameraDef camera = vplDefaultCameraDef();
    camera.eye = vplVec(0, 1.5f, 4);
    camera.target = vplVec(0, 0.7f, 0);
    assert_int_equal(vplScene_AddCamera(scene, &camera, NULL), VPL_SUCCESS);
    return scene;
}

vplRenderOptions zooOptions(int shadows)
{
    vplRenderOptions o = plainOptions();
    o.output.width = 35;
    o.output.height = 25;
    o.particles.count = 36; // makes about 70 lights, more than one group
    o.lights.areaLightSamples = 9;
    o.shadow.mapSize = 32;
    o.lights.mapSize = 8;
    o.lights.shadows = (vplLightShadows)shadows;
    return o;
}
