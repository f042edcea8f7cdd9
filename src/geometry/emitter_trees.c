// SPDX-License-Identifier: MIT
#include "geometry/emitter_trees.h"
#include "base/arena.h"

static vplResult listDirectional(vplEmitterTrees* t)
{
    const vplEmission* e = t->emission;
    t->directional = vplArena_Alloc(t->arena, (size_t)e->emitterCount, sizeof *t->directional);
    TRY(vplArena_Check(t->arena));
    for (int i = 0; i < e->emitterCount; i++) {
        if (e->emitters[i].type == VPL_EMITTER_DIRECTIONAL) {
            t->directional[t->directionalCount++] = i;
        }
    }
    return VPL_SUCCESS;
}

static vplResult fill(vplEmitterTrees* t, vplTreesWanted wanted)
{
    const vplEmission* e = t->emission;
    const int emitters = e->environment >= 0 ? e->environment : e->firstTriangle;
    const int triangles = e->sourceCount - e->firstTriangle;
    if (emitters >= wanted.emitters) {
        TRY(vplEmitterTree_Create(t->arena, e, 0, emitters, &t->emitters));
        TRY(listDirectional(t));
    }
    return triangles >= wanted.triangles
               ? vplEmitterTree_Create(t->arena, e, e->firstTriangle, e->sourceCount, &t->triangles)
               : VPL_SUCCESS;
}

vplResult vplEmitterTrees_Create(const vplGeometry* geometry, const vplEmitterDef* emitters, int emitterCount,
                                 vplTreesWanted wanted, vplEmitterTrees** treesOut)
{
    vplArena* arena = vplArena_Create(geometry->context);
    vplEmitterTrees* t = vplArena_AllocZero(arena, 1, sizeof *t);
    vplResult result = vplArena_Check(arena);
    if (result == VPL_SUCCESS) {
        t->arena = arena;
        result = vplEmission_Create(geometry, emitters, emitterCount, &t->emission);
    }
    if (result == VPL_SUCCESS) {
        vplArena_Absorb(arena, t->emission->arena);
        t->emission->arena = NULL;
        result = fill(t, wanted);
    }
    return vplArena_Deliver(arena, result, t, treesOut);
}

void vplEmitterTrees_Destroy(vplEmitterTrees* trees)
{
    vplArena_Destroy(trees != NULL ? trees->arena : NULL);
}
