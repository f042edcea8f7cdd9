// SPDX-License-Identifier: MIT
// Running out of memory: the n-th allocation fails, for every n, and each time the answer is VPL_OUT_OF_MEMORY,
// one sentence, nothing leaked and no file. New memory is filled with junk, so that success does not depend on it.
#include "patch_support.h"
#include "shapes.h"
#include "sides_fixture.h"

#include "render/show_maps.h"

#include <jansson.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

typedef struct Failing {
    long allocations; // so far
    long failAt;      // this one returns NULL; -1: none
    bool stayEmpty;   // and all after it
    long held;        // blocks not yet freed
    int errors;       // sentences logged
} Failing;

static void* failingAlloc(void* user, void* memory, size_t oldSize, size_t newSize)
{
    Failing* f = user;
    if (newSize == 0) {
        f->held -= memory != NULL;
        free(memory);
        return NULL;
    }
    long number = f->allocations++;
    if (number == f->failAt || (f->stayEmpty && f->failAt >= 0 && number > f->failAt)) {
        return NULL;
    }
    char* block = realloc(memory, newSize);
    f->held += memory == NULL && block != NULL;
    if (block != NULL && newSize > oldSize) {
        memset(block + oldSize, 0xCD, newSize - oldSize);
    }
    return block;
}

static void countErrors(void* user, vplLogLevel level, const char* message)
{
    Failing* f = user;
    f->errors += level == VPL_LOG_ERROR && message[0] != 0;
}

static vplContext* openFailing(Failing* f)
{
    vplContextDef def = vplDefaultContextDef();
    def.alloc = failingAlloc;
    def.allocUser = f;
    def.log = countErrors;
    def.logUser = f;
    def.workerCount = 2;
    vplContext* context = NULL;
    vplContext_Create(&def, &context);
    return context;
}

typedef vplResult Work(vplContext* context, const char* path, int variant);

