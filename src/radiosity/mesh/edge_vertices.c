// SPDX-License-Identifier: MIT
// Finds vertices on edges of patches that other surfaces cut: cuts of neighbours end anywhere on an edge.
#include "geometry/patch_cuts.h"
#include "math/double3.h"
#include "radiosity/mesh/patch_mesh.h"

#include <math.h>

// Cells are so many times as large as a patch of mean area.
static const double CELL = 1.5;

vplResult vplEdgeVertices_Create(vplArena* scratch, const vplPatches* patches, vplEdgeVertices* out)
{
    double area = 0;
    for (int i = 0; i < patches->patchCount; i++) {
        area += vplPatches_Area(patches, i);
    }
    *out = (vplEdgeVertices){.patches = patches, .tolerance = vplCutTolerance(patches->geometry)};
    const double size = fmax(CELL * sqrt(area / fmax(patches->patchCount, 1)), 4 * out->tolerance);
    TRY(vplPointCells_Create(scratch, patches->positions, (size_t)patches->positionCount, size, &out->cells));
    uint8_t* used = vplArena_AllocZero(scratch, (size_t)patches->positionCount, 1);
    TRY(vplArena_Check(scratch));
    for (int i = 0; i < 3 * (patches->patchCount - patches->groupCount); i++) {
        const uint32_t corner = patches->nodes[patches->patches[i / 3]].corners[i % 3];
        if (!used[corner]) {
            used[corner] = 1;
            vplPointCells_Add(&out->cells, (int)corner);
        }
    }
    return VPL_SUCCESS;
}

typedef struct Edge {
    double start[3], along[3]; // unit
    double length;
    uint32_t ends[2];
    int best;
    double bestOff; // its distance from the middle
} Edge;

// Keeps a vertex if it lies on the edge, off its ends, and nearer to its middle than others do.
static void consider(const vplEdgeVertices* v, Edge* edge, int vertex)
{
    double p[3], square = 0;
    vplToDouble3(v->patches->positions[vertex], p);
    for (int k = 0; k < 3; k++) {
        p[k] -= edge->start[k];
        square += p[k] * p[k];
    }
    const double x = vplDot3(p, edge->along), off = fabs(x - 0.5 * edge->length), apart = 2 * v->tolerance;
    const bool inside = x > apart && x < edge->length - apart;
    if (inside && square - x * x <= v->tolerance * v->tolerance && (uint32_t)vertex != edge->ends[0] &&
        (uint32_t)vertex != edge->ends[1] &&
        (off < edge->bestOff || (off == edge->bestOff && vertex < edge->best))) {
        edge->best = vertex;
        edge->bestOff = off;
    }
}

// Considers the vertices in all cells that the box around a part of the edge reaches.
static void searchPart(const vplEdgeVertices* v, Edge* edge, double from, double to)
{
    double low[3], high[3];
    for (int k = 0; k < 3; k++) {
        const double a = edge->start[k] + from * edge->along[k], b = edge->start[k] + to * edge->along[k];
        low[k] = fmin(a, b) - v->tolerance;
        high[k] = fmax(a, b) + v->tolerance;
    }
    const vplCell first = vplPointCells_At(&v->cells, low), last = vplPointCells_At(&v->cells, high);
    vplCell cell;
    for (cell.at[0] = first.at[0]; cell.at[0] <= last.at[0]; cell.at[0]++) {
        for (cell.at[1] = first.at[1]; cell.at[1] <= last.at[1]; cell.at[1]++) {
            for (cell.at[2] = first.at[2]; cell.at[2] <= last.at[2]; cell.at[2]++) {
                for (int i = vplPointCells_First(&v->cells, &cell); i >= 0; i = v->cells.next[i]) {
                    consider(v, edge, i);
                }
            }
        }
    }
}

int vplEdgeVertices_Find(const vplEdgeVertices* v, uint32_t a, uint32_t b)
{
    Edge edge = {.ends = {a, b}, .best = -1, .bestOff = INFINITY};
    double end[3];
    vplToDouble3(v->patches->positions[a], edge.start);
    vplToDouble3(v->patches->positions[b], end);
    for (int k = 0; k < 3; k++) {
        edge.along[k] = end[k] - edge.start[k];
    }
    edge.length = sqrt(vplDot3(edge.along, edge.along));
    for (int k = 0; k < 3; k++) {
        edge.along[k] /= edge.length;
    }
    // An edge without length has no inside: no part is searched.
    const int parts = edge.length > 4 * v->tolerance ? 1 + (int)(edge.length / v->cells.size) : 0;
    for (int i = 0; i < parts; i++) {
        searchPart(v, &edge, edge.length * i / parts, edge.length * (i + 1) / parts);
    }
    return edge.best;
}
