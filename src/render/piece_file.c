// SPDX-License-Identifier: MIT
#include "render/piece_file.h"

#include "base/arena.h" // TRY

#include <string.h>

enum { VERSION = 1, MEAN = 1, SPLITS = 2 };

static const double LEAST_SHARE = 1.0 / VPL_MAX_LIGHTS; // of a pass of one particle

static const char MAGIC[8] = {'V', 'P', 'L', 'P', 'I', 'E', 'C', 'E'};

vplPiecePlace vplPieceGrid_Place(const vplPieceGrid* g, int index)
{
    vplPiecePlace p = {.pass = index % g->passes, .band = index / g->passes};
    p.firstRow = p.band * g->rows;
    p.endRow = g->height - p.firstRow < g->rows ? g->height : p.firstRow + g->rows;
    p.values = 3 * (size_t)g->width * (size_t)(p.endRow - p.firstRow);
    return p;
}

int vplPiece_CountArrays(const vplPieceHeader* h)
{
    return 1 + (h->mean && h->index % h->grid.passes == 0) + h->splits;
}

size_t vplPiece_Size(const vplPieceHeader* h)
{
    const vplPiecePlace place = vplPieceGrid_Place(&h->grid, h->index);
    return VPL_PIECE_HEADER_BYTES + VPL_PIECE_CHECKSUM_BYTES +
           (size_t)vplPiece_CountArrays(h) * place.values * sizeof(float);
}

static void streamInt(vplStream* s, int* value)
{
    uint32_t word = (uint32_t)*value;
    vplStream_Word(s, &word);
    *value = word <= INT32_MAX ? (int)word : -1;
}

void vplPiece_StreamHeader(vplStream* s, vplPieceHeader* h)
{
    int version = VERSION, flags = (h->mean ? MEAN : 0) | (h->splits ? SPLITS : 0);
    vplPieceGrid* g = &h->grid;
    uint64_t reserved = 0;
    if (s->writes) {
        memcpy(s->bytes, MAGIC, sizeof MAGIC);
    }
    s->at = sizeof MAGIC;
    streamInt(s, &version);
    streamInt(s, &flags);
    vplStream_Long(s, &h->scene);
    vplStream_Long(s, &h->options);
    int* const words[] = {&g->width, &g->height, &g->passes, &g->bands, &g->rows, &h->index};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        streamInt(s, words[i]);
    }
    vplStream_Doubles(s, &h->share, 1);
    vplStream_Long(s, &reserved);
    h->mean = (flags & MEAN) != 0;
    h->splits = (flags & SPLITS) != 0;
    if (version != VERSION || (flags & ~(MEAN | SPLITS)) != 0) {
        h->index = -1;
    }
}

// True if the numbers of a header can be those of a piece, so that sizes can be computed from them.
static bool isPlausible(vplPieceHeader* h)
{
    vplPieceGrid* g = &h->grid;
    const bool sizes = g->width >= 1 && g->width <= VPL_MAX_IMAGE_SIZE && g->height >= 1 &&
                       g->height <= VPL_MAX_IMAGE_SIZE && g->rows >= 1 && g->rows <= 2 * VPL_MAX_IMAGE_SIZE &&
                       g->passes >= 1 && g->passes <= VPL_MAX_PASSES;
    if (!sizes || g->bands != (g->height + g->rows - 1) / g->rows || g->passes > INT32_MAX / g->bands) {
        return false;
    }
    g->count = g->passes * g->bands;
    return h->index >= 0 && h->index < g->count && h->share >= LEAST_SHARE && h->share <= 1 &&
           (h->mean || g->passes == 1);
}

vplResult vplPiece_ReadHeader(const vplContext* context, const uint8_t* bytes, size_t size, const char* name,
                              vplPieceHeader* headerOut)
{
    vplStream s = {.bytes = (uint8_t*)bytes, .finite = true};
    vplPieceHeader h = {.index = 0};
    if (size < sizeof MAGIC || memcmp(bytes, MAGIC, sizeof MAGIC) != 0) {
        return vplFail(context, VPL_PARSE_ERROR, "%s: not a part of a picture, which begins with VPLPIECE",
                       name);
    }
    if (size < VPL_PIECE_HEADER_BYTES) {
        return vplFail(context, VPL_PARSE_ERROR, "%s: ends within the header of a piece: it is not complete",
                       name);
    }
    vplPiece_StreamHeader(&s, &h);
    if (!s.finite || !isPlausible(&h)) {
        return vplFail(context, VPL_PARSE_ERROR,
                       "%s: the header of a piece is damaged, or of another version of the library", name);
    }
    const size_t whole = vplPiece_Size(&h);
    if (size < whole) {
        return vplFail(context, VPL_PARSE_ERROR,
                       "%s: ends within a piece, which has %zu bytes of %zu: it is not complete", name, size,
                       whole);
    }
    *headerOut = h;
    return VPL_SUCCESS;
}

vplResult vplPiece_Read(const vplContext* context, const uint8_t* bytes, size_t size, const char* name,
                        vplPieceHeader* headerOut)
{
    vplPieceHeader h;
    uint64_t checksum = 0;
    TRY(vplPiece_ReadHeader(context, bytes, size, name, &h));
    const size_t whole = vplPiece_Size(&h);
    vplStream s = {.bytes = (uint8_t*)bytes, .at = whole - VPL_PIECE_CHECKSUM_BYTES, .finite = true};
    vplStream_Long(&s, &checksum);
    if (checksum != vplState_Checksum(bytes, whole - VPL_PIECE_CHECKSUM_BYTES)) {
        return vplFail(context, VPL_PARSE_ERROR, "%s: the checksum of a piece does not fit: it is damaged",
                       name);
    }
    *headerOut = h;
    return VPL_SUCCESS;
}
