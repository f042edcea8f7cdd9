// SPDX-License-Identifier: MIT
// Layers of a render: its picture, the two parts of its light, and what denoisers and compositors want to
// know of the surfaces that it shows. Surfaces are drawn once for each layer and sample of the pixels, which
// costs little beside light.
#include "base/clock.h"
#include "math/sampling.h"
#include "math/scalar.h"
#include "render/stages/make.h"
#include "render/stages/results.h"

#include <string.h>

enum { PICTURE, DIRECT, INDIRECT, FIRST_GUIDE, DEPTH = 5, OBJECT = 6 }; // places in the table below

// Denoisers expect albedo and normals to be antialiased like the picture: albedo in [0, 1], normals of any
// length. Depths and indices have no mean.
// Source: Open Image Denoise, documentation, "Albedo" and "Normal". Z is the name of depth in OpenEXR's
// Technical Introduction.
static const struct {
    const char* name;
    vplLayerKind kind;
    vplShadeOutput output;
    bool mean; // over the samples of a pixel
} LAYERS[VPL_MAX_LAYERS] = {
    {.name = "", .kind = VPL_LAYER_COLOUR},
    {.name = "direct", .kind = VPL_LAYER_COLOUR},
    {.name = "indirect", .kind = VPL_LAYER_COLOUR},
    {.name = "albedo", .kind = VPL_LAYER_COLOUR, .output = VPL_OUTPUT_ALBEDO, .mean = true},
    {.name = "normal", .kind = VPL_LAYER_VECTOR, .output = VPL_OUTPUT_NORMALS, .mean = true},
    {.name = "Z", .kind = VPL_LAYER_NUMBER, .output = VPL_OUTPUT_DEPTH},
    {.name = "object.id", .kind = VPL_LAYER_INDEX, .output = VPL_OUTPUT_OBJECT},
};

static bool isWanted(const vplRun* run, int layer)
{
    return layer == PICTURE || (run->plan->options.output.aovs & 1 << (layer - 1)) != 0;
}

// ---- light

// Splits the picture into direct light, which is at most all of it, and the rest. Where light is not split,
// all is direct.
static vplResult addLight(const vplRun* run, vplImage** images)
{
    const vplImage* picture = images[PICTURE];
    if (!isWanted(run, DIRECT) && !isWanted(run, INDIRECT)) {
        return VPL_SUCCESS;
    }
    if (images[DIRECT] == NULL) {
        TRY(vplImage_Create(run->context, picture->width, picture->height, &images[DIRECT]));
        memcpy(images[DIRECT]->pixels, picture->pixels, vplValueCount(picture) * sizeof *picture->pixels);
    }
    if (isWanted(run, INDIRECT)) {
        TRY(vplImage_Create(run->context, picture->width, picture->height, &images[INDIRECT]));
    }
    for (size_t k = 0; k < vplValueCount(picture); k++) {
        float* direct = &images[DIRECT]->pixels[k];
        *direct = vplMinf(*direct, picture->pixels[k]);
        if (images[INDIRECT] != NULL) {
            images[INDIRECT]->pixels[k] = picture->pixels[k] - *direct;
        }
    }
    return VPL_SUCCESS;
}

// ---- surfaces

// The path tracer samples all of a pixel, so that its edges are as smooth as those of the most samples.
int vplCountLayerSamples(const vplPlan* plan)
{
    const vplRenderOptions* o = &plan->options;
    if (o->method == VPL_METHOD_PATH) {
        return o->path.pixel == VPL_PIXEL_AREA ? VPL_MAX_SAMPLES_PER_PIXEL + 1 : 1;
    }
    return o->output.supersample > 1 ? o->output.supersample : vplCountPoints(plan);
}

static vplResult drawMean(const vplRun* run, const vplShadeDef* def, int count, vplImage* image)
{
    const vplGeometry* g = run->results[VPL_STAGE_GEOMETRY];
    vplImage* sample = NULL;
    vplResult result = vplImage_Create(run->context, image->width, image->height, &sample);
    for (int i = 0; i < count && result == VPL_SUCCESS; i++) {
        double x, y;
        vplPixelPoint(i, count, &x, &y);
        const vplView view = vplView_At(&run->plan->view, x, y);
        result = vplShadeView(g, &view, def, sample, NULL);
        for (size_t k = 0; k < vplValueCount(image) && result == VPL_SUCCESS; k++) {
            image->pixels[k] += sample->pixels[k];
        }
    }
    for (size_t k = 0; k < vplValueCount(image); k++) {
        image->pixels[k] /= (float)count;
    }
    vplImage_Destroy(sample);
    return result;
}

