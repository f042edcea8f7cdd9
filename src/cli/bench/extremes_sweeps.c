// SPDX-License-Identifier: MIT
// The sweeps of vpl bench --extremes, and what each promises.
#include "cli/bench/extremes.h"

#include <math.h>
#include <stdlib.h>

// Bits of methods.
enum {
    ALL = (1 << METHODS) - 1,
    MAPPED = 1 << DIRECT_MAP | 1 << DEFERRED | 1 << SSVP,
    COUNTED = ALL & ~(1 << DIRECT_MAP | 1 << DIRECT_RAYS)
};

static vplResult measureRoom(Trial* t, const RoomScene* room)
{
    vplScene* scene = NULL;
    const vplResult made = buildRoomAt(t->context, room, &scene);
    return compareRoom(t, room, scene, made);
}

// ---- the same room elsewhere

static vplResult measureScale(Trial* t)
{
    RoomScene room = plainRoom();
    room.scale = t->value;
    room.intensity = fmin(10 * t->value * t->value, 1e14);
    return measureRoom(t, &room);
}

static vplResult measurePlanes(Trial* t)
{
    RoomScene room = plainRoom();
    room.farOverNear = t->value;
    return measureRoom(t, &room);
}

static vplResult measureIntensity(Trial* t)
{
    RoomScene room = plainRoom();
    room.intensity = t->value;
    return measureRoom(t, &room);
}

static RoomScene movedRoom(double offset)
{
    RoomScene room = plainRoom();
    room.offset[0] = offset;
    room.offset[1] = offset / 3;
    room.offset[2] = -offset;
    return room;
}

static vplResult measureOffset(Trial* t)
{
    const RoomScene room = movedRoom(t->value);
    return measureRoom(t, &room);
}

static vplResult measureFileOffset(Trial* t)
{
    const RoomScene room = movedRoom(t->value);
    vplScene* scene = NULL;
    const vplResult made = loadRoomAt(t->context, &room, &scene);
    return compareRoom(t, &room, scene, made);
}

// ---- a floor under a point light

static vplResult measureView(Trial* t)
{
    FloorScene f = plainFloor();
    vplRenderOptions o;
    f.fov = t->value * VPL_PI / 180;
    f.size = fmax(10, 3 * f.eyeHeight * tan(fmin(f.fov, 3.14) / 2));
    TRY(chooseOptions(t, f.width, f.height, &o));
    return compareFloor(t, &f, &o);
}

static vplResult measureLightHeight(Trial* t)
{
    FloorScene f = plainFloor();
    vplRenderOptions o;
    f.light[1] = t->value;
    f.intensity = fmax(1, t->value * t->value);
    TRY(chooseOptions(t, f.width, f.height, &o));
    return compareFloor(t, &f, &o);
}

// The light is 2 m from the middle of the picture, which shows 1 cm of the floor.
static vplResult measureGrazing(Trial* t)
{
    FloorScene f = plainFloor();
    vplRenderOptions o;
    const double angle = t->value * VPL_PI / 180;
    f.light[0] = 2 * sin(angle);
    f.light[1] = 2 * cos(angle);
    f.fov = 0.0025;
    TRY(chooseOptions(t, f.width, f.height, &o));
    return compareFloor(t, &f, &o);
}

static FloorScene shadowedFloor(void)
{
    FloorScene f = plainFloor();
    f.light[0] = 0.06;
    f.light[2] = -0.041;
    f.eyeHeight = 1;
    f.blocker = 0.09;
    f.width = f.height = 96;
    return f;
}

// Direct light and SSVP are compared with the closed form of the square's shadow. Virtual lights with maps are compared
// with virtual lights that cast shadow rays, in the room.
static vplResult measureMaps(Trial* t)
{
    const FloorScene f = shadowedFloor();
    const RoomScene room = plainRoom();
    vplRenderOptions o;
    TRY(chooseOptions(t, f.width, f.height, &o));
    o.shadow.mapSize = o.shadow.rsmSize = o.lights.mapSize = o.ssvp.paraboloidSize = (int)t->value;
    o.shadow.pcfSamples = 1;
    if (t->method != DEFERRED) {
        o.output.show = VPL_SHOW_DIRECT;
        return compareFloor(t, &f, &o);
    }
    o.output.width = ROOM_WIDTH;
    o.output.height = ROOM_HEIGHT;
    o.particles.count = 10;
    vplScene* scene = NULL;
    vplImage *mapped, *traced;
    vplResult made = buildRoomAt(t->context, &room, &scene);
    TRY(renderOnce(scene, made, &o, &mapped));
    o.lights.shadows = VPL_LIGHT_SHADOWS_RAY;
    o.lights.mapSize = 1;
    scene = NULL;
    made = buildRoomAt(t->context, &room, &scene);
    const vplResult result = renderOnce(scene, made, &o, &traced);
    if (result == VPL_SUCCESS) {
        t->error = differenceOf(mapped, traced, 1);
        vplImage_Destroy(traced);
    }
    vplImage_Destroy(mapped);
    return result;
}

