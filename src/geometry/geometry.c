// SPDX-License-Identifier: MIT
// The scene as read-only world-space arrays of triangles.
#include "base/arena.h"
#include "geometry/bvh.h"
#include "geometry/cut_outs.h"
#include "geometry/formula.h"
#include "geometry/object_build.h"
#include "geometry/paint.h"
#include "geometry/paint_data.h"
#include "geometry/triangle.h"
#include "math/vec.h"

#include <math.h>
#include <string.h>

static bool isSmooth(const vplScene* scene, const vplObjectDef* def)
{
    return def->type == VPL_OBJECT_MESH && scene->meshes[def->mesh].normals != NULL;
}

// Quads and boxes that let light through are always tested as triangles.
static bool isCutOut(const vplScene* scene, const vplObjectDef* def)
{
    return def->material >= 0 && vplIsCutOut(&scene->materials[def->material]);
}

// Counts vertices and triangles, and allocates the arrays.
static vplResult allocate(const vplScene* scene, vplGeometry* g, vplGeometryBuilder* b)
{
    int64_t vertexCount = 0, triangleCount = 0;
    bool smooth = false;
    for (int i = 0; i < scene->objectCount; i++) {
        const vplMeshDef shape = vplShapeOf(scene, &scene->objects[i]);
        vertexCount += shape.vertexCount;
        triangleCount += shape.triangleCount;
        smooth = smooth || isSmooth(scene, &scene->objects[i]);
    }
    if (triangleCount > VPL_MAX_TRIANGLES || vertexCount > VPL_MAX_TRIANGLES) {
        return vplFail(scene->context, VPL_LIMIT, "the scene has %lld triangles, at most %d are allowed",
                       (long long)triangleCount, VPL_MAX_TRIANGLES);
    }
    g->objectCount = scene->objectCount;
    g->materialCount = scene->materialCount;
    g->vertexCount = (int)vertexCount;
    g->triangleCount = (int)triangleCount;
    const size_t vertices = (size_t)vertexCount, triangles = (size_t)triangleCount;
    g->objects = b->objects = vplArena_AllocZero(g->arena, (size_t)g->objectCount, sizeof *b->objects);
    g->positions = b->positions = vplArena_Alloc(g->arena, vertices, sizeof *b->positions);
    g->indices = b->indices = vplArena_Alloc(g->arena, 3 * triangles, sizeof *b->indices);
    g->formulaObjects = b->formulaObjects =
        vplArena_Alloc(g->arena, (size_t)g->objectCount, sizeof *b->formulaObjects);
    g->normals = b->normals = vplArena_Alloc(g->arena, triangles, sizeof *b->normals);
    g->owners = b->owners = vplArena_Alloc(g->arena, triangles, sizeof *b->owners);
    g->triangleMaterials = b->triangleMaterials =
        vplArena_Alloc(g->arena, triangles, sizeof *b->triangleMaterials);
    g->materials = b->materials = vplArena_Alloc(g->arena, (size_t)g->materialCount, sizeof *b->materials);
    if (smooth) {
        g->shadingNormals = b->shadingNormals = vplArena_Alloc(g->arena, vertices, sizeof *b->shadingNormals);
    }
    return vplArena_Check(g->arena);
}

void vplFillMaterials(const vplGeometry* g, const vplGeometryBuilder* b)
{
    for (int i = 0; i < g->materialCount; i++) {
        b->materials[i] = b->scene->materials[i];
        b->materials[i].name = NULL; // the scene may be destroyed before the geometry
    }
}

vplResult vplFinishObject(const vplGeometryBuilder* b, int index)
{
    vplGeometryObject* object = &b->objects[index];
    const vplMeshDef shape = vplShapeOf(b->scene, &b->scene->objects[index]);
    TRY(vplBuildObject(b, index));
    object->byFormula =
        !isCutOut(b->scene, &b->scene->objects[index]) && vplNeedsFormula(object, &shape, b->positions);
    return VPL_SUCCESS;
}

void vplListFormulaObjects(vplGeometry* g, const vplGeometryBuilder* b)
{
    g->formulaCount = 0;
    for (int i = 0; i < g->objectCount; i++) {
        if (g->objects[i].byFormula) {
            b->formulaObjects[g->formulaCount++] = i;
        }
    }
}

