#include "cli/bench.h"
int runScaling(const Arguments* a)
{
    (void)a;
    return 0;
}
