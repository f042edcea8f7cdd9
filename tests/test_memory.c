// SPDX-License-Identifier: MIT
// Runs every scenario of the table below with each allocation failing in turn (tests/failing.h).
#include "failing.h"
#include "patch_support.h"

#include "render/stages/show.h"

#include <errno.h>
#include <jansson.h>
#include <stdlib.h>

// ---- scene files

static vplResult readJson(Attempt* a)
{
    return vplScene_Load(a->context, "tests/data/room.json", &a->scene);
}

// The second file is read into a scene that has the same names already.
static vplResult readMeshes(Attempt* a)
{
    static const char* const scenes[] = {"tests/data/obj/meshes.json", "tests/data/obj/everything.obj",
                                         "tests/data/obj/square.obj"};
    TRY(vplScene_Load(a->context, scenes[a->variant], &a->scene));
    return vplScene_LoadObj(a->scene, scenes[a->variant ? a->variant : 1], NULL);
}

static vplResult readModels(Attempt* a)
{
    static const char* const scenes[] = {"tests/data/gltf/everything.glb", "tests/data/gltf/everything.gltf",
                                         "tests/data/ply/odd/more-elements.ply",
                                         "tests/data/ply/odd/normals-nan.ply",
                                         "tests/data/stl/odd/upper-case-name.STL"};
    return vplScene_Load(a->context, scenes[a->variant], &a->scene);
}

static vplResult openRoom(Attempt* a, const char* path)
{
    TRY(vplScene_Load(a->context, path, &a->scene));
    return vplGeometry_Create(a->scene, &a->geometry);
}

// Adds a sphere of 320 triangles that emits light.
static vplResult addBall(Attempt* a)
{
    vplMaterialDef material = vplDefaultMaterialDef();
    vplObjectDef object = vplDefaultObjectDef();
    a->shape = icosphere(2);
    material.emission = (vplRgb){1, 2, 3};
    object.transform.m[13] = 3;
    TRY(vplScene_AddMaterial(a->scene, &material, &object.material));
    return tryAddShape(a->scene, &a->shape, true, &object);
}

static vplResult buildBall(Attempt* a)
{
    TRY(vplScene_Create(a->context, &a->scene));
    TRY(addBall(a));
    return vplGeometry_Create(a->scene, &a->geometry);
}

// ---- pictures

static vplRenderOptions optionsOf(vplMethod method, int size, int particles)
{
    vplRenderOptions options = plainOptions();
    options.method = method;
    options.output.width = options.output.height = size;
    options.particles.count = particles;
    options.shadow.mapSize = size / 2;
    options.lights.mapSize = 2;
    options.pipeline.batch = 4;
    return options;
}

static vplResult render(Attempt* a, const vplRenderOptions* options)
{
    return vplRender(a->scene, options, &a->image, NULL);
}

static vplResult loadAndRender(Attempt* a, const char* from, const vplRenderOptions* options)
{
    TRY(vplScene_Load(a->context, from, &a->scene));
    return render(a, options);
}

// Runs the whole program, from scene file to picture file. Variants: pipelines.
static vplResult renderAndWrite(Attempt* a)
{
    vplRenderOptions options = optionsOf(VPL_METHOD_INSTANT_RADIOSITY, 32, 6);
    vplWriteOptions write = vplDefaultWriteOptions();
    write.tonemap = VPL_TONEMAP_REINHARD;
    options.pipeline.kind = (vplAccumulation)a->variant;
    TRY(loadAndRender(a, "tests/data/room.json", &options));
    return vplImage_Write(a->image, a->path, &write);
}

// Variants: without and with an area light.
static vplResult tracePaths(Attempt* a)
{
    vplRenderOptions options = optionsOf(VPL_METHOD_PATH, 16, 0);
    options.path.samples = 2;
    TRY(loadAndRender(a, a->variant ? "examples/scenes/room-area.json" : "tests/data/room.json", &options));
    return vplImage_Write(a->image, a->path, NULL);
}

