// SPDX-License-Identifier: MIT
#ifndef VPL_SCENE_GLTF_H
#define VPL_SCENE_GLTF_H

#include "scene/model.h"

vplResult vplScene_ReadGltf(vplScene* scene, const char* path, bool whole, vplModel* model);

#endif
