// SPDX-License-Identifier: MIT
// Light at points that a program has, such as the texels of a lightmap or the probes of a level: bake_points SCENE COUNT
// spreads points over the scene's surfaces, finds their irradiance by 1,000 particles with shadows by rays, and prints
// x,y,z,r,g,b (metres, W/m^2) as CSV.
#include <vpl/stages.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

// Points on all triangles, as many on each as its share of the area asks for, at the front.
static int spreadPoints(const vplGeometry* geometry, int wanted, vplSurfacePoint* points)
{
    const double areaPerPoint = vplGeometry_Area(geometry) / wanted;
    double area = 0.5 * areaPerPoint; // since the last point
    int count = 0;
    for (int i = 0; i < geometry->triangleCount && count < wanted; i++) {
        const vplVec3* corner[3];
        const vplGeometryObject* object = &geometry->objects[geometry->owners[i]];
        for (int k = 0; k < 3; k++) {
            corner[k] = &geometry->positions[object->firstVertex + (int)geometry->indices[3 * i + k]];
        }
        const double a[3] = {(double)corner[1]->x - (double)corner[0]->x,
                             (double)corner[1]->y - (double)corner[0]->y,
                             (double)corner[1]->z - (double)corner[0]->z};
        const double b[3] = {(double)corner[2]->x - (double)corner[0]->x,
                             (double)corner[2]->y - (double)corner[0]->y,
                             (double)corner[2]->z - (double)corner[0]->z};
        const double n[3] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
        area += 0.5 * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        for (; area >= areaPerPoint && count < wanted; area -= areaPerPoint) {
            // Additive recurrence of the two golden ratios (Roberts, 2018): even for any count.
            const double u = 0.5 + 0.7548776662466927 * count, v = 0.5 + 0.5698402909980532 * count;
            const vplHit hit =
                vplGeometry_SampleTriangle(geometry, i, (float)(u - floor(u)), (float)(v - floor(v)));
            points[count++] = (vplSurfacePoint){hit.position, geometry->normals[i], i};
        }
    }
    return count;
}

static vplResult bake(const vplScene* scene, int wanted, vplSurfacePoint* points, vplRgb* light)
{
    vplRenderOptions options = vplDefaultRenderOptions();
    vplGeometry* geometry = NULL;
    vplLightSet* set = NULL;
    options.method = VPL_METHOD_KELLER;
    options.particles.count = 1000;
    vplResult result = vplGeometry_Create(scene, &geometry);
    result = result == VPL_SUCCESS ? vplMakeLights(scene, &options, &set) : result;
    const int emitters = vplScene_GetEmitterCount(scene);
    vplShadeLight* lights =
        result == VPL_SUCCESS ? malloc(((size_t)set->lightCount + 1) * sizeof *lights) : NULL;
    vplEmitterDef* sources = malloc(((size_t)emitters + 1) * sizeof *sources);
    if (result == VPL_SUCCESS && (lights == NULL || sources == NULL)) {
        fprintf(stderr, "out of memory\n");
        result = VPL_OUT_OF_MEMORY;
    }
    if (result == VPL_SUCCESS) {
        const int count = spreadPoints(geometry, wanted, points);
        vplShadeDef def = vplDefaultShadeDef();
        def.lights = lights;
        def.lightCount = vplPrepareLights(set, VPL_LIGHTING_PHYSICAL, lights);
        def.lightRays = true;
        for (int i = 0; i < emitters; i++) {
            sources[i] = *vplScene_GetEmitter(scene, i);
        }
        def.emitters = sources;
        def.emitterCount = emitters;
        def.minDistance = 0.1f; // metres: nearer lights shine as from there
        result = vplShadePoints(geometry, &def, points, count, light, NULL);
        for (int i = 0; i < count && result == VPL_SUCCESS; i++) {
            const vplVec3 p = points[i].position;
            printf("%.6g,%.6g,%.6g,%.6g,%.6g,%.6g\n", (double)p.x, (double)p.y, (double)p.z,
                   (double)light[i].r, (double)light[i].g, (double)light[i].b);
        }
    }
    free(lights);
    free(sources);
    vplLightSet_Destroy(set);
    vplGeometry_Destroy(geometry);
    return result;
}

int main(int count, char** words)
{
    const int wanted = count == 3 ? atoi(words[2]) : 0;
    if (wanted < 1 || wanted > 1000000) {
        fprintf(stderr, "usage: bake_points SCENE COUNT (up to a million)\n");
        return 2;
    }
    vplContextDef def = vplDefaultContextDef();
    def.log = vplLogToStderr;
    vplContext* context = NULL;
    vplScene* scene = NULL;
    vplSurfacePoint* points = malloc((size_t)wanted * sizeof *points);
    vplRgb* light = malloc((size_t)wanted * sizeof *light);
    const bool done = points != NULL && light != NULL && vplContext_Create(&def, &context) == VPL_SUCCESS &&
                      vplScene_Load(context, words[1], &scene) == VPL_SUCCESS &&
                      bake(scene, wanted, points, light) == VPL_SUCCESS;
    vplScene_Destroy(scene);
    vplContext_Destroy(context);
    free(points);
    free(light);
    return done ? 0 : 1;
}
