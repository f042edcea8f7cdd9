// SPDX-License-Identifier: MIT
// The hot loops, each alone on one thread, what each item costs by its source, and variants that tell what
// bounds those far from the roof.
#include "roofline.h"

#include "geometry/bvh.h"
#include "shading/shading.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LIGHTS = 512, SIDE = 512, LAYERS = 8, MAP = 1024, SMALL_MAP = 16, NODES = 32, BLOCKS = 64, RAYS = 64 };

struct Work {
    vplContext* context;
    vplScene* scene;
    vplGeometry* geometry;
    vplShadeLight lights[LIGHTS];
    vplSurface surface[4]; // 4 blocks of the room's floor
    vplCubeMap *map, *smallMap;
    vplShadow shadow, smallShadow, hardShadow;
    vplRaster* rasters[8];
    float depths[LAYERS];
    float* planes; // of the framebuffer
    vplBvh chain, single, blocks;
    vplRay rays[RAYS];
};

static void check(vplResult result)
{
    if (result != VPL_SUCCESS) {
        exit(1);
    }
}

// ---- light kernels: `which` is the lighting

static double addLights(void* work, int which)
{
    Work* w = work;
    float irradiance[3][VPL_LANES] = {{0}};
    for (int i = 0; i < 16; i++) {
        vplAccumulateLights(w->context, which ? VPL_LIGHTING_PHYSICAL : VPL_LIGHTING_DOCUMENTED, 0.2f,
                            &w->surface[i % 4], w->lights, LIGHTS, irradiance);
    }
    w->planes[0] = irradiance[0][0];
    return 16.0 * LIGHTS * VPL_LANES;
}

// One light per call, as with shadows: shows what reading and writing the block around each light costs.
static double addLightsOneByOne(void* work, int which)
{
    Work* w = work;
    float irradiance[3][VPL_LANES] = {{0}};
    for (int i = 0; i < LIGHTS; i++) {
        vplAccumulateLights(w->context, which ? VPL_LIGHTING_PHYSICAL : VPL_LIGHTING_DOCUMENTED, 0.2f,
                            &w->surface[i % 4], &w->lights[i], 1, irradiance);
    }
    w->planes[0] = irradiance[0][0];
    return (double)LIGHTS * VPL_LANES;
}

static void makeLights(Work* w)
{
    for (int i = 0; i < LIGHTS; i++) {
        float t = (float)i / LIGHTS;
        w->lights[i] = (vplShadeLight){2 * t - 1, 4.9f, 1 - 2 * t * t, 0, -1, 0, 0.1f, 0.2f, 0.3f};
    }
    for (int b = 0; b < 4; b++) {
        for (int l = 0; l < VPL_LANES; l++) {
            w->surface[b].px[l] = -1.8f + 0.9f * (float)b + 0.01f * (float)(l % 4);
            w->surface[b].py[l] = 0;
            w->surface[b].pz[l] = 1.9f + 0.01f * (float)(l / 4);
            w->surface[b].nx[l] = w->surface[b].nz[l] = 0;
            w->surface[b].ny[l] = 1;
        }
    }
}

// ---- fill: triangles over all of the picture

static void coverVertices(const void* uniforms, int first, int count, const vplVertices* out)
{
    const float* depth = uniforms;
    for (int i = 0; i < count; i++) {
        out->x[i] = first + i == 1 ? 3 : -1;
        out->y[i] = first + i == 2 ? 3 : -1;
        out->z[i] = *depth;
        out->w[i] = 1;
    }
}

static void constantFragments(const void* uniforms, vplFragments* f)
{
    (void)uniforms;
    for (int p = 0; p < 4; p++) {
        for (int l = 0; l < VPL_LANES; l++) {
            f->plane[p][l] = (float)(p + 1);
        }
    }
}

// What the planes then hold is what the block held before.
static void noFragments(const void* uniforms, vplFragments* f)
{
    (void)uniforms;
    (void)f;
}

enum { FILL_NEARER = 0, FILL_HIDDEN, FILL_ADD, FILL_ADD_CHEAP, FILL_ADD_IDLE };

static const uint32_t COVER_INDICES[3] = {0, 1, 2};
static const vplMesh COVER = {COVER_INDICES, 3, 1};

