// SPDX-License-Identifier: MIT
// The path-traced reference against analytic answers, against itself, and against the rasterizer's pixels.
#include "scenes.h"

#include "reference/path_trace.h"

#include <stdlib.h>

// ---- scenes in code

static vplScene* newScene(vplContext* context)
{
    vplScene* scene;
    assert_int_equal(vplScene_Create(context, &scene), VPL_SUCCESS);
    return scene;
}

static int addGrey(vplScene* scene, float rho, float emission)
{
    int index;
    vplMaterialDef def = vplDefaultMaterialDef();
    def.diffuse = (vplRgb){rho, rho, rho};
    def.emission = (vplRgb){emission, emission, emission};
    assert_int_equal(vplScene_AddMaterial(scene, &def, &index), VPL_SUCCESS);
    return index;
}

// `quarters` quarter turns about x: 0 faces +z, -1 up, 1 down.
static void addQuad(vplScene* scene, int material, vplVec3 place, int quarters, float size)
{
    vplObjectDef def = vplDefaultObjectDef();
    def.material = material;
    def.transform =
        vplMat4_FromParts(place, (double[3]){quarters * VPL_PI / 2, 0, 0}, (vplVec3){size, size, 1});
    assert_int_equal(vplScene_AddObject(scene, &def, NULL), VPL_SUCCESS);
}

// The cube [-1, 1]^3 as six quads that face inwards.
static void addRoom(vplScene* scene, int material)
{
    for (int face = 0; face < 6; face++) {
        static const vplVec3 places[6] = {{1, 0, 0},  {-1, 0, 0}, {0, 1, 0},
                                          {0, -1, 0}, {0, 0, 1},  {0, 0, -1}};
        static const double turns[6][2] = {{0, -1}, {0, 1}, {1, 0}, {-1, 0}, {0, 2}, {0, 0}}; // about x, y
        vplObjectDef def = vplDefaultObjectDef();
        def.material = material;
        const double rotate[3] = {turns[face][0] * VPL_PI / 2, turns[face][1] * VPL_PI / 2, 0};
        def.transform = vplMat4_FromParts(places[face], rotate, (vplVec3){2, 2, 1});
        assert_int_equal(vplScene_AddObject(scene, &def, NULL), VPL_SUCCESS);
    }
}

// A sphere of radius 1 made of an octahedron's faces, each cut into n^2; with normals of the true sphere or none.
static void addSphere(vplScene* scene, int material, vplVec3 centre, float radius, int n, bool smooth)
{
    const int perFace = (n + 1) * (n + 2) / 2;
    vplVec3* positions = malloc((size_t)(8 * perFace) * sizeof *positions);
    uint32_t* indices = malloc((size_t)(8 * n * n * 3) * sizeof *indices);
    int vertices = 0, count = 0;
    for (int face = 0; face < 8; face++) {
        const float sx = face & 1 ? -1 : 1, sy = face & 2 ? -1 : 1, sz = face & 4 ? -1 : 1;
        const bool turned = sx * sy * sz < 0;
        for (int i = 0; i <= n; i++) {
            for (int j = 0; j <= n - i; j++) {
                float x = sx * (float)i, y = sy * (float)j, z = sz * (float)(n - i - j);
                float length = sqrtf(x * x + y * y + z * z);
                const int at = vertices + i * (n + 1) - i * (i - 1) / 2 + j;
                positions[at] = (vplVec3){x / length, y / length, z / length};
                const uint32_t a = (uint32_t)at, right = a + 1, below = (uint32_t)(at + n + 1 - i);
                if (i + j < n) {
                    const uint32_t up[3] = {a, turned ? right : below, turned ? below : right};
                    memcpy(indices + 3 * count++, up, sizeof up);
                }
                if (i + j < n - 1) {
                    const uint32_t down[3] = {right, turned ? below + 1 : below, turned ? below : below + 1};
                    memcpy(indices + 3 * count++, down, sizeof down);
                }
            }
        }
        vertices += perFace;
    }
    vplMeshDef mesh = vplDefaultMeshDef();
    mesh.positions = positions;
    mesh.normals = smooth ? positions : NULL;
    mesh.indices = indices;
    mesh.vertexCount = vertices;
    mesh.triangleCount = count;
    vplObjectDef def = vplDefaultObjectDef();
    def.type = VPL_OBJECT_MESH;
    def.material = material;
    def.transform = vplMat4_FromParts(centre, (double[3]){0, 0, 0}, (vplVec3){radius, radius, radius});
    assert_int_equal(vplScene_AddMesh(scene, &mesh, &def.mesh), VPL_SUCCESS);
    assert_int_equal(vplScene_AddObject(scene, &def, NULL), VPL_SUCCESS);
    free(positions);
    free(indices);
}

static vplEmitterDef* addWhite(vplScene* scene, vplEmitterType type, vplVec3 position, float intensity)
{
    static vplEmitterDef def; // for the caller to compare with
    def = vplDefaultEmitterDef();
    def.type = type;
    def.position = position;
    def.intensity = (vplRgb){intensity, 2 * intensity, 0};
    assert_int_equal(vplScene_AddEmitter(scene, &def, NULL), VPL_SUCCESS);
    return &def;
}

