// SPDX-License-Identifier: MIT
#include "factor_cases.h"

vplVec3 cornerOf(const Table* t, int row, const char* letter, int i)
{
    char prefix[8];
    snprintf(prefix, sizeof prefix, "%s%d", letter, i);
    return vectorOf(t, row, prefix);
}

void swapCorners(vplVec3 t[3])
{
    const vplVec3 swap = t[1];
    t[1] = t[2];
    t[2] = swap;
}

double factorOfEitherSide(const vplVec3 a[3], vplVec3 b[3])
{
    const double f = vplTriangleFormFactor(a, b);
    if (f > 0) {
        return f;
    }
    swapCorners(b);
    return vplTriangleFormFactor(a, b);
}

void assertRelative(double value, double wanted, double tolerance, const char* what, int row)
{
    assertNear(value / wanted, 1, tolerance, what, row);
}

vplVec3 rollPoint(uint64_t seed, uint64_t index, float size, vplVec3 at)
{
    return (vplVec3){at.x + size * (float)(uniformAt(seed, 3 * index) - 0.5),
                     at.y + size * (float)(uniformAt(seed, 3 * index + 1) - 0.5),
                     at.z + size * (float)(uniformAt(seed, 3 * index + 2) - 0.5)};
}

void rollPair(uint64_t seed, vplVec3 a[3], vplVec3 b[3])
{
    const float size = powf(10, (float)(uniformAt(seed, 100) * 2 - 1)),
                apart = 8 * (float)uniformAt(seed, 101);
    for (uint64_t i = 0; i < 3; i++) {
        a[i] = rollPoint(seed, i, 1, (vplVec3){0, 0, 0});
        b[i] = rollPoint(seed, 3 + i, size, (vplVec3){0, 0, apart});
    }
    if (vplTriangleFormFactor(a, b) == 0) {
        swapCorners(b);
    }
}

double areaOf(const vplVec3 t[3])
{
    const double ux = (double)t[1].x - t[0].x, uy = (double)t[1].y - t[0].y, uz = (double)t[1].z - t[0].z;
    const double vx = (double)t[2].x - t[0].x, vy = (double)t[2].y - t[0].y, vz = (double)t[2].z - t[0].z;
    const double x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
    return 0.5 * sqrt(x * x + y * y + z * z);
}