static void makeFill(Work* w, int kind)
{
    vplFramebuffer framebuffer = vplDefaultFramebuffer(SIDE, SIDE);
    const bool add = kind >= FILL_ADD;
    framebuffer.planeCount = add ? 4 : 0;
    check(vplRaster_Create(w->context, &framebuffer, &w->rasters[kind]));
    vplPipeline pipeline = vplDefaultPipeline();
    pipeline.vertex = coverVertices;
    for (int i = 0; i < LAYERS; i++) {
        w->depths[i] = (float)(LAYERS - i) / (LAYERS + 1);
        pipeline.vertexUniforms = &w->depths[add ? 0 : kind == FILL_HIDDEN ? LAYERS - 1 - i : i];
        check(vplRaster_Draw(w->rasters[kind], &COVER, &pipeline));
        if (add) {
            pipeline.depthCompare = VPL_DEPTH_EQUAL;
            pipeline.depthWrite = false;
            pipeline.blend = VPL_BLEND_ADD;
            pipeline.fragment = kind == FILL_ADD_IDLE ? noFragments : constantFragments;
            pipeline.planeMask = kind == FILL_ADD_CHEAP ? 0 : 15;
        }
    }
}

static double fill(void* work, int which)
{
    Work* w = work;
    check(vplRaster_Run(w->rasters[which], NULL, NULL, NULL));
    return (double)LAYERS * SIDE * SIDE;
}

// ---- cube maps and shadow factors

static vplCubeMap* drawMap(const Work* w, int size)
{
    vplCubeMapDef def = vplDefaultCubeMapDef();
    def.position = (vplVec3){0.1f, 4.5f, 0.2f};
    def.size = size;
    vplCubeMap* map;
    check(vplCubeMap_Create(w->geometry, &def, NULL, NULL, &map));
    return map;
}

static double drawTexels(void* work, int size)
{
    vplCubeMap_Destroy(drawMap(work, size));
    return 6.0 * size * size;
}

static double lookUp(void* work, int which)
{
    Work* w = work;
    const vplShadow* shadow = which == 0 ? &w->shadow : which == 1 ? &w->smallShadow : &w->hardShadow;
    float factor[VPL_LANES];
    for (int i = 0; i < 256; i++) {
        vplSurface surface = w->surface[i % 4];
        for (int l = 0; l < VPL_LANES; l++) { // all over the floor
            surface.px[l] += 0.06f * (float)(i / 4 % 16);
            surface.pz[l] -= 0.25f * (float)(i / 64);
        }
        vplShadow_FactorBlock(shadow, &surface, factor);
        w->planes[i] = factor[0];
    }
    return 256.0 * VPL_LANES * shadow->def.pcfSamples;
}

// ---- rays: boxes one in another, and triangles that all miss

static void makeChain(vplBvh* bvh, int count)
{
    bvh->nodes = calloc((size_t)count, sizeof *bvh->nodes);
    bvh->nodeCount = count;
    for (int n = 0; bvh->nodes != NULL && n < count; n++) {
        for (int i = 0; i < VPL_BVH_WIDTH; i++) {
            const bool way = i == n % VPL_BVH_WIDTH && n + 1 < count; // the last is missed in all its boxes
            for (int k = 0; k < 6; k++) {
                bvh->nodes[n].planes[k][i] = way ? (k < 3 ? -1.0f : 1.0f) : (k < 3 ? 50.0f : 51.0f);
            }
            bvh->nodes[n].child[i] = n + 1 < count ? n + 1 : 0;
        }
    }
}

static void makeBlocks(vplBvh* bvh)
{
    bvh->blocks = calloc(BLOCKS, sizeof *bvh->blocks);
    bvh->blockCount = BLOCKS;
    for (int b = 0; bvh->blocks != NULL && b < BLOCKS; b++) {
        for (int i = 0; i < VPL_BVH_WIDTH; i++) {
            for (int k = 0; k < 9; k++) { // beside the rays
                bvh->blocks[b].p[k / 3][k % 3][i] = 5 + 0.1f * (float)(k == 4 || k == 8) + 0.01f * (float)i;
            }
            bvh->blocks[b].id[i] = b * VPL_BVH_WIDTH + i;
        }
    }
}

static void makeRays(Work* w)
{
    makeChain(&w->chain, NODES);
    makeChain(&w->single, 1);
    makeBlocks(&w->blocks);
    if (w->chain.nodes == NULL || w->single.nodes == NULL || w->blocks.blocks == NULL) {
        exit(1);
    }
    for (int i = 0; i < RAYS; i++) {
        float t = (float)i / RAYS;
        w->rays[i] = (vplRay){{0.1f * t, 0.2f, -3}, {0.1f * t - 0.05f, 0.03f, 1}, {0, 0}};
    }
}

