// SPDX-License-Identifier: MIT
#include "render/state_file.h"

#include "reference/path_trace.h"
#include "reference/sparse_paths.h"
#include "render/stages/make.h"
#include "render/stages/results.h"

#include <float.h>
#include <math.h>

// Bytes of a pixel of the truth, and of what was concluded from them (vplState_StreamTruth).
enum { TRUTH_PIXEL_BYTES = 80, TRUTH_BYTES = 40 };

void vplState_StreamHeader(vplStream* s, vplStateHeader* h)
{
    s->at = VPL_STATE_MAGIC_BYTES;
    vplStream_Word(s, &h->version);
    vplStream_Word(s, &h->textBytes);
    vplStream_Long(s, &h->scene);
    uint32_t* const words[] = {&h->width, &h->height, &h->parts, &h->passes, &h->samples, &h->truth};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        vplStream_Word(s, words[i]);
    }
    vplStream_Long(s, &h->rays[0]);
    vplStream_Long(s, &h->rays[1]);
    vplStream_Doubles(s, h->loss, 2);
    vplStream_Long(s, &h->unreviewed);
    vplStream_Doubles(s, &h->spread, 1);
    vplStream_Doubles(s, &h->spent, 1);
    vplStream_Doubles(s, h->turn, 2);
    vplStream_Long(s, &h->side);
    vplStream_Word(s, &h->edges[0]);
    vplStream_Word(s, &h->edges[1]);
    vplStream_Long(s, &h->tries);
    vplStream_Doubles(s, &h->coarser, 1);
    vplStream_Doubles(s, &h->lights, 1);
}

size_t vplState_Size(const vplStateHeader* h)
{
    const size_t values = 3 * (size_t)h->width * (size_t)h->height,
                 direct = (h->parts & VPL_STATE_DIRECT) != 0;
    size_t size = VPL_STATE_HEADER_BYTES + h->textBytes + VPL_STATE_CHECKSUM_BYTES;
    size +=
        (h->parts & VPL_STATE_PASSES) != 0 ? values * (2 * sizeof(double) + (1 + direct) * sizeof(float)) : 0;
    size += h->truth > 0 ? TRUTH_BYTES + (size_t)h->truth * TRUTH_PIXEL_BYTES : 0;
    size += (h->parts & VPL_STATE_PATHS) != 0 ? (1 + direct) * 2 * values * sizeof(double) : 0;
    return size;
}

uint32_t vplState_PartsOf(const vplPlan* p)
{
    const bool paths = p->options.method == VPL_METHOD_PATH;
    if (!paths && !p->progressive) {
        return VPL_STATE_ONCE;
    }
    return (paths ? VPL_STATE_PATHS : VPL_STATE_PASSES) | (vplPassesSplitLight(p) ? VPL_STATE_DIRECT : 0);
}

bool vplRenderer_HasState(const vplRenderer* r)
{
    if (r == NULL) {
        return false;
    }
    const vplRenderOptions* o = &r->asked;
    const bool follows = o->method == VPL_METHOD_AUTO || (r->coarse && r->plan->showsVirtual);
    const bool goesOn =
        follows && o->output.show == VPL_SHOW_PICTURE && (o->stop.maxError > 0 || o->stop.budgetMs > 0);
    return goesOn || vplState_PartsOf(r->plan) != VPL_STATE_ONCE;
}

void vplState_StreamSums(vplStream* s, vplRenderer* r, uint32_t parts)
{
    for (int i = 0; i < vplState_CountTracers(parts); i++) {
        const vplPathSums sums = vplPathTracer_GetSums(vplGetPathTracer(&r->runner.run, i > 0));
        vplStream_Doubles(s, sums.values, sums.count);
    }
    if ((parts & VPL_STATE_PASSES) != 0) {
        const size_t values = vplValueCount(r->base);
        vplStream_Floats(s, r->base->pixels, values);
        vplStream_Doubles(s, r->sums[0], values);
        vplStream_Doubles(s, r->sums[1], values);
        if ((parts & VPL_STATE_DIRECT) != 0) {
            vplStream_Floats(s, r->direct->pixels, values);
        }
    }
}

void vplState_StreamTruth(vplStream* s, vplRenderer* r)
{
    const vplTruthState t = vplTruth_GetState(r->truth);
    uint32_t each = (uint32_t)t.each, reserved = 0;
    vplStream_Word(s, &each);
    vplStream_Word(s, &reserved);
    vplStream_Doubles(s, &r->judgedNoise, 1);
    vplStream_Doubles(s, &r->error.noise, 1);
    vplStream_Doubles(s, &r->error.total, 1);
    vplStream_Doubles(s, &r->error.bound, 1);
    for (int i = 0; i < t.count; i++) {
        vplSparsePixel* p = &t.pixels[i];
        uint32_t x = (uint32_t)p->x, y = (uint32_t)p->y;
        uint64_t rays = (uint64_t)p->rays;
        vplStream_Word(s, &x);
        vplStream_Word(s, &y);
        vplStream_Doubles(s, &p->sums[0].r, 3);
        vplStream_Doubles(s, &p->sums[1].r, 3);
        vplStream_Long(s, &rays);
        vplStream_Doubles(s, &t.weights[i], 1);
        p->x = (int)x;
        p->y = (int)y;
        p->rays = (int64_t)rays;
    }
    for (int i = 0; i < t.count; i++) {
        vplStream_Doubles(s, &t.pixels[i].squares, 1);
    }
    vplTruth_SetPaths(r->truth, (int)each);
}

// True if all values lie in [least, most].
static bool areBetween(const double* values, size_t count, double least, double most)
{
    bool between = true;
    for (size_t k = 0; k < count; k++) {
        between = between && values[k] >= least && values[k] <= most;
    }
    return between;
}

bool vplState_AreSumsValid(const vplRenderer* r, uint32_t parts, double weight)
{
    const double most = (double)FLT_MAX / 4; // light of the first pass and the mean of all are added
    bool valid = true;
    for (int i = 0; i < vplState_CountTracers(parts); i++) {
        const vplPathSums sums = vplPathTracer_GetSums(vplGetPathTracer(&r->runner.run, i > 0));
        valid = valid && areBetween(sums.values, sums.count, 0, DBL_MAX / 4);
    }
    if ((parts & VPL_STATE_PASSES) != 0) {
        const size_t values = vplValueCount(r->base);
        valid =
            valid && vplStream_AreSmall(r->base->pixels, values, most) &&
            areBetween(r->sums[0], values, -most * weight, most * weight) &&
            areBetween(r->sums[1], values, 0, DBL_MAX / 4) &&
            ((parts & VPL_STATE_DIRECT) == 0 || vplStream_AreSmall(r->direct->pixels, values, most * weight));
    }
    return valid;
}

bool vplState_IsTruthValid(const vplRenderer* r)
{
    const vplTruthState t = vplTruth_GetState(r->truth);
    const vplOutputOptions* o = &r->plan->options.output;
    bool valid = t.each >= 1 && t.each <= VPL_MAX_SAMPLES / 2;
    for (int i = 0; i < t.count && valid; i++) {
        const vplSparsePixel* p = &t.pixels[i];
        valid = p->x >= 0 && p->x < o->width && p->y >= 0 && p->y < o->height && p->rays >= 0 &&
                p->rays < INT64_MAX / 4096;
    }
    return valid;
}
