// SPDX-License-Identifier: MIT
// The shaders evaluate the documented and the physical formulas of <vpl/shading.h> and the shadow test of
// src/visibility/shadow_kernel.c, in the usual GPU style.
#include "gl.h"

static const char ROOM_VERTEX[] = "layout(location = 0) in vec3 position;\n"
                                  "layout(location = 1) in vec3 normal;\n"
                                  "layout(location = 2) in vec3 colour;\n" // rho / pi
                                  "layout(location = 3) in float facet;\n"
                                  "layout(location = 0) uniform mat4 toClip;\n"
                                  "invariant gl_Position;\n" // depth EQUAL between programs
                                  "out vec3 p;\n"
                                  "flat out vec3 n;\n"
                                  "flat out vec3 c;\n"
                                  "flat out float id;\n"
                                  "#ifdef INSTANCES\n"
                                  "layout(location = 4) in vec3 lightOfInstance;\n"
                                  "layout(location = 5) in vec3 colourOfInstance;\n"
                                  "flat out vec3 lightPosition;\n"
                                  "flat out vec3 lightColour;\n"
                                  "#endif\n"
                                  "void main() {\n"
                                  "    gl_Position = toClip * vec4(position, 1.0);\n"
                                  "    p = position;\n"
                                  "    n = normal;\n"
                                  "    c = colour;\n"
                                  "    id = facet;\n"
                                  "#ifdef INSTANCES\n"
                                  "    lightPosition = lightOfInstance;\n"
                                  "    lightColour = colourOfInstance * colour;\n"
                                  "#endif\n"
                                  "}\n";

// Draws one triangle at depth 1: the depth test GREATER rejects pixels that show no surface.
static const char SCREEN_VERTEX[] =
    "void main() {\n"
    "    gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 1.0, 1.0);\n"
    "}\n";

static const char LAYERS_VERTEX[] =
    "layout(location = 5) uniform int layerCount;\n"
    "void main() {\n"
    "    int corner = gl_VertexID % 3;\n"
    "    float z = layerCount == 0 ? 0.5 : 1.0 - float(gl_VertexID / 3 + 1) / float(layerCount + 1);\n"
    "    gl_Position = vec4(corner == 1 ? 3.0 : -1.0, corner == 2 ? 3.0 : -1.0, z, 1.0);\n"
    "}\n";

static const char GRID_VERTEX[] =
    "layout(location = 0) in vec3 position;\n"
    "void main() { gl_Position = vec4(position.x, -position.y, position.z, 1.0); }\n";

static const char EMPTY_FRAGMENT[] = "void main() {}\n";

static const char ONE_LIGHT_FRAGMENT[] =
    "in vec3 p;\n"
    "flat in vec3 n;\n"
    "#ifdef INSTANCES\n"
    "flat in vec3 lightPosition;\n"
    "flat in vec3 lightColour;\n"
    "#define COLOUR lightColour\n"
    "#else\n"
    "flat in vec3 c;\n"
    "layout(location = 1) uniform vec3 lightPosition;\n"
    "layout(location = 2) uniform vec3 lightColour;\n"
    "#define COLOUR (c * lightColour)\n"
    "#endif\n"
    "layout(location = 0) out vec4 result;\n"
    "void main() {\n"
    "    vec3 l = lightPosition - p;\n"
    "    result = vec4(COLOUR * (max(dot(n, l), 0.0) * inversesqrt(dot(l, l))), 0.0);\n"
    "}\n";

// Passes several lights at once as flat varyings: Mesa 22.3 loads uniforms lane by lane, but varyings by
// broadcast.
#define VECTORS_OUT                                                                                          \
    "layout(std140, binding = 0) uniform Lights { vec4 lights[4096]; };\n"                                   \
    "flat out vec3 vectors[COUNT * VECTORS];\n"                                                              \
    "void writeVectors() {\n"                                                                                \
    "    for (int i = 0; i < COUNT * VECTORS; i++) {\n"                                                      \
    "        vectors[i] = lights[gl_InstanceID * (COUNT * VECTORS) + i].xyz;\n"                              \
    "    }\n"                                                                                                \
    "}\n"

