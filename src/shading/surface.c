// SPDX-License-Identifier: MIT
// The camera, its vertex shader, and the surface that a block of fragments shows.
#include "math/scalar.h"
#include "math/vec.h"
#include "shading/shading.h"

vplView vplView_Create(const vplCameraDef* camera, int width, int height)
{
    vplView view;
    view.eye = camera->eye;
    view.forward = vplNormalize(vplSub(camera->target, camera->eye));
    view.right = vplNormalize(vplCross(view.forward, camera->up));
    view.up = vplCross(view.right, view.forward);
    double sine, cosine;
    vplSinCos(camera->fovY / 2, &sine, &cosine);
    view.scaleY = cosine / sine;
    view.scaleX = view.scaleY * height / width;
    view.near = camera->near;
    view.far = camera->far;
    view.width = width;
    view.height = height;
    return view;
}

typedef struct ViewPoint {
    double x, y, depth;
} ViewPoint;

// Relative to the eye first, so that a scene far from the origin keeps its digits.
static ViewPoint toView(const vplView* v, vplVec3 p)
{
    double x = (double)p.x - v->eye.x, y = (double)p.y - v->eye.y, z = (double)p.z - v->eye.z;
    return (ViewPoint){v->scaleX * (v->right.x * x + v->right.y * y + v->right.z * z),
                       v->scaleY * (v->up.x * x + v->up.y * y + v->up.z * z),
                       v->forward.x * x + v->forward.y * y + v->forward.z * z};
}

bool vplView_Project(const vplView* view, vplVec3 point, float* x, float* y)
{
    ViewPoint p = toView(view, point);
    if (!(p.depth >= view->near)) {
        return false;
    }
    *x = (float)((p.x / p.depth * 0.5 + 0.5) * view->width);
    *y = (float)((0.5 - p.y / p.depth * 0.5) * view->height);
    return true;
}

void vplCameraVertices(const void* uniforms, int first, int count, const vplVertices* out)
{
    const vplObjectUniforms* u = uniforms;
    const vplView* view = u->shading->view;
    const double depthScale = view->far / (view->far - view->near);
    for (int i = 0; i < count; i++) {
        vplVec3 p = u->positions[first + i];
        ViewPoint v = toView(view, p);
        out->x[i] = (float)v.x;
        out->y[i] = (float)v.y;
        out->z[i] = (float)((v.depth - view->near) * depthScale);
        out->w[i] = (float)v.depth;
        out->varying[0][i] = p.x;
        out->varying[1][i] = p.y;
        out->varying[2][i] = p.z;
    }
}

vplPipeline vplCameraPipeline(const vplShading* shading, int object)
{
    vplPipeline pipeline = vplDefaultPipeline();
    pipeline.vertex = vplCameraVertices;
    pipeline.vertexUniforms = &shading->objects[object];
    pipeline.varyingCount = VPL_CAMERA_VARYINGS;
    return pipeline;
}

vplFacet vplGetFacet(const vplShading* shading, int triangle)
{
    const vplGeometry* g = shading->geometry;
    const vplGeometryObject* o = &g->objects[g->owners[triangle]];
    const vplMaterialDef* material = &g->materials[g->triangleMaterials[triangle]];
    vplFacet facet = {g->normals[triangle], material->diffuse, material->emission};
    vplVec3 corner = g->positions[(uint32_t)o->firstVertex + g->indices[3 * (size_t)triangle]];
    bool fromBehind = vplDot(facet.normal, vplSub(shading->view->eye, corner)) < 0;
    if (fromBehind) {
        facet.emission = (vplRgb){0, 0, 0};
        if (shading->def->lighting == VPL_LIGHTING_PHYSICAL) {
            facet.normal = vplNegate(facet.normal);
        }
    }
    return facet;
}

void vplSurface_FromFragments(const vplShading* shading, int object, const vplFragments* fragments,
                              vplSurface* surfaceOut)
{
    int triangle = shading->geometry->objects[object].firstTriangle + fragments->primitive;
    vplVec3 n = vplGetFacet(shading, triangle).normal;
    for (int l = 0; l < VPL_LANES; l++) {
        surfaceOut->px[l] = fragments->varying[0][l];
        surfaceOut->py[l] = fragments->varying[1][l];
        surfaceOut->pz[l] = fragments->varying[2][l];
        surfaceOut->nx[l] = n.x;
        surfaceOut->ny[l] = n.y;
        surfaceOut->nz[l] = n.z;
    }
}

void vplDirectIrradiance(const vplShading* shading, const vplSurface* surface, float irradiance[3][VPL_LANES])
{
    const vplShadeDef* def = shading->def;
    const bool documented = def->lighting == VPL_LIGHTING_DOCUMENTED;
    const float weight = documented && def->particleCount > 0 ? 1 / (float)def->particleCount : 1;
    for (int l = 0; l < VPL_LANES; l++) {
        irradiance[0][l] = irradiance[1][l] = irradiance[2][l] = 0;
    }
    for (int i = 0; i < def->emitterCount; i++) {
        const vplEmitterDef* e = &def->emitters[i];
        float cosine[VPL_LANES], shadow[VPL_LANES];
        if (!shading->emitterKernel(surface, e->position, !documented, cosine)) {
            continue;
        }
        vplShadow_FactorBlock(&def->shadows[i], surface, shadow);
        const vplRgb colour = vplRgbScale(weight, e->intensity);
        for (int l = 0; l < VPL_LANES; l++) {
            float lit = (1 - shadow[l]) * cosine[l];
            irradiance[0][l] += colour.r * lit;
            irradiance[1][l] += colour.g * lit;
            irradiance[2][l] += colour.b * lit;
        }
    }
}
