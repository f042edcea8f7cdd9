# SPDX-License-Identifier: MIT
# vpl render --frames: names, numbers, and the same pictures one by one.

moving=$PWD/examples/scenes/room-path.json
few="--size 40x30 --particles 20 --shadow-map 32"

mkdir "$out/frames"
succeeds FramesAreRendered "$vpl" render "$moving" $few -o "$out/frames/a.b.pfm" --stats "$out/frames/s" --frames 8:10
equals FramesAreNumbered "a.b-0008.pfm a.b-0009.pfm a.b-0010.pfm s-0008 s-0009 s-0010" "$(ls "$out/frames" | tr '\n' ' ' | sed 's/ $//')"
# one_hash WORDS...: the hash of a single frame of the moving room.
one_hash() {
    "$vpl" render "$moving" $few -o "$out/frames/x.pfm" --stats "$out/frames/x" "$@" && field "$out/frames/x"-*[0-9] image_hash
    rm "$out/frames"/x*
}
for i in 10 8 9; do
    equals "FrameIsThatOfASeparateRender_$i" "$(field "$out/frames/s-$(printf %04d $i)" image_hash)" "$(one_hash --frames $i:$i --threads 3)"
done
check FramesDiffer test "$(one_hash --frames 8:8)" != "$(one_hash --frames 9:9)"
"$vpl" render "$moving" $few -o "$out/frames/y.pfm" --stats "$out/frames/y"
"$vpl" render "$moving" $few -o "$out/frames/y.pfm" --stats "$out/frames/y" --frames 0:0
equals WithoutFramesItIsTheFirst "$(field "$out/frames/y" image_hash)" "$(field "$out/frames/y-0000" image_hash)"
"$vpl" render "$moving" $few --method keller -o "$out/frames/k.pfm" --stats "$out/frames/k" --frames 3:4
equals FramesOfKellerAreThose "$(field "$out/frames/k-0004" image_hash)" "$(one_hash --method keller --frames 4:4)"
succeeds LongNumbersAreNotCut "$vpl" render "$room" --size 4x4 --method direct --shadow-map 8 -o "$out/frames/z.png" --frames 99999:100000
check LongNumbersAreAsWideAsTheLast test -s "$out/frames/z-099999.png" -a -s "$out/frames/z-100000.png"
"$vpl" render "$moving" $few -o "$out/frames/e.png" --frames 8:20 -v 2>"$scratch/stderr"
equals FramesShareAnAutomaticExposure "13 1" \
    "$(grep -c '^vpl: exposure' "$scratch/stderr") $(grep '^vpl: exposure' "$scratch/stderr" | sort -u | wc -l)"
"$vpl" render "$moving" $few -o "$out/frames/f.png" --frames 20:20 -v 2>"$scratch/alone"
check ThatOfTheLastAloneIsAnother test "$(grep '^vpl: exposure' "$scratch/alone")" != "$(grep -m 1 '^vpl: exposure' "$scratch/stderr")"
succeeds DotsOfFoldersAreNoExtensions "$vpl" render "$room" --size 4x4 --method direct --shadow-map 8 -o "$out/frames/z.pfm" --stats "$out/frames/../stats" --frames 1:1
check TheStatisticsAreThere test -s "$out/stats-0001"
# Each frame's file has its layers, where OpenEXR is built in.
if "$vpl" render "$moving" $few -o "$out/frames/l.exr" --frames 8:9 --aov all --stats "$out/frames/l" 2>"$scratch/stderr"; then
    for i in 8 9; do
        check "FrameHasItsLayers_$i" grep -aq object.id.names "$out/frames/l-000$i.exr"
        equals "LayersChangeNoFrame_$i" "$(field "$out/frames/s-000$i" image_hash)" "$(field "$out/frames/l-000$i" image_hash)"
    done
else
    check LayersNeedOpenExr grep -q "no OpenEXR" "$scratch/stderr"
fi
rm -r "$out/frames" "$out/stats-0001"

for bad in "" 5 3:2 1:2:3 a:b 1: :2 -1:2 "1: 2" 1:2x 0:100000 0:9999999999 1.5:2; do
    refuses "FramesRefused_$bad" 2 "--frames is \"$bad\", must be" "$vpl" render "$moving" -o "$out/a.png" --frames="$bad"
done
mkdir "$out/a-0004.png"
refuses FramesFindAFolderInTheWay 1 "is a directory" "$vpl" render "$moving" -o "$out/a.png" --frames 4:5
rmdir "$out/a-0004.png"
sed -e 's/"eye": \[-1.2, 2.2, 8.2\]/"eye": [0, 2, 8], "target": [0, 2, 0]/' \
    -e 's/"eye": \[0, 2.6, 7.4\]/"eye": [0, 2, -8]/' "$moving" >"$scratch/through.json"
refuses FramesThatDegenerateAreBadInput 2 "camera 0 at frame" "$vpl" render "$scratch/through.json" $few -o "$out/a.pfm" --frames 15:15

# What was finished stays; nothing is half there.
"$vpl" render "$moving" $few -o "$out/t.pfm" --frames 0:99999 >"$scratch/stdout" 2>"$scratch/stderr" &
process=$!
for i in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20; do
    [ -s "$out/t-0002.pfm" ] && break
    sleep 0.2
done
kill -INT $process
wait $process
equals InterruptedFramesEndWithOne 1 $?
check InterruptedFramesSayHowMany grep -q "^vpl: cancelled, [0-9]* of 100000 frames were written" "$scratch/stderr"
check InterruptedFramesKeepWhatIsFinished test "$(sed 's/.*cancelled, \([0-9]*\) .*/\1/' "$scratch/stderr")" -eq "$(ls "$out" | grep -c '^t-.*\.pfm$')"
equals InterruptedFramesLeaveNothingElse 1 "$(ls "$out"/t-* | sed 's/.*\.//' | sort -u | wc -l)"
rm "$out"/t-*

succeeds InfoTellsTheFrames "$vpl" info "$moving"
check InfoNamesFirstAndLastFrame grep -q "paths *2, frames 0 to 60" "$scratch/stdout"
"$vpl" info "$moving" --json >"$scratch/info.json"
equals InfoJsonNamesTheLastFrame 60 "$(field "$scratch/info.json" last_frame | sed 's/\.0*$//')"
