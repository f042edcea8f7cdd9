// SPDX-License-Identifier: MIT
// The sweeps of vpl bench --extremes, and what each promises.
#include "cli/bench/extremes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    DIRECT_MAP,
    DIRECT_RAYS,
    BATCHED,
    DEFERRED,
    INTERLEAVED,
    PATH,
    SSVP,
    RADIOSITY,
    ALL = (1 << METHODS) - 1,
    WITHOUT_PATH = ALL & ~(1 << PATH),
    MAPPED = 1 << DIRECT_MAP | 1 << DEFERRED | 1 << SSVP,
    COUNTED = 1 << BATCHED | 1 << DEFERRED | 1 << INTERLEAVED
};

const Method EXTREME_METHODS[METHODS] = {
    {"direct, map", "--method direct"},
    {"direct, rays", "--method direct --light-shadows ray"},
    {"batched", "--method keller --particles 100 --pipeline batched --light-shadows ray"},
    {"deferred", "--method keller --particles 100 --pipeline deferred --light-shadows map --light-map 64"},
    {"interleaved",
     "--method keller --particles 1000 --pipeline interleaved --interleave 4 --light-shadows ray"},
    {"path", "--method path --spp 4 --pixel centre --max-bounces 8"},
    {"ssvp", "--method ssvp --rsm-size 256"},
    {"radiosity", "--method radiosity --patches 200 --iterations 2000 --residual 1e-6"},
};

// ---- errors

static vplResult chooseOptions(const Trial* t, int width, int height, vplRenderOptions* o)
{
    *o = vplDefaultRenderOptions();
    TRY(vplRenderOptions_SetAll(o, EXTREME_METHODS[t->method].words));
    o->output.antialias = 1;
    o->output.width = width;
    o->output.height = height;
    o->shadow.mapSize = 256;
    return VPL_SUCCESS;
}

// Sums of squares over the red channel.
typedef struct Squares {
    double error, truth;
} Squares;

static void addSquare(Squares* s, double value, double truth)
{
    s->error += (value - truth) * (value - truth);
    s->truth += truth * truth;
}

static double errorOf(const Squares* s)
{
    return s->truth > 0 ? sqrt(s->error / s->truth) : sqrt(s->error);
}

// Renders a scene, which it destroys even if making it failed.
static vplResult render(vplScene* scene, vplResult made, const vplRenderOptions* o, vplImage** imageOut)
{
    const vplResult result = made == VPL_SUCCESS ? vplRender(scene, o, imageOut, NULL) : made;
    vplScene_Destroy(scene);
    return result;
}

static vplResult compareFloor(Trial* t, const FloorScene* f, const vplRenderOptions* o)
{
    vplScene* scene = NULL;
    vplImage* image;
    const vplResult made = buildFloor(t->context, f, &scene);
    TRY(render(scene, made, o, &image));
    Squares s = {0, 0};
    // Path tracing samples a little right of and below the centre; see src/reference/path_scene.c.
    const double shift[2] = {t->method == PATH ? 0.5 + 0x1p-10 : 0.5, t->method == PATH ? 0.5 + 0x1p-12 : 0.5};
    for (int i = 0; i < f->width * f->height; i++) {
        addSquare(&s, (double)image->pixels[3 * (size_t)i], floorRadiance(f, i % f->width + shift[0], i / f->width + shift[1]));
    }
    t->error = errorOf(&s);
    vplImage_Destroy(image);
    return VPL_SUCCESS;
}

enum { ROOM_WIDTH = 32, ROOM_HEIGHT = 24 };

// The error of a picture whose light is `factor` times that of the truth.
static double differenceOf(const vplImage* image, const vplImage* truth, double factor)
{
    Squares s = {0, 0};
    for (int i = 0; i < 3 * truth->width * truth->height; i++) {
        addSquare(&s, (double)image->pixels[i] / factor, (double)truth->pixels[i]);
    }
    return errorOf(&s);
}

