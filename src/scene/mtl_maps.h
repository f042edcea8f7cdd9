// SPDX-License-Identifier: MIT
// Pictures that MTL files name.
#ifndef VPL_SCENE_MTL_MAPS_H
#define VPL_SCENE_MTL_MAPS_H

#include "base/arena.h"
#include "scene/obj_text.h"
#include "scene/scene.h"

typedef struct vplObjMap {
    char* path;        // NULL: none
    const char* where; // the place in the MTL file
    float scale[2], offset[2];
    bool clamp;
} vplObjMap;

// Reads what follows map_Kd or map_d. Without a file name *map stays as it is.
vplResult vplMtl_ReadMap(vplArena* arena, const vplText* text, vplWord line, vplObjMap* map);

#endif
