// SPDX-License-Identifier: MIT
// Pictures of SSVP's maps, four side by side: position (0 to 1 from one end of the scene's bounds to the other), normal
// ((n + 1) / 2, on the side that is seen), reflectance, and a fourth as a share of its largest number. Black where
// nothing is.
#ifndef VPL_RENDER_SHOW_MAPS_H
#define VPL_RENDER_SHOW_MAPS_H

#include <vpl/image.h>
#include <vpl/lights.h>

// What an emitter lights first; the fourth is flux. A point's six faces are unfolded into a cross as those of its shadow
// map.
vplResult vplShowReflectiveMap(const vplReflectiveMap* map, const vplGeometry* geometry, vplImage** imageOut);

// What a cluster sees, one row per hemisphere; the fourth is distance. The map must have triangles.
vplResult vplShowParaboloidMap(const vplParaboloidMap* map, const vplGeometry* geometry, vplImage** imageOut);

#endif
