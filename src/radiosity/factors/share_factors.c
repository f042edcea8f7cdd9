// SPDX-License-Identifier: MIT
// Form factors of a team: each pair of sides is computed once, by any member, and sent to the two that hold its rows. Blocks
// of sides are taken in rounds, so that only the strips of one round are in memory with their zeros. Since each round has the
// next columns, rows are only ever appended to.
#include "math/scalar.h"
#include "radiosity/factors/form_factors.h"

#include <string.h>

enum {
    LANES = VPL_SHARED_LANES,
    OWN_BLOCKS = VPL_STRIPS_PER_ROUND,
    SPAN = 64 // columns of a task, in blocks
};

typedef struct Round {
    vplFactorWork* work;
    vplSharedRows* rows;
    vplPairWork pairs;
    vplFactorStrip strips[OWN_BLOCKS];
    int spans; // tasks of a block
    int round;
    vplTeamMail mail;
    const uint8_t** masks; // of each member's message: the next mask, and the next factor
    const uint8_t** values;
} Round;

static int ownBlock(const Round* r, int k)
{
    return (r->round * OWN_BLOCKS + k) * r->rows->members + r->rows->member;
}

// ---- computing

static void fillSpan(void* data, int task, int worker)
{
    Round* r = data;
    const int k = task / r->spans, block = ownBlock(r, k), first = task % r->spans * SPAN;
    const int end = vplMini(first + SPAN, r->rows->blocks);
    if (block < end) {
        vplPairWork_Fill(&r->pairs, task, worker, block, vplMaxi(block, first), end, &r->strips[k]);
    }
}

static vplResult computeStrips(Round* r)
{
    const vplFormFactorDef* def = &r->work->def;
    const size_t bytes = vplSharedRows_Columns(r->rows) * LANES * sizeof(float);
    // The first rounds have the longest strips.
    const double left = 1 - (double)r->round / r->rows->rounds, after = left - 1.0 / r->rows->rounds;
    for (int k = 0; k < OWN_BLOCKS; k++) {
        memset(r->strips[k].there, 0, bytes);
        memset(r->strips[k].back, 0, bytes);
    }
    return vplParallelForProgress(
        r->work->context, OWN_BLOCKS * r->spans, fillSpan, r,
        (vplProgressRange){def->progress, def->progressUser, 1 - left * left, 1 - after * after});
}

// ---- sending
//
// A message has the number of its masks, the masks, and the factors that these count: for each row of its receiver the
// sender's blocks of columns of this round, and from the row's own block on all columns.

// The part of a row that a block's strip has.
typedef struct Piece {
    const float* values;
    int count; // of blocks of columns; 0: none
} Piece;

static Piece pieceOf(const Round* r, int row, int k)
{
    const int block = ownBlock(r, k), of = row / LANES;
    const size_t columns = vplSharedRows_Columns(r->rows), lane = (size_t)(row % LANES);
    if (block > of) {
        return (Piece){NULL, 0};
    }
    return block < of ? (Piece){r->strips[k].back + (size_t)row * LANES, 1}
                      : (Piece){r->strips[k].there + lane * columns + (size_t)block * LANES,
                                r->rows->blocks - block};
}

static uint16_t maskOf(const float* values)
{
    uint32_t mask = 0;
    for (int l = 0; l < LANES; l++) {
        mask |= (uint32_t)(values[l] != 0) << l;
    }
    return (uint16_t)mask;
}

static uint32_t countMasks(const Round* r, int first, int member)
{
    uint32_t count = 0;
    for (int row = vplTeam_FirstRow(first, member, r->rows->members); row < r->rows->count;
         row += r->rows->members) {
        for (int k = 0; k < OWN_BLOCKS; k++) {
            count += (uint32_t)pieceOf(r, row, k).count;
        }
    }
    return count;
}

static size_t headBytes(uint32_t masks)
{
    return sizeof masks + ((size_t)masks + masks % 2) * sizeof(uint16_t);
}

// Writes the message to a member; returns its size.
static size_t writeMessage(const Round* r, int first, int member, uint8_t* to)
{
    const uint32_t masks = countMasks(r, first, member);
    uint16_t* mask = (uint16_t*)(void*)(to + sizeof masks);
    float* value = (float*)(void*)(to + headBytes(masks));
    memcpy(to, &masks, sizeof masks);
    for (int row = vplTeam_FirstRow(first, member, r->rows->members); row < r->rows->count;
         row += r->rows->members) {
        for (int k = 0; k < OWN_BLOCKS; k++) {
            const Piece piece = pieceOf(r, row, k);
            for (int b = 0; b < piece.count; b++) {
                const float* from = piece.values + (size_t)b * LANES;
                *mask = maskOf(from);
                for (uint32_t left = *mask++; left != 0; left &= left - 1) {
                    *value++ = from[__builtin_ctz(left)];
                }
            }
        }
    }
    return (size_t)((uint8_t*)value - to);
}

static void writeMessages(Round* r)
{
    size_t at = 0;
    for (int m = 0; m < r->rows->members; m++) {
        r->mail.sendBytes[m] = writeMessage(r, r->round * r->rows->perRound * LANES, m, r->mail.send + at);
        at += r->mail.sendBytes[m];
    }
}