static void addCamera(vplScene* scene, vplVec3 eye, vplVec3 target, double fovY)
{
    vplCameraDef def = vplDefaultCameraDef();
    def.eye = eye;
    def.target = target;
    def.up = eye.x == target.x && eye.z == target.z ? (vplVec3){0, 0, -1} : (vplVec3){0, 1, 0};
    def.near = 1e-3;
    def.far = 1e4;
    def.fovY = fovY;
    assert_int_equal(vplScene_AddCamera(scene, &def, NULL), VPL_SUCCESS);
}

static vplRenderOptions pathOptions(int size, int samples)
{
    vplRenderOptions o = vplDefaultRenderOptions();
    o.method = VPL_METHOD_PATH;
    o.output.width = o.output.height = size;
    o.path.samples = samples;
    return o;
}

static double meanOfImage(const vplImage* image, int channel)
{
    double sum = 0;
    for (int i = 0; i < image->width * image->height; i++) {
        sum += (double)image->pixels[3 * i + channel];
    }
    return sum / image->width / image->height;
}

// Mean of one channel of a small picture.
static double radianceOf(const vplScene* scene, const vplRenderOptions* options, int channel)
{
    vplImage* image = renderScene(scene, options, NULL);
    double mean = meanOfImage(image, channel);
    vplImage_Destroy(image);
    return mean;
}

// ---- a furnace: where all walls reflect rho and emit E, everything is E / (1 - rho)

static void FurnaceGlowsEverywhereAlike(void** state)
{
    (void)state;
    static const struct {
        float rho;
        int samples;
        double pixel, mean; // relative bounds: six and five standard deviations, measured with twenty seeds
    } cases[] = {{0, 1, 1e-6, 1e-6},
                 {0.1f, 64, 0.033, 0.0034},
                 {0.5f, 64, 0.09, 0.009},
                 {0.9f, 64, 0.14, 0.015},
                 {0.99f, 64, 0.16, 0.017}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        vplContext* context = openTestContext(2);
        vplScene* scene = newScene(context);
        addRoom(scene, addGrey(scene, cases[i].rho, 2));
        addCamera(scene, (vplVec3){0.3f, 0.1f, 0.2f}, (vplVec3){-1, -0.4f, -0.8f}, 1.5);
        vplRenderOptions options = pathOptions(8, cases[i].samples);
        vplImage* image = renderScene(scene, &options, NULL);
        const double wanted = 2 / (1 - (double)cases[i].rho);
        for (int k = 0; k < 3 * 8 * 8; k++) {
            assertNear((double)image->pixels[k], wanted, cases[i].pixel * wanted, "pixel", (int)i);
        }
        assertNear(meanOfImage(image, 0), wanted, cases[i].mean * wanted, "mean", (int)i);
        vplImage_Destroy(image);
        vplScene_Destroy(scene);
        closeTestContext(context);
    }
}

// A perfect reflector among walls that emit E shows E, or it makes or loses energy. Interpolated normals may lose
// what would have to be reflected into the surface, but never gain.
static void WhiteBodyInAFurnaceVanishes(void** state)
{
    (void)state;
    for (int smooth = 0; smooth < 2; smooth++) {
        vplContext* context = openTestContext(2);
        vplScene* scene = newScene(context);
        int white = addGrey(scene, 1, 0);
        addRoom(scene, addGrey(scene, 0, 1));
        addSphere(scene, white, (vplVec3){0, 0, 0}, 0.5f, 3, smooth);
        addCamera(scene, (vplVec3){0, 0, 0.95f}, (vplVec3){0, 0, 0}, 0.8);
        vplRenderOptions options = pathOptions(32, 64);
        vplImage* image = renderScene(scene, &options, NULL);
        double mean = meanOfImage(image, 1);
        if (smooth) {
            assert_true(mean < 1 + 1e-4 && mean > 0.95);
        } else {
            assertNear(mean, 1, 1e-3, "mean", smooth);
        }
        vplImage_Destroy(image);
        vplScene_Destroy(scene);
        closeTestContext(context);
    }
}

// ---- direct light with an analytic answer

static const double NARROW = 1e-7; // angle of view: what one small pixel sees is a point

static void PointLightFollowsTheInverseSquare(void** state)
{
    (void)state;
    vplContext* context = openTestContext(1);
    for (int i = 0; i < 5; i++) {
        const float x = 0.7f * (float)i;
        vplScene* scene = newScene(context);
        addQuad(scene, addGrey(scene, 0.5f, 0), (vplVec3){0, 0, 0}, -1, 20);
        addWhite(scene, VPL_EMITTER_POINT, (vplVec3){0, 2, 0}, 3);
        addCamera(scene, (vplVec3){x, 3, 0}, (vplVec3){x, 0, 0}, NARROW);
        vplRenderOptions options = pathOptions(1, 4);
        double d2 = 4 + (double)x * x, wanted = 0.5 / VPL_PI * 3 / d2 * (2 / sqrt(d2));
        assertNear(radianceOf(scene, &options, 0), wanted, 1e-6 * wanted, "red", i);
        assertNear(radianceOf(scene, &options, 1), 2 * wanted, 2e-6 * wanted, "green", i);
        assertNear(radianceOf(scene, &options, 2), 0, 0, "blue", i);
        vplScene_Destroy(scene);
    }
    closeTestContext(context);
}

