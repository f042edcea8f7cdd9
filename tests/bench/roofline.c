// SPDX-License-Identifier: MIT
// Compares the hot loops with the limits of the machine: bench/roofline [--isa I] [--rounds N] [--loop NAME]
//   first table   peaks: arithmetic, conversions, table look-ups and bandwidth, per instruction set, on one
//                 thread and on all; measured by loops that do nothing else (roofline/peaks_kernel.c)
//   second table  each hot loop on one thread: its rate, cycles per 16 lanes, its roof from the operations
//                 in its source (roofline/loops.c), the share of the roof reached, the limiting resource
//   below it      for loops below half of their roof: the gain from vectors, and variants with one change;
//                 a variant that is faster shows what limits the loop
// With --loop NAME that loop alone runs for ten seconds, for a profiler. The program measures processor time
// of the thread in rounds and prints the best round, because other load on the machine only makes rounds
// slower.
#include "roofline/roofline.h"

#include "base/isa.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { MOST_THREADS = 64, MOST_LOOPS = 32 };

static const char* const PEAK_NAMES[PEAK_COUNT] = {"multiply and add, both counted",
                                                   "multiply",
                                                   "add",
                                                   "fused multiply-add, counted twice",
                                                   "double: multiply and add",
                                                   "divide",
                                                   "square root",
                                                   "float to double",
                                                   "double to float",
                                                   "float to int",
                                                   "look-ups, table of 16 KB",
                                                   "look-ups, table of 512 KB",
                                                   "L1 read, bytes",
                                                   "L1 write",
                                                   "L1 copy, read + written",
                                                   "L2 read",
                                                   "L2 write",
                                                   "L2 copy, read + written",
                                                   "memory read",
                                                   "memory write",
                                                   "memory copy, read + written",
                                                   "clock, cycles"};

typedef struct Bench {
    vplContext* context; // with all threads
    int threads, rounds;
    Arena arenas[MOST_THREADS];
    double one[VPL_ISA_COUNT][PEAK_COUNT], all[VPL_ISA_COUNT][PEAK_COUNT]; // per second
    double loops[VPL_ISA_COUNT][MOST_LOOPS];
} Bench;

static double threadSeconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double larger(double a, double b)
{
    return a > b ? a : b;
}

// ---- peaks

typedef struct PeakRun {
    Bench* bench;
    PeakFcn* run;
    Peak peak;
    double rates[MOST_THREADS];
} PeakRun;

static void runPeakTask(void* data, int task, int worker)
{
    (void)worker;
    PeakRun* p = data;
    double done = 0, start = threadSeconds(), seconds;
    do {
        done += p->run(&p->bench->arenas[task], p->peak);
        seconds = threadSeconds() - start;
    } while (seconds < 2e-3);
    p->rates[task] = done / seconds;
}

static double peakRate(Bench* b, vplIsa isa, Peak peak, int threads)
{
    PeakRun p = {b, getPeak(isa), peak, {0}};
    double sum = 0;
    if (threads == 1) {
        runPeakTask(&p, 0, 0);
    } else {
        vplParallelFor(b->context, threads, runPeakTask, &p);
    }
    for (int i = 0; i < threads; i++) {
        sum += p.rates[i];
    }
    return sum;
}

static void openArena(Arena* a)
{
    memset(a, 0, sizeof *a);
    a->memory = aligned_alloc(64, MEMORY_BYTES);
    a->results = aligned_alloc(64, WAYS * sizeof *a->results);
    a->index = malloc(2 * WAYS * sizeof *a->index);
    if (a->memory == NULL || a->results == NULL || a->index == NULL) {
        exit(1);
    }
    for (size_t i = 0; i < MEMORY_BYTES / sizeof(float); i++) {
        a->memory[i] = 1.5f;
    }
    uint32_t state = 1;
    for (int i = 0; i < 2 * WAYS; i++) {
        state = state * 1664525 + 1013904223;
        a->index[i] = (int32_t)((state >> 8) % ((i < WAYS ? L1_BYTES : TABLE_BYTES) / sizeof(float)));
    }
}

static void closeArena(Arena* a)
{
    free(a->memory);
    free(a->results);
    free(a->index);
}

// ---- loops

