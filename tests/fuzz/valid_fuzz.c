// SPDX-License-Identifier: MIT
// Makes valid but extreme scenes and options from bytes and renders them: with one worker, and with three whose tasks
// run in the opposite order. Both must give the same bits, or the same refusal.
#include "valid.h"

#include "base/hash.h"

#include <math.h>
#include <string.h>

// ---- numbers

// A power of ten between 10^low and 10^high.
static double power(Bytes* b, double low, double high)
{
    return pow(10, low + (high - low) * unit(b));
}

// A number in [low, high]: its ends, between them, or of any order of magnitude.
static double numberIn(Bytes* b, double low, double high)
{
    double value = low;
    switch (pick(b, 4)) {
    case 0:
        value = low + (high - low) * unit(b);
        break;
    case 1:
        value = high;
        break;
    case 2:
        value = low;
        break;
    default:
        value = power(b, -12, 15);
    }
    return fmin(fmax(value, low), high);
}

// ---- scenes

static vplVec3 pointIn(Bytes* b, double size)
{
    const double x = size * (2 * unit(b) - 1), y = size * (2 * unit(b) - 1), z = size * (2 * unit(b) - 1);
    return (vplVec3){(float)x, (float)y, (float)z};
}

// Brightness relative to `usual`, mostly moderate.
static vplRgb lightOf(Bytes* b, double usual)
{
    static const double extremes[] = {1, 1, 0, 1e-6, 1e6, 1e12};
    const double level = fmin(usual * extremes[pick(b, 6)], 1e15);
    return (vplRgb){(float)level, (float)(level * unit(b)), (float)(level / (1 + pick(b, 3)))};
}

// A picture of few texels, with 1 to 4 channels.
static void addTexture(Bytes* b, vplScene* scene)
{
    enum { WIDEST = 9 };
    unsigned char texels[4 * WIDEST * WIDEST];
    vplTextureDef def = vplDefaultTextureDef();
    def.width = 1 + (int)pick(b, WIDEST);
    def.height = 1 + (int)pick(b, WIDEST);
    def.channels = 1 + (int)pick(b, 4);
    def.wrapU = (vplTextureWrap)pick(b, 3);
    def.wrapV = (vplTextureWrap)pick(b, 3);
    const unsigned seed = pick(b, 256);
    for (int i = 0; i < def.width * def.height * def.channels; i++) {
        texels[i] = (unsigned char)((unsigned)i * 73 % (seed + 2) * 255 / (seed + 1));
    }
    def.texels = texels;
    MUST(vplScene_AddTexture(scene, &def, NULL) == VPL_SUCCESS);
}

// Textures, holes and panes of a material.
static void dress(Bytes* b, const vplScene* scene, vplMaterialDef* def)
{
    const int textures = vplScene_GetTextureCount(scene);
    if (textures > 0) {
        const int chosen = (int)pick(b, (unsigned)textures);
        const bool alpha = vplScene_GetTexture(scene, chosen)->channels % 2 == 0;
        def->texture = chosen;
        def->alphaFromTexture = alpha && pick(b, 2);
        def->alphaTexture = pick(b, 4) == 3 ? (int)pick(b, (unsigned)textures) : -1;
        def->textureScale[0] = (float)(pick(b, 4) == 3 ? power(b, -6, 6) : 1);
        def->textureOffset[1] = (float)(pick(b, 4) == 3 ? power(b, -6, 6) : 0);
        def->textureRotation = pick(b, 3);
    }
    def->opacity = pick(b, 4) == 3 ? (float)numberIn(b, 0, 1) : 1;
}

static void addMaterial(Bytes* b, vplScene* scene)
{
    vplMaterialDef def = vplDefaultMaterialDef();
    const float bright = (float)numberIn(b, 0, 1);
    def.diffuse = (vplRgb){bright, (float)unit(b), pick(b, 2) ? 1 : bright};
    if (pick(b, 3) == 2) {
        def.emission = lightOf(b, 1);
    }
    dress(b, scene, &def);
    MUST(vplScene_AddMaterial(scene, &def, NULL) == VPL_SUCCESS);
}

