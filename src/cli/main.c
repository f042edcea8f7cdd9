// SPDX-License-Identifier: MIT
#include "cli/calibration.h"

#include <errno.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

void complain(const char* format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    fputs("vpl: ", stderr);
    vfprintf(stderr, format, arguments);
    fputc('\n', stderr);
    va_end(arguments);
}

void logToStderr(void* user, vplLogLevel level, const char* message)
{
    const Arguments* arguments = user;
    if (level == VPL_LOG_ERROR) {
        complain("%s", message);
    } else if (level == VPL_LOG_WARNING ? !arguments->quiet : arguments->verbose) {
        complain("%s%s", level == VPL_LOG_WARNING ? "warning: " : "", message);
    }
}

// Nine tenths of the machine's memory: the rest is for the system and for what the plan gets wrong. 0 where the system does
// not say how much there is.
static size_t usableBytes(void)
{
    const long pages = sysconf(_SC_PHYS_PAGES), size = sysconf(_SC_PAGESIZE);
    return pages > 0 && size > 0 ? (size_t)pages / 10 * 9 * (size_t)size : 0;
}

vplContext* openContext(const Arguments* arguments)
{
    vplContextDef def = arguments->context;
    def.log = logToStderr;
    def.logUser = (void*)arguments;
    vplContext* context = NULL;
    if (vplContext_Create(&def, &context) == VPL_SUCCESS) {
        const size_t mib = (size_t)arguments->memoryMib << 20;
        vplContext_SetMemoryLimit(context, mib > 0 ? mib : usableBytes());
    }
    return context;
}

vplResult loadScene(const Arguments* a, vplContext* context, vplScene** sceneOut)
{
    vplModelSceneDef def = vplDefaultModelSceneDef();
    def.aspect = (double)a->render.output.width / a->render.output.height;
    def.ground = !a->noGround;
    def.areaLight = a->render.lighting != VPL_LIGHTING_DOCUMENTED; // which has no area lights
    vplContext_SetProgress(context, askInterrupts, NULL);          // a pipe may be silent
    def.unlit = a->environment != NULL || a->sky != NULL;
    vplResult result = vplScene_LoadFor(context, a->positionals[0], &def, sceneOut);
    if (result == VPL_SUCCESS) {
        result = addEnvironment(a, *sceneOut);
    }
    vplContext_SetProgress(context, NULL, NULL); // an interrupted render still writes its picture
    return result;
}

int exitCode(vplResult result, bool reading)
{
    switch (result) {
    case VPL_SUCCESS:
        return EXIT_DONE;
    case VPL_INVALID_ARGUMENT:
    case VPL_LIMIT:
    case VPL_PARSE_ERROR:
        return EXIT_USAGE;
    case VPL_FILE_ERROR:
        return reading ? EXIT_USAGE : EXIT_COULD_NOT;
    case VPL_CANCELLED:
        complain("cancelled, nothing was written");
        return EXIT_COULD_NOT;
    case VPL_OUT_OF_MEMORY:
        break;
    }
    return EXIT_COULD_NOT;
}

int printPlan(const vplPlan* plan, FILE* file)
{
    const size_t length = vplPlan_Describe(plan, NULL, 0);
    char* text = malloc(length + 1);
    if (text == NULL) {
        complain("out of memory");
        return EXIT_COULD_NOT;
    }
    vplPlan_Describe(plan, text, length + 1);
    fputs(text, file);
    free(text);
    return EXIT_DONE;
}

vplResult planRender(const Arguments* a, const vplScene* scene, vplPlan** planOut)
{
    vplRenderOptions options = a->render;
    options.progress = askInterrupts;
    return vplPlan_Create(scene, &options, NULL, planOut);
}

