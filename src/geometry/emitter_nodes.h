// SPDX-License-Identifier: MIT
// The nodes of an emitter tree and one step down the tree: the arithmetic of single points and of kernels that choose for
// sixteen points side by side. Loops over points vectorise, because nothing branches there.
// Based on: see emitter_tree.c.
#ifndef VPL_GEOMETRY_EMITTER_NODES_H
#define VPL_GEOMETRY_EMITTER_NODES_H

#include "geometry/emitter_tree.h"

#include <float.h>
#include <math.h>

// Bounds of cosines are wider by this, because the directions of sources and normals are rounded.
#define VPL_CONE_MARGIN 1e-6

// A subtree of n sources has 2n - 1 consecutive nodes: its root, the nodes of its left half, those of its right half.
typedef struct vplEmitterNode {
    float centre[3], radius; // of a sphere around the box
    float axis[3];
    float cosSpread, sinSpread, cosReach;
    double strength;
    int left; // sources in the left half; 0: one source
} vplEmitterNode;

struct vplEmitterTree {
    vplEmitterNode* nodes;
    int* sources;   // in the order of leaves
    int* positions; // in that order, of source first + i; without meaning where it is not in the tree
    int first, end, count;
    bool cones; // whether some source sends light in some directions only
};

#define VPL_STEP static inline __attribute__((always_inline))

// An angle of up to half a turn.
typedef struct vplAngle {
    double cosine, sine;
} vplAngle;

// max(a - b, 0), where the angle b has this cosine and sine.
VPL_STEP vplAngle vplAngle_Subtract(vplAngle a, double cosine, double sine)
{
    const bool none = a.cosine > cosine;
    return (vplAngle){none ? 1 : a.cosine * cosine + a.sine * sine,
                      none ? 0 : a.sine * cosine - a.cosine * sine};
}

VPL_STEP vplAngle vplAngle_Of(double cosine)
{
    const double square = 1 - cosine * cosine;
    return (vplAngle){cosine, sqrt(square > 0 ? square : 0)};
}

// A mean of two cosines of an angle: the largest in a node, which keeps its sources, and that of its centre, which tells
// halves apart. Variance is 0.3 to 0.7 of that with the largest alone (halls with 100 and 1,000 lamps).
VPL_STEP double vplBlendCosines(double largest, double middle)
{
    return 0.125 * largest + 0.875 * (middle > 0 ? middle : 0);
}

// The factor of emission towards the point: about the cosine of the angle between the axis of a source and the way to the point. 1 where sources
// emit in all directions, 0 if no source of the node emits towards the point. `off`: the cosine of that angle for the node's axis and centre;
// cosBox, sinBox: of half the angle that the node's sphere covers, seen from the point.
VPL_STEP double vplEmitterNode_Sent(const vplEmitterNode* node, double off, double cosBox, double sinBox)
{
    const double reach = node->cosReach;
    const vplAngle beyond =
        vplAngle_Subtract(vplAngle_Of(off), (double)node->cosSpread, (double)node->sinSpread);
    const double least = vplAngle_Subtract(beyond, cosBox, sinBox).cosine;
    const double sent = vplBlendCosines(least > 0 ? least + VPL_CONE_MARGIN : VPL_CONE_MARGIN,
                                        beyond.cosine > reach ? beyond.cosine : 0);
    return node->cosSpread <= -1 ? 1 : least <= reach - VPL_CONE_MARGIN ? 0 : sent;
}

// About the strength that reaches the point, over the squared distance; 0 only where no source of the node lights it.
// Inside of the sphere nothing is known of directions. `cones`: whether some sources send light in some directions only; `branches`: whether
// to return early, which loops over points cannot.
VPL_STEP double vplEmitterNode_Importance(const vplEmitterNode* node, vplVec3 p, vplVec3 n, bool cones,
                                          bool branches)
{
    const double x = (double)node->centre[0] - p.x, y = (double)node->centre[1] - p.y,
                 z = (double)node->centre[2] - p.z;
    const double d2 = x * x + y * y + z * z, r2 = (double)node->radius * node->radius;
    const double inside = r2 > 0 ? node->strength / r2 : 0;
    const double inverse = 1 / sqrt(d2), sinBox = node->radius * inverse;
    const double cosBox = sqrt(1 - sinBox * sinBox), facing = (n.x * x + n.y * y + n.z * z) * inverse;
    const double received = vplAngle_Subtract(vplAngle_Of(facing), cosBox, sinBox).cosine + VPL_CONE_MARGIN;
    if (branches && (d2 <= r2 || received <= 0)) {
        return d2 <= r2 ? inside : 0;
    }
    double sent = 1;
    if (cones) {
        const double off = -(node->axis[0] * x + node->axis[1] * y + node->axis[2] * z) * inverse;
        sent = vplEmitterNode_Sent(node, off, cosBox, sinBox);
    }
    const double outside = node->strength * vplBlendCosines(received, facing) * sent / d2;
    return d2 <= r2 ? inside : received <= 0 ? 0 : outside;
}

// The probability of the left half; negative if neither half lights the point.
VPL_STEP double vplEmitterTree_LeftShare(const vplEmitterTree* t, int leftNode, int rightNode,
                                         vplVec3 position, vplVec3 normal, bool cones, bool branches)
{
    const vplEmitterNode *l = &t->nodes[leftNode], *r = &t->nodes[rightNode];
    const double left = vplEmitterNode_Importance(l, position, normal, cones, branches),
                 right = vplEmitterNode_Importance(r, position, normal, cones, branches);
    return left + right > 0 ? left / (left + right) : -1;
}

// The way of a choice down the tree.
typedef struct vplDescent {
    double probability, rest; // of the choices so far; a random number again
    int node, first;          // the node, and the first of its sources in the order of leaves
    bool ended;               // no source of the node lights the point
} vplDescent;

VPL_STEP vplDescent vplDescent_Start(double choice)
{
    return (vplDescent){.probability = 1, .rest = choice};
}

// Goes to one of the halves of a node, of which the left one has `left` sources, by the share of that half.
VPL_STEP vplDescent vplDescent_Step(vplDescent d, int left, double share)
{
    const bool goesLeft = d.rest < share;
    const double chosen = goesLeft ? share : 1 - share, rest = (goesLeft ? d.rest : d.rest - share) / chosen;
    if (share < 0) {
        d.ended = true;
        return d;
    }
    d.probability *= chosen;
    d.rest = rest < 1 ? rest : 1 - DBL_EPSILON;
    d.node += goesLeft ? 1 : 2 * left;
    d.first += goesLeft ? 0 : left;
    return d;
}

#endif