#define VECTORS_IN                                                                                           \
    "flat in vec3 vectors[COUNT * VECTORS];\n"                                                               \
    "vec3 addVectors() {\n"                                                                                  \
    "    vec3 sum = vec3(0.0);\n"                                                                            \
    "    for (int i = 0; i < COUNT; i++) {\n"                                                                \
    "        vec3 l = vectors[VECTORS * i] - p;\n"                                                           \
    "        float d2 = dot(l, l), here = max(dot(n, l), 0.0);\n"                                            \
    "#if VECTORS == 3\n"                                                                                     \
    "        float there = max(-dot(vectors[3 * i + 1], l), 0.0);\n"                                         \
    "        sum += vectors[3 * i + 2] * (here * there / (d2 * max(d2, BOUND)));\n"                          \
    "#else\n"                                                                                                \
    "        sum += vectors[2 * i + 1] * (here * inversesqrt(d2));\n"                                        \
    "#endif\n"                                                                                               \
    "    }\n"                                                                                                \
    "    return sum;\n"                                                                                      \
    "}\n"

static const char BATCH_VERTEX[] = "layout(location = 0) in vec3 position;\n"
                                   "layout(location = 1) in vec3 normal;\n"
                                   "layout(location = 2) in vec3 colour;\n"
                                   "layout(location = 0) uniform mat4 toClip;\n"
                                   "invariant gl_Position;\n"
                                   "out vec3 p;\n"
                                   "flat out vec3 n;\n"
                                   "flat out vec3 c;\n" VECTORS_OUT "void main() {\n"
                                   "    gl_Position = toClip * vec4(position, 1.0);\n"
                                   "    p = position;\n"
                                   "    n = normal;\n"
                                   "    c = colour;\n"
                                   "    writeVectors();\n"
                                   "}\n";

static const char GBUFFER_FRAGMENT[] = "in vec3 p;\n"
                                       "flat in float id;\n"
                                       "layout(location = 0) out vec4 result;\n"
                                       "void main() { result = vec4(p, id); }\n";

// Reads the surface of a fragment from the rasterizer or from the G-buffer.
#define SURFACE                                                                                              \
    "#ifdef FORWARD\n"                                                                                       \
    "in vec3 p;\n"                                                                                           \
    "flat in vec3 n;\n"                                                                                      \
    "flat in vec3 c;\n"                                                                                      \
    "#define READ_SURFACE(texel)\n"                                                                          \
    "#else\n"                                                                                                \
    "layout(binding = 0) uniform sampler2D gbuffer;\n"                                                       \
    "layout(std140, binding = 1) uniform Facets { vec4 facets[2048]; };\n"                                   \
    "vec3 p, n, c;\n"                                                                                        \
    "void READ_SURFACE(ivec2 texel) {\n"                                                                     \
    "    vec4 g = texelFetch(gbuffer, texel, 0);\n"                                                          \
    "    int f = 2 * int(g.w);\n"                                                                            \
    "    p = g.xyz;\n"                                                                                       \
    "    n = facets[f].xyz;\n"                                                                               \
    "    c = facets[f + 1].xyz;\n"                                                                           \
    "}\n"                                                                                                    \
    "#endif\n"

#define LIGHTS                                                                                               \
    "layout(std140, binding = 0) uniform Lights { vec4 lights[4096]; };\n"                                   \
    "layout(location = 3) uniform int lightCount;\n"                                                         \
    "vec3 addLights() {\n"                                                                                   \
    "    vec3 sum = vec3(0.0);\n"                                                                            \
    "#ifdef PHYSICAL\n"                                                                                      \
    "    for (int i = 0; i < 3 * lightCount; i += 3) {\n"                                                    \
    "        vec3 l = lights[i].xyz - p;\n"                                                                  \
    "        float d2 = dot(l, l);\n"                                                                        \
    "        float cosines = max(dot(n, l), 0.0) * max(-dot(lights[i + 1].xyz, l), 0.0);\n"                  \
    "        sum += lights[i + 2].xyz * (cosines / (d2 * max(d2, lights[i].w)));\n"                          \
    "    }\n"                                                                                                \
    "#else\n"                                                                                                \
    "    for (int i = 0; i < 2 * lightCount; i += 2) {\n"                                                    \
    "        vec3 l = lights[i].xyz - p;\n"                                                                  \
    "        sum += lights[i + 1].xyz * (max(dot(n, l), 0.0) * inversesqrt(dot(l, l)));\n"                   \
    "    }\n"                                                                                                \
    "#endif\n"                                                                                               \
    "    return sum;\n"                                                                                      \
    "}\n"

