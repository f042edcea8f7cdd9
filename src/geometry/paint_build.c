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

// Whether any object of a scene shows a texture, and whether any has colours of vertices.
typedef struct Shown {
    bool textures, colours;
} Shown;

static void inspect(const vplScene* scene, const vplObjectDef* def, Shown* shown)
{
    const vplMeshDef shape = vplShapeOf(scene, def);
    shown->colours = shown->colours || shape.colors != NULL;
    if (def->material >= 0) {
        shown->textures = shown->textures || usesTexture(&scene->materials[def->material]);
        return;
    }
    for (int i = 0; !shown->textures && i < shape.triangleCount; i++) {
        shown->textures = usesTexture(&scene->materials[shape.materials[i]]);
    }
}

static Shown inspectAll(const vplScene* scene)
{
    Shown shown = {false, false};
    for (int i = 0; i < scene->objectCount; i++) {
        inspect(scene, &scene->objects[i], &shown);
    }
    return shown;
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

static void fillPlaces(const vplScene* scene, vplTexturePlace* places)
{
    for (int i = 0; i < scene->materialCount; i++) {
        places[i] = placeOf(&scene->materials[i]);
    }
}

static vplResult create(const vplScene* scene, const vplGeometry* g, Shown shown, const vplPaint** paintOut)
{
    const size_t vertices = (size_t)g->vertexCount, textureCount = (size_t)scene->textureCount;
    vplArena* arena = vplArena_Create(g->context);
    vplPaint* p = vplArena_AllocZero(arena, 1, sizeof *p);
    float* texcoords = shown.textures ? vplArena_AllocZero(arena, 2 * vertices, sizeof *texcoords) : NULL;
    vplRgb* colours = shown.colours ? vplArena_Alloc(arena, vertices, sizeof *colours) : NULL;
    vplRgb* means = vplArena_Alloc(arena, (size_t)g->triangleCount, sizeof *means);
    vplTexturePlace* places = vplArena_Alloc(arena, (size_t)scene->materialCount, sizeof *places);
    vplTexture** textures = vplArena_Alloc(arena, textureCount, sizeof *textures);
    const vplResult result = vplArena_Check(arena);
    if (result == VPL_SUCCESS) {
        fillVertices(scene, g, texcoords, colours);
        fillPlaces(scene, places);
        for (size_t i = 0; i < textureCount; i++) {
            textures[i] = scene->textures[i].decoded;
            vplTexture_Retain(textures[i]);
        }
        *p = (vplPaint){texcoords, colours, places, means, textures, scene->textureCount, arena};
    }
    return vplArena_Deliver(arena, result, p, paintOut);
}

void vplPaint_Destroy(const vplPaint* paint)
{
    if (paint != NULL) {
        for (int i = 0; i < paint->textureCount; i++) {
            vplTexture_Release(paint->textures[i]);
        }
        vplArena_Destroy(paint->arena);
    }
}

enum { CHUNK = 1024 }; // triangles per task

typedef struct Averaging {
    const vplGeometry* geometry;
    const uint8_t* changes; // of objects; NULL: all did
    vplRgb* means;
} Averaging;

static bool isChanged(const Averaging* a, int object)
{
    return a->changes == NULL || a->changes[object] != 0;
}

static void averageChunk(void* data, int chunk, int worker)
{
    (void)worker;
    const Averaging* a = data;
    const int first = chunk * CHUNK, left = a->geometry->triangleCount - first;
    for (int t = first; t < first + (left < CHUNK ? left : CHUNK); t++) {
        if (isChanged(a, a->geometry->owners[t])) {
            const vplTriangleCorners corners = vplGeometry_Corners(a->geometry, t);
            a->means[t] = vplPaint_MeanOfPart(a->geometry, t, corners.corner);
        }
    }
}

// Replaces the mean reflectance of an object, which knows materials only.
static void averageObject(const vplGeometry* g, vplGeometryObject* object)
{
    double sums[3] = {0}, area = 0;
    for (int t = object->firstTriangle; t < object->firstTriangle + object->triangleCount; t++) {
        const double a = vplGeometry_TriangleArea(g, t);
        const vplRgb rho = vplPaint_Mean(g, t);
        sums[0] += a * (double)rho.r;
        sums[1] += a * (double)rho.g;
        sums[2] += a * (double)rho.b;
        area += a;
    }
    if (area > 0) {
        object->reflectance =
            (vplRgb){(float)(sums[0] / area), (float)(sums[1] / area), (float)(sums[2] / area)};
    }
}

static vplResult average(const vplGeometry* g, vplGeometryObject* objects, const uint8_t* changes)
{
    Averaging a = {g, changes, (vplRgb*)g->paint->means};
    TRY(vplParallelForAsking(g->context, (int)(((int64_t)g->triangleCount + CHUNK - 1) / CHUNK), averageChunk,
                             &a));
    for (int i = 0; i < g->objectCount; i++) {
        if (isChanged(&a, i)) {
            averageObject(g, &objects[i]);
        }
    }
    return VPL_SUCCESS;
}

vplResult vplBuildPaint(const vplScene* scene, vplGeometry* g, vplGeometryObject* objects)
{
    const Shown shown = inspectAll(scene);
    if (!shown.textures && !shown.colours) {
        return VPL_SUCCESS;
    }
    TRY(create(scene, g, shown, &g->paint));
    return average(g, objects, NULL);
}

// ---- updates

bool vplPaintFits(const vplGeometry* g, const vplScene* scene)
{
    const vplPaint* p = g->paint;
    const Shown shown = inspectAll(scene);
    if (p == NULL) {
        return !shown.textures && !shown.colours;
    }
    bool same = (p->texcoords != NULL) == shown.textures && (p->colours != NULL) == shown.colours &&
                p->textureCount == scene->textureCount && g->materialCount == scene->materialCount;
    for (int i = 0; i < p->textureCount && same; i++) {
        same = p->textures[i] == scene->textures[i].decoded;
    }
    return same;
}

vplResult vplUpdatePaint(const vplScene* scene, const vplGeometry* g, vplGeometryObject* objects,
                         const uint8_t* changes)
{
    fillPlaces(scene, (vplTexturePlace*)g->paint->places);
    return average(g, objects, changes);
}
