// SPDX-License-Identifier: MIT
// Form factors between one side and sixteen, and operations on rows of the matrix.
#include "radiosity/radiosity_kernels.h"

#include <string.h>

enum { LANES = VPL_SIDE_LANES };

static const float INVERSE_PI = 0.318309886f;

// cos cos / (pi r^2) over the vector `way` between surfaces of normals n and m. Divides by the squared
// distance twice: its square would underflow at 1e-10 m.
static inline float termOf(vplVec3 way, vplVec3 n, vplVec3 m)
{
    const float square = vplDot(way, way);
    const float inverse = 1 / (square > 0x1p-100f ? square : 0x1p-100f);
    const float a = vplDot(way, n) * inverse, b = -vplDot(way, m) * inverse;
    const float product = a * b * INVERSE_PI;
    return ((a > 0) & (b > 0)) ? product : 0;
}

// The heights of the highest corners of b over a's plane, and of a over b's planes.
static inline void findHeights(const vplFactorBlock* a, int lane, const vplFactorBlock* b, float over[LANES],
                               float under[LANES])
{
    const vplVec3 n = vplGetLane(a->normal, lane), centre = vplGetLane(a->centre, lane);
    float most[LANES], least[LANES];
    for (int l = 0; l < LANES; l++) {
        most[l] = least[l] = -INFINITY;
    }
    for (int c = 0; c < 3; c++) {
        const vplVec3 corner = vplGetLane(a->corner[c], lane);
        for (int l = 0; l < LANES; l++) {
            const float h = vplDot(n, vplSub(vplGetLane(b->corner[c], l), centre));
            const float g = vplDot(vplGetLane(b->normal, l), vplSub(corner, vplGetLane(b->centre, l)));
            most[l] = h > most[l] ? h : most[l];
            least[l] = g > least[l] ? g : least[l];
        }
    }
    memcpy(over, most, sizeof most);
    memcpy(under, least, sizeof least);
}

void VPL_KERNEL(vplEstimateFactors)(const vplFactorBlock* a, int lane, const vplFactorBlock* b,
                                    float tolerance, float near2, vplFactorEstimate* estimate)
{
    const vplVec3 n = vplGetLane(a->normal, lane), centre = vplGetLane(a->centre, lane);
    const float radius2 = a->radius2[lane];
    float over[LANES], under[LANES], sum[LANES] = {0};
    int32_t facing[LANES], near[LANES];
    findHeights(a, lane, b, over, under);
    for (int l = 0; l < LANES; l++) {
        const vplVec3 way = vplSub(vplGetLane(b->centre, l), centre);
        const float other = b->radius2[l], larger = other > radius2 ? other : radius2;
        facing[l] = (over[l] > tolerance) & (under[l] > tolerance);
        near[l] = vplDot(way, way) < near2 * larger;
    }
    estimate->facing = estimate->near = 0;
    for (int l = 0; l < LANES; l++) {
        estimate->facing |= (uint32_t)facing[l] << l;
        estimate->near |= (uint32_t)near[l] << l;
    }
    if (estimate->facing == 0) {
        return;
    }
    for (int p = 0; p < VPL_QUADRATURE_POINTS; p++) {
        const vplVec3 from = vplGetLane(a->quadrature[p], lane);
        for (int q = 0; q < VPL_QUADRATURE_POINTS; q++) {
            for (int l = 0; l < LANES; l++) {
                sum[l] += termOf(vplSub(vplGetLane(b->quadrature[q], l), from), n, vplGetLane(b->normal, l));
            }
        }
    }
    for (int l = 0; l < LANES; l++) {
        sum[l] *= 1.0f / (VPL_QUADRATURE_POINTS * VPL_QUADRATURE_POINTS);
    }
    memcpy(estimate->mean, sum, sizeof sum);
}

static inline float largestOf(float x, float y, float z)
{
    const float ax = fabsf(x), ay = fabsf(y), az = fabsf(z), axy = ax > ay ? ax : ay;
    return axy > az ? axy : az;
}

// Directions are those of vplWayToLight.
void VPL_KERNEL(vplPointTerms)(const float point[3], const float normal[3], const float to[3][LANES],
                               const float toNormal[3][LANES], float termOut[LANES],
                               float directionOut[3][LANES])
{
    const vplVec3 p = vplVec(point[0], point[1], point[2]), n = vplVec(normal[0], normal[1], normal[2]);
    const float largest = largestOf(p.x, p.y, p.z);
    float term[LANES], direction[3][LANES];
    for (int l = 0; l < LANES; l++) {
        const float tx = to[0][l], ty = to[1][l], tz = to[2][l];
        const float mx = toNormal[0][l], my = toNormal[1][l], mz = toNormal[2][l];
        const float b = largestOf(tx, ty, tz);
        const float lift = (b > largest ? b : largest) * 0x1p-18f;
        const float x = tx + lift * mx - p.x, y = ty + lift * my - p.y, z = tz + lift * mz - p.z;
        const float w = largestOf(x, y, z);
        const float length = w > 2 * lift ? w : 2 * lift;
        const float scale = 1 - lift / (length > 0x1p-126f ? length : 0x1p-126f);
        term[l] = termOf(vplVec(tx - p.x, ty - p.y, tz - p.z), n, vplVec(mx, my, mz));
        direction[0][l] = scale * x;
        direction[1][l] = scale * y;
        direction[2][l] = scale * z;
    }
    memcpy(termOut, term, sizeof term);
    memcpy(directionOut, direction, sizeof direction);
}

// ---- rows

double VPL_KERNEL(vplScaledSum)(const float* row, const double* scale, int count)
{
    double sum[LANES] = {0};
    int j = 0;
    for (; j + LANES <= count; j += LANES) {
        for (int l = 0; l < LANES; l++) {
            sum[l] += (double)row[j + l] * scale[j + l];
        }
    }
    double all = 0;
    for (int l = 0; l < LANES; l++) {
        all += sum[l];
    }
    for (; j < count; j++) {
        all += (double)row[j] * scale[j];
    }
    return all;
}

void VPL_KERNEL(vplScaleRow)(float* row, double rowScale, const double* scale, int count)
{
    for (int j = 0; j < count; j++) {
        row[j] = (float)((double)row[j] * (rowScale * scale[j]));
    }
}
