// SPDX-License-Identifier: MIT
// Internal declarations of the OpenGL side.
#ifndef VPL_BENCH_PEERS_GL_H
#define VPL_BENCH_PEERS_GL_H

#include "peers.h"

#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>

typedef enum Program {
    PROGRAM_DEPTH, // writes only depth
    PROGRAM_ONE_LIGHT,
    PROGRAM_INSTANCE, // one light per instance
    PROGRAM_BATCH,    // + lighting
    PROGRAM_BATCH_DOCUMENTED,
    PROGRAM_BATCH_FEW,
    PROGRAM_GBUFFER,
    PROGRAM_FORWARD, // + lighting
    PROGRAM_FORWARD_DOCUMENTED,
    PROGRAM_DEFERRED, // + lighting
    PROGRAM_DEFERRED_DOCUMENTED,
    PROGRAM_DIRECT_FORWARD,
    PROGRAM_DIRECT_DEFERRED,
    PROGRAM_FRAME_FORWARD,
    PROGRAM_FRAME_DEFERRED,
    PROGRAM_CUBE_DEPTH,
    PROGRAM_CUBE_COLOUR,
    PROGRAM_INTERLEAVE,
    PROGRAM_GATHER,
    PROGRAM_LAYERS_DEPTH,
    PROGRAM_LAYERS_COLOUR,
    PROGRAM_GRID,
    PROGRAM_COUNT
} Program;

typedef struct ProgramText {
    const char* defines;
    const char *vertex, *fragment;
} ProgramText;

extern const ProgramText PROGRAM_TEXTS[PROGRAM_COUNT];

// Locations of uniforms and attributes, bindings of blocks and textures, as in the shaders.
enum {
    AT_TO_CLIP = 0,
    AT_LIGHT_POSITION = 1,
    AT_LIGHT_COLOUR = 2,
    AT_LIGHT_COUNT = 3,
    AT_ORIGIN = 4,
    AT_LAYER_COUNT = 5,
    BLOCK_LIGHTS = 0,
    BLOCK_FACETS,
    BLOCK_DIRECT,
    TEXTURE_GBUFFER = 0,
    TEXTURE_CUBE,
    TEXTURE_PARTS
};

// Size of a uniform block of 64 KB, the maximum of llvmpipe.
enum { LIGHT_VECTORS = 4096, FACETS = 1024 };

// Lights per batch: COUNT in the shaders. More lights run out of registers, fewer need more blending passes:
// 0.79, 0.98, 1.05 and 0.89 G/s with 6, 9, 12 and 18 documented lights, 0.71, 0.86 and 0.81 with 6, 9 and 12
// physical ones (512 in all). One pass holds at most eighteen lights, the limit of the varyings.
enum { BATCH_PHYSICAL = 9, BATCH_DOCUMENTED = 12, BATCH_FEW = 18, BATCH_INTERLEAVED = 16 };

// The first lights of a list, padded with black ones.
typedef struct LightSet {
    int key;
    GLuint buffer;
} LightSet;

enum { LIGHT_SETS = 20 };

struct Gl {
    const Room* room;
    void *display, *context;
    int width, height;
    GLuint programs[PROGRAM_COUNT];
    GLuint roomArray, lightsArray, gridArray, emptyArray;
    GLuint roomBuffer, instanceBuffer, gridVertices, gridIndices;
    GLuint split, facets, direct; // uniform buffers; split: documented lights by i mod 16
    LightSet lightSets[LIGHT_SETS];
    int lightSetCount;
    GLuint colour, gbuffer, parts, depth; // textures
    GLuint colourFrame, gbufferFrame, partsFrame, depthFrame;
    GLuint cubeDepth, cubeColour, cubeBuffer;
    GLuint cubeDepthFrames[6], cubeColourFrames[6];
    int vertexCount, gridCount;
    float toClip[16];        // the camera's
    float faceToClip[6][16]; // of the cube map's faces
    int64_t draws;
};

void makeGlPrograms(Gl* gl);
void makeGlRoom(Gl* gl);
void makeGlTargets(Gl* gl);

// Writes "#define TAPS ..." for the shaders.
void writeTaps(const Gl* gl, char* text, size_t size);

// Returns the uniform buffer of the first `count` lights.
GLuint findLights(Gl* gl, bool documented, int count);

// The OpenGL state that differs between ways; setState sets all of it.
typedef struct State {
    GLuint frame;
    GLenum compare; // depth test; 0: none
    bool depthWrite, add;
} State;

void setState(Gl* gl, State state);
void useProgram(Gl* gl, Program program);
void drawRoom(Gl* gl);
void drawScreen(Gl* gl);

// Clears depth to 1 if `depth`, and all channels of the colour to `colour`.
void clearTarget(float colour, bool depth);
void drawGbuffer(Gl* gl);

#endif
