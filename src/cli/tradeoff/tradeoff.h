// SPDX-License-Identifier: MIT
// vpl tradeoff: settings -> renders -> errors against a reference -> CSV, plot and report.
#ifndef VPL_CLI_TRADEOFF_H
#define VPL_CLI_TRADEOFF_H

#include "cli/bench/measure.h"
#include "cli/cli.h"
#include "cli/tradeoff/math.h"
#include "cli/tradeoff/text.h"

// What the base of vpl tradeoff differs in from the defaults of vpl render: a size that allows many pictures,
// enough particles to see something, the sampler and hard shadows that the truth of a point light wants, and
// a seed other than 0, with which the first Halton point is the origin in all dimensions: the particle that
// it drives goes on to the last steps, where lights weigh most (cornell-area, 100 particles: 145 % error,
// else 18 %).
#define TRADEOFF_BASE "--size 320x180 --particles 100 --sampler halton --seed 1 --shadow-map 256 --pcf 1"

enum { MAX_SETTINGS = 512, MAX_SWEEPS = 64, MAX_STAGE_NAMES = 32, SENTENCE = 512 };

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
    FAMILY_COUNT
} Family;

extern const char* const FAMILY_NAMES[FAMILY_COUNT];

// A series of settings that differ from the base in one thing.
typedef struct Sweep {
    const char* name;  // as in --sweeps; rows of one name belong together
    const char* words; // the change; the last word is an option that takes each of the values
    // With spaces between; @X is X times the scene's diagonal, in metres; NULL: its choices.
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
    double error; // as errorOf
    double ssim, flip;
} Run;

typedef struct Setting {
    char command[SENTENCE];   // the words after `vpl render` that make its picture, without the output
    char change[128];         // words that differ from the base; empty for the base itself
    vplRenderOptions options; // the base with the change
    uint64_t sweeps;          // bit i: belongs to SWEEPS[i]
    Family family;
    double work; // foreseen, in units that only compare settings of one family and pipeline
    Run* runs;
    int runCount;
    double error, errorLow, errorHigh; // as errorOf: median, least and most of the seeds
    double cpuMs, cpuLow, cpuHigh, wallMs;
    double energy;           // median of the ratio to the truth's
    char problem[SENTENCE];  // why it was not measured; empty: it was, or time ran out before
    bool onFront, exhausted; // exhausted: left out for lack of time
    int number;              // on the front: 1 is the cheapest
    vplImage* image;         // of the first seed, kept while no other setting is better in all ways
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

typedef struct Tradeoff {
    const Arguments* arguments; // of the command line; its render options are the base
    vplContext* context;        // in which settings are measured
    vplScene* scene;
    vplContext* tracing; // in which the reference is made, with all threads
    vplScene* traced;    // the same scene there
    double diagonal;     // of the scene, metres
    Reference reference;
    Setting settings[MAX_SETTINGS];
    int settingCount;
    Progress progress;
    double start, deadline; // seconds; INFINITY: none
    bool interrupted;
    char message[SENTENCE]; // the last error of the library
    bool silent;            // errors are kept, not printed
} Tradeoff;

// ---- settings

// Fills in the base and all settings of the chosen sweeps; complains and returns false if a name is unknown.
bool listSettings(Tradeoff* t);

// The words after `vpl render` that ask for these options, without the output.
void writeCommand(const vplRenderOptions* options, char* words, size_t size);

// ---- measuring

// Reads or path-traces the reference. A sentence was printed unless it returns EXIT_DONE.
int makeReference(Tradeoff* t);

// The error of a picture: root mean square difference from the reference / mean of the reference. With two
// halves it is free of the reference's own noise. Never below the reference's resolution.
double errorOf(const Reference* r, const vplImage* image, const vplComparison* comparison);

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

// The index of the cheapest setting of a family (FAMILY_COUNT: any) with a median error within the limit, or
// -1.
int findCheapest(const Tradeoff* t, Family family, double limit);

// The settings on the front, the cheapest first; returns how many.
int listFront(const Tradeoff* t, const Setting* front[MAX_SETTINGS]);

// The error that a family without shadows cannot get below however many particles; NAN where none shows.
double findFloor(const Tradeoff* t, Family family);

static inline bool isMeasured(const Setting* s)
{
    return s->runCount > 0;
}

#endif
