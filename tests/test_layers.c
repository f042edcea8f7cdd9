// SPDX-License-Identifier: MIT
// Tests of layers: light adds up to the picture, surfaces are those of materials, rays and --show, and what
// is written into an .exr file comes back under the names that other programs know.
#include "test.h"

#include "math/vec.h"

#include <stdlib.h>
#include <unistd.h>

static const char ROOM[] = "examples/scenes/room.json", AREA[] = "examples/scenes/room-area.json";

enum { WIDTH = 96, HEIGHT = 54 };

typedef struct Words {
    const char* words[12]; // names and values of options
} Words;

static vplRenderOptions optionsOf(const Words* w, const char* aov)
{
    vplRenderOptions o = plainOptions();
    o.output.width = WIDTH;
    o.output.height = HEIGHT;
    o.shadow.mapSize = 128;
    for (int i = 0; w->words[i] != NULL; i += 2) {
        assert_int_equal(vplRenderOptions_Set(&o, w->words[i], w->words[i + 1]), VPL_SUCCESS);
    }
    assert_int_equal(vplRenderOptions_Set(&o, "aov", aov), VPL_SUCCESS);
    return o;
}

static vplLayers* layersOf(const vplScene* scene, const Words* w, const char* aov, vplRenderStats* stats)
{
    const vplRenderOptions o = optionsOf(w, aov);
    vplLayers* layers = NULL;
    assert_int_equal(vplRenderLayers(scene, &o, &layers, stats), VPL_SUCCESS);
    return layers;
}

static const vplImage* layer(const vplLayers* layers, const char* name)
{
    for (int i = 0; i < layers->count; i++) {
        if (strcmp(layers->layers[i].name, name) == 0) {
            return layers->layers[i].image;
        }
    }
    fail_msg("there is no layer \"%s\"", name);
    return NULL;
}

static size_t countValues(const vplImage* image)
{
    return 3 * (size_t)image->width * (size_t)image->height;
}

// ---- light

// Renders of all methods and pipelines, with one pass and several.
static const Words LIGHTS[] = {
    {{"method", "direct"}},
    {{"particles", "100", "antialias", "1"}},
    {{"particles", "100", "lighting", "documented"}},
    {{"particles", "50", "pipeline", "multipass"}},
    {{"method", "keller", "particles", "200", "pipeline", "deferred", "antialias", "4"}},
    {{"method", "keller", "particles", "200", "pipeline", "interleaved", "antialias", "1"}},
    {{"method", "keller", "particles", "200", "pipeline", "interleaved", "antialias", "4"}},
    {{"method", "keller", "particles", "60", "pipeline", "deferred", "light-shadows", "map", "light-map",
      "32"}},
    {{"method", "keller", "particles", "60", "pipeline", "deferred", "passes", "3"}},
    {{"method", "keller", "particles", "200", "pipeline", "lightcuts"}},
    {{"method", "ssvp", "supersample", "2"}},
    {{"method", "ssvp", "passes", "2"}},
    {{"method", "radiosity", "patches", "200", "antialias", "4"}},
    {{"method", "path", "spp", "40"}},
    {{"method", "path", "spp", "3", "pixel", "centre"}},
};

// Direct light is that of --show direct, where no virtual lights of other numbers stand for it.
static void assertDirect(const vplScene* scene, const Words* w, const vplLayers* layers, bool exact)
{
    vplRenderOptions o = optionsOf(w, "none");
    o.output.show = VPL_SHOW_DIRECT;
    vplComparison c;
    vplImage* shown = renderScene(scene, &o, NULL);
    assert_int_equal(vplImage_Compare(layer(layers, "direct"), shown, &c), VPL_SUCCESS);
    if (!(c.relativeRmse <= (exact ? 1e-6 : 0.05))) {
        fail_msg("%s %s: direct light differs from --show direct by %g", w->words[1], w->words[3],
                 c.relativeRmse);
    }
    vplImage_Destroy(shown);
}

