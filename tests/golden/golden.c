// SPDX-License-Identifier: MIT
// Golden pictures: `vpl-golden check golden OUT` renders all and compares the hashes of the float images;
// `vpl-golden write golden` rewrites them. hashes.txt decides; the PNGs are for people to look at. On a
// mismatch the program shows the picture, eight times its difference from the golden PNG, and the first
// differing pixel.
#include "../plain_options.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { SIZE = 96 };

typedef struct Case {
    const char* name;
    const char* scene;
    float exposure; // of the PNG
    void (*adjust)(vplRenderOptions* o);
} Case;

static void defaults(vplRenderOptions* o)
{
    (void)o;
}

static void documented(vplRenderOptions* o)
{
    o->lighting = VPL_LIGHTING_DOCUMENTED;
}

static void documentedMultipass(vplRenderOptions* o)
{
    o->lighting = VPL_LIGHTING_DOCUMENTED;
    o->pipeline.kind = VPL_ACCUMULATE_MULTIPASS;
    o->particles.count = 100;
    o->particles.sampler = VPL_SAMPLER_HALTON;
}

static void manyLights(vplRenderOptions* o)
{
    o->particles.count = 1000;
    o->particles.sampler = VPL_SAMPLER_HALTON;
    o->particles.reflectivity = -1;
}

static void manyLightsBatched(vplRenderOptions* o)
{
    manyLights(o);
    o->pipeline.kind = VPL_ACCUMULATE_BATCHED;
    o->pipeline.batch = 100;
    o->particles.sampler = VPL_SAMPLER_HAMMERSLEY;
}

static void interleaved(vplRenderOptions* o)
{
    manyLights(o);
    o->pipeline.kind = VPL_ACCUMULATE_INTERLEAVED;
}

static void lightMaps(vplRenderOptions* o)
{
    o->particles.count = 200;
    o->particles.sampler = VPL_SAMPLER_HALTON;
    o->particles.reflectivity = -1;
    o->lights.shadows = VPL_LIGHT_SHADOWS_MAP;
    o->output.show = VPL_SHOW_INDIRECT;
}

static void unbounded(vplRenderOptions* o)
{
    o->particles.count = 200;
    o->lights.minDistance = 0;
}

static void hardShadow(vplRenderOptions* o)
{
    o->method = VPL_METHOD_DIRECT;
    o->shadow.pcfSamples = 1;
    o->shadow.mapSize = 128;
}

static void acne(vplRenderOptions* o)
{
    hardShadow(o);
    o->shadow.bias = 0.002f;
    o->shadow.biasSlope = 0;
}

static void softShadow(vplRenderOptions* o)
{
    o->method = VPL_METHOD_DIRECT;
    o->shadow.pcfSamples = 64;
    o->shadow.pcfOffset = 0.25f;
}

static void depth(vplRenderOptions* o)
{
    o->output.show = VPL_SHOW_DEPTH;
}

static void normals(vplRenderOptions* o)
{
    o->output.show = VPL_SHOW_NORMALS;
}

static void shadowMap(vplRenderOptions* o)
{
    o->output.show = VPL_SHOW_SHADOW_MAP;
    o->shadow.mapSize = 24;
}

static void shadowFactor(vplRenderOptions* o)
{
    o->output.show = VPL_SHOW_SHADOW_FACTOR;
}

static void lightcuts(vplRenderOptions* o)
{
    o->pipeline.kind = VPL_ACCUMULATE_LIGHTCUTS;
    o->lights.shadows = VPL_LIGHT_SHADOWS_RAY;
    o->particles.count = 3000;
}

static void kellerDocumented(vplRenderOptions* o)
{
    o->method = VPL_METHOD_KELLER;
    o->lighting = VPL_LIGHTING_DOCUMENTED;
    o->particles.count = 60;
}

static void kellerPasses(vplRenderOptions* o)
{
    o->method = VPL_METHOD_KELLER;
    o->particles.reflectivity = -1;
    o->particles.count = 300;
    o->stop.passes = 3;
    o->pipeline.kind = VPL_ACCUMULATE_INTERLEAVED;
}

static void indirect(vplRenderOptions* o)
{
    o->output.show = VPL_SHOW_INDIRECT;
}

static void oneLight(vplRenderOptions* o)
{
    o->lighting = VPL_LIGHTING_DOCUMENTED;
    o->output.show = VPL_SHOW_LIGHT;
    o->output.showIndex = 4;
}

static void overlay(vplRenderOptions* o)
{
    o->output.show = VPL_SHOW_OVERLAY;
    o->particles.count = 60;
}

