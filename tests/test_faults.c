// SPDX-License-Identifier: MIT
// Files that fail: at every byte that is written or read, when they are flushed or renamed, or where they end too early.
// This program's read, write, fsync and rename replace those of the C library.
#include "cli/cli.h"
#undef TRY // that of the library is the same
#include "failing.h"
#include "patch_support.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

// ---- system calls that fail

// While armed, `limit` bytes may be read and as many written, up to `chunk` at a time. Then comes the error or, if it is
// 0, the end of the file.
static struct {
    bool armed;
    size_t limit, chunk, done;
    int error, flushError, renameError;
} faults;

static void arm(size_t limit, size_t chunk, int error)
{
    faults.armed = true;
    faults.limit = limit;
    faults.chunk = chunk;
    faults.done = 0;
    faults.error = error;
    faults.flushError = faults.renameError = 0;
}

// Takes part of `size` bytes. Returns false if there are none left. Other tests read files in threads: only what is armed is
// counted.
static bool take(size_t* size)
{
    if (!faults.armed) {
        return true;
    }
    const size_t left = faults.limit - faults.done;
    if (*size > 0) {
        *size = *size < faults.chunk ? *size : faults.chunk;
        *size = *size < left ? *size : left;
        faults.done += *size;
    }
    return left > 0;
}

static long failWith(int error)
{
    errno = error;
    return error != 0 ? -1 : 0;
}

ssize_t read(int fd, void* bytes, size_t size)
{
    if (!take(&size)) {
        return failWith(faults.error);
    }
    const long got = syscall(SYS_read, fd, bytes, size);
    if (faults.armed) {
        faults.done -= size - (size_t)got; // less before the end
    }
    return got;
}

ssize_t write(int fd, const void* bytes, size_t size)
{
    return take(&size) ? syscall(SYS_write, fd, bytes, size) : failWith(faults.error);
}

int fsync(int fd)
{
    const bool fails = faults.armed && faults.flushError != 0;
    return (int)(fails ? failWith(faults.flushError) : syscall(SYS_fsync, fd));
}

int rename(const char* from, const char* to)
{
    const bool fails = faults.armed && faults.renameError != 0;
    return (int)(fails ? failWith(faults.renameError)
                       : syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, 0));
}

// ---- what is written and read

enum { SAME_BYTES = (size_t)1 << 30 };

typedef struct Files {
    Failing failing; // counts blocks and sentences
    vplContext* context;
    char folder[32], path[64];
    vplScene* scene;
    vplImage* image;
    vplRenderer* renderer;
    vplPlan* plan;
    Arguments tile; // of vpl render --tile
    SidesFixture sides;
    vplPatchMesh* mesh;
    char sentence[300];
} Files;

static void keepSentence(void* user, vplLogLevel level, const char* message)
{
    Files* f = user;
    f->failing.errors += level == VPL_LOG_ERROR;
    snprintf(f->sentence, sizeof f->sentence, "%s", message);
}

static vplRenderOptions smallPaths(void)
{
    vplRenderOptions options = plainOptions();
    options.method = VPL_METHOD_PATH;
    options.output.width = 2;
    options.output.height = 1;
    options.path.samples = 40;
    return options;
}

static void openFiles(Files* f)
{
    const vplVec3 corners[] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    const vplRenderOptions options = smallPaths();
    bool done;
    memset(f, 0, sizeof *f);
    strcpy(f->folder, "/tmp/vpl-faults-XXXXXX");
    assert_non_null(mkdtemp(f->folder));
    f->failing.failAt = -1;
    f->context = openFailing(&f->failing);
    f->context->def.log = keepSentence;
    f->context->def.logUser = f;
    f->scene = openScene(f->context, "tests/data/room.json");
    assert_int_equal(vplImage_Create(f->context, 5, 4, &f->image), VPL_SUCCESS);
    for (int i = 0; i < 3 * 5 * 4; i++) {
        f->image->pixels[i] = 0.1f * (float)i;
    }
    assert_int_equal(vplRenderer_Create(f->scene, &options, &f->renderer), VPL_SUCCESS);
    assert_int_equal(vplRenderer_Step(f->renderer, &done), VPL_SUCCESS);
    assert_int_equal(vplPlan_Create(f->scene, &options, NULL, &f->plan), VPL_SUCCESS);
    f->tile = (Arguments){.render = options, .tile = {1, 1}, .quiet = true};
    f->sides = openFronts(f->context, corners, 1, 0, 1);
    f->mesh = meshOf(f->sides.sides);
}

static void closeFiles(Files* f)
{
    vplPatchMesh_Destroy(f->mesh);
    closeFronts(&f->sides);
    vplPlan_Destroy(f->plan);
    vplRenderer_Destroy(f->renderer);
    vplImage_Destroy(f->image);
    vplScene_Destroy(f->scene);
    assert_int_equal(vplContext_GetBytes(f->context), 0);
    vplContext_Destroy(f->context);
    assert_int_equal(f->failing.held, 0);
    assert_int_equal(rmdir(f->folder), 0); // fails if a temporary file stayed behind
}

