// SPDX-License-Identifier: MIT
// The double integral of the logarithm of the distance along two straight edges, of which form factors are sums.
#ifndef VPL_RADIOSITY_EDGE_INTEGRAL_H
#define VPL_RADIOSITY_EDGE_INTEGRAL_H

// Gauss-Legendre on [-1, 1]: the positive half of the nodes, of an even number of them.
typedef struct vplGaussRule {
    int pairs;
    double x[5], w[5];
} vplGaussRule;

extern const vplGaussRule vplGauss4, vplGauss6, vplGauss10;

// How well the outer of the two integrals is done: its edge is bisected until nothing singular is nearer to a part's
// middle than `apart` halves of the part, in the complex plane, or the part is `least` of the edge.
typedef struct vplEdgeRule {
    const vplGaussRule* gauss;
    double apart, least;
} vplEdgeRule;

typedef struct vplEdge {
    double from[3], along[3]; // unit vector
    double length;            // > 0
} vplEdge;

// Of ln r times the cosine between the edges. Coordinates of about 1; edges may touch, cross and coincide.
double vplEdgeIntegral(const vplEdge* outer, const vplEdge* inner, const vplEdgeRule* rule);

#endif
