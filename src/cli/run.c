// SPDX-License-Identifier: MIT
// What all commands share: messages, contexts, scenes, exit codes, --explain and --dry-run.
#include "cli/calibration.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char* speaker = "vpl"; // NULL: nobody speaks

void setSpeaker(const char* name)
{
    speaker = name;
}

// Written by one call, so that lines of several processes do not mix.
void complain(const char* format, ...)
{
    char text[8192];
    va_list arguments;
    if (speaker == NULL) {
        return;
    }
    int length = snprintf(text, sizeof text, "%s: ", speaker);
    va_start(arguments, format);
    length += vsnprintf(text + length, sizeof text - (size_t)length - 1, format, arguments);
    va_end(arguments);
    const int most = (int)sizeof text - 2;
    length = length < most ? length : most;
    text[length] = '\n';
    fwrite(text, 1, (size_t)length + 1, stderr);
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

vplResult openContext(const Arguments* arguments, vplContext** contextOut)
{
    vplContextDef def = arguments->context;
    def.log = logToStderr;
    def.logUser = (void*)arguments;
    *contextOut = NULL;
    const vplResult result = vplContext_Create(&def, contextOut);
    if (result == VPL_SUCCESS) {
        const size_t mib = (size_t)arguments->memoryMib << 20;
        vplContext_SetMemoryLimit(*contextOut, mib > 0 ? mib : usableBytes());
    }
    return result;
}

vplResult loadNamedScene(const Arguments* a, vplContext* context, vplScene** sceneOut)
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
    if (result == VPL_SUCCESS) {
        result = vplScene_SetFrame(*sceneOut, a->render.sequence.frame);
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

int explainPlan(const Arguments* a, const vplScene* scene)
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
    vplContext* context;
    vplScene* scene = NULL;
    int code = exitCode(openContext(a, &context), true);
    if (code == EXIT_DONE) {
        code = exitCode(loadNamedScene(a, context, &scene), true);
    }
    if (code == EXIT_DONE && a->planIn != NULL && !a->quiet && a->planScene != vplScene_GetHash(scene)) {
        complain("warning: %s was made for another scene, or %s was changed since: the picture will differ",
                 a->planIn, a->positionals[0]);
    }
    if (code == EXIT_DONE) {
        code = exitCode(findSpeeds(a, context), false);
    }
    if (code == EXIT_DONE && (a->explain || a->dryRun)) {
        code = explainPlan(a, scene);
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
