// SPDX-License-Identifier: MIT
// Frames of a sequence: each rank renders whole frames and sends the bytes of their files, which rank 0 writes. The file of
// --checkpoint has a line for each frame that was written.
#include "mpi/ranks.h"

#include "cli/bench/measure.h"
#include "cli/tradeoff/tradeoff.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct Frames {
    Ranks* ranks;
    vplScene* scene;
    vplContext* context;
    vplRenderOptions options;
    vplWriteOptions display; // its exposure is that of the first frame
    bool* done;
    Journal journal;
    char title[64]; // the first line of the journal: hashes of scene and options
} Frames;

// What comes before the bytes of a frame's file.
typedef struct FrameHeader {
    double exposure;
    uint64_t hash;
} FrameHeader;

static bool nameFrame(const Frames* f, int index, char path[PATH_MAX])
{
    const Arguments* a = f->ranks->arguments;
    return numberName(a->output, a->frames[0] + index, a->frames[1], path, PATH_MAX);
}

// Encodes a picture, or layers.
static vplResult encode(Frames* f, vplImage* image, const vplLayers* layers, const char* path,
                        uint8_t** bytesOut, size_t* sizeOut)
{
    FrameHeader header = {.hash = vplImage_Hash(image)};
    uint8_t* bytes;
    size_t size;
    if (layers == NULL && preparePicture(f->ranks->arguments, image, path, &f->display) != EXIT_DONE) {
        return VPL_OUT_OF_MEMORY;
    }
    header.exposure = (double)f->display.exposure;
    TRY(layers != NULL ? vplImage_EncodeLayers(layers->layers, layers->count, &bytes, &size)
                       : vplImage_Encode(image, path, &f->display, &bytes, &size));
    *sizeOut = sizeof header + size;
    *bytesOut = malloc(*sizeOut);
    if (*bytesOut != NULL) {
        memcpy(*bytesOut, &header, sizeof header);
        memcpy(*bytesOut + sizeof header, bytes, size);
    }
    vplBytes_Free(f->context, bytes);
    return *bytesOut != NULL ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
}

static vplResult makeFrame(void* user, int index, uint8_t** bytesOut, size_t* sizeOut)
{
    Frames* f = user;
    const bool layered = f->options.output.aovs != 0;
    vplImage* image = NULL;
    vplLayers* layers = NULL;
    char path[PATH_MAX];
    nameFrame(f, index, path); // renderFrames has checked the lengths
    f->options.sequence.frame = f->ranks->arguments->frames[0] + index;
    TRY(vplScene_SetFrame(f->scene, f->options.sequence.frame));
    TRY(layered ? vplRenderLayers(f->scene, &f->options, &layers, NULL)
                : vplRender(f->scene, &f->options, &image, NULL));
    const vplResult result = encode(f, layered ? layers->images[0] : image, layers, path, bytesOut, sizeOut);
    vplLayers_Destroy(layers);
    vplImage_Destroy(image);
    return result;
}

static int takeFrame(void* user, int index, const uint8_t* bytes, size_t size)
{
    Frames* f = user;
    FrameHeader header;
    char path[PATH_MAX], line[128];
    nameFrame(f, index, path);
    memcpy(&header, bytes, sizeof header);
    f->display.exposure = index == 0 ? (float)header.exposure : f->display.exposure;
    const int code =
        exitCode(vplWriteFile(f->context, path, bytes + sizeof header, size - sizeof header), false);
    const int length = snprintf(line, sizeof line, "%d %a %016llx\n", f->ranks->arguments->frames[0] + index,
                                header.exposure, (unsigned long long)header.hash);
    if (code != EXIT_DONE || !appendJournal(&f->journal, line, (size_t)length)) {
        return EXIT_COULD_NOT;
    }
    f->done[index] = true;
    return EXIT_DONE;
}

// ---- going on

static const uint64_t EMPTY_HASH = 0xcbf29ce484222325u;

// FNV-1a.
static uint64_t hashBytes(uint64_t hash, const void* bytes, size_t size)
{
    for (size_t i = 0; i < size; i++) {
        hash = (hash ^ ((const uint8_t*)bytes)[i]) * 0x100000001b3u;
    }
    return hash;
}

// The hash of a scene is of where its objects stand now, not of their paths.
static uint64_t hashPaths(const vplScene* scene)
{
    uint64_t hash = EMPTY_HASH;
    for (int i = 0; i < vplScene_GetObjectCount(scene); i++) {
        int count;
        const vplTransformKey* keys = vplScene_GetObjectPath(scene, i, &count);
        if (keys != NULL) {
            hash = hashBytes(hashBytes(hash, &i, sizeof i), keys, (size_t)count * sizeof *keys);
        }
    }
    return hash;
}

