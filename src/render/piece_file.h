// SPDX-License-Identifier: MIT
// The bytes of a piece: the 8 letters VPLPIECE, a header, floats, and a checksum; all words are little-endian.
#ifndef VPL_RENDER_PIECE_FILE_H
#define VPL_RENDER_PIECE_FILE_H

#include <vpl/stages.h>

#include "render/state_stream.h"

enum { VPL_PIECE_HEADER_BYTES = 72, VPL_PIECE_CHECKSUM_BYTES = 8 };

typedef struct vplPieceHeader {
    uint64_t scene, options; // hashes
    vplPieceGrid grid;
    int index;
    bool mean;    // the picture is its first floats plus the mean of all passes
    bool splits;  // each piece also has the direct light of its pass alone, for layers
    double share; // weight of the pass
} vplPieceHeader;

// Where a piece lies in the picture.
typedef struct vplPiecePlace {
    int pass, band, firstRow, endRow;
    size_t values; // of its rows: 3 per pixel
} vplPiecePlace;

vplPiecePlace vplPieceGrid_Place(const vplPieceGrid* grid, int index);

// Arrays of `values` floats in a piece: direct light if it is of the first pass of a mean, the pass or picture, and last the
// direct light of the pass alone if the header says splits.
int vplPiece_CountArrays(const vplPieceHeader* header);

// Bytes of a whole piece.
size_t vplPiece_Size(const vplPieceHeader* header);

// Writes or reads the header at the front of a stream.
void vplPiece_StreamHeader(vplStream* stream, vplPieceHeader* header);

// Reads the header at the front of `bytes`, of a piece that is there as a whole.
vplResult vplPiece_ReadHeader(const vplContext* context, const uint8_t* bytes, size_t size, const char* name,
                              vplPieceHeader* headerOut);

// Reads and checks the piece at the front of `bytes`.
vplResult vplPiece_Read(const vplContext* context, const uint8_t* bytes, size_t size, const char* name,
                        vplPieceHeader* headerOut);

#endif