// Variants: an area light in one pass and in two, and the path tracer.
static vplResult renderLayers(Attempt* a)
{
    vplRenderOptions options = optionsOf(a->variant == 2 ? VPL_METHOD_PATH : VPL_METHOD_KELLER, 6, 2);
    options.output.aovs = VPL_AOV_ALL;
    options.output.antialias = options.path.samples = 2;
    options.stop.passes = a->variant == 1 ? 2 : 0;
    options.pipeline.kind = VPL_ACCUMULATE_DEFERRED;
    TRY(vplScene_Load(a->context, "examples/scenes/room-area.json", &a->scene));
    TRY(vplRenderLayers(a->scene, &options, &a->layers, NULL));
    return strstr(a->path, ".exr") != NULL
               ? vplImage_WriteLayers(a->layers->layers, a->layers->count, a->path)
               : VPL_SUCCESS;
}

// Variants: deferred and interleaved.
static vplResult compensate(Attempt* a)
{
    vplRenderOptions options = optionsOf(VPL_METHOD_KELLER, 12, 5);
    options.pipeline.kind = a->variant ? VPL_ACCUMULATE_INTERLEAVED : VPL_ACCUMULATE_DEFERRED;
    return loadAndRender(a, "examples/scenes/room-area.json", &options);
}

// Variants: the document's pipeline with shadow maps, and interleaved; particles stop at bounding boxes.
static vplResult renderDocumented(Attempt* a)
{
    vplRenderOptions options = optionsOf(VPL_METHOD_KELLER, 8, 5);
    options.lighting = VPL_LIGHTING_DOCUMENTED;
    options.particles.geometry = VPL_PARTICLE_GEOMETRY_OBB;
    options.pipeline.kind = a->variant ? VPL_ACCUMULATE_INTERLEAVED : VPL_ACCUMULATE_MULTIPASS;
    return loadAndRender(a, a->variant ? "tests/data/room.json" : "tests/data/room-closed.json", &options);
}

// Variants: virtual lights without shadows, with maps and with rays, each with a different pipeline.
static vplResult renderBall(Attempt* a)
{
    vplRenderOptions options = optionsOf(VPL_METHOD_INSTANT_RADIOSITY, 8, 2);
    options.pipeline.kind = (vplAccumulation)a->variant;
    options.lights.shadows = (vplLightShadows)(VPL_LIGHT_SHADOWS_NONE + a->variant);
    options.lights.areaLightSamples = 3;
    TRY(vplScene_Load(a->context, "tests/data/room.json", &a->scene));
    TRY(addBall(a));
    return render(a, &options);
}

// Variants: two lights, and so many that the top of the light tree is built before its subtrees.
static vplResult renderCuts(Attempt* a)
{
    vplRenderOptions options = optionsOf(VPL_METHOD_INSTANT_RADIOSITY, 4, a->variant ? 2000 : 1);
    options.pipeline.kind = VPL_ACCUMULATE_LIGHTCUTS;
    options.lights.shadows = VPL_LIGHT_SHADOWS_RAY;
    return loadAndRender(a, "tests/data/room.json", &options);
}

static vplResult showStage(Attempt* a)
{
    vplRenderOptions options = optionsOf(VPL_METHOD_INSTANT_RADIOSITY, 16, 2);
    options.output.show = (vplShow)(VPL_SHOW_DEPTH + a->variant);
    options.lighting = VPL_LIGHTING_DOCUMENTED;
    TRY(loadAndRender(a, "tests/data/room-closed.json", &options));
    return vplImage_Write(a->image, a->path, NULL);
}

static vplResult renderSsvp(Attempt* a)
{
    vplRenderOptions options = optionsOf(VPL_METHOD_SSVP, 8, 0);
    options.shadow.rsmSize = 8;
    options.ssvp.clusters = 2;
    options.ssvp.firstBounce = options.ssvp.secondBounce = 6;
    options.ssvp.paraboloidSize = 4;
    options.ssvp.nextBounce = a->variant ? VPL_NEXT_BOUNCE_MAPS : VPL_NEXT_BOUNCE_RAYS;
    options.maxBounces = 4;
    return loadAndRender(a, "tests/data/room.json", &options);
}

