// SPDX-License-Identifier: MIT
// OpenEXR pictures by OpenEXRCore. Writes layers of float or UINT scanlines with ZIP compression; reads the
// RGB or grey (Y) scanlines of one layer with any compression that OpenEXRCore knows. Pixels and the encoded
// file are in context memory. OpenEXRCore's own scratch memory, a few scanlines, is not: its allocation hooks
// take no user data. It never touches files itself, because vplWriteFile writes them whole or not at all.
#include "base/arena.h"
#include "image/image_file.h"

#if !VPL_EXR

bool vplHasExr(void)
{
    return false;
}

vplResult vplEncodeExrLayers(const vplLayer* layers, int count, vplByteBuffer* buffer)
{
    (void)count;
    (void)buffer;
    return vplFail(layers[0].image->context, VPL_INVALID_ARGUMENT,
                   "this build has no OpenEXR and writes no EXR picture");
}

vplResult vplDecodeExrLayer(vplContext* context, const char* path, const char* name, const uint8_t* bytes,
                            size_t size, vplImage** imageOut)
{
    (void)name;
    (void)bytes;
    (void)size;
    (void)imageOut;
    return vplFail(context, VPL_INVALID_ARGUMENT, "%s: this build has no OpenEXR and reads no EXR picture",
                   path);
}

#else

#include <OpenEXR/openexr.h>

#include <stdio.h>
#include <string.h>

// Returns from the calling function with the result of `expression` unless it succeeded.
#define TRY_EXR(expression)                                                                                  \
    do {                                                                                                     \
        const exr_result_t tryResult = (expression);                                                         \
        if (tryResult != EXR_ERR_SUCCESS) {                                                                  \
            return tryResult;                                                                                \
        }                                                                                                    \
    } while (0)

bool vplHasExr(void)
{
    return true;
}

// ---- reading from and writing to memory

// The user data of OpenEXRCore's callbacks.
typedef struct Stream {
    const uint8_t* bytes; // to read
    size_t size;
    vplByteBuffer* buffer; // to write
    char reason[160];      // of the first error, which OpenEXRCore would print
} Stream;

static void keepReason(exr_const_context_t exr, exr_result_t code, const char* message)
{
    (void)code;
    void* user;
    if (exr == NULL || exr_get_user_data(exr, &user) != EXR_ERR_SUCCESS || user == NULL) {
        return;
    }
    Stream* s = user;
    if (s->reason[0] != 0) {
        return;
    }
    // The message quotes names from the file, which may contain any byte.
    size_t length = 0;
    for (; message[length] != 0 && length + 1 < sizeof s->reason; length++) {
        bool printable = message[length] >= 0x20 && message[length] < 0x7F;
        s->reason[length] = (char)(printable ? message[length] : '?');
    }
    s->reason[length] = 0;
}

static int64_t readStream(exr_const_context_t exr, void* user, void* to, uint64_t size, uint64_t offset,
                          exr_stream_error_func_ptr_t fail)
{
    (void)exr;
    (void)fail;
    const Stream* s = user;
    if (offset >= s->size) {
        return 0;
    }
    const size_t left = s->size - (size_t)offset, count = left < size ? left : (size_t)size;
    memcpy(to, s->bytes + offset, count);
    return (int64_t)count;
}

static int64_t sizeStream(exr_const_context_t exr, void* user)
{
    (void)exr;
    return (int64_t)((const Stream*)user)->size;
}

// Appends, except for the table of chunks, which is overwritten at the end.
static int64_t writeStream(exr_const_context_t exr, void* user, const void* from, uint64_t size,
                           uint64_t offset, exr_stream_error_func_ptr_t fail)
{
    (void)exr;
    (void)fail;
    static const uint8_t zeros[256];
    vplByteBuffer* buffer = ((Stream*)user)->buffer;
    while (buffer->size < offset && !buffer->failed) {
        const uint64_t gap = offset - buffer->size;
        vplByteBuffer_Append(buffer, zeros, gap < sizeof zeros ? (size_t)gap : sizeof zeros);
    }
    if (buffer->failed) {
        return -1;
    }
    const size_t left = buffer->size - (size_t)offset, over = left < size ? left : (size_t)size;
    if (over > 0) {
        memcpy(buffer->bytes + (size_t)offset, from, over);
    }
    vplByteBuffer_Append(buffer, (const uint8_t*)from + over, (size_t)size - over);
    return buffer->failed ? -1 : (int64_t)size;
}

static void closeStream(exr_const_context_t exr, void* user, int failed)
{
    (void)exr;
    (void)user;
    (void)failed;
}

