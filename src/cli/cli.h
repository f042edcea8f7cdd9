// SPDX-License-Identifier: MIT
// The program: parses words, calls the public API, prints. Everything of substance is in the library.
#ifndef VPL_CLI_CLI_H
#define VPL_CLI_CLI_H

#include <vpl/stages.h>

#include <jansson.h>
#include <stdio.h>

enum { EXIT_DONE = 0, EXIT_COULD_NOT = 1, EXIT_USAGE = 2 };

// Returns the result of a call if it failed.
#define TRY(call)                                                                                            \
    do {                                                                                                     \
        const vplResult tryResult = (call);                                                                  \
        if (tryResult != VPL_SUCCESS) {                                                                      \
            return tryResult;                                                                                \
        }                                                                                                    \
    } while (0)

enum { MAX_POSITIONALS = 1024, MAX_THREAD_COUNTS = 8, MAX_FRAMES = 100000 };

typedef struct Arguments Arguments;

// Bits of commands, for tables.
enum {
    RENDER = 1,
    BAKE = 2,
    LIGHTS = 4,
    INFO = 8,
    TRADEOFF = 16,
    COMPARE = 32,
    BENCH = 64,
    MERGE = 128,
    ON_SCENES = RENDER | BAKE | LIGHTS | INFO | TRADEOFF // they take the options of rendering
};

typedef struct Command {
    const char* name;
    int bit;
    int positionals; // words that are no options: of merge at most, of others exactly
    int (*run)(const Arguments* arguments);
    const char *usage, *summary, *text; // for the help
    const char* unused; // render options without effect here, with spaces around each; or NULL
} Command;

extern const Command COMMANDS[];
extern const int COMMAND_COUNT;

// Returns NULL if no command has that name.
const Command* findCommand(const char* name);

// The command that a misspelt word may mean; NULL if none is near.
const char* nearestCommand(const char* word);

// The options and other words of a command line.
struct Arguments {
    const Command* command;
    const char* const* words; // the whole line
    int wordCount;
    const char* positionals[MAX_POSITIONALS];
    int positionalCount;
    vplRenderOptions render;
    vplContextDef context;
    const char* output;              // -o
    const char* stats;               // --stats
    const char* errorMap;            // --error-map
    const char *planIn, *planOut;    // --plan, --plan-out
    uint64_t planScene;              // hash of the scene that the plan was made for
    const char *checkpoint, *resume; // --checkpoint, --resume
    double checkpointEvery;          // seconds
    const char *environment, *sky;   // --environment, --sky
    const char* heatmap;             // --heatmap
    int heatmapOf;                   // a vplHeat
    double heatScale;                // 0: automatic
    double ppd;                      // pixels per degree of vision
    double exposure;                 // stops, or VPL_EXPOSURE_AUTO
    int tonemap;                     // 0: as usual with what is shown; else 1 + a vplToneMap
    int failure;                     // exit code if the words are refused: EXIT_USAGE unless memory ran out
    int frames[2];                   // first and last; [1] < 0: one picture without a number
    int tile[2];                     // --tile: part, from 1 on, and parts; 0: the whole picture
    int region[4];                   // x, y, width, height; width 0: all of the picture
    int regions[2];                  // columns and rows; 0: none
    int threads[MAX_THREAD_COUNTS], threadsCount;
    int runs, seeds, referenceSpp;
    int memoryMib;  // --memory; 0: what the machine has
    double seconds; // --time
    const char *stage, *reference, *sweeps;
    bool all, scaling, extremes, calibrate, json, explain, dryRun, noGround, noPartial, quiet, verbose, help;
};

// Fills *a, or prints one sentence to stderr and returns false: a->failure is the exit code then.
bool parseArguments(int count, const char* const* words, Arguments* a);

// Returns true if the command line names an option; the name is without dashes.
bool isGiven(const Arguments* arguments, const char* name);

// Sets options by words "--name value --name value"; complains and returns false if one is wrong.
bool setOptions(vplRenderOptions* options, const char* words);

// vpl help TOPIC SUBJECT: the topic is NULL, a command or "options", which alone has subjects. Returns false
// after complaining.
bool printHelp(const char* topic, const char* subject);

// Prints what a shell needs to complete command lines: "bash", "zsh" or "fish". Returns false after complaining.
bool printCompletion(const char* shell);

// One sentence on stderr, starting with "vpl: " (see setSpeaker).
#if defined(__GNUC__)
__attribute__((format(printf, 1, 2)))
#endif
void complain(const char* format, ...);

// Who complains instead of "vpl"; the name must last. NULL: nobody, and sentences are not printed.
void setSpeaker(const char* name);

// Prints messages of the library as --quiet and -v ask for. Takes the Arguments.
vplLogFcn logToStderr;

// Makes a context that logs to stderr. On failure logs why, and *contextOut is NULL.
vplResult openContext(const Arguments* arguments, vplContext** contextOut);

// Plans a render as renderPicture does it: it can be interrupted.
vplResult planRender(const Arguments* arguments, const vplScene* scene, vplPlan** planOut);

