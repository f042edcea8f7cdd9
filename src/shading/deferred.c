// SPDX-License-Identifier: MIT
// Deferred shading: one pass writes position and triangle of every visible pixel, then each tile is lit by all
// lights while it is in cache. Also where depth, normals and shadow factors can be seen, because they need
// nothing but that G-buffer.
#include "math/vec.h"
#include "shading/shading.h"

#include <string.h>

enum { BLOCKS = VPL_TILE_BLOCKS * VPL_TILE_BLOCKS };

static void gbufferFragments(const void* uniforms, vplFragments* f)
{
    const vplObjectUniforms* u = uniforms;
    const int id = u->shading->geometry->objects[u->object].firstTriangle + f->primitive + 1;
    for (int l = 0; l < VPL_LANES; l++) {
        memcpy(&f->plane[VPL_PLANE_TRIANGLE][l], &id, sizeof id);
    }
    memcpy(f->plane[VPL_PLANE_POSITION], f->varying[0], 3 * sizeof f->varying[0]);
    if (u->normals != NULL) {
        memcpy(f->plane[VPL_PLANE_NORMAL], f->varying[VPL_CAMERA_VARYINGS], 3 * sizeof f->varying[0]);
    }
}

// The points of a block of the G-buffer; false where it is empty.
static bool readPoints(const vplShading* s, const vplTile* tile, int element, vplPoints* points)
{
    if (!vplReadTriangles(tile, element, points->triangle)) {
        return false;
    }
    vplSurface* surface = &points->surface;
    memcpy(surface->px, tile->planes[VPL_PLANE_POSITION] + element, sizeof surface->px);
    memcpy(surface->py, tile->planes[VPL_PLANE_POSITION + 1] + element, sizeof surface->py);
    memcpy(surface->pz, tile->planes[VPL_PLANE_POSITION + 2] + element, sizeof surface->pz);
    if (s->smooth) {
        memcpy(surface->nx, tile->planes[VPL_PLANE_NORMAL] + element, sizeof surface->nx);
        memcpy(surface->ny, tile->planes[VPL_PLANE_NORMAL + 1] + element, sizeof surface->ny);
        memcpy(surface->nz, tile->planes[VPL_PLANE_NORMAL + 2] + element, sizeof surface->nz);
    }
    vplPoints_FinishNormals(s, points);
    return true;
}

static void lightTile(void* data, vplTile* tile, int worker)
{
    (void)worker;
    const vplShading* s = data;
    const vplShadeDef* def = s->def;
    vplTileSums* sums = tile->scratch;
    for (int block = 0; block < BLOCKS; block++) {
        const int at = block * VPL_LANES;
        vplPoints points;
        float part[3][VPL_LANES];
        if (!readPoints(s, tile, at, &points)) {
            continue;
        }
        vplDirectIrradiance(s, &points, part, &sums->shadowRays);
        for (int first = 0;; first += VPL_LIGHT_GROUP) {
            for (int c = 0; c < 3; c++) {
                for (int l = 0; l < VPL_LANES; l++) {
                    sums->irradiance[c][at + l] += (double)part[c][l];
                    part[c][l] = 0;
                }
            }
            if (first >= def->lightCount) {
                break;
            }
            int count = def->lightCount - first < VPL_LIGHT_GROUP ? def->lightCount - first : VPL_LIGHT_GROUP;
            vplIndirectIrradiance(s, &points, first, count, part, &sums->shadowRays);
        }
    }
}

// Depth, normals or shadow factor instead of light.
static void showTile(void* data, vplTile* tile, int worker)
{
    (void)worker;
    const vplShading* s = data;
    const vplView* view = s->view;
    for (int block = 0; block < BLOCKS; block++) {
        const int at = block * VPL_LANES;
        vplPoints points;
        const vplSurface* surface = &points.surface;
        float values[3][VPL_LANES] = {{0}};
        if (readPoints(s, tile, at, &points)) {
            float factor[VPL_LANES] = {0};
            if (s->def->output == VPL_OUTPUT_SHADOW_FACTOR) {
                vplShadow_FactorBlock(&s->def->shadows[0], s->smooth ? &points.plane : surface, factor);
            }
            for (int l = 0; l < VPL_LANES; l++) {
                if (points.triangle[l] < 0) {
                    continue;
                }
                vplVec3 p = vplVec(surface->px[l], surface->py[l], surface->pz[l]);
                bool depth = s->def->output == VPL_OUTPUT_DEPTH,
                     normals = s->def->output == VPL_OUTPUT_NORMALS;
                float grey = depth ? vplDot(view->forward, vplSub(p, view->eye)) : factor[l];
                values[0][l] = normals ? surface->nx[l] : grey;
                values[1][l] = normals ? surface->ny[l] : grey;
                values[2][l] = normals ? surface->nz[l] : grey;
            }
        }
        vplWriteBlock(s, tile, block, values);
    }
}

vplResult vplRecordDeferred(const vplShading* shading, vplRaster* raster)
{
    vplResult result = VPL_SUCCESS;
    for (int i = 0; i < shading->geometry->objectCount && result == VPL_SUCCESS; i++) {
        vplPipeline pipeline = vplCameraPipeline(shading, i);
        pipeline.fragment = gbufferFragments;
        pipeline.fragmentUniforms = &shading->objects[i];
        pipeline.planeMask = 15u << VPL_PLANE_TRIANGLE | (shading->smooth ? 7u << VPL_PLANE_NORMAL : 0);
        result = vplRaster_Draw(raster, &shading->meshes[i], &pipeline);
    }
    void* data = (void*)shading;
    if (result == VPL_SUCCESS && shading->def->output != VPL_OUTPUT_RADIANCE) {
        return vplRaster_TileTask(raster, showTile, data);
    }
    if (result == VPL_SUCCESS) {
        result = vplRaster_TileTask(raster, lightTile, data);
    }
    return result == VPL_SUCCESS ? vplRaster_TileTask(raster, vplResolveTile, data) : result;
}