static vplResult measurePcf(Trial* t)
{
    FloorScene f = shadowedFloor();
    vplRenderOptions o;
    TRY(chooseOptions(t, f.width, f.height, &o));
    o.shadow.pcfSamples = (int)t->value;
    o.shadow.mapSize = 2048;
    return compareFloor(t, &f, &o);
}

static vplResult measureSize(Trial* t, int width, int height)
{
    FloorScene f = plainFloor();
    vplRenderOptions o;
    f.width = width;
    f.height = height;
    f.fov = width > height ? 0.0001 : f.fov;
    TRY(chooseOptions(t, width, height, &o));
    return compareFloor(t, &f, &o);
}

static vplResult measureWidth(Trial* t)
{
    return measureSize(t, (int)t->value, 1);
}

static vplResult measureHeight(Trial* t)
{
    return measureSize(t, 1, (int)t->value);
}

// ---- memory

#define FREE_BYTES 65536.0 // for the context and its threads, which plans do not count

typedef struct Purse {
    size_t held, peak, limit; // bytes
} Purse;

static void* spend(void* user, void* memory, size_t oldSize, size_t newSize)
{
    Purse* p = user;
    if (newSize > oldSize && p->held + (newSize - oldSize) > p->limit) {
        return NULL;
    }
    void* block = newSize > 0 ? realloc(memory, newSize) : NULL;
    if (newSize == 0) {
        free(memory);
    } else if (block == NULL) {
        return NULL;
    }
    p->held += newSize - oldSize;
    p->peak = p->held > p->peak ? p->held : p->peak;
    return block;
}

static vplResult renderWithin(Trial* t, const FloorScene* f, const vplRenderOptions* o, Purse* purse)
{
    vplScene* scene = NULL;
    vplPlan* plan;
    vplImage* image;
    vplResult made = buildFloor(t->context, f, &scene);
    made = made == VPL_SUCCESS ? vplPlan_Create(scene, o, NULL, &plan) : made;
    if (made == VPL_SUCCESS) {
        const double planned = (double)plan->peakBytes;
        vplPlan_Destroy(plan);
        purse->limit = (size_t)fmin(1.15 * planned + FREE_BYTES, 0x1p30);
        purse->peak = purse->held;
        TRY(renderOnce(scene, VPL_SUCCESS, o, &image));
        vplImage_Destroy(image);
        t->error = fmax(0, ((double)purse->peak - FREE_BYTES) / planned - 1);
        return VPL_SUCCESS;
    }
    vplScene_Destroy(scene);
    return made;
}

// Renders square pictures with an allocator whose limit is 1.15 times the planned bytes plus 64 KiB, at most 1 GiB.
static vplResult measureMemory(Trial* t)
{
    FloorScene f = plainFloor();
    Purse purse = {0, 0, SIZE_MAX};
    vplRenderOptions o;
    Trial inner = *t;
    vplContextDef def = t->contextDef;
    f.width = f.height = (int)t->value;
    def.alloc = spend;
    def.allocUser = &purse;
    TRY(chooseOptions(t, f.width, f.height, &o));
    o.path.samples = 1;
    TRY(vplContext_Create(&def, &inner.context));
    const vplResult result = renderWithin(&inner, &f, &o, &purse);
    vplContext_Destroy(inner.context);
    t->error = inner.error;
    return result;
}

// ---- a furnace

static vplResult measureReflectance(Trial* t)
{
    vplRenderOptions o;
    TRY(chooseOptions(t, 8, 8, &o));
    o.lights.areaLightSamples = 1024;
    o.radiosity.rowSums = VPL_ROW_SUMS_NORMALISE; // a furnace is closed
    return compareFurnace(t, t->value, &o);
}

// N is the number of paths per pixel, of first-bounce lights of SSVP, and of patches, up to what takes seconds.
static vplResult measureCount(Trial* t)
{
    vplRenderOptions o;
    const double most = t->method == PATH        ? 1e4
                        : t->method == SSVP      ? 1e5
                        : t->method == RADIOSITY ? 1e3
                                                 : INFINITY;
    TRY(chooseOptions(t, 4, 4, &o));
    if (t->value > most && t->value <= 1e7) {
        t->error = NAN;
        return VPL_SUCCESS;
    }
    int* count = t->method == PATH        ? &o.path.samples
                 : t->method == SSVP      ? &o.ssvp.firstBounce
                 : t->method == RADIOSITY ? &o.radiosity.patches
                                          : &o.particles.count;
    *count = (int)t->value;
    if (count != &o.particles.count) {
        o.lights.areaLightSamples = 1024;
        return compareFurnace(t, 0.3, &o);
    }
    TRY(vplRenderOptions_SetAll(&o,
                                "--light-shadows none --compensation rays --reflectivity 0.3 --batch 65536"));
    return compareFurnace(t, 0.3, &o);
}

