// SPDX-License-Identifier: MIT
// Sides and form factors made by hand, for tests of what is done with them.
#ifndef VPL_TESTS_EXCHANGE_H
#define VPL_TESTS_EXCHANGE_H

#include "test.h"

typedef struct Exchange {
    vplPatchSide* side; // to be filled in: area 1, reflectance 0.5, nothing else
    float* rows;        // [i][j], all 0
    vplPatchSides sides;
    vplFormFactors factors;
    vplTransport transport;
} Exchange;

void openExchange(Exchange* exchange, vplContext* context, int count);
void freeExchange(Exchange* exchange);

// Closed: F_ij = A_j / sum of areas, as inside of a sphere; areas and reflectances drawn from `seed`.
void fillSphere(Exchange* exchange, uint64_t seed);

void setReflectance(Exchange* exchange, float rho);

#endif
