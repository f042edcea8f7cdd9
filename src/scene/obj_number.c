// SPDX-License-Identifier: MIT
// Based on: William D. Clinger, How to Read Floating Point Numbers Accurately, PLDI 1990. It computes in
// double, and compares exactly, in integers, where the error could change the answer. Departs: the answer is
// a float, so double has 29 spare bits and one number in 60 million needs the exact comparison.
#include "scene/obj_number.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

// A decimal number: its digits as an integer, times 10^exponent.
typedef struct Decimal {
    const char* first;       // first significant digit
    const char* end;         // behind the last digit; a point may lie between
    uint64_t leading;        // the first 19 significant digits
    int64_t leadingExponent; // of the last of these
    int64_t exponent;        // of the last digit of all
    bool negative;
} Decimal;

enum {
    MOST_DIGITS = 120, // a midpoint of two floats has at most 113
    WORDS = 32         // of a BigInteger: 10^167 times 2^25 needs 580 bits, 121 digits times 2^150 need 552
};

static bool isDigit(char c)
{
    return c >= '0' && c <= '9';
}

// ---- exact comparison

typedef struct BigInteger {
    uint32_t words[WORDS]; // least significant first
    int count;
} BigInteger;

static void multiplyAdd(BigInteger* w, uint32_t factor, uint32_t summand)
{
    uint64_t carry = summand;
    for (int i = 0; i < w->count; i++) {
        carry += (uint64_t)w->words[i] * factor;
        w->words[i] = (uint32_t)carry;
        carry >>= 32;
    }
    if (carry != 0 && w->count < WORDS) {
        w->words[w->count++] = (uint32_t)carry;
    }
}

static void multiplyPower(BigInteger* w, uint32_t base, int64_t exponent)
{
    for (; exponent > 0; exponent--) {
        multiplyAdd(w, base, 0);
    }
}

static int compare(const BigInteger* a, const BigInteger* b)
{
    if (a->count != b->count) {
        return a->count < b->count ? -1 : 1;
    }
    for (int i = a->count - 1; i >= 0; i--) {
        if (a->words[i] != b->words[i]) {
            return a->words[i] < b->words[i] ? -1 : 1;
        }
    }
    return 0;
}

// The digits as an integer times 10^*exponent. If a digit beyond MOST_DIGITS is not 0, a single 1 replaces
// them all.
static BigInteger integerOf(const Decimal* d, int64_t* exponent)
{
    BigInteger w = {{0}, 0};
    int digits = 0;
    int64_t skipped = 0;
    bool more = false;
    for (const char* p = d->first; p < d->end; p++) {
        if (!isDigit(*p)) {
            continue;
        }
        if (digits < MOST_DIGITS) {
            multiplyAdd(&w, 10, (uint32_t)(*p - '0'));
            digits++;
        } else {
            skipped++;
            more = more || *p != '0';
        }
    }
    *exponent = d->exponent + skipped;
    if (more) {
        multiplyAdd(&w, 10, 1);
        --*exponent;
    }
    return w;
}

// The sign of the decimal minus the midpoint between the float of `bits` and the next float.
static int compareWithMidpoint(const Decimal* d, uint32_t bits)
{
    int64_t ten;
    BigInteger left = integerOf(d, &ten), right = {{0}, 0};
    uint32_t exponent = bits >> 23, mantissa = bits & 0x7FFFFF;
    mantissa |= exponent ? 0x800000 : 0;
    int two = (int)(exponent ? exponent : 1) - 151; // of the midpoint (2 mantissa + 1) * 2^two
    multiplyAdd(&right, 1, 2 * mantissa + 1);
    multiplyPower(&left, 10, ten);
    multiplyPower(&right, 10, -ten);
    multiplyPower(&left, 2, -two);
    multiplyPower(&right, 2, two);
    return compare(&left, &right);
}

