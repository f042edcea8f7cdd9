// SPDX-License-Identifier: MIT
// Prints the table as text or as Markdown.
#include "peers.h"

#include <stdio.h>
#include <string.h>

static void readProcessor(char name[128])
{
    char line[256];
    strcpy(name, "unknown processor");
    FILE* file = fopen("/proc/cpuinfo", "r");
    while (file != NULL && fgets(line, sizeof line, file) != NULL) {
        const char* colon = strchr(line, ':');
        if (strncmp(line, "model name", 10) == 0 && colon != NULL) {
            snprintf(name, 128, "%.*s", (int)strcspn(colon + 2, "\n"), colon + 2);
            break;
        }
    }
    if (file != NULL) {
        fclose(file);
    }
}

// Writes the row's rate, for example "1.23 G/s", or "" if the row has none.
static void formatRate(char text[16], const Row* row, double work, double ms)
{
    text[0] = 0;
    if (row->unit == UNIT_LIGHTS) {
        snprintf(text, 16, "%.2f G/s", 1e-6 * work / ms);
    } else if (row->unit != UNIT_NONE) {
        snprintf(text, 16, "%.*f M/s", row->unit == UNIT_TRIANGLES ? 1 : 0, 1e-3 * work / ms);
    }
}

static void printRow(const Options* o, const Room* room, const Row* row, const Figure* f)
{
    char ours[16] = "-", ratio[16] = "-", error[16] = "-", glRate[16], rate[16] = "", draws[48];
    const double gl = f->glMs[f->best], work = workOf(room, row);
    formatRate(glRate, row, work, gl);
    snprintf(draws, sizeof draws, "%lld / -", (long long)f->glDraws);
    if (row->vpl != NULL) {
        snprintf(ours, sizeof ours, "%.1f", f->vplMs);
        snprintf(ratio, sizeof ratio, "%.2f", gl / f->vplMs);
        snprintf(error, sizeof error, "%.1e", f->error);
        snprintf(draws, sizeof draws, "%lld / %lld", (long long)f->glDraws, (long long)f->vplDraws);
        formatRate(rate, row, work, f->vplMs);
    }
    const char* format = o->markdown ? "| %s | %s | %.1f | %s | %s | %s | %s | %s | %s | %s | %d |\n"
                                     : "%-31s  %-14s %8.1f %8s %6s  %10s %10s  %-18s %13s  %-7s %4d\n";
    printf(format, row->name, row->gl[f->best].name, gl, ours, ratio, glRate, rate,
           row->goal[o->threads != 1], draws, error, f->runs);
}

void printTable(const Options* o, const Room* room, const Gl* gl, const Figure* figures)
{
    char processor[128];
    readProcessor(processor);
    const char* end = o->markdown ? "  \n" : "\n";
    printf("%s; OpenGL: %s, %s%s", processor, rendererOfGl(gl), versionOfGl(gl), end);
    printf("%dx%d, %lld pixels covered; %d thread%s, ms of %s; medians of up to %d alternated runs%s",
           o->width, o->height, (long long)room->covered, o->threads, o->threads == 1 ? "" : "s",
           o->threads == 1 ? "processor time" : "wall-clock time", o->runs, end);
    printf("rates of lights: covered pixels x lights; error: rmse / mean of libvpl's; goals: the issue's%s\n",
           o->markdown ? "\n" : "");
    if (o->markdown) {
        printf("| | OpenGL's way | OpenGL | libvpl | ratio | OpenGL | libvpl | goal (Mesa 25) | draw calls | "
               "error | runs |\n"
               "| --- | --- | ---: | ---: | ---: | ---: | ---: | --- | ---: | ---: | ---: |\n");
    } else {
        printf("%-31s  %-14s %8s %8s %6s  %10s %10s  %-18s %13s  %-7s %4s\n", "", "OpenGL's way", "OpenGL",
               "libvpl", "ratio", "OpenGL", "libvpl", "goal (Mesa 25)", "draw calls", "error", "runs");
    }
    for (int i = 0; i < ROW_COUNT; i++) {
        if (figures[i].runs > 0) {
            printRow(o, room, &ROWS[i], &figures[i]);
        }
    }
}
