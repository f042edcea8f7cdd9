# SPDX-License-Identifier: MIT
# Renders that are interrupted, saved, continued and replayed: --no-partial, --checkpoint, --resume, --plan, --plan-out.

little="--size 40x30 --shadow-map 16 --quiet"

# interrupted NAME FILE WORDS...: an endless render, interrupted as soon as FILE is there (or after a second), ends with
# code 1. What it said is in $scratch/stderr.
interrupted() {
    name=$1
    until=$2
    shift 2
    "$vpl" render "$room" $little "$@" >"$scratch/stdout" 2>"$scratch/stderr" &
    process=$!
    for i in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20; do
        [ -s "$until" ] && break
        sleep 0.1
    done
    kill -INT $process
    wait $process
    equals "$name" 1 $?
}

# ---- interrupts
for method in "path --spp 100000" "keller --particles 20 --passes 100000" "ssvp --first-bounce 8 --second-bounce 8 --oversampling 1 --max-clusters 8 --passes 100000"; do
    word=${method%% *}
    interrupted "InterruptEndsWithOne_$word" none --method $method -o "$out/i.pfm" --stats "$out/i.json"
    check "InterruptSaysWhatItWrote_$word" grep -Eq \
        "^vpl: interrupted after [0-9]+ of [0-9]+ passes; $out/i.pfm has the picture so far, with an estimated error of [0-9.e+]+ %\$" "$scratch/stderr"
    equals "InterruptSaysNoMore_$word" 1 "$(wc -l <"$scratch/stderr")"
    passes=$(field "$out/i.json" passes)
    hash=$(field "$out/i.json" image_hash)
    count="--passes $passes"
    [ "$word" = path ] && count="--spp $((32 * passes))"
    "$vpl" render "$room" $little --method $method $count -o "$out/w.pfm" --stats "$out/w.json"
    equals "InterruptedPictureIsThatOfItsPasses_$word" "$(field "$out/w.json" image_hash)" "$hash"
    check "InterruptedFileIsThatPicture_$word" cmp "$out/w.pfm" "$out/i.pfm"
    rm "$out"/*
done
interrupted NoPartialEndsWithOne none --method path --spp 100000 --no-partial -o "$out/i.pfm" --stats "$out/i.json"
equals NoPartialSaysNothingWasWritten "vpl: cancelled, nothing was written" "$(cat "$scratch/stderr")"
equals NoPartialWritesNothing "" "$(ls -A "$out")"
interrupted AnErrorThatIsFarHasNoCount none --method keller --particles 20 --max-error 1e-9 -o "$out/i.pfm"
check ItSaysPassesAlone grep -Eq "^vpl: interrupted after [0-9]+ pass(es)?; " "$scratch/stderr"
moving_room=$PWD/examples/scenes/room-path.json
"$vpl" render "$moving_room" --size 64x48 --method path --spp 320 --frames 0:99999 -o "$out/f.pfm" 2>"$scratch/stderr" &
process=$!
sleep 1.5
kill -TERM $process
wait $process
equals InterruptedFrameEndsWithOne 1 $?
check InterruptedFrameSaysHowMany grep -Eq "^vpl: (interrupted after [0-9]+ of 100000 frames and [0-9]+ of 10 passes; $out/f-[0-9]+.pfm has the picture so far|cancelled, [0-9]+ of 100000 frames were written|cancelled, nothing)" "$scratch/stderr"
rm -f "$out"/*

# ---- states
for method in "path --spp 100" "keller --particles 20 --passes 5" "instant-radiosity --particles 7 --passes 5" \
    "ssvp --first-bounce 8 --second-bounce 8 --passes 5"; do
    word=${method%% *}
    "$vpl" render "$room" $little --method $method -o "$out/whole.pfm"
    interrupted "SavedRenderIsInterrupted_$word" "$out/state" --method $method --spp 100000 --passes 100000 --quiet \
        --checkpoint "$out/state" --checkpoint-every 0 -o "$out/part.pfm"
    check "InterruptSaysHowToGoOn_$word" grep -q "; go on with --resume $out/state\$" "$scratch/stderr"
    "$vpl" render "$room" $little --method $method -o "$out/first.pfm" --spp 40 --passes 2 --quiet --checkpoint "$out/state"
    succeeds "ResumeGoesOn_$word" "$vpl" render "$room" $little --method $method --resume "$out/state" \
        --checkpoint "$out/state" --threads 3 --isa scalar -o "$out/rest.pfm"
    check "ResumedPictureIsThatOfOneRender_$word" cmp "$out/whole.pfm" "$out/rest.pfm"
    succeeds "AFinishedStateHasThePicture_$word" "$vpl" render "$room" $little --method $method --resume "$out/state" -o "$out/again.pfm"
    check "ThePictureOfAFinishedState_$word" cmp "$out/whole.pfm" "$out/again.pfm"
    rm "$out"/*
done
"$vpl" render "$room" $little --passes 2 --particles 9 --method keller -o "$out/a.pfm" --checkpoint "$out/state"
rm "$out/a.pfm"
resume="render $room $little --passes 3 --particles 9 --method keller -o $out/a.pfm --resume"
refuses ResumeOfNothing 2 "cannot open" "$vpl" $resume "$out/none"
refuses ResumeOfAnotherFile 2 "not the state of a render" "$vpl" $resume "$room"
head -c 3000 "$out/state" >"$scratch/cut"
refuses ResumeOfACutFile 2 "damaged or not complete" "$vpl" $resume "$scratch/cut"
refuses ResumeOfOtherOptions 2 "saved with --seed 0, but this render has 3" "$vpl" $resume "$out/state" --seed 3
refuses ResumeOfAnotherScene 2 "another scene" "$vpl" render "$closed" $little --passes 3 --particles 9 --method keller -o "$out/a.pfm" --resume "$out/state"
# Patches for an error are drawn at once, but the planner may go on from them.
patches="$closed --size 96x54 --max-error 0.03 --quiet"
succeeds AStateOfPatches "$vpl" render $patches -o "$out/a.pfm" --checkpoint "$out/patches" --plan-out "$out/plan.json"
check PatchesAreChosen grep -q '"method": "radiosity"' "$out/plan.json"
succeeds PatchesAreResumed "$vpl" render $patches -o "$out/b.pfm" --resume "$out/patches"
check ResumedPatchesAreTheSame cmp "$out/a.pfm" "$out/b.pfm"
succeeds APlanOfPatchesIsReplayed "$vpl" render "$closed" --plan "$out/plan.json" --isa scalar -o "$out/c.pfm" --quiet
check ReplayedPatchesAreTheSame cmp "$out/a.pfm" "$out/c.pfm"
# Patches guide paths through edges, and are made again where a state goes on.
guided="examples/scenes/flat.json --size 96x54 --max-error 0.07 --seed 4 --quiet"
succeeds AStateOfGuidedPaths "$vpl" render $guided -o "$out/a.pfm" --checkpoint "$out/patches" --plan-out "$out/plan.json"
check GuidedPathsGoThroughEdges grep -q "\"edge-pixels\": \"[1-9]" "$out/plan.json"
succeeds GuidedPathsAreResumed "$vpl" render $guided -o "$out/b.pfm" --resume "$out/patches"
check ResumedGuidedPathsAreTheSame cmp "$out/a.pfm" "$out/b.pfm"
succeeds APlanOfGuidedPathsIsReplayed "$vpl" render examples/scenes/flat.json --plan "$out/plan.json" --isa scalar -o "$out/c.pfm" --quiet
check ReplayedGuidedPathsAreTheSame cmp "$out/a.pfm" "$out/c.pfm"
rm "$out/patches" "$out/plan.json" "$out"/[abc].pfm
# Pictures for a time are saved, too, and without any more time they stay as they are. The first plan for a time is small, and
# a state does not keep its picture; three seconds are enough to get beyond it on a busy machine.
succeeds AStateOfATime "$vpl" render "$closed" --size 96x54 --budget 3000 --quiet -o "$out/a.pfm" --checkpoint "$out/timed"
succeeds ATimeIsResumed "$vpl" render "$closed" --size 96x54 --budget 1 --quiet -o "$out/b.pfm" --resume "$out/timed"
check WithoutMoreTimeThePictureStays cmp "$out/a.pfm" "$out/b.pfm"
rm "$out/timed" "$out"/[ab].pfm
for option in checkpoint resume; do
    refuses "NoStateOfOnePass_$option" 2 "--$option: this picture is drawn at once" "$vpl" render "$room" $little --method direct -o "$out/a.pfm" "--$option" "$out/state"
    refuses "NoStateOfFrames_$option" 2 "--$option is for one picture, not for --frames" "$vpl" render "$room" $little -o "$out/a.pfm" "--$option" "$out/state" --frames 1:2
done
refuses ACheckpointIsNoPicture 2 "both the picture and the state would be written there" "$vpl" render "$room" -o "$out/a.pfm" --checkpoint "$out/a.pfm"
refuses ACheckpointInNoFolder 1 "cannot write" "$vpl" render "$room" -o "$out/a.pfm" --checkpoint "$out/none/state"
interrupted ASavedRenderWithoutAPicture "$out/late" --method keller --particles 9 --passes 100000 --no-partial --checkpoint "$out/late" --checkpoint-every 0 -o "$out/a.pfm"
equals NoPartialSaysHowToGoOn "vpl: interrupted, no picture was written; go on with --resume $out/late" "$(cat "$scratch/stderr")"
check NoPartialWritesNoPicture test ! -e "$out/a.pfm"
rm "$out"/*

# ---- plans
for words in "--method keller --particles 30" "--method keller --particles 30 --budget 100" "--method path --max-error 0.5" \
    "--method ssvp --first-bounce 8 --second-bounce 8" "--method radiosity --patches 50" "--method instant-radiosity" \
    "--method direct" "--method auto --max-error 0.4" "--preset keller-1997"; do
    word=$(echo "$words" | tr -d ' -')
    "$vpl" render "$room" $little $words -o "$out/a.pfm" --plan-out "$out/plan.json" --stats "$out/a.json"
    succeeds "PlanIsReplayed_$word" "$vpl" render "$room" --plan "$out/plan.json" --threads 3 --isa scalar -o "$out/b.pfm" --plan-out "$out/again.json"
    check "ReplayHasTheSameBits_$word" cmp "$out/a.pfm" "$out/b.pfm"
    equals "ReplayHasTheSameOptions_$word" "$(sed -n '/"options"/,/}/p' "$out/plan.json")" "$(sed -n '/"options"/,/}/p' "$out/again.json")"
    rm "$out"/*
done
succeeds InfoWritesAPlan "$vpl" info "$room" $little --seed 4 --plan-out "$out/info.json"
succeeds DryRunWritesAPlan "$vpl" render "$room" $little --seed 4 --dry-run --plan-out "$out/dry.json"
check TheyAreEqual cmp "$out/info.json" "$out/dry.json"
check APlanHasReasons grep -q '"why": "[^"]' "$out/dry.json"
check APlanHasTheSeed grep -q '"seed": "4"' "$out/dry.json"
"$vpl" render "$room" --plan "$out/dry.json" --seed 5 --dry-run --plan-out "$out/other.json" >"$scratch/stdout"
check OptionsBesideAPlanChangeIt grep -q '"seed": "5"' "$out/other.json"
check TheOthersAreThePlans grep -q '"size": "40x30"' "$out/other.json"
"$vpl" render "$closed" --plan "$out/dry.json" --dry-run >"$scratch/stdout" 2>"$scratch/stderr"
equals APlanOfAnotherSceneWarns "vpl: warning: $out/dry.json was made for another scene, or $closed was changed since: the picture will differ" "$(cat "$scratch/stderr")"
succeeds QuietDoesNot "$vpl" render "$closed" --plan "$out/dry.json" --dry-run --quiet
sed -e 's/"vpl_plan": 1/"vpl_plan": 2/' "$out/dry.json" >"$scratch/plan"
refuses APlanOfAnotherVersion 2 "$scratch/plan:2:15: vpl_plan is 2, must be 1" "$vpl" render "$room" --plan "$scratch/plan" -o "$out/a.pfm"
sed -e 's/"seed"/"sead"/' "$out/dry.json" >"$scratch/plan"
refuses APlanWithAnotherOption 2 "options.sead is no option" "$vpl" render "$room" --plan "$scratch/plan" -o "$out/a.pfm"
refuses APlanThatIsNone 2 "cannot open" "$vpl" render "$room" --plan "$out/none" -o "$out/a.pfm"
refuses APlanOfFrames 2 "--plan-out is for one picture" "$vpl" render "$room" -o "$out/a.pfm" --plan-out "$out/p" --frames 1:2
refuses APlanIsNoPicture 2 "both the picture and the plan" "$vpl" render "$room" -o "$out/a.pfm" --plan-out "$out/a.pfm"
refuses APlanInNoFolder 1 "cannot" "$vpl" info "$room" --plan-out "$out/none/p"
rm "$out"/*
