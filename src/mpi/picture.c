// SPDX-License-Identifier: MIT
// One picture by pieces. Rank 0 puts them together and appends them to the file of --checkpoint, which vpl merge reads, too.
#include "mpi/ranks.h"

#include "cli/bench/measure.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

// Each rank gets about so many pieces. A band repeats what its pass needs (lights, maps) at another rank, so there are no
// more than dynamic scheduling needs: with 4 the last piece is at most a quarter of a rank's work.
enum { PIECES_PER_RANK = 4 };

// A picture is not divided into pieces that the plan predicts to take less time than this: each costs two messages.
static const double LEAST_MS = 10;

typedef struct Picture {
    Ranks* ranks;
    vplContext* context;
    vplRenderer* renderer;
    vplPieceGrid grid;
    vplAssembly* assembly; // at rank 0
    Journal journal;
    bool* done;
} Picture;

static vplResult makePiece(void* user, int index, uint8_t** bytesOut, size_t* sizeOut)
{
    Picture* p = user;
    uint8_t* bytes;
    TRY(vplRenderer_MakePiece(p->renderer, &p->grid, index, &bytes, sizeOut));
    *bytesOut = malloc(*sizeOut);
    if (*bytesOut != NULL) {
        memcpy(*bytesOut, bytes, *sizeOut);
    }
    vplBytes_Free(p->context, bytes);
    return *bytesOut != NULL ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
}

static int takePiece(void* user, int index, const uint8_t* bytes, size_t size)
{
    Picture* p = user;
    size_t used;
    (void)index;
    if (!appendJournal(&p->journal, bytes, size)) {
        return EXIT_COULD_NOT;
    }
    return exitCode(vplAssembly_Add(p->assembly, bytes, size, "a piece from another rank", &used), false);
}

// ---- going on with a file of pieces

// Adds the pieces at the front of a file. *keptOut is the size of those that are whole.
static int readPieces(void* user, const char* path, const uint8_t* bytes, size_t size, size_t* keptOut)
{
    Picture* p = user;
    size_t at = 0, used = 0;
    vplResult result = VPL_SUCCESS;
    while (at < size && result == VPL_SUCCESS) {
        setSpeaker(NULL); // a damaged last piece is no error here: a warning follows
        result = vplAssembly_Add(p->assembly, bytes + at, size - at, path, &used);
        setSpeaker(p->ranks->speaker);
        at += result == VPL_SUCCESS ? used : 0;
    }
    if (result == VPL_PARSE_ERROR && at == 0) {
        complain("%s: has no whole piece of a picture", path);
        return EXIT_USAGE;
    }
    if (result == VPL_PARSE_ERROR && !p->ranks->arguments->quiet) {
        complain("warning: %s: its last %zu bytes are no whole piece and are dropped", path, size - at);
    }
    if (result != VPL_SUCCESS && result != VPL_PARSE_ERROR) {
        complain("%s: a piece after %zu bytes is of another picture than the first", path, at);
        return exitCode(result, true);
    }
    *keptOut = at;
    return exitCode(vplAssembly_CheckRenderer(p->assembly, p->renderer), true);
}

// ---- the division

// A file of pieces keeps its division, whatever the number of ranks.
static vplResult divide(Picture* p)
{
    const vplPieceGrid before =
        p->assembly != NULL ? vplAssembly_GetGrid(p->assembly) : (vplPieceGrid){.count = 0};
    int bands = before.count > 0 ? before.bands : p->ranks->options.bands;
    TRY(vplRenderer_Divide(p->renderer, 1, &p->grid));
    if (bands == 0 && p->ranks->count > 1) {
        const vplPlan* plan = vplRenderer_GetPlan(p->renderer);
        const double once = plan->firstMs - plan->passMs, pieces = (plan->predictedMs - once) / LEAST_MS;
        const int most = PIECES_PER_RANK * p->ranks->count, least = p->ranks->count;
        const int wanted = pieces < least ? least : pieces < most ? (int)pieces : most;
        bands = (wanted + p->grid.passes - 1) / p->grid.passes;
    }
    return bands > 1 ? vplRenderer_Divide(p->renderer, bands, &p->grid) : VPL_SUCCESS;
}