// ---- frames of a sequence with a moving emitter

static vplResult renderFrames(Attempt* a, vplRenderOptions options, int frames)
{
    TRY(vplHistory_Create(a->context, &a->history));
    options.sequence.history = a->history;
    for (int frame = 0; frame < frames; frame++) {
        options.sequence.frame = 10 * frame;
        vplImage_Destroy(a->image);
        a->image = NULL;
        TRY(render(a, &options));
    }
    return VPL_SUCCESS;
}

static vplResult renderSequence(Attempt* a)
{
    vplRenderOptions options = optionsOf(VPL_METHOD_INSTANT_RADIOSITY, 16, 1);
    options.lights.shadows = VPL_LIGHT_SHADOWS_RAY;
    TRY(vplScene_Load(a->context, "examples/scenes/room-path.json", &a->scene));
    return renderFrames(a, options, 3);
}

static vplRenderOptions radiosityOptions(void)
{
    vplRenderOptions options = optionsOf(VPL_METHOD_RADIOSITY, 8, 0);
    options.radiosity.patches = 16;
    options.radiosity.cuts = VPL_PATCH_CUTS_OFF;
    options.radiosity.iterations = 2;
    options.radiosity.lightSamples = options.radiosity.formSamples = 1;
    return options;
}

// Variants: all pairs, links, adaptive patches, and cuts, which look for pieces in the dark.
static vplResult renderRadiosity(Attempt* a)
{
    vplRenderOptions options = radiosityOptions();
    options.radiosity.hierarchy = a->variant == 1 ? VPL_HIERARCHY_ON : VPL_HIERARCHY_AUTO;
    options.radiosity.placement = a->variant == 2 ? VPL_PATCHES_ADAPTIVE : VPL_PATCHES_UNIFORM;
    options.radiosity.patches = a->variant == 2 ? 20 : 16; // fewer patches are not refined
    options.radiosity.cuts = a->variant == 3 ? VPL_PATCH_CUTS_ON : VPL_PATCH_CUTS_OFF;
    options.radiosity.groups = a->variant == 3 ? VPL_PATCH_GROUPS_OFF : VPL_PATCH_GROUPS_AUTO;
    vplPlan* plan;
    TRY(vplScene_Load(a->context, "tests/data/corner-path.json", &a->scene));
    TRY(vplPlan_Create(a->scene, &options, NULL, &plan)); // finds a sample of links
    vplPlan_Destroy(plan);
    return renderFrames(a, options, a->variant == 3 ? 1 : 2);
}

// More triangles than patches, so that they are in groups. Variants: all pairs and light gathered at vertices, links and a
// final gather, adaptive patches.
static vplResult renderGroups(Attempt* a)
{
    vplRenderOptions options = radiosityOptions();
    options.radiosity.hierarchy = a->variant == 1 ? VPL_HIERARCHY_ON : VPL_HIERARCHY_AUTO;
    options.radiosity.placement = a->variant == 2 ? VPL_PATCHES_ADAPTIVE : VPL_PATCHES_UNIFORM;
    options.radiosity.gather = a->variant == 1 ? 2 : 0;
    options.radiosity.cuts = VPL_PATCH_CUTS_ON;
    options.radiosity.patches = 30;
    TRY(vplScene_Load(a->context, "tests/data/room.json", &a->scene));
    return renderFrames(a, options, 1);
}

// Variants: solvers.
static vplResult bake(Attempt* a)
{
    vplRenderOptions options = radiosityOptions();
    options.radiosity.solver = a->variant ? VPL_SOLVER_SHOOTING : VPL_SOLVER_JACOBI;
    TRY(vplScene_Load(a->context, "tests/data/corner-path.json", &a->scene));
    return vplBake(a->scene, &options, 0, a->path, NULL);
}

