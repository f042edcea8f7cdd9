// SPDX-License-Identifier: MIT
// Animations of glTF files: curves of translations, rotations and scales of nodes. Cameras, lights and objects get a keyframe at
// each whole frame, because a path of libvpl is linear between its keys, and what a node above turns is not.
#include "scene/gltf.h"

#include "math/scalar.h"

#include <string.h>

static const int COMPONENTS[] = {3, 4, 3}; // of a translation, rotation and scale

enum { LINEAR, STEP, CUBIC };

// ---- reading

static vplResult readForm(const vplJson* sampler, int* out)
{
    static const char* const names[] = {"LINEAR", "STEP", "CUBICSPLINE"};
    const vplJson member = vplJson_Member(sampler, "interpolation");
    const char* name = "LINEAR";
    TRY(vplJson_ReadString(sampler, "interpolation", &name));
    for (int i = 0; i < 3; i++) {
        if (strcmp(name, names[i]) == 0) {
            *out = i;
            return VPL_SUCCESS;
        }
    }
    return vplJson_Fail(&member, "is \"%.40s\", must be \"LINEAR\", \"STEP\" or \"CUBICSPLINE\"", name);
}

// Reads the numbers of an accessor, all of which must be finite.
static vplResult readNumbers(vplGltf* g, const vplJson* sampler, const char* key, int components,
                             int64_t* countOut, const float** out)
{
    const vplJson member = vplJson_Member(sampler, key);
    vplGltfAccessor a;
    TRY(vplGltf_OpenAccessor(g, sampler, key, 1u << components, &a));
    if (a.count < 0) {
        return vplJson_Fail(sampler, "lacks the key \"%s\"", key);
    }
    float* numbers = vplArena_Alloc(g->scratch, (size_t)a.count, (size_t)components * sizeof *numbers);
    TRY(vplArena_Check(g->scratch));
    vplGltfAccessor_CopyFloats(&a, numbers);
    for (int64_t i = 0; i < a.count * components; i++) {
        if (!(fabsf(numbers[i]) <= VPL_MAX_MAGNITUDE)) {
            return vplJson_Fail(&member, "has the number %g, must be at most %g", (double)numbers[i],
                                (double)VPL_MAX_MAGNITUDE);
        }
    }
    *countOut = a.count;
    *out = numbers;
    return VPL_SUCCESS;
}

static vplResult readCurve(vplGltf* g, const vplJson* sampler, vplGltfCurve* c)
{
    const vplJson input = vplJson_Member(sampler, "input"), output = vplJson_Member(sampler, "output");
    int64_t count = 0, values = 0;
    TRY(vplJson_RequireObject(sampler));
    TRY(readForm(sampler, &c->form));
    TRY(readNumbers(g, sampler, "input", 1, &count, &c->times));
    TRY(readNumbers(g, sampler, "output", COMPONENTS[c->part], &values, &c->values));
    const int64_t expected = (c->form == CUBIC ? 3 : 1) * count;
    if (count == 0 || values != expected) {
        return vplJson_Fail(&output, "has %lld elements, must have %lld for %lld times", (long long)values,
                            (long long)expected, (long long)count);
    }
    for (int64_t i = 0; i < count; i++) {
        if (!(c->times[i] >= 0 && (i == 0 || c->times[i] > c->times[i - 1]))) {
            return vplJson_Fail(&input, "has the time %g in element %lld, must be at least 0 and increase",
                                (double)c->times[i], (long long)i);
        }
    }
    c->count = (int)count;
    return VPL_SUCCESS;
}

