// SPDX-License-Identifier: MIT
// The ray tree: a bounding volume hierarchy with eight children per node over blocks of up to eight
// triangles, or the blocks alone in scenes so small that testing all of them is faster. Also the ray queries
// of the other folders.
#ifndef VPL_GEOMETRY_BVH_H
#define VPL_GEOMETRY_BVH_H

#include "geometry/box.h"
#include "math/vec.h"

#include <vpl/geometry.h>

#include "base/isa.h"

enum {
    VPL_BVH_WIDTH = 8,  // children of a node, and triangles of a block
    VPL_BVH_DEPTH = 64, // deepest tree; the builder halves ranges before it gets there
    // Up to this many blocks there are no nodes, and rays test every block (bench/rays: the tree is 1.1x to
    // 1.3x as fast at 5 blocks, 0.95x to 1.0x at 3).
    VPL_BRUTE_BLOCKS = 4,
    // Up to this many blocks, counted rays test every object, so that counts agree with the documents'.
    VPL_COUNTED_BLOCKS = 8
};

typedef struct vplBvhNode {
    float planes[6][VPL_BVH_WIDTH]; // low x, y, z, high x, y, z; unused children: low above high
    int32_t child[VPL_BVH_WIDTH];   // >= 0: a node; else ~block
    int32_t count;                  // of children; they come first
} __attribute__((aligned(64))) vplBvhNode;

static inline void vplBvhNode_SetBox(vplBvhNode* node, int child, vplBox box)
{
    for (int axis = 0; axis < 3; axis++) {
        node->planes[axis][child] = box.low[axis];
        node->planes[axis + 3][child] = box.high[axis];
    }
}

// Triangles in structure-of-arrays form, tested together. Unused lanes have id -1.
typedef struct vplTriangleBlock {
    float p[3][3][VPL_BVH_WIDTH]; // [corner][axis]
    int32_t id[VPL_BVH_WIDTH];    // ascending
} vplTriangleBlock;

// Lanes that rays test differently, which are few; bit i is lane i.
typedef struct vplBlockMarks {
    uint8_t byFormula; // not at all: the object is among vplGeometry.formulaObjects
    uint8_t extreme;   // in double: the longest edge is above 2^18 m or below 2^-38 m
} vplBlockMarks;

typedef struct vplBvh {
    vplBvhNode* nodes; // the root first; NULL: test all blocks
    vplTriangleBlock* blocks;
    vplBlockMarks* marks; // per block; NULL: none has any
    int nodeCount, blockCount;
    double cost;            // of a ray, relative, when it was built
    bool quick;             // it was built from groups of triangles
    struct vplArena* arena; // owns the arrays
} vplBvh;

// Builds the tree over all triangles of positive area, with all workers: the same tree for any number of
// them. Up to `bruteBlocks` blocks (usually VPL_BRUTE_BLOCKS) it has no nodes. A quick tree is built in 0.4 of the time,
// from groups of triangles; rays have the same hits and take 0.85 to 1.6 times as long (bench/rays).
vplResult vplBvh_Create(const vplGeometry* geometry, int bruteBlocks, bool quick, vplBvh** bvhOut);
void vplBvh_Destroy(vplBvh* bvh);

// Updates the triangles of moved objects and the boxes around them; changes[i] has VPL_OBJECT_MOVED if object i was moved.
// Triangles stay in their blocks. Returns false if the tree must be built anew instead: other triangles can be hit than
// before, or rays would cost more than 1.2 times what they cost when it was built. All workers.
bool vplBvh_Refit(vplBvh* bvh, const vplGeometry* geometry, const uint8_t* changes);

// The expected cost of a ray, by the surface area heuristic: sums the surfaces of the boxes of nodes and blocks, in square
// metres.
double vplBvh_Cost(const vplBvh* bvh);

// Builds the ray tree unless the geometry has one; `quick`: as for vplBvh_Create.
vplResult vplGeometry_BuildTree(vplGeometry* geometry, bool quick);

// The box of three corners, padded as vplBoundTriangle says.
vplBox vplBoundCorners(const vplVec3 corners[3]);

// The box of a triangle, and its area in high[3].
vplBox vplBoundItem(const vplGeometry* geometry, int triangle);

