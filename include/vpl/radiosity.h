// SPDX-License-Identifier: MIT
// Radiosity: surfaces divided into patches, form factors between them, and the light that they exchange.
// Source: Dan Hemgren, Radiosity in Realtime Rendering, and the improvements that it suggests.
#ifndef VPL_RADIOSITY_H
#define VPL_RADIOSITY_H

#include <vpl/choices.h>
#include <vpl/geometry.h>
#include <vpl/image.h>
#include <vpl/raster.h>

VPL_HEADER_BEGIN

// ---- sides of patches: the unknowns of the radiosity equations

// Two rounds of joining the midpoints of a triangle's edges divide each patch into 16 cells. A group's triangles, one
// after the other, are divided into 16 of equal area. vplPatchSides_SampleCell defines their order.
enum { VPL_PATCH_CELLS = 16 };

// One side of a patch. Surfaces reflect on both sides, and only sides that light can reach are in the
// equations.
typedef struct vplPatchSide {
    int patch;
    bool back;          // the side that the patch's normal points away from
    uint16_t open;      // bit k: light can reach cell k; never 0
    float area;         // m^2, of the open cells; the patch's whole area where all are open
    vplVec3 corners[3]; // counter-clockwise seen from this side; of a group's first triangle
    vplVec3 normal;     // unit, of this side; a group's mean, weighted by area
    vplVec3 incentre;   // the centre of the inscribed circle; a group's centroid
    vplRgb reflectance; // a group's mean, weighted by area
    vplRgb emission;    // radiosity, W/m^2: pi times the material's radiance, 0 on the back
} vplPatchSide;

typedef struct vplPatchSidesDef {
    // Light sources that are not part of the geometry; NULL where emitterCount is 0 (default).
    const vplEmitterDef* emitters;
    int emitterCount;
    // Camera positions: sides that they see are searched for light from there, too, and without light sources count as
    // reached. NULL where viewpointCount is 0 (default).
    const vplVec3* viewpoints;
    int viewpointCount;
    // Keep all cells and patches of a triangle's side where light reaches any of it, also those under boxes,
    // as Hemgren does. Default false.
    bool wholeTriangles;
    // Leave out sides that the viewpoints do not see and that receive less than 1/64 of the mean light of the sides that the viewpoints
    // see, as in voids behind walls. Nothing is left out where fewer than one in eight sides is so faint, or where more than 1/50 of the area
    // that the viewpoints see has less than 1/16 of the mean. Default false: all viewpoints have their light.
    bool leaveFaint;
    uint64_t seed; // default 0
    vplProgressFcn* progress;
    void* progressUser;
    uint32_t cookie; // set by vplDefaultPatchSidesDef
} vplPatchSidesDef;

vplPatchSidesDef vplDefaultPatchSidesDef(void);

// The sides, and their cells, that light can reach. Read only.
typedef struct vplPatchSides {
    const vplPatches* patches;
    const vplPatchSide* sides; // in the order of patches, front before back
    int count;
    const int* ofPatch;     // [patch][front, back]: index in sides, -1: light does not reach that side
    int64_t rays;           // cast to find the sides
    struct vplArena* arena; // owns the arrays
    vplContext* context;
    const int* hits; // per side: hits of the particles that search for sides; NULL: not known
    // Where a viewpoint sees a dark room and triangles are in groups, which may lie on both sides of its wall; else NULL. Per triangle
    // a code for its front, in the low four bits, and one for its back, in the high four. 0: light reaches the whole side. 1: light
    // reaches no part of it. 2 + k: light reaches the part from which corner k of the node is visible;
    // on the back, corner (3 - k) % 3.
    const uint8_t* dark;
    int faintCount; // sides left out by vplPatchSidesDef.leaveFaint
} vplPatchSides;