// Reads the node and the part that a channel moves; *part is -1 for weights and what extensions move.
static vplResult readTarget(vplGltf* g, const vplJson* channel, int* node, int* part)
{
    static const char* const paths[] = {"translation", "rotation", "scale"};
    const vplJson target = vplJson_Member(channel, "target");
    const char* path = "";
    *node = *part = -1;
    if (target.value == NULL) {
        return vplJson_Fail(channel, "lacks the key \"target\"");
    }
    TRY(vplJson_RequireObject(&target));
    TRY(vplGltf_ReadIndex(&target, "node", vplGltf_Count(g, VPL_GLTF_NODES), node));
    TRY(vplJson_ReadString(&target, "path", &path));
    for (int i = 0; i < 3 && *node >= 0; i++) {
        *part = strcmp(path, paths[i]) == 0 ? i : *part;
    }
    return VPL_SUCCESS;
}

static vplResult readChannel(vplGltf* g, const vplJson* channel, const vplJson* samplers, vplGltfMotion* out)
{
    vplGltfCurve c = {.node = -1};
    int sampler = -1;
    TRY(vplJson_RequireObject(channel));
    TRY(readTarget(g, channel, &c.node, &c.part));
    if (c.part < 0) {
        return VPL_SUCCESS;
    }
    TRY(vplGltf_ReadIndex(channel, "sampler", (int)json_array_size(samplers->value), &sampler));
    if (sampler < 0) {
        return vplJson_Fail(channel, "lacks the key \"sampler\"");
    }
    const vplJson element = vplJson_Element(samplers, sampler);
    TRY(readCurve(g, &element, &c));
    TRY(vplArena_Reserve(g->scratch, &out->curves, &out->capacity, out->count + 1, sizeof c));
    out->curves[out->count++] = c;
    g->nodes[c.node].moves = true;
    return VPL_SUCCESS;
}

vplResult vplGltf_ReadMotion(vplGltf* g, vplGltfMotion* out)
{
    *out = (vplGltfMotion){0};
    for (int i = 0; i < vplGltf_Count(g, VPL_GLTF_ANIMATIONS); i++) {
        const vplJson animation = vplGltf_Item(g, VPL_GLTF_ANIMATIONS, i);
        const vplJson channels = vplJson_Member(&animation, "channels");
        const vplJson samplers = vplJson_Member(&animation, "samplers");
        if (channels.value == NULL || samplers.value == NULL) {
            return vplJson_Fail(&animation, "lacks the key \"%s\"",
                                channels.value == NULL ? "channels" : "samplers");
        }
        TRY(vplJson_RequireArray(&channels));
        TRY(vplJson_RequireArray(&samplers));
        for (size_t k = 0; k < json_array_size(channels.value); k++) {
            const vplJson channel = vplJson_Element(&channels, (int)k);
            TRY(readChannel(g, &channel, &samplers, out));
        }
    }
    return VPL_SUCCESS;
}

// ---- interpolation

static void slerp(double t, const float* a, const float* b, double out[4])
{
    double cosine = 0, first = 1 - t, second = t;
    for (int k = 0; k < 4; k++) {
        cosine += (double)a[k] * (double)b[k];
    }
    const double sign = cosine < 0 ? -1 : 1; // the shorter way round
    const double angle = vplAcos(fmin(fabs(cosine), 1));
    double sine, along, rest;
    vplSinCos(angle, &sine, &rest);
    if (sine > 1e-6) {
        vplSinCos((1 - t) * angle, &along, &rest);
        first = along / sine;
        vplSinCos(t * angle, &along, &rest);
        second = along / sine;
    }
    for (int k = 0; k < 4; k++) {
        out[k] = first * (double)a[k] + sign * second * (double)b[k];
    }
}

// The Hermite spline of two keys, each of which has a tangent before its value and one behind it.
static void spline(const vplGltfCurve* c, int key, double t, double length, double* out)
{
    const int n = COMPONENTS[c->part];
    const float* a = c->values + (size_t)(3 * n) * (size_t)key;
    const float* b = a + 3 * n;
    const double t2 = t * t, t3 = t2 * t;
    for (int k = 0; k < n; k++) {
        out[k] = (2 * t3 - 3 * t2 + 1) * (double)a[n + k] +
                 length * (t3 - 2 * t2 + t) * (double)a[2 * n + k] + (3 * t2 - 2 * t3) * (double)b[n + k] +
                 length * (t3 - t2) * (double)b[k];
    }
}

