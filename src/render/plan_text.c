// SPDX-License-Identifier: MIT
// A plan as text.
#include "render/plan.h"
#include "base/numbers.h"
#include "render/stages/make.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>

typedef struct Text {
    char* at;
    size_t size, length;
} Text;

__attribute__((format(printf, 2, 3))) static void put(Text* t, const char* format, ...)
{
    const bool room = t->length < t->size;
    va_list arguments;
    va_start(arguments, format);
    const int length =
        vplFormatList(room ? t->at + t->length : NULL, room ? t->size - t->length : 0, format, arguments);
    va_end(arguments);
    t->length += length > 0 ? (size_t)length : 0;
}

static void putBytes(Text* t, const char* before, int64_t bytes)
{
    const bool large = bytes >= 1 << 20;
    put(t, "%s%.1f %s", before, (double)bytes / (large ? 1 << 20 : 1 << 10), large ? "MiB" : "KiB");
}

// Each row begins on a new line.
static void putRow(Text* t, const char* name)
{
    put(t, "\n  %-20s ", name);
}

static void putSize(Text* t, const char* name, const char* before, int64_t bytes)
{
    putRow(t, name);
    putBytes(t, before, bytes);
}

static void putCounts(Text* t, const vplPlan* p)
{
    if (p->options.method == VPL_METHOD_PATH) {
        putRow(t, "paths");
        put(t, p->paths > 0 ? "%lld" : "as many as asked for", (long long)p->paths);
        return;
    }
    if (p->showsPatches) {
        putRow(t, "patches");
        put(t, "%d", p->patches);
        if (p->longestEdge > 0) {
            put(t, ", edges up to %g m", p->longestEdge);
        }
        if (p->patchGroups > 0) {
            putRow(t, "groups");
            put(t, "%d of the patches are groups of %d triangles", p->patchGroups, p->groupedTriangles);
        }
        if (p->litPatches > 0) {
            putRow(t, "lit patches");
            put(t, "%d", p->litPatches);
        }
        putRow(t, "sides");
        put(t, "%d of %d that light reaches", p->patchSides, 2 * p->patches);
        if (!p->linked) {
            putSize(t, "form factors", "", p->formFactorBytes);
        }
    } else {
        putRow(t, "virtual lights");
        put(t, "%lld", (long long)p->virtualLights);
        for (int i = 0; i < p->stepCount && i < 12; i++) {
            put(t, "%s%d", i > 0 ? ", " : " (", p->particlesPerStep[i]);
        }
        put(t, "%s", p->stepCount > 12 ? ", ...)" : p->stepCount > 0 ? ")" : "");
    }
    putRow(t, "draw calls");
    put(t, "%lld", (long long)p->drawCalls);
    putSize(t, "shadow maps", "", p->shadowMapBytes);
    putSize(t, "lights", "", p->lightBytes);
}

// Two digits without an exponent.
static void putMs(Text* t, double ms)
{
    const double value = ms >= 1000 ? ms / 1000 : ms;
    const double step = value >= 1000 ? 100 : 10;
    if (value >= 99.5) {
        put(t, "%.0f", step * floor(value / step + 0.5));
    } else {
        put(t, "%.2g", value);
    }
    put(t, ms >= 1000 ? " s" : " ms");
}

static void putTime(Text* t, const vplPlan* p)
{
    const vplStopOptions* o = &p->options.stop;
    const bool open =
        p->options.method == VPL_METHOD_PATH ? vplPathsAreOpen(p) : p->progressive && o->passes <= 0;
    putRow(t, "time");
    put(t, "about ");
    putMs(t, p->predictedMs);
    put(t, "%s on %s",
        !open                                  ? ""
        : p->options.method == VPL_METHOD_PATH ? " for 32 paths per pixel"
                                               : " for the first pass",
        p->usualSpeeds ? "the machine of our benchmarks" : "this machine");
}

static void putDecisions(Text* t, const char* title, const vplDecision* decisions, int count)
{
    if (count > 0) {
        put(t, "\n%s", title);
    }
    for (int i = 0; i < count; i++) {
        const vplDecision* d = &decisions[i];
        const bool option = d->value[0] != 0;
        char name[64];
        snprintf(name, sizeof name, "%s%s%s%s", option ? "--" : "", d->name, option ? " " : "", d->value);
        put(t, "\n  %-28s %s", name, d->why);
    }
}

static void putLook(Text* t, const vplPlan* p)
{
    const vplLook* l = &p->look;
    if (l->points == 0) {
        return;
    }
    put(t, "\na look at the scene");
    putRow(t, "picture");
    put(t,
        "%.3g %% of it is background; above its surfaces %.3g %% of the directions are open, in %.3g %% "
        "something is near",
        100 * l->background, 100 * l->open, 100 * l->nearShare);
    putRow(t, "light");
    put(t,
        "of %d virtual lights %.3g %% reach the picture, worth %.2g of as many equal ones; %.3g %% of the "
        "particles leave",
        l->lights, 100 * l->reaching, l->worth, 100 * l->lightLeaving);
}

static void putStages(Text* t, const vplPlan* p)
{
    put(t, "\nstages, in this order");
    for (int i = 0; i < p->stageCount; i++) {
        const vplPlanStage* s = &p->stages[i];
        putRow(t, s->name);
        put(t, "%s", s->why);
        if (s->bytes + s->scratch >= 1 << 16) {
            putBytes(t, "; ", s->bytes + s->scratch);
        }
        if (s->inputs[0] != 0) {
            put(t, "; from %s", s->inputs);
        }
    }
}

size_t vplPlan_Describe(const vplPlan* p, char* text, size_t size)
{
    if (p == NULL || (text == NULL && size > 0)) {
        return 0;
    }
    Text t = {text, size, 0};
    char method[32] = "", pipeline[32] = "";
    vplRenderOptions_Get(&p->options, "method", method, sizeof method);
    vplRenderOptions_Get(&p->options, "pipeline", pipeline, sizeof pipeline);
    put(&t, "to render it by %s%s%s, at %dx%d", method, p->showsVirtual ? ", " : "",
        p->showsVirtual ? pipeline : "", p->options.output.width, p->options.output.height);
    if (p->problem[0] != 0) {
        putRow(&t, "not possible:");
        put(&t, "%s\n", p->problem);
        return t.length;
    }
    putCounts(&t, p);
    putSize(&t, "picture", "", p->pictureBytes);
    if (p->layerBytes > 0) {
        char layers[64] = "";
        vplRenderOptions_Get(&p->options, "aov", layers, sizeof layers);
        putSize(&t, "layers", "", p->layerBytes);
        put(&t, ": %s", layers);
    }
    putSize(&t, "most memory", "about ", p->peakBytes);
    putTime(&t, p);
    putLook(&t, p);
    putDecisions(&t, "decisions", p->decisions, p->decisionCount);
    putStages(&t, p);
    putDecisions(&t, "left out", p->leftOut, p->leftOutCount);
    put(&t, "\n");
    return t.length;
}