// ---- writers

typedef vplResult FileFcn(Files* f, const char* path);

static vplResult writeImage(Files* f, const char* path)
{
    return vplImage_Write(f->image, path, NULL);
}

static vplResult writeTwoLayers(Files* f, const char* path)
{
    const vplLayer layers[] = {{.name = "", .kind = VPL_LAYER_COLOUR, .image = f->image},
                               {.name = "depth", .kind = VPL_LAYER_NUMBER, .image = f->image}};
    return vplImage_WriteLayers(layers, 2, path);
}

static vplResult writeMesh(Files* f, const char* path)
{
    const vplRgb light[100] = {{1, 2, 3}};
    return vplPatchMesh_WritePly(f->mesh, light, 1, path);
}

static vplResult writePlan(Files* f, const char* path)
{
    return vplPlan_Write(f->plan, f->scene, path);
}

static vplResult writeState(Files* f, const char* path)
{
    return vplRenderer_Save(f->renderer, path);
}

static vplResult writePart(Files* f, const char* path)
{
    f->tile.output = path;
    return renderTile(&f->tile, f->scene) == EXIT_DONE ? VPL_SUCCESS : VPL_FILE_ERROR;
}

// Statistics, tables, plots and reports of the program are such texts.
static vplResult writeText(Files* f, const char* path)
{
    return vplWriteFile(f->context, path, "{\"a\": 1}\n", 9);
}

static const struct {
    FileFcn* write;
    const char* name;
} WRITERS[] = {{writeImage, "a.png"},     {writeImage, "a.pfm"}, {writeImage, "a.hdr"}, {writeImage, "b.exr"},
               {writeTwoLayers, "c.exr"}, {writeMesh, "a.ply"},  {writePlan, "p.json"}, {writeState, "state"},
               {writeText, "a.txt"},      {writePart, "part"}};
enum { WRITER_COUNT = sizeof WRITERS / sizeof *WRITERS };

static bool canWrite(int writer)
{
    return strstr(WRITERS[writer].name, ".exr") == NULL || vplImage_CanWrite("a.exr");
}

static const char* nameIn(Files* f, const char* name)
{
    snprintf(f->path, sizeof f->path, "%s/%s", f->folder, name);
    return f->path;
}

static size_t readWhole(const char* path, char* bytes, size_t most)
{
    FILE* file = fopen(path, "rb");
    assert_non_null(file);
    const size_t size = fread(bytes, 1, most, file);
    fclose(file);
    assert_true(size < most);
    return size;
}

static int countEntries(const char* folder)
{
    DIR* open = opendir(folder);
    int count = 0;
    assert_non_null(open);
    while (readdir(open) != NULL) {
        count++;
    }
    closedir(open);
    return count;
}

// Whether the sentence has the reason of an error, in the words of the C library.
static bool tells(const Files* f, const char* what, int error)
{
    char reason[128];
    snprintf(reason, sizeof reason, "%s: %s", what, strerror(error));
    return strstr(f->sentence, reason) != NULL;
}

// Writes over an old file while faults are armed. The sentence must have the reason; the old file must stay, and no other
// file and no open descriptor.
static void requireOldFile(Files* f, int writer, int error)
{
    char bytes[16];
    const int descriptors = countEntries("/proc/self/fd");
    const vplResult result = WRITERS[writer].write(f, f->path);
    const size_t where = faults.limit;
    faults.armed = false;
    if (result != VPL_FILE_ERROR || f->failing.errors != 1 || !tells(f, "cannot write", error) ||
        readWhole(f->path, bytes, sizeof bytes) != 3 || memcmp(bytes, "old", 3) != 0 ||
        countEntries(f->folder) != 3 || countEntries("/proc/self/fd") != descriptors) {
        fail_msg("%s after %zu bytes: %s, \"%s\", %d sentences, %d files, %d descriptors",
                 WRITERS[writer].name, where, vplResult_GetName(result), f->sentence, f->failing.errors,
                 countEntries(f->folder) - 2, countEntries("/proc/self/fd") - descriptors);
    }
    f->failing.errors = 0;
}