static void viewPlacement(vplRenderOptions* o)
{
    o->particles.placement = VPL_PLACEMENT_VIEW;
    o->particles.count = 100;
    o->lights.shadows = VPL_LIGHT_SHADOWS_RAY;
}

static void rsmPlacement(vplRenderOptions* o)
{
    o->particles.placement = VPL_PLACEMENT_RSM;
    o->shadow.rsmSize = 64;
    o->particles.count = 100;
}

static void paths(vplRenderOptions* o)
{
    o->method = VPL_METHOD_PATH;
    o->path.samples = 32;
}

static void lightPaths(vplRenderOptions* o)
{
    paths(o);
    o->path.lightVertices = 16;
}

static void secondBounce(vplRenderOptions* o)
{
    paths(o);
    o->output.show = VPL_SHOW_BOUNCE;
    o->output.showIndex = 2;
    o->seed = 7;
}

static void compensated(vplRenderOptions* o)
{
    o->method = VPL_METHOD_KELLER;
    o->particles.count = 100;
    o->lights.shadows = VPL_LIGHT_SHADOWS_RAY;
}

static void ssvp(vplRenderOptions* o)
{
    o->method = VPL_METHOD_SSVP;
    o->shadow.rsmSize = 128;
}

// Selects the document's printed variants wherever libvpl's default follows a later reading of it.
static void ssvpPrinted(vplRenderOptions* o)
{
    ssvp(o);
    o->ssvp.metric = VPL_CLUSTER_PRINTED;
    o->ssvp.place = VPL_CLUSTER_PLACE_MEAN;
    o->ssvp.secondWeight = VPL_SECOND_WEIGHT_PRINTED;
    o->ssvp.oversampling = 1;
    o->ssvp.nextBounce = VPL_NEXT_BOUNCE_MAPS;
    o->ssvp.paraboloidSize = 128;
    o->maxBounces = 2;
}

static void ssvpGather(vplRenderOptions* o)
{
    ssvp(o);
    o->output.show = VPL_SHOW_GATHER;
}

static void ssvpClusters(vplRenderOptions* o)
{
    ssvp(o);
    o->output.show = VPL_SHOW_CLUSTERS;
}

static void paraboloid(vplRenderOptions* o)
{
    ssvp(o);
    o->output.show = VPL_SHOW_PARABOLOID;
    o->output.showIndex = 2;
    o->ssvp.paraboloidSize = 48;
}

static void radiosity(vplRenderOptions* o)
{
    o->method = VPL_METHOD_RADIOSITY;
    o->radiosity.cuts = VPL_PATCH_CUTS_OFF;
    o->radiosity.patchSize = 0.45f; // gives 784 patches of the report's box
}

static void radiosityIncentre(vplRenderOptions* o)
{
    radiosity(o);
    o->radiosity.subdivisions = 3; // gives 192 patches, and too bright a picture
    o->radiosity.formFactors = VPL_FORM_FACTORS_INCENTRE;
    o->radiosity.vertexWeight = VPL_VERTEX_WEIGHT_EQUAL;
    o->radiosity.interpolation = VPL_INTERPOLATION_NONE;
}

static void radiosityLinks(vplRenderOptions* o)
{
    o->method = VPL_METHOD_RADIOSITY;
    o->radiosity.cuts = VPL_PATCH_CUTS_OFF;
    o->radiosity.patches = 500;
    o->radiosity.hierarchy = VPL_HIERARCHY_ON;
}

static void radiosityAdaptive(vplRenderOptions* o)
{
    o->method = VPL_METHOD_RADIOSITY;
    o->radiosity.cuts = VPL_PATCH_CUTS_OFF;
    o->radiosity.patches = 300;
    o->radiosity.placement = VPL_PATCHES_ADAPTIVE;
}

static void adaptivePatches(vplRenderOptions* o)
{
    radiosityAdaptive(o);
    o->output.show = VPL_SHOW_PATCHES;
}

static void patchRadiosity(vplRenderOptions* o)
{
    radiosity(o);
    o->output.show = VPL_SHOW_PATCH_RADIOSITY;
    o->radiosity.solver = VPL_SOLVER_SHOOTING;
}

static void laterFrame(vplRenderOptions* o)
{
    manyLights(o);
    o->sequence.frame = 45;
}

// 72 lamps, which all light each pixel; four samples of eight at rims of shadows, and four lamps at hits of short rays.
static void manyLamps(vplRenderOptions* o)
{
    o->method = VPL_METHOD_KELLER;
    o->particles.count = 250;
    o->lights.shadows = VPL_LIGHT_SHADOWS_RAY;
    o->lights.compensation = VPL_COMPENSATION_RAYS;
    o->lights.minDistance = 1;
    o->pipeline.kind = VPL_ACCUMULATE_INTERLEAVED;
    o->pipeline.interleave = 4;
    o->output.antialias = 8;
}

