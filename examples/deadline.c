// SPDX-License-Identifier: MIT
// The best picture at a deadline, in a program that has other work every 16 ms: deadline SCENE PICTURE [MS] renders passes
// for MS milliseconds (default 500) into memory of its own. The library calls `breathe` again and again; an editor would
// handle its window there. When the time is over the render is cancelled and leaves the picture of the passes that are done.
#include <vpl/vpl.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { WIDTH = 160, HEIGHT = 90, FRAME_MS = 16 };

typedef struct Clock {
    double deadline, frame, longest; // ms: end, when the next frame is due, and by how much one was late
    int frames;
} Clock;

static double now(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return 1e3 * (double)time.tv_sec + 1e-6 * (double)time.tv_nsec;
}

static bool breathe(void* user, double fraction)
{
    Clock* clock = user;
    const double time = now();
    (void)fraction;
    if (time >= clock->frame) { // the program's own work
        clock->longest = fmax(clock->longest, time - clock->frame);
        clock->frame = time + FRAME_MS;
        clock->frames++;
    }
    return time < clock->deadline;
}

int main(int count, char** words)
{
    if (count < 3) {
        fprintf(stderr, "usage: deadline SCENE PICTURE [MS]\n");
        return 2;
    }
    vplContextDef def = vplDefaultContextDef();
    def.log = vplLogToStderr;
    vplRenderOptions options = vplDefaultRenderOptions();
    vplContext* context = NULL;
    vplScene* scene = NULL;
    vplImage* image = NULL; // its memory serves as the program's own, because it can write files
    bool done = vplContext_Create(&def, &context) == VPL_SUCCESS &&
                vplScene_Load(context, words[1], &scene) == VPL_SUCCESS &&
                vplImage_Create(context, WIDTH, HEIGHT, &image) == VPL_SUCCESS;
    if (done) {
        const double start = now();
        Clock clock = {start + (count > 3 ? atof(words[3]) : 500), start, 0, 0};
        vplTarget target = {0, vplDefaultPixelsDef()};
        int passes;
        target.pixels.first = image->pixels;
        options.method = VPL_METHOD_KELLER;
        options.output.width = WIDTH;
        options.output.height = HEIGHT;
        options.particles.count = 1000; // of each pass
        options.stop.passes = 10000;    // more than there is time for
        options.progress = breathe;
        options.progressUser = &clock;
        const vplResult result = vplRenderTo(scene, &options, &target, 1, &passes, NULL);
        printf("%.0f ms: %d passes, %d frames, the latest by %.0f ms\n", now() - start, passes, clock.frames,
               clock.longest);
        done = (result == VPL_SUCCESS || passes > 0) && vplImage_Write(image, words[2], NULL) == VPL_SUCCESS;
    }
    vplImage_Destroy(image);
    vplScene_Destroy(scene);
    vplContext_Destroy(context);
    return done ? 0 : 1;
}
