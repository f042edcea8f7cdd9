// SPDX-License-Identifier: MIT
// The exchange between all points of two nodes of the hierarchy.
#include "radiosity/radiosity_kernels.h"

enum { POINTS = VPL_LINK_POINTS };

// A sum in an order that suits vectors.
static inline float sumOf(const float x[POINTS])
{
    return ((x[0] + x[4]) + (x[2] + x[6])) + ((x[1] + x[5]) + (x[3] + x[7]));
}

void VPL_KERNEL(vplLinkTerms_Find)(const vplLinkPoints* p, const vplLinkPoints* q, vplLinkTerms* out)
{
    const float scale = (float)(1 / VPL_PI);
    float columns[POINTS] = {0};
    for (int i = 0; i < POINTS; i++) {
        const float x = p->at[0][i], y = p->at[1][i], z = p->at[2][i];
        const float nx = p->normal[0][i], ny = p->normal[1][i], nz = p->normal[2][i];
        const float weight = p->weight[i];
        float terms[POINTS], weighted[POINTS];
        for (int k = 0; k < POINTS; k++) {
            const float dx = q->at[0][k] - x, dy = q->at[1][k] - y, dz = q->at[2][k] - z;
            const float square = dx * dx + dy * dy + dz * dz;
            const float there = dx * nx + dy * ny + dz * nz;
            const float back = -(dx * q->normal[0][k] + dy * q->normal[1][k] + dz * q->normal[2][k]);
            const float inverse = 1 / (square > 1e-37f ? square : 1e-37f);
            const float term = scale * (there * inverse) * (back * inverse);
            const bool facing = (there > 0) & (back > 0);
            terms[k] = facing ? term : 0.0f;
            weighted[k] = terms[k] * q->weight[k];
            columns[k] += weight * terms[k];
        }
        for (int k = 0; k < POINTS; k++) {
            out->of[i][k] = terms[k];
        }
        out->rows[i] = sumOf(weighted);
    }
    for (int k = 0; k < POINTS; k++) {
        out->columns[k] = columns[k];
    }
}
