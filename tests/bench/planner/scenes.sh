#!/bin/sh
# Writes the scenes that the planner is tried on, besides those of examples/scenes: tests/bench/planner/scenes.sh DIR
# [BUNNY.obj]. hall (a dark hall, its door ajar to a bright room), plain (boxes in the sun), furnace (all walls emit and
# reflect), shade (a lamp in a box with a slit), boxes (1,000 small ones in a room), lamps (1,000 point lights), furnished
# (a flat with 90,000 triangles of turned furniture), and bunny (in a room) where its file is given.
set -e
dir=$1
bunny=$2
mkdir -p "$dir"

# room WIDTH HEIGHT DEPTH: six walls around the origin of the floor, without a comma at the end.
room() {
    awk -v w="$1" -v h="$2" -v d="$3" 'BEGIN {
        q = "{\"name\": \"%s\", \"type\": \"quad\", \"material\": \"%s\", \"translate\": [%g, %g, %g], \"rotate\": [%g, %g, 0], \"scale\": [%g, %g, 1]}%s\n"
        printf q, "floor", "wood", 0, 0, 0, -90, 0, w, d, ","
        printf q, "ceiling", "white", 0, h, 0, 90, 0, w, d, ","
        printf q, "back", "white", 0, h / 2, -d / 2, 0, 0, w, h, ","
        printf q, "front", "white", 0, h / 2, d / 2, 0, 180, w, h, ","
        printf q, "left", "red", -w / 2, h / 2, 0, 0, 90, d, h, ","
        printf q, "right", "green", w / 2, h / 2, 0, 0, -90, d, h, ""
    }'
}

materials='"materials": {"white": {"diffuse": [0.72, 0.7, 0.66]}, "wood": {"diffuse": [0.45, 0.32, 0.21]},
"red": {"diffuse": [0.58, 0.15, 0.11]}, "green": {"diffuse": [0.21, 0.42, 0.18]}, "blue": {"diffuse": [0.16, 0.24, 0.48]},
"lamp": {"diffuse": [0.5, 0.5, 0.5], "emission": [20, 18, 15]}, "oven": {"diffuse": [0.5, 0.5, 0.5], "emission": [0.5, 0.5, 0.5]}},'

camera() {
    echo "\"camera\": {\"eye\": [$1], \"target\": [$2], \"up\": [0, 1, 0], \"fov_y\": $3, \"near\": 0.02, \"far\": $4},"
}

# The wall between hall and room stands at x = 0; the door, 0.9 m wide, is open by 12 degrees.
{
    echo "{"; camera "-0.5, 1.6, 2.2" "-2.6, 0.9, -1.4" 60 50; echo "$materials" '"objects": ['
    room 8 2.7 5
    echo ',{"name": "wall a", "type": "box", "material": "white", "translate": [0, 1.35, -1.75], "scale": [0.12, 2.7, 1.5]},
{"name": "wall b", "type": "box", "material": "white", "translate": [0, 1.35, 1.2], "scale": [0.12, 2.7, 2.6]},
{"name": "lintel", "type": "box", "material": "white", "translate": [0, 2.4, -0.55], "scale": [0.12, 0.6, 0.9]},
{"name": "door", "type": "box", "material": "white", "translate": [0.092, 1.05, -0.56], "rotate": [0, 12, 0], "scale": [0.04, 2.08, 0.9]},
{"name": "chest", "type": "box", "material": "blue", "translate": [-1.4, 0.3, -1.9], "rotate": [0, 15, 0], "scale": [1, 0.6, 0.6]},
{"name": "table", "type": "box", "material": "wood", "translate": [2, 0.4, 0], "scale": [1.2, 0.8, 0.8]}],
"lights": [{"type": "point", "position": [2.2, 2.2, 0.4], "intensity": [14, 13, 12]}]}'
} > "$dir/hall.json"

{
    echo "{"; camera "9, 5, 12" "0, 0.8, 0" 45 1000; echo "$materials" '"objects": ['
    echo '{"name": "ground", "type": "quad", "material": "wood", "translate": [0, 0, 0], "rotate": [-90, 0, 0], "scale": [400, 400, 1]}'
    awk 'BEGIN { for (i = 0; i < 9; i++)
        printf ",{\"name\": \"block %d\", \"type\": \"box\", \"material\": \"%s\", \"translate\": [%g, %g, %g], \"rotate\": [0, %g, 0], \"scale\": [1.4, %g, 1.4]}\n",
            i, i % 2 ? "white" : "red", (i % 3 - 1) * 3, 0.5 + 0.3 * (i % 4), (int(i / 3) - 1) * 3, 17 * i, 1 + 0.6 * (i % 4) }'
    echo '], "lights": [{"type": "directional", "direction": [-0.5, -1, -0.3], "irradiance": [3, 2.8, 2.4]}]}'
} > "$dir/plain.json"

{
    echo "{"; camera "0, 1.5, 3.4" "0, 1.3, 0" 60 50; echo "$materials" '"objects": ['
    room 6 3 7 | sed 's/"material": "[a-z]*"/"material": "oven"/'
    echo ',{"name": "block", "type": "box", "material": "oven", "translate": [0.5, 0.6, -0.5], "rotate": [0, 30, 0], "scale": [1.2, 1.2, 1.2]}],
"lights": []}'
} > "$dir/furnace.json"

