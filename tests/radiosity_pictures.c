// SPDX-License-Identifier: MIT
#include "radiosity_pictures.h"

vplScene* boxRoom(vplContext* context, float rho, bool areaLight)
{
    vplScene* scene = closedCubeScene(context, rho, 0);
    addThing(scene, VPL_OBJECT_BOX, 0, vplVec(0.25f, -0.7f, -0.2f), 0, 0.5, vplVec(0.5f, 0.6f, 0.5f));
    aim(scene, vplVec(0.1f, -0.2f, 0.9f), vplVec(0, -0.3f, -1));
    if (areaLight) {
        addThing(scene, VPL_OBJECT_QUAD, addMaterial(scene, (vplRgb){0, 0, 0}, 5), vplVec(0, 0.99f, 0),
                 VPL_PI / 2, 0, vplVec(0.5f, 0.5f, 1));
    } else {
        addEmitter(scene, VPL_EMITTER_POINT, vplVec(-0.3f, 0.6f, 0.2f), vplVec(0, -1, 0), 3);
    }
    return scene;
}

vplRenderOptions radiosityOptions(int patches)
{
    vplRenderOptions o = plainOptions();
    o.method = VPL_METHOD_RADIOSITY;
    o.output.width = 40;
    o.output.height = 30;
    o.radiosity.patches = patches;
    return o;
}

vplImage* showOf(const vplScene* scene, vplRenderOptions o, vplShow show)
{
    o.output.show = show;
    return renderScene(scene, &o, NULL);
}

double meanOf(const vplImage* image)
{
    double sum = 0;
    for (int i = 0; i < 3 * image->width * image->height; i++) {
        sum += (double)image->pixels[i];
    }
    return sum / (3 * image->width * image->height);
}

vplImage* pathsOf(const vplScene* scene, vplShow show, int spp)
{
    vplRenderOptions o = radiosityOptions(1);
    o.method = VPL_METHOD_PATH;
    o.path.pixel = VPL_PIXEL_CENTRE;
    o.path.samples = spp;
    return showOf(scene, o, show);
}

vplComparison compare(const vplImage* a, const vplImage* b)
{
    vplComparison c;
    assert_int_equal(vplImage_Compare(a, b, &c), VPL_SUCCESS);
    return c;
}

double commonError(const vplImage* image, vplImage* const truth[2])
{
    double sum = 0;
    const int count = 3 * image->width * image->height;
    for (int i = 0; i < count; i++) {
        const double a = (double)truth[0]->pixels[i], b = (double)truth[1]->pixels[i],
                     x = (double)image->pixels[i];
        sum += (x - a) * (x - b) / ((0.5 * (a + b) + 0.01) * (0.5 * (a + b) + 0.01));
    }
    return sum / count;
}
