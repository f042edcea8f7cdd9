// SPDX-License-Identifier: MIT
// Shadow maps: does light reach x from y? Cube maps for point lights, hemi-octahedral maps for virtual
// lights, paraboloid maps for clusters of virtual lights. They know nothing of lights but their position.
#ifndef VPL_VISIBILITY_H
#define VPL_VISIBILITY_H

#include <vpl/geometry.h>
#include <vpl/raster.h>

VPL_HEADER_BEGIN

#define VPL_MAX_SHADOW_MAP  8192
#define VPL_MAX_PCF_SAMPLES 256
// With fewer samples per point a shadow does not use the map's bounds.
#define VPL_MIN_BOUND_SAMPLES 8

// A face of a cube around a point, 90 degrees of view. Faces are numbered +x, -x, +y, -y, +z, -z. Frames are
// those of Direct3D: left-handed, right x up = forward.
typedef struct vplCubeFrame {
    vplVec3 right, up, forward;
} vplCubeFrame;

// The frame of face 0 to 5; that of 0 for other numbers.
vplCubeFrame vplCube_GetFrame(int face);

// A point of a cube and the texel that holds it.
typedef struct vplCubePoint {
    int face;        // 0 to 5
    float s, t;      // in [0, 1]; t points down
    int column, row; // in [0, size - 1]
} vplCubePoint;

// Finds the point where a direction of any length meets the cube, for a map with `size` texels a side. Ties
// go to z, then y, then x. Returns false for the zero vector, NaN and sizes below 1.
// Not checked, for speed: pointers must not be NULL.
bool vplCube_Find(vplVec3 direction, int size, vplCubePoint* pointOut);

typedef struct vplCubeMapDef {
    vplVec3 position; // metres
    int size;         // texels along a face, [1, VPL_MAX_SHADOW_MAP]; default 1024
    float nearPlane;  // metres, > 0: nearer surfaces cast no shadow; 0 (default): farPlane * 2^-64
    // Metres, > nearPlane: unit of the stored distances; 0 (default): distance of the farthest vertex.
    float farPlane;
    uint32_t cookie; // set by vplDefaultCubeMapDef
} vplCubeMapDef;

vplCubeMapDef vplDefaultCubeMapDef(void);

// Distances from a point to the nearest surface in all directions. Read only.
typedef struct vplCubeMap {
    vplVec3 position;
    int size;
    float nearPlane, farPlane;
    float* texels; // [face][row][column]: radial distance / farPlane, not clamped; +infinity where nothing is
    struct vplCubeBounds* bounds; // NULL before vplCubeMap_FindBounds
    vplRasterStats stats;
    vplContext* context;
    struct vplArena* arena; // owns the map and its texels
} vplCubeMap;

// Draws every object into the six faces. Source: Franchi and Ferrante, Virtual Point Lights, "Rendering the
// Cube Shadow Map". Departs: distances are not clamped to farPlane, because that falsely shadows the corners of
// the cube.
vplResult vplCubeMap_Create(const vplGeometry* geometry, const vplCubeMapDef* def, vplProgressFcn* progress,
                            void* user, vplCubeMap** mapOut);

// Draws the map again, for a light that moved. The size must be the same; no texels are allocated, and bounds
// are freed. On failure the map's contents are undefined.
vplResult vplCubeMap_Redraw(vplCubeMap* map, const vplGeometry* geometry, const vplCubeMapDef* def,
                            vplProgressFcn* progress, void* user);

// Finds bounds of the texels in each region, so that for most points one test replaces all samples of a soft
// shadow. Shadows keep their bits. It costs about as much as half a sample per texel, and pays where points
// times samples are more than half the texels (bench/shadow). On failure the map is as it was.
vplResult vplCubeMap_FindBounds(vplCubeMap* map);

// NULL is allowed.
void vplCubeMap_Destroy(vplCubeMap* map);

// The stored distance in a direction, metres; +infinity where nothing is, for the zero vector and for NaN.
// Not checked, for speed: pointers must not be NULL.
float vplCubeMap_Distance(const vplCubeMap* map, vplVec3 direction);

typedef enum vplBiasRule {
    VPL_BIAS_AUTO = 0, // VPL_BIAS_EXACT; in vplRender with documented lighting VPL_BIAS_PAIR
    VPL_BIAS_PAIR,     // b_s + b_dmax (1 - n.l): the document's static and dynamic bias
    VPL_BIAS_EXACT     // r (1 - cos t / cos(t - a)): bias of a plane at angle t whose samples are off by a
} vplBiasRule;

typedef struct vplShadowDef {
    vplBiasRule biasRule; // default VPL_BIAS_AUTO
    // b_s and b_dmax of VPL_BIAS_PAIR, metres. Negative (default): farPlane * texel half-angle + the disc's
    // radius at farPlane, and 5.6 b_s, which is free of acne up to 79.9 degrees.
    float biasStatic, biasDynamic;
    int pcfSamples; // S, [1, VPL_MAX_PCF_SAMPLES]; 1 is a hard shadow; default 16
    // off: radius of the disc of samples, metres, >= 0. Negative (default): half a texel's diagonal at the
    // surface's distance from the light, so that shadows are as sharp as the map, however far the scene
    // reaches.
    float pcfOffset;
    uint32_t cookie; // set by vplDefaultShadowDef
} vplShadowDef;

