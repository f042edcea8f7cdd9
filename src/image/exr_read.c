// SPDX-License-Identifier: MIT
// Reads the RGB or grey (Y) scanlines of one layer with any compression that OpenEXRCore knows.
#include "image/exr.h"

#if !VPL_EXR

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

#include <errno.h>
#include <string.h>

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
        const int index = vplFindExrChannel(name, c->name.str);
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
            const int index = vplFindExrChannel(layout->name, channel->channel_name);
            float* to = image->pixels + 3 * (size_t)y * (size_t)image->width + (index > 0 ? index : 0);
            vplDescribeExrChannel(channel, image->width);
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

static vplResult failReading(vplContext* context, const char* path, const vplExrStream* stream,
                             exr_result_t r)
{
    if (vplExrLacksMemory(r)) {
        return vplFail(context, VPL_OUT_OF_MEMORY, "%s: out of memory while decoding", path);
    }
    return vplFail(context, VPL_PARSE_ERROR, "%s: cannot read the EXR picture: %s", path,
                   stream->reason[0] ? stream->reason : exr_get_default_error_message(r));
}

static vplResult decode(vplContext* context, exr_context_t exr, const char* path, const char* name,
                        const vplExrStream* stream, vplImage** imageOut)
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
    vplExrStream stream = {.bytes = bytes, .size = size};
    const exr_context_initializer_t init = vplDescribeExrStream(&stream);
    exr_context_t exr = NULL;
    errno = 0;
    const exr_result_t r = exr_start_read(&exr, "picture.exr", &init);
    if (r != EXR_ERR_SUCCESS) {
        return failReading(context, path, &stream, r);
    }
    const vplResult result = decode(context, exr, path, name, &stream, imageOut);
    exr_finish(&exr);
    return result;
}

#endif

vplResult vplDecodeExr(vplContext* context, const char* path, const uint8_t* bytes, size_t size,
                       vplImage** imageOut)
{
    return vplDecodeExrLayer(context, path, "", bytes, size, imageOut);
}
