// SPDX-License-Identifier: MIT
// Based on: J. G. van der Corput, Verteilungsfunktionen, 1935; J. H. Halton, On the efficiency of certain
// quasi-random sequences of points, Numerische Mathematik 1960. Keller's Instant Radiosity and SSVP use these
// sequences.
#include "math/sampling.h"
#include "math/scalar.h"
#include "math/vec.h"

float vplVanDerCorput(uint32_t k)
{
    return (float)(vplReverseBits(k) >> 8) * 0x1p-24f;
}

void vplPixelPoint(int i, int count, double* x, double* y)
{
    static const struct {
        int factor, modulus; // found by trying all: least rmse of what random edges cover
    } lattices[] = {{1, 3}, {3, 5}, {3, 7}, {3, 10}, {3, 11}, {8, 13}, {4, 15}, {13, 17}};
    if (count > 1 && count <= 17 && count % 2 == 1) {
        const int middle = count / 2, m = lattices[middle - 1].modulus;
        const int row = (lattices[middle - 1].factor * (i + m - middle) + middle) % m;
        *x = floor(256 * (i + 0.5) / count + 0.5) / 256; // as the rasterizer's sub-pixels
        *y = floor(256 * (row + 0.5) / count + 0.5) / 256;
    } else {
        const double shifted = vplVanDerCorput((uint32_t)i) + 0.5 / count;
        *x = (i + 0.5) / count;
        *y = shifted - floor(shifted);
    }
}

float vplHalton(uint64_t k, int dimension)
{
    static const uint16_t primes[VPL_PRIME_COUNT] = {
        2,   3,   5,   7,   11,  13,  17,  19,  23,  29,  31,  37,  41,  43,  47,  53,
        59,  61,  67,  71,  73,  79,  83,  89,  97,  101, 103, 107, 109, 113, 127, 131,
        137, 139, 149, 151, 157, 163, 167, 173, 179, 181, 191, 193, 197, 199, 211, 223,
        227, 229, 233, 239, 241, 251, 257, 263, 269, 271, 277, 281, 283, 293, 307, 311};
    uint64_t base = primes[dimension];
    uint64_t digits = 0, scale = 1;
    while (k > 0 && scale < (UINT64_C(1) << 52) / base) { // a float has no use for more than 52 bits
        digits = digits * base + k % base;
        scale *= base;
        k /= base;
    }
    double value = (double)digits / (double)scale;
    return (float)(value < 1 - 0x1p-24 ? value : 1 - 0x1p-24); // must not round to 1
}

void vplSamplePolarDisc(float u, float v, float* x, float* y)
{
    double sine, cosine;
    vplSinCosQuarters(4.0 * v, &sine, &cosine);
    double r = sqrt((double)u);
    *x = (float)(r * cosine);
    *y = (float)(r * sine);
}

void vplSampleConcentricDisc(float u, float v, float* x, float* y)
{
    double a = 2.0 * u - 1, b = 2.0 * v - 1;
    if (a == 0 && b == 0) {
        *x = *y = 0;
        return;
    }
    double r, quarters, sine, cosine;
    if (fabs(a) > fabs(b)) {
        r = a;
        quarters = 0.5 * (b / a);
    } else {
        r = b;
        quarters = 1 - 0.5 * (a / b);
    }
    vplSinCosQuarters(quarters, &sine, &cosine);
    *x = (float)(r * cosine);
    *y = (float)(r * sine);
}

vplVec3 vplSampleSphere(float u, float v)
{
    double z = 1 - 2.0 * u;
    double r2 = 1 - z * z;
    double r = sqrt(r2 > 0 ? r2 : 0);
    double sine, cosine;
    vplSinCosQuarters(4.0 * v, &sine, &cosine);
    return vplVec((float)(r * cosine), (float)(r * sine), (float)z);
}

vplVec3 vplSampleCosine(float u, float v)
{
    float x, y;
    vplSamplePolarDisc(u, v, &x, &y);
    double z2 = 1.0 - u;
    return vplVec(x, y, (float)sqrt(z2 > 0 ? z2 : 0));
}

vplVec3 vplSampleCosineAround(vplVec3 n, float u, float v)
{
    return vplTurnTo(n, vplSampleCosine(u, v));
}

vplVec3 vplTurnTo(vplVec3 n, vplVec3 d)
{
    vplVec3 tangent, bitangent;
    vplTangentFrame(n, &tangent, &bitangent);
    vplVec3 side = vplAdd(vplScale(d.x, tangent), vplScale(d.y, bitangent));
    return vplNormalize(vplAdd(side, vplScale(d.z, n)));
}