TEST_ALONE(WritesThatFailAtAnyByteLeaveTheOldFile)
{
    static char bytes[1 << 16], pieces[1 << 16];
    Files f;
    long tried = 0;
    openFiles(&f);
    for (int writer = 0; writer < WRITER_COUNT; writer++) {
        if (!canWrite(writer)) {
            continue;
        }
        nameIn(&f, WRITERS[writer].name);
        assert_int_equal(WRITERS[writer].write(&f, f.path), VPL_SUCCESS);
        const size_t size = readWhole(f.path, bytes, sizeof bytes);
        arm(SAME_BYTES, 7, 0); // writes may be partial
        assert_int_equal(WRITERS[writer].write(&f, f.path), VPL_SUCCESS);
        faults.armed = false;
        assert_true(readWhole(f.path, pieces, sizeof pieces) == size && memcmp(bytes, pieces, size) == 0);
        assert_int_equal(vplWriteFile(f.context, f.path, "old", 3), VPL_SUCCESS);
        for (size_t limit = 0; limit < size; limit++, tried++) {
            arm(limit, SAME_BYTES, ENOSPC);
            requireOldFile(&f, writer, ENOSPC);
        }
        arm(SAME_BYTES, SAME_BYTES, 0);
        faults.flushError = EIO;
        requireOldFile(&f, writer, EIO);
        arm(SAME_BYTES, SAME_BYTES, 0);
        faults.renameError = EXDEV;
        requireOldFile(&f, writer, EXDEV);
        unlink(f.path);
        assert_int_equal(mkdir(f.path, 0700), 0);
        assert_int_equal(WRITERS[writer].write(&f, f.path), VPL_FILE_ERROR);
        assert_non_null(strstr(f.sentence, "it is a directory"));
        assert_int_equal(rmdir(f.path), 0);
        f.failing.errors = 0;
    }
    closeFiles(&f);
    printf("# %ld writes that failed\n", tried);
}

// ---- readers

static vplResult readScene(Files* f, const char* path)
{
    vplScene* scene = NULL;
    const vplResult result = vplScene_Load(f->context, path, &scene);
    assert_int_equal(result == VPL_SUCCESS, scene != NULL);
    vplScene_Destroy(scene);
    return result;
}

static vplResult readImage(Files* f, const char* path)
{
    vplImage* image = NULL;
    const vplResult result = vplImage_Read(f->context, path, &image);
    assert_int_equal(result == VPL_SUCCESS, image != NULL);
    vplImage_Destroy(image);
    return result;
}

static vplResult readEnvironment(Files* f, const char* path)
{
    vplScene* scene;
    const vplEnvironmentDef def = vplDefaultEnvironmentDef();
    assert_int_equal(vplScene_Create(f->context, &scene), VPL_SUCCESS);
    const vplResult result = vplScene_LoadEnvironment(scene, path, &def);
    assert_int_equal(vplScene_GetEnvironment(scene)->type,
                     result == VPL_SUCCESS ? VPL_ENVIRONMENT_PICTURE : VPL_ENVIRONMENT_NONE);
    vplScene_Destroy(scene);
    return result;
}

static vplResult readPlan(Files* f, const char* path)
{
    vplRenderOptions options = vplDefaultRenderOptions();
    return vplRenderOptions_Load(f->context, path, &options, NULL);
}

static vplResult readState(Files* f, const char* path)
{
    const vplRenderOptions options = smallPaths();
    vplRenderer* r;
    bool done;
    assert_int_equal(vplRenderer_Create(f->scene, &options, &r), VPL_SUCCESS);
    const vplResult result = vplRenderer_Load(r, path, &done);
    vplRenderer_Destroy(r);
    return result;
}

// As vpl merge does.
static vplResult readPart(Files* f, const char* path)
{
    vplAssembly* assembly;
    char* bytes;
    size_t size, used;
    vplResult result = vplReadFile(f->context, path, &bytes, &size);
    if (result == VPL_SUCCESS) {
        assert_int_equal(vplAssembly_Create(f->context, &assembly), VPL_SUCCESS);
        result = vplAssembly_Add(assembly, (uint8_t*)bytes, size, path, &used);
        vplAssembly_Destroy(assembly);
        vplBytes_Free(f->context, (uint8_t*)bytes);
    }
    return result;
}

static const struct {
    FileFcn* read;
    const char* path;
    int writer; // that makes the file; -1: it is there
} READERS[] = {{readScene, "tests/data/room.json", -1},
               {readScene, "tests/data/obj/meshes.json", -1},
               {readScene, "tests/data/obj/everything.obj", -1}, // with two MTL files
               {readScene, "tests/data/gltf/everything.glb", -1},
               {readScene, "tests/data/gltf/apart/triangle.gltf", -1}, // with a buffer and two pictures
               {readScene, "tests/data/textured.json", -1},
               {readScene, "tests/data/ply/odd/more-elements.ply", -1},
               {readScene, "tests/data/stl/odd/upper-case-name.STL", -1},
               {readEnvironment, "tests/fuzz/corpus/image/small.hdr", -1},
               {readImage, "tests/fuzz/corpus/image/small.png", -1},
               {readImage, "tests/fuzz/corpus/image/small.pfm", -1},
               {readImage, "tests/fuzz/corpus/image/small.hdr", -1},
               {readImage, "tests/fuzz/corpus/image/small.bmp", -1},
               {readImage, "tests/fuzz/corpus/image/small.tga", -1},
               {readImage, "tests/fuzz/corpus/image/small.exr", -1},
               {readImage, "tests/data/gltf/apart/picture.jpg", -1},
               {readPart, NULL, 9},
               {readPlan, NULL, 6},
               {readState, NULL, 7}};
