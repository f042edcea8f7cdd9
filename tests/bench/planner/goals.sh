#!/bin/sh
# Does the planner keep its word? tests/bench/planner/goals.sh BUILD SIZE GOALS SEEDS SCENE...: renders each scene by --method
# auto for each goal (words like max-error=0.1 or budget=200) and seed, and prints lines "scene goal seed asked error
# estimate bound ms cpu passes method", where error is the relative rmse against two path-traced pictures whose noise cancels. They
# are kept in BUILD/planner and are traced there with SPP (default 512) paths per pixel each.
set -e
build=$1
size=$2
goals=$3
seeds=$4
shift 4
kept=$build/planner
mkdir -p "$kept"
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

compare() {
    "$build/vpl" compare "$1" "$2" | awk '/^rmse/ { print $2 * $2 }'
}

for scene; do
    name=$(basename "$scene" .json)
    for half in 1 2; do
        truth=$kept/$name-$size-$half.pfm
        [ -s "$truth" ] || "$build/vpl" render "$scene" --method path --spp "${SPP:-512}" --seed $((1000 + half)) \
            --size "$size" -o "$truth" --quiet
    done
    a=$kept/$name-$size-1.pfm b=$kept/$name-$size-2.pfm
    between=$(compare "$a" "$b")
    mean=$("$build/vpl" compare "$b" "$a" | awk '/^rmse/ { r = $2 } /^relative_rmse/ { print r / $2 }')
    for goal in $goals; do
        for seed in $seeds; do
            "$build/vpl" render "$scene" --"$goal" --seed "$seed" --size "$size" -o "$scratch/p.pfm" --quiet \
                --stats "$scratch/s.json" --plan-out "$scratch/plan.json"
            method=$(sed -n 's/.*"method": "\([a-z-]*\)".*/\1/p' "$scratch/plan.json" | head -1)
            echo "$(compare "$scratch/p.pfm" "$a") $(compare "$scratch/p.pfm" "$b") $between $mean" |
                awk -v head="$name $goal $seed" -v method="$method" -v stats="$(tr -d ' \n' < "$scratch/s.json")" '
                function of(key) {
                    if (!match(stats, "\"" key "\":[-0-9.e+]*")) return -1
                    return substr(stats, RSTART + length(key) + 3, RLENGTH - length(key) - 3)
                }
                {
                    square = ($1 + $2 - $3) / 2
                    split(head, word, "[ =]")
                    printf "%s asked %s error %.4f estimate %.4f bound %.4f ms %.0f cpu %.0f passes %d %s\n", head, word[3],
                      sqrt(square > 0 ? square : 0) / $4, of("relative_error_estimate"), of("relative_error_bound"), of("total_ms"), of("cpu_ms"), of("passes"), method }'
        done
    done
done
