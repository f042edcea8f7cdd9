// SPDX-License-Identifier: MIT
// report.html: one file that needs no other and no network. Its one script, which compares two pictures, is
// not needed to read it.
#include "cli/tradeoff/tradeoff.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/utsname.h>
#include <time.h>

static const char CSS[] =
    "body{margin:0;background:var(--paper);color:var(--ink);font:16px/1.5 system-ui,sans-serif}\n"
    "main{max-width:1000px;margin:0 auto;padding:1.5rem}\n"
    "h1{font-size:1.7rem;margin:.2rem 0} h2{margin-top:2.4rem} h3{margin:1.6rem 0 .3rem;font-size:1.05rem}\n"
    "code{background:var(--panel);padding:.1em .3em;border-radius:3px;font-size:.9em}\n"
    "code.copy{display:inline-block;user-select:all;overflow-wrap:anywhere} code span{white-space:nowrap}\n"
    ".answer{border-left:5px solid var(--f3);padding:.4rem .9rem;background:var(--panel);font-size:1.1rem}\n"
    "table{border-collapse:collapse;width:100%;font-size:.92rem} th,td{text-align:left;padding:.35rem .5rem;"
    "border-bottom:1px solid var(--line);vertical-align:top} .n{text-align:right;white-space:nowrap}\n"
    ".small,figcaption{font-size:.85rem;color:var(--soft)} .row{display:flex;gap:.6rem;flex-wrap:wrap}\n"
    "figure{margin:0;flex:1 1 280px} img{width:100%;display:block;border:1px solid var(--line)}\n"
    ".dot{display:inline-block;width:.7em;height:.7em;border-radius:50%;margin-right:.5em}\n"
    ".scroll{overflow-x:auto} details{margin-top:1rem}\n"
    ".stage{position:relative;touch-action:none;cursor:ew-resize;user-select:none} .stage "
    "img{width:100%;display:block}\n"
    ".stage .over{position:absolute;inset:0} .stage "
    ".cut{position:absolute;top:0;bottom:0;width:2px;margin-left:-1px;"
    "background:#fff;box-shadow:0 0 0 1px #000;pointer-events:none}\n"
    ".slider{max-width:960px} .slider input{width:100%;margin:.5rem 0;display:block} .slider "
    "label{display:inline-block;"
    "margin:0 1rem .5rem 0} .slider select{font:inherit;max-width:100%}\n"
    "@media (max-width:720px){table{display:block;overflow-x:auto} td code.copy{min-width:17rem} "
    "td:first-child{min-width:9rem}}\n"
    ".scroll svg.vpl{min-width:700px} "
    "@media print{.slider{display:none}main{max-width:none} h2{break-after:avoid} "
    "figure,tr,svg{break-inside:avoid}}\n";

static void addHead(const Tradeoff* t, Text* html)
{
    const vplRenderOptions* o = &t->arguments->render;
    addText(html, "<!DOCTYPE html>\n<html lang=\"en\">\n<head><meta charset=\"utf-8\">\n<meta "
                  "name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n<meta "
                  "name=\"color-scheme\" content=\"light dark\">\n<title>Error against time: ");
    addEscaped(html, t->arguments->positionals[0]);
    addText(html, "</title>\n<style>\n");
    writeStyle(html);
    addText(html, "%s", CSS);
    for (int i = 0; i < FAMILY_COUNT; i++) {
        addText(html, ".d%d{background:var(--f%d)}", i, i);
    }
    addText(html,
            "\n</style></head>\n<body class=\"vpl\"><main>\n<p class=\"small\">vpl tradeoff %s</p>\n"
            "<h1>Error against time</h1>\n<p>",
            vplGetVersion());
    addEscaped(html, t->arguments->positionals[0]);
    addText(html, ", camera %d, %dx%d pixels.", o->output.camera, o->output.width, o->output.height);
    if (t->interrupted) {
        addText(html, " <strong>Interrupted: only what was measured until then is shown.</strong>");
    }
    addText(html, "</p>\n");
}

