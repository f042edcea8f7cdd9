// SPDX-License-Identifier: MIT
// A walk through a scene in the terminal: interactive SCENE. w a s d move the camera, arrow keys or h j k l turn it, q ends.
// While no key is pressed the picture is refined, pass by pass. Each character shows two pixels, in 24-bit colours. Where
// standard input is no terminal the keys are read to their end and the last picture is printed.
#define _POSIX_C_SOURCE 200809L
#include <vpl/vpl.h>

#include <math.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

enum { LARGEST = 200, MOST_PASSES = 64 };

static struct termios terminalBefore;

static void leaveTerminal(void)
{
    tcsetattr(STDIN_FILENO, TCSANOW, &terminalBefore);
    fputs("\033[?25h\033[0m\n", stdout);
}

// Keys come at once and are not shown.
static void enterTerminal(void)
{
    if (tcgetattr(STDIN_FILENO, &terminalBefore) == 0) {
        struct termios raw = terminalBefore;
        raw.c_lflag &= (tcflag_t) ~(ICANON | ECHO);
        tcsetattr(STDIN_FILENO, TCSANOW, &raw);
        atexit(leaveTerminal);
        fputs("\033[?25l\033[2J", stdout);
    }
}

// True if a key waits to be read, or input has ended.
static bool keyWaits(void)
{
    struct pollfd in = {.fd = STDIN_FILENO, .events = POLLIN};
    return poll(&in, 1, 0) > 0;
}

// A key ends the pass under way.
static bool noKey(void* user, double fraction)
{
    (void)user;
    (void)fraction;
    return !keyWaits();
}

// The next key; arrows become h j k l; 0 at the end of input.
static char readKey(void)
{
    char key = 0;
    char arrow[2];
    if (read(STDIN_FILENO, &key, 1) != 1) {
        return 0;
    }
    if (key == 27 && keyWaits() && read(STDIN_FILENO, arrow, 2) == 2 && arrow[0] == '[' && arrow[1] >= 'A' &&
        arrow[1] <= 'D') {
        key = "kjlh"[arrow[1] - 'A'];
    }
    return key;
}

static double along(vplVec3 from, vplVec3 to, int axis)
{
    const float d[3] = {to.x - from.x, to.y - from.y, to.z - from.z};
    return (double)d[axis];
}

// Moves by a step, or turns by five degrees about the vertical or up and down.
static void moveCamera(vplCameraDef* c, char key)
{
    double d[3] = {along(c->eye, c->target, 0), along(c->eye, c->target, 1), along(c->eye, c->target, 2)};
    const double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    double yaw = atan2(d[0], -d[2]), pitch = asin(d[1] / length);
    const double step = 0.05 * length, turn = VPL_PI / 36;
    double ahead = key == 'w'   ? step
                   : key == 's' ? -step
                                : 0,
           right = key == 'd'   ? step
                   : key == 'a' ? -step
                                : 0;
    yaw += key == 'l' ? turn : key == 'h' ? -turn : 0;
    pitch += key == 'k' ? turn : key == 'j' ? -turn : 0;
    pitch = fmin(1.5, fmax(-1.5, pitch));
    c->eye.x += (float)(ahead * sin(yaw) + right * cos(yaw));
    c->eye.z += (float)(-ahead * cos(yaw) + right * sin(yaw));
    c->target.x = c->eye.x + (float)(length * cos(pitch) * sin(yaw));
    c->target.y = c->eye.y + (float)(length * sin(pitch));
    c->target.z = c->eye.z - (float)(length * cos(pitch) * cos(yaw));
}