// Triangles between few points, so that some have no area.
static int addMesh(Bytes* b, vplScene* scene)
{
    enum { POINTS = 7, MOST = 12 };
    vplVec3 points[POINTS];
    float texcoords[2 * POINTS];
    vplRgb colors[POINTS];
    uint32_t indices[3 * MOST];
    vplMeshDef def = vplDefaultMeshDef();
    int index;
    for (int i = 0; i < POINTS; i++) {
        points[i] = pointIn(b, 1);
    }
    def.triangleCount = 1 + (int)pick(b, MOST);
    for (int i = 0; i < 3 * def.triangleCount; i++) {
        indices[i] = pick(b, POINTS);
    }
    const double spread = pick(b, 4) == 3 ? power(b, -6, 6) : 1;
    for (int i = 0; i < POINTS; i++) {
        texcoords[2 * i] = (float)(spread * (2 * unit(b) - 1));
        texcoords[2 * i + 1] = (float)(spread * (2 * unit(b) - 1));
        colors[i] = (vplRgb){(float)unit(b), 1, 0.5f};
    }
    def.texcoords = pick(b, 2) ? texcoords : NULL;
    def.colors = pick(b, 3) == 2 ? colors : NULL;
    def.positions = points;
    def.indices = indices;
    def.vertexCount = POINTS;
    MUST(vplScene_AddMesh(scene, &def, &index) == VPL_SUCCESS);
    return index;
}

static double stretch(Bytes* b, double size)
{
    static const double extremes[] = {1, 1, 0.1, 1e-4, 1e-7, 100};
    return (pick(b, 4) == 3 ? -1 : 1) * size * (0.5 + unit(b)) * extremes[pick(b, 6)];
}

// Adds an object. One that is too thin is refused, which must give a sentence.
static void addObject(Bytes* b, FuzzLog* log, vplScene* scene, double size, vplVec3 middle)
{
    vplObjectDef def = vplDefaultObjectDef();
    const vplVec3 shift = pointIn(b, size);
    const vplVec3 place = {middle.x + shift.x, middle.y + shift.y, middle.z + shift.z};
    const double turns[3] = {0.5 * VPL_PI * pick(b, 5), 0.1 * pick(b, 3), unit(b)};
    const vplVec3 scale = {(float)stretch(b, size), (float)stretch(b, size), (float)stretch(b, size)};
    def.type = (vplObjectType)pick(b, 3);
    def.material = (int)pick(b, (unsigned)vplScene_GetMaterialCount(scene));
    def.transform = vplMat4_FromParts(place, turns, scale);
    def.mesh = def.type == VPL_OBJECT_MESH ? addMesh(b, scene) : 0;
    const vplResult result = vplScene_AddObject(scene, &def, NULL);
    MUST(result == VPL_SUCCESS || (result == VPL_INVALID_ARGUMENT && log->errors == 1));
    log->errors = 0;
}

static void addEmitter(Bytes* b, FuzzLog* log, vplScene* scene, double size, vplVec3 middle)
{
    vplEmitterDef def = vplDefaultEmitterDef();
    const vplVec3 shift = pointIn(b, size), direction = pointIn(b, 1);
    def.type = (vplEmitterType)pick(b, 3);
    def.position = (vplVec3){middle.x + shift.x, middle.y + shift.y, middle.z + shift.z};
    def.direction = pick(b, 2) ? direction : def.direction;
    def.intensity = lightOf(b, def.type == VPL_EMITTER_DIRECTIONAL ? 1 : size * size);
    def.outerAngle = numberIn(b, 1e-6, 1.57);
    def.innerAngle = def.outerAngle * unit(b);
    const vplResult result = vplScene_AddEmitter(scene, &def, NULL);
    MUST(result == VPL_SUCCESS || (result == VPL_INVALID_ARGUMENT && log->errors == 1));
    log->errors = 0;
}

