// SPDX-License-Identifier: MIT
// What radiosity makes before it draws, stage by stage.
#ifndef VPL_RENDER_RADIOSITY_H
#define VPL_RENDER_RADIOSITY_H

#include "render/ingredients.h"

// What surfaces are divided into, and how these exchange light, depends on this besides the scene: where two are equal
// byte for byte, so is the rest.
typedef struct vplRadiosityKey {
    float patchSize;
    int patches, subdivisions, patchPlacement, formFactors, formSamples, rowSums, hierarchy, lightSamples;
    int camera;
    double linkError;
    uint64_t seed;
} vplRadiosityKey;

// How far the stages must go for a picture.
typedef enum vplRadiosityNeed {
    VPL_NEED_NOTHING = 0,
    VPL_NEED_PATCHES,
    VPL_NEED_FACTORS,
    VPL_NEED_LIGHT
} vplRadiosityNeed;

vplRadiosityNeed vplFindRadiosityNeed(const vplRenderOptions* options);

typedef struct vplRadiosityState {
    vplRadiosityKey key;
    bool draft; // of a round before the last: good enough to say where patches are wanted
    vplPatches* patches;
    vplPatchSides* sides;
    vplPatchMesh* mesh;
    vplFormFactors* factors; // NULL: not needed, or by links
    vplLinks* links;
    // One per side, W/m^2; NULL where no light is needed.
    vplRgb* direct;          // irradiance of emitters
    float* spread;           // its standard deviation over the side
    vplRgb* source;          // radiosity: emission and reflected direct light
    vplRgb* radiosity;       // all light
    vplRgb* irradiance;      // of light that was reflected at least once
    vplRgb* corners;         // the same at the mesh's vertices: [vertex][front, back]
    vplEmitterDef* emitters; // that `direct` is of; NULL: of none yet
    vplSolveStats solve;
    vplContext* context;
} vplRadiosityState;

// Patches, their sides and what these exchange, as far as options need, unless those of the last frame do.
vplResult vplRadiosity_Begin(vplJob* job, vplRadiosityState** stateOut);

static inline vplTransport vplRadiosity_Transport(const vplRadiosityState* s)
{
    return (vplTransport){s->sides, s->factors, s->links};
}

// What sides radiate of light that they did not make themselves.
void vplRadiosity_FindReflected(const vplRadiosityState* s, vplRgb* reflectedOut);

// Irradiance of sides by what sides send, and by emitters.
vplResult vplRadiosity_Receive(const vplRadiosityState* s, const vplRgb* sent, vplRgb* irradianceOut);

// Light of this frame.
vplResult vplRadiosity_Light(vplJob* job, vplRadiosityState* state);

// Where more patches are wanted, one number per patch; light must be there.
vplResult vplRadiosity_FindPriority(vplJob* job, const vplRadiosityState* state, float* priorityOut);

// Adds to a picture what the options ask to be seen of patches.
vplResult vplRadiosity_Draw(vplJob* job, const vplRadiosityState* state, const vplView* view,
                            vplImage* image);

// NULL is allowed.
void vplRadiosity_Destroy(vplRadiosityState* state);

// Gives the state to the next frame, or destroys it.
void vplRadiosity_End(vplJob* job, vplRadiosityState* state);

#endif
