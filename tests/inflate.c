// SPDX-License-Identifier: MIT
// Based on: L. Peter Deutsch, DEFLATE Compressed Data Format Specification version 1.3, RFC 1951, 1996, and ZLIB Compressed Data
// Format Specification version 3.3, RFC 1950, 1996. One bit at a time: slow, and short enough to be seen to be right.
#include "inflate.h"

#include <stdbool.h>
#include <string.h>

enum { MOST_BITS = 15, LENGTH_CODES = 288, DISTANCE_CODES = 30, END_OF_BLOCK = 256 };

typedef struct Stream {
    const uint8_t* in;
    size_t size, at; // bytes
    int bit;         // the next of in[at]
    uint8_t* out;
    size_t capacity, count;
    bool broken;
} Stream;

// A canonical Huffman code: how many codes each length has, and symbols in the order of their codes.
typedef struct Code {
    int counts[MOST_BITS + 1];
    int symbols[LENGTH_CODES];
} Code;

static int readBits(Stream* s, int count)
{
    int value = 0;
    for (int i = 0; i < count; i++) {
        if (s->at >= s->size) {
            s->broken = true;
            return 0;
        }
        value |= (s->in[s->at] >> s->bit & 1) << i;
        s->bit = (s->bit + 1) % 8;
        s->at += s->bit == 0;
    }
    return value;
}

static void writeByte(Stream* s, uint8_t byte)
{
    s->broken = s->broken || s->count >= s->capacity;
    if (!s->broken) {
        s->out[s->count++] = byte;
    }
}

static Code makeCode(const uint8_t* lengths, int count)
{
    Code code = {{0}, {0}};
    int next[MOST_BITS + 2] = {0};
    for (int i = 0; i < count; i++) {
        code.counts[lengths[i]]++;
    }
    code.counts[0] = 0;
    for (int bits = 1; bits <= MOST_BITS; bits++) {
        next[bits + 1] = next[bits] + code.counts[bits];
    }
    for (int i = 0; i < count; i++) {
        if (lengths[i] > 0) {
            code.symbols[next[lengths[i]]++] = i;
        }
    }
    return code;
}

static int readSymbol(Stream* s, const Code* code)
{
    int value = 0, first = 0, index = 0; // of the codes with so many bits
    for (int bits = 1; bits <= MOST_BITS && !s->broken; bits++) {
        value |= readBits(s, 1);
        if (value - first < code->counts[bits]) {
            return code->symbols[index + value - first];
        }
        index += code->counts[bits];
        first = (first + code->counts[bits]) << 1;
        value <<= 1;
    }
    s->broken = true;
    return END_OF_BLOCK;
}

static void copyStored(Stream* s)
{
    s->at += s->bit > 0;
    s->bit = 0;
    const int length = readBits(s, 16), inverse = readBits(s, 16);
    s->broken = s->broken || (length ^ inverse) != 0xffff;
    for (int i = 0; i < length && !s->broken; i++) {
        writeByte(s, (uint8_t)readBits(s, 8));
    }
}

static void makeFixedCodes(Code* lengths, Code* distances)
{
    uint8_t bits[LENGTH_CODES];
    for (int i = 0; i < LENGTH_CODES; i++) {
        bits[i] = i < 144 ? 8 : i < 256 ? 9 : i < 280 ? 7 : 8;
    }
    *lengths = makeCode(bits, LENGTH_CODES);
    memset(bits, 5, DISTANCE_CODES);
    *distances = makeCode(bits, DISTANCE_CODES);
}

