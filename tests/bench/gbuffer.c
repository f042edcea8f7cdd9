// SPDX-License-Identifier: MIT
// Measures how much time a shared G-buffer saves. Three things are timed in turn: a picture without lights whose triangles are
// rasterized, the same picture from a G-buffer that was kept, and the making of that G-buffer. Both pictures must have the same bits.
// `bench/gbuffer SCENE [WIDTH HEIGHT [SAMPLES [RUNS]]]`; figures are medians.
#include "bench.h"

enum { DRAWN, KEPT, MADE, WAYS };

typedef struct Bench {
    vplContext* context;
    vplScene* scene;
    vplGeometry* geometry;
    vplView view;
    vplShadeDef def;
    vplGbuffer* kept;
    vplImage* images[2];
} Bench;

static vplResult run(void* user, int way)
{
    const Bench* b = user;
    vplShadeDef def = b->def;
    if (way == MADE) {
        vplGbuffer* made;
        const vplResult result = vplGbuffer_Create(b->geometry, &b->view, &def, &made, NULL);
        vplGbuffer_Destroy(result == VPL_SUCCESS ? made : NULL);
        return result;
    }
    def.gbuffer = way == KEPT ? b->kept : NULL;
    return vplShadeView(b->geometry, &b->view, &def, b->images[way], NULL);
}

static void print(const Bench* b, const Times* times, double bytes)
{
    const int width = b->view.width, height = b->view.height;
    printf("%dx%d, %d samples, %.2f triangles for each pixel, G-buffer of %.1f MiB\n", width, height,
           b->def.samples, (double)b->geometry->triangleCount / width / height, bytes / 1048576);
    printf("%-22s %8s %8s\n", "", "cpu ms", "wall ms");
    static const char* const NAMES[WAYS] = {"triangles are drawn", "G-buffer is kept", "making the G-buffer"};
    for (int i = 0; i < WAYS; i++) {
        printf("%-22s %8.2f %8.2f\n", NAMES[i], times[i].cpu, times[i].wall);
    }
    const bool same = vplImage_Hash(b->images[0]) == vplImage_Hash(b->images[1]);
    printf("%s\n", same ? "same bits" : "OTHER BITS");
}

int main(int count, char** words)
{
    Bench b = {.def = vplDefaultShadeDef()};
    Times times[WAYS];
    const int width = count > 3 ? atoi(words[2]) : 320, height = count > 3 ? atoi(words[3]) : 180;
    const int runs = count > 5 ? atoi(words[5]) : 9;
    openScene(count > 1 ? words[1] : "examples/scenes/room.json", 0, VPL_ISA_AUTO, &b.context, &b.scene);
    check(vplGeometry_Create(b.scene, &b.geometry));
    b.view = vplView_Create(vplScene_GetCamera(b.scene, 0), width, height);
    b.def.accumulation = VPL_ACCUMULATE_DEFERRED;
    b.def.emission = true;
    b.def.samples = count > 4 ? atoi(words[4]) : 8;
    check(vplImage_Create(b.context, width, height, &b.images[DRAWN]));
    check(vplImage_Create(b.context, width, height, &b.images[KEPT]));
    const double before = (double)vplContext_GetBytes(b.context);
    check(vplGbuffer_Create(b.geometry, &b.view, &b.def, &b.kept, NULL));
    const double bytes = (double)vplContext_GetBytes(b.context) - before;
    const Measurement measurement = {run, &b, WAYS, runs < 1 ? 1 : runs > MAX_RUNS ? MAX_RUNS : runs, 0, 0};
    check(measureInTurn(&measurement, times, NULL));
    print(&b, times, bytes);
    vplGbuffer_Destroy(b.kept);
    vplImage_Destroy(b.images[DRAWN]);
    vplImage_Destroy(b.images[KEPT]);
    vplGeometry_Destroy(b.geometry);
    vplScene_Destroy(b.scene);
    vplContext_Destroy(b.context);
    return 0;
}
