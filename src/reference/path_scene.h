// SPDX-License-Identifier: MIT
// The inputs shared by all paths of a picture, the random numbers of a path, and its vertices.
#ifndef VPL_REFERENCE_PATH_SCENE_H
#define VPL_REFERENCE_PATH_SCENE_H

#include <vpl/geometry.h>

#include "geometry/emitter_trees.h"
#include "geometry/paint.h"
#include "math/sobol.h"
#include "reference/path_guide.h"

// Techniques for sampling the last steps of a path to a light. Where several can find the same path, multiple
// importance sampling weights their results.
enum {
    VPL_PATH_LIGHT_SAMPLING = 1, // choose a point on a light (next-event estimation)
    VPL_PATH_BSDF_SAMPLING = 2,  // reflect the path and see whether it hits a light
    VPL_PATH_PARTICLES = 4,      // connect to where a path from a light has landed
    VPL_PATH_ALL = 7
};

// Variance times time of a hall with 30, 100, 1,000 points is 1.23, 0.82, 0.24 of that with all emitters asked, with 10, 100,
// 1,000 quads 0.33, 0.19, 0.08 of that with triangles chosen by power (bench/path). Scenes with a box or two that emit keep
// their bits.
enum { VPL_PATH_EMITTERS_OF_TREE = 64, VPL_PATH_TRIANGLES_OF_TREE = 32 };

// The most vertices of a path from a light. More would gain little: squared error times time over that with one vertex is 0.08 with 8 and
// 0.05 with 16 vertices in shade, 0.19 and 0.18 in corridor, 0.81 and 0.82 in hall.
enum { VPL_MOST_LIGHT_VERTICES = 16 };

typedef struct vplPathDef {
    const vplCameraDef* camera;
    const vplEmitterDef* emitters; // NULL if there are none
    int emitterCount;
    int width, height;    // pixels
    int firstRow, endRow; // only pixels of these rows are traced; endRow 0 (default): all
    bool emission;        // show surfaces that emit; default true
    bool pixelCentres;    // start paths at the centres of pixels, where the rasterizer samples; default false
    // The picture sums light of this range of bounces, counted before the one towards the camera; default 0,
    // 1 << 16.
    int firstBounce, lastBounce;
    int mostBounces; // after which paths end, also where lastBounce is lower; default 1 << 16
    uint64_t seed;
    // VPL_PATH_..., default VPL_PATH_ALL. Lights that a path cannot hit are sampled in any case.
    int techniques;
    // The most vertices of a path from a light, to which paths from the camera connect: [0, VPL_MOST_LIGHT_VERTICES]; default 1.
    int lightVertices;
    bool balanceHeuristic; // weight by the balance heuristic instead of the power heuristic; default false
    bool random;           // independent random numbers instead of Sobol's points; default false
    double rouletteFrom;   // paths with a throughput below this may end; default 0.25
    // Vertices choose from trees of at least so many emitters, and of so many triangles that emit; default
    // VPL_PATH_EMITTERS_OF_TREE and VPL_PATH_TRIANGLES_OF_TREE.
    int emittersOfTree, trianglesOfTree;
    const vplEmitterTrees* trees; // of these emitters, with trees as above; NULL (default): they are made
    const vplPathGuide* guide;    // NULL (default): paths go where they are reflected
} vplPathDef;

vplPathDef vplDefaultPathDef(void);

typedef struct vplPathScene {
    const vplGeometry* geometry;
    const vplEmission* emission;
    const vplEmitterTrees*
        trees; // without one of emitters a vertex asks each, without one of triangles it chooses by power
    vplEmitterTrees* ownTrees; // NULL: the def's
    vplPathDef def;            // without the camera and the emitters, which need not outlive it
    vplCameraDef camera;
    vplSobol sobol;
    int lightVertices;           // the most of a light path; 0: there are no light paths
    float pixelWidth;            // at a depth of one metre, metres
    vplVec3 right, up, forward;  // of the camera
    double scaleX, scaleY;       // tangents of its half-angles
    double power, trianglePower; // W, of all sources and of the triangles among them
    // The environment's share of all power, over the area of the disc that its particles cover, per square metre.
    double skyShare;
} vplPathScene;

// Copies the camera and the emitters; the geometry and the def's trees must outlive the scene. On failure there is nothing to free.
vplResult vplPathScene_Init(vplPathScene* scene, const vplGeometry* geometry, const vplPathDef* def);

