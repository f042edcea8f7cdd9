// SPDX-License-Identifier: MIT
// Decides how emitting triangles light a pixel: all pixels share a set of samples on them, or a tree chooses triangles for each
// pixel. A triangle of the tree costs 7 to 18 times as much as a shared sample, because shadow rays of neighbouring pixels to a
// shared sample are coherent. Measured by bench/lamps (processor time, error of a pixel):
//     1,000 quads in a hall: 64 triangles of the tree 0.10 s, 4.8 %; one or two samples on each quad 0.16 s, 0.2 %
//     a sphere of 2,208 triangles: 64 of the tree 0.54 s, 3.7 %; 64 samples 0.03 s, 5.2 %; 256 samples 0.12 s, 0.6 %
#include "geometry/emission.h"
#include "geometry/triangle.h"
#include "lights/light_set.h"
#include "math/scalar.h"
#include "reference/path_scene.h"
#include "render/plan.h"
#include "shading/shading.h"

#include <math.h>

// Samples on compact meshes that have more emitting triangles than can each have a sample.
enum { COMPACT_POINTS = 256 };

// A mesh is compact if its emitting area is at least this share of the surface of its bounding box: 0.52 for a sphere, 0.5 for a
// square, 0.4 for a torus ten times as wide as thick. Several lamps far apart in one mesh have a smaller share.
static const double COMPACT_SHARE = 0.125;

vplTreesWanted vplTreesOf(const vplPlan* p)
{
    const bool hits = p->trianglesPerPoint > 0 && (p->compensates || p->gathers);
    const int emitters = p->emittersPerPoint > 0            ? 1
                         : p->compensates && p->emitterRays ? VPL_EMITTERS_OF_HIT + 1
                                                            : INT32_MAX;
    return p->options.method == VPL_METHOD_PATH
               ? (vplTreesWanted){VPL_PATH_EMITTERS_OF_TREE, VPL_PATH_TRIANGLES_OF_TREE}
               : (vplTreesWanted){emitters, hits || vplPixelsChooseTriangles(p) ? 1 : INT32_MAX};
}

int vplChosenEmitters(const vplPlan* p, int asked, int* placedOut)
{
    *placedOut = 0;
    for (int i = 0; i < p->emitterCount; i++) {
        *placedOut += p->emitters[i].type != VPL_EMITTER_DIRECTIONAL;
    }
    if (asked > 0) {
        return asked < *placedOut ? asked : 0;
    }
    return *placedOut > VPL_MOST_EMITTERS ? VPL_EMITTERS_PER_POINT : 0;
}

double vplAskedEmitters(const vplPlan* p)
{
    double sum = 0;
    for (int i = 0; i < p->emitterCount; i++) {
        const vplEmitterDef* e = &p->emitters[i];
        double sine, cosine = -1; // a point light is a cone of all directions
        if (e->type == VPL_EMITTER_SPOT) {
            vplSinCos(e->outerAngle, &sine, &cosine);
        }
        sum += 0.5 - 0.5 * cosine;
    }
    return sum;
}

bool vplPixelsChooseTriangles(const vplPlan* p)
{
    return p->trianglesPerPoint > 0 && p->trianglesPerPoint == p->options.lights.areaLightSamples;
}

// Computes the area of an object's emitting triangles over the surface of their bounding box; `first` is the object's first
// triangle. Returns the end of its triangles.
static int shareOfBox(const vplGeometry* g, int first, double* shareOut)
{
    vplVec3 low = {INFINITY, INFINITY, INFINITY}, high = {-INFINITY, -INFINITY, -INFINITY};
    double area = 0;
    int i = first;
    for (; i < g->triangleCount && g->owners[i] == g->owners[first]; i++) {
        if (vplRgbMean(g->materials[g->triangleMaterials[i]].emission) > 0) {
            const vplTriangleCorners t = vplGeometry_Corners(g, i);
            for (int k = 0; k < 3; k++) {
                const vplVec3 p = t.corner[k];
                low = vplVec(fminf(low.x, p.x), fminf(low.y, p.y), fminf(low.z, p.z));
                high = vplVec(fmaxf(high.x, p.x), fmaxf(high.y, p.y), fmaxf(high.z, p.z));
            }
            area += vplGeometry_TriangleArea(g, i);
        }
    }
    const double x = (double)high.x - low.x, y = (double)high.y - low.y, z = (double)high.z - low.z;
    *shareOut = area > 0 ? area / (2 * (x * y + y * z + z * x)) : 1;
    return i;
}

static bool areCompact(const vplGeometry* g)
{
    for (int i = 0; i < g->triangleCount;) {
        double share;
        i = shareOfBox(g, i, &share);
        if (share < COMPACT_SHARE) {
            return false;
        }
    }
    return true;
}

static vplResult countFaces(const vplGeometry* g, int* facesOut)
{
    vplEmission* emission;
    TRY(vplEmission_Create(g, NULL, 0, &emission));
    *facesOut = vplCountEmittingFaces(emission);
    vplEmission_Destroy(emission);
    return VPL_SUCCESS;
}

// If many triangles emit, hits of rays always use the tree. Pixels use samples if one on each face is affordable or the meshes
// are compact; otherwise they use the tree as well. The chosen number of samples is written into the options, and a replayed
// plan makes the same decision from it.
vplResult vplDecideTriangles(const vplRunner* r, vplPlan* p)
{
    const vplGeometry* g = r->run.results[VPL_STAGE_GEOMETRY];
    int *samples = &p->options.lights.areaLightSamples, faces = INT32_MAX;
    const bool points = p->options.method != VPL_METHOD_PATH && p->options.method != VPL_METHOD_KELLER &&
                        p->options.lighting == VPL_LIGHTING_PHYSICAL;
    const int most = *samples > VPL_MOST_EMITTERS ? *samples : VPL_MOST_EMITTERS;
    const bool manyObjects = g->emittingObjects > VPL_EMITTERS_PER_POINT;
    p->emittingTriangles = g->emittingTriangles;
    if (!points || !(g->emittingObjects > *samples || manyObjects || g->emittingTriangles > most)) {
        return VPL_SUCCESS;
    }
    if (manyObjects && g->emittingTriangles <= 2 * most) {
        TRY(countFaces(g, &faces));
    }
    p->trianglesPerPoint = VPL_EMITTERS_PER_POINT;
    if (faces <= most) {
        *samples = faces > *samples ? faces : *samples;
        vplDecide(p, "area-light-samples", "each of the %d faces that emit has a point", faces);
    } else if (!manyObjects && g->emittingTriangles > most && areCompact(g)) {
        *samples = *samples > COMPACT_POINTS ? *samples : COMPACT_POINTS;
        vplDecide(p, "area-light-samples", "points on compact meshes of %d triangles that emit",
                  g->emittingTriangles);
    } else {
        p->trianglesPerPoint = *samples;
        vplDecide(p, "area-light-samples", "for each point a tree chooses %d of the %d triangles that emit",
                  *samples, g->emittingTriangles);
    }
    return VPL_SUCCESS;
}
