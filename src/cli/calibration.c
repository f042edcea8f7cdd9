// SPDX-License-Identifier: MIT
#include "cli/calibration.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/utsname.h>
#include <unistd.h>

typedef struct Field {
    const char* name;
    size_t offset; // in vplSpeeds
    const char* text;
} Field;

static const Field FIELDS[] = {
    {"build_triangle", offsetof(vplSpeeds, buildTriangle), "ns to add a triangle to the ray tree"},
    {"draw_triangle", offsetof(vplSpeeds, drawTriangle), "ns to draw a small triangle"},
    {"draw_texel", offsetof(vplSpeeds, drawTexel), "ns to draw a texel of a shadow map"},
    {"draw_pixel", offsetof(vplSpeeds, drawPixel), "ns to draw a pixel without light"},
    {"pixel_light", offsetof(vplSpeeds, pixelLight), "ns to add a light to a pixel"},
    {"shadow_ray", offsetof(vplSpeeds, shadowRay), "ns for a shadow ray"},
    {"path_ray", offsetof(vplSpeeds, pathRay), "ns for a ray of a path"},
    {"form_factor", offsetof(vplSpeeds, formFactor), "ns for a form factor"},
    {"threads", offsetof(vplSpeeds, threads), "times as fast with all threads as with one"}};
enum { FIELD_COUNT = sizeof FIELDS / sizeof *FIELDS, LARGEST_FILE = 1 << 16 };

static double* valueOf(vplSpeeds* speeds, int field)
{
    return (double*)(void*)((char*)speeds + FIELDS[field].offset);
}

// ---- the file

// Adds the processor's name to the hash: FNV-1a of the lines of /proc/cpuinfo that tell models apart.
static uint64_t hashMachine(uint64_t hash)
{
    static const char* const keys[] = {"model name", "CPU implementer", "CPU part", "cpu MHz max"};
    char line[256];
    FILE* file = fopen("/proc/cpuinfo", "r");
    while (file != NULL && fgets(line, sizeof line, file) != NULL && line[0] != '\n') {
        for (size_t i = 0; i < sizeof keys / sizeof *keys; i++) {
            for (const char* c = line; strncmp(line, keys[i], strlen(keys[i])) == 0 && *c != 0; c++) {
                hash = (hash ^ (unsigned char)*c) * 0x100000001b3u;
            }
        }
    }
    if (file != NULL) {
        fclose(file);
    }
    return hash;
}

// The name of the file for this machine, this version, and the context's threads and instruction set. Makes its folder
// if `create`. Returns false where there is no folder that can be used.
static bool nameFile(const vplContext* context, bool create, char path[PATH_MAX])
{
    const char *cache = getenv("XDG_CACHE_HOME"), *home = getenv("HOME");
    const bool xdg = cache != NULL && cache[0] == '/'; // relative ones are to be ignored
    char folder[PATH_MAX], words[128];
    struct utsname name;
    if (!xdg && (home == NULL || home[0] != '/')) {
        return false;
    }
    int length = snprintf(folder, sizeof folder, "%s%s", xdg ? cache : home, xdg ? "" : "/.cache");
    if (length < 0 || length > PATH_MAX - 100) {
        return false;
    }
    if (create) {
        mkdir(folder, 0700);
    }
    strcat(folder, "/libvpl");
    if (create) {
        mkdir(folder, 0700);
    }
    uint64_t hash = hashMachine(0xcbf29ce484222325u);
    snprintf(words, sizeof words, "%.40s %s %d", uname(&name) == 0 ? name.machine : "",
             vplIsa_GetName(vplContext_GetIsa(context)), vplContext_GetWorkerCount(context));
    for (const char* c = words; *c != 0; c++) {
        hash = (hash ^ (unsigned char)*c) * 0x100000001b3u;
    }
    length = snprintf(path, PATH_MAX, "%s/speeds-%s-%016llx.json", folder, vplGetVersion(),
                      (unsigned long long)hash);
    return length > 0 && length < PATH_MAX && (!create || access(folder, W_OK | X_OK) == 0);
}

