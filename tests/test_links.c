// SPDX-License-Identifier: MIT
// Tests of hierarchical radiosity's links against all pairs and against known solutions.
#include "scenes.h"

#include "radiosity/links/links.h"
#include "base/hash.h"
#include "math/vec.h"

#include <stdlib.h>

typedef struct Room {
    vplGeometry* geometry;
    vplPatches* patches;
    vplPatchSides* sides;
    vplLinks* links;
    vplFormFactors* factors; // NULL until a test creates them
} Room;

// Opens a room from `scene`, which it destroys. The emission of the scene's emitters and materials is the
// light.
static void openRoom(Room* room, vplScene* scene, int patches)
{
    memset(room, 0, sizeof *room);
    vplPatchDef patchDef = vplDefaultPatchDef();
    vplPatchSidesDef sidesDef = vplDefaultPatchSidesDef();
    vplEmitterDef emitters[2];
    assert_true(vplScene_GetEmitterCount(scene) <= 2);
    for (int i = 0; i < vplScene_GetEmitterCount(scene); i++) {
        emitters[i] = *vplScene_GetEmitter(scene, i);
    }
    sidesDef.emitters = emitters;
    sidesDef.emitterCount = vplScene_GetEmitterCount(scene);
    patchDef.count = patches;
    assert_int_equal(vplGeometry_Create(scene, &room->geometry), VPL_SUCCESS);
    assert_int_equal(vplPatches_Create(room->geometry, &patchDef, &room->patches), VPL_SUCCESS);
    assert_int_equal(vplPatchSides_Create(room->patches, &sidesDef, &room->sides), VPL_SUCCESS);
    vplScene_Destroy(scene);
}

static void linkRoom(Room* room, const vplLinkDef* def)
{
    if (vplLinks_Create(room->sides, def, &room->links) != VPL_SUCCESS) {
        fail_msg("%s", takeMessage());
    }
}

static void closeRoom(Room* room)
{
    vplFormFactors_Destroy(room->factors);
    vplLinks_Destroy(room->links);
    vplPatchSides_Destroy(room->sides);
    vplPatches_Destroy(room->patches);
    vplGeometry_Destroy(room->geometry);
}

static vplRgb* gather(const Room* room, const vplFormFactors* factors, const vplRgb* b)
{
    const vplTransport t = {room->sides, factors, factors ? NULL : room->links};
    vplRgb* e = calloc((size_t)room->sides->count + 1, sizeof *e);
    assert_non_null(e);
    if (vplGatherRadiosity(&t, b, e) != VPL_SUCCESS) {
        fail_msg("%s", takeMessage());
    }
    return e;
}

// Returns the same radiosity for every side.
static vplRgb* evenLight(const Room* room)
{
    vplRgb* b = calloc((size_t)room->sides->count + 1, sizeof *b);
    assert_non_null(b);
    for (int i = 0; i < room->sides->count; i++) {
        b[i] = (vplRgb){1, 2, 0};
    }
    return b;
}

// Returns radiosity that varies smoothly between walls and over each wall.
static vplRgb* unevenLight(const Room* room)
{
    vplRgb* b = evenLight(room);
    for (int i = 0; i < room->sides->count; i++) {
        const vplVec3 p = room->sides->sides[i].incentre;
        b[i].r = 1.5f + p.x * p.y;
        b[i].g = 2 + p.z + 0.5f * p.x;
    }
    return b;
}

static double areaMean(const Room* room, const vplRgb* values)
{
    double sum = 0, area = 0;
    for (int i = 0; i < room->sides->count; i++) {
        sum += (double)room->sides->sides[i].area * (double)values[i].r;
        area += (double)room->sides->sides[i].area;
    }
    return sum / area;
}

// Returns the root of the area-weighted mean square of a - b, relative to the mean of b.
static double difference(const Room* room, const vplRgb* a, const vplRgb* b)
{
    double squares = 0, area = 0;
    for (int i = 0; i < room->sides->count; i++) {
        const double d = (double)a[i].r - (double)b[i].r;
        squares += (double)room->sides->sides[i].area * d * d;
        area += (double)room->sides->sides[i].area;
    }
    return sqrt(squares / area) / areaMean(room, b);
}

