// SPDX-License-Identifier: MIT
// What programs change for their whole process or thread: setlocale(LC_ALL, "") makes decimal points commas in half of the world, and the
// floating-point environment may flush denormals, round up or trap. Files, options and pictures must not notice.
#include "scenes.h"

#include <locale.h>
#include <stdlib.h>
#include <unistd.h>

enum { TEXT = 20000 };

// What the library reads and writes as text, one after another.
typedef struct Texts {
    char plan[TEXT], file[TEXT], options[TEXT];
    uint64_t scene, picture, heatmap, obj;
} Texts;

static void readText(const char* path, char text[TEXT])
{
    FILE* file = fopen(path, "rb");
    assert_non_null(file);
    text[fread(text, 1, TEXT - 1, file)] = 0;
    fclose(file);
    unlink(path);
}

static void listOptions(const vplRenderOptions* o, char text[TEXT])
{
    int count, length = 0;
    const vplOption* options = vplGetOptions(&count);
    for (int i = 0; i < count; i++) {
        char value[64];
        if (vplRenderOptions_Get(o, options[i].name, value, sizeof value) == VPL_SUCCESS) {
            length += snprintf(text + length, TEXT - (size_t)length, "%s %s\n", options[i].name, value);
        }
    }
}

static void describePlan(const vplScene* scene, const vplRenderOptions* o, Texts* t)
{
    char path[64];
    vplPlan* plan = NULL;
    snprintf(path, sizeof path, "%s", temporaryName(".plan"));
    assert_int_equal(vplPlan_Create(scene, o, NULL, &plan), VPL_SUCCESS);
    assert_true(vplPlan_Describe(plan, t->plan, TEXT) < TEXT);
    assert_int_equal(vplPlan_Write(plan, scene, path), VPL_SUCCESS);
    readText(path, t->file);
    vplPlan_Destroy(plan);
}

// Renders, writes the picture as PFM, reads it, and compares it with itself.
static void drawPictures(vplContext* context, const vplScene* scene, const vplRenderOptions* o, Texts* t)
{
    char path[64];
    vplImage *image = NULL, *read = NULL, *heatmap = NULL;
    snprintf(path, sizeof path, "%s", temporaryName(".pfm"));
    assert_int_equal(vplRender(scene, o, &image, NULL), VPL_SUCCESS);
    assert_int_equal(vplImage_Write(image, path, NULL), VPL_SUCCESS);
    assert_int_equal(vplImage_Read(context, path, &read), VPL_SUCCESS);
    t->picture = vplImage_Hash(read);
    assert_true(t->picture == vplImage_Hash(image));
    for (int i = 0; i < 3 * read->width; i++) {
        read->pixels[i] *= 1.5f;
    }
    assert_int_equal(vplImage_Heatmap(image, read, 0.5f, &heatmap), VPL_SUCCESS);
    t->heatmap = vplImage_Hash(heatmap); // its colour bar has numbers
    unlink(path);
    vplImage_Destroy(image);
    vplImage_Destroy(read);
    vplImage_Destroy(heatmap);
}

static void gather(vplContext* context, Texts* t)
{
    vplScene *scene = NULL, *model = NULL;
    vplRenderOptions o = plainOptions();
    o.output.width = 24;
    o.output.height = 18;
    assert_int_equal(vplRenderOptions_SetAll(&o, " --particles 5 --min-distance 0.125 --reflectivity 0.1"),
                     VPL_SUCCESS);
    assert_true(o.particles.reflectivity == 0.1);
    assert_int_equal(vplScene_Load(context, "tests/data/room.json", &scene), VPL_SUCCESS);
    assert_int_equal(vplScene_Load(context, "tests/data/obj/everything.obj", &model), VPL_SUCCESS);
    t->scene = vplScene_GetHash(scene);
    t->obj = vplScene_GetHash(model);
    listOptions(&o, t->options);
    describePlan(scene, &o, t);
    drawPictures(context, scene, &o, t);
    vplScene_Destroy(scene);
    vplScene_Destroy(model);
}

// Makes a locale with a decimal comma that of the process. Returns false if the system has none.
static bool setComma(void)
{
    static const char* const names[] = {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "de-DE"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        if (setlocale(LC_ALL, names[i]) != NULL && localeconv()->decimal_point[0] == ',') {
            return true;
        }
    }
    return false;
}