vplShadowDef vplDefaultShadowDef(void);

// A checked shadow test with its automatic values filled in and its sample pattern made.
typedef struct vplShadow {
    const vplCubeMap* map;
    vplShadowDef def;
    float pcfTangent;   // the disc's radius is def.pcfOffset + pcfTangent * distance; one of the two is 0
    float reach;        // upper bound of the offsets' lengths
    float texelTangent; // tangent of the largest angle between a texel's centre and corner
    float offsets[VPL_MAX_PCF_SAMPLES][2]; // on the unit disc, in pairs o, -o
} vplShadow;

vplResult vplShadow_Create(const vplCubeMap* map, const vplShadowDef* def, vplShadow* shadowOut);

// The bias subtracted from the distance of a fragment, metres. cosine is max(n.l, 0).
// Source: VPL_BIAS_PAIR from Franchi and Ferrante, Virtual Point Lights, "Rendering the Point Light with
// Shadows"; VPL_BIAS_EXACT from the geometry of a plane, derived in src/visibility/shadow_kernel.c.
// Not checked, for speed: pointers must not be NULL.
float vplShadow_Bias(const vplShadow* shadow, float distance, float cosine);

// The shadow factor s in [0, 1] at a surface point: the fraction of samples with something nearer to the
// light. The samples lie on a disc perpendicular to the light, so that no seams show at the cube's edges. 0 for a position
// of NaN.
// Not checked, for speed: pointers must not be NULL.
float vplShadow_Factor(const vplShadow* shadow, vplVec3 position, vplVec3 normal);

// ---- hemi-octahedral maps: many small shadow maps of virtual lights, which shine to one side of their
// surface

// The half space above a surface, mapped to the upper half of an octahedron, seen from above and turned by 45
// degrees: the direction (x, y, z) in the frame below maps to (u, v) = (x + y, x - y) / (|x| + |y| + z) in
// [-1, 1]^2. Straight edges stay straight except for kinks where x or y is 0. One square replaces a half
// cube's three.
// Source: Emil Praun and Hugues Hoppe, Spherical Parametrization and Remeshing, SIGGRAPH 2003 (the
// octahedron); Zina Cigolle and others, A Survey of Efficient Representations for Independent Unit Vectors,
// JCGT 2014 (its half).
typedef struct vplHemiMap {
    vplVec3 position;           // metres; slightly above the surface
    vplVec3 right, up, forward; // right-handed, unit; forward is the surface's normal
    int size;                   // texels along a side
    // 1 / (|x| + |y| + z) of the nearest surface, 1/metres; 0 where nothing is. Blocks of 4 x 4 columns (u)
    // and rows (v).
    const float* texels;
    vplContext* context;
} vplHemiMap;

// Read only.
typedef struct vplHemiMaps {
    vplHemiMap* maps;
    int count, capacity, size;
    float* texels;
    vplContext* context;
    struct vplArena* arena; // owns the maps and their texels
} vplHemiMaps;

typedef struct vplHemiMapPlace {
    vplVec3 position; // metres; on a surface, which does not shadow it
    vplVec3 normal;   // unit
} vplHemiMapPlace;

// Makes room for `capacity` maps with `size` texels a side, [1, VPL_MAX_SHADOW_MAP].
vplResult vplHemiMaps_Create(vplContext* context, int size, int capacity, vplHemiMaps** mapsOut);

// Bytes per map.
size_t vplHemiMaps_BytesPerMap(int size);

// Draws maps from `count` places, at most the capacity, in parallel. They replace all maps drawn before.
vplResult vplHemiMaps_Draw(vplHemiMaps* maps, const vplGeometry* geometry, const vplHemiMapPlace* places,
                           int count, vplProgressFcn* progress, void* user);

// NULL is allowed.
void vplHemiMaps_Destroy(vplHemiMaps* maps);

// The shadow factor of a surface point with a unit normal: 1 where something nearer to the map's position hides it, and where
// the position lies behind the point's surface; else 0.
// A ray gives the same answer except within a band. The centre of a texel is off a point at distance r, in
// the direction (x, y, z), by at most the footprint f = sqrt(2) (|x| + |y| + z) / size. Along the point's
// plane, at the angle T to the light, it is nearer by at most b = r (1 - cos T / cos(T - a)), tan a = f / r,
// as in VPL_BIAS_EXACT. Blockers nearer to the point than 1.5 f are ignored. So map and ray agree where every
// blocker is further than 2.5 f + b from the point and blocks either all or none of the rays to the point's
// plane within f around it.
// Not checked, for speed: pointers must not be NULL.
float vplHemiMap_Factor(const vplHemiMap* map, vplVec3 position, vplVec3 normal);

// ---- paraboloid maps: shadow maps of clusters of virtual lights