static vplScene* boxInRoom(vplContext* context)
{
    vplScene* scene = closedCubeScene(context, 0.5f, 0);
    addThing(scene, VPL_OBJECT_BOX, 0, vplVec(0.25f, -0.6f, -0.2f), 0, 0.5, vplVec(0.5f, 0.8f, 0.5f));
    addEmitter(scene, VPL_EMITTER_POINT, vplVec(-0.3f, 0.6f, 0.2f), vplVec(0, -1, 0), 3);
    return scene;
}

// ---- known solutions

TEST(AClosedRoomKeepsAllLight, 2)
{
    Room room;
    const vplLinkDef def = vplDefaultLinkDef();
    openRoom(&room, closedCubeScene(context, 0.5f, 1), 1500);
    linkRoom(&room, &def);
    double before = 0;
    for (int i = 0; i < room.sides->count; i++) {
        before += (double)room.links->rowSums[i] / room.sides->count;
    }
    assertNear(before, 1, 0.01, "mean of sums as found", 0);
    vplRgb* b = evenLight(&room);
    vplRgb* e = gather(&room, NULL, b);
    for (int i = 0; i < room.sides->count; i++) {
        assertNear((double)e[i].r, 1, 2e-3, "irradiance", i);
        assertNear((double)e[i].g, 2, 4e-3, "irradiance", i);
        assert_true(e[i].b == 0);
    }
    free(b);
    free(e);
    closeRoom(&room);
}

TEST(AFurnaceGlowsAsItMust, 2)
{
    Room room;
    const vplLinkDef def = vplDefaultLinkDef();
    openRoom(&room, closedCubeScene(context, 0.75f, 1), 700);
    linkRoom(&room, &def);
    const vplTransport t = {room.sides, NULL, room.links};
    vplRgb* source = calloc((size_t)room.sides->count, sizeof *source);
    vplRgb* b = calloc((size_t)room.sides->count, sizeof *b);
    assert_true(source != NULL && b != NULL);
    for (int i = 0; i < room.sides->count; i++) {
        source[i] = room.sides->sides[i].emission; // pi, pi / 2, pi / 4
    }
    vplSolveDef solveDef = vplDefaultSolveDef();
    vplSolveStats stats;
    assert_int_equal(vplSolveRadiosity(&t, &solveDef, source, b, &stats), VPL_SUCCESS);
    for (int i = 0; i < room.sides->count; i++) {
        assertNear((double)b[i].r, 4 * VPL_PI, 0.04, "radiosity", i);
        assertNear((double)b[i].b, VPL_PI, 0.01, "radiosity", i);
    }
    assert_int_equal(stats.solver, VPL_SOLVER_JACOBI);
    assertNear(stats.spectralRadius, 0.75, 1e-3, "radius", 0);
    assert_true(stats.rowSumMax <= 1);
    free(source);
    free(b);
    closeRoom(&room);
}

// Links are reciprocal, A_i F_ij = A_j F_ji: <x, F y> = <y, F x> with area weights.
TEST(LinksServeBothDirections, 2)
{
    Room room;
    const vplLinkDef def = vplDefaultLinkDef();
    openRoom(&room, boxInRoom(context), 600);
    linkRoom(&room, &def);
    vplRgb *x = unevenLight(&room), *y = evenLight(&room);
    for (int i = 0; i < room.sides->count; i++) {
        y[i].r = (float)uniformAt(3, (uint64_t)i);
    }
    vplRgb *fx = gather(&room, NULL, x), *fy = gather(&room, NULL, y);
    double there = 0, back = 0;
    for (int i = 0; i < room.sides->count; i++) {
        const double area = (double)room.sides->sides[i].area;
        there += area * (double)y[i].r * (double)fx[i].r;
        back += area * (double)x[i].r * (double)fy[i].r;
    }
    assertNear(there / back, 1, 1e-6, "ratio", 0);
    free(x);
    free(y);
    free(fx);
    free(fy);
    closeRoom(&room);
}

// ---- against all pairs

static double errorOf(Room* room, double error)
{
    vplLinkDef def = vplDefaultLinkDef();
    vplFormFactorDef all = vplDefaultFormFactorDef();
    def.error = error;
    all.samples = 16;
    linkRoom(room, &def);
    if (room->factors == NULL) {
        assert_int_equal(vplFormFactors_Create(room->sides, &all, &room->factors), VPL_SUCCESS);
    }
    vplRgb* b = unevenLight(room);
    vplRgb *e = gather(room, NULL, b), *wanted = gather(room, room->factors, b);
    const double found = difference(room, e, wanted);
    assertNear(areaMean(room, e) / areaMean(room, wanted), 1, 0.01, "mean irradiance", 0);
    free(b);
    free(e);
    free(wanted);
    return found;
}

