// SPDX-License-Identifier: MIT
// Tests of pictures in pieces: whatever the division and the order, the bits are those of one render.
#include "shapes.h"

#include "base/bytes.h"

// Options of one line, for pictures of three bands of tiles.
static vplRenderOptions optionsOf(const char* words)
{
    vplRenderOptions o = vplDefaultRenderOptions();
    assert_int_equal(vplRenderOptions_SetAll(&o, words), VPL_SUCCESS);
    o.output.width = 70;
    o.output.height = 150;
    return o;
}

// The hash of a picture, or of all its layers.
static uint64_t hashOfLayers(const vplLayers* layers)
{
    uint64_t hash = 0;
    for (int i = 0; i < layers->count; i++) {
        hash = 31 * hash + vplImage_Hash(layers->layers[i].image);
    }
    return hash;
}

static uint64_t hashOfWhole(const vplScene* scene, const vplRenderOptions* o)
{
    vplLayers* layers;
    assert_int_equal(vplRenderLayers(scene, o, &layers, NULL), VPL_SUCCESS);
    const uint64_t hash = hashOfLayers(layers);
    vplLayers_Destroy(layers);
    return hash;
}

// Renders the pieces from the last to the first, each by a renderer of its own, as on another machine, or all by one.
static uint64_t hashOfPieces(vplContext* context, const vplScene* scene, const vplRenderOptions* o, int bands,
                             bool one)
{
    vplRenderer* r = NULL;
    vplAssembly* a;
    vplPieceGrid grid = {.count = INT32_MAX};
    assert_int_equal(vplAssembly_Create(context, &a), VPL_SUCCESS);
    for (int left = 1; left > 0;) {
        uint8_t* bytes;
        size_t size = 0, used;
        if (r == NULL || !one) {
            vplRenderer_Destroy(r);
            assert_int_equal(vplRenderer_Create(scene, o, &r), VPL_SUCCESS);
        }
        assert_int_equal(vplRenderer_Divide(r, bands, &grid), VPL_SUCCESS);
        const vplPieceGrid seen = vplAssembly_GetGrid(a);
        const int index = (seen.count > 0 ? vplAssembly_CountMissing(a) : grid.count) - 1;
        assert_int_equal(vplRenderer_MakePiece(r, &grid, index, &bytes, &size), VPL_SUCCESS);
        assert_int_equal(vplAssembly_Add(a, bytes, size, "piece", &used), VPL_SUCCESS);
        assert_int_equal(used, size);
        vplBytes_Free(context, bytes);
        left = vplAssembly_CountMissing(a);
    }
    vplLayers* layers;
    vplImage* image;
    assert_int_equal(vplAssembly_GetLayers(a, r, &layers), VPL_SUCCESS);
    assert_int_equal(vplAssembly_GetImage(a, &image), VPL_SUCCESS);
    assert_int_equal(vplImage_Hash(image), vplImage_Hash(layers->images[0]));
    const uint64_t hash = hashOfLayers(layers);
    vplImage_Destroy(image);
    vplLayers_Destroy(layers);
    vplRenderer_Destroy(r);
    vplAssembly_Destroy(a);
    return hash;
}

// A piece of one machine fits into the picture of another only if both hash the caller's view alike, whatever the order of
// bytes in memory. The number was recorded on x86-64.
TEST(TheHashOfTheCallersViewIsTheSameOnEveryMachine, 1)
{
    enum { SCENE_HASH = 16 }; // its place in the bytes of a piece
    vplScene* scene;
    vplRenderer* r;
    vplPieceGrid grid;
    uint8_t* bytes;
    size_t size;
    assert_int_equal(vplScene_Load(context, "tests/data/room.json", &scene), VPL_SUCCESS);
    vplCameraDef view = *vplScene_GetCamera(scene, 0);
    view.eye.x += 0.5f;
    vplRenderOptions o = optionsOf("--method direct --antialias 1");
    o.output.width = o.output.height = 8;
    o.view = &view;
    assert_int_equal(vplRenderer_Create(scene, &o, &r), VPL_SUCCESS);
    assert_int_equal(vplRenderer_Divide(r, 1, &grid), VPL_SUCCESS);
    assert_int_equal(vplRenderer_MakePiece(r, &grid, 0, &bytes, &size), VPL_SUCCESS);
    assert_int_equal(vplTakeWord(bytes + SCENE_HASH), 0x8250ab1a);
    assert_int_equal(vplTakeWord(bytes + SCENE_HASH + 4), 0xc8d06073);
    vplBytes_Free(context, bytes);
    vplRenderer_Destroy(r);
    vplScene_Destroy(scene);
}

// In one band and in three, by a renderer for each piece and by one.
static void assertPiecesAreTheWhole(vplContext* context, const vplScene* scene, const char* words)
{
    const vplRenderOptions o = optionsOf(words);
    const uint64_t whole = hashOfWhole(scene, &o);
    for (int k = 0; k < 3; k++) {
        const int bands = k > 0 ? 3 : 1;
        const uint64_t pieces = hashOfPieces(context, scene, &o, bands, k == 2);
        if (pieces != whole) {
            fail_msg("%s in %d bands%s: %016llx, must be %016llx", words, bands,
                     k == 2 ? " by one renderer" : "", (unsigned long long)pieces, (unsigned long long)whole);
        }
    }
}

