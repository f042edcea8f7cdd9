// SPDX-License-Identifier: MIT
// With a value x of the picture and the means a and b of two independent halves of its paths, the mean of (x - a)(x - b)
// is (x - truth)^2: the paths' noise cancels. A pixel that was chosen with probability p counts 1/p times.
#include "render/planner/truth.h"

#include "base/rng.h"
#include "render/planner/contrast.h"
#include "render/stages/make.h"
#include "render/stages/results.h"

#include <math.h>

enum {
    TRUTH_STREAM = 0x80000009u, // of random numbers
    SEED = 0x7472757468         // differs from that of pictures
};

struct vplTruth {
    vplSparsePaths paths;
    vplSparsePixel* pixels;
    double* weights; // 1 / (probability x pixels of the picture)
    int pixelCount;  // of the picture
    vplArena* arena; // owns all
};

// ---- which pixels

// A sixth of the pixels is chosen evenly and a sixth by brightness: in sunlight a pixel without contrast may have a large error, too,
// where a gap between tiles is thinner than a pixel. A third is chosen by contrast and a third by its square, because errors at edges are
// about proportional to it and few pixels have most of it.
typedef struct Shares {
    double even, bright, linear, square;
} Shares;

static double brightnessOf(const vplImage* image, int x, int y)
{
    const float* p = image->pixels + 3 * ((size_t)y * (size_t)image->width + (size_t)x);
    return ((double)p[0] + (double)p[1] + (double)p[2]) / 3;
}

static Shares sharesOf(const vplImage* image)
{
    double bright = 0, linear = 0, square = 0;
    for (int y = 0; y < image->height; y++) {
        for (int x = 0; x < image->width; x++) {
            const double contrast = vplContrastOfPixel(image, x, y);
            bright += brightnessOf(image, x, y);
            linear += sqrt(contrast);
            square += contrast;
        }
    }
    const double pixels = (double)image->width * image->height;
    const bool flat = !(square > 0 && isfinite(square));
    return flat ? (Shares){1 / pixels, 0, 0, 0}
                : (Shares){1 / (6 * pixels), 1 / (6 * bright), 1 / (3 * linear), 1 / (3 * square)};
}

// The probability of choosing a pixel where `wanted` pixels of the picture are chosen.
static double expectedOf(const vplImage* image, const Shares* s, int x, int y, int wanted)
{
    const double contrast = vplContrastOfPixel(image, x, y);
    const double share =
        s->even + s->bright * brightnessOf(image, x, y) + s->linear * sqrt(contrast) + s->square * contrast;
    return wanted >= image->width * image->height ? 1 : fmin(1, wanted * share);
}

// Systematic sampling: takes a pixel where the sum of expected counts passes a whole number plus `offset`.
static int choosePixels(vplTruth* t, const vplImage* image, int wanted, double offset)
{
    const Shares shares = sharesOf(image);
    double sum = 0;
    int count = 0;
    for (int y = 0; y < image->height; y++) {
        for (int x = 0; x < image->width; x++) {
            const double expected = expectedOf(image, &shares, x, y, wanted);
            const double before = floor(sum - offset);
            sum += expected;
            if (floor(sum - offset) > before && count < wanted) {
                t->pixels[count] = (vplSparsePixel){.x = x, .y = y};
                t->weights[count++] = 1 / (expected * t->pixelCount);
            }
        }
    }
    return count;
}

// ---- their paths

static vplResult openTruth(const vplRun* run, int count, vplTruth* t)
{
    const vplOutputOptions* o = &run->plan->options.output;
    t->pixelCount = o->width * o->height;
    t->pixels = vplArena_AllocZero(t->arena, (size_t)count, sizeof *t->pixels);
    t->weights = vplArena_AllocZero(t->arena, (size_t)count, sizeof *t->weights);
    TRY(vplArena_Check(t->arena));
    TRY(vplFindLightVertices(run));
    vplPathDef def = vplDescribePaths(run, run->plan->options.output.show);
    def.seed ^= SEED;
    def.lastBounce = def.mostBounces = VPL_MAX_BOUNCES;
    return vplSparsePaths_Init(&t->paths, run->results[VPL_STAGE_GEOMETRY], &def, t->pixels, count);
}

vplResult vplTruth_Open(const vplRun* run, int count, vplTruth** truthOut)
{
    vplArena* arena = vplArena_Create(run->context);
    vplTruth* t = vplArena_AllocZero(arena, 1, sizeof *t);
    vplResult result = vplArena_Check(arena);
    if (result == VPL_SUCCESS) {
        t->arena = arena;
        result = openTruth(run, count, t);
    }
    return vplArena_Deliver(arena, result, t, truthOut);
}

vplTruthState vplTruth_GetState(const vplTruth* t)
{
    return (vplTruthState){t->pixels, t->weights, t->paths.count, t->paths.done};
}

void vplTruth_SetPaths(vplTruth* truth, int each)
{
    truth->paths.done = each;
}

