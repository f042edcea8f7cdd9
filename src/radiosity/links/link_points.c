// SPDX-License-Identifier: MIT
// Points on groups of sides, linear fits to values at them, and rays between them.
#include "base/rng.h"
#include "geometry/bvh.h"
#include "geometry/triangle.h"
#include "radiosity/links/links.h"
#include "radiosity/sides/side.h"
#include "visibility/hemi_map.h"

enum { STREAM = 0x4c00, POINTS = VPL_LINK_POINTS }; // of random numbers; one per point

// Fits do not follow directions in which points spread by less than this fraction of their variance.
static const double RIDGE = 1e-4;

// ---- points

// The position in the tree's order of the side at which the summed area passes `target`.
static int findSide(const struct vplLinkTree* tree, const vplLinkNode* node, double target)
{
    int low = node->first, high = node->first + node->count - 1;
    while (low < high) {
        const int middle = low + (high - low) / 2;
        if (tree->areaUpTo[middle + 1] > target) {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    return low;
}

static void drawPoints(const vplLinkWork* work, int node, vplLinkPoints* out)
{
    const struct vplLinkTree* tree = work->tree;
    const vplLinkNode* n = &tree->nodes[node];
    const double from = tree->areaUpTo[n->first], to = tree->areaUpTo[n->first + n->count];
    const float scale = n->radius > 0 ? 1 / n->radius : 0;
    for (int k = 0; k < POINTS; k++) {
        const vplRandom4 random = vplRandomAt(work->def->seed, STREAM + (uint32_t)k, (uint64_t)node);
        const double target =
            from + (to - from) * ((k + 0.25 + 0.5 * (double)vplUnitFloat(random.v[0])) / POINTS);
        const int position = findSide(tree, n, target);
        const vplPatchSide* side = &work->sides->sides[tree->order[position]];
        // Beside a large sum, the summed areas of tiny sides may differ by more than the area, or not at all.
        const double into = fmin((target - tree->areaUpTo[position]) / (double)side->area, 1);
        const int cells = __builtin_popcount(side->open);
        const int cell = (int)(into * cells);
        const vplSidePoint point = vplPatchSide_SampleCell(
            work->sides, side, vplPatchSide_OpenCell(side, cell < cells ? cell : cells - 1),
            vplUnitFloat(random.v[1]), vplUnitFloat(random.v[2]));
        const vplRay ray = vplPatchSides_Leave(work->sides, &point, point.normal);
        out->skipFirst[k] = ray.skip.first;
        out->skipCount[k] = ray.skip.count;
        for (int axis = 0; axis < 3; axis++) {
            out->at[axis][k] = vplComponent(point.at, axis);
            out->normal[axis][k] = vplComponent(point.normal, axis);
            out->origin[axis][k] = vplComponent(ray.origin, axis);
            out->place[axis][k] = scale * (vplComponent(point.at, axis) - vplComponent(n->middle, axis));
        }
    }
}

// ---- linear fits

// The inverse of a symmetric, positive definite matrix: its adjugate over its determinant.
static void invert(const double m[3][3], double out[3][3])
{
    for (int i = 0; i < 3; i++) {
        const int a = (i + 1) % 3, b = (i + 2) % 3;
        for (int k = 0; k < 3; k++) {
            const int c = (k + 1) % 3, d = (k + 2) % 3;
            out[k][i] = m[a][c] * m[b][d] - m[a][d] * m[b][c];
        }
    }
    const double determinant = m[0][0] * out[0][0] + m[0][1] * out[1][0] + m[0][2] * out[2][0];
    for (int i = 0; i < 9; i++) {
        out[i / 3][i % 3] = determinant > 0 ? out[i / 3][i % 3] / determinant : 0;
    }
}

// Fills weight and slope.
static void fitPoints(vplLinkPoints* points)
{
    double mean[3] = {0}, spread[3][3] = {{0}}, inverse[3][3];
    for (int i = 0; i < 3 * POINTS; i++) {
        mean[i / POINTS] += (double)points->place[i / POINTS][i % POINTS] / POINTS;
    }
    for (int i = 0; i < POINTS; i++) {
        for (int k = 0; k < 9; k++) {
            spread[k / 3][k % 3] += ((double)points->place[k / 3][i] - mean[k / 3]) *
                                    ((double)points->place[k % 3][i] - mean[k % 3]);
        }
    }
    const double ridge = RIDGE * (spread[0][0] + spread[1][1] + spread[2][2]);
    for (int k = 0; k < 3; k++) {
        spread[k][k] += ridge;
    }
    invert(spread, inverse);
    for (int i = 0; i < POINTS; i++) {
        double weight = 1.0 / POINTS;
        for (int axis = 0; axis < 3; axis++) {
            double slope = 0;
            for (int k = 0; k < 3; k++) {
                slope += inverse[axis][k] * ((double)points->place[k][i] - mean[k]);
            }
            points->slope[axis][i] = (float)slope;
            weight -= slope * mean[axis];
        }
        points->weight[i] = (float)weight;
    }
}

void vplLinkPoints_Draw(const vplLinkWork* work, int node)
{
    drawPoints(work, node, &work->points[node]);
    fitPoints(&work->points[node]);
}

// ---- rays

vplRay vplLinkRay(const vplLinkPoints* from, int i, const vplLinkPoints* to, int k)
{
    const vplVec3 way =
        vplWayToLight(vplLinkPoint(to->at, k), vplLinkPoint(to->normal, k), vplLinkPoint(from->at, i));
    return (vplRay){vplLinkPoint(from->origin, i), way, {from->skipFirst[i], from->skipCount[i]}};
}

// The ends of a ray. Points are in the order of area, so any four consecutive rays leave from all quarters of a
// node, and arrive at all quarters of the other.
static int fromPoint(const vplLinkSight* sight, int ray)
{
    return (int)((2 * (unsigned)ray + (unsigned)ray / 4 + sight->start) % POINTS);
}

static int toPoint(const vplLinkSight* sight, int ray)
{
    const unsigned turn = (unsigned)(ray / POINTS);
    return (int)((3 * (unsigned)fromPoint(sight, ray) + 4 * turn + turn / 2 + sight->start / POINTS) %
                 POINTS);
}

// Joins sixteen pairs of points, or those up to sight->to.
static void join(const vplLinkWork* work, const vplLinkSight* sight, int first, vplLinkSeen* seen, int* rays)
{
    const vplLinkPoints *p = sight->p, *q = sight->q;
    int from[VPL_RAY_PACKET], to[VPL_RAY_PACKET];
    float amount[VPL_RAY_PACKET];
    vplRayPacket packet;
    packet.active = 0;
    for (int l = 0; l < VPL_RAY_PACKET; l++) {
        const int i = from[l] = fromPoint(sight, first + l), k = to[l] = toPoint(sight, first + l);
        amount[l] = first + l < sight->to ? sight->terms->of[i][k] : 0;
        if (amount[l] > 0) {
            const vplRay ray = vplLinkRay(p, i, q, k);
            vplRayPacket_Set(&packet, l, &ray);
            seen->openP[i] += amount[l];
            seen->openQ[k] += amount[l];
            seen->open += (double)amount[l];
        }
    }
    *rays += vplGeometry_Darken(work->sides->patches->geometry, &packet, 1, amount);
    for (int l = 0; l < VPL_RAY_PACKET; l++) {
        seen->visibleP[from[l]] += amount[l];
        seen->visibleQ[to[l]] += amount[l];
        seen->visible += (double)amount[l];
    }
}

void vplCastLinkRays(const vplLinkWork* work, const vplLinkSight* sight, vplLinkSeen* seen, int* rays)
{
    for (int first = sight->from; first < sight->to; first += VPL_RAY_PACKET) {
        join(work, sight, first, seen, rays);
    }
}

// Multiplies values at points by their visible fractions. A point of which no ray was cast gets that of all.
static void darken(float values[POINTS], const float open[POINTS], const float visible[POINTS], double all)
{
    for (int i = 0; i < POINTS; i++) {
        values[i] *= open[i] > 0 ? visible[i] / open[i] : (float)all;
    }
}

void vplDarkenTerms(const vplLinkSeen* seen, vplLinkTerms* terms)
{
    const double all = seen->open > 0 ? seen->visible / seen->open : 0;
    darken(terms->rows, seen->openP, seen->visibleP, all);
    darken(terms->columns, seen->openQ, seen->visibleQ, all);
}
