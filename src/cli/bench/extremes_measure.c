// SPDX-License-Identifier: MIT
// What each sweep of vpl bench --extremes measures.
#include "cli/bench/extremes.h"

#include <math.h>
#include <stdlib.h>

static vplResult measureRoom(Trial* t, const RoomScene* room)
{
    vplScene* scene = NULL;
    const vplResult made = buildRoomAt(t->context, room, &scene);
    return compareRoom(t, room, scene, made);
}

// ---- the same room elsewhere

vplResult measureScale(Trial* t)
{
    RoomScene room = plainRoom();
    room.scale = t->value;
    room.intensity = fmin(10 * t->value * t->value, 1e14);
    return measureRoom(t, &room);
}

vplResult measurePlanes(Trial* t)
{
    RoomScene room = plainRoom();
    room.farOverNear = t->value;
    return measureRoom(t, &room);
}

vplResult measureIntensity(Trial* t)
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

vplResult measureOffset(Trial* t)
{
    const RoomScene room = movedRoom(t->value);
    return measureRoom(t, &room);
}

vplResult measureFileOffset(Trial* t)
{
    const RoomScene room = movedRoom(t->value);
    vplScene* scene = NULL;
    const vplResult made = loadRoomAt(t->context, &room, &scene);
    return compareRoom(t, &room, scene, made);
}

// ---- a floor under a point light

vplResult measureView(Trial* t)
{
    FloorScene f = plainFloor();
    vplRenderOptions o;
    f.fov = t->value * VPL_PI / 180;
    f.size = fmax(10, 3 * f.eyeHeight * tan(fmin(f.fov, 3.14) / 2));
    TRY(chooseOptions(t, f.width, f.height, &o));
    return compareFloor(t, &f, &o);
}

vplResult measureLightHeight(Trial* t)
{
    FloorScene f = plainFloor();
    vplRenderOptions o;
    f.light[1] = t->value;
    f.intensity = fmax(1, t->value * t->value);
    TRY(chooseOptions(t, f.width, f.height, &o));
    return compareFloor(t, &f, &o);
}

// The light is 2 m from the middle of the picture, which shows 1 cm of the floor.
vplResult measureGrazing(Trial* t)
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
vplResult measureMaps(Trial* t)
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

vplResult measurePcf(Trial* t)
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

vplResult measureWidth(Trial* t)
{
    return measureSize(t, (int)t->value, 1);
}

vplResult measureHeight(Trial* t)
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
vplResult measureMemory(Trial* t)
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

static const double FURNACE_VIEW = 70 * VPL_PI / 180; // radians

static vplResult measureFurnace(Trial* t, double rho, double fov, int width, int height)
{
    vplRenderOptions o;
    TRY(chooseOptions(t, width, height, &o));
    o.lights.areaLightSamples = (int64_t)width * height > 64 ? 64 : 1024;
    o.radiosity.rowSums = VPL_ROW_SUMS_NORMALISE; // a furnace is closed
    return compareFurnace(t, rho, fov, &o);
}

vplResult measureReflectance(Trial* t)
{
    return measureFurnace(t, t->value, FURNACE_VIEW, 8, 8);
}

// Half of the light of these is indirect, which a floor alone does not have.
vplResult measureFurnaceView(Trial* t)
{
    return measureFurnace(t, 0.5, t->value * VPL_PI / 180, 8, 8);
}

vplResult measureFurnaceWidth(Trial* t)
{
    return measureFurnace(t, 0.5, FURNACE_VIEW, (int)t->value, 1);
}

vplResult measureFurnaceHeight(Trial* t)
{
    return measureFurnace(t, 0.5, FURNACE_VIEW, 1, (int)t->value);
}

// The largest number of the sweep of counts that takes seconds.
static double mostCounted(int method)
{
    return method == PATH || method == MULTIPASS ? 1e4
           : method == SSVP                      ? 1e5
           : method == LIGHTCUTS                 ? 1e6
           : hasPatches(method)                  ? 1e3
                                                 : INFINITY;
}

// N is the number of paths per pixel, of first-bounce lights of SSVP, of patches, or of particles.
vplResult measureCount(Trial* t)
{
    vplRenderOptions o;
    TRY(chooseOptions(t, 4, 4, &o));
    if (t->value > mostCounted(t->method) && t->value <= 1e7) {
        t->leftOut = "left out: takes more than a minute";
        return VPL_SUCCESS;
    }
    int* count = t->method == PATH       ? &o.path.samples
                 : t->method == SSVP     ? &o.ssvp.firstBounce
                 : hasPatches(t->method) ? &o.radiosity.patches
                                         : &o.particles.count;
    *count = (int)t->value;
    if (count != &o.particles.count) {
        o.lights.areaLightSamples = 1024;
        return compareFurnace(t, 0.3, FURNACE_VIEW, &o);
    }
    TRY(vplRenderOptions_SetAll(&o,
                                "--light-shadows none --compensation rays --reflectivity 0.3 --batch 65536"));
    return compareFurnace(t, 0.3, FURNACE_VIEW, &o);
}
