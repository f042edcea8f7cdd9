// SPDX-License-Identifier: MIT
#include "cli/cli.h"

int runBench(const Arguments* a)
{
    (void)a;
    return 0;
}
