#!/bin/sh
# Hemgren's figures 5 to 11 with numbers: 120 to 784 patches of the report's box, 100 iterations, flat and interpolated,
# with the document's estimator and with ours, beside the path-traced truth. Prints errors of the indirect light.
# tests/bench/radiosity_report.sh BUILD OUT [SPP [SIZE]]
set -e
build=$1
out=$2
spp=${3:-512}
size=${4:-240x240}
scene=examples/scenes/testmodel.json
mkdir -p "$out"
render="$build/vpl render $scene --antialias 1 --size $size --quiet"
eyes="--exposure 1.65 --tonemap none"
$render -o "$out/truth.pfm" --method path --pixel centre --spp "$spp" --show indirect
$render -o "$out/truth.png" $eyes --method path --spp "$spp"
echo "patches estimator    light       relative_rmse  relmse   energy  row_max  radius"
for rounds in 2 3 4 5 6; do
    for estimator in incentre monte-carlo; do
        for light in none gouraud; do
            words="--method radiosity --patch-size 0.45 --subdivisions $rounds --form-factors $estimator \
                --interpolation $light --iterations 100 --residual 0"
            test $estimator = monte-carlo || words="$words --vertex-weight equal --sharpen 0"
            # shellcheck disable=SC2086
            $render -o "$out/indirect.pfm" $words --show indirect --stats "$out/stats.json"
            patches=$(sed -n 's/.*"patches": \([0-9]*\).*/\1/p' "$out/stats.json")
            # shellcheck disable=SC2086
            $render -o "$out/$estimator-$patches-$light.png" $eyes $words
            "$build/vpl" compare "$out/indirect.pfm" "$out/truth.pfm" >"$out/compare.txt"
            figure() { sed -n "s/^$1 *\([0-9.e-]*\).*/\1/p" "$out/compare.txt"; }
            statistic() { sed -n "s/.*\"$1\": \([0-9.e-]*\).*/\1/p" "$out/stats.json"; }
            printf '%7s %-12s %-8s %15.4f %9.5f %7.3f %8.3f %7.3f\n' "$patches" $estimator $light \
                "$(figure relative_rmse)" "$(figure relmse)" "$(figure energy_ratio)" "$(statistic max)" \
                "$(statistic spectral_radius)"
        done
    done
done
rm -f "$out/indirect.pfm" "$out/compare.txt" "$out/stats.json"