static void writeTitle(Frames* f)
{
    const Arguments* a = f->ranks->arguments;
    char words[4096];
    writeCommand(&a->render, words, sizeof words - 64);
    snprintf(words + strlen(words), 64, " exposure %a tonemap %d", a->exposure, a->tonemap);
    snprintf(f->title, sizeof f->title, "vpl-mpi frames %016llx %016llx\n",
             (unsigned long long)vplScene_GetHash(f->scene),
             (unsigned long long)hashBytes(hashPaths(f->scene), words, strlen(words)));
}

// Marks the frames that a journal names and whose files are there. *keptOut is the size of its whole lines.
static int readLines(void* user, const char* path, const uint8_t* bytes, size_t size, size_t* keptOut)
{
    Frames* f = user;
    const char* text = (const char*)bytes;
    const Arguments* a = f->ranks->arguments;
    const size_t title = strlen(f->title);
    if (size < title || memcmp(text, f->title, title) != 0) {
        complain("%s: is no list of frames of this scene with these options, which begins with %.*s", path,
                 (int)title - 1, f->title);
        return EXIT_USAGE;
    }
    size_t at = title;
    for (const char* end; (end = memchr(text + at, '\n', size - at)) != NULL; at = (size_t)(end - text) + 1) {
        int frame;
        double exposure;
        char file[PATH_MAX];
        if (sscanf(text + at, "%d %la", &frame, &exposure) != 2 || frame < a->frames[0] ||
            frame > a->frames[1]) {
            continue; // a frame of a longer sequence
        }
        const int index = frame - a->frames[0];
        f->done[index] = nameFrame(f, index, file) && access(file, R_OK) == 0;
        f->display.exposure = index == 0 && f->done[0] ? (float)exposure : f->display.exposure;
    }
    if (at < size && !a->quiet) {
        complain("warning: %s: its last %zu bytes are no whole line and are dropped", path, size - at);
    }
    *keptOut = at;
    return EXIT_DONE;
}

// ---- the sequence

// Renders the first frame alone if all others need its exposure.
static int renderFirst(Frames* f, Work* work)
{
    const int count = work->count;
    const bool waits = f->display.exposure == VPL_EXPOSURE_AUTO && (f->ranks->rank > 0 || !f->done[0]);
    int code = EXIT_DONE;
    if (shareNumber(f->ranks, waits) != 0) {
        work->count = 1;
        code = runWork(f->ranks, work);
        work->count = count;
    }
    int bits;
    memcpy(&bits, &f->display.exposure, sizeof bits);
    bits = shareNumber(f->ranks, bits);
    memcpy(&f->display.exposure, &bits, sizeof bits);
    return code;
}

static int checkNames(const Frames* f)
{
    char path[PATH_MAX];
    const Arguments* a = f->ranks->arguments;
    if (!nameFrame(f, a->frames[1] - a->frames[0], path)) {
        complain("%s: the name is too long", a->output);
        return EXIT_USAGE;
    }
    return checkOutput(path) ? EXIT_DONE : EXIT_COULD_NOT;
}

int renderFrames(Ranks* r, vplScene* scene)
{
    const double start = wallMs();
    const Arguments* a = r->arguments;
    Frames f = {.ranks = r,
                .scene = scene,
                .context = vplScene_GetContext(scene),
                .options = a->render,
                .display = chooseDisplay(a),
                .journal = {.file = -1}};
    Progress progress = beginProgress(a->quiet);
    Work work = {.name = "frames",
                 .count = a->frames[1] - a->frames[0] + 1,
                 .make = makeFrame,
                 .take = takeFrame,
                 .user = &f,
                 .progress = &progress,
                 .checkpoint = a->checkpoint};
    f.options.progress = attendWork;
    f.options.progressUser = &work;
    f.done = calloc((size_t)work.count, sizeof *f.done);
    work.done = r->rank == 0 ? f.done : NULL;
    writeTitle(&f);
    int code = f.done == NULL ? EXIT_COULD_NOT
                              : exitCode(vplHistory_Create(f.context, &f.options.sequence.history), false);
    if (code == EXIT_DONE && r->rank == 0) {
        code = checkNames(&f);
        code = code == EXIT_DONE ? openJournal(&f.journal, f.context, a, f.title, readLines, &f) : code;
    }
    code = largestNumber(r, code);
    code = code == EXIT_DONE ? renderFirst(&f, &work) : code;
    code = code == EXIT_DONE ? runWork(r, &work) : code;
    if (r->rank == 0) {
        endProgress(&progress);
        code = closeJournal(&f.journal) || code != EXIT_DONE ? code : EXIT_COULD_NOT;
        code = code == EXIT_DONE ? reportRanks(r, wallMs() - start, 0) : code;
    }
    vplHistory_Destroy(f.options.sequence.history);
    free(f.done);
    return shareNumber(r, code);
}
