// SPDX-License-Identifier: MIT
// Measures flicker in a sequence of pictures, once with a moving camera and once with a slowly moving light,
// with temporal coherence on and off: the mean change of pixels from frame to frame, and the part of it that
// is not linear in time.
// `bench/flicker SCENE [METHOD [FRAMES [WIDTH HEIGHT]]]`; the program gives the camera and the first light a
// path of its own: over 60 frames a twentieth of the scene's diagonal, or 6 degrees. METHOD: ssvp,
// instant-radiosity or keller; instant-radiosity and keller are coherent if all frames use one seed.
//   change   mean |I(t+1) - I(t)| / mean I
//   flicker  mean |I(t+1) - 2 I(t) + I(t-1)| / 2 / mean I: 0 where light changes linearly
// Both are measured on linear pictures and on each frame tone-mapped with Reinhard's operator. A surface
// point is reprojected into the other frames; only points in the interior of the same surface in all three
// frames count.
#include "bench.h"

#include <math.h>
#include <string.h>

enum { MAX_FRAMES = 1000 };
static const double SAME_DEPTH = 0.02, SAME_NORMAL = 0.98; // for pixels of one surface

typedef struct Frame {
    vplView view;
    vplImage *depth, *normals, *light, *shown;
} Frame;

typedef struct Bench {
    vplContext* context;
    vplScene* scene;
    vplRenderOptions options;
    int count;
    Frame frames[MAX_FRAMES];
} Bench;

// ---- paths

static double diagonalOf(const vplScene* scene)
{
    vplGeometry* geometry;
    check(vplGeometry_Create(scene, &geometry));
    const double diagonal = (double)vplLength(vplSub(geometry->boundsMax, geometry->boundsMin));
    vplGeometry_Destroy(geometry);
    return diagonal;
}

static void moveCamera(vplScene* scene, double diagonal)
{
    const vplCameraDef* def = vplScene_GetCamera(scene, 0);
    const vplView view = vplView_Create(def, 16, 9);
    vplCameraKey keys[] = {vplMakeCameraKey(def, 0), vplMakeCameraKey(def, 60)};
    keys[1].eye = vplAdd(def->eye, vplScale((float)(0.05 * diagonal), view.right));
    keys[1].target = vplAdd(def->target, vplScale((float)(0.025 * diagonal), view.right));
    check(vplScene_SetCameraPath(scene, 0, keys, 2));
    check(vplScene_SetEmitterPath(scene, 0, NULL, 0));
}

static void moveLight(vplScene* scene, double diagonal)
{
    const vplEmitterDef* def = vplScene_GetEmitter(scene, 0);
    vplEmitterKey keys[] = {vplMakeEmitterKey(def, 0), vplMakeEmitterKey(def, 60)};
    vplVec3 across, other;
    vplTangentFrame(vplNormalize(def->direction), &across, &other);
    if (def->type == VPL_EMITTER_DIRECTIONAL) {
        keys[1].direction = vplAdd(vplNormalize(def->direction), vplScale(0.105f, across));
    } else {
        keys[1].position = vplAdd(def->position, vplScale((float)(0.05 * diagonal), across));
    }
    check(vplScene_SetCameraPath(scene, 0, NULL, 0));
    check(vplScene_SetEmitterPath(scene, 0, keys, 2));
}

// ---- frames

static vplImage* show(const Bench* b, const vplRenderOptions* from, vplShow what)
{
    vplRenderOptions o = *from;
    vplImage* image;
    o.method = VPL_METHOD_DIRECT;
    o.output.show = what;
    check(vplRender(b->scene, &o, &image, NULL));
    return image;
}

