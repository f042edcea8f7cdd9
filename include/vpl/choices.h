// SPDX-License-Identifier: MIT
// Choices of methods that options and the headers of single stages share, and the statistics of the radiosity solver.
#ifndef VPL_CHOICES_H
#define VPL_CHOICES_H

#include <vpl/base.h>

VPL_HEADER_BEGIN

// The formulas of particles and of shading.
typedef enum vplLighting {
    VPL_LIGHTING_PHYSICAL = 0, // radiometry: virtual lights emit flux/pi cos, clamped cos cos / d^2
    VPL_LIGHTING_DOCUMENTED    // as Franchi and Ferrante print it: no falloff, rho/pi per bounce
} vplLighting;

typedef enum vplSampler {
    VPL_SAMPLER_AUTO = 0,  // Halton where particles' starts are lights (Keller), else random
    VPL_SAMPLER_RANDOM,    // counter-based random numbers
    VPL_SAMPLER_HALTON,    // radical inverses in the primes
    VPL_SAMPLER_HAMMERSLEY // i/N and radical inverses
} vplSampler;

typedef enum vplBounce {
    VPL_BOUNCE_AUTO = 0, // reflect for documented lighting, diffuse for physical
    VPL_BOUNCE_REFLECT,  // like a mirror
    VPL_BOUNCE_DIFFUSE   // cosine-distributed
} vplBounce;

// The geometry that stops particles.
typedef enum vplParticleGeometry {
    VPL_PARTICLE_GEOMETRY_EXACT = 0, // the triangles
    VPL_PARTICLE_GEOMETRY_OBB        // objects' oriented bounding boxes (Franchi and Ferrante, "Improving")
} vplParticleGeometry;

// Distance of a light from a cluster: w1 |V - C| + w2 times one of these; n: the two unit normals.
typedef enum vplClusterMetric {
    VPL_CLUSTER_ONE_MINUS = 0,     // 1 - n.n (the default)
    VPL_CLUSTER_PRINTED,           // max(n.n, 0), as printed: equal normals are far apart
    VPL_CLUSTER_ONE_MINUS_CLAMPED, // 1 - max(n.n, 0)
    VPL_CLUSTER_ANGLE              // the angle, radians (Dong et al. 2009)
} vplClusterMetric;

typedef enum vplSecondWeight {
    VPL_SECOND_WEIGHT_COSINE = 0, // 4 (1 - p^2) / (1 + p^2)^3: a diffuse light (default)
    VPL_SECOND_WEIGHT_PRINTED     // 1: the document gives none
} vplSecondWeight;

// Ways to add up virtual lights. The first three give the same bits.
typedef enum vplAccumulation {
    VPL_ACCUMULATE_MULTIPASS = 0, // one pass over the scene per light, depth EQUAL, additive
    VPL_ACCUMULATE_BATCHED,       // one pass per `batch` lights
    VPL_ACCUMULATE_DEFERRED,      // one pass for a G-buffer, then all lights per tile
    VPL_ACCUMULATE_INTERLEAVED,   // every K^2-th light per pixel, then means of neighbours on one surface
    VPL_ACCUMULATE_LIGHTCUTS,     // clusters of a light tree, as fine as an error bound requires
    VPL_ACCUMULATE_USUAL          // vplRender chooses by the method, particles and interleave
} vplAccumulation;

typedef enum vplFormFactorKind {
    // Stratified pairs of points with a shadow ray each; `analytic` decides about the unoccluded part.
    VPL_FORM_FACTORS_MONTE_CARLO = 0,
    // One pair of points, the incentres: A_j cos cos / (pi r^2) V, as Hemgren has it.
    VPL_FORM_FACTORS_INCENTRE
} vplFormFactorKind;

// Correction of rows of form factors whose sums are not those of a closed or open room.
typedef enum vplRowSums {
    VPL_ROW_SUMS_USUAL = 0, // clamped for Monte Carlo, kept for incentres
    VPL_ROW_SUMS_KEEP,
    VPL_ROW_SUMS_CLAMP,    // scale factors, alike in both directions, until no row's sum is above 1
    VPL_ROW_SUMS_NORMALISE // scale until the sum of every row that is not 0 is 1: for closed rooms
} vplRowSums;

typedef enum vplSolver {
    // Each side uses the new values of the sides before it. Source: Hemgren, Algorithm 1.
    VPL_SOLVER_GAUSS_SEIDEL = 0,
    // One sweep is one bounce. Links are always solved by Jacobi.
    VPL_SOLVER_JACOBI,
    // Progressive refinement: the side with the most unshot power sends it to all others. As many shots as
    // there are sides count as one sweep.
    VPL_SOLVER_SHOOTING
} vplSolver;

typedef struct vplSolveStats {
    vplSolver solver; // the one used: Jacobi for links, whatever the def says
    int iterations;
    double residual; // of the last sweep, as in vplSolveDef; 0 where there was none
    // The spectral radius of rho F, estimated from below: one sweep of Jacobi shrinks errors by this factor.
    // At 1 and above there is no solution. 0: no light is exchanged, or vplSolveDef.spectrum is false.
    double spectralRadius;
    double rowSumMin, rowSumMean, rowSumMax; // of F as used; the mean is weighted by area
} vplSolveStats;

// The weights of the sides that meet at a vertex.
typedef enum vplVertexWeight {
    VPL_VERTEX_WEIGHT_ANGLE = 0, // the angle of their corner, times the fraction of their cells that is open
    VPL_VERTEX_WEIGHT_AREA,      // the area of their open cells
    VPL_VERTEX_WEIGHT_EQUAL      // equal weights, whether cells are open or not, as Hemgren has it
} vplVertexWeight;

VPL_HEADER_END

#endif
