// SPDX-License-Identifier: MIT
// Bounds the form factor of two nodes by their bounding volumes and cones of normals.
#include "math/scalar.h"
#include "math/vec.h"
#include "radiosity/links/link_pair.h"

#include <math.h>

// An upper bound of the cosine at `from` towards `to`; 1 where their spheres intersect.
static double cosineBound(const vplLinkNode* from, const vplLinkNode* to)
{
    const vplVec3 way = vplSub(to->centre, from->centre);
    const double distance = (double)vplLength(way), sum = (double)from->radius + (double)to->radius;
    if (distance <= sum) {
        return 1;
    }
    const double sinSize = sum / distance, cosSize = sqrt(1 - sinSize * sinSize);
    const double cosSpread = (double)from->cosSpread, sinSpread = (double)from->sinSpread;
    const double cosAll = cosSpread * cosSize - sinSpread * sinSize;
    const double sinAll = sinSpread * cosSize + cosSpread * sinSize;
    const double cosine = (double)vplDot(way, from->normal) / distance;
    if (sinAll <= 0 || cosine >= cosAll) {
        return 1;
    }
    const double sine = sqrt(cosine * cosine < 1 ? 1 - cosine * cosine : 0);
    const double bound = cosine * cosAll + sine * sinAll;
    return bound > 0 ? bound : 0;
}

// The squared distance of two bounding boxes, m^2; 0 where they intersect.
static double squareGap(const vplLinkNode* p, const vplLinkNode* q)
{
    double square = 0;
    for (int axis = 0; axis < 3; axis++) {
        const double after = (double)vplComponent(q->low, axis) - (double)vplComponent(p->high, axis);
        const double before = (double)vplComponent(p->low, axis) - (double)vplComponent(q->high, axis);
        const double gap = after > before ? after : before;
        square += gap > 0 ? gap * gap : 0;
    }
    return square;
}

bool vplNode_IsBehind(const vplJudgedPair* pair, const vplLinkNode* node, const vplLinkNode* plane)
{
    if (!plane->flat) {
        return false;
    }
    const vplVec3 n = vplFirstSide(pair, plane)->normal, from = vplFirstSide(pair, plane)->corners[0];
    float most = -INFINITY;
    if (node->count == 1 && !node->group) {
        for (int k = 0; k < 3; k++) {
            most = fmaxf(most, vplDot(n, vplSub(vplFirstSide(pair, node)->corners[k], from)));
        }
    } else {
        const vplVec3 corner = {n.x > 0 ? node->high.x : node->low.x, n.y > 0 ? node->high.y : node->low.y,
                                n.z > 0 ? node->high.z : node->low.z};
        most = vplDot(n, vplSub(corner, from));
    }
    const float largest = vplLargestOf(from);
    return most <= 0x1p-20f * (largest + node->radius + plane->radius);
}

double vplFactorBound(const vplJudgedPair* pair)
{
    const double p = cosineBound(pair->p, pair->q), q = cosineBound(pair->q, pair->p);
    const double square = squareGap(pair->p, pair->q);
    return p * q > 0 ? pair->sent * p * q / (VPL_PI * square) : 0;
}
