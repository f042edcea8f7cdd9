// SPDX-License-Identifier: MIT
// Passes arbitrary bytes as a scene file: the reader must either log one sentence with file, line and column,
// or make a scene that every pipeline renders to reproducible, finite bits.
#define _GNU_SOURCE
#include "fuzz.h"

#include "../plain_options.h"

#include <math.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#define FOLDER "/proc/self/fd/"

// Gives bytes in memory a file name under /proc, because the reader opens files by name.
static int writeMemoryFile(const uint8_t* bytes, size_t size, char* name, size_t nameSize)
{
    int fd = memfd_create("scene", MFD_CLOEXEC);
    MUST(fd >= 0);
    MUST(write(fd, bytes, size) == (ssize_t)size);
    snprintf(name, nameSize, FOLDER "%d", fd);
    return fd;
}

static void requireFinite(const vplImage* image)
{
    for (int i = 0; i < 3 * image->width * image->height; i++) {
        MUST(isfinite(image->pixels[i]));
    }
}

static void renderEveryWay(const vplScene* scene)
{
    uint64_t hash = 0;
    vplResult first = VPL_SUCCESS;
    for (int way = VPL_ACCUMULATE_MULTIPASS; way <= VPL_ACCUMULATE_INTERLEAVED; way++) {
        vplRenderOptions options = plainOptions();
        options.output.antialias = way == VPL_ACCUMULATE_INTERLEAVED ? 8 : 1; // passes are not smoothed
        options.output.width = 12;
        options.output.height = 8;
        options.particles.count = 4;
        options.shadow.mapSize = 4;
        options.pipeline.batch = 3;
        options.pipeline.interleave = 2;
        options.pipeline.kind = (vplAccumulation)way;
        vplImage* image = NULL;
        vplRenderStats stats;
        vplResult result = vplRender(scene, &options, &image, &stats);
        first = way == 0 ? result : first;
        MUST(result == first);
        if (result == VPL_SUCCESS) {
            requireFinite(image);
            hash = way == 0 ? stats.imageHash : hash;
            MUST(way == VPL_ACCUMULATE_INTERLEAVED || stats.imageHash == hash);
        }
        vplImage_Destroy(image);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size)
{
    FuzzLog log = {{0}, 0};
    vplContext* context = openFuzzContext(&log);
    char name[64];
    int fd = writeMemoryFile(bytes, size, name, sizeof name);
    vplScene* scene = NULL;
    vplResult result = vplScene_Load(context, name, &scene);
    MUST(isPrintable(log.message));
    if (result == VPL_SUCCESS) {
        MUST(log.errors == 0);
        if (vplScene_GetObjectCount(scene) <= 8 && vplScene_GetEmitterCount(scene) <= 3) {
            renderEveryWay(scene);
        }
    } else {
        MUST(result == VPL_PARSE_ERROR && scene == NULL && log.errors == 1);
        MUST(strncmp(log.message, FOLDER, strlen(FOLDER)) == 0); // the scene file, or a mesh beside it
        size_t file = strcspn(log.message, ":");
        int line, column, used = 0;
        MUST(sscanf(log.message + file, ":%d:%d: %n", &line, &column, &used) == 2 && used > 0);
        MUST(line >= 1 && column >= 1 && log.message[file + (size_t)used] != 0);
    }
    vplScene_Destroy(scene);
    close(fd);
    closeFuzzContext(context);
    return 0;
}
