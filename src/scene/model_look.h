// SPDX-License-Identifier: MIT
// How a model that is a scene by itself is seen: the nearest camera that fits its vertices, and the ground under them.
//
// The camera looks down along VIEW, a three-quarter view, with a vertical field of VPL_MODEL_FIELD. It stands
// as near as it can with all vertices inside the picture and MARGIN of the picture's shorter side free at
// each edge. The view falls more steeply than half the field, so the horizon is above the picture: the camera
// is above all vertices, and a ground of finite size under them covers all of the picture behind the mesh.
#ifndef VPL_SCENE_MODEL_LOOK_H
#define VPL_SCENE_MODEL_LOOK_H

#include "scene/scene.h"

// The vertical field of view, radians.
#define VPL_MODEL_FIELD (26 * VPL_PI / 180)

// Half a field of view: its slopes at the edges of the picture, and without the margin.
typedef struct vplModelField {
    double slopes[2], inner[2]; // to the right and upwards
} vplModelField;

// The view of the mesh. Right is horizontal; right, up and ahead are unit vectors at right angles.
typedef struct vplModelLook {
    double centre[3], radius; // of the bounds of the vertices
    double low[3], high[3];   // the bounds
    double most[2][2];        // what the edges of the picture bound (see fit)
    double right[3], up[3], ahead[3];
    double eye[3];            // along right, up and ahead from the centre
    double nearest, farthest; // least and greatest depth of a vertex from the centre
} vplModelLook;

// A rectangle under the mesh that holds the mesh and all of the ground that the picture shows.
typedef struct vplModelGround {
    double centre[3], ahead[3]; // ahead is horizontal
    double halfWidth, halfLength;
    double nearest, most; // depths from the eye at the lower and upper edge of the picture
} vplModelGround;

vplModelField vplModelField_Find(double aspect);

// Looks at all objects of the scene, which are meshes.
vplModelLook vplModelLook_Find(const vplScene* scene, const vplModelField* field);
vplModelGround vplModelGround_Find(const vplModelLook* look, const vplModelField* field);

// out = centre + x right + y up + z ahead
void vplModelLook_Place(const vplModelLook* look, const double at[3], double out[3]);

// out = a / |a|
void vplNormalize3(const double a[3], double out[3]);

#endif
