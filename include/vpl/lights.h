// SPDX-License-Identifier: MIT
// Virtual lights as plain arrays, and the ways to make them: particles, reflective shadow maps, clusters.
#ifndef VPL_LIGHTS_H
#define VPL_LIGHTS_H

#include <vpl/choices.h>
#include <vpl/visibility.h>

VPL_HEADER_BEGIN

#define VPL_MAX_STEPS (1 << 20)

// The document that defines where paths start, and so which lights step 0 holds.
typedef enum vplParticleStart {
    VPL_START_FIRST_HIT = 0, // Franchi and Ferrante: all N particles are shot, their first hits are step 0
    VPL_START_EMITTER        // Keller: the N points on emitters where particles start are step 0
} vplParticleStart;

// ---- reflective shadow maps

typedef struct vplReflectiveMapDef {
    vplEmitterDef emitter; // as in a scene; default vplDefaultEmitterDef()
    int size;              // texels along a side, [1, VPL_MAX_SHADOW_MAP]; default 256
    uint32_t cookie;       // set by vplDefaultReflectiveMapDef
} vplReflectiveMapDef;

vplReflectiveMapDef vplDefaultReflectiveMapDef(void);

// Reflective shadow map: the surfaces that an emitter lights directly. A texel holds depth and triangle; the
// rest is found on demand. Order: [face][row from the top][column]. A point emitter has the six faces of a
// cube map; a spot's one face fits its outer angle; a directional emitter's one is a parallel view of all
// geometry. Read only.
typedef struct vplReflectiveMap {
    vplEmitterDef emitter;
    int size, faceCount;
    const float* depth; // of the texel's centre along forward from `origin`, in `unit`s; +infinity: nothing
    float unit;         // metres; directional: the length of the view
    const int32_t* triangle; // index in the geometry, -1 where nothing is
    // The frame of each face: unit vectors, left-handed as those of a cube map.
    vplVec3 right[6], up[6], forward[6];
    double extent[2]; // tangents of half the view, across and up; directional: half its size, metres
    vplVec3 origin;   // the emitter; directional: the centre of the view's near side
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
// Not checked, for speed: pointers must not be NULL.
int64_t vplReflectiveMap_Find(const vplReflectiveMap* map, const vplRay* ray);

// Finds the hit of the ray through a texel's centre, inside its triangle, and the ray's unit direction.
// Returns false where no surface is, and for texels that the map does not have.
// Not checked, for speed: pointers must not be NULL.
bool vplReflectiveMap_GetHit(const vplReflectiveMap* map, const vplGeometry* geometry, int64_t texel,
                             vplHit* hitOut, vplVec3* directionOut);

// The surface that a texel shows.
typedef struct vplReflectiveTexel {
    float distance; // metres from the emitter; directional: from the near side of its view
    // Metres: the hit of the ray through the texel's centre. If the ray passes the triangle by up to 1/256
    // texel, the point just inside its edge.
    vplVec3 position;
    vplVec3 normal; // unit, interpolated on smooth objects, on the lit side
    vplRgb albedo;  // diffuse reflectance, [0, 1]
    vplRgb flux;    // W: incident flux, sent by the emitter through the texel; times albedo is reflected
    int triangle;   // index in the geometry
} vplReflectiveTexel;

// Returns false as vplReflectiveMap_GetHit does. Solid angles are exact; a spot's falloff is taken at centres. In a
// closed room the flux of all texels is a point emitter's power to rounding, and a spot's power but for up to
// 1/size^2.
// Departs from Dachsbacher and Stamminger: flux is incident, so that it adds up for any colours.
// Not checked, for speed: pointers must not be NULL.
bool vplReflectiveMap_GetTexel(const vplReflectiveMap* map, const vplGeometry* geometry, int64_t texel,
                               vplReflectiveTexel* texelOut);

// The shadowed share, [0, 1], of the emitter's light at a surface point with a unit normal: the bilinear weight of those of the four
// nearest texels that show a surface nearer than both the point and its plane, by more than half a texel's
// side. So no plane shadows itself, and an object within that distance of a surface casts no shadow on it.
// If all rays within a texel's side agree, the factor agrees with them. 0 outside the map's view.
// Not checked, for speed: pointers must not be NULL.
float vplReflectiveMap_Factor(const vplReflectiveMap* map, vplVec3 position, vplVec3 normal);

// ---- particles

// The object of lights that are not on a surface but in the sky.
enum { VPL_SKY_OBJECT = 0x7fffffff };

typedef struct vplVirtualLight {
    vplVec3 position; // metres
    // Unit normal of the surface, on the side that the particle came from (documented: as declared). For a
    // light that is a point or directional emitter: the particle's direction.
    vplVec3 normal;
    // Documented: the light L the particle carries after attenuation, in the emitter's unit. Physical, and
    // Keller's: flux in W that the surface sends out if one particle carried all.
    vplRgb light;
    // N / floor(rho^k N), in a pass rho^-k; divided by its probability if the light was chosen. The picture
    // also divides by N.
    float weight;
    int step;     // k: 0 for the first hit
    int particle; // [0, N)
    // The object it lies on; VPL_SKY_OBJECT: it is light of the environment from one direction, far outside the scene;
    // -1: it is a point or directional emitter (Keller, step 0).
    int object;
} vplVirtualLight;

typedef struct vplParticleDef {
    vplLighting lighting;   // default VPL_LIGHTING_PHYSICAL; documented: rho/pi at every hit
    vplParticleStart start; // default VPL_START_FIRST_HIT
    int particleCount;      // N, [0, VPL_MAX_LIGHTS]; default 10
    // One of several passes of one long walk: step k gets floor(rho^k (firstParticle + N)) - floor(rho^k
    // firstParticle) particles of weight rho^-k, so that the mean of the passes lacks no step; default false.
    bool pass;
    int64_t firstParticle;        // index of the first in its sequence, [0, 2^40]; default 0
    double reflectivity;          // rho, [0, 1); the first floor(rho^k N) particles reach step k; default 0.5
    vplSampler sampler;           // default VPL_SAMPLER_AUTO
    vplBounce bounce;             // default VPL_BOUNCE_AUTO
    vplParticleGeometry geometry; // default VPL_PARTICLE_GEOMETRY_EXACT
    uint64_t seed;             // default 0; shifts the low-discrepancy samplers, 0 leaves them as published
    const vplVec3* directions; // N first directions, unit, instead of the sampler's; NULL (default)
    // One per emitter: first hits of its particles are looked up there; entry NULL: cast. Exact geometry
    // only. Default NULL.
    const vplReflectiveMap* const* maps;
    vplProgressFcn* progress; // default NULL
    void* progressUser;
    uint32_t cookie; // set by vplDefaultParticleDef
} vplParticleDef;

vplParticleDef vplDefaultParticleDef(void);

// N particles that follow `first` others of the same walk.
typedef struct vplParticlePass {
    int64_t first;
    int count;           // N, [0, VPL_MAX_LIGHTS]
    double reflectivity; // rho, [0, 1)
} vplParticlePass;

typedef struct vplStepTotals {
    int stepCount;
    int64_t lightCount; // in all steps
} vplStepTotals;

// floor(rho^k N) for k = 0, 1, ... until it is 0, for the decimal number that rho was written as: 0.7 * 10 is
// 7. After `first` particles step k gets the growth, floor(rho^k (first + N)) - floor(rho^k first), which may
// be 0 though a later step gets some. Fills at most `capacity` counts (NULL to count only). VPL_LIMIT beyond
// VPL_MAX_STEPS steps or VPL_MAX_LIGHTS lights.
// Source: Keller, Instant Radiosity, 1997, section 4; the rule against rounding is derived in
// particle_counts.c.
vplResult vplCountParticles(vplContext* context, const vplParticlePass* pass, int* counts, int capacity,
                            vplStepTotals* totalsOut);

// A set of virtual lights. Read only.
typedef struct vplLightSet {
    const vplVirtualLight* lights; // by step, then by particle
    int lightCount;
    const int* stepCounts;   // nominal particles per step: floor(rho^k N)
    const int* lightsInStep; // lights made in each step
    int stepCount;
    int escaped; // particles that left the scene before their last step
    int64_t rays;
    int64_t rayObjectTests; // objects tested; where a hierarchy is used, blocks of 8 triangles
    int particleCount;      // N
    vplContext* context;
    struct vplArena* arena; // owns the set
} vplLightSet;

// Shoots particles from the scene's emitters, and for physical lighting or Keller's start also from triangles
// that emit; all share N by power. Documented lighting of first hits knows point emitters only. Each hit
// leaves a virtual light; the first floor(rho^k N) particles go on. A particle that hits nothing ends without
// a light; the weights keep the nominal counts.
// Source: Franchi and Ferrante, Virtual Point Lights, "Particle Simulation"; Keller, Instant Radiosity, 1997,
// section 4, as Franchi and Ferrante summarise it under "Keller's Instant Radiosity".
vplResult vplSimulateParticles(const vplGeometry* geometry, const vplEmitterDef* emitters, int emitterCount,
                               const vplParticleDef* def, vplLightSet** setOut);

// NULL is allowed.
void vplLightSet_Destroy(vplLightSet* set);

// ---- lights for what a camera sees

// More lights than needed are made as candidates, and the contribution of each to some visible points is
// measured.
typedef struct vplPlacementDef {
    vplLighting lighting; // formulas by which the lights will light; default VPL_LIGHTING_PHYSICAL
    vplCameraDef camera;  // default vplDefaultCameraDef()
    int width, height;    // pixels; only their ratio counts; default 1280 x 720
    // S, points that the camera sees, [1, 2^20], rounded up to 16 per cell of a grid; default 256.
    int pointCount;
    // F: candidates come from F N particles, [1, 4096]; fewer if they would leave more than 2^22 candidates;
    // default 32.
    int oversampling;
    float minDistance;        // clamp distance while measuring, metres, >= 0; default 0
    bool shadows;             // the lights will cast shadows; default true
    float fluxShare;          // share of the probabilities by flux alone, (0, 1]; default 0.1
    uint64_t seed;            // default 0
    int64_t index;            // index of the pass: each pass chooses anew; default 0
    vplProgressFcn* progress; // default NULL
    void* progressUser;
    uint32_t cookie; // set by vplDefaultPlacementDef
} vplPlacementDef;

vplPlacementDef vplDefaultPlacementDef(void);

// The contribution of each light to the camera's points: the root of the mean square of its light that they
// reflect, in W/m^2 (documented: in the emitter's unit), with clamp and shadows. An estimate: a light that
// reaches other places only gets 0. *raysOut (may be NULL) is the number of rays cast.
vplResult vplMeasureLights(const vplGeometry* geometry, const vplLightSet* set, const vplPlacementDef* def,
                           float* contributionsOut, int64_t* raysOut);

// Chooses `count` of the candidates, give or take one: each with probability p = min(1, t q), where q mixes
// its share of all contributions and, by def->fluxShare, of all flux; t makes the sum of p `count`. Weights
// are divided by p, so that the mean over all choices is the light of all candidates. Among lights near each
// other every 1/p-th is taken. Lights without flux and lights that are the emitter itself are never chosen.
// Source: Georgiev and Slusallek, Simple and Robust Iterative Importance Sampling of Virtual Point Lights,
// Eurographics 2010; Segovia, Iehl, Mitanchey and Peroche, Bidirectional Instant Radiosity, EGSR 2006.
vplResult vplChooseLights(const vplLightSet* candidates, const float* contributions, double count,
                          const vplPlacementDef* def, vplLightSet** setOut);

// Simulates F N particles, measures their lights and chooses about as many as N particles would leave. The
// set's N is that of all candidates.
vplResult vplPlaceLights(const vplGeometry* geometry, const vplEmitterDef* emitters, int emitterCount,
                         const vplParticleDef* particles, const vplPlacementDef* def, vplLightSet** setOut);

// ---- lights of SSVP

typedef struct vplRsmSampleDef {
    int count;       // n: samples of all maps together, [0, VPL_MAX_LIGHTS], shared by flux; default 256
    uint64_t shift;  // 0 (default): the points as published; else seed of a random shift, modulo 1
    uint32_t cookie; // set by vplDefaultRsmSampleDef
} vplRsmSampleDef;

vplRsmSampleDef vplDefaultRsmSampleDef(void);

// First-bounce lights: the texels at the points (k/n, vdc(k)) of the Hammersley sequence, each standing for
// the n-th part of its map. Lights are in the order of samples, of step 0, with `particle` k; a sample
// without surface or light leaves none. Entries of `maps` may be NULL: emitters of no power.
// Source: Aranha, Macedo and Apolinario, Screen-Space Virtual Point Light Propagation, section II-A, equation
// 1.
vplResult vplSampleReflectiveMaps(const vplGeometry* geometry, const vplReflectiveMap* const* maps,
                                  int mapCount, const vplRsmSampleDef* def, vplLightSet** setOut);

// Most rays per light of vplMeasureUse.
enum { VPL_MAX_USE_RAYS = 4096 };

// The share of each light's flux that stays in the scene: of `rayCount` cosine-distributed rays, [1,
// VPL_MAX_USE_RAYS], the share that hit something. Unlike vplMeasureLights it does not depend on a camera.
vplResult vplMeasureUse(const vplGeometry* geometry, const vplLightSet* set, int rayCount, float* useOut);

// The expected number of lights that vplKeepUseful keeps.
double vplCountUseful(const vplLightSet* set, const float* use);

// Keeps each light with the probability of its use, at least 1/16, and divides its weight by that: the mean
// over all shifts is the light of all. In closed rooms all are kept unchanged. `shift` as in vplRsmSampleDef.
vplResult vplKeepUseful(const vplLightSet* set, const float* use, uint64_t shift, vplLightSet** setOut);

typedef struct vplClusterDef {
    int count;               // C, [1, VPL_MAX_LIGHTS]; default 8; no more than there are lights are made
    vplClusterMetric metric; // default VPL_CLUSTER_ONE_MINUS
    double w1;               // 1/metres, >= 0; default 0.6
    double w2;               // >= 0; default 0.4
    // [0, 10000]; default 32: no metric is minimised by means, so k-means may cycle.
    int maxIterations;
    // Indices of `count` lights that clusters start from. NULL (default): lights far from each other, or all
    // lights in their order if there are no more than clusters.
    const int* seeds;
    // Clusters of the last frame: those with lights are the start, the others start at lights far from them.
    // NULL (default): none.
    const struct vplLightClusters* last;
    // One weight per light, finite, >= 0, for the means of clusters and for the choice of the lights that
    // they start from. NULL (default): all 1.
    const float* weights;
    uint32_t cookie; // set by vplDefaultClusterDef
} vplClusterDef;

vplClusterDef vplDefaultClusterDef(void);

typedef struct vplLightCluster {
    vplVec3 position; // mean of its lights' positions, metres: maybe in mid-air
    vplVec3 normal;   // unit: of the sum of its lights' normals; unchanged where that is 0
    vplRgb flux;      // sum of its lights' flux, W (as weighted: what the picture gets)
    int lightCount;
    int nearest; // index of its light nearest to the mean (by the metric), -1 if it has none
    // None of its lights shines behind it: all lie within 1e-4 of the diagonal of the box around all lights
    // (and 4 roundings of float) of the plane through position with this normal, and no normal differs by
    // more than 1e-4. True where it has no lights.
    bool flat;
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
    const int* of; // the cluster of each light
    int lightCount;
    int iterations; // iterations in which clusters moved
    int emptyCount; // clusters without lights: they keep their positions
    vplClusterEnd end;
    vplContext* context;
    struct vplArena* arena; // owns the clusters
} vplLightClusters;

// Clusters lights by k-means in double precision; equal distances go to the lowest index. No light may be an
// emitter itself (object -1). 256 lights take 0.15 ms in 8 clusters, 0.3 ms in 32; the time grows with lights
// times clusters times iterations.
// Source: Aranha, Macedo and Apolinario, section II-A, equation 2; Dong et al., Real-time Indirect
// Illumination with Clustered Visibility, VMV 2009. Departs: the normal term, which as printed keeps equal
// normals apart.
vplResult vplFindClusters(const vplLightSet* lights, const vplClusterDef* def,
                          vplLightClusters** clustersOut);

// NULL is allowed.
void vplLightClusters_Destroy(vplLightClusters* clusters);

typedef struct vplClusterSplitDef {
    // Camera, minDistance and seed. pointCount points that the camera sees, and as many that each of them sees
    // by one and by two reflections, tell whether lights and clusters agree; default 64.
    vplPlacementDef view;
    int maxCount; // clusters after splitting, [1, VPL_MAX_LIGHTS]; default 64
    double wrong; // no cluster is split where at most this share of the light is wrong, [0, 1]; default 0.02
    uint32_t cookie; // set by vplDefaultClusterSplitDef
} vplClusterSplitDef;

vplClusterSplitDef vplDefaultClusterSplitDef(void);

// Agreement of lights with the viewpoints of their clusters: light that reaches the camera from the points, in
// units of radiance, summed over lights and points.
typedef struct vplClusterAgreement {
    double light; // that arrives
    double wrong; // that arrives although the cluster does not see the point, or that does not though it sees
    int64_t rays;
} vplClusterAgreement;

// Splits clusters whose viewpoint (`nearest`) does not see what their lights see. While the share of the light
// that is wrong is more than def->wrong, and there are less than def->maxCount clusters, the one with the most
// wrong light is split: one of its lights becomes a viewpoint, and takes those lights with it that agree
// better with it. New clusters are appended and look along their viewpoint's normal; others are copied.
// `agreement` is that after splitting.
vplResult vplSplitClusters(const vplGeometry* geometry, const vplLightSet* lights,
                           const vplLightClusters* clusters, const vplClusterSplitDef* def,
                           vplLightClusters** clustersOut, vplClusterAgreement* agreementOut);

typedef struct vplSecondBounceDef {
    int count;              // samples of all clusters together, [0, VPL_MAX_LIGHTS]; default 256
    vplSecondWeight weight; // default VPL_SECOND_WEIGHT_COSINE
    uint64_t shift;         // as in vplRsmSampleDef, besides a shift per cluster; default 0
    int step;               // of the lights: 1 for the second bounce (default), k for bounce k + 1, [1, 63]
    uint32_t cookie;        // set by vplDefaultSecondBounceDef
} vplSecondBounceDef;

vplSecondBounceDef vplDefaultSecondBounceDef(void);

// Second-bounce lights: texels of each cluster's front hemisphere at points of the unit disk, evenly spread
// (Shirley and Chiu's concentric map, as in Pharr et al.). Each carries its share of the cluster's flux,
// times the surface's reflectance. maps->maps[i] is the map of clusters->clusters[i]; the maps must have
// triangles. Lights are of def->step; their `particle` counts samples. The set's N is the number of samples.
// Clusters of second-bounce lights give lights of the third bounce, and so on.
// Source: Aranha, Macedo and Apolinario, section II-B. Departs: the weight; the document has two bounces.
vplResult vplSampleParaboloidMaps(const vplGeometry* geometry, const vplLightClusters* clusters,
                                  const vplParaboloidMaps* maps, const vplSecondBounceDef* def,
                                  vplLightSet** setOut);

typedef struct vplNextBounceDef {
    int count;       // rays, [0, VPL_MAX_LIGHTS]; default 256
    uint64_t shift;  // 0 (default): points of the Halton sequence; else seed of a random shift, modulo 1
    int step;        // of the lights, [1, 63]; default 1
    uint32_t cookie; // set by vplDefaultNextBounceDef
} vplNextBounceDef;

vplNextBounceDef vplDefaultNextBounceDef(void);

// Lights of the next bounce: the hits of cosine-distributed rays from the lights of a set, of which each sends
// as many as it has of the flux. All rays carry equal light, times the reflectance of what they hit. A ray that
// hits nothing leaves no light. Lights are of def->step; their `particle` counts rays, which are the set's N.
vplResult vplShootNextBounce(const vplGeometry* geometry, const vplLightSet* lights,
                             const vplNextBounceDef* def, vplLightSet** setOut);

// ---- lights as shading takes them

// A virtual light as vplShadeView and vplShadePoints take it.
typedef struct vplShadeLight {
    float px, py, pz; // metres
    float nx, ny, nz; // unit
    float r, g, b;    // documented: L * weight / N; physical: intensity on the axis, W/sr
} vplShadeLight;

// Samples of area lights, for direct light: `count` points, shared out by power among the objects that emit,
// whose own power they carry if every one gets a point; else each carries the same power. The points of a
// quad, a face of a box or a triangle are a lattice whose mean is its middle. Returns how many were written:
// count, or 0 where no triangle emits.
// Source: Keller, Instant Radiosity, 1997, section 3.
int vplSampleAreaLights(const vplEmission* emission, int count, vplShadeLight* out);

// Samples of the environment, for direct light: `count` directions by its distribution, as lights on a sphere of 4096
// radii of the scene, from where their light is parallel but for 1/4096. Returns how many were written: count, or 0 where
// the scene has no environment.
int vplSampleSky(const vplEmission* emission, int count, vplShadeLight* out);

VPL_HEADER_END

#endif