enum { READER_COUNT = sizeof READERS / sizeof *READERS };

// Opens the file of a reader. Returns false if this build cannot read it.
static bool openReader(Files* f, int reader)
{
    if (READERS[reader].path != NULL) {
        snprintf(f->path, sizeof f->path, "%s", READERS[reader].path);
        return strstr(f->path, ".exr") == NULL || vplImage_CanWrite("a.exr");
    }
    nameIn(f, WRITERS[READERS[reader].writer].name);
    assert_int_equal(WRITERS[READERS[reader].writer].write(f, f->path), VPL_SUCCESS);
    return true;
}

static void closeReader(const Files* f, int reader)
{
    if (READERS[reader].path == NULL) {
        unlink(f->path);
    }
}

// Reads while faults are armed. A failure must have one sentence and leave no memory and no open descriptor.
static vplResult readFaulty(Files* f, int reader)
{
    const size_t bytes = vplContext_GetBytes(f->context);
    const int descriptors = countEntries("/proc/self/fd");
    const vplResult result = READERS[reader].read(f, f->path);
    faults.armed = false;
    if (f->failing.errors != (result != VPL_SUCCESS && result != VPL_CANCELLED) ||
        vplContext_GetBytes(f->context) != bytes || countEntries("/proc/self/fd") != descriptors) {
        fail_msg("%s after %zu bytes: %s, \"%s\", %d sentences, %zu bytes held", f->path, faults.limit,
                 vplResult_GetName(result), f->sentence, f->failing.errors,
                 vplContext_GetBytes(f->context) - bytes);
    }
    f->failing.errors = 0;
    return result;
}

TEST_ALONE(ReadsThatFailAtAnyByteAreReported)
{
    Files f;
    openFiles(&f);
    for (int reader = 0; reader < READER_COUNT; reader++) {
        if (!openReader(&f, reader)) {
            continue;
        }
        arm(SAME_BYTES, 5, 0); // reads may be partial
        assert_int_equal(readFaulty(&f, reader), VPL_SUCCESS);
        const size_t size = faults.done;
        assert_true(size > 20);
        for (size_t limit = 0; limit < size; limit++) {
            arm(limit, SAME_BYTES, EIO);
            assert_int_equal(readFaulty(&f, reader), VPL_FILE_ERROR);
            assert_true(tells(&f, "cannot read", EIO));
        }
        closeReader(&f, reader);
    }
    closeFiles(&f);
}

// A file that ends early is refused in one sentence, unless what is left makes sense by itself.
TEST_ALONE(FilesThatEndAtAnyByteAreReadOrRefused)
{
    Files f;
    openFiles(&f);
    for (int reader = 0; reader < READER_COUNT; reader++) {
        if (!openReader(&f, reader)) {
            continue;
        }
        arm(SAME_BYTES, SAME_BYTES, 0);
        assert_int_equal(readFaulty(&f, reader), VPL_SUCCESS);
        const size_t size = faults.done;
        for (size_t limit = 0; limit < size; limit++) {
            arm(limit, SAME_BYTES, 0);
            const vplResult result = readFaulty(&f, reader);
            assert_true(result == VPL_SUCCESS || result == VPL_PARSE_ERROR);
            assert_true(limit > 2 || result == VPL_PARSE_ERROR);
        }
        closeReader(&f, reader);
    }
    closeFiles(&f);
}

// ---- reading is cancelled

static bool stopAtZero(void* user, double fraction)
{
    assert_true(fraction == 0);
    return --*(int*)user != 0;
}

TEST_ALONE(ReadingIsCancelledByTheContextsProgress)
{
    Files f;
    openFiles(&f);
    for (int reader = 0; reader < READER_COUNT - 1; reader++) { // states ask the render's own
        int calls = 0;
        if (!openReader(&f, reader)) {
            continue;
        }
        for (int left = 1; left > 0; calls++) {
            left = calls + 1;
            vplContext_SetProgress(f.context, stopAtZero, &left);
            arm(SAME_BYTES, 100, 0);
            const vplResult result = readFaulty(&f, reader);
            assert_int_equal(result, left > 0 ? VPL_SUCCESS : VPL_CANCELLED);
            left = result == VPL_CANCELLED;
        }
        vplContext_SetProgress(f.context, NULL, NULL);
        assert_true(calls >= 2);
        closeReader(&f, reader);
    }
    closeFiles(&f);
}
