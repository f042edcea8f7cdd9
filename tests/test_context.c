// SPDX-License-Identifier: MIT
// What a program that links libvpl relies on: versions, messages, and pictures in its own memory.
#include "test.h"

#include <unistd.h>

TEST_ALONE(OtherVersionsOfTheHeadersAreRefusedWithASentence)
{
    char text[256] = "";
    FILE* err = tmpfile();
    const int before = dup(2);
    assert_non_null(err);
    vplContextDef def = vplDefaultContextDef();
    def.log = vplLogToStderr;
    vplContext* context = NULL;
    dup2(fileno(err), 2);
    const vplResult newer = vplContext_CreateForAbi(VPL_VERSION_MAJOR, VPL_VERSION_MINOR + 1, &def, &context);
    dup2(before, 2);
    close(before);
    rewind(err);
    assert_non_null(fgets(text, sizeof text, err));
    fclose(err);
    assert_int_equal(newer, VPL_INVALID_ARGUMENT);
    assert_null(context);
    char expected[256];
    snprintf(expected, sizeof expected,
             "libvpl: error: vplContext_Create: the program was built with headers of libvpl %d.%d, the "
             "library is %s\n",
             VPL_VERSION_MAJOR, VPL_VERSION_MINOR + 1, VPL_VERSION_STRING);
    assert_string_equal(text, expected);
    assert_int_equal(vplContext_CreateForAbi(VPL_VERSION_MAJOR + 1, VPL_VERSION_MINOR, NULL, &context),
                     VPL_INVALID_ARGUMENT);
    assert_int_equal((vplContext_Create)(NULL, &context), VPL_SUCCESS);
    vplContext_Destroy(context);
}

TEST_ALONE(TheLastMessageStaysUntilTheNextFailure)
{
    vplContext* context;
    vplScene* scene;
    assert_string_equal(vplContext_GetLastMessage(NULL), "");
    assert_int_equal(vplContext_Create(NULL, &context), VPL_SUCCESS);
    assert_string_equal(vplContext_GetLastMessage(context), "");
    assert_int_equal(vplScene_Load(context, "nowhere.json", &scene), VPL_FILE_ERROR);
    assert_non_null(strstr(vplContext_GetLastMessage(context), "nowhere.json"));
    assert_int_equal(vplScene_Create(context, &scene), VPL_SUCCESS);
    vplCameraDef camera = vplDefaultCameraDef();
    camera.fovY = 4;
    assert_non_null(strstr(vplContext_GetLastMessage(context), "nowhere.json"));
    assert_int_equal(vplScene_AddCamera(scene, &camera, NULL), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(vplContext_GetLastMessage(context), "fovY"));

    char name[9000];
    memset(name, 'n', sizeof name);
    memcpy(name + sizeof name - 6, ".json", 6);
    vplScene* other;
    assert_int_equal(vplScene_Load(context, name, &other), VPL_FILE_ERROR);
    const char* message = vplContext_GetLastMessage(context);
    assert_int_equal(strlen(message), 4095);
    assert_non_null(strstr(message, "nnn ...n"));
    assert_non_null(strstr(message, ".json: ")); // the reason stands behind the name
    vplScene_Destroy(scene);
    vplContext_Destroy(context);
}

// A picture of 3 x 2 pixels whose values tell where they are.
static vplImage* numbers(vplContext* context)
{
    vplImage* image;
    assert_int_equal(vplImage_Create(context, 3, 2, &image), VPL_SUCCESS);
    for (int i = 0; i < 18; i++) {
        image->pixels[i] = (float)i / 18;
    }
    return image;
}