static void SpotFadesSmoothlyBetweenItsAngles(void** state)
{
    (void)state;
    static const struct {
        double angle, share; // degrees; 3x^2 - 2x^3 of the cosine
    } cases[] = {{0, 1}, {15, 1}, {19.9, 1}, {25, -1}, {28, -1}, {30.1, 0}, {45, 0}};
    vplContext* context = openTestContext(1);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const double angle = cases[i].angle * VPL_PI / 180, inner = cos(VPL_PI / 9), outer = cos(VPL_PI / 6);
        const float x = (float)(2 * tan(angle));
        vplScene* scene = newScene(context);
        addQuad(scene, addGrey(scene, 0.5f, 0), (vplVec3){0, 0, 0}, -1, 20);
        addWhite(scene, VPL_EMITTER_SPOT, (vplVec3){0, 2, 0}, 3); // shines down: 20 and 30 degrees
        addCamera(scene, (vplVec3){x, 3, 0}, (vplVec3){x, 0, 0}, NARROW);
        vplRenderOptions options = pathOptions(1, 4);
        double way = (cos(angle) - outer) / (inner - outer);
        double share = cases[i].share < 0 ? way * way * (3 - 2 * way) : cases[i].share;
        double d2 = 4 + (double)x * x, wanted = share * 0.5 / VPL_PI * 3 / d2 * (2 / sqrt(d2));
        assertNear(radianceOf(scene, &options, 0), wanted, 4e-6 * wanted, "red", (int)i);
        vplScene_Destroy(scene);
    }
    closeTestContext(context);
}

static void DirectionalLightGoesByTheCosine(void** state)
{
    (void)state;
    vplContext* context = openTestContext(1);
    vplScene* scene = newScene(context);
    addQuad(scene, addGrey(scene, 0.5f, 0), (vplVec3){0, 0, 0}, -1, 20);
    vplEmitterDef sun = vplDefaultEmitterDef();
    sun.type = VPL_EMITTER_DIRECTIONAL;
    sun.direction = (vplVec3){3, -4, 0};
    sun.intensity = (vplRgb){7, 7, 7};
    assert_int_equal(vplScene_AddEmitter(scene, &sun, NULL), VPL_SUCCESS);
    addCamera(scene, (vplVec3){1, 3, 0}, (vplVec3){1, 0, 0}, NARROW);
    vplRenderOptions options = pathOptions(1, 4);
    double wanted = 0.5 / VPL_PI * 7 * 0.8;
    assertNear(radianceOf(scene, &options, 0), wanted, 1e-6 * wanted, "red", 0);
    vplScene_Destroy(scene);
    closeTestContext(context);
}

// Form factor of a rectangle from a parallel surface element under one corner; a, b sides over the distance.
static double cornerFactor(double a, double b)
{
    double p = sqrt(1 + a * a), q = sqrt(1 + b * b);
    return (a / p * atan(b / p) + b / q * atan(a / q)) / (2 * VPL_PI);
}

static void SquareLampGivesItsFormFactor(void** state)
{
    (void)state;
    static const struct {
        float size, height;
        double bound;
    } cases[] = {{1, 1, 5e-4}, {1, 4, 5e-4}, {4, 0.25f, 2e-3}, {1, 0.01f, 2e-3}};
    vplContext* context = openTestContext(1);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        vplScene* scene = newScene(context);
        addQuad(scene, addGrey(scene, 0.5f, 0), (vplVec3){0, 0, 0}, -1, 20);
        addQuad(scene, addGrey(scene, 0, 5), (vplVec3){0, cases[i].height, 0}, 1, cases[i].size);
        vplVec3 eye = {0.25f * cases[i].size, 0.5f * cases[i].height, 0}, target = eye;
        target.y = 0;
        addCamera(scene, eye, target, NARROW);
        vplRenderOptions options = pathOptions(1, 1 << 14);
        double far = 0.75 * (double)cases[i].size, near = 0.25 * (double)cases[i].size;
        double half = 0.5 * (double)cases[i].size, h = (double)cases[i].height;
        double factor = 2 * (cornerFactor(far / h, half / h) + cornerFactor(near / h, half / h));
        double wanted = 0.5 * 5 * factor;
        assertNear(radianceOf(scene, &options, 0), wanted, cases[i].bound * wanted, "radiance", (int)i);
        vplScene_Destroy(scene);
    }
    closeTestContext(context);
}

