// SPDX-License-Identifier: MIT
// Pictures of more pixels.
#ifndef VPL_IMAGE_ENLARGE_H
#define VPL_IMAGE_ENLARGE_H

#include <vpl/image.h>

// Makes a picture of width x height from one of fewer pixels that shows the same: each value is the bilinear mean of the four nearest pixels,
// at the border of two or one. All workers.
vplResult vplImage_Enlarge(const vplImage* image, int width, int height, vplImage** enlargedOut);

#endif
