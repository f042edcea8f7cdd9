# SPDX-License-Identifier: MIT
# The speeds of the machine: measured once, kept in the cache folder, and never an error or a different picture.

cache=$scratch/speeds
few="--size 16x12 --shadow-map 16 --particles 10 --passes 1 --quiet"
files() {
    find "$cache" -type f 2>/dev/null | wc -l | tr -d ' '
}

XDG_CACHE_HOME=$cache
succeeds InfoWithoutABudgetMeasuresNothing "$vpl" info "$closed" $few
equals InfoWithoutABudgetKeepsNothing 0 "$(files)"
check InfoWithoutSpeedsSaysWhichMachine grep -q '^  time .* on the machine of our benchmarks' "$scratch/stdout"

succeeds RenderWithABudgetMeasuresInSilence "$vpl" render "$closed" $few --budget 1000 -o "$out/a.pfm"
equals RenderWithABudgetKeepsOneFile 1 "$(files)"
file=$(find "$cache" -type f)
cp "$file" "$scratch/first"
succeeds RenderWithABudgetReadsSpeeds "$vpl" render "$closed" $few --budget 1000 -o "$out/b.pfm"
check SpeedsAreMeasuredOnce cmp "$file" "$scratch/first"
succeeds InfoReadsSpeeds "$vpl" info "$closed" $few
check InfoOfKnownSpeedsSaysSo grep -q '^  time .* on this machine' "$scratch/stdout"
"$vpl" info "$closed" $few --json >"$scratch/info"
equals InfoJsonHasTheMachine false "$(field "$scratch/info" usual_speeds)"

sed 's/: \([0-9]\)/: 7\1/' "$scratch/first" >"$file"
succeeds SlowSpeedsRender "$vpl" render "$closed" $few -o "$out/c.pfm"
rm "$file"
succeeds NoSpeedsRender "$vpl" render "$closed" $few -o "$out/d.pfm"
check SpeedsChangeNoBit cmp "$out/c.pfm" "$out/d.pfm"

for text in "" "{" "[]" "{\"threads\": -1}" "{\"threads\": \"two\"}"; do
    printf '%s' "$text" >"$file"
    succeeds "InfoOfABrokenFile_$text" "$vpl" info "$closed" $few
    check "BrokenSpeedsAreNotUsed_$text" grep -q 'of our benchmarks' "$scratch/stdout"
done
succeeds ABrokenFileIsMeasuredAnew "$vpl" info "$closed" $few --budget 1000
check ANewFileReplacesABrokenOne grep -q '"shadow_ray": [0-9]' "$file"
equals ANewFileIsTheOnlyOne 1 "$(files)"

rm -r "$cache"
"$vpl" info "$closed" $few --budget 1000 -v >"$scratch/stdout" 2>"$scratch/stderr"
check MeasuringIsSaidByV grep -q 'measured the speeds of this machine, kept in ' "$scratch/stderr"
equals MeasuringIsSaidInOneLine 1 "$(wc -l <"$scratch/stderr" | tr -d ' ')"
rm -r "$cache"
succeeds Calibrate "$vpl" bench --calibrate
check CalibrateSaysWhere grep -q "^kept in $cache/libvpl/speeds-" "$scratch/stdout"
succeeds CalibrateJson "$vpl" bench --calibrate --json
check CalibrateJsonHasSpeeds grep -q '"path_ray": [0-9]' "$scratch/stdout"

# A file stands where the folder should be: nobody can make it, root neither.
printf x >"$scratch/blocked"
XDG_CACHE_HOME=$scratch/blocked
succeeds NoCacheFolderIsNoError "$vpl" render "$closed" $few --budget 1000 -o "$out/e.pfm"
"$vpl" info "$closed" $few --budget 1000 -v >"$scratch/stdout" 2>"$scratch/stderr"
check NoCacheFolderIsSaidByV grep -q 'no cache folder' "$scratch/stderr"
check NoCacheFolderMeansUsualSpeeds grep -q 'of our benchmarks' "$scratch/stdout"
succeeds CalibrateWithoutAFolder "$vpl" bench --calibrate
check CalibrateWithoutAFolderSaysSo grep -q '^not kept' "$scratch/stdout"
if [ "$(id -u)" -ne 0 ]; then
    mkdir "$scratch/locked"
    chmod 500 "$scratch/locked"
    XDG_CACHE_HOME= HOME=$scratch/locked
    succeeds ReadOnlyHomeIsNoError "$vpl" render "$closed" $few --budget 1000 -o "$out/e.pfm"
fi
home=$HOME
unset XDG_CACHE_HOME
HOME=$scratch/home
mkdir "$HOME"
succeeds WithoutXdgTheHomeHasTheCache "$vpl" info "$closed" $few --budget 1000
equals HomeHasTheFile 1 "$(find "$HOME/.cache/libvpl" -name 'speeds-*.json' | wc -l | tr -d ' ')"
unset HOME
succeeds NoHomeIsNoError "$vpl" info "$closed" $few --budget 1000
check NoHomeMeansUsualSpeeds grep -q 'of our benchmarks' "$scratch/stdout"
export HOME=$home XDG_CACHE_HOME=$scratch/cache
rm -f "$out"/[a-e].pfm
