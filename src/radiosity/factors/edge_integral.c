// SPDX-License-Identifier: MIT
// Based on: Hottel and Sarofim, Radiative Transfer, 1967, chapter 2 (the contour integral); Peter Schroeder
// and Pat Hanrahan, On the Form Factor between Two Polygons, SIGGRAPH 1993 (its inner integral in closed
// form). Departs: the outer integral, whose closed form needs dilogarithms, is computed numerically, in parts
// that shrink towards its singularities.
#include "radiosity/factors/analytic.h"

#include "math/scalar.h"

const vplGaussRule vplGauss4 = {
    2, {0.3399810435848563, 0.8611363115940526}, {0.6521451548625462, 0.34785484513745385}};
const vplGaussRule vplGauss6 = {3,
                                {0.2386191860831969, 0.6612093864662645, 0.932469514203152},
                                {0.46791393457269104, 0.3607615730481386, 0.17132449237917036}};
const vplGaussRule vplGauss10 = {
    5,
    {0.14887433898163122, 0.4333953941292472, 0.6794095682990244, 0.8650633666889845, 0.9739065285171717},
    {0.29552422471475287, 0.26926671930999635, 0.21908636251598204, 0.1494513491505806, 0.06667134430868814}};

// Edges count as parallel if the squared sine of their angle is below this, the rounding of double.
static const double PARALLEL = 0x1p-96;

// A singularity of the inner integral as a complex number along the outer edge.
typedef struct Singularity {
    double re, im2; // im2: the imaginary part squared
} Singularity;

typedef struct Inner {
    const vplEdge *outer, *edge;
    Singularity singular[3];
    int singularCount;
} Inner;

// The integral of ln sqrt(u^2 + h^2) du.
static double onceIntegrated(double u, double h)
{
    const double square = u * u + h * h;
    if (!(square > 0)) {
        return 0;
    }
    return 0.5 * u * vplLn(square) - u + (h > 0 ? h * vplAtan2(u, h) : 0);
}

// The integral of onceIntegrated(u, h) du.
static double twiceIntegrated(double u, double h)
{
    const double square = u * u + h * h;
    if (!(square > 0)) {
        return 0;
    }
    return 0.25 * (u * u - h * h) * vplLn(square) - 0.75 * u * u + (h > 0 ? h * u * vplAtan2(u, h) : 0);
}

// The squared length of way - at along.
static double squareBeside(const double way[3], double at, const double along[3])
{
    double square = 0;
    for (int k = 0; k < 3; k++) {
        const double off = way[k] - at * along[k];
        square += off * off;
    }
    return square;
}

// The position of `point` along the line of `edge`, and its distance from that line.
static double project(const vplEdge* edge, const double point[3], double* heightOut)
{
    double way[3];
    vplSub3(point, edge->from, way);
    const double at = vplDot3(way, edge->along);
    *heightOut = sqrt(squareBeside(way, at, edge->along));
    return at;
}

// The point of an edge at `at` metres from its start.
static void pointAt(const vplEdge* edge, double at, double point[3])
{
    for (int k = 0; k < 3; k++) {
        point[k] = edge->from[k] + at * edge->along[k];
    }
}

static double parallelIntegral(const vplEdge* outer, const vplEdge* inner, double cosine)
{
    double h;
    const double t0 = project(outer, inner->from, &h),
                 t1 = t0 + (cosine > 0 ? inner->length : -inner->length);
    return (twiceIntegrated(t1, h) - twiceIntegrated(t1 - outer->length, h)) -
           (twiceIntegrated(t0, h) - twiceIntegrated(t0 - outer->length, h));
}

// ---- edges at an angle

static double innerIntegral(const Inner* inner, double s)
{
    double point[3], h;
    pointAt(inner->outer, s, point);
    const double at = project(inner->edge, point, &h);
    return onceIntegrated(inner->edge->length - at, h) - onceIntegrated(-at, h);
}

// The singularities: the ends of the inner edge and, if it is on that edge, its closest point to the line of
// the outer one.
static void findSingularities(Inner* inner, double cosine, double sine2)
{
    const vplEdge *a = inner->outer, *b = inner->edge;
    double way[3];
    for (int i = 0; i < 2; i++) {
        double end[3], h;
        pointAt(b, i == 0 ? 0 : b->length, end);
        inner->singular[i].re = project(a, end, &h);
        inner->singular[i].im2 = h * h;
    }
    inner->singularCount = 2;
    vplSub3(a->from, b->from, way);
    const double d = vplDot3(a->along, way), e = vplDot3(b->along, way);
    const double s = (cosine * e - d) / sine2, t = (e - cosine * d) / sine2;
    if (t > 0 && t < b->length) {
        for (int k = 0; k < 3; k++) {
            way[k] += s * a->along[k];
        }
        inner->singular[inner->singularCount++] = (Singularity){s, squareBeside(way, t, b->along) / sine2};
    }
}

static bool isSmooth(const Inner* inner, double middle, double half, double apart)
{
    for (int i = 0; i < inner->singularCount; i++) {
        const double re = inner->singular[i].re - middle;
        if (re * re + inner->singular[i].im2 < apart * apart * half * half) {
            return false;
        }
    }
    return true;
}

static double gauss(const Inner* inner, const vplGaussRule* rule, double middle, double half)
{
    double sum = 0;
    for (int i = 0; i < rule->pairs; i++) {
        sum += rule->w[i] * (innerIntegral(inner, middle - half * rule->x[i]) +
                             innerIntegral(inner, middle + half * rule->x[i]));
    }
    return half * sum;
}

// Adds the integral from `from` to `to` by bisection towards singularities.
static void addIntegral(const Inner* inner, double from, double to, const vplEdgeRule* rule, double* sum)
{
    const double middle = 0.5 * (from + to), half = 0.5 * (to - from);
    if (half <= rule->least * inner->outer->length || isSmooth(inner, middle, half, rule->apart)) {
        *sum += gauss(inner, rule->gauss, middle, half);
    } else {
        addIntegral(inner, from, middle, rule, sum);
        addIntegral(inner, middle, to, rule, sum);
    }
}

double vplEdgeIntegral(const vplEdge* outer, const vplEdge* edge, const vplEdgeRule* rule)
{
    const double cosine = vplDot3(outer->along, edge->along),
                 sine2 = squareBeside(edge->along, cosine, outer->along);
    if (sine2 < PARALLEL) {
        return parallelIntegral(outer, edge, cosine);
    }
    if (cosine == 0) {
        return 0;
    }
    Inner inner = {.outer = outer, .edge = edge};
    findSingularities(&inner, cosine, sine2);
    double cuts[5] = {0};
    int count = 1;
    for (int i = 0; i < inner.singularCount; i++) {
        const double at = inner.singular[i].re;
        if (at > 0 && at < outer->length) {
            int k = count++;
            for (; k > 1 && cuts[k - 1] > at; k--) {
                cuts[k] = cuts[k - 1];
            }
            cuts[k] = at;
        }
    }
    cuts[count] = outer->length;
    double sum = 0;
    for (int i = 0; i < count; i++) {
        if (cuts[i + 1] > cuts[i]) {
            addIntegral(&inner, cuts[i], cuts[i + 1], rule, &sum);
        }
    }
    return cosine * sum;
}
