// SPDX-License-Identifier: MIT
// The sweeps: which settings are measured. A new row of the table measures a new option.
#include "cli/tradeoff/tradeoff.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char PARTICLES[] = "3 10 30 100 300 1000 3000 10000 30000 65536";

static const char PLACED[] = "10 100 1000 10000";

static const char PATCHES[] = "100 300 1000 3000 10000 30000";

static const char DISTANCES[] = "0 auto @0.003 @0.01 @0.03 @0.06 @0.1 @0.2 @0.4";

// Stands for the choices of the option, except auto and usual, which leave the choice to the library.
#define CHOICES NULL

const Sweep SWEEPS[] = {
    {"frontier", "--light-shadows none --particles", PARTICLES, NULL},
    {"frontier", "--light-shadows map --particles", PARTICLES, NULL},
    {"frontier", "--light-shadows ray --particles", PARTICLES, NULL},
    {"frontier", "--method keller --particles", PARTICLES, NULL},
    {"frontier", "--method keller --pipeline interleaved --particles", PARTICLES, NULL},
    {"frontier", "--method keller --pipeline interleaved --interleave 16 --particles", PARTICLES, NULL},
    {"frontier", "--method keller --placement rsm --particles", PLACED, NULL},
    {"frontier", "--method keller --placement view --particles", PLACED, NULL},
    {"frontier", "--method ssvp --clusters", "4 8 16 32 64", NULL},
    {"frontier", "--method ssvp --clusters 32 --first-bounce 1024 --second-bounce", "1024 4096", NULL},
    {"frontier", "--method radiosity --patches", PATCHES, NULL},
    {"frontier", "--method radiosity --patch-placement adaptive --patches", PATCHES, NULL},
    {"frontier", "--light-shadows none --min-distance @0.03 --particles", PARTICLES, NULL},
    {"frontier", "--light-shadows map --min-distance @0.03 --particles", PARTICLES, NULL},
    {"frontier", "--light-shadows ray --min-distance @0.03 --particles", PARTICLES, NULL},
    {"frontier", "--light-shadows ray --shadow-map 2048 --particles", PARTICLES, NULL},
    {"auto", "--method auto --max-error", "0.2 0.1 0.05 0.02", NULL},
    {"auto", "--method auto --budget", "200 1000 5000", NULL},
    {"path", "--method path --spp", "1 2 4 8 16 32 64 128 256 512 1024", NULL},
    {"direct", "--method", "direct", NULL},
    {"particles", "--particles", PARTICLES, "Particles"},
    {"light-shadows", "--light-shadows", "none map ray auto", "Shadows of virtual lights"},
    {"interleave", "--pipeline interleaved --interleave", "2 4 8 16",
     "Lights that neighbouring pixels share"},
    {"interleave", "--light-shadows ray --pipeline interleaved --interleave", "2 4 8 16", NULL},
    {"min-distance", "--min-distance", DISTANCES, "Clamp of near virtual lights"},
    {"min-distance", "--light-shadows map --min-distance", DISTANCES, NULL},
    {"compensation", "--light-shadows ray --compensation", CHOICES, "Light lost to the clamp found by rays"},
    {"compensation", "--light-shadows ray --compensation rays --particles", "100 1000 10000", NULL},
    {"passes", "--method keller --pipeline interleaved --interleave 16 --passes", "1 2 4 8", "Passes"},
    {"sampler", "--sampler", CHOICES, "Where particles go"},
    {"placement", "--light-shadows ray --placement", CHOICES, "Where lights go"},
    {"placement", "--method keller --placement", CHOICES, "Where Keller's lights go"},
    {"clusters", "--method ssvp --clusters", "4 8 16 32 64 256", "SSVP: clusters of lights"},
    {"bounces", "--method ssvp --max-bounces", "0 1 2 4 8", "SSVP: bounces"},
    {"first-bounce", "--method ssvp --first-bounce", "64 256 1024", "SSVP: first-bounce lights"},
    {"second-bounce", "--method ssvp --second-bounce", "64 256 1024", "SSVP: second-bounce lights"},
    {"max-clusters", "--method ssvp --max-clusters", "8 16 32 64 256", "SSVP: clusters after splitting"},
    {"next-bounce", "--method ssvp --next-bounce", CHOICES, "SSVP: where the second bounce begins"},
    {"second-weight", "--method ssvp --next-bounce maps --second-weight", CHOICES,
     "SSVP: weight of the second bounce"},
    {"cluster-metric", "--method ssvp --cluster-metric", CHOICES, "SSVP: distance of a light from a cluster"},
    {"cluster-place", "--method ssvp --cluster-place", CHOICES, "SSVP: viewpoints of clusters"},
    {"paraboloid", "--method ssvp --paraboloid", "64 128 256 512", "SSVP: size of paraboloid maps"},
    {"hemispheres", "--method ssvp --hemispheres", "1 2", "SSVP: hemispheres of a cluster"},
    {"oversampling", "--method ssvp --oversampling", "1 4 16", "SSVP: oversampling of the reflective map"},
    {"rsm-size", "--method ssvp --rsm-size", "256 512 1024 2048", "SSVP: size of the reflective map"},
    {"ssvp-interleave", "--method ssvp --interleave", "1 2 4 8",
     "SSVP: lights that neighbouring pixels share"},
    {"patches", "--method radiosity --patches", PATCHES, "Radiosity: patches"},
    {"patch-placement", "--method radiosity --patch-placement", CHOICES,
     "Radiosity: where patches are small"},
    {"form-factors", "--method radiosity --form-factors", CHOICES, "Radiosity: form factors"},
    {"form-samples", "--method radiosity --form-samples", "1 4 16", "Radiosity: samples of form factors"},
    {"row-sums", "--method radiosity --row-sums", CHOICES, "Radiosity: sums of form factors above 1"},
    {"hierarchy", "--method radiosity --hierarchy", CHOICES, "Radiosity: links between groups"},
    {"link-error", "--method radiosity --hierarchy on --link-error", "0.001 0.003 0.01 0.03 0.1",
     "Radiosity: error of links"},
    {"patch-light", "--method radiosity --patch-light", "1 4 16", "Radiosity: samples of lights"},
    {"iterations", "--method radiosity --iterations", "1 2 5 10", "Radiosity: sweeps"},
    {"interpolation", "--method radiosity --interpolation", CHOICES, "Radiosity: interpolation"},
    {"gather", "--method radiosity --patches 250 --gather", "0 4 16 64 256",
     "Radiosity: rays of the final gather"},
    {"sharpen", "--method radiosity --sharpen", "0 1 2 4 8", "Radiosity: sharpening of corners"},
    {"vertex-weight", "--method radiosity --vertex-weight", CHOICES, "Radiosity: weights at corners"},
    {"reflectivity", "--reflectivity", "0 0.25 0.5 0.75 auto", "Particles that go on at each bounce"},
    {"shadow-map", "--shadow-map", "64 128 256 512 1024 2048", "Size of the light's shadow map"},
    {"pcf", "--pcf", "1 4 16 64", "Softening of the light's shadow"},
    {"bias", "--bias", "auto 0 @0.001 @0.003 @0.01", "Shadow bias"},
    {"pipeline", "--pipeline", "usual batched multipass", "How virtual lights are added up"},
    {"cut-error", "--pipeline lightcuts --light-shadows ray --particles 10000 --cut-error",
     "0.005 0.01 0.02 0.05 0.1 0.2", "Error of lightcuts"},
    {"area-light-samples", "--area-light-samples", "4 16 64 256", "Samples of area lights"},
    {"area-light-samples", "--area-light-samples 16 --particles", "300 1000 3000", NULL},
    {"light-map", "--light-shadows map --light-map", "32 64 128 256 512", "Size of virtual lights' maps"},
    {"particle-geometry", "--particle-geometry", CHOICES, "What stops a particle"},
};

