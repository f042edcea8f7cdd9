// SPDX-License-Identifier: MIT
// Triangles for tests of form factors, from tables and at random.
#ifndef VPL_TESTS_FACTOR_CASES_H
#define VPL_TESTS_FACTOR_CASES_H

#include "shapes.h"

vplVec3 cornerOf(const Table* t, int row, const char* letter, int i);

void swapCorners(vplVec3 t[3]);

// Returns the form factor of the winding of b that a sees: the tables do not say which side is the front.
// Reverses b if needed.
double factorOfEitherSide(const vplVec3 a[3], vplVec3 b[3]);

void assertRelative(double value, double wanted, double tolerance, const char* what, int row);

vplVec3 rollPoint(uint64_t seed, uint64_t index, float size, vplVec3 at);

// Makes two random triangles, up to 8 apart, whose sizes differ by up to a factor of ten; b is wound so that
// a sees it. About half of the pairs cross each other's planes.
void rollPair(uint64_t seed, vplVec3 a[3], vplVec3 b[3]);

double areaOf(const vplVec3 t[3]);

enum { MOST_CASES = 2000 };

#endif
