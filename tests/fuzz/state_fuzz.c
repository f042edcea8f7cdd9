// SPDX-License-Identifier: MIT
// Passes arbitrary bytes as the state of a render, with a checksum that is made right, and with the options of the render if
// they have none: loading must log one sentence, or give a render that goes on.
#define _GNU_SOURCE
#include "fuzz.h"

#include "../plain_options.h"

#include "base/file.h"
#include "render/replay.h"
#include "render/state_file.h"

#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

// Renders in passes: every way in which sums are kept. Radiosity has no passes, so only a budget or an error gives it a state.
static const char* const CASES[] = {
    "--method path",
    "--method keller",
    "--method instant-radiosity --pipeline interleaved --grow-from 1",
    "--method ssvp --clusters 1 --first-bounce 2 --second-bounce 2 --paraboloid 2 --rsm-size 2",
    "--method path --aov direct,depth",
    "--method keller --pixel-size 2 --size 4x4",
    "--method path --pixel-size 2 --size 4x4",
    "--method auto --passes 1"};
enum { CASE_COUNT = sizeof CASES / sizeof *CASES, FIXED_CASES = 2 };

static vplRenderOptions makeOptions(int i)
{
    vplRenderOptions o = plainOptions();
    o.output.width = o.output.height = 2;
    o.particles.count = 2;
    o.shadow.mapSize = 2;
    o.path.samples = 3;
    o.stop.passes = 2;
    MUST(vplRenderOptions_SetAll(&o, CASES[i]) == VPL_SUCCESS);
    return o;
}

// The bytes of a state file.
typedef struct State {
    uint8_t* bytes;
    size_t size;
} State;

// Makes the checksum right.
static void sumUp(State* s)
{
    const size_t summed = s->size >= 8 ? (s->size - 8) & ~(size_t)3 : 0;
    vplStream stream = {.bytes = s->bytes, .at = summed, .writes = true};
    uint64_t checksum = vplState_Checksum(s->bytes, summed);
    if (summed > 0) {
        vplStream_Long(&stream, &checksum);
    }
}

// Inputs without options get those of the render, its scene and the version, so that they last when options change. Their
// scene says which of CASES it is; -1: the input has options of its own.
static int caseOf(const uint8_t* bytes, size_t size, vplStateHeader* h)
{
    vplStream s = {.bytes = (uint8_t*)bytes, .finite = true};
    if (size < VPL_STATE_HEADER_BYTES || memcmp(bytes, VPL_STATE_MAGIC, VPL_STATE_MAGIC_BYTES) != 0) {
        return -1;
    }
    vplState_StreamHeader(&s, h);
    return h->textBytes == 0 ? (int)(h->scene % CASE_COUNT) : -1;
}

static State completeState(const vplRenderer* r, vplStateHeader h, const uint8_t* bytes, size_t size)
{
    vplByteBuffer text = {.context = vplRenderer_ContextOf(r)};
    vplReplayList(vplRenderer_GetPlan(r), &text);
    State s = {malloc(size + text.size), size + text.size};
    MUST(s.bytes != NULL && !text.failed);
    vplStream stream = {.bytes = s.bytes, .writes = true};
    h.version = VPL_STATE_VERSION;
    h.scene = vplRenderer_HashScene(r);
    h.textBytes = (uint32_t)text.size;
    h.edges[1] %= 16; // paths, which loading traces again
    memcpy(s.bytes, bytes, VPL_STATE_MAGIC_BYTES);
    vplState_StreamHeader(&stream, &h);
    memcpy(s.bytes + stream.at, text.bytes, text.size);
    memcpy(s.bytes + stream.at + text.size, bytes + stream.at, size - stream.at);
    vplFree(text.context, text.bytes);
    return s;
}

static State copyState(const uint8_t* bytes, size_t size)
{
    State s = {malloc(size + 1), size};
    MUST(s.bytes != NULL);
    memcpy(s.bytes, bytes, size);
    return s;
}

static int openFile(const State* s, char* name, size_t nameSize)
{
    const int fd = memfd_create("state", MFD_CLOEXEC);
    MUST(fd >= 0 && write(fd, s->bytes, s->size) == (ssize_t)s->size);
    snprintf(name, nameSize, "/proc/self/fd/%d", fd);
    return fd;
}

// Loads the state and goes on.
static void load(vplRenderer* r, const State* s, FuzzLog* log)
{
    char name[64];
    const int fd = openFile(s, name, sizeof name);
    vplImage* image = NULL;
    bool done;
    *log = (FuzzLog){{0}, 0};
    const vplResult result = vplRenderer_Load(r, name, &done);
    MUST(isPrintable(log->message) && log->errors == (result != VPL_SUCCESS));
    MUST(vplRenderer_Step(r, &done) == VPL_SUCCESS); // also after a failure
    MUST(vplRenderer_GetImage(r, &image, NULL) == VPL_SUCCESS);
    vplImage_Destroy(image);
    close(fd);
}

int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size)
{
    FuzzLog log = {{0}, 0};
    vplContext* context = openFuzzContext(&log);
    vplScene* scene = makeFuzzScene(context);
    vplStateHeader h;
    const int only = caseOf(bytes, size, &h);
    for (int i = only >= 0 ? only : 0; i < (only >= 0 ? only + 1 : FIXED_CASES); i++) {
        const vplRenderOptions options = makeOptions(i);
        vplRenderer* r;
        MUST(vplRenderer_Create(scene, &options, &r) == VPL_SUCCESS);
        State s = only >= 0 ? completeState(r, h, bytes, size) : copyState(bytes, size);
        sumUp(&s);
        load(r, &s, &log);
        free(s.bytes);
        vplRenderer_Destroy(r);
    }
    vplScene_Destroy(scene);
    closeFuzzContext(context);
    return 0;
}