// ---- the table

// The bounds of deferred lights and SSVP are larger, because rounding moves texels of maps, samples of the reflective shadow
// map and clusters across a boundary. So are those of radiosity: slivers beside cuts are found lit or not by rounding.
#define ROUNDING 1e-6

const ExtremeSweep EXTREME_SWEEPS[] = {
    {"scale, metres per metre",
     "the room at 1 m",
     {1e-9, 1e-6, 1e-3, 0.1, 10, 1e3, 1e6, 1e9, 1e14},
     9,
     ALL,
     1e-9,
     1e9,
     {[0] = ROUNDING, [SSVP] = 0.01, [RADIOSITY] = 1e-3},
     measureScale},
    {"offset of a scene file, m",
     "the room at (0, 0, 0)",
     {0, 10, 1e3, 1e5, 1e6, 1e7, 1e16},
     7,
     ALL,
     0,
     1e7,
     {[0] = ROUNDING, [DEFERRED] = 1e-3, [SSVP] = 0.01, [RADIOSITY] = 1e-3},
     measureFileOffset},
    {"offset of positions in float, m",
     "the room at (0, 0, 0)",
     {1, 10, 100, 1e3, 1e4, 1e5, 1e7},
     7,
     ALL,
     0,
     100,
     {[0] = 1e-5, [DEFERRED] = 2e-3, [INTERLEAVED] = 1e-4, [SSVP] = 0.01, [RADIOSITY] = 1e-4},
     measureOffset},
    {"far plane / near plane",
     "the room with 1000",
     {1, 100, 1e5, 1e7, 1e9, 1e12},
     6,
     ALL,
     100,
     1e12,
     {ROUNDING},
     measurePlanes},
    {"intensity, W/sr",
     "the room with 10",
     {1e-38, 1e-30, 1e-20, 1e-10, 1e10, 1e15, 2e15, 1e30},
     8,
     ALL,
     1e-30,
     1e15,
     {ROUNDING},
     measureIntensity},
    {"field of view, degrees",
     "closed form",
     {0, 0.01, 0.1, 1, 40, 120, 170, 179, 179.9, 180},
     10,
     ALL,
     0.01,
     179.9,
     {1e-5},
     measureView},
    {"height of the light above a surface, m",
     "closed form",
     {0, 1e-6, 1e-4, 1e-2, 1, 1e2, 1e4, 1e6},
     8,
     ALL,
     0,
     1e6,
     {1e-5},
     measureLightHeight},
    {"angle of the light, degrees",
     "closed form",
     {0, 60, 89, 89.9, 89.99, 89.999, 89.9999},
     7,
     ALL,
     0,
     89.9999,
     {ROUNDING},
     measureGrazing},
    {"texels of maps",
     "closed form (deferred: rays)",
     {0, 1, 2, 16, 128, 1024, 8192, 8193},
     8,
     MAPPED,
     1024,
     8192,
     {[0] = ROUNDING, [DEFERRED] = 0.01, [SSVP] = 0.03},
     measureMaps},
    {"samples of a shadow",
     "a hard shadow",
     {0, 1, 4, 16, 64, 256, 257, 1024},
     8,
     1 << DIRECT_MAP,
     1,
     256,
     {0.05},
     measurePcf},
    {"width of a picture of height 1",
     "closed form",
     {0, 1, 100, 16384, 16385},
     5,
     ALL,
     1,
     16384,
     {ROUNDING},
     measureWidth},
    {"height of a picture of width 1",
     "closed form",
     {0, 1, 100, 16384, 16385},
     5,
     ALL,
     1,
     16384,
     {ROUNDING},
     measureHeight},
    {"side of a square picture: memory",
     "the plan's bytes; at most 1 GiB",
     {1, 64, 1024, 16384},
     4,
     ALL,
     1,
     1024,
     {0.15},
     measureMemory},
    {"reflectance",
     "1 / (1 - rho)",
     {0, 1e-10, 0.5, 0.9, 0.99, 0.999, 1},
     7,
     ALL,
     0,
     0.999,
     {[0] = 0.02, [SSVP] = 0.04},
     measureReflectance},
    {"particles, paths, lights or patches",
     "1 / (1 - rho)",
     {0, 1, 10, 100, 1e3, 1e4, 1e5, 1e6, 1e7, 16777217},
     10,
     COUNTED,
     1,
     1e7,
     {0.1},
     measureCount},
};

const int EXTREME_SWEEP_COUNT = sizeof EXTREME_SWEEPS / sizeof *EXTREME_SWEEPS;
