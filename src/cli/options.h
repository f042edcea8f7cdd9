// SPDX-License-Identifier: MIT
// All options of the command line: the program's own, and those of rendering from vpl/options.def.
#ifndef VPL_CLI_OPTIONS_H
#define VPL_CLI_OPTIONS_H

#include "cli/cli.h"

typedef struct Option Option;

// Stores a value in the arguments, or complains and returns false.
typedef bool ReadFcn(const Option* option, const char* value, Arguments* arguments);

struct Option {
    const char* name;     // without dashes: one for a letter, two for a word
    const char* value;    // the kind of value, "N", or the choices, "a|b|c"; NULL: a flag
    const char* default_; // as a value; NULL: none, or described by the help
    int commands;         // bits
    ReadFcn* read;
    size_t offset;    // in Arguments
    double low, high; // of numbers
    const char* help;
    // The row of vpl/options.def, which has default and range; NULL: one of the program's own.
    const vplOption* render;
};

// The program's own options, then those of rendering; the name of the last row is NULL.
const Option* getOptions(void);

// "--" or "-", by the length of the name.
const char* dashesOf(const Option* option);

#endif
