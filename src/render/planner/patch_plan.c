// SPDX-License-Identifier: MIT
#include "render/planner/patch_plan.h"

#include "radiosity/factors/form_factors.h"
#include "render/planner/planner.h"
#include "render/renderer.h"
#include "render/stages/results.h"
#include "scene/scene.h"

#include <math.h>

enum {
    FEWEST = 450,         // patches
    FEW_TRIANGLES = 40,   // of a scene that patches suit
    FEW_EMITTERS = 16,    // each takes a shadow ray per pixel and side
    PIXELS_PER_PATCH = 10 // in smaller pictures a pass of virtual lights is cheaper
};

// The error that FEWEST patches usually leave beside edges; it falls with the root of their number.
static const double USUAL_ERROR = 0.042;

static double patchesFor(double error)
{
    const double over = USUAL_ERROR / error;
    return fmax(FEWEST, FEWEST * over * over);
}

double vplMostPatches(const vplContext* context)
{
    const double most = (double)vplMostFormFactorBytes(context), limit = (double)context->memoryLimit;
    return sqrt((limit > 0 && limit < most ? limit : most) / (3 * sizeof(float)));
}

// True if light comes from a few small emitters.
static bool hasFewEmitters(const vplRunner* r, const vplPlan* p)
{
    const vplGeometry* g = r->run.results[VPL_STAGE_GEOMETRY];
    return p->emitterCount <= FEW_EMITTERS && g->emittingArea < VPL_MOST_LAMPS * g->area &&
           vplScene_GetEnvironment(r->run.scene)->type == VPL_ENVIRONMENT_NONE;
}

// Where doors or lids hide a part of the virtual lights from what the camera sees, light changes within patches: with 4,000 of them
// 25 % of error is left where a door stands ajar, 74 in a dark hall beside it, 14 around a lamp in a box (72, 50 and 75 % reach).
static const double MOST_REACH = 0.9;

// Patches are quicker in plain scenes only: room, room-area, closed-room, cornell-area and cornell-spot. With more triangles (loft)
// or with textures 2 % of error takes 1.3 and 10 times the time of virtual lights.
static bool isPlain(const vplRunner* r, const vplPlan* p)
{
    const vplGeometry* g = r->run.results[VPL_STAGE_GEOMETRY];
    return g->triangleCount <= FEW_TRIANGLES && r->run.scene->textureCount == 0 && p->look.lights > 0 &&
           p->look.reaching >= MOST_REACH;
}

// True if the options allow radiosity, and only a few small emitters light the scene.
static bool canUsePatches(const vplRunner* r, const vplPlan* p, const vplRenderOptions* o)
{
    return o->output.show == VPL_SHOW_PICTURE && o->lighting == VPL_LIGHTING_PHYSICAL &&
           (vplMethodsFor(o) & VPL_USE_RADIOSITY) != 0 && hasFewEmitters(r, p);
}

// The error that one pass of virtual lights leaves, about; passes grow with the square of a smaller one.
static const double ONE_PASS = 0.05;

bool vplChoosePatches(const vplRunner* r, vplPlan* p)
{
    vplRenderOptions* o = &p->options;
    const vplGeometry* g = r->run.results[VPL_STAGE_GEOMETRY];
    const double error = o->stop.maxError, passes = fmax(1, ONE_PASS * ONE_PASS / (error * error));
    const double pixels = (double)o->output.width * o->output.height * passes;
    const bool can = error > 0 && canUsePatches(r, p, o) && isPlain(r, p);
    const double patches = can ? patchesFor(error) : INFINITY;
    if (patches > vplMostPatches(r->run.context) || pixels < PIXELS_PER_PATCH * patches) {
        return false;
    }
    o->method = VPL_METHOD_RADIOSITY;
    o->radiosity.patches = (int)ceil(patches);
    vplDecide(p, "method", "light that patches exchange has no noise, and %d triangles need few",
              g->triangleCount);
    vplDecide(p, "patches", "enough for the error, as far as is known beforehand");
    if (o->output.antialias == 8) {
        o->output.antialias = 16;
        vplDecide(p, "antialias", "most of the error will be at edges");
    }
    return true;
}

// ---- patches instead of virtual lights that take long

enum {
    TRIANGLE_RAYS = 60, // a triangle is cut or grouped in the time of so many rays (furnished)
    PIXEL_RAYS = 2      // shadow rays from a pixel to an emitter
};

// Rays of form factors over the square of the number of patches (flat, loft, room: 0.9 to 1.2).
static const double PAIR_RAYS = 1.2;

bool vplMayTryPatches(const vplRunner* r, const vplPlan* p, const vplRenderOptions* asked, double rays)
{
    const vplGeometry* g = r->run.results[VPL_STAGE_GEOMETRY];
    const double count = VPL_FIRST_PATCHES, pixels = (double)asked->output.width * asked->output.height;
    const double needs = PAIR_RAYS * count * count + (double)TRIANGLE_RAYS * g->triangleCount +
                         PIXEL_RAYS * pixels * p->emitterCount;
    return needs <= rays && count <= vplMostPatches(r->run.context) && canUsePatches(r, p, asked);
}

void vplCountVainPatches(vplRenderer* r, double rays)
{
    r->lightRays = r->lightRays > 0 ? fmax(1, r->lightRays - rays) : 0;
}
