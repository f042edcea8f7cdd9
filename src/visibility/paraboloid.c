// SPDX-License-Identifier: MIT
// Based on: Wolfgang Heidrich and Hans-Peter Seidel, View-independent Environment Maps, Graphics Hardware 1998.
#include <vpl/visibility.h>

#include <math.h>

bool vplParaboloid_Project(vplVec3 direction, double* x, double* y)
{
    const double dx = (double)direction.x, dy = (double)direction.y, dz = (double)direction.z;
    // The largest component is brought to 1, so that no square underflows or overflows.
    const double largest = fmax(fabs(dx), fmax(fabs(dy), fabs(dz)));
    if (!(largest > 0) || !isfinite(dx + dy + dz)) {
        return false;
    }
    const double a = dx / largest, b = dy / largest, c = dz / largest;
    const double across = a * a + b * b, length = sqrt(across + c * c);
    if (!(across > 0) && c < 0) {
        return false;
    }
    // 1 / (|d| + z); behind the plane the difference would cancel, and (|d| - z) / (|d|^2 - z^2) does not.
    const double scale = c >= 0 ? 1 / (length + c) : (length - c) / across;
    *x = a * scale;
    *y = b * scale;
    return true;
}

vplVec3 vplParaboloid_Unproject(double x, double y)
{
    const double r2 = x * x + y * y, scale = 1 / (1 + r2);
    return (vplVec3){(float)(2 * x * scale), (float)(2 * y * scale), (float)((1 - r2) * scale)};
}

double vplParaboloid_Weight(double x, double y)
{
    const double r2 = x * x + y * y, s = 1 + r2;
    return r2 < 1 ? 4 * (1 - r2) / (s * s * s) : 0;
}