// True for a triangle with an area; rays never hit one that has none.
static inline bool vplCanBeHit(const vplGeometry* g, int triangle)
{
    const vplVec3 n = g->normals[triangle];
    return n.x != 0 || n.y != 0 || n.z != 0;
}

// Fills a block with 1 to 8 triangles, ids ascending. Returns its marks.
vplBlockMarks vplTriangleBlock_Fill(vplTriangleBlock* block, const vplGeometry* geometry, const int32_t* ids,
                                    int count);

// ---- ray packets

// Up to sixteen rays with something in common, such as the light they are cast to.
enum { VPL_RAY_PACKET = 16 };

typedef struct vplRayPacket {
    float origin[3][VPL_RAY_PACKET], direction[3][VPL_RAY_PACKET];
    int32_t skipFirst[VPL_RAY_PACKET], skipCount[VPL_RAY_PACKET];
    uint32_t active; // bit i: lane i holds a ray
} vplRayPacket;

static inline void vplRayPacket_Set(vplRayPacket* packet, int lane, const vplRay* ray)
{
    for (int axis = 0; axis < 3; axis++) {
        packet->origin[axis][lane] = vplComponent(ray->origin, axis);
        packet->direction[axis][lane] = vplComponent(ray->direction, axis);
    }
    packet->skipFirst[lane] = ray->skip.first;
    packet->skipCount[lane] = ray->skip.count;
    packet->active |= 1u << lane;
}

static inline vplRay vplRayPacket_Get(const vplRayPacket* packet, int lane)
{
    return (vplRay){{packet->origin[0][lane], packet->origin[1][lane], packet->origin[2][lane]},
                    {packet->direction[0][lane], packet->direction[1][lane], packet->direction[2][lane]},
                    {packet->skipFirst[lane], packet->skipCount[lane]}};
}

// ---- kernels: traversal, compiled once per instruction set

// t is the limit where nothing was hit.
typedef struct vplRawHit {
    float t;
    float b1, b2; // barycentrics of corners 1 and 2
    int triangle; // -1: none
    int blocks;   // how many were tested
} vplRawHit;

// The closest hit with t in (0, tMax); among equal t the lowest triangle.
typedef void vplTraceClosestFcn(const vplBvh* bvh, const vplRay* ray, float tMax, vplRawHit* hitOut);

// True if there is any hit with t in (0, tMax).
typedef bool vplTraceAnyFcn(const vplBvh* bvh, const vplRay* ray, float tMax);

// The same for a packet: bit i of the result is ray i.
typedef uint32_t vplTraceAnyPacketFcn(const vplBvh* bvh, const vplRayPacket* rays, float tMax);

// All kernels of this folder: X(type, field, function).
#define VPL_RAY_KERNELS(X)                                                                                   \
    X(vplTraceClosestFcn, closest, vplTraceClosest)                                                          \
    X(vplTraceAnyFcn, any, vplTraceAny)                                                                      \
    X(vplTraceAnyPacketFcn, anyPacket, vplTraceAnyPacket)

typedef struct vplRayKernels {
    VPL_RAY_KERNELS(VPL_KERNEL_FIELD)
} vplRayKernels;

const vplRayKernels* vplGetRayKernels(vplIsa isa);

// ---- queries; without a ray tree they test every triangle

// Finds the closest hit nearer than tMax, in units of the direction. Adds to *tests, which may be NULL, the
// number of objects where all are tested, otherwise the number of blocks that were tested.
bool vplClosestHit(const vplGeometry* geometry, const vplRay* ray, float tMax, int* tests, vplHit* hitOut);

// vplGeometry_IsOccluded by testing every triangle, also where there is a tree.
bool vplAnyOfTriangles(const vplGeometry* geometry, const vplRay* ray, float tMax);

// vplGeometry_IsOccluded for each ray of a packet: bit i of the result is ray i.
uint32_t vplGeometry_AreOccluded(const vplGeometry* geometry, const vplRayPacket* rays, float tMax);

// The same for solid triangles only.
uint32_t vplSolid_AreOccluded(const vplGeometry* geometry, const vplRayPacket* rays, float tMax);

// Multiplies amount[i] by the share of light that ray i brings: 0 where it is occluded before tMax, else 1 or what
// cut-outs let through. Returns the number of rays.
int vplGeometry_Darken(const vplGeometry* geometry, const vplRayPacket* rays, float tMax,
                       float amount[VPL_RAY_PACKET]);

#endif