// --explain and --dry-run.
static int explain(const Arguments* a, const vplScene* scene)
{
    vplPlan* plan = NULL;
    int code = exitCode(planRender(a, scene, &plan), true);
    if (code == EXIT_DONE && a->dryRun && plan->problem[0] != 0) {
        complain("%s", plan->problem);
        code = exitCode(plan->refusal, false);
    } else if (code == EXIT_DONE) {
        code = printPlan(plan, a->dryRun ? stdout : stderr);
        if (code == EXIT_DONE && a->dryRun && a->planOut != NULL) {
            catchInterrupts();
            code = exitCode(vplPlan_Write(plan, scene, a->planOut), false);
        }
    }
    vplPlan_Destroy(plan);
    return code;
}

int runOnScene(const Arguments* a, SceneWork* work)
{
    vplContext* context = openContext(a);
    if (context == NULL) {
        return EXIT_USAGE;
    }
    vplScene* scene = NULL;
    int code = exitCode(loadScene(a, context, &scene), true);
    if (code == EXIT_DONE) {
        code = exitCode(vplScene_SetFrame(scene, a->render.sequence.frame), true);
    }
    if (code == EXIT_DONE && a->planIn != NULL && !a->quiet && a->planScene != vplScene_GetHash(scene)) {
        complain("warning: %s was made for another scene, or %s was changed since: the picture will differ",
                 a->planIn, a->positionals[0]);
    }
    if (code == EXIT_DONE) {
        findSpeeds(a, context);
    }
    if (code == EXIT_DONE && (a->explain || a->dryRun)) {
        code = explain(a, scene);
    }
    if (code == EXIT_DONE && !a->dryRun) {
        code = work(a, scene);
    }
    vplScene_Destroy(scene);
    vplContext_Destroy(context);
    return code;
}

int finishOutput(int code)
{
    if (fflush(stdout) != 0 || ferror(stdout)) {
        complain("cannot write to standard output: %s", strerror(errno));
        return EXIT_COULD_NOT;
    }
    return code;
}

static int runCommand(const Command* command, int count, const char* const* words)
{
    Arguments arguments;
    if (!parseArguments(count, words, &arguments)) {
        return EXIT_USAGE;
    }
    if (arguments.help) {
        printHelp(command->name, NULL);
        return finishOutput(EXIT_DONE);
    }
    if (arguments.positionalCount < (command->bit == MERGE ? 1 : command->positionals)) {
        complain("%s needs %s; vpl help %s", command->name,
                 command->bit == MERGE     ? "parts of a picture"
                 : command->bit == COMPARE ? "two pictures"
                                           : "a scene file",
                 command->name);
        return EXIT_USAGE;
    }
    return finishOutput(command->run(&arguments));
}

int main(int count, char** words)
{
    signal(SIGPIPE, SIG_IGN); // writing to a closed pipe then fails, and is reported
    signal(SIGXFSZ, SIG_IGN); // so is writing beyond the file size limit
    const char* word = count > 1 ? words[1] : NULL;
    if (word == NULL) {
        complain("no command; vpl help lists them");
        return EXIT_USAGE;
    }
    if (strcmp(word, "--version") == 0) {
        printf("vpl %s\n", vplGetVersion());
        return finishOutput(EXIT_DONE);
    }
    if (strcmp(word, "help") == 0 || strcmp(word, "--help") == 0 || strcmp(word, "-h") == 0) {
        const bool done = printHelp(count > 2 ? words[2] : NULL, count > 3 ? words[3] : NULL);
        return finishOutput(done ? EXIT_DONE : EXIT_USAGE);
    }
    if (strcmp(word, "completion") == 0) {
        return finishOutput(printCompletion(count > 2 ? words[2] : "") ? EXIT_DONE : EXIT_USAGE);
    }
    const Command* command = findCommand(word);
    if (command == NULL) {
        const char* nearest = nearestCommand(word);
        complain(nearest != NULL ? "no command \"%s\", did you mean %s?"
                                 : "no command \"%s\"; vpl help lists them",
                 word, nearest);
        return EXIT_USAGE;
    }
    return runCommand(command, count, (const char* const*)words);
}
