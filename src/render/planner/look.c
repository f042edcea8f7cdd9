// SPDX-License-Identifier: MIT
#include "render/planner/look.h"

#include "base/arena.h"
#include "base/context.h"
#include "lights/light_set.h"
#include "lights/placement.h"
#include "math/sampling.h"
#include "math/vec.h"

#include <math.h>

enum {
    POINTS = 128,   // of the picture
    PARTICLES = 100 // of pilot lights
};

static vplPlacementDef describeView(const vplPlan* p)
{
    vplPlacementDef def = vplDefaultPlacementDef();
    def.camera = p->camera;
    def.width = p->options.output.width;
    def.height = p->options.output.height;
    def.pointCount = POINTS;
    def.seed = p->options.seed;
    return def;
}

// ---- how near and how open

// One ray from each visible point into the half space above it.
static void probe(const vplGeometry* g, const vplViewBlock* b, int lane, int index, vplLook* look)
{
    const vplVec3 normal = {b->plane[0][lane], b->plane[1][lane], b->plane[2][lane]};
    const float u = ((float)(index % 16) + 0.5f) / 16, v = vplVanDerCorput((uint32_t)index);
    const vplVec3 from = {b->rays.origin[0][lane], b->rays.origin[1][lane], b->rays.origin[2][lane]};
    const vplRay ray = {from, vplSampleCosineAround(normal, u, v), {0, 0}};
    vplHit hit;
    look->rays++;
    if (!vplGeometry_ClosestHit(g, &ray, &hit)) {
        look->open++;
    } else if ((double)hit.t < (double)vplGeometry_Diagonal(g) / 32) {
        look->nearShare++;
    }
}

static vplResult lookAround(const vplGeometry* g, const vplPlan* p, vplArena* scratch, vplLook* look)
{
    const vplPlacementDef def = describeView(p);
    const vplViewBlock* blocks;
    int count, seen = 0;
    TRY(vplSampleView(g, &def, scratch, &blocks, &count));
    for (int i = 0; i < VPL_LANES * count; i++) {
        const vplViewBlock* b = &blocks[i / VPL_LANES];
        const int lane = i % VPL_LANES;
        const bool visible = b->plane[0][lane] != 0 || b->plane[1][lane] != 0 || b->plane[2][lane] != 0;
        seen += visible;
        if (visible) {
            probe(g, b, lane, i, look);
        }
    }
    look->points = VPL_LANES * count;
    look->background = 1 - (double)seen / look->points;
    look->open /= seen > 0 ? seen : 1;
    look->nearShare /= seen > 0 ? seen : 1;
    return VPL_SUCCESS;
}

// ---- pilot lights

// Lights of contributions c are worth (sum c)^2 / sum c^2 lights of equal contribution.
static vplResult weigh(const vplGeometry* g, const vplPlan* p, const vplLightSet* set, vplArena* scratch,
                       vplLook* look)
{
    const vplPlacementDef def = describeView(p);
    float* contributions = vplArena_Alloc(scratch, (size_t)set->lightCount, sizeof *contributions);
    double sum = 0, squares = 0;
    int64_t rays = 0;
    int reaching = 0, count = 0;
    TRY(vplArena_Check(scratch));
    TRY(vplMeasureLights(g, set, &def, contributions, &rays));
    for (int i = 0; i < set->lightCount; i++) {
        const double c = (double)contributions[i];
        count += set->lights[i].object >= 0;
        reaching += c > 0;
        sum += c;
        squares += c * c;
    }
    look->rays += rays + set->rays;
    look->lights = count;
    look->reaching = count > 0 ? (double)reaching / count : 0;
    look->worth = squares > 0 ? sum * sum / squares / count : 0;
    look->lightLeaving = set->particleCount > 0 ? (double)set->escaped / set->particleCount : 0;
    return VPL_SUCCESS;
}

static vplResult shootPilots(const vplGeometry* g, const vplPlan* p, vplArena* scratch, vplLook* look)
{
    vplParticleDef def = vplDefaultParticleDef();
    vplLightSet* set;
    def.start = VPL_START_EMITTER;
    def.particleCount = PARTICLES;
    def.reflectivity = vplGeometry_MeanReflectance(g);
    def.sampler = VPL_SAMPLER_HALTON;
    def.bounce = VPL_BOUNCE_DIFFUSE;
    def.seed = p->options.seed;
    TRY(vplSimulateParticles(g, p->emitters, p->emitterCount, &def, &set));
    const vplResult result = weigh(g, p, set, scratch, look);
    vplLightSet_Destroy(set);
    return result;
}

// One worker takes the look, because waking the others may take longer: 10 to 30 ms in a virtual machine.
static vplResult takeLook(vplContext* context, const vplGeometry* g, const vplPlan* plan, vplLook* look)
{
    const int workers = context->workerCount;
    vplArena* scratch = vplArena_Create(context);
    *look = (vplLook){0};
    context->workerCount = 1;
    vplResult result = vplArena_Check(scratch);
    if (result == VPL_SUCCESS && g->triangleCount > 0) {
        result = lookAround(g, plan, scratch, look);
        result = result == VPL_SUCCESS ? shootPilots(g, plan, scratch, look) : result;
    }
    context->workerCount = workers;
    vplArena_Destroy(scratch);
    return result;
}

vplResult vplTakeLook(vplRunner* r, const vplPlan* plan, vplLook* lookOut)
{
    if (!r->looked) {
        TRY(takeLook(r->run.context, r->run.results[VPL_STAGE_GEOMETRY], plan, &r->look));
        r->looked = true;
    }
    *lookOut = r->look;
    return VPL_SUCCESS;
}
