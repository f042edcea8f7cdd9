// SPDX-License-Identifier: MIT
#include "render/planner/patch_plan.h"

#include "radiosity/factors/form_factors.h"
#include "render/options.h"
#include "render/planner/planner.h"
#include "render/renderer.h"
#include "render/stages/results.h"
#include "scene/scene.h"

#include <math.h>

enum {
    FEW_TRIANGLES = 40,   // of a scene that patches suit
    FEW_EMITTERS = 16,    // each takes a shadow ray per pixel and side
    MANY_EMITTERS = 128,  // their direct light may take so long that patches hardly count
    PIXELS_PER_PATCH = 10 // in smaller pictures a pass of virtual lights is cheaper
};

// The error that VPL_FEWEST_PATCHES usually leave beside edges; it falls with the root of their number.
static const double USUAL_ERROR = 0.042;

static double patchesFor(double error)
{
    const double over = USUAL_ERROR / error;
    return fmax(VPL_FEWEST_PATCHES, VPL_FEWEST_PATCHES * over * over);
}

double vplMostPatches(const vplContext* context)
{
    const double most = (double)vplMostFormFactorBytes(context), limit = (double)context->memoryLimit;
    return sqrt((limit > 0 && limit < most ? limit : most) / (3 * sizeof(float)));
}

// Form factors of n patches take PAIR_RAYS n^2 rays (flat, loft, room: 0.9 to 1.2).
static const double PAIR_RAYS = 1.2;

// To cut a triangle, or to put it into a group, takes as long as so many rays (furnished).
enum { TRIANGLE_RAYS = 60 };

// The time that `count` patches and their form factors take, in rays.
static double raysOfPatches(const vplGeometry* g, double count)
{
    return PAIR_RAYS * count * count + (double)TRIANGLE_RAYS * g->triangleCount;
}

// Patches are a small part of the time if they take at most SMALL_SHARE of the time of the shadow rays from pixels to emitters. This holds
// for errors below SMALL_ERROR only: for larger ones edges have fewer samples, or each pixel is lit by a few of the emitters.
static const double SMALL_SHARE = 0.1, SMALL_ERROR = 0.08;

static bool areSmallPart(const vplRunner* r, const vplPlan* p)
{
    const vplGeometry* g = r->run.results[VPL_STAGE_GEOMETRY];
    const vplRenderOptions* o = &p->options;
    const double pixels = vplCountPixels(&o->output);
    const double emitters = vplAskedEmitters(p);
    return o->stop.maxError > 0 && o->stop.maxError < SMALL_ERROR && emitters >= MANY_EMITTERS &&
           g->triangleCount <= VPL_FIRST_PATCHES &&
           raysOfPatches(g, VPL_FIRST_PATCHES) <= SMALL_SHARE * pixels * emitters;
}

// True if light comes from emitters that are small and few, or whose direct light takes most of the time.
static bool suitEmitters(const vplRunner* r, const vplPlan* p)
{
    const vplGeometry* g = r->run.results[VPL_STAGE_GEOMETRY];
    return (p->emitterCount <= FEW_EMITTERS || areSmallPart(r, p)) &&
           g->emittingArea < VPL_MOST_LAMPS * g->area &&
           vplScene_GetEnvironment(r->run.scene)->type == VPL_ENVIRONMENT_NONE;
}

// Where doors or lids hide a part of the virtual lights from what the camera sees, light changes within patches: with 4,000 of them
// 25 % of error is left where a door stands ajar, 74 in a dark hall beside it, 14 around a lamp in a box (72, 50 and 75 % reach).
static const double MOST_REACH = 0.9;

