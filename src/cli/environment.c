// SPDX-License-Identifier: MIT
// --environment and --sky: light from outside, instead of what the scene file says.
#include "cli/cli.h"

#include <stdlib.h>
#include <string.h>

static const double DEGREE = VPL_PI / 180;

// Reads 1 to `most` numbers with commas between. Returns how many; 0 if the text is anything else.
static int parseReals(const char* text, int most, double* out)
{
    for (int count = 0; count < most; text++) {
        char* end;
        if (strchr("0123456789.+-", *text) == NULL || *text == 0) {
            return 0;
        }
        out[count++] = strtod(text, &end);
        if (end == text || (*end != ',' && *end != 0)) {
            return 0;
        }
        text = end;
        if (*end == 0) {
            return count;
        }
    }
    return 0;
}

bool parseSky(const char* value, vplEnvironmentDef* out)
{
    double numbers[3] = {0, 3, 0};
    if (parseReals(value, 3, numbers) == 0 || !(numbers[0] >= 0 && numbers[0] <= 90) ||
        !(numbers[1] >= 2 && numbers[1] <= 10) || !(numbers[2] >= -1e6 && numbers[2] <= 1e6)) {
        return false;
    }
    out->type = VPL_ENVIRONMENT_SKY;
    out->elevation = numbers[0] < 90 ? numbers[0] * DEGREE : VPL_PI / 2;
    out->turbidity = numbers[1];
    out->rotate = numbers[2] * DEGREE;
    return true;
}

vplResult addEnvironment(const Arguments* a, vplScene* scene)
{
    double rgb[3];
    vplEnvironmentDef def = vplDefaultEnvironmentDef();
    if (a->sky != NULL) {
        parseSky(a->sky, &def); // its option has accepted it
        return vplScene_SetEnvironment(scene, &def);
    }
    if (a->environment == NULL) {
        return VPL_SUCCESS;
    }
    if (parseReals(a->environment, 3, rgb) != 3) {
        return vplScene_LoadEnvironment(scene, a->environment, &def);
    }
    def.type = VPL_ENVIRONMENT_CONSTANT;
    def.radiance = (vplRgb){(float)rgb[0], (float)rgb[1], (float)rgb[2]};
    return vplScene_SetEnvironment(scene, &def);
}

const char* describeEnvironment(const vplScene* scene)
{
    static const char* const NAMES[] = {"none", "constant", "picture", "sky"};
    return NAMES[vplScene_GetEnvironment(scene)->type];
}
