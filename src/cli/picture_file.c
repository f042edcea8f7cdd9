// SPDX-License-Identifier: MIT
// Files of pictures: their names, their exposure and tone map, and how they are written.
#include "cli/cli.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

static bool endsWith(const char* path, const char* extension)
{
    const size_t n = strlen(path), m = strlen(extension);
    return n >= m && strcasecmp(path + n - m, extension) == 0;
}

bool checkPictureName(const Arguments* a)
{
    const bool layers = a->render.output.aovs != 0;
    if (!vplImage_CanWrite(a->output)) {
        complain("%s: unknown picture format; the name must end in %s", a->output, vplImage_GetExtensions());
        return false;
    }
    if (layers && !endsWith(a->output, ".exr")) {
        complain("%s: --aov writes layers into .exr files only", a->output);
        return false;
    }
    if (isStdout(a->output) && (a->frames[1] >= 0 || layers)) {
        complain("-o %s: standard output takes one picture without layers", a->output);
        return false;
    }
    return true;
}

// ---- exposure and tone map

static bool isMetres(vplShow show)
{
    return show == VPL_SHOW_DEPTH || show == VPL_SHOW_SHADOW_MAP;
}

// Exposure and tone map are not for these.
static bool isNoLight(vplShow show)
{
    return isMetres(show) || show == VPL_SHOW_NORMALS || show == VPL_SHOW_SHADOW_FACTOR;
}

// Pictures of light alone, without marks or outlines. They are exposed and tone mapped by default.
static bool isLight(vplShow show)
{
    return show == VPL_SHOW_PICTURE || show == VPL_SHOW_DIRECT || show == VPL_SHOW_INDIRECT ||
           show == VPL_SHOW_LIGHT || show == VPL_SHOW_BOUNCE || show == VPL_SHOW_GATHER ||
           show == VPL_SHOW_DENOISED || show == VPL_SHOW_PATCH_RADIOSITY;
}

vplWriteOptions chooseDisplay(const Arguments* a)
{
    const vplShow show = a->render.output.show;
    vplWriteOptions display = vplDefaultWriteOptions();
    if (isNoLight(show)) {
        return display;
    }
    if (a->tonemap > 0) {
        display.tonemap = (vplToneMap)(a->tonemap - 1);
    } else if (isLight(show)) {
        const bool reinhard = a->render.preset == VPL_PRESET_SSVP_2020; // as its document has it
        display.tonemap = reinhard ? VPL_TONEMAP_REINHARD : VPL_TONEMAP_AGX;
    }
    if (isLight(show) || isGiven(a, "exposure")) {
        display.exposure = (float)a->exposure;
    }
    if (display.exposure == VPL_EXPOSURE_AUTO && display.tonemap == VPL_TONEMAP_REINHARD) {
        display.exposure = 0;
    }
    return display;
}

void warnOfDisplay(const Arguments* a)
{
    static const char* const NAMES[] = {"exposure", "tonemap"};
    for (int i = 0; i < 2 && !a->quiet; i++) {
        if (!isGiven(a, NAMES[i])) {
            continue;
        }
        if (!endsWith(a->output, ".png")) {
            complain("warning: --%s has no effect on %s, which holds linear values", NAMES[i], a->output);
        } else if (isNoLight(a->render.output.show)) {
            complain("warning: --%s has no effect with a --show that is not light", NAMES[i]);
        } else if (i == 0 && a->tonemap == 1 + VPL_TONEMAP_REINHARD) {
            complain("warning: --exposure has no effect with --tonemap reinhard, which has its own key");
        }
    }
}

// ---- writing

static bool isEmpty(const float* pixel)
{
    return pixel[0] == 0 && pixel[1] == 0 && pixel[2] == 0;
}

// Makes metres and normals visible in a PNG: the nearest is white, the farthest is dark; normals are (n + 1)
// / 2.
static void prepareForEyes(vplImage* image, vplShow show)
{
    size_t count = 3 * (size_t)image->width * (size_t)image->height;
    float smallest = INFINITY, largest = 0;
    for (size_t i = 0; i < count; i += 3) {
        if (!isEmpty(image->pixels + i)) {
            largest = fmaxf(largest, image->pixels[i]);
            smallest = fminf(smallest, image->pixels[i]);
        }
    }
    float scale = largest > smallest ? 0.9f / (largest - smallest) : 0;
    for (size_t i = 0; i < count; i += 3) {
        float* p = image->pixels + i;
        bool empty = isEmpty(p);
        for (int c = 0; c < 3 && !empty; c++) {
            float code = show == VPL_SHOW_NORMALS ? 0.5f * p[c] + 0.5f : 1 - scale * (p[c] - smallest);
            p[c] = vplSrgb_Decode(code);
        }
    }
}

static int writeToStdout(const vplImage* image, const char* path, const vplWriteOptions* display)
{
    uint8_t* bytes;
    size_t size;
    const int code = exitCode(vplImage_Encode(image, path, display, &bytes, &size), false);
    if (code == EXIT_DONE) {
        fwrite(bytes, 1, size, stdout); // finishOutput reports what fails
        vplBytes_Free(image->context, bytes);
    }
    return code;
}

int preparePicture(const Arguments* a, vplImage* image, const char* path, vplWriteOptions* display)
{
    const vplShow show = a->render.output.show;
    const bool png = endsWith(path, ".png");
    if (png && (isMetres(show) || show == VPL_SHOW_NORMALS)) {
        prepareForEyes(image, show);
    }
    if (png && display->exposure == VPL_EXPOSURE_AUTO) {
        const int code = exitCode(vplImage_AutoExposure(image, &display->exposure), false);
        if (code != EXIT_DONE) {
            return code;
        }
    }
    if (png && a->verbose && !isNoLight(show)) {
        const bool automatic = chooseDisplay(a).exposure == VPL_EXPOSURE_AUTO;
        complain("exposure %+.2f stops%s", (double)display->exposure, automatic ? " (auto)" : "");
    }
    return EXIT_DONE;
}

int writePicture(const Arguments* a, vplImage* image, const char* path, vplWriteOptions* display)
{
    const int code = preparePicture(a, image, path, display);
    if (code != EXIT_DONE) {
        return code;
    }
    return isStdout(path) ? writeToStdout(image, path, display)
                          : exitCode(vplImage_Write(image, path, display), false);
}

int writeWholePicture(const Arguments* a, vplImage* image)
{
    vplWriteOptions display = chooseDisplay(a);
    warnOfDisplay(a);
    return writePicture(a, image, a->output, &display);
}

int writeLayers(const vplLayers* layers, const char* path)
{
    return exitCode(vplImage_WriteLayers(layers->layers, layers->count, path), false);
}
