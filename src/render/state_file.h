// SPDX-License-Identifier: MIT
// The file of a saved render, all words little-endian: the 8 letters VPLSTATE, a header, the options as
// text, the sums that the picture is made from, and a checksum. Before the first pass of a plan that replaces another there
// are no sums. checkpoint.c writes it, checkpoint_load.c reads it, by the same functions.
#ifndef VPL_RENDER_STATE_FILE_H
#define VPL_RENDER_STATE_FILE_H

#include "render/renderer.h"
#include "render/state_stream.h"

enum { VPL_STATE_VERSION = 5, VPL_STATE_HEADER_BYTES = 160, VPL_STATE_CHECKSUM_BYTES = 8 };

// Arrays that a file may have; VPL_STATE_ONCE: none, the picture is drawn again. VPL_STATE_REPLANNED: the plan has other options than were
// asked for, so that it fits into the time; VPL_STATE_COARSE: its picture is coarse, and a better plan was to follow.
enum {
    VPL_STATE_PASSES = 1,
    VPL_STATE_PATHS = 2,
    VPL_STATE_DIRECT = 4,
    VPL_STATE_ONCE = 8,
    VPL_STATE_REPLANNED = 16,
    VPL_STATE_COARSE = 32,
    VPL_STATE_PLANS = VPL_STATE_REPLANNED | VPL_STATE_COARSE
};

// The first 8 letters.
#define VPL_STATE_MAGIC "VPLSTATE"
enum { VPL_STATE_MAGIC_BYTES = 8 };

typedef struct vplStateHeader {
    uint32_t version, textBytes; // of the options, a multiple of 4
    uint64_t scene;              // vplRenderer_HashScene
    uint32_t width, height, parts;
    uint32_t passes, samples; // done; samples of path tracing
    uint32_t truth;           // pixels that tell the error; 0: there are none
    uint64_t rays[2];         // of path tracing: of the picture and of its direct light
    double loss[2];           // of virtual lights by the clamp
    uint64_t unreviewed;      // vplRenderer.unreviewed
    double spread;            // spreadBefore of an unreviewed pass; negative: infinite
    double spent;             // rays of the plan under way
    double turn[2];           // rays and pathSquare of vplRenderer.turn
    uint64_t side;            // of vplRenderer.turn
    uint32_t edges[2];        // edgePixels and edgePaths of vplRenderer
    uint64_t tries;           // edgeTries of vplRenderer
    double coarser;           // coarserSquare of vplRenderer
    double lights;            // lightRays of vplRenderer
} vplStateHeader;

// Writes or reads the header, behind the letters.
void vplState_StreamHeader(vplStream* s, vplStateHeader* header);

// Bytes of the whole file.
size_t vplState_Size(const vplStateHeader* header);

// The arrays of a plan's renderer after its first pass. VPL_STATE_ONCE: there are none, the picture is drawn at once.
uint32_t vplState_PartsOf(const vplPlan* plan);

// How many path tracers these arrays are of: one for the picture, and one for its direct light.
static inline int vplState_CountTracers(uint32_t parts)
{
    return (parts & VPL_STATE_PATHS) != 0 ? 1 + ((parts & VPL_STATE_DIRECT) != 0) : 0;
}

// Writes or reads the arrays.
void vplState_StreamSums(vplStream* s, vplRenderer* r, uint32_t parts);

// Writes or reads what was found of the error so far, on which it depends when the render ends.
void vplState_StreamTruth(vplStream* s, vplRenderer* r);

// True if passes of this weight can have what was read of their sums: the picture is finite.
bool vplState_AreSumsValid(const vplRenderer* r, uint32_t parts, double weight);

// True if what was read of the truth lies in the picture and has plausible counts.
bool vplState_IsTruthValid(const vplRenderer* r);

#endif
