// SPDX-License-Identifier: MIT
// Based on: Tomas Akenine-Moeller, Cyril Crassin, Jakub Boksansky, Laurent Belcour, Alexey Panteleev and Oli Wright,
// Improved Shader and Texture Level of Detail Using Ray Cones, JCGT 2021: the ellipse in which a cone meets a
// surface. Departs: pixels of the rasterizer are cones from the eye, too, so that all methods filter alike; a
// footprint is at most as large as its triangle, because beyond its edges a texture may show something else.
#include "geometry/paint.h"

#include "geometry/paint_data.h"
#include "geometry/triangle.h"
#include "math/double3.h"
#include "math/scalar.h"
#include "scene/texture.h"

#include <math.h>

// At smaller cosines the ellipse stays as long as at this one.
#define LEAST_COSINE 1e-3f

enum {
    MOST_PARTS = 8,     // along an edge of a triangle whose mean is taken
    TEXELS_PER_PART = 4 // along the edge
};

float vplShareOfArea(const vplGeometry* geometry, int count)
{
    return count > 0 ? (float)sqrt(geometry->area / count) : 0;
}

// ---- texture coordinates

// The corner of a quad's or box's face, seen from its front with +y, or on horizontal faces -z, upwards.
static void placeOnFace(vplObjectType type, int face, uint32_t corner, double* u, double* v)
{
    if (type == VPL_OBJECT_QUAD) {
        *u = corner == 1 || corner == 2;
        *v = corner >= 2;
        return;
    }
    const double x = corner & 1, y = corner >> 1 & 1, z = corner >> 2 & 1;
    const double across[6] = {1 - z, z, x, x, x, 1 - x}, upward[6] = {y, y, 1 - z, z, y, y};
    *u = across[face];
    *v = upward[face];
}

vplTexturedTriangle vplPaint_Corners(const vplGeometry* g, int triangle)
{
    const vplGeometryObject* object = &g->objects[g->owners[triangle]];
    const vplTexturePlace* place = &g->paint->places[g->triangleMaterials[triangle]];
    vplTexturedTriangle t;
    for (int k = 0; k < 3; k++) {
        const uint32_t corner = g->indices[3 * (size_t)triangle + (size_t)k];
        double u, v;
        if (object->type == VPL_OBJECT_MESH) {
            const float* at = g->paint->texcoords + 2 * ((size_t)object->firstVertex + corner);
            u = (double)at[0];
            v = (double)at[1];
        } else {
            placeOnFace(object->type, vplGeometry_FaceOf(g, triangle), corner, &u, &v);
        }
        t.u[k] = place->m[0][0] * u + place->m[0][1] * v + place->m[0][2];
        t.v[k] = place->m[1][0] * u + place->m[1][1] * v + place->m[1][2];
    }
    return t;
}

static double mix(const double corners[3], const double w[3])
{
    return w[0] * corners[0] + w[1] * corners[1] + w[2] * corners[2];
}

static vplRgb colourAt(const vplGeometry* g, int triangle, const double w[3])
{
    const vplRgb* colours = g->paint->colours + g->objects[g->owners[triangle]].firstVertex;
    double sum[3] = {0};
    for (int k = 0; k < 3; k++) {
        const vplRgb c = colours[g->indices[3 * (size_t)triangle + (size_t)k]];
        sum[0] += w[k] * (double)c.r;
        sum[1] += w[k] * (double)c.g;
        sum[2] += w[k] * (double)c.b;
    }
    // Points beside the triangle are extrapolated.
    return (vplRgb){vplClampf((float)sum[0], 0, 1), vplClampf((float)sum[1], 0, 1),
                    vplClampf((float)sum[2], 0, 1)};
}

