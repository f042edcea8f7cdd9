// SPDX-License-Identifier: MIT
#include "cli/cli.h"

int runInfo(const Arguments* a)
{
    (void)a;
    return 0;
}
