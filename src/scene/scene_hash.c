// SPDX-License-Identifier: MIT
// A hash of what a scene says, for files that belong to one.
#include "base/hash.h"
#include "scene/scene.h"
#include "scene/texture.h"

#include <string.h>

static uint64_t addInts(uint64_t state, const int* values, size_t count)
{
    uint32_t words[1024];
    for (size_t i = 0; i < count; i += 1024) {
        const size_t n = count - i < 1024 ? count - i : 1024;
        memcpy(words, values + i, n * sizeof *words);
        state = vplHashWords(state, words, n);
    }
    return state;
}

static uint64_t addInt(uint64_t state, int value)
{
    return addInts(state, &value, 1);
}

// Low half first, on machines of either byte order.
static uint64_t addNumber(uint64_t state, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    const uint32_t words[2] = {(uint32_t)bits, (uint32_t)(bits >> 32)};
    return vplHashWords(state, words, 2);
}

static uint64_t addVector(uint64_t state, vplVec3 v)
{
    return vplHashFloats(state, (const float[3]){v.x, v.y, v.z}, 3);
}

static uint64_t addColour(uint64_t state, vplRgb c)
{
    return vplHashFloats(state, (const float[3]){c.r, c.g, c.b}, 3);
}

static uint64_t addCamera(uint64_t state, const vplCamera* camera)
{
    const vplCameraDef* d = &camera->def;
    const vplCameraKey* keys = camera->track.keys;
    state = addVector(addVector(addVector(state, d->eye), d->target), d->up);
    state = addNumber(addNumber(addNumber(state, d->fovY), d->nearPlane), d->farPlane);
    state = addInt(state, camera->track.count);
    for (int i = 0; i < camera->track.count; i++) {
        state = addNumber(addNumber(state, keys[i].frame), keys[i].fovY);
        state = addVector(addVector(addVector(state, keys[i].eye), keys[i].target), keys[i].up);
    }
    return state;
}

static uint64_t addEmitter(uint64_t state, const vplEmitter* emitter)
{
    const vplEmitterDef* d = &emitter->def;
    const vplEmitterKey* keys = emitter->track.keys;
    state = addInt(state, (int)d->type);
    state = addColour(addVector(addVector(state, d->position), d->direction), d->intensity);
    state = addNumber(addNumber(state, d->innerAngle), d->outerAngle);
    state = addInt(state, emitter->track.count);
    for (int i = 0; i < emitter->track.count; i++) {
        state = addVector(addVector(addNumber(state, keys[i].frame), keys[i].position), keys[i].direction);
        state = addColour(state, keys[i].intensity);
    }
    return state;
}

static uint64_t addTexture(uint64_t state, const vplTexture* t)
{
    const vplTextureLevel* level = &t->levels[0];
    const size_t texels = (size_t)level->width * (size_t)level->height;
    uint32_t words[1024]; // two per texel
    state = addInt(addInt(addInt(addInt(state, level->width), level->height), (int)t->wrapU), (int)t->wrapV);
    for (size_t i = 0; i < texels; i += 512) {
        const size_t n = texels - i < 512 ? texels - i : 512;
        for (size_t k = 0; k < 2 * n; k++) {
            const uint16_t* pair = level->texels + 2 * (2 * i + k);
            words[k] = pair[0] | (uint32_t)pair[1] << 16;
        }
        state = vplHashWords(state, words, 2 * n);
    }
    return state;
}

// Materials without textures and opacity have the hash that they had before there were any.
static uint64_t addMaterial(uint64_t state, const vplMaterialDef* d)
{
    state = addColour(addColour(state, d->diffuse), d->emission);
    if (d->texture >= 0 || d->alphaTexture >= 0) {
        const float placing[4] = {d->textureScale[0], d->textureScale[1], d->textureOffset[0],
                                  d->textureOffset[1]};
        state = addNumber(vplHashFloats(addInt(state, d->texture), placing, 4), d->textureRotation);
    }
    if (d->alphaTexture >= 0 || d->alphaFromTexture || d->opacity != 1) {
        const float opacity[2] = {d->opacity, d->alphaCutoff};
        state = vplHashFloats(addInt(addInt(state, d->alphaTexture), d->alphaFromTexture), opacity, 2);
    }
    return state;
}

static uint64_t addMesh(uint64_t state, const vplMeshDef* d)
{
    const size_t vertices = (size_t)d->vertexCount, triangles = (size_t)d->triangleCount;
    state = addInt(addInt(state, d->vertexCount), d->triangleCount);
    state = addInt(state, (d->normals != NULL ? 1 : 0) | (d->materials != NULL ? 2 : 0) |
                              (d->texcoords != NULL ? 4 : 0) | (d->colors != NULL ? 8 : 0));
    if (vertices > 0) {
        state = vplHashFloats(state, &d->positions[0].x, 3 * vertices);
        state = d->normals != NULL ? vplHashFloats(state, &d->normals[0].x, 3 * vertices) : state;
        state = d->texcoords != NULL ? vplHashFloats(state, d->texcoords, 2 * vertices) : state;
        state = d->colors != NULL ? vplHashFloats(state, &d->colors[0].r, 3 * vertices) : state;
    }
    if (triangles > 0) {
        state = vplHashWords(state, d->indices, 3 * triangles);
        state = d->materials != NULL ? addInts(state, d->materials, triangles) : state;
    }
    return state;
}

static uint64_t addObject(uint64_t state, const vplObjectDef* d)
{
    const int mesh = d->type == VPL_OBJECT_MESH ? d->mesh : -1;
    state = addInt(addInt(addInt(state, (int)d->type), d->material), mesh);
    for (int i = 0; i < 16; i++) {
        state = addNumber(state, (double)d->transform.m[i]);
    }
    return state;
}

// Scenes without an environment keep the hash that they had before there were environments. The sun is an emitter.
static uint64_t addEnvironment(uint64_t state, const vplEnvironmentDef* d)
{
    if (d->type == VPL_ENVIRONMENT_NONE) {
        return state;
    }
    state = addNumber(addNumber(addInt(state, (int)d->type), d->scale), d->rotate);
    return d->type == VPL_ENVIRONMENT_CONSTANT
               ? addColour(state, d->radiance)
               : vplHashFloats(addInts(state, (const int[2]){d->width, d->height}, 2), d->pixels,
                               3 * (size_t)d->width * (size_t)d->height);
}

uint64_t vplScene_GetHash(const vplScene* s)
{
    if (s == NULL) {
        return 0;
    }
    const int counts[5] = {s->cameraCount, s->materialCount, s->meshCount, s->objectCount, s->emitterCount};
    uint64_t state = addInts(0, counts, 5);
    for (int i = 0; i < s->cameraCount; i++) {
        state = addCamera(state, &s->cameras[i]);
    }
    for (int i = 0; i < s->textureCount; i++) {
        state = addTexture(state, s->textures[i].decoded);
    }
    for (int i = 0; i < s->materialCount; i++) {
        state = addMaterial(state, &s->materials[i]);
    }
    for (int i = 0; i < s->meshCount; i++) {
        state = addMesh(state, &s->meshes[i]);
    }
    for (int i = 0; i < s->objectCount; i++) {
        state = addObject(state, &s->objects[i]);
    }
    for (int i = 0; i < s->emitterCount; i++) {
        state = addEmitter(state, &s->emitters[i]);
    }
    return addEnvironment(state, &s->environment);
}