static void addCamera(Bytes* b, FuzzLog* log, vplScene* scene, double size, vplVec3 middle)
{
    vplCameraDef def = vplDefaultCameraDef();
    const vplVec3 shift = pointIn(b, 0.4 * size), away = pointIn(b, 0.9 * size);
    def.eye = (vplVec3){middle.x + away.x, middle.y + away.y, middle.z + (float)size};
    def.target = (vplVec3){middle.x + shift.x, middle.y + shift.y, middle.z + shift.z};
    def.fovY = pick(b, 4) == 3 ? numberIn(b, 1e-4, 3.14) : 0.8;
    def.nearPlane = size * (pick(b, 4) == 3 ? power(b, -9, 0) : 0.01);
    def.farPlane = fmax(def.nearPlane * 1.001, size * (pick(b, 4) == 3 ? power(b, -2, 6) : 10));
    if (vplScene_AddCamera(scene, &def, NULL) != VPL_SUCCESS) {
        MUST(log->errors == 1);
        const vplCameraDef usual = vplDefaultCameraDef();
        MUST(vplScene_AddCamera(scene, &usual, NULL) == VPL_SUCCESS);
    }
    log->errors = 0;
}

// Light from all directions: even, from a picture of few pixels, or of the sky.
static void addEnvironment(Bytes* b, vplScene* scene)
{
    enum { WIDEST = 7 };
    float pixels[3 * WIDEST * WIDEST];
    vplEnvironmentDef def = vplDefaultEnvironmentDef();
    def.type = (vplEnvironmentType)pick(b, 4);
    def.radiance = lightOf(b, 1);
    def.width = 1 + (int)pick(b, WIDEST);
    def.height = 1 + (int)pick(b, WIDEST);
    for (int i = 0; i < def.width * def.height; i++) {
        const vplRgb l = lightOf(b, 1);
        memcpy(pixels + 3 * i, (float[3]){l.r, l.g, l.b}, 3 * sizeof *pixels);
    }
    def.pixels = def.type == VPL_ENVIRONMENT_PICTURE ? pixels : NULL;
    def.scale = pick(b, 4) == 3 ? power(b, -12, 12) : 1;
    def.rotate = unit(b) - 0.5;
    def.elevation = numberIn(b, 0, 0.5 * VPL_PI);
    def.turbidity = numberIn(b, 2, 10);
    MUST(vplScene_SetEnvironment(scene, &def) == VPL_SUCCESS);
}

static vplScene* makeScene(vplContext* context, Bytes* b, FuzzLog* log)
{
    vplScene* scene;
    const double size = pick(b, 3) == 2 ? power(b, -9, 9) : 1;
    const vplVec3 middle = pick(b, 4) == 3 ? pointIn(b, size * power(b, 0, 5)) : (vplVec3){0, 0, 0};
    MUST(vplScene_Create(context, &scene) == VPL_SUCCESS);
    addCamera(b, log, scene, size, middle);
    for (int i = pick(b, 2) ? 1 + (int)pick(b, 2) : 0; i > 0; i--) {
        addTexture(b, scene);
    }
    for (int i = 1 + (int)pick(b, 3); i > 0; i--) {
        addMaterial(b, scene);
    }
    if (pick(b, 2)) { // a room
        vplObjectDef room = vplDefaultObjectDef();
        const vplVec3 scale = {(float)(2.5 * size), (float)(2.5 * size), (float)(2.5 * size)};
        room.type = VPL_OBJECT_BOX;
        room.transform = vplMat4_FromParts(middle, (const double[3]){0}, scale);
        MUST(vplScene_AddObject(scene, &room, NULL) == VPL_SUCCESS);
    }
    for (int i = (int)pick(b, 6); i > 0; i--) {
        addObject(b, log, scene, size, middle);
    }
    for (int i = (int)pick(b, 4); i > 0; i--) {
        addEmitter(b, log, scene, size, middle);
    }
    if (pick(b, 3) == 2) {
        addEnvironment(b, scene);
    }
    return scene;
}

