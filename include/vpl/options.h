// SPDX-License-Identifier: MIT
// Render options: methods, stages to show, and every other option, all of which come from vpl/options.def.
#ifndef VPL_OPTIONS_H
#define VPL_OPTIONS_H

#include <vpl/choices.h>
#include <vpl/scene.h>

#include <limits.h>

VPL_HEADER_BEGIN

typedef enum vplMethod {
    VPL_METHOD_INSTANT_RADIOSITY = 0, // Franchi and Ferrante, Virtual Point Lights
    VPL_METHOD_DIRECT,                // the scene's own lights only
    VPL_METHOD_PATH,                  // path tracing: the truth that the others are judged against
    VPL_METHOD_KELLER,                // Keller, Instant Radiosity
    VPL_METHOD_SSVP,      // Aranha, Macedo and Apolinario, Screen-Space Virtual Point Light Propagation
    VPL_METHOD_RADIOSITY, // Hemgren, Radiosity in Realtime Rendering
    VPL_METHOD_AUTO       // the planner chooses one of them and its options
} vplMethod;

// How exact a picture shall be, and how long it may take.
typedef enum vplQuality {
    VPL_QUALITY_NONE = 0, // as --budget and --max-error say; without them, what 5 % error should need
    VPL_QUALITY_DRAFT,    // --max-error 0.2 --budget 1000
    VPL_QUALITY_GOOD,     // --max-error 0.05 --budget 10000
    VPL_QUALITY_BEST      // --max-error 0.02 --budget 120000
} vplQuality;

// The content of the picture.
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
    // SSVP only:
    VPL_SHOW_RSM,         // reflective shadow maps: position, normal, albedo and flux side by side
    VPL_SHOW_RSM_SAMPLES, // the picture with the first-bounce lights drawn on it
    VPL_SHOW_CLUSTERS,    // the same with clusters, and each first-bounce light in its cluster's colour
    VPL_SHOW_PARABOLOID, // the map of cluster `showLight`: position, normal, albedo and distance side by side
    VPL_SHOW_SECOND_BOUNCE, // the picture with the second-bounce lights drawn on it
    VPL_SHOW_GATHER,        // indirect irradiance of every pixel by its own lights only, W/m^2
    VPL_SHOW_DENOISED,      // the same after neighbours have shared theirs
    // radiosity only, without interpolation:
    VPL_SHOW_PATCHES,         // patches with their outlines, in the colours of their surfaces
    VPL_SHOW_PATCH_RADIOSITY, // radiosity / pi of each patch: emission, direct and indirect light, W/(m^2 sr)
    VPL_SHOW_FORM_FACTOR_SUMS, // row sums of form factors as computed: 1 in closed rooms
    VPL_SHOW_RESIDUAL // error of each patch's radiosity after the last sweep, absolute, / pi, W/(m^2 sr)
} vplShow;

// Layers of a render besides its picture: bits of vplOutputOptions.aovs, in the order of the words of --aov.
typedef enum vplAov {
    VPL_AOV_DIRECT = 1, // "direct", RGB: emission and light that was not reflected before, as VPL_SHOW_DIRECT
    VPL_AOV_INDIRECT = 2, // "indirect", RGB: the rest of the picture
    // "albedo", RGB: diffuse reflectance plus emitted radiance, at most 1; 0 where nothing is.
    VPL_AOV_ALBEDO = 4,
    VPL_AOV_NORMAL = 8,  // "normal", XYZ: normals as shaded, in world space; 0 where nothing is
    VPL_AOV_DEPTH = 16,  // "Z": metres along the view axis; VPL_NO_DEPTH where nothing is
    VPL_AOV_OBJECT = 32, // "object.id": 1 + the scene's index of the object; 0 where nothing is
    VPL_AOV_ALL = 63
} vplAov;

// The depth of pixels that show nothing: behind everything, and finite.
#define VPL_NO_DEPTH 1e10f

