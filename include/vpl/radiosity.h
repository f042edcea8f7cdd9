// SPDX-License-Identifier: MIT
// Radiosity: surfaces in patches, form factors between them, and the light that all of them exchange.
// Follows Dan Hemgren, Radiosity in Realtime Rendering, and the improvements that it names.
#ifndef VPL_RADIOSITY_H
#define VPL_RADIOSITY_H

#include <vpl/geometry.h>
#include <vpl/image.h>
#include <vpl/raster.h>

#ifdef __cplusplus
extern "C" {
#endif

// ---- sides of patches: what the equations are about

// A patch's cells are the 16 triangles that two rounds of joining the middles of its edges make. Which, and in which
// order: vplPatchSides_SampleCell.
enum { VPL_PATCH_CELLS = 16 };

// One side of a patch. Surfaces reflect on both sides, and only sides that light can reach are in the equations.
typedef struct vplPatchSide {
    int patch;
    bool back;          // the side that the patch's normal points away from
    uint16_t open;      // bit k: light can reach cell k; never 0
    float area;         // of open cells, m^2; the patch's whole area where none is closed
    vplVec3 corners[3]; // counter-clockwise seen from this side
    vplVec3 normal;     // unit, of this side
    vplVec3 incentre;   // the centre of the circle that touches the three edges
    vplRgb reflectance;
    vplRgb emission; // radiosity, W/m^2: pi times the material's radiance, 0 on the back
} vplPatchSide;

typedef struct vplPatchSidesDef {
    const vplEmitterDef* emitters; // light that is not geometry's; NULL where emitterCount is 0
    int emitterCount;
    const vplVec3*
        eyes; // places that are looked from: what they see counts as reached; NULL where eyeCount is 0
    int eyeCount;
    bool
        whole; // as the document has it: all of a triangle's side takes part, cells and patches under boxes, too,
               // where light reaches some of it; default false
    uint64_t seed; // default 0
    vplProgressFcn* progress;
    void* progressUser;
    uint32_t cookie; // set by vplDefaultPatchSidesDef
} vplPatchSidesDef;

vplPatchSidesDef vplDefaultPatchSidesDef(void);

// The sides that light can reach, and where on them: found by particles from everything that emits, from the eyes, and
// by rays from sides that no particle met to others that are reached. The inside of a box, the floor under it and a room
// without a lamp take no part, and do not darken what is beside them (X101). A cell is open where light reaches half of
// it; a patch of less than 1/32 of the mean area is one cell. Of triangles in one place the first has the light. Without
// light, what the eyes see, and what is seen from there, is all that takes part. Read only.
typedef struct vplPatchSides {
    const vplPatches* patches;
    const vplPatchSide* sides; // in the order of patches, front before back
    int count;
    const int* ofPatch; // [patch][front, back]: index in sides, -1: not among them
    int64_t rays;       // that it took
    vplContext* context;
} vplPatchSides;

vplResult vplPatchSides_Create(const vplPatches* patches, const vplPatchSidesDef* def,
                               vplPatchSides** sidesOut);

// NULL is allowed.
void vplPatchSides_Destroy(vplPatchSides* sides);

// A point of cell k, uniform over it for u, v uniform in [0, 1).
vplVec3 vplPatchSide_SampleCell(const vplPatchSide* side, int k, float u, float v);

// ---- form factors

typedef enum vplFormFactorKind {
    VPL_FORM_FACTORS_MONTE_CARLO =
        0,                    // stratified pairs of points with a shadow ray each; near pairs: see `analytic`
    VPL_FORM_FACTORS_INCENTRE // one pair, the incentres: A_j cos cos / (pi r^2) V, as the document has it
} vplFormFactorKind;

// What becomes of rows whose sum is not what it can be.
typedef enum vplRowSums {
    VPL_ROW_SUMS_USUAL = 0, // clamped for Monte Carlo, kept for incentres
    VPL_ROW_SUMS_KEEP,
    VPL_ROW_SUMS_CLAMP,    // factors are scaled, alike in both directions, until no row's sum is above 1
    VPL_ROW_SUMS_NORMALISE // until every row's sum that is not 0 is 1: for closed rooms
} vplRowSums;

// Most memory that form factors of all pairs take; above it there is the hierarchy.
#define VPL_MAX_FORM_FACTOR_BYTES ((int64_t)1 << 30)

typedef struct vplFormFactorDef {
    vplFormFactorKind kind; // default VPL_FORM_FACTORS_MONTE_CARLO
    int samples;            // pairs of points per pair of patches, [1, 1024]; default 4; Monte Carlo only
    bool
        analytic; // Monte Carlo: what a pair would exchange with nothing between is known: by the integral along
    // the edges of near ones, by three points on each side of others; rays only say which share of it
    // is seen. false: the mean over the pairs of points, as the document has it; default true
    vplRowSums rowSums; // default VPL_ROW_SUMS_USUAL
    bool bruteForce;    // rays test every triangle: for measuring what the ray tree is worth; default false
    uint64_t seed;      // default 0
    vplProgressFcn* progress;
    void* progressUser;
    uint32_t cookie; // set by vplDefaultFormFactorDef
} vplFormFactorDef;

vplFormFactorDef vplDefaultFormFactorDef(void);

// F[i][j]: the share of what side i emits that arrives at side j. Read only.
typedef struct vplFormFactors {
    int count;
    const float* rows;    // [i][j]
    const float* rowSums; // before `rowSums` of the def changed them
    int64_t rays, analyticPairs;
    vplContext* context;
} vplFormFactors;

// Half of the pairs are computed, the others by A_i F_ij = A_j F_ji. Factors are 0 within a plane, and, but for
// incentres, never above 1 (X095). Rays are cast only where something can stand between; bruteForce casts all. VPL_LIMIT where all take more than
// VPL_MAX_FORM_FACTOR_BYTES. Source: Hemgren, 3.3.1.
vplResult vplFormFactors_Create(const vplPatchSides* sides, const vplFormFactorDef* def,
                                vplFormFactors** factorsOut);

// NULL is allowed.
void vplFormFactors_Destroy(vplFormFactors* factors);

// The form factor from triangle a to triangle b with nothing between them, by the integral along their edges; what lies
// behind the other's plane is cut off. Sides are those from which the corners are counter-clockwise.
// Source: Hottel and Sarofim, Radiative Transfer, 1967 (after Stokes). Relative error below 1e-11 against closed forms of
// squares 2^-7 to 10^6 sides apart, of touching and of thin triangles, below 2e-8 for any above 1e-6 (tests/test_triangle_factors.c).
double vplTriangleFormFactor(const vplVec3 a[3], const vplVec3 b[3]);

// The form factor from a surface element to a triangle with nothing between them: the share of what leaves the element at
// `point`, diffuse, that arrives at the side from which the corners are counter-clockwise; that is what the triangle's
// radiosity is multiplied by in the element's irradiance. What lies behind the element's plane is cut off. `normal` is
// unit; only its direction counts. In [0, 1]; 0 where the point is behind the triangle's plane, or in it as far as double
// can tell, where the triangle has no area, and where numbers are not finite.
// Source: Lambert, Photometria, 1760; Hottel and Sarofim, Radiative Transfer, 1967, chapter 2; Baum, Rushmeier and Winget,
// SIGGRAPH 1989. Error below 1e-15, or that times the triangle's size over the distance from its edges; from five sizes
// away, relative error below 1e-13 over the lesser of both cosines (300,000 random cases in quadruple precision).
double vplPointFormFactor(vplVec3 point, vplVec3 normal, const vplVec3 triangle[3]);

// ---- the hierarchy: form factors of near pairs between patches, of far ones between groups of them

typedef struct vplLinkDef {
    double
        error; // links are divided until the error of what they carry is below this share of what their receiver
               // gets of all, (0, 1]; default 0.002
    int samples; // pairs of points with a shadow ray per link, [1, 1024]; default 4
    vplRowSums
        rowSums;   // default VPL_ROW_SUMS_USUAL: 1 for sides from which all of 32 rays meet sides, others
                   // clamped; links err by some percent, and what is clamped alone grows darker by that
    uint64_t seed; // default 0
    vplProgressFcn* progress;
    void* progressUser;
    uint32_t cookie; // set by vplDefaultLinkDef
} vplLinkDef;

vplLinkDef vplDefaultLinkDef(void);

// Source: Hanrahan, Salzman and Aupperle, A Rapid Hierarchical Radiosity Algorithm, SIGGRAPH 1991; Smits, Arvo and
// Greenberg, A Clustering Algorithm for Radiosity in Complex Environments, SIGGRAPH 1994 (groups of surfaces).
typedef struct vplLinks {
    int sideCount, groupCount;
    int64_t linkCount, rays;
    const float*
        rowSums; // of each side: the sum of its form factors before `rowSums` of the def changed them
    struct vplLinkTree* tree;
    vplContext* context;
} vplLinks;

vplResult vplLinks_Create(const vplPatchSides* sides, const vplLinkDef* def, vplLinks** linksOut);

// NULL is allowed.
void vplLinks_Destroy(vplLinks* links);

// ---- solvers of B = E + rho F B

typedef enum vplSolver {
    VPL_SOLVER_GAUSS_SEIDEL =
        0,              // each side uses what the sides before it have just got (the document's Algorithm 1)
    VPL_SOLVER_JACOBI,  // one sweep is one bounce; the only one of links
    VPL_SOLVER_SHOOTING // the side with the most unshot power sends it to all others; as many shots as there
                        // are sides count as a sweep
} vplSolver;

enum { VPL_MAX_SWEEPS = 1 << 20 };

typedef struct vplSolveDef {
    vplSolver solver; // default VPL_SOLVER_GAUSS_SEIDEL
    int iterations;   // sweeps, at most, [0, VPL_MAX_SWEEPS]; default 100
    double residual;  // ends when the largest change of a sweep is below this share of the largest radiosity,
                      // [0, 1]; default 1e-4. 0: only where nothing changes, and without a warning
    bool
        relaxes; // more sweeps follow in the next frame: to end before `residual` is no warning; default false
    bool spectrum; // find the stats' spectral radius and sums of rows, which costs some ten sweeps: for light
                   // that moves, once; default true
    vplProgressFcn* progress;
    void* progressUser;
    uint32_t cookie; // set by vplDefaultSolveDef
} vplSolveDef;

vplSolveDef vplDefaultSolveDef(void);

typedef struct vplSolveStats {
    vplSolver solver; // that was used: for links it is Jacobi's whatever the def says
    int iterations;
    double residual; // as above, of the last sweep; 0 where there was none
    double
        spectralRadius; // of rho F, an estimate from below: errors shrink by this factor in a sweep of Jacobi's; 1
    // and more: there is no solution; 0: no light is exchanged, or vplSolveDef.spectrum is off
    double rowSumMin, rowSumMean, rowSumMax; // of F, as used; the mean weighted by area
} vplSolveStats;

// What is exchanged: one of both.
typedef struct vplTransport {
    const vplPatchSides* sides;
    const vplFormFactors* factors; // NULL: by links
    const vplLinks* links;
} vplTransport;

// B starts from radiosity[] as it is: `source` for a solution from nothing, that of the frame before for a light that
// moved. Both W/m^2, one per side. VPL_LIMIT, with a sentence, where it diverges; then radiosity[] is as it was.
// It does where changes grow, sweep for sweep, and the spectral radius is above 1.0001; and where radiosities leave the
// range of float. VPL_SUCCESS with a warning where `iterations` end it before `residual` does. Shooting relies on A_i F_ij = A_j F_ji.
vplResult vplSolveRadiosity(const vplTransport* transport, const vplSolveDef* def, const vplRgb* source,
                            vplRgb* radiosity, vplSolveStats* statsOut);

// What arrives at each side, W/m^2: F B.
vplResult vplGatherRadiosity(const vplTransport* transport, const vplRgb* radiosity, vplRgb* irradianceOut);

// The residual of each side, W/m^2: source + rho F B - B.
vplResult vplRadiosityResidual(const vplTransport* transport, const vplRgb* source, const vplRgb* radiosity,
                               vplRgb* residualOut);

// ---- from patches to pictures

// How sides that meet at a vertex are weighted there.
typedef enum vplVertexWeight {
    VPL_VERTEX_WEIGHT_ANGLE = 0, // by the angle of their corner, times the share of their cells that is open
    VPL_VERTEX_WEIGHT_AREA,      // by their area, times that share
    VPL_VERTEX_WEIGHT_EQUAL      // all alike, closed cells and all: as the document has it
} vplVertexWeight;

// Triangles to be drawn instead of the geometry's: the patches, cut where vertices of others lie on their edges, so
// that nothing shines through and light is continuous (X100). Vertices are shared by patches in about one plane, or of
// one smooth object.
typedef struct vplPatchMesh {
    const vplPatchSides* sides;
    const vplVec3* positions; // metres
    const vplVec3* normals;   // unit: the mean of the patches around, of shading normals on smooth objects
    const uint32_t* indices;  // three per triangle
    const int* patchOf;       // of each triangle
    const uint8_t* edges;     // of each triangle: bit k: from corner k on runs an edge of the patch, no cut
    int vertexCount, triangleCount;
    int hangingVertices;             // places where some patch's edge was cut
    struct vplPatchesAround* around; // the patches at each vertex
    vplContext* context;
} vplPatchMesh;

// Edges are cut where the middles that bisection makes are vertices of other patches. Vertices of the scene that lie
// elsewhere on another triangle's edge stay as the scene has them: 46 of the conference room, 802 of Sibenik, 4 of
// Sponza, none of the boxes.
vplResult vplPatchMesh_Create(const vplPatchSides* sides, vplPatchMesh** meshOut);

// NULL is allowed.
void vplPatchMesh_Destroy(vplPatchMesh* mesh);

// Means at the vertices of one value per side: [vertex][front, back]. Sides that are not among `sides` do not count, so
// that what no light reaches darkens nothing (X101); 0 where none does, which is at no corner of a side that is among
// them. A vertex on the edge of a patch has its share, too. `values` and the result in any unit; finite.
vplResult vplPatchMesh_Interpolate(const vplPatchMesh* mesh, vplVertexWeight weight, const vplRgb* values,
                                   vplRgb* vertexValuesOut);

// Irradiance at the vertices from all that radiosities send there, found by `rays` rays in [1, 65536] from each: unlike
// means of patches around it, it knows that a corner is dark, and its patches need not. Where sides around a vertex end,
// at a wall or under a box, the place is moved a 32nd of the way into them. `radiosity`, W/m^2, one per side; out:
// [vertex][front, back], W/m^2, with the standard deviation of what the rays meet over sqrt(rays), or less; 0 at
// vertices of no side. raysOut, if given, grows by what it took. Source: Reichert, A Two-Pass Radiosity Method Driven by
// Lights and Viewer Position, Cornell 1992.
vplResult vplPatchMesh_Gather(const vplPatchMesh* mesh, const vplRgb* radiosity, int rays, uint64_t seed,
                              vplRgb* vertexIrradianceOut, vplProgressFcn* progress, void* user,
                              int64_t* raysOut);

// Moves such means, not below 0, so that what interpolation shows of each side comes nearer to its value, `rounds` times.
vplResult vplPatchMesh_Sharpen(const vplPatchMesh* mesh, vplVertexWeight weight, const vplRgb* values,
                               int rounds, vplRgb* vertexValues);

// What is drawn on the patches.
typedef struct vplPatchDraw {
    const vplPatchMesh* mesh;
    const vplRgb*
        vertexValues; // [vertex][front, back], interpolated over triangles (Gouraud); NULL: `values`, flat
    const vplRgb* values; // one per side; sides without: 0
    bool reflect;         // values are irradiance: multiplied by the patch's reflectance / pi
    bool outlines;        // edges of patches are drawn dark
} vplPatchDraw;

// Adds to an image: one draw per side of all triangles, fronts first. Sides that are not among the mesh's hide what is
// behind them: flat they are black, interpolated they show what their corners have from the sides beside them. `clip` are x, y, z, w of the mesh's vertices in clip space (vplView_ToClip). Within a
// triangle all values lie between those of its corners. Cancelled, it has added to a part of the image.
// Source: Hemgren, 4.
vplResult vplDrawPatches(const vplPatchDraw* draw, const float (*clip)[4], vplProgressFcn* progress,
                         void* user, vplImage* image, vplRasterStats* statsOut);

// Writes the mesh as binary little-endian PLY with a colour per vertex: all fronts, and the backs, turned round, that
// are among `sides`. W/m^2 irradiance, [vertex][front, back]; colours are linear radiosity rho E as float r, g, b, and
// 8-bit sRGB red, green, blue of it times `scale`, >= 0. Vertices are written twice where reflectances meet.
vplResult vplPatchMesh_WritePly(const vplPatchMesh* mesh, const vplRgb* vertexIrradiance, float scale,
                                const char* path);

// ---- where more patches are wanted

typedef struct vplPatchPriorityDef {
    const vplRgb* irradiance;       // W/m^2, indirect, one per side
    const vplRgb* vertexIrradiance; // the same at the mesh's vertices: [vertex][front, back]
    const vplRgb* vertexDirect;     // W/m^2, direct irradiance there, of lamps, too; NULL: not known
    const float* directSpread; // standard deviation of direct irradiance over each side, W/m^2: large where a
                               // shadow's boundary crosses it; NULL: not known
    uint32_t cookie;           // set by vplDefaultPatchPriorityDef
} vplPatchPriorityDef;

vplPatchPriorityDef vplDefaultPatchPriorityDef(void);

// How much is to be won by bisecting each patch, for vplPatches_Refine: by the gradient of light across it, by contact
// with another surface, by a shadow's boundary. Contact shows only if light at vertices was gathered there. Comparable
// among patches of one call only.
vplResult vplFindPatchPriority(const vplPatchMesh* mesh, const vplPatchPriorityDef* def, float* priorityOut);

#ifdef __cplusplus
}
#endif

#endif
