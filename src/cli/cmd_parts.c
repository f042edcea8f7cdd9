// SPDX-License-Identifier: MIT
// Pictures in parts, for farms that only have a queue: vpl render --tile I/N writes one of N parts, vpl merge puts them
// together. A part is a file of pieces (vpl/pieces.h), one behind the other.
#include "cli/cli.h"

#include <stdlib.h>
#include <string.h>

// Bytes that grow; NULL before the first.
typedef struct Bytes {
    uint8_t* bytes;
    size_t size;
} Bytes;

static bool append(Bytes* all, const uint8_t* bytes, size_t size)
{
    uint8_t* grown = realloc(all->bytes, all->size + size + 1);
    if (grown == NULL) {
        complain("out of memory");
        return false;
    }
    memcpy(grown + all->size, bytes, size);
    all->bytes = grown;
    all->size += size;
    return true;
}

// ---- vpl render --tile

// The pieces of the part, of which a render in N parts has about as many as it has passes or bands.
static vplResult makePieces(const Arguments* a, const vplScene* scene, vplRenderer* renderer,
                            Progress* progress, Bytes* all)
{
    vplPieceGrid grid;
    TRY(vplRenderer_Divide(renderer, 1, &grid));
    if (grid.passes < a->tile[1]) {
        TRY(vplRenderer_Divide(renderer, a->tile[1], &grid));
    }
    const int64_t count = grid.count;
    const int first = (int)(count * (a->tile[0] - 1) / a->tile[1]),
              end = (int)(count * a->tile[0] / a->tile[1]);
    if (first == end && !a->quiet) {
        complain("warning: part %d of %d is empty, because the picture has %d piece%s", a->tile[0],
                 a->tile[1], grid.count, grid.count > 1 ? "s" : "");
    }
    for (int i = first; i < end; i++) {
        uint8_t* bytes;
        size_t size;
        TRY(vplRenderer_MakePiece(renderer, &grid, i, &bytes, &size));
        const bool fits = append(all, bytes, size);
        vplBytes_Free(vplScene_GetContext(scene), bytes);
        if (!fits) {
            return VPL_OUT_OF_MEMORY;
        }
        if (!showProgress(progress, (i + 1.0 - first) / (end - first))) {
            return VPL_CANCELLED;
        }
    }
    return VPL_SUCCESS;
}

int renderTile(const Arguments* a, vplScene* scene)
{
    catchInterrupts();
    Progress progress = beginProgress(a->quiet);
    vplRenderOptions options = a->render;
    options.progress = askInterrupts;
    vplRenderer* renderer = NULL;
    Bytes all = {NULL, 0};
    vplResult result = vplRenderer_Create(scene, &options, &renderer);
    result = result == VPL_SUCCESS ? makePieces(a, scene, renderer, &progress, &all) : result;
    endProgress(&progress);
    if (result == VPL_SUCCESS) {
        result = vplWriteFile(vplScene_GetContext(scene), a->output,
                              all.bytes != NULL ? all.bytes : (uint8_t*)"", all.size);
    }
    vplRenderer_Destroy(renderer);
    free(all.bytes);
    return exitCode(result, false);
}

bool checkTile(const Arguments* a)
{
    static const char* const OTHERS[] = {"frames",   "aov",       "checkpoint", "resume",
                                         "plan-out", "error-map", "stats"};
    for (size_t i = 0; i < sizeof OTHERS / sizeof *OTHERS; i++) {
        if (isGiven(a, OTHERS[i])) {
            complain("--tile writes a part of one picture, without --%s", OTHERS[i]);
            return false;
        }
    }
    return true;
}

// ---- vpl merge

// Adds all pieces of a file.
static vplResult addPart(vplContext* context, vplAssembly* assembly, const char* path)
{
    char* bytes;
    size_t size;
    TRY(vplReadFile(context, path, &bytes, &size));
    vplResult result = VPL_SUCCESS;
    for (size_t at = 0, used = 0; result == VPL_SUCCESS && at < size; at += used) {
        result = askInterrupts(NULL, 0)
                     ? vplAssembly_Add(assembly, (uint8_t*)bytes + at, size - at, path, &used)
                     : VPL_CANCELLED;
    }
    vplBytes_Free(context, (uint8_t*)bytes);
    return result;
}

// Puts the picture of all files together. An interrupt ends it; afterwards the picture is written.
static vplResult mergeParts(const Arguments* a, vplContext* context, vplImage** imageOut)
{
    vplAssembly* assembly = NULL;
    catchInterrupts();
    vplContext_SetProgress(context, askInterrupts, NULL);
    vplResult result = vplAssembly_Create(context, &assembly);
    for (int i = 0; i < a->positionalCount && result == VPL_SUCCESS; i++) {
        result = addPart(context, assembly, a->positionals[i]);
    }
    result = result == VPL_SUCCESS ? vplAssembly_GetImage(assembly, imageOut) : result;
    vplAssembly_Destroy(assembly);
    vplContext_SetProgress(context, NULL, NULL);
    return result;
}

int runMerge(const Arguments* a)
{
    if (a->output == NULL) {
        complain("merge needs -o FILE, the picture to write");
        return EXIT_USAGE;
    }
    if (!checkPictureName(a)) {
        return EXIT_USAGE;
    }
    if (!checkOutput(a->output)) {
        return EXIT_COULD_NOT;
    }
    vplContext* context;
    vplImage* image = NULL;
    int code = exitCode(openContext(a, &context), true);
    if (code == EXIT_DONE) {
        code = exitCode(mergeParts(a, context, &image), true);
    }
    if (code == EXIT_DONE) {
        code = writeWholePicture(a, image);
    }
    vplImage_Destroy(image);
    vplContext_Destroy(context);
    return code;
}
