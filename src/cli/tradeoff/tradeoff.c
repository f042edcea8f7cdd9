// SPDX-License-Identifier: MIT
// vpl tradeoff: measures error against time.
#include "cli/tradeoff/tradeoff.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char* const FILES[] = {"tradeoff.csv", "tradeoff.svg", "report.html", "reference-a.pfm",
                                    "reference-b.pfm"};

enum { FILE_COUNT = sizeof FILES / sizeof *FILES };

// Keeps the last error of the library, and prints errors and warnings unless settings are being tried out.
static void keepLog(void* user, vplLogLevel level, const char* message)
{
    Tradeoff* t = user;
    if (level == VPL_LOG_ERROR) {
        snprintf(t->message, sizeof t->message, "%s", message);
    }
    if (!t->silent && level != VPL_LOG_INFO) {
        logToStderr((void*)t->arguments, level, message);
    }
}

// Returns false if the path is too long. prepareFolder has checked this for all files.
static bool joinPath(const char* folder, const char* name, char* path)
{
    return snprintf(path, PATH_MAX, "%s/%s", folder, name) < PATH_MAX;
}

// Makes the folder if it is missing, and then sets *made. Checks that all files can be written.
static bool prepareFolder(const char* folder, bool* made)
{
    char path[PATH_MAX];
    *made = mkdir(folder, 0777) == 0;
    if (!*made && errno != EEXIST) {
        complain("%s: cannot create the folder: %s", folder, strerror(errno));
        return false;
    }
    for (int i = 0; i < FILE_COUNT; i++) {
        if (!joinPath(folder, FILES[i], path)) {
            complain("%s: the name is too long", folder);
            return false;
        }
        if (!checkOutput(path)) {
            return false;
        }
    }
    return true;
}

static bool writeResult(const Tradeoff* t, const char* name, void write(const Tradeoff* t, Text* text))
{
    char path[PATH_MAX];
    Text text = {0};
    write(t, &text);
    joinPath(t->arguments->output, name, path);
    bool good = !text.failed && text.bytes != NULL;
    if (!good) {
        complain("%s: out of memory", path);
    }
    good = good && writeTextFile(path, text.bytes);
    free(text.bytes);
    return good;
}

static int writeResults(Tradeoff* t)
{
    char path[PATH_MAX];
    const char* folder = t->arguments->output;
    for (int i = 0; i < 2 && t->reference.spp > 0; i++) {
        joinPath(folder, i == 0 ? "reference-a.pfm" : "reference-b.pfm", path);
        if (vplImage_Write(t->reference.halves[i], path, NULL) != VPL_SUCCESS) {
            return EXIT_COULD_NOT;
        }
    }
    bool good = writeResult(t, "tradeoff.csv", writeTable) && writeResult(t, "tradeoff.svg", writePlot) &&
                writeResult(t, "report.html", writeReport);
    if (good && t->interrupted) {
        complain("interrupted; what had been measured is in %s/report.html", folder);
    }
    return good && !t->interrupted ? EXIT_DONE : EXIT_COULD_NOT;
}

// Writes the report: alone, or as the first of a crew.
static bool leads(const Tradeoff* t)
{
    return t->crew == NULL || t->crew->index == 0;
}

static int agree(const Tradeoff* t, int code)
{
    return t->crew != NULL ? t->crew->agree(t->crew->user, code) : code;
}

static int measure(Tradeoff* t)
{
    t->start = 1e-3 * wallMs();
    t->deadline = t->start + t->arguments->seconds;
    t->limit = INFINITY;
    t->progress = beginProgress(t->arguments->quiet);
    int code = leads(t) || t->arguments->reference != NULL ? makeReference(t) : EXIT_DONE;
    code = agree(t, code);
    if (code == EXIT_DONE && t->crew != NULL && t->arguments->reference == NULL) {
        code = t->crew->shareReference(t->crew->user, t);
    }
    if (code == EXIT_DONE) {
        code = measureSettings(t);
    }
    endProgress(&t->progress);
    return code;
}

