// SPDX-License-Identifier: MIT
// How near radiosity comes to the truth as patches shrink. `bench/radiosity_error SCENE TRUTH.pfm [OPTIONS]`: the truth is
// indirect light (vpl render SCENE --method path --pixel centre --show indirect); OPTIONS, in one word, are letters:
// i: the document's estimator; h: the hierarchy; c: rows clamped; n: no interpolation.
//   relmse   mean of (a - b)^2 / (b + 0.01)^2 over pixels off discontinuities: all around show the same plane
//   all      the same over all pixels
//   energy   sum of a / sum of b
// ms are of the wall clock, of the whole picture; with several patch counts and both placements.
#include "bench.h"

#include <math.h>
#include <string.h>

static vplImage* show(const vplScene* scene, const vplImage* like, vplShow what)
{
    vplRenderOptions o = vplDefaultRenderOptions();
    vplImage* image;
    o.method = VPL_METHOD_DIRECT;
    o.width = like->width;
    o.height = like->height;
    o.show = what;
    check(vplRender(scene, &o, &image, NULL));
    return image;
}

// Whether two neighbours show one plane.
static bool isSame(const float* d, const float* n, int i, int k)
{
    const float dot = n[3 * i] * n[3 * k] + n[3 * i + 1] * n[3 * k + 1] + n[3 * i + 2] * n[3 * k + 2];
    return d[3 * k] > 0 && dot > 0.99f && fabsf(d[3 * i] - d[3 * k]) < 0.03f * d[3 * i];
}

static bool* findSmooth(const vplScene* scene, const vplImage* like)
{
    vplImage *depth = show(scene, like, VPL_SHOW_DEPTH), *normals = show(scene, like, VPL_SHOW_NORMALS);
    const int w = like->width, h = like->height;
    bool* smooth = calloc((size_t)w * (size_t)h, 1);
    for (int y = 1; y + 1 < h; y++) {
        for (int x = 1; x + 1 < w; x++) {
            bool same = depth->pixels[3 * (y * w + x)] > 0;
            for (int k = 0; k < 9; k++) {
                same = same &&
                       isSame(depth->pixels, normals->pixels, y * w + x, (y + k / 3 - 1) * w + x + k % 3 - 1);
            }
            smooth[y * w + x] = same;
        }
    }
    vplImage_Destroy(depth);
    vplImage_Destroy(normals);
    return smooth;
}

static double relmseOf(const vplImage* a, const vplImage* b, const bool* mask)
{
    double sum = 0, count = 0;
    for (int i = 0; i < a->width * a->height; i++) {
        for (int c = 0; c < 3 && (mask == NULL || mask[i]); c++) {
            const double truth = (double)b->pixels[3 * i + c], e = (double)a->pixels[3 * i + c] - truth;
            sum += e * e / ((truth + 0.01) * (truth + 0.01));
            count++;
        }
    }
    return sum / count;
}

static void measure(const vplScene* scene, const vplImage* truth, const bool* smooth, const char* letters,
                    vplPatchPlacement placement, int patches)
{
    vplRenderOptions o = vplDefaultRenderOptions();
    o.method = VPL_METHOD_RADIOSITY;
    o.show = VPL_SHOW_INDIRECT;
    o.width = truth->width;
    o.height = truth->height;
    o.patches = patches;
    o.patchPlacement = placement;
    o.formFactors = strchr(letters, 'i') ? VPL_FORM_FACTORS_INCENTRE : o.formFactors;
    o.hierarchy = strchr(letters, 'h') ? VPL_HIERARCHY_ON : o.hierarchy;
    o.rowSums = strchr(letters, 'c') ? VPL_ROW_SUMS_CLAMP : o.rowSums;
    o.interpolation = strchr(letters, 'n') ? VPL_INTERPOLATION_NONE : o.interpolation;
    vplImage* image;
    vplRenderStats stats;
    check(vplRender(scene, &o, &image, &stats));
    vplComparison c;
    check(vplImage_Compare(image, truth, &c));
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
    vplImage* truth;
    if (count < 3) {
        fprintf(stderr, "usage: radiosity_error SCENE TRUTH.pfm [OPTIONS]\n");
        return 2;
    }
    openScene(words[1], 0, VPL_ISA_AUTO, &context, &scene);
    check(vplImage_Read(context, words[2], &truth));
    bool* smooth = findSmooth(scene, truth);
    puts("placement patches   sides        ms     relmse        all  energy");
    for (int patches = 125; patches <= 16000; patches *= 2) {
        for (int placement = 0; placement < (strchr(count > 3 ? words[3] : "", (int)117) ? 1 : 2); placement++) {
            measure(scene, truth, smooth, count > 3 ? words[3] : "", (vplPatchPlacement)placement, patches);
        }
    }
    free(smooth);
    vplImage_Destroy(truth);
    vplScene_Destroy(scene);
    vplContext_Destroy(context);
    return 0;
}