TEST(PiecesHaveTheBitsOfOneRender, 2)
{
    static const char* const CASES[] = {
        "--method keller --particles 60 --pipeline interleaved --interleave 16",
        "--method keller --particles 60 --pipeline interleaved --interleave 5 --antialias 8",
        "--method keller --particles 30 --pipeline deferred --antialias 4 --supersample 2",
        "--method keller --particles 20 --passes 3",
        "--method instant-radiosity --particles 8 --pipeline multipass",
        "--method instant-radiosity --particles 40 --pipeline lightcuts --passes 2",
        "--method direct --antialias 8",
        "--method ssvp --first-bounce 40",
        "--method radiosity --patches 60",
        "--method path --spp 3",
        "--method path --spp 3 --aov all",
        "--method keller --particles 20 --passes 3 --aov direct,normal",
        "--method instant-radiosity --particles 8 --passes 2 --aov indirect,depth",
        "--method ssvp --first-bounce 40 --aov direct,indirect",
        "--method radiosity --patches 60 --antialias 4 --aov all"};
    vplScene* scene = loadScene(context, "room.json");
    for (size_t i = 0; i < sizeof CASES / sizeof *CASES; i++) {
        assertPiecesAreTheWhole(context, scene, CASES[i]);
    }
    vplScene_Destroy(scene);
}

// Where triangles are many, passes share the surfaces of the rows of a piece.
TEST(PiecesOfManyTrianglesHaveTheBitsOfOneRender, 2)
{
    vplScene* scene = loadScene(context, "room.json");
    Shape ball = icosphere(5); // 20,480 triangles
    addShape(scene, &ball, true, NULL);
    freeShape(&ball);
    assertPiecesAreTheWhole(context, scene,
                            "--method keller --particles 20 --passes 2 --antialias 4 --interleave 16");
    assertPiecesAreTheWhole(context, scene, "--method ssvp --first-bounce 40 --passes 2");
    vplScene_Destroy(scene);
}

// Near hits of sixteen pixels share one of several lights, so a band must take the same pixels together as the whole.
TEST(PiecesOfAFinalGatherChooseTheSameLights, 2, SLOW)
{
    static const char* const CASES[] = {"--method radiosity --patches 60 --gather 4 --interleave 8",
                                        "--method radiosity --patches 60 --gather 4 --interleave 4"};
    vplScene* scene = openScene(context, "examples/scenes/six-rooms.json");
    for (size_t i = 0; i < sizeof CASES / sizeof *CASES; i++) {
        const vplRenderOptions o = optionsOf(CASES[i]);
        assert_int_equal(hashOfPieces(context, scene, &o, 3, true), hashOfWhole(scene, &o));
    }
    vplScene_Destroy(scene);
}

// Divides the room in three bands.
static vplRenderer* openRoom(vplContext* context, const vplRenderOptions* o, vplScene** sceneOut,
                             vplPieceGrid* gridOut)
{
    vplRenderer* r;
    assert_int_equal(vplScene_Load(context, "tests/data/room.json", sceneOut), VPL_SUCCESS);
    assert_int_equal(vplRenderer_Create(*sceneOut, o, &r), VPL_SUCCESS);
    assert_int_equal(vplRenderer_Divide(r, 3, gridOut), VPL_SUCCESS);
    return r;
}

TEST(DamagedPiecesAreRefused, 1)
{
    const vplRenderOptions o = optionsOf("--method direct --antialias 1");
    vplScene* scene;
    vplAssembly* a;
    vplPieceGrid grid;
    uint8_t* bytes;
    size_t size = 0, used = 0;
    vplRenderer* r = openRoom(context, &o, &scene, &grid);
    assert_int_equal(vplRenderer_MakePiece(r, &grid, 1, &bytes, &size), VPL_SUCCESS);
    assert_int_equal(vplAssembly_Create(context, &a), VPL_SUCCESS);
    for (size_t cut = 0; cut < size; cut += cut < 100 ? 1 : size / 50) {
        assert_int_equal(vplAssembly_Add(a, bytes, cut, "piece", &used), VPL_PARSE_ERROR);
        bytes[cut] ^= 0x40;
        assert_int_equal(vplAssembly_Add(a, bytes, size, "piece", &used), VPL_PARSE_ERROR);
        bytes[cut] ^= 0x40;
    }
    vplImage* image = NULL;
    assert_int_equal(vplAssembly_Add(a, bytes, size, "piece", &used), VPL_SUCCESS);
    assert_int_equal(vplAssembly_GetImage(a, &image), VPL_INVALID_ARGUMENT);
    assert_null(image);
    vplBytes_Free(context, bytes);
    vplAssembly_Destroy(a);
    vplRenderer_Destroy(r);
    vplScene_Destroy(scene);
}