void vplPathScene_Free(vplPathScene* scene);

// Radiance, or a part of it.
typedef struct vplRadiance {
    double r, g, b;
} vplRadiance;

static inline vplRadiance vplRadiance_Of(vplRgb c)
{
    return (vplRadiance){c.r, c.g, c.b};
}

static inline vplRadiance vplRadiance_Scale(double s, vplRadiance a)
{
    return (vplRadiance){s * a.r, s * a.g, s * a.b};
}

// s rho a, in this order.
static inline vplRadiance vplRadiance_Reflect(double s, vplRgb rho, vplRadiance a)
{
    return (vplRadiance){s * rho.r * a.r, s * rho.g * a.g, s * rho.b * a.b};
}

static inline void vplRadiance_Add(vplRadiance* sum, vplRadiance a)
{
    sum->r += a.r;
    sum->g += a.g;
    sum->b += a.b;
}

// One path while it is followed.
typedef struct vplPathState {
    const vplPathScene* scene;
    uint64_t stream; // of its numbers: one for each half of a pixel's samples
    uint32_t index;  // of the path in the stream
    int64_t rays;    // cast so far
    // The part of the path's radiance that was found at vertices of light paths after the first, mean over red, green and blue.
    double further;
    // [n]: the weights of all techniques that connect the ends of one of the last n edges, instead of going along it, over the weight of
    // light sampling at the last vertex; 0 for n = 0.
    double edges[VPL_MOST_LIGHT_VERTICES + 1];
} vplPathState;

// Draws the four numbers in [0, 1) of set `set` of the path.
void vplPath_Draw(const vplPathState* path, uint32_t set, float out[4]);

// Follows a path through pixel (x, y) and adds its radiance to *sum.
void vplPath_Follow(vplPathState* path, int x, int y, vplRadiance* sum);

// The ray through a position in pixel (x, y), from the near plane. t counts the depth beyond that plane, so
// the camera sees hits with t <= far - near.
vplRay vplPathScene_CameraRay(const vplPathScene* scene, int x, int y, const float offset[2]);

// The weight of a technique before all are normalized, from the ratio of its density to that of another.
static inline double vplHeuristic(const vplPathScene* s, double ratio)
{
    return s->def.balanceHeuristic ? ratio : ratio * ratio;
}

// The probability with which Russian roulette lets a path of this throughput go on.
static inline float vplPathScene_Survival(const vplPathScene* s, vplRgb throughput)
{
    const float most = fmaxf(throughput.r, fmaxf(throughput.g, throughput.b));
    return fminf(1, most / (float)s->def.rouletteFrom);
}

// The density, per square metre, with which a diffuse reflection reaches a point at `distance` metres, from the cosines at both ends.
static inline double vplDensityOfReflection(double cosineFrom, double cosineTo, double distance)
{
    return cosineFrom * cosineTo / (VPL_PI * distance * distance);
}

// A point where a path is reflected.
typedef struct vplPathVertex {
    vplHit hit;
    vplVec3 normal;  // of the surface, on the side that the path came from
    vplVec3 shading; // normal to shade with, on the same side
    vplRgb rho;
    double edges;  // as of vplPathState, for the longest light paths
    int place;     // of the guide; negative: of none
    double guided; // the probability with which the path goes on to where the guide says
} vplPathVertex;

// `width`: diameter, metres, of the cone around the ray in `direction`, of any length.
vplPathVertex vplPathVertex_Make(const vplPathScene* scene, const vplHit* hit, vplVec3 direction,
                                 float width);

// Finds the vertex's place. The scene must have a guide.
void vplPathVertex_Locate(const vplPathScene* scene, vplPathVertex* vertex, vplVec3 direction);

// The density, per square metre, with which a path goes from the vertex to a point of `sender`, which may be negative. `reflection`: that of
// the diffuse reflection alone.
static inline double vplPathVertex_Density(const vplPathScene* s, const vplPathVertex* v, int sender,
                                           double reflection)
{
    if (v->guided == 0) {
        return reflection;
    }
    const vplPathGuide* g = s->def.guide;
    return (1 - v->guided) * reflection +
           (sender < 0 ? 0 : v->guided * g->density(g->data, v->place, sender));
}

// The radiance that the surface emits against `direction`.
vplRgb vplPathScene_EmissionAt(const vplPathScene* scene, const vplHit* hit, vplVec3 direction);

#endif
