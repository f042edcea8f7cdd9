// SPDX-License-Identifier: MIT
// Each stage of instant radiosity called by itself: stages SCENE PICTURE simulates particles, draws a cube shadow map, asks
// it about a point, lights points by virtual lights and shades a picture. The scene's first light must be a point light.
#include <vpl/stages.h>

#include <stdio.h>
#include <stdlib.h>

static void printMessage(void* file, vplLogLevel level, const char* message)
{
    (void)level;
    fprintf(file, "%s\n", message);
}

// Ends the program if a stage failed. The log has the reason.
static void check(vplResult result, const char* stage)
{
    if (result != VPL_SUCCESS) {
        fprintf(stderr, "%s: %s\n", stage, vplResult_GetName(result));
        exit(1);
    }
}

static vplScene* loadScene(vplContext* context, const char* file)
{
    vplScene* scene;
    check(vplScene_Load(context, file, &scene), "scene");
    if (vplScene_GetEmitterCount(scene) == 0 || vplScene_GetEmitter(scene, 0)->type != VPL_EMITTER_POINT) {
        fprintf(stderr, "the scene's first light must be a point light\n");
        exit(2);
    }
    return scene;
}

// 1. Particles leave the light, and each hit leaves a virtual light.
static vplLightSet* simulateParticles(const vplGeometry* geometry, const vplEmitterDef* light)
{
    vplParticleDef particles = vplDefaultParticleDef();
    particles.particleCount = 100;
    vplLightSet* set;
    check(vplSimulateParticles(geometry, light, 1, &particles, &set), "particles");
    printf("%d lights in %d steps, %d particles escaped\n", set->lightCount, set->stepCount, set->escaped);
    return set;
}

// 2. The cube shadow map of the light gives the shadow at any point. The shadow refers to the map.
static vplCubeMap* castShadow(const vplGeometry* geometry, const vplEmitterDef* light, vplShadow* shadow)
{
    vplCubeMapDef mapDef = vplDefaultCubeMapDef();
    vplShadowDef shadowDef = vplDefaultShadowDef();
    vplVec3 point = {-2, 0, -2}, up = {0, 1, 0};
    vplCubeMap* map;
    mapDef.position = light->position;
    check(vplCubeMap_Create(geometry, &mapDef, NULL, NULL, &map), "cube map");
    check(vplShadow_Create(map, &shadowDef, shadow), "shadow");
    printf("shadow factor at (-2, 0, -2): %g\n", (double)vplShadow_Factor(shadow, point, up));
    return map;
}

// Particles that start at the emitter are no virtual lights, so there may be fewer than the set has.
static vplShadeLight* prepareLights(const vplLightSet* set, int* countOut)
{
    vplShadeLight* lights = malloc((size_t)set->lightCount * sizeof *lights);
    if (lights == NULL && set->lightCount > 0) {
        fprintf(stderr, "out of memory\n");
        exit(1);
    }
    *countOut = vplPrepareLights(set, VPL_LIGHTING_PHYSICAL, lights);
    return lights;
}

// 3. The virtual lights light points of the floor, here 16 along its front, which rays find.
static void lightFloor(const vplGeometry* geometry, const vplShadeLight* lights, int lightCount)
{
    vplShadeDef def = vplDefaultShadeDef();
    def.minDistance = 0.2f; // metres: nearer lights shine as from there
    def.lights = lights;
    def.lightCount = lightCount;
    vplSurfacePoint points[16];
    vplRgb irradiance[16];
    int count = 0;
    for (int i = 0; i < 16; i++) {
        const vplRay ray = {.origin = {-2 + 0.25f * (float)i, 0.1f, 2}, .direction = {0, -1, 0}};
        vplHit hit;
        if (vplGeometry_ClosestHit(geometry, &ray, &hit)) {
            points[count++] = (vplSurfacePoint){hit.position, hit.normal, hit.triangle};
        }
    }
    check(vplShadePoints(geometry, &def, points, count, irradiance, NULL), "points");
    if (count > 0) {
        printf("irradiance along the front of the floor: %g ... %g W/m^2\n", (double)irradiance[0].r,
               (double)irradiance[count - 1].r);
    }
}

// 4. The picture: direct light with shadows, then one additive pass per virtual light.
static void shadePicture(const vplGeometry* geometry, const vplCameraDef* camera, const vplShadeDef* def,
                         const char* file)
{
    vplView view = vplView_Create(camera, 320, 240);
    vplImage* image;
    vplShadeStats stats;
    check(vplImage_Create(geometry->context, 320, 240, &image), "image");
    check(vplShadeView(geometry, &view, def, image, &stats), "shading");
    printf("%lld draw calls, %lld fragments\n", (long long)stats.raster.drawCalls,
           (long long)stats.raster.fragments);
    check(vplToneMap_Reinhard(image, NULL), "tone map");
    check(vplImage_Write(image, file, NULL), "picture");
    vplImage_Destroy(image);
}

int main(int count, char** words)
{
    if (count < 3) {
        fprintf(stderr, "usage: stages SCENE PICTURE\n");
        return 2;
    }
    vplContextDef contextDef = vplDefaultContextDef();
    contextDef.log = printMessage;
    contextDef.logUser = stderr;
    vplContext* context;
    check(vplContext_Create(&contextDef, &context), "context");
    vplScene* scene = loadScene(context, words[1]);
    const vplEmitterDef* light = vplScene_GetEmitter(scene, 0);
    vplGeometry* geometry;
    check(vplGeometry_Create(scene, &geometry), "geometry");

    vplLightSet* set = simulateParticles(geometry, light);
    vplShadow shadow;
    vplCubeMap* map = castShadow(geometry, light, &shadow);
    int lightCount;
    vplShadeLight* lights = prepareLights(set, &lightCount);
    lightFloor(geometry, lights, lightCount);
    vplShadeDef def = vplDefaultShadeDef(); // one pass per virtual light
    def.minDistance = 0.2f;
    def.emitters = light;
    def.shadows = &shadow;
    def.emitterCount = 1;
    def.lights = lights;
    def.lightCount = lightCount;
    def.emission = true;
    shadePicture(geometry, vplScene_GetCamera(scene, 0), &def, words[2]);

    free(lights);
    vplCubeMap_Destroy(map);
    vplLightSet_Destroy(set);
    vplGeometry_Destroy(geometry);
    vplScene_Destroy(scene);
    vplContext_Destroy(context);
    return 0;
}
