// SPDX-License-Identifier: MIT
#include "cli/cli.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static void printText(const vplComparison* c)
{
    printf("rmse            %.9g\n", c->rmse);
    printf("relative_rmse   %.9g\n", c->relativeRmse);
    printf("relmse          %.9g\n", c->relmse);
    printf("psnr            %.6g dB\n", c->psnr);
    printf("energy_ratio    %.9g\n", c->energyRatio);
    printf("max_difference  %.9g at (%d, %d)\n", c->maxDifference, c->maxX, c->maxY);
}

// JSON knows no infinity: what is infinite is null.
static json_t* number(double value)
{
    return isfinite(value) ? json_real(value) : json_null();
}

static void printJson(const vplComparison* c)
{
    json_t* root = json_object();
    json_object_set_new(root, "rmse", number(c->rmse));
    json_object_set_new(root, "relative_rmse", number(c->relativeRmse));
    json_object_set_new(root, "relmse", number(c->relmse));
    json_object_set_new(root, "psnr", number(c->psnr));
    json_object_set_new(root, "energy_ratio", number(c->energyRatio));
    json_object_set_new(root, "max_difference", number(c->maxDifference));
    json_object_set_new(root, "max_x", json_integer(c->maxX));
    json_object_set_new(root, "max_y", json_integer(c->maxY));
    json_dumpf(root, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(9));
    putchar('\n');
    json_decref(root);
}

static int compare(const Arguments* a, const vplImage* first, const vplImage* second)
{
    vplComparison comparison;
    int code = exitCode(vplImage_Compare(first, second, &comparison), true);
    if (code != EXIT_DONE) {
        return code;
    }
    if (a->json) {
        printJson(&comparison);
    } else {
        printText(&comparison);
    }
    if (a->heatmap == NULL) {
        return EXIT_DONE;
    }
    vplImage* map = NULL;
    code = exitCode(vplImage_Heatmap(first, second, (float)a->heatScale, &map), true);
    if (code == EXIT_DONE) {
        catchInterrupts(); // no temporary file stays behind
        code = exitCode(vplImage_Write(map, a->heatmap, NULL), false);
    }
    vplImage_Destroy(map);
    return code;
}

int runCompare(const Arguments* a)
{
    if (a->heatmap != NULL && !vplImage_CanWrite(a->heatmap)) {
        complain("%s: unknown picture format; the name must end in .png, .hdr or .pfm", a->heatmap);
        return EXIT_USAGE;
    }
    if (a->heatmap != NULL && !checkOutput(a->heatmap)) {
        return EXIT_COULD_NOT;
    }
    vplContext* context = openContext(a);
    if (context == NULL) {
        return EXIT_USAGE;
    }
    vplImage* images[2] = {NULL, NULL};
    int code = EXIT_DONE;
    for (int i = 0; i < 2 && code == EXIT_DONE; i++) {
        code = exitCode(vplImage_Read(context, a->positionals[i], &images[i]), true);
    }
    if (code == EXIT_DONE) {
        code = compare(a, images[0], images[1]);
    }
    vplImage_Destroy(images[0]);
    vplImage_Destroy(images[1]);
    vplContext_Destroy(context);
    return code;
}