// The set-up of an OpenEXRCore context that uses the stream.
static exr_context_initializer_t describeStream(Stream* s)
{
    exr_context_initializer_t init = EXR_DEFAULT_CONTEXT_INITIALIZER;
    init.error_handler_fn = keepReason;
    init.user_data = s;
    init.read_fn = s->buffer ? NULL : readStream;
    init.size_fn = s->buffer ? NULL : sizeStream;
    init.write_fn = s->buffer ? writeStream : NULL;
    init.destroy_fn = closeStream;
    init.max_image_width = init.max_image_height = VPL_MAX_IMAGE_SIZE;
    return init;
}

// ---- channels

// Index in our pixels of a channel of the layer `name`, or -1. Grey and single channels are stored in red
// first.
// Source: layers and the names of channels are those of "Channel Names" and "Layers" in OpenEXR's Technical
// Introduction.
static int channelIndex(const char* name, const char* channel)
{
    static const char letters[] =
        "RGBXYZ"; // X, Y and Z only behind a name, where they are no grey and no depth
    const size_t length = strlen(name);
    if (strcmp(channel, length > 0 ? name : "Y") == 0) {
        return 0;
    }
    if (length > 0 && (strncmp(channel, name, length) != 0 || channel[length] != '.')) {
        return -1;
    }
    const char* last = channel + length + (length > 0);
    const char* at = last[0] != 0 && last[1] == 0 ? strchr(letters, last[0]) : NULL;
    return at != NULL && (length > 0 || at < letters + 3) ? (int)(at - letters) % 3 : -1;
}

static void describeChannel(exr_coding_channel_info_t* channel, int width)
{
    channel->user_bytes_per_element = 4;
    channel->user_data_type = EXR_PIXEL_FLOAT; // OpenEXRCore converts indices
    channel->user_pixel_stride = 3 * 4;
    channel->user_line_stride = 3 * 4 * width;
}

// ---- writing

// Adds the channels of layer i. OpenEXRCore must not see one twice: it would wait for itself for ever when
// the file is closed.
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
            if (channelIndex(layers[k].name, name) >= 0) {
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
    while (channelIndex(layers->name, channel) < 0) {
        layers++;
    }
    return layers->image->pixels + channelIndex(layers->name, channel);
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
            describeChannel(channel, image->width);
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
    Stream stream = {.buffer = buffer};
    const exr_context_initializer_t init = describeStream(&stream);
    exr_context_t exr = NULL;
    exr_encode_pipeline_t pipeline = EXR_ENCODE_PIPELINE_INITIALIZER;
    exr_result_t r = encode(&exr, layers, count, &pipeline, &init);
    exr_encoding_destroy(exr, &pipeline);
    const exr_result_t finished = exr_finish(&exr);
    r = r == EXR_ERR_SUCCESS ? finished : r;
    if (r == EXR_ERR_SUCCESS || buffer->failed) {
        return VPL_SUCCESS; // the caller checks the buffer
    }
    if (r == EXR_ERR_OUT_OF_MEMORY) {
        return vplFail(context, VPL_OUT_OF_MEMORY, "out of memory while encoding an EXR picture");
    }
    return vplFail(context, VPL_INVALID_ARGUMENT, "cannot encode an EXR picture: %s",
                   stream.reason[0] ? stream.reason : exr_get_default_error_message(r));
}

// ---- reading

typedef struct Layout {
    const char* name; // of the layer
    int width, height, firstRow;
    bool grey; // one channel
} Layout;

// Describes the picture; returns why it cannot be read, or NULL.
static const char* findLayout(exr_const_context_t exr, const char* name, Layout* layout)
{
    int parts = 0;
    exr_storage_t storage;
    if (exr_get_count(exr, &parts) != EXR_ERR_SUCCESS || parts != 1) {
        return "it has several parts, must have one";
    }
    if (exr_get_storage(exr, 0, &storage) != EXR_ERR_SUCCESS || storage != EXR_STORAGE_SCANLINE) {
        return "it is tiled or deep, must be flat scanlines";
    }
    exr_attr_box2i_t window;
    const exr_attr_chlist_t* list;
    if (exr_get_data_window(exr, 0, &window) != EXR_ERR_SUCCESS ||
        exr_get_channels(exr, 0, &list) != EXR_ERR_SUCCESS) {
        return "its header lacks the data window or the channels";
    }
    int64_t width = (int64_t)window.max.x - window.min.x + 1,
            height = (int64_t)window.max.y - window.min.y + 1;
    if (width < 1 || width > VPL_MAX_IMAGE_SIZE || height < 1 || height > VPL_MAX_IMAGE_SIZE) {
        return "its data window is empty or too large, each side must be in [1, 16384]";
    }
    *layout = (Layout){name, (int)width, (int)height, window.min.y, false};
    int found = 0; // bits: R, G, B, a single channel
    for (int i = 0; i < list->num_channels; i++) {
        const exr_attr_chlist_entry_t* c = &list->entries[i];
        const bool single = strcmp(c->name.str, name[0] != 0 ? name : "Y") == 0;
        const int index = channelIndex(name, c->name.str);
        if (index < 0) {
            continue; // alpha, depth and the like
        }
        if ((c->pixel_type == EXR_PIXEL_UINT && name[0] == 0) || c->x_sampling != 1 || c->y_sampling != 1) {
            return "its channels are integers or subsampled, must be half or float in every pixel";
        }
        found |= single ? 8 : 1 << index;
    }
    layout->grey = found == 8;
    return layout->grey || found == 7 ? NULL
           : name[0] != 0             ? "it has no layer of that name"
                                      : "its channels must be R, G and B, or Y";
}