static void renderFrames(Bench* b, bool coherent)
{
    vplRenderOptions o = b->options;
    check(vplHistory_Create(b->context, &o.sequence.history));
    for (int t = 0; t < b->count; t++) {
        Frame* frame = &b->frames[t];
        vplCameraDef camera;
        o.sequence.frame = t;
        o.sequence.coherence = coherent ? VPL_COHERENCE_ON : VPL_COHERENCE_OFF;
        o.seed = coherent || o.method == VPL_METHOD_SSVP ? 1 : 1 + (uint64_t)t;
        check(vplScene_PoseCamera(b->scene, 0, t, &camera));
        frame->view = vplView_Create(&camera, o.output.width, o.output.height);
        frame->depth = show(b, &o, VPL_SHOW_DEPTH);
        frame->normals = show(b, &o, VPL_SHOW_NORMALS);
        check(vplRender(b->scene, &o, &frame->light, NULL));
        check(vplImage_Create(b->context, o.output.width, o.output.height, &frame->shown));
        memcpy(frame->shown->pixels, frame->light->pixels,
               3 * sizeof(float) * (size_t)o.output.width * (size_t)o.output.height);
        const vplReinhardDef reinhard = vplDefaultReinhardDef();
        check(vplToneMap_Reinhard(frame->shown, &reinhard));
    }
    vplHistory_Destroy(o.sequence.history);
}

static void freeFrames(Bench* b)
{
    for (int t = 0; t < b->count; t++) {
        vplImage_Destroy(b->frames[t].depth);
        vplImage_Destroy(b->frames[t].normals);
        vplImage_Destroy(b->frames[t].light);
        vplImage_Destroy(b->frames[t].shown);
    }
}

// ---- the same point in another frame

static const float* pixelOf(const vplImage* image, int x, int y)
{
    return image->pixels + 3 * ((size_t)y * (size_t)image->width + (size_t)x);
}

// The four pixels around a point and their bilinear weights.
typedef struct Place {
    int x[4], y[4];
    float weight[4];
} Place;

// Reprojects a point into a frame. Returns false if it leaves the picture, is hidden or lies at an edge.
static bool findPlace(const Frame* frame, vplVec3 point, const float* normal, Place* place)
{
    float fx, fy;
    if (!vplView_Project(&frame->view, point, &fx, &fy)) {
        return false;
    }
    const double depth = (double)vplDot(vplSub(point, frame->view.eye), frame->view.forward);
    // Rounding moves points by up to a thousandth of a pixel.
    const double cx = floor((double)fx - 0.5 + 1e-3), cy = floor((double)fy - 0.5 + 1e-3);
    const float sx = (float)fmax(0, (double)fx - 0.5 - cx), sy = (float)fmax(0, (double)fy - 0.5 - cy);
    for (int k = 0; k < 4; k++) {
        place->weight[k] = (k % 2 ? sx : 1 - sx) * (k / 2 ? sy : 1 - sy);
        const double x = cx + k % 2, y = cy + k / 2;
        const bool counts = place->weight[k] > 2e-3f;
        if (!(x >= 0 && y >= 0 && x < frame->view.width && y < frame->view.height)) {
            if (counts) {
                return false;
            }
            place->weight[k] = 0;
            place->x[k] = place->y[k] = 0;
            continue;
        }
        place->x[k] = (int)x;
        place->y[k] = (int)y;
        const float* n = pixelOf(frame->normals, (int)x, (int)y);
        const double there = (double)pixelOf(frame->depth, (int)x, (int)y)[0];
        const double along = (double)(n[0] * normal[0] + n[1] * normal[1] + n[2] * normal[2]);
        if (counts && !(fabs(there - depth) < SAME_DEPTH * depth && along > SAME_NORMAL)) {
            return false;
        }
    }
    return true;
}

static void lookUp(const vplImage* image, const Place* place, double colour[3])
{
    colour[0] = colour[1] = colour[2] = 0;
    for (int k = 0; k < 4; k++) {
        const float* p = pixelOf(image, place->x[k], place->y[k]);
        for (int c = 0; c < 3; c++) {
            colour[c] += (double)place->weight[k] * (double)p[c];
        }
    }
}

// ---- sums

typedef struct Sums {
    double light, change, flicker;
} Sums;

static void addPixel(Sums* s, const float* now, const double before[3], const double after[3])
{
    for (int c = 0; c < 3; c++) {
        s->light += (double)now[c];
        s->change += fabs(after[c] - (double)now[c]);
        s->flicker += 0.5 * fabs(after[c] - 2 * (double)now[c] + before[c]);
    }
}