static void addReference(const Tradeoff* t, Text* html)
{
    const Reference* r = &t->reference;
    addText(html, "<li>The truth: ");
    if (r->spp > 0) {
        addText(
            html,
            "path traced in two independent halves with %d paths per pixel in all (%s of processor "
            "time), %s. <code>--reference reference-a.pfm,reference-b.pfm</code> uses it again.",
            r->spp, formatTime(r->ms).text,
            t->arguments->render.output.antialias > 1
                ? "all over the pixels: jagged edges count as error"
                : "through the centres of pixels, as methods draw without <code>--antialias</code>: jagged "
                  "edges do not count as error");
    } else {
        addText(html, "<code>");
        addEscaped(html, t->arguments->reference);
        addText(html, "</code>, as given.");
    }
    if (r->error < 0) {
        addText(html, " Its own error is not known; small errors may be the file's.</li>\n");
        return;
    }
    addText(
        html,
        " It is noisy by %s itself, but the noise of the halves is independent and cancels in the mean of (x "
        "&minus; a)(x &minus; b). What remains unknown is <strong>%s</strong>, two standard errors; "
        "no error below that is claimed.</li>\n",
        formatPercent(r->error).text, formatPercent(r->resolution).text);
}

// Writes the processor's name from /proc/cpuinfo ("AMD EPYC ..."), or the architecture from uname without it.
static void describeMachine(char* text, size_t size)
{
    struct utsname system;
    snprintf(text, size, "%s", uname(&system) == 0 ? system.machine : "unknown");
    FILE* file = fopen("/proc/cpuinfo", "r");
    char line[256];
    while (file != NULL && fgets(line, sizeof line, file) != NULL) {
        const char* colon = strchr(line, ':');
        if (strncmp(line, "model name", 10) == 0 && colon != NULL) {
            snprintf(text, size, "%.*s", (int)strcspn(colon + 2, "\n"), colon + 2);
            break;
        }
    }
    if (file != NULL) {
        fclose(file);
    }
}

static void addMachine(const Tradeoff* t, Text* html)
{
    char machine[256], date[64] = "";
    time_t now = time(NULL);
    struct tm local;
    describeMachine(machine, sizeof machine);
    if (localtime_r(&now, &local) != NULL) {
        strftime(date, sizeof date, "%Y-%m-%d %H:%M", &local);
    }
    addText(html, "<li>The machine: ");
    addEscaped(html, machine);
    addText(html,
            ", %d threads, %s instructions, libvpl %s, %s. Pictures and errors are the same on every "
            "machine; times are not.</li>\n",
            vplContext_GetWorkerCount(t->context), vplIsa_GetName(vplContext_GetIsa(t->context)),
            vplGetVersion(), date);
}

// Adds the settings that the time was too short for, by their reasons, and returns their number.
static int addLate(const Tradeoff* t, Text* html)
{
    static const char* const reasons[] = {
        "for lack of time", "because one picture was foreseen to take longer than all the time given",
        "for lack of time, foreseen to be slower or worse than others",
        "because they were cancelled, far slower than foreseen"};
    int counts[4] = {0}, all = 0;
    for (int i = 0; i < t->settingCount; i++) {
        const Setting* s = &t->settings[i];
        const bool late = !isMeasured(s) && s->problem[0] == 0;
        counts[s->leftOut] += late;
        all += late;
    }
    if (all > 0) {
        addText(html, ", %d left out in the time of %g s: ", all, t->arguments->seconds);
    }
    const char* before = "";
    for (int i = 0; i < 4; i++) {
        if (counts[i] > 0) {
            addText(html, "%s%d %s", before, counts[i], reasons[i]);
            before = "; ";
        }
    }
    return all;
}

