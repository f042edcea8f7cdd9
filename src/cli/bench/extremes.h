// SPDX-License-Identifier: MIT
// vpl bench --extremes: the error of every method at the ends of what scenes and options may be.
#ifndef VPL_CLI_BENCH_EXTREMES_H
#define VPL_CLI_BENCH_EXTREMES_H

#include "cli/cli.h"

enum { MOST_VALUES = 12 };

enum {
    DIRECT_MAP,
    DIRECT_RAYS,
    MULTIPASS,
    BATCHED,
    DEFERRED,
    INTERLEAVED,
    LIGHTCUTS,
    PATH,
    SSVP,
    RADIOSITY,
    LINKS,
    GATHER,
    ADAPTIVE,
    AUTO,
    METHODS
};

// A method with the settings of the table.
typedef struct Method {
    const char* name;
    const char* words; // as on the command line
} Method;

extern const Method EXTREME_METHODS[METHODS];

typedef struct Trial Trial;

// A sweep: the values of one quantity, the function that measures the error at each, and the promised error.
typedef struct ExtremeSweep {
    const char* name;
    const char* truth; // what pictures are compared with
    double values[MOST_VALUES];
    int valueCount;
    int methods;            // bits
    const char* others;     // why the other methods have no column; NULL: all have
    double low, high;       // promised range of values
    double bounds[METHODS]; // promised error; 0: as the first's
    vplResult (*measure)(Trial* trial);
} ExtremeSweep;

extern const ExtremeSweep EXTREME_SWEEPS[];
extern const int EXTREME_SWEEP_COUNT;

// One cell of the table.
struct Trial {
    vplContext* context;
    vplContextDef contextDef; // of the context
    const ExtremeSweep* sweep;
    double value;
    int method;
    vplImage** home;     // pictures by method that scenes in other units are compared with; made when needed
    double error;        // root mean square of the picture's error over that of the truth
    const char* leftOut; // why there is no error; NULL: there is
};

// ---- extremes_scenes.c

#define EXTREME_FILE "/tmp/vpl-extremes-" // start of the names of temporary files

// A floor below a point light, seen from above; a square may cast its shadow on it. Metres, radians.
typedef struct FloorScene {
    double light[3], intensity;
    double eyeHeight, fov, nearPlane;
    double size;    // of the floor
    double blocker; // side of a square at y = 1.5 under the light; 0: none
    int width, height;
} FloorScene;

FloorScene plainFloor(void);
vplResult buildFloor(vplContext* context, const FloorScene* floor, vplScene** sceneOut);

// Returns the exact reflected radiance at a point of the picture, whose position is in pixels.
double floorRadiance(const FloorScene* floor, double column, double row);

// A closed room with a box and a point light.
typedef struct RoomScene {
    double scale;     // metres per metre
    double offset[3]; // metres, after scaling
    double farOverNear;
    double intensity; // W/sr
} RoomScene;

RoomScene plainRoom(void);
vplResult buildRoomAt(vplContext* context, const RoomScene* room, vplScene** sceneOut);

// Builds the same room by loading a scene file.
vplResult loadRoomAt(vplContext* context, const RoomScene* room, vplScene** sceneOut);

// A cube whose walls reflect rho and emit 1, seen with a field of view in radians.
vplResult buildFurnace(vplContext* context, double rho, double fov, vplScene** sceneOut);

// ---- extremes_errors.c

enum { ROOM_WIDTH = 32, ROOM_HEIGHT = 24 };

// The settings of the trial's method.
vplResult chooseOptions(const Trial* trial, int width, int height, vplRenderOptions* options);

// Renders a scene, which it destroys even if making it failed.
vplResult renderOnce(vplScene* scene, vplResult made, const vplRenderOptions* options, vplImage** imageOut);

// Returns the relative rmse of a picture that was rendered with `factor` times the light of the truth.
double differenceOf(const vplImage* image, const vplImage* truth, double factor);

// Set trial->error.
vplResult compareFloor(Trial* trial, const FloorScene* floor, const vplRenderOptions* options);
vplResult compareFurnace(Trial* trial, double rho, double fov, const vplRenderOptions* options);

// True for the methods whose light is exchanged by patches.
bool hasPatches(int method);

// Compares a room with the room at home; destroys the scene.
vplResult compareRoom(Trial* trial, const RoomScene* room, vplScene* scene, vplResult made);

// ---- extremes_measure.c

// Measure the trial's value with its method: set trial->error or trial->leftOut.
vplResult measureScale(Trial* trial);
vplResult measureFileOffset(Trial* trial);
vplResult measureOffset(Trial* trial);
vplResult measurePlanes(Trial* trial);
vplResult measureIntensity(Trial* trial);
vplResult measureView(Trial* trial);
vplResult measureLightHeight(Trial* trial);
vplResult measureGrazing(Trial* trial);
vplResult measureMaps(Trial* trial);
vplResult measurePcf(Trial* trial);
vplResult measureWidth(Trial* trial);
vplResult measureHeight(Trial* trial);
vplResult measureMemory(Trial* trial);
vplResult measureReflectance(Trial* trial);
vplResult measureFurnaceView(Trial* trial);
vplResult measureFurnaceWidth(Trial* trial);
vplResult measureFurnaceHeight(Trial* trial);
vplResult measureCount(Trial* trial);

#endif
