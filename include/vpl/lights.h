// SPDX-License-Identifier: MIT
// Virtual lights: plain arrays, and the particle simulation that makes them.
#ifndef VPL_LIGHTS_H
#define VPL_LIGHTS_H

#include <vpl/visibility.h>

#ifdef __cplusplus
extern "C" {
#endif

#define VPL_MAX_STEPS (1 << 20)

// Which formulas are used, for particles and for shading.
typedef enum vplLighting {
    VPL_LIGHTING_PHYSICAL = 0, // radiometry: virtual lights emit flux/pi cos, bounded cos cos / d^2
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

// Whose recipe is followed: what counts as step 0.
typedef enum vplParticleStart {
    VPL_START_FIRST_HIT = 0, // Franchi and Ferrante: all N particles are shot, their first hits are step 0
    VPL_START_EMITTER        // Keller: where the N particles start are lights, too, and are step 0
} vplParticleStart;

// What stops a particle.
typedef enum vplParticleGeometry {
    VPL_PARTICLE_GEOMETRY_EXACT = 0, // the triangles
    VPL_PARTICLE_GEOMETRY_OBB        // objects' oriented bounding boxes (Franchi and Ferrante, "Improving")
} vplParticleGeometry;

// ---- reflective shadow maps

typedef struct vplReflectiveMapDef {
    vplEmitterDef emitter; // as in a scene; default vplDefaultEmitterDef()
    int size;              // texels along a side, [1, VPL_MAX_SHADOW_MAP]; default 256
    uint32_t cookie;       // set by vplDefaultReflectiveMapDef
} vplReflectiveMapDef;

vplReflectiveMapDef vplDefaultReflectiveMapDef(void);

// The surfaces that an emitter lights first: per texel how far away they are and which triangle it is; what else there
// is to know of a texel is found when it is asked for. [face][row from the top][column]. Faces: a point emitter has the
// six of a cube map; a spot's one fits its outer angle; a directional emitter's one is a parallel view of all geometry.
// Read only.
typedef struct vplReflectiveMap {
    vplEmitterDef emitter;
    int size, faceCount;
    const float*
        depth; // of the texel's centre along the face's forward, from `origin` on, in `unit`s; +infinity where
               // nothing is
    float unit;              // metres; directional: the length of the view
    const int32_t* triangle; // index in the geometry, -1 where nothing is
    vplVec3 right[6], up[6],
        forward[6];   // of each face: unit; right, up and forward are left-handed, as a cube's
    double extent[2]; // tangents of half the view, across and up; directional: half its size, metres
    vplVec3 origin;   // the emitter; directional: the middle of where the view begins
    vplRasterStats stats;
    vplContext* context;
    struct vplArena* arena; // owns the map
} vplReflectiveMap;

// Draws every object once per face. Source: Dachsbacher and Stamminger, Reflective Shadow Maps, I3D 2005.
vplResult vplReflectiveMap_Create(const vplGeometry* geometry, const vplReflectiveMapDef* def,
                                  vplProgressFcn* progress, void* user, vplReflectiveMap** mapOut);

// NULL is allowed.
void vplReflectiveMap_Destroy(vplReflectiveMap* map);

// Index of the texel that a ray of the emitter goes through; -1 where its view does not reach.
int64_t vplReflectiveMap_Find(const vplReflectiveMap* map, const vplRay* ray);

// The hit of the ray through a texel's centre, inside of its triangle, and that ray's unit direction; false where
// nothing is.
bool vplReflectiveMap_GetHit(const vplReflectiveMap* map, const vplGeometry* geometry, int64_t texel,
                             vplHit* hitOut, vplVec3* directionOut);

// What a texel sees.
typedef struct vplReflectiveTexel {
    float distance; // metres from the emitter; directional: from where its view begins
    vplVec3
        position; // metres: where the ray through the texel's centre meets the triangle; where that is at an edge
                  // and up to 1/256 texel outside, a hair inside
    vplVec3 normal; // unit, interpolated on smooth objects, on the side that is lit
    vplRgb albedo;  // diffuse reflectance, [0, 1]
    vplRgb flux;    // W: incident, what the emitter sends through the texel; it leaves times albedo
    int triangle;   // index in the geometry
} vplReflectiveTexel;

// False where nothing is. Solid angles are exact and a spot's falloff is taken at texels' centres, so the flux of all
// texels of a closed room is a point emitter's power to rounding and a spot's with up to 1/size^2 missing; at
// silhouettes texels are in or out. Departs from Dachsbacher and Stamminger: flux is what arrives, so that it adds up
// whatever the colours.
bool vplReflectiveMap_GetTexel(const vplReflectiveMap* map, const vplGeometry* geometry, int64_t texel,
                               vplReflectiveTexel* texelOut);

// The share in [0, 1] of the emitter's light that something nearer keeps from a point, for 16 points: of the four
// texels around it, linearly weighted, those that see something nearer than the point and its own plane, by more than
// half a texel's side; so planes never shadow themselves, and what is that near to a surface casts no shadow on it. A
// ray says the same (0 or 1) where all rays within a texel's side around it do. 0 where the map's view does not reach.
void vplReflectiveMap_FactorBlock(const vplReflectiveMap* map, const vplSurface* surface,
                                  float factorOut[VPL_LANES]);

// ---- particles

typedef struct vplVirtualLight {
    vplVec3 position; // metres
    vplVec3
        normal; // unit; of the surface, on the side the particle came from (documented: as declared); where a
                // particle leaves a point or comes from a direction, its own direction
    vplRgb light; // documented: the light L the particle carries after attenuation, in the emitter's unit;
                  // physical, and Keller's: flux in W that the surface sends out if one particle carried all
    float
        weight; // N / floor(rho^k N), in a pass rho^-k; of a light that was chosen divided by its probability; the
                // picture also divides by N
    int step;     // k: 0 for the first hit
    int particle; // [0, N)
    int object;   // where it lies; -1: it is the emitter itself (Keller, step 0 of what is no surface)
} vplVirtualLight;

typedef struct vplParticleDef {
    vplLighting lighting;   // default VPL_LIGHTING_PHYSICAL; documented: rho/pi at every hit
    vplParticleStart start; // default VPL_START_FIRST_HIT
    int particleCount;      // N, [0, VPL_MAX_LIGHTS]; default 10
    bool pass; // one of several passes that are one long walk: step k gets floor(rho^k (firstParticle + N)) -
               // floor(rho^k firstParticle) particles of weight rho^-k, so that the passes' mean lacks no
               // step; default false
    int64_t firstParticle;        // index of the first in its sequence, [0, 2^40]; default 0
    double reflectivity;          // rho, [0, 1); the first floor(rho^k N) particles reach step k; default 0.5
    vplSampler sampler;           // default VPL_SAMPLER_AUTO
    vplBounce bounce;             // default VPL_BOUNCE_AUTO
    vplParticleGeometry geometry; // default VPL_PARTICLE_GEOMETRY_EXACT
    uint64_t seed;             // default 0; shifts the low-discrepancy samplers, 0 leaves them as published
    const vplVec3* directions; // N first directions, unit, instead of the sampler's; NULL (default)
    const vplReflectiveMap* const*
        maps; // one per emitter, where its particles' first hits are looked up instead of cast; an entry may be
              // NULL: cast; with exact geometry only; NULL (default)
    vplProgressFcn* progress; // default NULL
    void* progressUser;
    uint32_t cookie; // set by vplDefaultParticleDef
} vplParticleDef;

vplParticleDef vplDefaultParticleDef(void);

// floor(rho^k N) for k = 0, 1, ... until it is 0, for the decimal number that rho was written as: 0.7 * 10 is 7.
// Fills at most `capacity` counts (NULL to count only). *stepsOut is the number of steps, *totalOut the sum.
// VPL_LIMIT beyond VPL_MAX_STEPS steps or VPL_MAX_LIGHTS lights.
// Source: Keller, Instant Radiosity, 1997, section 4; the rule against rounding is derived in particles.c.
vplResult vplCountParticles(vplContext* context, int particleCount, double reflectivity, int* counts,
                            int capacity, int* stepsOut, int64_t* totalOut);

// What a simulation made. Read only.
typedef struct vplLightSet {
    const vplVirtualLight* lights; // by step, then by particle
    int lightCount;
    const int* stepCounts;   // nominal particles per step: floor(rho^k N)
    const int* lightsInStep; // lights really left in each step
    int stepCount;
    int escaped; // particles that left the scene before their last step
    int64_t rays;
    int64_t rayObjectTests; // objects tested; where a hierarchy is used, blocks of 8 triangles
    int particleCount;      // N
    vplContext* context;
    struct vplArena* arena; // owns the set
} vplLightSet;

// Shoots particles from the scene's emitters, and for physical lighting or Keller's start also from triangles that
// emit; all share N by power. Documented lighting of first hits knows point emitters only. Each hit leaves a virtual light; the first
// floor(rho^k N) go on. A particle that hits nothing leaves no light and is gone; the weights keep the nominal
// counts.
// Source: Franchi and Ferrante, Virtual Point Lights, "Particle Simulation"; Keller, Instant Radiosity, 1997,
// section 4, as they tell it under "Keller's Instant Radiosity".
vplResult vplSimulateParticles(const vplGeometry* geometry, const vplEmitterDef* emitters, int emitterCount,
                               const vplParticleDef* def, vplLightSet** setOut);

// NULL is allowed.
void vplLightSet_Destroy(vplLightSet* set);

// ---- lights for what a camera sees

// Lights are candidates first; each is judged by what it gives to some points that the camera sees.
typedef struct vplPlacementDef {
    vplLighting lighting; // formulas by which the lights will light; default VPL_LIGHTING_PHYSICAL
    vplCameraDef camera;  // default vplDefaultCameraDef()
    int width, height;    // pixels; only their ratio counts; default 1280 x 720
    int pointCount; // S, points that the camera sees, [1, 2^20], rounded up to 16 per cell of a grid; default
                    // 256
    int oversampling; // F: candidates come from F N particles, [1, 4096]; fewer where F N particles would leave
                      // more than 2^22 candidates; default 32
    float minDistance;        // bound of the geometry term while judging, metres, >= 0; default 0
    bool shadows;             // the lights will cast shadows; default true
    float fluxShare;          // share of the probabilities that goes by flux alone, (0, 1]; default 0.1
    uint64_t seed;            // default 0
    int64_t index;            // another number, another choice: of a pass; default 0
    vplProgressFcn* progress; // default NULL
    void* progressUser;
    uint32_t cookie; // set by vplDefaultPlacementDef
} vplPlacementDef;

vplPlacementDef vplDefaultPlacementDef(void);

// What each light of the set gives to the camera's points: the root of the mean square of what they reflect of it,
// in W/m^2 (documented: in the emitter's unit), of light that comes through the bound and past what is between.
// Only an estimate: a light that reaches other places only gets 0. *raysOut (may be NULL) is the rays that were cast.
vplResult vplMeasureLights(const vplGeometry* geometry, const vplLightSet* set, const vplPlacementDef* def,
                           float* contributionsOut, int64_t* raysOut);

// Chooses `count` of the candidates, give or take one: each with probability p = min(1, t q), where q mixes its
// share of all contributions and, by def->fluxShare, of all flux; t makes the sum of p `count`. Weights are divided
// by p, so that the mean over all choices is the light of all candidates. Neighbours share: of lights that are near
// to each other every 1/p-th is taken. What has no flux is never chosen, nor are lights that are the emitter itself.
// Source: Georgiev and Slusallek, Simple and Robust Iterative Importance Sampling of Virtual Point Lights,
// Eurographics 2010; Segovia, Iehl, Mitanchey and Peroche, Bidirectional Instant Radiosity, EGSR 2006.
vplResult vplChooseLights(const vplLightSet* candidates, const float* contributions, double count,
                          const vplPlacementDef* def, vplLightSet** setOut);

// Both: simulates F N particles and leaves about as many lights as N would. The set's N is that of all candidates.
vplResult vplPlaceLights(const vplGeometry* geometry, const vplEmitterDef* emitters, int emitterCount,
                         const vplParticleDef* particles, const vplPlacementDef* def, vplLightSet** setOut);

// ---- lights of SSVP

typedef struct vplRsmSampleDef {
    int count; // n: samples of all maps together, [0, VPL_MAX_LIGHTS]; each map gets a share by its flux; default 256
    uint64_t shift;  // 0 (default): the points as published; else they are shifted by chance, modulo 1
    uint32_t cookie; // set by vplDefaultRsmSampleDef
} vplRsmSampleDef;

vplRsmSampleDef vplDefaultRsmSampleDef(void);

// First-bounce lights: the texels that the points (k/n, vdc(k)) of the Hammersley sequence fall into, each standing for
// its n-th part of the map. The set's lights are in the order of the samples, of step 0, with `particle` k; what meets
// nothing, or no light, leaves none. Entries of `maps` may be NULL: emitters of no power.
// Source: Aranha, Macedo and Apolinario, Screen-Space Virtual Point Light Propagation, section II-A, equation 1.
vplResult vplSampleReflectiveMaps(const vplGeometry* geometry, const vplReflectiveMap* const* maps,
                                  int mapCount, const vplRsmSampleDef* def, vplLightSet** setOut);

// Most rays per light of vplMeasureUse.
enum { VPL_MAX_USE_RAYS = 4096 };

// Of each light, the share of `rayCount` cosine-distributed rays, [1, VPL_MAX_USE_RAYS], that meet something: what of
// its light stays in the scene. Unlike vplMeasureLights it asks no camera, and does not change when one moves.
vplResult vplMeasureUse(const vplGeometry* geometry, const vplLightSet* set, int rayCount, float* useOut);

// How many lights vplKeepUseful is expected to keep.
double vplCountUseful(const vplLightSet* set, const float* use);

// Keeps each light with the probability of its use, at least 1/16, and divides its weight by that: the mean over all
// shifts is the light of all. In closed rooms all are kept, as they are. `shift` as in vplRsmSampleDef.
vplResult vplKeepUseful(const vplLightSet* set, const float* use, uint64_t shift, vplLightSet** setOut);

// What makes a light far from a cluster: w1 |V - C| + w2 times one of these, n the two unit normals.
typedef enum vplClusterMetric {
    VPL_CLUSTER_ONE_MINUS = 0,     // 1 - n.n (the default)
    VPL_CLUSTER_PRINTED,           // max(n.n, 0), as the document prints it: unlike normals are near
    VPL_CLUSTER_ONE_MINUS_CLAMPED, // 1 - max(n.n, 0)
    VPL_CLUSTER_ANGLE              // the angle, radians (Dong et al. 2009)
} vplClusterMetric;

typedef struct vplClusterDef {
    int count;               // C, [1, VPL_MAX_LIGHTS]; default 8; no more than there are lights are made
    vplClusterMetric metric; // default VPL_CLUSTER_ONE_MINUS
    double w1;               // 1/metres, >= 0; default 0.6
    double w2;               // >= 0; default 0.4
    int maxIterations; // [0, 10000]; default 32: the mean minimises no metric of these, and the printed one cycles
    const int*
        seeds; // indices of `count` lights that clusters start from; NULL (default): lights that are far
               // from each other, or all lights, in their order, where there are no more than clusters
    const struct vplLightClusters*
        last; // where clusters start instead: those of the last frame that have lights;
              // others at lights that are far from them; NULL (default)
    const float*
        weights; // of the lights, finite, >= 0: a cluster's mean goes by them, and how far is far where clusters
                 // start; NULL (default): all count alike
    uint32_t cookie; // set by vplDefaultClusterDef
} vplClusterDef;

vplClusterDef vplDefaultClusterDef(void);

typedef struct vplLightCluster {
    vplVec3 position; // mean of its lights' positions, metres: maybe in mid-air
    vplVec3 normal;   // unit: of the sum of its lights' normals; where that is 0 the one of before
    vplRgb flux;      // sum of its lights' flux, W (as weighted: what the picture gets)
    int lightCount;
    int nearest; // index of its light nearest to the mean (by the metric), -1 where it has none
    bool
        flat; // none of its lights shines behind it: all lie within 1e-4 of the diagonal of the box around all
              // lights (and 4 roundings of float) of the plane through position with this normal, and no
              // normal differs by more than 1e-4; true where it has none
} vplLightCluster;

typedef enum vplClusterEnd {
    VPL_CLUSTERS_CONVERGED = 0, // the last assignment repeated the one before it
    VPL_CLUSTERS_CYCLE,         // it repeated an earlier one
    VPL_CLUSTERS_STOPPED        // at maxIterations
} vplClusterEnd;

// Read only.
typedef struct vplLightClusters {
    const vplLightCluster* clusters;
    int count;
    const int* of; // of each light: its cluster
    int lightCount;
    int iterations; // times that clusters moved until the assignment repeated
    int emptyCount; // clusters without lights: they keep their places
    vplClusterEnd end;
    vplContext* context;
    struct vplArena* arena; // owns the clusters
} vplLightClusters;

// K-means in double precision; equal distances go to the lowest index. Lights of object -1 must not be among them. 256
// lights take 0.15 ms in 8 clusters, 0.3 ms in 32; the time grows with lights times clusters times iterations.
// Source: Aranha, Macedo and Apolinario, section II-A, equation 2; Dong et al., Real-time Indirect Illumination with
// Clustered Visibility, VMV 2009. Departs: the normal term, which as printed keeps equal normals apart.
vplResult vplFindClusters(const vplLightSet* lights, const vplClusterDef* def,
                          vplLightClusters** clustersOut);

// NULL is allowed.
void vplLightClusters_Destroy(vplLightClusters* clusters);

typedef enum vplSecondWeight {
    VPL_SECOND_WEIGHT_COSINE = 0, // 4 (1 - p^2) / (1 + p^2)^3: what a diffuse light sends there (the default)
    VPL_SECOND_WEIGHT_PRINTED     // 1: the document gives none
} vplSecondWeight;

typedef struct vplSecondBounceDef {
    int count;              // of all clusters together, [0, VPL_MAX_LIGHTS]; default 256
    vplSecondWeight weight; // default VPL_SECOND_WEIGHT_COSINE
    uint64_t shift;         // as in vplRsmSampleDef; each cluster's points are shifted besides; default 0
    uint32_t cookie;        // set by vplDefaultSecondBounceDef
} vplSecondBounceDef;

vplSecondBounceDef vplDefaultSecondBounceDef(void);

// Second-bounce lights: texels of each cluster's front hemisphere at points of the unit disk, evenly spread (Shirley
// and Chiu's concentric map, as in Pharr et al.). Each carries its share of what the cluster sends out, times the
// surface's reflectance. clusters->clusters[i] is what maps->maps[i] sees; the maps must have triangles. Lights are of
// step 1; their `particle` counts samples. The set's N is that of the samples.
// Source: Aranha, Macedo and Apolinario, section II-B. Departs: the weight.
vplResult vplSampleParaboloidMaps(const vplGeometry* geometry, const vplLightClusters* clusters,
                                  const vplParaboloidMaps* maps, const vplSecondBounceDef* def,
                                  vplLightSet** setOut);

// ----

// A virtual light as the kernel wants it.
typedef struct vplShadeLight {
    float px, py, pz; // metres
    float nx, ny, nz; // unit
    float r, g, b;    // documented: L * weight / N; physical: intensity on the axis, W/sr
} vplShadeLight;

// Lights that stand for the emitting triangles in direct light: `count` points spread over them by power, each
// with its share of it. Returns how many were written: count, or 0 where no triangle emits.
// Source: Keller, Instant Radiosity, 1997, section 3.
int vplSampleAreaLights(const vplEmission* emission, int count, vplShadeLight* out);

#ifdef __cplusplus
}
#endif

#endif