// TAPS has one TAP per sample, with its position on the disc in metres as constants, which are faster than
// uniforms.
#define DIRECT                                                                                                     \
    "layout(binding = 1) uniform samplerCube cube;\n"                                                              \
    "layout(std140, binding = 2) uniform Direct { vec4 place, intensity, bias; };\n" /* far; 1 / N; b_s, b_dmax */ \
    "#define TAP(a, b) shadowed += limit > texture(cube, way + (a) * u + (b) * v).x ? 1.0 : 0.0;\n"                \
    "float shadowFactor(vec3 way, vec3 l, float r, float cosine) {\n"                                              \
    "    float limit = (r - (bias.x + bias.y * (1.0 - min(cosine, 1.0)))) / place.w;\n"                            \
    "    float s = l.y > -0.9 ? 1.0 : -1.0;\n"                                                                     \
    "    float a = -1.0 / (s + l.y), b = l.x * l.z * a;\n"                                                         \
    "    vec3 u = vec3(b, -l.z, s + l.z * l.z * a);\n"                                                             \
    "    vec3 v = vec3(1.0 + s * l.x * l.x * a, -s * l.x, s * b);\n"                                               \
    "    float shadowed = 0.0;\n"                                                                                  \
    "    TAPS\n"                                                                                                   \
    "    return shadowed / 16.0;\n"                                                                                \
    "}\n"                                                                                                          \
    "vec3 addDirect() {\n"                                                                                         \
    "    vec3 way = p - place.xyz;\n"                                                                              \
    "    float r = length(way);\n"                                                                                 \
    "    vec3 l = way / -r;\n"                                                                                     \
    "    float cosine = max(dot(n, l), 0.0);\n"                                                                    \
    "    return intensity.xyz * (cosine * (1.0 - shadowFactor(way, l, r, cosine)));\n"                             \
    "}\n"

#define RESULT "layout(location = 0) out vec4 result;\n"

static const char LIGHTS_FRAGMENT[] = SURFACE LIGHTS RESULT "void main() {\n"
                                                            "    READ_SURFACE(ivec2(gl_FragCoord.xy));\n"
                                                            "    result = vec4(c * addLights(), 0.0);\n"
                                                            "}\n";

static const char BATCH_FRAGMENT[] =
    SURFACE VECTORS_IN RESULT "void main() { result = vec4(c * addVectors(), 0.0); }\n";

static const char DIRECT_FRAGMENT[] = SURFACE DIRECT RESULT "void main() {\n"
                                                            "    READ_SURFACE(ivec2(gl_FragCoord.xy));\n"
                                                            "    result = vec4(c * addDirect(), 0.0);\n"
                                                            "}\n";

static const char FRAME_FRAGMENT[] =
    SURFACE LIGHTS DIRECT RESULT "void main() {\n"
                                 "    READ_SURFACE(ivec2(gl_FragCoord.xy));\n"
                                 "    result = vec4(c * (addDirect() + addLights()), 0.0);\n"
                                 "}\n";

static const char CUBE_FRAGMENT[] = "in vec3 p;\n"
                                    "layout(std140, binding = 2) uniform Direct { vec4 place; };\n"
                                    "#ifndef DEPTH\n"
                                    "layout(location = 0) out float result;\n"
                                    "#define gl_FragDepth result\n"
                                    "#endif\n"
                                    "void main() { gl_FragDepth = length(p - place.xyz) / place.w; }\n";

// Draws one of 16 pictures side by side; each holds every fourth pixel across and down.
static const char INTERLEAVE_VERTEX[] = VECTORS_OUT
    "void main() {\n"
    "    gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 1.0, 1.0);\n"
    "    writeVectors();\n"
    "}\n";

static const char INTERLEAVE_FRAGMENT[] = SURFACE VECTORS_IN RESULT
    "layout(location = 4) uniform ivec4 origin;\n" // of the part, and its pixel in a block
    "void main() {\n"
    "    READ_SURFACE(4 * (ivec2(gl_FragCoord.xy) - origin.xy) + origin.zw);\n"
    "    result = vec4(addVectors(), 0.0);\n"
    "}\n";