static exr_result_t readRows(exr_context_t exr, const Layout* layout, vplImage* image,
                             exr_decode_pipeline_t* pipeline)
{
    int32_t step = 1;
    TRY_EXR(exr_get_scanlines_per_chunk(exr, 0, &step));
    for (int y = 0; y < layout->height; y += step) {
        exr_chunk_info_t chunk;
        TRY_EXR(exr_read_scanline_chunk_info(exr, 0, layout->firstRow + y, &chunk));
        // Refuses a chunk that would write outside the rows and columns expected here.
        if (chunk.start_y != layout->firstRow + y || chunk.width != layout->width ||
            chunk.height > layout->height - y) {
            return EXR_ERR_BAD_CHUNK_LEADER;
        }
        TRY_EXR((y == 0 ? exr_decoding_initialize : exr_decoding_update)(exr, 0, &chunk, pipeline));
        for (int c = 0; c < pipeline->channel_count; c++) {
            exr_coding_channel_info_t* channel = &pipeline->channels[c];
            const int index = channelIndex(layout->name, channel->channel_name);
            float* to = image->pixels + 3 * (size_t)y * (size_t)image->width + (index > 0 ? index : 0);
            describeChannel(channel, image->width);
            channel->decode_to_ptr = index < 0 ? NULL : (uint8_t*)to;
        }
        if (y == 0) {
            TRY_EXR(exr_decoding_choose_default_routines(exr, 0, pipeline));
        }
        TRY_EXR(exr_decoding_run(exr, 0, pipeline));
    }
    for (size_t i = 0; layout->grey && i < (size_t)image->width * (size_t)image->height; i++) {
        image->pixels[3 * i + 1] = image->pixels[3 * i + 2] = image->pixels[3 * i];
    }
    return EXR_ERR_SUCCESS;
}

static vplResult failReading(vplContext* context, const char* path, const Stream* stream, exr_result_t r)
{
    if (r == EXR_ERR_OUT_OF_MEMORY) {
        return vplFail(context, VPL_OUT_OF_MEMORY, "%s: out of memory while decoding", path);
    }
    return vplFail(context, VPL_PARSE_ERROR, "%s: cannot read the EXR picture: %s", path,
                   stream->reason[0] ? stream->reason : exr_get_default_error_message(r));
}

static vplResult decode(vplContext* context, exr_context_t exr, const char* path, const char* name,
                        const Stream* stream, vplImage** imageOut)
{
    Layout layout;
    const char* wrong = findLayout(exr, name, &layout);
    if (wrong != NULL) {
        return vplFail(context, VPL_PARSE_ERROR, "%s: cannot read this kind of EXR picture: %s", path, wrong);
    }
    vplImage* image;
    TRY(vplImage_Create(context, layout.width, layout.height, &image));
    exr_decode_pipeline_t pipeline = EXR_DECODE_PIPELINE_INITIALIZER;
    const exr_result_t r = readRows(exr, &layout, image, &pipeline);
    exr_decoding_destroy(exr, &pipeline);
    if (r != EXR_ERR_SUCCESS) {
        vplImage_Destroy(image);
        return failReading(context, path, stream, r);
    }
    *imageOut = image;
    return VPL_SUCCESS;
}

vplResult vplDecodeExrLayer(vplContext* context, const char* path, const char* name, const uint8_t* bytes,
                            size_t size, vplImage** imageOut)
{
    Stream stream = {.bytes = bytes, .size = size};
    const exr_context_initializer_t init = describeStream(&stream);
    exr_context_t exr = NULL;
    const exr_result_t r = exr_start_read(&exr, "picture.exr", &init);
    if (r != EXR_ERR_SUCCESS) {
        return failReading(context, path, &stream, r);
    }
    const vplResult result = decode(context, exr, path, name, &stream, imageOut);
    exr_finish(&exr);
    return result;
}

#endif

vplResult vplEncodeExr(const vplImage* image, const vplWriteOptions* options, vplByteBuffer* buffer)
{
    (void)options;
    return vplEncodeExrLayers(&(vplLayer){.name = "", .image = image}, 1, buffer);
}

vplResult vplDecodeExr(vplContext* context, const char* path, const uint8_t* bytes, size_t size,
                       vplImage** imageOut)
{
    return vplDecodeExrLayer(context, path, "", bytes, size, imageOut);
}