// Finds the sides that light reaches: by particles from all light sources, by rays from the viewpoints, and
// by rays from sides that no particle hit to sides that are reached. The inside of a box, the floor under it
// and a room without a light source are left out and do not darken what is beside them. A cell is open where
// light reaches half of it; a patch smaller than 1/32 of the mean area has one cell. Of coplanar triangles
// that overlap, the first receives the light. Sides in a sealed room without a light source are left out even if a
// viewpoint sees them, so that they are exactly black. Without light sources, only what the viewpoints see, and what
// is visible from there, is kept. VPL_INVALID_ARGUMENT for a def with a wrong cookie, a negative count, a
// missing array or a viewpoint that is not finite.
vplResult vplPatchSides_Create(const vplPatches* patches, const vplPatchSidesDef* def,
                               vplPatchSides** sidesOut);

// NULL is allowed.
void vplPatchSides_Destroy(vplPatchSides* sides);

// A point of a side.
typedef struct vplSidePoint {
    vplVec3 at;
    vplVec3 normal; // unit, of the side; in a group, of the triangle's side
    int triangle;   // of the geometry
} vplSidePoint;

// A point of cell k, uniform over it for u, v uniform in [0, 1).
// Not checked, for speed: pointers must not be NULL.
vplSidePoint vplPatchSide_SampleCell(const vplPatchSides* sides, const vplPatchSide* side, int k, float u,
                                     float v);

// ---- form factors

// The largest matrix of form factors, unless the context's limit of memory (vplContext_SetMemoryLimit) is higher; larger scenes
// need the hierarchy (vplLinks) or a team of processes (vplContext_SetTeam).
#define VPL_MAX_FORM_FACTOR_BYTES ((int64_t)1 << 30)

typedef struct vplFormFactorDef {
    vplFormFactorKind kind; // default VPL_FORM_FACTORS_MONTE_CARLO
    int samples;            // pairs of points per pair of patches, [1, 1024]; default 4; Monte Carlo only
    // Monte Carlo only. true (default): the unoccluded form factor is computed, by the contour integral for
    // near pairs and by quadrature with three points per side for others, and rays only estimate the visible
    // fraction. false: the mean over the pairs of points, as Hemgren has it.
    bool analytic;
    vplRowSums rowSums; // default VPL_ROW_SUMS_USUAL
    bool bruteForce;    // rays test every triangle, to measure what the ray tree saves; default false
    uint64_t seed;      // default 0
    vplProgressFcn* progress;
    void* progressUser;
    uint32_t cookie; // set by vplDefaultFormFactorDef
} vplFormFactorDef;

vplFormFactorDef vplDefaultFormFactorDef(void);

// F[i][j]: the fraction of what side i emits that arrives at side j. Read only.
typedef struct vplFormFactors {
    int count;
    const float* rows;           // [i][j]; NULL where a team shares them
    const float* rowSums;        // before vplFormFactorDef.rowSums corrected them
    int64_t rays, analyticPairs; // of this process
    struct vplArena* arena;      // owns the arrays
    vplContext* context;
} vplFormFactors;

// Computes half of the pairs, and the others by A_i F_ij = A_j F_ji. Factors are 0 within a plane and, except
// for incentres, never above 1. Rays are cast only where a triangle can be in the way; bruteForce casts all.
// VPL_LIMIT where the matrix of one process takes more than VPL_MAX_FORM_FACTOR_BYTES, or than the context's limit of memory
// if that is higher; VPL_INVALID_ARGUMENT for a wrong def.
// Source: Hemgren, 3.3.1.
vplResult vplFormFactors_Create(const vplPatchSides* sides, const vplFormFactorDef* def,
                                vplFormFactors** factorsOut);

// NULL is allowed.
void vplFormFactors_Destroy(vplFormFactors* factors);

// The unoccluded form factor from triangle a to triangle b by the contour integral; each triangle is clipped
// at the other's plane. Corners are counter-clockwise on the sides that exchange light. Relative error below
// 1e-11 against closed forms of squares 2^-7 to 10^6 sides apart and of touching and thin triangles, below
// 2e-8 for any factor above 1e-6 (tests/test_triangle_factors.c).
// Source: Hottel and Sarofim, Radiative Transfer, 1967, chapter 2 (after Stokes).
double vplTriangleFormFactor(const vplVec3 a[3], const vplVec3 b[3]);