// ---- options

// The largest values of options that make work. The time and memory of the others is bounded.
static const struct {
    const char* name;
    double most; // 0: not touched
} MOST[] = {{"max-bounces", 40},
            {"supersample", 3},
            {"camera", 0},
            {"particles", 60},
            {"light-map", 40},
            {"spp", 9},
            {"area-light-samples", 70},
            {"sky-samples", 70},
            {"shadow-map", 70},
            {"pcf", 40},
            {"rsm-size", 40},
            {"clusters", 20},
            {"first-bounce", 60},
            {"oversampling", 6},
            {"second-bounce", 60},
            {"paraboloid", 40},
            {"patches", 90},
            {"subdivisions", 7},
            {"form-samples", 9},
            {"iterations", 60},
            {"passes", 3},
            {"grow-from", 40},
            {"quality", 0},
            {"budget", 0},
            {"max-error", 0},
            {"light-map-memory", 4}};

static double mostOf(const vplOption* option)
{
    for (size_t i = 0; i < sizeof MOST / sizeof *MOST; i++) {
        if (strcmp(MOST[i].name, option->name) == 0) {
            return MOST[i].most;
        }
    }
    return option->high;
}

// Writes word n modulo their count of a list such as "none|map|ray"; the K of "light:K" becomes a number.
static void writeWord(Bytes* b, const char* words, unsigned n, char* text, size_t size)
{
    unsigned count = 1;
    for (const char* at = words; *at != 0; at++) {
        count += *at == '|';
    }
    for (n %= count; n > 0; n--) {
        words = strchr(words, '|') + 1;
    }
    const int length = (int)strcspn(words, "|"), colon = (int)strcspn(words, "|:");
    if (colon < length) {
        snprintf(text, size, "%.*s:%u", colon, words, pick(b, 9));
    } else {
        snprintf(text, size, "%.*s", length, words);
    }
}

static void writeValue(Bytes* b, const vplOption* o, char* text, size_t size)
{
    static const char* const sides[] = {"1x1", "1x30", "30x1", "13x9", "5x67", "20x16"};
    const bool whole = o->kind == VPL_OPTION_INT || o->kind == VPL_OPTION_INT_AUTO;
    const double most = mostOf(o), low = whole ? o->low : fmax(o->low, -1e9);
    switch (o->kind) {
    case VPL_OPTION_CHOICE:
    case VPL_OPTION_PRESET:
    case VPL_OPTION_SHOW:
    case VPL_OPTION_SET:
        writeWord(b, o->value, pick(b, 256), text, size);
        return;
    case VPL_OPTION_SIZE:
        snprintf(text, size, "%s", sides[pick(b, 6)]);
        return;
    case VPL_OPTION_SEED:
        snprintf(text, size, "%u", pick(b, 256));
        return;
    default:
        if (strstr(o->value, "auto") != NULL && pick(b, 3) == 0) {
            writeWord(b, o->value, 1 + pick(b, 4), text, size);
            return;
        }
        snprintf(text, size, whole ? "%.0f" : "%.9g",
                 numberIn(b, low, o->kind == VPL_OPTION_BELOW_AUTO ? 0.97 : most));
    }
}

static vplRenderOptions makeOptions(Bytes* b)
{
    int count;
    const vplOption* rows = vplGetOptions(&count);
    vplRenderOptions options = vplDefaultRenderOptions();
    MUST(vplRenderOptions_SetAll(&options, SMALL) == VPL_SUCCESS);
    options.method = (vplMethod)pick(b, VPL_METHOD_AUTO + 1);
    for (int i = (int)pick(b, 12); i > 0; i--) {
        const vplOption* o = &rows[pick(b, (unsigned)count)];
        char text[64];
        if (o->kind != VPL_OPTION_PART && mostOf(o) + (o->low == o->high) > 0) {
            writeValue(b, o, text, sizeof text);
            const vplResult result = vplRenderOptions_Set(&options, o->name, text);
            MUST(result == VPL_SUCCESS || strchr("KCNDBOR", text[0]) != NULL); // the name of a number
            if (o->kind == VPL_OPTION_PRESET) {
                MUST(vplRenderOptions_SetAll(&options, SMALL) == VPL_SUCCESS);
            }
        }
    }
    return options;
}

