// SPDX-License-Identifier: MIT
#include "render/state_stream.h"

#include "base/bytes.h"
#include "base/hash.h"

#include <math.h>
#include <string.h>

void vplStream_Word(vplStream* s, uint32_t* word)
{
    uint8_t* b = s->bytes + s->at;
    s->at += 4;
    if (s->writes) {
        vplPutWord(b, *word);
    } else {
        *word = vplTakeWord(b);
    }
}

void vplStream_Long(vplStream* s, uint64_t* value)
{
    uint32_t low = (uint32_t)*value, high = (uint32_t)(*value >> 32);
    vplStream_Word(s, &low);
    vplStream_Word(s, &high);
    *value = (uint64_t)high << 32 | low;
}

void vplStream_Doubles(vplStream* s, double* values, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        uint64_t bits;
        memcpy(&bits, &values[i], sizeof bits);
        vplStream_Long(s, &bits);
        memcpy(&values[i], &bits, sizeof bits);
        s->finite = s->finite && isfinite(values[i]);
    }
}

void vplStream_Floats(vplStream* s, float* values, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        uint32_t bits;
        memcpy(&bits, &values[i], sizeof bits);
        vplStream_Word(s, &bits);
        memcpy(&values[i], &bits, sizeof bits);
        s->finite = s->finite && isfinite(values[i]);
    }
}

bool vplStream_AreSmall(const float* values, size_t count, double most)
{
    bool small = true;
    for (size_t k = 0; k < count; k++) {
        small = small && fabs((double)values[k]) <= most;
    }
    return small;
}

uint64_t vplState_Checksum(const uint8_t* bytes, size_t size)
{
    vplStream s = {.bytes = (uint8_t*)bytes};
    uint32_t words[1024];
    uint64_t state = 0;
    while (s.at < size) {
        size_t n = 0;
        for (; n < 1024 && s.at < size; n++) {
            vplStream_Word(&s, &words[n]);
        }
        state = vplHashWords(state, words, n);
    }
    return state;
}