// Compares a room with the room at home.
static vplResult compareRoom(Trial* t, const RoomScene* room, vplScene* scene, vplResult made)
{
    vplRenderOptions o;
    vplImage* image;
    const vplResult chosen = chooseOptions(t, ROOM_WIDTH, ROOM_HEIGHT, &o);
    const double w1 = o.ssvp.w1;
    o.ssvp.w1 /= room->scale; // 1/metres
    TRY(render(scene, chosen == VPL_SUCCESS ? made : chosen, &o, &image));
    vplResult result = VPL_SUCCESS;
    if (t->home[t->method] == NULL) {
        vplScene* home = NULL;
        const RoomScene plain = plainRoom();
        const vplResult built = buildRoomAt(t->context, &plain, &home);
        o.ssvp.w1 = w1;
        result = render(home, built, &o, &t->home[t->method]);
    }
    const double factor = (double)(float)room->intensity / 10 / (room->scale * room->scale);
    if (result == VPL_SUCCESS) {
        t->error = differenceOf(image, t->home[t->method], factor);
    }
    vplImage_Destroy(image);
    return result;
}

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

// The light is 2 m from the middle of a picture 1 cm wide.
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
    f.light[2] = -0.04;
    f.eyeHeight = 1;
    f.blocker = 0.09;
    f.width = f.height = 96;
    return f;
}

// The maps of emitters, of which direct light's and SSVP's show the shadow of the square; of virtual lights the
// error is that against rays, in the room.
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
    TRY(render(scene, made, &o, &mapped));
    o.lights.shadows = VPL_LIGHT_SHADOWS_RAY;
    o.lights.mapSize = 1;
    scene = NULL;
    made = buildRoomAt(t->context, &room, &scene);
    const vplResult result = render(scene, made, &o, &traced);
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

// Pictures as wide as the value says, its digits before the point, and as high as those behind it say.
static vplResult measureSize(Trial* t)
{
    FloorScene f = plainFloor();
    vplRenderOptions o;
    f.width = (int)t->value;
    f.height = (int)lround((t->value - f.width) * 1e5);
    f.fov = f.width > f.height ? 0.0001 : f.fov;
    TRY(chooseOptions(t, f.width, f.height, &o));
    return compareFloor(t, &f, &o);
}

// ---- memory

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
        purse->limit = (size_t)fmin(1.15 * planned + 65536, 0x1p30);
        purse->peak = purse->held;
        TRY(render(scene, VPL_SUCCESS, o, &image));
        vplImage_Destroy(image);
        t->error = fmax(0, (double)purse->peak / planned - 1);
        return VPL_SUCCESS;
    }
    vplScene_Destroy(scene);
    return made;
}

// Square pictures with an allocator that refuses what exceeds the plan by 15 % and 64 KiB, and 1 GiB.
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

// Compares means, because single points of lights in corners are far off.
static vplResult compareFurnace(Trial* t, double rho, const vplRenderOptions* o)
{
    vplScene* scene = NULL;
    vplImage* image;
    const vplResult made = buildFurnace(t->context, rho, &scene);
    TRY(render(scene, made, o, &image));
    double wanted = 0, mean = 0, power = 1;
    const int terms = t->method == DIRECT_MAP || t->method == DIRECT_RAYS ? 2
                      : t->method == SSVP                                 ? 4
                      : t->method == PATH                                 ? 10
                                                                          : 4000; // bounces that are rendered
    for (int k = 0; k < terms; k++, power *= rho) {
        wanted += power;
    }
    const int count = image->width * image->height;
    for (int i = 0; i < count; i++) {
        mean += (double)image->pixels[3 * i] / count;
    }
    t->error = fabs(mean / wanted - 1);
    vplImage_Destroy(image);
    return VPL_SUCCESS;
}

static vplResult measureReflectance(Trial* t)
{
    vplRenderOptions o;
    TRY(chooseOptions(t, 8, 8, &o));
    o.lights.areaLightSamples = 1024;
    return compareFurnace(t, t->value, &o);
}

