// SPDX-License-Identifier: MIT
#include "scenes.h"

vplMat4 matrixOf(const Table* t, int row)
{
    vplMat4 m = vplMat4_Identity();
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 4; j++) {
            char name[4] = {'m', (char)('0' + i), (char)('0' + j), 0};
            m.m[4 * j + i] = (float)number(t, row, name);
        }
    }
    return m;
}

vplGeometry* tableRoom(vplContext* context)
{
    vplScene* scene;
    vplGeometry* geometry;
    Table t = loadTable("room_objects.csv");
    assert_int_equal(vplScene_Create(context, &scene), VPL_SUCCESS);
    for (int row = 0; row < t.rows; row++) {
        vplMaterialDef material = vplDefaultMaterialDef();
        material.diffuse = (vplRgb){(float)number(&t, row, "rho_r"), (float)number(&t, row, "rho_g"),
                                    (float)number(&t, row, "rho_b")};
        vplObjectDef object = vplDefaultObjectDef();
        assert_int_equal(vplScene_AddMaterial(scene, &material, &object.material), VPL_SUCCESS);
        object.name = cell(&t, row, "name");
        object.type = strcmp(cell(&t, row, "type"), "box") == 0 ? VPL_OBJECT_BOX : VPL_OBJECT_QUAD;
        object.transform = matrixOf(&t, row);
        assert_int_equal(vplScene_AddObject(scene, &object, NULL), VPL_SUCCESS);
    }
    assert_int_equal(vplGeometry_Create(scene, &geometry), VPL_SUCCESS);
    vplScene_Destroy(scene);
    freeTable(&t);
    return geometry;
}

static vplGeometry* build(vplScene* scene)
{
    vplGeometry* geometry;
    assert_int_equal(vplGeometry_Create(scene, &geometry), VPL_SUCCESS);
    vplScene_Destroy(scene);
    return geometry;
}

vplScene* sceneOf(vplContext* context, float rho)
{
    vplScene* scene;
    assert_int_equal(vplScene_Create(context, &scene), VPL_SUCCESS);
    vplMaterialDef material = vplDefaultMaterialDef();
    material.diffuse = (vplRgb){rho, rho, rho};
    assert_int_equal(vplScene_AddMaterial(scene, &material, NULL), VPL_SUCCESS);
    return scene;
}

vplScene* closedCubeScene(vplContext* context, float rho, float emission)
{
    vplScene* scene = sceneOf(context, rho);
    vplMaterialDef material = vplDefaultMaterialDef();
    int wall;
    material.diffuse = (vplRgb){rho, rho, rho};
    material.emission = (vplRgb){emission, 0.5f * emission, 0.25f * emission};
    assert_int_equal(vplScene_AddMaterial(scene, &material, &wall), VPL_SUCCESS);
    for (int face = 0; face < 6; face++) {
        float side = face & 1 ? -1 : 1; // the wall at `side` on axis face / 2, turned inwards
        double rotate[3] = {0, 0, 0};
        vplVec3 place = {0, 0, 0};
        if (face / 2 == 0) {
            place.x = side;
            rotate[1] = side > 0 ? -VPL_PI / 2 : VPL_PI / 2;
        } else if (face / 2 == 1) {
            place.y = side;
            rotate[0] = side > 0 ? VPL_PI / 2 : -VPL_PI / 2;
        } else {
            place.z = side;
            rotate[1] = side > 0 ? VPL_PI : 0;
        }
        vplObjectDef object = vplDefaultObjectDef();
        object.material = wall;
        object.transform = vplMat4_FromParts(place, rotate, (vplVec3){2, 2, 1});
        assert_int_equal(vplScene_AddObject(scene, &object, NULL), VPL_SUCCESS);
    }
    return scene;
}

vplGeometry* closedCube(vplContext* context, float rho)
{
    return build(closedCubeScene(context, rho, 0));
}

vplGeometry* floorQuad(vplContext* context, vplVec3 centre, float size, float rho)
{
    vplScene* scene = sceneOf(context, rho);
    vplObjectDef object = vplDefaultObjectDef();
    object.transform = vplMat4_FromParts(centre, (double[3]){-VPL_PI / 2, 0, 0}, (vplVec3){size, size, 1});
    assert_int_equal(vplScene_AddObject(scene, &object, NULL), VPL_SUCCESS);
    return build(scene);
}

void aim(vplScene* scene, vplVec3 eye, vplVec3 target)
{
    vplCameraDef camera = vplDefaultCameraDef();
    camera.eye = eye;
    camera.target = target;
    camera.fovY = 1.2;
    camera.nearPlane = 0.01;
    assert_int_equal(vplScene_AddCamera(scene, &camera, NULL), VPL_SUCCESS);
}

void addEmitter(vplScene* scene, vplEmitterType type, vplVec3 position, vplVec3 direction, float intensity)
{
    vplEmitterDef emitter = vplDefaultEmitterDef();
    emitter.type = type;
    emitter.position = position;
    emitter.direction = direction;
    emitter.intensity = (vplRgb){intensity, intensity, intensity};
    assert_int_equal(vplScene_AddEmitter(scene, &emitter, NULL), VPL_SUCCESS);
}

int addMaterial(vplScene* scene, vplRgb diffuse, float emission)
{
    vplMaterialDef material = vplDefaultMaterialDef();
    material.diffuse = diffuse;
    material.emission = (vplRgb){emission, emission, emission};
    int index;
    assert_int_equal(vplScene_AddMaterial(scene, &material, &index), VPL_SUCCESS);
    return index;
}

void addThing(vplScene* scene, vplObjectType type, int material, vplVec3 place, double turnX, double turnY,
              vplVec3 size)
{
    vplObjectDef object = vplDefaultObjectDef();
    object.type = type;
    object.material = material;
    object.transform = vplMat4_FromParts(place, (double[3]){turnX, turnY, 0}, size);
    assert_int_equal(vplScene_AddObject(scene, &object, NULL), VPL_SUCCESS);
}
