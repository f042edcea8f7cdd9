// SPDX-License-Identifier: MIT
#include "cli/bench/series.h"

#include <math.h>

static const Stage SHADED = {.accumulation = VPL_ACCUMULATE_DEFERRED, .lights = 64, .batch = 1};

static vplResult shadeLights(Sweep* s, int point)
{
    Stage stage = SHADED;
    stage.lights = (int)s->n[point];
    Outcome outcome = {0};
    return shadeInto(&s->bench, s->bench.geometry, &stage, s->bench.image, &outcome);
}

// n is the number of pixels of a picture of 16:9.
static vplResult makeImage(Sweep* s, int point)
{
    const int height = (int)(sqrt(s->n[point] * 9 / 16) + 0.5), width = (int)(height * 16.0 / 9 + 0.5);
    s->n[point] = (double)width * height;
    return vplImage_Create(s->bench.context, width, height, &s->images[point]);
}

static vplResult shadePixels(Sweep* s, int point)
{
    Outcome outcome = {0};
    return shadeInto(&s->bench, s->bench.geometry, &SHADED, s->images[point], &outcome);
}

static vplResult makeField(Sweep* s, int point)
{
    TRY(buildField(s->bench.context, (int)s->n[point], &s->scenes[point]));
    TRY(vplGeometry_Create(s->scenes[point], &s->geometries[point]));
    s->n[point] = s->geometries[point]->triangleCount;
    return VPL_SUCCESS;
}

static vplResult buildTree(Sweep* s, int point)
{
    vplGeometry* geometry;
    TRY(vplGeometry_Create(s->scenes[point], &geometry));
    vplGeometry_Destroy(geometry);
    return VPL_SUCCESS;
}

static vplResult drawTriangles(Sweep* s, int point)
{
    const Stage stage = {.accumulation = VPL_ACCUMULATE_DEFERRED, .batch = 1, .flags = STAGE_NORMALS};
    Outcome outcome = {0};
    return shadeInto(&s->bench, s->geometries[point], &stage, s->bench.image, &outcome);
}

static vplResult traceTriangles(Sweep* s, int point)
{
    Outcome outcome = {0};
    hitPixels(s->geometries[point], vplScene_GetCamera(s->scenes[point], 0), 256, 144, &outcome);
    return VPL_SUCCESS;
}

static vplResult openThreads(Sweep* s, int point)
{
    const vplImage* image = s->bench.image;
    return openBench(s->arguments, (int)s->n[point], image->width, image->height, &s->benches[point]);
}

static vplResult shadeThreads(Sweep* s, int point)
{
    Bench* b = &s->benches[point];
    Stage stage = SHADED;
    stage.lights = 512;
    Outcome outcome = {0};
    return shadeInto(b, b->geometry, &stage, b->image, &outcome);
}

static vplResult drawCubeMap(Sweep* s, int point)
{
    vplCubeMapDef def = vplDefaultCubeMapDef();
    def.position = vplScene_GetEmitter(s->bench.scene, 0)->position;
    def.size = (int)s->n[point];
    vplCubeMap* map;
    TRY(vplCubeMap_Create(s->bench.geometry, &def, NULL, NULL, &map));
    vplCubeMap_Destroy(map);
    return VPL_SUCCESS;
}

const Series SERIES[] = {
    {"deferred against lights", "lights", 1, "each light costs each pixel the same", 16, 2048, 2, NULL,
     shadeLights},
    {"deferred, 64 lights, against pixels", "pixels", 1, "each pixel costs the same; 240p to 2160p",
     426 * 240, 3840 * 2160, 2.0837, makeImage, shadePixels},
    {"geometry and tree against triangles", "triangles", 1, "n log n: a little above 1", 1024, 1 << 20, 4,
     makeField, buildTree},
    {"G-buffer against triangles", "triangles", 1, "at most: triangles smaller than a pixel mostly end early",
     1024, 1 << 20, 4, makeField, drawTriangles},
    {"closest hits against triangles", "triangles", 0, "log n, and what no longer fits the caches", 1024,
     1 << 20, 4, makeField, traceTriangles},
    {"deferred, 512 lights, against threads", "threads", -1, "tiles are independent", 1, 0, 2, openThreads,
     shadeThreads},
    {"cube shadow map against size", "texels along a face", 2,
     "each texel costs the same, until maps outgrow the caches", 256, 4096, 2, NULL, drawCubeMap},
};

const int SERIES_COUNT = sizeof SERIES / sizeof *SERIES;
