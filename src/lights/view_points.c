// SPDX-License-Identifier: MIT
// Points that a camera sees: sixteen Sobol points in each cell of a grid over the picture, so that the shadow
// rays of a packet start close together.
#include "lights/placement.h"

#include "geometry/paint.h"
#include "geometry/triangle.h"
#include "lights/light_set.h"
#include "math/scalar.h"
#include "math/sobol.h"
#include "math/vec.h"

#include <string.h>

enum { VIEW_STREAM = 0x80000002u }; // of random numbers; differs from those of particles

typedef struct ViewSampling {
    const vplGeometry* geometry;
    const vplPlacementDef* def;
    vplVec3 right, up, forward; // the camera's; right and up span half a picture at a distance of one metre
    int columns, rows;          // of cells
    const vplSobol* sobol;
    vplViewBlock* blocks;
} ViewSampling;

static void aimCamera(ViewSampling* s)
{
    const vplCameraDef* camera = &s->def->camera;
    double sine, cosine;
    vplSinCos(camera->fovY / 2, &sine, &cosine);
    const double tangent = sine / cosine, aspect = (double)s->def->width / s->def->height;
    s->forward = vplNormalize(vplSub(camera->target, camera->eye));
    const vplVec3 right = vplNormalize(vplCross(s->forward, camera->up));
    s->up = vplScale((float)tangent, vplCross(right, s->forward));
    s->right = vplScale((float)(tangent * aspect), right);
}

// Makes cells about as wide as they are high.
static void divide(ViewSampling* s)
{
    const int cells = (s->def->pointCount + VPL_LANES - 1) / VPL_LANES;
    const double rows = rint(sqrt((double)cells * s->def->height / s->def->width));
    s->rows = rows < 1 ? 1 : rows > cells ? cells : (int)rows;
    s->columns = (cells + s->rows - 1) / s->rows;
}

static void putPoint(const ViewSampling* s, const vplHit* hit, vplVec3 from, vplViewBlock* b, int l)
{
    const vplGeometry* g = s->geometry;
    const vplVec3 shading = vplGeometry_ShadingNormal(g, hit);
    const float side = vplDot(hit->normal, from) > 0 ? -1.0f : 1.0f;
    // Documented lighting shades with normals as declared.
    const float shown = s->def->lighting == VPL_LIGHTING_DOCUMENTED ? 1.0f : side;
    const vplFootprint point = {.width = 0};
    const vplRgb rho = vplGeometry_Reflectance(g, hit->triangle, hit->position, &point);
    const vplRay leave = vplGeometry_Leave(g, hit, vplScale(shown, hit->normal));
    vplSurface_Put(&b->surface, l, hit->position, vplScale(shown, shading));
    b->plane[0][l] = shown * hit->normal.x;
    b->plane[1][l] = shown * hit->normal.y;
    b->plane[2][l] = shown * hit->normal.z;
    b->rho[0][l] = rho.r;
    b->rho[1][l] = rho.g;
    b->rho[2][l] = rho.b;
    vplRayPacket_Set(&b->rays, l, &leave);
}

// A task: the points of one cell.
static void sampleCell(void* data, int cell, int worker)
{
    (void)worker;
    const ViewSampling* s = data;
    const vplCameraDef* camera = &s->def->camera;
    const uint64_t cells = (uint64_t)s->columns * (uint64_t)s->rows;
    vplViewBlock* b = &s->blocks[cell];
    memset(b, 0, sizeof *b);
    for (int l = 0; l < VPL_LANES; l++) {
        float u[VPL_SOBOL_DIMENSIONS];
        vplSobol_Sample(s->sobol, s->def->seed, (uint64_t)s->def->index * cells + (uint64_t)cell, VIEW_STREAM,
                        (uint32_t)l, u);
        const float x = 2 * ((float)(cell % s->columns) + u[0]) / (float)s->columns - 1;
        const float y = 1 - 2 * ((float)(cell / s->columns) + u[1]) / (float)s->rows;
        // The direction is one metre along the view axis, so that t is a depth; the ray starts at the near
        // plane.
        const vplVec3 way = vplAdd(s->forward, vplAdd(vplScale(x, s->right), vplScale(y, s->up)));
        const vplRay ray = {vplAdd(camera->eye, vplScale((float)camera->nearPlane, way)), way, {0, 0}};
        vplHit hit;
        if (vplGeometry_ClosestHit(s->geometry, &ray, &hit) &&
            (double)hit.t <= camera->farPlane - camera->nearPlane) {
            putPoint(s, &hit, way, b, l);
        }
    }
}

vplResult vplSampleView(const vplGeometry* geometry, const vplPlacementDef* def, vplArena* arena,
                        const vplViewBlock** blocksOut, int* countOut)
{
    const vplSobol sobol = vplSobol_Make();
    ViewSampling s = {.geometry = geometry, .def = def, .sobol = &sobol};
    aimCamera(&s);
    divide(&s);
    s.blocks = vplArena_Alloc(arena, (size_t)s.columns * (size_t)s.rows, sizeof *s.blocks);
    TRY(vplArena_Check(arena));
    TRY(vplParallelForAsking(geometry->context, s.columns * s.rows, sampleCell, &s));
    *blocksOut = s.blocks;
    *countOut = s.columns * s.rows;
    return VPL_SUCCESS;
}