static double loopRate(const Loop* loop, Work* work)
{
    double done = 0, start = threadSeconds(), seconds;
    do {
        done += loop->run(work, loop->which);
        seconds = threadSeconds() - start;
    } while (seconds < 10e-3);
    return done / seconds;
}

// Returns the time of one item in seconds, by the resource that takes longest, and that resource's name. The
// model assumes that all resources work in parallel.
static double roofSeconds(const Costs* c, const double* peak, const char** what)
{
    const struct {
        const char* name;
        double seconds;
    } bounds[] = {
        {"arithmetic", (c->mul + c->add + c->other) / peak[PEAK_MUL_ADD]},
        {"multiplying", c->mul / peak[PEAK_MUL]},
        {"adding", c->add / peak[PEAK_ADD]},
        {"double", c->doubles / peak[PEAK_DOUBLE]},
        {"dividing", c->divide / peak[PEAK_DIVIDE] + c->root / peak[PEAK_ROOT]},
        {"converting", c->toFloat / peak[PEAK_TO_FLOAT] + c->toInt / peak[PEAK_TO_INT]},
        {"look-ups", c->gather / peak[PEAK_GATHER_L1]},
        {"L1 reads", c->read / peak[PEAK_READ_L1]},
        {"L1 writes", c->written / peak[PEAK_WRITE_L1]},
    };
    double most = 0;
    for (size_t i = 0; i < sizeof bounds / sizeof *bounds; i++) {
        if (bounds[i].seconds > most) {
            most = bounds[i].seconds;
            *what = bounds[i].name;
        }
    }
    return most;
}

// ---- all

static void measureIsa(Bench* b, vplIsa isa)
{
    Work* work = openWork(isa);
    for (int round = 0; round < b->rounds; round++) {
        for (int p = 0; p < PEAK_COUNT; p++) {
            b->one[isa][p] = larger(b->one[isa][p], peakRate(b, isa, (Peak)p, 1));
        }
        for (int p = 0; p < PEAK_COUNT; p++) {
            b->all[isa][p] = larger(b->all[isa][p], peakRate(b, isa, (Peak)p, b->threads));
        }
        for (int i = 0; i < LOOP_COUNT; i++) {
            b->loops[isa][i] = larger(b->loops[isa][i], loopRate(&LOOPS[i], work));
        }
    }
    closeWork(work);
}

static void printPeaks(const Bench* b, const bool* wanted)
{
    printf("peaks, G/s: one thread, %d threads\n%-35s", b->threads, "");
    for (int isa = VPL_ISA_SCALAR; isa < VPL_ISA_COUNT; isa++) {
        if (wanted[isa]) {
            printf(" %16s", vplIsa_GetName((vplIsa)isa));
        }
    }
    for (int p = 0; p < PEAK_COUNT; p++) {
        printf("\n%-35s", PEAK_NAMES[p]);
        for (int isa = VPL_ISA_SCALAR; isa < VPL_ISA_COUNT; isa++) {
            if (wanted[isa] && b->one[isa][p] > 0) {
                printf(" %7.2f %8.2f", 1e-9 * b->one[isa][p], 1e-9 * b->all[isa][p]);
            } else if (wanted[isa]) {
                printf(" %7s %8s", "-", "-");
            }
        }
    }
    printf("\n");
}

// Returns the index of the loop that variants refer to.
static int findLoop(const char* name)
{
    for (int i = 0; i < LOOP_COUNT; i++) {
        if (strcmp(LOOPS[i].name, name) == 0) {
            return i;
        }
    }
    abort();
}

static double shareOfRoof(const Bench* b, vplIsa isa, int loop, const char** what)
{
    return b->loops[isa][loop] * roofSeconds(&LOOPS[loop].costs, b->one[isa], what);
}

// Explains a loop far from its roof by measurements: the gain from vector width, and the loop's variants.
static void explainLoop(const Bench* b, vplIsa isa, int loop)
{
    const double gain = b->loops[isa][loop] / b->loops[VPL_ISA_SCALAR][loop];
    printf("  %s", LOOPS[loop].name);
    if (isa != VPL_ISA_SCALAR) {
        printf(": %.2f times as fast as without vectors%s", gain,
               gain < 1.5 ? "; most of it runs lane by lane, or waits" : "");
    }
    printf("\n");
    for (int i = 0; i < LOOP_COUNT; i++) {
        if (LOOPS[i].probeOf != NULL && findLoop(LOOPS[i].probeOf) == loop) {
            printf("    %5.2f times as fast where %s\n", b->loops[isa][i] / b->loops[isa][loop],
                   LOOPS[i].question);
        }
    }
}

