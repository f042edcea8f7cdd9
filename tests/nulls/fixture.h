// SPDX-License-Identifier: MIT
// One valid value of every type that public functions take, for the calls that tests/nulls/generate.py writes.
#ifndef VPL_TESTS_NULLS_FIXTURE_H
#define VPL_TESTS_NULLS_FIXTURE_H

#include <vpl/stages.h>

// A room of two quads, a mesh and a lamp, and everything that can be made of it.
typedef struct Fixture {
    vplContext* context;
    vplScene* scene;
    vplRenderOptions* options;
    vplGeometry* geometry;
    vplEnvironment* environment;
    vplEmission* emission;
    vplImage *image, *other;
    vplLayer layer;
    vplPixelsDef pixels;
    vplTarget target;
    vplView view;
    vplCubeMap* cube;
    vplCubeMapDef cubeDef;
    vplShadow shadow;
    vplReflectiveMap* reflective;
    vplHemiMaps* hemi;
    vplParaboloidMaps* paraboloids;
    vplLightSet* lights;
    vplShadeLight* shadeLights;
    int shadeLightCount;
    vplLightClusters* clusters;
    vplPatches* patches;
    vplPatchSides* sides;
    vplFormFactors* factors;
    vplLinks* links;
    vplTransport transport;
    vplPatchMesh* mesh;
    vplRaster* raster;
    vplFramebuffer framebuffer;
    vplPipeline pipeline;
    vplMesh drawn;
    vplPlan* plan;
    vplRenderer* renderer;
    vplPieceGrid grid;
    uint8_t* piece;
    size_t pieceBytes;
    vplAssembly* assembly;
    vplHistory* history;
    vplRay ray;
    vplHit hit;
    vplPlacement placement;
    vplPlacementDef placementDef;
    vplShadeDef shade;
    vplCompensationDef compensation;
    vplSurfacePoint point;
    vplEmitterDef emitter;
    vplPatchDraw draw;
    vplVertexGather gather;
    vplPatchPriorityDef priority;
    vplTextureDef texture;
    vplMeshDef meshDef;
    vplEnvironmentDef sky;
    vplCameraDef camera;
    vplCameraKey cameraKey;
    vplEmitterKey emitterKey;
    vplTransformKey transformKey;
    vplMemoryFile file;
    vplSpeeds speeds;
    vplMachine machine;
    vplTeam team;
    vplTile tile;
    vplHemiMapPlace hemiPlace;
    vplParaboloidPlace paraboloidPlace;
    vplMat4 matrix;
    vplParticlePass pass;
    vplRasterStats stats;
} Fixture;

extern Fixture f;

// Makes the fixture; ends the process where a call fails that must not.
void makeFixture(void);

// Memory that calls write their results to, SPACE_BYTES of zeros each. Before a call pointers to objects hold `untouched`.
enum { SPACES = 8, SPACE_BYTES = 1 << 20 };
extern _Alignas(64) unsigned char spaces[SPACES][SPACE_BYTES];
extern _Alignas(64) unsigned char zeros[1 << 16];
extern float ones[1 << 16]; // also colours and points

bool goOn(void* user, double fraction);
void tileTask(void* data, vplTile* tile, int worker);

// One call with one wrong argument. Returns its result; VPL_SUCCESS for functions that have none.
typedef struct Call {
    const char* function;
    const char* argument;
    const char* value;
    vplResult (*run)(void);
    bool null, optional; // the value is NULL; the header allows it
    bool result, known;  // the function has a result; another argument leads to the context
    unsigned outputs;    // spaces that receive a pointer to a new object
} Call;

extern const Call calls[];
extern const int callCount, functionCount, skippedCount;

// The cookie that a default function sets.
typedef struct Cookie {
    const char* def;
    uint32_t cookie;
} Cookie;

extern const int defCount;

void findCookies(Cookie* out); // defCount of them

#endif
