#!/bin/sh
# Renders the README's pictures: tests/gallery.sh VPL. Small, so that the repository stays small.
set -e
vpl=$1
out=golden/gallery
room=examples/scenes/room.json
closed=examples/scenes/closed-room.json
mkdir -p $out
shot() {
    name=$1
    shift
    "$vpl" render "$@" -o "$out/$name.png" --quiet
}
shot documented $closed --size 360x315 --lighting documented --exposure 0.5 --pcf 64 --pcf-offset 0.12
shot physical $closed --size 360x315 --particles 4000 --sampler halton --reflectivity auto --pcf 64 --pcf-offset 0.12 --tonemap reinhard --exposure 1
shot direct $closed --size 240x210 --lighting documented --show direct --exposure 1
shot light-0 $closed --size 240x210 --lighting documented --show light:0 --exposure 3
shot light-6 $closed --size 240x210 --lighting documented --show light:6 --exposure 3
shot overlay $closed --size 240x210 --lighting documented --show overlay
shot shadow-map $room --size 240x210 --show shadow-map --shadow-map 60
shot normals $room --size 240x210 --show normals