// The unoccluded form factor from a surface element to a triangle, in [0, 1]: the fraction of the element's
// diffuse emission that arrives at the side on which the corners are counter-clockwise, which is also the
// factor of the triangle's radiosity in the element's irradiance. The triangle is clipped at the element's
// plane; only the direction of `normal` counts. 0 where the point is behind the triangle's plane, or in it to
// the precision of double, where the triangle has no area, and where numbers are not finite. Error below
// 1e-15, or that times the triangle's size over the distance from its edges; from five sizes away, relative
// error below 1e-13 over the lesser of both cosines (300,000 random cases in quadruple precision).
// Source: Lambert, Photometria, 1760; Hottel and Sarofim, Radiative Transfer, 1967, chapter 2; Baum,
// Rushmeier and Winget, Improving Radiosity Solutions through the Use of Analytically Determined
// Form-Factors, SIGGRAPH 1989.
double vplPointFormFactor(vplVec3 point, vplVec3 normal, const vplVec3 triangle[3]);

// ---- the hierarchy: form factors between patches, and between groups of patches that are far apart

typedef struct vplLinkDef {
    // Links are divided until the exchange of two groups differs from a linear function of the place on either by
    // less than this fraction of all that their receiver gets, (0, 1]; default 0.00015; half of it where something is
    // between them; four times as much where sides are groups of triangles, which err by more themselves. Without
    // groups, beyond 4,000 sides, it falls with the root of their number. The number of links rises by 1.7 to 1.9 where
    // the error is halved.
    double error;
    // Shadow rays between two sides, [1, 1024], of which up to 64 are cast; default 4. Groups take 16 to 64, more where
    // they exchange more, unless nothing is between their parents.
    int samples;
    // Default VPL_ROW_SUMS_USUAL: normalise sides from which all of 32 rays hit sides and whose form factors sum to
    // 0.97 or more, clamp others.
    vplRowSums rowSums;
    uint64_t seed; // default 0
    vplProgressFcn* progress;
    void* progressUser;
    uint32_t cookie; // set by vplDefaultLinkDef
} vplLinkDef;

vplLinkDef vplDefaultLinkDef(void);

// Source: Hanrahan, Salzman and Aupperle, A Rapid Hierarchical Radiosity Algorithm, SIGGRAPH 1991; Smits,
// Arvo and Greenberg, A Clustering Algorithm for Radiosity in Complex Environments, SIGGRAPH 1994 (groups of
// surfaces).
typedef struct vplLinks {
    int sideCount, groupCount;
    int64_t linkCount, rays;
    // The sum of each side's form factors before vplLinkDef.rowSums corrected them.
    const float* rowSums;
    struct vplLinkTree* tree;
    struct vplArena* arena; // owns the arrays and the tree
    vplContext* context;
} vplLinks;

// VPL_INVALID_ARGUMENT for a wrong def.
vplResult vplLinks_Create(const vplPatchSides* sides, const vplLinkDef* def, vplLinks** linksOut);

// NULL is allowed.
void vplLinks_Destroy(vplLinks* links);

// ---- solvers of B = E + rho F B

enum { VPL_MAX_SWEEPS = 1 << 20 };

typedef struct vplSolveDef {
    vplSolver solver; // default VPL_SOLVER_GAUSS_SEIDEL
    int iterations;   // the most sweeps, [0, VPL_MAX_SWEEPS]; default 100
    // E in [0, 1], default 1e-4. Sweeps end when the largest change is at most E times the largest radiosity, and the mean over
    // the area of each side's relative change is at most 50 E, so that dark places are complete, too. 0: sweeps end
    // when nothing changes, and there is no warning.
    double residual;
    // The next frame goes on sweeping: stopping before `residual` is no warning. Default false.
    bool continues;
    // Compute the stats' spectral radius and row sums, which costs about ten sweeps; default true.
    bool spectrum;
    vplProgressFcn* progress;
    void* progressUser;
    uint32_t cookie; // set by vplDefaultSolveDef
} vplSolveDef;

vplSolveDef vplDefaultSolveDef(void);

