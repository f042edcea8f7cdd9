#!/bin/sh
# The pictures and numbers of the top-level README: tests/bench/readme.sh BUILD [OUT]. Renders examples/scenes/loft.json by
# every method to OUT (golden/gallery) and prints a table of errors and seconds.
# Error: root-mean-square difference of linear radiance from a path-traced truth by the truth's mean, one sample per pixel,
# through its centre on both sides, so that edges do not count. The truth is two independent halves of SPP (256) paths per
# pixel, kept in BUILD; their own noise is taken off. Seconds: processor time of all threads, median of three runs.
# The pictures themselves have smooth edges.
set -e
build=$1
out=${2:-golden/gallery}
scene=examples/scenes/loft.json
size=${SIZE:-480x270}
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

for half in 1 2; do
    truth=$build/readme-truth-$half.pfm
    [ -s "$truth" ] || "$build/vpl" render $scene -o "$truth" --method path --spp "${SPP:-256}" --seed $((100 + half)) \
        --pixel centre --size "$size" --quiet
done

# error A B: rmse by the mean of B.
error() {
    "$build/vpl" compare "$1" "$2" | sed -n 's/^relative_rmse  *\([-0-9.e]*\).*/\1/p'
}
noise=$(error "$build/readme-truth-1.pfm" "$build/readme-truth-2.pfm")

# shot NAME RUNS SMOOTH OPTIONS...: a picture with the option SMOOTH, and a row of the table without.
shot() {
    name=$1
    runs=$2
    smooth=$3
    shift 3
    "$build/vpl" render $scene -o "$out/$name.png" --antialias 1 "$@" $smooth --size "$size" --tonemap none --exposure 1 --quiet
    : >"$scratch/times"
    for run in $(seq "$runs"); do
        "$build/vpl" render $scene -o "$scratch/picture.pfm" --antialias 1 "$@" --size "$size" --quiet --stats "$scratch/stats.json"
        sed -n 's/.*"cpu_ms": \([0-9.e+]*\).*/\1/p' "$scratch/stats.json" >>"$scratch/times"
    done
    ms=$(sort -g "$scratch/times" | awk '{ t[NR] = $1 } END { print t[int((NR + 1) / 2)] }')
    a=$(error "$scratch/picture.pfm" "$build/readme-truth-1.pfm")
    b=$(error "$scratch/picture.pfm" "$build/readme-truth-2.pfm")
    echo "$a $b $noise $ms" | awk -v name="$name" -v options="$*" '{
        squared = ($1 * $1 + $2 * $2 - $3 * $3) / 2
        printf "| %s | %.1f %% | %.2g | `%s` |\n", name, 100 * sqrt(squared > 0 ? squared : 0), $4 / 1000, options }'
}

echo '| picture | error | seconds | options |'
echo '| --- | ---: | ---: | --- |'
shared="--light-shadows ray"
particles="--particles 4000 --reflectivity auto --pipeline interleaved --interleave 16"
shot best-direct 3 "--antialias 8" --method direct $shared
shot best-instant-radiosity 3 "--antialias 8" --method instant-radiosity $particles --sampler halton $shared
shot best-keller 3 "--antialias 8" --method keller $particles $shared
shot best-radiosity 3 "--antialias 8" --method radiosity --patches 4000 $shared
shot best-ssvp 3 "--antialias 8" --method ssvp --clusters 32
shot best-path 1 "--pixel area" --method path --spp 256 --pixel centre
