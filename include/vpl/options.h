// SPDX-License-Identifier: MIT
// What a picture is asked to be: methods, stages to show, and every option, which all come from
// vpl/options.def.
#ifndef VPL_OPTIONS_H
#define VPL_OPTIONS_H

#include <vpl/radiosity.h>
#include <vpl/shading.h>

#include <limits.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum vplMethod {
    VPL_METHOD_INSTANT_RADIOSITY = 0, // Franchi and Ferrante, Virtual Point Lights
    VPL_METHOD_DIRECT,                // the scene's own lights only
    VPL_METHOD_PATH,                  // path tracing: the truth that the others are judged against
    VPL_METHOD_KELLER,                // Keller, Instant Radiosity
    VPL_METHOD_SSVP,     // Aranha, Macedo and Apolinario, Screen-Space Virtual Point Light Propagation
    VPL_METHOD_RADIOSITY // Hemgren, Radiosity in Realtime Rendering
} vplMethod;

// What the picture shows.
typedef enum vplShow {
    VPL_SHOW_PICTURE = 0,
    VPL_SHOW_DEPTH,         // distance along the view axis, metres
    VPL_SHOW_NORMALS,       // components in [-1, 1]
    VPL_SHOW_SHADOW_MAP,    // the first emitter's cube unfolded into a cross of 4 x 3 faces, metres
    VPL_SHOW_SHADOW_FACTOR, // s of the first emitter, 1 in full shadow
    VPL_SHOW_DIRECT,        // light of the scene's emitters only
    VPL_SHOW_INDIRECT,      // light of all virtual lights only
    VPL_SHOW_LIGHT,         // light of virtual light `showLight` only
    VPL_SHOW_OVERLAY,       // the picture with the virtual lights drawn on it, coloured by step
    VPL_SHOW_BOUNCE,        // path: light after `showBounce` reflections before the eye's last; 0 is direct
    // of SSVP:
    VPL_SHOW_RSM,         // reflective shadow maps: position, normal, albedo and flux side by side
    VPL_SHOW_RSM_SAMPLES, // the picture with the first-bounce lights drawn on it
    VPL_SHOW_CLUSTERS,    // the same with clusters, and each first-bounce light in its cluster's colour
    VPL_SHOW_PARABOLOID, // the map of cluster `showLight`: position, normal, albedo and distance side by side
    VPL_SHOW_SECOND_BOUNCE, // the picture with the second-bounce lights drawn on it
    VPL_SHOW_GATHER,        // indirect irradiance before pixels share it, W/m^2: of every pixel's own lights
    VPL_SHOW_DENOISED,      // after that
    // of radiosity, without interpolation:
    VPL_SHOW_PATCHES,         // patches with their outlines, in the colours of their surfaces
    VPL_SHOW_PATCH_RADIOSITY, // radiosity / pi of each patch: emission, direct and indirect light, W/(m^2 sr)
    VPL_SHOW_FORM_FACTOR_SUMS, // sum of each patch's form factors, before they were clamped or normalised: 1 in closed
                               // rooms
    VPL_SHOW_RESIDUAL          // what each patch's radiosity still lacks, / pi, W/(m^2 sr): absolute values
} vplShow;

// Most paths per pixel, and most bounces of a path.
enum { VPL_MAX_SAMPLES = 1 << 24, VPL_MAX_BOUNCES = 1 << 16 };

// Whether light from a virtual light is stopped by what is between.
typedef enum vplLightShadows {
    // As the method's document draws: instant radiosity none, Keller's auto, SSVP by the paraboloid map of a
    // light's cluster.
    VPL_LIGHT_SHADOWS_USUAL = 0,
    VPL_LIGHT_SHADOWS_NONE,   // it is not: as Franchi and Ferrante draw
    VPL_LIGHT_SHADOWS_MAP,    // a map of the half space above each virtual light, one sample: as Keller draws
    VPL_LIGHT_SHADOWS_RAY,    // a ray per pixel and light: exact
    VPL_LIGHT_SHADOWS_AUTO,   // map or ray, whichever will be cheaper by the measurements of bench/crossover
    VPL_LIGHT_SHADOWS_CLUSTER // SSVP: by the paraboloid map of the light's cluster
} vplLightShadows;

// Where virtual lights go.
typedef enum vplLightPlacement {
    VPL_PLACEMENT_PARTICLES = 0, // where particles land
    VPL_PLACEMENT_RSM,           // first hits are texels of reflective shadow maps
    VPL_PLACEMENT_VIEW           // particles, of which those are kept that light what the camera sees
} vplLightPlacement;

