// SPDX-License-Identifier: MIT
#include "patch_model.h"

#include "math/vec.h"

vplGeometry* geometryOf(vplContext* context, const Shape* shape, float rho, float emission)
{
    vplScene* scene;
    vplMaterialDef material = vplDefaultMaterialDef();
    material.diffuse = (vplRgb){rho, rho, rho};
    material.emission = (vplRgb){emission, emission, emission};
    assert_int_equal(vplScene_Create(context, &scene), VPL_SUCCESS);
    assert_int_equal(vplScene_AddMaterial(scene, &material, NULL), VPL_SUCCESS);
    addShape(scene, shape, false, NULL);
    return freezeScene(scene);
}

static vplVec3 place(vplVec3 p, ModelUnit unit)
{
    if (unit == MODEL_SCALED) {
        return vplVec(p.x * 2 / 555 - 1, p.y * 2 / 555 - 1, p.z * 2 / 555 - 1);
    }
    return vplScale(unit == MODEL_METRES ? 0.01f : 1, p);
}

vplGeometry* testModel(vplContext* context, ModelUnit unit, float rho)
{
    Table t = loadTable("cornell_testmodel.csv");
    Shape shape = {0};
    for (int row = 0; row < t.rows; row++) {
        addTriangle(&shape, place(vectorOf(&t, row, "v0"), unit), place(vectorOf(&t, row, "v2"), unit),
                    place(vectorOf(&t, row, "v1"), unit));
    }
    vplGeometry* geometry = geometryOf(context, &shape, rho, 0);
    freeShape(&shape);
    freeTable(&t);
    return geometry;
}

vplPatchSides* sidesOf(const vplPatches* patches, const vplVec3* position)
{
    vplPatchSidesDef def = vplDefaultPatchSidesDef();
    vplEmitterDef lamp = vplDefaultEmitterDef();
    vplPatchSides* sides = NULL;
    if (position != NULL) {
        lamp.position = *position;
        def.emitters = &lamp;
        def.emitterCount = 1;
    }
    if (vplPatchSides_Create(patches, &def, &sides) != VPL_SUCCESS) {
        fail_msg("%s", takeMessage());
    }
    return sides;
}