// The exchange of light between sides: by form factors or by links.
typedef struct vplTransport {
    const vplPatchSides* sides;
    const vplFormFactors* factors; // NULL: by links
    const vplLinks* links;         // NULL: by form factors
} vplTransport;

// Solves for radiosity[], which also holds the start value: `source` for a solution from scratch, the
// previous frame's solution where light has moved. Both in W/m^2, one per side. VPL_LIMIT where the solution
// diverges; radiosity[] then keeps its start value. It diverges where changes grow from sweep to sweep and
// the spectral radius is above 1.0001, or where a radiosity leaves the range of float. VPL_INVALID_ARGUMENT
// where a value is not finite or the transport does not fit the sides. Ending by `iterations` before
// `residual` is a success with a warning. Shooting relies on A_i F_ij = A_j F_ji. statsOut may be NULL.
vplResult vplSolveRadiosity(const vplTransport* transport, const vplSolveDef* def, const vplRgb* source,
                            vplRgb* radiosity, vplSolveStats* statsOut);

// The irradiance of each side, W/m^2: F B.
vplResult vplGatherRadiosity(const vplTransport* transport, const vplRgb* radiosity, vplRgb* irradianceOut);

// The residual of each side, W/m^2: source + rho F B - B.
vplResult vplRadiosityResidual(const vplTransport* transport, const vplRgb* source, const vplRgb* radiosity,
                               vplRgb* residualOut);

// ---- from patches to pictures

// The triangles that are drawn: the patches, cut where vertices of others lie on their edges, so that there
// are no cracks and light is continuous. Patches share a vertex if their planes are within 20 degrees or they
// belong to one smooth object. Where surfaces were cut, values on a face of a vertex are means over those of these
// patches that edges join on which nothing stands on that face: light does not pass under a wall.
typedef struct vplPatchMesh {
    const vplPatchSides* sides;
    const vplVec3* positions; // metres
    // Unit: the mean over the patches at a vertex, of shading normals on smooth objects.
    const vplVec3* normals;
    const uint32_t* indices; // three per triangle
    const int* patchOf;      // of each triangle
    const int* triangleOf;   // of each triangle: that of the geometry which it is a part of
    // One byte per triangle. Bit k: the edge from corner k is an edge of the patch, not a cut.
    const uint8_t* edges;
    int vertexCount, triangleCount;
    int hangingVertices;             // positions at which some patch's edge was cut
    struct vplPatchesAround* around; // the patches at each vertex
    struct vplArena* arena;          // owns the arrays
    vplContext* context;
} vplPatchMesh;

// Edges are cut where bisection put another patch's vertex at their midpoint. T-vertices that the scene
// itself has stay: 46 in the conference room, 802 in Sibenik, 4 in Sponza. If vplPatchDef.cut was set,
// edges are cut there, too.
// Source: Baum, Mann, Smith and Winget, Making Radiosity Usable, SIGGRAPH 1991.
vplResult vplPatchMesh_Create(const vplPatchSides* sides, vplPatchMesh** meshOut);

// NULL is allowed.
void vplPatchMesh_Destroy(vplPatchMesh* mesh);

// Means at the vertices of one finite value per side: [vertex][front, back], in the unit of `values`. Sides
// that light does not reach are ignored, so that they do not darken others; a vertex without any side gets 0.
// A patch whose edge was cut at a vertex counts there, too. Source: Hemgren, 4.
vplResult vplPatchMesh_Interpolate(const vplPatchMesh* mesh, vplVertexWeight weight, const vplRgb* values,
                                   vplRgb* vertexValuesOut);

typedef struct vplVertexGather {
    const vplRgb* radiosity; // W/m^2, one per side
    int rays;                // from each vertex, [1, 65536]
    const bool* only;        // [vertex][front, back]: false: the value stays as it is; NULL: all are gathered
    uint64_t seed;
    vplProgressFcn* progress;
    void* progressUser;
} vplVertexGather;

