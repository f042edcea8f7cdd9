// SPDX-License-Identifier: MIT
// Compares the path tracer with another renderer: `bench/corridor SCENE REFERENCE [SAMPLES]`. The reference
// is a text file of means over square blocks of a picture, row by row from the top, rendered with at most
// four bounces before the eye's vertex. Our path tracer renders each block as one pixel, which has the same
// mean. The program prints ratios ours / theirs over larger and larger blocks, with the deviation that our
// own error estimate explains.
// The scene is that of Laurent Noel and Venceslas Biri, Skeleton based Vertex Connection Resampling for
// Bidirectional Path Tracing, Pacific Graphics 2015; it is not part of libvpl.
#include "cli/bench/measure.h"
#include "reference/path_trace.h"

#include <vpl/stages.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { SIZE = 64, BOUNCES = 4 };

static bool readReference(const char* path, double* values)
{
    char line[16384];
    int count = 0;
    FILE* file = fopen(path, "r");
    while (file != NULL && fgets(line, sizeof line, file) != NULL) {
        char* at = line;
        for (char* end; line[0] != '#' && count < SIZE * SIZE; at = end, count++) {
            values[count] = strtod(at, &end);
            if (end == at) {
                break;
            }
        }
    }
    if (file != NULL) {
        fclose(file);
    }
    return count == SIZE * SIZE;
}

static double blockMean(const double* values, int x, int y, int side)
{
    double sum = 0;
    for (int j = 0; j < side; j++) {
        for (int i = 0; i < side; i++) {
            sum += values[(y + j) * SIZE + x + i];
        }
    }
    return sum / side / side;
}

static void compareBlocks(const double* ours, const double* theirs, int side, double error, double mean)
{
    double squares = 0, low = INFINITY, high = 0;
    int near = 0, count = 0;
    for (int y = 0; y < SIZE; y += side) {
        for (int x = 0; x < SIZE; x += side) {
            double ratio = blockMean(ours, x, y, side) / blockMean(theirs, x, y, side);
            squares += (ratio - 1) * (ratio - 1);
            low = fmin(low, ratio);
            high = fmax(high, ratio);
            near += fabs(ratio - 1) <= 0.05;
            count++;
        }
    }
    printf("%5d %8.3f %8.3f %9.2f%% %11.2f%% %11.1f%%\n", side, low, high, 100 * sqrt(squares / count),
           100 * error / mean / side, 100.0 * near / count);
}

static void printMessage(void* user, vplLogLevel level, const char* message)
{
    (void)user;
    (void)level;
    fprintf(stderr, "%s\n", message);
}

static void compare(const vplImage* image, const vplPathStats* stats, double ms, const double* theirs)
{
    static double ours[SIZE * SIZE];
    for (int i = 0; i < SIZE * SIZE; i++) {
        ours[i] = (double)image->pixels[3 * i];
    }
    double mean = blockMean(ours, 0, 0, SIZE), wanted = blockMean(theirs, 0, 0, SIZE);
    printf("mean %.6g, reference %.6g, ratio %.4f; %.1f s of processor time, %.2f Mrays/s, hash %016llx\n",
           mean, wanted, mean / wanted, ms / 1000, (double)stats->rays / ms / 1000,
           (unsigned long long)vplImage_Hash(image));
    printf("%5s %8s %8s %10s %12s %12s\n", "block", "least", "most", "deviation", "our error", "within 5 %");
    for (int side = 1; side <= 16; side *= 2) {
        compareBlocks(ours, theirs, side, stats->errorEstimate, mean);
    }
}

static vplResult trace(const vplScene* scene, const vplGeometry* geometry, int samples, const double* theirs)
{
    vplPathDef def = vplDefaultPathDef();
    def.camera = vplScene_GetCamera(scene, 0);
    def.width = def.height = SIZE;
    def.lastBounce = BOUNCES;
    def.rouletteFrom = 1e-30; // no roulette: lastBounce already limits paths
    vplPathTracer* tracer = NULL;
    vplImage* image = NULL;
    vplPathStats stats;
    double start = cpuMs();
    vplResult result = vplPathTracer_Create(geometry, &def, &tracer);
    if (result == VPL_SUCCESS) {
        result = vplPathTracer_Pass(tracer, samples, NULL, NULL, 0, 1);
    }
    if (result == VPL_SUCCESS) {
        result = vplImage_Create(geometry->context, SIZE, SIZE, &image);
    }
    if (result == VPL_SUCCESS) {
        vplPathTracer_Resolve(tracer, image, &stats);
        compare(image, &stats, cpuMs() - start, theirs);
    }
    vplImage_Destroy(image);
    vplPathTracer_Destroy(tracer);
    return result;
}

int main(int count, char** words)
{
    static double theirs[SIZE * SIZE];
    vplContextDef def = vplDefaultContextDef();
    def.log = printMessage;
    vplContext* context = NULL;
    vplScene* scene = NULL;
    vplGeometry* geometry = NULL;
    if (count < 3 || !readReference(words[2], theirs)) {
        fprintf(stderr, "usage: corridor SCENE REFERENCE [SAMPLES]; the reference has 64 x 64 numbers\n");
        return 2;
    }
    bool good = vplContext_Create(&def, &context) == VPL_SUCCESS &&
                vplScene_Load(context, words[1], &scene) == VPL_SUCCESS &&
                vplGeometry_Create(scene, &geometry) == VPL_SUCCESS &&
                trace(scene, geometry, count > 3 ? atoi(words[3]) : 4096, theirs) == VPL_SUCCESS;
    vplGeometry_Destroy(geometry);
    vplScene_Destroy(scene);
    vplContext_Destroy(context);
    return good ? 0 : 1;
}
