// SPDX-License-Identifier: MIT
// A bounding volume hierarchy with eight children per node over blocks of up to eight triangles. Also the
// arrays of blocks alone, for scenes so small that testing all of them is faster.
#ifndef VPL_GEOMETRY_BVH_H
#define VPL_GEOMETRY_BVH_H

#include <vpl/geometry.h>

enum {
    VPL_BVH_WIDTH = 8,  // children of a node, and triangles of a block
    VPL_BVH_DEPTH = 64, // deepest tree; the builder splits in halves before it gets there
    // Up to this many blocks all are tested. Rays a second, tree against all (tests/bench/rays on parts of the
    // room): 1 block 0.5 to 1.0, 2 blocks 0.8 to 0.9, 3 blocks 0.95 to 1.0, 5 blocks 1.1 to 1.3.
    VPL_BRUTE_BLOCKS = 4,
    // Up to this many, counted rays test every object, as the documents do whose counts they are compared with.
    VPL_COUNTED_BLOCKS = 8
};

// The box that stands for a triangle. It is wider than the corners by what the triangle test may err, about
// two units in the last place of coordinates and of differences between them.
static inline void vplBoundTriangle(const float p[3][3], float low[3], float high[3])
{
    float extent = 0, largest = 0;
    for (int axis = 0; axis < 3; axis++) {
        float a = p[0][axis], b = p[1][axis], c = p[2][axis];
        float least = a < b ? a : b, most = a > b ? a : b;
        low[axis] = least < c ? least : c;
        high[axis] = most > c ? most : c;
        float size = high[axis] - low[axis];
        extent = extent > size ? extent : size;
        float magnitude = -low[axis] > high[axis] ? -low[axis] : high[axis];
        largest = largest > magnitude ? largest : magnitude;
    }
    const float pad = extent * 0x1p-20f + largest * 0x1p-22f;
    for (int axis = 0; axis < 3; axis++) {
        low[axis] -= pad;
        high[axis] += pad;
    }
}

typedef struct vplBvhNode {
    float planes[6][VPL_BVH_WIDTH]; // low x, y, z, high x, y, z; unused children: low above high
    int32_t child[VPL_BVH_WIDTH];   // >= 0: a node; else ~block
    int32_t count;                  // of children; they come first
} __attribute__((aligned(64))) vplBvhNode;

// Triangles side by side, so that one instruction tests all of them. Unused lanes have id -1.
typedef struct vplTriangleBlock {
    float p[3][3][VPL_BVH_WIDTH]; // [corner][axis]
    int32_t id[VPL_BVH_WIDTH];    // ascending
} vplTriangleBlock;

typedef struct vplBvh {
    vplBvhNode* nodes; // the root first; NULL: test all blocks
    vplTriangleBlock* blocks;
    int nodeCount, blockCount;
} vplBvh;

// Builds over all triangles of positive area; without nodes up to `bruteBlocks` blocks (VPL_BRUTE_BLOCKS is
// what pays). `alone`: on the calling thread only.
vplResult vplBvh_Create(const vplGeometry* geometry, int bruteBlocks, bool alone, vplBvh** bvhOut);
// A triangle without area never is.
static inline bool vplCanBeHit(const vplGeometry* g, int triangle)
{
    const vplVec3 n = g->normals[triangle];
    return n.x != 0 || n.y != 0 || n.z != 0;
}

// Of 1 to 8 triangles, ascending.
void vplTriangleBlock_Fill(vplTriangleBlock* block, const vplGeometry* geometry, const int32_t* ids,
                           int count);

void vplBvh_Destroy(vplContext* context, vplBvh* bvh);

// What a traversal found: t is the limit if nothing was.
typedef struct vplRawHit {
    float t;
    float b1, b2; // weights of corners 1 and 2
    int triangle; // -1: none
    int blocks;   // tested on the way
} vplRawHit;

// The closest hit with t in (0, tMax); among equal t the lowest triangle.
typedef void vplTraceClosestFcn(const vplBvh* bvh, const vplRay* ray, float tMax, vplRawHit* hitOut);

// Whether there is any.
typedef bool vplTraceAnyFcn(const vplBvh* bvh, const vplRay* ray, float tMax);

// Up to sixteen rays with something in common, such as the light they are cast to.
enum { VPL_RAY_PACKET = 16 };

typedef struct vplRayPacket {
    float origin[3][VPL_RAY_PACKET], direction[3][VPL_RAY_PACKET];
    int32_t skipFirst[VPL_RAY_PACKET], skipCount[VPL_RAY_PACKET];
    uint32_t active; // bit i: ray i is there
} vplRayPacket;

static inline void vplRayPacket_Set(vplRayPacket* packet, int lane, const vplRay* ray)
{
    packet->origin[0][lane] = ray->origin.x;
    packet->origin[1][lane] = ray->origin.y;
    packet->origin[2][lane] = ray->origin.z;
    packet->direction[0][lane] = ray->direction.x;
    packet->direction[1][lane] = ray->direction.y;
    packet->direction[2][lane] = ray->direction.z;
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

// Bit i of the result: what vplTraceAnyFcn says about ray i.
typedef uint32_t vplTraceAnyPacketFcn(const vplBvh* bvh, const vplRayPacket* rays, float tMax);

vplTraceAnyPacketFcn* vplGetTraceAnyPacket(vplIsa isa);
vplTraceClosestFcn* vplGetTraceClosest(vplIsa isa);
vplTraceAnyFcn* vplGetTraceAny(vplIsa isa);

// vplGeometry_ClosestHit that also adds to *tests (may be NULL): objects where all are tested, else blocks.
bool vplClosestHit(const vplGeometry* geometry, const vplRay* ray, vplHit* hitOut, int* tests);

// vplGeometry_ClosestHit of what is nearer than tMax, in units of the direction.
bool vplClosestHitWithin(const vplGeometry* geometry, const vplRay* ray, float tMax, vplHit* hitOut);

// vplGeometry_IsOccluded for each ray of a packet: bit i of the result is ray i.
uint32_t vplGeometry_AreOccluded(const vplGeometry* geometry, const vplRayPacket* rays, float tMax);

// Sets to 0 what comes along the packet's rays where one meets something before tMax. Returns how many rays it cast.
static inline int vplGeometry_Darken(const vplGeometry* geometry, const vplRayPacket* rays, float tMax,
                                     float amount[VPL_RAY_PACKET])
{
    if (rays->active == 0) {
        return 0;
    }
    for (uint32_t dark = vplGeometry_AreOccluded(geometry, rays, tMax); dark != 0; dark &= dark - 1) {
        amount[__builtin_ctz(dark)] = 0;
    }
    return __builtin_popcount(rays->active);
}

#endif
