// SPDX-License-Identifier: MIT
// Plans as JSON files: written for people and for replaying, read for replaying.
#include "base/file.h"
#include "reference/path_trace.h"
#include "render/renderer.h"
#include "render/replay.h"
#include "render/stages/make.h"
#include "scene/json_reader.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { VERSION = 1 };

// ---- writing

// An object or array under construction. A value that could not be made, or was not taken, marks it.
typedef struct Writer {
    json_t* json;
    bool failed;
} Writer;

static void put(Writer* w, const char* key, json_t* value)
{
    w->failed =
        json_object_set_new(w->json, key, value) != 0 || w->failed; // takes the value also where it fails
}

static void putText(Writer* w, const char* key, const char* text)
{
    put(w, key, json_string(text));
}

static void putWriter(Writer* w, const char* key, Writer inner)
{
    w->failed = w->failed || inner.failed;
    put(w, key, inner.json);
}

static void append(Writer* array, Writer element)
{
    array->failed = json_array_append_new(array->json, element.json) != 0 || array->failed || element.failed;
}

static Writer listOptions(const vplRenderOptions* o)
{
    Writer w = {json_object(), false};
    int count;
    const vplOption* options = vplGetOptions(&count);
    for (int i = 0; i < count; i++) {
        char text[64];
        if (vplReplayText(&options[i], o, text)) {
            putText(&w, options[i].name, text);
        }
    }
    return w;
}

static Writer listDecisions(const vplDecision* decisions, int count)
{
    Writer w = {json_array(), false};
    for (int i = 0; i < count; i++) {
        Writer decision = {json_object(), false};
        putText(&decision, "name", decisions[i].name);
        if (decisions[i].value[0] != 0) {
            putText(&decision, "value", decisions[i].value);
        }
        putText(&decision, "why", decisions[i].why);
        append(&w, decision);
    }
    return w;
}

static Writer listStages(const vplPlan* p)
{
    Writer w = {json_array(), false};
    for (int i = 0; i < p->stageCount; i++) {
        Writer stage = {json_object(), false};
        putText(&stage, "name", p->stages[i].name);
        putText(&stage, "inputs", p->stages[i].inputs);
        putText(&stage, "why", p->stages[i].why);
        append(&w, stage);
    }
    return w;
}

// `used` is that of the render so far, or has no JSON.
static Writer describe(const vplScene* scene, const vplPlan* p, const vplRenderOptions* o, Writer used)
{
    Writer w = {json_object(), false}, predicted = {json_object(), false};
    char hash[17];
    snprintf(hash, sizeof hash, "%016llx", (unsigned long long)vplScene_GetHash(scene));
    put(&predicted, "peak_bytes", json_integer(p->peakBytes));
    put(&predicted, "virtual_lights", json_integer(p->virtualLights));
    put(&w, "vpl_plan", json_integer(VERSION));
    putText(&w, "scene", hash);
    putWriter(&w, "options", listOptions(o));
    putWriter(&w, "decisions", listDecisions(p->decisions, p->decisionCount));
    putWriter(&w, "stages", listStages(p));
    putWriter(&w, "left_out", listDecisions(p->leftOut, p->leftOutCount));
    putWriter(&w, "predicted", predicted);
    if (used.json != NULL) {
        putWriter(&w, "used", used);
    }
    return w;
}

static vplResult writePlan(vplContext* context, Writer w, const char* path)
{
    char* text = w.failed ? NULL : json_dumps(w.json, JSON_INDENT(2) | JSON_REAL_PRECISION(9));
    json_decref(w.json);
    if (text == NULL) {
        return vplFail(context, VPL_OUT_OF_MEMORY, "%s: out of memory while writing JSON", path);
    }
    vplByteBuffer file = {.context = context};
    vplByteBuffer_Append(&file, text, strlen(text));
    vplByteBuffer_Append(&file, "\n", 1);
    free(text);
    const vplResult result =
        file.failed ? VPL_OUT_OF_MEMORY : vplWriteFile(context, path, file.bytes, file.size);
    vplFree(context, file.bytes);
    return result;
}

vplResult vplPlan_Write(const vplPlan* plan, const vplScene* scene, const char* path)
{
    REQUIRE(vplScene_GetContext(scene), plan, scene, path);
    const vplRenderOptions o = vplReplayOptions(plan);
    return writePlan(vplScene_GetContext(scene), describe(scene, plan, &o, (Writer){NULL, false}), path);
}

// Replaces what ended the render by counts.
static void fixEnd(const vplShown* shown, vplRenderOptions* o)
{
    if (shown->edgePixels > 0) {
        o->path.edgePixels = shown->edgePixels;
        o->path.edgePaths = shown->edgePaths;
    }
    o->stop.quality = VPL_QUALITY_NONE;
    o->stop.budgetMs = o->stop.maxError = 0;
    if (o->method == VPL_METHOD_PATH) {
        o->path.samples = shown->paths;
    } else {
        o->stop.passes = shown->plan->progressive ? shown->passes : 0;
    }
}

