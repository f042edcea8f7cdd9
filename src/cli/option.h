// SPDX-License-Identifier: MIT
// How one option is described and read.
#ifndef VPL_CLI_OPTION_H
#define VPL_CLI_OPTION_H

#include "cli/cli.h"

typedef struct Option Option;

// Stores a value in the arguments, or complains and returns false.
typedef bool ReadFcn(const Option* option, const char* value, Arguments* arguments);

struct Option {
    const char* name;
    const char* value; // shown in the help; NULL for a flag
    int commands;      // bits: 1 << index in COMMANDS
    ReadFcn* read;
    size_t offset;
    double low, high;    // numbers
    const char* choices; // "a|b|c", in the order of the enum
    const char* help;
};

extern const Option OPTIONS[];
extern const int OPTION_COUNT;

// The bit of a command's name, 0 if there is none such.
int commandBit(const char* command);

// The value of an option that decides what a picture looks like, as option->read would read it; empty where only
// the default can be meant. False for all other options.
bool writeOption(const Option* option, const Arguments* arguments, char* text, size_t size);

// The same by the option's name.
void writeNamedOption(const char* name, const Arguments* arguments, char* text, size_t size);

ReadFcn readInt, readSeed, readFloat, readDouble, readFloatOrAuto, readReflectivity, readTonemap, readBias,
    readBiasSlope, readFlag, readText, readChoice, readShow, readSize, readThreads, readRegion, readGrid,
    readFrames;

#endif
