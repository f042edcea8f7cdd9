// SPDX-License-Identifier: MIT
// Sorts corners of pieces by position, and finds which of those at one position belong to one surface.
#include "geometry/patch_cuts.h"
#include "math/double3.h"
#include "math/scalar.h"
#include "math/vec.h"
#include "radiosity/mesh/patch_mesh.h"

#include <string.h>

// The cosine of 20 degrees: the sides of a cylinder with 18 or more are one surface, the walls of a room are
// not.
static const float SAME_SURFACE = 0.9396926f;

enum { CHUNK = 1024 }; // positions per task

// ---- one corner

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

// The angle between two edges, by their cross product, which unlike the cosine is precise near 0 and pi.
// Never 0, so that the thinnest patch counts where there is no other.
static float angleAt(const vplVec3* positions, const vplPiece* piece, int corner)
{
    const vplVec3 p = positions[piece->corners[corner]];
    const vplVec3 a = vplNormalize(vplSub(positions[piece->corners[(corner + 1) % 3]], p));
    const vplVec3 b = vplNormalize(vplSub(positions[piece->corners[(corner + 2) % 3]], p));
    return fmaxf((float)vplAtan2((double)vplLength(vplCross(a, b)), (double)vplDot(a, b)), 1e-6f);
}

// The triangle of the scene that a corner belongs to.
static int triangleOf(const vplMeshCorners* b, size_t i)
{
    return vplMeshCorners_Piece(b, i)->triangle;
}

// A counting sort, which keeps the order of pieces at each position.
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
    memmove(b->first + 1, b->first,
            positions * sizeof *b->first); // each had advanced to the start of the next
    b->first[0] = 0;
}

// ---- surfaces

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

// ---- what stands on an edge

// Coordinates of a point along and across a cut.
static void locate(const vplPatchCut* cut, vplVec3 point, double* along, double* across)
{
    double a[3], b[3], p[3];
    vplToDouble3(cut->ends[0], a);
    vplToDouble3(cut->ends[1], b);
    vplToDouble3(point, p);
    for (int k = 0; k < 3; k++) {
        b[k] -= a[k];
        p[k] -= a[k];
    }
    const double length = sqrt(vplDot3(b, b));
    *along = vplDot3(p, b) / length;
    *across = sqrt(fmax(vplDot3(p, p) - *along * *along, 0));
}

// Tests whether a part of the edge pq lies on a cut.
static bool liesOn(const vplPatchCut* cut, vplVec3 p, vplVec3 q, double tolerance)
{
    double x[2], y[2], end, offEnd;
    locate(cut, p, &x[0], &y[0]);
    locate(cut, q, &x[1], &y[1]);
    locate(cut, cut->ends[1], &end, &offEnd);
    const double from = fmax(fmin(x[0], x[1]), 0), to = fmin(fmax(x[0], x[1]), end);
    return fmax(y[0], y[1]) <= 2 * tolerance && to - from > 2 * tolerance;
}

// The corner of the piece that is at the other end of an edge of corner i. edge: 0: that from it; 1: that to it.
static uint32_t otherEnd(const vplMeshCorners* b, size_t i, int edge)
{
    return vplMeshCorners_Piece(b, i)->corners[(b->at[i] % 3 + (edge == 0 ? 1 : 2)) % 3];
}

static uint8_t findBlocked(const vplMeshCorners* b, size_t i)
{
    const vplPatches* patches = b->patches;
    const int triangle = triangleOf(b, i);
    const vplVec3 at = patches->positions[vplMeshCorners_Piece(b, i)->corners[b->at[i] % 3]];
    unsigned blocked = 0;
    for (int c = patches->firstCut[triangle]; c < patches->firstCut[triangle + 1]; c++) {
        for (int edge = 0; edge < 2; edge++) {
            const vplPatchCut* cut = &patches->cuts[c];
            const vplVec3 other = patches->positions[otherEnd(b, i, edge)];
            if (cut->faces != 0 && liesOn(cut, at, other, b->tolerance)) {
                blocked |= (unsigned)cut->faces << 2 * edge;
            }
        }
    }
    return (uint8_t)blocked;
}

