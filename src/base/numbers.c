// SPDX-License-Identifier: MIT
#include "base/numbers.h"

#include <locale.h>
#include <stdio.h>
#include <stdlib.h>

// The thread's locale until leavePlain. Other threads keep theirs.
static locale_t enterPlain(void)
{
    return uselocale(newlocale(LC_ALL_MASK, "C", (locale_t)0));
}

static void leavePlain(locale_t before)
{
    const locale_t plain = uselocale(before);
    freelocale(plain);
}

double vplParseDouble(const char* text, char** end)
{
    const locale_t before = enterPlain();
    const double value = strtod(text, end);
    leavePlain(before);
    return value;
}

float vplParseFloat(const char* text, char** end)
{
    const locale_t before = enterPlain();
    const float value = strtof(text, end);
    leavePlain(before);
    return value;
}

int vplFormatList(char* text, size_t size, const char* format, va_list arguments)
{
    const locale_t before = enterPlain();
    const int length = vsnprintf(text, size, format, arguments);
    leavePlain(before);
    return length;
}

int vplFormat(char* text, size_t size, const char* format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    const int length = vplFormatList(text, size, format, arguments);
    va_end(arguments);
    return length;
}
