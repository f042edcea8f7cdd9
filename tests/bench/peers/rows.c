// SPDX-License-Identifier: MIT
// The measured rows, and the goals of the issue ("Fast") for them: figures in brackets are the issue's own
// measurements of Mesa 25. Single stages have goals for one thread, whole frames for two.
#include "peers.h"

static const GlWay PASSES[] = {{"pass per light", glMultipass}, {"instances", glInstances}, {NULL, NULL}};
static const GlWay SINGLE[] = {
    {"deferred", glDeferred}, {"forward", glForward}, {"batches", glBatches}, {NULL, NULL}};
static const GlWay FRAME_PASSES[] = {
    {"pass per light", glFrameMultipass}, {"instances", glFrameInstances}, {NULL, NULL}};
static const GlWay FRAME_SINGLE[] = {
    {"deferred", glFrameDeferred}, {"forward", glFrameForward}, {"batches", glFrameBatches}, {NULL, NULL}};
static const GlWay CUBE[] = {{"depth", glCubeDepth}, {"colour", glCubeColour}, {NULL, NULL}};
static const GlWay DIRECT[] = {{"deferred", glDirectDeferred}, {"forward", glDirectForward}, {NULL, NULL}};
static const GlWay DEPTH_FILL[] = {{"LESS", glDepthFill}, {NULL, NULL}};
static const GlWay ADD_FILL[] = {{"EQUAL", glAddFill}, {NULL, NULL}};
static const GlWay TRIANGLES[] = {{"LESS", glTriangles}, {NULL, NULL}};
static const GlWay INTERLEAVED[] = {{"16 parts", glInterleaved}, {NULL, NULL}};

// Entries shared by all rows of one kind.
#define MULTIPASS                                                                                            \
    PASSES, vplLightsWay, VPL_ACCUMULATE_MULTIPASS, UNIT_LIGHTS, PRODUCT_PICTURE,                            \
    {                                                                                                        \
        ">= 1.2 G/s (0.20)", ""                                                                              \
    }
#define DOCUMENTED                                                                                           \
    SINGLE, vplLightsWay, VPL_ACCUMULATE_DEFERRED, UNIT_LIGHTS, PRODUCT_PICTURE,                             \
    {                                                                                                        \
        ">= 3.5 G/s (1.39)", ""                                                                              \
    }
#define PHYSICAL                                                                                             \
    SINGLE, vplLightsWay, VPL_ACCUMULATE_DEFERRED, UNIT_LIGHTS, PRODUCT_PICTURE,                             \
    {                                                                                                        \
        ">= 3.8 G/s (0.96)", ""                                                                              \
    }
#define FRAME_MULTIPASS   FRAME_PASSES, vplFrameWay, VPL_ACCUMULATE_MULTIPASS, UNIT_NONE, PRODUCT_PICTURE
#define FRAME_DEFERRED    FRAME_SINGLE, vplFrameWay, VPL_ACCUMULATE_DEFERRED, UNIT_NONE, PRODUCT_PICTURE
#define CUBE_STAGE        CUBE, vplCubeWay, VPL_ACCUMULATE_DEFERRED, UNIT_NONE, PRODUCT_CUBE
#define DIRECT_STAGE      DIRECT, vplDirectWay, VPL_ACCUMULATE_DEFERRED, UNIT_NONE, PRODUCT_PICTURE
#define DEPTH_STAGE       DEPTH_FILL, vplDepthFillWay, VPL_ACCUMULATE_DEFERRED, UNIT_DEPTH, PRODUCT_DEPTH
#define ADD_STAGE         ADD_FILL, vplAddFillWay, VPL_ACCUMULATE_DEFERRED, UNIT_ADD, PRODUCT_LAYERS
#define TRIANGLE_STAGE    TRIANGLES, vplTrianglesWay, VPL_ACCUMULATE_DEFERRED, UNIT_TRIANGLES, PRODUCT_DEPTH
#define INTERLEAVED_STAGE INTERLEAVED, vplLightsWay, VPL_ACCUMULATE_INTERLEAVED, UNIT_NONE, PRODUCT_PICTURE
#define SAME_LIGHTS       SINGLE, vplLightsWay, VPL_ACCUMULATE_DEFERRED, UNIT_LIGHTS, PRODUCT_PICTURE

