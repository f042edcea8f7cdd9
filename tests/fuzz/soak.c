// SPDX-License-Identifier: MIT
// Renders N random scenes with random options, valid but extreme, one after another in one process: soak N. Memory must
// be that of the first thousand (or half) at the end, and every 50th render must have the bits of the same render in a process of
// its own: soak --one SEED.
#include "valid.h"

#include "base/rng.h"

#include <inttypes.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { BYTES = 240, FRESH_EVERY = 50, MOST_GROWTH = 8 << 20 };
#ifdef __SANITIZE_ADDRESS__
enum { KEEPS_FREED_MEMORY = 1 }; // to find uses of it
#else
enum { KEEPS_FREED_MEMORY = 0 };
#endif

static uint64_t renderSeed(vplContext* context, FuzzLog* log, uint64_t seed)
{
    uint8_t bytes[BYTES];
    for (int i = 0; i < BYTES / 16; i++) {
        const vplRandom4 words = vplRandomAt(seed, 0, (uint64_t)i);
        memcpy(bytes + 16 * i, &words, 16);
    }
    *log = (FuzzLog){{0}, 0};
    const uint64_t hash = renderValid(context, log, bytes, BYTES);
    MUST(vplContext_GetBytes(context) == 0);
    return hash;
}

static vplContext* openContext(FuzzLog* log)
{
    vplContextDef def = vplDefaultContextDef();
    vplContext* context = NULL;
    def.log = fuzzLog;
    def.logUser = log;
    def.workerCount = 2;
    MUST(vplContext_Create(&def, &context) == VPL_SUCCESS);
    return context;
}

// Returns the resident size without blocks that the C library keeps for later use.
static size_t residentBytes(void)
{
#ifdef __GLIBC__
    malloc_trim(0);
#endif
    long all, resident = 0;
    FILE* file = fopen("/proc/self/statm", "r");
    MUST(file != NULL && fscanf(file, "%ld %ld", &all, &resident) == 2);
    fclose(file);
    return (size_t)resident * (size_t)sysconf(_SC_PAGESIZE);
}

static uint64_t renderAfresh(const char* program, uint64_t seed)
{
    char command[4096];
    uint64_t hash = 0;
    snprintf(command, sizeof command, "'%s' --one %" PRIu64, program, seed);
    FILE* pipe = popen(command, "r");
    MUST(pipe != NULL && fscanf(pipe, "%" SCNx64, &hash) == 1);
    MUST(pclose(pipe) == 0);
    return hash;
}

int main(int wordCount, char** words)
{
    FuzzLog log;
    vplContext* context = openContext(&log);
    const bool one = wordCount > 2 && strcmp(words[1], "--one") == 0;
    if (one) {
        printf("%016" PRIx64 "\n", renderSeed(context, &log, strtoull(words[2], NULL, 10)));
    }
    const uint64_t count = one ? 0 : wordCount > 1 ? strtoull(words[1], NULL, 10) : 20000;
    const uint64_t first = count < 2000 ? count / 2 : 1000;
    size_t settled = 0, compared = 0, pictures = 0;
    for (uint64_t seed = 0; seed < count; seed++) {
        const uint64_t hash = renderSeed(context, &log, seed);
        pictures += hash > VPL_PARSE_ERROR;
        if (seed % FRESH_EVERY == 0) {
            compared++;
            if (renderAfresh(words[0], seed) != hash) {
                printf("render %" PRIu64 " has other bits in a process of its own\n", seed);
                return 1;
            }
        }
        settled = seed + 1 == first ? residentBytes() : settled;
    }
    vplContext_Destroy(context);
    if (count > 0) {
        const size_t last = residentBytes();
        printf(
            "%" PRIu64
            " renders, %zu pictures, %zu compared with processes of their own, resident %.1f MiB after the "
            "first %" PRIu64 ", %.1f MiB at the end, processor time %.0f s\n",
            count, pictures, compared, (double)settled / 1048576, first, (double)last / 1048576,
            (double)clock() / CLOCKS_PER_SEC);
        return !KEEPS_FREED_MEMORY && last > settled + MOST_GROWTH;
    }
    return 0;
}