static void chosenLamps(vplRenderOptions* o)
{
    o->method = VPL_METHOD_DIRECT;
    o->lights.emitterSamples = 8;
    o->output.antialias = 4;
}

static const Case CASES[] = {
    {"room-physical", "room", 1, defaults},
    {"room-documented", "closed-room", 0, documented},
    {"room-documented-multipass", "room", 0, documentedMultipass},
    {"room-many-lights", "closed-room", 1, manyLights},
    {"room-many-lights-batched", "room", 1, manyLightsBatched},
    {"interleaved-room", "room", 1, interleaved},
    {"lightcuts-room", "room", 1, lightcuts},
    {"room-unbounded", "room", 1, unbounded},
    {"room-light-maps", "room", 1, lightMaps},
    {"hard-shadow", "room", 2, hardShadow},
    {"acne", "room", 2, acne},
    {"soft-shadow", "room", 2, softShadow},
    {"depth", "room", -4, depth},
    {"normals", "room", 0, normals},
    {"shadow-map", "room", -3, shadowMap},
    {"shadow-factor", "room", 0, shadowFactor},
    {"indirect", "closed-room", 1, indirect},
    {"light-4", "closed-room", 2, oneLight},
    {"overlay", "room", 0, overlay},
    {"placement-view", "flat", 3, viewPlacement},
    {"placement-rsm", "room", 1, rsmPlacement},
    {"keller-documented", "room-area", 1, kellerDocumented},
    {"keller-passes", "room", 1, kellerPasses},
    {"compensated-area", "room-area", 1, compensated},
    {"path-area", "room-area", 1, paths},
    {"path-point", "closed-room", 1, paths},
    {"path-bounce-2", "room", 3, secondBounce},
    {"light-paths", "../../tests/data/shade", 9, lightPaths},
    {"ssvp-room", "room", 1, ssvp},
    {"ssvp-printed", "closed-room", 1, ssvpPrinted},
    {"ssvp-gather", "room", 1, ssvpGather},
    {"ssvp-clusters", "room", 0, ssvpClusters},
    {"ssvp-paraboloid", "room", 0, paraboloid},
    {"radiosity-box", "testmodel", 1.65f, radiosity},
    {"radiosity-incentre", "testmodel", 1.65f, radiosityIncentre},
    {"radiosity-patches", "testmodel", 1.65f, patchRadiosity},
    {"radiosity-links", "room", 1, radiosityLinks},
    {"radiosity-adaptive", "room-area", 1, radiosityAdaptive},
    {"adaptive-patches", "room-area", 0, adaptivePatches},
    {"frame-45", "room-path", 2.5f, laterFrame},
    {"many-lamps", "../../tests/data/lamps", 1, manyLamps},
    {"chosen-lamps", "../../tests/data/lamps", 1, chosenLamps},
};

enum { CASE_COUNT = sizeof CASES / sizeof *CASES };

static void printMessage(void* user, vplLogLevel level, const char* message)
{
    (void)user;
    if (level != VPL_LOG_INFO) {
        fprintf(stderr, "%s\n", message);
    }
}

static vplImage* renderCase(vplContext* context, const Case* c)
{
    char path[256];
    vplScene* scene = NULL;
    vplImage* image = NULL;
    vplRenderOptions options = plainOptions();
    options.output.width = options.output.height = SIZE;
    c->adjust(&options);
    snprintf(path, sizeof path, "examples/scenes/%s.json", c->scene);
    if (vplScene_Load(context, path, &scene) == VPL_SUCCESS) {
        vplRender(scene, &options, &image, NULL);
    }
    vplScene_Destroy(scene);
    return image;
}

static bool writePng(const Case* c, const vplImage* image, const char* folder, const char* suffix)
{
    char path[512];
    vplWriteOptions write = vplDefaultWriteOptions();
    write.exposure = c->exposure;
    snprintf(path, sizeof path, "%s/%s%s.png", folder, c->name, suffix);
    return vplImage_Write(image, path, &write) == VPL_SUCCESS;
}

// Returns the hash recorded for a name, or 0.
static uint64_t recordedHash(const char* folder, const char* name)
{
    char path[512], line[256], found[128];
    unsigned long long hash = 0;
    snprintf(path, sizeof path, "%s/hashes.txt", folder);
    FILE* file = fopen(path, "r");
    while (file != NULL && fgets(line, sizeof line, file) != NULL) {
        unsigned long long value;
        if (sscanf(line, "%127s %llx", found, &value) == 2 && strcmp(found, name) == 0) {
            hash = value;
        }
    }
    if (file != NULL) {
        fclose(file);
    }
    return hash;
}