// Loads the scene that the arguments name, as it stands at --frame; a mesh by itself is fitted to the picture.
vplResult loadNamedScene(const Arguments* arguments, vplContext* context, vplScene** sceneOut);

// Reads "ELEVATION", "ELEVATION,TURBIDITY" or "ELEVATION,TURBIDITY,TURN", degrees; false if it is anything else.
bool parseSky(const char* value, vplEnvironmentDef* defOut);

// Gives the scene the environment that the arguments name, if they name one.
vplResult addEnvironment(const Arguments* arguments, vplScene* scene);

// "none", "constant", "picture" or "sky".
const char* describeEnvironment(const vplScene* scene);

// Returns the exit code for a result. A file error is bad input (2) if `reading`, else a failure to write
// (1).
int exitCode(vplResult result, bool reading);

// Writes vplPlan_Describe's text.
int printPlan(const vplPlan* plan, FILE* file);

// --explain and --dry-run: prints the plan; an exit code.
int explainPlan(const Arguments* arguments, const vplScene* scene);

// Loads the scene, prints the plan if --explain or --dry-run asks for it, and calls `work` unless it is a dry
// run.
typedef int SceneWork(const Arguments* arguments, vplScene* scene);
int runOnScene(const Arguments* arguments, SceneWork* work);

// Flushes stdout; complains and returns EXIT_COULD_NOT if anything was lost.
int finishOutput(int code);

// Progress with the time left, on stderr: a bar on a terminal, else a line every ten seconds. showProgress takes the
// Progress.
typedef struct Progress {
    double start, last; // seconds; of the last drawing
    bool quiet, terminal;
} Progress;

Progress beginProgress(bool quiet);
vplProgressFcn showProgress;
void endProgress(Progress* progress);

// From now on SIGINT and SIGTERM make showProgress and askInterrupts return false; a second signal ends the program.
// Programs call it before they write their first file, so that an interrupt leaves no temporary file.
void catchInterrupts(void);
vplProgressFcn askInterrupts;

// Infinity and NaN become null, because JSON has no such numbers.
json_t* numberJson(double value);
json_t* integersJson(const int* values, int count);

// From now on the program ends with a sentence when jansson runs out of memory. jansson itself may fail an assertion, report a syntax error
// or leave values out. No file is left half-written, because JSON is neither read nor made while a file is being written.
void guardJson(void);

// Writes JSON to a file, or to stdout if the path is NULL, and frees it. Complains unless it returns
// EXIT_DONE.
int writeJson(json_t* root, int digits, const char* path);

// Writes the statistics of a render as JSON.
int writeStats(vplContext* context, const char* path, const vplRenderStats* stats);

// True for "-" and for "-.pfm" and the like, which stand for standard output.
bool isStdout(const char* path);

// Returns true if a file can probably be written there; complains otherwise. Called before hours of
// rendering.
bool checkOutput(const char* path);

// Checks that -o names a picture format, and one of layers or of frames if these are asked for; complains otherwise.
bool checkPictureName(const Arguments* arguments);

// How the picture is shown in 8 bits, as --exposure, --tonemap and --show ask for it.
vplWriteOptions chooseDisplay(const Arguments* arguments);
void warnOfDisplay(const Arguments* arguments);

// Prepares a picture for the file format of `path`: makes metres and normals visible in a PNG, and replaces an automatic
// exposure by that of this picture, for those that follow. An exit code.
int preparePicture(const Arguments* arguments, vplImage* image, const char* path, vplWriteOptions* display);

// Prepares a picture and writes it to a file or to standard output; an exit code.
int writePicture(const Arguments* arguments, vplImage* image, const char* path, vplWriteOptions* display);

// Writes a picture of light by -o, --exposure and --tonemap; an exit code.
int writeWholePicture(const Arguments* arguments, vplImage* image);

// Writes a picture with layers; an exit code.
int writeLayers(const vplLayers* layers, const char* path);

// vpl render --tile: returns false after complaining of options that are not for parts; renders a part.
bool checkTile(const Arguments* arguments);
int renderTile(const Arguments* arguments, vplScene* scene);

// vpl bake: an exit code after complaining of its options; bakes.
int checkBake(const Arguments* arguments);
int bakeScene(const Arguments* arguments, vplScene* scene);

// Writes the file name of frame `number` of frames up to `last`: "-0012" before the extension, at least four
// digits. last < 0: the name itself. Returns false if it does not fit.
bool numberName(const char* name, int number, int last, char* out, size_t size);

// Writes a whole file beside its target and renames it, or leaves everything as it was and complains.
bool writeTextFile(const char* path, const char* text);

int runRender(const Arguments* arguments);
int runLights(const Arguments* arguments);
int runCompare(const Arguments* arguments);
int runMerge(const Arguments* arguments);
int runInfo(const Arguments* arguments);
int runBench(const Arguments* arguments);
int runTradeoff(const Arguments* arguments);
int runBake(const Arguments* arguments);

#endif