// What becomes of the light that minDistance takes away.
typedef enum vplCompensation {
    VPL_COMPENSATION_USUAL = 0, // rays for Keller's method with physical lighting and shadows, else none
    VPL_COMPENSATION_NONE,      // it is lost
    VPL_COMPENSATION_RAYS       // short rays from each pixel find it
} vplCompensation;

// Where in a pixel the path tracer looks.
typedef enum vplPixel {
    VPL_PIXEL_AREA = 0, // everywhere: the pixel is the mean over its square, edges are smooth
    VPL_PIXEL_CENTRE    // its centre, as all other methods do: for comparing with them
} vplPixel;

// Where a cluster looks from.
typedef enum vplClusterPlace {
    VPL_CLUSTER_PLACE_MEMBER = 0, // from its light that is nearest to the mean: on a surface
    VPL_CLUSTER_PLACE_MEAN // from the mean, as the document has it: maybe in mid-air or inside of something
} vplClusterPlace;

// What form factors are found between.
typedef enum vplHierarchy {
    VPL_HIERARCHY_AUTO = 0, // all pairs up to VPL_ALL_PAIRS sides, else links
    VPL_HIERARCHY_OFF,      // all pairs of sides
    VPL_HIERARCHY_ON        // links between groups of them
} vplHierarchy;

// More sides of patches than this are linked in groups: as many as VPL_MAX_FORM_FACTOR_BYTES allow. Links are
// five times as fast there and err ten to twenty times as much (bench/form_factors, bench/radiosity_error):
// more patches should not make a picture worse where nobody asked for it.
enum { VPL_ALL_PAIRS = 16384 };

// Where patches are small.
typedef enum vplPatchPlacement {
    VPL_PATCHES_UNIFORM = 0, // everywhere alike, as in the document
    VPL_PATCHES_ADAPTIVE     // where light changes much: found from solutions with fewer patches
} vplPatchPlacement;

// How light varies over a patch.
typedef enum vplInterpolation {
    VPL_INTERPOLATION_GOURAUD = 0, // linearly between the patches' corners
    VPL_INTERPOLATION_NONE         // not at all
} vplInterpolation;

// Whether frames of a sequence have anything to do with each other.
typedef enum vplCoherence {
    // New sample patterns for each frame, and clusters that start from the frame's own lights The same
    // patterns in all frames, and clusters that start from those of the frame before. Radiosities go on from
    // those of the frame before, `iterations` sweeps a frame: light that moved arrives with the lag of its
    // bounces.
    VPL_COHERENCE_OFF = 0,
    VPL_COHERENCE_ON
} vplCoherence;

// What frames of a sequence hand on to each other; see vpl/render.h.
typedef struct vplHistory vplHistory;

// Most passes of a render.
enum { VPL_MAX_PASSES = 1 << 20 };

// Values of vplShadowOptions.bias that are no length.
#define VPL_BIAS_OPTION_AUTO  (-1.0f) // VPL_BIAS_EXACT, with documented lighting or a biasSlope VPL_BIAS_PAIR
#define VPL_BIAS_OPTION_EXACT (-2.0f) // VPL_BIAS_EXACT

// ---- the fields: meaning, unit, range and default of each stand in vpl/options.def

#define VPL_OPTION_FIELD(kind, type, field, ...) type field;

// clang-format off
typedef struct vplOutputOptions {
#define VPL_OUTPUT_OPTION VPL_OPTION_FIELD
#include <vpl/options.def>
} vplOutputOptions;

typedef struct vplParticleOptions {
#define VPL_PARTICLES_OPTION VPL_OPTION_FIELD
#include <vpl/options.def>
} vplParticleOptions;

typedef struct vplLightOptions {
#define VPL_LIGHTS_OPTION VPL_OPTION_FIELD
#include <vpl/options.def>
} vplLightOptions;

typedef struct vplPipelineOptions {
#define VPL_PIPELINE_OPTION VPL_OPTION_FIELD
#include <vpl/options.def>
} vplPipelineOptions;

typedef struct vplShadowOptions {
#define VPL_SHADOW_OPTION VPL_OPTION_FIELD
#include <vpl/options.def>
} vplShadowOptions;

typedef struct vplPathOptions {
#define VPL_PATH_OPTION VPL_OPTION_FIELD
#include <vpl/options.def>
} vplPathOptions;

typedef struct vplSsvpOptions {
#define VPL_SSVP_OPTION VPL_OPTION_FIELD
#include <vpl/options.def>
} vplSsvpOptions;

typedef struct vplRadiosityOptions {
#define VPL_RADIOSITY_OPTION VPL_OPTION_FIELD
#include <vpl/options.def>
} vplRadiosityOptions;

