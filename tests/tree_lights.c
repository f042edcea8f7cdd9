// SPDX-License-Identifier: MIT
#include "tree_lights.h"

vplShadeLight rollLight(Dice* dice, Kind kind, int i)
{
    vplVec3 p = rollVec(dice, 2), n = rollUnit(dice);
    if (kind == KIND_WALLS) {
        const int axis = (int)roll(dice, 0, 2.999f);
        const float side = roll(dice, -1, 1) > 0 ? 1.0f : -1.0f;
        float at[3] = {p.x, p.y, p.z}, to[3] = {0, 0, 0};
        at[axis] = 2 * side;
        to[axis] = -side;
        p = vplVec(at[0], at[1], at[2]);
        n = vplVec(to[0], to[1], to[2]);
    }
    p = kind == KIND_FAR ? vplAdd(vplScale(0.01f, p), vplVec(1e6f, -1e6f, 1e6f)) : p;
    p = kind == KIND_SERIES ? vplScale(ldexpf(1, -(i % 140)), vplVec(1, 1, 1)) : p;
    p = kind == KIND_POINT || kind == KIND_SAME ? vplVec(0.3f, 0.7f, 0.1f) : p;
    p = kind == KIND_HUGE ? vplScale(1e17f, p) : p;
    n = kind == KIND_SAME ? vplVec(0, 1, 0) : n;
    n = kind == KIND_BACK ? vplVec(0, i % 2 ? 1.0f : -1.0f, 0) : n;
    float r = roll(dice, 0, 1), g = roll(dice, 0, 1), b = roll(dice, 0, 1);
    if (kind == KIND_UNEQUAL) {
        const float scale = i % 100 == 0 ? 1e12f : i % 3 == 0 ? 0 : 1;
        r *= scale, g *= scale, b *= scale;
    }
    return (vplShadeLight){p.x, p.y, p.z, n.x, n.y, n.z, r, g, b};
}

vplShadeLight* rollTreeLights(Kind kind, int count, uint64_t seed)
{
    Dice dice = {seed, 0};
    vplShadeLight* lights = malloc((size_t)count * sizeof *lights);
    for (int i = 0; i < count; i++) {
        lights[i] = rollLight(&dice, kind, i);
    }
    return lights;
}

vplLightTree* plant(vplContext* context, const vplShadeLight* lights, int count)
{
    vplLightTree* tree = NULL;
    assert_int_equal(vplLightTree_Create(context, lights, count, NULL, NULL, &tree), VPL_SUCCESS);
    return tree;
}