static void OnlyTheFrontOfALampEmits(void** state)
{
    (void)state;
    vplContext* context = openTestContext(1);
    for (int behind = 0; behind < 2; behind++) {
        vplScene* scene = newScene(context);
        addQuad(scene, addGrey(scene, 0, 5), (vplVec3){0, 0, 0}, 0, 1);
        addQuad(scene, addGrey(scene, 0.5f, 0), (vplVec3){0, 0, -1}, 0, 4); // what the back faces
        addCamera(scene, (vplVec3){0, 0, behind ? -0.5f : 1}, (vplVec3){0, 0, 0}, NARROW);
        addCamera(scene, (vplVec3){0.3f, 0, -0.5f}, (vplVec3){0.3f, 0, -1}, NARROW);
        vplRenderOptions options = pathOptions(1, 16);
        assertNear(radianceOf(scene, &options, 0), behind ? 0 : 5, 0, "lamp", behind);
        options.output.camera = 1;
        assertNear(radianceOf(scene, &options, 0), 0, 0, "behind it", behind);
        vplScene_Destroy(scene);
    }
    closeTestContext(context);
}

// ---- bounces with known answers

// The mean over all pixels is within four of its standard deviations, and those are within a share of it.
static void assertMean(const vplScene* scene, const vplRenderOptions* options, double wanted, double share,
                       const char* what, int row)
{
    vplRenderStats stats;
    vplImage* image = renderScene(scene, options, &stats);
    double deviations = 4 * stats.errorEstimate / options->output.width;
    assert_true(deviations < share * wanted);
    assertNear(meanOfImage(image, 0), wanted, fmax(deviations, 1e-6 * wanted), what, row);
    vplImage_Destroy(image);
}

static void CubeMatchesTheTableBounceByBounce(void** state)
{
    (void)state;
    static const char* const columns[] = {"E_direct", "E1_over_rho", "E2_over_rho^2", "E3_over_rho^3"};
    const float rho = 0.5f;
    Table t = loadTable("cube_physical.csv");
    vplContext* context = openTestContext(2);
    for (int row = 0; row < t.rows; row++) {
        const float u = (float)number(&t, row, "u"), v = (float)number(&t, row, "v");
        vplScene* scene = newScene(context);
        addRoom(scene, addGrey(scene, rho, 0));
        addWhite(scene, VPL_EMITTER_POINT, (vplVec3){0, 0, 0}, 1);
        addCamera(scene, (vplVec3){u, 0, v}, (vplVec3){u, -1, v}, NARROW);
        vplRenderOptions options = pathOptions(8, 512);
        options.output.show = VPL_SHOW_BOUNCE;
        for (int k = 0; k < 4; k++) {
            options.output.showIndex = k;
            double wanted = pow((double)rho, k + 1) / VPL_PI * number(&t, row, columns[k]);
            assertMean(scene, &options, wanted, k == 0 ? 1e-6 : k == 1 ? 0.01 : 0.025, columns[k], row);
        }
        options.output.show = VPL_SHOW_INDIRECT;
        double wanted = (double)rho / VPL_PI * number(&t, row, "E_indirect_total_rho0.5");
        assertMean(scene, &options, wanted, 0.015, "all bounces", row);
        vplScene_Destroy(scene);
    }
    freeTable(&t);
    closeTestContext(context);
}

// A light in the middle of a sphere: rho/pi I/R^2 / (1 - rho) everywhere. The mesh is inside the sphere by up to
// 1 - cos(its edges' half angle), 0.05 %, and R^2 twice that.
static void SphereMatchesTheTable(void** state)
{
    (void)state;
    Table t = loadTable("furnace_sphere.csv");
    vplContext* context = openTestContext(2);
    for (int row = 0; row < t.rows; row++) {
        const float radius = (float)number(&t, row, "R"), rho = (float)number(&t, row, "rho");
        vplScene* scene = newScene(context);
        addSphere(scene, addGrey(scene, rho, 0), (vplVec3){0, 0, 0}, radius, 32, row & 1);
        addWhite(scene, VPL_EMITTER_POINT, (vplVec3){0, 0, 0}, (float)number(&t, row, "I"));
        vplCameraDef camera = vplDefaultCameraDef();
        camera.eye = (vplVec3){0.1f * radius, 0.2f * radius, 0.3f * radius};
        camera.near = 0.01 * (double)radius;
        camera.far = 3 * (double)radius;
        camera.target = (vplVec3){-radius, 0, 0};
        camera.fovY = 1.5;
        assert_int_equal(vplScene_AddCamera(scene, &camera, NULL), VPL_SUCCESS);
        vplRenderOptions options = pathOptions(16, 64);
        double total = number(&t, row, "radiance_total_phys");
        assertNear(radianceOf(scene, &options, 0), total, 5e-3 * total, "total", row);
        options.output.show = VPL_SHOW_DIRECT;
        double direct = number(&t, row, "radiance_direct_phys");
        assertNear(radianceOf(scene, &options, 0), direct, 2e-3 * direct, "direct", row);
        vplScene_Destroy(scene);
    }
    freeTable(&t);
    closeTestContext(context);
}

static vplScene* loadExample(vplContext* context, const char* path)
{
    vplScene* scene = NULL;
    if (vplScene_Load(context, path, &scene) != VPL_SUCCESS) {
        fail_msg("%s: %s", path, takeMessage());
    }
    return scene;
}

static const char ROOM[] = "examples/scenes/room.json", LAMP_ROOM[] = "examples/scenes/room-area.json";

