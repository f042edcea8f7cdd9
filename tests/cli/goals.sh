# SPDX-License-Identifier: MIT
# --method auto, --quality, --budget, --max-error and --error-map.

wee="--size 64x36 --quiet"

# figure NAME: a number of the last statistics.
figure() {
    sed -n "s/.*\"$1\": \\([-0-9.e+]*\\).*/\\1/p" "$out/g.json" | head -1
}

succeeds AutoIsTheDefault "$vpl" info "$room"
check AutoIsKellerInTheRoom grep -q "method keller" "$scratch/stdout"
check ALookIsTold grep -q "a look at the scene" "$scratch/stdout"
succeeds PathsAreForPaths "$vpl" info "$room" --spp 3
check PathsChoosePathTracing grep -q "render it by path" "$scratch/stdout"
succeeds ClustersAreForSsvp "$vpl" info "$room" --clusters 4
check ClustersChooseSsvp grep -q "render it by ssvp" "$scratch/stdout"

succeeds AnErrorIsReached "$vpl" render "$room" $wee --max-error 0.05 -o "$out/g.pfm" --stats "$out/g.json" --error-map "$out/e.pfm"
check TheErrorIsBelow test "$(figure relative_error_estimate | awk '{ print $1 <= 0.05 }')" = 1
check TheErrorIsNotNothing test "$(figure relative_error_estimate | awk '{ print ($1 > 0) }')" = 1
check TheBoundIsAboveTheError test "$(figure relative_error_bound | awk -v e="$(figure relative_error_estimate)" '{ print ($1 >= e && $1 <= 0.05) }')" = 1
check BiasIsTold test -n "$(figure relative_bias)"
check TruthIsTold test -n "$(figure truth_paths_per_pixel)"
equals BlocksAreEightPixelsWide "8 5" "$(sed -n 2p "$out/e.pfm")"
refuses AMapIsAPicture 2 "unknown picture format" "$vpl" render "$room" $wee -o "$out/g.pfm" --error-map "$out/e.txt"
refuses AMapHasItsOwnName 2 "would be written there" "$vpl" render "$room" $wee -o "$out/g.pfm" --error-map "$out/g.pfm"

# The same bits with other threads and instructions.
succeeds AnErrorWithOneThread "$vpl" render "$room" $wee --max-error 0.05 -o "$out/h.pfm" --threads 1 --isa scalar
check AnErrorGivesTheSameBits cmp -s "$out/g.pfm" "$out/h.pfm"

# The first pass has seven particles, so there are more.
succeeds SmallPassesReachAnError "$vpl" render "$room" $wee --method keller --particles 60 --max-error 0.2 -o "$out/g.pfm" --stats "$out/g.json"
check NoiseIsTold test -n "$(figure relative_noise)"

# Without shadows no number of passes comes near the truth.
"$vpl" render "$room" --size 64x36 --method instant-radiosity --particles 50 --max-error 0.03 -o "$out/g.pfm" 2>"$scratch/told"
equals BiasIsNoFailure 0 $?
check BiasEndsIt grep -q "which more passes do not mend" "$scratch/told"
"$vpl" render "$room" --size 64x36 --max-error 0.001 --budget 200 -o "$out/g.pfm" 2>"$scratch/told"
equals ABudgetIsNoFailure 0 $?
check ABudgetThatEndsItIsSaid grep -q -- "--budget ended the render" "$scratch/told"
"$vpl" render "$room" --size 640x360 --max-error 0.001 --budget 20 -o "$out/g.pfm" 2>"$scratch/told"
check AnUnknownErrorIsSaid grep -q "the error is not known" "$scratch/told"

for word in draft good; do
    succeeds "Quality_$word" "$vpl" render "$room" $wee --quality $word -o "$out/g.pfm"
done
refuses QualityIsAWord 2 "draft|good|best" "$vpl" render "$room" $wee --quality fine -o "$out/g.pfm"

# A coarse picture, and a plan that replays it.
succeeds ABudgetHasAPicture "$vpl" render "$room" $wee --budget 1 -o "$out/g.pfm" --plan-out "$out/plan.json"
succeeds ACoarsePlanIsReplayed "$vpl" render "$room" $wee --plan "$out/plan.json" -o "$out/h.pfm"
check ACoarsePlanHasTheSameBits cmp -s "$out/g.pfm" "$out/h.pfm"
awk 'BEGIN { for (i = 0; i < 2000; i++) printf "v %d 0 0\nv %d 1 0\nv %d 0 1\nf %d %d %d\n", i, i, i, 3 * i + 1, 3 * i + 2, 3 * i + 3 }' \
    >"$scratch/many.obj"
refuses RadiosityRefusesShortTimes 2 "radiosity makes patches of all" "$vpl" render "$scratch/many.obj" $wee --method radiosity \
    --patch-groups off \
    --budget 10 -o "$out/never.png"
refuses GroupsOfTrianglesRefuseShortTimes 2 "radiosity makes patches of all 2006 triangles, which takes about 0.0092 s" "$vpl" render \
    "$scratch/many.obj" $wee --method radiosity --budget 7 -o "$out/never.png"
refuses SsvpRefusesShortTimes 2 "SSVP draws its maps of all 2006 triangles, which takes about 0.00062 s" "$vpl" render \
    "$scratch/many.obj" $wee --method ssvp --budget 0.5 -o "$out/never.png"
succeeds ThePlannerDoesNotRefuseItsOwnPatches "$vpl" render "$scratch/many.obj" $wee --budget 7 -o "$out/g.pfm"
"$vpl" render "$closed" $wee --budget 1000 --explain --dry-run >"$scratch/told" 2>&1
check APlanForATimeSaysThatPatchesMayFollow grep -q "patches follow if there is time" "$scratch/told"
"$vpl" render examples/scenes/loft.json $wee --budget 1000 --explain --dry-run >"$scratch/told" 2>&1
check OthersDoNotSaySo grep -q "virtual lights with shadows leave the least error" "$scratch/told"
rm -f "$out/g.pfm" "$out/h.pfm" "$out/e.pfm" "$out/g.json" "$out/plan.json"
