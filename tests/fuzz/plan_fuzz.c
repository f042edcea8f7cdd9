// SPDX-License-Identifier: MIT
// Passes arbitrary bytes as a plan file: the reader must either log one sentence with file, line and column,
// or set options, all in their ranges. With little work and a tiny scene these make a plan, whose list of options makes the
// same list again.
#define _GNU_SOURCE
#include "valid.h"

#include "render/replay.h"

#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#define FOLDER "/proc/self/fd/"

// Plans, and lists the options that make the plan again. Returns false where the render is refused.
static bool listPlan(const vplScene* scene, const vplRenderOptions* options, vplByteBuffer* text)
{
    vplPlan* plan;
    *text = (vplByteBuffer){.context = vplScene_GetContext(scene)};
    if (vplPlan_Create(scene, options, NULL, &plan) != VPL_SUCCESS) {
        return false;
    }
    const bool renders = plan->problem[0] == 0;
    vplReplayList(plan, text);
    vplByteBuffer_Append(text, "", 1);
    MUST(!text->failed);
    vplPlan_Destroy(plan);
    return renders;
}

// Sets the options of a list, which it overwrites.
static vplRenderOptions readList(char* list)
{
    vplRenderOptions options = vplDefaultRenderOptions();
    for (char* line = strtok(list, "\n"); line != NULL; line = strtok(NULL, "\n")) {
        char* equals = strchr(line, '=');
        MUST(equals != NULL);
        *equals = 0;
        MUST(vplRenderOptions_Set(&options, line, equals + 1) == VPL_SUCCESS);
    }
    return options;
}

static void replay(vplContext* context, vplRenderOptions options)
{
    vplScene* scene = makeFuzzScene(context);
    vplByteBuffer first, second = {.bytes = NULL};
    MUST(vplRenderOptions_SetAll(&options, SMALL " --quality none --budget 0 --max-error 0") == VPL_SUCCESS);
    if (listPlan(scene, &options, &first)) {
        char* list = strdup((char*)first.bytes);
        MUST(list != NULL);
        const vplRenderOptions again = readList(list);
        MUST(listPlan(scene, &again, &second) && strcmp((char*)first.bytes, (char*)second.bytes) == 0);
        free(list);
    }
    vplFree(context, first.bytes);
    vplFree(context, second.bytes);
    vplScene_Destroy(scene);
}

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
        replay(context, options);
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
