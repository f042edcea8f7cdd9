// SPDX-License-Identifier: MIT
#include "scene/model_look.h"

#include "math/double3.h"
#include "math/matrix.h"
#include "math/scalar.h"

static const double VIEW[3] = {-0.42, -0.38, -0.9}; // of any length
static const double MARGIN = 0.05;

void vplNormalize3(const double a[3], double out[3])
{
    const double length = sqrt(vplDot3(a, a));
    for (int k = 0; k < 3; k++) {
        out[k] = a[k] / length;
    }
}

void vplModelLook_Place(const vplModelLook* l, const double at[3], double out[3])
{
    for (int k = 0; k < 3; k++) {
        out[k] = l->centre[k] + (at[0] * l->right[k] + at[1] * l->up[k] + at[2] * l->ahead[k]);
    }
}

// gcc 12 for aarch64 fails to compile fmin and fmax in the loops below.
static double smaller(double a, double b)
{
    return a < b ? a : b;
}

static double larger(double a, double b)
{
    return a > b ? a : b;
}

// Called for all vertices of all objects.
typedef void VertexFcn(vplModelLook* l, const double inner[2], const double p[3]);

static void forVertices(const vplScene* scene, vplModelLook* l, const double inner[2], VertexFcn* call)
{
    for (int o = 0; o < scene->objectCount; o++) {
        const vplMeshDef* mesh = &scene->meshes[scene->objects[o].mesh];
        const vplAffine world = vplAffine_FromMat4(&scene->objects[o].transform);
        for (int i = 0; i < mesh->vertexCount; i++) {
            double at[3], p[3];
            vplToDouble3(mesh->positions[i], at);
            for (int k = 0; k < 3; k++) {
                p[k] = world.m[k][3] + vplDot3(world.m[k], at);
            }
            call(l, inner, p);
        }
    }
}

static void addToBounds(vplModelLook* l, const double inner[2], const double p[3])
{
    (void)inner;
    for (int k = 0; k < 3; k++) {
        l->low[k] = smaller(l->low[k], p[k]);
        l->high[k] = larger(l->high[k], p[k]);
    }
}

static void measure(vplModelLook* l, const vplScene* scene)
{
    double half[3];
    for (int k = 0; k < 3; k++) {
        l->low[k] = INFINITY;
        l->high[k] = -INFINITY;
    }
    forVertices(scene, l, NULL, addToBounds);
    for (int k = 0; k < 3; k++) {
        l->centre[k] = 0.5 * (l->low[k] + l->high[k]);
        half[k] = 0.5 * (l->high[k] - l->low[k]);
    }
    l->radius = sqrt(vplDot3(half, half));
}

vplModelField vplModelField_Find(double aspect)
{
    double sine, cosine;
    vplSinCos(VPL_MODEL_FIELD / 2, &sine, &cosine);
    const double upwards = sine / cosine, margin = 2 * MARGIN * upwards * fmin(aspect, 1);
    return (vplModelField){{aspect * upwards, upwards}, {aspect * upwards - margin, upwards - margin}};
}

// Finds the eye. A vertex at (x, z), z its depth, is left of the right edge of a picture of slope s, seen
// from (a, e), if x - a <= s (z - e), and right of the left edge if a - x <= s (z - e). Let A be the greatest
// x - s z of all vertices and B the greatest -x - s z. Then A <= a - s e and B <= -a - s e: their sum bounds
// e, and a = (A - B) / 2 serves every such e. The same holds upwards. The nearest eye has the greatest e
// within both bounds. A third bound keeps the eye away from a needle that points at it.
static void addToFit(vplModelLook* l, const double inner[2], const double p[3])
{
    double from[3];
    for (int k = 0; k < 3; k++) {
        from[k] = p[k] - l->centre[k];
    }
    const double depth = vplDot3(from, l->ahead), across[2] = {vplDot3(from, l->right), vplDot3(from, l->up)};
    for (int k = 0; k < 2; k++) {
        l->most[k][0] = larger(l->most[k][0], across[k] - inner[k] * depth);
        l->most[k][1] = larger(l->most[k][1], -across[k] - inner[k] * depth);
    }
    l->nearest = smaller(l->nearest, depth);
    l->farthest = larger(l->farthest, depth);
}

static void fit(vplModelLook* l, const vplScene* scene, const double inner[2])
{
    for (int k = 0; k < 4; k++) {
        l->most[k / 2][k % 2] = -INFINITY;
    }
    l->nearest = INFINITY;
    l->farthest = -INFINITY;
    forVertices(scene, l, inner, addToFit);
    l->eye[2] = l->nearest - 0.125 * l->radius;
    for (int k = 0; k < 2; k++) {
        l->eye[k] = 0.5 * (l->most[k][0] - l->most[k][1]);
        l->eye[2] = smaller(l->eye[2], -(l->most[k][0] + l->most[k][1]) / (2 * inner[k]));
    }
}

vplModelLook vplModelLook_Find(const vplScene* scene, const vplModelField* field)
{
    vplModelLook l;
    measure(&l, scene);
    vplNormalize3(VIEW, l.ahead);
    vplNormalize3((double[3]){-VIEW[2], 0, VIEW[0]}, l.right);
    vplCross3(l.right, l.ahead, l.up);
    fit(&l, scene, field->inner);
    // Bounds too small for the transform of a lamp are taken as a point, which no camera can look at.
    for (int k = 0; k < 3 && l.radius < 2e-15; k++) {
        l.eye[k] = 0;
    }
    return l;
}

vplModelGround vplModelGround_Find(const vplModelLook* l, const vplModelField* field)
{
    vplModelGround g;
    double eye[3];
    vplModelLook_Place(l, l->eye, eye);
    vplNormalize3((double[3]){l->ahead[0], 0, l->ahead[2]}, g.ahead);
    // The mesh may have a face at its bottom: the ground is lower by a little, also where floats are coarse.
    g.centre[1] = l->low[1] - fmax(1e-3 * l->radius, fabs(l->low[1]) * 0x1p-22);
    const double fall = -l->ahead[1], level = l->up[1], slope = field->slopes[1];
    g.nearest = (eye[1] - g.centre[1]) / (fall + slope * level);
    g.most = (eye[1] - g.centre[1]) / (fall - slope * level);
    const double start = l->eye[1] * fall + l->eye[2] * level; // of the eye, along g.ahead from the centre
    const double first = fmin(start + g.nearest * (level - slope * fall), -l->radius);
    const double last = fmax(start + g.most * (level + slope * fall), l->radius);
    g.halfLength = 0.5 * 1.05 * (last - first);
    g.halfWidth = 1.05 * fmax(g.most * field->slopes[0], fabs(l->eye[0]) + l->radius);
    for (int k = 0; k < 3; k += 2) {
        g.centre[k] = l->centre[k] + l->eye[0] * l->right[k] + 0.5 * (first + last) * g.ahead[k];
    }
    return g;
}
