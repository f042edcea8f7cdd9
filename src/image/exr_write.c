// SPDX-License-Identifier: MIT
// Writes layers of float or UINT scanlines with ZIP compression.
#include "image/exr.h"

#if !VPL_EXR

vplResult vplEncodeExrLayers(const vplLayer* layers, int count, vplByteBuffer* buffer)
{
    (void)count;
    (void)buffer;
    return vplFail(layers[0].image->context, VPL_INVALID_ARGUMENT,
                   "this build has no OpenEXR and writes no EXR picture");
}

#else

#include <errno.h>
#include <stdio.h>

// Adds the channels of layer i. A channel that is added twice would make OpenEXRCore hang when the file is closed, so it is refused.
static exr_result_t addChannels(exr_context_t exr, int part, const vplLayer* layers, int i)
{
    const vplLayer* layer = &layers[i];
    static const char* const letters[] = {"RGB", "XYZ"};
    const bool whole = layer->kind == VPL_LAYER_INDEX, single = whole || layer->kind == VPL_LAYER_NUMBER;
    const exr_perceptual_treatment_t treatment =
        layer->kind == VPL_LAYER_COLOUR ? EXR_PERCEPTUALLY_LOGARITHMIC : EXR_PERCEPTUALLY_LINEAR;
    for (int c = 0; c < (single ? 1 : 3); c++) {
        char name[64];
        snprintf(name, sizeof name, single ? "%s" : "%s%s%c", layer->name, layer->name[0] != 0 ? "." : "",
                 single ? 0 : letters[layer->kind][c]);
        for (int k = 0; k < i; k++) {
            if (vplFindExrChannel(layers[k].name, name) >= 0) {
                return EXR_ERR_INVALID_ARGUMENT;
            }
        }
        TRY_EXR(exr_add_channel(exr, part, name, whole ? EXR_PIXEL_UINT : EXR_PIXEL_FLOAT, treatment, 1, 1));
    }
    return EXR_ERR_SUCCESS;
}

static exr_result_t addNames(exr_context_t exr, int part, const vplLayer* layer)
{
    char name[64];
    snprintf(name, sizeof name, "%s.names", layer->name);
    return layer->nameCount > 0 ? exr_attr_set_string_vector(exr, part, name, layer->nameCount, layer->names)
                                : EXR_ERR_SUCCESS;
}

static exr_result_t writeHeader(exr_context_t exr, const vplLayer* layers, int count)
{
    const vplImage* image = layers[0].image;
    int part;
    TRY_EXR(exr_add_part(exr, "picture", EXR_STORAGE_SCANLINE, &part));
    TRY_EXR(exr_initialize_required_attr_simple(exr, part, image->width, image->height, EXR_COMPRESSION_ZIP));
    for (int i = 0; i < count; i++) {
        TRY_EXR(addChannels(exr, part, layers, i));
        TRY_EXR(addNames(exr, part, &layers[i]));
    }
    return exr_write_header(exr);
}

// Writes a chunk to the file, which is the pipeline's user data. A reader takes a chunk of as many bytes as
// its raw pixels for uncompressed. OpenEXRCore up to 3.4.7 writes the compressed bytes even then, so that the
// pixels would be read wrong; this function writes the raw ones.
// Source: "Scan Line Blocks" in The OpenEXR File Layout; OpenEXR issue 2306.
static exr_result_t writeChunk(exr_encode_pipeline_t* p)
{
    const bool gains = p->compressed_bytes < p->packed_bytes;
    return exr_write_scanline_chunk(p->encoding_user_data, p->part_index, p->chunk.start_y,
                                    gains ? p->compressed_buffer : p->packed_buffer,
                                    gains ? p->compressed_bytes : p->packed_bytes);
}

// The first value of a channel.
static const float* findPixels(const vplLayer* layers, const char* channel)
{
    while (vplFindExrChannel(layers->name, channel) < 0) {
        layers++;
    }
    return layers->image->pixels + vplFindExrChannel(layers->name, channel);
}

static exr_result_t writeRows(exr_context_t exr, const vplLayer* layers, exr_encode_pipeline_t* pipeline)
{
    const vplImage* image = layers[0].image;
    int32_t step = 1;
    TRY_EXR(exr_get_scanlines_per_chunk(exr, 0, &step));
    for (int y = 0; y < image->height; y += step) {
        exr_chunk_info_t chunk;
        TRY_EXR(exr_write_scanline_chunk_info(exr, 0, y, &chunk));
        TRY_EXR((y == 0 ? exr_encoding_initialize : exr_encoding_update)(exr, 0, &chunk, pipeline));
        for (int c = 0; c < pipeline->channel_count; c++) {
            exr_coding_channel_info_t* channel = &pipeline->channels[c];
            vplDescribeExrChannel(channel, image->width);
            channel->encode_from_ptr = (const uint8_t*)(findPixels(layers, channel->channel_name) +
                                                        3 * (size_t)y * (size_t)image->width);
        }
        if (y == 0) {
            TRY_EXR(exr_encoding_choose_default_routines(exr, 0, pipeline));
            pipeline->encoding_user_data = exr;
            pipeline->write_fn = writeChunk;
        }
        TRY_EXR(exr_encoding_run(exr, 0, pipeline));
    }
    return EXR_ERR_SUCCESS;
}

static exr_result_t encode(exr_context_t* exr, const vplLayer* layers, int count,
                           exr_encode_pipeline_t* pipeline, const exr_context_initializer_t* init)
{
    TRY_EXR(exr_start_write(exr, "picture.exr", EXR_WRITE_FILE_DIRECTLY, init));
    TRY_EXR(writeHeader(*exr, layers, count));
    return writeRows(*exr, layers, pipeline);
}

vplResult vplEncodeExrLayers(const vplLayer* layers, int count, vplByteBuffer* buffer)
{
    vplContext* context = layers[0].image->context;
    vplExrStream stream = {.buffer = buffer};
    const exr_context_initializer_t init = vplDescribeExrStream(&stream);
    exr_context_t exr = NULL;
    exr_encode_pipeline_t pipeline = EXR_ENCODE_PIPELINE_INITIALIZER;
    errno = 0;
    exr_result_t r = encode(&exr, layers, count, &pipeline, &init);
    exr_encoding_destroy(exr, &pipeline);
    const exr_result_t finished = exr_finish(&exr);
    r = r == EXR_ERR_SUCCESS ? finished : r;
    if (r == EXR_ERR_SUCCESS || buffer->failed) {
        return VPL_SUCCESS; // the caller checks the buffer
    }
    if (vplExrLacksMemory(r)) {
        return vplFail(context, VPL_OUT_OF_MEMORY, "out of memory while encoding an EXR picture");
    }
    return vplFail(context, VPL_INVALID_ARGUMENT, "cannot encode an EXR picture: %s",
                   exr_get_default_error_message(r));
}

#endif

vplResult vplEncodeExr(const vplImage* image, const vplWriteOptions* options, vplByteBuffer* buffer)
{
    (void)options;
    return vplEncodeExrLayers(&(vplLayer){.name = "", .image = image}, 1, buffer);
}