static void assertLight(vplContext* context, const char* path, bool area)
{
    vplScene* scene = openScene(context, path);
    for (size_t i = 0; i < sizeof LIGHTS / sizeof *LIGHTS; i++) {
        const vplRenderOptions plain = optionsOf(&LIGHTS[i], "none");
        const bool keller = plain.method == VPL_METHOD_KELLER;
        if (area && plain.lighting == VPL_LIGHTING_DOCUMENTED) {
            continue;
        }
        vplRenderStats stats, layered;
        vplImage_Destroy(renderScene(scene, &plain, &stats));
        vplLayers* layers = layersOf(scene, &LIGHTS[i], "direct,indirect", &layered);
        assert_true(layers->count == 3 && layered.imageHash == stats.imageHash);
        assert_true(vplImage_Hash(layers->layers[0].image) == stats.imageHash);
        const vplImage *picture = layer(layers, ""), *direct = layer(layers, "direct"),
                       *indirect = layer(layers, "indirect");
        for (size_t k = 0; k < countValues(picture); k++) {
            const float sum = direct->pixels[k] + indirect->pixels[k];
            assert_true(direct->pixels[k] >= 0 && indirect->pixels[k] >= 0);
            assertNear((double)sum, (double)picture->pixels[k], 2e-7 * (double)picture->pixels[k],
                       "direct and indirect", (int)i);
        }
        assertDirect(scene, &LIGHTS[i], layers, !(keller && area));
        vplLayers_Destroy(layers);
    }
    vplScene_Destroy(scene);
}

TEST(DirectAndIndirectLightAddUpToThePicture, 2)
{
    assertLight(context, ROOM, false);
}

TEST(LightOfSurfacesThatEmitIsDirect, 2)
{
    assertLight(context, AREA, true);
}

TEST(ALayerAloneIsTheSameAsAmongAll, 2)
{
    static const char* const aovs[] = {"direct", "indirect", "albedo", "normal", "depth", "object"};
    const Words w = {{"method", "keller", "particles", "40", "antialias", "3"}};
    vplScene* scene = openScene(context, AREA);
    vplLayers* all = layersOf(scene, &w, "all", NULL);
    assert_int_equal(all->count, 7);
    for (int i = 0; i < 6; i++) {
        vplLayers* one = layersOf(scene, &w, aovs[i], NULL);
        assert_int_equal(one->count, 2);
        assert_string_equal(one->layers[1].name, all->layers[i + 1].name);
        assert_true(vplImage_Hash(one->layers[1].image) == vplImage_Hash(all->layers[i + 1].image));
        vplLayers_Destroy(one);
    }
    vplLayers_Destroy(all);
    vplScene_Destroy(scene);
}

// A renderer can be asked between its passes.
TEST(LayersOfARendererAreThoseOfItsPasses, 2)
{
    const Words w = {{"method", "keller", "particles", "40", "passes", "2"}};
    vplScene* scene = openScene(context, AREA);
    const vplRenderOptions o = optionsOf(&w, "all");
    vplRenderer* renderer;
    vplLayers *layers = NULL, *twice = layersOf(scene, &w, "all", NULL);
    bool done = false;
    assert_int_equal(vplRenderer_Create(scene, &o, &renderer), VPL_SUCCESS);
    assert_int_equal(vplRenderer_GetLayers(renderer, &layers, NULL), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "before its first step"));
    for (int pass = 0; !done; pass++) {
        assert_int_equal(vplRenderer_Step(renderer, &done), VPL_SUCCESS);
        assert_int_equal(vplRenderer_GetLayers(renderer, &layers, NULL), VPL_SUCCESS);
        for (int i = 0; i < layers->count; i++) {
            const bool same = vplImage_Hash(layers->images[i]) == vplImage_Hash(twice->images[i]);
            assert_int_equal(same, pass == 1 || i > 2);
        }
        vplLayers_Destroy(layers);
    }
    vplRenderer_Destroy(renderer);
    vplLayers_Destroy(twice);
    vplScene_Destroy(scene);
}

// ---- surfaces