vplResult vplRenderer_WritePlan(vplRenderer* r, const char* path)
{
    REQUIRE(vplRenderer_ContextOf(r), r, path);
    const vplScene* scene = r->runner.run.scene;
    const vplShown shown = vplRenderer_Shown(r);
    if (shown.passes == 0) {
        return vplPlan_Write(shown.plan, scene, path);
    }
    vplRenderOptions o = vplReplayOptions(shown.plan);
    vplRenderStats stats;
    Writer used = {json_object(), false};
    vplRenderer_FinishStats(r, NULL, &stats);
    fixEnd(&shown, &o);
    put(&used, "passes", json_integer(stats.passes));
    put(&used, "total_ms", json_real(stats.totalMs));
    put(&used, "cpu_ms", json_real(stats.cpuMs));
    put(&used, "peak_bytes", json_integer((json_int_t)stats.peakBytes));
    if (stats.relativeErrorEstimate >= 0) {
        put(&used, "relative_error_estimate", json_real(stats.relativeErrorEstimate));
    }
    return writePlan(vplScene_GetContext(scene), describe(scene, shown.plan, &o, used), path);
}

// ---- reading

static vplResult readOption(const vplJson* options, const char* name, vplRenderOptions* o)
{
    const vplJson member = vplJson_Member(options, name);
    const char* text = NULL;
    TRY(vplJson_ReadString(options, name, &text));
    if (text != NULL && vplRenderOptions_Set(o, name, text) != VPL_SUCCESS) {
        return vplJson_Fail(&member, "%s", o->problem + strlen(name) + 1); // "is ..., must be ..."
    }
    return VPL_SUCCESS;
}

// The preset comes first, because it sets others.
static vplResult readOptions(const vplJson* root, vplRenderOptions* o)
{
    const vplJson options = vplJson_Member(root, "options");
    const char* key;
    json_t* value;
    int count;
    const vplOption* rows = vplGetOptions(&count);
    TRY(vplJson_RequireObject(&options));
    json_object_foreach(options.value, key, value)
    {
        const vplJson member = vplJson_Member(&options, key);
        const vplOption* option = vplFindOption(key);
        if (option == NULL || option->kind == VPL_OPTION_PART) {
            return vplJson_Fail(&member, "is no option of this version of the library");
        }
    }
    TRY(readOption(&options, "preset", o));
    for (int i = 0; i < count; i++) {
        TRY(rows[i].kind == VPL_OPTION_PRESET ? VPL_SUCCESS : readOption(&options, rows[i].name, o));
    }
    return VPL_SUCCESS;
}

static vplResult readHash(const vplJson* root, uint64_t* hashOut)
{
    const vplJson member = vplJson_Member(root, "scene");
    const char* text = "";
    TRY(vplJson_ReadString(root, "scene", &text));
    if (strlen(text) != 16 || strspn(text, "0123456789abcdef") != 16) {
        return vplJson_Fail(&member, "must be 16 of the digits 0 to 9 and a to f");
    }
    *hashOut = strtoull(text, NULL, 16);
    return VPL_SUCCESS;
}

static vplResult readPlan(const vplJsonFile* file, vplRenderOptions* o, uint64_t* hashOut)
{
    static const char* const KEYS[] = {"!vpl_plan", "!scene",    "!options", "decisions", "stages",
                                       "left_out",  "predicted", "used",     NULL};
    const vplJson root = vplJson_Root(file), version = vplJson_Member(&root, "vpl_plan");
    double number = 0;
    TRY(vplJson_RequireObject(&root));
    if (version.value != NULL) { // before keys that another version may have
        TRY(vplJson_ReadNumber(&root, "vpl_plan", &number));
        if (number != VERSION) {
            return vplJson_Fail(&version, "is %g, must be %d, the version that this library reads", number,
                                VERSION);
        }
    }
    TRY(vplJson_CheckKeys(&root, KEYS));
    TRY(readHash(&root, hashOut));
    return readOptions(&root, o);
}

vplResult vplRenderOptions_Load(vplContext* context, const char* path, vplRenderOptions* options,
                                uint64_t* sceneHashOut)
{
    REQUIRE(context, context, path, options);
    vplJsonFile file;
    vplRenderOptions o = *options;
    uint64_t hash = 0;
    TRY(vplJsonFile_Open(context, path, &file));
    file.subject = "the plan";
    const vplResult result = readPlan(&file, &o, &hash);
    vplJsonFile_Close(&file);
    if (result == VPL_SUCCESS) {
        *options = o;
        if (sceneHashOut != NULL) {
            *sceneHashOut = hash;
        }
    }
    return result;
}
