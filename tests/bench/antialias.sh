#!/bin/sh
# The price and gain of smooth edges: tests/bench/antialias.sh BUILD [SIZE [REFERENCE [SCENE...]]]. For each scene a table
# of coverage samples (--antialias 1, 4, 8, 16) and of whole pictures (--supersample 8): relative rmse against
# --supersample REFERENCE (64) of the same lights, and processor time over that of one sample, medians of three runs.
# Virtual lights have no shadows and no compensation, so that pictures differ by edges and not by noise.
set -e
build=$1
size=${2:-640x360}
reference=${3:-64}
shift $(($# < 3 ? $# : 3))
[ $# -gt 0 ] || set -- examples/scenes/room.json examples/scenes/room-area.json examples/scenes/loft.json
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
lights="--method instant-radiosity --particles 256 --sampler halton --pipeline interleaved --light-shadows none"

# shot OPTIONS...: the median time of three runs in ms.
shot() {
    for run in 1 2 3; do
        "$build/vpl" render "$scene" -o "$scratch/picture.pfm" --size "$size" $lights "$@" --quiet --stats "$scratch/stats.json"
        sed -n 's/.*"cpu_ms": \([0-9.e+]*\).*/\1/p' "$scratch/stats.json"
    done | sort -g | sed -n 2p
}

for scene; do
    echo "$scene, $size"
    "$build/vpl" render "$scene" -o "$scratch/reference.pfm" --size "$size" $lights --supersample "$reference" --quiet
    one=$(shot)
    for samples in "--antialias 1" "--antialias 4" "--antialias 8" "--antialias 16" "--supersample 8"; do
        ms=$(shot $samples)
        error=$("$build/vpl" compare "$scratch/picture.pfm" "$scratch/reference.pfm" |
            sed -n 's/^relative_rmse  *\([-0-9.e]*\).*/\1/p')
        echo "$ms $one $error" | awk -v samples="$samples" '{ printf "  %-16s rmse %.4f  time %.2f\n", samples, $3, $1 / $2 }'
    done
done
