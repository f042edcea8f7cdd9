// SPDX-License-Identifier: MIT
#include "scene/gltf.h"

vplResult vplScene_ReadGltf(vplScene* scene, const char* path, bool whole, vplModel* model)
{
    (void)whole;
    (void)model;
    return vplFail(scene->context, VPL_PARSE_ERROR, "%s: not yet", path);
}