TEST(PicturesAreCopiedWithTheCallersStrides, 1)
{
    vplImage* image = numbers(context);
    float floats[64];
    for (int i = 0; i < 64; i++) {
        floats[i] = -1;
    }
    vplPixelsDef def = vplDefaultPixelsDef();
    def.format = VPL_PIXELS_RGBA_FLOAT;
    def.first = floats + 32; // rows go up, with a gap between pixels and between rows
    def.pixelStride = 5 * sizeof(float);
    def.rowStride = -32 * (ptrdiff_t)sizeof(float);
    assert_int_equal(vplImage_CopyTo(image, &def), VPL_SUCCESS);
    for (int y = 0; y < 2; y++) {
        for (int i = 0; i < 32; i++) {
            const float want = i >= 15 || i % 5 == 4 ? -1
                               : i % 5 == 3          ? 1
                                                     : image->pixels[9 * y + 3 * (i / 5) + i % 5];
            assert_true(floats[32 - 32 * y + i] == want);
        }
    }
    def = vplDefaultPixelsDef();
    def.format = VPL_PIXELS_NUMBER_FLOAT;
    def.first = floats;
    assert_int_equal(vplImage_CopyTo(image, &def), VPL_SUCCESS);
    for (int i = 0; i < 6; i++) {
        assert_true(floats[i] == image->pixels[3 * i]);
    }
    vplImage_Destroy(image);
}

TEST(BytesAreTheCodesOfAPng, 1)
{
    vplImage *image = numbers(context), *read;
    uint8_t bytes[4 * 6 + 1];
    memset(bytes, 7, sizeof bytes);
    vplPixelsDef def = vplDefaultPixelsDef();
    def.format = VPL_PIXELS_RGBA_SRGB8;
    def.first = bytes;
    def.exposure = 0.5f;
    def.tonemap = VPL_TONEMAP_AGX;
    assert_int_equal(vplImage_CopyTo(image, &def), VPL_SUCCESS);
    vplWriteOptions options = vplDefaultWriteOptions();
    options.exposure = def.exposure;
    options.tonemap = def.tonemap;
    assert_int_equal(vplImage_Write(image, temporaryName(".png"), &options), VPL_SUCCESS);
    assert_int_equal(vplImage_Read(context, temporaryName(".png"), &read), VPL_SUCCESS);
    remove(temporaryName(".png"));
    for (int i = 0; i < 24; i++) {
        const int want = i % 4 == 3 ? 255 : vplSrgb_Code(read->pixels[3 * (i / 4) + i % 4]);
        assert_int_equal(bytes[i], want);
    }
    assert_int_equal(bytes[24], 7);
    vplImage_Destroy(read);
    vplImage_Destroy(image);
}

TEST(MemoryThatDoesNotFitAPictureIsRefused, 1)
{
    static const struct {
        vplPixelFormat format;
        ptrdiff_t pixel, row;
        float exposure;
        const char* field;
    } cases[] = {
        {(vplPixelFormat)5, 0, 0, 0, "format"},          {(vplPixelFormat)-1, 0, 0, 0, "format"},
        {VPL_PIXELS_RGB_FLOAT, 11, 0, 0, "pixelStride"}, {VPL_PIXELS_RGB_FLOAT, -12, 0, 0, "pixelStride"},
        {VPL_PIXELS_RGB_FLOAT, 12, 35, 0, "rowStride"},  {VPL_PIXELS_RGB_SRGB8, 0, -8, 0, "rowStride"},
        {VPL_PIXELS_RGB_SRGB8, 0, 0, 65, "exposure"},
    };
    vplImage* image = numbers(context);
    char memory[256];
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        vplPixelsDef def = vplDefaultPixelsDef();
        def.first = memory;
        def.format = cases[i].format;
        def.pixelStride = cases[i].pixel;
        def.rowStride = cases[i].row;
        def.exposure = cases[i].exposure;
        assert_int_equal(vplImage_CopyTo(image, &def), VPL_INVALID_ARGUMENT);
        assert_non_null(strstr(takeMessage(), cases[i].field));
    }
    vplPixelsDef def = vplDefaultPixelsDef();
    assert_int_equal(vplImage_CopyTo(image, &def), VPL_INVALID_ARGUMENT);
    assert_string_equal(takeMessage(), "vplPixelsDef.first is NULL");
    vplImage_Destroy(image);
}

// ---- renders into the caller's memory

enum { WIDTH = 24, HEIGHT = 16 };

static vplRenderOptions smallOptions(void)
{
    vplRenderOptions options = vplDefaultRenderOptions();
    options.method = VPL_METHOD_KELLER;
    options.output.width = WIDTH;
    options.output.height = HEIGHT;
    options.particles.count = 60;
    options.stop.passes = 4;
    return options;
}

