// SPDX-License-Identifier: MIT
// Solving B = E + rho F B in tests.
#ifndef VPL_TESTS_SOLVING_H
#define VPL_TESTS_SOLVING_H

#include "exchange.h"

#include "base/hash.h"

#include <float.h>
#include <stdlib.h>

extern const vplSolver SOLVERS[];

vplSolveDef sweeps(vplSolver solver, int iterations);

// From B = E.
vplSolveStats solve(const Exchange* e, const vplSolveDef* def, const vplRgb* source, vplRgb* radiosity);

vplRgb grey(double x);

// Relative to the wanted value.
void assertRatio(double value, double wanted, double tolerance, const char* what, int row);

enum { MANY = 300 }; // more than one block and one chunk, no multiple of either

void fillSources(vplRgb* source, int count, uint64_t seed);

// Inside of a sphere all receive the same: H = sum a E / (1 - sum a rho), a the shares of area.
double sphereIrradiance(const Exchange* e, const vplRgb* source, int channel);
// The unit cube's faces; opposite ones: Howell's catalogue, C-11; both as in ff_analytic.csv.
void openCube(Exchange* e, vplContext* context, float rho);

#endif