// ---- stages of virtual lights

// Variants: placements. The placement for the view is called directly, with few candidates and few points.
static vplResult placeLights(Attempt* a)
{
    vplRenderOptions options = optionsOf(VPL_METHOD_INSTANT_RADIOSITY, 32, 6);
    vplParticleDef particles = vplDefaultParticleDef();
    vplPlacementDef def = vplDefaultPlacementDef();
    options.particles.placement = VPL_PLACEMENT_RSM;
    options.shadow.rsmSize = 4;
    def.oversampling = 2;
    def.pointCount = 1;
    TRY(openRoom(a, "tests/data/room.json"));
    return a->variant == 0 ? vplMakeLights(a->scene, &options, &a->lights)
                           : vplPlaceLights(a->geometry, vplScene_GetEmitter(a->scene, 0), 1, &particles,
                                            &def, &a->lights);
}

// Variants: fewer clusters than lights, and more. The second clustering starts from the first.
static vplResult findClusters(Attempt* a)
{
    vplVirtualLight lights[20] = {{.weight = 1}};
    for (int i = 0; i < 20; i++) {
        lights[i].position.x = (float)(i * i);
    }
    const vplLightSet set = {.lights = lights, .lightCount = 20, .particleCount = 20, .context = a->context};
    vplClusterDef def = vplDefaultClusterDef();
    def.count = a->variant ? 30 : 4;
    TRY(vplFindClusters(&set, &def, &a->clusters));
    def.last = a->clusters;
    return vplFindClusters(&set, &def, &a->nextClusters);
}

// Shades interleaved lights of eight clusters. Variants: output before and after neighbours share irradiance.
static vplResult shadeClusters(Attempt* a)
{
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
                                         .context = a->context};
    }
    vplShadeDef def = vplDefaultShadeDef();
    def.accumulation = VPL_ACCUMULATE_INTERLEAVED;
    def.output = a->variant ? VPL_OUTPUT_DENOISED : VPL_OUTPUT_GATHER;
    def.interleave = 2;
    def.minDistance = 0.1f;
    def.lights = lights;
    def.lightCount = LIGHTS;
    def.lightClusters = clusters;
    def.clusterShadows = maps;
    def.clusterCount = CLUSTERS;
    TRY(openRoom(a, "tests/data/room.json"));
    TRY(vplImage_Create(a->context, 8, 6, &a->image));
    const vplView view = vplView_Create(vplScene_GetCamera(a->scene, 0), 8, 6);
    return vplShadeView(a->geometry, &view, &def, a->image, NULL);
}

// ---- uses of shadow maps (tests/test_shadow_maps.c tests the maps of all kinds)

static vplResult boundCube(Attempt* a)
{
    vplCubeMapDef def = vplDefaultCubeMapDef();
    def.size = 16;
    TRY(openRoom(a, "tests/data/room.json"));
    TRY(vplCubeMap_Create(a->geometry, &def, NULL, NULL, &a->cube));
    return vplCubeMap_FindBounds(a->cube);
}

// Variants: without triangles, and with triangles and lights of the second bounce.
static vplResult drawParaboloids(Attempt* a)
{
    const vplParaboloidPlace place = {{0, 1, 0}, {0, 1, 0}, 2, false};
    const vplLightCluster cluster = {{0, 1, 0}, {0, 1, 0}, {1, 1, 1}, 1, 0, true};
    const vplLightClusters clusters = {.clusters = &cluster, .count = 1};
    vplSecondBounceDef def = vplDefaultSecondBounceDef();
    def.count = 4;
    TRY(openRoom(a, "tests/data/room.json"));
    TRY(vplParaboloidMaps_Create(a->context, 4, 1, a->variant > 0, &a->paraboloids));
    TRY(vplParaboloidMaps_Draw(a->paraboloids, a->geometry, &place, 1, NULL, NULL));
    return a->variant == 0
               ? VPL_SUCCESS
               : vplSampleParaboloidMaps(a->geometry, &clusters, a->paraboloids, &def, &a->lights);
}

