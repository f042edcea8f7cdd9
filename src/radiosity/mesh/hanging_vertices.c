// SPDX-License-Identifier: MIT
// Hanging vertices, which lie on edges of other patches, and the cuts that make them corners on both sides.
// Based on: Baum, Mann, Smith and Winget, Making Radiosity Usable: Automatic Preprocessing and Meshing
// Techniques for the Generation of Accurate Radiosity Solutions, SIGGRAPH 1991, section 4 (T-vertices).
// Departs: they keep a tree of edges during subdivision. Here bisection puts hanging vertices at midpoints
// only, and a midpoint has the same bits from both sides, so a hash table of positions finds them. Where other
// surfaces cut patches, vertices are anywhere on edges (edge_vertices.c).
#include "math/vec.h"
#include "radiosity/mesh/patch_mesh.h"

#include <string.h>

enum { MOST_PIECES = VPL_MAX_TRIANGLES / 3 }; // corners are counted in int, too

typedef struct Cutter {
    const vplPatches* patches;
    vplArena* arena; // owns the pieces
    vplPieces* out;
    int* table; // a hash table of indices of positions, -1: empty
    size_t tableMask;
    vplEdgeVertices* onEdges; // NULL: hanging vertices are at midpoints
    uint8_t* hangs;           // per position: some edge was cut there
} Cutter;

// ---- the table of positions

// -0 and 0 are equal positions.
static size_t slotOf(const Cutter* c, vplVec3 p)
{
    const vplVec3 key = {p.x + 0.0f, p.y + 0.0f, p.z + 0.0f};
    uint32_t bits[3];
    memcpy(bits, &key, sizeof bits);
    uint64_t h = bits[0] * UINT64_C(0x9E3779B97F4A7C15);
    h = (h ^ (h >> 32) ^ bits[1]) * UINT64_C(0xBF58476D1CE4E5B9);
    h = (h ^ (h >> 32) ^ bits[2]) * UINT64_C(0x94D049BB133111EB);
    return (size_t)(h ^ (h >> 32)) & c->tableMask;
}

