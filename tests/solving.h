// SPDX-License-Identifier: MIT
// Solves B = E + rho F B for tests.
#ifndef VPL_TESTS_SOLVING_H
#define VPL_TESTS_SOLVING_H

#include "exchange.h"

#include "base/hash.h"

#include <float.h>
#include <stdlib.h>

extern const vplSolver SOLVERS[];

vplSolveDef sweeps(vplSolver solver, int iterations);

// Solves from the initial value B = E.
vplSolveStats solve(const Exchange* e, const vplSolveDef* def, const vplRgb* source, vplRgb* radiosity);

vplRgb grey(double x);

// Asserts a tolerance relative to the wanted value.
void assertRatio(double value, double wanted, double tolerance, const char* what, int row);

enum { MANY = 300 }; // more than one block and one chunk, no multiple of either

void fillSources(vplRgb* source, int count, uint64_t seed);

// Returns the irradiance inside a sphere, equal everywhere: H = sum a E / (1 - sum a rho), where a is a
// side's share of the area.
double sphereIrradiance(const Exchange* e, const vplRgb* source, int channel);
// Makes the unit cube's six faces. The factor of opposite faces is C-11 in Howell's catalogue; all factors
// are those of ff_analytic.csv.
void openCube(Exchange* e, vplContext* context, float rho);

#endif
