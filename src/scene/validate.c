// SPDX-License-Identifier: MIT
// One check per number. The API puts "vplCameraDef." before the sentence, the file reader "scene.json:3:14:
// camera.".
#include "scene/scene.h"
#include "base/numbers.h"
#include "math/matrix.h"
#include "math/scalar.h"
#include "math/vec.h"

#include <limits.h>
#include <stdarg.h>
#include <stdio.h>

static const vplFault FINE = {NULL, -1, ""};
static const double MAX_ROTATION = 1e6; // radians; sine and cosine keep ten digits

static vplFault fault(const char* field, int index, const char* format, ...) VPL_PRINTF(3, 4);

static vplFault fault(const char* field, int index, const char* format, ...)
{
    vplFault f = {field, index, ""};
    va_list arguments;
    va_start(arguments, format);
    vplFormatList(f.text, sizeof f.text, format, arguments);
    va_end(arguments);
    return f;
}

static vplFault checkComponents(const char* field, vplVec3 p, float low, float high)
{
    const float v[3] = {p.x, p.y, p.z};
    for (int i = 0; i < 3; i++) {
        if (!(v[i] >= low && v[i] <= high)) {
            return fault(field, i, "is %g, must be in [%g, %g]", (double)v[i], (double)low, (double)high);
        }
    }
    return FINE;
}

static vplFault checkPoint(const char* field, vplVec3 p)
{
    return checkComponents(field, p, -VPL_MAX_MAGNITUDE, VPL_MAX_MAGNITUDE);
}

static vplFault checkColour(const char* field, vplRgb c, float high)
{
    return checkComponents(field, vplVec(c.r, c.g, c.b), 0, high);
}

static vplFault checkDirection(const char* field, vplVec3 d)
{
    vplFault f = checkPoint(field, d);
    if (f.field == NULL && vplDot(vplNormalize(d), vplNormalize(d)) == 0) {
        return fault(field, -1, "is the zero vector, must have a direction");
    }
    return f;
}

vplFault vplCheckCamera(const vplCameraDef* def)
{
    vplFault f = checkPoint("eye", def->eye);
    f = f.field ? f : checkPoint("target", def->target);
    f = f.field ? f : checkDirection("up", def->up);
    if (f.field) {
        return f;
    }
    vplVec3 view = vplNormalize(vplSub(def->target, def->eye));
    if (vplDot(view, view) == 0) {
        return fault("target", -1, "equals the eye (%g, %g, %g), must differ from it", (double)def->eye.x,
                     (double)def->eye.y, (double)def->eye.z);
    }
    vplVec3 right = vplCross(vplNormalize(def->up), view);
    if (vplLength(right) < 1e-6f) {
        return fault("up", -1, "is parallel to the view direction, must not be");
    }
    if (!(def->fovY > 0 && def->fovY < VPL_PI)) {
        return fault("fovY", -1, "is %g, must be in (0, pi) radians", def->fovY);
    }
    if (!(def->nearPlane > 0 && def->nearPlane <= VPL_MAX_MAGNITUDE_DOUBLE)) {
        return fault("nearPlane", -1, "is %g, must be in (0, %g]", def->nearPlane, VPL_MAX_MAGNITUDE_DOUBLE);
    }
    if (!(def->farPlane > def->nearPlane && def->farPlane <= VPL_MAX_MAGNITUDE_DOUBLE)) {
        return fault("farPlane", -1, "is %g, must be greater than near (%g) and at most %g", def->farPlane,
                     def->nearPlane, VPL_MAX_MAGNITUDE_DOUBLE);
    }
    return FINE;
}

static vplFault checkWrap(const char* field, vplTextureWrap wrap)
{
    return wrap == VPL_WRAP_REPEAT || wrap == VPL_WRAP_CLAMP || wrap == VPL_WRAP_MIRROR
               ? FINE
               : fault(field, -1, "is %d, must be a vplTextureWrap", (int)wrap);
}

vplFault vplCheckTexture(const vplTextureDef* def)
{
    if (def->width < 1 || def->width > VPL_MAX_IMAGE_SIZE || def->height < 1 ||
        def->height > VPL_MAX_IMAGE_SIZE) {
        return fault("width", -1, "and height are %d and %d, must be in [1, %d]", def->width, def->height,
                     VPL_MAX_IMAGE_SIZE);
    }
    if (def->channels < 1 || def->channels > 4) {
        return fault("channels", -1, "is %d, must be in [1, 4]", def->channels);
    }
    if ((def->texels == NULL) == (def->linear == NULL)) {
        return fault("texels", -1, "or linear must be given, and only one of them");
    }
    const size_t count = (size_t)def->width * (size_t)def->height * (size_t)def->channels;
    for (size_t i = 0; def->linear != NULL && i < count; i++) {
        if (!(def->linear[i] >= 0 && def->linear[i] <= 1)) {
            return fault("linear", (int)i, "is %g, must be in [0, 1]", (double)def->linear[i]);
        }
    }
    vplFault f = checkWrap("wrapU", def->wrapU);
    return f.field ? f : checkWrap("wrapV", def->wrapV);
}