// The closest hit of the ray through the centre of a pixel. False if there is none.
static bool hitOf(const vplGeometry* g, const vplView* v, int x, int y, vplHit* hit)
{
    const double right = ((2 * x + 1) / (double)v->width - 1) / v->scaleX,
                 up = (1 - (2 * y + 1) / (double)v->height) / v->scaleY;
    const vplVec3 d =
        vplAdd(v->forward, vplAdd(vplScale((float)right, v->right), vplScale((float)up, v->up)));
    const vplRay ray = {.origin = v->eye, .direction = d};
    return vplGeometry_ClosestHit(g, &ray, hit);
}

// True if a pixel next to pixel i shows the object.
static bool isNear(const vplImage* object, int i, int id)
{
    bool near = false;
    for (int k = 0; k < 9; k++) {
        const int x = i % WIDTH + k % 3 - 1, y = i / WIDTH + k / 3 - 1;
        near = near || (x >= 0 && x < WIDTH && y >= 0 && y < HEIGHT &&
                        object->pixels[3 * (y * WIDTH + x)] == (float)id);
    }
    return near;
}

// The rasterizer snaps corners to 1/256 pixel, so that it may disagree with rays at edges.
TEST(SurfacesAreThoseThatRaysHit, 2)
{
    const Words w = {{"method", "direct", "antialias", "1"}};
    vplScene* scene = openScene(context, AREA);
    vplLayers* layers = layersOf(scene, &w, "albedo,normal,depth,object", NULL);
    const vplImage *object = layer(layers, "object.id"), *depth = layer(layers, "Z"),
                   *albedo = layer(layers, "albedo"), *normal = layer(layers, "normal");
    const vplView view = vplView_Create(vplScene_GetCamera(scene, 0), object->width, object->height);
    vplGeometry* g;
    assert_int_equal(vplGeometry_Create(scene, &g), VPL_SUCCESS);
    int different = 0, emitting = 0, background = 0;
    for (int i = 0; i < object->width * object->height; i++) {
        vplHit hit;
        const bool there = hitOf(g, &view, i % object->width, i / object->width, &hit);
        const float* a = albedo->pixels + 3 * i;
        if (object->pixels[3 * i] != (float)(there ? hit.object + 1 : 0)) {
            assert_true(isNear(object, i, there ? hit.object + 1 : 0));
            different++;
            continue;
        }
        if (!there) {
            assert_true(depth->pixels[3 * i] == VPL_NO_DEPTH && a[0] == 0 && normal->pixels[3 * i] == 0);
            background++;
            continue;
        }
        const vplMaterialDef* m = &g->materials[g->triangleMaterials[hit.triangle]];
        const bool emits = m->emission.r > 0;
        emitting += emits;
        if (emits && a[0] != m->diffuse.r) { // seen from its front
            assert_true(a[0] == 1 && a[1] == 1 && a[2] == 1);
        } else {
            assert_true(a[0] == m->diffuse.r && a[1] == m->diffuse.g && a[2] == m->diffuse.b);
        }
        assertNear((double)depth->pixels[3 * i], (double)hit.t, 1e-4 * (double)hit.t, "depth", i);
        const vplVec3 n = vplVec(normal->pixels[3 * i], normal->pixels[3 * i + 1], normal->pixels[3 * i + 2]);
        assertNear(fabs((double)vplDot(n, g->normals[hit.triangle])), 1, 1e-5, "normal", i);
    }
    printf("# %d of %d pixels show another object than their ray hits\n", different, WIDTH * HEIGHT);
    assert_true(different < WIDTH * HEIGHT / 100 && emitting > 5 && background > 20);
    vplGeometry_Destroy(g);
    vplLayers_Destroy(layers);
    vplScene_Destroy(scene);
}

