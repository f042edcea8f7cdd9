// SPDX-License-Identifier: MIT
// The parts of report.html.
#ifndef VPL_CLI_TRADEOFF_REPORT_H
#define VPL_CLI_TRADEOFF_REPORT_H

#include "cli/tradeoff/tradeoff.h"

void addAnswers(const Tradeoff* t, Text* html);  // words and table: which settings for 5 % error
void addPictures(const Tradeoff* t, Text* html); // the front beside the truth
void addClamp(const Tradeoff* t, Text* html);    // error and energy against --min-distance
void addKnobs(const Tradeoff* t, Text* html);
void addMethod(const Tradeoff* t, Text* html); // how it was measured, what was left out, all settings

#endif