// ---- pictures

static uint64_t hashImage(const vplImage* image)
{
    for (size_t i = 0; i < 3 * (size_t)image->width * (size_t)image->height; i++) {
        MUST(isfinite(image->pixels[i]));
    }
    return vplImage_Hash(image);
}

static vplResult render(const vplScene* scene, const vplRenderOptions* options, uint64_t* hashOut)
{
    vplImage* image = NULL;
    vplLayers* layers = NULL;
    vplRenderStats stats;
    const bool layered = options->output.aovs != 0;
    const vplResult result = layered ? vplRenderLayers(scene, options, &layers, &stats)
                                     : vplRender(scene, options, &image, &stats);
    for (int i = 0; i < VPL_MAX_LAYERS && layers != NULL; i++) {
        *hashOut += layers->images[i] != NULL ? hashImage(layers->images[i]) : 0;
    }
    if (image != NULL) {
        *hashOut = hashImage(image);
        MUST(stats.imageHash == *hashOut);
    }
    MUST((result == VPL_SUCCESS) == (layered ? layers != NULL : image != NULL));
    vplLayers_Destroy(layers);
    vplImage_Destroy(image);
    return result;
}

// True if the planned work is small: sanitizers make it 20 times as slow.
static bool isSmall(const vplPlan* plan)
{
    return plan->predictedMs < 30 && plan->peakBytes < 64 << 20;
}

uint64_t renderValid(vplContext* context, FuzzLog* log, const uint8_t* bytes, size_t size)
{
    Bytes b = {bytes, size};
    vplPlan* plan;
    uint64_t hash = 0;
    vplHistory* history = NULL;
    vplRenderOptions options = makeOptions(&b);
    const vplMachine machine = {1, NULL}; // what is small does not depend on the context's workers
    if (pick(&b, 4) > 0) {                // without one, statistics of what the clamp takes may take long
        MUST(vplHistory_Create(context, &history) == VPL_SUCCESS);
    }
    options.sequence.history = history;
    vplScene* scene = makeScene(context, &b, log);
    vplResult result = vplPlan_Create(scene, &options, &machine, &plan);
    if (result == VPL_SUCCESS && (plan->problem[0] != 0 || isSmall(plan))) {
        char problem[sizeof plan->problem];
        memcpy(problem, plan->problem, sizeof problem);
        const vplResult refusal = plan->refusal;
        vplPlan_Destroy(plan);
        result = render(scene, &options, &hash);
        MUST(problem[0] == 0 || (result == refusal && strcmp(log->message, problem) == 0));
    } else if (result == VPL_SUCCESS) {
        vplPlan_Destroy(plan);
    }
    MUST(result == VPL_SUCCESS || result == VPL_INVALID_ARGUMENT || result == VPL_LIMIT);
    MUST(log->errors == (result != VPL_SUCCESS) && isPrintable(log->message));
    vplHistory_Destroy(history);
    vplScene_Destroy(scene);
    return hash + (uint64_t)result;
}

// ---- the target

int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size)
{
    uint64_t hashes[2];
    for (int i = 0; i < 2; i++) {
        FuzzLog log = {{0}, 0};
        vplContextDef def = vplDefaultContextDef();
        def.log = fuzzLog;
        def.logUser = &log;
        def.workerCount = i ? 3 : 1;
        def.parallelFor = backwards;
        vplContext* context = NULL;
        MUST(vplContext_Create(&def, &context) == VPL_SUCCESS);
        hashes[i] = renderValid(context, &log, bytes, size);
        closeFuzzContext(context);
    }
    MUST(hashes[0] == hashes[1]);
    return 0;
}
