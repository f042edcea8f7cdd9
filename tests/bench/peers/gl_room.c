// SPDX-License-Identifier: MIT
// Puts the room into OpenGL: triangles, lights, camera and cube map as buffers and matrices.
#include "gl.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { VERTEX_FLOATS = 10 };

static GLuint makeBuffer(const void* bytes, size_t size)
{
    GLuint buffer;
    glCreateBuffers(1, &buffer);
    glNamedBufferStorage(buffer, (GLsizeiptr)size, bytes, 0);
    return buffer;
}

static void attribute(GLuint array, int location, int binding, int components, int offset)
{
    glEnableVertexArrayAttrib(array, (GLuint)location);
    glVertexArrayAttribFormat(array, (GLuint)location, components, GL_FLOAT, GL_FALSE, (GLuint)offset * 4);
    glVertexArrayAttribBinding(array, (GLuint)location, (GLuint)binding);
}

// Writes three vertices per triangle, in the scene's order: position, normal, rho / pi, triangle index.
static void fillTriangles(const vplGeometry* g, float* vertices, float (*facets)[2][4])
{
    for (int t = 0; t < g->triangleCount; t++) {
        const vplVec3* corners = g->positions + g->objects[g->owners[t]].firstVertex;
        const vplVec3 n = g->normals[t];
        const vplRgb rho = g->materials[g->triangleMaterials[t]].diffuse;
        const float scale = (float)(1 / VPL_PI);
        const float c[3] = {rho.r * scale, rho.g * scale, rho.b * scale};
        for (int k = 0; k < 3; k++) {
            const vplVec3 p = corners[g->indices[3 * t + k]];
            const float vertex[VERTEX_FLOATS] = {p.x, p.y, p.z, n.x, n.y, n.z, c[0], c[1], c[2], (float)t};
            memcpy(vertices + VERTEX_FLOATS * (3 * t + k), vertex, sizeof vertex);
        }
        const float facet[2][4] = {{n.x, n.y, n.z, 0}, {c[0], c[1], c[2], 0}};
        memcpy(facets[t], facet, sizeof facet);
    }
}

static void roomArray(const Gl* gl, GLuint array)
{
    glVertexArrayVertexBuffer(array, 0, gl->roomBuffer, 0, VERTEX_FLOATS * 4);
    attribute(array, 0, 0, 3, 0);
    attribute(array, 1, 0, 3, 3);
    attribute(array, 2, 0, 3, 6);
    attribute(array, 3, 0, 1, 9);
}

static void makeTriangles(Gl* gl)
{
    const vplGeometry* g = gl->room->geometry;
    demand(g->triangleCount <= FACETS, "the peer draws at most 1024 triangles");
    gl->vertexCount = 3 * g->triangleCount;
    const size_t size = (size_t)gl->vertexCount * VERTEX_FLOATS * sizeof(float);
    float* vertices = malloc(size);
    float(*facets)[2][4] = calloc(FACETS, sizeof *facets);
    demand(vertices != NULL && facets != NULL, "out of memory");
    fillTriangles(g, vertices, facets);
    gl->roomBuffer = makeBuffer(vertices, size);
    gl->facets = makeBuffer(facets, FACETS * sizeof *facets);
    free(vertices);
    free(facets);
    glCreateVertexArrays(1, &gl->roomArray);
    glCreateVertexArrays(1, &gl->lightsArray);
    glCreateVertexArrays(1, &gl->emptyArray);
    roomArray(gl, gl->roomArray);
    roomArray(gl, gl->lightsArray);
}

// Packs a light into uniform vectors: position, (normal,) colour.
static int packLight(const Room* room, bool documented, int i, float (*out)[4])
{
    const vplShadeLight l = documented ? room->documented[i] : room->physical[i];
    const float place[4] = {l.px, l.py, l.pz, MIN_DISTANCE * MIN_DISTANCE};
    const float normal[4] = {l.nx, l.ny, l.nz, 0}, light[4] = {l.r, l.g, l.b, 0};
    const int vectors = documented ? 2 : 3;
    memcpy(out[0], place, sizeof place);
    memcpy(out[1], normal, sizeof normal);
    memcpy(out[vectors - 1], light, sizeof light);
    return vectors;
}

void writeTaps(const Gl* gl, char* text, size_t size)
{
    const vplShadow* shadow = &gl->room->shadow;
    size_t at = (size_t)snprintf(text, size, "#define TAPS");
    for (int s = 0; s < PCF_SAMPLES && at < size; s++) {
        const float off = shadow->def.pcfOffset;
        at += (size_t)snprintf(text + at, size - at, " TAP(%.9g, %.9g)",
                               (double)(off * shadow->offsets[s][0]), (double)(off * shadow->offsets[s][1]));
    }
    demand(at + 2 < size, "the shadow's samples are too long");
    strcpy(text + at, "\n");
}