TEST(DepthIsThatOfShowDepth, 2)
{
    static const Words ways[] = {{{"method", "direct", "antialias", "8"}},
                                 {{"method", "direct", "supersample", "3"}},
                                 {{"method", "path", "spp", "1"}}};
    const Words show = {{"method", "direct", "show", "depth"}};
    vplScene* scene = openScene(context, ROOM);
    const vplRenderOptions o = optionsOf(&show, "none");
    vplImage* shown = renderScene(scene, &o, NULL);
    for (size_t i = 0; i < sizeof ways / sizeof *ways; i++) {
        vplLayers* layers = layersOf(scene, &ways[i], "depth", NULL);
        for (size_t k = 0; k < countValues(shown); k++) {
            const float wanted = shown->pixels[k] > 0 ? shown->pixels[k] : VPL_NO_DEPTH;
            assert_true(layer(layers, "Z")->pixels[k] == wanted);
        }
        vplLayers_Destroy(layers);
    }
    vplImage_Destroy(shown);
    vplScene_Destroy(scene);
}

// A pixel whose neighbours show the same object shows one surface, if the object is flat.
static bool isInside(const vplImage* object, int x, int y)
{
    for (int dy = -1; dy <= 1; dy++) {
        for (int dx = -1; dx <= 1; dx++) {
            const int i = (y + dy) * object->width + x + dx;
            if (object->pixels[3 * i] != object->pixels[3 * (y * object->width + x)]) {
                return false;
            }
        }
    }
    return true;
}

// Albedo and normals are means over samples: unit and of one material inside of surfaces, between them at
// edges. Depth and objects are never mixed.
TEST(OnlyAlbedoAndNormalsAreMeansOverAPixel, 2)
{
    static const Words ways[] = {{{"method", "direct", "antialias", "8"}},
                                 {{"method", "direct", "supersample", "8"}},
                                 {{"method", "path", "spp", "1"}}};
    const Words plainly = {{"method", "direct", "antialias", "1"}};
    vplScene* scene = openScene(context, ROOM);
    vplLayers* plain = layersOf(scene, &plainly, "albedo,normal,depth,object", NULL);
    const vplImage* object = layer(plain, "object.id");
    for (size_t way = 0; way < sizeof ways / sizeof *ways; way++) {
        vplLayers* smooth = layersOf(scene, &ways[way], "albedo,normal,depth,object", NULL);
        const float *albedo = layer(smooth, "albedo")->pixels, *normal = layer(smooth, "normal")->pixels;
        int mixed = 0;
        assert_true(vplImage_Hash(layer(smooth, "Z")) == vplImage_Hash(layer(plain, "Z")));
        assert_true(vplImage_Hash(layer(smooth, "object.id")) == vplImage_Hash(object));
        for (int y = 1; y < object->height - 1; y++) {
            for (int x = 1; x < object->width - 1; x++) {
                const int i = 3 * (y * object->width + x);
                const float* n = normal + i;
                const double length = sqrt((double)(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]));
                assert_true(length < 1 + 1e-6);
                if (!isInside(object, x, y)) {
                    mixed += length < 0.95;
                    continue;
                }
                assertNear((double)albedo[i], (double)layer(plain, "albedo")->pixels[i], 1e-6, "albedo",
                           i / 3);
                assert_true(length == 0 || length > 0.5); // edges of boxes
            }
        }
        assert_true(mixed > 50);
        vplLayers_Destroy(smooth);
    }
    vplLayers_Destroy(plain);
    vplScene_Destroy(scene);
}

// A normal has length 1. Where the two samples of a pixel show surfaces that face different ways, their mean is shorter.
TEST(TwoSamplesOfAPixelAreAMeanToo, 2)
{
    static const Words ways[] = {{{"method", "direct", "antialias", "2"}},
                                 {{"method", "direct", "supersample", "2"}}};
    vplScene* scene = openScene(context, ROOM);
    for (size_t way = 0; way < sizeof ways / sizeof *ways; way++) {
        vplLayers* layers = layersOf(scene, &ways[way], "normal", NULL);
        const float* n = layer(layers, "normal")->pixels;
        int mixed = 0;
        for (int i = 0; i < 3 * WIDTH * HEIGHT; i += 3) {
            const float length = vplLength(vplVec(n[i], n[i + 1], n[i + 2]));
            assert_true(length < 1 + 1e-6f);
            mixed += length > 0 && length < 0.95f;
        }
        assert_true(mixed > 50);
        vplLayers_Destroy(layers);
    }
    vplScene_Destroy(scene);
}