static vplFault checkIndex(const char* field, int index, int count)
{
    return index >= -1 && index < count
               ? FINE
               : fault(field, -1, "is %d, must be -1 or one of the scene's %d textures", index, count);
}

static vplFault checkShare(const char* field, float value)
{
    return value >= 0 && value <= 1 ? FINE : fault(field, -1, "is %g, must be in [0, 1]", (double)value);
}

static vplFault checkPair(const char* field, const float pair[2])
{
    return checkPoint(field, vplVec(pair[0], pair[1], 0));
}

vplFault vplCheckMaterial(const vplMaterialDef* def, int textureCount)
{
    vplFault f = checkColour("diffuse", def->diffuse, 1);
    f = f.field ? f : checkColour("emission", def->emission, VPL_MAX_MAGNITUDE);
    f = f.field ? f : checkIndex("texture", def->texture, textureCount);
    f = f.field ? f : checkPair("textureScale", def->textureScale);
    f = f.field ? f : checkPair("textureOffset", def->textureOffset);
    f = f.field ? f : checkIndex("alphaTexture", def->alphaTexture, textureCount);
    f = f.field ? f : checkShare("opacity", def->opacity);
    f = f.field ? f : checkShare("alphaCutoff", def->alphaCutoff);
    if (f.field == NULL && !(fabs(def->textureRotation) <= MAX_ROTATION)) {
        return fault("textureRotation", -1, "is %g, must be in [%g, %g] radians", def->textureRotation,
                     -MAX_ROTATION, MAX_ROTATION);
    }
    if (f.field == NULL && def->alphaFromTexture && def->texture < 0) {
        return fault("alphaFromTexture", -1, "is true, must be false without a texture");
    }
    return f;
}

vplFault vplCheckMesh(const vplMeshDef* def, int materialCount)
{
    if (def->vertexCount < 0 || def->triangleCount < 0) {
        return fault("vertexCount", -1, "and triangleCount are %d and %d, must not be negative",
                     def->vertexCount, def->triangleCount);
    }
    if ((def->vertexCount > 0 && def->positions == NULL) ||
        (def->triangleCount > 0 && def->indices == NULL)) {
        return fault("positions", -1, "and indices must not be NULL");
    }
    for (int i = 0; i < def->vertexCount; i++) {
        vplFault f = checkPoint("positions", def->positions[i]);
        f = f.field || def->normals == NULL ? f : checkDirection("normals", def->normals[i]);
        f = f.field || def->texcoords == NULL ? f : checkPair("texcoords", def->texcoords + 2 * (size_t)i);
        f = f.field || def->colors == NULL ? f : checkColour("colors", def->colors[i], 1);
        if (f.field) {
            f.index = i;
            return f;
        }
    }
    for (int i = 0; i < def->triangleCount; i++) {
        for (int k = 0; k < 3; k++) {
            if (def->indices[3 * (size_t)i + (size_t)k] >= (uint32_t)def->vertexCount) {
                return fault("indices", 3 * i + k, "is %u, must be less than the vertexCount %d",
                             def->indices[3 * (size_t)i + (size_t)k], def->vertexCount);
            }
        }
        if (def->materials != NULL && (def->materials[i] < 0 || def->materials[i] >= materialCount)) {
            return fault("materials", i, "is %d, must be one of the scene's %d materials", def->materials[i],
                         materialCount);
        }
    }
    return FINE;
}

vplFault vplCheckTransform(const vplMat4* m)
{
    for (int i = 0; i < 16; i++) {
        if (!(fabsf(m->m[i]) <= VPL_MAX_MAGNITUDE)) {
            return fault("transform", i, "is %g, must be in [%g, %g]", (double)m->m[i],
                         -(double)VPL_MAX_MAGNITUDE, (double)VPL_MAX_MAGNITUDE);
        }
    }
    if (m->m[3] != 0 || m->m[7] != 0 || m->m[11] != 0 || m->m[15] != 1) {
        return fault("transform", -1, "has the last row (%g, %g, %g, %g), must be affine: (0, 0, 0, 1)",
                     (double)m->m[3], (double)m->m[7], (double)m->m[11], (double)m->m[15]);
    }
    for (int j = 0; j < 3; j++) {
        if (!(vplLength(vplVec(m->m[4 * j], m->m[4 * j + 1], m->m[4 * j + 2])) >= 1e-15f)) {
            return fault("transform", -1, "scales the %c axis to nothing, must not be singular", 'x' + j);
        }
    }
    vplAffine a = vplAffine_FromMat4(m);
    if (!(vplAffine_Orthogonality(&a) >= 1e-10)) { // below that, no digit of the inverse is right in float
        return fault("transform", -1, "is singular: its axes lie in one plane");
    }
    return FINE;
}