// The value of a curve at a time; before its first key and behind its last, that key's.
static void evaluate(const vplGltfCurve* c, double time, double* out)
{
    const int n = COMPONENTS[c->part], stride = c->form == CUBIC ? 3 * n : n,
              offset = c->form == CUBIC ? n : 0;
    int low = 0, high = c->count; // the key is in [low, high)
    while (high - low > 1) {
        const int middle = low + (high - low) / 2;
        const bool before = (double)c->times[middle] <= time;
        low = before ? middle : low;
        high = before ? high : middle;
    }
    const float* a = c->values + (size_t)stride * (size_t)low;
    const double from = (double)c->times[low],
                 length = low + 1 < c->count ? (double)c->times[low + 1] - from : 0;
    const double t = length > 0 ? (time - from) / length : 0;
    for (int k = 0; k < n; k++) {
        out[k] = (double)a[offset + k];
    }
    if (!(t > 0) || c->form == STEP) {
        return;
    }
    if (c->form == CUBIC) {
        spline(c, low, t, length, out);
    } else if (c->part == 1) {
        slerp(t, a, a + stride, out);
    } else {
        for (int k = 0; k < n; k++) {
            out[k] += t * ((double)a[stride + k] - out[k]);
        }
    }
}

// ---- nodes that move

vplResult vplGltfMotion_FindFrames(vplGltf* g, const vplGltfMotion* m, int node, int64_t* firstOut,
                                   int64_t* lastOut, bool* movesOut)
{
    double first = INFINITY, last = -INFINITY;
    for (int at = node; at >= 0; at = g->nodes[at].parent) {
        for (size_t i = 0; i < m->count && g->nodes[at].moves; i++) {
            const vplGltfCurve* c = &m->curves[i];
            if (c->node == at) {
                first = fmin(first, (double)c->times[0]);
                last = fmax(last, (double)c->times[c->count - 1]);
            }
        }
    }
    *movesOut = first <= last;
    if (*movesOut && !(last * VPL_GLTF_FRAME_RATE < VPL_GLTF_MAX_FRAMES)) {
        return vplFail(g->context, VPL_LIMIT, "%s:1:1: an animation of %g s is longer than %d frames",
                       g->path, last, VPL_GLTF_MAX_FRAMES);
    }
    *firstOut = *movesOut ? (int64_t)floor(first * VPL_GLTF_FRAME_RATE) : 0;
    *lastOut = *movesOut ? (int64_t)ceil(last * VPL_GLTF_FRAME_RATE) : 0;
    return VPL_SUCCESS;
}

// The place of a node in its parent at a time.
static vplAffine localAt(const vplGltf* g, const vplGltfMotion* m, int node, double time)
{
    const vplJson item = vplGltf_Item(g, VPL_GLTF_NODES, node);
    vplGltfPlace place = {{0, 0, 0}, {0, 0, 0, 1}, {1, 1, 1}};
    vplGltf_ReadPlace(&item, &place); // succeeded before
    for (size_t i = 0; i < m->count; i++) {
        const vplGltfCurve* c = &m->curves[i];
        double* const parts[] = {place.translation, place.rotation, place.scale};
        if (c->node == node) {
            evaluate(c, time, parts[c->part]);
        }
    }
    return vplGltfPlace_ToAffine(&place);
}

vplAffine vplGltfMotion_Place(const vplGltf* g, const vplGltfMotion* m, int node, double frame)
{
    const double time = frame / VPL_GLTF_FRAME_RATE;
    vplAffine place = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    for (int at = node; at >= 0; at = g->nodes[at].parent) {
        const vplAffine local = g->nodes[at].moves ? localAt(g, m, at, time) : g->nodes[at].toParent;
        place = vplAffine_Multiply(&local, &place);
    }
    return place;
}
