// SPDX-License-Identifier: MIT
// The fixture of the calls with wrong arguments. One worker: calls run in forked processes, which have no other threads.
#include "fixture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

Fixture f;
_Alignas(64) unsigned char spaces[SPACES][SPACE_BYTES];
_Alignas(64) unsigned char zeros[1 << 16];
float ones[1 << 16];

#define MUST(call)                                                                                           \
    do {                                                                                                     \
        if ((call) != VPL_SUCCESS) {                                                                         \
            fprintf(stderr, "%s: %s\n", #call, vplContext_GetLastMessage(f.context));                        \
            exit(1);                                                                                         \
        }                                                                                                    \
    } while (0)

bool goOn(void* user, double fraction)
{
    (void)user;
    (void)fraction;
    return true;
}

void tileTask(void* data, vplTile* tile, int worker)
{
    (void)data;
    (void)tile;
    (void)worker;
}

static void shadeVertices(const void* uniforms, int first, int count, const vplVertices* out)
{
    (void)uniforms;
    for (int i = 0; i < count; i++) {
        out->x[i] = (float)((first + i) % 2);
        out->y[i] = (float)((first + i) / 2);
        out->z[i] = 0.5f;
        out->w[i] = 1;
    }
}

// Refuses more than 256 MiB at once, so that a wrong size does not take the machine's memory.
static void* allocate(void* user, void* memory, size_t oldSize, size_t newSize)
{
    (void)user;
    (void)oldSize;
    if (newSize == 0) {
        free(memory);
        return NULL;
    }
    return newSize > (size_t)256 << 20 ? NULL : realloc(memory, newSize);
}

static void makeScene(void)
{
    static const vplVec3 corners[] = {{-1, 0.5f, 0}, {1, 0.5f, 0}, {0, 1.5f, 0.2f}};
    static const uint32_t indices[] = {0, 1, 2};
    static const unsigned char texels[] = {200, 100, 50};
    MUST(vplScene_Create(f.context, &f.scene));
    f.camera = vplDefaultCameraDef();
    f.camera.eye = (vplVec3){0, 1.5f, 5};
    MUST(vplScene_AddCamera(f.scene, &f.camera, NULL));
    f.texture = vplDefaultTextureDef();
    f.texture.texels = texels;
    f.texture.width = f.texture.height = 1;
    MUST(vplScene_AddTexture(f.scene, &f.texture, NULL));
    vplMaterialDef material = vplDefaultMaterialDef();
    MUST(vplScene_AddMaterial(f.scene, &material, NULL));
    material.emission = (vplRgb){1, 1, 1};
    MUST(vplScene_AddMaterial(f.scene, &material, NULL));
    f.meshDef = vplDefaultMeshDef();
    f.meshDef.positions = corners;
    f.meshDef.indices = indices;
    f.meshDef.vertexCount = 3;
    f.meshDef.triangleCount = 1;
    MUST(vplScene_AddMesh(f.scene, &f.meshDef, NULL));
    for (int i = 0; i < 3; i++) {
        const vplVec3 at[] = {{0, 0, 0}, {0, 1, -2}, {0, 0, 0}};
        const double turn[] = {i == 0 ? -VPL_PI / 2 : 0, 0, 0};
        vplObjectDef object = vplDefaultObjectDef();
        object.type = i == 2 ? VPL_OBJECT_MESH : VPL_OBJECT_QUAD;
        object.material = i == 2;
        object.transform = vplMat4_FromParts(at[i], turn, (vplVec3){i == 2 ? 1 : 4, i == 2 ? 1 : 4, 1});
        MUST(vplScene_AddObject(f.scene, &object, NULL));
    }
    f.emitter = vplDefaultEmitterDef();
    f.emitter.position = (vplVec3){0, 2, 1};
    MUST(vplScene_AddEmitter(f.scene, &f.emitter, NULL));
    f.sky = vplDefaultEnvironmentDef();
    f.sky.type = VPL_ENVIRONMENT_CONSTANT;
    MUST(vplScene_SetEnvironment(f.scene, &f.sky));
    f.cameraKey = vplMakeCameraKey(&f.camera, 0);
    f.emitterKey = vplMakeEmitterKey(&f.emitter, 0);
    f.transformKey.transform = vplMat4_Identity();
}

static void makeGeometry(void)
{
    MUST(vplGeometry_Create(f.scene, &f.geometry));
    MUST(vplEnvironment_Create(f.scene, &f.environment));
    MUST(vplEmission_Create(f.geometry, &f.emitter, 1, &f.emission));
    f.ray = (vplRay){{0, 1, 3}, {0, 0, -1}, {0, 0}};
    if (!vplGeometry_ClosestHit(f.geometry, &f.ray, &f.hit)) {
        exit(1);
    }
    f.matrix = vplMat4_Identity();
    MUST(vplPlacement_Create(f.context, &f.matrix, &f.placement));
    f.point = (vplSurfacePoint){f.hit.position, f.hit.normal, f.hit.triangle};
    f.view = vplView_Create(&f.camera, 8, 8);
}

static void makePictures(void)
{
    MUST(vplImage_Create(f.context, 8, 8, &f.image));
    MUST(vplImage_Create(f.context, 8, 8, &f.other));
    for (int i = 0; i < 192; i++) {
        f.image->pixels[i] = 0.1f;
        f.other->pixels[i] = 0.2f;
    }
    f.layer = (vplLayer){.name = "", .image = f.image};
    f.pixels = vplDefaultPixelsDef();
    f.pixels.first = spaces[SPACES - 1];
    f.target.pixels = f.pixels;
}

static void makeMaps(void)
{
    vplCubeMapDef cube = vplDefaultCubeMapDef();
    cube.position = f.emitter.position;
    cube.size = 16;
    f.cubeDef = cube;
    MUST(vplCubeMap_Create(f.geometry, &cube, NULL, NULL, &f.cube));
    const vplShadowDef shadow = vplDefaultShadowDef();
    MUST(vplShadow_Create(f.cube, &shadow, &f.shadow));
    vplReflectiveMapDef reflective = vplDefaultReflectiveMapDef();
    reflective.emitter = f.emitter;
    reflective.size = 16;
    MUST(vplReflectiveMap_Create(f.geometry, &reflective, NULL, NULL, &f.reflective));
    f.hemiPlace = (vplHemiMapPlace){f.hit.position, f.hit.normal};
    MUST(vplHemiMaps_Create(f.context, 16, 8, &f.hemi));
    MUST(vplHemiMaps_Draw(f.hemi, f.geometry, &f.hemiPlace, 1, NULL, NULL));
}

static void makeLights(void)
{
    vplParticleDef particles = vplDefaultParticleDef();
    MUST(vplSimulateParticles(f.geometry, &f.emitter, 1, &particles, &f.lights));
    f.shadeLights = malloc((size_t)(f.lights->lightCount + 1) * sizeof *f.shadeLights);
    f.shadeLightCount = vplPrepareLights(f.lights, VPL_LIGHTING_PHYSICAL, f.shadeLights);
    vplClusterDef clusters = vplDefaultClusterDef();
    clusters.count = 2;
    MUST(vplFindClusters(f.lights, &clusters, &f.clusters));
    vplParaboloidPlace places[2];
    for (int i = 0; i < 2; i++) {
        places[i] =
            (vplParaboloidPlace){f.clusters->clusters[i].position, f.clusters->clusters[i].normal, 2, 1};
    }
    f.paraboloidPlace = places[0];
    MUST(vplParaboloidMaps_Create(f.context, 16, 2, true, &f.paraboloids));
    MUST(vplParaboloidMaps_Draw(f.paraboloids, f.geometry, places, 2, NULL, NULL));
    f.placementDef = vplDefaultPlacementDef();
    f.placementDef.camera = f.camera;
    f.shade = vplDefaultShadeDef();
    f.shade.emitters = &f.emitter;
    f.shade.shadows = &f.shadow;
    f.shade.emitterCount = 1;
    f.shade.lights = f.shadeLights;
    f.shade.lightCount = f.shadeLightCount;
    f.shade.minDistance = 0.2f;
    f.compensation = vplDefaultCompensationDef();
    f.compensation.emitters = &f.emitter;
    f.compensation.shadows = &f.shadow;
    f.compensation.emitterCount = 1;
    f.compensation.lights = f.shadeLights;
    f.compensation.lightCount = f.shadeLightCount;
    f.shade.compensation = &f.compensation;
    f.pass = (vplParticlePass){0, 10, 0.5};
}

static void makeRadiosity(void)
{
    vplPatchDef patches = vplDefaultPatchDef();
    patches.count = 16;
    MUST(vplPatches_Create(f.geometry, &patches, &f.patches));
    vplPatchSidesDef sides = vplDefaultPatchSidesDef();
    sides.emitters = &f.emitter;
    sides.emitterCount = 1;
    MUST(vplPatchSides_Create(f.patches, &sides, &f.sides));
    const vplFormFactorDef factors = vplDefaultFormFactorDef();
    MUST(vplFormFactors_Create(f.sides, &factors, &f.factors));
    const vplLinkDef links = vplDefaultLinkDef();
    MUST(vplLinks_Create(f.sides, &links, &f.links));
    f.transport = (vplTransport){f.sides, f.factors, NULL};
    MUST(vplPatchMesh_Create(f.sides, &f.mesh));
    const vplRgb* light = (const vplRgb*)(const void*)ones;
    f.draw = (vplPatchDraw){.mesh = f.mesh, .vertexValues = light, .values = light};
    f.gather = (vplVertexGather){.radiosity = light, .rays = 1};
    f.priority = vplDefaultPatchPriorityDef();
    f.priority.irradiance = f.priority.vertexIrradiance = light;
}

static void makeRaster(void)
{
    static const uint32_t indices[] = {0, 1, 2};
    f.framebuffer = vplDefaultFramebuffer(8, 8);
    MUST(vplRaster_Create(f.context, &f.framebuffer, &f.raster));
    f.pipeline = vplDefaultPipeline();
    f.pipeline.vertex = shadeVertices;
    f.drawn = (vplMesh){indices, 3, 1};
    MUST(vplRaster_Draw(f.raster, &f.drawn, &f.pipeline));
    f.tile = (vplTile){.width = 8, .height = 8};
}

// A team of one exchanges nothing.
static void exchange(void* user, const void* send, const size_t* sendBytes, void* receive,
                     const size_t* receiveBytes)
{
    (void)user, (void)send, (void)sendBytes, (void)receive, (void)receiveBytes;
}

static void makeRender(void)
{
    f.options = vplRenderOptions_Create(f.context);
    MUST(vplRenderOptions_SetAll(
        f.options, "--size 8x8 --method keller --particles 4 --antialias 1 --passes 2 --patches 20"));
    MUST(vplPlan_Create(f.scene, f.options, NULL, &f.plan));
    MUST(vplRenderer_Create(f.scene, f.options, &f.renderer));
    MUST(vplRenderer_Divide(f.renderer, 1, &f.grid));
    MUST(vplRenderer_MakePiece(f.renderer, &f.grid, 0, &f.piece, &f.pieceBytes));
    bool done;
    MUST(vplRenderer_Step(f.renderer, &done));
    size_t used;
    MUST(vplAssembly_Create(f.context, &f.assembly));
    MUST(vplAssembly_Add(f.assembly, f.piece, f.pieceBytes, "piece", &used));
    MUST(vplHistory_Create(f.context, &f.history));
    f.speeds = vplUsualSpeeds();
    f.machine = (vplMachine){1, NULL};
    f.team = (vplTeam){0, 1, exchange, NULL};
}

void makeFixture(void)
{
    static const char scene[] =
        "{\"camera\":{\"eye\":[0,0,5],\"target\":[0,0,0]},\"materials\":{},\"objects\":[],\"lights\":[]}";
    vplContextDef def = vplDefaultContextDef();
    def.alloc = allocate;
    def.workerCount = 1;
    if (vplContext_Create(&def, &f.context) != VPL_SUCCESS) {
        exit(1);
    }
    for (int i = 0; i < 1 << 16; i++) {
        ones[i] = 1;
    }
    f.file = (vplMemoryFile){"scene.json", scene, sizeof scene - 1};
    makeScene();
    makeGeometry();
    makePictures();
    makeMaps();
    makeLights();
    makeRadiosity();
    makeRaster();
    makeRender();
}
