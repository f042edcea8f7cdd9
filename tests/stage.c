// SPDX-License-Identifier: MIT
#include "stage.h"

#include "math/vec.h"

#include <stdlib.h>

vplGeometry* stage(vplContext* context)
{
    vplScene* scene = sceneOf(context, 0.5f);
    const vplVec3 places[3] = {{0, 0, 0}, {0.7f, 0.5f, 0.3f}, {0, 1, -2}},
                  sizes[3] = {{4, 4, 1}, {1, 1, 1}, {4, 2, 1}};
    for (int i = 0; i < 3; i++) {
        vplObjectDef object = vplDefaultObjectDef();
        const double rotate[3] = {i < 2 ? -VPL_PI / 2 : 0, 0, 0};
        object.transform = vplMat4_FromParts(places[i], rotate, sizes[i]);
        assert_int_equal(vplScene_AddObject(scene, &object, NULL), VPL_SUCCESS);
    }
    return buildGeometry(scene);
}

vplView stageView(vplVec3 eye, int width, int height)
{
    vplCameraDef camera = vplDefaultCameraDef();
    camera.eye = eye;
    camera.target = vplVec(0, 0.2f, 0);
    return vplView_Create(&camera, width, height);
}

vplShadeLight* rollLights(int count, uint64_t seed)
{
    Dice dice = {seed, 0};
    vplShadeLight* lights = malloc((size_t)count * sizeof *lights);
    for (int i = 0; i < count; i++) {
        const vplVec3 p = rollVec(&dice, 2);
        lights[i] = (vplShadeLight){
            p.x, 3 + 0.5f * p.y, p.z, 0, -1, 0, roll(&dice, 0, 1), roll(&dice, 0, 1), roll(&dice, 0, 1)};
    }
    return lights;
}

vplShadeDef stageDef(const vplShadeLight* lights, int count, int side)
{
    vplShadeDef def = vplDefaultShadeDef();
    def.minDistance = 0.3f;
    def.accumulation = side > 0 ? VPL_ACCUMULATE_INTERLEAVED : VPL_ACCUMULATE_DEFERRED;
    def.interleave = side;
    def.lights = lights;
    def.lightCount = count;
    return def;
}

vplImage* shadeStage(const vplGeometry* g, const vplView* view, const vplShadeDef* def)
{
    vplImage* image;
    assert_int_equal(vplImage_Create(g->context, view->width, view->height, &image), VPL_SUCCESS);
    assert_int_equal(vplShadeView(g, view, def, image, NULL), VPL_SUCCESS);
    return image;
}

PixelSample* samplePixels(const vplGeometry* g, const vplView* view)
{
    vplShadeDef def = stageDef(NULL, 0, 0);
    def.output = VPL_OUTPUT_DEPTH;
    vplImage* depth = shadeStage(g, view, &def);
    def.output = VPL_OUTPUT_NORMALS;
    vplImage* normals = shadeStage(g, view, &def);
    PixelSample* samples = malloc((size_t)(view->width * view->height) * sizeof *samples);
    for (int i = 0; i < view->width * view->height; i++) {
        const double x = ((i % view->width + 0.5) / view->width * 2 - 1) / view->scaleX;
        const double y = (1 - (i / view->width + 0.5) / view->height * 2) / view->scaleY;
        for (int k = 0; k < 3; k++) {
            const double f = (double)vplComponent(view->forward, k), r = (double)vplComponent(view->right, k),
                         u = (double)vplComponent(view->up, k);
            samples[i].w = (double)depth->pixels[3 * i];
            samples[i].p[k] = samples[i].w * (f + x * r + y * u);
            samples[i].n[k] = (double)normals->pixels[3 * i + k];
        }
    }
    vplImage_Destroy(depth);
    vplImage_Destroy(normals);
    return samples;
}
