// SPDX-License-Identifier: MIT
// The scene in world space: placements, triangles, rays, everything that emits, and patches for radiosity.
#ifndef VPL_GEOMETRY_H
#define VPL_GEOMETRY_H

#include <vpl/scene.h>

VPL_HEADER_BEGIN

// ---- placements, rays and hits

// A model matrix with what intersection and shading derive from it; rows of 3x4 and 3x3 matrices. Matrices
// are in double, because grazing angles magnify the rounding of a hit: tenfold at a tenth of a radian.
typedef struct vplPlacement {
    double toWorld[3][4];
    double toLocal[3][4]; // the inverse
    float normal[6][3];   // unit world normal of each local face, by the inverse transpose
} vplPlacement;

// Fails with VPL_INVALID_ARGUMENT on a singular, non-affine or non-finite matrix.
vplResult vplPlacement_Create(vplContext* context, const vplMat4* transform, vplPlacement* placementOut);

// A ray never hits triangles first .. first + count - 1: those it starts on. {0, 0} skips none.
typedef struct vplSkip {
    int first, count;
} vplSkip;

typedef struct vplRay {
    vplVec3 origin;    // metres
    vplVec3 direction; // any length but 0; distances t are in units of this length
    vplSkip skip;
} vplRay;

// Faces of the unit box: +x, -x, +y, -y, +z, -z; a quad's only face is VPL_FACE_QUAD.
enum { VPL_FACE_NONE = -1, VPL_FACE_QUAD = 4 };

typedef struct vplHit {
    float t;      // > 0 and finite
    int object;   // index in the geometry
    int face;     // 2 * axis + (0: +, 1: -); VPL_FACE_QUAD for quads; VPL_FACE_NONE for meshes
    int triangle; // index in the geometry's triangles; for quads and boxes one of the face
    // Mesh: barycentrics of corners 1 and 2. Quad and box: local coordinates on the face, [-0.5, 0.5], along the
    // two axes other than the face's, in the order x, y, z.
    float u, v;
    vplVec3 position; // on the surface to rounding
    vplVec3 normal;   // unit, of the front side (a quad's +z, a box's outside), also when hit from behind
} vplHit;

// Intersects a ray with the quad [-0.5, 0.5]^2 at z = 0 in local space: t > 0, closed edges, both sides.
// Source: Franchi and Ferrante, Virtual Point Lights, "Ray-Quad".
// Not checked, for speed: pointers must not be NULL.
bool vplRay_HitQuad(const vplRay* ray, const vplPlacement* placement, vplHit* hitOut);

// Intersects a ray with the box [-0.5, 0.5]^3 by the slab method: the entry at t > 0, or from inside the
// exit. A ray that leaves the box from its face `fromFace` never hits that face again; VPL_FACE_NONE: the ray
// does not start on the box.
// Source: Franchi and Ferrante, Virtual Point Lights, "Ray-Box". Departs: t = 0 is a miss, or every reflected
// particle would hit the face it starts on.
// Not checked, for speed: pointers must not be NULL.
bool vplRay_HitBox(const vplRay* ray, const vplPlacement* placement, int fromFace, vplHit* hitOut);

// ---- the environment

// Light from infinitely far away as a picture of all directions, laid out as vplEnvironmentDef.pixels, and its
// distribution. Read only. The camera sees radiance that is interpolated linearly between the centres of pixels. Surfaces
// receive its mean over each pixel, so that light and density of a direction are in the same ratio everywhere.
typedef struct vplEnvironment {
    int width, height;
    const float* pixels;    // radiance, W/(m^2 sr)
    const double* rows;     // power of all rows above, W/m^2; height + 1
    const double* columns;  // of each row, the share of the pixels left of each; height * (width + 1)
    const double* cosines;  // of the angle from +y at the upper edge of each row; height + 1
    double sine, cosine;    // of the turn about +y
    vplRgb irradiance;      // of all directions together: the integral of radiance, W/m^2
    struct vplArena* arena; // owns the arrays
} vplEnvironment;

// NULL in *environmentOut where the scene has none, or one of radiance 0. VPL_OUT_OF_MEMORY.
vplResult vplEnvironment_Create(const vplScene* scene, vplEnvironment** environmentOut);

// NULL is allowed.
void vplEnvironment_Destroy(vplEnvironment* environment);

