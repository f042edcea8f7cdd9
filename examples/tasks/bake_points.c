// SPDX-License-Identifier: MIT
// The light at points of a scene: bake_points SCENE prints the irradiance of four points of its first triangles.
#include <vpl/stages.h>

#include <stdio.h>

enum { POINTS = 4, MOST_LIGHTS = 4000 };

int main(int count, char** words)
{
    static vplShadeLight lights[MOST_LIGHTS];
    vplSurfacePoint points[POINTS];
    vplRgb light[POINTS] = {{0}};
    vplContextDef context = vplDefaultContextDef();
    context.log = vplLogToStderr;
    vplRenderOptions options = vplDefaultRenderOptions();
    vplRenderOptions_SetAll(&options, "--method keller --particles 500");
    vplContext* owner = NULL;
    vplScene* scene = NULL;
    vplGeometry* geometry = NULL;
    vplLightSet* set = NULL;
    bool failed = vplContext_Create(&context, &owner) ||
                  vplScene_Load(owner, count > 1 ? words[1] : "room.json", &scene) ||
                  vplGeometry_Create(scene, &geometry) || vplMakeLights(scene, &options, &set) ||
                  geometry->triangleCount < POINTS || set->lightCount > MOST_LIGHTS;
    if (!failed) {
        vplShadeDef def = vplDefaultShadeDef();
        def.lights = lights;
        def.lightRays = true;
        def.minDistance = 0.1f;
        def.lightCount = vplPrepareLights(set, VPL_LIGHTING_PHYSICAL, lights);
        def.emitters = vplScene_GetEmitter(scene, 0); // the scene has one
        def.emitterCount = 1;
        for (int i = 0; i < POINTS; i++) {
            points[i] = (vplSurfacePoint){vplGeometry_SampleTriangle(geometry, i, 0.3f, 0.3f).position,
                                          geometry->normals[i], i};
        }
        failed = vplShadePoints(geometry, &def, points, POINTS, light, NULL) != VPL_SUCCESS;
    }
    for (int i = 0; i < POINTS; i++) {
        printf("%g %g %g W/m^2\n", (double)light[i].r, (double)light[i].g, (double)light[i].b);
        failed = failed || !(light[i].r > 0 && light[i].r < 1000);
    }
    vplLightSet_Destroy(set);
    vplGeometry_Destroy(geometry);
    vplScene_Destroy(scene);
    vplContext_Destroy(owner);
    return failed ? 1 : 0;
}
