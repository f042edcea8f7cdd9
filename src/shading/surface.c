// SPDX-License-Identifier: MIT
// The camera, its vertex shader, and the facets of triangles.
#include "geometry/triangle.h"
#include "math/scalar.h"
#include "math/vec.h"
#include "shading/shading.h"

#include <string.h>

vplView vplView_Create(const vplCameraDef* camera, int width, int height)
{
    if (camera == NULL) {
        return (vplView){0};
    }
    vplView view;
    view.eye = camera->eye;
    view.forward = vplNormalize(vplSub(camera->target, camera->eye));
    view.right = vplNormalize(vplCross(view.forward, camera->up));
    view.up = vplCross(view.right, view.forward);
    double sine, cosine;
    vplSinCos(camera->fovY / 2, &sine, &cosine);
    view.scaleY = cosine / sine;
    view.scaleX = view.scaleY * height / width;
    view.offsetX = view.offsetY = 0;
    view.nearPlane = camera->nearPlane;
    view.farPlane = camera->farPlane;
    view.width = width;
    view.height = height;
    return view;
}

vplView vplView_At(const vplView* view, double x, double y)
{
    vplView moved = *view;
    moved.offsetX = (1 - 2 * x) / view->width;
    moved.offsetY = (2 * y - 1) / view->height;
    return moved;
}

typedef struct ViewPoint {
    double x, y, depth;
} ViewPoint;

// Subtracts the eye first: a scene far from the origin keeps its digits.
static ViewPoint toView(const vplView* v, vplVec3 p)
{
    double x = (double)p.x - v->eye.x, y = (double)p.y - v->eye.y, z = (double)p.z - v->eye.z;
    double depth = v->forward.x * x + v->forward.y * y + v->forward.z * z;
    return (ViewPoint){v->scaleX * (v->right.x * x + v->right.y * y + v->right.z * z) + v->offsetX * depth,
                       v->scaleY * (v->up.x * x + v->up.y * y + v->up.z * z) + v->offsetY * depth, depth};
}

bool vplView_Project(const vplView* view, vplVec3 point, float* x, float* y)
{
    ViewPoint p = toView(view, point);
    if (!(p.depth >= view->nearPlane)) {
        return false;
    }
    *x = (float)((p.x / p.depth * 0.5 + 0.5) * view->width);
    *y = (float)((0.5 - p.y / p.depth * 0.5) * view->height);
    return true;
}

// All draws use this function: depths that are compared must have the same bits.
static void toClip(const vplView* view, vplVec3 point, float* x, float* y, float* z, float* w)
{
    const ViewPoint v = toView(view, point);
    *x = (float)v.x;
    *y = (float)v.y;
    *z = (float)((view->farPlane - v.depth) * (view->nearPlane / (view->farPlane - view->nearPlane)));
    *w = (float)v.depth;
}

void vplView_ToClip(const vplView* view, const vplVec3* points, int count, float (*clipOut)[4])
{
    for (int i = 0; i < count; i++) {
        float* clip = clipOut[i];
        toClip(view, points[i], &clip[0], &clip[1], &clip[2], &clip[3]);
    }
}

void vplCameraVertices(const void* uniforms, int first, int count, const vplVertices* out)
{
    const vplObjectUniforms* u = uniforms;
    const vplView* view = u->shading->view;
    for (int i = 0; i < count; i++) {
        vplVec3 p = u->positions[first + i];
        toClip(view, p, &out->x[i], &out->y[i], &out->z[i], &out->w[i]);
        out->varying[0][i] = p.x;
        out->varying[1][i] = p.y;
        out->varying[2][i] = p.z;
    }
    for (int i = 0; u->normals != NULL && i < count; i++) {
        out->varying[3][i] = u->normals[first + i].x;
        out->varying[4][i] = u->normals[first + i].y;
        out->varying[5][i] = u->normals[first + i].z;
    }
}

void vplSetCamera(const vplShading* shading, int object, vplPipeline* pipeline)
{
    pipeline->vertex = vplCameraVertices;
    pipeline->vertexUniforms = &shading->objects[object];
    pipeline->varyingCount = VPL_CAMERA_VARYINGS + (shading->objects[object].normals ? 3 : 0);
    pipeline->surface = shading->kernels.surface;
    pipeline->surfaceCount = VPL_SURFACE_VARYINGS * (shading->smooth ? 2 : 1);
}

vplFacet vplGetFacet(const vplShading* shading, int triangle)
{
    const vplGeometry* g = shading->geometry;
    const vplMaterialDef* material = &g->materials[g->triangleMaterials[triangle]];
    const vplVec3 corner = vplGeometry_Corners(g, triangle).corner[0];
    const vplRgb rho = material->diffuse, emission = material->emission;
    const double scale = 1 / VPL_PI;
    vplFacet facet = {
        .normal = g->normals[triangle],
        .reflector = {.factor = {rho.r * scale, rho.g * scale, rho.b * scale}, .texture = material->texture},
        .smooth = g->objects[g->owners[triangle]].smooth};
    facet.offset = vplDot(facet.normal, vplSub(corner, shading->view->eye));
    const bool fromBehind = facet.offset > 0;
    if (fromBehind && shading->def->lighting == VPL_LIGHTING_PHYSICAL) {
        facet.normal = vplNegate(facet.normal);
        facet.offset = -facet.offset;
    }
    if (!fromBehind && shading->def->emission) {
        memcpy(facet.reflector.emission, &emission, sizeof emission);
    }
    return facet;
}
