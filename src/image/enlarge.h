// SPDX-License-Identifier: MIT
// Bilinear enlargement of pictures.
#ifndef VPL_IMAGE_ENLARGE_H
#define VPL_IMAGE_ENLARGE_H

#include <vpl/image.h>

// Enlarges a picture to width x height by bilinear interpolation between the centres of its pixels. Beyond the outermost centres their values are
// repeated. Uses all workers.
vplResult vplImage_Enlarge(const vplImage* image, int width, int height, vplImage** enlargedOut);

#endif
