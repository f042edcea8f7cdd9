# SPDX-License-Identifier: MIT
# Light from outside: "environment" of scene files, --environment and --sky.

cat >"$scratch/open.json" <<'SCENE'
{ "camera": { "eye": [0, 1, 4], "target": [0, 0.5, 0] }, "materials": { "grey": { "diffuse": [0.5, 0.5, 0.5] } },
  "objects": [ { "type": "quad", "material": "grey", "rotate": [-90, 0, 0], "scale": [6, 6, 1] },
               { "type": "box", "material": "grey", "translate": [0, 0.5, 0] } ] }
SCENE
sed 's/"objects"/"environment": { "radiance": [2, 2, 2] }, "objects"/' "$scratch/open.json" >"$scratch/lit.json"
tiny="--size 32x24 --quiet"

refuses SceneWithoutEnvironmentIsDark 2 "no emitter" "$vpl" render "$scratch/open.json" -o "$out/dark.pfm" --size 8x8
for method in auto direct instant-radiosity keller ssvp radiosity path; do
    succeeds "EnvironmentIsRendered_$method" "$vpl" render "$scratch/open.json" -o "$out/a.pfm" $tiny --method $method --spp 4 --environment 2,2,2
    succeeds "EnvironmentOfTheFileIsRendered_$method" "$vpl" render "$scratch/lit.json" -o "$out/b.pfm" $tiny --method $method --spp 4
    check "OptionAndFileAreTheSame_$method" cmp "$out/a.pfm" "$out/b.pfm"
done
succeeds SkyIsRendered "$vpl" render "$scratch/lit.json" -o "$out/sky.pfm" $tiny --sky 30,4,100
succeeds SkyNeedsItsElevationOnly "$vpl" render "$scratch/lit.json" -o "$out/sky.pfm" $tiny --sky 30

# A picture of the same radiance everywhere lights as that radiance does.
sed 's/"objects": *\[.*/"objects": [] }/; /"box"/d' "$scratch/lit.json" >"$scratch/empty.json"
succeeds AnEmptySceneShowsItsEnvironment "$vpl" render "$scratch/empty.json" -o "$out/even.pfm" --size 16x8 --method direct
succeeds PictureOfSurroundingsLights "$vpl" render "$scratch/open.json" -o "$out/c.pfm" $tiny --method direct --environment "$out/even.pfm"
"$vpl" render "$scratch/open.json" -o "$out/d.pfm" $tiny --method direct --environment 2,2,2
check EvenPictureIsAConstant sh -c "'$vpl' compare '$out/c.pfm' '$out/d.pfm' | awk '\$1 == \"relmse\" { exit !(\$2 < 1e-5) }'"

refuses PictureOfSurroundingsIsMissing 2 "none.hdr: cannot open" "$vpl" render "$scratch/open.json" -o "$out/x.pfm" --environment none.hdr
refuses PictureOfSurroundingsHasAFormat 2 "unknown picture format" "$vpl" render "$scratch/open.json" -o "$out/x.pfm" --environment "$room"
refuses RadianceIsNotNegative 2 "radiance[1] is -1" "$vpl" render "$scratch/open.json" -o "$out/x.pfm" --environment 1,-1,1
for sky in 91 -1 30,1 30,11 30,3,x 30,3,0,0 '' x 30,; do
    refuses "SkyIsNot: $sky" 2 "sky" "$vpl" render "$scratch/open.json" -o "$out/x.pfm" "--sky=$sky"
done
refuses OneEnvironmentOnly 2 "both given" "$vpl" render "$scratch/open.json" -o "$out/x.pfm" --sky 30 --environment 1,1,1
refuses MapsDoNotSeeTheSky 2 "too far away for shadow maps" \
    "$vpl" render "$scratch/lit.json" -o "$out/x.pfm" --method keller --light-shadows map
refuses DocumentsKnowNoSky 2 "knows no environment" "$vpl" render "$scratch/lit.json" -o "$out/x.pfm" --preset franchi-ferrante

succeeds InfoOfASky "$vpl" info "$scratch/open.json" --sky 40
check InfoNamesTheSky grep -q '^  environment *sky, 256x128, mean radiance' "$scratch/stdout"
check InfoCountsTheSun grep -q '1 (0 point, 0 spot, 1 directional)' "$scratch/stdout"
succeeds InfoOfASkyAsJson "$vpl" info "$scratch/open.json" --sky 40 --json
check JsonNamesTheSky grep -q '"environment": "sky"' "$scratch/stdout"
succeeds ExplainsTheSky "$vpl" render "$scratch/lit.json" --dry-run --method direct --sky-samples 100
check PlanSaysHowTheSkyLights grep -q '100 directions stand for the environment' "$scratch/stdout"
"$vpl" info tests/data/obj/square.obj --sky 40 >"$scratch/stdout" 2>"$scratch/said"
check AMeshUnderASkyGetsNoLamps sh -c "! grep -q lamp '$scratch/said'"
check AMeshUnderASkyHasItsSun grep -q '1 (0 point, 0 spot, 1 directional)' "$scratch/stdout"

# Plans and states know the environment by the scene's hash.
succeeds PlanUnderASky "$vpl" render "$scratch/open.json" -o "$out/p.pfm" $tiny --sky 40 --sky-samples 50 --method direct --plan-out "$out/plan.json"
check PlanHoldsTheSamples grep -q '"sky-samples": "50"' "$out/plan.json"
succeeds PlanIsReplayed "$vpl" render "$scratch/open.json" -o "$out/q.pfm" --sky 40 --plan "$out/plan.json"
check ReplayHasTheSameBits cmp "$out/p.pfm" "$out/q.pfm"
"$vpl" render "$scratch/open.json" -o "$out/q.pfm" --sky 41 --plan "$out/plan.json" 2>"$scratch/said"
check AnotherSkyIsWarnedOf grep -q 'was made for another scene' "$scratch/said"
succeeds StateUnderASky "$vpl" render "$scratch/open.json" -o "$out/p.pfm" $tiny --sky 40 --method keller --particles 50 --passes 2 --checkpoint "$out/state"
succeeds StateGoesOn "$vpl" render "$scratch/open.json" -o "$out/p.pfm" --quiet --size 32x24 --sky 40 --method keller --particles 50 --passes 4 --resume "$out/state"
"$vpl" render "$scratch/open.json" -o "$out/q.pfm" $tiny --sky 40 --method keller --particles 50 --passes 4
check StateGoesOnToTheSameBits cmp "$out/p.pfm" "$out/q.pfm"
refuses StateOfAnotherSky 2 "scene" "$vpl" render "$scratch/open.json" -o "$out/x.pfm" --quiet --size 32x24 --sky 41 --method keller --particles 50 --passes 4 --resume "$out/state"
succeeds BudgetsWorkUnderASky "$vpl" render "$scratch/lit.json" -o "$out/p.pfm" $tiny --budget 300
succeeds ErrorsAreKeptUnderASky "$vpl" render "$scratch/lit.json" -o "$out/p.pfm" $tiny --max-error 0.1
# Layers of an EXR, where OpenEXR is built in.
if "$vpl" render "$scratch/lit.json" -o "$out/p.exr" $tiny --aov all 2>"$scratch/stderr"; then
    ok SkyAndLayers
else
    check SkyAndLayersNeedOpenExr grep -q "no OpenEXR" "$scratch/stderr"
fi
rm -f "$out"/*
