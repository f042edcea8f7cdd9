// SPDX-License-Identifier: MIT
// Based on: Gary Meisters, Polygons Have Ears, American Mathematical Monthly 1975; David Eberly,
// Triangulation by Ear Clipping, 2002 (only the neighbours of a clipped ear can change); Martin Newell's sum
// for the normal.
// Departs: a corner on the edge of an ear forbids the ear, so that corners on a straight edge become corners
// of triangles and leave no gaps. A corner that coincides with one of the ear's (a hole joined by a double
// edge) is judged by the direction of its edges. An outline that crosses itself is cut somehow, in time
// quadratic in its corners.
#include "scene/ear_clipping.h"

#include "math/double3.h"
#include "math/vec.h"

// The tests that an ear must pass, the strictest first. An outline that has no ear left gets the next rule.
typedef enum Rule {
    RULE_CLOSED = 0, // no corner may lie in or on the ear: every simple polygon has such ears
    RULE_OPEN,       // no corner may lie inside
    RULE_FLAT,       // an ear may also have no area: spikes and repeated corners
    RULE_NONE        // no test is left
} Rule;

// Twice the signed area of (a, b, c): > 0 if it turns left.
static double turn(const double* a, const double* b, const double* c)
{
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

// Projects the polygon along the largest component of its normal, which keeps straight lines, turns and
// ratios of areas. Swaps the axes if the normal points away, so that every polygon turns left. False if there
// is no normal: the corners are collinear, or the outline turns as much to the left as to the right.
static bool project(vplEarClipper* g, const vplVec3* corners, int count)
{
    double n[3] = {0, 0, 0};
    for (int i = 1; i + 1 < count; i++) {
        double p[3], q[3], cross[3];
        for (int k = 0; k < 3; k++) {
            const double origin = (double)vplComponent(corners[0], k);
            p[k] = (double)vplComponent(corners[i], k) - origin;
            q[k] = (double)vplComponent(corners[i + 1], k) - origin;
        }
        vplCross3(p, q, cross);
        for (int k = 0; k < 3; k++) {
            n[k] += cross[k];
        }
    }
    int axis = fabs(n[1]) > fabs(n[0]) ? 1 : 0;
    axis = fabs(n[2]) > fabs(n[axis]) ? 2 : axis;
    int u = (axis + (n[axis] < 0 ? 2 : 1)) % 3, v = 3 - axis - u;
    for (int i = 0; i < count; i++) {
        g->at[i][0] = (double)vplComponent(corners[i], u);
        g->at[i][1] = (double)vplComponent(corners[i], v);
    }
    return n[axis] != 0;
}

// True if every corner turns left and the outline goes round once, so that x changes direction exactly twice.
static bool isStrictlyConvex(const vplEarClipper* g, int count)
{
    int reversals = 0, direction = 0, first = 0;
    for (int i = 0; i < count; i++) {
        const double *a = g->at[i], *b = g->at[(i + 1) % count], *c = g->at[(i + 2) % count];
        if (!(turn(a, b, c) > 0)) {
            return false;
        }
        int now = b[0] > a[0] ? 1 : b[0] < a[0] ? -1 : direction;
        reversals += direction != 0 && now != direction;
        first = first ? first : now;
        direction = now;
    }
    return reversals + (direction != first) <= 2;
}

static bool isLeftAndRight(double a, double b)
{
    return (a > 0 && b < 0) || (a < 0 && b > 0);
}

// True if two edges intersect between their ends.
static bool crossesItself(const vplEarClipper* g, int count)
{
    for (int i = 0; i < count; i++) {
        const double *a = g->at[i], *b = g->at[(i + 1) % count];
        for (int j = i + 2; j < count; j++) {
            const double *c = g->at[j], *d = g->at[(j + 1) % count];
            if (isLeftAndRight(turn(a, b, c), turn(a, b, d)) &&
                isLeftAndRight(turn(c, d, a), turn(c, d, b))) {
                return true;
            }
        }
    }
    return false;
}

static void emit(vplEarClipper* g, int a, int b, int c)
{
    int* triangle = g->triangles[g->triangleCount++];
    triangle[0] = a;
    triangle[1] = b;
    triangle[2] = c;
}

static bool isSame(const double* a, const double* b)
{
    return a[0] == b[0] && a[1] == b[1];
}

// True if the edge from `corner` to q starts inside the angle between the edges to `right` and to `left`.
static bool entersAngle(const double* corner, const double* right, const double* left, const double* q)
{
    return turn(corner, right, q) > 0 && turn(corner, q, left) > 0;
}

// True if corner p forbids the ear with corners v.
static bool blocks(const vplEarClipper* g, int p, const int* v, Rule rule)
{
    const double *a = g->at[v[0]], *b = g->at[v[1]], *c = g->at[v[2]], *x = g->at[p];
    double ab = turn(a, b, x), bc = turn(b, c, x), ca = turn(c, a, x);
    if (rule > RULE_CLOSED) {
        return ab > 0 && bc > 0 && ca > 0;
    }
    if (!(ab >= 0 && bc >= 0 && ca >= 0)) {
        return false;
    }
    for (int k = 0; k < 3; k++) {
        const double *corner = g->at[v[k]], *right = g->at[v[(k + 1) % 3]], *left = g->at[v[(k + 2) % 3]];
        if (isSame(x, corner)) {
            return entersAngle(corner, right, left, g->at[g->next[p]]) ||
                   entersAngle(corner, right, left, g->at[g->previous[p]]);
        }
    }
    return true;
}

static bool isEar(const vplEarClipper* g, int tip, Rule rule)
{
    const int v[3] = {g->previous[tip], tip, g->next[tip]};
    double area = turn(g->at[v[0]], g->at[v[1]], g->at[v[2]]);
    if (!(area > 0) && !(rule == RULE_FLAT && area == 0)) {
        return false;
    }
    for (int p = g->next[v[2]]; p != v[0]; p = g->next[p]) {
        if (blocks(g, p, v, rule)) {
            return false;
        }
    }
    return true;
}

// The first ear from corner `start` on. Relaxes the rule until there is one; -1 if there is none at all.
static int findEar(vplEarClipper* g, int start, Rule* rule)
{
    while (*rule < RULE_NONE) {
        int i = start;
        do {
            if (g->ear[i]) {
                return i;
            }
            i = g->next[i];
        } while (i != start);
        ++*rule;
        do {
            g->ear[i] = isEar(g, i, *rule);
            i = g->next[i];
        } while (i != start);
    }
    return -1;
}

static void clipEars(vplEarClipper* g, int count)
{
    Rule rule = RULE_CLOSED;
    for (int i = 0; i < count; i++) {
        g->previous[i] = (i + count - 1) % count;
        g->next[i] = (i + 1) % count;
    }
    for (int i = 0; i < count; i++) {
        g->ear[i] = isEar(g, i, rule);
    }
    int start = 0;
    for (int left = count; left > 3; left--) {
        int tip = findEar(g, start, &rule);
        tip = tip >= 0 ? tip : start; // an outline that crosses itself may have none
        int previous = g->previous[tip], next = g->next[tip];
        emit(g, previous, tip, next);
        g->next[previous] = next;
        g->previous[next] = previous;
        g->ear[previous] = isEar(g, previous, rule);
        g->ear[next] = isEar(g, next, rule);
        start = g->next[next]; // moving on gives fewer thin triangles than staying
    }
    emit(g, g->previous[start], start, g->next[start]);
}

void vplEarClipper_Triangulate(vplEarClipper* clipper, const vplVec3* corners, int count)
{
    clipper->triangleCount = 0;
    clipper->simple = project(clipper, corners, count);
    if (!isStrictlyConvex(clipper, count)) {
        clipper->simple = clipper->simple && !crossesItself(clipper, count);
        clipEars(clipper, count);
        return;
    }
    for (int i = 1; i + 1 < count; i++) {
        emit(clipper, 0, i, i + 1);
    }
}
