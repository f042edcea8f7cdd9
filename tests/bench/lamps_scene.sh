#!/bin/sh
# SPDX-License-Identifier: MIT
# Prints a hall of 40 x 4 x 40 m with 60 blocks and N lamps below its ceiling, 4 kW/sr together:
#     tests/bench/lamps_scene.sh N points|spots|quads
awk -v n="$1" -v kind="$2" '
function at(i) { return sprintf("[%.3f, %.3f, %.3f]", 39 * rand() - 19.5, 3.2 + 0.6 * rand(), 39 * rand() - 19.5) }
function quad(name, material, translate, rotate, scale) {
    printf "%s{\"name\": \"%s\", \"type\": \"quad\", \"material\": \"%s\", \"translate\": %s, \"rotate\": %s, \"scale\": %s}\n",
        comma, name, material, translate, rotate, scale; comma = ","
}
BEGIN {
    srand(13)
    each = 4000 / n; side = 0.02
    print "{\"camera\": {\"eye\": [12, 2.5, 18], \"target\": [0, 1, 0], \"up\": [0, 1, 0], \"fov_y\": 50, \"near\": 0.1, \"far\": 100},"
    print "\"materials\": {\"white\": {\"diffuse\": [0.7, 0.7, 0.7]}, \"red\": {\"diffuse\": [0.7, 0.2, 0.2]},"
    printf "\"lamp\": {\"diffuse\": [0.5, 0.5, 0.5], \"emission\": [%g, %g, %g]}}, \"objects\": [\n",
        each / side / side, 0.9 * each / side / side, 0.8 * each / side / side
    quad("floor", "white", "[0, 0, 0]", "[-90, 0, 0]", "[40, 40, 1]")
    quad("ceiling", "white", "[0, 4, 0]", "[90, 0, 0]", "[40, 40, 1]")
    quad("left", "red", "[-20, 2, 0]", "[0, 90, 0]", "[40, 4, 1]")
    quad("right", "white", "[20, 2, 0]", "[0, -90, 0]", "[40, 4, 1]")
    quad("back", "white", "[0, 2, -20]", "[0, 0, 0]", "[40, 4, 1]")
    quad("front", "white", "[0, 2, 20]", "[0, 180, 0]", "[40, 4, 1]")
    for (i = 0; i < 60; i++)
        printf ",{\"name\": \"block %d\", \"type\": \"box\", \"material\": \"white\", \"translate\": [%.3f, 0.9, %.3f], \"rotate\": [0, %.1f, 0], \"scale\": [1, 1.8, 1]}\n",
            i, 36 * rand() - 18, 30 * rand() - 18, 90 * rand()
    for (i = 0; i < n && kind == "quads"; i++)
        quad("lamp " i, "lamp", at(), "[90, 0, 0]", "[" side ", " side ", 1]")
    printf "]"
    if (kind != "quads") printf ", \"lights\": ["
    for (i = 0; i < n && kind != "quads"; i++)
        printf "%s{\"type\": \"%s\", \"position\": %s, \"intensity\": [%g, %g, %g]%s}\n", i ? "," : "",
            kind == "spots" ? "spot" : "point", at(), each, 0.9 * each, 0.8 * each,
            kind == "spots" ? ", \"direction\": [0, -1, 0], \"inner_angle\": 30, \"outer_angle\": 60" : ""
    print kind == "quads" ? "}" : "]}"
}'
