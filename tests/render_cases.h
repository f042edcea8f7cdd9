// SPDX-License-Identifier: MIT
// Tiny renders of every method with each of its pipelines and variants, and of everything that --show shows.
#ifndef VPL_TESTS_RENDER_CASES_H
#define VPL_TESTS_RENDER_CASES_H

#include "test.h"

enum { MOST_RENDER_CASES = 200 };

// Lists the cases that are not refused; returns their number.
int listRenderCases(vplContext* context, int cases[MOST_RENDER_CASES]);

// The scene file of case i.
const char* renderCaseScene(int i);

// The options of case i, and their words in *wordsOut, which the next call overwrites.
vplRenderOptions renderCaseOptions(int i, const char** wordsOut);

#endif
