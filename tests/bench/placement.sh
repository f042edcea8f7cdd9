#!/bin/sh
# What placement is worth: tests/bench/placement.sh BUILD SCENE...: with shadow rays, the error of view-driven placement
# and, at equal processor time, of plain particles. The truth is path traced twice, through pixel centres, with
# SPP (2048) paths per pixel; half of the squared difference is one truth's own error, and is taken off. KEEP=FOLDER
# keeps the truths for another run. SIZE (128x128) pixels, SEEDS (4) of which the root mean square counts.
build=$1
shift
SPP=${SPP:-2048}
SIZE=${SIZE:-128x128}
SEEDS=${SEEDS:-4}
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
keep=${KEEP:-$scratch}
value() {
    "$build/vpl" compare "$2" "$3" | sed -n "s/^$1  *\([-0-9.e]*\).*/\1/p"
}

# measure SCENE PLACEMENT N: sets `error` (relative to the truth's mean) and `ms` of processor time.
measure() {
    : >"$scratch/rows"
    for seed in $(seq "$SEEDS"); do
        "$build/vpl" render "$1" -o "$scratch/a.pfm" --method instant-radiosity --antialias 1 --placement "$2" --particles "$3" --light-shadows ray \
            --size "$SIZE" --seed "$seed" --quiet --stats "$scratch/stats.json" || exit 1
        echo "$(value relative_rmse "$scratch/a.pfm" "$truth-1.pfm") $(value relative_rmse "$scratch/a.pfm" "$truth-2.pfm") \
            $(sed -n 's/.*"cpu_ms": \([0-9.e+]*\).*/\1/p' "$scratch/stats.json")" >>"$scratch/rows"
    done
    error=$(awk -v noise="$noise" '{s += ($1 * $1 + $2 * $2) / 2 - noise * noise / 2} END {print (s > 0 ? sqrt(s / NR) : 0)}' "$scratch/rows")
    ms=$(awk '{print $3}' "$scratch/rows" | sort -g | awk '{a[NR] = $1} END {print a[int((NR + 1) / 2)]}')
}

printf '%-14s %6s | %6s %8s %8s | %6s %8s %8s | %5s\n' scene truth view error ms plain error ms ratio
for scene; do
    truth=$keep/$(basename "$scene" .json)
    for seed in 1 2; do
        [ -s "$truth-$seed.pfm" ] || "$build/vpl" render "$scene" -o "$truth-$seed.pfm" --method path --spp "$SPP" \
            --seed $seed --pixel centre --size "$SIZE" --quiet || exit 1
    done
    noise=$(value relative_rmse "$truth-1.pfm" "$truth-2.pfm")
    for particles in ${PARTICLES:-100 1000}; do
        measure "$scene" view "$particles"
        view_error=$error
        view_ms=$ms
        measure "$scene" particles "$particles"
        plain=$(awk -v n="$particles" -v t="$view_ms" -v p="$ms" 'BEGIN {printf "%d", n * t / p}')
        measure "$scene" particles "$plain"
        echo "$view_error $error $noise" | awk -v s="$(basename "$scene" .json)" -v n="$particles" -v m="$plain" \
            -v tv="$view_ms" -v tp="$ms" '{printf "%-14s %6.4f | %6d %8.4f %8.0f | %6d %8.4f %8.0f | %5.2f\n",
                s, $3 / sqrt(2), n, $1, tv, m, $2, tp, $2 / $1}'
    done
done