# The lamp shines out of a slit of 6 cm in a box of 0.5 m.
{
    echo "{"; camera "2.2, 1.6, -2.7" "-0.6, 0.9, 0.4" 60 50; echo "$materials" '"objects": ['
    room 6 2.7 6
    echo ',{"name": "base", "type": "box", "material": "white", "translate": [0, 1, -1], "scale": [0.5, 0.02, 0.5]},
{"name": "top", "type": "box", "material": "white", "translate": [0, 1.5, -1], "scale": [0.5, 0.02, 0.5]},
{"name": "side 1", "type": "box", "material": "white", "translate": [-0.25, 1.25, -1], "scale": [0.02, 0.5, 0.5]},
{"name": "side 2", "type": "box", "material": "white", "translate": [0.25, 1.25, -1], "scale": [0.02, 0.5, 0.5]},
{"name": "side 3", "type": "box", "material": "white", "translate": [0, 1.25, -1.25], "scale": [0.5, 0.5, 0.02]},
{"name": "side 4", "type": "box", "material": "white", "translate": [0, 1.105, -0.75], "scale": [0.5, 0.21, 0.02]},
{"name": "side 5", "type": "box", "material": "white", "translate": [0, 1.385, -0.75], "scale": [0.5, 0.23, 0.02]},
{"name": "stand", "type": "box", "material": "wood", "translate": [0, 0.5, -1], "scale": [0.1, 0.98, 0.1]},
{"name": "bulb", "type": "quad", "material": "lamp", "translate": [0, 1.48, -1], "rotate": [90, 0, 0], "scale": [0.2, 0.2, 1]}],
"lights": []}'
} > "$dir/shade.json"

{
    echo "{"; camera "-2.6, 1.9, 3.2" "0.2, 0.8, -0.6" 60 50; echo "$materials" '"objects": ['
    room 7 3 7
    awk 'BEGIN { srand(7); split("white wood red green blue", m, " "); for (i = 0; i < 1000; i++)
        printf ",{\"name\": \"box %d\", \"type\": \"box\", \"material\": \"%s\", \"translate\": [%.4f, %.4f, %.4f], \"rotate\": [%.1f, %.1f, 0], \"scale\": [%.3f, %.3f, %.3f]}\n",
            i, m[i % 5 + 1], 5 * rand() - 2, 0.05 + 1.6 * rand() * rand(), 5 * rand() - 3.2, 90 * rand(), 90 * rand(),
            0.05 + 0.1 * rand(), 0.05 + 0.1 * rand(), 0.05 + 0.1 * rand() }'
    echo '], "lights": [{"type": "point", "position": [1, 2.6, 1], "intensity": [14, 13, 12]}]}'
} > "$dir/boxes.json"

{
    echo "{"; camera "-8, 2.2, 9" "1, 1, -2" 60 80; echo "$materials" '"objects": ['
    room 20 4 20
    awk 'BEGIN { srand(11); for (i = 0; i < 30; i++)
        printf ",{\"name\": \"block %d\", \"type\": \"box\", \"material\": \"white\", \"translate\": [%.3f, %.3f, %.3f], \"rotate\": [0, %.1f, 0], \"scale\": [0.8, 1.2, 0.8]}\n",
            i, 16 * rand() - 8, 0.6, 14 * rand() - 9, 90 * rand() }'
    echo '], "lights": ['
    awk 'BEGIN { srand(13); for (i = 0; i < 1000; i++)
        printf "%s{\"type\": \"point\", \"position\": [%.3f, %.3f, %.3f], \"intensity\": [%.4f, %.4f, %.4f]}\n",
            i ? "," : "", 19 * rand() - 9.5, 3.2 + 0.6 * rand(), 19 * rand() - 9.5, 0.15 * rand(), 0.15 * rand(), 0.15 * rand() }'
    echo ']}'
} > "$dir/lamps.json"

# Vases, table legs and stools, turned from profiles: 48 of them with 960 quads each.
awk 'BEGIN {
    srand(5); rings = 20; sides = 48; pi = 3.14159265; n = 0
    for (k = 0; k < 48; k++) {
        print "o turned" k; print "usemtl m"
        x = 0.6 + 14.8 * rand(); z = 0.6 + 6.8 * rand(); h = 0.3 + 0.9 * rand(); r = 0.08 + 0.17 * rand(); f = 2 + 5 * rand()
        for (i = 0; i <= rings; i++) for (j = 0; j < sides; j++) {
            t = i / rings; q = r * (0.55 + 0.45 * cos(f * t)) * (i < rings ? 1 : 0.02)
            printf "v %.5f %.5f %.5f\n", x + q * cos(2 * pi * j / sides), 0.001 + h * t, z + q * sin(2 * pi * j / sides)
        }
        for (i = 0; i < rings; i++) for (j = 0; j < sides; j++) {
            a = n + i * sides + j + 1; b = n + i * sides + (j + 1) % sides + 1
            print "f", a, a + sides, b + sides, b
        }
        n += (rings + 1) * sides
    }
}' > "$dir/turned.obj"
flat=$(dirname "$0")/../../../examples/scenes/flat.json
awk '/"objects": \[/ { print; print "{\"name\": \"furniture\", \"type\": \"mesh\", \"file\": \"turned.obj\", \"material\": \"white\"},"; next } { print }' \
    "$flat" > "$dir/furnished.json"

[ -z "$bunny" ] || {
    cp "$bunny" "$dir/bunny.obj"
    echo "{"; camera "-2.2, 1.5, 2.6" "0, 0.7, -0.3" 50 50; echo "$materials" '"objects": ['
    room 6 2.8 6
    echo ',{"name": "bunny", "type": "mesh", "file": "bunny.obj", "material": "white", "translate": ['"${BUNNY_PLACE:-0, 0, 0}"'], "scale": ['"${BUNNY_SCALE:-1, 1, 1}"']}],
"lights": [{"type": "point", "position": [1.6, 2.4, 1.2], "intensity": [12, 11, 10]}]}'
} > "$dir/bunny.json"
