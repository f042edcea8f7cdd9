// SPDX-License-Identifier: MIT
// Normals of smoothing groups, for files that have none of their own.
// Based on: Thuermer and Wuethrich, Computing Vertex Normals from Polygonal Facets, 1998 (weights by angle, so that the
// cutting of faces into triangles does not matter).
#include "scene/obj.h"

#include "math/double3.h"
#include "math/scalar.h"
#include "math/vec.h"
#include "scene/obj_number.h"

#include <math.h>

static const double OPPOSITE_COSINE =
    0.5; // a normal whose cosine with the mean so far is below minus this is turned
static const double LEAST_COSINE = 0.25; // of a mean normal with the normal of a triangle

int64_t vplObj_ReadGroup(vplWord line)
{
    vplWord word;
    int64_t group = 0;
    if (vplNextWord(&line, &word) && !vplWord_Is(word, "off")) {
        const char* at = word.start;
        group = vplReadInteger(&at, word.end, &group) ? group : 1;
    }
    return group;
}

// A point in a smoothing group, and the sum of normals there, times angles.
typedef struct Sum {
    uint32_t point;
    int64_t group;
    double normal[3];
} Sum;

typedef struct Smoothing {
    const vplObj* obj;
    vplObjMesh* mesh;
    vplHashIndex index; // of sums
    Sum* sums;
    size_t capacity;
} Smoothing;

static vplResult findSum(Smoothing* s, uint32_t point, int64_t group, uint32_t* out)
{
    const uint32_t words[3] = {point, (uint32_t)group, (uint32_t)((uint64_t)group >> 32)};
    const uint32_t hash = vplHashKey(words, 3);
    *out = vplHashIndex_First(&s->index, hash);
    while (*out != VPL_NO_ENTRY && (s->sums[*out].point != point || s->sums[*out].group != group)) {
        *out = vplHashIndex_Next(&s->index, *out);
    }
    if (*out != VPL_NO_ENTRY) {
        return VPL_SUCCESS;
    }
    *out = s->index.count;
    TRY(vplArena_Reserve(s->obj->scratch, &s->sums, &s->capacity, (size_t)*out + 1, sizeof *s->sums));
    s->sums[*out] = (Sum){.point = point, .group = group};
    return vplHashIndex_Add(&s->index, hash);
}

// The angle at a corner, radians.
static double angleAt(const vplVec3 at[3], int corner)
{
    double p[3][3], a[3], b[3], cross[3];
    for (int k = 0; k < 3; k++) {
        vplToDouble3(at[(corner + k) % 3], p[k]);
    }
    for (int k = 0; k < 3; k++) {
        a[k] = p[1][k] - p[0][k];
        b[k] = p[2][k] - p[0][k];
    }
    vplCross3(a, b, cross);
    return vplAtan2(sqrt(vplDot3(cross, cross)), vplDot3(a, b));
}

static void getTriangle(const Smoothing* s, int64_t triangle, vplVec3 at[3], vplVec3* normal)
{
    for (int k = 0; k < 3; k++) {
        at[k] = s->obj->points[s->mesh->indices[3 * triangle + k]];
    }
    vplObj_FindNormal(at, normal); // triangles without area are left out before
}

// Files wind triangles of one surface both ways, or have each triangle twice, once for each side: a normal that is nearly
// opposite to the sum so far is turned.
static void addNormal(double sum[3], const double normal[3], double angle)
{
    const double length = sqrt(vplDot3(sum, sum));
    const double weight = vplDot3(sum, normal) < -OPPOSITE_COSINE * length ? -angle : angle;
    for (int axis = 0; axis < 3; axis++) {
        sum[axis] += weight * normal[axis];
    }
}

static vplResult addNormals(Smoothing* s, int64_t triangle)
{
    vplVec3 at[3], normal = {0, 0, 0};
    getTriangle(s, triangle, at, &normal);
    for (int k = 0; k < 3; k++) {
        uint32_t sum;
        double n[3];
        vplToDouble3(normal, n);
        TRY(findSum(s, s->mesh->indices[3 * triangle + k], s->mesh->groups[triangle], &sum));
        addNormal(s->sums[sum].normal, n, angleAt(at, k));
    }
    return VPL_SUCCESS;
}

// The mean normal at a corner of a triangle, on the side of the triangle's own normal. Where normals cancel, and on spikes,
// the mean is nearly in the triangle's plane and would leave it black; such corners have the triangle's normal.
static vplVec3 smoothNormal(const double sum[3], vplVec3 flat)
{
    double own[3];
    vplToDouble3(flat, own);
    const double length = sqrt(vplDot3(sum, sum)), along = vplDot3(sum, own);
    if (!(length > 1e-6 && fabs(along) > LEAST_COSINE * length)) {
        return flat;
    }
    const double scale = along < 0 ? -1 / length : 1 / length;
    return vplVec((float)(scale * sum[0]), (float)(scale * sum[1]), (float)(scale * sum[2]));
}

// Turns the indices of points into those of vertices. Corners outside groups have the triangle's normal.
static vplResult placeCorners(Smoothing* s, int64_t triangle)
{
    vplVec3 at[3], flat = {0, 0, 0};
    getTriangle(s, triangle, at, &flat);
    for (int k = 0; k < 3; k++) {
        uint32_t* index = &s->mesh->indices[3 * triangle + k];
        vplVec3 normal = flat;
        if (s->mesh->groups[triangle] != 0) {
            uint32_t sum;
            TRY(findSum(s, *index, s->mesh->groups[triangle], &sum));
            normal = smoothNormal(s->sums[sum].normal, flat);
        }
        const vplTexcoord texcoord =
            s->mesh->waiting != NULL ? s->mesh->waiting[3 * triangle + k] : (vplTexcoord){0, 0};
        TRY(vplObjMesh_FindVertex(s->obj, s->mesh, &(vplObjCorner){*index, normal, texcoord}, index));
    }
    return VPL_SUCCESS;
}

vplResult vplObjMesh_Smooth(const vplObj* obj, vplObjMesh* mesh)
{
    Smoothing s = {.obj = obj, .mesh = mesh, .index = {.arena = obj->scratch}};
    for (int64_t t = 0; t < mesh->triangleCount; t++) {
        TRY(t % 65536 == 65535 ? vplAsk(obj->text.context) : VPL_SUCCESS);
        if (mesh->groups[t] != 0) {
            TRY(addNormals(&s, t));
        }
    }
    for (int64_t t = 0; t < mesh->triangleCount; t++) {
        TRY(t % 65536 == 65535 ? vplAsk(obj->text.context) : VPL_SUCCESS);
        TRY(placeCorners(&s, t));
    }
    return VPL_SUCCESS;
}
