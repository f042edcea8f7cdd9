// SPDX-License-Identifier: MIT
// Means at vertices smooth light out: a patch in a dark corner gets its neighbours' light, and gives them none of its
// darkness back. Here what interpolation makes of each patch is compared with the patch's own value, and vertices get the
// mean of what is missing around them, again and again.
// Based on: P. H. van Cittert, Zum Einfluss der Spaltbreite auf die Intensitaetsverteilung in Spektrallinien II, Zeitschrift
// fuer Physik 69, 1931 (the iteration).
#include "base/context.h"
#include "math/scalar.h"
#include "math/vec.h"
#include "radiosity/side.h"

#include <vpl/radiosity.h>

#include <math.h>
#include <string.h>

typedef struct Sharpening {
    const vplPatchMesh* mesh;
    const vplRgb* values;
    vplRgb* missing;   // one per side
    double (*sums)[4]; // one per side: r, g, b times area, area
    vplRgb* change;    // one per vertex and face
} Sharpening;

static vplResult reserve(Sharpening* s)
{
    vplContext* context = s->mesh->context;
    const size_t sides = (size_t)s->mesh->sides->count;
    s->missing = vplAlloc(context, sides, sizeof *s->missing);
    s->sums = s->missing ? vplAlloc(context, sides, sizeof *s->sums) : NULL;
    s->change = s->sums ? vplAlloc(context, 2 * (size_t)s->mesh->vertexCount, sizeof *s->change) : NULL;
    return s->change != NULL ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
}

static void release(Sharpening* s)
{
    vplFree(s->mesh->context, s->missing);
    vplFree(s->mesh->context, s->sums);
    vplFree(s->mesh->context, s->change);
}

// Adds what triangle t shows of its patch, times its area.
static void addTriangle(const Sharpening* s, const vplRgb* vertexValues, int t)
{
    const vplPatchMesh* m = s->mesh;
    const uint32_t* v = m->indices + 3 * (size_t)t;
    const vplVec3 p = m->positions[v[0]];
    const vplVec3 cross = vplCross(vplSub(m->positions[v[1]], p), vplSub(m->positions[v[2]], p));
    const double area = sqrt((double)vplDot(cross, cross));
    for (int face = 0; face < 2; face++) {
        const int side = vplSideOf(m->sides, m->patchOf[t], face);
        if (side >= 0) {
            double* sum = s->sums[side];
            for (int k = 0; k < 3; k++) {
                const vplRgb value = vertexValues[2 * (size_t)v[k] + (size_t)face];
                sum[0] += area / 3 * (double)value.r;
                sum[1] += area / 3 * (double)value.g;
                sum[2] += area / 3 * (double)value.b;
            }
            sum[3] += area;
        }
    }
}

// Of sides with closed cells nothing: their value is the mean of a part that interpolation does not know.
static void findMissing(const Sharpening* s, const vplRgb* vertexValues)
{
    const vplPatchSides* sides = s->mesh->sides;
    memset(s->sums, 0, (size_t)sides->count * sizeof *s->sums);
    for (int t = 0; t < s->mesh->triangleCount; t++) {
        addTriangle(s, vertexValues, t);
    }
    for (int i = 0; i < sides->count; i++) {
        const double* sum = s->sums[i];
        const bool known = sum[3] > 0 && sides->sides[i].open == 0xffff;
        const vplRgb v = s->values[i];
        s->missing[i] =
            known ? (vplRgb){(float)((double)v.r - sum[0] / sum[3]), (float)((double)v.g - sum[1] / sum[3]),
                             (float)((double)v.b - sum[2] / sum[3])}
                  : (vplRgb){0, 0, 0};
    }
}

static float addClamped(float value, float change)
{
    return vplMaxf(value + change, 0);
}

vplResult vplPatchMesh_Sharpen(const vplPatchMesh* mesh, vplVertexWeight weight, const vplRgb* values,
                               int rounds, vplRgb* vertexValues)
{
    Sharpening s = {.mesh = mesh, .values = values};
    vplResult result = reserve(&s);
    for (int round = 0; round < rounds && result == VPL_SUCCESS; round++) {
        findMissing(&s, vertexValues);
        result = vplPatchMesh_Interpolate(mesh, weight, s.missing, s.change);
        for (size_t i = 0; i < 2 * (size_t)mesh->vertexCount && result == VPL_SUCCESS; i++) {
            vplRgb* v = &vertexValues[i];
            *v = (vplRgb){addClamped(v->r, s.change[i].r), addClamped(v->g, s.change[i].g),
                          addClamped(v->b, s.change[i].b)};
        }
    }
    release(&s);
    return result;
}
