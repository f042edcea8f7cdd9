// SPDX-License-Identifier: MIT
// Gathers what textures and colours of vertices need, for scenes that have any.
#include "base/arena.h"
#include "geometry/object_build.h"
#include "geometry/paint.h"
#include "geometry/paint_data.h"
#include "geometry/triangle.h"
#include "math/scalar.h"
#include "scene/texture.h"

#include <string.h>

static bool usesTexture(const vplMaterialDef* m)
{
    return m->texture >= 0 || m->alphaTexture >= 0;
}

// Tests whether an object shows textures, and whether it has colours of vertices.
static void inspect(const vplScene* scene, const vplObjectDef* def, bool* textured, bool* coloured)
{
    const vplMeshDef shape = vplShapeOf(scene, def);
    *coloured = *coloured || shape.colors != NULL;
    if (def->material >= 0) {
        *textured = *textured || usesTexture(&scene->materials[def->material]);
        return;
    }
    for (int i = 0; !*textured && i < shape.triangleCount; i++) {
        *textured = usesTexture(&scene->materials[shape.materials[i]]);
    }
}

static vplTexturePlace placeOf(const vplMaterialDef* m)
{
    double sine, cosine;
    vplSinCos(m->textureRotation, &sine, &cosine);
    const double su = (double)m->textureScale[0], sv = (double)m->textureScale[1];
    return (vplTexturePlace){{{cosine * su, -sine * sv, (double)m->textureOffset[0]},
                              {sine * su, cosine * sv, (double)m->textureOffset[1]}}};
}

static void fillVertices(const vplScene* scene, const vplGeometry* g, float* texcoords, vplRgb* colours)
{
    for (int i = 0; i < g->objectCount; i++) {
        const vplMeshDef shape = vplShapeOf(scene, &scene->objects[i]);
        const size_t first = (size_t)g->objects[i].firstVertex, count = (size_t)shape.vertexCount;
        if (texcoords != NULL && shape.texcoords != NULL) {
            memcpy(texcoords + 2 * first, shape.texcoords, 2 * count * sizeof *texcoords);
        }
        for (size_t k = 0; colours != NULL && k < count; k++) {
            colours[first + k] = shape.colors != NULL ? shape.colors[k] : (vplRgb){1, 1, 1};
        }
    }
}

static vplResult allocate(const vplScene* scene, const vplGeometry* g, bool textured, bool coloured,
                          vplPaint** paintOut)
{
    const size_t vertices = (size_t)g->vertexCount;
    vplPaint* p = vplArena_AllocZero(g->arena, 1, sizeof *p);
    float* texcoords = textured ? vplArena_AllocZero(g->arena, 2 * vertices, sizeof *texcoords) : NULL;
    vplRgb* colours = coloured ? vplArena_Alloc(g->arena, vertices, sizeof *colours) : NULL;
    vplTexturePlace* places = vplArena_Alloc(g->arena, (size_t)scene->materialCount, sizeof *places);
    vplTexture** textures = vplArena_Alloc(g->arena, (size_t)scene->textureCount, sizeof *textures);
    TRY(vplArena_Check(g->arena));
    fillVertices(scene, g, texcoords, colours);
    for (int i = 0; i < scene->materialCount; i++) {
        places[i] = placeOf(&scene->materials[i]);
    }
    for (int i = 0; i < scene->textureCount; i++) {
        textures[i] = scene->textures[i].decoded;
    }
    *p = (vplPaint){.texcoords = texcoords, .colours = colours, .places = places, .textures = textures};
    *paintOut = p;
    return VPL_SUCCESS;
}

enum { CHUNK = 1024 }; // triangles per task

typedef struct Averaging {
    const vplGeometry* geometry;
    vplRgb* means;
} Averaging;

static void averageChunk(void* data, int chunk, int worker)
{
    (void)worker;
    const Averaging* a = data;
    const int first = chunk * CHUNK, left = a->geometry->triangleCount - first;
    for (int t = first; t < first + (left < CHUNK ? left : CHUNK); t++) {
        const vplTriangleCorners corners = vplGeometry_Corners(a->geometry, t);
        a->means[t] = vplPaint_MeanOfPart(a->geometry, t, corners.corner);
    }
}

static vplResult averageTriangles(const vplGeometry* g, vplRgb* means)
{
    Averaging averaging = {g, means};
    return vplParallelForAsking(g->context, (int)(((int64_t)g->triangleCount + CHUNK - 1) / CHUNK),
                                averageChunk, &averaging);
}

// Replaces the mean reflectances of objects, which know materials only.
static void averageObjects(const vplGeometry* g, vplGeometryObject* objects)
{
    for (int i = 0; i < g->objectCount; i++) {
        double sums[3] = {0}, area = 0;
        for (int t = objects[i].firstTriangle; t < objects[i].firstTriangle + objects[i].triangleCount; t++) {
            const double a = vplGeometry_TriangleArea(g, t);
            const vplRgb rho = vplPaint_Mean(g, t);
            sums[0] += a * (double)rho.r;
            sums[1] += a * (double)rho.g;
            sums[2] += a * (double)rho.b;
            area += a;
        }
        if (area > 0) {
            objects[i].reflectance =
                (vplRgb){(float)(sums[0] / area), (float)(sums[1] / area), (float)(sums[2] / area)};
        }
    }
}

vplResult vplBuildPaint(const vplScene* scene, vplGeometry* g, vplGeometryObject* objects)
{
    bool textured = false, coloured = false;
    for (int i = 0; i < g->objectCount; i++) {
        inspect(scene, &scene->objects[i], &textured, &coloured);
    }
    if (!textured && !coloured) {
        return VPL_SUCCESS;
    }
    vplPaint* paint = NULL;
    vplRgb* means = vplArena_Alloc(g->arena, (size_t)g->triangleCount, sizeof *means);
    TRY(allocate(scene, g, textured, coloured, &paint));
    paint->means = means;
    g->paint = paint;
    for (; paint->textureCount < scene->textureCount; paint->textureCount++) {
        vplTexture_Retain(paint->textures[paint->textureCount]);
    }
    TRY(averageTriangles(g, means));
    averageObjects(g, objects);
    return VPL_SUCCESS;
}

void vplReleasePaint(const vplGeometry* g)
{
    for (int i = 0; g->paint != NULL && i < g->paint->textureCount; i++) {
        vplTexture_Release(g->paint->textures[i]);
    }
}
