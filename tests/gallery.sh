#!/bin/sh
# Renders the pictures of golden/gallery/README.md but for those of tests/bench/readme.sh and tests/bench/ssvp_gallery.sh:
# tests/gallery.sh VPL. They are small, so that the repository stays small.
set -e
vpl=$1
out=golden/gallery
room=examples/scenes/room.json
closed=examples/scenes/closed-room.json
mkdir -p $out
# shot NAME SCENE OPTIONS...: linear radiance as it is, unless the options say otherwise.
shot() {
    name=$1
    shift
    "$vpl" render --method instant-radiosity --antialias 1 --exposure 0 --tonemap none "$@" -o "$out/$name.png" --quiet
}
shot documented $closed --size 360x315 --lighting documented --exposure 0.5 --pcf 64 --pcf-offset 0.12
# The clamp distance of 0.5 m removes bright specks where walls meet.
shot physical $closed --size 360x315 --particles 4000 --sampler halton --reflectivity auto --light-shadows ray --min-distance 0.5 --pipeline interleaved --interleave 16 --antialias 8 --tonemap reinhard
shot direct $closed --size 240x210 --lighting documented --show direct --exposure 1
shot light-0 $closed --size 240x210 --lighting documented --show light:0 --exposure 3
shot light-6 $closed --size 240x210 --lighting documented --show light:6 --exposure 3
shot overlay $closed --size 240x210 --lighting documented --show overlay
shot shadow-map $room --size 240x210 --show shadow-map --shadow-map 60
shot normals $room --size 240x210 --show normals
box=examples/scenes/testmodel.json
report="--form-factors incentre --vertex-weight equal --sharpen 0"
boxed="--size 200x200 --exposure 2.3 --antialias 8 --show indirect"
shot radiosity-truth $box --size 200x200 --exposure 2.3 --show indirect --method path --spp 1024
shot radiosity-incentre-192 $box $boxed --method radiosity --patch-size 0.45 --subdivisions 3 $report
shot radiosity-192 $box $boxed --method radiosity --patch-size 0.45 --subdivisions 3
shot radiosity-incentre-784 $box $boxed --method radiosity --patch-size 0.45 $report
shot radiosity-784 $box $boxed --method radiosity --patch-size 0.45
shot radiosity-box $box --size 200x200 --exposure 1.3 --antialias 8 --method radiosity --patch-size 0.45
shot radiosity-patches $box --size 200x200 --exposure -0.5 --supersample 4 --method radiosity --patch-size 0.45 --show patches
shot radiosity-adaptive examples/scenes/room-area.json --size 200x200 --supersample 4 --method radiosity --patch-placement adaptive --patches 1500 --show patches