const int SWEEP_COUNT = sizeof SWEEPS / sizeof *SWEEPS;

_Static_assert(sizeof SWEEPS / sizeof *SWEEPS <= MAX_SWEEPS, "a sweep is an element of Setting.sweeps");

const char* const FAMILY_NAMES[FAMILY_COUNT] = {"direct light only",
                                                "virtual lights without shadows",
                                                "virtual lights with shadow maps",
                                                "virtual lights with shadow rays",
                                                "Keller's method",
                                                "SSVP",
                                                "radiosity",
                                                "path tracing",
                                                "the planner (--method auto)"};

bool isOfSweep(const Setting* s, const char* name)
{
    bool found = false;
    for (int i = 0; i < SWEEP_COUNT; i++) {
        found = found || (s->sweeps[i] && strcmp(SWEEPS[i].name, name) == 0);
    }
    return found;
}

// Marks the sweeps that "a,b,c" names; NULL names all. Returns false after complaining of an unknown name.
static bool chooseSweeps(const char* list, bool chosen[MAX_SWEEPS])
{
    bool good = list == NULL || *list != 0;
    for (int i = 0; i < SWEEP_COUNT; i++) {
        chosen[i] = list == NULL;
    }
    for (const char* at = list; at != NULL && *at != 0 && good; at += strcspn(at, ","), at += *at == ',') {
        const size_t length = strcspn(at, ",");
        good = false;
        for (int i = 0; i < SWEEP_COUNT; i++) {
            if (strlen(SWEEPS[i].name) == length && strncmp(at, SWEEPS[i].name, length) == 0) {
                chosen[i] = good = true;
            }
        }
        if (!good) {
            complain("--sweeps names \"%.*s\"; vpl help tradeoff lists the sweeps", (int)length, at);
        }
    }
    return good;
}

