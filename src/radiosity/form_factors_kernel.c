// SPDX-License-Identifier: MIT
// One side against sixteen: by their planes, by points in the middle of their thirds, by points that rays join.
#include "base/isa.h"
#include "radiosity/form_factors.h"

#include <math.h>
#include <string.h>

enum { LANES = VPL_FACTOR_LANES };

vplFactorFirstFcn VPL_KERNEL(vplFactorFirst);
vplFactorWeightsFcn VPL_KERNEL(vplFactorWeights);
vplFactorDotFcn VPL_KERNEL(vplFactorDot);
vplFactorScaleFcn VPL_KERNEL(vplFactorScale);

static const float INVERSE_PI = 0.318309886f;

// Divided by the squared distance twice, not by its square, which would underflow at 1e-10 m.
static inline float exchange(float x, float y, float z, float nx, float ny, float nz, float mx, float my,
                             float mz)
{
    const float square = x * x + y * y + z * z;
    const float inverse = 1 / (square > 0x1p-100f ? square : 0x1p-100f);
    const float a = (x * nx + y * ny + z * nz) * inverse, b = -(x * mx + y * my + z * mz) * inverse;
    const float product = a * b * INVERSE_PI;
    return ((a > 0) & (b > 0)) ? product : 0;
}

// The heights of the highest corners of b over a's plane, and of a over b's.
static inline void findHeights(const vplFactorBlock* a, int lane, const vplFactorBlock* b, float over[LANES],
                               float under[LANES])
{
    const float nx = a->normal[0][lane], ny = a->normal[1][lane], nz = a->normal[2][lane];
    const float px = a->centre[0][lane], py = a->centre[1][lane], pz = a->centre[2][lane];
    float most[LANES], least[LANES];
    for (int l = 0; l < LANES; l++) {
        most[l] = least[l] = -INFINITY;
    }
    for (int c = 0; c < 3; c++) {
        const float cx = a->corner[c][0][lane], cy = a->corner[c][1][lane], cz = a->corner[c][2][lane];
        for (int l = 0; l < LANES; l++) {
            const float h = nx * (b->corner[c][0][l] - px) + ny * (b->corner[c][1][l] - py) +
                            nz * (b->corner[c][2][l] - pz);
            const float g = b->normal[0][l] * (cx - b->centre[0][l]) +
                            b->normal[1][l] * (cy - b->centre[1][l]) +
                            b->normal[2][l] * (cz - b->centre[2][l]);
            most[l] = h > most[l] ? h : most[l];
            least[l] = g > least[l] ? g : least[l];
        }
    }
    memcpy(over, most, sizeof most);
    memcpy(under, least, sizeof least);
}

void VPL_KERNEL(vplFactorFirst)(const vplFactorBlock* a, int lane, const vplFactorBlock* b, float tolerance,
                                float near2, vplFactorFirst* first)
{
    const float nx = a->normal[0][lane], ny = a->normal[1][lane], nz = a->normal[2][lane];
    const float cx = a->centre[0][lane], cy = a->centre[1][lane], cz = a->centre[2][lane];
    const float radius2 = a->radius2[lane];
    float over[LANES], under[LANES], sum[LANES] = {0};
    int32_t seen[LANES], near[LANES];
    findHeights(a, lane, b, over, under);
    for (int l = 0; l < LANES; l++) {
        const float x = b->centre[0][l] - cx, y = b->centre[1][l] - cy, z = b->centre[2][l] - cz;
        const float other = b->radius2[l], larger = other > radius2 ? other : radius2;
        seen[l] = (over[l] > tolerance) & (under[l] > tolerance);
        near[l] = x * x + y * y + z * z < near2 * larger;
    }
    first->seen = first->near = 0;
    for (int l = 0; l < LANES; l++) {
        first->seen |= (uint32_t)seen[l] << l;
        first->near |= (uint32_t)near[l] << l;
    }
    if (first->seen == 0) {
        return;
    }
    for (int p = 0; p < VPL_FACTOR_MIDDLES; p++) {
        const float px = a->middle[p][0][lane], py = a->middle[p][1][lane], pz = a->middle[p][2][lane];
        for (int q = 0; q < VPL_FACTOR_MIDDLES; q++) {
            for (int l = 0; l < LANES; l++) {
                sum[l] += exchange(b->middle[q][0][l] - px, b->middle[q][1][l] - py, b->middle[q][2][l] - pz,
                                   nx, ny, nz, b->normal[0][l], b->normal[1][l], b->normal[2][l]);
            }
        }
    }
    for (int l = 0; l < LANES; l++) {
        sum[l] *= 1.0f / (VPL_FACTOR_MIDDLES * VPL_FACTOR_MIDDLES);
    }
    memcpy(first->middle, sum, sizeof sum);
}

// The ways are vplWayToLight's.
void VPL_KERNEL(vplFactorWeights)(const float point[3], const float normal[3], const float to[3][LANES],
                                  const float toNormal[3][LANES], float weightOut[LANES],
                                  float wayOut[3][LANES])
{
    const float px = point[0], py = point[1], pz = point[2], nx = normal[0], ny = normal[1], nz = normal[2];
    const float ax = fabsf(px), ay = fabsf(py), az = fabsf(pz);
    const float axy = ax > ay ? ax : ay, largest = axy > az ? axy : az;
    float weight[LANES], way[3][LANES];
    for (int l = 0; l < LANES; l++) {
        const float tx = to[0][l], ty = to[1][l], tz = to[2][l];
        const float mx = toNormal[0][l], my = toNormal[1][l], mz = toNormal[2][l];
        const float bx = fabsf(tx), by = fabsf(ty), bz = fabsf(tz);
        const float bxy = bx > by ? bx : by, b = bxy > bz ? bxy : bz;
        const float lift = (b > largest ? b : largest) * 0x1p-18f;
        const float x = tx + lift * mx - px, y = ty + lift * my - py, z = tz + lift * mz - pz;
        const float wx = fabsf(x), wy = fabsf(y), wz = fabsf(z);
        const float wxy = wx > wy ? wx : wy, w = wxy > wz ? wxy : wz;
        const float length = w > 2 * lift ? w : 2 * lift;
        const float scale = 1 - lift / (length > 0x1p-126f ? length : 0x1p-126f);
        weight[l] = exchange(tx - px, ty - py, tz - pz, nx, ny, nz, mx, my, mz);
        way[0][l] = scale * x;
        way[1][l] = scale * y;
        way[2][l] = scale * z;
    }
    memcpy(weightOut, weight, sizeof weight);
    memcpy(wayOut, way, sizeof way);
}

// ---- rows

double VPL_KERNEL(vplFactorDot)(const float* row, const double* factor, int count)
{
    double sum[LANES] = {0};
    int j = 0;
    for (; j + LANES <= count; j += LANES) {
        for (int l = 0; l < LANES; l++) {
            sum[l] += (double)row[j + l] * factor[j + l];
        }
    }
    double all = 0;
    for (int l = 0; l < LANES; l++) {
        all += sum[l];
    }
    for (; j < count; j++) {
        all += (double)row[j] * factor[j];
    }
    return all;
}

void VPL_KERNEL(vplFactorScale)(float* row, double scale, const double* factor, int count)
{
    for (int j = 0; j < count; j++) {
        row[j] = (float)((double)row[j] * (scale * factor[j]));
    }
}
