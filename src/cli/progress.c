// SPDX-License-Identifier: MIT
#include "cli/bench/measure.h"
#include "cli/cli.h"

#include <signal.h>
#include <stdio.h>
#include <unistd.h>

static volatile sig_atomic_t interrupted;
static volatile double firstInterrupt; // ms; read and written by the handler alone

// The second signal ends the program, unless it follows at once, because timeout(1) sends every signal twice.
static void onInterrupt(int number)
{
    if (!interrupted) {
        firstInterrupt = wallMs();
        interrupted = 1;
    } else if (wallMs() - firstInterrupt > 500) {
        signal(number, SIG_DFL);
        raise(number);
    }
}

void catchInterrupts(void)
{
    struct sigaction action = {.sa_handler = onInterrupt};
    sigaddset(&action.sa_mask, SIGINT);
    sigaddset(&action.sa_mask, SIGTERM);
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
}

bool askInterrupts(void* user, double fraction)
{
    (void)user;
    (void)fraction;
    return !interrupted;
}

Progress beginProgress(bool quiet)
{
    const double now = 1e-3 * wallMs();
    return (Progress){now, now, quiet, isatty(STDERR_FILENO)};
}

bool showProgress(void* user, double fraction)
{
    Progress* p = user;
    const double time = 1e-3 * wallMs();
    if (!p->quiet && time - p->last > (p->terminal ? 0.1 : 10) && fraction > 0) {
        const int left = (int)((time - p->start) * (1 - fraction) / fraction);
        if (p->terminal) {
            char bar[41] = "";
            for (int i = 0; i < 40; i++) {
                bar[i] = i < (int)(40 * fraction) ? '#' : '.';
            }
            fprintf(stderr, "\r[%s] %3d %%  %d:%02d left ", bar, (int)(100 * fraction), left / 60, left % 60);
            fflush(stderr);
        } else {
            complain("%d %%, %d:%02d left", (int)(100 * fraction), left / 60, left % 60);
        }
        p->last = time;
    }
    return !interrupted;
}

void endProgress(Progress* progress)
{
    if (!progress->quiet && progress->terminal && progress->last > progress->start) {
        fputs("\r\033[K", stderr);
    }
}