static vplResult measureCount(Trial* t)
{
    vplRenderOptions o;
    TRY(chooseOptions(t, 4, 4, &o));
    TRY(vplRenderOptions_SetAll(&o,
                                "--light-shadows none --compensation rays --reflectivity 0.3 --batch 65536"));
    o.particles.count = (int)t->value;
    return compareFurnace(t, 0.3, &o);
}

// ---- the table

const ExtremeSweep EXTREME_SWEEPS[] = {
    {"scale, metres per metre",
     "the room at 1 m",
     {1e-9, 1e-6, 1e-3, 0.1, 10, 1e3, 1e6, 1e9, 1e14},
     9,
     ALL,
     1e-9,
     1e9,
     {1},
     measureScale},
    {"offset of a scene file, m",
     "the room at (0, 0, 0)",
     {0, 10, 1e3, 1e5, 1e6, 1e7, 1e16}, 7,
     ALL,
     0,
     1e7,
     {1},
     measureFileOffset},
    {"offset of positions in float, m",
     "the room at (0, 0, 0)",
     {1, 10, 100, 1e3, 1e4, 1e5, 1e7},
     7,
     ALL,
     0,
     100,
     {1},
     measureOffset},
    {"far plane / near plane",
     "the room with 1000",
     {1, 100, 1e5, 1e7, 1e9, 1e12}, 6,
     ALL,
     100,
     1e9,
     {1},
     measurePlanes},
    {"intensity",
     "the room with 10",
     {1e-38, 1e-30, 1e-20, 1e-10, 1e10, 1e14, 1e15, 1e30}, 8,
     ALL,
     1e-30,
     1e14,
     {1},
     measureIntensity},
    {"field of view, degrees",
     "closed form",
     {0, 0.01, 0.1, 1, 40, 120, 170, 179, 179.9, 180},
     10,
     ALL,
     0.01,
     179.9,
     {1},
     measureView},
    {"height of the light, m",
     "closed form",
     {0, 1e-6, 1e-4, 1e-2, 1, 1e2, 1e4, 1e6},
     8,
     ALL,
     1e-6,
     1e6,
     {1},
     measureLightHeight},
    {"angle of the light, degrees",
     "closed form",
     {0, 60, 89, 89.9, 89.99, 89.999, 89.9999},
     7,
     ALL,
     0,
     89.9999,
     {1},
     measureGrazing},
    {"texels of maps",
     "closed form",
     {0, 1, 2, 16, 128, 1024, 8192, 8193},
     8,
     MAPPED,
     1,
     8192,
     {1},
     measureMaps},
    {"samples of a shadow",
     "closed form",
     {0, 1, 4, 16, 64, 256, 257, 1024},
     8,
     1 << DIRECT_MAP,
     1,
     256,
     {1},
     measurePcf},
    {"picture: width.height",
     "closed form",
     {1.00001, 16384.00001, 1.16384, 16385.00001},
     4,
     ALL,
     1,
     16384.5,
     {1},
     measureSize},
    {"side of a picture and its memory",
     "the plan's memory",
     {1, 64, 1024, 16384, 16385},
     5,
     ALL,
     1,
     1024,
     {0.15},
     measureMemory},
    {"reflectance",
     "1 / (1 - rho)",
     {0, 1e-10, 0.5, 0.9, 0.99, 0.999, 1},
     7,
     WITHOUT_PATH | 1 << PATH,
     0,
     0.99,
     {1},
     measureReflectance},
    {"particles",
     "1 / (1 - rho)",
     {0, 1, 10, 100, 1e3, 1e4, 1e5, 1e6, 1e7, 16777217},
     10,
     COUNTED,
     1,
     1e7,
     {1},
     measureCount},
};

const int EXTREME_SWEEP_COUNT = sizeof EXTREME_SWEEPS / sizeof *EXTREME_SWEEPS;
