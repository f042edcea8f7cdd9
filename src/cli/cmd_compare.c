// SPDX-License-Identifier: MIT
#include "cli/cli.h"

#include <stdio.h>
#include <stdlib.h>

// All figures of a comparison.
typedef struct Findings {
    vplComparison pixels;
    double ssim, flip;
    vplRegion* regions;
    int regionCount;
} Findings;

static void printText(const Findings* f)
{
    const vplComparison* c = &f->pixels;
    printf("rmse            %.9g\n", c->rmse);
    printf("relative_rmse   %.9g\n", c->relativeRmse);
    printf("relmse          %.9g\n", c->relmse);
    printf("trimmed_relmse  %.9g\n", c->trimmedRelmse);
    printf("psnr            %.6g dB\n", c->psnr);
    printf("ssim            %.9g\n", f->ssim);
    printf("flip            %.9g\n", f->flip);
    printf("energy_ratio    %.9g\n", c->energyRatio);
    printf("max_difference  %.9g at (%d, %d)\n", c->maxDifference, c->maxX, c->maxY);
    if (f->regionCount > 0) {
        printf("\n%6s %6s %6s %6s %13s %13s %13s %13s\n", "x", "y", "width", "height", "mean_a", "mean_b",
               "ratio", "rmse");
    }
    for (int i = 0; i < f->regionCount; i++) {
        const vplRegion* r = &f->regions[i];
        printf("%6d %6d %6d %6d %13.6g %13.6g %13.6g %13.6g\n", r->x, r->y, r->width, r->height, r->meanA,
               r->meanB, r->ratio, r->rmse);
    }
}

static json_t* describe(const Findings* f, double ppd)
{
    const vplComparison* c = &f->pixels;
    json_t* root = json_pack("{s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:f, s:o, s:o, s:i, s:i}", "rmse",
                             numberJson(c->rmse), "relative_rmse", numberJson(c->relativeRmse), "relmse",
                             numberJson(c->relmse), "trimmed_relmse", numberJson(c->trimmedRelmse), "psnr",
                             numberJson(c->psnr), "ssim", numberJson(f->ssim), "flip", numberJson(f->flip),
                             "flip_ppd", ppd, "energy_ratio", numberJson(c->energyRatio), "max_difference",
                             numberJson(c->maxDifference), "max_x", c->maxX, "max_y", c->maxY);
    if (f->regionCount == 0) {
        return root;
    }
    json_t* regions = json_array();
    for (int i = 0; i < f->regionCount; i++) {
        const vplRegion* r = &f->regions[i];
        json_array_append_new(regions, json_pack("{s:i, s:i, s:i, s:i, s:o, s:o, s:o, s:o}", "x", r->x, "y",
                                                 r->y, "width", r->width, "height", r->height, "mean_a",
                                                 numberJson(r->meanA), "mean_b", numberJson(r->meanB),
                                                 "ratio", numberJson(r->ratio), "rmse", numberJson(r->rmse)));
    }
    json_object_set_new(root, "regions", regions);
    return root;
}

static vplResult compareRegions(const Arguments* a, const vplImage* first, const vplImage* second,
                                Findings* findings)
{
    // Without room for one pixel per region, vplImage_CompareRegions refuses.
    const bool fits = a->regions[0] <= first->width && a->regions[1] <= first->height;
    findings->regionCount = a->regions[0] * a->regions[1];
    findings->regions = fits ? calloc((size_t)findings->regionCount, sizeof *findings->regions) : NULL;
    if (fits && findings->regions == NULL) {
        complain("out of memory: %d regions", findings->regionCount);
        return VPL_OUT_OF_MEMORY;
    }
    return vplImage_CompareRegions(first, second, a->regions[0], a->regions[1], findings->regions);
}

// Moves coordinates in the cropped pictures to those in the whole ones.
static void movePlaces(Findings* f, const int region[4])
{
    f->pixels.maxX += region[0];
    f->pixels.maxY += region[1];
    for (int i = 0; i < f->regionCount; i++) {
        f->regions[i].x += region[0];
        f->regions[i].y += region[1];
    }
}

static vplResult measure(const Arguments* a, const vplImage* first, const vplImage* second,
                         Findings* findings)
{
    TRY(vplImage_Compare(first, second, &findings->pixels));
    TRY(vplImage_Ssim(first, second, &findings->ssim, NULL));
    TRY(vplImage_Flip(first, second, a->ppd, &findings->flip, NULL));
    return a->regions[0] > 0 ? compareRegions(a, first, second, findings) : VPL_SUCCESS;
}

static int writeHeatmap(const Arguments* a, const vplImage* first, const vplImage* second)
{
    vplImage* map = NULL;
    vplHeatmapDef def = vplDefaultHeatmapDef();
    def.of = (vplHeat)a->heatmapOf;
    def.scale = (float)a->heatScale;
    def.ppd = a->ppd;
    int code = exitCode(vplImage_HeatmapOf(first, second, &def, &map), true);
    if (code == EXIT_DONE) {
        catchInterrupts(); // an interrupt leaves no temporary file
        code = exitCode(vplImage_Write(map, a->heatmap, NULL), false);
    }
    vplImage_Destroy(map);
    return code;
}

static int compare(const Arguments* a, const vplImage* first, const vplImage* second)
{
    Findings findings = {.regions = NULL};
    int code = exitCode(measure(a, first, second, &findings), true);
    if (code == EXIT_DONE) {
        movePlaces(&findings, a->region);
        if (a->json) {
            code = writeJson(describe(&findings, a->ppd), 9, NULL);
        } else {
            printText(&findings);
        }
    }
    free(findings.regions);
    return code == EXIT_DONE && a->heatmap != NULL ? writeHeatmap(a, first, second) : code;
}

// Replaces both pictures by their --region.
static int cropBoth(const int region[4], vplImage* images[2])
{
    if (images[0]->width != images[1]->width || images[0]->height != images[1]->height) {
        complain("the pictures differ in size: %dx%d and %dx%d", images[0]->width, images[0]->height,
                 images[1]->width, images[1]->height);
        return EXIT_USAGE;
    }
    int code = EXIT_DONE;
    for (int i = 0; i < 2 && code == EXIT_DONE; i++) {
        vplImage* crop = NULL;
        code = exitCode(vplImage_Crop(images[i], region[0], region[1], region[2], region[3], &crop), true);
        if (code == EXIT_DONE) {
            vplImage_Destroy(images[i]);
            images[i] = crop;
        }
    }
    return code;
}

int runCompare(const Arguments* a)
{
    if (a->heatmap != NULL && !vplImage_CanWrite(a->heatmap)) {
        complain("%s: unknown picture format; the name must end in %s", a->heatmap, vplImage_GetExtensions());
        return EXIT_USAGE;
    }
    if (a->heatmap != NULL && !checkOutput(a->heatmap)) {
        return EXIT_COULD_NOT;
    }
    vplContext* context;
    vplImage* images[2] = {NULL, NULL};
    int code = exitCode(openContext(a, &context), true);
    for (int i = 0; i < 2 && code == EXIT_DONE; i++) {
        code = exitCode(vplImage_Read(context, a->positionals[i], &images[i]), true);
    }
    if (code == EXIT_DONE && a->region[2] > 0) {
        code = cropBoth(a->region, images);
    }
    if (code == EXIT_DONE) {
        code = compare(a, images[0], images[1]);
    }
    vplImage_Destroy(images[0]);
    vplImage_Destroy(images[1]);
    vplContext_Destroy(context);
    return code;
}