TEST(PictureAndLayersComeInOneCall, 2)
{
    static float picture[3 * WIDTH * HEIGHT], depth[WIDTH * HEIGHT];
    vplScene* scene = openScene(context, "tests/data/room.json");
    vplRenderOptions options = smallOptions();
    vplTarget targets[2] = {{0, vplDefaultPixelsDef()}, {VPL_AOV_DEPTH, vplDefaultPixelsDef()}};
    targets[0].pixels.first = picture;
    targets[1].pixels.first = depth;
    targets[1].pixels.format = VPL_PIXELS_NUMBER_FLOAT;
    int passes;
    vplRenderStats stats;
    assert_int_equal(vplRenderTo(scene, &options, targets, 2, &passes, &stats), VPL_SUCCESS);
    assert_int_equal(passes, 4);
    vplImage* image = renderScene(scene, &options, NULL);
    assert_memory_equal(picture, image->pixels, sizeof picture);
    assert_true(stats.imageHash == vplImage_Hash(image));
    options.output.aovs = VPL_AOV_ALBEDO | VPL_AOV_DEPTH;
    vplLayers* layers;
    assert_int_equal(vplRenderLayers(scene, &options, &layers, NULL), VPL_SUCCESS);
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        assert_true(depth[i] == layers->layers[2].image->pixels[3 * i]);
    }
    targets[1].layer = VPL_AOV_DEPTH | VPL_AOV_OBJECT;
    assert_int_equal(vplRenderTo(scene, &options, targets, 2, NULL, NULL), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "targets[1].layer is 48"));
    vplLayers_Destroy(layers);
    vplImage_Destroy(image);
    vplScene_Destroy(scene);
}

// Cancels once the fraction that `user` holds is reached.
static bool goesOnUntil(void* user, double fraction)
{
    return fraction < *(double*)user;
}

TEST(ACancelledRenderLeavesThePictureSoFar, 2)
{
    static float picture[3 * WIDTH * HEIGHT];
    vplScene* scene = openScene(context, "tests/data/room.json");
    vplRenderOptions options = smallOptions();
    double until = 0.6;
    options.progress = goesOnUntil;
    options.progressUser = &until;
    vplTarget target = {0, vplDefaultPixelsDef()};
    target.pixels.first = picture;
    int passes;
    assert_int_equal(vplRenderTo(scene, &options, &target, 1, &passes, NULL), VPL_CANCELLED);
    assert_in_range(passes, 1, 3);
    options.progress = NULL;
    options.stop.passes = passes;
    vplImage* image = renderScene(scene, &options, NULL);
    for (int i = 0; i < 3 * WIDTH * HEIGHT; i++) {
        assertNear((double)picture[i], (double)image->pixels[i], 1e-6 * (1 + (double)image->pixels[i]),
                   "value", i);
    }
    until = 0; // no pass ends
    options.progress = goesOnUntil;
    picture[0] = -1;
    assert_int_equal(vplRenderTo(scene, &options, &target, 1, &passes, NULL), VPL_CANCELLED);
    assert_int_equal(passes, 0);
    assert_true(picture[0] == -1);
    vplImage_Destroy(image);
    vplScene_Destroy(scene);
}

TEST(TheCallersViewReplacesTheScenesCamera, 2)
{
    vplScene* scene = openScene(context, "tests/data/room.json");
    vplRenderOptions options = smallOptions();
    vplCameraDef view = *vplScene_GetCamera(scene, 0);
    vplImage* first = renderScene(scene, &options, NULL);
    options.view = &view;
    vplImage* same = renderScene(scene, &options, NULL);
    assert_true(vplImage_Hash(first) == vplImage_Hash(same));
    view.eye.x += 0.5f;
    vplImage* moved = renderScene(scene, &options, NULL);
    assert_true(vplImage_Hash(first) != vplImage_Hash(moved));
    vplScene_AddCamera(scene, &view, &options.output.camera);
    options.view = NULL;
    vplImage* declared = renderScene(scene, &options, NULL);
    assert_true(vplImage_Hash(declared) == vplImage_Hash(moved));
    view.nearPlane = -1;
    options.view = &view;
    vplImage* none;
    assert_int_equal(vplRender(scene, &options, &none, NULL), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "vplRenderOptions.view->near"));
    vplImage_Destroy(first);
    vplImage_Destroy(same);
    vplImage_Destroy(moved);
    vplImage_Destroy(declared);
    vplScene_Destroy(scene);
}
