#!/bin/sh
# The price and gain of smooth edges: tests/bench/antialias.sh BUILD [SIZE [REFERENCE [SCENE...]]]. For each scene a table
# of coverage samples (--antialias 1, 4, 8, 16) and of whole pictures (--supersample 9): relative rmse against
# --supersample REFERENCE (256) of the same lights, and processor time over that of one sample: of the same lights, and
# of the default command. Medians of three runs. Virtual lights have no shadows and no compensation where errors are
# measured, so that pictures differ by edges and not by noise. References are kept in BUILD/antialias.
set -e
build=$1
size=${2:-640x360}
reference=${3:-256}
shift $(($# < 3 ? $# : 3))
[ $# -gt 0 ] || set -- examples/scenes/room.json examples/scenes/room-area.json examples/scenes/loft.json
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
lights="--method instant-radiosity --particles 256 --sampler halton --pipeline interleaved --light-shadows none"
[ "$size" = 640x360 ] || lights="$lights --area-light-samples 8"
kept=$build/antialias
mkdir -p "$kept"

# shot OPTIONS...: the median time of three runs in ms.
shot() {
    for run in 1 2 3; do
        "$build/vpl" render "$scene" -o "$scratch/picture.pfm" --size "$size" "$@" --quiet --stats "$scratch/stats.json"
        sed -n 's/.*"cpu_ms": \([0-9.e+]*\).*/\1/p' "$scratch/stats.json"
    done | sort -g | sed -n 2p
}

echo "| scene, $size | samples | relative rmse | time | time of the default command |"
echo "| --- | --- | ---: | ---: | ---: |"
for scene; do
    name=$(basename "$scene" .json)
    truth=$kept/$name-$size.pfm
    [ -s "$truth" ] || "$build/vpl" render "$scene" -o "$truth" --size "$size" $lights --supersample "$reference" --quiet
    for samples in "--antialias 1" "--antialias 4" "--antialias 8" "--antialias 16" "--supersample 9"; do
        usual=1
        [ "$samples" = "--supersample 9" ] || usual=$(shot $samples)
        ms=$(shot $lights $samples)
        [ "$samples" = "--antialias 1" ] && one=$ms && usualOne=$usual
        error=$("$build/vpl" compare "$scratch/picture.pfm" "$truth" | sed -n 's/^relative_rmse  *\([-0-9.e]*\).*/\1/p')
        echo "$ms $one $usual $usualOne $error" | awk -v name="$name" -v samples="$samples" '{
            printf "| %s | `%s` | %.4f | %.2f | %s |\n", name, samples, $5, $1 / $2,
                samples ~ /super/ ? "" : sprintf("%.2f", $3 / $4) }'
    done
done
