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

# The stability table: every sweep is there, no error is larger than promised, refusals are sentences, and the errors are those
# of the committed table, to a quarter where a C library rounds otherwise. Left out are "in float", "height of the light", "texels",
# "reflectance", "rows" and "particles", which are slow, and "memory", whose bytes depend on threads.
refuses ExtremesKnowTheirSweeps 2 "no sweep of bench --extremes has \"frob\"" "$vpl" bench --extremes --stage frob
committed() { awk -v name="$1" '/; promised: / { on = index($0, name) > 0 && index($0, name) < index($0, ";") } on && NF' \
    tests/bench/extremes.txt; }
same_errors() { # COMMITTED FOUND
    awk 'NR == FNR { line[NR] = $0; lines = NR; next }
        { n = split(line[FNR], was); wrong = wrong || n != NF
          for (i = 1; i <= NF; i++)
              if ($i != was[i] && !($i was[i] ~ /^[0-9][0-9.e+-]*$/ && $i <= 1.25 * was[i] && was[i] <= 1.25 * $i)) {
                  wrong = 1; print }
        }
        END { exit wrong || FNR != lines || lines < 5 }' "$1" "$2"
}
for sweep in "scale" "scene file" "far plane" "intensity" "field" "angle" "samples" "width of" "height of a picture" "columns"; do
    succeeds "ExtremesKeepTheirPromises: $sweep" "$vpl" bench --extremes --threads 1 --stage "$sweep"
    check "ExtremesSayWhatTheyRefuse: $sweep" awk -v all="$([ "$sweep" = angle ] && echo 1)" \
        '/^  [a-z]: ..../ { told++ } / [a-z] / { refused++ } END { exit !(all || (told && refused)) }' "$scratch/stdout"
    committed "$sweep" >"$scratch/was"
    grep . "$scratch/stdout" >"$scratch/now"
    check "ExtremesAreThoseOfTheCommittedTable: $sweep" same_errors "$scratch/was" "$scratch/now"
done
succeeds ExtremesJson "$vpl" bench --extremes --threads 1 --stage "width of" --json
equals ExtremesHaveEveryMethodAndValue 42 "$(grep -c '"error": [0-9]' "$scratch/stdout")"
grep '; promised: ' tests/bench/extremes.txt | sed 's/;.*//' >"$scratch/committed"
"$vpl" help bench >"$scratch/stdout"
check HelpNamesExtremes grep -q -- --extremes "$scratch/stdout"
equals TheCommittedTableHasEverySweep "$(grep -c '^     *measure[A-Z][a-zA-Z]*},$' src/cli/bench/extremes_sweeps.c)" \
    "$(wc -l <"$scratch/committed")"
check TheCommittedTableKeepsItsPromises awk '/!/ { exit 1 }' tests/bench/extremes.txt
