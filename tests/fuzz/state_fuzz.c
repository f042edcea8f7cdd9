// SPDX-License-Identifier: MIT
// Passes arbitrary bytes as the state of a render, with a checksum that is made right: loading must log one
// sentence, or give a render that goes on.
#define _GNU_SOURCE
#include "fuzz.h"

#include "../plain_options.h"

#include "render/state_stream.h"

#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

// A floor under a lamp.
static vplScene* makeScene(vplContext* context)
{
    vplScene* scene;
    vplMaterialDef material = vplDefaultMaterialDef();
    vplObjectDef object = vplDefaultObjectDef();
    vplCameraDef camera = vplDefaultCameraDef();
    vplEmitterDef emitter = vplDefaultEmitterDef();
    emitter.position = (vplVec3){0, 0, 2};
    MUST(vplScene_Create(context, &scene) == VPL_SUCCESS);
    MUST(vplScene_AddMaterial(scene, &material, NULL) == VPL_SUCCESS);
    MUST(vplScene_AddObject(scene, &object, NULL) == VPL_SUCCESS);
    MUST(vplScene_AddCamera(scene, &camera, NULL) == VPL_SUCCESS);
    MUST(vplScene_AddEmitter(scene, &emitter, NULL) == VPL_SUCCESS);
    return scene;
}

static vplRenderOptions makeOptions(vplMethod method)
{
    vplRenderOptions o = plainOptions();
    o.method = method;
    o.output.width = o.output.height = 2;
    o.particles.count = 2;
    o.shadow.mapSize = 2;
    o.path.samples = 3;
    o.stop.passes = 2;
    return o;
}

// Writes the bytes with the checksum that fits them.
static int writeState(const uint8_t* bytes, size_t size, char* name, size_t nameSize)
{
    const size_t summed = size >= 8 ? (size - 8) & ~(size_t)3 : 0;
    uint8_t* copy = malloc(size + 1);
    MUST(copy != NULL);
    memcpy(copy, bytes, size);
    const uint64_t checksum = vplState_Checksum(copy, summed);
    for (size_t i = 0; i < 8 && summed > 0; i++) {
        copy[summed + i] = (uint8_t)(checksum >> 8 * i);
    }
    const int fd = memfd_create("state", MFD_CLOEXEC);
    MUST(fd >= 0 && write(fd, copy, size) == (ssize_t)size);
    snprintf(name, nameSize, "/proc/self/fd/%d", fd);
    free(copy);
    return fd;
}

int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size)
{
    FuzzLog log = {{0}, 0};
    vplContext* context = openFuzzContext(&log);
    vplScene* scene = makeScene(context);
    char name[64];
    const int fd = writeState(bytes, size, name, sizeof name);
    for (int i = 0; i < 2; i++) {
        const vplRenderOptions options = makeOptions(i ? VPL_METHOD_KELLER : VPL_METHOD_PATH);
        vplRenderer* r;
        vplImage* image = NULL;
        bool done;
        log = (FuzzLog){{0}, 0};
        MUST(vplRenderer_Create(scene, &options, &r) == VPL_SUCCESS);
        const vplResult result = vplRenderer_Load(r, name, &done);
        MUST(isPrintable(log.message) && log.errors == (result != VPL_SUCCESS));
        MUST(vplRenderer_Step(r, &done) == VPL_SUCCESS); // also after a failure
        MUST(vplRenderer_GetImage(r, &image, NULL) == VPL_SUCCESS);
        vplImage_Destroy(image);
        vplRenderer_Destroy(r);
    }
    close(fd);
    vplScene_Destroy(scene);
    closeFuzzContext(context);
    return 0;
}
