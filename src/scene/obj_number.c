// SPDX-License-Identifier: MIT
// Reads decimal numbers: computes in double, and calls vplParseFloat only where the error of double could change the
// float. A float has 29 bits less than a double, so this concerns one number in 60 million.
#include "scene/obj_number.h"
#include "base/numbers.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// The value of the first 19 significant digits of a number: leading * 10^exponent.
typedef struct Decimal {
    uint64_t leading;
    int64_t exponent;
} Decimal;

static bool isDigit(char c)
{
    return c >= '0' && c <= '9';
}

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

// The nearest float to a number of value `d` whose digits are at `text`.
static float nearestFloat(const Decimal* d, const char* text)
{
    if (d->leading == 0) {
        return 0;
    }
    if (d->exponent > 40 || d->exponent < -70) { // leading is in [1, 1e19]
        return d->exponent > 0 ? INFINITY : 0;
    }
    double value = approximate(d->leading, d->exponent);
    if (value > 1e39 || value < 1e-46) {
        return value > 1 ? INFINITY : 0;
    }
    // The 29 bits that a float lacks round up or down clearly unless they are close to one half. Denormal
    // floats lack more bits.
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    int64_t overHalf = (int64_t)(bits & 0x1FFFFFFF) - 0x10000000;
    bool clear = (overHalf > 16 || overHalf < -16) && value >= 0x1p-126 && value < 0x1p128;
    return clear ? (float)value : vplParseFloat(text, NULL);
}

// Reads digits around an optional point; false if there is no digit.
static bool readDigits(const char** at, const char* end, Decimal* d)
{
    const char* p = *at;
    bool point = false, any = false;
    for (; p < end && (isDigit(*p) || (*p == '.' && !point)); p++) {
        if (*p == '.') {
            point = true;
            continue;
        }
        any = true;
        if (d->leading < 1000000000000000000) { // at most 18 digits so far
            d->leading = 10 * d->leading + (uint64_t)(*p - '0');
            d->exponent -= point;
        } else {
            d->exponent += !point;
        }
    }
    *at = p;
    return any;
}

bool vplReadInteger(const char** at, const char* end, int64_t* out)
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
    const bool negative = start < end && *start == '-';
    const char* digits = start + (start < end && (*start == '-' || *start == '+'));
    const char* p = digits;
    Decimal d = {0, 0};
    int64_t exponent = 0;
    if (!readDigits(&p, end, &d)) {
        return false;
    }
    if (p < end && (*p == 'e' || *p == 'E')) {
        p++;
        if (!vplReadInteger(&p, end, &exponent)) {
            return false;
        }
    }
    if (p != end) {
        return false;
    }
    d.exponent += exponent;
    const float value = nearestFloat(&d, digits);
    *out = negative && value != 0 ? -value : value; // -0 and 0 are the same point
    return true;
}
