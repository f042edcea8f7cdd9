// SPDX-License-Identifier: MIT
// vpl tradeoff: settings -> renders -> errors against a reference -> CSV, plot and report.
#ifndef VPL_CLI_TRADEOFF_H
#define VPL_CLI_TRADEOFF_H

#include "cli/bench/measure.h"
#include "cli/cli.h"
#include "cli/tradeoff/math.h"
#include "cli/tradeoff/text.h"

// The base of vpl tradeoff, as changes to the defaults of vpl render: a size that allows many pictures,
// enough particles to see something, and the sampler and hard shadows that match the reference of a point
// light. The seed is not 0, because the first Halton point of seed 0 is the origin in all dimensions. Its
// particle survives to the last steps, where lights weigh most (cornell-area, 100 particles: 145 % error
// instead of 18 %).
#define TRADEOFF_BASE                                                                                        \
    "--method instant-radiosity --antialias 1 --size 320x180 --particles 100 --reflectivity 0.5 --sampler "  \
    "halton "                                                                                                \
    "--seed 1 --shadow-map 256 --pcf 1"

// A render whose time is not known yet is tried for about this share of the time.
#define TRIAL_SHARE 0.1

enum { MAX_SETTINGS = 512, MAX_SWEEPS = 128, MAX_STAGE_NAMES = 32, SENTENCE = 512 };

// Kinds of settings, each with a colour in the plots: they converge differently.
typedef enum Family {
    FAMILY_DIRECT = 0,
    FAMILY_UNSHADOWED, // instant radiosity, virtual lights shine through walls
    FAMILY_MAP,        // with a shadow map per virtual light
    FAMILY_RAY,        // with a ray per pixel and virtual light
    FAMILY_KELLER,     // Keller's method, whatever its shadows
    FAMILY_SSVP,
    FAMILY_RADIOSITY,
    FAMILY_PATH,
    FAMILY_AUTO, // --method auto: judged by the others, and so neither on the front nor among the answers
    FAMILY_COUNT
} Family;

extern const char* const FAMILY_NAMES[FAMILY_COUNT];

// A series of settings that differ from the base in one thing.
typedef struct Sweep {
    const char* name;  // as in --sweeps; rows of one name belong together
    const char* words; // the change; the last word is an option that takes each of the values
    // Separated by spaces; @X is X times the scene's diagonal, in metres. NULL: the option's choices.
    const char* values;
    const char* meaning; // of the knob, for the report; NULL: no knob, only points of the plot
} Sweep;

extern const Sweep SWEEPS[];
extern const int SWEEP_COUNT;

// The option that takes each of the values, with its dashes.
const char* optionOf(const Sweep* sweep);

// One setting rendered with one seed.
typedef struct Run {
    uint64_t seed;
    vplRenderStats stats;
    vplComparison comparison;
    double error;      // as errorOf
    double ssim, flip; // NAN: not computed, see compare
} Run;

// A setting's picture as it is foreseen; error 0 where nothing is known.
typedef struct Forecast {
    double wallMs, cpuMs, error;
    bool known; // not a guess from the number of pixels
    bool far;   // far beyond what has been measured of the curve
} Forecast;

// Reasons for which a setting that could be measured was not.
typedef enum LeftOut {
    LEFT_LATE = 0, // time was up
    LEFT_DEAR,     // it was foreseen to take longer than all the time given
    LEFT_WORSE,    // time was up, and another setting was foreseen to be both faster and better
    LEFT_LONG      // it was cancelled, because it took far longer than foreseen
} LeftOut;

typedef struct Setting {
    char command[SENTENCE];   // the words after `vpl render` that make its picture, without the output
    char change[128];         // words that differ from the base; empty for the base itself
    vplRenderOptions options; // the base with the change
    bool sweeps[MAX_SWEEPS];  // i: belongs to SWEEPS[i]
    Family family;
    double work; // foreseen, in units that only compare settings of one family and pipeline
    int curve;   // index of the first setting from which only the amount differs; its own if there is none
    char first[SENTENCE]; // the command with amount 1
    double amount;        // lights, patches, paths or clusters; 0: the method has no such number
    Forecast forecast;    // from what has been measured
    Run* runs;            // of Tradeoff.runs
    int runCount;
    double error, errorLow, errorHigh; // as errorOf: median, least and most of the seeds
    double cpuMs, cpuLow, cpuHigh, wallMs;
    double energy;          // median of the ratio to the truth's
    char problem[SENTENCE]; // why it was not measured; empty: it was, or time ran out before
    LeftOut leftOut;        // why else
    bool elsewhere;         // another process measures it
    double cancelledMs;     // of LEFT_LONG: after so much time
    int number;             // on the front, where 1 is the cheapest; 0: not on the front
    vplImage* image;        // of the first seed, kept while the setting is on the front
} Setting;

// The reference picture.
typedef struct Reference {
    vplImage* image;
    vplImage* halves[2]; // independent pictures of which it is the mean; NULL if there is only one
    double error;        // its own, as relative rmse; negative where it is not known
    double resolution;   // errors below this cannot be told from 0; 0 where that is not known
    int spp;             // 0: from files
    double ms;           // processor time
    double mean;         // of all pixels and channels
} Reference;

typedef struct Tradeoff Tradeoff;

