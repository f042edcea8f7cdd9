// SPDX-License-Identifier: MIT
// Paths from lights, to which the vertices of paths from the camera connect.
#ifndef VPL_REFERENCE_LIGHT_PATH_H
#define VPL_REFERENCE_LIGHT_PATH_H

#include "reference/direct_light.h"

// A surface that a light path has met.
typedef struct vplLightVertex {
    vplPathVertex at;
    // The product of the reflectances of all vertices so far but the first, over the probabilities that the path went on, and of the
    // density of the reflection over that of guided paths at each.
    vplRgb carried;
    // The density of these vertices, over that with which a path from the camera finds them in reverse; differs from 1 where
    // normals are interpolated, or paths are guided.
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

// Returns the radiance that a vertex of a path from the camera reflects from the light path. It is connected to one vertex of the light path,
// which is chosen with a probability proportional to its unoccluded radiance. `bounce` counts the bounces before the vertex, `throughput` is
// that of the path up to it.
vplRadiance vplConnectToLightPath(vplPathState* path, const vplPathVertex* vertex, const vplLightPath* light,
                                  int bounce, vplRgb throughput);

// If paths find more than this share of reflected light at vertices of light paths after the first, light paths of VPL_MOST_LIGHT_VERTICES have
// the smaller error in the same time; otherwise those of one vertex have it, or nearly. Share, and squared error times time over that with one vertex:
// corridor 0.67, 0.18; shade 0.60, 0.05; hall 0.38, 0.82; thin-boxes 0.32, 0.97; loft 0.31, 1.36; cornell-area 0.23, 1.43; flat 0.23, 0.91.
#define VPL_FURTHER_SHARE (1.0 / 3)

// Measures this share by VPL_PILOT_PATHS paths through pixels all over the picture of the def. The paths do not depend on the def's seed.
enum { VPL_PILOT_PATHS = 512 };
vplResult vplMeasureFurther(const vplGeometry* geometry, const vplPathDef* def, double* shareOut);

#endif
