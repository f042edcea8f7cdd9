// SPDX-License-Identifier: MIT
// The scene is read once, at rank 0, which notes every file that was read. Other ranks find these files in memory.
#include "mpi/ranks.h"

#include <stdlib.h>
#include <string.h>

typedef struct Files {
    vplMemoryFile* files;
    int count;
    bool failed; // out of memory
} Files;

static void noteFile(void* user, const vplMemoryFile* file)
{
    Files* all = user;
    vplMemoryFile* grown = realloc(all->files, ((size_t)all->count + 1) * sizeof *grown);
    all->failed = all->failed || grown == NULL;
    if (grown == NULL) {
        return;
    }
    all->files = grown;
    grown += all->count++;
    void* bytes = malloc(file->size + 1);
    grown->path = strdup(file->path);
    grown->bytes = bytes;
    grown->size = bytes != NULL ? file->size : 0;
    all->failed = all->failed || grown->path == NULL || bytes == NULL;
    if (bytes != NULL) {
        memcpy(bytes, file->bytes, file->size);
    }
}

static void freeFiles(Files* all)
{
    for (int i = 0; i < all->count; i++) {
        free((char*)all->files[i].path);
        free((void*)all->files[i].bytes);
    }
    free(all->files);
}

// Sends the files of rank 0 to all.
static bool shareFiles(Ranks* r, Files* all)
{
    const int count = shareNumber(r, all->failed ? -1 : all->count);
    bool good = count >= 0;
    if (!good) {
        complain("out of memory for the files of the scene");
    }
    if (r->rank > 0 && good) {
        all->files = calloc((size_t)count + 1, sizeof *all->files);
        good = all->files != NULL;
    }
    good = largestNumber(r, !good) == 0;
    for (int i = 0; i < count && good; i++) {
        uint8_t *path = (uint8_t*)all->files[i].path, *bytes = (uint8_t*)all->files[i].bytes;
        size_t length = path != NULL ? strlen((char*)path) : 0, size = all->files[i].size;
        good = shareBytes(r, &path, &length) && shareBytes(r, &bytes, &size);
        all->files[i] = (vplMemoryFile){(char*)path, bytes, size};
        all->count = i + 1 > all->count ? i + 1 : all->count;
    }
    return good;
}

int shareScene(Ranks* r, vplContext* context, vplScene** sceneOut)
{
    Files all = {NULL, 0, false};
    const bool reads = r->rank == 0 || r->options.shared;
    int code = EXIT_DONE;
    vplContext_SetFileObserver(context, r->rank == 0 && !r->options.shared ? noteFile : NULL, &all);
    code = reads ? exitCode(loadNamedScene(r->arguments, context, sceneOut), true) : EXIT_DONE;
    vplContext_SetFileObserver(context, NULL, NULL);
    code = largestNumber(r, code);
    if (code == EXIT_DONE && !r->options.shared) {
        code = shareFiles(r, &all) ? EXIT_DONE : EXIT_COULD_NOT;
        if (code == EXIT_DONE && r->rank > 0) {
            vplContext_SetFiles(context, all.files, all.count);
            code = exitCode(loadNamedScene(r->arguments, context, sceneOut), true);
            vplContext_SetFiles(context, NULL, 0);
        }
        code = largestNumber(r, code);
    }
    freeFiles(&all);
    return code;
}