vplFault vplCheckEmitter(const vplEmitterDef* def)
{
    if (def->type != VPL_EMITTER_POINT && def->type != VPL_EMITTER_SPOT &&
        def->type != VPL_EMITTER_DIRECTIONAL) {
        return fault("type", -1, "is %d, must be a vplEmitterType", (int)def->type);
    }
    vplFault f = checkPoint("position", def->position);
    f = f.field ? f : checkColour("intensity", def->intensity, VPL_MAX_MAGNITUDE);
    if (f.field == NULL && def->type != VPL_EMITTER_POINT) {
        f = checkDirection("direction", def->direction);
    }
    if (f.field == NULL && def->type == VPL_EMITTER_SPOT) {
        if (!(def->outerAngle > 0 && def->outerAngle < VPL_PI / 2)) {
            return fault("outerAngle", -1, "is %g, must be in (0, pi/2) radians", def->outerAngle);
        }
        if (!(def->innerAngle >= 0 && def->innerAngle <= def->outerAngle)) {
            return fault("innerAngle", -1, "is %g, must be in [0, outer angle %g] radians", def->innerAngle,
                         def->outerAngle);
        }
    }
    return f;
}

static vplFault checkPicture(const vplEnvironmentDef* def)
{
    const int size[2] = {def->width, def->height};
    for (int i = 0; i < 2; i++) {
        if (size[i] < 1 || size[i] > VPL_MAX_IMAGE_SIZE) {
            return fault(i == 0 ? "width" : "height", -1, "is %d, must be in [1, %d]", size[i],
                         VPL_MAX_IMAGE_SIZE);
        }
    }
    if (def->pixels == NULL) {
        return fault("pixels", -1, "must not be NULL");
    }
    const size_t count = 3 * (size_t)def->width * (size_t)def->height;
    for (size_t i = 0; i < count; i++) {
        if (!(def->pixels[i] >= 0 && def->pixels[i] <= VPL_MAX_MAGNITUDE)) {
            return fault("pixels", i <= INT_MAX ? (int)i : -1, "is %g, must be in [0, %g]",
                         (double)def->pixels[i], (double)VPL_MAX_MAGNITUDE);
        }
    }
    return FINE;
}

vplFault vplCheckEnvironment(const vplEnvironmentDef* def)
{
    if ((int)def->type < VPL_ENVIRONMENT_NONE || def->type > VPL_ENVIRONMENT_SKY) {
        return fault("type", -1, "is %d, must be a vplEnvironmentType", (int)def->type);
    }
    vplFault f = checkColour("radiance", def->radiance, VPL_MAX_MAGNITUDE);
    if (f.field == NULL && !(def->scale >= 0 && def->scale <= VPL_MAX_MAGNITUDE_DOUBLE)) {
        return fault("scale", -1, "is %g, must be in [0, %g]", def->scale, VPL_MAX_MAGNITUDE_DOUBLE);
    }
    if (f.field == NULL && !(fabs(def->rotate) <= 1e6)) {
        return fault("rotate", -1, "is %g, must be in [-1e6, 1e6] radians", def->rotate);
    }
    if (f.field == NULL && !(def->elevation >= 0 && def->elevation <= VPL_PI / 2)) {
        return fault("elevation", -1, "is %g, must be in [0, pi/2] radians", def->elevation);
    }
    if (f.field == NULL && !(def->turbidity >= 2 && def->turbidity <= 10)) {
        return fault("turbidity", -1, "is %g, must be in [2, 10]", def->turbidity);
    }
    return f.field == NULL && def->type == VPL_ENVIRONMENT_PICTURE ? checkPicture(def) : f;
}

vplFault vplCheckKeyFrame(double before, double frame)
{
    if (!(fabs(frame) <= VPL_MAX_FRAME)) {
        return fault("frame", -1, "is %g, must be in [%d, %d]", frame, -VPL_MAX_FRAME, VPL_MAX_FRAME);
    }
    if (!(frame > before)) {
        return fault("frame", -1, "is %g, must be greater than that of the key before (%g)", frame, before);
    }
    return FINE;
}
