// SPDX-License-Identifier: MIT
// Pictures of the front, each beside the reference and the difference.
#include "cli/tradeoff/tradeoff.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

// More would make a page of many megabytes.
enum { MAX_PICTURES = 10 };

// Chooses the exposure that all pictures share: whole stops, so that nine in ten of the reference's lit
// values are at most 0.8.
static float chooseExposure(const Tradeoff* t)
{
    const vplImage* image = t->reference.image;
    size_t count = 3 * (size_t)image->width * (size_t)image->height;
    float exposure = -30;
    for (; exposure < 30; exposure++) {
        double next = ldexp(1, (int)exposure + 1);
        size_t lit = 0, above = 0;
        for (size_t i = 0; i < count; i++) {
            lit += image->pixels[i] > 0;
            above += next * (double)image->pixels[i] > 0.8;
        }
        if (10 * above > lit) {
            break;
        }
    }
    return exposure;
}

// A picture with a name can be chosen for the slider.
static void addFigure(Text* html, const vplImage* image, const vplWriteOptions* options, const char* caption,
                      const char* name)
{
    addText(html, "<figure><img alt=\"%s\"", caption);
    if (name != NULL) {
        addText(html, " data-name=\"%s\"", name);
    }
    addText(html, " width=\"%d\" height=\"%d\" src=\"", image->width, image->height);
    addPicture(html, image, options);
    addText(html, "\"><figcaption>%s</figcaption></figure>\n", caption);
}

// About half of the reference's mean, rounded to one digit for the labels of the bar.
static double heatScale(const Tradeoff* t)
{
    char text[32];
    snprintf(text, sizeof text, "%.0e", 0.5 * t->reference.mean);
    return strtod(text, NULL);
}

static void addPoint(const Tradeoff* t, const Setting* s, const vplWriteOptions* options, bool first,
                     Text* html)
{
    char caption[128], name[128];
    snprintf(name, sizeof name, "%d: %s, %s, %s error", s->number, FAMILY_NAMES[s->family],
             formatTime(s->cpuMs).text, formatPercent(s->runs[0].error).text);
    addText(html, "<h3>%d &middot; %s &middot; %s error</h3>\n<p><code>", s->number,
            formatTime(s->cpuMs).text, formatPercent(s->runs[0].error).text);
    addWords(html, s->command);
    addText(html, "</code></p>\n<div class=\"row\">");
    addFigure(html, s->image, options, FAMILY_NAMES[s->family], name);
    addFigure(html, t->reference.image, options, "the truth", first ? "the truth" : NULL);
    vplImage* map = NULL;
    if (vplImage_Heatmap(s->image, t->reference.image, (float)heatScale(t), &map) == VPL_SUCCESS) {
        snprintf(caption, sizeof caption,
                 "difference; white is %g W/(m&sup2; sr), about half the truth's mean", heatScale(t));
        addFigure(html, map, NULL, caption, NULL);
    } else {
        html->failed = true;
    }
    vplImage_Destroy(map);
    addText(html, "</div>\n");
}

// Chooses points of the front by ascending cost: all, or if they are too many evenly spaced ones and the
// last.
static int choosePoints(const Tradeoff* t, const Setting** chosen)
{
    const Setting* front[MAX_SETTINGS];
    int count = 0;
    for (int i = 0, all = listFront(t, front); i < all; i++) {
        front[count] = front[i];
        count += front[i]->image != NULL;
    }
    int kept = count < MAX_PICTURES ? count : MAX_PICTURES;
    for (int i = 0; i < kept; i++) {
        chosen[i] = front[kept > 1 ? i * (count - 1) / (kept - 1) : 0];
    }
    return kept;
}

void addPictures(const Tradeoff* t, Text* html)
{
    const Setting* chosen[MAX_PICTURES];
    vplWriteOptions options = vplDefaultWriteOptions();
    options.exposure = t->arguments->exposure != 0 ? (float)t->arguments->exposure : chooseExposure(t);
    int count = choosePoints(t, chosen);
    addText(html,
            "<h2>What it looks like</h2>\n<p>Settings on the front of the plot, by their numbers there; "
            "first seed; exposure %+g stops.</p>\n",
            (double)options.exposure);
    for (int i = 0; i < count; i++) {
        addPoint(t, chosen[i], &options, i == 0, html);
    }
}
