// SPDX-License-Identifier: MIT
// vpl bench: stages on a built-in room, and how their times grow.
#ifndef VPL_CLI_BENCH_H
#define VPL_CLI_BENCH_H

#include "cli/bench/measure.h"
#include "cli/cli.h"

#include <string.h>

// What the stages work on, one for each thread count.
typedef struct Bench {
    vplContext* context;
    vplScene* scene;
    vplGeometry* geometry;
    vplLightSet* set;
    vplShadeLight* lights; // of all virtual lights
    vplImage* image;       // what shading stages draw into, of the size asked for
    vplImage* quarter;     // the same for stages of rays: a quarter of the width and height
    // Made when a stage first asks for them:
    vplCubeMap* map;
    vplShadow shadow;
    vplImage* picture; // lit directly and by 18 lights, for the stages of pictures
    vplScene* field;   // bumpy spheres
    vplGeometry* fieldGeometry;
} Bench;

// What one run of a stage did.
typedef struct Outcome {
    double work;      // what the rate is of, in `unit`
    const char* unit; // NULL: no rate
    double pixelLights;
    int64_t drawCalls, fragments, triangles, rays;
    uint64_t hash;
    const vplImage* image; // hashed when the clock has stopped; NULL: `hash` is all
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
    STAGE_DIRECT = 1,  // light of the emitter, too
    STAGE_RAYS = 2,    // virtual lights cast shadow rays; drawn into `quarter`
    STAGE_SLOW = 4,    // runs only with --all or when asked for by name
    STAGE_NORMALS = 8, // show normals instead of light
    STAGE_SERIAL = 16  // one thread by what the stage is: no speed-up is expected
};

extern const Stage STAGES[];
extern const int STAGE_COUNT;

// A stage that ran, and what came of it for each thread count.
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

// Makes the room, its lights and images. `threads` 0 is one per processor. A Bench of zeros may be closed.
vplResult openBench(const Arguments* a, int threads, int width, int height, Bench* b);
void closeBench(Bench* b);

// 16 spheres of about triangleCount triangles in all, with bumps, in front of the room's camera.
vplResult buildField(vplContext* context, int triangleCount, vplScene** sceneOut);

// Make what is missing.
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

// Draws b->geometry's virtual lights as the stage says, into `image`.
vplResult shadeInto(Bench* b, const vplGeometry* geometry, const Stage* stage, vplImage* image,
                    Outcome* outcome);

// The closest hits of one ray per pixel of a camera's view.
void hitPixels(const vplGeometry* geometry, const vplCameraDef* camera, int width, int height,
               Outcome* outcome);

// ---- bench.c, print.c, scaling.c

// Whether --stage asks for a thing of this name.
bool isAskedFor(const Arguments* a, const char* name);

void printTable(const Arguments* a, const Table* table);
int printTableJson(const Table* table);

int runScaling(const Arguments* a);

#endif