TEST(IrradianceIsThatOfAllPairsToTheErrorAskedFor, 2, SLOW)
{
    Room room;
    openRoom(&room, boxInRoom(context), 1000);
    const double fine = errorOf(&room, vplDefaultLinkDef().error);
    const int64_t many = room.links->linkCount;
    vplLinks_Destroy(room.links);
    const double coarse = errorOf(&room, 0.004);
    // Measured: 0.0045 and 0.0091, a part of which are rays between sides.
    assert_true(fine < 0.006 && fine < 0.6 * coarse && many > 4 * room.links->linkCount);
    closeRoom(&room);
}

// A floor under a distant square: light over it is smooth, though the links' receivers are groups of patches.
TEST(LightOverAGroupHasASlope, 2)
{
    Room room;
    vplScene* scene = sceneOf(context, 0.5f);
    addThing(scene, VPL_OBJECT_QUAD, 0, vplVec(0, 0, 0), -VPL_PI / 2, 0, vplVec(4, 4, 1));
    addThing(scene, VPL_OBJECT_QUAD, addMaterial(scene, (vplRgb){0, 0, 0}, 1), vplVec(3, 4, 0), VPL_PI / 2, 0,
             vplVec(1, 1, 1));
    openRoom(&room, scene, 2176);
    vplLinkDef def = vplDefaultLinkDef();
    def.rowSums = VPL_ROW_SUMS_KEEP;
    linkRoom(&room, &def);
    vplRgb* b = evenLight(&room);
    for (int i = 0; i < room.sides->count; i++) {
        b[i].r = room.sides->sides[i].normal.y < 0 ? 1 : 0;
    }
    vplRgb* e = gather(&room, NULL, b);
    const float y = 4, low = -0.5f, high = 0.5f;
    const vplVec3 halves[2][3] = {{{3 + low, y, low}, {3 + high, y, low}, {3 + high, y, high}},
                                  {{3 + low, y, low}, {3 + high, y, high}, {3 + low, y, high}}};
    double worst = 0, most = 0, least = INFINITY;
    for (int i = 0; i < room.sides->count; i++) {
        const vplPatchSide* s = &room.sides->sides[i];
        if (s->normal.y > 0) {
            const vplVec3 at =
                vplScale(1.0f / 3, vplAdd(s->corners[0], vplAdd(s->corners[1], s->corners[2])));
            const double wanted =
                vplPointFormFactor(at, s->normal, halves[0]) + vplPointFormFactor(at, s->normal, halves[1]);
            worst = fmax(worst, fabs((double)e[i].r - wanted) / wanted);
            most = fmax(most, wanted);
            least = fmin(least, wanted);
        }
    }
    // Measured: 0.011 at the darkest corner with 923 links for 2,176 patches, over which light varies by 6.5.
    assert_true(most > 5 * least && worst < 0.025);
    printf("# %d %ld worst %g\n", room.sides->count, (long)room.links->linkCount, worst);
    assert_true(room.links->linkCount < room.sides->count / 2);
    free(b);
    free(e);
    closeRoom(&room);
}

// The area light lies in the ceiling's plane, but must not share a group of the hierarchy with it.
TEST(AnAreaLightFlushWithTheCeilingShinesFromWhereItIs, 2)
{
    Room room;
    vplScene* scene = closedCubeScene(context, 0.5f, 0);
    addThing(scene, VPL_OBJECT_QUAD, addMaterial(scene, (vplRgb){0, 0, 0}, 5), vplVec(0.7f, 0.9999f, 0.7f),
             VPL_PI / 2, 0, vplVec(0.3f, 0.3f, 1));
    openRoom(&room, scene, 1000);
    vplLinkDef def = vplDefaultLinkDef();
    vplFormFactorDef all = vplDefaultFormFactorDef();
    all.samples = 16;
    linkRoom(&room, &def);
    assert_int_equal(vplFormFactors_Create(room.sides, &all, &room.factors), VPL_SUCCESS);
    vplRgb* b = evenLight(&room);
    for (int i = 0; i < room.sides->count; i++) {
        b[i] = room.sides->sides[i].emission;
    }
    vplRgb *e = gather(&room, NULL, b), *wanted = gather(&room, room.factors, b);
    assert_true(areaMean(&room, wanted) > 0.01);
    assert_true(difference(&room, e, wanted) < 0.12); // measured: 0.098, on walls next to it
    free(b);
    free(e);
    free(wanted);
    closeRoom(&room);
}

