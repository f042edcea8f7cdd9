// SPDX-License-Identifier: MIT
// A mesh in memory becomes a picture: mesh_to_picture PICTURE.
#include <vpl/vpl.h>

int main(int count, char** words)
{
    const vplVec3 positions[] = {{-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}, {0, 1.5f, 0}};
    const uint32_t indices[] = {0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4, 0, 3, 2, 0, 2, 1};
    vplContextDef def = vplDefaultContextDef();
    def.log = vplLogToStderr;
    vplMeshDef mesh = vplDefaultMeshDef();
    mesh.positions = positions;
    mesh.indices = indices;
    mesh.vertexCount = 5;
    mesh.triangleCount = 6;
    vplObjectDef object = vplDefaultObjectDef();
    object.type = VPL_OBJECT_MESH;
    vplEmitterDef lamp = vplDefaultEmitterDef();
    lamp.position = (vplVec3){2, 3, 4};
    lamp.intensity = (vplRgb){30, 30, 30};
    vplMaterialDef material = vplDefaultMaterialDef();
    vplCameraDef camera = vplDefaultCameraDef();
    vplRenderOptions options = vplDefaultRenderOptions();
    options.output.width = 64;
    options.output.height = 36;
    vplContext* context = NULL;
    vplScene* scene = NULL;
    vplImage* image = NULL;
    const bool failed = vplContext_Create(&def, &context) || vplScene_Create(context, &scene) ||
                        vplScene_AddMaterial(scene, &material, NULL) ||
                        vplScene_AddMesh(scene, &mesh, NULL) || vplScene_AddObject(scene, &object, NULL) ||
                        vplScene_AddEmitter(scene, &lamp, NULL) || vplScene_AddCamera(scene, &camera, NULL) ||
                        vplRender(scene, &options, &image, NULL) ||
                        vplImage_Write(image, count > 1 ? words[1] : "mesh.png", NULL);
    const bool lit = !failed && image->pixels[3 * (12 * 64 + 32)] > 0;
    vplImage_Destroy(image);
    vplScene_Destroy(scene);
    vplContext_Destroy(context);
    return lit ? 0 : 1;
}