// Gathers irradiance at the vertices by rays to the sides: unlike an interpolated mean, it knows dark corners
// inside patches. Where the sides at a vertex end, at a wall or under a box, rays start 1/32 of the way into
// them. Out: [vertex][front, back], W/m^2, 0 where a vertex has no side; its standard deviation is at most
// that of what the rays hit, over sqrt(rays). *raysOut grows by the rays cast; it may be NULL.
// Source: Reichert, A Two-Pass Radiosity Method Driven by Lights and Viewer Position, Cornell 1992.
vplResult vplPatchMesh_Gather(const vplPatchMesh* mesh, const vplVertexGather* gather,
                              vplRgb* vertexIrradianceOut, int64_t* raysOut);

// Sharpens interpolated values: `rounds` times, changes vertex values, not below 0, so that the mean of the
// interpolated values over each side comes nearer to the side's own value.
// Source: van Cittert, Zum Einfluss der Spaltbreite auf die Intensitaetsverteilung in Spektrallinien II,
// 1931.
vplResult vplPatchMesh_Sharpen(const vplPatchMesh* mesh, vplVertexWeight weight, const vplRgb* values,
                               int rounds, vplRgb* vertexValues);

typedef struct vplPatchDraw {
    const vplPatchMesh* mesh;
    const vplRgb* vertexValues; // [vertex][front, back], interpolated (Gouraud); NULL: draw `values` flat
    const vplRgb* values;       // one per side
    bool reflect;               // values are irradiance: multiply by the patch's reflectance / pi
    bool outlines;              // draw edges of patches dark
    // With `reflect`: the reflectance of a triangle of the geometry in pixel (x, y), instead of the patch's.
    // NULL: the geometry has no textures and no colours of vertices.
    vplRgb (*reflectance)(const void* user, int triangle, int x, int y);
    const void* user; // passed to reflectance
} vplPatchDraw;

// Adds the mesh to an image: one draw of all fronts, one of all backs. Sides that light does not reach hide
// what is behind them; drawn flat they are black, interpolated they show the values at their corners. `clip`:
// x, y, z, w of the mesh's vertices in clip space (vplView_ToClip). Values within a triangle lie between
// those of its corners. If cancelled, part of the image is drawn. statsOut may be NULL.
// Source: Hemgren, 4.
vplResult vplDrawPatches(const vplPatchDraw* draw, const float (*clip)[4], vplProgressFcn* progress,
                         void* user, vplImage* image, vplRasterStats* statsOut);

// Writes the mesh as binary little-endian PLY with a colour per vertex: all fronts, and the backs that light
// reaches, with reversed orientation. `vertexIrradiance`: W/m^2, [vertex][front, back]. Colours are linear
// radiosity rho E as float r, g, b, and rho E times `scale`, >= 0, as 8-bit sRGB red, green, blue. A vertex
// is written once per reflectance. Positions are the caller's: floats, or where the scene has an origin
// (vplScene_SetOrigin) doubles.
vplResult vplPatchMesh_WritePly(const vplPatchMesh* mesh, const vplRgb* vertexIrradiance, float scale,
                                const char* path);

// ---- adaptive subdivision

typedef struct vplPatchPriorityDef {
    const vplRgb* irradiance;       // W/m^2, indirect, one per side
    const vplRgb* vertexIrradiance; // W/m^2, indirect, at the mesh's vertices: [vertex][front, back]
    const vplRgb* vertexDirect;     // W/m^2, direct, at the vertices, from area lights, too; NULL: unknown
    // Standard deviation of direct irradiance over each side, W/m^2, which is large across shadow boundaries;
    // NULL: unknown.
    const float* directSpread;
    uint32_t cookie; // set by vplDefaultPatchPriorityDef
} vplPatchPriorityDef;

vplPatchPriorityDef vplDefaultPatchPriorityDef(void);

// The refinement priority of each patch, for vplPatches_Refine: how much its bisection is expected to lower
// the error, judged by the gradient of light across it, by contact with other surfaces and by shadow
// boundaries. Contact shows only in vertex irradiance from vplPatchMesh_Gather. Priorities are comparable
// within one call only. VPL_INVALID_ARGUMENT for a wrong cookie or missing irradiance.
vplResult vplFindPatchPriority(const vplPatchMesh* mesh, const vplPatchPriorityDef* def, float* priorityOut);

VPL_HEADER_END

#endif
