// SPDX-License-Identifier: MIT
// Based on: Lance Williams, Pyramidal Parametrics, SIGGRAPH 1983 (mip maps, trilinear lookup); Joel McCormack et al.,
// Feline: Fast Elliptical Lines for Anisotropic Texture Mapping, SIGGRAPH 1999 (several lookups along the longer
// side). Departs: levels of odd size are averaged by area instead of dropping a row, so that each level has the
// mean of the picture; the logarithm of the level is linear between powers of two, the same on each machine.
#include "scene/texture.h"

#include "base/arena.h"
#include "image/srgb.h"
#include "math/scalar.h"

#include <math.h>
#include <string.h>

static int halved(int size)
{
    return size > 1 ? size / 2 : 1;
}

static vplResult allocateLevels(vplTexture* t, int width, int height)
{
    for (bool last = false; !last; t->levelCount++) {
        vplTextureLevel* level = &t->levels[t->levelCount];
        const size_t count = (size_t)width * (size_t)height * VPL_TEXTURE_CHANNELS;
        *level = (vplTextureLevel){vplArena_Alloc(t->arena, count, sizeof(uint16_t)), width, height};
        last = width == 1 && height == 1;
        width = halved(width);
        height = halved(height);
    }
    return vplArena_Check(t->arena);
}

static uint16_t quantise(float x)
{
    return (uint16_t)(65535 * x + 0.5f);
}

typedef struct Decoding {
    const vplTextureDef* def;
    uint16_t* to;
    uint16_t linear[256]; // values of sRGB codes
} Decoding;

static void decodeRow(void* data, int y, int worker)
{
    (void)worker;
    const Decoding* d = data;
    const vplTextureDef* def = d->def;
    const int colours = def->channels < 3 ? 1 : 3;
    const size_t first = (size_t)y * (size_t)def->width, end = first + (size_t)def->width;
    const size_t channels = (size_t)def->channels;
    uint16_t* to = d->to + VPL_TEXTURE_CHANNELS * first;
    for (size_t i = first; i < end; i++, to += VPL_TEXTURE_CHANNELS) {
        const unsigned char* codes = def->texels != NULL ? def->texels + channels * i : NULL;
        const float* values = def->linear != NULL ? def->linear + channels * i : NULL;
        for (int c = 0; c < 3; c++) {
            const int from = colours == 1 ? 0 : c;
            to[c] = codes != NULL ? d->linear[codes[from]] : quantise(values[from]);
        }
        to[3] = 65535;
        if (def->channels == colours + 1) {
            to[3] = codes != NULL ? (uint16_t)(257 * codes[colours]) : quantise(values[colours]);
        }
    }
}

// Decodes the texels of the largest level.
static vplResult decode(vplContext* context, const vplTextureDef* def, uint16_t* to)
{
    Decoding d = {.def = def, .to = to};
    for (int code = 0; code < 256; code++) {
        d.linear[code] = quantise(vplSrgb_Decode((float)code / 255.0f));
    }
    return vplParallelForAsking(context, def->height, decodeRow, &d);
}

// The texels of one axis that a texel of the next level covers: first .. last, and how much of the first and the
// last. A whole texel counts as the size of the next level; all together count as the size of this one.
typedef struct Span {
    int first, last;
    uint64_t firstWeight, lastWeight;
} Span;

static Span spanOf(int i, int from, int to)
{
    const int64_t start = (int64_t)i * from, end = start + from;
    const int first = (int)(start / to), last = (int)((end - 1) / to);
    return (Span){first, last, (uint64_t)(((int64_t)first + 1) * to - start),
                  (uint64_t)(end - (int64_t)last * to)};
}

static uint64_t weightAt(const Span* s, int i, int whole)
{
    if (s->first == s->last) {
        return s->firstWeight + s->lastWeight - (uint64_t)whole;
    }
    return i == s->first ? s->firstWeight : i == s->last ? s->lastWeight : (uint64_t)whole;
}

