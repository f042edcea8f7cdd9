# SPDX-License-Identifier: MIT
# The plan: vpl info, --dry-run and --explain print the same one, and refusals are its problem.

tiny="--size 16x12 --shadow-map 16 --quiet"
for method in instant-radiosity direct path keller ssvp radiosity; do
    words="$tiny --method $method --rsm-size 64 --spp 2 --patches 50"
    succeeds "DryRun_$method" "$vpl" render "$room" $words --dry-run
    cp "$scratch/stdout" "$scratch/plan"
    check "DryRunHasStages_$method" grep -q '^stages' "$scratch/plan"
    check "DryRunNamesTheMethod_$method" grep -q "by $method" "$scratch/plan"
    "$vpl" info "$room" $words | tail -n "$(wc -l <"$scratch/plan")" >"$scratch/told"
    check "InfoEndsWithThePlan_$method" cmp "$scratch/told" "$scratch/plan"
    "$vpl" render "$room" $words --explain -o "$out/e.pfm" >"$scratch/stdout" 2>"$scratch/stderr"
    equals "ExplainRenders_$method" 0 $?
    check "ExplainPrintsThePlanOnStderr_$method" cmp "$scratch/stderr" "$scratch/plan"
    check "ExplainPrintsNothingOnStdout_$method" test ! -s "$scratch/stdout"
    "$vpl" render "$room" $words -o "$out/f.pfm"
    check "ExplainChangesNothing_$method" cmp "$out/e.pfm" "$out/f.pfm"
    rm "$out/e.pfm" "$out/f.pfm"
done
refuses DryRunOfWhatCannotBeRendered 2 "use physical" "$vpl" render "$room" $tiny --method ssvp --lighting documented --dry-run
refuses DryRunOfTooManyPairs 2 "use --hierarchy on" "$vpl" render "$room" $tiny --method radiosity --patches 40000 --hierarchy off --memory 2000 --dry-run
refuses DryRunOfNoScene 2 "cannot open" "$vpl" render "$out/none.json" --dry-run
refuses DryRunOfACameraThatIsNone 2 "camera is 3" "$vpl" render "$room" --camera 3 --dry-run
succeeds DryRunWritesNothing "$vpl" render "$room" $tiny --dry-run -o "$out/d.pfm" --stats "$out/d.json"
equals DryRunWroteNothing "" "$(ls -A "$out")"
succeeds DryRunOfLights "$vpl" lights "$room" --dry-run
check DryRunOfLightsListsNone test -z "$(grep '^index,step' "$scratch/stdout")"
succeeds DryRunOfBake "$vpl" bake "$room" --patches 50 --dry-run
check DryRunOfBakeIsRadiosity grep -q 'by radiosity' "$scratch/stdout"
succeeds DryRunOfFrames "$vpl" render "$PWD/examples/scenes/room-path.json" $tiny --frames 8:10 --dry-run
"$vpl" lights "$room" --explain >"$scratch/stdout" 2>"$scratch/stderr"
check ExplainOfLightsKeepsStdout test "$(head -n 1 "$scratch/stdout")" = "index,step,px,py,pz,nx,ny,nz,r,g,b,weight"
check ExplainOfLightsIsOnStderr grep -q '^stages' "$scratch/stderr"

"$vpl" info "$room" --json >"$scratch/info"
for key in cameras materials objects meshes lights paths first_frame last_frame triangles lamp_triangles lamp_area bounds_min \
    bounds_max diagonal area mean_reflectance render method pipeline width height reflectivity steps lights_per_step \
    virtual_lights draw_calls shadow_map_bytes light_bytes picture_bytes patches lit_patches patch_sides form_factor_bytes \
    peak_bytes stages decisions left_out problem; do
    check "InfoJsonHas_$key" grep -q "\"$key\": " "$scratch/info"
done
check InfoJsonHasReasons grep -q '"why": "[^"]' "$scratch/info"
equals InfoJsonHasNoProblem null "$(field "$scratch/info" problem)"
"$vpl" info "$room" --json --method path --lighting documented >"$scratch/info"
check InfoJsonHasAProblem grep -q '"problem": ".*physical' "$scratch/info"
