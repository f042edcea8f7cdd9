// SPDX-License-Identifier: MIT
// The PCF factor of one point: the share of stored distances that shadow it, and what a disc of samples gives on average.
#include <vpl/formulas.h>

#include <stdio.h>

int main(void)
{
    const double stored[] = {1.5, 1.6, 1.99, 2.4}; // metres, around a point at 2 m
    const double shadow = vplFormula_Pcf(2, 0.02, stored, 4);
    const double beside = vplFormula_PcfAtEdge(VPL_PCF_DISC, 0.5);
    printf("%g of the samples, %g at half a radius from an edge\n", shadow, beside);
    return shadow == 0.5 && beside > 0.19 && beside < 0.2 ? 0 : 1;
}
