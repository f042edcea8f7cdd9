#!/bin/sh
# Do more lights make a better picture? tests/bench/converge.sh BUILD TRUTH N SCENE...: Keller's method with shadow
# rays and 64, 128, ... N particles against path tracing (4096 paths through the centres of pixels, kept in the folder
# TRUTH), mean of SEEDS (4) renders of 96x96 each: with compensation, without at the same bound, without at the
# automatic bound. relmse is mean (a - b)^2 / (b + 0.01)^2; the exponent is that of relmse ~ N^e, fitted by least
# squares; seconds are processor time. What remains at the bound of compensation is the floor; "lost" is the
# estimated share of the virtual lights' light, "missing" the share of the picture's energy that is not there.
build=$1
truth=$2
most=$3
shift 3
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
mkdir -p "$truth"
number() {
    sed -n "s/.*\"$1\": \([-0-9.e]*\).*/\1/p" "$scratch/stats.json"
}
# measure SCENE N OPTION...: relmse, seconds, energy, loss and bound, means over the seeds
measure() {
    scene=$1
    count=$2
    shift 2
    for seed in $(seq 1 "${SEEDS:-4}"); do
        "$build/vpl" render "$scene" -o "$scratch/picture.pfm" --method keller --antialias 1 --light-shadows ray --reflectivity auto \
            --particles "$count" --size 96x96 --seed "$seed" --quiet --stats "$scratch/stats.json" "$@" || exit 1
        "$build/vpl" compare "$scratch/picture.pfm" "$reference" | awk -v ms="$(number cpu_ms)" \
            -v loss="$(number clamp_loss)" -v bound="$(number min_distance)" '
            $1 == "relmse" { e = $2 } $1 == "energy_ratio" { r = $2 } END { print e, ms / 1000, r, loss, bound }'
    done | awk '{ for (i = 1; i <= 5; i++) s[i] += $i } END { print s[1] / NR, s[2] / NR, s[3] / NR, s[4] / NR, s[5] / NR }'
}
for scene; do
    reference=$truth/$(basename "$scene" .json).pfm
    [ -s "$reference" ] || "$build/vpl" render "$scene" -o "$reference" --method path --spp 4096 --pixel centre \
        --size 96x96 --quiet || exit 1
    printf '%s\n%7s  %10s %8s %8s  %10s %8s %8s %8s  %10s %8s\n' "$(basename "$scene" .json)" particles "rays" s \
        energy "same bound" s missing lost "auto bound" s
    count=64
    while [ "$count" -le "$most" ]; do
        with=$(measure "$scene" "$count")
        bound=$(echo "$with" | cut -d' ' -f5)
        without=$(measure "$scene" "$count" --compensation none --min-distance "$bound")
        auto=$(measure "$scene" "$count" --compensation none)
        echo "$count $with $without $auto" >>"$scratch/table"
        tail -n 2 "$scratch/table" | awk '
            { worse = NR == 2 && $2 + 0 > last; last = $2 + 0 }
            END { printf "%7d  %10.3g %8.3g %8.4f  %10.3g %8.3g %8.4f %8.4f  %10.3g %8.3g%s\n", $1, $2, $3, $4, $7, $8,
                      1 - $9, $10, $12, $13, worse ? "  worse than half as many" : "" }'
        count=$((count * 2))
    done
    awk '
        { n++; x = log($1); sx += x; sxx += x * x; y[1] = $2; y[2] = $7; y[3] = $12
          for (i = 1; i <= 3; i++) { sy[i] += log(y[i]); sxy[i] += x * log(y[i]) } }
        END { for (i = 1; i <= 3; i++) e[i] = n > 1 ? (n * sxy[i] - sx * sy[i]) / (n * sxx - sx * sx) : 0
              printf "exponent %10.2f %30.2f %39.2f\n", e[1], e[2], e[3] }' "$scratch/table"
    rm "$scratch/table"
done