// Returns false unless the file is there and good.
static bool readSpeeds(const char* path, vplSpeeds* speedsOut)
{
    struct stat info;
    const bool small = stat(path, &info) == 0 && S_ISREG(info.st_mode) && info.st_size <= LARGEST_FILE;
    json_t* root = small ? json_load_file(path, 0, NULL) : NULL;
    vplSpeeds speeds = {0};
    bool good = root != NULL;
    for (int i = 0; i < FIELD_COUNT && good; i++) {
        const double value = json_number_value(json_object_get(root, FIELDS[i].name));
        good = value > 0 && value < 1e9;
        *valueOf(&speeds, i) = value;
    }
    json_decref(root);
    *speedsOut = good ? speeds : *speedsOut;
    return good;
}

static json_t* speedsJson(vplSpeeds speeds)
{
    json_t* root = json_object();
    for (int i = 0; i < FIELD_COUNT; i++) {
        json_object_set_new(root, FIELDS[i].name, json_real(*valueOf(&speeds, i)));
    }
    return root;
}

// Writes the whole file or nothing, without a word.
static bool writeSpeeds(const char* path, const vplSpeeds* speeds)
{
    json_t* root = speedsJson(*speeds);
    char* text = json_dumps(root, JSON_INDENT(2) | JSON_REAL_PRECISION(6));
    vplContext* silent = NULL;
    const bool open = text != NULL && vplContext_Create(NULL, &silent) == VPL_SUCCESS;
    catchInterrupts();
    const bool written = open && vplWriteFile(silent, path, text, strlen(text)) == VPL_SUCCESS;
    vplContext_Destroy(silent);
    free(text);
    json_decref(root);
    return written;
}

// ---- the two uses

vplResult findSpeeds(const Arguments* a, vplContext* context)
{
    const vplStopOptions* stop = &a->render.stop;
    const bool budget = stop->budgetMs > 0 || stop->quality != VPL_QUALITY_NONE;
    const bool needed = budget && (a->command->bit & (RENDER | INFO)) != 0;
    char path[PATH_MAX];
    vplSpeeds speeds;
    if (nameFile(context, false, path) && readSpeeds(path, &speeds)) {
        return vplContext_SetSpeeds(context, &speeds);
    }
    if (needed && nameFile(context, true, path)) {
        TRY(vplSpeeds_Measure(context, &speeds));
        TRY(vplContext_SetSpeeds(context, &speeds));
        const bool kept = writeSpeeds(path, &speeds);
        if (a->verbose) {
            complain("measured the speeds of this machine, %s %s",
                     kept ? "kept in" : "which could not be kept in", path);
        }
    } else if (needed && a->verbose) {
        complain("there is no cache folder to keep the speeds of this machine in; times are predicted by "
                 "those of the "
                 "machine of our benchmarks");
    }
    return VPL_SUCCESS;
}

int runCalibration(const Arguments* a)
{
    char path[PATH_MAX];
    vplSpeeds speeds = {0};
    vplContext* context;
    int code = exitCode(openContext(a, &context), true);
    if (code == EXIT_DONE) {
        code = exitCode(vplSpeeds_Measure(context, &speeds), false);
    }
    const bool kept = code == EXIT_DONE && nameFile(context, true, path) && writeSpeeds(path, &speeds);
    vplContext_Destroy(context);
    if (code == EXIT_DONE && a->json) {
        code = writeJson(speedsJson(speeds), 6, NULL);
    } else if (code == EXIT_DONE) {
        for (int i = 0; i < FIELD_COUNT; i++) {
            printf("  %-16s %10.3g %s\n", FIELDS[i].name, *valueOf(&speeds, i), FIELDS[i].text);
        }
        printf("%s%s\n", kept ? "kept in " : "not kept, because there is no cache folder that can be written",
               kept ? path : "");
    }
    return code;
}
