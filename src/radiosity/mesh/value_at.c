// SPDX-License-Identifier: MIT
// Interpolated values at points of patches.
#include "radiosity/mesh/patch_mesh.h"

#include <string.h>

void vplPatchMesh_ListPatches(const vplPatchMesh* mesh, int* firstOut)
{
    int patch = 0;
    for (int i = 0; i < mesh->triangleCount; i++) {
        for (; patch <= mesh->patchOf[i]; patch++) {
            firstOut[patch] = i;
        }
    }
    for (; patch <= mesh->sides->patches->patchCount; patch++) {
        firstOut[patch] = mesh->triangleCount;
    }
}

static double leastOf(const double w[3])
{
    const double least = w[0] < w[1] ? w[0] : w[1];
    return least < w[2] ? least : w[2];
}

// The point is in the triangle of the patch in which its least barycentric is largest, also where rounding put it
// beside all of them.
vplRgb vplPatchMesh_ValueAt(const vplPatchMesh* mesh, const int* first, const vplPatchPoint* point,
                            const vplRgb* vertexValues)
{
    const uint32_t* in = NULL;
    double w[3] = {0, 0, 0}, sum[3] = {0, 0, 0}, total = 0;
    for (int i = first[point->patch]; i < first[point->patch + 1]; i++) {
        const uint32_t* index = mesh->indices + 3 * (size_t)i;
        const vplTriangleCorners corners = vplCornersOf(mesh->positions, index);
        double here[3];
        vplTriangle_Barycentrics(corners.corner, point->position, here);
        if (in == NULL || leastOf(here) > leastOf(w)) {
            in = index;
            memcpy(w, here, sizeof w);
        }
    }
    for (int k = 0; k < 3 && in != NULL; k++) {
        const double weight = w[k] > 0 ? w[k] : 0;
        vplAddRgb(sum, weight, vertexValues[2 * (size_t)in[k] + (size_t)point->face]);
        total += weight;
    }
    return total > 0 ? vplDivideRgb(sum, total) : (vplRgb){0, 0, 0};
}