// Draws a map, samples its lights and shows it as a picture. Variants: emitter types.
static vplResult sampleReflectiveMap(Attempt* a)
{
    vplReflectiveMapDef def = vplDefaultReflectiveMapDef();
    const vplRsmSampleDef sampling = vplDefaultRsmSampleDef();
    def.size = 3;
    def.emitter.type = (vplEmitterType)a->variant;
    TRY(openRoom(a, "tests/data/room.json"));
    TRY(vplReflectiveMap_Create(a->geometry, &def, NULL, NULL, &a->reflective));
    const vplReflectiveMap* const maps[] = {a->reflective};
    TRY(vplSampleReflectiveMaps(a->geometry, maps, 1, &sampling, &a->lights));
    return vplShowReflectiveMap(a->reflective, a->geometry, &a->image);
}

// ---- stages of radiosity

static vplResult openPatchesOf(Attempt* a, const char* path, int count)
{
    vplPatchDef def = vplDefaultPatchDef();
    def.count = count;
    TRY(openRoom(a, path));
    return vplPatches_Create(a->geometry, &def, &a->patches);
}

// Bisects every `step`-th patch, so that neighbours get hanging vertices on their edges.
static vplResult refine(Attempt* a, int step, int most)
{
    float* priorities = a->blocks[0] = calloc((size_t)a->patches->patchCount, sizeof *priorities);
    for (int i = 0; i < a->patches->patchCount; i += step) {
        priorities[i] = 1;
    }
    return vplPatches_Refine(a->patches, priorities, most, &a->finer);
}

// Variants: sides that an area light reaches, and in addition sides that a viewpoint sees.
static vplResult findSides(Attempt* a)
{
    vplPatchSidesDef def = vplDefaultPatchSidesDef();
    const vplVec3 eye = {0, 0, 0};
    def.viewpoints = &eye;
    def.viewpointCount = a->variant;
    TRY(openPatchesOf(a, "examples/scenes/room-area.json", 50));
    TRY(refine(a, 1, 70));
    return vplPatchSides_Create(a->finer, &def, &a->sides);
}

// Variants: numbers of samples.
static vplResult findFactors(Attempt* a)
{
    vplFormFactorDef def = vplDefaultFormFactorDef();
    def.samples = a->variant ? 20 : 4;
    TRY(openPatchesOf(a, "tests/data/room-closed.json", 40));
    a->handMade = openSides(a->patches, frontsOpen);
    return vplFormFactors_Create(a->handMade, &def, &a->factors);
}

// Divides a room into patches of different sizes, then makes the mesh, pictures without and with vertex
// values, and a file.
static vplResult meshAndWrite(Attempt* a)
{
    TRY(openPatchesOf(a, "tests/data/room.json", 100));
    TRY(refine(a, 3, VPL_MAX_PATCHES));
    a->handMade = openSides(a->finer, allOpen);
    const size_t most = 6 * (size_t)a->finer->patchCount * 8;
    vplRgb* values = a->blocks[1] = calloc(most, sizeof *values);
    vplRgb* corners = a->blocks[2] = calloc(most, sizeof *corners);
    float(*clip)[4] = a->blocks[3] = calloc(most, sizeof *clip);
    TRY(vplPatchMesh_Create(a->handMade, &a->mesh));
    TRY(vplPatchMesh_Interpolate(a->mesh, VPL_VERTEX_WEIGHT_ANGLE, values, corners));
    TRY(vplImage_Create(a->context, 16, 16, &a->image));
    const vplPatchDraw draw = {
        .mesh = a->mesh, .values = values, .vertexValues = a->variant ? corners : NULL};
    TRY(vplDrawPatches(&draw, (const float(*)[4])clip, NULL, NULL, a->image, NULL));
    return vplPatchMesh_WritePly(a->mesh, corners, 1, a->path);
}