static Family familyOf(const vplRenderOptions* o)
{
    switch (o->method) {
    case VPL_METHOD_AUTO:
        return FAMILY_AUTO;
    case VPL_METHOD_DIRECT:
        return FAMILY_DIRECT;
    case VPL_METHOD_PATH:
        return FAMILY_PATH;
    case VPL_METHOD_KELLER:
        return FAMILY_KELLER;
    case VPL_METHOD_SSVP:
        return FAMILY_SSVP;
    case VPL_METHOD_RADIOSITY:
        return FAMILY_RADIOSITY;
    case VPL_METHOD_INSTANT_RADIOSITY:
        break;
    }
    return o->lights.shadows == VPL_LIGHT_SHADOWS_MAP   ? FAMILY_MAP
           : o->lights.shadows == VPL_LIGHT_SHADOWS_RAY ? FAMILY_RAY
                                                        : FAMILY_UNSHADOWED;
}

// The field that runs along a curve: the number of lights, patches, paths or clusters; NULL of other methods.
static int* amountOf(vplRenderOptions* o)
{
    return o->method == VPL_METHOD_PATH        ? &o->path.samples
           : o->method == VPL_METHOD_RADIOSITY ? &o->radiosity.patches
           : o->method == VPL_METHOD_SSVP      ? &o->ssvp.clusters
           : o->method == VPL_METHOD_KELLER || o->method == VPL_METHOD_INSTANT_RADIOSITY ? &o->particles.count
                                                                                         : NULL;
}

// Lights, patches or paths, plus a constant for the cost of any picture. The planner's noise falls as the
// root of its time.
static double workOf(const vplRenderOptions* o)
{
    if (o->method == VPL_METHOD_AUTO) {
        return o->stop.maxError > 0 ? 1 / (o->stop.maxError * o->stop.maxError) : fmax(o->stop.budgetMs, 1);
    }
    double reflectivity = o->particles.reflectivity >= 0 ? o->particles.reflectivity : 0.7;
    return o->method == VPL_METHOD_PATH        ? o->path.samples
           : o->method == VPL_METHOD_DIRECT    ? 1
           : o->method == VPL_METHOD_RADIOSITY ? 500 + o->radiosity.patches
           : o->method == VPL_METHOD_SSVP
               ? 200 + o->ssvp.firstBounce + o->ssvp.secondBounce + 8 * o->ssvp.clusters
               : 50 + o->particles.count / (1 - reflectivity);
}