// Two rows of pixels are one row of text: "upper half block" has the upper pixel as its colour.
static vplResult show(const vplImage* image, int passes, bool home)
{
    static unsigned char codes[LARGEST][LARGEST][3];
    vplPixelsDef pixels = vplDefaultPixelsDef();
    pixels.first = codes;
    pixels.format = VPL_PIXELS_RGB_SRGB8;
    pixels.rowStride = (ptrdiff_t)sizeof codes[0];
    pixels.exposure = VPL_EXPOSURE_AUTO;
    pixels.tonemap = VPL_TONEMAP_AGX;
    const vplResult result = vplImage_CopyTo(image, &pixels);
    if (result == VPL_SUCCESS) {
        fputs(home ? "\033[H" : "", stdout);
        for (int y = 0; y + 1 < image->height; y += 2) {
            for (int x = 0; x < image->width; x++) {
                const unsigned char *a = codes[y][x], *b = codes[y + 1][x];
                printf("\033[38;2;%d;%d;%d;48;2;%d;%d;%dm\xE2\x96\x80", a[0], a[1], a[2], b[0], b[1], b[2]);
            }
            fputs("\033[0m\n", stdout);
        }
        printf("%d passes; w a s d, arrows, q   ", passes);
        fflush(stdout);
    }
    return result;
}

// Refines the picture of a view until a key is pressed.
static vplResult refine(const vplScene* scene, const vplRenderOptions* options, bool live)
{
    vplRenderer* renderer;
    vplResult result = vplRenderer_Create(scene, options, &renderer);
    if (result != VPL_SUCCESS) {
        return result == VPL_CANCELLED ? VPL_SUCCESS : result;
    }
    for (bool done = false; result == VPL_SUCCESS && !done && !(live && keyWaits());) {
        result = vplRenderer_Step(renderer, &done);
        vplImage* image = NULL;
        if (result == VPL_SUCCESS && (live || done)) {
            result = vplRenderer_GetImage(renderer, &image, NULL);
        }
        if (image != NULL) {
            result = show(image, vplRenderer_GetPassCount(renderer), live);
            vplImage_Destroy(image);
        }
    }
    vplRenderer_Destroy(renderer);
    return result == VPL_CANCELLED ? VPL_SUCCESS : result;
}

static vplResult walk(const vplScene* scene, vplRenderOptions* options)
{
    vplCameraDef camera = *vplScene_GetCamera(scene, 0);
    const bool live = isatty(STDIN_FILENO) && isatty(STDOUT_FILENO);
    struct winsize window = {.ws_col = 80, .ws_row = 24};
    vplHistory* history = NULL; // geometry and whatever the next view needs, too
    vplResult result = vplHistory_Create(vplScene_GetContext(scene), &history);
    if (live) {
        ioctl(STDOUT_FILENO, TIOCGWINSZ, &window);
        enterTerminal();
    }
    if (window.ws_col == 0 || window.ws_row < 4) { // some terminals do not say
        window = (struct winsize){.ws_col = 80, .ws_row = 24};
    }
    options->output.width = window.ws_col < LARGEST ? window.ws_col : LARGEST;
    options->output.height = 2 * (window.ws_row - 2) < LARGEST ? 2 * (window.ws_row - 2) : LARGEST;
    options->view = &camera;
    options->sequence.history = history;
    options->progress = live ? noKey : NULL;
    for (char key = ' '; result == VPL_SUCCESS && key != 'q' && key != 0;) {
        if (live) {
            result = refine(scene, options, true);
        }
        key = readKey();
        moveCamera(&camera, key);
    }
    if (result == VPL_SUCCESS && !live) {
        result = refine(scene, options, false);
    }
    vplHistory_Destroy(history);
    return result;
}

int main(int count, char** words)
{
    if (count != 2) {
        fprintf(stderr, "usage: interactive SCENE\n");
        return 2;
    }
    vplContextDef def = vplDefaultContextDef();
    def.log = vplLogToStderr;
    vplRenderOptions options = vplDefaultRenderOptions();
    options.method = VPL_METHOD_KELLER;
    options.particles.count = 1000; // of each pass
    options.stop.passes = MOST_PASSES;
    vplContext* context = NULL;
    vplScene* scene = NULL;
    bool done = vplContext_Create(&def, &context) == VPL_SUCCESS &&
                vplScene_Load(context, words[1], &scene) == VPL_SUCCESS;
    if (done && vplScene_GetCameraCount(scene) == 0) {
        fprintf(stderr, "%s has no camera\n", words[1]);
        done = false;
    }
    done = done && walk(scene, &options) == VPL_SUCCESS;
    vplScene_Destroy(scene);
    vplContext_Destroy(context);
    return done ? 0 : 1;
}
