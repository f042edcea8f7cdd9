// SPDX-License-Identifier: MIT
// Measures the error of SSVP with few clusters. `bench/ssvp_error SCENE [TRUTH.pfm]`: compares pictures of 4,
// 8 and 16 clusters with that of 32, tone-mapped, at 1920 x 1080, as the document does (0.1259, 0.1020 and
// 0.0806); then, at the truth's size, 4 to 256 clusters with one and two bounces against a path-traced
// picture. rmse: of values in [0, 1] after tone mapping; coded: of the same as sRGB codes; error: root mean
// square relative to the truth's mean, linear.
#include "bench.h"

#include <math.h>

static vplImage* renderClusters(const vplScene* scene, int width, int height, int clusters, int bounces)
{
    vplRenderOptions o = plainOptions();
    o.method = VPL_METHOD_SSVP;
    o.output.width = width;
    o.output.height = height;
    o.ssvp.clusters = clusters;
    o.maxBounces = bounces;
    vplImage* image;
    check(vplRender(scene, &o, &image, NULL));
    return image;
}

static vplComparison compareToned(vplImage* a, vplImage* b)
{
    vplReinhardDef tone = vplDefaultReinhardDef();
    tone.skipBlack = true; // the default for written pictures
    check(vplToneMap_Reinhard(a, &tone));
    check(vplToneMap_Reinhard(b, &tone));
    vplComparison c;
    check(vplImage_Compare(a, b, &c));
    vplImage_Destroy(a);
    vplImage_Destroy(b);
    return c;
}

// Returns the RMSE of sRGB codes from the PSNR: the mean square is 10^(-psnr / 10).
static double codedOf(const vplComparison* c)
{
    return isfinite(c->psnr) ? pow(10, -c->psnr / 20) : 0;
}

static void againstMost(const vplScene* scene)
{
    puts("clusters     rmse    coded   (against 32)");
    for (int clusters = 4; clusters <= 16; clusters *= 2) {
        const vplComparison c = compareToned(renderClusters(scene, 1920, 1080, clusters, 2),
                                             renderClusters(scene, 1920, 1080, 32, 2));
        printf("%8d  %7.4f  %7.4f\n", clusters, c.rmse, codedOf(&c));
    }
}

static void againstTruth(const vplScene* scene, const char* path)
{
    vplImage* truth;
    check(vplImage_Read(vplScene_GetContext(scene), path, &truth));
    puts("clusters  bounces    error   energy    rmse    coded   (against the truth)");
    for (int clusters = 4; clusters <= 256; clusters *= clusters < 32 ? 2 : 8) {
        for (int bounces = clusters == 8 ? 0 : 2; bounces <= 2; bounces++) {
            vplImage* image = renderClusters(scene, truth->width, truth->height, clusters, bounces);
            vplImage* copy;
            vplComparison linear;
            check(vplImage_Compare(image, truth, &linear));
            check(vplImage_Crop(truth, 0, 0, truth->width, truth->height, &copy));
            const vplComparison toned = compareToned(image, copy);
            printf("%8d  %7d  %6.1f %%  %7.3f  %7.4f  %7.4f\n", clusters, bounces, 100 * linear.relativeRmse,
                   linear.energyRatio, toned.rmse, codedOf(&toned));
        }
    }
    vplImage_Destroy(truth);
}

int main(int count, char** words)
{
    vplContext* context;
    vplScene* scene;
    if (count < 2) {
        fprintf(stderr, "usage: ssvp_error SCENE [TRUTH.pfm]\n");
        return 2;
    }
    openScene(words[1], 0, VPL_ISA_AUTO, &context, &scene);
    againstMost(scene);
    if (count > 2) {
        againstTruth(scene, words[2]);
    }
    vplScene_Destroy(scene);
    vplContext_Destroy(context);
    return 0;
}
