// SPDX-License-Identifier: MIT
// Compares frames of a scene rendered with and without a history, in alternation: medians of processor time,
// of its system time, and of the pages that the operating system's kernel had to clear.
// `bench/history SCENE [METHOD [WIDTH HEIGHT [RUNS]]]`; METHOD: direct (default), interleaved or ssvp.
#include "bench.h"

#include <string.h>
#include <sys/resource.h>

enum { WAYS = 2, MOST_RUNS = 101 };

typedef struct Way {
    const char* name;
    vplContext* context;
    vplScene* scene;
    vplHistory* history;
    double wall[MOST_RUNS], cpu[MOST_RUNS], kernel[MOST_RUNS], pages[MOST_RUNS];
    size_t peak;
} Way;

static double kernelMs(const struct rusage* u)
{
    return (double)u->ru_stime.tv_sec * 1e3 + (double)u->ru_stime.tv_usec * 1e-3;
}

static uint64_t runOnce(Way* way, vplRenderOptions options, int run)
{
    struct rusage before, after;
    vplImage* image;
    vplRenderStats stats;
    options.sequence.history = way->history;
    options.sequence.frame = run;
    const double wall = wallMs(), cpu = cpuMs();
    getrusage(RUSAGE_SELF, &before);
    check(vplRender(way->scene, &options, &image, &stats));
    vplImage_Destroy(image);
    getrusage(RUSAGE_SELF, &after);
    way->peak = stats.peakBytes;
    if (run >= 0) {
        way->wall[run] = wallMs() - wall;
        way->cpu[run] = cpuMs() - cpu;
        way->kernel[run] = kernelMs(&after) - kernelMs(&before);
        way->pages[run] = (double)(after.ru_minflt - before.ru_minflt);
    }
    return stats.imageHash;
}

int main(int count, char** words)
{
    static Way ways[WAYS] = {{.name = "none"}, {.name = "history"}};
    if (count < 2) {
        fprintf(stderr, "usage: history SCENE [METHOD [WIDTH HEIGHT [RUNS]]]\n");
        return 2;
    }
    const char* method = count > 2 ? words[2] : "direct";
    vplRenderOptions options = plainOptions();
    options.method = strcmp(method, "direct") == 0 ? VPL_METHOD_DIRECT
                     : strcmp(method, "ssvp") == 0 ? VPL_METHOD_SSVP
                                                   : VPL_METHOD_INSTANT_RADIOSITY;
    if (options.method == VPL_METHOD_INSTANT_RADIOSITY) {
        options.pipeline.kind = VPL_ACCUMULATE_INTERLEAVED;
        options.particles.placement = VPL_PLACEMENT_RSM;
        options.particles.count = 256;
    }
    options.output.width = count > 4 ? atoi(words[3]) : 1920;
    options.output.height = count > 4 ? atoi(words[4]) : 1080;
    const int runs = count > 5 && atoi(words[5]) < MOST_RUNS ? atoi(words[5]) : 15;
    for (int w = 0; w < WAYS; w++) {
        openScene(words[1], 0, VPL_ISA_AUTO, &ways[w].context, &ways[w].scene);
        if (w > 0) {
            check(vplHistory_Create(ways[w].context, &ways[w].history));
        }
    }
    for (int run = -2; run < runs; run++) {
        uint64_t hashes[WAYS];
        for (int w = 0; w < WAYS; w++) {
            hashes[w] = runOnce(&ways[w], options, run);
        }
        if (hashes[0] != hashes[1]) {
            fprintf(stderr, "history: frame %d is another picture\n", run);
            return 1;
        }
    }
    printf("%s, %s, %dx%d, medians of %d frames\n", words[1], method, options.output.width,
           options.output.height, runs);
    printf("%-17s %9s %9s %10s %8s %8s\n", "history of", "wall ms", "cpu ms", "kernel ms", "pages",
           "peak MB");
    for (int w = 0; w < WAYS; w++) {
        Way* way = &ways[w];
        printf("%-17s %9.1f %9.1f %10.1f %8.0f %8.0f\n", way->name, medianOf(way->wall, runs),
               medianOf(way->cpu, runs), medianOf(way->kernel, runs), medianOf(way->pages, runs),
               (double)way->peak / (1 << 20));
        vplHistory_Destroy(way->history);
        vplScene_Destroy(way->scene);
        vplContext_Destroy(way->context);
    }
    return 0;
}