TEST(NoLightGoesThroughAWall, 2, SLOW)
{
    Room room;
    vplScene* scene = closedCubeScene(context, 0.5f, 0);
    addThing(scene, VPL_OBJECT_QUAD, 0, vplVec(0, 0, 0), 0, VPL_PI / 2, vplVec(2.01f, 2.01f, 1));
    addEmitter(scene, VPL_EMITTER_POINT, vplVec(-0.5f, 0.1f, 0.2f), vplVec(0, -1, 0), 3);
    addEmitter(scene, VPL_EMITTER_POINT, vplVec(0.5f, 0.1f, 0.2f), vplVec(0, -1, 0), 3);
    openRoom(&room, scene, 1000);
    const vplLinkDef def = vplDefaultLinkDef();
    linkRoom(&room, &def);
    vplRgb* b = evenLight(&room);
    for (int i = 0; i < room.sides->count; i++) {
        const vplPatchSide* s = &room.sides->sides[i];
        const bool left = s->incentre.x < -1e-3f || (fabsf(s->incentre.x) < 1e-3f && s->normal.x < 0);
        b[i].r = left ? 1 : 0;
    }
    vplRgb* e = gather(&room, NULL, b);
    double leaked = 0, kept = 0;
    for (int i = 0; i < room.sides->count; i++) {
        const double power = (double)room.sides->sides[i].area * (double)e[i].r;
        kept += b[i].r > 0 ? power : 0;
        leaked += b[i].r > 0 ? 0 : power;
    }
    assert_true(kept > 5 && leaked < 1e-3 * kept);
    free(b);
    free(e);
    closeRoom(&room);
}

// The linear functions that links stand for are checked at eight points of either group, but are used at all sides.
// They must be negative at none: in Sponza, light grew without bound.
TEST(NoSideTakesLightFromAnother, 2)
{
    Room room;
    vplLinkDef def = vplDefaultLinkDef();
    def.error = 0.004; // large groups
    openRoom(&room, boxInRoom(context), 500);
    linkRoom(&room, &def);
    vplRgb* b = evenLight(&room);
    memset(b, 0, (size_t)room.sides->count * sizeof *b);
    double least = 0, most = 0;
    for (int from = 0; from < room.sides->count; from++) {
        b[from].r = 1;
        vplRgb* e = gather(&room, NULL, b);
        for (int i = 0; i < room.sides->count; i++) {
            const double r = (double)e[i].r; // fmin and fmax here crash gcc 12 for aarch64
            least = r < least ? r : least;
            most = r > most ? r : most;
        }
        b[from].r = 0;
        free(e);
    }
    assert_true(most > 0.1 && most <= 1);
    assertNear(least, 0, 1e-7, "least exchange", 0);
    free(b);
    closeRoom(&room);
}

// Rows of links that carry next to nothing are not scaled to 1: what they carry may be the rounding of nothing.
TEST(RoundingIsNotScaledUp, 2)
{
    Room room;
    vplLinkDef def = vplDefaultLinkDef();
    openRoom(&room, closedCubeScene(context, 0.5f, 1), 100);
    linkRoom(&room, &def);
    struct vplLinkTree* tree = room.links->tree;
    for (int64_t i = 0; i < tree->firstOf[tree->nodeCount]; i++) {
        vplLinkEnd* end = &tree->ends[i];
        end->factor *= 1e-12f;
        for (int axis = 0; axis < 3; axis++) {
            end->receiverSlope[axis] *= 1e-12f;
            end->senderSlope[axis] *= 1e-12f;
        }
    }
    float* sums = calloc((size_t)room.sides->count, sizeof *sums);
    def.rowSums = VPL_ROW_SUMS_NORMALISE;
    assert_int_equal(vplLinks_FitRows(room.links, room.sides, &def, sums), VPL_SUCCESS);
    for (int i = 0; i < room.sides->count; i++) {
        assert_true(sums[i] < 2e-12f && tree->scale[i] >= 1 && tree->scale[i] <= 1024);
    }
    free(sums);
    closeRoom(&room);
}