// Upper limits of paths per pixel and of bounces per path.
enum {
    VPL_MAX_SAMPLES = 1 << 24,
    VPL_MAX_LIGHT_VERTICES = 16,
    VPL_MAX_BOUNCES = 1 << 16,
    VPL_MAX_EDGE_PIXELS = 1 << 28
};

// Shadows of virtual lights.
typedef enum vplLightShadows {
    // As the method's document draws: instant radiosity none, Keller's auto, SSVP by the paraboloid map of a
    // light's cluster.
    VPL_LIGHT_SHADOWS_USUAL = 0,
    VPL_LIGHT_SHADOWS_NONE,   // no shadows: as Franchi and Ferrante draw
    VPL_LIGHT_SHADOWS_MAP,    // a map of the half space above each virtual light, one sample: as Keller draws
    VPL_LIGHT_SHADOWS_RAY,    // a ray per pixel and light: exact
    VPL_LIGHT_SHADOWS_AUTO,   // map or ray, whichever will be cheaper by the measurements of bench/crossover
    VPL_LIGHT_SHADOWS_CLUSTER // SSVP: by the paraboloid map of the light's cluster
} vplLightShadows;

// Placement of virtual lights.
typedef enum vplLightPlacement {
    VPL_PLACEMENT_PARTICLES = 0, // where particles land
    VPL_PLACEMENT_RSM,           // first hits are texels of reflective shadow maps
    VPL_PLACEMENT_VIEW           // particles, of which those are kept that light what the camera sees
} vplLightPlacement;

// Treatment of the light that the clamp at minDistance takes away.
typedef enum vplCompensation {
    VPL_COMPENSATION_USUAL = 0, // rays for Keller's method with physical lighting and shadows, else none
    VPL_COMPENSATION_NONE,      // that light is lost
    VPL_COMPENSATION_RAYS       // short rays from each pixel add it again
} vplCompensation;

// Settings of a document as printed; see src/render/option_text.c.
typedef enum vplPreset {
    VPL_PRESET_NONE = 0,
    VPL_PRESET_FRANCHI_FERRANTE,
    VPL_PRESET_KELLER_1997,
    VPL_PRESET_HEMGREN,
    VPL_PRESET_SSVP_2020
} vplPreset;

// Positions in a pixel at which the path tracer starts its paths.
typedef enum vplPixel {
    VPL_PIXEL_AREA = 0, // all over the pixel, which is the mean over its square: edges are smooth
    VPL_PIXEL_CENTRE    // the centre, as in all other methods, for comparing with them
} vplPixel;

// Viewpoint of a cluster of lights.
typedef enum vplClusterPlace {
    VPL_CLUSTER_PLACE_MEMBER = 0, // its light nearest to the mean, which is on a surface
    VPL_CLUSTER_PLACE_MEAN // the mean of its lights, as in the document: maybe in mid-air or inside an object
} vplClusterPlace;

// Source of the second-bounce lights of SSVP, and of further bounces.
typedef enum vplNextBounce {
    VPL_NEXT_BOUNCE_RAYS = 0, // rays from lights of the bounce before; those are kept that light what is seen
    VPL_NEXT_BOUNCE_MAPS      // samples of the clusters' paraboloid maps, as in the document
} vplNextBounce;

// Form factors are computed for all pairs of patch sides, or for links between groups of them.
typedef enum vplHierarchy {
    VPL_HIERARCHY_AUTO = 0, // all pairs up to VPL_ALL_PAIRS sides, else links
    VPL_HIERARCHY_OFF,      // all pairs of sides
    VPL_HIERARCHY_ON        // links between groups of sides
} vplHierarchy;

// Patch sides beyond which VPL_HIERARCHY_AUTO uses links: the most that VPL_MAX_FORM_FACTOR_BYTES allows for
// all pairs. The limit is no lower because links are no faster up to about 8,000 sides, and err more:
// asking for more patches should not make a picture worse (src/radiosity/README.md).
enum { VPL_ALL_PAIRS = 16384 };

// Distribution of patch sizes.
typedef enum vplPatchPlacement {
    VPL_PATCHES_UNIFORM = 0, // one size everywhere, as in the document
    VPL_PATCHES_ADAPTIVE     // smaller where light changes much, by solutions with fewer patches
} vplPatchPlacement;

