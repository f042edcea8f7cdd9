#!/bin/sh
# SPDX-License-Identifier: MIT
# Writes six scenes by which the planner is only checked; no constant was chosen with them: tests/bench/planner/check_scenes.sh
# DIR. attic (the sky through two small windows), stairs (steps and banisters, a spot above and a point below), shop (600 boxes
# on shelves under 24 area lights), grove (300 trees of cones in the sun), passage (the light of one room through an open
# doorway into another), street (at night: windows that glow and four lamps between three houses).
set -e
dir=$1
mkdir -p "$dir"

camera() {
    echo "{\"camera\": {\"eye\": [$1], \"target\": [$2], \"up\": [0, 1, 0], \"fov_y\": $3, \"near\": 0.02, \"far\": $4},"
}

materials='"materials": {"white": {"diffuse": [0.75, 0.74, 0.7]}, "oak": {"diffuse": [0.5, 0.36, 0.22]}, "grey": {"diffuse": [0.35, 0.35, 0.37]},
"rust": {"diffuse": [0.55, 0.22, 0.1]}, "moss": {"diffuse": [0.14, 0.27, 0.09]}, "sea": {"diffuse": [0.12, 0.25, 0.4]},
"lamp": {"diffuse": [0.6, 0.6, 0.6], "emission": [9, 8.4, 7.2]}, "window": {"diffuse": [0.2, 0.2, 0.2], "emission": [3, 2.2, 1.1]}}, "objects": ['

# box MATERIAL X Y Z WIDTH HEIGHT DEPTH [TURN]: with a comma behind it.
box() {
    echo "{\"type\": \"box\", \"material\": \"$1\", \"translate\": [$2, $3, $4], \"scale\": [$5, $6, $7], \"rotate\": [0, ${8:-0}, 0]},"
}

# quad MATERIAL X Y Z PITCH TURN WIDTH HEIGHT: with a comma behind it.
quad() {
    echo "{\"type\": \"quad\", \"material\": \"$1\", \"translate\": [$2, $3, $4], \"rotate\": [$5, $6, 0], \"scale\": [$7, $8, 1]},"
}

# many SEED PROGRAM: what an awk program prints, in which u(a, b) is a uniform random number between a and b.
many() {
    awk "function u(a, b) { return a + (b - a) * rand() } BEGIN { srand($1); $2 }"
}

{
    camera "2.4, 1.5, 3.4" "-0.8, 1, -1.5" 65 200; echo '"environment": {"sky": {"elevation": 40, "turbidity": 3}, "rotate": 200},' "$materials"
    box oak 0 -0.05 0 6.2 0.1 8.2; box white 0 1.3 -4.05 6.2 2.6 0.1
    box white -3.05 0.5 0 0.1 1 8.2; box white -3.05 2.2 0 0.1 0.8 8.2      # the left wall, with two windows of 0.8 x 0.8 m
    box white -3.05 1.4 -3.05 0.1 0.8 2.1; box white -3.05 1.4 0 0.1 0.8 2.4; box white -3.05 1.4 3.05 0.1 0.8 2.1
    box white 3.05 1.3 0 0.1 2.6 8.2; box white 0 1.3 4.05 6.2 2.6 0.1; box white 0 2.65 0 6.2 0.1 8.2
    box oak -1 0.35 -2.4 1.6 0.7 0.8 12; box rust 1.6 0.5 -2.8 0.9 1 0.7 -20; box sea -1.9 0.25 0.8 0.5 0.5 0.5 33; box white 0.6 0.2 -1.2 1.2 0.4 0.6 5
    box oak 0 2.4 -1.2 6 0.2 0.2
    echo '{"type": "box", "material": "rust", "translate": [2.2, 0.15, 0.4], "scale": [0.5, 0.3, 0.7]}]}'
} > "$dir/attic.json"

{
    camera "0.2, 1.9, 4.6" "0, 2.1, -1" 62 60; echo "$materials"
    quad grey 0 0 1 -90 0 5 9; quad white 0 6 1 90 0 5 9; quad white 0 3 -3.5 0 0 5 6; quad white 0 3 5.5 0 180 5 6; quad sea -2.5 3 1 0 90 9 6; quad white 2.5 3 1 0 -90 9 6
    many 1 'for (i = 0; i < 16; i++) { printf "{\"type\": \"box\", \"material\": \"oak\", \"translate\": [-0.6, %.3f, %.3f], \"scale\": [1.8, 0.18, 0.32]},\n", 0.09 + 0.18 * i, 2.2 - 0.3 * i
        for (k = 0; k < 2; k++) printf "{\"type\": \"box\", \"material\": \"white\", \"translate\": [%.3f, %.3f, %.3f], \"scale\": [0.04, 0.9, 0.04]},\n", k ? 0.28 : -1.48, 0.63 + 0.18 * i, 2.2 - 0.3 * i }'
    box rust 1.5 0.4 1.6 0.8 0.8 0.8 25
    echo '{"type": "box", "material": "grey", "translate": [1.6, 0.6, -1.8], "scale": [0.5, 1.2, 0.5]}],
"lights": [{"type": "spot", "position": [-1.8, 5.6, 0.5], "direction": [0.35, -1, -0.3], "intensity": [60, 56, 48], "inner_angle": 18, "outer_angle": 26},
{"type": "point", "position": [1.9, 1.2, 0.2], "intensity": [2, 1.7, 1.2]}]}'
} > "$dir/stairs.json"