static vplImage* renderShown(const vplScene* scene, vplShow show, int bounce)
{
    vplRenderOptions options = pathOptions(32, 5);
    options.maxBounces = 3;
    options.output.show = show;
    options.output.showIndex = bounce;
    return renderScene(scene, &options, NULL);
}

// Whatever is shown, the same paths are followed, so parts add up to the whole but for rounding.
static void PartsAddUpToThePicture(void** state)
{
    (void)state;
    static const char* const scenes[] = {ROOM, LAMP_ROOM};
    vplContext* context = openTestContext(2);
    for (int s = 0; s < 2; s++) {
        vplScene* scene = loadExample(context, scenes[s]);
        vplImage* picture = renderShown(scene, VPL_SHOW_PICTURE, 0);
        vplImage* direct = renderShown(scene, VPL_SHOW_DIRECT, 0);
        vplImage* indirect = renderShown(scene, VPL_SHOW_INDIRECT, 0);
        vplImage* bounces[5];
        for (int k = 0; k < 5; k++) {
            bounces[k] = renderShown(scene, VPL_SHOW_BOUNCE, k);
        }
        double emitted = 0;
        for (int i = 0; i < 3 * 32 * 32; i++) {
            double whole = (double)picture->pixels[i], part = (double)indirect->pixels[i];
            assertNear((double)direct->pixels[i] + part, whole, 1e-6 * whole, "direct and indirect", i);
            double sum = 0;
            for (int k = 1; k < 4; k++) {
                sum += (double)bounces[k]->pixels[i];
            }
            assertNear(sum, part, 1e-6 * part, "bounces 1 to 3", i);
            assertNear((double)bounces[4]->pixels[i], 0, 0, "a bounce beyond the last", i);
            emitted += (double)direct->pixels[i] - (double)bounces[0]->pixels[i];
        }
        assert_true(s == 0 ? emitted == 0 : emitted > 100); // bounce 0 has no emission in it
        vplImage_Destroy(picture);
        vplImage_Destroy(direct);
        vplImage_Destroy(indirect);
        for (int k = 0; k < 5; k++) {
            vplImage_Destroy(bounces[k]);
        }
        vplScene_Destroy(scene);
    }
    closeTestContext(context);
}

// ---- error, bits, pixels

static double squaredDifference(const vplImage* a, const vplImage* b)
{
    double squares = 0;
    for (int i = 0; i < 3 * a->width * a->height; i++) {
        double apart = (double)a->pixels[i] - (double)b->pixels[i];
        squares += apart * apart;
    }
    return squares / (3.0 * a->width * a->height);
}

// Few bright pixels make most of the error, so a single pair of pictures says little: twelve pairs are taken.
static void ErrorEstimatePredictsTheDifferenceOfSeeds(void** state)
{
    (void)state;
    static const char* const scenes[] = {ROOM, LAMP_ROOM};
    vplContext* context = openTestContext(2);
    for (int s = 0; s < 2; s++) {
        vplScene* scene = loadExample(context, scenes[s]);
        vplRenderOptions options = pathOptions(40, 15); // odd: the halves differ in size
        double found = 0, predicted = 0;
        for (int pair = 0; pair < 12; pair++) {
            vplImage* images[2];
            for (int i = 0; i < 2; i++) {
                vplRenderStats stats;
                images[i] = renderScene(scene, &options, &stats);
                predicted += stats.errorEstimate * stats.errorEstimate;
                double sum =
                    meanOfImage(images[i], 0) + meanOfImage(images[i], 1) + meanOfImage(images[i], 2);
                assertNear(stats.relativeErrorEstimate, stats.errorEstimate * 3 / sum,
                           1e-6 * stats.relativeErrorEstimate, "relative", s);
                assert_true(stats.rays > 40 * 40 * 15);
                options.seed++;
            }
            found += squaredDifference(images[0], images[1]);
            vplImage_Destroy(images[0]);
            vplImage_Destroy(images[1]);
        }
        assertNear(sqrt(found / predicted), 1, 0.15, "found / predicted", s);
        vplRenderStats stats;
        options.path.samples = 1;
        vplImage_Destroy(renderScene(scene, &options, &stats));
        assert_true(stats.errorEstimate < 0); // nothing to compare with
        vplScene_Destroy(scene);
    }
    closeTestContext(context);
}

static vplImage* traceWith(const vplScene* scene, const vplGeometry* geometry, const vplPathDef* def,
                           int samples, vplPathStats* stats)
{
    vplPathTracer* tracer;
    vplImage* image;
    vplPathDef d = *def;
    d.camera = vplScene_GetCamera(scene, 0);
    d.emitterCount = vplScene_GetEmitterCount(scene);
    d.emitters = d.emitterCount ? vplScene_GetEmitter(scene, 0) : NULL;
    d.width = d.height = 24;
    assert_int_equal(vplPathTracer_Create(geometry, &d, &tracer), VPL_SUCCESS);
    assert_int_equal(vplPathTracer_Pass(tracer, samples, NULL, NULL, 0, 1), VPL_SUCCESS);
    assert_int_equal(vplImage_Create(geometry->context, 24, 24, &image), VPL_SUCCESS);
    vplPathTracer_Resolve(tracer, image, stats);
    vplPathTracer_Destroy(tracer);
    return image;
}

