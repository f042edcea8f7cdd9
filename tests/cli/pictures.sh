# SPDX-License-Identifier: MIT
# Pictures: the same bits whatever the pipeline, threads and instruction set; every --show; compare.

base="--method instant-radiosity --size 75x50 --particles 100 --shadow-map 64 --antialias 1"

# hash_of WORDS...: the image hash of a render, or what went wrong.
hash_of() {
    if "$vpl" render "$room" $base -o "$out/h.pfm" --stats "$out/h.json" "$@" >"$scratch/stdout" 2>"$scratch/stderr"; then
        field "$out/h.json" image_hash
    else
        cat "$scratch/stderr"
    fi
}
for lighting in physical documented; do
    wanted=$(hash_of --lighting $lighting)
    check "HashIsThere_$lighting" test ${#wanted} -eq 18
    for pipeline in multipass batched deferred; do
        equals "SameBits_${lighting}_$pipeline" "$wanted" "$(hash_of --lighting $lighting --pipeline $pipeline)"
    done
    for threads in 1 2 3 7; do
        equals "SameBits_${lighting}_threads_$threads" "$wanted" "$(hash_of --lighting $lighting --threads $threads)"
    done
    for isa in scalar sse2 avx2 avx512; do
        found=$(hash_of --lighting $lighting --isa $isa)
        case $found in
        *"this machine or build lacks"*) ;;
        *) equals "SameBits_${lighting}_$isa" "$wanted" "$found" ;;
        esac
    done
done
shared=$(hash_of --pipeline interleaved --antialias 2)
check InterleavedIsAnotherPicture test "$shared" != "$(hash_of --antialias 2)"
equals InterleavedByOneIsDeferred "$(hash_of)" "$(hash_of --pipeline interleaved --interleave 1)"
for threads in 1 2 3 7; do
    equals "SameBits_interleaved_threads_$threads" "$shared" "$(hash_of --pipeline interleaved --antialias 2 --threads $threads)"
done
for isa in scalar sse2 avx2 avx512; do
    found=$(hash_of --pipeline interleaved --antialias 2 --isa $isa)
    case $found in
    *"this machine or build lacks"*) ;;
    *) equals "SameBits_interleaved_$isa" "$shared" "$found" ;;
    esac
