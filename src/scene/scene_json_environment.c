// SPDX-License-Identifier: MIT
// "environment" of a scene file: a constant radiance, a picture of all directions, or a sky.
#include "base/file.h"
#include "scene/scene_json.h"

#include <string.h>

static const double DEGREE = VPL_PI / 180;

static vplResult readSky(const vplJson* environment, vplEnvironmentDef* def)
{
    static const char* const keys[] = {"!elevation", "turbidity", NULL};
    const vplJson sky = vplJson_Member(environment, "sky");
    double degrees = 0;
    def->type = VPL_ENVIRONMENT_SKY;
    TRY(vplJson_CheckKeys(&sky, keys));
    TRY(vplJson_ReadNumber(&sky, "elevation", &degrees));
    if (!(degrees >= 0 && degrees <= 90)) {
        const vplJson elevation = vplJson_Member(&sky, "elevation");
        return vplJson_Fail(&elevation, "is %g, must be in [0, 90] degrees", degrees);
    }
    def->elevation = degrees < 90 ? degrees * DEGREE : VPL_PI / 2;
    TRY(vplJson_ReadNumber(&sky, "turbidity", &def->turbidity));
    return vplJson_ReportFault(&sky, vplCheckEnvironment(def));
}

static vplResult readPicture(vplSceneLoader* l, const vplJson* environment, const vplEnvironmentDef* def)
{
    const char* name = NULL;
    const vplJson member = vplJson_Member(environment, "file");
    TRY(vplJson_ReadString(environment, "file", &name));
    char* path = vplPathBeside(l->json.context, l->json.name, name, strlen(name));
    if (path == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    const vplResult result =
        vplIsRegularFile(l->json.context, path)
            ? vplScene_LoadEnvironment(l->scene, path, def)
            : vplJson_Fail(&member, "is \"%.80s\", but there is no file %.200s", name, path);
    vplFree(l->json.context, path);
    return result;
}

static vplResult readTurn(const vplJson* environment, vplEnvironmentDef* def)
{
    double degrees = 0;
    TRY(vplJson_ReadNumber(environment, "rotate", &degrees));
    if (!(degrees >= -1e6 && degrees <= 1e6)) {
        const vplJson rotate = vplJson_Member(environment, "rotate");
        return vplJson_Fail(&rotate, "is %g, must be in [-1e6, 1e6] degrees", degrees);
    }
    def->rotate = degrees * DEGREE;
    TRY(vplJson_ReadNumber(environment, "scale", &def->scale));
    return vplJson_ReportFault(environment, vplCheckEnvironment(def));
}

vplResult vplSceneLoader_ReadEnvironment(vplSceneLoader* l, const vplJson* root)
{
    static const char* const kinds[] = {"radiance", "file", "sky"};
    static const char* const keys[] = {"radiance", "file", "sky", "rotate", "scale", NULL};
    const vplJson environment = vplJson_Member(root, "environment");
    vplEnvironmentDef def = vplDefaultEnvironmentDef();
    int count = 0;
    if (environment.value == NULL) {
        return VPL_SUCCESS;
    }
    TRY(vplJson_CheckKeys(&environment, keys));
    for (int i = 0; i < 3; i++) {
        count += json_object_get(environment.value, kinds[i]) != NULL;
    }
    if (count != 1) {
        return vplJson_Fail(&environment,
                            "has %d of the keys \"radiance\", \"file\" and \"sky\", must have one", count);
    }
    TRY(readTurn(&environment, &def));
    if (json_object_get(environment.value, "file") != NULL) {
        return readPicture(l, &environment, &def);
    }
    if (json_object_get(environment.value, "sky") != NULL) {
        TRY(readSky(&environment, &def));
    } else {
        def.type = VPL_ENVIRONMENT_CONSTANT;
        TRY(vplJson_ReadFloats(&environment, "radiance", 3, &def.radiance));
        TRY(vplJson_ReportFault(&environment, vplCheckEnvironment(&def)));
    }
    return vplScene_SetEnvironment(l->scene, &def);
}
