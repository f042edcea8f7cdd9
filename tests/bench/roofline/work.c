// SPDX-License-Identifier: MIT
// Runs the hot loops on one thread, and variants of them with one change each.
#include "work.h"

#include "cli/bench/cover.h"
#include "geometry/bvh.h"
#include "shading/light_block.h"
#include "shading/shading.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LIGHTS = 512, SIDE = 512, LAYERS = 8, NODES = 32, BLOCKS = 64, RAYS = 64 };

struct Work {
    vplContext* context;
    vplScene* scene;
    vplGeometry* geometry;
    vplShadeLight lights[LIGHTS];
    float columns[6][LIGHTS]; // the lights' positions and normals
    vplSurface surface[4];    // 4 blocks of the room's floor
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

double addLights(void* work, int which)
{
    Work* w = work;
    const vplLightFormula formula = {which ? VPL_LIGHTING_PHYSICAL : VPL_LIGHTING_DOCUMENTED, 0.2f};
    float irradiance[3][VPL_LANES] = {{0}};
    for (int i = 0; i < 16; i++) {
        vplAccumulateLights(w->context, formula, &w->surface[i % 4], w->lights, LIGHTS, irradiance);
    }
    w->planes[0] = irradiance[0][0];
    return 16.0 * LIGHTS * VPL_LANES;
}

// Adds one light per call, as shading with shadows does: shows the cost of reading and writing the block for
// each light.
double addLightsOneByOne(void* work, int which)
{
    Work* w = work;
    const vplLightFormula formula = {which ? VPL_LIGHTING_PHYSICAL : VPL_LIGHTING_DOCUMENTED, 0.2f};
    float irradiance[3][VPL_LANES] = {{0}};
    for (int i = 0; i < LIGHTS; i++) {
        vplAccumulateLights(w->context, formula, &w->surface[i % 4], &w->lights[i], 1, irradiance);
    }
    w->planes[0] = irradiance[0][0];
    return (double)LIGHTS * VPL_LANES;
}

// Culls lights that cannot reach a square metre of the floor. All of them can.
double cullLights(void* work, int which)
{
    Work* w = work;
    (void)which;
    const vplBounds bounds = {{-0.5f, 0, -0.5f, 0, 1, 0}, {0.5f, 0, 0.5f, 0, 1, 0}};
    float* const columns[6] = {w->columns[0], w->columns[1], w->columns[2],
                               w->columns[3], w->columns[4], w->columns[5]};
    vplCullFcn* cull = vplGetShadingKernels(w->context->isa, VPL_LIGHTING_PHYSICAL)->cull;
    int32_t keep[VPL_LIGHT_GROUP];
    for (int first = 0; first < LIGHTS; first += VPL_LIGHT_GROUP) {
        cull(&bounds, columns, first, VPL_LIGHT_GROUP, keep);
        w->planes[first / VPL_LIGHT_GROUP] = (float)keep[0];
    }
    return LIGHTS;
}

static void makeLights(Work* w)
{
    for (int i = 0; i < LIGHTS; i++) {
        float t = (float)i / LIGHTS;
        w->lights[i] = (vplShadeLight){2 * t - 1, 4.9f, 1 - 2 * t * t, 0, -1, 0, 0.1f, 0.2f, 0.3f};
        const vplShadeLight* v = &w->lights[i];
        const float values[6] = {v->px, v->py, v->pz, v->nx, v->ny, v->nz};
        for (int k = 0; k < 6; k++) {
            w->columns[k][i] = values[k];
        }
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

// Writes nothing: the planes keep the block's previous values.
static void noFragments(const void* uniforms, vplFragments* f)
{
    (void)uniforms;
    (void)f;
}

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
            pipeline.fragment = kind == FILL_ADD_IDLE ? noFragments : coverFragments;
            pipeline.planeMask = kind == FILL_ADD_CHEAP ? 0 : 15;
        }
    }
}

double fill(void* work, int which)
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

double drawTexels(void* work, int size)
{
    vplCubeMap_Destroy(drawMap(work, size));
    return 6.0 * size * size;
}

double lookUp(void* work, int which)
{
    Work* w = work;
    const vplShadow* shadow = which == 0 ? &w->shadow : which == 1 ? &w->smallShadow : &w->hardShadow;
    float factor[VPL_LANES];
    for (int i = 0; i < 256; i++) {
        vplSurface surface = w->surface[i % 4];
        for (int l = 0; l < VPL_LANES; l++) { // spread over the floor
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
    bvh->nodes = aligned_alloc(64, (size_t)count * sizeof *bvh->nodes);
    bvh->nodeCount = count;
    for (int n = 0; bvh->nodes != NULL && n < count; n++) {
        bvh->nodes[n].count = VPL_BVH_WIDTH;
        for (int i = 0; i < VPL_BVH_WIDTH; i++) {
            const bool way = i == n % VPL_BVH_WIDTH && n + 1 < count; // rays miss all boxes of the last node
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
            for (int k = 0; k < 9; k++) { // beside the rays, so that they miss
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

double traceRays(void* work, int which)
{
    Work* w = work;
    const vplBvh* bvh = which == RAY_CHAIN ? &w->chain : which == RAY_SINGLE ? &w->single : &w->blocks;
    vplTraceAnyFcn* any = vplGetRayKernels(w->context->isa)->any;
    int hits = 0;
    for (int i = 0; i < RAYS; i++) {
        hits += any(bvh, &w->rays[i], INFINITY);
    }
    w->planes[0] = (float)hits;
    const int units = which == RAY_BLOCKS ? BLOCKS : bvh->nodeCount;
    return (double)RAYS * units * VPL_BVH_WIDTH;
}

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