// Walks from a guess, which is at most a few floats off, to the nearest.
static float refine(const Decimal* d, float guess)
{
    uint32_t bits;
    memcpy(&bits, &guess, sizeof bits);
    for (int side = 1; bits < 0x7F800000; bits++) {
        side = compareWithMidpoint(d, bits);
        if (side < 0 || (side == 0 && bits % 2 == 0)) {
            break;
        }
    }
    for (; bits > 0; bits--) {
        int side = compareWithMidpoint(d, bits - 1);
        if (side > 0 || (side == 0 && bits % 2 == 0)) {
            break;
        }
    }
    memcpy(&guess, &bits, sizeof guess);
    return guess;
}

// ---- approximation in double

// leading * 10^exponent within 4 units in the last place of a double.
static double approximate(uint64_t leading, int64_t exponent)
{
    static const double powers[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                    1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    double value = (double)leading;
    for (; exponent > 22; exponent -= 22) {
        value *= 1e22;
    }
    for (; exponent < -22; exponent += 22) {
        value /= 1e22;
    }
    return exponent < 0 ? value / powers[-exponent] : value * powers[exponent];
}

static float nearestFloat(const Decimal* d)
{
    if (d->leading == 0) {
        return 0;
    }
    if (d->leadingExponent > 40 || d->leadingExponent < -70) { // leading is in [1, 1e19]
        return d->leadingExponent > 0 ? INFINITY : 0;
    }
    double value = approximate(d->leading, d->leadingExponent);
    if (value > 1e39 || value < 1e-46) {
        return value > 1 ? INFINITY : 0;
    }
    // The 29 bits that a float lacks round up or down clearly unless they are close to one half. Denormal
    // floats lack more bits.
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    int64_t overHalf = (int64_t)(bits & 0x1FFFFFFF) - 0x10000000;
    bool clear = (overHalf > 16 || overHalf < -16) && value >= 0x1p-126 && value < 0x1p128;
    return clear ? (float)value : refine(d, (float)value);
}

// ---- syntax

// Reads digits around an optional point; false if there is no digit.
static bool readDigits(const char** at, const char* end, Decimal* d)
{
    const char* p = *at;
    bool point = false, any = false;
    int significant = 0;
    for (; p < end && (isDigit(*p) || (*p == '.' && !point)); p++) {
        if (*p == '.') {
            point = true;
            continue;
        }
        any = true;
        d->exponent -= point;
        if (significant == 0 && *p == '0') {
            d->leadingExponent -= point;
            continue;
        }
        if (significant++ == 0) {
            d->first = p;
        }
        if (significant <= 19) {
            d->leading = 10 * d->leading + (uint64_t)(*p - '0');
            d->leadingExponent -= point;
        } else {
            d->leadingExponent += !point;
        }
    }
    d->end = p;
    *at = p;
    return any;
}

// Reads an exponent. It saturates beyond anything that the number of digits in a file could compensate.
static bool readExponent(const char** at, const char* end, int64_t* out)
{
    const char* p = *at;
    bool negative = p < end && *p == '-';
    p += p < end && (*p == '-' || *p == '+');
    const char* digits = p;
    int64_t value = 0;
    for (; p < end && isDigit(*p); p++) {
        value = value > (int64_t)1 << 50 ? value : 10 * value + (*p - '0');
    }
    *out = negative ? -value : value;
    *at = p;
    return p > digits;
}

bool vplReadNumber(const char* start, const char* end, float* out)
{
    const char* p = start;
    Decimal d = {.negative = p < end && *p == '-'};
    int64_t exponent = 0;
    p += p < end && (*p == '-' || *p == '+');
    if (!readDigits(&p, end, &d)) {
        return false;
    }
    if (p < end && (*p == 'e' || *p == 'E')) {
        p++;
        if (!readExponent(&p, end, &exponent)) {
            return false;
        }
    }
    if (p != end) {
        return false;
    }
    d.exponent += exponent;
    d.leadingExponent += exponent;
    float value = nearestFloat(&d);
    *out = d.negative && value != 0 ? -value : value; // -0 and 0 are the same point
    return true;
}
