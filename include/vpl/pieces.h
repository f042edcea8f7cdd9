// SPDX-License-Identifier: MIT
// A picture in pieces, for several processes or machines: each piece is rendered by itself and becomes bytes, and an
// assembly puts the bytes of all pieces together, in any order, to the bits of vplRender. It needs no scene.
#ifndef VPL_PIECES_H
#define VPL_PIECES_H

#include <vpl/render.h>
#include <vpl/rendertools.h>

VPL_HEADER_BEGIN

// How a picture is divided: into its passes, and each pass into bands of rows. Piece i is pass i % passes of band i / passes.
typedef struct vplPieceGrid {
    int width, height; // of the picture, pixels
    int passes;        // path tracing: 1, with all paths
    int bands;         // the last may have fewer rows
    int rows;          // of a band: whole tiles, of 64 rows, path tracing of 16
    int count;         // passes * bands
} vplPieceGrid;

// Divides the renderer's picture into at most `bands` bands, as many as its tiles allow. The division follows from the plan
// and `bands` alone. VPL_INVALID_ARGUMENT for pictures that are not made of pieces: those that a time or an error ends, those
// whose edges are traced, and passes with marks drawn over them.
vplResult vplRenderer_Divide(const vplRenderer* renderer, int bands, vplPieceGrid* gridOut);

// Makes what all pieces of radiosity need: patches, form factors and the light that they exchange. Without it the first piece
// makes it. The processes of a team (vplContext_SetTeam) call it together; afterwards each may make pieces of its own without
// the team. VPL_CANCELLED and what vplRenderer_Step fails with.
vplResult vplRenderer_Prepare(vplRenderer* renderer);

// Renders piece `index` of the grid and writes it as bytes, little-endian, which carry the hash of scene and options and a
// checksum. What all pieces need (geometry, lights of the pass, patches) is kept for the next piece. Interleaved pictures also
// light 16 rows above and below a band, which the filter reads. The bytes are freed by vplBytes_Free. Pieces leave the
// renderer's own passes alone. VPL_CANCELLED, VPL_INVALID_ARGUMENT and what vplRenderer_Step fails with.
vplResult vplRenderer_MakePiece(vplRenderer* renderer, const vplPieceGrid* grid, int index,
                                uint8_t** bytesOut, size_t* sizeOut);

// A picture that is put together. It holds 36 bytes per pixel for passes, 12 for other pictures, and the pieces of passes
// that have come before their turn.
typedef struct vplAssembly vplAssembly;

vplResult vplAssembly_Create(vplContext* context, vplAssembly** assemblyOut);

// NULL is allowed.
void vplAssembly_Destroy(vplAssembly* assembly);

// Adds the piece at the front of `bytes`, whose length becomes *usedOut, so that a file of several pieces is read by several
// calls. A piece that is there already is passed over. `name` is for messages. VPL_PARSE_ERROR for bytes that are damaged or
// not complete, VPL_INVALID_ARGUMENT for a piece of another scene, of other options or of another division.
vplResult vplAssembly_Add(vplAssembly* assembly, const uint8_t* bytes, size_t size, const char* name,
                          size_t* usedOut);

// The division; count is 0 before the first piece.
vplPieceGrid vplAssembly_GetGrid(const vplAssembly* assembly);

// Checks that the pieces of an assembly are of the renderer's picture, so that an old file of pieces is not continued with
// another scene. VPL_INVALID_ARGUMENT where scene, camera or options differ; an assembly without pieces fits.
vplResult vplAssembly_CheckRenderer(const vplAssembly* assembly, const vplRenderer* renderer);

bool vplAssembly_Has(const vplAssembly* assembly, int index);

// Returns how many pieces are missing.
int vplAssembly_CountMissing(const vplAssembly* assembly);

// Gets the whole picture; destroy it with vplImage_Destroy. VPL_INVALID_ARGUMENT names the first piece that is missing.
vplResult vplAssembly_GetImage(const vplAssembly* assembly, vplImage** imageOut);

// Gets the whole picture and the layers of options.output.aovs, with the bits of vplRenderLayers; destroy them with
// vplLayers_Destroy. Direct light comes from the pieces. The renderer, which must have their scene and options, draws the layers of
// surfaces. Errors of vplAssembly_GetImage, vplAssembly_CheckRenderer and vplRenderer_GetLayers.
vplResult vplAssembly_GetLayers(const vplAssembly* assembly, vplRenderer* renderer, vplLayers** layersOut);

VPL_HEADER_END

#endif