// Cuts of patches where surfaces meet.
typedef enum vplPatchCuts {
    VPL_PATCH_CUTS_AUTO =
        0,              // on, except with patchSize or VPL_FORM_FACTORS_INCENTRE: the document has no cuts
    VPL_PATCH_CUTS_OFF, // patches may span what cuts them
    VPL_PATCH_CUTS_ON
} vplPatchCuts;

// Groups of small triangles. AUTO: on where there are more triangles than patches are asked for, or where many triangles are small: more
// than 8,192, and more than one per eight patches, have less than 1/16 of the mean patch's area; off with patchSize or
// VPL_FORM_FACTORS_INCENTRE.
typedef enum vplPatchGroups {
    VPL_PATCH_GROUPS_AUTO = 0,
    VPL_PATCH_GROUPS_OFF, // each triangle is at least one patch
    VPL_PATCH_GROUPS_ON
} vplPatchGroups;

// Sides of patches that hardly any light reaches and that the camera does not see. AUTO: LEAVE, but KEEP with patchSize or
// VPL_FORM_FACTORS_INCENTRE, as in the document. vplBake and renders with vplRenderOptions.view keep them in any case, because other
// cameras may see them.
typedef enum vplFaintSides {
    VPL_FAINT_SIDES_AUTO = 0,
    VPL_FAINT_SIDES_LEAVE, // left out where they are many and nothing that the camera sees is dim (vplPatchSidesDef.leaveFaint)
    VPL_FAINT_SIDES_KEEP
} vplFaintSides;

// Interpolation of radiosity over a patch.
typedef enum vplInterpolation {
    VPL_INTERPOLATION_GOURAUD = 0, // linear between the patches' corners
    VPL_INTERPOLATION_NONE         // constant
} vplInterpolation;

// Coherence between the frames of a sequence.
typedef enum vplCoherence {
    // Each frame has its own sample patterns, and k-means starts from the frame's own lights.
    VPL_COHERENCE_OFF = 0,
    // All frames have the same sample patterns, and k-means starts from the clusters of the frame before. The
    // radiosity solver starts from the solution of the frame before and makes `iterations` sweeps per frame:
    // light that moved arrives with the lag of its bounces.
    VPL_COHERENCE_ON
} vplCoherence;

// Results that frames of a sequence share; see vpl/render.h.
typedef struct vplHistory vplHistory;

// Upper limit of passes per render.
enum { VPL_MAX_PASSES = 1 << 20 };

// Values of vplShadowOptions.bias that are no length.
#define VPL_BIAS_OPTION_AUTO  (-1.0f) // VPL_BIAS_EXACT; VPL_BIAS_PAIR with documented lighting or a biasSlope
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
    vplHistory* history; // results of the frame before; NULL (default): every frame starts anew
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
    // Replaces the scene's camera of output.camera and its path; NULL (default): that camera. It is read when a render
    // starts. Plan files do not hold it.
    const vplCameraDef* view;
    vplProgressFcn* progress; // called with the progress; NULL (default): never
    void* progressUser;       // passed to progress
    char problem[512];        // why the last vplRenderOptions_Set failed; empty if it did not
    uint32_t cookie;          // set by vplDefaultRenderOptions
} vplRenderOptions;
// clang-format on

// Every option at its default.
vplRenderOptions vplDefaultRenderOptions(void);

// Sets an option by its name on the command line, without dashes: vplRenderOptions_Set(&o, "particles",
// "200"). VPL_INVALID_ARGUMENT if there is no such option or the value is not one of its values: then nothing
// is changed but options->problem, one sentence.
vplResult vplRenderOptions_Set(vplRenderOptions* options, const char* name, const char* value);

// Sets options from words as on the command line: "--particles 200 --seed 7". What precedes a value that is
// refused stays set.
vplResult vplRenderOptions_SetAll(vplRenderOptions* options, const char* words);

VPL_HEADER_END

#endif