static vplRgb paintedWith(const vplGeometry* g, int triangle, const double w[3], const vplTextureArea* area)
{
    const vplMaterialDef* m = &g->materials[g->triangleMaterials[triangle]];
    vplRgb rho = m->diffuse;
    if (area != NULL) {
        float rgba[4];
        vplTexture_Lookup(g->paint->textures[m->texture], area, rgba);
        rho = vplRgbMul(rho, (vplRgb){rgba[0], rgba[1], rgba[2]});
    }
    return g->paint->colours != NULL ? vplRgbMul(rho, colourAt(g, triangle, w)) : rho;
}

// ---- footprints

// How texture coordinates change along a direction in a triangle's plane.
typedef struct Gradient {
    double u[3], v[3];
} Gradient;

// Edges e1 and e2 span the plane: the barycentric of corner 1 changes along (e2 x n) / (e1 . (e2 x n)).
static Gradient gradientOf(const vplTriangleCorners* c, const vplTexturedTriangle* t)
{
    double e1[3], e2[3], n[3], along1[3], along2[3];
    for (int k = 0; k < 3; k++) {
        e1[k] = (double)vplComponent(c->corner[1], k) - (double)vplComponent(c->corner[0], k);
        e2[k] = (double)vplComponent(c->corner[2], k) - (double)vplComponent(c->corner[0], k);
    }
    vplCross3(e1, e2, n);
    vplCross3(e2, n, along1);
    vplCross3(n, e1, along2);
    const double scale = vplDot3(n, n) > 0 ? 1 / vplDot3(n, n) : 0;
    Gradient g;
    for (int k = 0; k < 3; k++) {
        g.u[k] = scale * ((t->u[1] - t->u[0]) * along1[k] + (t->u[2] - t->u[0]) * along2[k]);
        g.v[k] = scale * ((t->v[1] - t->v[0]) * along1[k] + (t->v[2] - t->v[0]) * along2[k]);
    }
    return g;
}

// The two axes of the ellipse in which a cone meets the plane, metres.
static void findAxes(vplVec3 normal, const vplFootprint* f, float most, double longer[3], double shorter[3])
{
    const float cosine = vplDot(f->direction, normal), slope = vplMaxf(fabsf(cosine), LEAST_COSINE);
    const vplVec3 inPlane = vplSub(f->direction, vplScale(cosine, normal));
    const vplVec3 guess = fabsf(normal.x) < 0.5f ? vplVec(1, 0, 0) : vplVec(0, 1, 0);
    const bool upright = !(vplDot(inPlane, inPlane) > 1e-6f);
    const vplVec3 along = vplNormalize(upright ? vplCross(normal, guess) : inPlane);
    const float width = vplMinf(f->width, most);
    vplToDouble3(vplScale(vplMinf(width / slope, most), along), longer);
    vplToDouble3(vplScale(width, vplCross(normal, along)), shorter);
}

static vplTextureArea areaAt(const vplGeometry* g, int triangle, const vplTriangleCorners* c,
                             const double w[3], const vplFootprint* f)
{
    const vplTexturedTriangle t = vplPaint_Corners(g, triangle);
    vplTextureArea area = {.u = mix(t.u, w), .v = mix(t.v, w)};
    if (f->width > 0) {
        const Gradient gradient = gradientOf(c, &t);
        double longer[3], shorter[3];
        findAxes(g->normals[triangle], f, (float)sqrt(2 * vplTriangle_Area(c)), longer, shorter);
        area.longU = (float)vplDot3(gradient.u, longer);
        area.longV = (float)vplDot3(gradient.v, longer);
        area.shortU = (float)vplDot3(gradient.u, shorter);
        area.shortV = (float)vplDot3(gradient.v, shorter);
    }
    return area;
}

static bool isPainted(const vplGeometry* g, int triangle)
{
    return g->materials[g->triangleMaterials[triangle]].texture >= 0 || g->paint->colours != NULL;
}

