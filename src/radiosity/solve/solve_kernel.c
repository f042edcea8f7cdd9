// SPDX-License-Identifier: MIT
// Rows of form factors times radiosities, and shots. Lane l sums sides l, l + 16, ..., and the lanes are
// added in order.
#include "radiosity/radiosity_kernels.h"

#include <math.h>
#include <string.h>

enum {
    LANES = VPL_SIDE_LANES,
    // Products of this many sides are summed in float before they are added in double: 16 per lane, all of
    // one sign, so the relative error is at most 16 * 2^-24, 1e-6, and conversions cost nothing.
    CHUNK = 16 * LANES
};

static inline void addProducts(float sum[restrict LANES], const float* restrict row,
                               const float* restrict values)
{
    float f[LANES], x[LANES];
    memcpy(f, row, sizeof f);
    memcpy(x, values, sizeof x);
    for (int l = 0; l < LANES; l++) {
        sum[l] += f[l] * x[l];
    }
}

void VPL_KERNEL(vplRowDot)(const float* row, const vplPlanes* planes, int count, double sumOut[3])
{
    const float *r = planes->c[0], *g = planes->c[1], *b = planes->c[2];
    double total[3][LANES] = {{0}};
    for (int first = 0; first < count; first += CHUNK) {
        const int end = first + CHUNK < count ? first + CHUNK : count;
        float sum[3][LANES] = {{0}};
        int j = first;
        for (; j + LANES <= end; j += LANES) {
            addProducts(sum[0], row + j, r + j);
            addProducts(sum[1], row + j, g + j);
            addProducts(sum[2], row + j, b + j);
        }
        if (j < end) { // copy the rest: the next row follows in memory
            float last[LANES] = {0};
            memcpy(last, row + j, sizeof *last * (size_t)(end - j));
            addProducts(sum[0], last, r + j);
            addProducts(sum[1], last, g + j);
            addProducts(sum[2], last, b + j);
        }
        for (int c = 0; c < 3; c++) {
            for (int l = 0; l < LANES; l++) {
                total[c][l] += (double)sum[c][l];
            }
        }
    }
    for (int c = 0; c < 3; c++) {
        double all = 0;
        for (int l = 0; l < LANES; l++) {
            all += total[c][l];
        }
        sumOut[c] = all;
    }
}

// ---- shooting

// Adds a shot to 16 sides, and finds their unshot power.
static inline void shootAt(const vplShot* shot, const float* row, int j, float power[restrict LANES])
{
    float f[LANES], area[LANES];
    memcpy(f, row, sizeof f);
    memcpy(area, shot->area + j, sizeof area);
    memset(power, 0, LANES * sizeof *power);
    for (int c = 0; c < 3; c++) {
        const float sent = shot->power[c];
        float gain[LANES], unshot[LANES];
        memcpy(gain, shot->gain.c[c] + j, sizeof gain);
        memcpy(unshot, shot->unshot.c[c] + j, sizeof unshot);
        for (int l = 0; l < LANES; l++) {
            unshot[l] += gain[l] * (f[l] * sent);
            power[l] += area[l] * fabsf(unshot[l]);
        }
        memcpy(shot->unshot.c[c] + j, unshot, sizeof unshot);
    }
}

static inline void keepLargest(const float power[restrict LANES], int j, float best[restrict LANES],
                               int32_t at[restrict LANES])
{
    for (int l = 0; l < LANES; l++) {
        const bool more = power[l] > best[l];
        const float most = best[l], now = power[l];
        const int32_t old = at[l], here = j + l;
        best[l] = more ? now : most;
        at[l] = more ? here : old;
    }
}

int VPL_KERNEL(vplShoot)(const vplShot* shot, int count)
{
    float best[LANES] = {0}, power[LANES];
    int32_t at[LANES];
    memset(at, 0xff, sizeof at);
    int j = 0;
    for (; j + LANES <= count; j += LANES) {
        shootAt(shot, shot->row + j, j, power);
        keepLargest(power, j, best, at);
    }
    if (j < count) {
        float last[LANES] = {0};
        memcpy(last, shot->row + j, sizeof *last * (size_t)(count - j));
        shootAt(shot, last, j, power);
        keepLargest(power, j, best, at);
    }
    int next = -1;
    float most = 0;
    for (int l = 0; l < LANES; l++) {
        if (best[l] > most || (best[l] == most && at[l] >= 0 && at[l] < next)) {
            most = best[l];
            next = at[l];
        }
    }
    return next;
}