static void readCodes(Stream* s, Code* lengths, Code* distances)
{
    static const uint8_t order[19] = {16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15};
    uint8_t bits[LENGTH_CODES + 32] = {0};
    const int lengthCount = readBits(s, 5) + 257, distanceCount = readBits(s, 5) + 1,
              count = readBits(s, 4) + 4;
    for (int i = 0; i < count; i++) {
        bits[order[i]] = (uint8_t)readBits(s, 3);
    }
    const Code code = makeCode(bits, 19);
    for (int i = 0; i < lengthCount + distanceCount && !s->broken;) {
        const int symbol = readSymbol(s, &code);
        const uint8_t value = symbol < 16 ? (uint8_t)symbol : symbol == 16 && i > 0 ? bits[i - 1] : 0;
        int times = symbol < 16    ? 1
                    : symbol == 16 ? 3 + readBits(s, 2)
                    : symbol == 17 ? 3 + readBits(s, 3)
                                   : 11 + readBits(s, 7);
        s->broken = s->broken || i + times > lengthCount + distanceCount || (symbol == 16 && i == 0);
        for (; times > 0 && !s->broken; times--) {
            bits[i++] = value;
        }
    }
    s->broken = s->broken || lengthCount > LENGTH_CODES || distanceCount > DISTANCE_CODES;
    if (!s->broken) {
        *lengths = makeCode(bits, lengthCount);
        *distances = makeCode(bits + lengthCount, distanceCount);
    }
}

// Copies bytes that were written before. Codes of lengths and distances come in groups with one more bit each.
static void copyBack(Stream* s, int symbol, const Code* distances)
{
    static const uint8_t more[29] = {0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2,
                                     2, 3, 3, 3, 3, 4, 4, 4, 4, 5, 5, 5, 5, 0};
    int length = 3, distance = 1;
    if (symbol - 257 > 28) {
        s->broken = true;
        return;
    }
    for (int i = 0; i < symbol - 257; i++) {
        length += 1 << more[i];
    }
    length = symbol == 285 ? 258 : length + readBits(s, more[symbol - 257]);
    const int far = readSymbol(s, distances);
    for (int i = 0; i < far && i < DISTANCE_CODES; i++) {
        distance += 1 << (i < 2 ? 0 : i / 2 - 1);
    }
    distance += readBits(s, far < 2 ? 0 : far / 2 - 1);
    s->broken = s->broken || far >= DISTANCE_CODES || (size_t)distance > s->count;
    for (int i = 0; i < length && !s->broken; i++) {
        writeByte(s, s->out[s->count - (size_t)distance]);
    }
}

static void readBlock(Stream* s, int kind)
{
    Code lengths, distances;
    if (kind == 1) {
        makeFixedCodes(&lengths, &distances);
    } else {
        readCodes(s, &lengths, &distances);
    }
    while (!s->broken) {
        const int symbol = readSymbol(s, &lengths);
        if (symbol < END_OF_BLOCK) {
            writeByte(s, (uint8_t)symbol);
        } else if (symbol == END_OF_BLOCK) {
            return;
        } else {
            copyBack(s, symbol, &distances);
        }
    }
}

static uint32_t adler(const uint8_t* bytes, size_t count)
{
    uint32_t a = 1, b = 0;
    for (size_t i = 0; i < count; i++) {
        a = (a + bytes[i]) % 65521;
        b = (b + a) % 65521;
    }
    return b << 16 | a;
}

long inflateBytes(const uint8_t* in, size_t size, uint8_t* out, size_t capacity)
{
    Stream s = {.in = in, .size = size, .at = 2, .out = out, .capacity = capacity};
    s.broken = size < 2 || (in[0] & 15) != 8 || (in[0] << 8 | in[1]) % 31 != 0 || (in[1] & 32) != 0;
    for (int last = 0; !last && !s.broken;) {
        last = readBits(&s, 1);
        const int kind = readBits(&s, 2);
        s.broken = s.broken || kind == 3;
        if (kind == 0) {
            copyStored(&s);
        } else if (!s.broken) {
            readBlock(&s, kind);
        }
    }
    s.at += s.bit > 0;
    if (s.broken || s.at + 4 != size) {
        return -1;
    }
    const uint32_t sum =
        (uint32_t)in[s.at] << 24 | (uint32_t)in[s.at + 1] << 16 | (uint32_t)in[s.at + 2] << 8 | in[s.at + 3];
    return sum == adler(out, s.count) ? (long)s.count : -1;
}
