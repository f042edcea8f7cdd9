// SPDX-License-Identifier: MIT
// The hierarchy: what its caller sees.
#include "radiosity/links.h"

#include "base/context.h"

#include <string.h>

enum { LINK_COOKIE = 0x56504cb4, MOST_SAMPLES = VPL_LINK_POINTS * VPL_LINK_POINTS };

vplLinkDef vplDefaultLinkDef(void)
{
    return (vplLinkDef){.error = 0.002, .samples = 4, .rowSums = VPL_ROW_SUMS_USUAL, .cookie = LINK_COOKIE};
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

static vplResult findLinks(const vplPatchSides* sides, const vplLinkDef* def, vplLinks* links)
{
    vplLinkList list = {.links = NULL};
    vplResult result = vplFindLinks(sides, links->tree, def, &list);
    if (result == VPL_SUCCESS) {
        result = vplLinkTree_Connect(links->context, links->tree, &list);
    }
    links->linkCount = (int64_t)list.count;
    links->rays = list.rays;
    vplFree(links->context, list.links);
    return result;
}

static vplResult fitRows(const vplPatchSides* sides, const vplLinkDef* def, vplLinks* links)
{
    vplContext* context = links->context;
    const size_t count = (size_t)sides->count;
    bool* closed = vplAlloc(context, count, sizeof *closed);
    links->tree->scale = closed ? vplAlloc(context, count, sizeof *links->tree->scale) : NULL;
    links->rowSums = links->tree->scale ? vplAlloc(context, count, sizeof *links->rowSums) : NULL;
    vplResult result = links->rowSums ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
    for (size_t i = 0; i < count && result == VPL_SUCCESS; i++) {
        closed[i] = def->rowSums == VPL_ROW_SUMS_NORMALISE;
    }
    if (result == VPL_SUCCESS && def->rowSums == VPL_ROW_SUMS_USUAL) {
        result = vplFindClosed(sides, def, closed, &links->rays);
    }
    if (result == VPL_SUCCESS) {
        result = vplLinks_FitRows(links, def->rowSums, closed, (float*)links->rowSums);
    }
    vplFree(context, closed);
    return result;
}

static vplResult build(const vplPatchSides* sides, const vplLinkDef* def, vplLinks* links)
{
    vplResult result = vplLinkTree_Build(sides, links->tree);
    if (result == VPL_SUCCESS) {
        result = vplGeometry_PrepareRays(sides->patches->geometry);
    }
    if (result == VPL_SUCCESS) {
        result = findLinks(sides, def, links);
    }
    if (result == VPL_SUCCESS) {
        links->groupCount = links->tree->nodeCount - sides->count;
        result = fitRows(sides, def, links);
    }
    return result;
}

vplResult vplLinks_Create(const vplPatchSides* sides, const vplLinkDef* def, vplLinks** linksOut)
{
    vplContext* context = sides->context;
    vplResult result = checkDef(sides, def);
    vplLinks* links = result == VPL_SUCCESS ? vplAllocZero(context, 1, sizeof *links) : NULL;
    if (links == NULL) {
        return result == VPL_SUCCESS ? VPL_OUT_OF_MEMORY : result;
    }
    links->context = context;
    links->sideCount = sides->count;
    links->tree = vplAllocZero(context, 1, sizeof *links->tree);
    result = links->tree ? build(sides, def, links) : VPL_OUT_OF_MEMORY;
    if (result != VPL_SUCCESS) {
        vplLinks_Destroy(links);
        return result;
    }
    *linksOut = links;
    return VPL_SUCCESS;
}

void vplLinks_Destroy(vplLinks* links)
{
    if (links == NULL) {
        return;
    }
    vplContext* context = links->context;
    struct vplLinkTree* tree = links->tree;
    if (tree != NULL) {
        vplFree(context, tree->nodes);
        vplFree(context, tree->order);
        vplFree(context, tree->areaUpTo);
        vplFree(context, tree->firstOf);
        vplFree(context, tree->senders);
        vplFree(context, tree->factors);
        vplFree(context, tree->scale);
        vplFree(context, tree);
    }
    vplFree(context, (void*)links->rowSums);
    vplFree(context, links);
}