static void averageTexel(const vplTextureLevel* from, const vplTextureLevel* to, Span across, Span down,
                         uint16_t* out)
{
    uint64_t sums[VPL_TEXTURE_CHANNELS] = {0}; // below 2^16 * 2^28: exact
    for (int y = down.first; y <= down.last; y++) {
        const uint64_t rowWeight = weightAt(&down, y, to->height);
        for (int x = across.first; x <= across.last; x++) {
            const uint64_t weight = rowWeight * weightAt(&across, x, to->width);
            const uint16_t* texel =
                from->texels + VPL_TEXTURE_CHANNELS * ((size_t)y * (size_t)from->width + (size_t)x);
            for (int c = 0; c < VPL_TEXTURE_CHANNELS; c++) {
                sums[c] += weight * texel[c];
            }
        }
    }
    const uint64_t total = (uint64_t)from->width * (uint64_t)from->height;
    for (int c = 0; c < VPL_TEXTURE_CHANNELS; c++) {
        out[c] = (uint16_t)((sums[c] + total / 2) / total);
    }
}

typedef struct Halving {
    const vplTextureLevel *from, *to;
} Halving;

static void averageRow(void* data, int y, int worker)
{
    (void)worker;
    const Halving* h = data;
    const Span down = spanOf(y, h->from->height, h->to->height);
    uint16_t* out = h->to->texels + VPL_TEXTURE_CHANNELS * (size_t)y * (size_t)h->to->width;
    for (int x = 0; x < h->to->width; x++, out += VPL_TEXTURE_CHANNELS) {
        averageTexel(h->from, h->to, spanOf(x, h->from->width, h->to->width), down, out);
    }
}

vplResult vplTexture_Create(vplContext* context, const vplTextureDef* def, vplTexture** textureOut)
{
    vplArena* arena = vplArena_Create(context);
    vplTexture* t = vplArena_AllocZero(arena, 1, sizeof *t);
    vplResult result = vplArena_Check(arena);
    if (result == VPL_SUCCESS) {
        *t = (vplTexture){.arena = arena, .wrapU = def->wrapU, .wrapV = def->wrapV, .users = 1};
        result = allocateLevels(t, def->width, def->height);
    }
    if (result == VPL_SUCCESS) {
        result = decode(context, def, t->levels[0].texels);
    }
    for (int i = 1; result == VPL_SUCCESS && i < t->levelCount; i++) {
        Halving halving = {&t->levels[i - 1], &t->levels[i]};
        result = vplParallelForAsking(context, t->levels[i].height, averageRow, &halving);
    }
    return vplArena_Deliver(arena, result, t, textureOut);
}

void vplTexture_Retain(vplTexture* texture)
{
    texture->users++;
}

void vplTexture_Release(vplTexture* texture)
{
    if (--texture->users == 0) {
        vplArena_Destroy(texture->arena);
    }
}

// ---- lookup

// The index of a texel of an axis, from one that may be up to one texel outside of the picture.
static int wrapIndex(int i, int size, vplTextureWrap wrap)
{
    if (wrap == VPL_WRAP_REPEAT) {
        return i < 0 ? i + size : i >= size ? i - size : i;
    }
    return i < 0 ? 0 : i >= size ? size - 1 : i;
}

// Maps a texture coordinate to [0, 1].
static double wrapCoordinate(double t, vplTextureWrap wrap)
{
    if (wrap == VPL_WRAP_REPEAT) {
        return t - floor(t);
    }
    if (wrap == VPL_WRAP_MIRROR) {
        const double half = 0.5 * t, both = 2 * (half - floor(half));
        return both > 1 ? 2 - both : both;
    }
    return t > 0 ? (t < 1 ? t : 1) : 0;
}

