// SPDX-License-Identifier: MIT
// Based on: Gary Meisters, Polygons Have Ears, American Mathematical Monthly 1975; David Eberly, Triangulation by
// Ear Clipping, 2002 (only the neighbours of a clipped ear can change); the normal by Martin Newell's sum.
// Departs: a corner on the edge of an ear forbids it, so that corners on a straight edge become corners of
// triangles instead of gaps; a corner that lies on another (a hole joined by a double edge) is judged by where
// its edges go; what crosses itself is cut somehow, in no more time than corners squared.
#include "scene/obj_polygon.h"

#include <math.h>

// How careful the search for an ear is. It only grows, for the outlines that have none.
typedef enum Care {
    CARE_CLOSED = 0, // nothing may lie in or on the ear: enough for every simple polygon
    CARE_OPEN,       // nothing may lie inside
    CARE_FLAT,       // an ear may have no area: spikes and repeated corners
    CARE_NONE        // none is left to find
} Care;

// Twice the signed area of (a, b, c): > 0 if it turns left.
static double turn(const double* a, const double* b, const double* c)
{
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

// The plane's axes: along the largest component of the normal, so that straight lines, turns and ratios of areas
// stay what they are. Swapped where the normal points away, so that every polygon turns left. False if there is no
// normal: the corners lie on a line, or the outline turns as much to the left as to the right.
static bool project(vplPolygon* g, const vplVec3* corners, int count)
{
    double n[3] = {0, 0, 0};
    const float* origin = &corners[0].x;
    for (int i = 1; i + 1 < count; i++) {
        double p[3], q[3];
        for (int k = 0; k < 3; k++) {
            p[k] = (double)(&corners[i].x)[k] - (double)origin[k];
            q[k] = (double)(&corners[i + 1].x)[k] - (double)origin[k];
        }
        n[0] += p[1] * q[2] - p[2] * q[1];
        n[1] += p[2] * q[0] - p[0] * q[2];
        n[2] += p[0] * q[1] - p[1] * q[0];
    }
    int axis = fabs(n[1]) > fabs(n[0]) ? 1 : 0;
    axis = fabs(n[2]) > fabs(n[axis]) ? 2 : axis;
    int u = (axis + (n[axis] < 0 ? 2 : 1)) % 3, v = 3 - axis - u;
    for (int i = 0; i < count; i++) {
        g->at[i][0] = (double)(&corners[i].x)[u];
        g->at[i][1] = (double)(&corners[i].x)[v];
    }
    return n[axis] != 0;
}

// True if every corner turns left and the outline goes round once: then x turns back exactly twice.
static bool isStrictlyConvex(const vplPolygon* g, int count)
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

// True if two edges meet between their ends.
static bool crossesItself(const vplPolygon* g, int count)
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

static void emit(vplPolygon* g, int a, int b, int c)
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

// True if the edge from `corner` to q starts into the angle between the edges to `right` and to `left`.
static bool entersAngle(const double* corner, const double* right, const double* left, const double* q)
{
    return turn(corner, right, q) > 0 && turn(corner, q, left) > 0;
}

// True if corner p forbids the ear with the corners v.
static bool blocks(const vplPolygon* g, int p, const int* v, Care care)
{
    const double *a = g->at[v[0]], *b = g->at[v[1]], *c = g->at[v[2]], *x = g->at[p];
    double ab = turn(a, b, x), bc = turn(b, c, x), ca = turn(c, a, x);
    if (care > CARE_CLOSED) {
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

static bool isEar(const vplPolygon* g, int tip, Care care)
{
    const int v[3] = {g->previous[tip], tip, g->next[tip]};
    double area = turn(g->at[v[0]], g->at[v[1]], g->at[v[2]]);
    if (!(area > 0) && !(care == CARE_FLAT && area == 0)) {
        return false;
    }
    for (int p = g->next[v[2]]; p != v[0]; p = g->next[p]) {
        if (blocks(g, p, v, care)) {
            return false;
        }
    }
    return true;
}

// The first ear from corner `start` on; the care grows until there is one. -1 if there is none at all.
static int findEar(vplPolygon* g, int start, Care* care)
{
    while (*care < CARE_NONE) {
        int i = start;
        do {
            if (g->ear[i]) {
                return i;
            }
            i = g->next[i];
        } while (i != start);
        ++*care;
        for (i = g->next[start]; *care < CARE_NONE; i = g->next[i]) {
            g->ear[i] = isEar(g, i, *care);
            if (i == start) {
                break;
            }
        }
    }
    return -1;
}

static void clipEars(vplPolygon* g, int count)
{
    Care care = CARE_CLOSED;
    for (int i = 0; i < count; i++) {
        g->previous[i] = (i + count - 1) % count;
        g->next[i] = (i + 1) % count;
    }
    for (int i = 0; i < count; i++) {
        g->ear[i] = isEar(g, i, care);
    }
    int start = 0;
    for (int left = count; left > 3; left--) {
        int tip = findEar(g, start, &care);
        tip = tip >= 0 ? tip : start; // what crosses itself may have none
        int previous = g->previous[tip], next = g->next[tip];
        emit(g, previous, tip, next);
        g->next[previous] = next;
        g->previous[next] = previous;
        if (care < CARE_NONE) {
            g->ear[previous] = isEar(g, previous, care);
            g->ear[next] = isEar(g, next, care);
        }
        start = g->next[next]; // ears taken in turn are less thin than ears taken in a row
    }
    emit(g, g->previous[start], start, g->next[start]);
}

void vplPolygon_Triangulate(vplPolygon* polygon, const vplVec3* corners, int count)
{
    polygon->triangleCount = 0;
    polygon->simple = project(polygon, corners, count);
    if (!isStrictlyConvex(polygon, count)) {
        polygon->simple = polygon->simple && !crossesItself(polygon, count);
        clipEars(polygon, count);
        return;
    }
    for (int i = 1; i + 1 < count; i++) {
        emit(polygon, 0, i, i + 1);
    }
}
