// SPDX-License-Identifier: MIT
// Loops that measure a machine's peak rates and do nothing else. The file is compiled once per instruction
// set, with the flags of the library's kernels.
#include "roofline.h"

#include "base/isa.h"

#include <math.h>
#include <string.h>
#if defined(__x86_64__)
#include <immintrin.h>
#endif

#define IS_scalar     1
#define IS_sse2       0
#define IS_avx2       0
#define IS_avx512     0
#define IS_SCALAR_ISA VPL_JOIN(IS, VPL_KERNEL_ISA)

#if IS_SCALAR_ISA
typedef float Floats;
typedef double Doubles;
#else
#if defined(__AVX512F__)
enum { BYTES = 64 };
#elif defined(__AVX2__)
enum { BYTES = 32 };
#else
enum { BYTES = 16 };
#endif
typedef float Floats __attribute__((vector_size(BYTES)));
typedef double Doubles __attribute__((vector_size(BYTES)));
#endif

enum { FLOATS = sizeof(Floats) / sizeof(float), REPEATS = 20000, PASSES = 200 };

// Twelve independent chains keep two units busy: each operation takes three to four cycles, and up to two
// begin per cycle.
#define TWELVE(X) X(0) X(1) X(2) X(3) X(4) X(5) X(6) X(7) X(8) X(9) X(10) X(11)
#define BEGIN(k)  x##k = (a - a) + (float)(k + 1);
#define SUM(k)    sum += x##k;
#define MUL(k)    x##k = x##k * a;
#define ADD(k)    x##k = x##k + a;
#define BOTH(k)   MUL(k) ADD(k)

