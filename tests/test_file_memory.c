// SPDX-License-Identifier: MIT
// Files that are read, and pictures in pieces, with each allocation failing in turn (tests/failing.h).
#include "failing.h"

// ---- pictures and scenes

static vplResult readPictures(Attempt* a)
{
    static const char* const pictures[] = {"tests/fuzz/corpus/image/small.bmp",
                                           "tests/fuzz/corpus/image/small.tga",
                                           "tests/data/gltf/apart/picture.jpg"};
    for (int i = 0; i < 3; i++) {
        vplImage_Destroy(a->image);
        a->image = NULL;
        TRY(vplImage_Read(a->context, pictures[i], &a->image));
    }
    return VPL_SUCCESS;
}

// Variants: without compression, and compressions that have buffers of their own.
static vplResult readExr(Attempt* a)
{
    static const char* const pictures[] = {
        "tests/fuzz/corpus/image/none.exr", "tests/fuzz/corpus/image/piz.exr",
        "tests/fuzz/corpus/image/rle.exr", "tests/fuzz/corpus/image/b44.exr"};
    TRY(vplImage_Read(a->context, pictures[a->variant], &a->image));
    return vplImage_ReadLayer(a->context, pictures[a->variant], "", &a->other);
}

// Variants: a glTF file with a buffer and pictures beside it, and a scene with textures.
static vplResult readPartsOfAScene(Attempt* a)
{
    return vplScene_Load(a->context,
                         a->variant ? "tests/data/textured.json" : "tests/data/gltf/apart/triangle.gltf",
                         &a->scene);
}

static vplResult readEnvironment(Attempt* a)
{
    const vplEnvironmentDef def = vplDefaultEnvironmentDef();
    TRY(vplScene_Create(a->context, &a->scene));
    return vplScene_LoadEnvironment(a->scene, "tests/fuzz/corpus/image/small.hdr", &def);
}

// ---- pieces

typedef struct Pieces {
    vplRenderer* renderer;
    vplAssembly* assembly;
    vplPieceGrid grid;
} Pieces;

static vplResult addPiece(Attempt* a, const Pieces* p, int index)
{
    uint8_t* bytes = NULL;
    size_t size, used;
    TRY(vplRenderer_MakePiece(p->renderer, &p->grid, index, &bytes, &size));
    const vplResult result = vplAssembly_Add(p->assembly, bytes, size, "piece", &used);
    vplBytes_Free(a->context, bytes);
    return result;
}

// From the last to the first, so that passes wait.
static vplResult putTogether(Attempt* a, Pieces* p, const vplRenderOptions* o)
{
    TRY(vplRenderer_Create(a->scene, o, &p->renderer));
    TRY(vplAssembly_Create(a->context, &p->assembly));
    TRY(vplRenderer_Divide(p->renderer, 2, &p->grid));
    TRY(vplRenderer_Prepare(p->renderer));
    for (int i = p->grid.count - 1; i >= 0; i--) {
        TRY(addPiece(a, p, i));
    }
    TRY(vplAssembly_CheckRenderer(p->assembly, p->renderer));
    TRY(vplAssembly_GetImage(p->assembly, &a->image));
    return vplAssembly_GetLayers(p->assembly, p->renderer, &a->layers);
}

// Variants: passes with direct light of their own, paths, and patches.
static vplResult renderPieces(Attempt* a)
{
    static const char* const words[] = {"--method keller --particles 2 --passes 3 --aov direct,depth",
                                        "--method path --spp 2 --aov direct",
                                        "--method radiosity --patches 16 --iterations 2 --form-samples 1"};
    vplRenderOptions o = plainOptions();
    Pieces p = {NULL, NULL, {0}};
    TRY(vplRenderOptions_SetAll(&o, words[a->variant]));
    o.output.width = 2;
    o.output.height = a->variant == 1 ? 20 : 70; // two bands
    o.shadow.mapSize = o.lights.mapSize = 4;
    TRY(vplScene_Load(a->context,
                      a->variant == 2 ? "tests/data/corner-path.json" : "examples/scenes/room-area.json",
                      &a->scene));
    const vplResult result = putTogether(a, &p, &o);
    vplAssembly_Destroy(p.assembly);
    vplRenderer_Destroy(p.renderer);
    return result;
}

TEST_ALONE(EveryFailedAllocationOfPicturesThatAreReadIsReported)
{
    failEveryAllocation("PicturesThatAreRead", readPictures, "none", 1);
}

TEST_ALONE(EveryFailedAllocationOfExrFilesThatAreReadIsReported)
{
    if (vplImage_CanWrite("a.exr")) {
        failEveryAllocation("ExrFilesThatAreRead", readExr, "none", 4);
    }
}

TEST_ALONE(EveryFailedAllocationOfScenesWithFilesBesideThemIsReported)
{
    failEveryAllocation("ScenesWithFilesBesideThem", readPartsOfAScene, "none", 2);
}

TEST_ALONE(EveryFailedAllocationOfAnEnvironmentThatIsReadIsReported)
{
    failEveryAllocation("AnEnvironmentThatIsRead", readEnvironment, "none", 1);
}

TEST_ALONE(EveryFailedAllocationOfAPictureInPiecesIsReported)
{
    failEveryAllocation("APictureInPieces", renderPieces, "none", 3);
}
