// SPDX-License-Identifier: MIT
// Makes the benchmark room, its camera, lights and shadow map through libvpl's public API. OpenGL draws the
// same data.
#include "peers.h"

#include <stdio.h>
#include <stdlib.h>

void demand(bool ok, const char* message)
{
    if (!ok) {
        fprintf(stderr, "bench/peers: %s\n", message);
        exit(1);
    }
}

static void say(void* user, vplLogLevel level, const char* message)
{
    (void)user;
    if (level == VPL_LOG_ERROR) {
        fprintf(stderr, "bench/peers: %s\n", message);
    }
}

// Traces enough particles for MOST_LIGHTS lights and takes the first ones; a list that is too short is
// repeated.
static vplShadeLight* makeLights(const Room* room, vplLighting lighting)
{
    vplParticleDef def = vplDefaultParticleDef();
    def.lighting = lighting;
    def.particleCount = 1200;
    def.sampler = VPL_SAMPLER_HALTON;
    vplLightSet* set;
    demand(vplSimulateParticles(room->geometry, room->emitter, 1, &def, &set) == VPL_SUCCESS &&
               set->lightCount > 0,
           "no virtual lights");
    const int found = set->lightCount;
    vplShadeLight* lights = malloc((size_t)(found > MOST_LIGHTS ? found : MOST_LIGHTS) * sizeof *lights);
    demand(lights != NULL, "out of memory");
    vplPrepareLights(set, lighting, lights);
    for (int i = found; i < MOST_LIGHTS; i++) {
        lights[i] = lights[i % found];
    }
    vplLightSet_Destroy(set);
    return lights;
}

static float gridDepth(int i)
{
    return 0.25f + 0.5f * (float)((uint32_t)i * 2654435761u >> 8) / 16777216;
}

// Makes rows of right triangles with legs of two pixels.
static void makeGrid(Room* room)
{
    const int columns = room->view.width / GRID_STEP, rows = room->view.height / GRID_STEP;
    const int vertexCount = (columns + 1) * (rows + 1), triangleCount = 2 * columns * rows;
    vplVec3* positions = malloc((size_t)vertexCount * sizeof *positions);
    uint32_t* indices = malloc(3 * (size_t)triangleCount * sizeof *indices);
    demand(positions != NULL && indices != NULL, "out of memory");
    for (int i = 0; i < vertexCount; i++) {
        const double x = (double)(i % (columns + 1)) / columns, y = (double)(i / (columns + 1)) / rows;
        positions[i] = (vplVec3){(float)(2 * x - 1), (float)(1 - 2 * y), gridDepth(i)};
    }
    uint32_t* at = indices;
    for (int i = 0; i < columns * rows; i++) {
        const uint32_t a = (uint32_t)(i / columns * (columns + 1) + i % columns);
        const uint32_t b = a + 1, c = a + (uint32_t)columns + 1, d = c + 1;
        const uint32_t two[6] = {a, c, b, b, c, d};
        for (int k = 0; k < 6; k++) {
            *at++ = two[k];
        }
    }
    room->gridPositions = positions;
    room->grid = (vplMesh){indices, vertexCount, triangleCount};
}

// Counts pixels that show a surface; rates multiply this by the number of lights.
static int64_t countCovered(Room* room)
{
    vplShadeDef def = vplDefaultShadeDef();
    def.output = VPL_OUTPUT_DEPTH;
    demand(vplShadeView(room->geometry, &room->view, &def, room->image, NULL) == VPL_SUCCESS,
           "the room cannot be drawn");
    int64_t covered = 0;
    for (int i = 0; i < room->view.width * room->view.height; i++) {
        covered += room->image->pixels[3 * i] > 0;
    }
    return covered;
}

void openRoom(Room* room, const Options* o)
{
    vplContextDef def = vplDefaultContextDef();
    def.workerCount = o->threads;
    def.log = say;
    demand(vplContext_Create(&def, &room->context) == VPL_SUCCESS, "no context");
    demand(vplScene_Load(room->context, o->scene, &room->scene) == VPL_SUCCESS, "no scene");
    demand(vplScene_GetEmitterCount(room->scene) == 1, "the scene must have one point light");
    demand(vplGeometry_Create(room->scene, &room->geometry) == VPL_SUCCESS, "no geometry");
    demand(room->geometry->shadingNormals == NULL, "the scene must have flat triangles only");
    room->emitter = vplScene_GetEmitter(room->scene, 0);
    room->view = vplView_Create(vplScene_GetCamera(room->scene, 0), o->width, o->height);
    demand(vplImage_Create(room->context, o->width, o->height, &room->image) == VPL_SUCCESS, "no image");
    const size_t pixels = (size_t)o->width * (size_t)o->height;
    room->depth = calloc(pixels, sizeof(float));
    room->colour = calloc(pixels * ADD_PLANES, sizeof(float));
    demand(room->depth != NULL && room->colour != NULL, "out of memory");
    room->documented = makeLights(room, VPL_LIGHTING_DOCUMENTED);
    room->physical = makeLights(room, VPL_LIGHTING_PHYSICAL);
    makeGrid(room);
    vplCubeWay(room, NULL);
    demand(vplCubeMap_FindBounds(room->map) == VPL_SUCCESS, "no bounds");
    room->covered = countCovered(room);
}

void closeRoom(Room* room)
{
    free((void*)room->grid.indices);
    free(room->gridPositions);
    free(room->documented);
    free(room->physical);
    free(room->depth);
    free(room->colour);
    vplCubeMap_Destroy(room->map);
    vplImage_Destroy(room->image);
    vplGeometry_Destroy(room->geometry);
    vplScene_Destroy(room->scene);
    vplContext_Destroy(room->context);
}