static void explain(vplContext* context, const Case* c, vplImage* image, const char* folder, const char* out)
{
    char path[512];
    vplImage *golden = NULL, *now = NULL;
    writePng(c, image, out, "");
    snprintf(path, sizeof path, "%s/%s.png", folder, c->name);
    if (vplImage_Read(context, path, &golden) != VPL_SUCCESS) {
        return;
    }
    snprintf(path, sizeof path, "%s/%s.png", out, c->name);
    if (vplImage_Read(context, path, &now) == VPL_SUCCESS && now->width == golden->width &&
        now->height == golden->height) {
        int first = -1;
        for (int i = 0; i < 3 * now->width * now->height; i++) {
            float difference = fabsf(now->pixels[i] - golden->pixels[i]);
            first = first < 0 && difference > 0 ? i / 3 : first;
            golden->pixels[i] = 8 * difference;
        }
        vplImage_Write(golden, (snprintf(path, sizeof path, "%s/%s-difference.png", out, c->name), path),
                       NULL);
        if (first >= 0) {
            printf("  first pixel that differs in the PNG: (%d, %d)\n", first % now->width,
                   first / now->width);
        } else {
            printf("  the differences are too small for a PNG\n");
        }
    }
    vplImage_Destroy(golden);
    vplImage_Destroy(now);
}

// Checks the first picture and every `step`-th after it.
static int check(vplContext* context, const char* folder, const char* out, int step)
{
    int failed = 0, checked = 0;
    mkdir(out, 0777);
    for (int i = 0; i < CASE_COUNT; i += step, checked++) {
        vplImage* image = renderCase(context, &CASES[i]);
        uint64_t hash = image ? vplImage_Hash(image) : 0, wanted = recordedHash(folder, CASES[i].name);
        if (image == NULL || hash != wanted) {
            printf("not ok %s: hash %016llx, recorded %016llx; see %s/%s.png\n", CASES[i].name,
                   (unsigned long long)hash, (unsigned long long)wanted, out, CASES[i].name);
            failed++;
            if (image != NULL) {
                explain(context, &CASES[i], image, folder, out);
            }
        }
        vplImage_Destroy(image);
    }
    printf("%d passed, %d failed\n", checked - failed, failed);
    return failed > 0;
}

static int rewrite(vplContext* context, const char* folder)
{
    char path[512];
    snprintf(path, sizeof path, "%s/hashes.txt", folder);
    FILE* file = fopen(path, "w");
    if (file == NULL) {
        return 1;
    }
    for (int i = 0; i < CASE_COUNT; i++) {
        vplImage* image = renderCase(context, &CASES[i]);
        if (image == NULL || !writePng(&CASES[i], image, folder, "")) {
            return 1;
        }
        fprintf(file, "%s %016llx\n", CASES[i].name, (unsigned long long)vplImage_Hash(image));
        vplImage_Destroy(image);
    }
    return fclose(file) != 0;
}

// Returns VPL_ISA_COUNT for unknown names.
static vplIsa isaOf(const char* name)
{
    vplIsa isa = VPL_ISA_AUTO;
    while (isa < VPL_ISA_COUNT && strcmp(vplIsa_GetName(isa), name) != 0) {
        isa++;
    }
    return isa;
}

int main(int count, char** words)
{
    vplContextDef def = vplDefaultContextDef();
    const bool checks = (count == 4 || count == 6) && strcmp(words[1], "check") == 0;
    def.log = printMessage;
    def.workerCount = count == 6 ? atoi(words[4]) : 0;
    def.isa = count == 6 ? isaOf(words[5]) : VPL_ISA_AUTO;
    vplContext* context;
    if (vplContext_Create(&def, &context) != VPL_SUCCESS) {
        return 2;
    }
    int code = 2;
    if (checks) {
        const char* step = getenv("VPL_GOLDEN_STEP"); // 3: a third of the pictures, where an emulator is slow
        code = check(context, words[2], words[3], step != NULL && atoi(step) > 1 ? atoi(step) : 1);
    } else if (count == 3 && strcmp(words[1], "write") == 0) {
        code = rewrite(context, words[2]);
    } else {
        fprintf(stderr, "usage: vpl-golden check GOLDEN OUT [THREADS ISA] | write GOLDEN\n");
    }
    vplContext_Destroy(context);
    return code;
}
