# SPDX-License-Identifier: MIT
# vpl bench: what is refused, what is chosen, and that bits do not depend on threads. No times.

refuses BenchKnowsItsStages 2 "no stage of bench has \"frob\" in its name" "$vpl" bench --stage frob
refuses BenchKnowsItsSeries 2 "no series of bench --scaling has \"frob\"" "$vpl" bench --scaling --stage frob
refuses BenchRunsAtLeastOnce 2 "--runs is \"0\"" "$vpl" bench --runs 0
refuses RenderIsNotScaled 2 "render has no option --scaling" "$vpl" render "$closed" -o "$out/never.png" --scaling

# All stages but those of many triangles, at sizes that leave odd blocks; no stage differs between thread counts.
for stage in particles fill pixels direct "18 lights" tone; do
    succeeds "BenchStage_${stage% lights}" "$vpl" bench --size 70x38 --runs 1 --threads 1,2,3 --stage "$stage"
    if grep -q DIFFERS "$scratch/stdout" || [ "$(wc -l <"$scratch/stdout")" -lt 4 ]; then
        not_ok "BenchStageSameBits_${stage% lights}" "$(head -n 4 "$scratch/stdout" | tail -n 2)"
    else
        ok "BenchStageSameBits_${stage% lights}"
    fi
done
succeeds BenchOfOnePixel "$vpl" bench --size 1x1 --runs 1 --threads 1 --stage "of 2 pixels"

# One row per stage and thread count, with the fields that were always there.
succeeds BenchJson "$vpl" bench --size 64x36 --runs 1 --threads 1,2 --stage layers --json
for key in stage threads ms draw_calls pixel_lights hash cpu_ms efficiency; do
    equals "BenchJsonHas_$key" 4 "$(grep -c "\"$key\": " "$scratch/stdout")"
done
equals BenchJsonOneHashPerStage 2 "$(grep '"hash"' "$scratch/stdout" | sort -u | wc -l)"

# The three pipelines, as they are timed, give one picture.
"$vpl" bench --size 64x36 --runs 1 --threads 1 --stage "198 lights, physical" --json >"$scratch/stdout"
equals BenchPipelines 3 "$(grep -c '"hash"' "$scratch/stdout")"
equals BenchPipelinesSameBits 1 "$(grep '"hash"' "$scratch/stdout" | sort -u | wc -l)"

succeeds BenchScaling "$vpl" bench --scaling --stage lights --runs 1 --size 32x18
check BenchScalingHasExponents grep -q 'exponent [-0-9.]*, of the upper half [-0-9.]*; expected 1' "$scratch/stdout"
succeeds BenchScalingJson "$vpl" bench --scaling --stage threads --runs 1 --size 32x18 --json
check BenchScalingJsonHasPoints grep -q '"points": ' "$scratch/stdout"
