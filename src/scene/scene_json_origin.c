// SPDX-License-Identifier: MIT
// Finds a near origin for scene files whose contents are far from (0, 0, 0). Looks at the numbers only: what
// has the wrong type is left to the functions that read and report it.
#include "scene/scene_json.h"

#include <math.h>

// A scene that is this many times as far away as it is large gets an origin of its own: float then has at
// least 19 of its 24 bits for what is inside.
static const double FAR = 32;

typedef struct Bounds {
    double low[3], high[3];
} Bounds;

// Adds the elements first .. first + 2 of an array.
static void addPoint(Bounds* b, json_t* array, size_t first)
{
    for (size_t i = 0; i < 3; i++) {
        json_t* number = json_array_get(array, first + i);
        if (json_is_number(number)) {
            const double x = json_number_value(number);
            b->low[i] = x < b->low[i] ? x : b->low[i];
            b->high[i] = x > b->high[i] ? x : b->high[i];
        }
    }
}

// Adds all that one camera, object, light or key places.
static void addThing(Bounds* b, json_t* thing)
{
    static const char* const keys[] = {"eye", "target", "translate", "position"};
    for (size_t i = 0; i < sizeof keys / sizeof *keys; i++) {
        addPoint(b, json_object_get(thing, keys[i]), 0);
    }
    addPoint(b, json_object_get(thing, "matrix"), 12);
    json_t *path = json_object_get(thing, "path"), *key;
    size_t k;
    json_array_foreach(path, k, key)
    {
        addPoint(b, json_object_get(key, "eye"), 0);
        addPoint(b, json_object_get(key, "target"), 0);
        addPoint(b, json_object_get(key, "position"), 0);
    }
}

void vplFindOrigin(json_t* root, double originOut[3])
{
    static const char* const arrays[] = {"cameras", "objects", "lights"};
    Bounds b = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    addThing(&b, json_object_get(root, "camera"));
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) {
        json_t *array = json_object_get(root, arrays[i]), *thing;
        size_t k;
        json_array_foreach(array, k, thing)
        {
            addThing(&b, thing);
        }
    }
    double half = 0, centre[3], farthest = 0;
    for (int i = 0; i < 3; i++) {
        centre[i] = 0.5 * (b.low[i] + b.high[i]);
        half = fmax(half, 0.5 * (b.high[i] - b.low[i]));
        farthest = fmax(farthest, fabs(centre[i]));
        originOut[i] = 0;
    }
    if (farthest > FAR * half && half > 0 && farthest <= 0.5 * (double)VPL_MAX_MAGNITUDE) {
        const double grid = ldexp(1, ilogb(half) + 2);
        for (int i = 0; i < 3; i++) {
            originOut[i] = rint(centre[i] / grid) * grid;
        }
    }
}
