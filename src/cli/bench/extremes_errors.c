// SPDX-License-Identifier: MIT
// Errors of pictures for vpl bench --extremes: against closed forms, and against the same room at home.
#include "cli/bench/extremes.h"

#include <math.h>

#define SOLVED " --iterations 2000 --residual 1e-6"

const Method EXTREME_METHODS[METHODS] = {
    {"direct, map", "--method direct"},
    {"direct, rays", "--method direct --light-shadows ray"},
    {"multipass", "--method instant-radiosity --particles 100 --reflectivity auto --pipeline multipass "
                  "--light-shadows ray"},
    {"batched", "--method keller --particles 100 --pipeline batched --light-shadows ray"},
    {"deferred", "--method keller --particles 100 --pipeline deferred --light-shadows map --light-map 64"},
    {"interleaved",
     "--method keller --particles 1000 --pipeline interleaved --interleave 4 --light-shadows ray"},
    {"lightcuts", "--method keller --particles 1000 --pipeline lightcuts --light-shadows ray"},
    {"path", "--method path --spp 4 --pixel centre --max-bounces 8"},
    // As the document has it. By default rounding exchanges chosen lights: the room at other scales differs by 3 %.
    {"ssvp",
     "--method ssvp --rsm-size 256 --next-bounce maps --max-bounces 2 --max-clusters 8 --paraboloid 128"},
    {"radiosity", "--method radiosity --patches 200 --hierarchy off --gather 0" SOLVED},
    {"links", "--method radiosity --patches 200 --hierarchy on --gather 0" SOLVED},
    {"gather", "--method radiosity --patches 200 --hierarchy off --gather 16 --interleave 1" SOLVED},
    {"adaptive",
     "--method radiosity --patches 200 --patch-placement adaptive --hierarchy off --gather 0" SOLVED},
    {"auto", "--method auto" SOLVED},
};

bool hasPatches(int method)
{
    return method == RADIOSITY || method == LINKS || method == GATHER || method == ADAPTIVE;
}

// ---- errors

vplResult chooseOptions(const Trial* t, int width, int height, vplRenderOptions* o)
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

vplResult renderOnce(vplScene* scene, vplResult made, const vplRenderOptions* o, vplImage** imageOut)
{
    const vplResult result = made == VPL_SUCCESS ? vplRender(scene, o, imageOut, NULL) : made;
    vplScene_Destroy(scene);
    return result;
}

vplResult compareFloor(Trial* t, const FloorScene* f, const vplRenderOptions* o)
{
    vplScene* scene = NULL;
    vplImage* image;
    const vplResult made = buildFloor(t->context, f, &scene);
    TRY(renderOnce(scene, made, o, &image));
    Squares s = {0, 0};
    // Path tracing samples a little right of and below the centre; see src/reference/path_scene.c.
    const double shift[2] = {t->method == PATH ? 0.5 + 0x1p-10 : 0.5,
                             t->method == PATH ? 0.5 + 0x1p-12 : 0.5};
    for (int i = 0; i < f->width * f->height; i++) {
        addSquare(&s, (double)image->pixels[3 * (size_t)i],
                  floorRadiance(f, i % f->width + shift[0], i / f->width + shift[1]));
    }
    t->error = errorOf(&s);
    vplImage_Destroy(image);
    return VPL_SUCCESS;
}

double differenceOf(const vplImage* image, const vplImage* truth, double factor)
{
    Squares s = {0, 0};
    for (int i = 0; i < 3 * truth->width * truth->height; i++) {
        addSquare(&s, (double)image->pixels[i] / factor, (double)truth->pixels[i]);
    }
    return errorOf(&s);
}

vplResult compareRoom(Trial* t, const RoomScene* room, vplScene* scene, vplResult made)
{
    vplRenderOptions o;
    vplImage* image;
    const vplResult chosen = chooseOptions(t, ROOM_WIDTH, ROOM_HEIGHT, &o);
    const double w1 = o.ssvp.w1;
    if (t->method == SSVP) {      // auto chooses SSVP where it is set
        o.ssvp.w1 /= room->scale; // 1/metres
    }
    TRY(renderOnce(scene, chosen == VPL_SUCCESS ? made : chosen, &o, &image));
    vplResult result = VPL_SUCCESS;
    if (t->home[t->method] == NULL) {
        vplScene* home = NULL;
        const RoomScene plain = plainRoom();
        const vplResult built = buildRoomAt(t->context, &plain, &home);
        o.ssvp.w1 = w1;
        result = renderOnce(home, built, &o, &t->home[t->method]);
    }
    const double factor = (double)(float)room->intensity / 10 / (room->scale * room->scale);
    if (result == VPL_SUCCESS) {
        t->error = differenceOf(image, t->home[t->method], factor);
    }
    vplImage_Destroy(image);
    return result;
}

// ---- a furnace

// Compares the mean radiance: at pixels in corners a few samples of the area lights are far off.
vplResult compareFurnace(Trial* t, double rho, double fov, const vplRenderOptions* o)
{
    vplScene* scene = NULL;
    vplImage* image;
    const vplResult made = buildFurnace(t->context, rho, fov, &scene);
    TRY(renderOnce(scene, made, o, &image));
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
