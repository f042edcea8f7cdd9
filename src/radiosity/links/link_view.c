// SPDX-License-Identifier: MIT
// Finds what is between two nodes, with as many rays as what they exchange asks for.
// Based on: Eric Haines and John Wallace, Shaft Culling for Efficient Ray-Cast Radiosity, Eurographics Workshop on
// Rendering 1991. Departs: rays come first, and the shaft is searched only if none of them is blocked.
#include "math/scalar.h"
#include "math/vec.h"
#include "radiosity/factors/shaft.h"
#include "radiosity/links/link_pair.h"

#include <math.h>

// Two groups count as hidden from each other if HIDING_RAYS n rays are all blocked, where n is their unoccluded form factor
// divided by the allowed error.
static const double HIDING_RAYS = 16;

// Fewer rays are enough where each row is scaled to the share of light that rays measured, which restores what this test
// misses; at most two rays per pair of sides, because the sides by themselves would cast four. Without that scaling, so few
// rays cost a room that is lit through a door ajar a twentieth of its light.
static const double FEWER_HIDING_RAYS = 4, HIDING_RAYS_OF_SIDES = 2;

// With that scaling, so few rays still cost rooms that have a sixth of the mean light 4 % of theirs (a furnished flat, 50,000 patches).
// So the number of rays is divided by the lower `lit` of the two groups, but by no less than SHADED; and where `lit` is below
// SHADED, sides are tried by themselves as well. These rooms then lose 2 %.
static const double SHADED = 0.25;

// The first rays of a pair of groups: one packet.
enum { FEW_RAYS = VPL_RAY_PACKET };

// A number that looks random.
static unsigned startOf(int32_t p, int32_t q)
{
    const uint32_t mixed = ((uint32_t)p * 0x9e3779b1u ^ (uint32_t)q * 0x85ebca77u) * 0xc2b2ae3du;
    return mixed >> 26;
}

static vplShaftEnd endOf(const vplJudgedPair* pair, const vplLinkNode* node)
{
    const vplPatchSide* side = vplFirstSide(pair, node);
    return (vplShaftEnd){.low = {node->low.x, node->low.y, node->low.z},
                         .high = {node->high.x, node->high.y, node->high.z},
                         .flat = node->flat,
                         .normal = side->normal,
                         .at = side->corners[0]};
}

// Tests whether nothing is between the nodes, and remembers it for their parts.
static bool isClear(const vplJudgedPair* pair)
{
    if (!pair->answer->clear) {
        const vplShaftEnd p = endOf(pair, pair->p), q = endOf(pair, pair->q);
        const float largest = fmaxf(fmaxf(vplLargestOf(pair->p->low), vplLargestOf(pair->p->high)),
                                    fmaxf(vplLargestOf(pair->q->low), vplLargestOf(pair->q->high)));
        pair->answer->clear = vplShaft_IsClear(pair->work->sides->patches->geometry, &p, &q,
                                               largest * 0x1p-21f, &pair->answer->blocker);
    }
    return pair->answer->clear;
}

void vplCastPairRays(const vplJudgedPair* pair, const vplLinkTerms* terms, int from, int to,
                     vplLinkSeen* seen)
{
    const vplLinkSight sight = {.p = &pair->work->points[pair->ids->p],
                                .q = &pair->work->points[pair->ids->q],
                                .terms = terms,
                                .start = startOf(pair->ids->p, pair->ids->q),
                                .from = from,
                                .to = to};
    vplCastLinkRays(pair->work, &sight, seen, &pair->answer->rays);
}

// The lower `lit` of the two groups: that of the group which receives less light for its area.
static double leastLit(const vplJudgedPair* pair)
{
    return (double)fminf(pair->p->lit, pair->q->lit);
}

// The rays after which a pair counts as hidden if all were blocked.
static double raysToHide(const vplJudgedPair* pair, double open)
{
    const double times = open / pair->work->allowed;
    return vplRowsAreScaled(pair) ? fmin(FEWER_HIDING_RAYS * times / fmin(fmax(leastLit(pair), SHADED), 1),
                                         HIDING_RAYS_OF_SIDES * vplPairsOfSides(pair))
                                  : HIDING_RAYS * times;
}

// The error of a pair of groups that comes from chance alone, with all rays, where these let through a fraction `v`:
// each point casts some of them.
static double chanceError(double open, double v)
{
    return 2 * open * sqrt(v * (1 - v) * VPL_LINK_POINTS / VPL_MOST_LINK_RAYS);
}

// The first rays, and more while all are blocked and the pair does not count as hidden. A search of what is in the way
// follows only if these find nothing. Returns the number of rays.
static int lookBetween(const vplJudgedPair* pair, const vplLinkTerms* terms, double hide, vplLinkSeen* seen)
{
    vplCastPairRays(pair, terms, 0, FEW_RAYS, seen);
    int rays = FEW_RAYS;
    for (; rays < VPL_MOST_LINK_RAYS && !(seen->visible > 0) && (rays < hide || !(seen->open > 0));
         rays += FEW_RAYS) {
        vplCastPairRays(pair, terms, rays, rays + FEW_RAYS, seen);
    }
    return rays;
}

// ---- sides by themselves