// ---- taking

// Finds the parts of the messages; returns how many factors they have.
static size_t openMessages(Round* r)
{
    size_t count = 0;
    const uint8_t* at = r->mail.received;
    for (int m = 0; m < r->rows->members; m++) {
        uint32_t masks;
        memcpy(&masks, at, sizeof masks);
        r->masks[m] = at + sizeof masks;
        r->values[m] = at + headBytes(masks);
        count += (r->mail.receivedBytes[m] - headBytes(masks)) / sizeof(float);
        at += r->mail.receivedBytes[m];
    }
    return count;
}

// Takes a piece of a row from a member's message; returns the place behind its factors.
static float* takePiece(Round* r, int member, int count, uint16_t* masks, float* values)
{
    size_t factors = 0;
    memcpy(masks, r->masks[member], (size_t)count * sizeof *masks);
    for (int b = 0; b < count; b++) {
        factors += (size_t)__builtin_popcount(masks[b]);
    }
    memcpy(values, r->values[member], factors * sizeof *values);
    r->masks[member] += (size_t)count * sizeof *masks;
    r->values[member] += factors * sizeof *values;
    return values + factors;
}

static vplResult takeMessages(Round* r)
{
    vplSharedRows* s = r->rows;
    const int first = r->round * s->perRound;
    float* values = vplArena_Alloc(r->work->factors->arena, openMessages(r), sizeof *values);
    s->values[r->round] = values;
    TRY(vplArena_Check(r->work->factors->arena));
    float* to = values;
    for (int row = vplTeam_FirstRow(first * LANES, s->member, s->members); row < s->count;
         row += s->members) {
        const size_t own = (size_t)(row / s->members);
        uint16_t* masks = s->masks + own * (size_t)s->blocks;
        s->starts[(size_t)r->round * (size_t)s->ownCount + own] = (uint32_t)(to - values);
        for (int b = first; b <= vplMini(row / LANES, first + s->perRound - 1); b++) {
            to = takePiece(r, b % s->members, b == row / LANES ? s->blocks - b : 1, masks + b, to);
        }
    }
    return VPL_SUCCESS;
}

// ---- the whole

static vplResult reserve(Round* r)
{
    vplFactorWork* work = r->work;
    vplSharedRows* s = r->rows;
    vplArena *kept = work->factors->arena, *scratch = work->scratch;
    const size_t strip = vplSharedRows_Columns(s) * LANES, members = (size_t)s->members;
    s->masks = vplArena_AllocZero(kept, (size_t)s->ownCount * (size_t)s->blocks, sizeof *s->masks);
    s->starts = vplArena_AllocZero(kept, (size_t)s->rounds * (size_t)s->ownCount, sizeof *s->starts);
    s->values = vplArena_AllocZero(kept, (size_t)s->rounds, sizeof *s->values);
    s->nearby = vplArena_AllocZero(kept, (size_t)s->count * VPL_SWEEP_ROWS, sizeof *s->nearby);
    for (int k = 0; k < OWN_BLOCKS; k++) {
        r->strips[k].there = vplArena_Alloc(scratch, strip, sizeof(float));
        r->strips[k].back = vplArena_Alloc(scratch, strip, sizeof(float));
    }
    r->mail = vplTeamMail_Alloc(work->context, scratch, 0, 0);
    r->mail.send = vplArena_Alloc(scratch, 2 * OWN_BLOCKS * (strip * 4 + strip / 8) + 8 * members, 1);
    r->masks = vplArena_Alloc(scratch, members, sizeof *r->masks);
    r->values = vplArena_Alloc(scratch, members, sizeof *r->values);
    r->spans = (s->blocks + SPAN - 1) / SPAN;
    TRY(vplPairWork_Open(work, OWN_BLOCKS * r->spans, &r->pairs));
    TRY(vplArena_Check(scratch));
    TRY(vplArena_Check(kept));
    return vplFactorWork_MakeBlocks(work);
}

vplResult vplFactorWork_ShareRows(vplFactorWork* work)
{
    const vplTeam* team = &work->context->team;
    vplSharedRows* s = work->shared;
    *s = (vplSharedRows){.count = work->count,
                         .blocks = (work->count + LANES - 1) / LANES,
                         .member = team->index,
                         .members = team->count,
                         .perRound = OWN_BLOCKS * team->count};
    s->ownCount = (s->count - s->member + s->members - 1) / s->members;
    s->rounds = (s->blocks + s->perRound - 1) / s->perRound;
    Round r = {.work = work, .rows = s};
    vplResult result = reserve(&r);
    TRY(vplTeam_Agree(work->context, result));
    for (; r.round < s->rounds; r.round++) {
        result = result == VPL_SUCCESS ? computeStrips(&r) : result;
        if (result == VPL_SUCCESS) {
            writeMessages(&r);
        }
        TRY(vplTeam_Exchange(work->context, result, &r.mail));
        result = takeMessages(&r);
    }
    vplPairWork_Count(&r.pairs, OWN_BLOCKS * r.spans);
    return vplTeam_Agree(work->context, result);
}
