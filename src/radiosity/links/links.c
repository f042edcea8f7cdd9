// SPDX-License-Identifier: MIT
// The hierarchy as its callers see it.
#include "radiosity/links/links.h"

#include <math.h>

enum { LINK_COOKIE = 0x56504cb4, MOST_SAMPLES = 1024 };

vplLinkDef vplDefaultLinkDef(void)
{
    return (vplLinkDef){.error = 0.00015, .samples = 4, .rowSums = VPL_ROW_SUMS_USUAL, .cookie = LINK_COOKIE};
}

static vplResult checkDef(const vplPatchSides* sides, const vplLinkDef* def)
{
    vplContext* context = sides->context;
    if (def->cookie != LINK_COOKIE) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplLinkDef was not made by vplDefaultLinkDef");
    }
    if (!(def->error > 0 && def->error <= 1)) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplLinkDef.error is %g, must be in (0, 1]",
                       def->error);
    }
    if (def->samples < 1 || def->samples > MOST_SAMPLES) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplLinkDef.samples is %d, must be in [1, %d]",
                       def->samples, (int)MOST_SAMPLES);
    }
    if ((int)def->rowSums < 0 || def->rowSums > VPL_ROW_SUMS_NORMALISE) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplLinkDef.rowSums is %d, must be a vplRowSums",
                       (int)def->rowSums);
    }
    return VPL_SUCCESS;
}

// Sorts links into the tree by receiver, with a counting sort. Each link becomes one per direction.
static vplResult sortLinks(vplArena* arena, struct vplLinkTree* tree, const vplLinkList* list)
{
    const size_t nodes = (size_t)tree->nodeCount;
    tree->firstOf = vplArena_AllocZero(arena, nodes + 2, sizeof *tree->firstOf);
    tree->ends = vplArena_Alloc(arena, 2 * list->count, sizeof *tree->ends);
    TRY(vplArena_Check(arena));
    int64_t* next = tree->firstOf + 2; // shifted by two: counts become starts, starts become ends
    for (size_t i = 0; i < list->count; i++) {
        next[list->links[i].p]++;
        next[list->links[i].q]++;
    }
    for (size_t i = 1; i < nodes; i++) {
        next[i] += next[i - 1];
    }
    next--;
    for (size_t i = 0; i < list->count; i++) {
        const vplLink* link = &list->links[i];
        for (int k = 0; k < 2; k++) {
            const int32_t receiver = k ? link->q : link->p, sender = k ? link->p : link->q;
            const float *here = k ? link->fit.q : link->fit.p, *there = k ? link->fit.p : link->fit.q;
            const float area =
                tree->nodes[sender].area / fmaxf(tree->nodes[sender].area, tree->nodes[receiver].area);
            vplLinkEnd* end = &tree->ends[next[receiver]++];
            *end = (vplLinkEnd){.sender = sender, .factor = area * link->fit.mean};
            for (int axis = 0; axis < 3; axis++) {
                end->receiverSlope[axis] = area * here[axis];
                end->senderSlope[axis] = area * there[axis];
            }
        }
    }
    return VPL_SUCCESS;
}

static vplResult findLinks(const vplPatchSides* sides, const vplLinkDef* def, vplLinks* links)
{
    vplLinkList list = {.links = NULL};
    vplResult result = vplFindLinks(sides, links->tree, def, &list);
    if (result == VPL_SUCCESS) {
        result = sortLinks(links->arena, links->tree, &list);
    }
    links->linkCount = (int64_t)list.count;
    links->rays = list.rays;
    vplFree(links->context, list.links);
    return result;
}

static vplResult build(const vplPatchSides* sides, const vplLinkDef* def, vplLinks* links)
{
    links->tree = vplArena_AllocZero(links->arena, 1, sizeof *links->tree);
    float* rowSums = vplArena_Alloc(links->arena, (size_t)sides->count, sizeof *rowSums);
    TRY(vplArena_Check(links->arena));
    TRY(vplLinkTree_Build(links->arena, sides, links->tree));
    TRY(findLinks(sides, def, links));
    links->groupCount = links->tree->nodeCount - sides->count;
    links->rowSums = rowSums;
    return vplLinks_FitRows(links, sides, def, rowSums);
}

vplResult vplLinks_Create(const vplPatchSides* sides, const vplLinkDef* def, vplLinks** linksOut)
{
    REQUIRE(CONTEXT_OF(sides), sides, def, linksOut);
    TRY(checkDef(sides, def));
    vplArena* arena = vplArena_Create(sides->context);
    vplLinks* links = vplArena_AllocZero(arena, 1, sizeof *links);
    vplResult result = vplArena_Check(arena);
    if (result == VPL_SUCCESS) {
        *links = (vplLinks){.sideCount = sides->count, .arena = arena, .context = sides->context};
        result = build(sides, def, links);
    }
    return vplArena_Deliver(arena, result, links, linksOut);
}

void vplLinks_Destroy(vplLinks* links)
{
    vplArena_Destroy(links != NULL ? links->arena : NULL);
}