// Processes that measure together, setting i at process i % count; process 0 writes the report (src/mpi/tradeoff.c). Exit
// codes are those of all processes.
typedef struct Crew {
    int index, count;
    int (*agree)(void* user, int code);                    // the largest code of all
    int (*shareReference)(void* user, Tradeoff* tradeoff); // gives all the reference of process 0
    int (*collectRuns)(void* user, Tradeoff* tradeoff);    // brings all runs to process 0
    void* user;
} Crew;

struct Tradeoff {
    const Crew* crew;           // NULL: this process is alone
    const Arguments* arguments; // of the command line; its render options are the base
    vplContext* context;        // in which settings are measured
    vplScene* scene;
    vplContext* tracing; // in which the reference is made, with all threads
    vplScene* traced;    // the same scene there
    double diagonal;     // of the scene, metres
    Reference reference;
    Setting settings[MAX_SETTINGS];
    int settingCount;
    Run* runs; // of all settings
    Progress progress;
    double start, deadline; // seconds; INFINITY: none
    double limit;           // seconds: the render that runs now is cancelled then
    bool coarse;            // what is measured now is the base or a coarse point
    double spent, knobs;    // seconds on all others, and on the knobs among them
    double perceptual;      // seconds of computing ssim and flip
    bool interrupted;
    char message[SENTENCE]; // the last error of the library
    bool silent;            // errors are kept, not printed
};

// vpl tradeoff: complains of its options; runs it, with a crew (may be NULL). Exit codes.
int checkTradeoff(const Arguments* arguments);
int runTradeoffWith(const Arguments* arguments, const Crew* crew);

// ---- settings

// True if the setting belongs to a sweep of this name.
bool isOfSweep(const Setting* s, const char* name);

// Fills in the base and all settings of the chosen sweeps; complains and returns false if a name is unknown.
bool listSettings(Tradeoff* t);

// The words after `vpl render` that ask for these options, without the output.
void writeCommand(const vplRenderOptions* options, char* words, size_t size);

// ---- measuring

// Reads or path-traces the reference. Prints a sentence unless it returns EXIT_DONE.
int makeReference(Tradeoff* t);

// The error of a picture: root mean square difference from the reference / mean of the reference. With two
// halves it is free of the reference's own noise. It is at least the reference's resolution.
double errorOf(const Reference* r, const vplImage* image, const vplComparison* comparison);

// Returns the setting with `done` seeds to measure next, so that it should end before `end`; NULL: none.
Setting* chooseNext(Tradeoff* t, int done, double end);

// True of a setting that belongs to knobs only, and is no point of the plot's curves.
bool isKnob(const Setting* s);

// Writes why a setting was not measured, and returns the sentence.
const char* whyLeftOut(const Setting* s, char* text, size_t size);

// Notes for every setting that was not measured why it was left out.
void explainLeftOut(Tradeoff* t);

// Renders all settings that fit into the time. EXIT_DONE also if interrupted; then t->interrupted says so.
int measureSettings(Tradeoff* t);

// Fills in medians, bands and the front from the runs.
void summarise(Tradeoff* t);

// Renders with the library's error kept in t->message and the deadline watched.
vplResult renderQuietly(Tradeoff* t, const vplScene* scene, const vplRenderOptions* options,
                        vplImage** imageOut, vplRenderStats* stats);

// ---- results

void writeTable(const Tradeoff* t, Text* csv);
void writeStyle(Text* css); // colours of both the plots and the report
void writePlot(const Tradeoff* t, Text* svg);
void writeReport(const Tradeoff* t, Text* html);

// Returns the index of a family's (FAMILY_COUNT: any but the planner) cheapest setting with a median error <=
// limit, or -1.
int findCheapest(const Tradeoff* t, Family family, double limit);

// Lists the settings on the front, the cheapest first, and returns their number.
int listFront(const Tradeoff* t, const Setting* front[MAX_SETTINGS]);

// Returns the error at which a family of virtual lights levels off as particles grow in number; NAN if it
// does not.
double findFloor(const Tradeoff* t, Family family);

// The processor time over that of the cheapest setting without planner of at most this error; NAN: there is
// none.
double overFront(const Tradeoff* t, const Setting* s);

// Parts of report.html.
void addAnswers(const Tradeoff* t, Text* html); // words and table: the settings for 5 % error
void addCommand(const Tradeoff* t, const Setting* s, Text* html);
void addBest(const Tradeoff* t, Text* html);     // the least error within some times
void addPlanner(const Tradeoff* t, Text* html);  // asked against reached
void addPictures(const Tradeoff* t, Text* html); // the front beside the truth
void addSlider(Text* html);                      // compares two of the pictures, by the script
void addScript(Text* html);                      // behind all pictures
void addClamp(const Tradeoff* t, Text* html);    // error and energy against --min-distance
void addKnobs(const Tradeoff* t, Text* html);    // each option against the base

static inline bool isMeasured(const Setting* s)
{
    return s->runCount > 0;
}

// FAMILY_COUNT: of any family but the planner.
static inline bool isMeasuredOf(const Setting* s, Family family)
{
    return isMeasured(s) && (family == FAMILY_COUNT ? s->family != FAMILY_AUTO : s->family == family);
}

#endif
