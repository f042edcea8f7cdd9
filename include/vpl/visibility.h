// SPDX-License-Identifier: MIT
// Does light reach x from y? Answered here by a cube shadow map; knows nothing of lights but their place.
#ifndef VPL_VISIBILITY_H
#define VPL_VISIBILITY_H

#include <vpl/geometry.h>
#include <vpl/raster.h>

#ifdef __cplusplus
extern "C" {
#endif

#define VPL_MAX_SHADOW_MAP  8192
#define VPL_MAX_PCF_SAMPLES 256
// With fewer samples per point a shadow does not ask the map's bounds.
#define VPL_MIN_BOUND_SAMPLES 8

// Faces +x, -x, +y, -y, +z, -z of a cube around a point, with 90 degrees of view each. Frames as in Direct3D:
// left-handed, right x up = forward.
typedef struct vplCubeFrame {
    vplVec3 right, up, forward;
} vplCubeFrame;

// The frame of face 0 to 5.
vplCubeFrame vplCube_GetFrame(int face);

// Where a direction meets the cube: face, s and t in [0, 1] (t down), and texel (i, j) of a map with `size`
// texels a side. Ties go to z, then y, then x. False for the zero vector.
bool vplCube_Find(vplVec3 direction, int size, int* face, float* s, float* t, int* i, int* j);

typedef struct vplCubeMapDef {
    vplVec3 position; // metres
    int size;         // texels along a face, [1, VPL_MAX_SHADOW_MAP]; default 1024
    float near;       // metres, > 0: what is nearer to the position casts no shadow; 0 (default): far * 2^-20
    float far; // metres, > near: unit of the stored distances; 0 (default): distance of the farthest vertex
    uint32_t cookie; // set by vplDefaultCubeMapDef
} vplCubeMapDef;

vplCubeMapDef vplDefaultCubeMapDef(void);

// Distances from a point to the nearest surface in all directions. Read only.
typedef struct vplCubeMap {
    vplVec3 position;
    int size;
    float near, far;
    const float*
        texels; // [face][row][column]: radial distance / far, not clamped; +infinity where nothing is
    struct vplCubeBounds* bounds; // NULL before vplCubeMap_FindBounds
    vplRasterStats stats;
    vplContext* context;
} vplCubeMap;

// Draws every object six times. Source: Franchi and Ferrante, Virtual Point Lights, "Rendering the Cube Shadow
// Map"; departs in not clamping distances to far, which falsely shadows the corners of the cube.
vplResult vplCubeMap_Create(const vplGeometry* geometry, const vplCubeMapDef* def, vplProgressFcn* progress,
                            void* user, vplCubeMap** mapOut);

// Draws the map again, for a light that moved: the same size, no memory is made for texels, and bounds are
// forgotten. Where it fails, the map's contents are undefined.
vplResult vplCubeMap_Redraw(vplCubeMap* map, const vplGeometry* geometry, const vplCubeMapDef* def,
                            vplProgressFcn* progress, void* user);

// Finds what the texels of each region have in common, so that for most points one look takes the place of all
// samples of a soft shadow. Shadows keep their bits. It costs about as much as half a sample per texel, and pays
// where points times samples are more than half the texels. On failure the map is as it was.
vplResult vplCubeMap_FindBounds(vplCubeMap* map);

// NULL is allowed.
void vplCubeMap_Destroy(vplCubeMap* map);

// The stored distance in a direction, metres; +infinity where nothing is or for the zero vector.
float vplCubeMap_Distance(const vplCubeMap* map, vplVec3 direction);

typedef enum vplBiasRule {
    VPL_BIAS_AUTO = 0, // VPL_BIAS_EXACT; in vplRender with documented lighting VPL_BIAS_PAIR
    VPL_BIAS_PAIR,     // b_s + b_dmax (1 - n.l): the document's static and dynamic bias
    VPL_BIAS_EXACT     // r (1 - cos t / cos(t - a)): what a plane at angle t needs when samples are a off
} vplBiasRule;

typedef struct vplShadowDef {
    vplBiasRule biasRule; // default VPL_BIAS_AUTO
    float biasStatic;     // b_s, metres; negative (default): far * texel half-angle + pcfOffset; pair only
    float
        biasDynamic; // b_dmax, metres; negative (default): 5.6 b_s, free of acne up to 80 degrees; pair only
    int pcfSamples;  // S, [1, VPL_MAX_PCF_SAMPLES]; 1 is a hard shadow; default 16
    float pcfOffset; // off: radius of the disc of samples at the fragment, metres, >= 0; negative
                     // (default): far / 128
    uint32_t cookie; // set by vplDefaultShadowDef
} vplShadowDef;

vplShadowDef vplDefaultShadowDef(void);

// A checked shadow test with its automatic values filled in and its sample pattern made.
typedef struct vplShadow {
    const vplCubeMap* map;
    vplShadowDef def;
    float reach;                           // not less than any offset, metres
    float texelTangent;                    // tangent of the largest angle between a texel's centre and corner
    float offsets[VPL_MAX_PCF_SAMPLES][2]; // on the unit disc, in pairs o, -o; times pcfOffset
} vplShadow;

vplResult vplShadow_Create(const vplCubeMap* map, const vplShadowDef* def, vplShadow* shadowOut);

// The bias subtracted from the distance of a fragment, metres. cosine is max(n.l, 0).
// Source: VPL_BIAS_PAIR from Franchi and Ferrante, Virtual Point Lights, "Rendering the Point Light with
// Shadows"; VPL_BIAS_EXACT from the geometry of a plane, derived in src/visibility/shadow_kernel.c.
float vplShadow_Bias(const vplShadow* shadow, float distance, float cosine);

// The shadow factor s in [0, 1] at a surface point: the share of samples that see something nearer to the
// light. The samples lie on a disc perpendicular to the light, so no seams show at the cube's edges.
float vplShadow_Factor(const vplShadow* shadow, vplVec3 position, vplVec3 normal);

// 16 points at once: the positions and unit normals of a block.
typedef struct vplSurface {
    float px[VPL_LANES], py[VPL_LANES], pz[VPL_LANES];
    float nx[VPL_LANES], ny[VPL_LANES], nz[VPL_LANES];
} vplSurface;

void vplShadow_FactorBlock(const vplShadow* shadow, const vplSurface* surface, float factorOut[VPL_LANES]);

// ---- many small maps: what virtual lights, which shine to one side of their surface only, see of a scene

// The half space above a surface, as an octahedron's upper half seen from straight above and turned by 45 degrees:
// the direction (x, y, z) in the frame below meets (u, v) = (x + y, x - y) / (|x| + |y| + z) in [-1, 1]^2. Straight
// edges stay straight but for kinks where x or y is 0, and one square sees what a half cube sees with three.
// Source: Emil Praun and Hugues Hoppe, Spherical Parametrization and Remeshing, SIGGRAPH 2003 (the octahedron); Zina
// Cigolle and others, A Survey of Efficient Representations for Independent Unit Vectors, JCGT 2014 (its half).
typedef struct vplHemiMap {
    vplVec3 position;           // metres; a hair above the surface
    vplVec3 right, up, forward; // right-handed, unit; forward is the surface's normal
    int size;                   // texels along a side
    const float*
        texels; // 1 / (|x| + |y| + z) of the nearest surface, 1/metres; 0 where nothing is; in blocks of
                // 4 x 4 of columns (u) and rows (v)
    vplContext* context;
} vplHemiMap;

// Read only.
typedef struct vplHemiMaps {
    const vplHemiMap* maps;
    int count, capacity, size;
    float* texels;
    vplContext* context;
} vplHemiMaps;

typedef struct vplHemiMapPlace {
    vplVec3 position; // metres; on a surface, which does not shadow it
    vplVec3 normal;   // unit
} vplHemiMapPlace;

// Room for `capacity` maps with `size` texels a side, [1, VPL_MAX_SHADOW_MAP].
vplResult vplHemiMaps_Create(vplContext* context, int size, int capacity, vplHemiMaps** mapsOut);

// Memory per map.
size_t vplHemiMaps_BytesPerMap(int size);

// Draws what is seen from `count` places, at most the capacity, side by side; those of before are gone.
vplResult vplHemiMaps_Draw(vplHemiMaps* maps, const vplGeometry* geometry, const vplHemiMapPlace* places,
                           int count, vplProgressFcn* progress, void* user);

// NULL is allowed.
void vplHemiMaps_Destroy(vplHemiMaps* maps);

// 1 where something nearer to the place hides it from a point, and where one lies behind the other's surface; else 0.
// A ray says the same except within a band. A texel's centre looks past a point at distance r, in the direction (x, y,
// z), by at most the footprint f = sqrt(2) (|x| + |y| + z) / size; along the point's plane, at the angle T to the light,
// it is nearer by at most b = r (1 - cos T / cos(T - a)), tan a = f / r, as in VPL_BIAS_EXACT; 1.5 f are tolerated. So
// the answers are equal where all that blocks the way is further than 2.5 f + b from the point, and blocks or frees all
// ways to the point's plane within f around it alike.
void vplHemiMap_FactorBlock(const vplHemiMap* map, const vplSurface* surface, float factorOut[VPL_LANES]);

// ---- paraboloid maps: what a cluster of virtual lights sees of a scene

// Where a direction of any length, in a map's frame (z along its axis), meets the front hemisphere's map: p = (x, y) /
// (|d| + z), inside the unit disk where z >= 0. False where z is -|d|, and for the zero vector. It is the stereographic
// projection: circles stay circles, and an area of the disk stands for 4 / (1 + p^2)^2 times as much solid angle.
// Source: Wolfgang Heidrich and Hans-Peter Seidel, View-independent Environment Maps, Graphics Hardware 1998.
bool vplParaboloid_Project(vplVec3 direction, double* x, double* y);

// The unit direction of a point of the map; the inverse.
vplVec3 vplParaboloid_Unproject(double x, double y);

// What a diffuse light sends through a point of the unit disk, as a multiple of the mean over the disk:
// 4 (1 - p^2) / (1 + p^2)^3, the cosine times the solid angle. 0 outside of the disk.
double vplParaboloid_Weight(double x, double y);

// One place and the surfaces that it sees. Hemisphere 0 looks along `forward`, hemisphere 1 (if there are two) back,
// with z turned round: p = (x, y) / (|d| - z).
typedef struct vplParaboloidMap {
    vplVec3 position;           // metres
    vplVec3 right, up, forward; // right-handed, unit
    int size;                   // texels along a side; the disk touches the sides of the square
    int hemispheres;            // 1 or 2
    // 1 / distance of the nearest surface along the texel's centre, 1/metres; 0 where nothing is and outside of the disk
    // (of two, by more than a texel's diagonal). [hemisphere][row + 1 (y)][column + 1 (x)], size + 2 of either: those at
    // the sides are there twice.
    const float* texels;
    const int32_t*
        triangles; // in that order, not twice: index in the geometry, -1 where nothing is; NULL: not kept
    vplContext* context;
} vplParaboloidMap;

// Read only.
typedef struct vplParaboloidMaps {
    const vplParaboloidMap* maps;
    int count, capacity, size;
    float* texels;
    int32_t* triangles; // NULL: not kept
    float* scratch;     // where workers draw
    vplContext* context;
} vplParaboloidMaps;

typedef struct vplParaboloidPlace {
    vplVec3 position; // metres
    vplVec3 normal;   // unit: the axis
    int hemispheres;  // 1: nothing behind the plane is asked for; 2
    bool onSurface;   // it lies on one, which must not hide what it sees: seen from a hair above
} vplParaboloidPlace;

// Room for `capacity` maps of two hemispheres with `size` texels a side, [1, VPL_MAX_SHADOW_MAP]; with triangles, where
// surfaces are asked for (vplParaboloidMap_GetHit).
vplResult vplParaboloidMaps_Create(vplContext* context, int size, int capacity, bool triangles,
                                   vplParaboloidMaps** mapsOut);

// Draws what is seen from `count` places, at most the capacity, side by side; those of before are gone. One pass over
// the triangles per hemisphere. Edges are not straightened: whether a texel's centre lies in a triangle is decided in
// space, by the planes through its edges and the eye, so that there is no distortion to bound. The document's
// rasterizer draws them straight, up to 169 of 512 texels off (EXTREMES.md).
vplResult vplParaboloidMaps_Draw(vplParaboloidMaps* maps, const vplGeometry* geometry,
                                 const vplParaboloidPlace* places, int count, vplProgressFcn* progress,
                                 void* user);

// NULL is allowed.
void vplParaboloidMaps_Destroy(vplParaboloidMaps* maps);

// What texel (column, row) of a hemisphere sees: the hit of the ray through its centre, and that ray's unit direction
// in the world. False where nothing is and outside of the disk. The map must have triangles.
bool vplParaboloidMap_GetHit(const vplParaboloidMap* map, const vplGeometry* geometry, int hemisphere,
                             int column, int row, vplHit* hitOut, vplVec3* directionOut);

// The share in [0, 1] of what lies between a point and the map's place, for 16 points: of the four texels around it,
// linearly weighted, those that see something nearer than the point's own plane. The plane may face either way: lights
// beside the map's place may be before it. Points in a hemisphere that was not drawn: 1; of the only hemisphere, texels
// beyond the rim hide nothing. A ray says the same except within a band: texels' centres look past a point at distance r
// by at most a texel's diagonal f = 2 sqrt(2) (r + |z|) / size, z along the axis, where its plane, at the angle T to the
// light, is nearer by at most b = r (1 - cos T / cos(T - a)), tan a = f / r; f / 2 and less is tolerated. So the answers
// are equal where all that blocks the way is further than 2.5 f + b from the point, and blocks or frees all ways to the
// point's plane within f around it alike.
void vplParaboloidMap_FactorBlock(const vplParaboloidMap* map, const vplSurface* surface,
                                  float factorOut[VPL_LANES]);

#ifdef __cplusplus
}
#endif

#endif