// Radiance that the camera sees in the direction of a unit vector; black for NULL.
vplRgb vplEnvironment_Radiance(const vplEnvironment* environment, vplVec3 direction);

// Radiance that surfaces receive from a direction (unit). Stores the probability density of the direction, per steradian:
// its share of the light, the mean of red, green and blue.
// Not checked, for speed: pointers must not be NULL.
vplRgb vplEnvironment_Light(const vplEnvironment* environment, vplVec3 direction, double* densityOut);

// Samples a direction (unit, towards the light) of this density by two numbers in [0, 1), with its light and density.
// Source: Pharr, Jakob and Humphreys, Physically Based Rendering, 4th edition, 12.5.2; rows are sampled evenly in solid
// angle.
typedef struct vplEnvironmentSample {
    vplVec3 direction;
    vplRgb light;   // W/(m^2 sr)
    double density; // > 0
} vplEnvironmentSample;

// Not checked, for speed: pointers must not be NULL.
vplEnvironmentSample vplEnvironment_Sample(const vplEnvironment* environment, double u, double v);

// ---- the geometry

typedef struct vplGeometryObject {
    vplObjectType type;
    int material;       // -1: each triangle has its own
    vplRgb reflectance; // mean over its area
    bool smooth;        // has shading normals
    bool byFormula;     // is among vplGeometry.formulaObjects
    bool coplanar;      // may share a plane with another object
    vplPlacement placement;
    vplPlacement bounds; // mesh: maps the unit box onto its oriented bounding box
    int firstVertex, vertexCount;
    int firstTriangle, triangleCount;
} vplGeometryObject;

// Read only. Triangles are counter-clockwise seen from the front; a quad has two, a box two per face in the
// order of the faces. Indices are relative to the object's firstVertex.
typedef struct vplGeometry {
    const vplGeometryObject* objects;
    const vplVec3* positions;        // world space, metres
    const vplVec3* shadingNormals;   // per vertex: unit on smooth objects, else 0; NULL where none is smooth
    const uint32_t* indices;         // three per triangle
    const vplVec3* normals;          // one unit vector per triangle; 0 where its area is 0
    const int* owners;               // the object of each triangle
    const int* triangleMaterials;    // the material of each triangle
    const vplMaterialDef* materials; // without names
    int objectCount, materialCount, vertexCount, triangleCount;
    // Quads and boxes that rays do not test as triangles but by vplRay_HitQuad and vplRay_HitBox, one by one:
    // those whose corners move by more than 1/512 of their size when rounded to float, because they are small
    // and far from the origin or very thin, and those whose axes almost lie in one plane. Usually there are
    // none.
    const int* formulaObjects;
    int formulaCount;
    vplVec3 boundsMin, boundsMax;           // of all positions; both 0 when there are none
    double origin[3];                       // vplScene_GetOrigin: all positions are relative to it
    double area;                            // of all triangles, square metres
    double meanReflectance;                 // area-weighted, mean of the channels; 0 where there is no area
    bool emits;                             // some triangle may emit
    int emittingTriangles, emittingObjects; // that may, and objects with such triangles
    double emittingArea;                    // of these triangles, square metres
    const struct vplPaint* paint;     // textures and colours of vertices; NULL: surfaces have one colour each
    const struct vplCutOuts* cutOuts; // triangles that let light through; NULL: there are none
    vplEnvironment* environment;      // light from outside; NULL: there is none
    struct vplBvh* rayTree;           // of all others; accelerates rays; NULL: there is none
    uint64_t scene;                   // identifies the scene that it was made of
    struct vplArena* arena;           // owns the arrays
    vplContext* context;
} vplGeometry;

// Builds the geometry of a scene and its ray tree, with all workers. The scene may be destroyed before the
// geometry.
// Errors: VPL_LIMIT for more than VPL_MAX_TRIANGLES triangles or vertices, VPL_OUT_OF_MEMORY.
vplResult vplGeometry_Create(const vplScene* scene, vplGeometry** geometryOut);

// The same without the ray tree, for pictures that cast no rays. Rays work and have the same hits, but test
// every triangle.
vplResult vplGeometry_CreateForRaster(const vplScene* scene, vplGeometry** geometryOut);

// Builds the ray tree, with all workers; does nothing if there is one. Not to be called from a task or while
// rays are being cast. On VPL_OUT_OF_MEMORY the geometry stays as it was.
vplResult vplGeometry_BuildRayTree(vplGeometry* geometry);