vplRgb vplPaint_Reflectance(const vplGeometry* g, int triangle, vplVec3 point, const vplFootprint* f)
{
    const vplMaterialDef* m = &g->materials[g->triangleMaterials[triangle]];
    if (!isPainted(g, triangle)) {
        return m->diffuse;
    }
    const vplTriangleCorners corners = vplGeometry_Corners(g, triangle);
    double w[3];
    vplTriangle_Barycentrics(corners.corner, point, w);
    if (m->texture < 0) {
        return paintedWith(g, triangle, w, NULL);
    }
    const vplTextureArea area = areaAt(g, triangle, &corners, w, f);
    return paintedWith(g, triangle, w, &area);
}

// ---- means

// The number of parts that each edge is divided into.
static int partsOf(const vplTexture* texture, const vplTextureArea* edges)
{
    const float width = (float)texture->levels[0].width, height = (float)texture->levels[0].height;
    const float a = fabsf(edges->longU) * width + fabsf(edges->longV) * height;
    const float b = fabsf(edges->shortU) * width + fabsf(edges->shortV) * height;
    const float parts = vplMaxf(a, b) / TEXELS_PER_PART;
    return parts < MOST_PARTS ? vplMaxi((int)ceilf(parts), 1) : MOST_PARTS; // also for infinity
}

// Barycentrics, in a triangle divided into n x n equal ones, of the middle of one of them.
static void middleOf(int i, int j, bool upper, int n, double w[3])
{
    const double third = upper ? 2.0 / 3 : 1.0 / 3;
    w[1] = (i + third) / n;
    w[2] = (j + third) / n;
    w[0] = 1 - w[1] - w[2];
}

vplRgb vplPaint_Mean(const vplGeometry* g, int triangle)
{
    return g->paint->means[triangle];
}

vplRgb vplPaint_MeanOfPart(const vplGeometry* g, int triangle, const vplVec3 corners[3])
{
    const vplMaterialDef* m = &g->materials[g->triangleMaterials[triangle]];
    if (!isPainted(g, triangle)) {
        return m->diffuse;
    }
    const vplTriangleCorners whole = vplGeometry_Corners(g, triangle);
    double at[3][3]; // barycentrics of the part's corners
    for (int k = 0; k < 3; k++) {
        vplTriangle_Barycentrics(whole.corner, corners[k], at[k]);
    }
    vplTextureArea area = {0};
    vplTexturedTriangle t = {{0}, {0}}, part = t;
    int n = 1;
    if (m->texture >= 0) {
        t = vplPaint_Corners(g, triangle);
        for (int k = 0; k < 3; k++) {
            part.u[k] = mix(t.u, at[k]);
            part.v[k] = mix(t.v, at[k]);
        }
        area = (vplTextureArea){.longU = (float)(part.u[1] - part.u[0]),
                                .longV = (float)(part.v[1] - part.v[0]),
                                .shortU = (float)(part.u[2] - part.u[0]),
                                .shortV = (float)(part.v[2] - part.v[0])};
        n = partsOf(g->paint->textures[m->texture], &area);
        area.longU /= (float)n;
        area.longV /= (float)n;
        area.shortU /= (float)n;
        area.shortV /= (float)n;
    }
    double sum[3] = {0};
    for (int k = 0; k < n * n; k++) { // n - row lower and n - row - 1 upper ones in each row
        int row = 0, left = k;
        while (left >= 2 * (n - row) - 1) {
            left -= 2 * (n - row) - 1;
            row++;
        }
        double inPart[3], w[3];
        middleOf(left / 2, row, left % 2 == 1, n, inPart);
        for (int i = 0; i < 3; i++) {
            w[i] = inPart[0] * at[0][i] + inPart[1] * at[1][i] + inPart[2] * at[2][i];
        }
        area.u = mix(t.u, w);
        area.v = mix(t.v, w);
        const vplRgb rho = paintedWith(g, triangle, w, m->texture >= 0 ? &area : NULL);
        sum[0] += (double)rho.r;
        sum[1] += (double)rho.g;
        sum[2] += (double)rho.b;
    }
    return (vplRgb){(float)(sum[0] / (n * n)), (float)(sum[1] / (n * n)), (float)(sum[2] / (n * n))};
}