GLuint findLights(Gl* gl, bool documented, int count)
{
    const int key = 2 * count + documented;
    int i = 0;
    while (i < gl->lightSetCount && gl->lightSets[i].key != key) {
        i++;
    }
    if (i == gl->lightSetCount) {
        static float vectors[2 * LIGHT_VECTORS][4];
        memset(vectors, 0, sizeof vectors);
        for (int l = 0, at = 0; l < count; l++) {
            at += packLight(gl->room, documented, l, vectors + at);
        }
        demand(i < LIGHT_SETS, "too many numbers of lights");
        gl->lightSets[gl->lightSetCount++] = (LightSet){key, makeBuffer(vectors, sizeof vectors)};
    }
    return gl->lightSets[i].buffer;
}

// Packs lights i, i + 16, i + 32 ... one after another, and one light per instance.
static void makeLights(Gl* gl)
{
    static float split[2 * LIGHT_VECTORS][4]; // padded, so that 64 KB can be bound from any part on
    const int groups = INTERLEAVE * INTERLEAVE;
    for (int i = 0; i < INTERLEAVED_LIGHTS; i++) {
        packLight(gl->room, true, i, &split[2 * (i % groups * (INTERLEAVED_LIGHTS / groups) + i / groups)]);
    }
    gl->split = makeBuffer(split, sizeof split);
    glVertexArrayVertexBuffer(gl->lightsArray, 1, findLights(gl, true, MOST_LIGHTS), 0, 32);
    glVertexArrayBindingDivisor(gl->lightsArray, 1, 1);
    attribute(gl->lightsArray, 4, 1, 3, 0);
    attribute(gl->lightsArray, 5, 1, 3, 4);
}

// Packs the direct light with libvpl's bias.
static void makeDirect(Gl* gl)
{
    const Room* room = gl->room;
    const vplShadow* shadow = &room->shadow;
    float block[3][4] = {{0}};
    const vplVec3 p = room->emitter->position;
    const vplRgb i = room->emitter->intensity;
    const float place[4] = {p.x, p.y, p.z, room->map->farPlane};
    const float light[4] = {i.r / PARTICLES, i.g / PARTICLES, i.b / PARTICLES, 0};
    memcpy(block[0], place, sizeof place);
    memcpy(block[1], light, sizeof light);
    block[2][0] = shadow->def.biasStatic;
    block[2][1] = shadow->def.biasDynamic;
    gl->direct = makeBuffer(block, sizeof block);
    glBindBufferBase(GL_UNIFORM_BUFFER, BLOCK_FACETS, gl->facets);
    glBindBufferBase(GL_UNIFORM_BUFFER, BLOCK_DIRECT, gl->direct);
}

// Sets row `row` of a matrix that transforms a world point, relative to `from`, along `axis`.
static void setRow(float m[16], int row, double scale, vplVec3 axis, vplVec3 from, double add)
{
    const double x = scale * axis.x, y = scale * axis.y, z = scale * axis.z;
    m[row] = (float)x;
    m[4 + row] = (float)y;
    m[8 + row] = (float)z;
    m[12 + row] = (float)(add - (x * from.x + y * from.y + z * from.z));
}

static void makeMatrices(Gl* gl)
{
    const vplView* v = &gl->room->view;
    const double depth = v->farPlane / (v->farPlane - v->nearPlane);
    setRow(gl->toClip, 0, v->scaleX, v->right, v->eye, 0);
    // The picture is upside down: row 0 is the top, as in libvpl, so that pixel centres on edges fall into
    // the same triangles.
    setRow(gl->toClip, 1, -v->scaleY, v->up, v->eye, 0);
    setRow(gl->toClip, 2, depth, v->forward, v->eye, -depth * v->nearPlane);
    setRow(gl->toClip, 3, 1, v->forward, v->eye, 0);
    const vplCubeMap* map = gl->room->map;
    for (int face = 0; face < 6; face++) {
        const vplCubeFrame frame = vplCube_GetFrame(face);
        float* m = gl->faceToClip[face];
        setRow(m, 0, 1, frame.right, map->position, 0);
        setRow(m, 1, -1, frame.up, map->position, 0); // row 0 of a face is its top in OpenGL
        setRow(m, 2, 1, frame.forward, map->position, -(double)map->nearPlane);
        setRow(m, 3, 1, frame.forward, map->position, 0);
    }
}

static void makeGrid(Gl* gl)
{
    const vplMesh* grid = &gl->room->grid;
    gl->gridCount = 3 * grid->triangleCount;
    gl->gridVertices = makeBuffer(gl->room->gridPositions, (size_t)grid->vertexCount * sizeof(vplVec3));
    gl->gridIndices = makeBuffer(grid->indices, (size_t)gl->gridCount * sizeof(uint32_t));
    glCreateVertexArrays(1, &gl->gridArray);
    glVertexArrayVertexBuffer(gl->gridArray, 0, gl->gridVertices, 0, sizeof(vplVec3));
    glVertexArrayElementBuffer(gl->gridArray, gl->gridIndices);
    attribute(gl->gridArray, 0, 0, 3, 0);
}

void makeGlRoom(Gl* gl)
{
    makeTriangles(gl);
    makeLights(gl);
    makeDirect(gl);
    makeMatrices(gl);
    makeGrid(gl);
}