// Makes the light of patches together, unless no piece is left to be drawn. An exit code for all ranks.
static int shareLight(Picture* p, int code)
{
    bool left = false;
    for (int i = 0; i < p->grid.count && code == EXIT_DONE; i++) {
        left = left || !p->done[i];
    }
    if (shareNumber(p->ranks, left) != 0) {
        const double start = wallMs();
        code = exitCode(vplRenderer_Prepare(p->renderer), false);
        p->ranks->stats.busyMs += wallMs() - start - p->ranks->stats.waitMs;
    }
    dissolveTeam(p->ranks);
    return largestNumber(p->ranks, code);
}

static int prepare(Picture* p, const vplScene* scene, Work* work)
{
    vplRenderOptions options = p->ranks->arguments->render;
    options.progress = attendWork;
    options.progressUser = work;
    const bool zero = p->ranks->rank == 0;
    int code = formTeam(p->ranks);
    code = code == EXIT_DONE ? exitCode(vplRenderer_Create(scene, &options, &p->renderer), true) : code;
    if (code == EXIT_DONE) {
        p->ranks->stats.plannedBytes = (double)vplRenderer_GetPlan(p->renderer)->peakBytes;
    }
    if (code == EXIT_DONE && zero) {
        code = exitCode(vplAssembly_Create(p->context, &p->assembly), false);
        code = code == EXIT_DONE
                   ? openJournal(&p->journal, p->context, p->ranks->arguments, NULL, readPieces, p)
                   : code;
        code = code == EXIT_DONE ? exitCode(divide(p), true) : code;
    }
    code = largestNumber(p->ranks, code);
    const int bands = shareNumber(p->ranks, p->grid.bands);
    if (code == EXIT_DONE && !zero) {
        code = exitCode(vplRenderer_Divide(p->renderer, bands, &p->grid), true);
    }
    p->done = calloc((size_t)p->grid.count + 1, sizeof *p->done);
    if (code == EXIT_DONE && p->done == NULL) {
        complain("out of memory");
        code = EXIT_COULD_NOT;
    }
    for (int i = 0; code == EXIT_DONE && zero && i < p->grid.count; i++) {
        p->done[i] = vplAssembly_GetGrid(p->assembly).count > 0 && vplAssembly_Has(p->assembly, i);
    }
    work->count = p->grid.count;
    work->done = zero ? p->done : NULL;
    return shareLight(p, largestNumber(p->ranks, code));
}

static int finish(Picture* p, double start)
{
    const Arguments* a = p->ranks->arguments;
    vplImage* image = NULL;
    vplLayers* layers = NULL;
    uint64_t hash = 0;
    int code = exitCode(a->render.output.aovs != 0 ? vplAssembly_GetLayers(p->assembly, p->renderer, &layers)
                                                   : vplAssembly_GetImage(p->assembly, &image),
                        false);
    if (code == EXIT_DONE) {
        hash = vplImage_Hash(layers != NULL ? layers->images[0] : image);
        code = layers != NULL ? writeLayers(layers, a->output) : writeWholePicture(a, image);
    }
    vplLayers_Destroy(layers);
    vplImage_Destroy(image);
    return code == EXIT_DONE ? reportRanks(p->ranks, wallMs() - start, hash) : code;
}

int renderPieces(Ranks* r, vplScene* scene)
{
    const double start = wallMs();
    Picture p = {.ranks = r, .context = vplScene_GetContext(scene), .journal = {.file = -1}};
    Progress progress = beginProgress(r->arguments->quiet);
    Work work = {.name = "pieces",
                 .make = makePiece,
                 .take = takePiece,
                 .user = &p,
                 .progress = &progress,
                 .checkpoint = r->arguments->checkpoint};
    int code = prepare(&p, scene, &work);
    if (code == EXIT_DONE) {
        code = runWork(r, &work);
    }
    if (r->rank == 0) {
        endProgress(&progress);
        if (!closeJournal(&p.journal) && code == EXIT_DONE) {
            code = EXIT_COULD_NOT;
        }
        code = code == EXIT_DONE ? finish(&p, start) : code;
    }
    free(p.done);
    vplAssembly_Destroy(p.assembly);
    vplRenderer_Destroy(p.renderer);
    return shareNumber(r, code);
}