// Writes the options in which `o` differs from `plain`, except those that the method of `o` does not use.
static void writeDifference(const vplRenderOptions* plain, const vplRenderOptions* o, char* words,
                            size_t size)
{
    int count;
    const vplOption* options = vplGetOptions(&count);
    size_t used = 0;
    words[0] = 0;
    for (int i = 0; i < count; i++) {
        char value[64], usual[64];
        const char* name = options[i].name;
        if (vplRenderOptions_Get(o, name, value, sizeof value) == VPL_SUCCESS &&
            vplRenderOptions_Get(plain, name, usual, sizeof usual) == VPL_SUCCESS &&
            strcmp(value, usual) != 0 && vplRenderOptions_IsUsed(o, name, NULL, 0)) {
            int length = snprintf(words + used, size - used, "%s--%s %s", used ? " " : "", name, value);
            used += length > 0 && (size_t)length < size - used ? (size_t)length : 0;
        }
    }
}

void writeCommand(const vplRenderOptions* o, char* words, size_t size)
{
    const vplRenderOptions plain = vplDefaultRenderOptions();
    const char* method =
        o->method == VPL_METHOD_AUTO ? "--method auto " : ""; // said although it is the default
    const int length = snprintf(words, size, "%s", method);
    writeDifference(&plain, o, words + length, size - (size_t)length);
}

// Sets options that the method does not use to their defaults, so that equal settings compare equal.
static void forgetUnused(vplRenderOptions* o)
{
    const vplRenderOptions plain = vplDefaultRenderOptions();
    int count;
    const vplOption* options = vplGetOptions(&count);
    for (int i = 0; i < count; i++) {
        char usual[64];
        if (!vplRenderOptions_IsUsed(o, options[i].name, NULL, 0) &&
            vplRenderOptions_Get(&plain, options[i].name, usual, sizeof usual) == VPL_SUCCESS) {
            vplRenderOptions_Set(o, options[i].name, usual);
        }
    }
}

// Leaves to the planner what it can choose: sets options that some method does not use to their defaults. The
// pixels stay those of the other settings, because one truth judges all.
static void forgetChoices(vplRenderOptions* o)
{
    const vplRenderOptions plain = vplDefaultRenderOptions();
    int count;
    const vplOption* options = vplGetOptions(&count);
    for (int i = 0; i < count; i++) {
        char usual[64];
        const bool general = (options[i].users & VPL_USE_ALL) == VPL_USE_ALL;
        if (!general && strcmp(options[i].name, "antialias") != 0 &&
            vplRenderOptions_Get(&plain, options[i].name, usual, sizeof usual) == VPL_SUCCESS) {
            vplRenderOptions_Set(o, options[i].name, usual);
        }
    }
}

// Finds the curve of a setting behind the others, on which only the amount varies.
static void findCurve(const Tradeoff* t, Setting* s)
{
    vplRenderOptions o = s->options;
    int* amount = amountOf(&o);
    s->amount = amount != NULL ? *amount : 0;
    if (amount != NULL) {
        *amount = 1;
    }
    if (o.method == VPL_METHOD_AUTO) {
        o.stop.maxError = o.stop.maxError > 0;
        o.stop.budgetMs = o.stop.budgetMs > 0;
    }
    writeCommand(&o, s->first, sizeof s->first);
    for (s->curve = 0; s->curve < t->settingCount; s->curve++) {
        if (strcmp(t->settings[s->curve].first, s->first) == 0) {
            break;
        }
    }
}

