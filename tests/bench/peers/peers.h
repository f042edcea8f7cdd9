// SPDX-License-Identifier: MIT
// The benchmark room drawn by OpenGL and by libvpl: declarations that both sides share.
#ifndef VPL_BENCH_PEERS_H
#define VPL_BENCH_PEERS_H

#include <vpl/stages.h>

enum {
    MOST_LIGHTS = 1998,
    PARTICLES = 10, // N of documented direct light
    PCF_SAMPLES = 16,
    CUBE_SIZE = 1024,
    DEPTH_LAYERS = 64,
    ADD_LAYERS = 32,
    GRID_STEP = 2, // pixels along a leg of the small triangles: each covers two
    INTERLEAVE = 4,
    INTERLEAVED_LIGHTS = 512,
    GL_WAYS = 3
};

#define MIN_DISTANCE 0.2f // metres, of physical lighting
#define LAYER_COLOUR 0.25f

typedef struct Options {
    const char* scene;
    const char* only; // runs only rows whose names contain this; NULL: all
    int width, height, threads, runs;
    bool markdown;
} Options;

// The scene data that both sides draw, and libvpl's results.
typedef struct Room {
    vplContext* context;
    vplScene* scene;
    vplGeometry* geometry;
    vplView view;
    const vplEmitterDef* emitter;
    vplShadeLight *documented, *physical; // MOST_LIGHTS of each
    vplMesh grid;                         // small triangles that cover the picture
    vplVec3* gridPositions;               // clip space, w = 1
    // libvpl's results
    vplImage* image;
    vplCubeMap* map;
    vplShadow shadow;
    float* depth;    // of the fill rows: one per pixel
    float* colour;   // of the fill rows: ADD_PLANES planes, one after another
    int64_t draws;   // draw calls of the last way
    int64_t covered; // pixels that show the room
} Room;

enum { ADD_PLANES = 4 };

typedef struct Gl Gl;
typedef struct Row Row;
typedef void GlWayFcn(Gl* gl, const Row* row);
typedef void VplWayFcn(Room* room, const Row* row);

// The result of a row that main.c compares.
typedef enum Product { PRODUCT_PICTURE, PRODUCT_DEPTH, PRODUCT_LAYERS, PRODUCT_CUBE } Product;

// The unit of work that a row's rate counts.
typedef enum Unit { UNIT_NONE, UNIT_LIGHTS, UNIT_DEPTH, UNIT_ADD, UNIT_TRIANGLES } Unit;

typedef struct GlWay {
    const char* name;
    GlWayFcn* draw; // NULL: the end of a list
} GlWay;

struct Row {
    const char* name;
    int lights;
    vplLighting lighting;
    const GlWay* gl; // at most GL_WAYS and a terminator without name; the fastest counts
    VplWayFcn* vpl;  // NULL: libvpl has no such way
    vplAccumulation accumulation;
    Unit unit;
    Product product;
    const char* goal[2]; // goals of the issue for one and for two threads, with its figure for Mesa 25
};

// The medians of one row.
typedef struct Figure {
    double glMs[GL_WAYS], vplMs, error;
    int best, runs;
    int64_t glDraws, vplDraws;
} Figure;

extern const Row ROWS[];
extern const int ROW_COUNT;

// Returns the units of work in one run of a row.
double workOf(const Room* room, const Row* row);

void printTable(const Options* o, const Room* room, const Gl* gl, const Figure* figures);

// Ends the program with a message unless `ok`.
void demand(bool ok, const char* message);

// ---- libvpl

void openRoom(Room* room, const Options* o);
void closeRoom(Room* room);

VplWayFcn vplLightsWay, vplDirectWay, vplCubeWay, vplFrameWay, vplDepthFillWay, vplAddFillWay,
    vplTrianglesWay;

// ---- OpenGL

Gl* openGl(const Room* room, int threads);
void closeGl(Gl* gl);
void finishGl(void);
int64_t drawsOfGl(const Gl* gl);
void resetDrawsOfGl(Gl* gl);
const char* rendererOfGl(const Gl* gl);
const char* versionOfGl(const Gl* gl);

// Reads a product's floats back, rows top-down.
void readGl(Gl* gl, Product product, float* out);

GlWayFcn glMultipass, glInstances, glForward, glDeferred, glCubeDepth, glCubeColour, glDirectForward,
    glDirectDeferred, glBatches, glFrameBatches, glFrameMultipass, glFrameInstances, glFrameForward,
    glFrameDeferred, glInterleaved, glDepthFill, glAddFill, glTriangles;

#endif
