// SPDX-License-Identifier: MIT
// Compares libvpl with Mesa's llvmpipe: both draw the same room in one process that alternates them:
//   bench/peers [--scene FILE] [--size WxH] [--threads 1|2] [--runs N] [--only TEXT] [--markdown]
// One thread is measured in processor time, several in wall-clock time. If OpenGL has several ways to draw a
// row, the fastest counts. The results of a row are compared, which shows that both sides drew the same
// picture.
#include "peers.h"

#include "cli/bench/measure.h"

#include <malloc.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { MOST_RUNS = 100, FEW_LIGHTS = 64 };

// A row ends after so many ms, so that the slowest rows do not take all the time.
static const double ROW_MS = 2000;

static double now(const Options* o)
{
    return o->threads == 1 ? cpuMs() : wallMs();
}

static void drawGl(Gl* gl, const Row* row, int way)
{
    resetDrawsOfGl(gl);
    row->gl[way].draw(gl, row);
    finishGl();
}

static double timeGl(const Options* o, Gl* gl, const Row* row, int way)
{
    finishGl();
    const double start = now(o);
    drawGl(gl, row, way);
    return now(o) - start;
}

static double timeVpl(const Options* o, Room* room, const Row* row)
{
    room->draws = 0;
    const double start = now(o);
    row->vpl(room, row);
    const double ms = now(o) - start;
    // Idle workers spin for a while. The pause keeps that out of OpenGL's time.
    const struct timespec pause = {0, 10000000};
    if (o->threads > 1) {
        nanosleep(&pause, NULL);
    }
    return ms;
}

// ---- is it the same picture?

static size_t sizeOf(const Room* room, Product product)
{
    const size_t pixels = (size_t)room->view.width * (size_t)room->view.height;
    return product == PRODUCT_CUBE      ? 6 * CUBE_SIZE * CUBE_SIZE
           : product == PRODUCT_PICTURE ? 3 * pixels
                                        : pixels;
}

static const float* resultOf(const Room* room, Product product)
{
    switch (product) {
    case PRODUCT_PICTURE:
        return room->image->pixels;
    case PRODUCT_DEPTH:
        return room->depth;
    case PRODUCT_LAYERS:
        return room->colour;
    case PRODUCT_CUBE:
        break;
    }
    return room->map->texels;
}

// Maps empty texels to one value: OpenGL's cube map has 1 there, libvpl's infinity.
static float clipped(float x)
{
    return x < 1e30f ? x : 1;
}

// Returns the RMSE relative to the mean of libvpl's result.
static double compareResults(Gl* gl, const Room* room, const Row* row)
{
    const size_t count = sizeOf(room, row->product);
    const float* ours = resultOf(room, row->product);
    float* theirs = malloc(count * sizeof(float));
    demand(theirs != NULL, "out of memory");
    readGl(gl, row->product, theirs);
    double square = 0, sum = 0;
    for (size_t i = 0; i < count; i++) {
        const double d = (double)clipped(theirs[i]) - (double)clipped(ours[i]);
        square += d * d;
        sum += (double)clipped(ours[i]);
    }
    free(theirs);
    return sqrt(square / (double)count) / (sum / (double)count);
}

// ---- rows

// Chooses the OpenGL ways to measure: all if the row is small, else the one that was fastest with few lights.
// It compares processor time, which other programs on the machine disturb least. The call also compiles
// shaders and touches memory.
static int chooseWays(Gl* gl, Room* room, const Row* row, int* countOut)
{
    Row few = *row;
    few.lights = row->lights < FEW_LIGHTS ? row->lights : FEW_LIGHTS;
    double best = 0;
    int first = 0, count = 0;
    for (; few.gl[count].draw != NULL; count++) {
        drawGl(gl, &few, count);
        const double start = cpuMs();
        drawGl(gl, &few, count);
        const double ms = cpuMs() - start;
        if (count == 0 || ms < best) {
            best = ms;
            first = count;
        }
    }
    if (few.vpl != NULL) {
        few.vpl(room, &few);
    }
    const bool all = row->lights <= FEW_LIGHTS;
    *countOut = all ? count : 1;
    return all ? 0 : first;
}

