// SPDX-License-Identifier: MIT
// The program: parses words, calls the public API, prints. Everything of substance is in the library.
#ifndef VPL_CLI_CLI_H
#define VPL_CLI_CLI_H

#include <vpl/vpl.h>

enum { EXIT_DONE = 0, EXIT_COULD_NOT = 1, EXIT_USAGE = 2 };

enum { MAX_POSITIONALS = 2, MAX_THREAD_COUNTS = 8, MAX_FRAMES = 100000 };

// What the base of vpl tradeoff differs in from the defaults of vpl render: a size that allows many pictures,
// enough particles to see something, the sampler and hard shadows that the truth of a point light wants, and a
// seed other than 0, with which the first Halton point is the origin in all dimensions: the particle that it
// drives goes on to the last steps, where lights weigh most (cornell-area, 100 particles: 145 % error, else 18 %).
#define TRADEOFF_BASE "--size 320x180 --particles 100 --sampler halton --seed 1 --shadow-map 256 --pcf 1"

// All options of all commands.
typedef struct Arguments {
    const char* command;
    const char* positionals[MAX_POSITIONALS];
    int positionalCount;
    vplRenderOptions render;
    vplContextDef context;
    vplWriteOptions write;
    const char* output;  // -o
    const char* stats;   // --stats
    const char* heatmap; // --heatmap
    vplHeatmapDef heat;
    int frames[2];     // --frames: first and last; [1] < 0: one picture without a number
    int region[4];     // --region: x, y, width, height; width 0: all of the picture
    int columns, rows; // --regions; 0: none
    int threads[MAX_THREAD_COUNTS];
    int threadsCount;
    int runs;
    const char* stage; // --stage; NULL: all
    bool all, scaling;
    const char* reference; // --reference
    const char* sweeps;    // --sweeps
    int seeds;
    double seconds; // --time
    int referenceSpp;
    bool json, quiet, verbose, help;
    bool sizeGiven, tonemapGiven;
} Arguments;

// Fills `arguments`, or prints one sentence to stderr and returns false.
bool parseArguments(int count, char** words, Arguments* arguments);

// Applies more words of `vpl render`, separated by spaces, or complains and returns false.
bool changeArguments(const char* words, Arguments* arguments);

// Prints the general help (command NULL) or that of one command. False if there is no such command.
bool printHelp(const char* command);

// Prints the options of a command.
void printOptions(const char* command);

// One sentence on stderr, starting with "vpl: ".
#if defined(__GNUC__)
__attribute__((format(printf, 1, 2)))
#endif
void complain(const char* format, ...);

// Makes a context that logs to stderr; NULL after complaining.
vplContext* openContext(const Arguments* arguments);

// Exit code of a result; `reading` says whether a file error was met while reading input.
int exitCode(vplResult result, bool reading);

// Loads the scene that the words name, lets `work` have it, and cleans up. Interrupts cancel the work.
typedef int SceneWork(const Arguments* arguments, vplContext* context, const vplScene* scene);
int runOnScene(const Arguments* arguments, SceneWork* work);

// Flushes stdout; complains and returns EXIT_COULD_NOT if anything was lost.
int finishOutput(int code);

// Of a clock that never goes back.
double secondsNow(void);

// Progress bar with the time left, on stderr if that is a terminal; also notices SIGINT. Both take a Progress.
typedef struct Progress {
    double start, lastDrawn;
    bool visible;
} Progress;

Progress beginProgress(bool quiet);
vplProgressFcn showProgress;
void endProgress(Progress* progress);

// From here on SIGINT and SIGTERM only make showProgress return false; a second one kills.
void catchInterrupts(void);

// Writes the statistics of a render as JSON.
vplResult writeStats(vplContext* context, const char* path, const vplRenderStats* stats);

// True if a file can probably be written there; complains otherwise. Asked before hours of rendering.
bool checkOutput(const char* path);

// The name of frame `number` of frames up to `last`: "-0012" before the extension, at least four digits. False if it
// does not fit.
bool numberName(const char* name, int number, int last, char* out, size_t size);

// Writes a whole file beside its target and renames it, or leaves everything as it was and complains.
bool writeTextFile(const char* path, const char* text);

int runRender(const Arguments* arguments);
int runLights(const Arguments* arguments);
int runCompare(const Arguments* arguments);
int runInfo(const Arguments* arguments);
int runBench(const Arguments* arguments);
int runTradeoff(const Arguments* arguments);
int runBake(const Arguments* arguments);

#endif
