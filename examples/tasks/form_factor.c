// SPDX-License-Identifier: MIT
// The form factor of two triangles: the halves of two unit squares, 1 m apart, that face each other.
#include <vpl/radiosity.h>

#include <stdio.h>

int main(void)
{
    const vplVec3 below[3] = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}};
    const vplVec3 above[3] = {{0, 1, 0}, {1, 1, 0}, {0, 1, 1}};
    const double factor = vplTriangleFormFactor(below, above);
    printf("%.6f\n", factor);
    return factor > 0.1 && factor < 0.12 ? 0 : 1;
}
