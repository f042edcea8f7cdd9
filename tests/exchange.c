// SPDX-License-Identifier: MIT
#include "exchange.h"

#include <stdlib.h>

void openExchange(Exchange* e, vplContext* context, int count)
{
    memset(e, 0, sizeof *e);
    e->side = calloc((size_t)count + 1, sizeof *e->side);
    e->rows = calloc((size_t)count * (size_t)count + 1, sizeof *e->rows);
    assert_true(e->side != NULL && e->rows != NULL);
    for (int i = 0; i < count; i++) {
        e->side[i].area = 1;
        e->side[i].open = 0xffff;
    }
    e->sides = (vplPatchSides){.sides = e->side, .count = count, .context = context};
    e->factors = (vplFormFactors){.count = count, .rows = e->rows, .context = context};
    e->transport = (vplTransport){.sides = &e->sides, .factors = &e->factors};
    setReflectance(e, 0.5f);
}

void freeExchange(Exchange* e)
{
    free(e->side);
    free(e->rows);
}

void setReflectance(Exchange* e, float rho)
{
    for (int i = 0; i < e->sides.count; i++) {
        e->side[i].reflectance = (vplRgb){rho, rho, rho};
    }
}

void fillSphere(Exchange* e, uint64_t seed)
{
    const int count = e->sides.count;
    double area = 0;
    for (int i = 0; i < count; i++) {
        const uint64_t at = 4 * (uint64_t)i;
        e->side[i].area = (float)(0.5 + uniformAt(seed, at));
        e->side[i].reflectance =
            (vplRgb){(float)(0.9 * uniformAt(seed, at + 1)), (float)(0.9 * uniformAt(seed, at + 2)),
                     (float)(0.9 * uniformAt(seed, at + 3))};
        area += (double)e->side[i].area;
    }
    for (int i = 0; i < count; i++) {
        for (int j = 0; j < count; j++) {
            e->rows[(size_t)i * (size_t)count + (size_t)j] = (float)((double)e->side[j].area / area);
        }
    }
}
