// SPDX-License-Identifier: MIT
// Vertices that lie on other patches' edges, and the cuts that make them corners on both sides.
// Based on: Baum, Mann, Smith and Winget, Making Radiosity Usable: Automatic Preprocessing and Meshing Techniques for
// the Generation of Accurate Radiosity Solutions, SIGGRAPH 1991, section 4 (T-vertices).
// Departs: they find such vertices in a tree of edges that is kept during subdivision. Bisection puts them in the
// middles of edges only, and middles are the same bits from both sides, so a table of positions answers the same.
#include "base/context.h"
#include "math/vec.h"
#include "radiosity/mesh.h"

#include <string.h>

enum { MOST_PIECES = VPL_MAX_TRIANGLES / 3 }; // corners are counted in int, too

typedef struct Cutter {
    const vplPatches* patches;
    vplPieces* out;
    int* table; // indices of positions by place, -1: empty
    size_t tableMask;
    uint8_t* hangs; // per position
    vplResult result;
} Cutter;

// ---- the table of positions

// -0 and 0 are one place.
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

// Corners of patches only: a scene's triangle without area has none.
static void fillTable(Cutter* c)
{
    memset(c->table, 0xff, (c->tableMask + 1) * sizeof *c->table);
    for (int i = 0; i < 3 * c->patches->patchCount; i++) {
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

// The vertex in the middle of an edge, -1 where there is none.
static int middleOf(const Cutter* c, uint32_t a, uint32_t b)
{
    const vplVec3 p = c->patches->positions[a], q = c->patches->positions[b];
    const int middle = findPosition(c, vplAdd(vplScale(0.5f, p), vplScale(0.5f, q))); // as bisection has it
    // Between neighbouring floats the middle is one of them.
    return middle == (int)a || middle == (int)b ? -1 : middle;
}

// The longest edge of a piece that has a vertex in its middle; -1: none has.
static int edgeToCut(const Cutter* c, const vplPiece* piece, int* middleOut)
{
    int best = -1;
    double longest = -1;
    for (int k = 0; k < 3; k++) {
        const uint32_t a = piece->corners[k], b = piece->corners[(k + 1) % 3];
        const int middle = piece->edges >> k & 1 ? middleOf(c, a, b) : -1;
        const double length = lengthSquared(c, a, b);
        if (middle >= 0 && length > longest) {
            best = k;
            longest = length;
            *middleOut = middle;
        }
    }
    return best;
}

static void append(Cutter* c, const vplPiece* piece)
{
    vplPieces* out = c->out;
    if (c->result == VPL_SUCCESS && out->count == MOST_PIECES) {
        c->result = vplFail(out->context, VPL_LIMIT, "patches have more than %d pieces", MOST_PIECES);
    }
    if (c->result == VPL_SUCCESS) {
        c->result = vplReserve(out->context, &out->pieces, &out->capacity, out->count + 1, sizeof *piece);
    }
    if (c->result == VPL_SUCCESS) {
        out->pieces[out->count++] = *piece;
    }
}

// From the corner opposite to it to the middle of an edge: each cut halves a triangle, so none is without area, where a
// fan about one corner may join three vertices of one edge. Ends because edges get shorter; the new edge is in no other
// patch and is not cut.
static void cut(Cutter* c, const vplPiece* piece)
{
    int middle = -1;
    const int k = edgeToCut(c, piece, &middle);
    if (k < 0) {
        append(c, piece);
        return;
    }
    c->out->hanging += !c->hangs[middle];
    c->hangs[middle] = 1;
    const uint32_t a = piece->corners[k], b = piece->corners[(k + 1) % 3], tip = piece->corners[(k + 2) % 3];
    const uint8_t next = piece->edges >> (k + 1) % 3 & 1, last = piece->edges >> (k + 2) % 3 & 1;
    const vplPiece first = {{tip, a, (uint32_t)middle}, piece->patch, (uint8_t)(last | 2)};
    const vplPiece second = {{tip, (uint32_t)middle, b}, piece->patch, (uint8_t)(2 | next << 2)};
    cut(c, &first);
    cut(c, &second);
}

vplResult vplCutPatches(const vplPatches* patches, vplPieces* pieces)
{
    vplContext* context = pieces->context;
    const size_t positions = (size_t)patches->positionCount;
    Cutter c = {.patches = patches, .out = pieces, .tableMask = 1};
    while (c.tableMask < 2 * positions) {
        c.tableMask = 2 * c.tableMask + 1;
    }
    c.table = vplAlloc(context, c.tableMask + 1, sizeof *c.table);
    c.hangs = c.table ? vplAllocZero(context, positions, 1) : NULL;
    c.result = c.hangs ? vplReserve(context, &pieces->pieces, &pieces->capacity, (size_t)patches->patchCount,
                                    sizeof *pieces->pieces)
                       : VPL_OUT_OF_MEMORY;
    if (c.result == VPL_SUCCESS) {
        fillTable(&c);
    }
    for (int i = 0; i < patches->patchCount && c.result == VPL_SUCCESS; i++) {
        vplPiece whole = {.patch = i, .edges = 7};
        memcpy(whole.corners, patches->nodes[patches->patches[i]].corners, sizeof whole.corners);
        cut(&c, &whole);
    }
    vplFree(context, c.table);
    vplFree(context, c.hangs);
    return c.result;
}