// Patches are quicker in plain scenes only: room, room-area, closed-room, cornell-area and cornell-spot. With more triangles (loft)
// or with textures 2 % of error takes 1.3 and 10 times the time of virtual lights. Scenes of up to
// VPL_FIRST_PATCHES triangles are plain, too, if patches are a small part of the time: with 1,000 lamps 2 % of error takes 12 and 36 s by
// virtual lights and 6 to 12 s by patches; 5 % takes 4.6 s by either.
static bool isPlain(const vplRunner* r, const vplPlan* p)
{
    const vplGeometry* g = r->run.results[VPL_STAGE_GEOMETRY];
    return (g->triangleCount <= FEW_TRIANGLES || areSmallPart(r, p)) && r->run.scene->textureCount == 0 &&
           p->look.lights > 0 && p->look.reaching >= MOST_REACH;
}

bool vplMayChoosePatches(const vplRenderOptions* o)
{
    const int methods = vplMethodsFor(o);
    return (methods & VPL_USE_RADIOSITY) != 0 && (methods & VPL_USE_KELLER) != 0;
}

// True if the options allow radiosity, and the emitters of the scene suit it.
static bool canUsePatches(const vplRunner* r, const vplPlan* p, const vplRenderOptions* o)
{
    return o->output.show == VPL_SHOW_PICTURE && o->lighting == VPL_LIGHTING_PHYSICAL &&
           vplMayChoosePatches(o) && suitEmitters(r, p);
}

// ---- a first try of patches in scenes that are not plain

enum { PIXEL_RAYS = 2 }; // shadow rays from a pixel to an emitter

// True if `count` patches, whose light pixels gather by `gather` rays, are foreseen to cost at most as much as `rays` rays.
static bool fitInto(const vplRunner* r, const vplPlan* p, const vplRenderOptions* o, double count, int gather,
                    double rays)
{
    const vplGeometry* g = r->run.results[VPL_STAGE_GEOMETRY];
    const double pixels = vplCountPixels(&o->output);
    const double needs =
        raysOfPatches(g, count) + PIXEL_RAYS * pixels * p->emitterCount + VPL_PATH_RAY * pixels * gather;
    return needs <= rays && count <= vplMostPatches(r->run.context);
}

bool vplMayTryPatches(const vplRunner* r, const vplPlan* p, const vplRenderOptions* asked, double rays)
{
    return fitInto(r, p, asked, VPL_FIRST_PATCHES, 0, rays) && canUsePatches(r, p, asked);
}

// ---- the first plan

// Patches come first if less than this share of the virtual lights reaches the picture. In the flat (19 %) the first pass of virtual
// lights leaves 70 to 180 % of error, 1,000 patches leave 9 % in the same time.
static const double FEW_REACH = 0.4;

// The share that reaches the picture is too uncertain if the look has fewer virtual lights.
enum { ENOUGH_LIGHTS = 64 };

// Rays of the final gather, where patches come first. Light behind doors is finer than patches: in the flat 1,000 patches leave 13 %
// of error without a gather, 9 with 4 rays and 5 with 16, in 0.6, 0.6 and 1.3 s (320x180). Patches that are tried after virtual
// lights have no gather: with 16 rays the hall took 41 s instead of 26, door-ajar 4.4 instead of 3.4 (20 %, medians of five). Nor have
// tiny pictures, where 64 pixels share the rays of a gather: at 96x54, 3,000 patches leave 9, 10 and 6 % in corridor, six-rooms and the flat
// without one, 23, 15 and 7 % with 64 rays.
static int firstGather(const vplRenderOptions* o)
{
    return vplIsTinyPicture(o) ? 0 : o->stop.maxError >= 0.15 ? 4 : 16;
}

// The first plan has twice as many patches if the scene has more triangles than VPL_FIRST_PATCHES and the error that is asked for is at
// least GROUPED_ERROR. Triangles are then grouped into patches, and 1,000 patches leave an error of 15 % in furnished, so that most renders
// at 20 % and all at 10 % needed a second plan. Medians with 1,000, 2,000 and 3,000 patches (320x180): 10.5, 4.9 and 5.8 s at 10 %; 2.1,
// 2.3 and 3.5 s at 20 %, the slowest 5.3, 3.4 and 3.9 s. Smaller errors need a second plan anyway.
static const double GROUPED_ERROR = 0.08;