static vplResult fill(vplGeometry* g, const vplGeometryBuilder* b)
{
    const vplScene* scene = b->scene;
    int vertex = 0, triangle = 0;
    for (int i = 0; i < g->objectCount; i++) {
        const vplObjectDef* def = &scene->objects[i];
        const vplMeshDef shape = vplShapeOf(scene, def);
        vplGeometryObject* object = &b->objects[i];
        *object = (vplGeometryObject){.type = def->type,
                                      .material = def->material,
                                      .smooth = isSmooth(scene, def),
                                      .firstVertex = vertex,
                                      .vertexCount = shape.vertexCount,
                                      .firstTriangle = triangle,
                                      .triangleCount = shape.triangleCount};
        TRY(vplPlacement_Create(g->context, &def->transform, &object->placement));
        TRY(vplFinishObject(b, i));
        vertex += object->vertexCount;
        triangle += object->triangleCount;
    }
    vplListFormulaObjects(g, b);
    vplFillMaterials(g, b);
    return VPL_SUCCESS;
}

// Sums over a chunk of triangles.
typedef struct Summary {
    double area, reflecting, emittingArea; // reflecting: mean reflectance times area
    int emittingTriangles, emittingObjects;
    int firstEmitter, lastEmitter; // objects
} Summary;

typedef struct Summaries {
    const vplGeometry* geometry;
    Summary* chunks;
} Summaries;

static void summariseChunk(void* data, int chunk, int worker)
{
    (void)worker;
    const Summaries* all = data;
    const vplGeometry* g = all->geometry;
    Summary s = {.firstEmitter = -1, .lastEmitter = -1};
    const int first = chunk * VPL_TRIANGLE_CHUNK,
              end = vplEndOfChunk(g->triangleCount, first, VPL_TRIANGLE_CHUNK);
    for (int i = first; i < end; i++) {
        const vplMaterialDef* material = &g->materials[g->triangleMaterials[i]];
        const vplRgb rho = vplGeometry_ReflectanceOf(g, i);
        const double area = vplGeometry_TriangleArea(g, i);
        s.area += area;
        s.reflecting += area * ((double)rho.r + (double)rho.g + (double)rho.b) / 3;
        if (vplRgbMean(material->emission) > 0) {
            s.emittingArea += area;
            s.emittingTriangles++;
            s.emittingObjects += g->owners[i] != s.lastEmitter;
            s.firstEmitter = s.firstEmitter < 0 ? g->owners[i] : s.firstEmitter;
            s.lastEmitter = g->owners[i];
        }
    }
    all->chunks[chunk] = s;
}

static void findBounds(vplGeometry* g)
{
    for (int i = 0; i < g->vertexCount; i++) {
        const vplVec3 p = g->positions[i], low = i > 0 ? g->boundsMin : p, high = i > 0 ? g->boundsMax : p;
        g->boundsMin = vplVec(vplMinf(low.x, p.x), vplMinf(low.y, p.y), vplMinf(low.z, p.z));
        g->boundsMax = vplVec(vplMaxf(high.x, p.x), vplMaxf(high.y, p.y), vplMaxf(high.z, p.z));
    }
}

