#!/bin/sh
# Figures 4 to 7 of Aranha and others for the document's scenes: one bounce, two bounces, the truth, side by side in
# golden/gallery/README.md.
# tests/bench/ssvp_gallery.sh BUILD OUT SCENE...
set -e
build=$1
out=$2
shift 2
mkdir -p "$out"
for scene; do
    name=$(basename "$scene" .json)
    for bounces in 1 2; do
        "$build/vpl" render "$scene" -o "$out/ssvp-$name-$bounces.png" --method ssvp --max-bounces $bounces --size 240x135 \
            --antialias 8 --tonemap reinhard --quiet
    done
    "$build/vpl" render "$scene" -o "$out/ssvp-$name-truth.png" --method path --spp 256 --tonemap reinhard --size 240x135 --quiet
done
