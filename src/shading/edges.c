// SPDX-License-Identifier: MIT
// The surfaces of a pixel at an edge, and the queue in which they wait for their light.
#include "shading/edges.h"

#include "geometry/triangle.h"
#include "lights/light_set.h"
#include "math/scalar.h"

// Two triangles are one surface if they reflect and emit the same, their normals are as near as this, and
// they lie within EDGE_PIXELS of each other's plane.
#define EDGE_COSINE        0.95f
#define EDGE_SMOOTH_COSINE 0.8f // of two smooth triangles
#define EDGE_PIXELS        2.0f // widths of a pixel at that distance

// ---- which surfaces

float vplEdgeDistance(const vplShading* s, int triangle, const vplFacet* facet, vplVec3 sight)
{
    return vplDistanceOf(s->geometry, s->view, triangle, facet->normal, facet->offset, sight);
}

static bool sameReflector(const vplReflector* a, const vplReflector* b)
{
    bool same = a->texture == b->texture;
    for (int c = 0; c < 3; c++) {
        same &= a->factor[c] == b->factor[c] && a->emission[c] == b->emission[c];
    }
    return same;
}

bool vplIsOneSurface(const vplShading* s, const vplFacet* a, const vplFacet* b, float distance, vplVec3 sight)
{
    const float width = 2 / (float)(s->view->height * s->view->scaleY) * distance;
    const float apart = distance * vplDot(a->normal, sight) - a->offset;
    const float least = a->smooth && b->smooth ? EDGE_SMOOTH_COSINE : EDGE_COSINE;
    return sameReflector(&a->reflector, &b->reflector) && vplDot(a->normal, b->normal) >= least &&
           fabsf(apart) <= EDGE_PIXELS * width;
}

// The sample of a set that is nearest to the mean of them.
static int middleSample(uint32_t samples, int count)
{
    int x = 0, y = 0, n = 0;
    for (uint32_t left = samples; left != 0; left &= left - 1, n++) {
        const vplSubPixel at = vplSubPixel_OfSample(__builtin_ctz(left), count);
        x += at.x;
        y += at.y;
    }
    int best = 0, nearest = INT32_MAX;
    for (uint32_t left = samples; left != 0; left &= left - 1) {
        const int i = __builtin_ctz(left);
        const vplSubPixel at = vplSubPixel_OfSample(i, count);
        const int dx = n * at.x - x, dy = n * at.y - y, d2 = dx * dx + dy * dy; // at most 2^25
        best = d2 < nearest ? i : best;
        nearest = d2 < nearest ? d2 : nearest;
    }
    return best;
}

// Names the surface whose samples are `samples`: one of them, and the triangle that it shows.
static vplEdgeSurface nameSurface(const vplTile* tile, int element, uint32_t samples)
{
    const int sample = middleSample(samples, tile->sampleCount);
    return (vplEdgeSurface){.triangle = tile->samples[sample][element],
                            .sample = (int16_t)sample,
                            .glows = true,
                            .share = (float)__builtin_popcount(samples) / (float)(tile->sampleCount + 1)};
}

void vplFindEdges(const vplShading* s, const vplTile* tile, int element, vplFacetCache* cache,
                  vplEdgePixel* p)
{
    enum { OWN = VPL_MAX_SAMPLES_PER_PIXEL }; // the surface in the centre
    vplCoverage found[VPL_MAX_SAMPLES_PER_PIXEL];
    vplFacet facets[VPL_MAX_SAMPLES_PER_PIXEL + 1];
    uint32_t sets[VPL_MAX_SAMPLES_PER_PIXEL + 1] = {0};
    const int count = vplTile_GetCoverage(tile, element, found);
    if (p->triangle >= 0) {
        facets[OWN] = *vplFacetCache_Get(s, p->triangle, cache);
    }
    p->count = 0;
    for (int i = 0; i < count; i++) {
        const int triangle = found[i].triangle;
        if (triangle == p->triangle || triangle < 0) {
            sets[OWN] |= triangle == p->triangle ? found[i].samples : 0;
            continue;
        }
        const vplFacet facet = *vplFacetCache_Get(s, triangle, cache);
        const vplSubPixel at = vplSubPixel_OfSample(__builtin_ctz(found[i].samples), tile->sampleCount);
        const vplVec3 sight = vplSightOf(s->view, p->x, p->y, at);
        const float distance = vplEdgeDistance(s, triangle, &facet, sight);
        int same = p->triangle >= 0 && vplIsOneSurface(s, &facets[OWN], &facet, distance, sight) ? OWN : 0;
        while (same < p->count && !vplIsOneSurface(s, &facets[same], &facet, distance, sight)) {
            same++;
        }
        if (same == p->count) {
            facets[p->count++] = facet;
        }
        sets[same] |= found[i].samples;
    }
    p->own = sets[OWN];
    p->share = (float)(__builtin_popcount(sets[OWN]) + 1) / (float)(tile->sampleCount + 1);
    for (int i = 0; i < p->count; i++) {
        p->others[i] = nameSurface(tile, element, sets[i]);
    }
}

