// SPDX-License-Identifier: MIT
// vpl bench: stages on a built-in room, and how their times grow.
#ifndef VPL_CLI_BENCH_H
#define VPL_CLI_BENCH_H

#include "cli/bench/measure.h"
#include "cli/cli.h"

#include <string.h>

// Inputs of the stages; there is one Bench for each thread count.
typedef struct Bench {
    vplContext* context;
    vplScene* scene;
    vplGeometry* geometry;
    vplLightSet* set;
    vplShadeLight* lights; // of all virtual lights
    vplImage* image;       // the target of shading stages, of the size asked for
    vplImage* quarter;     // the target of stages of rays: a quarter of the width and height
    // Made when a stage first needs them:
    vplCubeMap* map;
    vplShadow shadow;
    vplImage* picture; // lit directly and by 18 lights, for the stages of pictures
    vplScene* field;   // bumpy spheres
    vplGeometry* fieldGeometry;
} Bench;

// Counts and results of one run of a stage.
typedef struct Outcome {
    double work;      // in `unit`; the rate is work / time
    const char* unit; // NULL: no rate
    double pixelLights;
    vplRasterStats raster;
    int64_t rays;
    uint64_t hash;
    const vplImage* image; // hashed when the clock has stopped; NULL: the stage has computed the hash
} Outcome;

typedef struct Stage Stage;

struct Stage {
    const char* name;
    vplResult (*run)(Bench* b, const Stage* stage, Outcome* outcome);
    vplLighting lighting;
    vplAccumulation accumulation;
    int lights, batch;
    int flags;
};

enum {
    DIRECT = 1,  // light of the emitter, too
    RAYS = 2,    // virtual lights cast shadow rays; drawn into `quarter`
    SLOW = 4,    // runs only with --all or when asked for by name
    NORMALS = 8, // show normals instead of light
    SERIAL = 16  // always on one thread
};

extern const Stage STAGES[];
extern const int STAGE_COUNT;

// The measurements of one stage, for each thread count.
typedef struct Row {
    const Stage* stage;
    int runs;
    Times times[MAX_THREAD_COUNTS]; // medians
    Outcome outcomes[MAX_THREAD_COUNTS];
} Row;

// All stages that ran.
typedef struct Table {
    int width, height;
    double load; // average of the minute before it began
    int threads[MAX_THREAD_COUNTS], columns;
    Row* rows;
    int rowCount;
} Table;

// ---- room.c

// Makes the room, its lights and images. `threads` 0 is one per processor. Close it even after a failure.
// closeBench accepts a Bench of zeros.
vplResult openBench(const Arguments* a, int threads, int width, int height, Bench* b);
void closeBench(Bench* b);

// 16 spheres of about triangleCount triangles in all, with bumps, in front of the room's camera.
vplResult buildField(vplContext* context, int triangleCount, vplScene** sceneOut);

// Make these inputs unless they exist.
vplResult needShadow(Bench* b);
vplResult needPicture(Bench* b);
vplResult needField(Bench* b);

// ---- stages.c, raster.c, rays.c

vplResult runFill(Bench* b, const Stage* stage, Outcome* outcome);
vplResult runAdditiveFill(Bench* b, const Stage* stage, Outcome* outcome);
vplResult runSmallTriangles(Bench* b, const Stage* stage, Outcome* outcome);
vplResult runGeometry(Bench* b, const Stage* stage, Outcome* outcome);
vplResult runClosestHits(Bench* b, const Stage* stage, Outcome* outcome);
vplResult runPath(Bench* b, const Stage* stage, Outcome* outcome);
vplResult runShading(Bench* b, const Stage* stage, Outcome* outcome);

// Mixes bits into a hash.
static inline void addHash(uint64_t* hash, uint64_t bits)
{
    *hash = (*hash ^ bits) * 0x9E3779B97F4A7C15u;
}

static inline void addFloat(uint64_t* hash, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    addHash(hash, bits);
}

// Shades a geometry with the first of b->lights into `image`, as the stage asks.
vplResult shadeInto(Bench* b, const vplGeometry* geometry, const Stage* stage, vplImage* image,
                    Outcome* outcome);

// Casts one ray through each pixel's centre and hashes the triangles and distances of the closest hits.
void hitPixels(const vplGeometry* geometry, const vplCameraDef* camera, int width, int height,
               Outcome* outcome);

// ---- bench.c, print.c, scaling.c

// Returns true if --stage is absent or part of the name.
bool isAskedFor(const Arguments* a, const char* name);

void printTable(const Arguments* a, const Table* table);
int printTableJson(const Table* table);

int runScaling(const Arguments* a);

// ---- extremes.c

int runExtremes(const Arguments* a);

#endif
