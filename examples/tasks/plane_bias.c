// SPDX-License-Identifier: MIT
// The bias of a plane: at 2 m and 60 degrees to the light, with samples that are off by half a degree.
#include <vpl/formulas.h>
#include <vpl/vecmath.h>

#include <stdio.h>

int main(void)
{
    const double bias = vplFormula_PlaneBias(2, VPL_PI / 3, VPL_PI / 360);
    printf("%.6f m\n", bias);
    return bias > 0.029 && bias < 0.031 ? 0 : 1;
}