typedef struct vplSequenceOptions {
#define VPL_SEQUENCE_OPTION VPL_OPTION_FIELD
#include <vpl/options.def>
    vplHistory* history; // what the frame before hands on; NULL (default): nothing
} vplSequenceOptions;

typedef struct vplStopOptions {
#define VPL_STOP_OPTION VPL_OPTION_FIELD
#include <vpl/options.def>
} vplStopOptions;

typedef struct vplRenderOptions {
#define VPL_GENERAL_OPTION VPL_OPTION_FIELD
#include <vpl/options.def>
    vplOutputOptions output;
    vplParticleOptions particles;
    vplLightOptions lights;
    vplPipelineOptions pipeline;
    vplShadowOptions shadow;
    vplPathOptions path;
    vplSsvpOptions ssvp;
    vplRadiosityOptions radiosity;
    vplSequenceOptions sequence;
    vplStopOptions stop;
    vplProgressFcn* progress; // NULL (default): nobody listens
    void* progressUser;       // passed to progress
    char problem[256];        // why the last vplRenderOptions_Set failed; empty if it did not
    uint32_t cookie;          // set by vplDefaultRenderOptions
} vplRenderOptions;
// clang-format on

// Every option at its default.
vplRenderOptions vplDefaultRenderOptions(void);

// Sets an option by its name on the command line, without dashes: vplRenderOptions_Set(&o, "particles",
// "200"). VPL_INVALID_ARGUMENT if there is no such option or the value is not one of its values: then nothing
// is changed but options->problem, one sentence.
vplResult vplRenderOptions_Set(vplRenderOptions* options, const char* name, const char* value);

// The inverse: writes the value of an option as vplRenderOptions_Set reads it. VPL_INVALID_ARGUMENT if there
// is no such option or `size` bytes are too few.
vplResult vplRenderOptions_Get(const vplRenderOptions* options, const char* name, char* textOut, size_t size);

// Whether the method and pipeline of `options` make any use of an option. If not, and reasonOut is not NULL,
// it gets what stands against it, such as "--method keller".
bool vplRenderOptions_IsUsed(const vplRenderOptions* options, const char* name, char* reasonOut, size_t size);

// ---- the table

// Methods that make use of an option, and pipelines: without a pipeline's bit it is used by all of them.
enum {
    VPL_USE_INSTANT_RADIOSITY = 1 << VPL_METHOD_INSTANT_RADIOSITY,
    VPL_USE_DIRECT = 1 << VPL_METHOD_DIRECT,
    VPL_USE_PATH = 1 << VPL_METHOD_PATH,
    VPL_USE_KELLER = 1 << VPL_METHOD_KELLER,
    VPL_USE_SSVP = 1 << VPL_METHOD_SSVP,
    VPL_USE_RADIOSITY = 1 << VPL_METHOD_RADIOSITY,
    VPL_USE_ALL = (1 << (VPL_METHOD_RADIOSITY + 1)) - 1,
    VPL_USE_PARTICLES = VPL_USE_INSTANT_RADIOSITY | VPL_USE_KELLER,
    VPL_USE_VIRTUAL_LIGHTS = VPL_USE_PARTICLES | VPL_USE_SSVP,
    VPL_USE_SHADOW_MAPS = VPL_USE_PARTICLES | VPL_USE_DIRECT | VPL_USE_RADIOSITY,
    VPL_USE_BATCHED = 256 << VPL_ACCUMULATE_BATCHED,
    VPL_USE_INTERLEAVED = 256 << VPL_ACCUMULATE_INTERLEAVED,
    VPL_USE_LIGHTCUTS = 256 << VPL_ACCUMULATE_LIGHTCUTS
};

typedef enum vplOptionKind {
    VPL_OPTION_INT,
    VPL_OPTION_FLOAT,
    VPL_OPTION_DOUBLE,
    VPL_OPTION_FLOAT_AUTO,
    VPL_OPTION_BELOW_AUTO,
    VPL_OPTION_CHOICE,
    VPL_OPTION_SEED,
    VPL_OPTION_SIZE,
    VPL_OPTION_SHOW,
    VPL_OPTION_BIAS,
    VPL_OPTION_PART
} vplOptionKind;

// One row of vpl/options.def.
typedef struct vplOption {
    const char* name;
    const char* value; // what it takes: "N", or its choices: "a|b|c"
    const char* group; // a heading, such as "Particles"
    const char* help;
    const char* field; // as in "vplRenderOptions.particles.count"
    vplOptionKind kind;
    int users;
    double low, high;
    size_t offset; // of the field in vplRenderOptions
} vplOption;

// All options, in the order of the groups.
const vplOption* vplGetOptions(int* countOut);

// NULL if there is none of that name.
const vplOption* vplFindOption(const char* name);

#ifdef __cplusplus
}
#endif

#endif