TEST(PiecesOfAnotherPictureDoNotFitTheRenderer, 1)
{
    vplRenderOptions o = optionsOf("--method direct --antialias 1");
    vplScene* scene;
    vplRenderer* other;
    vplAssembly* a;
    vplPieceGrid grid;
    uint8_t* bytes;
    size_t size = 0, used = 0;
    vplRenderer* r = openRoom(context, &o, &scene, &grid);
    assert_int_equal(vplRenderOptions_Set(&o, "seed", "9"), VPL_SUCCESS);
    assert_int_equal(vplRenderer_Create(scene, &o, &other), VPL_SUCCESS);
    assert_int_equal(vplAssembly_Create(context, &a), VPL_SUCCESS);
    assert_int_equal(vplAssembly_CheckRenderer(a, other), VPL_SUCCESS);
    assert_int_equal(vplRenderer_MakePiece(r, &grid, 0, &bytes, &size), VPL_SUCCESS);
    assert_int_equal(vplAssembly_Add(a, bytes, size, "piece", &used), VPL_SUCCESS);
    assert_int_equal(vplAssembly_CheckRenderer(a, r), VPL_SUCCESS);
    assert_int_equal(vplAssembly_CheckRenderer(a, other), VPL_INVALID_ARGUMENT);
    vplBytes_Free(context, bytes);
    vplAssembly_Destroy(a);
    vplRenderer_Destroy(r);
    vplRenderer_Destroy(other);
    vplScene_Destroy(scene);
}

TEST(PiecesOfAnotherDivisionAreRefused, 1)
{
    vplScene* scene = openScene(context, "tests/data/room.json");
    const vplRenderOptions o = optionsOf("--method direct");
    vplRenderer* r;
    vplPieceGrid grid = {.count = 7}, other;
    uint8_t* bytes = NULL;
    size_t size = 0;
    assert_int_equal(vplRenderer_Create(scene, &o, &r), VPL_SUCCESS);
    assert_int_equal(vplRenderer_Divide(r, 0, &grid), VPL_INVALID_ARGUMENT);
    assert_string_equal(takeMessage(), "vplRenderer_Divide: bands is 0, must be at least 1");
    assert_int_equal(grid.count, 7);
    assert_int_equal(vplRenderer_Divide(r, 3, &grid), VPL_SUCCESS);
    other = grid;
    other.rows++;
    assert_int_equal(vplRenderer_MakePiece(r, &other, 0, &bytes, &size), VPL_INVALID_ARGUMENT);
    assert_int_equal(vplRenderer_MakePiece(r, &grid, grid.count, &bytes, &size), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "of another division"));
    assert_true(bytes == NULL && size == 0);
    vplRenderer_Destroy(r);
    vplScene_Destroy(scene);
}

// Adds piece 0 of a render of a scene in some bands to an assembly; says what came of it.
static vplResult addPieceOf(vplAssembly* a, const vplScene* scene, const vplRenderOptions* o, int bands)
{
    vplRenderer* r;
    vplPieceGrid grid;
    uint8_t* bytes;
    size_t size = 0, used = 0;
    assert_int_equal(vplRenderer_Create(scene, o, &r), VPL_SUCCESS);
    assert_int_equal(vplRenderer_Divide(r, bands, &grid), VPL_SUCCESS);
    assert_int_equal(vplRenderer_MakePiece(r, &grid, 0, &bytes, &size), VPL_SUCCESS);
    const vplResult result = vplAssembly_Add(a, bytes, size, "b.piece", &used);
    vplBytes_Free(vplScene_GetContext(scene), bytes);
    vplRenderer_Destroy(r);
    return result;
}

TEST(PartsOfTwoPicturesAreNotPutTogether, 1)
{
    vplScene *room = openScene(context, "tests/data/room.json"),
             *closed = openScene(context, "examples/scenes/closed-room.json");
    const vplRenderOptions o = optionsOf("--method direct"), other = optionsOf("--method direct --seed 9");
    vplAssembly* a;
    vplImage* image = NULL;
    assert_int_equal(vplAssembly_Create(context, &a), VPL_SUCCESS);
    assert_int_equal(vplAssembly_GetImage(a, &image), VPL_INVALID_ARGUMENT);
    assert_string_equal(takeMessage(), "there is no part of the picture");
    assert_int_equal(addPieceOf(a, room, &o, 3), VPL_SUCCESS);
    assert_int_equal(addPieceOf(a, room, &other, 3), VPL_INVALID_ARGUMENT);
    assert_string_equal(takeMessage(), "b.piece: a part of another picture than the first: options differ");
    assert_int_equal(addPieceOf(a, closed, &o, 3), VPL_INVALID_ARGUMENT);
    assert_string_equal(takeMessage(),
                        "b.piece: a part of another picture than the first: scene or camera differ");
    assert_int_equal(addPieceOf(a, room, &o, 2), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "b.piece: divided in 2 bands"));
    vplAssembly_Destroy(a);
    vplScene_Destroy(room);
    vplScene_Destroy(closed);
}
