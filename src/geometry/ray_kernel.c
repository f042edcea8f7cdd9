// SPDX-License-Identifier: MIT
// Traversal of the hierarchy by single rays.
// Based on: Holger Dammertz, Johannes Hanika and Alexander Keller, Shallow Bounding Volume Hierarchies, EGSR
// 2008 (wide nodes).
#include "geometry/ray_tests.h"

// Lanes go in order, so among equal t within a block the lowest triangle stays; across blocks the ids are
// compared.
static inline void keepClosest(const Prepared* r, const vplTriangleBlock* block, vplRawHit* best)
{
    float t[WIDTH], b1[WIDTH], b2[WIDTH];
    for (uint32_t hits = testBlock(r, block, t, b1, b2); hits != 0; hits &= hits - 1) {
        const int i = __builtin_ctz(hits);
        const float at = clampToBox(r, block, i, t[i]);
        if (at < best->t || (at == best->t && best->triangle > block->id[i])) {
            best->t = at;
            best->b1 = b1[i];
            best->b2 = b2[i];
            best->triangle = block->id[i];
        }
    }
}

// The distance at which a child is entered and the child, in one number that sorts by distance. Distances are
// not negative, so their bits sort as they do.
typedef uint64_t Entry;

static inline Entry makeEntry(float t, int32_t child)
{
    uint32_t bits;
    memcpy(&bits, &t, sizeof bits);
    return (uint64_t)bits << 32 | (uint32_t)child;
}

static inline float distanceOf(Entry entry)
{
    const uint32_t bits = (uint32_t)(entry >> 32);
    float t;
    memcpy(&t, &bits, sizeof t);
    return t;
}

// Pushes the children that were hit, sorted by distance, except the nearest, which it returns. hits is not 0.
static inline Entry pushOthers(const vplBvhNode* node, uint32_t hits, const float entry[WIDTH], Entry* stack,
                               int* height)
{
    int i = __builtin_ctz(hits);
    Entry nearest = makeEntry(entry[i], node->child[i]);
    Entry *const base = stack + *height, *top = base;
    for (hits &= hits - 1; hits != 0; hits &= hits - 1) {
        i = __builtin_ctz(hits);
        const Entry next = makeEntry(entry[i], node->child[i]);
        const Entry other = next > nearest ? next : nearest;
        nearest = next > nearest ? nearest : next;
        Entry* at = top++;
        for (; at > base && at[-1] < other; at--) {
            *at = at[-1];
        }
        *at = other;
    }
    *height = (int)(top - stack);
    return nearest;
}

vplTraceClosestFcn VPL_KERNEL(vplTraceClosest);

void VPL_KERNEL(vplTraceClosest)(const vplBvh* bvh, const vplRay* ray, float tMax, vplRawHit* hitOut)
{
    const Prepared r = prepare(bvh, ray);
    vplRawHit best = {tMax, 0, 0, -1, 0};
    for (int i = 0; bvh->nodes == NULL && i < bvh->blockCount; i++, best.blocks++) {
        keepClosest(&r, &bvh->blocks[i], &best);
    }
    Entry stack[VPL_BVH_DEPTH * (WIDTH - 1) + 2];
    int height = 1;
    stack[0] = UINT64_MAX; // sentinel: further than all
    Entry top = 0;
    for (bool more = bvh->nodes != NULL; more;) {
        const int32_t child = (int32_t)(uint32_t)top;
        if (child < 0) {
            keepClosest(&r, &bvh->blocks[~child], &best);
            best.blocks++;
        } else {
            float entry[WIDTH];
            const vplBvhNode* node = &bvh->nodes[child];
            const uint32_t hits = testBoxes(&r, node, best.t, entry);
            if (hits != 0) {
                top = pushOthers(node, hits, entry, stack, &height);
                continue;
            }
        }
        do {
            more = height > 1;
            top = stack[more ? --height : 0];
        } while (more && distanceOf(top) > best.t);
    }
    *hitOut = best;
}

vplTraceAnyFcn VPL_KERNEL(vplTraceAny);

bool VPL_KERNEL(vplTraceAny)(const vplBvh* bvh, const vplRay* ray, float tMax)
{
    const Prepared r = prepare(bvh, ray);
    if (bvh->nodes != NULL) {
        return hasHitInTree(&r, bvh, 0, tMax);
    }
    for (int i = 0; i < bvh->blockCount; i++) {
        if (hasHitBelow(&r, &bvh->blocks[i], tMax)) {
            return true;
        }
    }
    return false;
}
