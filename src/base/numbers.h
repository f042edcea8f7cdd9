// SPDX-License-Identifier: MIT
// Numbers as text with a decimal point, whatever locale the program has set: setlocale(LC_ALL, "") makes it a comma in half of
// the world, in strtod and printf too.
#ifndef VPL_BASE_NUMBERS_H
#define VPL_BASE_NUMBERS_H

#include "base/context.h"

#include <stdarg.h>

// strtod and strtof in the C locale.
double vplParseDouble(const char* text, char** end);
float vplParseFloat(const char* text, char** end);

// vsnprintf and snprintf in the C locale.
int vplFormatList(char* text, size_t size, const char* format, va_list arguments);
int vplFormat(char* text, size_t size, const char* format, ...) VPL_PRINTF(3, 4);

#endif