// Does the work with every allocation failing in turn, until it succeeds because there is none left to fail.
static void failEveryAllocation(Work* work, const char* extension, int variant, bool stayEmpty)
{
    char folder[] = "/tmp/vpl-memory-XXXXXX", path[64];
    assert_non_null(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/a.%s", folder, extension);
    vplResult result = VPL_OUT_OF_MEMORY;
    long n = 0;
    for (; result != VPL_SUCCESS; n++) {
        Failing failing = {.failAt = n, .stayEmpty = stayEmpty};
        vplContext* context = openFailing(&failing);
        result = context ? work(context, path, variant) : VPL_OUT_OF_MEMORY;
        bool intact = context == NULL || vplContext_GetBytes(context) == 0;
        vplContext_Destroy(context);
        struct stat info;
        bool written = stat(path, &info) == 0;
        if (result == VPL_SUCCESS) {
            assert_true(failing.allocations <= n && failing.errors == 0);
        } else if (result != VPL_OUT_OF_MEMORY || (stayEmpty ? failing.errors < 1 : failing.errors != 1) ||
                   written) {
            fail_msg("variant %d, allocation %ld: %s, %d sentences%s", variant, n, vplResult_GetName(result),
                     failing.errors, written ? ", a file" : "");
        }
        if (failing.held != 0 || !intact) {
            fail_msg("variant %d, allocation %ld: %ld blocks leaked", variant, n, failing.held);
        }
        unlink(path);
    }
    assert_true(n > 5);
    assert_int_equal(rmdir(folder), 0); // fails if a temporary file stayed behind
}

static vplRenderOptions smallOptions(int pipeline)
{
    vplRenderOptions options = vplDefaultRenderOptions();
    options.output.width = 32;
    options.output.height = 24;
    options.shadow.mapSize = 16;
    options.particles.count = 6;
    options.pipeline.batch = 4;
    options.pipeline.kind = (vplAccumulation)pipeline;
    return options;
}

// A whole run of the program: scene file in, picture file out.
static vplResult renderFile(vplContext* context, const char* from, const vplRenderOptions* options,
                            const vplWriteOptions* write, const char* to)
{
    vplScene* scene = NULL;
    vplImage* image = NULL;
    vplResult result = vplScene_Load(context, from, &scene);
    if (result == VPL_SUCCESS) {
        result = vplRender(scene, options, &image, NULL);
    }
    if (result == VPL_SUCCESS) {
        result = vplImage_Write(image, to, write);
    }
    vplImage_Destroy(image);
    vplScene_Destroy(scene);
    return result;
}

static vplResult renderAndWrite(vplContext* context, const char* path, int pipeline)
{
    vplRenderOptions options = smallOptions(pipeline);
    vplWriteOptions write = vplDefaultWriteOptions();
    write.tonemap = VPL_TONEMAP_REINHARD;
    return renderFile(context, "tests/data/room.json", &options, &write, path);
}

TEST_ALONE(EveryFailedAllocationOfARenderIsReported)
{
    const char* const extensions[] = {"png", vplImage_CanWrite("a.exr") ? "exr" : "hdr", "pfm", "pfm"};
    for (int pipeline = VPL_ACCUMULATE_MULTIPASS; pipeline <= VPL_ACCUMULATE_INTERLEAVED; pipeline++) {
        failEveryAllocation(renderAndWrite, extensions[pipeline], pipeline, false);
        failEveryAllocation(renderAndWrite, extensions[pipeline], pipeline, true);
    }
}

static vplResult compensateAndWrite(vplContext* context, const char* path, int variant)
{
    vplRenderOptions options = vplDefaultRenderOptions();
    options.output.width = options.output.height = 20;
    options.method = VPL_METHOD_KELLER;
    options.particles.count = 5;
    options.pipeline.kind = variant ? VPL_ACCUMULATE_INTERLEAVED : VPL_ACCUMULATE_DEFERRED;
    return renderFile(context, "examples/scenes/room-area.json", &options, NULL, path);
}

static vplResult pathAndWrite(vplContext* context, const char* path, int variant)
{
    vplRenderOptions options = smallOptions(VPL_ACCUMULATE_DEFERRED);
    options.method = VPL_METHOD_PATH;
    options.path.samples = 2;
    return renderFile(context, variant ? "examples/scenes/room-area.json" : "examples/scenes/room.json",
                      &options, NULL, path);
}

TEST_ALONE(EveryFailedAllocationOfCompensationIsReported)
{
    for (int variant = 0; variant < 2; variant++) {
        failEveryAllocation(compensateAndWrite, "png", variant, false);
    }
}

TEST_ALONE(EveryFailedAllocationOfThePathTracerIsReported)
{
    for (int variant = 0; variant < 2; variant++) {
        failEveryAllocation(pathAndWrite, "pfm", variant, variant);
    }
}

// ---- meshes of patches

// Every third patch of 100 is bisected, so that edges of others are cut.
static vplResult openThirds(const vplGeometry* geometry, vplPatches** patchesOut)
{
    vplPatchDef def = vplDefaultPatchDef();
    vplPatches* whole = NULL;
    def.count = 100;
    vplResult result = vplPatches_Create(geometry, &def, &whole);
    if (result == VPL_SUCCESS) {
        float* priorities = calloc((size_t)whole->patchCount, sizeof *priorities);
        for (int i = 0; i < whole->patchCount; i += 3) {
            priorities[i] = 1;
        }
        result = vplPatches_Refine(whole, priorities, VPL_MAX_PATCHES, patchesOut);
        free(priorities);
    }
    vplPatches_Destroy(whole);
    return result;
}

// A room in uneven patches: mesh, means, picture and file.
static vplResult meshAndWrite(vplContext* context, const char* path, int variant)
{
    vplScene* scene = NULL;
    vplGeometry* geometry = NULL;
    vplResult result = vplScene_Load(context, "tests/data/room.json", &scene);
    if (result == VPL_SUCCESS) {
        result = vplGeometry_Create(scene, &geometry);
    }
    vplScene_Destroy(scene);
    if (result != VPL_SUCCESS) {
        return result;
    }
    vplPatches* patches = NULL;
    result = openThirds(geometry, &patches);
    if (result != VPL_SUCCESS) {
        vplGeometry_Destroy(geometry);
        return result;
    }
    vplPatchSides* sides = openSides(patches, allOpen);
    const size_t most = 6 * (size_t)patches->patchCount * 8;
    vplRgb *values = calloc(most, sizeof *values), *corners = calloc(most, sizeof *corners);
    float(*clip)[4] = calloc(most, sizeof *clip);
    vplPatchMesh* mesh = NULL;
    vplImage* image = NULL;
    result = vplPatchMesh_Create(sides, &mesh);
    if (result == VPL_SUCCESS) {
        result = vplPatchMesh_Interpolate(mesh, VPL_VERTEX_WEIGHT_ANGLE, values, corners);
    }
    if (result == VPL_SUCCESS) {
        result = vplImage_Create(context, 16, 16, &image);
    }
    if (result == VPL_SUCCESS) {
        const vplPatchDraw draw = {.mesh = mesh, .values = values, .vertexValues = variant ? corners : NULL};
        result = vplDrawPatches(&draw, (const float(*)[4])clip, NULL, NULL, image, NULL);
    }
    if (result == VPL_SUCCESS) {
        result = vplPatchMesh_WritePly(mesh, corners, 1, path);
    }
    vplImage_Destroy(image);
    vplPatchMesh_Destroy(mesh);
    free(clip);
    free(values);
    free(corners);
    closeSides(sides);
    vplPatches_Destroy(patches);
    vplGeometry_Destroy(geometry);
    return result;
}

TEST_ALONE(EveryFailedAllocationOfPatchMeshesIsReported)
{
    for (int variant = 0; variant < 2; variant++) {
        failEveryAllocation(meshAndWrite, "ply", variant, variant);
    }
}

// ---- meshes with a tree, lamps, and shadows of virtual lights

static vplResult addBall(vplScene* scene, const Shape* ball)
{
    uint32_t indices[3 * 320];
    for (uint32_t i = 0; i < 3 * 320; i++) {
        indices[i] = i;
    }
    vplMeshDef mesh = vplDefaultMeshDef();
    vplObjectDef object = vplDefaultObjectDef();
    vplMaterialDef lamp = vplDefaultMaterialDef();
    mesh.positions = mesh.normals = ball->corners;
    mesh.indices = indices;
    mesh.vertexCount = 3 * ball->triangleCount;
    mesh.triangleCount = ball->triangleCount;
    lamp.emission = (vplRgb){1, 2, 3};
    vplResult result = vplScene_AddMesh(scene, &mesh, &object.mesh);
    if (result == VPL_SUCCESS) {
        result = vplScene_AddMaterial(scene, &lamp, &object.material);
    }
    if (result == VPL_SUCCESS) {
        object.type = VPL_OBJECT_MESH;
        object.transform.m[13] = 3;
        result = vplScene_AddObject(scene, &object, NULL);
    }
    return result;
}

// Variants: a pipeline each for no shadows, maps and rays.
static vplResult renderBall(vplContext* context, const char* path, int variant)
{
    (void)path;
    vplScene* scene = NULL;
    vplImage* image = NULL;
    Shape ball = icosphere(2);
    vplRenderOptions options = smallOptions(variant);
    options.lights.shadows = (vplLightShadows)variant;
    options.output.width = options.output.height = 8;
    options.particles.count = 2;
    options.shadow.mapSize = options.lights.mapSize = 2;
    options.lights.areaLightSamples = 3;
    vplResult result = vplScene_Load(context, "tests/data/room.json", &scene);
    if (result == VPL_SUCCESS) {
        result = addBall(scene, &ball);
    }
    if (result == VPL_SUCCESS) {
        result = vplRender(scene, &options, &image, NULL);
    }
    vplImage_Destroy(image);
    vplScene_Destroy(scene);
    freeShape(&ball);
    return result;
}

// Variants: two lights, and so many that the top of their tree is built before its parts.
static vplResult renderCuts(vplContext* context, const char* path, int variant)
{
    (void)path;
    vplScene* scene = NULL;
    vplImage* image = NULL;
    vplRenderOptions options = vplDefaultRenderOptions();
    options.output.width = options.output.height = 4;
    options.particles.count = variant ? 2000 : 1;
    options.shadow.mapSize = 2;
    options.pipeline.kind = VPL_ACCUMULATE_LIGHTCUTS;
    options.lights.shadows = VPL_LIGHT_SHADOWS_RAY;
    vplResult result = vplScene_Load(context, "tests/data/room.json", &scene);
    if (result == VPL_SUCCESS) {
        result = vplRender(scene, &options, &image, NULL);
    }
    vplImage_Destroy(image);
    vplScene_Destroy(scene);
    return result;
}

// Three frames with one history. Variants: large enough for blocks that stay with the context, and small.
static vplResult renderFrames(vplContext* context, const char* path, int variant)
{
    (void)path;
    vplScene* scene = NULL;
    vplHistory* history = NULL;
    vplRenderOptions options = smallOptions(VPL_ACCUMULATE_DEFERRED);
    if (variant) {
        options.output.width = 480; // 1.4 MB of picture
        options.output.height = 260;
    }
    options.lights.shadows = VPL_LIGHT_SHADOWS_RAY;
    options.particles.count = 1;
    vplResult result = vplScene_Load(context, "examples/scenes/room-path.json", &scene);
    if (result == VPL_SUCCESS) {
        result = vplHistory_Create(context, &history);
    }
    options.sequence.history = history;
    for (int frame = 0; frame < 3 && result == VPL_SUCCESS; frame++) {
        vplImage* image = NULL;
        options.sequence.frame = 10 * frame;
        result = vplRender(scene, &options, &image, NULL);
        vplImage_Destroy(image);
    }
    vplHistory_Destroy(history);
    vplScene_Destroy(scene);
    return result;
}

// Variants: all pairs, adaptive, links; two frames, in the second of which the light has moved.
static vplResult renderRadiosity(vplContext* context, const char* path, int variant)
{
    (void)path;
    vplScene* scene = NULL;
    vplHistory* history = NULL;
    vplRenderOptions options = smallOptions(VPL_ACCUMULATE_DEFERRED);
    options.method = VPL_METHOD_RADIOSITY;
    options.radiosity.patches = 40;
    options.radiosity.placement = variant == 1 ? VPL_PATCHES_ADAPTIVE : VPL_PATCHES_UNIFORM;
    options.radiosity.hierarchy = variant == 2 ? VPL_HIERARCHY_ON : VPL_HIERARCHY_AUTO;
    vplResult result = vplScene_Load(context, "tests/data/corner-path.json", &scene);
    if (result == VPL_SUCCESS) {
        result = vplHistory_Create(context, &history);
    }
    options.sequence.history = history;
    for (int frame = 0; frame < 2 && result == VPL_SUCCESS; frame++) {
        vplImage* image = NULL;
        options.sequence.frame = 10 * frame;
        result = vplRender(scene, &options, &image, NULL);
        vplImage_Destroy(image);
    }
    vplHistory_Destroy(history);
    vplScene_Destroy(scene);
    return result;
}

static vplResult bakeRoom(vplContext* context, const char* path, int variant)
{
    vplScene* scene = NULL;
    vplRenderOptions options = vplDefaultRenderOptions();
    options.radiosity.patches = 40;
    options.radiosity.solver = variant ? VPL_SOLVER_SHOOTING : VPL_SOLVER_JACOBI;
    vplResult result = vplScene_Load(context, "tests/data/corner-path.json", &scene);
    if (result == VPL_SUCCESS) {
        result = vplBake(scene, &options, 0, path, NULL);
    }
    vplScene_Destroy(scene);
    return result;
}

TEST_ALONE(EveryFailedAllocationOfRadiosityIsReported)
{
    for (int variant = 0; variant < 3; variant++) {
        failEveryAllocation(renderRadiosity, "png", variant, true);
    }
    failEveryAllocation(bakeRoom, "ply", 0, true);
    failEveryAllocation(bakeRoom, "ply", 1, true);
}

// While blocks are kept one failure is none: they are given back, and the block is asked for again.
TEST_ALONE(EveryFailedAllocationOfFramesIsReported)
{
    failEveryAllocation(renderFrames, "png", 0, false);
    failEveryAllocation(renderFrames, "png", 0, true);
    failEveryAllocation(renderFrames, "png", 1, true);
}

static vplResult findClusters(vplContext* context, const char* path, int variant)
{
    (void)path;
    vplVirtualLight lights[20] = {{.weight = 1}};
    for (int i = 0; i < 20; i++) {
        lights[i].position.x = (float)(i * i);
    }
    const vplLightSet set = {.lights = lights, .lightCount = 20, .particleCount = 20, .context = context};
    vplClusterDef def = vplDefaultClusterDef();
    def.count = variant ? 30 : 4;
    vplLightClusters *clusters = NULL, *next = NULL;
    vplResult result = vplFindClusters(&set, &def, &clusters);
    if (result == VPL_SUCCESS) {
        def.last = clusters;
        result = vplFindClusters(&set, &def, &next);
    }
    vplLightClusters_Destroy(next);
    vplLightClusters_Destroy(clusters);
    return result;
}

TEST_ALONE(EveryFailedAllocationOfClustersIsReported)
{
    for (int variant = 0; variant < 2; variant++) {
        failEveryAllocation(findClusters, "png", variant, false);
        failEveryAllocation(findClusters, "png", variant, true);
    }
}

// Patches, finer ones, and their sides. Variants: by the lamp alone, and by an eye.
static vplResult findSides(vplContext* context, const char* path, int variant)
{
    (void)path;
    vplScene* scene = NULL;
    vplGeometry* geometry = NULL;
    vplPatches *patches = NULL, *finer = NULL;
    vplPatchSides* sides = NULL;
    vplPatchDef def = vplDefaultPatchDef();
    vplPatchSidesDef sidesDef = vplDefaultPatchSidesDef();
    const vplVec3 eye = {0, 0, 0};
    float priorities[200];
    for (int i = 0; i < 200; i++) {
        priorities[i] = 1;
    }
    def.count = 50;
    sidesDef.eyes = &eye;
    sidesDef.eyeCount = variant;
    vplResult result = vplScene_Load(context, "examples/scenes/room-area.json", &scene);
    if (result == VPL_SUCCESS) {
        result = vplGeometry_Create(scene, &geometry);
    }
    if (result == VPL_SUCCESS) {
        result = vplPatches_Create(geometry, &def, &patches);
    }
    if (result == VPL_SUCCESS) {
        assert_true(patches->patchCount <= 200);
        result = vplPatches_Refine(patches, priorities, 70, &finer);
    }
    if (result == VPL_SUCCESS) {
        result = vplPatchSides_Create(finer, &sidesDef, &sides);
    }
    vplPatchSides_Destroy(sides);
    vplPatches_Destroy(finer);
    vplPatches_Destroy(patches);
    vplGeometry_Destroy(geometry);
    vplScene_Destroy(scene);
    return result;
}

TEST_ALONE(EveryFailedAllocationOfPatchesIsReported)
{
    for (int variant = 0; variant < 2; variant++) {
        failEveryAllocation(findSides, "png", variant, false);
        failEveryAllocation(findSides, "png", variant, true);
    }
}

TEST_ALONE(EveryFailedAllocationOfLightcutsIsReported)
{
    for (int variant = 0; variant < 2; variant++) {
        failEveryAllocation(renderCuts, "png", variant, false);
        failEveryAllocation(renderCuts, "png", variant, true);
    }
}

// Interleaved lights of eight clusters. Variants: before neighbours share, after that.
static vplResult findFactors(vplContext* context, const char* path, int variant)
{
    (void)path;
    vplVec3 corners[36];
    boxCorners(1, 1, 1, corners);
    SidesFixture sides;
    if (!makeSides(context, corners, 12, 0, 1, &sides)) {
        return VPL_OUT_OF_MEMORY;
    }
    vplFormFactorDef def = vplDefaultFormFactorDef();
    def.samples = variant ? 20 : 4;
    vplFormFactors* factors = NULL;
    const vplResult result = vplFormFactors_Create(&sides.sides, &def, &factors);
    vplFormFactors_Destroy(factors);
    freeSides(&sides);
    return result;
}

TEST_ALONE(EveryFailedAllocationOfFormFactorsIsReported)
{
    for (int variant = 0; variant < 2; variant++) {
        failEveryAllocation(findFactors, "png", variant, false);
        failEveryAllocation(findFactors, "png", variant, true);
    }
}

static vplResult shadeClusters(vplContext* context, const char* path, int variant)
{
    (void)path;
    enum { LIGHTS = 16, CLUSTERS = 8 };
    static const float texels[2 * (4 + 2) * (4 + 2)];
    vplShadeLight lights[LIGHTS];
    int clusters[LIGHTS];
    vplParaboloidMap maps[CLUSTERS];
    for (int i = 0; i < LIGHTS; i++) {
        lights[i] = (vplShadeLight){.py = 2, .pz = (float)i, .ny = -1, .r = 1, .g = 1, .b = 1};
        clusters[i] = i / 2;
        maps[i / 2] = (vplParaboloidMap){.position = {0, 2, 0},
                                         .right = {1, 0, 0},
                                         .up = {0, 0, -1},
                                         .forward = {0, 1, 0},
                                         .size = 4,
                                         .hemispheres = 2,
                                         .texels = texels,
                                         .context = context};
    }
    const vplShadeDef def = {.lighting = VPL_LIGHTING_PHYSICAL,
                             .accumulation = VPL_ACCUMULATE_INTERLEAVED,
                             .output = variant ? VPL_OUTPUT_DENOISED : VPL_OUTPUT_GATHER,
                             .interleave = 2,
                             .minDistance = 0.1f,
                             .lights = lights,
                             .lightCount = LIGHTS,
                             .lightClusters = clusters,
                             .clusterShadows = maps,
                             .clusterCount = CLUSTERS};
    vplScene* scene = NULL;
    vplGeometry* geometry = NULL;
    vplImage* image = NULL;
    vplResult result = vplScene_Load(context, "tests/data/room.json", &scene);
    if (result == VPL_SUCCESS) {
        result = vplGeometry_Create(scene, &geometry);
    }
    if (result == VPL_SUCCESS) {
        result = vplImage_Create(context, 8, 6, &image);
    }
    if (result == VPL_SUCCESS) {
        const vplView view = vplView_Create(vplScene_GetCamera(scene, 0), 8, 6);
        result = vplShadeView(geometry, &view, &def, NULL, NULL, image, NULL);
    }
    vplImage_Destroy(image);
    vplGeometry_Destroy(geometry);
    vplScene_Destroy(scene);
    return result;
}

TEST_ALONE(EveryFailedAllocationOfLightsInClustersIsReported)
{
    for (int variant = 0; variant < 2; variant++) {
        failEveryAllocation(shadeClusters, "png", variant, false);
        failEveryAllocation(shadeClusters, "png", variant, true);
    }
}

TEST_ALONE(EveryFailedAllocationOfMeshesLampsAndLightShadowsIsReported)
{
    for (int variant = 0; variant < 3; variant++) {
        failEveryAllocation(renderBall, "png", variant, false);
    }
}

// Variants: placements. The view's is called by itself: with few candidates and few points.
static vplResult placeLights(vplContext* context, const char* path, int variant)
{
    (void)path;
    vplScene* scene = NULL;
    vplGeometry* geometry = NULL;
    vplLightSet* set = NULL;
    vplRenderOptions options = smallOptions(VPL_ACCUMULATE_DEFERRED);
    vplParticleDef particles = vplDefaultParticleDef();
    vplPlacementDef def = vplDefaultPlacementDef();
    options.particles.placement = VPL_PLACEMENT_RSM;
    options.shadow.rsmSize = 4;
    def.oversampling = 2;
    def.pointCount = 1;
    vplResult result = vplScene_Load(context, "tests/data/room.json", &scene);
    if (result == VPL_SUCCESS && variant == VPL_PLACEMENT_RSM) {
        result = vplMakeLights(scene, &options, &set);
    } else if (result == VPL_SUCCESS) {
        result = vplGeometry_Create(scene, &geometry);
        if (result == VPL_SUCCESS) {
            result = vplPlaceLights(geometry, vplScene_GetEmitter(scene, 0), 1, &particles, &def, &set);
        }
    }
    vplLightSet_Destroy(set);
    vplGeometry_Destroy(geometry);
    vplScene_Destroy(scene);
    return result;
}

TEST_ALONE(EveryFailedAllocationOfAPlacementIsReported)
{
    for (int variant = VPL_PLACEMENT_RSM; variant <= VPL_PLACEMENT_VIEW; variant++) {
        failEveryAllocation(placeLights, "png", variant, false);
        failEveryAllocation(placeLights, "png", variant, true);
    }
}

// Variants: types of emitters. The map, its lights and its picture.
static vplResult sampleReflectiveMap(vplContext* context, const char* path, int variant)
{
    (void)path;
    vplScene* scene = NULL;
    vplGeometry* geometry = NULL;
    vplReflectiveMap* map = NULL;
    vplLightSet* set = NULL;
    vplImage* image = NULL;
    vplReflectiveMapDef def = vplDefaultReflectiveMapDef();
    vplRsmSampleDef sampling = vplDefaultRsmSampleDef();
    def.size = 3;
    def.emitter.type = (vplEmitterType)variant;
    vplResult result = vplScene_Load(context, "tests/data/room.json", &scene);
    if (result == VPL_SUCCESS) {
        result = vplGeometry_Create(scene, &geometry);
    }
    if (result == VPL_SUCCESS) {
        result = vplReflectiveMap_Create(geometry, &def, NULL, NULL, &map);
    }
    if (result == VPL_SUCCESS) {
        result = vplSampleReflectiveMaps(geometry, (const vplReflectiveMap* const*)&map, 1, &sampling, &set);
    }
    if (result == VPL_SUCCESS) {
        result = vplShowReflectiveMap(map, geometry, &image);
    }
    vplImage_Destroy(image);
    vplLightSet_Destroy(set);
    vplReflectiveMap_Destroy(map);
    vplGeometry_Destroy(geometry);
    vplScene_Destroy(scene);
    return result;
}

TEST_ALONE(EveryFailedAllocationOfAReflectiveMapIsReported)
{
    for (int variant = VPL_EMITTER_POINT; variant <= VPL_EMITTER_DIRECTIONAL; variant++) {
        failEveryAllocation(sampleReflectiveMap, "png", variant, false);
        failEveryAllocation(sampleReflectiveMap, "png", variant, true);
    }
}

// Only the geometry of a mesh, and its tree.
static vplResult freezeBall(vplContext* context, const char* path, int variant)
{
    (void)path;
    (void)variant;
    vplScene* scene = NULL;
    vplGeometry* geometry = NULL;
    Shape ball = icosphere(2);
    vplResult result = vplScene_Create(context, &scene);
    if (result == VPL_SUCCESS) {
        result = addBall(scene, &ball);
    }
    if (result == VPL_SUCCESS) {
        result = vplGeometry_Create(scene, &geometry);
    }
    if (result == VPL_SUCCESS) {
        result = vplGeometry_PrepareRays(geometry);
    }
    vplGeometry_Destroy(geometry);
    vplScene_Destroy(scene);
    freeShape(&ball);
    return result;
}

// Variants: without and with triangles, and then lights of the second bounce.
static vplResult drawParaboloids(vplContext* context, const char* path, int variant)
{
    (void)path;
    vplScene* scene = NULL;
    vplGeometry* geometry = NULL;
    vplParaboloidMaps* maps = NULL;
    vplLightSet* set = NULL;
    const vplParaboloidPlace place = {{0, 1, 0}, {0, 1, 0}, 2, false};
    const vplLightCluster cluster = {{0, 1, 0}, {0, 1, 0}, {1, 1, 1}, 1, 0, true};
    const vplLightClusters clusters = {.clusters = &cluster, .count = 1};
    vplSecondBounceDef def = vplDefaultSecondBounceDef();
    def.count = 4;
    vplResult result = vplScene_Load(context, "tests/data/room.json", &scene);
    result = result == VPL_SUCCESS ? vplGeometry_Create(scene, &geometry) : result;
    result = result == VPL_SUCCESS ? vplParaboloidMaps_Create(context, 4, 1, variant > 0, &maps) : result;
    result = result == VPL_SUCCESS ? vplParaboloidMaps_Draw(maps, geometry, &place, 1, NULL, NULL) : result;
    if (result == VPL_SUCCESS && variant > 0) {
        result = vplSampleParaboloidMaps(geometry, &clusters, maps, &def, &set);
    }
    vplLightSet_Destroy(set);
    vplParaboloidMaps_Destroy(maps);
    vplGeometry_Destroy(geometry);
    vplScene_Destroy(scene);
    return result;
}

TEST_ALONE(EveryFailedAllocationOfParaboloidMapsIsReported)
{
    for (int variant = 0; variant < 2; variant++) {
        failEveryAllocation(drawParaboloids, "png", variant, false);
    }
}

TEST_ALONE(EveryFailedAllocationOfAGeometryIsReported)
{
    failEveryAllocation(freezeBall, "png", 0, false);
    failEveryAllocation(freezeBall, "png", 0, true);
}

// Everything that `show` can ask for.
static vplResult showAndWrite(vplContext* context, const char* path, int show)
{
    vplRenderOptions options = smallOptions(VPL_ACCUMULATE_DEFERRED);
    options.output.show = (vplShow)show;
    options.lighting = VPL_LIGHTING_DOCUMENTED;
    return renderFile(context, "tests/data/room-closed.json", &options, NULL, path);
}

TEST_ALONE(EveryFailedAllocationOfAShownStageIsReported)
{
    for (int show = VPL_SHOW_DEPTH; show <= VPL_SHOW_OVERLAY; show++) {
        failEveryAllocation(showAndWrite, "pfm", show, false);
    }
}

static vplResult readCompareAndMap(vplContext* context, const char* path, int format)
{
    static const char* const pictures[] = {"small.pfm", "small.png", "small.hdr"};
    char source[128];
    snprintf(source, sizeof source, "tests/fuzz/corpus/image/%s", pictures[format]);
    vplImage *a = NULL, *b = NULL, *map = NULL;
    vplComparison comparison;
    vplResult result = vplImage_Read(context, source, &a);
    if (result == VPL_SUCCESS) {
        result = vplImage_Read(context, source, &b);
    }
    if (result == VPL_SUCCESS) {
        result = vplImage_Compare(a, b, &comparison);
    }
    vplHeatmapDef def = vplDefaultHeatmapDef();
    def.of = format == 0 ? VPL_HEAT_FLIP : format == 1 ? VPL_HEAT_SSIM : VPL_HEAT_RELATIVE;
    if (result == VPL_SUCCESS) {
        result = vplImage_HeatmapOf(a, b, &def, &map);
    }
    if (result == VPL_SUCCESS) {
        result = vplImage_Write(map, path, NULL);
    }
    vplImage_Destroy(a);
    vplImage_Destroy(b);
    vplImage_Destroy(map);
    return result;
}

TEST_ALONE(EveryFailedAllocationOfAComparisonIsReported)
{
    for (int format = 0; format < 3; format++) {
        failEveryAllocation(readCompareAndMap, "png", format, false);
        failEveryAllocation(readCompareAndMap, "png", format, true);
    }
}

static vplResult readMeshes(vplContext* context, const char* path, int variant)
{
    static const char* const scenes[] = {"tests/data/obj/meshes.json", "tests/data/obj/everything.obj",
                                         "tests/data/obj/square.obj"};
    (void)path;
    vplScene* scene = NULL;
    vplResult result = vplScene_Load(context, scenes[variant], &scene);
    if (result == VPL_SUCCESS) { // once more into a scene that has the names already
        result = vplScene_LoadObj(scene, scenes[variant ? variant : 1], NULL);
    }
    vplScene_Destroy(scene);
    return result;
}

TEST_ALONE(EveryFailedAllocationOfTheObjReaderIsReported)
{
    for (int variant = 0; variant < 3; variant++) {
        failEveryAllocation(readMeshes, "png", variant, false);
        failEveryAllocation(readMeshes, "png", variant, true);
    }
}

// ---- jansson allocates by itself

static long jsonAllocations, jsonFailAt;

static void* failingJsonAlloc(size_t size)
{
    return jsonAllocations++ == jsonFailAt ? NULL : malloc(size);
}

// When it has no memory for a key, jansson itself believes that there is none, and calls it a syntax error.
TEST_ALONE(EveryFailedAllocationOfTheJsonReaderIsReported)
{
    vplResult result = VPL_OUT_OF_MEMORY;
    json_set_alloc_funcs(failingJsonAlloc, free);
    for (jsonFailAt = 0; result != VPL_SUCCESS; jsonFailAt++) {
        Failing failing = {.failAt = -1};
        vplContext* context = openFailing(&failing);
        vplScene* scene = NULL;
        jsonAllocations = 0;
        result = vplScene_Load(context, "tests/data/room.json", &scene);
        vplScene_Destroy(scene);
        vplContext_Destroy(context);
        bool told = (result == VPL_OUT_OF_MEMORY || result == VPL_PARSE_ERROR) && failing.errors == 1;
        if (failing.held != 0 || (result != VPL_SUCCESS && !told)) {
            json_set_alloc_funcs(malloc, free);
            fail_msg("allocation %ld of jansson: %s, %d sentences, %ld blocks leaked", jsonFailAt,
                     vplResult_GetName(result), failing.errors, failing.held);
        }
    }
    json_set_alloc_funcs(malloc, free);
    assert_true(jsonFailAt > 100);
}

static vplResult encodePng(vplContext* context, const char* path, int variant)
{
    (void)path;
    (void)variant;
    vplImage* image = NULL;
    uint8_t* bytes = NULL;
    size_t size;
    vplWriteOptions write = vplDefaultWriteOptions();
    write.tonemap = VPL_TONEMAP_REINHARD;
    vplResult result = vplImage_Create(context, 60, 40, &image);
    if (result == VPL_SUCCESS) {
        result = vplImage_EncodePng(image, &write, &bytes, &size);
    }
    vplPng_Free(context, bytes);
    vplImage_Destroy(image);
    return result;
}

TEST_ALONE(EveryFailedAllocationOfAnEncodedPngIsReported)
{
    failEveryAllocation(encodePng, "png", 0, false);
    failEveryAllocation(encodePng, "png", 0, true);
}
