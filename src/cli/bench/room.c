// SPDX-License-Identifier: MIT
// Scenes of vpl bench, made in code so that the program needs no files: a room, and bumpy spheres for stages
// with many triangles.
#include "cli/bench/bench.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct Object {
    vplObjectType type;
    int material;
    vplVec3 place;
    double turnX, turnY; // degrees
    vplVec3 size;
} Object;

static void addObject(vplScene* scene, const Object* o)
{
    vplObjectDef def = vplDefaultObjectDef();
    const double rotate[3] = {o->turnX * VPL_PI / 180, o->turnY * VPL_PI / 180, 0};
    def.type = o->type;
    def.material = o->material;
    def.transform = vplMat4_FromParts(o->place, rotate, o->size);
    vplScene_AddObject(scene, &def, NULL);
}

static void addCamera(vplScene* scene)
{
    vplCameraDef camera = vplDefaultCameraDef();
    camera.eye = (vplVec3){0, 2.5f, 8.5f};
    camera.target = (vplVec3){0, 2.5f, 0};
    camera.farPlane = 50;
    vplScene_AddCamera(scene, &camera, NULL);
}

static void addEmitter(vplScene* scene)
{
    vplEmitterDef light = vplDefaultEmitterDef();
    light.position = (vplVec3){0, 4.5f, 0};
    light.intensity = (vplRgb){10, 10, 10};
    vplScene_AddEmitter(scene, &light, NULL);
}

// The room of examples/scenes/room.json.
static vplResult buildRoom(vplContext* context, vplScene** sceneOut)
{
    static const vplRgb colours[] = {{0.725f, 0.71f, 0.68f}, {0.63f, 0.065f, 0.05f}, {0.14f, 0.45f, 0.091f}};
    static const Object objects[] = {
        {VPL_OBJECT_QUAD, 0, {0, 0, 0}, -90, 0, {5, 5, 1}},
        {VPL_OBJECT_QUAD, 0, {0, 5, 0}, 90, 0, {5, 5, 1}},
        {VPL_OBJECT_QUAD, 0, {0, 2.5f, -2.5f}, 0, 0, {5, 5, 1}},
        {VPL_OBJECT_QUAD, 1, {-2.5f, 2.5f, 0}, 0, 90, {5, 5, 1}},
        {VPL_OBJECT_QUAD, 2, {2.5f, 2.5f, 0}, 0, -90, {5, 5, 1}},
        {VPL_OBJECT_BOX, 0, {-0.9f, 1.65f, -0.8f}, 0, 17, {1.5f, 3.3f, 1.5f}},
        {VPL_OBJECT_BOX, 0, {0.85f, 0.75f, 0.75f}, 0, -17, {1.5f, 1.5f, 1.5f}},
    };
    TRY(vplScene_Create(context, sceneOut));
    for (size_t i = 0; i < sizeof colours / sizeof *colours; i++) {
        vplMaterialDef material = vplDefaultMaterialDef();
        material.diffuse = colours[i];
        vplScene_AddMaterial(*sceneOut, &material, NULL);
    }
    for (size_t i = 0; i < sizeof objects / sizeof *objects; i++) {
        addObject(*sceneOut, &objects[i]);
    }
    addEmitter(*sceneOut);
    addCamera(*sceneOut);
    return VPL_SUCCESS;
}

// A unit sphere of 2 * rings columns, two triangles each, with bumps as fine as its triangles allow so that
// they lie at all angles. The poles' triangles without area are kept: geometry leaves them out of its tree.
static void fillSphere(int rings, vplVec3* positions, uint32_t* indices)
{
    const int columns = 2 * rings;
    for (int i = 0; i <= rings; i++) {
        for (int k = 0; k <= columns; k++) {
            double up = VPL_PI * i / rings, round = 2 * VPL_PI * (k % columns) / columns;
            double radius =
                1 + 0.05 * sin(9 * round) * sin(7 * up) + 0.4 / rings * ((i * 7 + k % columns * 5) % 8 / 8.0);
            *positions++ = (vplVec3){(float)(radius * sin(up) * cos(round)), (float)(radius * cos(up)),
                                     (float)(radius * sin(up) * sin(round))};
        }
    }
    for (int i = 0; i < rings; i++) {
        for (int k = 0; k < columns; k++) {
            uint32_t at = (uint32_t)(i * (columns + 1) + k), below = at + (uint32_t)columns + 1;
            const uint32_t corners[6] = {at, at + 1, below, at + 1, below + 1, below};
            memcpy(indices, corners, sizeof corners);
            indices += 6;
        }
    }
}

enum { SPHERES = 16 };