// Tests whether light on a face of corner i's piece continues to that of corner j: they share an edge on which nothing
// stands.
static bool continues(const vplMeshCorners* b, int face, size_t i, size_t j)
{
    for (int k = 0; k < 4 && b->blocked != NULL; k++) {
        const int one = k & 1, other = k >> 1;
        if (otherEnd(b, i, one) == otherEnd(b, j, other)) {
            return !(b->blocked[i] >> (2 * one + face) & 1) && !(b->blocked[j] >> (2 * other + face) & 1);
        }
    }
    return b->blocked == NULL;
}

// ---- groups

static int rootOf(const int* group, size_t i)
{
    while (group[i] != (int)i) {
        i = (size_t)group[i];
    }
    return (int)i;
}

// Groups the corners at one position, transitively, so that the order of triangles does not matter. A group
// is named by its first corner. Quadratic in the number of corners, of which most positions have 6.
static void groupCorners(vplMeshCorners* b, int face, size_t first, size_t end)
{
    int* group = b->group[face];
    for (size_t i = first; i < end; i++) {
        group[i] = (int)i;
        for (size_t j = first; j < i; j++) {
            const int one = rootOf(group, i), other = rootOf(group, j);
            if (one != other && isOneSurface(b, i, j) && continues(b, face, i, j)) {
                group[vplMaxi(one, other)] = vplMini(one, other);
            }
        }
    }
    for (size_t i = first; i < end; i++) {
        group[i] = rootOf(group, i);
    }
}

static void findLeaders(vplMeshCorners* b, size_t first, size_t end)
{
    for (size_t i = first; i < end; i++) {
        size_t j = first;
        while (b->group[0][j] != b->group[0][i] || b->group[1][j] != b->group[1][i]) {
            j++;
        }
        b->leader[i] = (int)j;
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
            if (b->blocked != NULL) {
                b->blocked[i] = findBlocked(b, i);
            }
            b->normals[i] = normalAt(b->patches->geometry, triangleOf(b, i), b->patches->positions[p]);
        }
        for (int face = 0; face < (b->blocked != NULL ? 2 : 1); face++) {
            groupCorners(b, face, b->first[p], b->first[p + 1]);
        }
        findLeaders(b, b->first[p], b->first[p + 1]);
    }
}

vplResult vplMeshCorners_Find(vplArena* scratch, const vplPatches* patches, const vplPieces* pieces,
                              vplMeshCorners* b)
{
    *b = (vplMeshCorners){.patches = patches, .pieces = pieces, .count = 3 * pieces->count};
    b->tolerance = vplCutTolerance(patches->geometry);
    b->first = vplArena_AllocZero(scratch, (size_t)patches->positionCount + 1, sizeof *b->first);
    b->at = vplArena_Alloc(scratch, b->count, sizeof *b->at);
    b->group[0] = b->group[1] = vplArena_Alloc(scratch, b->count, sizeof *b->leader);
    b->leader = vplArena_Alloc(scratch, b->count, sizeof *b->leader);
    if (patches->cuts != NULL) {
        b->group[1] = vplArena_Alloc(scratch, b->count, sizeof *b->leader);
        b->blocked = vplArena_Alloc(scratch, b->count, sizeof *b->blocked);
    }
    b->normals = vplArena_Alloc(scratch, b->count, sizeof *b->normals);
    b->angles = vplArena_Alloc(scratch, b->count, sizeof *b->angles);
    TRY(vplArena_Check(scratch));
    sortCorners(b);
    return vplParallelForAsking(patches->context, (patches->positionCount + CHUNK - 1) / CHUNK, groupChunk,
                                b);
}
