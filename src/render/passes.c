// SPDX-License-Identifier: MIT
#include "render/passes.h"

#include "render/stages/results.h"

#include <math.h>

vplResult vplPasses_Open(vplPasses* p, const vplImage* base)
{
    for (int half = 0; half < 2; half++) {
        p->sums[half] = vplAllocZero(p->context, vplValueCount(base), sizeof *p->sums[half]);
        if (p->sums[half] == NULL) {
            return VPL_OUT_OF_MEMORY;
        }
    }
    return VPL_SUCCESS;
}

void vplPasses_Free(vplPasses* p)
{
    vplImage_Destroy(p->base);
    vplFree(p->context, p->sums[0]);
    vplFree(p->context, p->sums[1]);
}

void vplPasses_Add(vplPasses* p, int pass, const vplImage* image)
{
    double* sums = p->sums[pass % 2];
    for (size_t k = 0; k < vplValueCount(image); k++) {
        sums[k] += (double)image->pixels[k];
    }
}

// The two halves of the passes differ by their errors: half of that is expected in their mean. What both have
// in common (the error of direct light, light lost or moved by the accumulation) is not in it.
static void estimateError(const vplPasses* p, int count, const vplImage* image, vplRenderStats* stats)
{
    const size_t values = vplValueCount(image);
    const int odd = count / 2, even = count - odd;
    double squares = 0, sum = 0;
    for (size_t k = 0; k < values && odd > 0; k++) {
        const double half = 0.5 * (p->sums[0][k] / even - p->sums[1][k] / odd);
        squares += half * half;
        sum += (double)image->pixels[k];
    }
    if (odd > 0) {
        stats->errorEstimate = sqrt(squares / (double)values);
        stats->relativeErrorEstimate = sum > 0 ? stats->errorEstimate * (double)values / sum : 0;
    }
}

vplResult vplPasses_Resolve(const vplPasses* p, int count, vplImage** imageOut, vplRenderStats* stats)
{
    TRY(vplImage_Create(p->context, p->base->width, p->base->height, imageOut));
    for (size_t k = 0; k < vplValueCount(p->base); k++) {
        const double mean = p->sums[0] != NULL ? (p->sums[0][k] + p->sums[1][k]) / count : 0;
        (*imageOut)->pixels[k] = (float)((double)p->base->pixels[k] + mean);
    }
    if (p->sums[0] != NULL) {
        estimateError(p, count, *imageOut, stats);
    }
    return VPL_SUCCESS;
}