vplResult buildField(vplContext* context, int triangleCount, vplScene** sceneOut)
{
    const int rings = (int)fmax(2, sqrt(triangleCount / (4.0 * SPHERES)) + 0.5);
    const int vertices = (rings + 1) * (2 * rings + 1), triangles = 4 * rings * rings;
    vplVec3* positions = malloc((size_t)vertices * sizeof *positions);
    uint32_t* indices = malloc(3 * (size_t)triangles * sizeof *indices);
    vplScene* s = NULL;
    vplResult result = positions && indices ? vplScene_Create(context, &s) : VPL_OUT_OF_MEMORY;
    if (result == VPL_SUCCESS) {
        fillSphere(rings, positions, indices);
        vplMeshDef mesh = vplDefaultMeshDef();
        mesh.positions = positions;
        mesh.indices = indices;
        mesh.vertexCount = vertices;
        mesh.triangleCount = triangles;
        vplMaterialDef material = vplDefaultMaterialDef();
        vplScene_AddMaterial(s, &material, NULL);
        result = vplScene_AddMesh(s, &mesh, NULL);
    }
    for (int i = 0; i < SPHERES && result == VPL_SUCCESS; i++) {
        const vplVec3 place = {1.2f * (float)(i % 4) - 1.8f, 0.7f + 1.2f * (float)(i / 4),
                               0.3f * (float)(i % 3)};
        const Object sphere = {VPL_OBJECT_MESH, 0, place, 23.0 * i, 41.0 * i, {0.6f, 0.6f, 0.6f}};
        addObject(s, &sphere);
    }
    free(positions);
    free(indices);
    if (result != VPL_SUCCESS) {
        vplScene_Destroy(s);
        return result;
    }
    addEmitter(s);
    addCamera(s);
    *sceneOut = s;
    return VPL_SUCCESS;
}

vplResult needField(Bench* b)
{
    if (b->fieldGeometry == NULL) {
        TRY(buildField(b->context, 1 << 18, &b->field));
        TRY(vplGeometry_Create(b->field, &b->fieldGeometry));
    }
    return VPL_SUCCESS;
}

vplResult needShadow(Bench* b)
{
    if (b->map == NULL) {
        vplCubeMapDef def = vplDefaultCubeMapDef();
        const vplShadowDef shadowDef = vplDefaultShadowDef();
        def.position = vplScene_GetEmitter(b->scene, 0)->position;
        TRY(vplCubeMap_Create(b->geometry, &def, NULL, NULL, &b->map));
        TRY(vplCubeMap_FindBounds(b->map));
        TRY(vplShadow_Create(b->map, &shadowDef, &b->shadow));
    }
    return VPL_SUCCESS;
}

vplResult needPicture(Bench* b)
{
    if (b->picture == NULL) {
        const Stage lit = {
            .accumulation = VPL_ACCUMULATE_DEFERRED, .lights = 18, .batch = 1, .flags = DIRECT};
        Outcome outcome;
        TRY(vplImage_Create(b->context, b->image->width, b->image->height, &b->picture));
        TRY(shadeInto(b, b->geometry, &lit, b->picture, &outcome));
    }
    return VPL_SUCCESS;
}

static vplResult makeLights(Bench* b)
{
    vplParticleDef def = vplDefaultParticleDef();
    def.particleCount = 3000;
    def.sampler = VPL_SAMPLER_HALTON;
    TRY(vplSimulateParticles(b->geometry, vplScene_GetEmitter(b->scene, 0), 1, &def, &b->set));
    b->lights = malloc((size_t)b->set->lightCount * sizeof *b->lights);
    if (b->lights == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    vplPrepareLights(b->set, VPL_LIGHTING_PHYSICAL, b->lights);
    return VPL_SUCCESS;
}

vplResult openBench(const Arguments* a, int threads, int width, int height, Bench* b)
{
    Arguments copy = *a;
    copy.context.workerCount = threads;
    memset(b, 0, sizeof *b);
    TRY(openContext(&copy, &b->context));
    TRY(buildRoom(b->context, &b->scene));
    TRY(vplGeometry_Create(b->scene, &b->geometry));
    TRY(vplImage_Create(b->context, width, height, &b->image));
    TRY(vplImage_Create(b->context, (width + 3) / 4, (height + 3) / 4, &b->quarter));
    return makeLights(b);
}

void closeBench(Bench* b)
{
    free(b->lights);
    vplImage_Destroy(b->image);
    vplImage_Destroy(b->quarter);
    vplImage_Destroy(b->picture);
    vplCubeMap_Destroy(b->map);
    vplLightSet_Destroy(b->set);
    vplGeometry_Destroy(b->geometry);
    vplScene_Destroy(b->scene);
    vplGeometry_Destroy(b->fieldGeometry);
    vplScene_Destroy(b->field);
    vplContext_Destroy(b->context);
}