// Every emitter type, a lamp, and a smooth sphere: what each way finds is the same light. Pictures differ by no more
// than their error estimates say, and so do their means.
static void AllWaysOfFindingLightAgree(void** state)
{
    (void)state;
    vplContext* context = openTestContext(2);
    vplScene* scene = newScene(context);
    vplGeometry* geometry;
    addRoom(scene, addGrey(scene, 0.6f, 0));
    addQuad(scene, addGrey(scene, 0.3f, 4), (vplVec3){0.3f, 0.6f, 0}, 1, 0.5f);
    addSphere(scene, addGrey(scene, 0.8f, 0), (vplVec3){-0.4f, -0.5f, 0}, 0.4f, 3, true);
    addWhite(scene, VPL_EMITTER_POINT, (vplVec3){0.5f, -0.5f, 0.3f}, 0.4f);
    addWhite(scene, VPL_EMITTER_POINT, (vplVec3){-0.5f, 0.5f, -0.3f}, 0.2f);
    addWhite(scene, VPL_EMITTER_SPOT, (vplVec3){-0.5f, 0.8f, 0.3f}, 2);
    addCamera(scene, (vplVec3){0, 0, 0.9f}, (vplVec3){0, -0.1f, -1}, 1.4);
    assert_int_equal(vplGeometry_Create(scene, &geometry), VPL_SUCCESS);
    vplPathDef def = vplDefaultPathDef();
    def.emission = false; // its edges would hide the rest
    def.lastBounce = 4;
    vplPathStats stats, other;
    vplImage* all = traceWith(scene, geometry, &def, 1024, &stats);
    static const int ways[] = {VPL_PATH_LIGHT_SAMPLING,
                               VPL_PATH_BSDF_SAMPLING,
                               VPL_PATH_LIGHT_SAMPLING | VPL_PATH_BSDF_SAMPLING,
                               VPL_PATH_BSDF_SAMPLING | VPL_PATH_PARTICLES,
                               VPL_PATH_ALL,
                               VPL_PATH_ALL};
    for (int i = 0; i < 6; i++) {
        def.seed = 1 + (uint64_t)i;
        def.techniques = ways[i];
        def.balanceHeuristic = i & 1;
        def.random = i == 4;
        vplImage* image = traceWith(scene, geometry, &def, 512, &other);
        double predicted =
            stats.errorEstimate * stats.errorEstimate + other.errorEstimate * other.errorEstimate;
        assertNear(sqrt(squaredDifference(all, image) / predicted), 1, 0.2, "found / predicted", i);
        for (int c = 0; c < 2;
             c++) { // the mean of 576 pixels: three standard deviations, and red is less noisy
            assertNear(meanOfImage(image, c), meanOfImage(all, c), 2 * 3 * sqrt(predicted) / 24, "mean", i);
        }
        vplImage_Destroy(image);
    }
    vplImage_Destroy(all);
    vplGeometry_Destroy(geometry);
    vplScene_Destroy(scene);
    closeTestContext(context);
}

static uint64_t hashOf(vplContext* context, const char* path)
{
    vplRenderStats stats;
    vplRenderOptions options = pathOptions(40, 7);
    vplScene* scene = loadExample(context, path);
    vplImage_Destroy(renderScene(scene, &options, &stats));
    vplScene_Destroy(scene);
    closeTestContext(context);
    return stats.imageHash;
}

static void SameBitsForAllThreadsAndInstructionSets(void** state)
{
    (void)state;
    static const char* const scenes[] = {ROOM, LAMP_ROOM};
    for (int s = 0; s < 2; s++) {
        uint64_t wanted = hashOf(openTestContext(1), scenes[s]);
        static const int workers[] = {2, 3, 7};
        for (int i = 0; i < 3; i++) {
            assert_int_equal(hashOf(openTestContext(workers[i]), scenes[s]), wanted);
        }
        for (int isa = VPL_ISA_SCALAR; isa < VPL_ISA_COUNT; isa++) {
            vplContext* context = openIsaContext(2, (vplIsa)isa);
            if (context != NULL) {
                assert_int_equal(hashOf(context, scenes[s]), wanted);
            }
        }
    }
}