static void printLoops(const Bench* b, vplIsa isa)
{
    const char* what = "";
    printf("\n%s, one thread\n%-24s %-14s %9s %10s %9s %7s  %s\n", vplIsa_GetName(isa), "loop", "item", "G/s",
           "cycles/16", "roof G/s", "reached", "the roof");
    for (int i = 0; i < LOOP_COUNT; i++) {
        if (LOOPS[i].probeOf == NULL) {
            double share = shareOfRoof(b, isa, i, &what);
            printf("%-24s %-14s %9.3f %9.2f %10.1f %9.3f %5.0f %%  %s\n", LOOPS[i].name, LOOPS[i].item,
                   1e-9 * b->loops[isa][i], b->loops[isa][i] / b->loops[VPL_ISA_SCALAR][i],
                   16 * b->one[isa][PEAK_CLOCK] / b->loops[isa][i], 1e-9 * b->loops[isa][i] / share,
                   100 * share, what);
        }
    }
    printf("below half of the roof:\n");
    for (int i = 0; i < LOOP_COUNT; i++) {
        if (LOOPS[i].probeOf == NULL && shareOfRoof(b, isa, i, &what) < 0.5) {
            explainLoop(b, isa, i);
        }
    }
}

// Runs one loop alone, for a profiler.
static int runAlone(const char* name, vplIsa isa)
{
    const Loop* loop = &LOOPS[findLoop(name)];
    Work* work = openWork(isa);
    double best = 0;
    for (int i = 0; i < 1000; i++) {
        best = larger(best, loopRate(loop, work));
    }
    printf("%s, %s: %.3f G%s/s\n", loop->name, vplIsa_GetName(isa), 1e-9 * best, loop->item);
    closeWork(work);
    return 0;
}

static vplIsa isaNamed(const char* name)
{
    int isa = VPL_ISA_COUNT - 1;
    while (isa > 0 && strcmp(vplIsa_GetName((vplIsa)isa), name) != 0) {
        isa--;
    }
    return (vplIsa)isa;
}

int main(int argc, char** argv)
{
    static Bench b;
    vplIsa only = VPL_ISA_AUTO;
    const char* loop = NULL;
    b.rounds = 7;
    for (int i = 1; i + 1 < argc; i += 2) {
        if (strcmp(argv[i], "--isa") == 0) {
            only = isaNamed(argv[i + 1]);
        } else if (strcmp(argv[i], "--rounds") == 0) {
            b.rounds = atoi(argv[i + 1]);
        } else if (strcmp(argv[i], "--loop") == 0) {
            loop = argv[i + 1];
        }
    }
    if (loop != NULL) {
        return runAlone(loop, only);
    }
    if (vplContext_Create(NULL, &b.context) != VPL_SUCCESS || LOOP_COUNT > MOST_LOOPS) {
        return 1;
    }
    b.threads = vplContext_GetWorkerCount(b.context);
    b.threads = b.threads < MOST_THREADS ? b.threads : MOST_THREADS;
    for (int i = 0; i < b.threads; i++) {
        openArena(&b.arenas[i]);
    }
    bool wanted[VPL_ISA_COUNT] = {false};
    for (int isa = VPL_ISA_SCALAR; isa < VPL_ISA_COUNT; isa++) {
        wanted[isa] =
            vplHasIsa((vplIsa)isa) && (only == VPL_ISA_AUTO || only == (vplIsa)isa || isa == VPL_ISA_SCALAR);
        if (wanted[isa]) {
            measureIsa(&b, (vplIsa)isa);
        }
    }
    printPeaks(&b, wanted);
    for (int isa = VPL_ISA_SCALAR; isa < VPL_ISA_COUNT; isa++) {
        if (wanted[isa]) {
            printLoops(&b, (vplIsa)isa);
        }
    }
    for (int i = 0; i < b.threads; i++) {
        closeArena(&b.arenas[i]);
    }
    vplContext_Destroy(b.context);
    return 0;
}