static const char GATHER_FRAGMENT[] =
    SURFACE RESULT "layout(binding = 2) uniform sampler2D parts;\n"
                   "layout(location = 4) uniform ivec4 size;\n" // of a part
                   "void main() {\n"
                   "    ivec2 at = ivec2(gl_FragCoord.xy);\n"
                   "    READ_SURFACE(at);\n"
                   "    vec3 sum = vec3(0.0);\n"
                   "    for (int y = -1; y < 3; y++) {\n"
                   "        for (int x = -1; x < 3; x++) {\n"
                   "            ivec2 q = clamp(at + ivec2(x, y), ivec2(0), 4 * size.xy - 1);\n"
                   "            sum += texelFetch(parts, (q & 3) * size.xy + (q >> 2), 0).xyz;\n"
                   "        }\n"
                   "    }\n"
                   "    result = vec4(c * sum, 0.0);\n"
                   "}\n";

static const char CONSTANT_FRAGMENT[] = RESULT "void main() { result = vec4(0.25); }\n";

const ProgramText PROGRAM_TEXTS[PROGRAM_COUNT] = {
    [PROGRAM_DEPTH] = {"", ROOM_VERTEX, EMPTY_FRAGMENT},
    [PROGRAM_ONE_LIGHT] = {"", ROOM_VERTEX, ONE_LIGHT_FRAGMENT},
    [PROGRAM_INSTANCE] = {"#define INSTANCES\n", ROOM_VERTEX, ONE_LIGHT_FRAGMENT},
    [PROGRAM_BATCH] = {"#define FORWARD\n#define COUNT 9\n#define VECTORS 3\n#define BOUND (0.2 * 0.2)\n",
                       BATCH_VERTEX, BATCH_FRAGMENT},
    [PROGRAM_BATCH_DOCUMENTED] = {"#define FORWARD\n#define COUNT 12\n#define VECTORS 2\n", BATCH_VERTEX,
                                  BATCH_FRAGMENT},
    [PROGRAM_BATCH_FEW] = {"#define FORWARD\n#define COUNT 18\n#define VECTORS 2\n", BATCH_VERTEX,
                           BATCH_FRAGMENT},
    [PROGRAM_GBUFFER] = {"", ROOM_VERTEX, GBUFFER_FRAGMENT},
    [PROGRAM_FORWARD] = {"#define FORWARD\n#define PHYSICAL\n", ROOM_VERTEX, LIGHTS_FRAGMENT},
    [PROGRAM_FORWARD_DOCUMENTED] = {"#define FORWARD\n", ROOM_VERTEX, LIGHTS_FRAGMENT},
    [PROGRAM_DEFERRED] = {"#define PHYSICAL\n", SCREEN_VERTEX, LIGHTS_FRAGMENT},
    [PROGRAM_DEFERRED_DOCUMENTED] = {"", SCREEN_VERTEX, LIGHTS_FRAGMENT},
    [PROGRAM_DIRECT_FORWARD] = {"#define FORWARD\n", ROOM_VERTEX, DIRECT_FRAGMENT},
    [PROGRAM_DIRECT_DEFERRED] = {"", SCREEN_VERTEX, DIRECT_FRAGMENT},
    [PROGRAM_FRAME_FORWARD] = {"#define FORWARD\n", ROOM_VERTEX, FRAME_FRAGMENT},
    [PROGRAM_FRAME_DEFERRED] = {"", SCREEN_VERTEX, FRAME_FRAGMENT},
    [PROGRAM_CUBE_DEPTH] = {"#define DEPTH\n", ROOM_VERTEX, CUBE_FRAGMENT},
    [PROGRAM_CUBE_COLOUR] = {"", ROOM_VERTEX, CUBE_FRAGMENT},
    [PROGRAM_INTERLEAVE] = {"#define COUNT 16\n#define VECTORS 2\n", INTERLEAVE_VERTEX, INTERLEAVE_FRAGMENT},
    [PROGRAM_GATHER] = {"", SCREEN_VERTEX, GATHER_FRAGMENT},
    [PROGRAM_LAYERS_DEPTH] = {"", LAYERS_VERTEX, EMPTY_FRAGMENT},
    [PROGRAM_LAYERS_COLOUR] = {"", LAYERS_VERTEX, CONSTANT_FRAGMENT},
    [PROGRAM_GRID] = {"", GRID_VERTEX, EMPTY_FRAGMENT},
};
