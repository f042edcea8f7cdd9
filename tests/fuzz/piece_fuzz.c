// SPDX-License-Identifier: MIT
// Passes arbitrary bytes as a file of pieces, with checksums that are made right: each piece must be refused in one
// sentence, or taken. Whole pictures must be finite and the same in any order, and their layers those of a renderer only if
// it divides its picture alike.
#include "fuzz.h"

#include "../plain_options.h"

#include "render/piece_file.h"
#include "render/renderer.h"

#include <math.h>
#include <string.h>

enum { MOST_PIECES = 64 };

// A renderer for inputs that ask for its hashes; NULL: none has.
typedef struct Own {
    vplContext* context;
    vplScene* scene;
    vplRenderer* renderer;
} Own;

// A floor that glows, so that passes split light.
static void makeRenderer(Own* own)
{
    vplMaterialDef material = vplDefaultMaterialDef();
    const vplObjectDef object = vplDefaultObjectDef();
    const vplCameraDef camera = vplDefaultCameraDef();
    vplRenderOptions o = plainOptions();
    o.method = VPL_METHOD_KELLER;
    o.output.width = 1;
    o.output.height = 4;
    o.output.aovs = VPL_AOV_ALL;
    o.particles.count = 1;
    o.shadow.mapSize = 2;
    o.stop.passes = 2;
    material.emission = (vplRgb){1, 1, 1};
    MUST(vplScene_Create(own->context, &own->scene) == VPL_SUCCESS);
    MUST(vplScene_AddMaterial(own->scene, &material, NULL) == VPL_SUCCESS);
    MUST(vplScene_AddObject(own->scene, &object, NULL) == VPL_SUCCESS);
    MUST(vplScene_AddCamera(own->scene, &camera, NULL) == VPL_SUCCESS);
    MUST(vplRenderer_Create(own->scene, &o, &own->renderer) == VPL_SUCCESS);
}

// Makes the checksum of the piece at the front of the bytes right. A scene's hash of 0 asks for those of the renderer.
static void repair(Own* own, uint8_t* bytes, size_t size)
{
    vplPieceHeader h;
    vplStream s = {.bytes = bytes, .writes = true};
    if (vplPiece_ReadHeader(NULL, bytes, size, "piece", &h) != VPL_SUCCESS) {
        return;
    }
    if (h.scene == 0) {
        if (own->renderer == NULL) {
            makeRenderer(own);
        }
        h.scene = vplRenderer_HashScene(own->renderer);
        MUST(vplRenderer_HashOptions(own->renderer, &h.options) == VPL_SUCCESS);
        vplPiece_StreamHeader(&s, &h);
    }
    s.at = vplPiece_Size(&h) - VPL_PIECE_CHECKSUM_BYTES;
    uint64_t checksum = vplState_Checksum(bytes, s.at);
    vplStream_Long(&s, &checksum);
}

// The places of pieces that were taken.
typedef struct Pieces {
    size_t at[MOST_PIECES + 1];
    int count;
    bool twice; // one came twice: the first counts
} Pieces;

static vplResult addPieces(Own* own, vplAssembly* a, uint8_t* bytes, size_t size, Pieces* p)
{
    vplResult result = VPL_SUCCESS;
    size_t at = 0, used = 0;
    *p = (Pieces){.count = 0};
    while (result == VPL_SUCCESS && at < size && p->count < MOST_PIECES) {
        const int missing = vplAssembly_CountMissing(a);
        repair(own, bytes + at, size - at);
        result = vplAssembly_Add(a, bytes + at, size - at, "piece", &used);
        if (result == VPL_SUCCESS) {
            MUST(used >= VPL_PIECE_HEADER_BYTES && used <= size - at);
            p->twice = p->twice || (p->count > 0 && vplAssembly_CountMissing(a) == missing);
            p->at[p->count++] = at;
            at += used;
        }
    }
    p->at[p->count] = at;
    return result;
}

static bool isFinite(const vplImage* image)
{
    bool finite = true;
    for (size_t k = 0; k < 3 * (size_t)image->width * (size_t)image->height; k++) {
        finite = finite && isfinite(image->pixels[k]);
    }
    return finite;
}

// The whole picture; NULL where pieces are missing, or memory.
static vplImage* imageOf(const vplAssembly* a)
{
    vplImage* image = NULL;
    const vplPieceGrid grid = vplAssembly_GetGrid(a);
    const vplResult result = vplAssembly_GetImage(a, &image);
    const bool whole = grid.count > 0 && vplAssembly_CountMissing(a) == 0;
    MUST(result == (whole ? VPL_SUCCESS : VPL_INVALID_ARGUMENT) || (whole && result == VPL_OUT_OF_MEMORY));
    MUST(image == NULL || (image->width == grid.width && image->height == grid.height && isFinite(image)));
    return image;
}

// The same pieces from the last to the first. One that came twice may be refused now: then the second was not read.
static void addBackwards(vplContext* context, const uint8_t* bytes, const Pieces* p, const vplImage* image)
{
    vplAssembly* a;
    size_t used;
    MUST(vplAssembly_Create(context, &a) == VPL_SUCCESS);
    vplResult result = VPL_SUCCESS;
    for (int i = p->count - 1; i >= 0 && result == VPL_SUCCESS; i--) {
        result = vplAssembly_Add(a, bytes + p->at[i], p->at[p->count] - p->at[i], "piece", &used);
        MUST(result != VPL_SUCCESS || used == p->at[i + 1] - p->at[i]);
    }
    MUST(result == VPL_SUCCESS || p->twice);
    vplImage* other = result == VPL_SUCCESS ? imageOf(a) : NULL;
    MUST(result != VPL_SUCCESS ||
         ((other != NULL) == (image != NULL) &&
          (image == NULL || p->twice || vplImage_Hash(other) == vplImage_Hash(image))));
    vplImage_Destroy(other);
    vplAssembly_Destroy(a);
}

static void getLayers(const vplAssembly* a, vplRenderer* r, const vplImage* image)
{
    vplLayers* layers = NULL;
    const bool fits = vplAssembly_CheckRenderer(a, r) == VPL_SUCCESS;
    const vplResult result = vplAssembly_GetLayers(a, r, &layers);
    MUST((result == VPL_SUCCESS) == (fits && image != NULL));
    for (int i = 0; layers != NULL && i < layers->count; i++) {
        MUST(isFinite(layers->images[i]));
    }
    vplLayers_Destroy(layers);
}

int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size)
{
    FuzzLog log = {{0}, 0};
    vplContext* context = openFuzzContext(&log);
    Own own = {context, NULL, NULL};
    vplAssembly* a;
    Pieces pieces;
    uint8_t* copy = malloc(size + 1);
    MUST(copy != NULL && vplAssembly_Create(context, &a) == VPL_SUCCESS);
    memcpy(copy, bytes, size);
    const vplResult result = addPieces(&own, a, copy, size, &pieces);
    MUST(isPrintable(log.message) && log.errors == (result != VPL_SUCCESS));
    vplImage* image = imageOf(a);
    addBackwards(context, copy, &pieces, image);
    if (own.renderer != NULL) {
        getLayers(a, own.renderer, image);
    }
    vplImage_Destroy(image);
    vplAssembly_Destroy(a);
    vplRenderer_Destroy(own.renderer);
    vplScene_Destroy(own.scene);
    free(copy);
    closeFuzzContext(context);
    return 0;
}