// ---- files

static vplImage* randomImage(vplContext* context, uint64_t seed, bool whole)
{
    vplImage* image;
    assert_int_equal(vplImage_Create(context, 19, 35, &image), VPL_SUCCESS);
    for (size_t k = 0; k < countValues(image); k++) {
        const double u = uniformAt(seed, k);
        image->pixels[k] = whole ? (float)floor(u * (VPL_MAX_LAYER_INDEX + 1.0)) : (float)(u - 0.3);
    }
    return image;
}

// Finds `wanted` in the bytes of a file.
static bool hasBytes(const char* path, const void* wanted, size_t size)
{
    static char bytes[1 << 16];
    FILE* file = fopen(path, "rb");
    const size_t length = fread(bytes, 1, sizeof bytes, file);
    fclose(file);
    for (size_t i = 0; i + size <= length; i++) {
        if (memcmp(bytes + i, wanted, size) == 0) {
            return true;
        }
    }
    return false;
}

TEST(LayersAreReadBackWithEveryBit, 1)
{
    static const char* names[] = {"one", "", "three"};
    vplImage* images[5];
    for (int i = 0; i < 5; i++) {
        images[i] = randomImage(context, (uint64_t)i, i == 4);
    }
    const vplLayer layers[] = {
        {.name = "Z", .kind = VPL_LAYER_NUMBER, .image = images[3]},
        {.name = "direct", .kind = VPL_LAYER_COLOUR, .image = images[1]},
        {.name = "", .kind = VPL_LAYER_COLOUR, .image = images[0]},
        {.name = "a.normal", .kind = VPL_LAYER_VECTOR, .image = images[2]},
        {.name = "object.id", .kind = VPL_LAYER_INDEX, .image = images[4], .names = names, .nameCount = 3}};
    const bool exr = vplImage_CanWrite("a.exr");
    assert_int_equal(vplImage_WriteLayers(layers, 5, temporaryName(".exr")),
                     exr ? VPL_SUCCESS : VPL_INVALID_ARGUMENT);
    for (int i = 0; i < 5 && exr; i++) {
        vplImage* back;
        assert_int_equal(vplImage_ReadLayer(context, temporaryName(".exr"), layers[i].name, &back),
                         VPL_SUCCESS);
        const bool single = layers[i].kind >= VPL_LAYER_NUMBER;
        for (size_t k = 0; k < countValues(back); k++) {
            assert_true(back->pixels[k] == layers[i].image->pixels[single ? k - k % 3 : k]);
        }
        vplImage_Destroy(back);
    }
    if (exr) {
        // Channels in alphabetical order, each with its type (0 UINT, 2 FLOAT), and the names of indices.
        static const char first[] = "B\0\2\0\0\0", second[] = "a.normal.X\0\2\0\0\0",
                          last[] = "object.id\0\0\0\0\0";
        static const char attribute[] =
            "object.id.names\0stringvector\0\24\0\0\0\3\0\0\0one\0\0\0\0\5\0\0\0three";
        vplImage* back = NULL;
        assert_true(hasBytes(temporaryName(".exr"), first, sizeof first - 1));
        assert_true(hasBytes(temporaryName(".exr"), second, sizeof second - 1));
        assert_true(hasBytes(temporaryName(".exr"), last, sizeof last - 1));
        assert_true(hasBytes(temporaryName(".exr"), attribute, sizeof attribute - 1));
        assert_int_equal(vplImage_ReadLayer(context, temporaryName(".exr"), "normal", &back),
                         VPL_PARSE_ERROR);
        assert_non_null(strstr(takeMessage(), "no layer of that name"));
        unlink(temporaryName(".exr"));
    }
    for (int i = 0; i < 5; i++) {
        vplImage_Destroy(images[i]);
    }
}

