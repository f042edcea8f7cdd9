// SPDX-License-Identifier: MIT
// The kernels of src/radiosity and the data that they work on. Files named *_kernel.c define them, once per
// instruction set; all instruction sets give the same bits.
#ifndef VPL_RADIOSITY_KERNELS_H
#define VPL_RADIOSITY_KERNELS_H

#include "base/isa.h"
#include "geometry/bvh.h"
#include "math/vec.h"

#include <vpl/radiosity.h>

// A kernel handles this many sides at a time: as many as a packet has rays.
enum { VPL_SIDE_LANES = VPL_RAY_PACKET };

static inline void vplSetLane(float to[3][VPL_SIDE_LANES], int lane, vplVec3 v)
{
    to[0][lane] = v.x;
    to[1][lane] = v.y;
    to[2][lane] = v.z;
}

static inline vplVec3 vplGetLane(const float from[3][VPL_SIDE_LANES], int lane)
{
    return vplVec(from[0][lane], from[1][lane], from[2][lane]);
}

// One value per side, channel by channel. Padded with zeros to a multiple of VPL_SIDE_LANES.
typedef struct vplPlanes {
    float* c[3];
} vplPlanes;

// ---- form factors (factors/factors_kernel.c)

enum { VPL_FACTOR_SAMPLES = 16, VPL_QUADRATURE_POINTS = 3 };

// Sample points of sixteen sides, and the origins of rays from them. Any four consecutive samples,
// cyclically, lie in different quarters of the side.
typedef struct vplFactorSamples {
    float at[VPL_FACTOR_SAMPLES][3][VPL_SIDE_LANES];
    float origin[VPL_FACTOR_SAMPLES][3][VPL_SIDE_LANES];
    // Of the triangle at the sample, which differ in a group.
    float normal[VPL_FACTOR_SAMPLES][3][VPL_SIDE_LANES];
    int32_t skipFirst[VPL_FACTOR_SAMPLES][VPL_SIDE_LANES], skipCount[VPL_FACTOR_SAMPLES][VPL_SIDE_LANES];
} vplFactorSamples;

// Sixteen sides. Unused lanes have the normal 0 and exchange nothing.
typedef struct vplFactorBlock {
    float corner[3][3][VPL_SIDE_LANES]; // [corner][axis]
    float normal[3][VPL_SIDE_LANES];
    float quadrature[VPL_QUADRATURE_POINTS][3][VPL_SIDE_LANES]; // points that stand for the open cells
    float centre[3][VPL_SIDE_LANES];                            // of the corners
    float radius2[VPL_SIDE_LANES]; // squared distance to the farthest corner, m^2
    float area[VPL_SIDE_LANES];    // 0: unused lane
    float low[3], high[3];         // bounds of all corners
    uint32_t groups;               // bit l: side l is one of a group of triangles, whose samples alone count
    vplFactorSamples samples;
} vplFactorBlock;

// The exchange of side `lane` of one block with the sixteen of another, estimated without rays.
typedef struct vplFactorEstimate {
    uint32_t facing;            // bit l: part of each side lies in front of the other's plane
    uint32_t near;              // bit l: too near for quadrature
    float mean[VPL_SIDE_LANES]; // of cos cos / (pi r^2) over all pairs of quadrature points, 1/m^2
} vplFactorEstimate;

// Sides face each other if a corner of each is more than `tolerance` metres in front of the other's plane.
// They are near if their centres are less than sqrt(near2) times the larger radius apart.
typedef void vplEstimateFactorsFcn(const vplFactorBlock* a, int lane, const vplFactorBlock* b,
                                   float tolerance, float near2, vplFactorEstimate* estimateOut);

// cos cos / (pi r^2) from one point to sixteen, 1/m^2, and ray directions that end just in front of them.
typedef void vplPointTermsFcn(const float point[3], const float normal[3], const float to[3][VPL_SIDE_LANES],
                              const float toNormal[3][VPL_SIDE_LANES], float termOut[VPL_SIDE_LANES],
                              float directionOut[3][VPL_SIDE_LANES]);

