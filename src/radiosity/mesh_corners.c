// SPDX-License-Identifier: MIT
// Corners of pieces by the place where they lie, and which of those at one place belong to one surface.
#include "base/context.h"
#include "geometry/triangle.h"
#include "math/scalar.h"
#include "math/vec.h"
#include "radiosity/mesh.h"

#include <string.h>

// Cosine of 20 degrees: the sides of a cylinder of 18 and more are one surface, the walls of a room are not.
static const float SAME_SURFACE = 0.9396926f;

enum { CHUNK = 1024 }; // positions per task

// ---- what is known of one corner

static vplVec3 interpolate(const vplVec3 n[3], double u, double v)
{
    return vplVec((float)((1 - u - v) * n[0].x + u * n[1].x + v * n[2].x),
                  (float)((1 - u - v) * n[0].y + u * n[1].y + v * n[2].y),
                  (float)((1 - u - v) * n[0].z + u * n[1].z + v * n[2].z));
}

// The normal of the surface at a point of a triangle.
static vplVec3 normalAt(const vplGeometry* g, int triangle, vplVec3 point)
{
    const vplGeometryObject* object = &g->objects[g->owners[triangle]];
    if (!object->smooth || g->shadingNormals == NULL) {
        return g->normals[triangle];
    }
    vplVec3 n[3];
    float u, v;
    for (int k = 0; k < 3; k++) {
        n[k] = g->shadingNormals[object->firstVertex + (int)g->indices[3 * (size_t)triangle + (size_t)k]];
    }
    vplGeometry_InsideAt(g, triangle, point, &u, &v);
    const vplVec3 smooth = vplNormalize(interpolate(n, (double)u, (double)v));
    return vplDot(smooth, smooth) > 0 ? smooth : g->normals[triangle];
}

// The angle between two edges, by their cross product: exact near 0 and pi, where a cosine is not.
static float angleAt(const vplVec3* positions, const vplPiece* piece, int corner)
{
    const vplVec3 p = positions[piece->corners[corner]];
    const vplVec3 a = vplNormalize(vplSub(positions[piece->corners[(corner + 1) % 3]], p));
    const vplVec3 b = vplNormalize(vplSub(positions[piece->corners[(corner + 2) % 3]], p));
    // Never 0: the thinnest patch counts where there is no other.
    return fmaxf((float)vplAtan2((double)vplLength(vplCross(a, b)), (double)vplDot(a, b)), 1e-6f);
}

// The scene's.
static int triangleOf(const vplMeshCorners* b, size_t i)
{
    return vplPatches_TriangleOf(b->patches, vplMeshCorners_Piece(b, i)->patch);
}

// Counting sort: the corners of one position in the order of pieces.
static void sortCorners(vplMeshCorners* b)
{
    const size_t positions = (size_t)b->patches->positionCount;
    for (size_t i = 0; i < b->count; i++) {
        b->first[b->pieces->pieces[i / 3].corners[i % 3]]++;
    }
    size_t start = 0;
    for (size_t p = 0; p <= positions; p++) {
        const size_t count = b->first[p];
        b->first[p] = start;
        start += count;
    }
    for (size_t i = 0; i < b->count; i++) {
        b->at[b->first[b->pieces->pieces[i / 3].corners[i % 3]]++] = (uint32_t)i;
    }
    memmove(b->first + 1, b->first, positions * sizeof *b->first); // each had moved to the start of the next
    b->first[0] = 0;
}

// ---- surfaces that go on

static bool isOneSurface(const vplMeshCorners* b, size_t i, size_t j)
{
    const vplGeometry* g = b->patches->geometry;
    const int t = triangleOf(b, i), s = triangleOf(b, j);
    if (vplDot(g->normals[t], g->normals[s]) >= SAME_SURFACE) {
        return true;
    }
    return g->owners[t] == g->owners[s] && g->objects[g->owners[t]].smooth &&
           vplDot(b->normals[i], b->normals[j]) >= SAME_SURFACE;
}

static int rootOf(const int* group, size_t i)
{
    while (group[i] != (int)i) {
        i = (size_t)group[i];
    }
    return (int)i;
}

// Surfaces that go on into one that goes on into a third are one with that, so that no order of triangles matters. A
// set is named by its first. In the square of the corners at a place, of which there are 6 in most.
static void groupCorners(vplMeshCorners* b, size_t first, size_t end)
{
    for (size_t i = first; i < end; i++) {
        b->group[i] = (int)i;
        for (size_t j = first; j < i; j++) {
            const int one = rootOf(b->group, i), other = rootOf(b->group, j);
            if (one != other && isOneSurface(b, i, j)) {
                b->group[vplMaxi(one, other)] = vplMini(one, other);
            }
        }
    }
    for (size_t i = first; i < end; i++) {
        b->group[i] = rootOf(b->group, i);
    }
}

static void groupChunk(void* data, int chunk, int worker)
{
    (void)worker;
    vplMeshCorners* b = data;
    const int end = vplMini((chunk + 1) * CHUNK, b->patches->positionCount);
    for (int p = chunk * CHUNK; p < end; p++) {
        for (size_t i = b->first[p]; i < b->first[p + 1]; i++) {
            const vplPiece* piece = vplMeshCorners_Piece(b, i);
            b->angles[i] = angleAt(b->patches->positions, piece, (int)(b->at[i] % 3));
            b->normals[i] = normalAt(b->patches->geometry, triangleOf(b, i), b->patches->positions[p]);
        }
        groupCorners(b, b->first[p], b->first[p + 1]);
    }
}

vplResult vplMeshCorners_Create(const vplPatches* patches, const vplPieces* pieces, vplMeshCorners* b)
{
    vplContext* context = pieces->context;
    *b = (vplMeshCorners){.patches = patches, .pieces = pieces, .count = 3 * pieces->count};
    b->first = vplAllocZero(context, (size_t)patches->positionCount + 1, sizeof *b->first);
    b->at = b->first ? vplAlloc(context, b->count, sizeof *b->at) : NULL;
    b->group = b->at ? vplAlloc(context, b->count, sizeof *b->group) : NULL;
    b->normals = b->group ? vplAlloc(context, b->count, sizeof *b->normals) : NULL;
    b->angles = b->normals ? vplAlloc(context, b->count, sizeof *b->angles) : NULL;
    if (b->angles == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    sortCorners(b);
    vplParallelFor(context, (patches->positionCount + CHUNK - 1) / CHUNK, groupChunk, b);
    return VPL_SUCCESS;
}

void vplMeshCorners_Release(vplMeshCorners* b)
{
    vplContext* context = b->pieces->context;
    vplFree(context, b->first);
    vplFree(context, b->at);
    vplFree(context, b->group);
    vplFree(context, b->normals);
    vplFree(context, b->angles);
}