// Sets all options of a setting.
static bool setWords(const Tradeoff* t, Setting* s, const char* words)
{
    s->options = t->arguments->render;
    if (!setOptions(&s->options, words)) {
        return false;
    }
    if (s->options.method == VPL_METHOD_AUTO) {
        forgetChoices(&s->options);
    }
    if (s->options.method == VPL_METHOD_PATH &&
        s->options.output.antialias == 1) { // paths start where the other methods sample
        s->options.path.pixel = VPL_PIXEL_CENTRE;
    }
    forgetUnused(&s->options);
    return true;
}

// Adds the base changed by `words`, or notes that an equal setting belongs to this sweep, too. The base
// itself belongs to every chosen knob.
static bool addSetting(Tradeoff* t, const char* words, const bool sweeps[MAX_SWEEPS])
{
    Setting s = {0};
    if (!setWords(t, &s, words)) {
        return false;
    }
    memcpy(s.sweeps, sweeps, sizeof s.sweeps);
    writeCommand(&s.options, s.command, sizeof s.command);
    for (int i = 0; i < t->settingCount; i++) {
        if (strcmp(t->settings[i].command, s.command) == 0) {
            for (int k = 0; k < SWEEP_COUNT; k++) {
                t->settings[i].sweeps[k] |= sweeps[k];
            }
            return true;
        }
    }
    if (t->settingCount == MAX_SETTINGS) {
        complain("more than %d settings", MAX_SETTINGS);
        return false;
    }
    writeDifference(&t->arguments->render, &s.options, s.change, sizeof s.change);
    if (s.options.method == VPL_METHOD_AUTO) { // as it was asked, without the base's options that it forgot
        snprintf(s.change, sizeof s.change, "%s", words);
    }
    s.family = familyOf(&s.options);
    s.work = workOf(&s.options);
    findCurve(t, &s);
    t->settings[t->settingCount++] = s;
    return true;
}

// Copies words and replaces @X by a length in metres, of two digits to keep commands short.
static void expandLengths(const Tradeoff* t, const char* from, char* words, size_t size)
{
    size_t used = 0;
    while (*from != 0 && used + 1 < size) {
        if (*from != '@') {
            words[used++] = *from++;
            continue;
        }
        char* end;
        char digits[32];
        snprintf(digits, sizeof digits, "%.1e", t->diagonal * strtod(from + 1, &end));
        int length = snprintf(words + used, size - used, "%g", strtod(digits, NULL));
        used += (size_t)length < size - used ? (size_t)length : 0;
        from = end;
    }
    words[used] = 0;
}

const char* optionOf(const Sweep* sweep)
{
    const char* space = strrchr(sweep->words, ' ');
    return space != NULL ? space + 1 : sweep->words;
}

static bool addSweep(Tradeoff* t, int index)
{
    const Sweep* sweep = &SWEEPS[index];
    const char* at = sweep->values != CHOICES ? sweep->values : vplFindOption(optionOf(sweep) + 2)->value;
    char value[32], pattern[128], words[128];
    bool only[MAX_SWEEPS] = {false};
    only[index] = true;
    for (; sscanf(at, "%31[^ |]", value) == 1; at += strlen(value), at += *at != 0) {
        const bool left = strcmp(value, "auto") == 0 || strcmp(value, "usual") == 0;
        snprintf(pattern, sizeof pattern, "%s %s", sweep->words, value);
        expandLengths(t, pattern, words, sizeof words);
        if ((sweep->values != CHOICES || !left) && !addSetting(t, words, only)) {
            return false;
        }
    }
    return true;
}

bool listSettings(Tradeoff* t)
{
    bool chosen[MAX_SWEEPS] = {false}, knobs[MAX_SWEEPS] = {false};
    bool good = chooseSweeps(t->arguments->sweeps, chosen);
    for (int i = 0; i < SWEEP_COUNT; i++) {
        knobs[i] = chosen[i] && SWEEPS[i].meaning != NULL;
    }
    good = good && addSetting(t, "", knobs);
    for (int i = 0; i < SWEEP_COUNT && good; i++) {
        good = !chosen[i] || addSweep(t, i);
    }
    return good;
}
