// SPDX-License-Identifier: MIT
// A scene declared in code instead of a file: scene_by_hand [PICTURE] makes three walls and a box, renders them with 300
// particles and prints statistics.
#include <vpl/vpl.h>

#include <stdio.h>
#include <stdlib.h>

static void printMessage(void* file, vplLogLevel level, const char* message)
{
    (void)level;
    fprintf(file, "%s\n", message);
}

// Ends the program if a call failed. printMessage has printed the reason.
static void check(vplResult result)
{
    if (result != VPL_SUCCESS) {
        exit(1);
    }
}

static int addMaterial(vplScene* scene, float r, float g, float b)
{
    vplMaterialDef def = vplDefaultMaterialDef();
    def.diffuse = (vplRgb){r, g, b};
    int index;
    check(vplScene_AddMaterial(scene, &def, &index));
    return index;
}

static void addQuad(vplScene* scene, int material, vplVec3 place, double turnX, double turnY, float size)
{
    vplObjectDef def = vplDefaultObjectDef();
    const double rotate[3] = {turnX, turnY, 0};
    def.material = material;
    def.transform = vplMat4_FromParts(place, rotate, (vplVec3){size, size, 1});
    check(vplScene_AddObject(scene, &def, NULL));
}

static vplScene* makeScene(vplContext* context)
{
    vplScene* scene;
    check(vplScene_Create(context, &scene));
    int white = addMaterial(scene, 0.7f, 0.7f, 0.7f), blue = addMaterial(scene, 0.1f, 0.2f, 0.7f);
    addQuad(scene, white, (vplVec3){0, 0, 0}, -VPL_PI / 2, 0, 4); // floor, facing up
    addQuad(scene, white, (vplVec3){0, 2, -2}, 0, 0, 4);          // back wall
    addQuad(scene, blue, (vplVec3){-2, 2, 0}, 0, VPL_PI / 2, 4);  // left wall

    vplObjectDef box = vplDefaultObjectDef();
    const double rotate[3] = {0, 0.5, 0};
    box.type = VPL_OBJECT_BOX;
    box.material = white;
    box.transform = vplMat4_FromParts((vplVec3){0.3f, 0.5f, -0.2f}, rotate, (vplVec3){1, 1, 1});
    check(vplScene_AddObject(scene, &box, NULL));

    vplEmitterDef light = vplDefaultEmitterDef();
    light.position = (vplVec3){1, 3, 1.5f};
    light.intensity = (vplRgb){12, 12, 12}; // W/sr
    check(vplScene_AddEmitter(scene, &light, NULL));

    vplCameraDef camera = vplDefaultCameraDef();
    camera.eye = (vplVec3){1.5f, 2, 5};
    camera.target = (vplVec3){-0.3f, 1, -0.5f};
    check(vplScene_AddCamera(scene, &camera, NULL));
    return scene;
}

int main(int count, char** words)
{
    vplContextDef def = vplDefaultContextDef();
    def.log = printMessage;
    def.logUser = stderr;
    vplContext* context;
    check(vplContext_Create(&def, &context));
    vplScene* scene = makeScene(context);

    vplRenderOptions options = vplDefaultRenderOptions();
    options.output.width = 480;
    options.output.height = 360;
    options.particles.count = 300;
    options.particles.sampler = VPL_SAMPLER_HALTON;
    vplImage* image;
    vplRenderStats stats;
    check(vplRender(scene, &options, &image, &stats));
    printf("%d virtual lights in %.1f ms, hash %016llx\n", stats.virtualLights, stats.totalMs,
           (unsigned long long)stats.imageHash);

    vplWriteOptions write = vplDefaultWriteOptions();
    write.exposure = 1;
    check(vplImage_Write(image, count > 1 ? words[1] : "scene_by_hand.png", &write));
    vplImage_Destroy(image);
    vplScene_Destroy(scene);
    vplContext_Destroy(context);
    return 0;
}