// Projects a direction of any length, in a map's frame (z along its axis), to the map of the front
// hemisphere: p = (x, y) / (|d| + z), inside the unit disk where z >= 0. Returns false where z is -|d|, and
// for the zero vector. It is the stereographic projection: circles stay circles, and an area of the disk
// covers 4 / (1 + p^2)^2 times as much solid angle.
// Source: Wolfgang Heidrich and Hans-Peter Seidel, View-independent Environment Maps, Graphics Hardware 1998.
// Not checked, for speed: pointers must not be NULL.
bool vplParaboloid_Project(vplVec3 direction, double* x, double* y);

// The unit direction of a point of the map: the inverse.
vplVec3 vplParaboloid_Unproject(double x, double y);

// The flux that a diffuse light sends through a point of the unit disk, as a multiple of the mean over the
// disk: 4 (1 - p^2) / (1 + p^2)^3, the cosine times the solid angle. 0 outside of the disk.
double vplParaboloid_Weight(double x, double y);

// The surfaces around one position. Hemisphere 0 looks along `forward`, hemisphere 1 (if there are two) back,
// with z reversed: p = (x, y) / (|d| - z).
typedef struct vplParaboloidMap {
    vplVec3 position;           // metres
    vplVec3 right, up, forward; // right-handed, unit
    int size;                   // texels along a side; the disk touches the sides of the square
    int hemispheres;            // 1 or 2
    // 1 / distance of the nearest surface along the texel's centre, 1/metres; 0 where nothing is, and outside
    // of the disk (with two hemispheres: by more than a texel's diagonal). [hemisphere][row + 1 (y)][column +
    // 1 (x)], size + 2 rows and columns: those at the sides are stored twice.
    const float* texels;
    // Index of that surface in the geometry, in the same order; -1 where nothing is. NULL: not kept.
    const int32_t* triangles;
    vplContext* context;
} vplParaboloidMap;

// Read only.
typedef struct vplParaboloidMaps {
    vplParaboloidMap* maps;
    int count, capacity, size;
    float* texels;
    int32_t* triangles; // NULL: not kept
    float* scratch;     // memory that workers draw in
    vplContext* context;
    struct vplArena* arena; // owns the maps and their arrays
} vplParaboloidMaps;

typedef struct vplParaboloidPlace {
    vplVec3 position; // metres
    vplVec3 normal;   // unit: the axis
    int hemispheres;  // 1: nothing behind the plane is needed; 2
    // The position lies on a surface, which must not hide it: the map is drawn from slightly above.
    bool onSurface;
} vplParaboloidPlace;

// Makes room for `capacity` maps of two hemispheres with `size` texels a side, [1, VPL_MAX_SHADOW_MAP].
// `triangles`: keeps the surfaces that vplParaboloidMap_GetHit needs.
vplResult vplParaboloidMaps_Create(vplContext* context, int size, int capacity, bool triangles,
                                   vplParaboloidMaps** mapsOut);

// Draws maps from `count` places, at most the capacity, in parallel. They replace all maps drawn before. One
// pass over the triangles per hemisphere. Edges are drawn as the circles that they are: the planes through an
// edge and the eye decide whether a texel's centre lies in a triangle. The document's rasterizer draws
// straight edges, up to 169 of 512 texels off.
vplResult vplParaboloidMaps_Draw(vplParaboloidMaps* maps, const vplGeometry* geometry,
                                 const vplParaboloidPlace* places, int count, vplProgressFcn* progress,
                                 void* user);

// NULL is allowed.
void vplParaboloidMaps_Destroy(vplParaboloidMaps* maps);

typedef struct vplParaboloidTexel {
    int hemisphere, column, row;
} vplParaboloidTexel;

// Finds the surface in a texel: the hit of the ray through its centre, and that ray's unit direction in the
// world. Returns false where nothing is and outside of the disk. The map must have triangles.
// Not checked, for speed: pointers must not be NULL.
bool vplParaboloidMap_GetHit(const vplParaboloidMap* map, const vplGeometry* geometry,
                             vplParaboloidTexel texel, vplHit* hitOut, vplVec3* directionOut);

// The shadow factor in [0, 1] of a surface point with a unit normal: the bilinear weight of those of the four texels around the point
// that show something nearer to the map's position than the point's own plane. The plane may face either way,
// because lights beside the map's position may be in front of it. Points in a hemisphere that was not drawn
// get 1. Texels beyond the rim of a single hemisphere hide nothing.
// A ray gives the same answer except within a band. The centres of the texels are off a point at distance r
// by at most a texel's diagonal f = 2 sqrt(2) (r + |z|) / size, z along the axis. Along the point's plane, at
// the angle T to the light, they are nearer by at most b = r (1 - cos T / cos(T - a)), tan a = f / r.
// Blockers nearer to the point than f / 2 are ignored. So map and ray agree where every blocker is further
// than 2.5 f + b from the point and blocks either all or none of the rays to the point's plane within f
// around it.
// Not checked, for speed: pointers must not be NULL.
float vplParaboloidMap_Factor(const vplParaboloidMap* map, vplVec3 position, vplVec3 normal);

VPL_HEADER_END

#endif