// Measures frame t against its two neighbours. Returns how many of its pixels count.
static int64_t measure(const Bench* b, int t, Sums* linear, Sums* mapped)
{
    const Frame *before = &b->frames[t - 1], *now = &b->frames[t], *after = &b->frames[t + 1];
    int64_t counted = 0;
    for (int y = 0; y < now->view.height; y++) {
        for (int x = 0; x < now->view.width; x++) {
            const float depth = pixelOf(now->depth, x, y)[0];
            const float* normal = pixelOf(now->normals, x, y);
            const vplVec3 point = vplAdd(now->view.eye, vplScale(depth, rayThrough(&now->view, x, y)));
            Place past, future;
            if (!(depth > 0) || !findPlace(before, point, normal, &past) ||
                !findPlace(after, point, normal, &future)) {
                continue;
            }
            double one[3], two[3];
            lookUp(before->light, &past, one);
            lookUp(after->light, &future, two);
            addPixel(linear, pixelOf(now->light, x, y), one, two);
            lookUp(before->shown, &past, one);
            lookUp(after->shown, &future, two);
            addPixel(mapped, pixelOf(now->shown, x, y), one, two);
            counted++;
        }
    }
    return counted;
}

static void measureAll(Bench* b, const char* path, const char* what, bool coherent)
{
    Sums linear = {0, 0, 0}, mapped = {0, 0, 0};
    int64_t counted = 0;
    renderFrames(b, coherent);
    for (int t = 1; t + 1 < b->count; t++) {
        counted += measure(b, t, &linear, &mapped);
    }
    const double pixels = (double)b->options.output.width * b->options.output.height * (b->count - 2);
    printf("%-7s %-9s %-9s %8.3f %8.3f %12.3f %8.3f %11.0f %%\n", path, what, coherent ? "on" : "off",
           100 * linear.change / linear.light, 100 * linear.flicker / linear.light,
           100 * mapped.change / mapped.light, 100 * mapped.flicker / mapped.light,
           100 * (double)counted / pixels);
    fflush(stdout);
    freeFrames(b);
}

static vplMethod readMethod(const char* name)
{
    return strcmp(name, "keller") == 0 ? VPL_METHOD_KELLER
           : strcmp(name, "ssvp") == 0 ? VPL_METHOD_SSVP
                                       : VPL_METHOD_INSTANT_RADIOSITY;
}

int main(int count, char** words)
{
    static Bench b;
    if (count < 2) {
        fprintf(stderr, "usage: flicker SCENE [METHOD [FRAMES [WIDTH HEIGHT]]]\n");
        return 2;
    }
    openScene(words[1], 0, VPL_ISA_AUTO, &b.context, &b.scene);
    b.options = plainOptions();
    b.options.method = count > 2 ? readMethod(words[2]) : VPL_METHOD_INSTANT_RADIOSITY;
    b.options.particles.count = 256;
    b.options.output.width = count > 5 ? atoi(words[4]) : 320;
    b.options.output.height = count > 5 ? atoi(words[5]) : 180;
    b.options.shadow.mapSize = 256;
    b.options.particles.sampler = VPL_SAMPLER_HALTON;
    b.count = count > 3 ? atoi(words[3]) : 60;
    if (b.count < 3 || b.count > MAX_FRAMES || vplScene_GetEmitterCount(b.scene) == 0) {
        fprintf(stderr, "flicker: needs a light and 3 to %d frames\n", MAX_FRAMES);
        return 2;
    }
    const double diagonal = diagonalOf(b.scene);
    printf("%d frames of %s at %dx%d, %% of the mean\n", b.count, words[1], b.options.output.width,
           b.options.output.height);
    printf("%-7s %-9s %-9s %8s %8s %12s %8s %13s\n", "path", "light", "coherence", "change", "flicker",
           "tone-mapped:", "flicker", "static pixels");
    for (int path = 0; path < 2; path++) {
        (path ? moveLight : moveCamera)(b.scene, diagonal);
        for (int indirect = 0; indirect < 2; indirect++) {
            b.options.output.show = indirect ? VPL_SHOW_INDIRECT : VPL_SHOW_PICTURE;
            for (int on = 0; on < 2; on++) {
                measureAll(&b, path ? "light" : "camera", indirect ? "indirect" : "all", on);
            }
        }
    }
    vplScene_Destroy(b.scene);
    vplContext_Destroy(b.context);
    return 0;
}
