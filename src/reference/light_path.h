// SPDX-License-Identifier: MIT
// Paths from lights, to which the vertices of paths from the camera connect.
#ifndef VPL_REFERENCE_LIGHT_PATH_H
#define VPL_REFERENCE_LIGHT_PATH_H

#include "reference/direct_light.h"

// A surface that a light path has met.
typedef struct vplLightVertex {
    vplPathVertex at;
    // The product of the reflectances of all vertices so far but the first, over the probabilities that the path went on.
    vplRgb carried;
    // The density of these vertices, over that with which a path from the camera finds them in reverse; differs from 1 where
    // normals are interpolated.
    double ratio;
    double edges; // as of vplPathState, of the edges between vertices so far
} vplLightVertex;

typedef struct vplLightPath {
    int count;           // of vertices; 0: there is no path
    vplConnection light; // of the first vertex with the light
    double weights;      // of light sampling and BSDF sampling there
    vplLightVertex vertices[VPL_MOST_LIGHT_VERTICES];
} vplLightPath;

// Follows a path from a light that `choice` selects, in a direction that u selects.
void vplLightPath_Follow(vplPathState* path, double choice, const float u[4], vplLightPath* out);

// Radiance that comes from the light path and is reflected at the vertex, after `bounce` bounces from the camera and with `throughput` on
// the way to it. The vertex connects to one vertex of the light path, which is chosen by what each would add without occlusion.
vplRadiance vplConnectToLightPath(vplPathState* path, const vplPathVertex* vertex, const vplLightPath* light,
                                  int bounce, vplRgb throughput);

// Where paths find more than this share of reflected light at vertices of light paths after the first, light paths of VPL_MOST_LIGHT_VERTICES have the
// smaller error in the same time, else those of one vertex. Share, and squared error times time over that with one vertex: corridor 0.77, 0.18; shade
// 0.66, 0.05; hall 0.38, 0.82; door-ajar 0.29, 1.1; cornell-area 0.20, 1.4; boxes 0.16, 1.4.
#define VPL_FURTHER_SHARE (1.0 / 3)

// Measures this share by paths through pixels all over the picture of the def, whose seed does not matter: they are the same for every seed.
vplResult vplMeasureFurther(const vplGeometry* geometry, const vplPathDef* def, double* shareOut);

// Paths that vplMeasureFurther traces.
enum { VPL_PILOT_PATHS = 512 };

#endif