done
for way in "--method keller" "--method keller --light-shadows ray --passes 3" "--pipeline lightcuts --light-shadows ray" \
    "--method keller --placement view --pipeline interleaved" "--placement rsm --rsm-size 32 --light-shadows map"; do
    once=$(hash_of $way)
    check "HashIsThere: $way" test ${#once} -eq 18
    equals "SameBitsOnThreeThreads: $way" "$once" "$(hash_of $way --threads 3 --isa sse2)"
    equals "SameBitsOnOneThread: $way" "$once" "$(hash_of $way --threads 1 --isa scalar)"
done
equals BatchSizeChangesNothing "$(hash_of --pipeline batched --batch 1)" "$(hash_of --pipeline batched --batch 99)"
other=$(hash_of --seed 1)
check AnotherSeedIsAnotherPicture test "$other" != "$(hash_of --seed 2)"
equals EqualsSignIsASpace "$other" "$(hash_of --seed=1)"
equals LastOptionWins "$other" "$(hash_of --seed 5 --seed=1)"
equals LightsKnowNoThreads "$("$vpl" lights "$room" --particles 500 --threads 1 | cksum)" \
    "$("$vpl" lights "$room" --particles=500 --threads=7 | cksum)"

for show in picture depth normals shadow-map shadow-factor direct indirect light:3 overlay; do
    succeeds "Show_$show" "$vpl" render "$room" $base -o "$out/$show.png" --show $show
    check "Show_${show}_IsAPicture" "$vpl" compare "$out/$show.png" "$out/$show.png"
done
check NothingShownTwice test "$(cksum "$out"/*.png | cut -d' ' -f1 | sort -u | wc -l)" -eq 9

# Exposure and tone map: by default automatic and AgX for light, nothing for other stages; linear files ignore them.
# displayed NAME WORDS...: a checksum of the PNG file.
displayed() {
    "$vpl" render "$room" $base -o "$out/e.png" "$@" 2>"$scratch/stderr"
    cksum "$out/e.png"
}
for show in picture direct indirect light:3; do
    equals "LightIsExposed_$show" "$(displayed --show $show --exposure auto --tonemap agx)" "$(displayed --show $show)"
done
for show in depth normals shadow-map shadow-factor overlay; do
    equals "OtherStagesAreNot_$show" "$(displayed --show $show --exposure 0 --tonemap none)" "$(displayed --show $show)"
done
for show in depth normals shadow-map shadow-factor; do
    equals "ExposureIsForLightOnly_$show" "$(displayed --show $show --exposure 3)" "$(displayed --show $show)"
done
for map in none reinhard aces agx; do
    displayed --tonemap $map
done | sort -u >"$scratch/maps"
equals ToneMapsDiffer 4 "$(wc -l <"$scratch/maps")"
check ExposureShows test "$(displayed --exposure 1)" != "$(displayed --exposure 2)"
displayed -v >"$scratch/stdout"
check AutomaticExposureIsSaid grep -qE '^vpl: exposure [+-][0-9]+\.[0-9][0-9] stops \(auto\)$' "$scratch/stderr"
displayed -v --exposure -1.5 >"$scratch/stdout"
check ExposureIsSaid grep -qx 'vpl: exposure -1.50 stops' "$scratch/stderr"
displayed --exposure 1 --tonemap reinhard >"$scratch/stdout"
check ReinhardHasItsOwnKey grep -q 'warning: --exposure has no effect with --tonemap reinhard' "$scratch/stderr"
displayed --tonemap agx --show depth >"$scratch/stdout"
check DepthHasNoToneMap grep -q 'warning: --tonemap has no effect with a --show that is not light' "$scratch/stderr"
rm "$out/e.png"
# The back wall faces the camera: its normal (0, 0, 1) is shown as (0.5, 0.5, 1), in linear light (0.214, 0.214, 1).
"$vpl" render "$closed" --size 16x9 --method direct --show normals --quiet -o "$out/n.png"
"$vpl" compare "$out/n.png" "$out/n.png" --region 9,4,1,1 --regions 1x1 >"$scratch/stdout"
check NormalsTowardsTheEyeAreBlue awk 'END { exit !($5 > 0.47 && $5 < 0.48) }' "$scratch/stdout"
rm "$out/n.png"

for type in png hdr pfm; do
    succeeds "Write_$type" "$vpl" render "$room" $base -o "$out/a.$type" --seed 1
    succeeds "CompareWithItself_$type" "$vpl" compare "$out/a.$type" "$out/a.$type"
    check "NoDifference_$type" grep -qE '^rmse +0$' "$scratch/stdout"
    check "InfinitePsnr_$type" grep -qE '^psnr +inf dB$' "$scratch/stdout"
    check "EnergyRatioOne_$type" grep -qE '^energy_ratio +1$' "$scratch/stdout"
done
succeeds CompareJson "$vpl" compare --json "$out/a.pfm" "$out/a.pfm"
equals JsonRmse 0.0 "$(field "$scratch/stdout" rmse)"
equals JsonPsnrIsNull null "$(field "$scratch/stdout" psnr)"
"$vpl" render "$room" $base -o "$out/b.pfm" --seed 2
succeeds CompareTwo "$vpl" compare --json "$out/a.pfm" "$out/b.pfm" --heatmap "$out/map.png"
for key in rmse relative_rmse relmse trimmed_relmse psnr ssim flip flip_ppd energy_ratio max_difference max_x max_y; do
    check "CompareHas_$key" test -n "$(field "$scratch/stdout" $key)"
done
check HeatmapIsAPicture "$vpl" compare "$out/map.png" "$out/map.png"
"$vpl" render "$room" -o "$out/c.pfm" --size 8x8 --shadow-map 16
metrics=$("$vpl" compare --json "$out/a.pfm" "$out/b.pfm" --threads 1 | cksum)
for threads in 2 3 7; do
    equals "MetricsKnowNoThreads_$threads" "$metrics" "$("$vpl" compare --json "$out/a.pfm" "$out/b.pfm" --threads $threads | cksum)"
done
for what in difference relative ssim flip; do
    succeeds "HeatmapOf_$what" "$vpl" compare "$out/a.pfm" "$out/b.pfm" --heatmap "$out/heat-$what.png" --heatmap-of $what
done
check HeatmapsDiffer test "$(cksum "$out"/heat-*.png | cut -d' ' -f1 | sort -u | wc -l)" -eq 4
"$vpl" compare --json "$out/a.pfm" "$out/b.pfm" >"$scratch/near"
"$vpl" compare --json "$out/a.pfm" "$out/b.pfm" --ppd 300 >"$scratch/far"
check PixelsPerDegreeChangeFlip test "$(field "$scratch/near" flip)" != "$(field "$scratch/far" flip)"
equals PixelsPerDegreeChangeNoSsim "$(field "$scratch/near" ssim)" "$(field "$scratch/far" ssim)"

succeeds RegionsAreATable "$vpl" compare "$out/a.pfm" "$out/b.pfm" --regions 5x2
equals RegionsHaveTenRows 10 "$(sed '1,/mean_a/d' "$scratch/stdout" | wc -l)"
succeeds RegionsAreJson "$vpl" compare "$out/a.pfm" "$out/b.pfm" --regions 3x2 --json
equals RegionsHaveSixObjects 6 "$(grep -c mean_a "$scratch/stdout")"
# A region's rmse is that of the same rectangle alone; its largest difference is told in the whole picture.
"$vpl" compare "$out/a.pfm" "$out/b.pfm" --json --region 25,0,25,25 >"$scratch/region"
equals RegionIsItsBlock "$(field "$scratch/region" rmse)" \
    "$(tr -d ' \n' <"$scratch/stdout" | sed 's/.*"x":25,"y":0,[^}]*"rmse":\([^}]*\)}.*/\1/')"
check RegionTellsPlacesInThePicture test "$(field "$scratch/region" max_x)" -ge 25
refuses RegionOutside 2 "must lie inside the picture, which is 75x50" "$vpl" compare "$out/a.pfm" "$out/b.pfm" --region 70,0,6,1
refuses RegionDoesNotHideSizes 2 "differ in size" "$vpl" compare "$out/a.pfm" "$out/c.pfm" --region 0,0,4,4
refuses TooManyRegions 2 "must be in [1, 75] and [1, 50]" "$vpl" compare "$out/a.pfm" "$out/b.pfm" --regions 76x1
if "$vpl" render "$room" $base -o "$out/a.exr" --seed 1 2>"$scratch/stderr"; then
    succeeds CompareExr "$vpl" compare "$out/a.exr" "$out/a.pfm"
    check ExrKeepsTheRender grep -qE '^rmse +0$' "$scratch/stdout"
else
    check NoOpenExrIsSaid grep -q 'this build has no OpenEXR' "$scratch/stderr"
    exr=$PWD/tests/fuzz/corpus/image/none.exr
    refuses NoOpenExrToRead 2 "no OpenEXR" "$vpl" compare "$exr" "$exr"
fi
refuses CompareDifferentSizes 2 "differ in size: 75x50 and 8x8" "$vpl" compare "$out/a.pfm" "$out/c.pfm"

"$vpl" render "$room" $base -o "$out/loud.pfm" --seed 1 -v >"$scratch/stdout" 2>"$scratch/stderr"
check ResultsAloneGoToStdout test ! -s "$scratch/stdout" -a -s "$scratch/stderr"
"$vpl" render "$room" --size 32x18 --method keller --particles 20 --passes 9 -o "$out/loud.hdr" -v 2>"$scratch/decided"
check VerboseSaysWhatWasDecided grep -q '^vpl: --light-shadows [a-z]*: ' "$scratch/decided"
check VerboseSaysNoLinePerPass test "$(grep -c '^vpl: shading' "$scratch/decided")" -eq 1
check VerboseChangesNothing cmp "$out/loud.pfm" "$out/a.pfm"
check NoTemporaryPictures test -z "$(ls -A "$out" | grep -v -E '\.(png|hdr|pfm|exr|json)$')"

# The path-traced reference: the same bits for all threads and instruction sets, what it can show, what it tells.
paths="--method path --spp 3"
wanted=$(hash_of $paths)
check PathsHaveAHash test ${#wanted} -eq 18
for threads in 1 3; do
    equals "PathsKnowNoThreads_$threads" "$wanted" "$(hash_of $paths --threads $threads)"
done
equals PathsKnowNoIsa "$wanted" "$(hash_of $paths --isa scalar)"
check OtherPathsForOtherSeeds test "$wanted" != "$(hash_of $paths --seed 1)"
check PathsTellTheirError test "$(field "$out/h.json" error_estimate)" != null
check MoreBouncesAreAnotherPicture test "$(hash_of $paths --max-bounces 0)" != "$(hash_of $paths --max-bounces 1)"
equals NoBouncesAreDirectLight "$(hash_of $paths --max-bounces 0)" "$(hash_of $paths --show direct)"
for show in indirect bounce:0 bounce:2; do
    succeeds "PathsShow_$show" "$vpl" render "$room" $base $paths -o "$out/h.png" --show $show --quiet
done
"$vpl" render "$room" $base $paths -o "$out/h.png" -v 2>"$scratch/told"
check PathsSayTheirError grep -q "the error is about" "$scratch/told"
refuses PathsAreNotDocumented 2 "physical lighting only" "$vpl" render "$room" $paths --lighting documented -o "$out/h.png"
refuses PathsShowNoNormals 2 "bounce:K" "$vpl" render "$room" $paths --show normals -o "$out/h.png"
