// SPDX-License-Identifier: MIT
// Measures the error of radiosity as patches shrink. `bench/radiosity_error SCENE TRUTH.pfm TRUTH.pfm
// [OPTIONS]`: the truths are indirect light of different seeds (vpl render SCENE --method path --pixel centre
// --show indirect --seed S), so that their noise is not counted. OPTIONS is one word of letters:
// i: the document's estimator; h: the hierarchy; c: rows clamped; n: no interpolation;
// u: uniform patches only; a: adaptive patches only; f: 500 to 4000 patches.
//   relmse   mean of (a - b)(a - c) / ((b + c) / 2 + 0.01)^2 over pixels away from discontinuities:
//            all neighbours show one plane, to 1 mm
//   all      the same over all pixels
//   energy   sum of a / sum of b
// Times are wall-clock ms of the whole picture. The program runs several patch counts and both placements of
// patches.
#include "bench.h"

#include <math.h>
#include <string.h>

static vplImage* show(const vplScene* scene, const vplImage* like, vplShow what)
{
    vplRenderOptions o = plainOptions();
    vplImage* image;
    o.method = VPL_METHOD_DIRECT;
    o.output.width = like->width;
    o.output.height = like->height;
    o.output.show = what;
    check(vplRender(scene, &o, &image, NULL));
    return image;
}

// Returns for each pixel the distance of its surface's plane from the origin; infinity for the background.
static float* findPlanes(const vplScene* scene, const vplImage* depth, const vplImage* normals)
{
    const vplView view = vplView_Create(vplScene_GetCamera(scene, 0), depth->width, depth->height);
    float* planes = malloc((size_t)depth->width * (size_t)depth->height * sizeof *planes);
    for (int i = 0; i < depth->width * depth->height; i++) {
        const vplVec3 d = rayThrough(&view, i % depth->width, i / depth->width);
        const vplVec3 p = vplAdd(view.eye, vplScale(depth->pixels[3 * i] / vplDot(d, view.forward), d));
        const float* n = normals->pixels + 3 * i;
        planes[i] = depth->pixels[3 * i] > 0 ? vplDot(p, vplVec(n[0], n[1], n[2])) : INFINITY;
    }
    return planes;
}

// Returns whether two pixels show one plane.
static bool isSame(const vplImage* normals, const float* planes, int i, int k)
{
    const float *n = normals->pixels + 3 * i, *m = normals->pixels + 3 * k;
    const float dot = n[0] * m[0] + n[1] * m[1] + n[2] * m[2];
    return dot > 0.99f && fabsf(planes[i] - planes[k]) < 1e-3f;
}

static bool* findSmooth(const vplScene* scene, const vplImage* like)
{
    vplImage *depth = show(scene, like, VPL_SHOW_DEPTH), *normals = show(scene, like, VPL_SHOW_NORMALS);
    float* planes = findPlanes(scene, depth, normals);
    const int w = like->width, h = like->height;
    bool* smooth = calloc((size_t)w * (size_t)h, 1);
    for (int y = 1; y + 1 < h; y++) {
        for (int x = 1; x + 1 < w; x++) {
            bool same = isfinite(planes[y * w + x]);
            for (int k = 0; k < 9 && same; k++) {
                same = isSame(normals, planes, y * w + x, (y + k / 3 - 1) * w + x + k % 3 - 1);
            }
            smooth[y * w + x] = same;
        }
    }
    free(planes);
    vplImage_Destroy(depth);
    vplImage_Destroy(normals);
    return smooth;
}

// Returns the relative MSE of the picture. The product of its errors against two independent truths cancels
// their noise.
static double relmseOf(const vplImage* image, vplImage* const truth[2], const bool* mask)
{
    double sum = 0, count = 0;
    for (int i = 0; i < 3 * image->width * image->height; i++) {
        const double a = (double)truth[0]->pixels[i], b = (double)truth[1]->pixels[i],
                     x = (double)image->pixels[i];
        const double scale = 0.5 * (a + b) + 0.01;
        if (mask == NULL || mask[i / 3]) {
            sum += (x - a) * (x - b) / (scale * scale);
            count++;
        }
    }
    return sum / count;
}

static void measure(const vplScene* scene, vplImage* const truth[2], const bool* smooth, const char* letters,
                    vplPatchPlacement placement, int patches)
{
    vplRenderOptions o = plainOptions();
    o.method = VPL_METHOD_RADIOSITY;
    o.output.show = VPL_SHOW_INDIRECT;
    o.output.width = truth[0]->width;
    o.output.height = truth[0]->height;
    o.radiosity.patches = patches;
    o.radiosity.placement = placement;
    o.radiosity.formFactors = strchr(letters, 'i') ? VPL_FORM_FACTORS_INCENTRE : o.radiosity.formFactors;
    o.radiosity.hierarchy = strchr(letters, 'h') ? VPL_HIERARCHY_ON : o.radiosity.hierarchy;
    o.radiosity.rowSums = strchr(letters, 'c') ? VPL_ROW_SUMS_CLAMP : o.radiosity.rowSums;
    o.radiosity.interpolation = strchr(letters, 'n') ? VPL_INTERPOLATION_NONE : o.radiosity.interpolation;
    vplImage* image;
    vplRenderStats stats;
    check(vplRender(scene, &o, &image, &stats));
    vplComparison c;
    check(vplImage_Compare(image, truth[0], &c));
    printf("%-8s %7d %7d %9.0f  %9.6f  %9.6f  %6.3f\n", placement ? "adaptive" : "uniform", stats.patches,
           stats.patchSides, stats.totalMs, relmseOf(image, truth, smooth), relmseOf(image, truth, NULL),
           c.energyRatio);
    fflush(stdout);
    vplImage_Destroy(image);
}

int main(int count, char** words)
{
    vplContext* context;
    vplScene* scene;
    vplImage* truth[2];
    if (count < 4) {
        fprintf(stderr, "usage: radiosity_error SCENE TRUTH.pfm TRUTH.pfm [OPTIONS]\n");
        return 2;
    }
    openScene(words[1], 0, VPL_ISA_AUTO, &context, &scene);
    check(vplImage_Read(context, words[2], &truth[0]));
    check(vplImage_Read(context, words[3], &truth[1]));
    bool* smooth = findSmooth(scene, truth[0]);
    const char* letters = count > 4 ? words[4] : "";
    puts("placement patches   sides        ms     relmse        all  energy");
    const bool few = strchr(letters, 'f') != NULL;
    for (int patches = few ? 500 : 125; patches <= (few ? 4000 : 16000); patches *= 2) {
        for (int placement = strchr(letters, 'a') != NULL; placement < (strchr(letters, 'u') ? 1 : 2);
             placement++) {
            measure(scene, truth, smooth, letters, (vplPatchPlacement)placement, patches);
        }
    }
    free(smooth);
    vplImage_Destroy(truth[0]);
    vplImage_Destroy(truth[1]);
    vplScene_Destroy(scene);
    vplContext_Destroy(context);
    return 0;
}