// The points of a group miss its small sides: the corner between a box and the floor had light through the box. So a pair is divided
// if the visible fraction from one of its sides differs from that of the pair by more than DIFFERENT times the allowed error over
// the unoccluded form factor, plus CHANCE standard deviations of the side's rays. The relmse in the room with 20,000 patches fell
// from 2.1 to 1.2 times that of all pairs. Without CHANCE loft took 1.2 times as long, and no error was smaller.
static const double DIFFERENT = 3, CHANCE = 2;

// At most so many sides of a group are tried, with so many rays each.
enum { TRIED_SIDES = 64, RAYS_OF_SIDE = 4 };

// Sets ray l of a packet, from a side to a group. False if the points that it joins do not face each other.
static bool setSideRay(const vplLinkPoints* side, const vplLinkPoints* group, unsigned number, int l,
                       vplRayPacket* packet)
{
    const int i = 2 * (l % RAYS_OF_SIDE) + (int)(number % 2),
              k = (int)((5 * number + 3 * (unsigned)l) % VPL_LINK_POINTS);
    const vplRay ray = vplLinkRay(side, i, group, k);
    if (!(vplDot(ray.direction, vplLinkPoint(side->normal, i)) > 0 &&
          vplDot(ray.direction, vplLinkPoint(group->normal, k)) < 0)) {
        return false;
    }
    vplRayPacket_Set(packet, l, &ray);
    return true;
}

// Tests whether the fraction of `to` that is visible from some side of `from` differs from `share` by more than `most`.
static bool someSideDiffers(const vplJudgedPair* pair, int32_t from, int32_t to, double share, double most)
{
    const vplLinkWork* work = pair->work;
    const vplLinkNode* node = &work->tree->nodes[from];
    const int step = (node->count + TRIED_SIDES - 1) / TRIED_SIDES;
    for (int first = 0; first < node->count; first += step * (VPL_RAY_PACKET / RAYS_OF_SIDE)) {
        float cast[VPL_RAY_PACKET], seen[VPL_RAY_PACKET];
        vplRayPacket packet;
        packet.active = 0;
        for (int l = 0; l < VPL_RAY_PACKET; l++) {
            const int side = first + step * (l / RAYS_OF_SIDE);
            const bool is = side < node->count && setSideRay(&work->points[work->leafAt[node->first + side]],
                                                             &work->points[to], (unsigned)side, l, &packet);
            cast[l] = seen[l] = is ? 1 : 0;
        }
        pair->answer->rays += vplGeometry_Darken(work->sides->patches->geometry, &packet, 1, seen);
        for (int l = 0; l < VPL_RAY_PACKET; l += RAYS_OF_SIDE) {
            float all = 0, open = 0;
            for (int i = l; i < l + RAYS_OF_SIDE; i++) {
                all += cast[i];
                open += seen[i];
            }
            if (all > 0 && fabs((double)(open / all) - share) > most) {
                return true;
            }
        }
    }
    return false;
}

// Tests whether a side of either group sees much more or less of the other than `share`, which is the visible fraction of the pair.
static bool sidesDiffer(const vplJudgedPair* pair, double open, double share)
{
    const double chance = sqrt(fmax(0, share * (1 - share)) / RAYS_OF_SIDE);
    const double most = DIFFERENT * pair->work->allowed / open + CHANCE * chance;
    const bool coarse =
        vplRowsAreScaled(pair) && leastLit(pair) >= SHADED; // scaled rows restore what is missed
    if (pair->work->leafAt == NULL || coarse || fmax(share, 1 - share) <= most) {
        return false;
    }
    const int32_t p = pair->ids->p, q = pair->ids->q;
    return (pair->p->count > 1 && someSideDiffers(pair, p, q, share, most)) ||
           (pair->q->count > 1 && someSideDiffers(pair, q, p, share, most));
}

// ---- the search

vplLinkView vplFindBetween(const vplJudgedPair* pair, const vplLinkTerms* terms, bool rough, double open,
                           vplLinkSeen* seen)
{
    vplLinkAnswer* answer = pair->answer;
    const double allowed = pair->work->allowed, hide = raysToHide(pair, open);
    if (answer->clear || (rough && hide > VPL_MOST_LINK_RAYS)) {
        answer->visible = isClear(pair);
        return answer->visible ? VPL_VIEW_CLEAR : VPL_VIEW_DIVIDED;
    }
    const int rays = lookBetween(pair, terms, hide, seen);
    answer->visible = seen->visible > 0;
    if (answer->visible && seen->visible == seen->open && isClear(pair)) {
        return VPL_VIEW_CLEAR;
    }
    if (!answer->visible) {
        answer->visible = sidesDiffer(pair, open, 0);
        return answer->visible ? VPL_VIEW_DIVIDED : VPL_VIEW_HIDDEN;
    }
    const double v = seen->visible / seen->open;
    if (rough ||
        (vplRowsAreScaled(pair) && v < VPL_LINK_OPEN && chanceError(open, v) > VPL_LINK_SHADOWED * allowed)) {
        return VPL_VIEW_DIVIDED;
    }
    const bool less = vplRowsAreScaled(pair) && open < 4 * allowed;
    const int wanted = less ? FEW_RAYS * ((int)(open / allowed) + 1) : VPL_MOST_LINK_RAYS;
    vplCastPairRays(pair, terms, rays, open > allowed ? wanted : rays, seen);
    return sidesDiffer(pair, open, seen->visible / seen->open) ? VPL_VIEW_DIVIDED : VPL_VIEW_BLOCKED;
}