// Makes the geometry that of the scene as it is now, after vplScene_SetTransform, SetMaterial, SetObjectMaterial and
// SetEnvironment, and after materials and textures were added. Objects that were moved, or whose materials were changed, are
// made anew, and so is the environment if it was set. The ray tree is refitted if objects were moved; it is built anew if
// rays would cost more than 1.2 times what they cost when it was built. The result has the bits of a new geometry, but for
// the tree, which changes no hit. vplGeometry_CanUpdate is false, and the geometry must be made anew, where objects were
// added. After a failure it can only be destroyed.
bool vplGeometry_CanUpdate(const vplGeometry* geometry, const vplScene* scene);
vplResult vplGeometry_Update(vplGeometry* geometry, const vplScene* scene);

// NULL is allowed.
void vplGeometry_Destroy(vplGeometry* geometry);

// Finds the closest hit; among equal distances the lowest triangle. False if there is none. Hits of quads and
// boxes are those of vplRay_HitQuad and vplRay_HitBox, to the last digits of position and normal. Mesh
// triangles are tested by the watertight test of Woop, Benthin and Wald, JCGT 2013: a ray through a shared
// edge hits one of its triangles.
// Not checked, for speed: pointers must not be NULL.
bool vplGeometry_ClosestHit(const vplGeometry* geometry, const vplRay* ray, vplHit* hitOut);

// True if the ray hits something with t in (0, tMax). tMax in units of the direction.
// Not checked, for speed: pointers must not be NULL.
bool vplGeometry_IsOccluded(const vplGeometry* geometry, const vplRay* ray, float tMax);

// A ray that leaves a hit point in `direction` and does not hit the surface it leaves: the quad, the box
// (towards its inside only the face), the triangle. From a mesh, and from what shares a plane with another object,
// it starts a few units in the last place off the surface.
// Not checked, for speed: pointers must not be NULL.
vplRay vplGeometry_Leave(const vplGeometry* geometry, const vplHit* hit, vplVec3 direction);

// The normal for shading, unit: interpolated on smooth objects, else the hit's own.
// Not checked, for speed: pointers must not be NULL.
vplVec3 vplGeometry_ShadingNormal(const vplGeometry* geometry, const vplHit* hit);

// Finds the closest hit among the objects' oriented bounding boxes (quads stay quads): the cheap stand-in for
// meshes that Franchi and Ferrante propose under "Improving the Particle Simulation". `from` is the hit that
// the ray leaves, NULL in free space; the box of a mesh is not hit by a ray that leaves one of the mesh's own
// triangles. Ignores ray->skip. hitOut->triangle is the object's first.
// Not checked, for speed: pointers must not be NULL.
bool vplGeometry_ClosestBox(const vplGeometry* geometry, const vplRay* ray, const vplHit* from,
                            vplHit* hitOut);

// Area of all surfaces, one side each, square metres.
double vplGeometry_Area(const vplGeometry* geometry);

// Area-weighted mean over all surfaces of the mean of the reflectance's three channels, [0, 1].
// This is the "scene's mean reflectivity" of Keller, Instant Radiosity, section 4, and --reflectivity auto.
double vplGeometry_MeanReflectance(const vplGeometry* geometry);

// Length of the diagonal of the bounding box, metres.
float vplGeometry_Diagonal(const vplGeometry* geometry);

// ---- emission

// An emitter of the scene, the environment, or a triangle whose material emits (from its front only).
typedef struct vplEmissionSource {
    int emitter;  // index of the emitter; -1: a triangle or the environment
    int triangle; // index of the triangle; -1: an emitter or the environment
    vplRgb power; // W
} vplEmissionSource;

// The list of all sources with power, for path tracing and for shooting particles. Read only. Sources are
// chosen with a probability proportional to power, the mean of its three channels.
typedef struct vplEmission {
    const vplGeometry* geometry;
    const vplEmitterDef* emitters; // a copy; directions are unit vectors
    const vplEmissionSource*
        sources;              // emitters in the scene's order, the environment, then triangles in theirs
    const double* cumulative; // W: power of all sources before this one; one more than there are sources
    int emitterCount, sourceCount;
    int firstTriangle; // index of the first source that is a triangle
    int environment;   // index of the source that is the environment; -1: there is none
    vplVec3 centre; // of the sphere around the geometry, which directional emitters and the environment cover
    double radius;  // metres; 0 where there is no geometry
    struct vplArena* arena; // owns the arrays
    vplContext* context;
} vplEmission;

