// SPDX-License-Identifier: MIT
// A material changes and the scene is rendered again, with what has not changed: change_material.
#include <vpl/vpl.h>

#include <stdio.h>

int main(void)
{
    vplContextDef def = vplDefaultContextDef();
    def.log = vplLogToStderr;
    vplMaterialDef material = vplDefaultMaterialDef();
    vplObjectDef object = vplDefaultObjectDef();
    vplEmitterDef lamp = vplDefaultEmitterDef();
    lamp.position = (vplVec3){0, 0, 2};
    vplCameraDef camera = vplDefaultCameraDef();
    vplRenderOptions options = vplDefaultRenderOptions();
    vplRenderOptions_SetAll(&options, "--method direct --size 32x18");
    vplContext* context = NULL;
    vplScene* scene = NULL;
    vplImage *grey = NULL, *red = NULL;
    bool failed = vplContext_Create(&def, &context) || vplScene_Create(context, &scene) ||
                  vplScene_AddMaterial(scene, &material, NULL) || vplScene_AddObject(scene, &object, NULL) ||
                  vplScene_AddEmitter(scene, &lamp, NULL) || vplScene_AddCamera(scene, &camera, NULL) ||
                  vplHistory_Create(context, &options.sequence.history) ||
                  vplRender(scene, &options, &grey, NULL);
    material.diffuse = (vplRgb){0.5f, 0.25f, 0};
    failed = failed || vplScene_SetMaterial(scene, 0, &material) || vplRender(scene, &options, &red, NULL);
    const float* before = failed ? NULL : &grey->pixels[3 * (9 * 32 + 16)];
    const float* after = failed ? NULL : &red->pixels[3 * (9 * 32 + 16)];
    const bool changed = !failed && after[0] == before[0] && after[1] == before[1] / 2 && after[2] == 0;
    printf("%s\n", changed ? "green is half, blue is gone" : "not as expected");
    vplImage_Destroy(grey);
    vplImage_Destroy(red);
    vplHistory_Destroy(options.sequence.history);
    vplScene_Destroy(scene);
    vplContext_Destroy(context);
    return changed ? 0 : 1;
}
