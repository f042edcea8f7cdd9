// SPDX-License-Identifier: MIT
// The program's own options; those of rendering are in vpl/options.def.
#ifndef VPL_CLI_OPTIONS_H
#define VPL_CLI_OPTIONS_H

#include "cli/cli.h"

typedef struct Option Option;

// Stores a value in the arguments, or complains and returns false.
typedef bool ReadFcn(const Option* option, const char* value, Arguments* arguments);

struct Option {
    const char* name;     // with its dashes
    const char* value;    // what it takes: "N", or its choices: "a|b|c"; NULL: a flag
    const char* default_; // as a value, or NULL: none, or the help says what
    int commands;         // bits
    ReadFcn* read;
    size_t offset;    // in Arguments
    double low, high; // of numbers
    const char* help;
};

extern const Option OPTIONS[];
extern const int OPTION_COUNT;

// Whether a command takes an option of rendering.
bool takesOption(const Command* command, const vplOption* option);

#endif
