// SPDX-License-Identifier: MIT
// Runs a fuzz target over every file of the folders named on the command line, without libFuzzer. With -v it
// prints each name before the run, so that after a crash the last name is the input at fault.
#include "fuzz.h"

#include <dirent.h>
#include <string.h>
#include <sys/stat.h>

// Runs one file. The input is a heap block of exactly `size` bytes, so that a sanitizer sees a read past the
// end. Returns false if the path is not a regular file.
static bool replayFile(const char* path)
{
    struct stat info;
    if (stat(path, &info) != 0 || !S_ISREG(info.st_mode)) {
        return false;
    }
    size_t size = (size_t)info.st_size;
    uint8_t* bytes = malloc(size ? size : 1);
    FILE* file = fopen(path, "rb");
    MUST(bytes != NULL && file != NULL && fread(bytes, 1, size, file) == size);
    fclose(file);
    LLVMFuzzerTestOneInput(bytes, size);
    free(bytes);
    return true;
}

static int replayFolder(const char* folder, bool verbose)
{
    DIR* open = opendir(folder);
    if (open == NULL) {
        return 0;
    }
    int count = 0;
    for (const struct dirent* entry = readdir(open); entry != NULL; entry = readdir(open)) {
        char path[4096];
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        if (verbose) {
            fprintf(stderr, "%s\n", path);
        }
        count += replayFile(path);
    }
    closedir(open);
    return count;
}

int main(int wordCount, char** words)
{
    int count = 0;
    bool verbose = wordCount > 1 && strcmp(words[1], "-v") == 0;
    for (int i = 1 + verbose; i < wordCount; i++) {
        count += replayFolder(words[i], verbose);
    }
    printf("%d inputs replayed\n", count);
    return count == 0; // an empty or missing corpus must not pass
}