static vplResult openContextFor(Tradeoff* t, int workers, vplContext** contextOut)
{
    vplContextDef def = t->arguments->context;
    def.log = keepLog;
    def.logUser = t;
    def.workerCount = workers;
    return vplContext_Create(&def, contextOut);
}

static int readScene(Tradeoff* t)
{
    int code = exitCode(loadNamedScene(t->arguments, t->context, &t->scene), true);
    if (code == EXIT_DONE && t->arguments->reference == NULL) {
        t->silent = true; // warnings about the scene have been printed
        code = exitCode(loadNamedScene(t->arguments, t->tracing, &t->traced), true);
        t->silent = false;
    }
    if (code != EXIT_DONE) {
        return code;
    }
    vplGeometry* geometry = NULL;
    code = exitCode(vplGeometry_Create(t->scene, &geometry), true);
    t->diagonal = geometry ? (double)vplGeometry_Diagonal(geometry) : 0;
    vplGeometry_Destroy(geometry);
    const int cameras = vplScene_GetCameraCount(t->scene), camera = t->arguments->render.output.camera;
    if (code == EXIT_DONE && camera >= cameras) {
        complain("--camera is %d, the scene has %d (from 0)", camera, cameras);
        code = EXIT_USAGE;
    }
    return code;
}

static int run(Tradeoff* t)
{
    int code = readScene(t);
    code = agree(t, code == EXIT_DONE && !listSettings(t) ? EXIT_USAGE : code);
    if (code != EXIT_DONE) {
        return code;
    }
    catchInterrupts(); // before, an interrupt ends the program: reading a scene may wait for ever
    bool made = false;
    if (t->arguments->reference != NULL) { // before the folder is made: a bad reference leaves none behind
        code = makeReference(t);
    }
    if (code == EXIT_DONE && leads(t) && !prepareFolder(t->arguments->output, &made)) {
        code = EXIT_COULD_NOT;
    }
    code = agree(t, code);
    if (code == EXIT_DONE) {
        code = measure(t);
        code = code == EXIT_DONE && leads(t) ? writeResults(t) : code;
    }
    if (code != EXIT_DONE && made) {
        rmdir(t->arguments->output); // stays if there is something in it
    }
    return code;
}

static void destroy(Tradeoff* t)
{
    for (int i = 0; i < t->settingCount; i++) {
        vplImage_Destroy(t->settings[i].image);
    }
    free(t->runs);
    vplImage_Destroy(t->reference.image);
    vplImage_Destroy(t->reference.halves[0]);
    vplImage_Destroy(t->reference.halves[1]);
    vplScene_Destroy(t->scene);
    vplContext_Destroy(t->context);
    vplScene_Destroy(t->traced);
    vplContext_Destroy(t->tracing);
    free(t);
}

int checkTradeoff(const Arguments* a)
{
    if (a->output == NULL) {
        complain("tradeoff needs -o DIR, the folder for the report");
        return EXIT_USAGE;
    }
    if (a->render.lighting != VPL_LIGHTING_PHYSICAL) {
        complain("--lighting documented has no truth to measure errors against; tradeoff is for physical");
        return EXIT_USAGE;
    }
    return EXIT_DONE;
}

int runTradeoff(const Arguments* a)
{
    const int code = checkTradeoff(a);
    return code == EXIT_DONE ? runTradeoffWith(a, NULL) : code;
}

int runTradeoffWith(const Arguments* a, const Crew* crew)
{
    Tradeoff* t = calloc(1, sizeof *t);
    if (t == NULL) {
        complain("out of memory");
        return EXIT_COULD_NOT;
    }
    t->arguments = a;
    t->crew = crew;
    // One thread unless told otherwise: waiting threads use processor time, too, the more the busier the
    // machine is.
    int workers = a->threadsCount > 0 ? a->context.workerCount : 1;
    int code = exitCode(openContextFor(t, workers, &t->context), true);
    if (code == EXIT_DONE) {
        code = exitCode(openContextFor(t, a->context.workerCount, &t->tracing), true);
    }
    if (code == EXIT_DONE) {
        code = run(t);
    }
    destroy(t);
    return code;
}