static vplResult drawSurfaces(const vplRun* run, int layer, vplImage** imageOut)
{
    const vplPlan* plan = run->plan;
    const vplGeometry* g = run->results[VPL_STAGE_GEOMETRY];
    vplShadeDef def = vplDefaultShadeDef();
    def.lighting = plan->shading;
    def.output = LAYERS[layer].output;
    def.emission = true;
    const int count = LAYERS[layer].mean ? vplCountLayerSamples(plan) : 1;
    if (layer == OBJECT && g->objectCount > VPL_MAX_LAYER_INDEX) {
        return vplFail(run->context, VPL_LIMIT, "the scene has %d objects, a layer can number %d",
                       g->objectCount, VPL_MAX_LAYER_INDEX);
    }
    TRY(vplImage_Create(run->context, plan->options.output.width, plan->options.output.height, imageOut));
    TRY(count > 1 ? drawMean(run, &def, count, *imageOut)
                  : vplShadeView(g, &plan->view, &def, *imageOut, NULL));
    for (size_t k = 0; k < vplValueCount(*imageOut) && layer == DEPTH; k++) {
        float* depth = &(*imageOut)->pixels[k];
        *depth = *depth > 0 ? *depth : VPL_NO_DEPTH;
    }
    return VPL_SUCCESS;
}

// Lists the names of the scene's objects, if any has one.
static vplResult nameObjects(const vplRun* run, vplLayers* layers, vplLayer* layer)
{
    const int count = vplScene_GetObjectCount(run->scene);
    bool named = false;
    for (int i = 0; i < count; i++) {
        named = named || vplScene_GetObject(run->scene, i)->name != NULL;
    }
    if (!named) {
        return VPL_SUCCESS;
    }
    layers->objectNames = vplAlloc(run->context, (size_t)count, sizeof *layers->objectNames);
    if (layers->objectNames == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    for (int i = 0; i < count; i++) {
        const char* name = vplScene_GetObject(run->scene, i)->name;
        layers->objectNames[i] = name != NULL ? name : "";
    }
    layer->names = layers->objectNames;
    layer->nameCount = count;
    return VPL_SUCCESS;
}

// ---- all

static vplResult addLayers(const vplRun* run, vplLayers* layers)
{
    TRY(addLight(run, layers->images));
    for (int i = 0; i < VPL_MAX_LAYERS; i++) {
        if (!isWanted(run, i)) {
            continue;
        }
        if (i >= FIRST_GUIDE) {
            TRY(drawSurfaces(run, i, &layers->images[i]));
        }
        vplLayer* layer = &layers->layers[layers->count++];
        *layer = (vplLayer){.name = LAYERS[i].name, .kind = LAYERS[i].kind, .image = layers->images[i]};
        TRY(i == OBJECT ? nameObjects(run, layers, layer) : VPL_SUCCESS);
    }
    return VPL_SUCCESS;
}

vplResult vplMakeLayers(const vplRun* run, vplImage* picture, vplImage* direct, vplLayers** layersOut)
{
    const double start = vplClockMs();
    vplLayers* layers = vplAllocZero(run->context, 1, sizeof *layers);
    if (layers == NULL) {
        vplImage_Destroy(picture);
        vplImage_Destroy(direct);
        return VPL_OUT_OF_MEMORY;
    }
    layers->context = run->context;
    layers->images[PICTURE] = picture;
    layers->images[DIRECT] = direct;
    const vplResult result = addLayers(run, layers);
    if (result != VPL_SUCCESS) {
        vplLayers_Destroy(layers);
        return result;
    }
    vplRun_AddTime(run, "layers", start);
    *layersOut = layers;
    return VPL_SUCCESS;
}

void vplLayers_Destroy(vplLayers* layers)
{
    if (layers != NULL) {
        for (int i = 0; i < VPL_MAX_LAYERS; i++) {
            vplImage_Destroy(layers->images[i]);
        }
        vplFree(layers->context, layers->objectNames);
        vplFree(layers->context, layers);
    }
}
