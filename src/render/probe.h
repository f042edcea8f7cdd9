// SPDX-License-Identifier: MIT
// Statistics of a scene and a camera from a few rays, for the estimates of a plan's time.
#ifndef VPL_RENDER_PROBE_H
#define VPL_RENDER_PROBE_H

#include <vpl/shading.h>

// Statistics of 96 rays through the picture, and of one ray from each surface that they hit.
typedef struct vplProbe {
    double seen;     // share of the picture where a surface is
    double enclosed; // share of the directions from surfaces in which there is something
    double
        facing; // share of pairs of a surface that is seen and one that light may come from, that face each other
} vplProbe;

vplProbe vplProbe_Take(const vplGeometry* geometry, const vplView* view, float nearPlane);

// About how many vertices the camera sees: those in the picture that nothing hides.
double vplProbe_SeenVertices(const vplGeometry* geometry, const vplView* view);

#endif
