// SPDX-License-Identifier: MIT
// The environment of a scene: a copy of what was declared, and for a sky its picture and its sun.
#include <vpl/imagetools.h>

#include "math/scalar.h"
#include "math/vec.h"
#include "scene/scene.h"
#include "scene/sky.h"

#include <string.h>

enum { COOKIE = 0x56504c3a, SKY_WIDTH = 256, SKY_HEIGHT = 128 };

vplEnvironmentDef vplDefaultEnvironmentDef(void)
{
    return (vplEnvironmentDef){
        .radiance = {1, 1, 1}, .scale = 1, .elevation = VPL_PI / 4, .turbidity = 3, .cookie = COOKIE};
}

const vplEnvironmentDef* vplScene_GetEnvironment(const vplScene* scene)
{
    if (scene == NULL) {
        return NULL;
    }
    return &scene->environment;
}

int vplScene_GetSun(const vplScene* scene)
{
    if (scene == NULL) {
        return -1;
    }
    return scene->sun - 1;
}

// Indices of other emitters stay as they are.
static void removeSun(vplScene* scene)
{
    if (scene->sun > 0 && scene->sun == scene->emitterCount) {
        scene->emitterCount--;
    } else if (scene->sun > 0) {
        scene->emitters[scene->sun - 1].def.intensity = (vplRgb){0, 0, 0};
    }
    scene->sun = 0;
}

static float scaled(double scale, float value)
{
    const double product = scale * (double)value;
    return product < (double)VPL_MAX_MAGNITUDE ? (float)product : VPL_MAX_MAGNITUDE;
}

// The sun that the scene had before is moved. Fails before anything is changed.
static vplResult placeSun(vplScene* scene, const vplSky* sky, const vplEnvironmentDef* def)
{
    const vplRgb full = vplSky_SunIrradiance(sky);
    vplEmitterDef sun = vplDefaultEmitterDef();
    double sine, cosine;
    int index = scene->sun - 1;
    vplSinCos(def->rotate, &sine, &cosine);
    sun.type = VPL_EMITTER_DIRECTIONAL;
    sun.direction = vplVec((float)(-sky->sunDirection[0] * cosine), (float)-sky->sunDirection[1],
                           (float)(sky->sunDirection[0] * sine));
    sun.intensity =
        (vplRgb){scaled(def->scale, full.r), scaled(def->scale, full.g), scaled(def->scale, full.b)};
    if (index >= 0) {
        scene->emitters[index].def = sun;
        return VPL_SUCCESS;
    }
    TRY(vplScene_AddEmitter(scene, &sun, &index));
    scene->sun = index + 1;
    return VPL_SUCCESS;
}

// Values between questions whether to go on: a few milliseconds.
enum { ASK_EVERY = 1 << 20 };

static vplResult copyValues(vplContext* context, const float* from, size_t count, float* to)
{
    for (size_t i = 0; i < count; i += ASK_EVERY) {
        const size_t some = count - i < ASK_EVERY ? count - i : ASK_EVERY;
        memcpy(to + i, from + i, some * sizeof *to);
        TRY(vplAsk(context));
    }
    return VPL_SUCCESS;
}

// Makes the picture that the copy of a def refers to.
static vplResult copyPicture(vplScene* scene, const vplSky* sky, vplEnvironmentDef* copy, float** pixelsOut)
{
    *pixelsOut = NULL;
    const bool isSky = copy->type == VPL_ENVIRONMENT_SKY;
    if (copy->type != VPL_ENVIRONMENT_PICTURE && !isSky) {
        copy->pixels = NULL;
        copy->width = copy->height = 0;
        return VPL_SUCCESS;
    }
    copy->width = isSky ? SKY_WIDTH : copy->width;
    copy->height = isSky ? SKY_HEIGHT : copy->height;
    const size_t values = 3 * (size_t)copy->width * (size_t)copy->height;
    float* pixels = vplArena_Alloc(scene->arena, values, sizeof *pixels);
    if (pixels == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    if (isSky) {
        vplSky_Paint(sky, copy->width, copy->height, pixels);
    } else {
        const vplResult result = copyValues(scene->context, copy->pixels, values, pixels);
        if (result != VPL_SUCCESS) {
            vplArena_Free(scene->arena, pixels);
            return result;
        }
    }
    copy->pixels = *pixelsOut = pixels;
    return VPL_SUCCESS;
}

vplResult vplScene_SetEnvironment(vplScene* scene, const vplEnvironmentDef* def)
{
    REQUIRE(CONTEXT_OF(scene), scene, def);
    if (def->cookie != COOKIE) {
        return vplFail(scene->context, VPL_INVALID_ARGUMENT,
                       "vplEnvironmentDef was not made by its default function");
    }
    TRY(vplScene_ReportFault(scene, "vplEnvironmentDef.", vplCheckEnvironment(def)));
    const vplSky sky = vplSky_Make(def->elevation, def->turbidity);
    vplEnvironmentDef copy = *def;
    float* pixels;
    TRY(copyPicture(scene, &sky, &copy, &pixels));
    if (copy.type == VPL_ENVIRONMENT_SKY && placeSun(scene, &sky, &copy) != VPL_SUCCESS) {
        vplArena_Free(scene->arena, pixels);
        return VPL_OUT_OF_MEMORY;
    }
    if (copy.type != VPL_ENVIRONMENT_SKY) {
        removeSun(scene);
    }
    vplArena_Free(scene->arena, scene->environmentPixels);
    scene->environmentPixels = pixels;
    scene->environment = copy;
    vplScene_Touch(scene, true);
    scene->environmentStamp = scene->stamp;
    return VPL_SUCCESS;
}

// Replaces values that no light has by 0.
static vplResult repair(const vplScene* scene, const char* path, vplImage* image)
{
    const size_t values = 3 * (size_t)image->width * (size_t)image->height;
    size_t wrong = 0;
    for (size_t i = 0; i < values; i++) {
        const float value = image->pixels[i];
        if (!(value >= 0 && value <= VPL_MAX_MAGNITUDE)) {
            image->pixels[i] = 0;
            wrong++;
        }
        TRY(i % ASK_EVERY == ASK_EVERY - 1 ? vplAsk(scene->context) : VPL_SUCCESS);
    }
    if (wrong > 0) {
        vplLog(scene->context, VPL_LOG_WARNING,
               "%s: %zu values are negative, not finite or above %g; they count as 0", path, wrong,
               (double)VPL_MAX_MAGNITUDE);
    }
    return VPL_SUCCESS;
}

vplResult vplScene_LoadEnvironment(vplScene* scene, const char* path, const vplEnvironmentDef* def)
{
    REQUIRE(CONTEXT_OF(scene), scene, path, def);
    vplImage* image;
    vplEnvironmentDef read = *def;
    TRY(vplImage_Read(scene->context, path, &image));
    vplResult result = repair(scene, path, image);
    read.type = VPL_ENVIRONMENT_PICTURE;
    read.pixels = image->pixels;
    read.width = image->width;
    read.height = image->height;
    result = result == VPL_SUCCESS ? vplScene_SetEnvironment(scene, &read) : result;
    vplImage_Destroy(image);
    return result;
}