#define CHAINS(name, Type, step, count)                                                                      \
    static double name(Arena* arena)                                                                         \
    {                                                                                                        \
        Type a = (Type){0} + arena->zero + 0.9990234375f, sum = a - a;                                       \
        Type x0, x1, x2, x3, x4, x5, x6, x7, x8, x9, x10, x11;                                               \
        TWELVE(BEGIN)                                                                                        \
        for (int i = 0; i < REPEATS; i++) {                                                                  \
            step                                                                                             \
        }                                                                                                    \
        TWELVE(SUM)                                                                                          \
        float first;                                                                                         \
        memcpy(&first, &sum, sizeof first);                                                                  \
        arena->sink = first;                                                                                 \
        return 12.0 * REPEATS * (count) * (double)(sizeof(Type) / sizeof(Type##Lane));                       \
    }

typedef float FloatsLane;
typedef double DoublesLane;

CHAINS(mulAdd, Floats, TWELVE(BOTH), 2)
CHAINS(mulOnly, Floats, TWELVE(MUL), 1)
CHAINS(addOnly, Floats, TWELVE(ADD), 1)
CHAINS(doubleMulAdd, Doubles, TWELVE(BOTH), 2)

// FMA is written with intrinsics, because contraction is off, as in the library.
#if defined(__AVX512F__) && !IS_SCALAR_ISA
#define FUSE(k) x##k = (Floats)_mm512_fmadd_ps((__m512)x##k, (__m512)a, (__m512)a);
CHAINS(fused, Floats, TWELVE(FUSE), 2)
#elif defined(__AVX2__) && !IS_SCALAR_ISA
#define FUSE(k) x##k = (Floats)_mm256_fmadd_ps((__m256)x##k, (__m256)a, (__m256)a);
__attribute__((target("avx2,fma"))) CHAINS(fused, Floats, TWELVE(FUSE), 2)
#else
static double fused(Arena* arena)
{
    (void)arena;
    return 0;
}
#endif

// Keeps the compiler from merging a pass over arrays with the next one.
#define NEXT_PASS() __asm__ volatile("" ::: "memory")

#define PASS(name, From, To, expression)                                                                     \
    static double name(Arena* arena)                                                                         \
    {                                                                                                        \
        const From* restrict from = (const From*)(void*)arena->memory;                                       \
        To* restrict to = (To*)(void*)arena->results;                                                        \
        for (int pass = 0; pass < PASSES; pass++) {                                                          \
            for (int i = 0; i < WAYS; i++) {                                                                 \
                to[i] = expression;                                                                          \
            }                                                                                                \
            NEXT_PASS();                                                                                     \
        }                                                                                                    \
        return (double)PASSES * WAYS;                                                                        \
    }

PASS(divide, float, float, 3 / from[i])
PASS(root, float, float, sqrtf(from[i]))
PASS(toDouble, float, double, from[i])
PASS(toFloat, double, float, (float)from[i])
PASS(toInt, float, int32_t, (int32_t)from[i])

static double gather(Arena* arena, const int32_t* restrict index)
{
    const float* restrict table = arena->memory;
    float sum[16] = {0};
    for (int pass = 0; pass < PASSES; pass++) {
        for (int i = 0; i < WAYS; i += 16) {
            for (int l = 0; l < 16; l++) {
                sum[l] += table[index[i + l]];
            }
        }
        NEXT_PASS();
    }
    for (int l = 0; l < 16; l++) {
        arena->sink = sum[l];
    }
    return (double)PASSES * WAYS;
}

static int passesOver(size_t bytes)
{
    return bytes > (size_t)L2_BYTES ? 1 : (int)((8u << 20) / bytes);
}

static double readBytes(Arena* arena, size_t bytes)
{
    const Floats* from = (const Floats*)(void*)arena->memory;
    const size_t count = bytes / sizeof(Floats);
    Floats s0 = (Floats){0}, s1 = s0, s2 = s0, s3 = s0, s4 = s0, s5 = s0, s6 = s0, s7 = s0;
    const int passes = passesOver(bytes);
    for (int pass = 0; pass < passes; pass++) {
        for (size_t i = 0; i < count; i += 8) {
            s0 += from[i];
            s1 += from[i + 1];
            s2 += from[i + 2];
            s3 += from[i + 3];
            s4 += from[i + 4];
            s5 += from[i + 5];
            s6 += from[i + 6];
            s7 += from[i + 7];
        }
        NEXT_PASS();
    }
    s0 += s1 + s2 + s3 + s4 + s5 + s6 + s7;
    float first;
    memcpy(&first, &s0, sizeof first);
    arena->sink = first;
    return (double)bytes * passes;
}

static double writeBytes(Arena* arena, size_t bytes)
{
    Floats* to = (Floats*)(void*)arena->memory;
    const size_t count = bytes / sizeof(Floats);
    const Floats value = (Floats){0} + arena->zero + 1.5f;
    const int passes = passesOver(bytes);
    for (int pass = 0; pass < passes; pass++) {
        for (size_t i = 0; i < count; i++) {
            to[i] = value;
        }
        NEXT_PASS();
    }
    return (double)bytes * passes;
}

// Multiplies by one, which costs nothing; for a plain copy the compiler would call memcpy, which stores
// differently.
static double copyBytes(Arena* arena, size_t bytes)
{
    const size_t count = bytes / 2 / sizeof(Floats);
    const Floats* restrict from = (const Floats*)(void*)arena->memory;
    Floats* restrict to = (Floats*)(void*)(arena->memory + bytes / 2 / sizeof(float));
    const Floats one = (Floats){0} + arena->zero + 1.0f;
    const int passes = passesOver(bytes);
    for (int pass = 0; pass < passes; pass++) {
        for (size_t i = 0; i < count; i++) {
            to[i] = from[i] * one;
        }
        NEXT_PASS();
    }
    return (double)bytes * passes;
}

static double clockCycles(Arena* arena)
{
    uint64_t x = (uint64_t)arena->index[0] | 1;
    for (int i = 0; i < REPEATS; i++) {
        x ^= x << 1;
        __asm__ volatile("" : "+r"(x));
    }
    arena->sink = (float)(x & 1);
    return 2.0 * REPEATS;
}

// Returns bandwidths in the order of the enum: read, write, copy of L1, L2, memory.
static double moveBytes(Arena* arena, int kind)
{
    static const size_t bytes[] = {L1_BYTES, L2_BYTES, MEMORY_BYTES};
    const size_t size = bytes[kind / 3];
    return kind % 3 == 0   ? readBytes(arena, size)
           : kind % 3 == 1 ? writeBytes(arena, size)
                           : copyBytes(arena, size);
}

PeakFcn VPL_KERNEL(runPeak);

double VPL_KERNEL(runPeak)(Arena* arena, Peak peak)
{
    switch (peak) {
    case PEAK_MUL_ADD:
        return mulAdd(arena);
    case PEAK_MUL:
        return mulOnly(arena);
    case PEAK_ADD:
        return addOnly(arena);
    case PEAK_FMA:
        return fused(arena);
    case PEAK_DOUBLE:
        return doubleMulAdd(arena);
    case PEAK_DIVIDE:
        return divide(arena);
    case PEAK_ROOT:
        return root(arena);
    case PEAK_TO_DOUBLE:
        return toDouble(arena);
    case PEAK_TO_FLOAT:
        return toFloat(arena);
    case PEAK_TO_INT:
        return toInt(arena);
    case PEAK_GATHER_L1:
        return gather(arena, arena->index);
    case PEAK_GATHER_L2:
        return gather(arena, arena->index + WAYS);
    case PEAK_CLOCK:
        return clockCycles(arena);
    default:
        return moveBytes(arena, (int)peak - PEAK_READ_L1);
    }
}