#define BY_DOCUMENT VPL_LIGHTING_DOCUMENTED
#define BY_PHYSICS  VPL_LIGHTING_PHYSICAL

// Each row gives name, number of lights, lighting, and the rest.
const Row ROWS[] = {
    {"multipass, 18 lights", 18, BY_DOCUMENT, MULTIPASS},
    {"multipass, 198 lights", 198, BY_DOCUMENT, MULTIPASS},
    {"multipass, 512 lights", 512, BY_DOCUMENT, MULTIPASS},
    {"multipass, 1998 lights", 1998, BY_DOCUMENT, MULTIPASS},
    {"one pass, 18 lights", 18, BY_DOCUMENT, DOCUMENTED},
    {"one pass, 198 lights", 198, BY_DOCUMENT, DOCUMENTED},
    {"one pass, 512 lights", 512, BY_DOCUMENT, DOCUMENTED},
    {"one pass, 1998 lights", 1998, BY_DOCUMENT, DOCUMENTED},
    {"one pass, 18 lights, physical", 18, BY_PHYSICS, PHYSICAL},
    {"one pass, 198 lights, physical", 198, BY_PHYSICS, PHYSICAL},
    {"one pass, 512 lights, physical", 512, BY_PHYSICS, PHYSICAL},
    {"one pass, 1998 lights, physical", 1998, BY_PHYSICS, PHYSICAL},
    {"cube shadow map, 6 x 1024^2", 0, BY_DOCUMENT, CUBE_STAGE, {"<= 4.5 ms (14.3)", "(9.3 ms)"}},
    {"direct light, 16 PCF samples", 0, BY_DOCUMENT, DIRECT_STAGE, {"<= 20 ms (62)", "(36.5 ms)"}},
    {"depth fill, 64 layers", 0, BY_DOCUMENT, DEPTH_STAGE, {"2x (1108 M/s)", ""}},
    {"additive fill, 32 layers", 0, BY_DOCUMENT, ADD_STAGE, {"3x (320 M/s)", ""}},
    {"triangles of 2 pixels, depth", 0, BY_DOCUMENT, TRIANGLE_STAGE, {">= 22 M/s (7.5)", ""}},
    {"frame, 18 lights, multipass", 18, BY_DOCUMENT, FRAME_MULTIPASS, {"", "6x (111 ms)"}},
    {"frame, 198 lights, multipass", 198, BY_DOCUMENT, FRAME_MULTIPASS, {"", "6x (764 ms)"}},
    {"frame, 512 lights, multipass", 512, BY_DOCUMENT, FRAME_MULTIPASS, {"", "6x (1753 ms)"}},
    {"frame, 1998 lights, multipass", 1998, BY_DOCUMENT, FRAME_MULTIPASS, {"", "6x (6995 ms)"}},
    {"frame, 18 lights, one pass", 18, BY_DOCUMENT, FRAME_DEFERRED, {"", "3x (56 ms)"}},
    {"frame, 198 lights, one pass", 198, BY_DOCUMENT, FRAME_DEFERRED, {"", "3x (146 ms)"}},
    {"frame, 512 lights, one pass", 512, BY_DOCUMENT, FRAME_DEFERRED, {"", "3x (299 ms)"}},
    {"frame, 1998 lights, one pass", 1998, BY_DOCUMENT, FRAME_DEFERRED, {"", "3x (1021 ms)"}},
    {"interleaved 4x4, 512 lights", 512, BY_DOCUMENT, INTERLEAVED_STAGE, {"", "<= 40 ms (131)"}},
    {"one pass, 32 lights", 32, BY_DOCUMENT, SAME_LIGHTS, {"", "(86 ms)"}},
};

const int ROW_COUNT = sizeof ROWS / sizeof *ROWS;

double workOf(const Room* room, const Row* row)
{
    const double pixels = (double)room->view.width * room->view.height;
    switch (row->unit) {
    case UNIT_LIGHTS:
        return (double)room->covered * row->lights;
    case UNIT_DEPTH:
        return pixels * DEPTH_LAYERS;
    case UNIT_ADD:
        return pixels * ADD_LAYERS;
    case UNIT_TRIANGLES:
        return room->grid.triangleCount;
    case UNIT_NONE:
        break;
    }
    return 0;
}