enum { RAY_CHAIN = 0, RAY_SINGLE, RAY_BLOCKS };

static double traceRays(void* work, int which)
{
    Work* w = work;
    const vplBvh* bvh = which == RAY_CHAIN ? &w->chain : which == RAY_SINGLE ? &w->single : &w->blocks;
    vplTraceAnyFcn* any = vplGetTraceAny(w->context->isa);
    int hits = 0;
    for (int i = 0; i < RAYS; i++) {
        hits += any(bvh, &w->rays[i], INFINITY);
    }
    w->planes[0] = (float)hits;
    const int units = which == RAY_BLOCKS ? BLOCKS : bvh->nodeCount;
    return (double)RAYS * units * VPL_BVH_WIDTH;
}

// ---- all: to be counted again where a kernel changes

#define DOCUMENTED_COSTS                                                                                     \
    {                                                                                                        \
        .mul = 9, .add = 10, .other = 2, .divide = 1, .root = 1                                              \
    }
#define PHYSICAL_COSTS                                                                                       \
    {                                                                                                        \
        .mul = 15, .add = 12, .other = 5, .divide = 1                                                        \
    }
// Blocks inside the triangle: depth stepped in double, clamped, compared, chosen; fragments counted.
#define FILL_COSTS                                                                                           \
    {                                                                                                        \
        .other = 5, .doubles = 1, .toFloat = 1, .read = 16, .written = 8                                     \
    }
// Passes over kept blocks: the shader writes four planes, each is added and chosen.
#define ADD_COSTS                                                                                            \
    {                                                                                                        \
        .add = 4, .other = 4, .read = 36, .written = 32                                                      \
    }
// w from three planes in double, the texel's direction, the distance along it; compared, chosen, counted.
#define TEXEL_COSTS                                                                                          \
    {                                                                                                        \
        .mul = 6, .add = 8, .other = 7, .doubles = 3, .toFloat = 3, .toInt = 2, .divide = 1, .root = 1,      \
        .read = 40, .written = 16                                                                            \
    }
// The sample's direction, the texel it meets (most of it choices between axes), one comparison there.
#define LOOK_UP_COSTS                                                                                        \
    {                                                                                                        \
        .mul = 11, .add = 9, .other = 35, .divide = 2, .toInt = 2, .gather = 1                               \
    }

const Loop LOOPS[] = {
    {"lights, documented", "pixel-lights", DOCUMENTED_COSTS, NULL, NULL, addLights, 0},
    {"lights, physical", "pixel-lights", PHYSICAL_COSTS, NULL, NULL, addLights, 1},
    {"physical, one light a call", "pixel-lights", PHYSICAL_COSTS, "lights, physical",
     "each call adds one light only: the block is read and written around it", addLightsOneByOne, 1},
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

Work* openWork(vplIsa isa)
{
    Work* w = calloc(1, sizeof *w);
    vplContextDef def = vplDefaultContextDef();
    def.isa = isa;
    def.workerCount = 1;
    if (w == NULL) {
        exit(1);
    }
    check(vplContext_Create(&def, &w->context));
    check(vplScene_Load(w->context, "examples/scenes/room.json", &w->scene));
    check(vplGeometry_Create(w->scene, &w->geometry));
    w->planes = calloc(256, sizeof *w->planes);
    if (w->planes == NULL) {
        exit(1);
    }
    makeLights(w);
    for (int kind = FILL_NEARER; kind <= FILL_ADD_IDLE; kind++) {
        makeFill(w, kind);
    }
    w->map = drawMap(w, MAP);
    w->smallMap = drawMap(w, SMALL_MAP);
    vplShadowDef shadow = vplDefaultShadowDef();
    check(vplShadow_Create(w->map, &shadow, &w->shadow));
    check(vplShadow_Create(w->smallMap, &shadow, &w->smallShadow));
    shadow.pcfSamples = 1;
    check(vplShadow_Create(w->map, &shadow, &w->hardShadow));
    makeRays(w);
    return w;
}

void closeWork(Work* w)
{
    for (int kind = FILL_NEARER; kind <= FILL_ADD_IDLE; kind++) {
        vplRaster_Destroy(w->rasters[kind]);
    }
    vplCubeMap_Destroy(w->map);
    vplCubeMap_Destroy(w->smallMap);
    free(w->chain.nodes);
    free(w->single.nodes);
    free(w->blocks.blocks);
    free(w->planes);
    vplGeometry_Destroy(w->geometry);
    vplScene_Destroy(w->scene);
    vplContext_Destroy(w->context);
    free(w);
}
