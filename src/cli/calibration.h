// SPDX-License-Identifier: MIT
// The speeds of this machine, by which times are predicted: measured once and kept in the user's cache folder.
#ifndef VPL_CLI_CALIBRATION_H
#define VPL_CLI_CALIBRATION_H

#include "cli/cli.h"

// Gives the context the speeds that the cache folder has. Where it has none and `a` is a render with a budget, measures and
// keeps them; without a folder to keep them in, the usual speeds serve. Only memory that runs out is an error; -v says
// a line.
vplResult findSpeeds(const Arguments* a, vplContext* context);

// vpl bench --calibrate: measures, keeps and prints the speeds.
int runCalibration(const Arguments* a);

#endif
