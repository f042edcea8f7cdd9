// SPDX-License-Identifier: MIT
// Nodes of glTF files: a forest, whose places are multiplied from the roots on.
#include "scene/gltf.h"

#include <math.h>
#include <string.h>

enum { MOST_DEEP = 1024 };

// ---- places

vplResult vplGltf_ReadPlace(const vplJson* node, vplGltfPlace* out)
{
    TRY(vplJson_ReadDoubles(node, "translation", 3, out->translation));
    TRY(vplJson_ReadDoubles(node, "rotation", 4, out->rotation));
    return vplJson_ReadDoubles(node, "scale", 3, out->scale);
}

vplAffine vplGltfPlace_ToAffine(const vplGltfPlace* p)
{
    double q[4], square = 0;
    vplAffine a;
    for (int i = 0; i < 4; i++) {
        square += p->rotation[i] * p->rotation[i];
    }
    const double length = sqrt(square);
    for (int i = 0; i < 4; i++) { // a quaternion of length 0 turns nothing
        q[i] = length > 0 && length < INFINITY ? p->rotation[i] / length : i == 3;
    }
    const double x = q[0], y = q[1], z = q[2], w = q[3];
    const double turn[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
                               {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
                               {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}};
    for (int row = 0; row < 3; row++) {
        for (int column = 0; column < 3; column++) {
            a.m[row][column] = turn[row][column] * p->scale[column];
        }
        a.m[row][3] = p->translation[row];
    }
    return a;
}

static vplResult readLocal(const vplJson* node, vplAffine* out)
{
    vplGltfPlace place = {{0, 0, 0}, {0, 0, 0, 1}, {1, 1, 1}};
    const vplJson matrix = vplJson_Member(node, "matrix");
    if (matrix.value == NULL) {
        TRY(vplGltf_ReadPlace(node, &place));
        *out = vplGltfPlace_ToAffine(&place);
        return VPL_SUCCESS;
    }
    double m[16];
    TRY(vplJson_ReadDoubles(node, "matrix", 16, m));
    if (fabs(m[3]) + fabs(m[7]) + fabs(m[11]) + fabs(m[15] - 1) > 1e-6) {
        return vplJson_Fail(&matrix, "has the last row (%g, %g, %g, %g), must be affine: (0, 0, 0, 1)", m[3],
                            m[7], m[11], m[15]);
    }
    for (int row = 0; row < 3; row++) {
        for (int column = 0; column < 4; column++) {
            out->m[row][column] = m[4 * column + row];
        }
    }
    return VPL_SUCCESS;
}

// ---- the forest

// Reads what a node has, and its place in its parent.
static vplResult readNode(vplGltf* g, int index)
{
    vplGltfNode* n = &g->nodes[index];
    const vplJson node = vplGltf_Item(g, VPL_GLTF_NODES, index),
                  extensions = vplJson_Member(&node, "extensions"),
                  punctual = vplJson_Member(&extensions, "KHR_lights_punctual");
    n->mesh = n->camera = n->light = -1;
    TRY(vplGltf_ReadIndex(&node, "mesh", vplGltf_Count(g, VPL_GLTF_MESHES), &n->mesh));
    TRY(vplGltf_ReadIndex(&node, "camera", vplGltf_Count(g, VPL_GLTF_CAMERAS), &n->camera));
    if (punctual.value != NULL) {
        TRY(vplGltf_ReadIndex(&punctual, "light", vplGltf_Count(g, VPL_GLTF_LIGHTS), &n->light));
    }
    return readLocal(&node, &n->toParent);
}

// Sets the parents of a node's children; a node has one parent at most.
static vplResult readChildren(vplGltf* g, int index)
{
    const vplJson node = vplGltf_Item(g, VPL_GLTF_NODES, index), children = vplJson_Member(&node, "children");
    if (children.value == NULL) {
        return VPL_SUCCESS;
    }
    TRY(vplJson_RequireArray(&children));
    for (size_t i = 0; i < json_array_size(children.value); i++) {
        const vplJson element = vplJson_Element(&children, (int)i);
        int child = -1;
        TRY(vplGltf_ReadElement(&element, vplGltf_Count(g, VPL_GLTF_NODES), &child));
        if (g->nodes[child].parent >= 0) {
            return vplJson_Fail(&element, "is %d, a child of nodes[%d] already", child,
                                g->nodes[child].parent);
        }
        g->nodes[child].parent = index;
    }
    return VPL_SUCCESS;
}

// Marks the roots of the scene that the file shows: the one it names, else the first, else all roots.
static vplResult markRoots(vplGltf* g)
{
    int shown = 0;
    const int scenes = vplGltf_Count(g, VPL_GLTF_SCENES);
    for (int i = 0; i < vplGltf_Count(g, VPL_GLTF_NODES); i++) {
        g->nodes[i].inScene = scenes == 0 && g->nodes[i].parent < 0;
    }
    TRY(vplGltf_ReadIndex(&g->root, "scene", scenes, &shown));
    if (scenes == 0) {
        return VPL_SUCCESS;
    }
    const vplJson scene = vplGltf_Item(g, VPL_GLTF_SCENES, shown), roots = vplJson_Member(&scene, "nodes");
    if (roots.value == NULL) {
        return VPL_SUCCESS;
    }
    TRY(vplJson_RequireArray(&roots));
    for (size_t i = 0; i < json_array_size(roots.value); i++) {
        const vplJson element = vplJson_Element(&roots, (int)i);
        int root = -1;
        TRY(vplGltf_ReadElement(&element, vplGltf_Count(g, VPL_GLTF_NODES), &root));
        if (g->nodes[root].parent >= 0) {
            return vplJson_Fail(&element, "is %d, must be a root, not a child of nodes[%d]", root,
                                g->nodes[root].parent);
        }
        g->nodes[root].inScene = true;
    }
    return VPL_SUCCESS;
}

// Orders the nodes so that parents precede children, which finds cycles: their nodes are no root's descendants.
static vplResult orderNodes(vplGltf* g)
{
    const int count = vplGltf_Count(g, VPL_GLTF_NODES);
    int* depths = vplArena_AllocZero(g->scratch, (size_t)count, sizeof *depths);
    TRY(vplArena_Check(g->scratch));
    for (int i = 0; i < count; i++) {
        if (g->nodes[i].parent < 0) {
            g->order[g->orderCount++] = i;
            depths[i] = 1;
        }
    }
    for (int k = 0; k < g->orderCount; k++) {
        const vplJson node = vplGltf_Item(g, VPL_GLTF_NODES, g->order[k]),
                      children = vplJson_Member(&node, "children");
        const int depth = depths[g->order[k]];
        for (size_t i = 0; i < json_array_size(children.value); i++) {
            const int child = (int)json_number_value(json_array_get(children.value, i));
            depths[child] = depth + 1;
            g->order[g->orderCount++] = child;
        }
        if (depth > MOST_DEEP) {
            return vplJson_Fail(&node, "has more than %d nodes above it", MOST_DEEP);
        }
    }
    for (int i = 0; i < count && g->orderCount < count; i++) {
        if (depths[i] == 0) {
            const vplJson node = vplGltf_Item(g, VPL_GLTF_NODES, i);
            return vplJson_Fail(&node, "is its own ancestor or has one that is: must be a tree");
        }
    }
    return VPL_SUCCESS;
}

vplResult vplGltf_ReadNodes(vplGltf* g)
{
    const int count = vplGltf_Count(g, VPL_GLTF_NODES);
    g->nodes = vplArena_AllocZero(g->scratch, (size_t)count, sizeof *g->nodes);
    g->order = vplArena_Alloc(g->scratch, (size_t)count, sizeof *g->order);
    TRY(vplArena_Check(g->scratch));
    for (int i = 0; i < count; i++) {
        g->nodes[i].parent = -1;
    }
    for (int i = 0; i < count; i++) {
        TRY(readNode(g, i));
        TRY(readChildren(g, i));
    }
    TRY(markRoots(g));
    TRY(orderNodes(g));
    for (int k = 0; k < g->orderCount; k++) {
        vplGltfNode* n = &g->nodes[g->order[k]];
        n->toModel = n->toParent;
        if (n->parent >= 0) {
            n->inScene = g->nodes[n->parent].inScene;
            n->toModel = vplAffine_Multiply(&g->nodes[n->parent].toModel, &n->toParent);
        }
    }
    return VPL_SUCCESS;
}