// Small sides between a box and the floor see what they see, and not what the group around them does: without, the irradiance of
// one is 0.077 off where the ceiling has a radiosity of 1.
TEST(SmallSidesSeeForThemselves, 2, SLOW)
{
    Room room;
    const vplLinkDef def = vplDefaultLinkDef();
    const vplFormFactorDef all = vplDefaultFormFactorDef();
    openRoom(&room, boxInRoom(context), 6656);
    linkRoom(&room, &def);
    assert_int_equal(vplFormFactors_Create(room.sides, &all, &room.factors), VPL_SUCCESS);
    vplRgb* b = calloc((size_t)room.sides->count, sizeof *b);
    for (int i = 0; i < room.sides->count; i++) {
        const vplPatchSide* s = &room.sides->sides[i];
        b[i].r = s->normal.y < -0.99f && s->incentre.y > 0.9f ? 1 : 0; // the ceiling
    }
    vplRgb *e = gather(&room, NULL, b), *wanted = gather(&room, room.factors, b);
    double most = 0;
    int compared = 0;
    for (int i = 0; i < room.sides->count; i++) {
        const vplPatchSide* s = &room.sides->sides[i];
        if (s->normal.y > 0.99f && s->incentre.y < -0.9f) {
            const double off = fabs((double)e[i].r - (double)wanted[i].r);
            most = off > most ? off : most;
            compared++;
        }
    }
    assert_true(compared > 900);
    assert_true(most < 0.04); // measured: 0.033
    free(b);
    free(e);
    free(wanted);
    closeRoom(&room);
}

// ---- cost

TEST(EightTimesThePatchesTakeHalfAsManyLinksEach, 2, SLOW)
{
    int64_t links[2], rays[2];
    int sides[2];
    for (int k = 0; k < 2; k++) {
        Room room;
        vplLinkDef def = vplDefaultLinkDef();
        def.error = k ? 0.00025 * sqrt(2) : 0.00025; // 0.00025 for one link: from 4,000 sides on it falls
        openRoom(&room, boxInRoom(context), k ? 13056 : 1664);
        const size_t before = vplContext_GetBytes(context);
        linkRoom(&room, &def);
        sides[k] = room.sides->count;
        links[k] = room.links->linkCount;
        rays[k] = room.links->rays;
        assert_int_equal(room.links->groupCount, sides[k] - 1);
        assert_true(vplContext_GetBytes(context) - before < 10000 * (size_t)sides[k]);
        closeRoom(&room);
    }
    // Measured: 3.99 times the links and 5.8 times the rays, of which 32 per side are the side's own. Before sides of a group were
    // tried by themselves it was 3.2 and 2.3 times.
    printf("# %d %d, %ld %ld, %ld %ld\n", sides[0], sides[1], (long)links[0], (long)links[1], (long)rays[0],
           (long)rays[1]);
    assert_true(sides[1] > 7 * sides[0] && links[1] < 4 * links[0] && rays[1] < 6 * rays[0]);
}

// The unoccluded form factor of two nodes, as points find it.
static double openFactor(const vplLinkWork* work, int p, int q)
{
    const vplLinkPoints *from = &work->points[p], *to = &work->points[q];
    const vplLinkNode *a = &work->tree->nodes[p], *b = &work->tree->nodes[q];
    vplLinkTerms terms;
    vplGetRadiosityKernels(work->sides->context->isa)->linkTerms(from, to, &terms);
    double mean = 0;
    for (int i = 0; i < VPL_LINK_POINTS; i++) {
        mean += 0.5 * (double)(from->weight[i] * terms.rows[i] + to->weight[i] * terms.columns[i]);
    }
    return mean * fmax((double)a->area * (double)a->brightness, (double)b->area * (double)b->brightness);
}

static void judgeRays(const vplLinkWork* work, int p, int q, int count[2])
{
    const vplLinkNode *a = &work->tree->nodes[p], *b = &work->tree->nodes[q];
    const bool disjoint = a->first + a->count <= b->first || b->first + b->count <= a->first;
    if (!disjoint || (a->count == 1 && b->count == 1)) {
        return;
    }
    const vplLinkAnswer answer = vplJudgePair(work, &(vplLinkPair){.p = p, .q = q, .blocker = -1});
    const double times = openFactor(work, p, q) / work->allowed;
    assert_true(answer.rays <= VPL_MOST_LINK_RAYS);
    if (answer.verdict == VPL_LINK_NONE && answer.rays > 0) {
        assert_true(answer.rays < 16 * times + 16);
        count[0]++;
    } else if (times <= 1) {
        assert_true(answer.rays <= 16);
        count[1]++;
    }
}