static Figure measureRow(const Options* o, Gl* gl, Room* room, const Row* row)
{
    double glMs[GL_WAYS][MOST_RUNS], vplMs[MOST_RUNS];
    Figure f = {0};
    int64_t draws[GL_WAYS] = {0};
    int ways;
    const int first = chooseWays(gl, room, row, &ways);
    const double start = now(o);
    for (; f.runs < o->runs && (f.runs == 0 || now(o) - start < ROW_MS); f.runs++) {
        for (int way = first; way < first + ways; way++) {
            glMs[way][f.runs] = timeGl(o, gl, row, way);
            draws[way] = drawsOfGl(gl);
            if (row->vpl != NULL && way == first) {
                vplMs[f.runs] = timeVpl(o, room, row);
                f.vplDraws = room->draws;
            }
        }
    }
    f.best = first;
    for (int way = first; way < first + ways; way++) {
        f.glMs[way] = medianOf(glMs[way], f.runs);
        f.best = f.glMs[way] < f.glMs[f.best] ? way : f.best;
    }
    f.glDraws = draws[f.best];
    if (row->vpl != NULL) {
        f.vplMs = medianOf(vplMs, f.runs);
        f.error = compareResults(gl, room, row);
    }
    return f;
}

static bool readOption(Options* o, const char* name, const char* value)
{
    if (strcmp(name, "--scene") == 0) {
        o->scene = value;
    } else if (strcmp(name, "--only") == 0) {
        o->only = value;
    } else if (strcmp(name, "--threads") == 0) {
        o->threads = atoi(value);
    } else if (strcmp(name, "--runs") == 0) {
        o->runs = atoi(value);
    } else if (strcmp(name, "--size") == 0) {
        return sscanf(value, "%dx%d", &o->width, &o->height) == 2;
    } else {
        return false;
    }
    return true;
}

static Options readOptions(int argc, char** argv)
{
    Options o = {"examples/scenes/room.json", NULL, 1920, 1080, 1, 7, false};
    bool ok = true;
    for (int i = 1; i < argc && ok; i++) {
        if (strcmp(argv[i], "--markdown") == 0) {
            o.markdown = true;
        } else {
            ok = i + 1 < argc && readOption(&o, argv[i], argv[i + 1]);
            i++;
        }
    }
    demand(
        ok,
        "usage: bench/peers [--scene FILE] [--size WxH] [--threads T] [--runs N] [--only TEXT] [--markdown]");
    demand(o.threads >= 1 && o.threads <= 16 && o.runs >= 1 && o.runs <= MOST_RUNS,
           "threads: 1 to 16, runs: 1 to 100");
    demand(o.width >= 16 && o.height >= 16 && o.width <= 8192 && o.height <= 8192 && o.width % 4 == 0 &&
               o.height % 4 == 0,
           "sides are multiples of 4 from 16 to 8192");
    return o;
}

int main(int argc, char** argv)
{
    const Options o = readOptions(argc, argv);
    // Both sides allocate large blocks in every run. By default glibc maps and unmaps each until it has seen
    // some freed; the page faults nearly double OpenGL's time of the small triangles if that row runs first.
    mallopt(M_MMAP_THRESHOLD, 1 << 30);
    mallopt(M_TRIM_THRESHOLD, 1 << 30);
    Room room = {0};
    openRoom(&room, &o);
    Gl* gl = openGl(&room, o.threads);
    Figure* figures = calloc((size_t)ROW_COUNT, sizeof *figures);
    demand(figures != NULL, "out of memory");
    for (int i = 0; i < ROW_COUNT; i++) {
        if (o.only == NULL || strstr(ROWS[i].name, o.only) != NULL) {
            figures[i] = measureRow(&o, gl, &room, &ROWS[i]);
        }
    }
    printTable(&o, &room, gl, figures);
    free(figures);
    closeGl(gl);
    closeRoom(&room);
    return 0;
}
