// SPDX-License-Identifier: MIT
#ifndef VPL_RENDER_SHOW_PARABOLOID_H
#define VPL_RENDER_SHOW_PARABOLOID_H

#include <vpl/image.h>
#include <vpl/visibility.h>

// Position (0 to 1 across the geometry's bounds), normal (-1 to 1 as 0 to 1, on the side that is seen), albedo and
// distance (metres) of a map's texels side by side, one row per hemisphere; black where nothing is. The map must have
// triangles.
vplResult vplShowParaboloidMap(const vplParaboloidMap* map, const vplGeometry* geometry, vplImage** imageOut);

#endif