// Pairs that carry less than the allowed error cast up to 16 rays; hidden ones 16 for each time that they carry it.
TEST(RaysFollowWhatALinkCarries, 2)
{
    Room room;
    vplLinkDef def = vplDefaultLinkDef();
    struct vplLinkTree tree = {.nodes = NULL};
    vplArena* arena = vplArena_Create(context);
    int count[2] = {0, 0};
    def.error = 0.001;
    openRoom(&room, boxInRoom(context), 300);
    assert_int_equal(vplLinkTree_Build(arena, room.sides, &tree), VPL_SUCCESS);
    vplLinkPoints* points = vplArena_Alloc(arena, (size_t)tree.nodeCount, sizeof *points);
    assert_int_equal(vplArena_Check(arena), VPL_SUCCESS);
    const vplLinkWork work = {
        .sides = room.sides, .tree = &tree, .def = &def, .allowed = def.error, .points = points};
    for (int node = 0; node < tree.nodeCount; node++) {
        vplLinkPoints_Draw(&work, node);
    }
    for (int p = 0; p < tree.nodeCount; p++) {
        for (int q = p + 1; q < tree.nodeCount; q++) {
            judgeRays(&work, p, q, count);
        }
    }
    assert_true(count[0] > 1000 && count[1] > 1000);
    vplArena_Destroy(arena);
    closeRoom(&room);
}

// Judging some pairs of each level tells how much memory all links take.
TEST(TheEstimateOfLinksHolds, 2)
{
    for (int k = 0; k < 2; k++) {
        Room room;
        const vplLinkDef def = vplDefaultLinkDef();
        double held, scratch;
        openRoom(&room, boxInRoom(context), k ? 2000 : 300);
        assert_int_equal(vplLinks_EstimateBytes(room.sides, &def, &held, &scratch), VPL_SUCCESS);
        const size_t before = vplContext_GetBytes(context);
        linkRoom(&room, &def);
        const double taken = (double)(vplContext_GetBytes(context) - before);
        assertNear(held / taken, 1, 0.15, "share of the memory", k);
        closeRoom(&room);
    }
}

// ---- extremes

TEST(WhatIsInOnePlaneHasNoLinks, 1)
{
    for (int tilt = 0; tilt < 2; tilt++) {
        for (int patches = 1; patches < 300; patches += 250) {
            Room room;
            vplScene* scene = sceneOf(context, 0.5f);
            addThing(scene, VPL_OBJECT_QUAD, 0, vplVec(100, 0, 0), tilt ? 0.7 : 0, tilt ? 0.3 : 0,
                     vplVec(3, 2, 1));
            addEmitter(scene, VPL_EMITTER_POINT, vplVec(100, 0, 5), vplVec(0, 0, -1), 1);
            openRoom(&room, scene, patches);
            const vplLinkDef def = vplDefaultLinkDef();
            linkRoom(&room, &def);
            vplRgb* b = evenLight(&room);
            vplRgb* e = gather(&room, NULL, b);
            assert_true(room.sides->count >= patches && room.links->linkCount == 0);
            for (int i = 0; i < room.sides->count; i++) {
                assert_true(e[i].r == 0 && e[i].g == 0);
            }
            free(b);
            free(e);
            closeRoom(&room);
        }
    }
}

TEST(NoSidesHaveNoLinks, 1)
{
    Room room;
    const vplLinkDef def = vplDefaultLinkDef();
    openRoom(&room, closedCubeScene(context, 0.5f, 0), 100); // dark
    assert_int_equal(room.sides->count, 0);
    linkRoom(&room, &def);
    vplRgb* b = evenLight(&room);
    free(gather(&room, NULL, b));
    assert_int_equal(room.links->linkCount, 0);
    free(b);
    closeRoom(&room);
}