// Powers: point 4 pi I; spot I times the solid angle weighted by the falloff; directional E pi radius^2;
// environment the same with its irradiance; triangle pi L area. `emitters` may be NULL if emitterCount is 0. The geometry must outlive the emission.
vplResult vplEmission_Create(const vplGeometry* geometry, const vplEmitterDef* emitters, int emitterCount,
                             vplEmission** emissionOut);

// NULL is allowed.
void vplEmission_Destroy(vplEmission* emission);

// Area of all triangles that emit, square metres.
double vplEmission_Area(const vplEmission* emission);

// Power of all sources, mean of the three channels, W.
double vplEmission_Power(const vplEmission* emission);

// The share of a spot's full intensity in a direction, by the cosine of its angle to the axis: 1 inside the
// inner angle, 0 outside the outer, between them 3x^2 - 2x^3, where x goes from 0 to 1 linearly in the
// cosine.
// Source: Pharr, Jakob and Humphreys, Physically Based Rendering, 4th edition, 12.2.1 (SmoothStep).
// Not checked, for speed: pointers must not be NULL.
double vplSpot_Falloff(const vplEmitterDef* spot, double cosine);

// Intensity of a point or spot emitter in a direction (unit vector away from it), W/sr; irradiance of a
// directional emitter, W/m^2.
// Not checked, for speed: pointers must not be NULL.
vplRgb vplEmitter_Intensity(const vplEmitterDef* emitter, vplVec3 direction);

// A point on a triangle, uniform over its area for u, v uniform in [0, 1).
// Not checked, for speed: pointers must not be NULL, and `triangle` must be in range.
vplHit vplGeometry_SampleTriangle(const vplGeometry* geometry, int triangle, float u, float v);

// A particle that leaves a source. Its flux is that of all sources: divide by the number of particles.
typedef struct vplParticle {
    vplRay
        ray; // unit direction; from a triangle as vplGeometry_Leave, directional and environment from outside
    vplVec3 position; // in m: of the emitter, or on its surface
    vplVec3 normal;   // unit: of the triangle, else the direction
    vplRgb flux;      // W; its mean over the channels is vplEmission_Power, whatever the source
    int source;       // index
} vplParticle;

// Samples a particle from five numbers in [0, 1): `choice` chooses the source, u[0], u[1] the position
// (triangle, directional, environment), u[2], u[3] the direction (cosine-distributed from a triangle, uniform from a
// point, by the falloff from a spot, as vplEnvironment_Sample). False where nothing emits.
// Not checked, for speed: pointers must not be NULL.
bool vplEmission_SampleParticle(const vplEmission* emission, double choice, const float u[4],
                                vplParticle* particleOut);

// ---- patches: the elements of radiosity

// Most patches, and most rounds of bisection of one triangle.
enum { VPL_MAX_PATCHES = 1 << 24, VPL_MAX_PATCH_ROUNDS = 40 };

typedef struct vplPatchDef {
    // T, metres, >= 0: each round bisects every triangle whose longest edge is longer than T, at the middle
    // of that edge. 0 (default): T is chosen for `count`.
    float size;
    // The number of patches, [1, VPL_MAX_PATCHES]; default 1000. Used where size is 0. The patch with the longest edge is
    // bisected first; of equally long ones, the one with the largest area. Lengths and areas are compared after rounding to 12
    // bits. Up to 5 % more bisections are made if then all equal patches are bisected. Without `group` there is at least one
    // patch per triangle, or per piece of a triangle that cuts divide.
    int count;
    int rounds; // of bisection at most, [0, VPL_MAX_PATCH_ROUNDS]; default VPL_MAX_PATCH_ROUNDS
    // Cut triangles where other surfaces cross, touch or overlap them, before they are bisected, so that no patch
    // lies on both sides of a wall, or half under a box; default false.
    bool cut;
    // Make one patch of many small triangles: of those in a box whose diagonal is at most T, which face the same way and
    // emit the same; default false. With `size` 0, T is chosen so that there are about `count` patches; if there are fewer,
    // patches that are no groups are bisected further. Only triangles that are in no group are cut, and by each other.
    bool group;
    uint32_t cookie; // set by vplDefaultPatchDef
} vplPatchDef;