static bool groupsTriangles(const vplGeometry* g)
{
    return g->triangleCount > VPL_FIRST_PATCHES;
}

static int usualFirstPatches(const vplGeometry* g, double error)
{
    return groupsTriangles(g) && error >= GROUPED_ERROR ? 2 * VPL_FIRST_PATCHES : VPL_FIRST_PATCHES;
}

// Virtual lights are foreseen to need HIDDEN_RAYS / (worth * error^2) rays per pixel, where `worth` is vplLook's. The flat, whose
// worth is 0.046, needed 26 / error^2 to 52 / error^2 rays per pixel for errors of 20, 10 and 5 %. So HIDDEN_RAYS is between 1.2 and 2.4;
// the higher value is taken.
static const double HIDDEN_RAYS = 2.4;

// True also if none of the lights reaches the picture: others may (corridor: one or two of 241, none with one of eight seeds). Not if the
// look saw no surface.
static bool isHidden(const vplPlan* p)
{
    return p->look.lights >= ENOUGH_LIGHTS && p->look.reaching < FEW_REACH && p->look.background < 1;
}

// Rays that virtual lights are foreseen to need if `reaching` of the look's lights, at least one, reach the picture.
static double raysForReaching(const vplPlan* p, double reaching)
{
    const vplRenderOptions* o = &p->options;
    const double error = o->stop.maxError, pixels = vplCountPixels(&o->output);
    const double worth = fmax(1, reaching) / fmax(1, p->look.lights);
    return error > 0 && isHidden(p) ? HIDDEN_RAYS / worth * pixels / (error * error) : 0;
}

double vplForeseenLightRays(const vplPlan* p)
{
    return raysForReaching(p, p->look.worth * p->look.lights);
}

// The error that one pass of virtual lights leaves, about; passes grow with the square of a smaller one.
static const double ONE_PASS = 0.05;

// The number of patches that come first in a scene whose light is hidden; 0: they cost too much. Tiny pictures, which have no gather, get three times
// as many if these are cheap enough, too: at 96x54 corridor takes 1.9 s instead of 4.0 at 20 %, 13 instead of 22 at 10 % (medians of eight and of
// four). Few of the look's lights reach such a picture, so the estimate of what virtual lights cost uses their number less one standard deviation
// (with two of those eight seeds three of 241 lights do: 3.1 -> 2.7 s and 2.0 -> 1.3).
static int countFirstPatches(const vplRunner* r, const vplPlan* p)
{
    const vplRenderOptions* o = &p->options;
    const int usual = usualFirstPatches(r->run.results[VPL_STAGE_GEOMETRY], o->stop.maxError),
              more = 3 * VPL_FIRST_PATCHES, gather = firstGather(o);
    const double reaching = p->look.worth * p->look.lights;
    const double rays = VPL_SHARE_OF_PATCHES * vplForeseenLightRays(p);
    const double most = VPL_SHARE_OF_PATCHES * raysForReaching(p, reaching - sqrt(reaching));
    return vplIsTinyPicture(o) && fitInto(r, p, o, more, gather, most) ? more
           : fitInto(r, p, o, usual, gather, rays)                     ? usual
                                                                       : 0;
}

// Patches that a plain scene begins with; 0: virtual lights are quicker.
static double patchesOfPlain(const vplRunner* r, const vplPlan* p)
{
    const vplRenderOptions* o = &p->options;
    const double error = o->stop.maxError, passes = fmax(1, ONE_PASS * ONE_PASS / (error * error));
    const double pixels = vplCountPixels(&o->output) * passes;
    const double patches = isPlain(r, p) ? patchesFor(error) : INFINITY;
    return patches > vplMostPatches(r->run.context) || pixels < PIXELS_PER_PATCH * patches ? 0 : patches;
}