static void addLeftOut(const Tradeoff* t, Text* html)
{
    int failed = 0, measured = 0;
    for (int i = 0; i < t->settingCount; i++) {
        const Setting* s = &t->settings[i];
        measured += isMeasured(s);
        failed += !isMeasured(s) && s->problem[0] != 0;
    }
    addText(html, "<li>%d settings measured", measured);
    addLate(t, html);
    if (failed == 0) {
        addText(html, ".</li>\n");
        return;
    }
    addText(html, ", %d not measured:</li>\n<ul>", failed);
    for (int i = 0; i < t->settingCount; i++) {
        const Setting* s = &t->settings[i];
        if (!isMeasured(s) && s->problem[0] != 0) {
            addText(html, "<li><code>%s</code>: ", s->change[0] ? s->change : "the base");
            addEscaped(html, s->problem);
            addText(html, "</li>\n");
        }
    }
    addText(html, "</ul>\n");
}

static void addAllSettings(const Tradeoff* t, Text* html)
{
    addText(html,
            "<details><summary>All settings</summary><div class=\"scroll\"><table>\n<tr><th>change from the "
            "base</th><th class=\"n\">seeds</th><th class=\"n\">processor time</th><th "
            "class=\"n\">error</th><th class=\"n\">least to most</th><th class=\"n\">energy</th></tr>\n");
    for (int i = 0; i < t->settingCount; i++) {
        const Setting* s = &t->settings[i];
        addText(html, "<tr><td><code>%s</code>", s->change[0] ? s->change : "the base");
        if (!isMeasured(s)) {
            char reason[SENTENCE];
            addText(html, "</td><td colspan=\"5\">not measured: ");
            addEscaped(html, whyLeftOut(s, reason, sizeof reason));
            addText(html, "</td></tr>\n");
            continue;
        }
        addText(html, "</td><td class=\"n\">%d</td><td class=\"n\">%s</td>", s->runCount,
                formatTime(s->cpuMs).text);
        addText(html, "<td class=\"n\">%s</td><td class=\"n\">%s to %s</td><td class=\"n\">%.3f</td></tr>\n",
                formatPercent(s->error).text, formatPercent(s->errorLow).text,
                formatPercent(s->errorHigh).text, s->energy);
    }
    addText(html, "</table></div></details>\n");
}

static void addMethod(const Tradeoff* t, Text* html)
{
    addText(html, "<h2>How it was measured</h2>\n<ul>\n");
    addReference(t, html);
    addText(
        html,
        "<li>Every setting was rendered with up to %d seed%s from %llu; figures are medians, bands run "
        "from the least to the most. Two cheap settings of every kind ran first, then those foreseen to be "
        "on or near the front, a quarter of the time the knobs, and last what was foreseen to be "
        "worse.</li>\n"
        "<li>Processor time is the time of all threads together for the whole of <code>vpl render</code> "
        "without reading the scene and writing the picture, here measured on %d thread%s. Several "
        "threads share it, so one waits less. Of short renders the fastest of three counts.</li>\n",
        t->arguments->seeds, t->arguments->seeds == 1 ? "" : "s",
        (unsigned long long)t->arguments->render.seed, vplContext_GetWorkerCount(t->context),
        vplContext_GetWorkerCount(t->context) == 1 ? "" : "s");
    addMachine(t, html);
    addText(html, "<li>Physical lighting only: the documented formulas have no falloff with distance, so "
                  "there is no truth to compare them with.</li>\n");
    addLeftOut(t, html);
    addText(html, "<li>Every figure of every run is in <code>tradeoff.csv</code>.</li>\n</ul>\n");
    addAllSettings(t, html);
}

void writeReport(const Tradeoff* t, Text* html)
{
    addHead(t, html);
    addAnswers(t, html);
    addText(html, "<h2>All settings: error against processor time</h2>\n");
    addText(html, "<div class=\"scroll\">\n");
    writePlot(t, html);
    addText(html, "</div>\n");
    addPlanner(t, html);
    addSlider(html);
    addPictures(t, html);
    addClamp(t, html);
    addKnobs(t, html);
    addMethod(t, html);
    addText(html, "</main>\n");
    addScript(html);
    addText(html, "</body></html>\n");
}
