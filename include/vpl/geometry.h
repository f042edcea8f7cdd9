// SPDX-License-Identifier: MIT
// The scene frozen in world space: placements, triangles, and the closest hit of a ray.
#ifndef VPL_GEOMETRY_H
#define VPL_GEOMETRY_H

#include <vpl/scene.h>

#ifdef __cplusplus
extern "C" {
#endif

// A model matrix with what intersection and shading need of it; rows of 3x4 and 3x3 matrices.
// In double: a wall grazed at a tenth of its angle makes ten times the rounding of a hit.
typedef struct vplPlacement {
    double toWorld[3][4];
    double toLocal[3][4]; // the inverse
    float normal[6][3];   // unit world normal of each local face, by the inverse transpose
} vplPlacement;

// Fails with VPL_INVALID_ARGUMENT on a singular, non-affine or non-finite matrix.
vplResult vplPlacement_Create(vplContext* context, const vplMat4* transform, vplPlacement* placementOut);

typedef struct vplRay {
    vplVec3 origin;    // metres
    vplVec3 direction; // any length but 0; t counts in its units
} vplRay;

// Faces of the unit box: +x, -x, +y, -y, +z, -z; a quad's only face is VPL_FACE_QUAD.
enum { VPL_FACE_NONE = -1, VPL_FACE_QUAD = 4 };

typedef struct vplHit {
    float t;          // > 0 and finite
    int object;       // index in the geometry
    int face;         // 2 * axis + (0: +, 1: -); VPL_FACE_QUAD for quads
    vplVec3 position; // on the surface to rounding: the local hit point taken to world space
    vplVec3 normal;   // unit; a quad's +z, a box's outward normal, also when hit from behind
} vplHit;

// Ray against the quad [-0.5, 0.5]^2 at z = 0 in local space: t > 0, closed edges, both sides.
// Source: Franchi and Ferrante, Virtual Point Lights, "Ray-Quad".
bool vplRay_HitQuad(const vplRay* ray, const vplPlacement* placement, vplHit* hitOut);

// Ray against the box [-0.5, 0.5]^3 by the slab method: the entry at t > 0, or from inside the exit. A ray
// that leaves the box from its face `fromFace` never hits that face again; VPL_FACE_NONE if it does not.
// Source: Franchi and Ferrante, Virtual Point Lights, "Ray-Box"; departs at t = 0, which is a miss here, or
// every reflected particle would hit the face it stands on.
bool vplRay_HitBox(const vplRay* ray, const vplPlacement* placement, int fromFace, vplHit* hitOut);

typedef struct vplGeometryObject {
    vplObjectType type;
    int material;
    vplPlacement placement;
    int firstVertex, vertexCount;     // in positions
    int firstTriangle, triangleCount; // in indices / 3 and normals
} vplGeometryObject;

// Read only. Triangles are counter-clockwise seen from the front; indices are relative to firstVertex.
typedef struct vplGeometry {
    const vplGeometryObject* objects;
    const vplVec3* positions; // world space, metres
    const uint32_t* indices;  // three per triangle
    const vplVec3* normals;   // one unit vector per triangle
    const int* owners;        // the object of each triangle
    const vplMaterialDef* materials;
    int objectCount, materialCount, vertexCount, triangleCount;
    vplVec3 boundsMin, boundsMax; // of all positions; both 0 when there are none
    vplContext* context;
} vplGeometry;

vplResult vplGeometry_Create(const vplScene* scene, vplGeometry** geometryOut);

// NULL is allowed.
void vplGeometry_Destroy(vplGeometry* geometry);

// Where a ray starts, so that it does not hit what it leaves. {-1, VPL_FACE_NONE} in free space.
typedef struct vplRayStart {
    int object, face;
} vplRayStart;

// The closest hit over all objects; among equal distances the lowest object index. False if there is none.
bool vplGeometry_ClosestHit(const vplGeometry* geometry, const vplRay* ray, vplRayStart start,
                            vplHit* hitOut);

// True if something other than the start lies in (0, tMax) along the ray. tMax in units of the direction.
bool vplGeometry_IsOccluded(const vplGeometry* geometry, const vplRay* ray, vplRayStart start, float tMax);

// Area of all surfaces, one side each, square metres.
double vplGeometry_Area(const vplGeometry* geometry);

// Area-weighted mean over all surfaces of the mean of the reflectance's three channels, [0, 1].
// This is the "scene's mean reflectivity" of Keller, Instant Radiosity, section 4, and --reflectivity auto.
double vplGeometry_MeanReflectance(const vplGeometry* geometry);

// Length of the diagonal of the bounding box, metres.
float vplGeometry_Diagonal(const vplGeometry* geometry);

#ifdef __cplusplus
}
#endif

#endif