bool vplChoosePatches(const vplRunner* r, vplPlan* p)
{
    vplRenderOptions* o = &p->options;
    const vplGeometry* g = r->run.results[VPL_STAGE_GEOMETRY];
    const bool can = o->stop.maxError > 0 && canUsePatches(r, p, o);
    const double plain = can ? patchesOfPlain(r, p) : 0;
    const int hidden = can ? countFirstPatches(r, p) : 0;
    if (plain == 0 && hidden == 0) {
        return false;
    }
    o->method = VPL_METHOD_RADIOSITY;
    o->radiosity.patches = plain > 0 ? (int)ceil(plain) : hidden;
    if (plain > 0) {
        vplDecide(p, "method", "light that patches exchange has no noise, and %d triangles need few",
                  g->triangleCount);
        vplDecide(p, "patches", "enough for the error, as far as is known beforehand");
    } else {
        o->radiosity.gather = firstGather(o);
        vplDecide(
            p, "method",
            "%.3g %% of the virtual lights reach the picture: light that patches exchange finds its way",
            100 * p->look.reaching);
        vplDecide(p, "patches", "a first try");
        vplDecide(p, "gather",
                  o->radiosity.gather > 0 ? "light is finer than patches"
                                          : "its blur is large in so small a picture");
    }
    if (o->output.antialias == 8) {
        o->output.antialias = 16;
        vplDecide(p, "antialias", "most of the error will be at edges");
    }
    return true;
}

// Groups of triangles take long to make, and nothing of them is left if virtual lights follow instead. So patches of them must be foreseen to
// take at most this share of the time (furnished, 320x180: from 0.5 to 0.7 s a third of the time was lost).
static const double SURE_OF_GROUPS = 0.8;

bool vplPatchesSuitTime(const vplRunner* r, const vplPlan* p, const vplRenderOptions* asked, double rays,
                        int* gatherOut)
{
    const bool plain = isPlain(r, p);
    *gatherOut = plain ? asked->radiosity.gather : firstGather(asked);
    const double patches = plain ? VPL_FEWEST_PATCHES : VPL_FIRST_PATCHES;
    const bool gathers =
        !plain && groupsTriangles(r->run.results[VPL_STAGE_GEOMETRY]); // others may go without
    return (plain || isHidden(p)) && canUsePatches(r, p, asked) &&
           fitInto(r, p, asked, patches, gathers ? VPL_FEWEST_GATHER : 0,
                   gathers ? SURE_OF_GROUPS * rays : rays);
}

void vplCountVainPatches(vplRenderer* r, double rays)
{
    r->lightRays = r->lightRays > 0 ? fmax(1, r->lightRays - rays) : 0;
}

// ---- options of plans that follow

vplRenderOptions vplAskedLikePlan(const vplRenderer* r)
{
    vplRenderOptions o = r->asked;
    const vplRenderOptions* planned = &r->plan->options;
    // If the caller chose the method, the plan's shadows are those of virtual lights alone; as an option they would apply to emitters, too.
    if (o.method == VPL_METHOD_AUTO) {
        o.lights.shadows = planned->lights.shadows;
    }
    o.method = planned->method;
    o.lights.compensation = planned->lights.compensation;
    o.lights.emitterSamples = planned->lights.emitterSamples;
    o.particles = planned->particles;
    o.pipeline.kind = planned->pipeline.kind;
    o.pipeline.interleave = planned->pipeline.interleave;
    o.output.antialias = planned->output.antialias;
    return o;
}

vplRenderOptions vplAskedWithPatches(const vplRenderer* r, int patches, int gather)
{
    vplRenderOptions o = r->asked;
    o.method = VPL_METHOD_RADIOSITY;
    o.lights.shadows = r->plan->options.lights.shadows;
    o.radiosity.patches = patches;
    o.radiosity.gather = gather;
    o.output.antialias = o.output.antialias == 8 ? 16 : o.output.antialias;
    return o;
}

vplRenderOptions vplAskedOfLights(const vplRenderer* r)
{
    vplRenderOptions o = r->asked;
    o.lights.compensation = VPL_COMPENSATION_RAYS;
    return o;
}
