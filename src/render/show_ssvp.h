// SPDX-License-Identifier: MIT
// Pictures of SSVP's stages.
#ifndef VPL_RENDER_SHOW_SSVP_H
#define VPL_RENDER_SHOW_SSVP_H

#include <vpl/image.h>
#include <vpl/lights.h>

// What an emitter lights first, four pictures side by side: position (0 to 1 from one end of the scene's bounds to the
// other), normal ((n + 1) / 2), reflectance, and flux as a share of its largest number; black where nothing is. A
// point's six faces are unfolded into a cross as those of its shadow map.
vplResult vplShowReflectiveMap(const vplReflectiveMap* map, const vplGeometry* geometry, vplImage** imageOut);

#endif
