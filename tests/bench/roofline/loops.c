// SPDX-License-Identifier: MIT
// The hot loops, the cost of each item counted from its source (count again when a kernel changes), and
// variants that show what limits loops far from their roof.
#include "work.h"

#define DOCUMENTED_COSTS                                                                                     \
    {                                                                                                        \
        .mul = 9, .add = 10, .other = 2, .divide = 1, .root = 1                                              \
    }
#define PHYSICAL_COSTS                                                                                       \
    {                                                                                                        \
        .mul = 15, .add = 12, .other = 5, .divide = 1                                                        \
    }
// Per light, not per pixel: bounds of two dot products.
#define CULL_COSTS                                                                                           \
    {                                                                                                        \
        .mul = 18, .add = 10, .other = 15, .read = 24, .written = 4                                          \
    }
// Blocks inside the triangle: depth is stepped in double, clamped, compared and selected; fragments are
// counted.
#define FILL_COSTS                                                                                           \
    {                                                                                                        \
        .other = 5, .doubles = 1, .toFloat = 1, .read = 16, .written = 8                                     \
    }
// Passes over stored blocks: the shader writes four planes, and each is added under a mask.
#define ADD_COSTS                                                                                            \
    {                                                                                                        \
        .add = 4, .other = 4, .read = 36, .written = 32                                                      \
    }
// w from three planes in double, the texel's direction, the distance along it; then compare, select, count.
#define TEXEL_COSTS                                                                                          \
    {                                                                                                        \
        .mul = 6, .add = 8, .other = 7, .doubles = 3, .toFloat = 3, .toInt = 2, .divide = 1, .root = 1,      \
        .read = 40, .written = 16                                                                            \
    }
// The sample's direction, the texel that it hits (mostly selects between axes), and one comparison there.
#define LOOK_UP_COSTS                                                                                        \
    {                                                                                                        \
        .mul = 11, .add = 9, .other = 35, .divide = 2, .toInt = 2, .gather = 1                               \
    }

const Loop LOOPS[] = {
    {"lights, documented", "pixel-lights", DOCUMENTED_COSTS, NULL, NULL, addLights, 0},
    {"lights, physical", "pixel-lights", PHYSICAL_COSTS, NULL, NULL, addLights, 1},
    {"physical, one light a call", "pixel-lights", PHYSICAL_COSTS, "lights, physical",
     "each call adds one light only: the block is read and written around it", addLightsOneByOne, 1},
    {"light culling", "lights", CULL_COSTS, NULL, NULL, cullLights, 0},
    {"depth fill", "fragments", FILL_COSTS, NULL, NULL, fill, FILL_NEARER},
    {"depth fill, hidden", "fragments", FILL_COSTS, "depth fill", "all but the first layer are hidden", fill,
     FILL_HIDDEN},
    {"additive fill, 4 planes", "fragments", ADD_COSTS, NULL, NULL, fill, FILL_ADD},
    {"additive fill, no plane", "fragments", ADD_COSTS, "additive fill, 4 planes", "planes are not blended",
     fill, FILL_ADD_CHEAP},
    {"additive fill, no shader", "fragments", ADD_COSTS, "additive fill, 4 planes",
     "the shader writes nothing", fill, FILL_ADD_IDLE},
    {"cube map, 1024^2", "texels", TEXEL_COSTS, NULL, NULL, drawTexels, MAP},
    {"cube map, 128^2", "texels", TEXEL_COSTS, "cube map, 1024^2", "texels stay in L2", drawTexels, 128},
    {"PCF, map 1024^2", "look-ups", LOOK_UP_COSTS, NULL, NULL, lookUp, 0},
    {"PCF, map 16^2", "look-ups", LOOK_UP_COSTS, "PCF, map 1024^2", "all texels lie in L1", lookUp, 1},
    {"PCF, 1 sample", "look-ups", LOOK_UP_COSTS, "PCF, map 1024^2",
     "there is one look-up for each bias and frame", lookUp, 2},
    {"ray, boxes in a row",
     "boxes",
     {.mul = 7, .add = 6, .other = 10, .read = 24},
     NULL,
     NULL,
     traceRays,
     RAY_CHAIN},
    {"ray, one node",
     "boxes",
     {.mul = 7, .add = 6, .other = 10, .read = 24},
     "ray, boxes in a row",
     "a ray meets one node: none waits for another, but each ray is prepared",
     traceRays,
     RAY_SINGLE},
    {"ray, triangles",
     "triangles",
     {.mul = 21, .add = 22, .other = 25, .divide = 1, .read = 40},
     NULL,
     NULL,
     traceRays,
     RAY_BLOCKS},
};

const int LOOP_COUNT = sizeof LOOPS / sizeof *LOOPS;
