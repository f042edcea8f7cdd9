// SPDX-License-Identifier: MIT
// A plan as text.
#include "render/plan.h"

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
        vsnprintf(room ? t->at + t->length : NULL, room ? t->size - t->length : 0, format, arguments);
    va_end(arguments);
    t->length += length > 0 ? (size_t)length : 0;
}

static const char* unitOf(double bytes, double* valueOut)
{
    const bool large = bytes >= 1 << 20;
    *valueOut = bytes / (large ? 1 << 20 : 1 << 10);
    return large ? "MiB" : "KiB";
}

static void putBytes(Text* t, const char* before, int64_t bytes)
{
    double value;
    const char* unit = unitOf((double)bytes, &value);
    put(t, "%s%.1f %s", before, value, unit);
}

static void putRow(Text* t, const char* name, const char* format, int64_t value)
{
    put(t, "  %-20s ", name);
    put(t, "%lld", (long long)value);
    put(t, "%s\n", format);
}

static void putCounts(Text* t, const vplPlan* p)
{
    if (p->options.method == VPL_METHOD_PATH) {
        putRow(t, "paths", "", p->paths);
        return;
    }
    if (p->showsPatches) {
        put(t, "  %-20s %d", "patches", p->patches);
        if (p->longestEdge > 0) {
            put(t, ", edges up to %g m", p->longestEdge);
        }
        put(t, "\n  %-20s %d of %d that light reaches\n", "sides", p->patchSides, 2 * p->patches);
        if (!p->linked) {
            put(t, "  %-20s ", "form factors");
            putBytes(t, "", p->formFactorBytes);
            put(t, "\n");
        }
    } else {
        put(t, "  %-20s %lld", "virtual lights", (long long)p->virtualLights);
        for (int i = 0; i < p->stepCount && i < 12; i++) {
            put(t, "%s%d", i > 0 ? ", " : " (", p->particlesPerStep[i]);
        }
        put(t, "%s\n", p->stepCount > 12 ? ", ...)" : p->stepCount > 0 ? ")" : "");
    }
    putRow(t, "draw calls", "", p->drawCalls);
    put(t, "  %-20s ", "shadow maps");
    putBytes(t, "", p->shadowMapBytes);
    put(t, "\n  %-20s ", "lights");
    putBytes(t, "", p->lightBytes);
    put(t, "\n");
}

static void putDecisions(Text* t, const char* title, const vplDecision* decisions, int count)
{
    if (count > 0) {
        put(t, "%s\n", title);
    }
    for (int i = 0; i < count; i++) {
        const vplDecision* d = &decisions[i];
        const bool option = d->value[0] != 0;
        char name[64];
        snprintf(name, sizeof name, "%s%s%s%s", option ? "--" : "", d->name, option ? " " : "", d->value);
        put(t, "  %-28s %s\n", name, d->why);
    }
}

static void putStages(Text* t, const vplPlan* p)
{
    put(t, "stages, in this order\n");
    for (int i = 0; i < p->stageCount; i++) {
        const vplPlanStage* s = &p->stages[i];
        put(t, "  %-20s %s", s->name, s->why);
        if (s->bytes + s->scratch >= 1 << 16) {
            putBytes(t, "; ", s->bytes + s->scratch);
        }
        if (s->inputs[0] != 0) {
            put(t, "; from %s", s->inputs);
        }
        put(t, "\n");
    }
}

size_t vplPlan_Describe(const vplPlan* p, char* text, size_t size)
{
    Text t = {text, size, 0};
    char method[32] = "", pipeline[32] = "";
    vplRenderOptions_Get(&p->options, "method", method, sizeof method);
    vplRenderOptions_Get(&p->options, "pipeline", pipeline, sizeof pipeline);
    put(&t, "to render it by %s%s%s, at %dx%d\n", method, p->showsVirtual ? ", " : "",
        p->showsVirtual ? pipeline : "", p->options.output.width, p->options.output.height);
    if (p->problem[0] != 0) {
        put(&t, "  %-20s %s\n", "not possible:", p->problem);
        return t.length;
    }
    putCounts(&t, p);
    put(&t, "  %-20s ", "picture");
    putBytes(&t, "", p->pictureBytes);
    put(&t, "\n  %-20s ", "most memory");
    putBytes(&t, "about ", p->peakBytes);
    put(&t, "\n");
    putDecisions(&t, "decisions", p->decisions, p->decisionCount);
    putStages(&t, p);
    putDecisions(&t, "left out", p->leftOut, p->leftOutCount);
    return t.length;
}