static bool sameVec(vplVec3 a, vplVec3 b)
{
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

// The index of a position, -1 where there is none.
static int findPosition(const Cutter* c, vplVec3 p)
{
    for (size_t slot = slotOf(c, p);; slot = (slot + 1) & c->tableMask) {
        const int index = c->table[slot];
        if (index < 0 || sameVec(c->patches->positions[index], p)) {
            return index;
        }
    }
}

// Enters the corners of patches only, and so none of a triangle without area. Those of groups are left out: large patches
// beside them stay whole.
static void fillTable(Cutter* c)
{
    memset(c->table, 0xff, (c->tableMask + 1) * sizeof *c->table);
    for (int i = 0; i < 3 * (c->patches->patchCount - c->patches->groupCount); i++) {
        const uint32_t corner = c->patches->nodes[c->patches->patches[i / 3]].corners[i % 3];
        size_t slot = slotOf(c, c->patches->positions[corner]);
        while (c->table[slot] >= 0 && c->table[slot] != (int)corner) {
            slot = (slot + 1) & c->tableMask;
        }
        c->table[slot] = (int)corner;
    }
}

// ---- cuts

static double lengthSquared(const Cutter* c, uint32_t a, uint32_t b)
{
    const vplVec3 p = c->patches->positions[a], q = c->patches->positions[b];
    const double x = (double)p.x - q.x, y = (double)p.y - q.y, z = (double)p.z - q.z;
    return x * x + y * y + z * z;
}

// The vertex at the midpoint of an edge, -1 if there is none.
static int middleOf(const Cutter* c, uint32_t a, uint32_t b)
{
    const vplVec3 p = c->patches->positions[a], q = c->patches->positions[b];
    const int middle = findPosition(c, vplAdd(vplScale(0.5f, p), vplScale(0.5f, q))); // as in bisection
    // The midpoint of neighbouring floats is one of them.
    return middle == (int)a || middle == (int)b ? -1 : middle;
}

// A vertex on an edge, near its middle; -1 if there is none.
static int vertexOn(const Cutter* c, uint32_t a, uint32_t b)
{
    return c->onEdges != NULL ? vplEdgeVertices_Find(c->onEdges, a, b) : middleOf(c, a, b);
}

// The longest edge of a piece that has a vertex on it; -1: none has.
static int edgeToCut(const Cutter* c, const vplPiece* piece, int* middleOut)
{
    int best = -1;
    double longest = -1;
    for (int k = 0; k < 3; k++) {
        const uint32_t a = piece->corners[k], b = piece->corners[(k + 1) % 3];
        const int middle = piece->edges >> k & 1 ? vertexOn(c, a, b) : -1;
        const double length = lengthSquared(c, a, b);
        if (middle >= 0 && length > longest) {
            best = k;
            longest = length;
            *middleOut = middle;
        }
    }
    return best;
}

static vplResult append(const Cutter* c, const vplPiece* piece)
{
    vplPieces* out = c->out;
    if (out->count == MOST_PIECES) {
        return vplFail(c->patches->context, VPL_LIMIT, "patches have more than %d pieces", MOST_PIECES);
    }
    TRY(vplArena_Reserve(c->arena, &out->pieces, &out->capacity, out->count + 1, sizeof *piece));
    out->pieces[out->count++] = *piece;
    return VPL_SUCCESS;
}

// Cuts from a vertex on an edge to the opposite corner. Each cut divides a triangle, so that no piece is
// without area, unlike in a fan around one corner. The recursion ends because edges get shorter; the new edge
// belongs to no other patch and is never cut.
static vplResult cut(Cutter* c, const vplPiece* piece)
{
    int middle = -1;
    const int k = edgeToCut(c, piece, &middle);
    if (k < 0) {
        return append(c, piece);
    }
    c->out->hanging += !c->hangs[middle];
    c->hangs[middle] = 1;
    const uint32_t a = piece->corners[k], b = piece->corners[(k + 1) % 3], tip = piece->corners[(k + 2) % 3];
    const uint8_t next = piece->edges >> (k + 1) % 3 & 1, last = piece->edges >> (k + 2) % 3 & 1;
    const vplPiece first = {{tip, a, (uint32_t)middle}, piece->patch, piece->triangle, (uint8_t)(last | 2)};
    const vplPiece second = {
        {tip, (uint32_t)middle, b}, piece->patch, piece->triangle, (uint8_t)(2 | next << 2)};
    TRY(cut(c, &first));
    return cut(c, &second);
}

vplResult vplCutPatches(vplArena* scratch, const vplPatches* patches, vplPieces* out)
{
    *out = (vplPieces){.count = 0};
    const size_t positions = (size_t)patches->positionCount;
    vplEdgeVertices onEdges;
    Cutter c = {.patches = patches, .arena = scratch, .out = out, .tableMask = 1};
    while (c.tableMask < 2 * positions) {
        c.tableMask = 2 * c.tableMask + 1;
    }
    c.table = vplArena_Alloc(scratch, c.tableMask + 1, sizeof *c.table);
    c.hangs = vplArena_AllocZero(scratch, positions, 1);
    TRY(vplArena_Check(scratch));
    TRY(vplArena_Reserve(scratch, &out->pieces, &out->capacity, (size_t)patches->patchCount,
                         sizeof *out->pieces));
    if (patches->cuts != NULL) {
        TRY(vplEdgeVertices_Create(scratch, patches, &onEdges));
        c.onEdges = &onEdges;
    } else {
        fillTable(&c);
    }
    for (int i = 0; i < patches->patchCount; i++) {
        const vplPatchParts parts = vplPatches_GetParts(patches, i);
        for (int k = 0; k < parts.count; k++) {
            const vplPatchNode* node = &patches->nodes[parts.nodes[k]];
            vplPiece whole = {.patch = i, .triangle = node->triangle, .edges = 7};
            memcpy(whole.corners, node->corners, sizeof whole.corners);
            TRY(parts.count > 1 && c.onEdges != NULL ? append(&c, &whole) : cut(&c, &whole));
        }
    }
    return VPL_SUCCESS;
}
