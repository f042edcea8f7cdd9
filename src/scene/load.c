// SPDX-License-Identifier: MIT
// What a path given as scene is: an OBJ file by its name, else JSON.
#include "scene/scene.h"

#include <string.h>

static bool isObj(const char* path)
{
    size_t length = strlen(path);
    const char* end = length >= 4 ? path + length - 4 : "";
    return end[0] == '.' && (end[1] | 32) == 'o' && (end[2] | 32) == 'b' && (end[3] | 32) == 'j';
}

vplResult vplScene_Load(vplContext* context, const char* path, vplScene** sceneOut)
{
    return isObj(path) ? vplScene_LoadObjAlone(context, path, sceneOut)
                       : vplScene_LoadJson(context, path, sceneOut);
}