static void PassesOfAnySizeEndInTheSameBits(void** state)
{
    (void)state;
    static const int passes[3][4] = {{7}, {1, 6}, {3, 1, 2, 1}};
    vplContext* context = openTestContext(2);
    vplScene* scene = loadExample(context, LAMP_ROOM);
    vplGeometry* geometry;
    uint64_t hashes[3];
    assert_int_equal(vplGeometry_Create(scene, &geometry), VPL_SUCCESS);
    for (int i = 0; i < 3; i++) {
        vplPathDef def = vplDefaultPathDef();
        def.camera = vplScene_GetCamera(scene, 0);
        def.width = 40;
        def.height = 24;
        vplPathTracer* tracer;
        vplImage* image;
        vplPathStats stats;
        assert_int_equal(vplPathTracer_Create(geometry, &def, &tracer), VPL_SUCCESS);
        for (int k = 0; k < 4 && passes[i][k] > 0; k++) {
            assert_int_equal(vplPathTracer_Pass(tracer, passes[i][k], NULL, NULL, 0, 1), VPL_SUCCESS);
        }
        assert_int_equal(vplImage_Create(context, 40, 24, &image), VPL_SUCCESS);
        vplPathTracer_Resolve(tracer, image, &stats);
        hashes[i] = vplImage_Hash(image);
        vplImage_Destroy(image);
        vplPathTracer_Destroy(tracer);
    }
    assert_int_equal(hashes[0], hashes[1]);
    assert_int_equal(hashes[0], hashes[2]);
    vplGeometry_Destroy(geometry);
    vplScene_Destroy(scene);
    closeTestContext(context);
}

// Where all samples of a pixel show one surface, the rasterizer must show it there, too; and most pixels are so.
static void PixelsAreTheRasterizersPixels(void** state)
{
    (void)state;
    vplContext* context = openTestContext(2);
    vplScene* scene = newScene(context);
    for (int i = 0; i < 40; i++) {
        vplObjectDef def = vplDefaultObjectDef();
        def.type = i & 1 ? VPL_OBJECT_BOX : VPL_OBJECT_QUAD;
        // No mixture of two of these has the square of its red as green.
        vplMaterialDef material = vplDefaultMaterialDef();
        material.diffuse = (vplRgb){0, 0, 0};
        material.emission = (vplRgb){(float)(i + 1), (float)((i + 1) * (i + 1)), 0};
        assert_int_equal(vplScene_AddMaterial(scene, &material, &def.material), VPL_SUCCESS);
        float p[6];
        for (int k = 0; k < 6; k++) {
            p[k] = (float)uniformAt(5, (uint64_t)(6 * i + k));
        }
        def.transform = vplMat4_FromParts((vplVec3){4 * p[0] - 2, 4 * p[1] - 2, 4 * p[2] - 2},
                                          (double[3]){6 * (double)p[3], 6 * (double)p[4], 6 * (double)p[5]},
                                          (vplVec3){1, 0.7f, 0.5f});
        assert_int_equal(vplScene_AddObject(scene, &def, NULL), VPL_SUCCESS);
    }
    vplCameraDef camera = vplDefaultCameraDef();
    camera.near = 3.2; // both cut through objects
    camera.far = 6.5;
    assert_int_equal(vplScene_AddCamera(scene, &camera, NULL), VPL_SUCCESS);
    vplRenderOptions options = pathOptions(96, 64);
    options.output.width = 128;
    vplImage* paths = renderScene(scene, &options, NULL);
    options.method = VPL_METHOD_DIRECT;
    vplImage* raster = renderScene(scene, &options, NULL);
    int pure = 0;
    for (int i = 0; i < 128 * 96; i++) {
        float value = paths->pixels[3 * i];
        if (paths->pixels[3 * i + 1] == value * value) {
            pure++;
            assertNear((double)raster->pixels[3 * i], (double)value, 0, "pixel", i);
        }
    }
    assert_true(pure > 128 * 96 * 8 / 10 && pure < 128 * 96);
    vplImage_Destroy(paths);
    vplImage_Destroy(raster);
    vplScene_Destroy(scene);
    closeTestContext(context);
}

// ---- what must not break it

static void LightsOnSurfacesAndEdgesGiveNumbers(void** state)
{
    (void)state;
    vplContext* context = openTestContext(2);
    vplScene* scene = newScene(context);
    int grey = addGrey(scene, 1, 0), lamp = addGrey(scene, 0.5f, 1e15f);
    addRoom(scene, grey);
    addQuad(scene, lamp, (vplVec3){0, -1, 0}, -1, 0.5f);             // in the floor
    addQuad(scene, lamp, (vplVec3){0, 0, -1}, 0, 1e-6f);             // tiny, in the wall
    addQuad(scene, grey, (vplVec3){0, 0, 0}, -1, 1e-15f);            // a speck
    addWhite(scene, VPL_EMITTER_POINT, (vplVec3){0, 1, 0}, 5e14f);   // in the ceiling
    addWhite(scene, VPL_EMITTER_POINT, (vplVec3){1, 1, -1}, 1);      // in a corner
    addWhite(scene, VPL_EMITTER_SPOT, (vplVec3){0, -1, 0}, 1);       // on a lamp
    addWhite(scene, VPL_EMITTER_DIRECTIONAL, (vplVec3){0, 0, 0}, 1); // along the walls
    addWhite(scene, VPL_EMITTER_POINT, (vplVec3){5, 5, 5}, 0);
    addCamera(scene, (vplVec3){0, 0, 0.99f}, (vplVec3){0.1f, -0.2f, -1}, 2.8);
    vplRenderOptions options = pathOptions(24, 8);
    options.maxBounces = 20;
    vplRenderStats stats;
    vplImage* image = renderScene(scene, &options, &stats);
    for (int i = 0; i < 3 * 24 * 24; i++) {
        assert_true(image->pixels[i] >= 0 && image->pixels[i] < INFINITY);
    }
    assert_true(isfinite(stats.errorEstimate) && isfinite(stats.relativeErrorEstimate));
    vplImage_Destroy(image);
    vplScene_Destroy(scene);
    closeTestContext(context);
}

