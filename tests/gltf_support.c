// SPDX-License-Identifier: MIT
#include "gltf_support.h"

#include "base/bytes.h"

#include <stdlib.h>
#include <unistd.h>

int addBytes(Blob* blob, const void* bytes, size_t size)
{
    const size_t at = (blob->size + 3) & ~(size_t)3;
    assert_true(at + size <= sizeof blob->bytes);
    memcpy(blob->bytes + at, bytes, size);
    blob->size = at + size;
    return (int)at;
}

int addFloats(Blob* blob, const float* values, int count)
{
    uint8_t bytes[sizeof blob->bytes];
    assert_true((size_t)count * sizeof *values <= sizeof bytes);
    return addBytes(blob, bytes, (size_t)(vplPutFloats(bytes, values, (size_t)count) - bytes));
}

static void putBase64(FILE* file, const Blob* blob)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < blob->size; i += 3) {
        unsigned bits = 0;
        for (size_t k = 0; k < 3; k++) {
            bits = bits << 8 | (i + k < blob->size ? blob->bytes[i + k] : 0);
        }
        for (int k = 0; k < 4; k++) {
            fputc(k > (int)(blob->size - i) ? '=' : digits[bits >> (18 - 6 * k) & 63], file);
        }
    }
}

static void putWord(FILE* file, size_t word)
{
    for (int k = 0; k < 4; k++) {
        fputc((int)(word >> (8 * k) & 255), file);
    }
}

static void writeBinary(FILE* file, const Blob* blob, const char* rest)
{
    char text[8192];
    int length =
        snprintf(text, sizeof text, "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":%zu}],%s}",
                 blob->size, rest);
    while (length % 4 != 0) {
        text[length++] = ' ';
    }
    const size_t padded = (blob->size + 3) & ~(size_t)3;
    fputs("glTF", file);
    putWord(file, 2);
    putWord(file, 12 + 8 + (size_t)length + 8 + padded);
    putWord(file, (size_t)length);
    fputs("JSON", file);
    fwrite(text, 1, (size_t)length, file);
    putWord(file, padded);
    fwrite("BIN", 1, 4, file);
    fwrite(blob->bytes, 1, padded, file);
}

void writeGltf(const char* path, const Blob* blob, const char* json, ...)
{
    char rest[8000];
    va_list arguments;
    va_start(arguments, json);
    assert_true(vsnprintf(rest, sizeof rest, json, arguments) < (int)sizeof rest);
    va_end(arguments);
    FILE* file = fopen(path, "wb");
    assert_non_null(file);
    if (strstr(path, ".glb") != NULL) {
        writeBinary(file, blob, rest);
    } else {
        fprintf(file,
                "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":%zu,\"uri\":\"data:;base64,",
                blob->size);
        putBase64(file, blob);
        fprintf(file, "\"}],%s}\n", rest);
    }
    fclose(file);
}

const char* deskPath(const Desk* d, const char* name)
{
    static char path[160];
    snprintf(path, sizeof path, "%s/%s", d->folder, name);
    return path;
}

vplScene* loadGltf(Desk* d, const char* name)
{
    vplScene* scene = NULL;
    d->said[0] = 0;
    if (vplScene_Load(d->context, deskPath(d, name), &scene) != VPL_SUCCESS) {
        fail_msg("%s", d->said);
    }
    unlink(deskPath(d, name));
    return scene;
}

void assertAround(double value, double wanted, double tolerance)
{
    if (!(fabs(value - wanted) <= tolerance)) {
        fail_msg("%.9g instead of %.9g", value, wanted);
    }
}
