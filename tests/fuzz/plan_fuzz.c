// SPDX-License-Identifier: MIT
// Passes arbitrary bytes as a plan file: the reader must either log one sentence with file, line and column,
// or set options, all in their ranges.
#define _GNU_SOURCE
#include "fuzz.h"

#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#define FOLDER "/proc/self/fd/"

int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size)
{
    FuzzLog log = {{0}, 0};
    vplContext* context = openFuzzContext(&log);
    char name[64];
    const int fd = memfd_create("plan", MFD_CLOEXEC);
    MUST(fd >= 0 && write(fd, bytes, size) == (ssize_t)size);
    snprintf(name, sizeof name, FOLDER "%d", fd);
    vplRenderOptions options = vplDefaultRenderOptions();
    const vplRenderOptions before = options;
    uint64_t hash = 0;
    const vplResult result = vplRenderOptions_Load(context, name, &options, &hash);
    MUST(isPrintable(log.message));
    if (result == VPL_SUCCESS) {
        int count;
        const vplOption* rows = vplGetOptions(&count);
        MUST(log.errors == 0);
        for (int i = 0; i < count; i++) { // what was set can be written and set again
            char text[64];
            MUST(rows[i].kind == VPL_OPTION_PART ||
                 (vplRenderOptions_Get(&options, rows[i].name, text, sizeof text) == VPL_SUCCESS &&
                  vplRenderOptions_Set(&options, rows[i].name, text) == VPL_SUCCESS));
        }
    } else {
        int line, column, used = 0;
        MUST(result == VPL_PARSE_ERROR && log.errors == 1 && memcmp(&options, &before, sizeof options) == 0);
        MUST(sscanf(log.message + strcspn(log.message, ":"), ":%d:%d: %n", &line, &column, &used) == 2 &&
             used > 0);
        MUST(line >= 1 && column >= 1);
    }
    close(fd);
    closeFuzzContext(context);
    return 0;
}