TEST(LayersThatNoFileCanHoldAreRefused, 1)
{
    vplImage *a = randomImage(context, 1, false), *whole = randomImage(context, 2, true), *small, *nan;
    assert_int_equal(vplImage_Create(context, 19, 34, &small), VPL_SUCCESS);
    assert_int_equal(vplImage_Create(context, 19, 35, &nan), VPL_SUCCESS);
    nan->pixels[5] = NAN;
    whole->pixels[3] = VPL_MAX_LAYER_INDEX + 2.0f;
    const struct {
        vplLayer layer;
        const char *path, *message;
    } cases[] = {
        {{"b", VPL_LAYER_COLOUR, a, NULL, 0}, "/tmp/a.png", "only .exr files have layers"},
        {{"b", VPL_LAYER_COLOUR, small, NULL, 0}, NULL, "layer \"b\" is 19x34, must be 19x35 as \"\""},
        {{"b", VPL_LAYER_COLOUR, nan, NULL, 0}, NULL, "b: pixel (1, 0) channel 2 is nan"},
        {{"b", VPL_LAYER_INDEX, a, NULL, 0}, NULL, "must have whole numbers in [0, 16777216]"},
        {{"b", VPL_LAYER_INDEX, whole, NULL, 0}, NULL, "must have whole numbers in [0, 16777216]"},
        {{"a name of twenty-six bytes", VPL_LAYER_COLOUR, a, NULL, 0}, NULL, "26 bytes, may have 24"},
        {{"", VPL_LAYER_COLOUR, a, NULL, 0}, NULL, "EXR picture"}}; // the channels of the first
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const vplLayer layers[] = {{.name = "", .image = a}, cases[i].layer};
        const char* path = cases[i].path != NULL ? cases[i].path : temporaryName(".exr");
        assert_int_equal(vplImage_WriteLayers(layers, 2, path), VPL_INVALID_ARGUMENT);
        const char* message = takeMessage();
        if (strstr(message, cases[i].message) == NULL) {
            fail_msg("case %zu: \"%s\" lacks \"%s\"", i, message, cases[i].message);
        }
        assert_int_equal(access(path, F_OK), -1);
    }
    vplImage_Destroy(a);
    vplImage_Destroy(whole);
    vplImage_Destroy(small);
    vplImage_Destroy(nan);
}

// ---- plans

TEST(LayersAreOfThePictureOnly, 1)
{
    const Words w = {{"show", "depth"}};
    const vplRenderOptions o = optionsOf(&w, "albedo");
    vplScene* scene = openScene(context, ROOM);
    vplLayers* layers = NULL;
    assert_int_equal(vplRenderLayers(scene, &o, &layers, NULL), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "--aov adds layers to the picture"));
    vplScene_Destroy(scene);
}

TEST_ALONE(PeakBytesWithLayersAreTrueWithin15Percent, SLOW)
{
    static const char* const aovs[] = {"all", "direct", "indirect", "albedo,depth"};
    int wrong = 0;
    for (size_t i = 0; i < sizeof LIGHTS / sizeof *LIGHTS; i++) {
        const Words* w = &LIGHTS[i];
        vplContext* context = openTestContext(1 + (int)i % 2);
        vplScene* scene = openScene(context, AREA);
        vplRenderOptions o = optionsOf(w, aovs[i % 4]);
        vplPlan* plan;
        vplRenderStats stats;
        vplLayers* layers;
        o.lighting = VPL_LIGHTING_PHYSICAL;
        o.output.width = 320;
        o.output.height = 180;
        assert_int_equal(vplPlan_Create(scene, &o, NULL, &plan), VPL_SUCCESS);
        assert_int_equal(vplRenderLayers(scene, &o, &layers, &stats), VPL_SUCCESS);
        const double ratio = (double)plan->peakBytes / (double)stats.peakBytes;
        if (!(fabs(ratio - 1) <= 0.15)) {
            printf("# case %zu, %s %s, layers %s: %.2f MiB planned, %.2f held\n", i, w->words[0], w->words[1],
                   aovs[i % 4], (double)plan->peakBytes / 1048576, (double)stats.peakBytes / 1048576);
            wrong++;
        }
        vplPlan_Destroy(plan);
        vplLayers_Destroy(layers);
        vplScene_Destroy(scene);
        closeTestContext(context);
    }
    assert_int_equal(wrong, 0);
}
