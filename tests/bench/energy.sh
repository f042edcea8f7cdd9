#!/bin/sh
# Do the two ways of computing the same light agree? tests/bench/energy.sh BUILD SCENE...: path tracing twice with
# 1024 paths per pixel, whose difference the program predicts, against instant radiosity with 4096 particles and
# shadow rays. 256x256, seen through pixel centres by both, so that edges are cut alike.
build=$1
shift
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
value() {
    sed -n "s/^$1  *\([-0-9.e]*\).*/\1/p" "$scratch/compare"
}
printf '%-16s %10s %10s %12s %10s\n' scene predicted measured energy rel.rmse
for scene; do
    for seed in 1 2; do
        "$build/vpl" render "$scene" -o "$scratch/path$seed.pfm" --method path --spp 1024 --seed $seed \
            --pixel centre --size 256x256 --quiet --stats "$scratch/stats$seed.json" || exit 1
    done
    "$build/vpl" render "$scene" -o "$scratch/ir.pfm" --method instant-radiosity --antialias 1 --particles 4096 --light-shadows ray --size 256x256 --quiet || exit 1
    "$build/vpl" compare "$scratch/path1.pfm" "$scratch/path2.pfm" >"$scratch/compare"
    measured=$(value rmse)
    predicted=$(sed -n 's/.*"error_estimate": \([0-9.e-]*\).*/\1/p' "$scratch/stats1.json")
    predicted=$(echo "$predicted" | awk '{print $1 * sqrt(2)}')
    "$build/vpl" compare "$scratch/ir.pfm" "$scratch/path1.pfm" >"$scratch/compare"
    printf '%-16s %10.3g %10.3g %12.5f %10.4f\n' "$(basename "$scene" .json)" "$predicted" "$measured" \
        "$(value energy_ratio)" "$(value relative_rmse)"
done