{
    camera "-5.6, 1.7, 6.2" "1, 1, -1.5" 60 80; echo "$materials"
    quad grey 0 0 0 -90 0 14 16; quad white 0 3.2 0 90 0 14 16; quad white 0 1.6 -8 0 0 14 3.2; quad white 0 1.6 8 0 180 14 3.2; quad white -7 1.6 0 0 90 16 3.2; quad rust 7 1.6 0 0 -90 16 3.2
    many 2 'for (i = 0; i < 24; i++) printf "{\"type\": \"quad\", \"material\": \"lamp\", \"translate\": [%.3f, 3.15, %.3f], \"rotate\": [90, 0, 0], \"scale\": [1.2, 0.3, 1]},\n", -5.5 + 11 / 3 * (i % 4), -6.5 + 13 / 5 * int(i / 4)'
    many 3 'split("oak rust moss sea white", m, " "); for (s = 0; s < 5; s++) for (h = 0; h < 4; h++) { y = 0.2 + 0.5 * h; z = -6 + 2.4 * s
        printf "{\"type\": \"box\", \"material\": \"grey\", \"translate\": [1, %.3f, %.3f], \"scale\": [9, 0.04, 0.5]},\n", y, z
        for (i = 0; i < 30; i++) { t = u(0.1, 0.34); printf "{\"type\": \"box\", \"material\": \"%s\", \"translate\": [%.3f, %.3f, %.3f], \"rotate\": [0, %.1f, 0], \"scale\": [%.3f, %.3f, 0.2]},\n", m[int(u(1, 6))], -3.3 + 0.29 * i, y + 0.02 + t / 2, z + u(-0.08, 0.08), u(-20, 20), u(0.12, 0.26), t } }'
    echo '{"type": "box", "material": "oak", "translate": [-5.5, 0.5, 1], "scale": [1.2, 1, 2.4]}]}'
} > "$dir/shop.json"

many 4 'sides = 12; n = 0; for (k = 0; k < 300; k++) { x = u(-30, 30); z = u(-42, 12); h = u(3, 8); r = h * u(0.12, 0.2)
    for (c = 0; c < 3; c++) { b = h * (0.15 + 0.25 * c); t = h * (0.55 + 0.225 * c); q = r * (1 - 0.25 * c)
        printf "v %.3f %.3f %.3f\n", x, t, z
        for (j = 0; j < sides; j++) printf "v %.3f %.3f %.3f\n", x + q * cos(6.2831853 * j / sides), b, z + q * sin(6.2831853 * j / sides)
        for (j = 0; j < sides; j++) { print "f", n + 1, n + 2 + (j + 1) % sides, n + 2 + j; if (j > 0 && j < sides - 1) print "f", n + 2, n + 2 + j, n + 3 + j }
        n += 1 + sides } }' > "$dir/grove.obj"
{
    camera "0, 1.8, 16" "0, 2.6, 0" 55 300; echo '"environment": {"sky": {"elevation": 25, "turbidity": 4}, "rotate": 60},' "$materials"
    quad oak 0 0 -10 -90 0 120 120
    echo '{"type": "mesh", "file": "grove.obj", "material": "moss"}]}'
} > "$dir/grove.json"

{
    camera "4.6, 1.6, 2.2" "1.2, 1, -1" 60 60; echo "$materials"
    quad oak 0.5 0 0 -90 0 11 6; quad white 0.5 2.6 0 90 0 11 6; quad white 0.5 1.3 -3 0 0 11 2.6; quad white 0.5 1.3 3 0 180 11 2.6; quad moss -5 1.3 0 0 90 6 2.6; quad white 6 1.3 0 0 -90 6 2.6
    box white 0 1.3 -2.05 0.15 2.6 1.9; box white 0 1.3 1.4 0.15 2.6 3.2; box white 0 2.35 -0.65 0.15 0.5 0.9
    box oak 2.6 0.37 -1.6 1.5 0.74 0.9 8; box sea 4.2 0.25 -2.2 0.6 0.5 0.6 30; box rust -1.2 0.9 1.2 0.05 1.8 1.4
    echo '{"type": "quad", "material": "lamp", "translate": [-2.6, 2.55, 1.6], "rotate": [90, 0, 0], "scale": [1, 0.6, 1]}]}'
} > "$dir/passage.json"

{
    camera "-3, 1.7, 19" "1, 3, 0" 58 200; echo "$materials"
    quad grey 0 0 0 -90 0 80 80
    many 5 'for (b = 0; b < 3; b++) { x = b == 1 ? 9 : -9; z = b == 2 ? 8 : -4 - 8 * (b == 1); w = 9; h = 9 + 2 * b
        printf "{\"type\": \"box\", \"material\": \"%s\", \"translate\": [%g, %g, %g], \"scale\": [%g, %g, 9]},\n", b == 1 ? "rust" : "white", x, h / 2, z, w, h
        for (f = 0; f < 4; f++) for (i = 0; i < 4; i++) if (u(0, 1) < 0.6) { s = x < 0 ? 1 : -1
            printf "{\"type\": \"quad\", \"material\": \"window\", \"translate\": [%.3f, %.3f, %.3f], \"rotate\": [0, %d, 0], \"scale\": [0.9, 1.3, 1]},\n", x + s * (w / 2 + 0.02), 1.8 + 2.2 * f, z - 3.3 + 2.2 * i, 90 * s } }'
    box sea 0.5 0.7 6 1.8 1.4 4 10; box oak -2.2 0.45 2 1.6 0.9 0.5 70
    echo '{"type": "box", "material": "moss", "translate": [2.8, 0.6, -3], "scale": [1.2, 1.2, 6]}], "lights": ['
    many 6 'for (i = 0; i < 4; i++) printf "%s{\"type\": \"point\", \"position\": [%g, 4.2, %g], \"intensity\": [26, 21, 13]}", i ? ",\n" : "", i % 2 ? 3.6 : -3.6, 12 - 7 * i'
    echo ']}'
} > "$dir/street.json"