// The sum of row[j] scale[j].
typedef double vplScaledSumFcn(const float* row, const double* scale, int count);

// row[j] *= rowScale scale[j].
typedef void vplScaleRowFcn(float* row, double rowScale, const double* scale, int count);

// ---- links (links/links_kernel.c)

// Each node of the hierarchy has so many points, by which all its pairs are judged.
enum { VPL_LINK_POINTS = 8 };

// The points of a node, and the least-squares fit of a linear function to values at them: the function is the
// sum of weight times value at the node's middle, and rises by the sum of slope times value per radius of the
// node along each axis.
typedef struct vplLinkPoints {
    float at[3][VPL_LINK_POINTS], normal[3][VPL_LINK_POINTS]; // [axis]
    float place[3][VPL_LINK_POINTS];                          // from the node's middle, in radii
    float weight[VPL_LINK_POINTS], slope[3][VPL_LINK_POINTS];
    float origin[3][VPL_LINK_POINTS]; // of rays from there
    int skipFirst[VPL_LINK_POINTS], skipCount[VPL_LINK_POINTS];
} vplLinkPoints;

// cos cos / (pi r^2) between point i of p and point k of q, 1/m^2; 0 where one point is behind the other's
// surface.
typedef struct vplLinkTerms {
    float of[VPL_LINK_POINTS][VPL_LINK_POINTS];
    float rows[VPL_LINK_POINTS];    // at points of p, the fit over q at q's middle
    float columns[VPL_LINK_POINTS]; // at points of q, the fit over p at p's middle
} vplLinkTerms;

typedef void vplLinkTermsFcn(const vplLinkPoints* p, const vplLinkPoints* q, vplLinkTerms* termsOut);

// ---- solvers (solve/solve_kernel.c)

// The sums of row[j] planes[c][j].
typedef void vplRowDotFcn(const float* row, const vplPlanes* planes, int count, double sumOut[3]);

// One shot of progressive refinement.
typedef struct vplShot {
    const float* row; // form factors from the side that shoots
    float power[3];   // W, of that side
    vplPlanes gain;   // reflectance / area, 1/m^2
    vplPlanes unshot;
    const float* area;
} vplShot;

// Distributes the shot. Returns the side whose unshot power, the sum of the channels' magnitudes, is now the
// largest: the first of equal ones, -1 where none has any.
typedef int vplShootFcn(const vplShot* shot, int count);

// ---- drawing (draw/draw_patches_kernel.c)

// One of the two faces of all triangles of a mesh.
typedef struct vplPatchFace {
    const vplPatchDraw* draw;
    const float (*clip)[4];
    int face;             // 0: fronts, 1: backs
    double width, height; // of the picture, pixels
} vplPatchFace;

typedef vplFragmentFcn vplShadePatchFcn;
typedef vplTileFcn vplAddPatchTileFcn;

// ---- the table

// X(type, field, function)
#define VPL_RADIOSITY_KERNELS(X)                                                                             \
    X(vplEstimateFactorsFcn, estimateFactors, vplEstimateFactors)                                            \
    X(vplPointTermsFcn, pointTerms, vplPointTerms)                                                           \
    X(vplLinkTermsFcn, linkTerms, vplLinkTerms_Find)                                                         \
    X(vplScaledSumFcn, scaledSum, vplScaledSum)                                                              \
    X(vplScaleRowFcn, scaleRow, vplScaleRow)                                                                 \
    X(vplRowDotFcn, rowDot, vplRowDot)                                                                       \
    X(vplShootFcn, shoot, vplShoot)                                                                          \
    X(vplShadePatchFcn, shadePatch, vplShadePatch)                                                           \
    X(vplAddPatchTileFcn, addPatchTile, vplAddPatchTile)

typedef struct vplRadiosityKernels {
    VPL_RADIOSITY_KERNELS(VPL_KERNEL_FIELD)
} vplRadiosityKernels;

const vplRadiosityKernels* vplGetRadiosityKernels(vplIsa isa);

#ifdef VPL_KERNEL_ISA
VPL_RADIOSITY_KERNELS(VPL_KERNEL_PROTOTYPE)
#endif

#endif