// Adds `weight` times the bilinear interpolation of a level at (u, v) in [0, 1]; v = 0 is the bottom.
static void addBilinear(const vplTexture* t, int index, float u, float v, float weight, float sums[4])
{
    const vplTextureLevel* l = &t->levels[index];
    const float x = u * (float)l->width - 0.5f, y = (1 - v) * (float)l->height - 0.5f;
    const float left = floorf(x), top = floorf(y), fx = x - left, fy = y - top;
    const int x0 = wrapIndex((int)left, l->width, t->wrapU),
              x1 = wrapIndex((int)left + 1, l->width, t->wrapU);
    const int y0 = wrapIndex((int)top, l->height, t->wrapV),
              y1 = wrapIndex((int)top + 1, l->height, t->wrapV);
    const uint16_t* upper = l->texels + VPL_TEXTURE_CHANNELS * (size_t)y0 * (size_t)l->width;
    const uint16_t* lower = l->texels + VPL_TEXTURE_CHANNELS * (size_t)y1 * (size_t)l->width;
    const uint16_t *a = upper + VPL_TEXTURE_CHANNELS * x0, *b = upper + VPL_TEXTURE_CHANNELS * x1;
    const uint16_t *c = lower + VPL_TEXTURE_CHANNELS * x0, *d = lower + VPL_TEXTURE_CHANNELS * x1;
    const float scale = weight * (1 / 65535.0f);
    const float wa = (1 - fx) * (1 - fy) * scale, wb = fx * (1 - fy) * scale;
    const float wc = (1 - fx) * fy * scale, wd = fx * fy * scale;
    for (int i = 0; i < 4; i++) {
        sums[i] += wa * (float)a[i] + wb * (float)b[i] + wc * (float)c[i] + wd * (float)d[i];
    }
}

// Logarithm to base 2 of x > 0, interpolated linearly between powers of two: at most 0.086 too low.
static float roughLog2(float x)
{
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    return (float)(bits >> 23) - 127 + (float)(bits & 0x7fffff) * 0x1p-23f;
}

static float lengthOf(float x, float y)
{
    return sqrtf(x * x + y * y);
}

void vplTexture_Lookup(const vplTexture* t, const vplTextureArea* area, float rgbaOut[4])
{
    const float width = (float)t->levels[0].width, height = (float)t->levels[0].height;
    const float longer = lengthOf(area->longU * width, area->longV * height);
    const float shorter = lengthOf(area->shortU * width, area->shortV * height);
    const float along = longer > shorter ? longer : shorter, least = longer > shorter ? shorter : longer;
    // The probes share the longer side, and each is at least as wide as the shorter one.
    int probes = 1;
    while (probes < VPL_TEXTURE_PROBES && along > (float)probes * least && along > (float)probes) {
        probes++;
    }
    if (!(along < VPL_TEXTURE_PROBES * (width > height ? width : height))) {
        probes = 1; // averages over all of the picture; sides may be infinite
    }
    const float size = along / (float)probes;
    float level = size > 1 ? roughLog2(size) : 0;
    level = level < (float)(t->levelCount - 1) ? level : (float)(t->levelCount - 1); // also for infinity
    const int lower = (int)level, upper = lower + 1 < t->levelCount ? lower + 1 : lower;
    const float between = level - (float)lower, weight = 1 / (float)probes;
    const double stepU = probes == 1 ? 0 : longer > shorter ? area->longU : area->shortU;
    const double stepV = probes == 1 ? 0 : longer > shorter ? area->longV : area->shortV;
    float sums[4] = {0, 0, 0, 0};
    for (int i = 0; i < probes; i++) {
        const double at = (i + 0.5) / probes - 0.5;
        const float u = (float)wrapCoordinate(area->u + at * stepU, t->wrapU);
        const float v = (float)wrapCoordinate(area->v + at * stepV, t->wrapV);
        addBilinear(t, lower, u, v, weight * (1 - between), sums);
        if (between > 0) {
            addBilinear(t, upper, u, v, weight * between, sums);
        }
    }
    for (int i = 0; i < 4; i++) {
        rgbaOut[i] = sums[i] < 1 ? sums[i] : 1; // rounding may exceed 1
    }
}