vplPatchDef vplDefaultPatchDef(void);

// A triangle of the geometry or a part of another node, counter-clockwise seen from the front. Corner 0 is
// opposite the edge that is, or would be, bisected: the longest, and of equally long ones the first in the
// order 01, 12, 20 of the parent's corners. Where another surface cuts the node, it is any edge.
typedef struct vplPatchNode {
    uint32_t corners[3]; // indices in vplPatches.positions
    int triangle;        // of the geometry
    int parent;          // -1: the node is that triangle
    int children;        // the first of two, which follow each other; -1: a patch, or a triangle without area
    int patch;           // index in vplPatches.patches, that of a group for each of its triangles; -1: none
    float at; // the children meet this share of the way from corner 1 to corner 2; 0.5 where bisected
} vplPatchNode;

// A segment along which another surface crosses or touches a triangle.
typedef struct vplPatchCut {
    vplVec3 ends[2];
    uint8_t
        faces; // bit 0: the surface stands on the triangle's front; bit 1: on its back; 0: lies in its plane
} vplPatchCut;

// The least cosine between the normal of a triangle in a group and the group's mean normal: 37 degrees.
#define VPL_PATCH_GROUP_COSINE 0.8

// Triangles bisected at their longest edges, or in groups. Read only. Node t, t < geometry->triangleCount, is triangle t.
// The middle of a shared edge has the same bits for both triangles. Triangles whose area is 0 have no patch.
// Source: Hemgren, Radiosity in Realtime Rendering, 3.1. Edges exactly as long as T stay whole.
typedef struct vplPatches {
    const vplGeometry* geometry;
    const vplVec3* positions; // all different: patches that meet at a point share its index
    int positionCount;
    const vplPatchNode* nodes;
    int nodeCount;
    // Nodes that are patches: triangle by triangle, each in the order of its tree. Then groups: the first triangle of
    // each.
    const int* patches;
    int patchCount;
    // The last groupCount patches are groups of at least two whole triangles. Group i has the triangles
    // members[firstMember[i]] .. members[firstMember[i + 1] - 1], neighbours next to each other; areaUpTo[m]: the area of
    // the group's triangles up to and with member m, m^2. All NULL where there are no groups.
    int groupCount;
    const int* firstMember;
    const int* members;
    const double* areaUpTo;
    float longestEdge; // of all patches, metres; rounded up, so that as T it gives the same patches
    // The cuts of triangle t are cuts[firstCut[t]] .. cuts[firstCut[t + 1] - 1]. NULL: no surface meets another, or
    // vplPatchDef.cut is false.
    const vplPatchCut* cuts;
    const int* firstCut;
    int cutPatches;         // how many more pieces than triangles cuts leave
    int unresolvedCuts;     // along which some patch still spans what cuts it, because no float lies between
    struct vplArena* arena; // owns the arrays
    vplContext* context;
} vplPatches;

// The geometry must outlive the patches. With `cut`, surfaces meet within 2^-19 of the scene's largest coordinate.
// Cuts that are not resolved are counted in a warning. Errors: VPL_INVALID_ARGUMENT, VPL_LIMIT for more than
// VPL_MAX_PATCHES patches, VPL_OUT_OF_MEMORY.
vplResult vplPatches_Create(const vplGeometry* geometry, const vplPatchDef* def, vplPatches** patchesOut);

// Bisects the patches of the largest priorities, one priority per patch, until there are `count` patches or
// no priority above 0 is left; halves of a patch are not bisected again. Makes new patches; the old ones
// stay.
vplResult vplPatches_Refine(const vplPatches* patches, const float* priorities, int count,
                            vplPatches** patchesOut);

// NULL is allowed.
void vplPatches_Destroy(vplPatches* patches);

// The patch of a triangle that contains a point on it, to rounding; of two that meet there, the first. -1:
// the triangle has none.
int vplPatches_Find(const vplPatches* patches, int triangle, vplVec3 position);

// Area of a patch, square metres.
double vplPatches_Area(const vplPatches* patches, int patch);

// The nodes that a patch consists of: one, or the triangles of a group.
typedef struct vplPatchParts {
    const int* nodes;
    int count;
} vplPatchParts;

vplPatchParts vplPatches_GetParts(const vplPatches* patches, int patch);

VPL_HEADER_END

#endif