vplResult vplSummarise(vplGeometry* g)
{
    const int count = vplCountChunks(g->triangleCount, VPL_TRIANGLE_CHUNK);
    Summaries all = {g, vplAlloc(g->context, (size_t)count, sizeof *all.chunks)};
    if (all.chunks == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    vplParallelFor(g->context, count, summariseChunk, &all);
    double reflecting = 0;
    g->area = g->emittingArea = 0;
    g->emittingTriangles = g->emittingObjects = 0;
    int emitter = -1; // the last object that does
    for (int i = 0; i < count; i++) {
        const Summary* s = &all.chunks[i];
        g->area += s->area;
        reflecting += s->reflecting;
        g->emittingArea += s->emittingArea;
        g->emittingTriangles += s->emittingTriangles;
        g->emittingObjects += s->emittingObjects - (s->emittingObjects > 0 && s->firstEmitter == emitter);
        emitter = s->emittingObjects > 0 ? s->lastEmitter : emitter;
    }
    vplFree(g->context, all.chunks);
    g->emits = g->emittingTriangles > 0;
    g->meanReflectance = g->area > 0 ? reflecting / g->area : 0;
    findBounds(g);
    return VPL_SUCCESS;
}

// Positions in float lose what is small beside their distance from (0, 0, 0).
static void warnOfDistance(const vplGeometry* g)
{
    const float farthest = vplGeometry_LargestCoordinate(g);
    const float size = vplGeometry_Diagonal(g);
    if (farthest > 4096 * size && size > 0) {
        vplLog(g->context, VPL_LOG_WARNING,
               "the scene is %g m large and %g m from (0, 0, 0): positions are off by up to %.2g m. Nearer "
               "vertices, or vplScene_SetOrigin, keep them exact",
               (double)size, (double)farthest, (double)farthest * 0x1p-24);
    }
}

static vplResult build(const vplScene* scene, vplGeometry* g)
{
    vplGeometryBuilder builder = {.scene = scene};
    g->scene = scene->identity;
    vplScene_GetOrigin(scene, g->origin);
    TRY(allocate(scene, g, &builder));
    TRY(fill(g, &builder));
    TRY(vplBuildPaint(scene, g, builder.objects));
    TRY(vplSummarise(g));
    TRY(vplMarkCoplanar(g, builder.objects));
    TRY(vplBuildCutOuts(g));
    warnOfDistance(g);
    return vplEnvironment_Create(scene, &g->environment);
}

// Frees what is not in the arena.
static void release(const vplGeometry* g)
{
    vplBvh_Destroy(g->rayTree);
    vplPaint_Destroy(g->paint);
    vplEnvironment_Destroy(g->environment);
    vplCutOuts_Destroy(g->cutOuts);
}

vplResult vplGeometry_CreateForRaster(const vplScene* scene, vplGeometry** geometryOut)
{
    REQUIRE(vplScene_GetContext(scene), scene, geometryOut);
    vplArena* arena = vplArena_Create(scene->context);
    vplGeometry* g = vplArena_AllocZero(arena, 1, sizeof *g);
    vplResult result = vplArena_Check(arena);
    if (result == VPL_SUCCESS) {
        g->context = scene->context;
        g->arena = arena;
        result = build(scene, g);
        if (result != VPL_SUCCESS) {
            release(g);
        }
    }
    return vplArena_Deliver(arena, result, g, geometryOut);
}

vplResult vplGeometry_BuildTree(vplGeometry* g, bool quick)
{
    return g->rayTree != NULL ? VPL_SUCCESS : vplBvh_Create(g, VPL_BRUTE_BLOCKS, quick, &g->rayTree);
}

vplResult vplGeometry_BuildRayTree(vplGeometry* geometry)
{
    REQUIRE(CONTEXT_OF(geometry), geometry);
    return vplGeometry_BuildTree(geometry, false);
}

vplResult vplGeometry_Create(const vplScene* scene, vplGeometry** geometryOut)
{
    REQUIRE(vplScene_GetContext(scene), scene, geometryOut);
    vplGeometry* g;
    TRY(vplGeometry_CreateForRaster(scene, &g));
    const vplResult result = vplGeometry_BuildRayTree(g);
    if (result != VPL_SUCCESS) {
        vplGeometry_Destroy(g);
        return result;
    }
    *geometryOut = g;
    return VPL_SUCCESS;
}

void vplGeometry_Destroy(vplGeometry* geometry)
{
    if (geometry != NULL) {
        release(geometry);
        vplArena_Destroy(geometry->arena);
    }
}

double vplGeometry_Area(const vplGeometry* geometry)
{
    if (geometry == NULL) {
        return 0;
    }
    return geometry->area;
}

double vplGeometry_MeanReflectance(const vplGeometry* geometry)
{
    if (geometry == NULL) {
        return 0;
    }
    return geometry->meanReflectance;
}

float vplGeometry_Diagonal(const vplGeometry* geometry)
{
    if (geometry == NULL) {
        return 0;
    }
    return vplLength(vplSub(geometry->boundsMax, geometry->boundsMin));
}
