// SPDX-License-Identifier: MIT
// Every stage called by itself: particles, cube shadow map, shadow factor, light kernel, a pipeline.
#include <vpl/vpl.h>

#include <stdio.h>
#include <stdlib.h>

static void check(vplResult result, const char* what)
{
    if (result != VPL_SUCCESS) {
        fprintf(stderr, "%s: %s\n", what, vplResult_GetName(result));
        exit(1);
    }
}

// Irradiance of 16 points along the front of the floor.
static void lightFloor(const vplContext* context, const vplShadeLight* lights, int lightCount)
{
    vplSurface surface;
    float irradiance[3][VPL_LANES] = {{0}};
    for (int l = 0; l < VPL_LANES; l++) {
        surface.px[l] = -2 + 0.25f * (float)l;
        surface.py[l] = 0;
        surface.pz[l] = 2;
        surface.nx[l] = surface.nz[l] = 0;
        surface.ny[l] = 1;
    }
    vplAccumulateLights(context, VPL_LIGHTING_PHYSICAL, 0.2f, &surface, lights, lightCount, irradiance);
    printf("irradiance along the front of the floor: %g ... %g W/m^2\n", (double)irradiance[0][0],
           (double)irradiance[0][VPL_LANES - 1]);
}

int main(int count, char** words)
{
    if (count < 3) {
        fprintf(stderr, "usage: stages SCENE.json PICTURE.png\n");
        return 2;
    }
    vplContext* context;
    vplScene* scene;
    vplGeometry* geometry;
    check(vplContext_Create(NULL, &context), "context");
    check(vplScene_Load(context, words[1], &scene), "scene");
    check(vplGeometry_Create(scene, &geometry), "geometry");
    const vplEmitterDef* lamp = vplScene_GetEmitter(scene, 0);

    // 1. Particles: each hit leaves a virtual light.
    vplParticleDef particles = vplDefaultParticleDef();
    particles.particleCount = 100;
    vplLightSet* set;
    check(vplSimulateParticles(geometry, lamp, 1, &particles, &set), "particles");
    printf("%d lights in %d steps, %d particles escaped\n", set->lightCount, set->stepCount, set->escaped);

    // 2. The cube shadow map, and what one point sees of the lamp.
    vplCubeMapDef mapDef = vplDefaultCubeMapDef();
    mapDef.position = lamp->position;
    vplCubeMap* map;
    check(vplCubeMap_Create(geometry, &mapDef, NULL, NULL, &map), "cube map");
    vplShadowDef shadowDef = vplDefaultShadowDef();
    vplShadow shadow;
    check(vplShadow_Create(map, &shadowDef, &shadow), "shadow");
    vplVec3 point = {-2, 0, -2}, up = {0, 1, 0};
    printf("shadow factor at (-2, 0, -2): %g\n", (double)vplShadow_Factor(&shadow, point, up));

    // 3. The light kernel on 16 points at once.
    vplShadeLight* lights = malloc((size_t)set->lightCount * sizeof *lights);
    vplPrepareLights(set, VPL_LIGHTING_PHYSICAL, lights);
    lightFloor(context, lights, set->lightCount);

    // 4. All of it in one of the pipelines.
    vplView view = vplView_Create(vplScene_GetCamera(scene, 0), 320, 240);
    vplShadeDef def = {0};
    def.accumulation = VPL_ACCUMULATE_MULTIPASS;
    def.minDistance = 0.2f;
    def.emitters = lamp;
    def.shadows = &shadow;
    def.emitterCount = 1;
    def.lights = lights;
    def.lightCount = set->lightCount;
    def.emission = true;
    vplImage* image;
    vplShadeStats stats;
    check(vplImage_Create(context, 320, 240, &image), "image");
    check(vplShadeView(geometry, &view, &def, NULL, NULL, image, &stats), "shading");
    printf("%lld draw calls, %lld fragments\n", (long long)stats.raster.drawCalls,
           (long long)stats.raster.fragments);
    check(vplToneMap_Reinhard(image, NULL), "tone map");
    check(vplImage_Write(image, words[2], NULL), "picture");

    vplImage_Destroy(image);
    free(lights);
    vplCubeMap_Destroy(map);
    vplLightSet_Destroy(set);
    vplGeometry_Destroy(geometry);
    vplScene_Destroy(scene);
    vplContext_Destroy(context);
    return 0;
}
