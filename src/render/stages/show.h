// SPDX-License-Identifier: MIT
// Pictures of results of stages.
#ifndef VPL_RENDER_STAGES_SHOW_H
#define VPL_RENDER_STAGES_SHOW_H

#include "render/stage.h"

// Results instead of a picture: the first emitter's cube map unfolded into a cross, in metres; a reflective
// shadow map; the paraboloid map of a cluster.
vplResult vplShowCubeMap(const vplRun* run, vplImage** imageOut);
vplResult vplShowReflectiveMaps(const vplRun* run, vplImage** imageOut);
vplResult vplShowClusterMap(const vplRun* run, vplImage** imageOut);

// Marks over a picture, smaller where the camera cannot see them: virtual lights as discs in the colour of
// their step; first-bounce lights; first-bounce lights in the colours of their clusters, with the clusters'
// viewpoints; second-bounce lights.
vplResult vplDrawVirtualLights(const vplRun* run, vplImage* image);
vplResult vplDrawFirstBounce(const vplRun* run, vplImage* image);
vplResult vplDrawClusters(const vplRun* run, vplImage* image);
vplResult vplDrawSecondBounce(const vplRun* run, vplImage* image);

// ---- single maps
//
// Four pictures side by side: position (0 to 1 from one end of the scene's bounds to the other), normal ((n +
// 1) / 2, of the side that is seen), reflectance, and a fourth quantity divided by its largest value. They
// are black where a texel sees nothing.

// Shows a reflective shadow map; the fourth picture is flux. The six faces of a point light are unfolded as
// those of its shadow map.
vplResult vplShowReflectiveMap(const vplReflectiveMap* map, const vplGeometry* geometry, vplImage** imageOut);

// Shows a paraboloid map, one row per hemisphere; the fourth picture is distance. The map must have
// triangles.
vplResult vplShowParaboloidMap(const vplParaboloidMap* map, const vplGeometry* geometry, vplImage** imageOut);

#endif
