// SPDX-License-Identifier: MIT
// bench/edits SCENE [METHOD [RUNS]]: a scene is edited and rendered again, with a history and anew in turn: medians of
// processor time of the geometry alone, by vplGeometry_Update and vplGeometry_Create, and of whole renders. A box is added in
// the middle of the scene; it is what is moved and recoloured. The pictures must have the same bits.
#include "bench.h"

#include <math.h>
#include <string.h>

enum { MOST_RUNS = 101 };

typedef enum Edit { NOTHING, MOVE, MOVE_AWAY, COLOUR, COLOUR_ALL, LAMP, CAMERA, EDITS } Edit;

static const char* const NAMES[EDITS] = {"nothing",     "move an object", "move it far", "an object's colour",
                                         "all colours", "a lamp",         "the camera"};

typedef struct Bench {
    vplScene* scene;
    vplGeometry* geometry; // that follows the edits
    vplHistory* history;
    vplRenderOptions options;
    int box;
    vplVec3 place; // of the box
    float size;    // of the scene, metres
} Bench;

static void addBox(Bench* b)
{
    vplMaterialDef material = vplDefaultMaterialDef();
    vplObjectDef object = vplDefaultObjectDef();
    vplGeometry* g;
    check(vplGeometry_CreateForRaster(b->scene, &g));
    b->place = (vplVec3){0.5f * (g->boundsMin.x + g->boundsMax.x), 0.5f * (g->boundsMin.y + g->boundsMax.y),
                         0.5f * (g->boundsMin.z + g->boundsMax.z)};
    b->size = vplGeometry_Diagonal(g);
    vplGeometry_Destroy(g);
    check(vplScene_AddMaterial(b->scene, &material, &object.material));
    object.type = VPL_OBJECT_BOX;
    check(vplScene_AddObject(b->scene, &object, &b->box));
}

static void moveBox(const Bench* b, float share)
{
    const double turn[3] = {0, 0.3, 0};
    const float side = 0.05f * b->size;
    const vplVec3 at = {b->place.x + share * b->size, b->place.y, b->place.z};
    const vplMat4 transform = vplMat4_FromParts(at, turn, (vplVec3){side, side, side});
    check(vplScene_SetTransform(b->scene, b->box, &transform));
}

static void recolour(const Bench* b, int material, float red)
{
    vplMaterialDef def = *vplScene_GetMaterial(b->scene, material);
    def.diffuse.r = red;
    check(vplScene_SetMaterial(b->scene, material, &def));
}

static void moveLamp(const Bench* b, float share)
{
    if (vplScene_GetEmitterCount(b->scene) > 0) {
        vplEmitterDef def = *vplScene_GetEmitter(b->scene, 0);
        def.intensity.r *= 1 + share;
        check(vplScene_SetEmitter(b->scene, 0, &def));
    }
}

static void turnCamera(const Bench* b, float share)
{
    vplCameraDef def = *vplScene_GetCamera(b->scene, 0);
    def.fovY *= 1 + (double)share;
    check(vplScene_SetCamera(b->scene, 0, &def));
}

// Edit number `step` differs from the one before.
static void edit(const Bench* b, Edit what, int step)
{
    const float share = 0.01f * (float)(step % 7 + 1) * (step % 2 == 0 ? 1 : -1);
    switch (what) {
    case MOVE:
        moveBox(b, share);
        break;
    case MOVE_AWAY:
        moveBox(b, 6 * share);
        break;
    case COLOUR:
        recolour(b, vplScene_GetObject(b->scene, b->box)->material, 0.5f + share);
        break;
    case COLOUR_ALL:
        for (int i = 0; i < vplScene_GetMaterialCount(b->scene); i++) {
            recolour(b, i, 0.5f + share);
        }
        break;
    case LAMP:
        moveLamp(b, share);
        break;
    case CAMERA:
        turnCamera(b, share);
        break;
    default:
        break;
    }
}

// ---- measuring

static double updateGeometry(const Bench* b)
{
    const double start = cpuMs();
    check(vplGeometry_Update(b->geometry, b->scene));
    return cpuMs() - start;
}

static double createGeometry(const Bench* b)
{
    vplGeometry* g;
    const double start = cpuMs();
    check(vplGeometry_Create(b->scene, &g));
    const double ms = cpuMs() - start;
    vplGeometry_Destroy(g);
    return ms;
}

static double render(const Bench* b, vplHistory* history, uint64_t* hashOut)
{
    vplRenderOptions options = b->options;
    vplImage* image;
    const double start = cpuMs();
    options.sequence.history = history;
    check(vplRender(b->scene, &options, &image, NULL));
    const double ms = cpuMs() - start;
    *hashOut = vplImage_Hash(image);
    vplImage_Destroy(image);
    return ms;
}

static void measure(const Bench* b, Edit what, int runs)
{
    static double times[4][MOST_RUNS];
    bool same = true;
    for (int i = 0; i < runs; i++) {
        uint64_t edited, anew;
        edit(b, what, i);
        times[0][i] = updateGeometry(b);
        times[1][i] = createGeometry(b);
        times[2][i] = render(b, b->history, &edited);
        times[3][i] = render(b, NULL, &anew);
        same = same && edited == anew;
    }
    printf("  %-20s %9.2f %9.2f %9.1f %9.1f  %s\n", NAMES[what], medianOf(times[0], runs),
           medianOf(times[1], runs), medianOf(times[2], runs), medianOf(times[3], runs),
           same ? "same bits" : "OTHER BITS");
    fflush(stdout);
}

int main(int count, char** words)
{
    const int runs = count > 3 ? atoi(words[3]) : 7;
    Bench b = {.options = plainOptions()};
    vplContext* context;
    uint64_t hash;
    if (count < 2 || runs < 1 || runs > MOST_RUNS) {
        fprintf(stderr, "usage: edits SCENE [METHOD [RUNS]]\n");
        return 2;
    }
    openScene(words[1], 0, VPL_ISA_AUTO, &context, &b.scene);
    check(vplRenderOptions_Set(&b.options, "method", count > 2 ? words[2] : "instant-radiosity"));
    b.options.output.width = 320;
    b.options.output.height = 180;
    addBox(&b);
    moveBox(&b, 0);
    check(vplGeometry_Create(b.scene, &b.geometry));
    check(vplHistory_Create(context, &b.history));
    render(&b, b.history, &hash);
    printf("%s, %d triangles, processor ms: geometry followed, anew; picture with history, anew\n", words[1],
           b.geometry->triangleCount);
    for (Edit what = NOTHING; what < EDITS; what++) {
        measure(&b, what, runs);
    }
    vplHistory_Destroy(b.history);
    vplGeometry_Destroy(b.geometry);
    vplScene_Destroy(b.scene);
    vplContext_Destroy(context);
    return 0;
}
