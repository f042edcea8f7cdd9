// SPDX-License-Identifier: MIT
// Tests of pieces whose checksum is right and whose header lies: they come from files and from other machines.
#include "test.h"

#include "base/context.h"
#include "render/piece_file.h"

typedef struct Piece {
    uint8_t* bytes;
    size_t size;
    vplPieceHeader header;
    vplScene* scene;
    vplRenderer* renderer;
    vplAssembly* assembly;
} Piece;

// Piece 0 of a small picture of two passes.
static Piece openPiece(vplContext* context)
{
    Piece p;
    vplPieceGrid grid;
    vplRenderOptions o = plainOptions();
    o.output.width = 5;
    o.output.height = 4;
    o.output.aovs = VPL_AOV_DEPTH;
    o.stop.passes = 2;
    o.shadow.mapSize = 8;
    p.scene = openScene(context, "tests/data/room.json");
    assert_int_equal(vplRenderer_Create(p.scene, &o, &p.renderer), VPL_SUCCESS);
    assert_int_equal(vplRenderer_Divide(p.renderer, 1, &grid), VPL_SUCCESS);
    assert_int_equal(vplRenderer_MakePiece(p.renderer, &grid, 0, &p.bytes, &p.size), VPL_SUCCESS);
    assert_int_equal(vplPiece_Read(context, p.bytes, p.size, "piece", &p.header), VPL_SUCCESS);
    assert_int_equal(vplAssembly_Create(context, &p.assembly), VPL_SUCCESS);
    return p;
}

static void closePiece(vplContext* context, Piece* p)
{
    vplAssembly_Destroy(p->assembly);
    vplBytes_Free(context, p->bytes);
    vplRenderer_Destroy(p->renderer);
    vplScene_Destroy(p->scene);
}

// Writes the header, and the checksum that fits it.
static void forge(Piece* p)
{
    vplStream s = {.bytes = p->bytes, .writes = true};
    vplPiece_StreamHeader(&s, &p->header);
    s.at = vplPiece_Size(&p->header) - VPL_PIECE_CHECKSUM_BYTES;
    assert_true(s.at < p->size);
    uint64_t checksum = vplState_Checksum(p->bytes, s.at);
    vplStream_Long(&s, &checksum);
}

static vplResult addForged(Piece* p)
{
    size_t used;
    forge(p);
    return vplAssembly_Add(p->assembly, p->bytes, p->size, "piece", &used);
}

TEST(APieceOfAMillionPassesTakesNoMemoryForTheOthers, 1)
{
    Piece p = openPiece(context);
    const size_t before = vplContext_GetBytes(context);
    p.header.grid.passes = p.header.grid.count = VPL_MAX_PASSES;
    assert_int_equal(addForged(&p), VPL_SUCCESS);
    p.header.index = VPL_MAX_PASSES - 1;
    assert_int_equal(addForged(&p), VPL_SUCCESS);
    assert_true(vplAssembly_Has(p.assembly, 0) && !vplAssembly_Has(p.assembly, 1));
    assert_true(vplAssembly_Has(p.assembly, VPL_MAX_PASSES - 1));
    assert_int_equal(vplAssembly_CountMissing(p.assembly), VPL_MAX_PASSES - 2);
    assert_true(vplContext_GetBytes(context) - before < 8192);
    closePiece(context, &p);
}

TEST(HeadersOutOfRangeAreRefused, 1)
{
    Piece p = openPiece(context);
    const vplPieceHeader good = p.header;
    p.header.grid.passes = VPL_MAX_PASSES + 1;
    assertRefused(addForged(&p), VPL_PARSE_ERROR, "the header of a piece is damaged");
    p.header = good;
    p.header.share = 1e-9; // of a pass of less than one particle
    assertRefused(addForged(&p), VPL_PARSE_ERROR, "the header of a piece is damaged");
    p.header = good;
    assert_int_equal(addForged(&p), VPL_SUCCESS);
    closePiece(context, &p);
}

// Else the picture would have an infinity.
TEST(ValuesWhoseSumIsNoFloatAreRefused, 1)
{
    static const float HUGE_VALUE = 2.5e38f;
    Piece p = openPiece(context);
    memcpy(p.bytes + VPL_PIECE_HEADER_BYTES, &HUGE_VALUE, sizeof HUGE_VALUE); // direct light
    assertRefused(addForged(&p), VPL_PARSE_ERROR, "values that are no numbers or too large");
    closePiece(context, &p);
}

// The hashes of scene and options are right, and the picture is smaller than the renderer's layers.
TEST(APictureOfAnotherSizeDoesNotFitTheRenderer, 1)
{
    Piece p = openPiece(context);
    vplLayers* layers = NULL;
    p.header.grid.width = p.header.grid.passes = p.header.grid.count = 1;
    assert_int_equal(addForged(&p), VPL_SUCCESS);
    assert_int_equal(vplAssembly_CountMissing(p.assembly), 0);
    assertRefused(vplAssembly_CheckRenderer(p.assembly, p.renderer), VPL_INVALID_ARGUMENT,
                  "this render: divided in 1 bands of 64 rows and 2 passes");
    assertRefused(vplAssembly_GetLayers(p.assembly, p.renderer, &layers), VPL_INVALID_ARGUMENT,
                  "this render");
    assert_null(layers);
    closePiece(context, &p);
}