vplResult vplTruth_Create(const vplRun* run, const vplImage* picture, int count, vplTruth** truthOut)
{
    const int pixels = picture->width * picture->height;
    vplTruth* t;
    TRY(vplTruth_Open(run, pixels < count ? pixels : count, &t));
    const vplRandom4 r = vplRandomAt(t->paths.scene.def.seed, TRUTH_STREAM, 0);
    t->paths.count = choosePixels(t, picture, t->paths.count, (double)vplUnitFloat(r.v[0]));
    const vplResult result = vplTraceGuided(run, &t->paths, VPL_FIRST_TRUTH_PATHS / 2,
                                            (vplProgressRange){run->progress, run->runner, 1, 1});
    if (result != VPL_SUCCESS) {
        vplTruth_Destroy(t);
        return result;
    }
    *truthOut = t;
    return VPL_SUCCESS;
}

void vplTruth_Destroy(vplTruth* truth)
{
    if (truth != NULL) {
        vplSparsePaths_Free(&truth->paths);
        vplArena_Destroy(truth->arena);
    }
}

vplResult vplTruth_Refine(const vplRun* run, vplTruth* truth, double share)
{
    const int each = (int)fmax(1, share * truth->paths.done);
    return vplTraceGuided(run, &truth->paths, each, (vplProgressRange){run->progress, run->runner, 1, 1});
}

bool vplTruth_IsGuided(const vplRun* run, const vplTruth* truth)
{
    return vplGuidePays(run, &truth->paths.scene);
}

int vplTruth_Paths(const vplTruth* truth)
{
    return 2 * truth->paths.done;
}

int64_t vplTruth_Rays(const vplTruth* truth)
{
    return truth != NULL ? truth->paths.cast : 0;
}

// ---- the error

// The mean square error of one pixel's values, and the mean of its true values.
static double errorOf(const vplSparsePixel* p, const float* values, double each, double* meanOut)
{
    const double halves[2][3] = {{p->sums[0].r, p->sums[0].g, p->sums[0].b},
                                 {p->sums[1].r, p->sums[1].g, p->sums[1].b}};
    double error = 0;
    *meanOut = 0;
    for (int c = 0; c < 3; c++) {
        const double a = halves[0][c] / each, b = halves[1][c] / each, x = (double)values[c];
        error += (x - a) * (x - b) / 3;
        *meanOut += (a + b) / 6;
    }
    return error;
}

// The variance of one path through a pixel, estimated as if its paths were independent.
static double varianceOfPaths(const vplSparsePixel* p, double each)
{
    const double square =
        (p->sums[0].r * p->sums[1].r + p->sums[0].g * p->sums[1].g + p->sums[0].b * p->sums[1].b) / 3;
    return p->squares / (2 * each) - square / (each * each);
}

vplTruthPixel vplTruth_GetPixel(const vplTruth* t, const vplImage* picture, int i)
{
    const vplSparsePixel* p = &t->pixels[i];
    const double each = t->paths.done;
    const float* values = picture->pixels + 3 * ((size_t)p->y * (size_t)picture->width + (size_t)p->x);
    vplTruthPixel out = {.x = p->x, .y = p->y};
    double mean;
    out.square = t->weights[i] * errorOf(p, values, each, &mean);
    out.mean = t->weights[i] * mean;
    out.pathVariance = t->weights[i] * varianceOfPaths(p, each);
    out.meanVariance = t->weights[i] * vplSparsePixel_Variance(p, each);
    return out;
}

int vplTruth_CountPixels(const vplTruth* t)
{
    return t->paths.count;
}

vplJudgement vplTruth_Judge(const vplTruth* t, const vplImage* picture, const vplEdges* edges)
{
    vplJudgement j = {0};
    const double each = t->paths.done, count = t->paths.count;
    double squares = 0, variance = 0; // of the means
    for (int i = 0; i < t->paths.count; i++) {
        vplTruthPixel p = vplTruth_GetPixel(t, picture, i);
        const size_t place = (size_t)p.y * (size_t)picture->width + (size_t)p.x;
        p.square = edges != NULL && vplEdges_VarianceAt(edges, place) >= 0 ? 0 : p.square;
        j.square += p.square;
        squares += p.square * p.square;
        j.mean += p.mean;
        j.pathVariance += p.pathVariance;
        variance += p.meanVariance;
        j.rays += t->pixels[i].rays;
    }
    j.pathVariance = fmin(j.pathVariance, 2 * each * variance);
    j.spread =
        count > 1 ? sqrt(fmax(0, squares - j.square * j.square / count) * count / (count - 1)) : INFINITY;
    const vplEdgeNoise noise = vplEdges_Noise(edges, t->pixelCount);
    j.square += noise.square;
    j.spread = sqrt(j.spread * j.spread + noise.spread * noise.spread);
    j.pathRays = count > 0 ? (double)j.rays / (2 * each * count) : 0;
    return j;
}
