// SPDX-License-Identifier: MIT
// Makes sides and form factors by hand, for tests of the solvers that use them.
#ifndef VPL_TESTS_EXCHANGE_H
#define VPL_TESTS_EXCHANGE_H

#include "test.h"

typedef struct Exchange {
    vplPatchSide* side; // for the test to fill in: area 1, reflectance 0.5, everything else 0
    float* rows;        // [i][j], all 0
    vplPatchSides sides;
    vplFormFactors factors;
    vplTransport transport;
} Exchange;

void openExchange(Exchange* exchange, vplContext* context, int count);
void freeExchange(Exchange* exchange);

// Fills a closed exchange: F_ij = A_j / sum of areas, as on the inside of a sphere; areas and reflectances
// are drawn from `seed`.
void fillSphere(Exchange* exchange, uint64_t seed);

void setReflectance(Exchange* exchange, float rho);

#endif