// Nothing absorbs and nothing lets out: paths end all the same.
static void PerfectMirrorRoomEnds(void** state)
{
    (void)state;
    vplContext* context = openTestContext(1);
    vplScene* scene = newScene(context);
    addRoom(scene, addGrey(scene, 1, 0));
    addWhite(scene, VPL_EMITTER_POINT, (vplVec3){0, 0, 0}, 1);
    addCamera(scene, (vplVec3){0, 0, 0.5f}, (vplVec3){0, 0, -1}, 1);
    vplRenderOptions options = pathOptions(1, 1);
    double mean = radianceOf(scene, &options, 0);
    assert_true(mean > 1e3 && mean < 1e5);
    vplScene_Destroy(scene);
    closeTestContext(context);
}

static void NothingToSeeIsBlack(void** state)
{
    (void)state;
    vplContext* context = openTestContext(1);
    vplScene* scene = newScene(context);
    addCamera(scene, (vplVec3){0, 0, 1}, (vplVec3){0, 0, 0}, 1);
    vplRenderOptions options = pathOptions(8, 2);
    vplRenderStats stats;
    vplImage* image = renderScene(scene, &options, &stats);
    assertNear(meanOfImage(image, 0), 0, 0, "mean", 0);
    assertNear(stats.relativeErrorEstimate, 0, 0, "relative error", 0);
    vplImage_Destroy(image);
    vplScene_Destroy(scene);
    closeTestContext(context);
}

static void WhatIsNotAskedOfPathsIsRefused(void** state)
{
    (void)state;
    static const vplShow shows[] = {VPL_SHOW_DEPTH,         VPL_SHOW_NORMALS, VPL_SHOW_SHADOW_MAP,
                                    VPL_SHOW_SHADOW_FACTOR, VPL_SHOW_LIGHT,   VPL_SHOW_OVERLAY};
    vplContext* context = openTestContext(1);
    vplScene* scene = loadExample(context, ROOM);
    vplImage* image = NULL;
    vplRenderOptions options = pathOptions(8, 1);
    options.lighting = VPL_LIGHTING_DOCUMENTED;
    assert_int_equal(vplRender(scene, &options, &image, NULL), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "documented"));
    options.lighting = VPL_LIGHTING_PHYSICAL;
    for (size_t i = 0; i < sizeof shows / sizeof *shows; i++) {
        options.output.show = shows[i];
        assert_int_equal(vplRender(scene, &options, &image, NULL), VPL_INVALID_ARGUMENT);
        assert_non_null(strstr(takeMessage(), "bounce:K"));
    }
    assert_null(image);
    vplScene_Destroy(scene);
    closeTestContext(context);
}

static bool stopAtOnce(void* user, double fraction)
{
    int* calls = user;
    assert_true(fraction >= 0 && fraction <= 1);
    return --*calls > 0;
}

static void ProgressCanCancel(void** state)
{
    (void)state;
    vplContext* context = openTestContext(1);
    vplScene* scene = loadExample(context, ROOM);
    vplImage* image = NULL;
    vplRenderOptions options = pathOptions(64, 1 << 24); // would take hours
    int calls = 5;
    options.progress = stopAtOnce;
    options.progressUser = &calls;
    assert_int_equal(vplRender(scene, &options, &image, NULL), VPL_CANCELLED);
    assert_null(image);
    assert_int_equal(calls, 0);
    vplScene_Destroy(scene);
    closeTestContext(context);
}

TEST_SUITE(path, slow_unit_test(FurnaceGlowsEverywhereAlike), cmocka_unit_test(WhiteBodyInAFurnaceVanishes),
           cmocka_unit_test(PointLightFollowsTheInverseSquare),
           cmocka_unit_test(SpotFadesSmoothlyBetweenItsAngles),
           cmocka_unit_test(DirectionalLightGoesByTheCosine), cmocka_unit_test(SquareLampGivesItsFormFactor),
           cmocka_unit_test(OnlyTheFrontOfALampEmits), slow_unit_test(CubeMatchesTheTableBounceByBounce),
           slow_unit_test(SphereMatchesTheTable), cmocka_unit_test(PartsAddUpToThePicture),
           slow_unit_test(ErrorEstimatePredictsTheDifferenceOfSeeds),
           slow_unit_test(AllWaysOfFindingLightAgree),
           cmocka_unit_test(SameBitsForAllThreadsAndInstructionSets),
           cmocka_unit_test(PassesOfAnySizeEndInTheSameBits), cmocka_unit_test(PixelsAreTheRasterizersPixels),
           cmocka_unit_test(LightsOnSurfacesAndEdgesGiveNumbers), cmocka_unit_test(PerfectMirrorRoomEnds),
           cmocka_unit_test(NothingToSeeIsBlack), cmocka_unit_test(WhatIsNotAskedOfPathsIsRefused),
           cmocka_unit_test(ProgressCanCancel));