// The same by a locale that localedef makes where it is installed.
static bool makeComma(void)
{
#ifdef _WIN32
    return false;
#else
    char folder[] = "/tmp/vpl-locale-XXXXXX", command[160];
    assert_non_null(mkdtemp(folder));
    snprintf(command, sizeof command, "localedef -i de_DE -f UTF-8 %s/de_DE.UTF-8 >/dev/null 2>&1", folder);
    const bool made = system(command) == 0 && setenv("LOCPATH", folder, 1) == 0 && setComma();
    snprintf(command, sizeof command, "rm -rf %s", folder);
    assert_int_equal(system(command), 0);
    return made;
#endif
}

TEST(DecimalCommasChangeNothing, 2)
{
    static Texts plain, comma;
    gather(context, &plain);
    if (!setComma() && !makeComma()) {
        printf("# skipped: there is no locale with a decimal comma, and localedef makes none\n");
        return;
    }
    char text[16];
    snprintf(text, sizeof text, "%g", 0.5);
    assert_string_equal(text, "0,5"); // the program's own numbers have commas now
    gather(context, &comma);
    snprintf(text, sizeof text, "%g", 0.5);
    assert_string_equal(text, "0,5"); // and still have them
    setlocale(LC_ALL, "C");
    assert_string_equal(comma.options, plain.options);
    assert_string_equal(comma.plan, plain.plan);
    assert_string_equal(comma.file, plain.file);
    assert_true(comma.scene == plain.scene && comma.obj == plain.obj);
    assert_true(comma.picture == plain.picture && comma.heatmap == plain.heatmap);
}

// ---- the floating-point environment

#ifdef __SSE__
#include <xmmintrin.h>

enum {
    FLUSHES = 0x1F80 | 0x8040, // denormals are zero, in and out
    ROUNDS_UP = 0x1F80 | 0x4000,
    TRAPS = 0x1000, // nothing but inexact results is masked
};

static unsigned strange; // MXCSR of the program

// A scheduler whose threads have the environment of the program, in any order of tasks.
static void runStrangely(void* user, int count, int workers, vplTaskFcn* task, void* data)
{
    (void)user;
    const unsigned before = _mm_getcsr();
    for (int i = count - 1; i >= 0; i--) {
        _mm_setcsr(strange);
        task(data, i, i % workers);
    }
    _mm_setcsr(before);
}

// The hash of a picture of light so faint that denormals matter.
static uint64_t renderStrangely(const char* words, unsigned control)
{
    vplContextDef def = vplDefaultContextDef();
    vplContext* context = NULL;
    vplScene* scene = NULL;
    vplImage* image = NULL;
    vplRenderOptions o = plainOptions();
    o.output.width = 16;
    o.output.height = 12;
    o.shadow.mapSize = 16;
    def.parallelFor = runStrangely;
    def.workerCount = 3;
    assert_int_equal(vplRenderOptions_SetAll(&o, words), VPL_SUCCESS);
    strange = control;
    _mm_setcsr(control);
    vplResult result = vplContext_Create(&def, &context);
    result = result == VPL_SUCCESS ? vplScene_Load(context, "tests/data/faint.json", &scene) : result;
    result = result == VPL_SUCCESS ? vplRender(scene, &o, &image, NULL) : result;
    const unsigned after = _mm_getcsr();
    _mm_setcsr(0x1F80);
    assert_int_equal(result, VPL_SUCCESS);
    assert_true((after & ~0x3Fu) == control);
    const uint64_t hash = vplImage_Hash(image);
    vplImage_Destroy(image);
    vplScene_Destroy(scene);
    vplContext_Destroy(context);
    return hash;
}

TEST_ALONE(TheFloatingPointEnvironmentChangesNoBit)
{
    static const char* const cases[] = {" --method keller --particles 9", " --method path --spp 4",
                                        " --method radiosity --patches 60",
                                        " --method ssvp --first-bounce 9 --second-bounce 9 --clusters 3",
                                        " --preset franchi-ferrante --particles 9"};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const uint64_t plain = renderStrangely(cases[i], 0x1F80);
        assert_true(renderStrangely(cases[i], FLUSHES) == plain);
        assert_true(renderStrangely(cases[i], ROUNDS_UP) == plain);
        assert_true(renderStrangely(cases[i], TRAPS) == plain);
    }
}
#endif