// X095: patches that share an edge, at tiny and huge scales, have finite factors of at most 1.
TEST(CornersAndScalesAreFinite, 2)
{
    for (int scale = -6; scale <= 6; scale += 6) {
        Room room;
        const float size = (float)pow(10, scale);
        vplScene* scene = sceneOf(context, 0.5f);
        addThing(scene, VPL_OBJECT_QUAD, 0, vplVec(0, 0, 0), 0, 0, vplVec(size, size, 1));
        addThing(scene, VPL_OBJECT_QUAD, 0, vplVec(0, 0.5f * size, 0.5f * size), VPL_PI / 2, 0,
                 vplVec(size, size, 1));
        addEmitter(scene, VPL_EMITTER_POINT, vplVec(0, 0, size), vplVec(0, 0, -1), 1);
        openRoom(&room, scene, 200);
        vplLinkDef def = vplDefaultLinkDef();
        def.rowSums = VPL_ROW_SUMS_KEEP;
        linkRoom(&room, &def);
        vplRgb* b = evenLight(&room);
        vplRgb* e = gather(&room, NULL, b);
        // Two squares at a right angle have the factor 0.20004 (Howell, C-14), for the fronts of both.
        assert_true(room.sides->count >= 200);
        assertNear(areaMean(&room, e), 0.20004, 0.004, "mean irradiance", scale);
        for (int i = 0; i < room.sides->count; i++) {
            assert_true(isfinite(e[i].r) && e[i].r >= 0 && e[i].r <= 1);
        }
        free(b);
        free(e);
        closeRoom(&room);
    }
}

TEST(WrongArgumentsAreRefused, 1)
{
    Room room;
    vplLinks* links = NULL;
    openRoom(&room, boxInRoom(context), 50);
    const struct {
        double error;
        int samples, rowSums;
        const char* message;
    } cases[] = {{0, 4, 0, "vplLinkDef.error is 0, must be in (0, 1]"},
                 {1.5, 4, 0, "vplLinkDef.error is 1.5"},
                 {(double)NAN, 4, 0, "vplLinkDef.error is"},
                 {0.1, 0, 0, "vplLinkDef.samples is 0, must be in [1, 1024]"},
                 {0.1, 1025, 0, "vplLinkDef.samples is 1025"},
                 {0.1, 4, 4, "vplLinkDef.rowSums is 4"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        vplLinkDef def = vplDefaultLinkDef();
        def.error = cases[i].error;
        def.samples = cases[i].samples;
        def.rowSums = (vplRowSums)cases[i].rowSums;
        assert_int_equal(vplLinks_Create(room.sides, &def, &links), VPL_INVALID_ARGUMENT);
        assert_non_null(strstr(takeMessage(), cases[i].message));
    }
    vplLinkDef def = vplDefaultLinkDef();
    def.cookie = 0;
    assert_int_equal(vplLinks_Create(room.sides, &def, &links), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "vplDefaultLinkDef"));
    assert_null(links);
    vplLinks_Destroy(NULL);
    closeRoom(&room);
}

TEST(ProgressOfLinksEndsAtOneAndCancellingLeavesNothing, 1)
{
    Room room;
    vplLinks* links = NULL;
    vplLinkDef def = vplDefaultLinkDef();
    Progressed seen = {0, 0};
    int asked = 0;
    openRoom(&room, boxInRoom(context), 500);
    const size_t before = vplContext_GetBytes(context);
    def.progress = noteProgress;
    def.progressUser = &seen;
    assert_int_equal(vplLinks_Create(room.sides, &def, &links), VPL_SUCCESS);
    assert_true(seen.last == 1);
    vplLinks_Destroy(links);
    links = NULL;
    def.progress = refuseThird;
    def.progressUser = &asked;
    assert_int_equal(vplLinks_Create(room.sides, &def, &links), VPL_CANCELLED);
    assert_true(links == NULL && asked == 3 && vplContext_GetBytes(context) == before);
    closeRoom(&room);
}

static uint64_t linksHash(vplContext* context)
{
    Room room;
    vplLinkDef def = vplDefaultLinkDef();
    def.samples = 20; // more than one packet
    openRoom(&room, boxInRoom(context), 700);
    linkRoom(&room, &def);
    vplRgb* b = unevenLight(&room);
    vplRgb* e = gather(&room, NULL, b);
    const uint32_t counts[] = {(uint32_t)room.links->linkCount, (uint32_t)room.links->rays};
    uint64_t hash = vplHashWords(0, counts, 2);
    hash = vplHashFloats(hash, room.links->rowSums, (size_t)room.sides->count);
    hash = vplHashFloats(hash, &e[0].r, 3 * (size_t)room.sides->count);
    free(b);
    free(e);
    closeRoom(&room);
    closeTestContext(context);
    return hash;
}

TEST_ALONE(LinksAreTheSameBitsEverywhere)
{
    assertSameEverywhere(linksHash);
}