// ---- pictures in files

// Variants: formats.
static vplResult compareAndMap(Attempt* a)
{
    static const char* const pictures[] = {"tests/fuzz/corpus/image/small.pfm",
                                           "tests/fuzz/corpus/image/small.png",
                                           "tests/fuzz/corpus/image/small.hdr"};
    static const vplHeat heats[] = {VPL_HEAT_FLIP, VPL_HEAT_SSIM, VPL_HEAT_RELATIVE};
    vplHeatmapDef def = vplDefaultHeatmapDef();
    vplComparison comparison;
    def.of = heats[a->variant];
    TRY(vplImage_Read(a->context, pictures[a->variant], &a->image));
    TRY(vplImage_Read(a->context, pictures[a->variant], &a->other));
    TRY(vplImage_Compare(a->image, a->other, &comparison));
    TRY(vplImage_HeatmapOf(a->image, a->other, &def, &a->heatmap));
    return vplImage_Write(a->heatmap, a->path, NULL);
}

// Variants: Reinhard, and AgX with an automatic exposure.
static vplResult encodePng(Attempt* a)
{
    uint8_t* bytes = NULL;
    size_t size;
    vplWriteOptions write = vplDefaultWriteOptions();
    write.tonemap = a->variant ? VPL_TONEMAP_AGX : VPL_TONEMAP_REINHARD;
    write.exposure = VPL_EXPOSURE_AUTO;
    TRY(vplImage_Create(a->context, 60, 40, &a->image));
    const vplResult result = vplImage_Encode(a->image, ".png", &write, &bytes, &size);
    vplBytes_Free(a->context, bytes);
    return result;
}

// ---- the table: name, scenario, extension of the file, number of variants

