// SPDX-License-Identifier: MIT
// Declarations that the parts of bench/roofline share. Based on: Samuel Williams, Andrew Waterman and David
// Patterson, Roofline: An Insightful Visual Performance Model for Multicore Architectures, CACM 52(4), 2009.
// Departs: one bound per resource (kinds of arithmetic, table look-ups, bytes of L1), the lowest of which is
// the roof.
#ifndef VPL_BENCH_ROOFLINE_H
#define VPL_BENCH_ROOFLINE_H

#include "base/context.h"

// Peak rates per second: lanes of arithmetic, table look-ups, or bytes.
typedef enum Peak {
    PEAK_MUL_ADD, // multiplications and additions in equal numbers, both counted
    PEAK_MUL,
    PEAK_ADD,
    PEAK_FMA,    // both counted; for reference: the library uses none
    PEAK_DOUBLE, // as PEAK_MUL_ADD
    PEAK_DIVIDE,
    PEAK_ROOT,
    PEAK_TO_DOUBLE, // conversions
    PEAK_TO_FLOAT,
    PEAK_TO_INT,    // float to int32
    PEAK_GATHER_L1, // table[index[i]], table of 16 KB
    PEAK_GATHER_L2, // table of 512 KB
    PEAK_READ_L1,
    PEAK_WRITE_L1,
    PEAK_COPY_L1, // bytes read and bytes written, both counted
    PEAK_READ_L2,
    PEAK_WRITE_L2,
    PEAK_COPY_L2,
    PEAK_READ_MEMORY,
    PEAK_WRITE_MEMORY,
    PEAK_COPY_MEMORY,
    PEAK_CLOCK, // cycles, from a chain of shift and exclusive or, which takes two
    PEAK_COUNT
} Peak;

// Memory of one thread.
enum {
    L1_BYTES = 16 << 10,
    L2_BYTES = 384 << 10,
    MEMORY_BYTES = 128 << 20,
    TABLE_BYTES = 512 << 10,
    WAYS = 1024
};

typedef struct Arena {
    float* memory;   // MEMORY_BYTES of normal floats
    double* results; // WAYS
    int32_t* index;  // 2 * WAYS: into tables of L1_BYTES and of TABLE_BYTES
    volatile float sink, zero;
} Arena;

// Performs the operation for at least about a tenth of a millisecond; returns how many were done.
typedef double PeakFcn(Arena* arena, Peak peak);

PeakFcn* getPeak(vplIsa isa);

// The least work of one item of a loop, counted from the source of its kernel. Operations whose results the
// compiler may drop are not counted.
typedef struct Costs {
    double mul, add, other; // lanes of float arithmetic; other: minimum, compare, select, logic, int32
    double doubles;         // lanes of double arithmetic
    double divide, root;
    double toFloat, toInt; // conversions from double, from float to int32 or back
    double gather;
    double read, written; // bytes of L1, including scratch
} Costs;

typedef struct Loop {
    const char* name;
    const char* item;
    Costs costs;
    const char* probeOf;                  // NULL: a loop; else the loop of which this is a variant...
    const char* question;                 // ...and the question that the ratio of the two answers
    double (*run)(void* work, int which); // returns how many items were done
    int which;
} Loop;

extern const Loop LOOPS[];
extern const int LOOP_COUNT;

// The data that the loops work on; each instruction set has its own.
typedef struct Work Work;
Work* openWork(vplIsa isa);
void closeWork(Work* work);

#endif
