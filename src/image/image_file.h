// SPDX-License-Identifier: MIT
// Encoders and decoders of picture formats. vplImage_Write and vplImage_Read choose one by the file's
// extension.
#ifndef VPL_IMAGE_IMAGE_FILE_H
#define VPL_IMAGE_IMAGE_FILE_H

#include <vpl/imagetools.h>

#include "base/file.h"

enum {
    VPL_WRITE_COOKIE = 0x56504c32,
    VPL_REINHARD_COOKIE = 0x56504c33,
    VPL_HEATMAP_COOKIE = 0x56504c48,
    VPL_PIXELS_COOKIE
};

// Encoders append a file to the buffer. The caller checks buffer->failed.
typedef vplResult vplEncodeFcn(const vplImage* image, const vplWriteOptions* options, vplByteBuffer* buffer);
vplEncodeFcn vplEncodePng, vplEncodeHdr, vplEncodePfm, vplEncodeExr;

// Makes the codes of an 8-bit picture, three bytes a pixel, after exposure and tone map. Free them with vplFree.
vplResult vplMakeCodes(const vplImage* image, const vplWriteOptions* options, uint8_t** codesOut);

// Fails unless exposure and tone map are in their ranges.
vplResult vplCheckDisplay(vplContext* context, const char* type, float exposure, vplToneMap tonemap);

// Decoders read a whole file. `path` is for messages.
typedef vplResult vplDecodeFcn(vplContext* context, const char* path, const uint8_t* bytes, size_t size,
                               vplImage** imageOut);
vplDecodeFcn vplDecodeLdr, vplDecodeHdr, vplDecodePfm, vplDecodeExr;

// The same for layers.
vplResult vplEncodeExrLayers(const vplLayer* layers, int count, vplByteBuffer* buffer);
vplResult vplDecodeExrLayer(vplContext* context, const char* path, const char* name, const uint8_t* bytes,
                            size_t size, vplImage** imageOut);

// True if OpenEXR is built in. If not, the functions for EXR fail with a message.
bool vplHasExr(void);

// Fails if a pixel is NaN or infinite, with a message that names `what` and the first such pixel.
vplResult vplImage_RequireFinite(const vplImage* image, const char* what);

#endif
