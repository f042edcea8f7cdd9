// SPDX-License-Identifier: MIT
// Plans from the inside.
#ifndef VPL_RENDER_PLAN_H
#define VPL_RENDER_PLAN_H

#include "geometry/emitter_trees.h"
#include "radiosity/factors/shared_rows.h"
#include "render/runner.h"

// Plans with a runner, which keeps the results of stages that decisions needed; the plan's render finds them
// there.
vplResult vplMakePlan(vplRunner* runner, const vplRenderOptions* options, const vplMachine* machine,
                      vplPlan** planOut);

// Replaces the words of --quality by an error and a time.
void vplResolveQuality(vplRenderOptions* options);

// Adds a decision to the plan: the value of the option as it is now, and why.
__attribute__((format(printf, 3, 4))) void vplDecide(vplPlan* plan, const char* option, const char* format,
                                                     ...);

// Sets the number of particles of the first pass, if the user gave neither --grow-from nor --passes.
void vplGrowFrom(vplPlan* plan, int particles);

// Triangles of the scene over pixels of the picture.
double vplTrianglesPerPixel(const vplRunner* runner, const vplRenderOptions* options);

// Decisions that need only the options and the declared scene.
void vplDecideByOptions(const vplScene* scene, vplPlan* plan);

// Decisions that need the scene's geometry, which the runner has, or results of stages, which it then runs.
// The triangles that patches are drawn as, before they are cut at hanging vertices.
static inline double vplPlan_DrawnPatches(const vplPlan* plan)
{
    return (double)plan->patches - plan->patchGroups + plan->groupedTriangles;
}

// Sets of points that find the direct light of a side, on average: one, and about two more where patches are groups (patch_light.c).
static inline double vplPlan_PointSets(const vplPlan* plan)
{
    return plan->patchGroups > 0 ? 3 : 1;
}

// The most that shadow maps of all emitters may take together, and reflective maps that choose their own size: rays cast the
// shadows of more, and reflective maps are smaller. Maps of 44 points of 1024^2 texels, after which rays take about as long.
#define VPL_MAX_EMITTER_MAP_BYTES 1073741824.0

// More emitters than VPL_MOST_EMITTERS do not each light every point: for each point a tree chooses some. Direct light of
// 1,000 takes five times as long as that, and the choices have a relmse of 0.011.
enum { VPL_MOST_EMITTERS = 1024, VPL_EMITTERS_PER_POINT = 64 };

// The time to choose one of `count` emitters from a tree and to cast its shadow ray, in shadow rays to an emitter that lights all pixels. Those
// take less time, because the rays of neighbouring pixels are coherent. Measured: 3 with 100 emitters, 4.4 to 4.9 with 1,000, 10 with 20,000.
double vplChoiceWork(double count);

// Where there are more emitters, so many of them, chosen by strength, have reflective maps and stand for all: the texels of
// more would be too few. SSVP with 1,000 lamps: relmse 0.014 instead of 0.074, energy 0.98 instead of 0.77.
enum { VPL_MAPPED_EMITTERS = 256 };

// Faces and bytes of the shadow maps of all emitters, and faces of their reflective maps.
int vplEmitterMapFaces(const vplPlan* plan);
double vplEmitterMapBytes(const vplPlan* plan);
double vplReflectiveMapFaces(const vplPlan* plan);

vplResult vplDecideByGeometry(vplRunner* runner, vplPlan* plan);

// True for options of Hemgren's document, which knows neither cuts nor groups, and keeps all sides.
bool vplIsDocumented(const vplRadiosityOptions* options);

// Write into the plan's `problem` why it cannot be rendered, if that is so: options that contradict each other or the scene, and the
// light of emitters that documented lighting does not know; stages that must be made whole and take longer than the budget; more bytes
// than are allowed.
void vplRefuseOptions(vplPlan* plan);
void vplRefuseTime(const vplRunner* runner, vplPlan* plan);
void vplRefuseMemory(const vplContext* context, vplPlan* plan);

// Resolves the options of radiosity. Makes the patches and their sides where these are known before the render.
vplResult vplDecidePatches(vplRunner* runner, vplPlan* plan);

// Resolves the pipeline and its square of pixels. The square of radiosity stays open until `gather` is known.
void vplDecidePipeline(vplPlan* plan);

// Path tracing: decides how many vertices light paths have. May trace a few hundred paths.
vplResult vplDecideLightVertices(vplRunner* runner, vplPlan* plan);

// For a reader of the plan: makes the clusters of SSVP, so that their number is known.
vplResult vplForetellClusters(vplRunner* r, const vplPlan* p);

// Chooses maps or rays for virtual lights, by their costs for the lights of the first pass.
vplResult vplDecideLightShadows(vplRunner* runner, vplPlan* plan);

// The least numbers of emitters and of triangles that emit from which points choose by a tree.
vplTreesWanted vplTreesOf(const vplPlan* plan);

// The number of emitters that a tree chooses for each point if --emitter-samples is `asked`; 0: all of them light it. *placedOut: points and
// spots, among which the tree chooses. Directional lights always light every point.
int vplChosenEmitters(const vplPlan* plan, int asked, int* placedOut);

// The number of emitters to which a point casts shadow rays on average, if no tree chooses among them. A spot counts as the share of all
// directions that lie in its cone.
double vplAskedEmitters(const vplPlan* plan);

// Decides whether emitting triangles light pixels by samples on them or by a tree.
vplResult vplDecideTriangles(const vplRunner* runner, vplPlan* plan);

// True if a tree chooses emitting triangles for each pixel. If false, samples on area lights light the pixels, even where a tree
// chooses triangles for hits of rays.
bool vplPixelsChooseTriangles(const vplPlan* plan);

// The bytes of form factors of all pairs that this process holds, and those that it needs besides while it computes them.
vplSharedBytes vplEstimateFactors(const vplRunner* runner, const vplPlan* plan);

// Fills in counts and bytes: measured for stages that ran already, estimated for the others.
vplResult vplEstimatePlan(vplRunner* runner, const vplMachine* machine, vplPlan* plan);

// Fills in predicted times. A machine without speeds has the usual ones.
void vplEstimateTime(vplRunner* runner, const vplMachine* machine, vplPlan* plan);

// Counts of the parts of a render whose times are in vplSpeeds, in its order.
enum { VPL_SPEED_COUNT = 8 };
typedef struct vplWork {
    double counts[VPL_SPEED_COUNT];
} vplWork;

// The work of each stage of the plan in one pass, in the order of plan->stages.
void vplCountWork(vplRunner* runner, const vplPlan* plan, vplWork works[VPL_MAX_PLAN_STAGES]);

// Milliseconds that all workers take for the geometry and its ray tree.
double vplTimeOfTree(const vplContext* context, int triangles);

// Milliseconds of one thread.
double vplTimeOf(const vplSpeeds* speeds, const vplWork* work);

// The field of vplSpeeds with an index below VPL_SPEED_COUNT.
double* vplSpeedAt(vplSpeeds* speeds, int index);

#endif