// ---- their light

void vplEdgeQueue_Flush(vplEdgeQueue* q)
{
    const vplShading* s = q->shading;
    vplBlock* b = &q->block;
    _Alignas(64) float part[3][VPL_LANES] = {{0}};
    if (q->count == 0) {
        return;
    }
    if (q->direct) {
        vplDirectIrradiance(s, &s->direct, &b->points, part, q->rays);
    }
    if (q->indirect && vplFindsLightByRays(s)) {
        uint32_t pixels[VPL_LANES] = {0};
        for (int l = 0; l < q->count; l++) {
            pixels[l] = (uint32_t)q->y[l] << 16 | (uint32_t)q->x[l];
        }
        vplAddLightOfRays(s, &b->points, pixels, part, q->rays);
    }
    vplStartSums(b, part);
    if (q->indirect) {
        q->addLights(s, q->user, b, q->rays);
    }
    for (int l = 0; l < q->count; l++) {
        const vplReflector* r = &vplFacetCache_Get(s, b->points.triangle[l], q->cache)->reflector;
        float* pixel = vplPixelOf(s, q->x[l], q->y[l]);
        double factor[3];
        vplFactorAtPoint(s, r, b->points.triangle[l], vplSurface_At(&b->surface, l), factor);
        for (int c = 0; c < 3; c++) {
            const double emission = q->direct && q->glows[l] ? r->emission[c] : 0;
            pixel[c] += q->share[l] * (float)(emission + factor[c] * b->sums[c][l]);
        }
    }
    q->count = 0;
}

// Puts a point into the next lane. The first point fills all lanes, so that unused ones hold valid numbers;
// they show no triangle.
static void putPoint(vplEdgeQueue* q, vplVec3 position, vplVec3 normal, vplVec3 plane)
{
    vplBlock* b = &q->block;
    if (q->count == 0) {
        b->points.surface = &b->surface;
        b->points.plane = &b->plane;
        b->cluster = VPL_NO_CLUSTER;
        memset(b->points.triangle, 0xff, sizeof b->points.triangle);
    }
    for (int l = q->count; l < (q->count == 0 ? VPL_LANES : q->count + 1); l++) {
        vplSurface_Put(&b->surface, l, position, normal);
        vplSurface_Put(&b->plane, l, position, plane);
    }
}

void vplEdgeQueue_PutSeen(vplEdgeQueue* q, int triangle, int x, int y, vplSubPixel at)
{
    const vplShading* s = q->shading;
    const vplFacet* facet = vplFacetCache_Get(s, triangle, q->cache);
    const vplVec3 sight = vplSightOf(s->view, x, y, at);
    const float distance = vplEdgeDistance(s, triangle, facet, sight);
    vplHit hit = {.object = s->geometry->owners[triangle],
                  .face = VPL_FACE_NONE,
                  .triangle = triangle,
                  .normal = facet->normal};
    hit.position = vplGeometry_InsideAt(s->geometry, triangle,
                                        vplAdd(s->view->eye, vplScale(distance, sight)), &hit.u, &hit.v);
    vplVec3 n = facet->smooth ? vplGeometry_ShadingNormal(s->geometry, &hit) : facet->normal;
    n = vplDot(n, facet->normal) < 0 ? vplNegate(n) : n;
    putPoint(q, hit.position, n, facet->normal);
    q->block.points.triangle[q->count] = triangle;
}

void vplEdgeQueue_Push(vplEdgeQueue* q, const vplEdgeSurface* surface, int x, int y)
{
    const vplSubPixel at = vplSubPixel_OfSample(surface->sample, q->shading->samples);
    vplEdgeQueue_PutSeen(q, surface->triangle, x, y, at);
    q->x[q->count] = x;
    q->y[q->count] = y;
    q->glows[q->count] = surface->glows;
    q->share[q->count] = surface->share;
    if (++q->count == VPL_LANES) {
        vplEdgeQueue_Flush(q);
    }
}
