// SPDX-License-Identifier: MIT
// Draws the rows of the table with libvpl, through its public API.
#include "peers.h"

#include <string.h>

static void shade(Room* room, const Row* row, bool direct)
{
    vplShadeDef def = vplDefaultShadeDef();
    def.lighting = row->lighting;
    def.accumulation = row->accumulation;
    def.interleave = 4;
    def.minDistance = MIN_DISTANCE;
    def.emitters = room->emitter;
    def.shadows = &room->shadow;
    def.emitterCount = direct;
    def.particleCount = PARTICLES;
    def.lights = row->lighting == VPL_LIGHTING_DOCUMENTED ? room->documented : room->physical;
    def.lightCount = row->lights;
    vplShadeStats stats;
    demand(vplShadeView(room->geometry, &room->view, &def, room->image, &stats) == VPL_SUCCESS,
           "libvpl cannot draw the room");
    room->draws += stats.raster.drawCalls;
}

void vplLightsWay(Room* room, const Row* row)
{
    shade(room, row, false);
}

// Measures direct light. The cube map's bounds are built once per map: this row leaves that out, the rows of
// whole frames include it.
void vplDirectWay(Room* room, const Row* row)
{
    if (room->map->bounds == NULL) { // another row has drawn the map again
        demand(vplCubeMap_FindBounds(room->map) == VPL_SUCCESS, "no bounds");
    }
    shade(room, row, true);
}

void vplCubeWay(Room* room, const Row* row)
{
    (void)row;
    vplCubeMapDef def = vplDefaultCubeMapDef();
    def.position = room->emitter->position;
    def.size = CUBE_SIZE;
    if (room->map == NULL) {
        demand(vplCubeMap_Create(room->geometry, &def, NULL, NULL, &room->map) == VPL_SUCCESS,
               "no shadow map");
    } else { // draws into the same map again, as OpenGL does
        demand(vplCubeMap_Redraw(room->map, room->geometry, &def, NULL, NULL) == VPL_SUCCESS,
               "no shadow map");
    }
    room->draws += room->map->stats.drawCalls;
    vplShadowDef shadowDef = vplDefaultShadowDef();
    shadowDef.biasRule = VPL_BIAS_PAIR; // the bias of the document, as vplRender uses for documented lighting
    shadowDef.pcfOffset = room->map->farPlane / 128; // and its radius
    shadowDef.pcfSamples = PCF_SAMPLES;
    demand(vplShadow_Create(room->map, &shadowDef, &room->shadow) == VPL_SUCCESS, "no shadow");
}

void vplFrameWay(Room* room, const Row* row)
{
    vplCubeWay(room, row);
    demand(vplCubeMap_FindBounds(room->map) == VPL_SUCCESS, "no bounds");
    shade(room, row, true);
}

// ---- the rasterizer alone

// Writes three vertices per layer: a triangle over the whole picture. layers 0: one triangle at medium depth.
static void layerVertices(const void* uniforms, int first, int count, const vplVertices* out)
{
    const int layers = *(const int*)uniforms;
    for (int i = 0; i < count; i++) {
        const int vertex = first + i, corner = vertex % 3;
        out->x[i] = corner == 1 ? 3 : -1;
        out->y[i] = corner == 2 ? 3 : -1;
        out->z[i] = layers == 0 ? 0.5f : 1 - (float)(vertex / 3 + 1) / (float)(layers + 1);
        out->w[i] = 1;
    }
}

static void constantColour(const void* const* uniforms, int count, vplFragments* f)
{
    (void)uniforms;
    for (int i = 0; i < count; i++) {
        for (int p = 0; p < ADD_PLANES; p++) {
            for (int l = 0; l < VPL_LANES; l++) {
                f->plane[p][l] += LAYER_COLOUR;
            }
        }
    }
}

static void gridVertices(const void* uniforms, int first, int count, const vplVertices* out)
{
    const vplVec3* positions = uniforms;
    for (int i = 0; i < count; i++) {
        out->x[i] = positions[first + i].x;
        out->y[i] = positions[first + i].y;
        out->z[i] = positions[first + i].z;
        out->w[i] = 1;
    }
}

static vplRaster* beginRaster(Room* room, bool colour)
{
    vplFramebuffer framebuffer = vplDefaultFramebuffer(room->view.width, room->view.height);
    const size_t pixels = (size_t)room->view.width * (size_t)room->view.height;
    framebuffer.depth.pixels = room->depth;
    framebuffer.planeCount = colour ? ADD_PLANES : 0;
    for (int p = 0; p < framebuffer.planeCount; p++) {
        framebuffer.planes[p].pixels = room->colour + (size_t)p * pixels;
    }
    vplRaster* raster;
    demand(vplRaster_Create(room->context, &framebuffer, &raster) == VPL_SUCCESS, "no raster");
    return raster;
}

static void draw(vplRaster* raster, const vplMesh* mesh, const vplPipeline* pipeline)
{
    demand(vplRaster_Draw(raster, mesh, pipeline) == VPL_SUCCESS, "libvpl refuses a draw");
}

static void endRaster(Room* room, vplRaster* raster)
{
    vplRasterStats stats;
    demand(vplRaster_Run(raster, NULL, NULL, &stats) == VPL_SUCCESS, "libvpl cannot draw");
    room->draws += stats.drawCalls;
    vplRaster_Destroy(raster);
}

// Returns the indices 0, 1, 2 ... of separate triangles.
static const uint32_t* countingIndices(void)
{
    static uint32_t indices[3 * DEPTH_LAYERS];
    for (uint32_t i = 0; i < 3 * DEPTH_LAYERS; i++) {
        indices[i] = i;
    }
    return indices;
}

void vplDepthFillWay(Room* room, const Row* row)
{
    (void)row;
    static const int layers = DEPTH_LAYERS;
    const vplMesh mesh = {countingIndices(), 3 * DEPTH_LAYERS, DEPTH_LAYERS};
    vplPipeline pipeline = vplDefaultPipeline();
    pipeline.vertex = layerVertices;
    pipeline.vertexUniforms = &layers;
    vplRaster* raster = beginRaster(room, false);
    draw(raster, &mesh, &pipeline);
    endRaster(room, raster);
}

void vplAddFillWay(Room* room, const Row* row)
{
    (void)row;
    static const int middle = 0;
    const vplMesh one = {countingIndices(), 3, 1};
    vplPipeline pipeline = vplDefaultPipeline();
    pipeline.vertex = layerVertices;
    pipeline.vertexUniforms = &middle;
    vplRaster* raster = beginRaster(room, true);
    draw(raster, &one, &pipeline);
    pipeline.passes = constantColour;
    pipeline.depthCompare = VPL_DEPTH_EQUAL;
    pipeline.depthWrite = false;
    pipeline.ownerTest = true;
    pipeline.blend = VPL_BLEND_ADD;
    for (int i = 0; i < ADD_LAYERS; i++) {
        draw(raster, &one, &pipeline);
    }
    endRaster(room, raster);
}

void vplTrianglesWay(Room* room, const Row* row)
{
    (void)row;
    vplPipeline pipeline = vplDefaultPipeline();
    pipeline.vertex = gridVertices;
    pipeline.vertexUniforms = room->gridPositions;
    vplRaster* raster = beginRaster(room, false);
    draw(raster, &room->grid, &pipeline);
    endRaster(room, raster);
}