#define EVERY_FAILED_ALLOCATION(name, scenario, extension, variants)                                         \
    TEST_ALONE(EveryFailedAllocationOf##name##IsReported)                                                    \
    {                                                                                                        \
        failEveryAllocation(#name, scenario, extension, variants);                                           \
    }

// clang-format off
EVERY_FAILED_ALLOCATION(AJsonScene, readJson, "png", 1)
EVERY_FAILED_ALLOCATION(TheObjReader, readMeshes, "png", 3)
EVERY_FAILED_ALLOCATION(TheReadersOfModels, readModels, "png", 5)
EVERY_FAILED_ALLOCATION(AGeometry, buildBall, "png", 1)
EVERY_FAILED_ALLOCATION(ARenderToPng, renderAndWrite, "png", 4)
EVERY_FAILED_ALLOCATION(ARenderToHdr, renderAndWrite, "hdr", 1)
EVERY_FAILED_ALLOCATION(ARenderToExr, renderAndWrite, vplImage_CanWrite("a.exr") ? "exr" : "pfm", 1)
EVERY_FAILED_ALLOCATION(Layers, renderLayers, vplImage_CanWrite("a.exr") ? "exr" : "pfm", 3)
EVERY_FAILED_ALLOCATION(ThePathTracer, tracePaths, "pfm", 2)
EVERY_FAILED_ALLOCATION(Compensation, compensate, "png", 2)
EVERY_FAILED_ALLOCATION(DocumentedKeller, renderDocumented, "png", 2)
EVERY_FAILED_ALLOCATION(MeshesAreaLightsAndLightShadows, renderBall, "png", 3)
EVERY_FAILED_ALLOCATION(Lightcuts, renderCuts, "png", 2)
EVERY_FAILED_ALLOCATION(AShownStage, showStage, "pfm", VPL_SHOW_OVERLAY - VPL_SHOW_DEPTH + 1)
EVERY_FAILED_ALLOCATION(Ssvp, renderSsvp, "png", 2)
EVERY_FAILED_ALLOCATION(Frames, renderSequence, "png", 1)
EVERY_FAILED_ALLOCATION(Radiosity, renderRadiosity, "png", 4)
EVERY_FAILED_ALLOCATION(GroupsOfTriangles, renderGroups, "png", 3)
EVERY_FAILED_ALLOCATION(ABake, bake, "ply", 2)
EVERY_FAILED_ALLOCATION(APlacement, placeLights, "png", 2)
EVERY_FAILED_ALLOCATION(Clusters, findClusters, "png", 2)
EVERY_FAILED_ALLOCATION(LightsInClusters, shadeClusters, "png", 2)
EVERY_FAILED_ALLOCATION(BoundsOfACubeMap, boundCube, "png", 1)
EVERY_FAILED_ALLOCATION(ParaboloidMaps, drawParaboloids, "png", 2)
EVERY_FAILED_ALLOCATION(AReflectiveMap, sampleReflectiveMap, "png", 3)
EVERY_FAILED_ALLOCATION(PatchSides, findSides, "png", 2)
EVERY_FAILED_ALLOCATION(FormFactors, findFactors, "png", 2)
EVERY_FAILED_ALLOCATION(PatchMeshes, meshAndWrite, "ply", 2)
EVERY_FAILED_ALLOCATION(AComparison, compareAndMap, "png", 3)
EVERY_FAILED_ALLOCATION(AnEncodedPng, encodePng, "png", 2)
// clang-format on

// ---- jansson's own allocations

static long jsonAllocations, jsonFailAt;

static void* failingJsonAlloc(size_t size)
{
    if (jsonAllocations++ == jsonFailAt) {
        errno = ENOMEM; // as malloc sets it
        return NULL;
    }
    return malloc(size);
}

// Variants: a scene, a glTF file with a buffer beside it, a plan.
static vplResult readByJansson(vplContext* context, int variant)
{
    static const char* const scenes[] = {"tests/data/room.json", "tests/data/gltf/apart/triangle.gltf"};
    static const char plan[] = "{\"vpl_plan\": 1, \"scene\": \"0123456789abcdef\", \"options\": {\"method\": "
                               "\"path\", \"spp\": \"7\"}}";
    const vplMemoryFile file = {"plan.json", plan, sizeof plan - 1};
    vplRenderOptions options = vplDefaultRenderOptions();
    vplScene* scene = NULL;
    if (variant == 2) {
        vplContext_SetFiles(context, &file, 1);
        return vplRenderOptions_Load(context, "plan.json", &options, NULL);
    }
    const vplResult result = vplScene_Load(context, scenes[variant], &scene);
    vplScene_Destroy(scene);
    return result;
}

// jansson itself reports a syntax error if it runs out of memory for a key, as if the key were missing.
static void failJansson(int variant)
{
    vplResult result = VPL_OUT_OF_MEMORY;
    json_set_alloc_funcs(failingJsonAlloc, free);
    for (jsonFailAt = 0; result != VPL_SUCCESS; jsonFailAt++) {
        Failing failing = {.failAt = -1};
        vplContext* context = openFailing(&failing);
        jsonAllocations = 0;
        result = readByJansson(context, variant);
        vplContext_Destroy(context);
        bool told = result == VPL_OUT_OF_MEMORY && failing.errors == 1;
        if (failing.held != 0 || (result != VPL_SUCCESS && !told)) {
            json_set_alloc_funcs(malloc, free);
            fail_msg("variant %d, allocation %ld of jansson: %s, %d sentences, %ld blocks leaked", variant,
                     jsonFailAt, vplResult_GetName(result), failing.errors, failing.held);
        }
    }
    json_set_alloc_funcs(malloc, free);
    printf("# jansson, variant %d: %ld failed allocations\n", variant, jsonFailAt - 1);
    assert_true(jsonFailAt > 20);
}

TEST_ALONE(EveryFailedAllocationOfJanssonIsReported)
{
    for (int variant = 0; variant < 3; variant++) {
        failJansson(variant);
    }
}
