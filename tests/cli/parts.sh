# SPDX-License-Identifier: MIT
# Parts of a picture: vpl render --tile and vpl merge.

area=$PWD/examples/scenes/room-area.json
for method in "keller --particles 200" "path --spp 4" "keller --particles 20 --passes 5" "ssvp --first-bounce 16 --second-bounce 16" \
    "radiosity --patches 100"; do
    word=${method%% *}
    options="--method $method --size 48x150 --quiet"
    "$vpl" render "$area" -o "$out/whole.pfm" $options
    for part in 1 2 3; do
        "$vpl" render "$area" -o "$out/part$part" --tile $part/3 --threads $part $options
    done
    succeeds "MergeOfParts_$word" "$vpl" merge "$out/part3" "$out/part1" "$out/part2" -o "$out/merged.pfm"
    check "MergedPartsAreTheWhole_$word" cmp "$out/whole.pfm" "$out/merged.pfm"
done
cat "$out/part1" "$out/part2" "$out/part3" >"$out/all"
succeeds PartsInOneFile "$vpl" merge "$out/all" -o "$out/all.pfm"
check PartsInOneFileAreTheWhole cmp "$out/whole.pfm" "$out/all.pfm"
succeeds MergeWritesPng "$vpl" merge "$out/part1" "$out/part2" "$out/part3" -o "$out/merged.png"
"$vpl" render "$area" -o "$out/whole.png" $options
check MergedPngIsThatOfTheWhole cmp "$out/whole.png" "$out/merged.png"
refuses MergeSaysWhatIsMissing 2 "of the picture are missing; the first is" "$vpl" merge "$out/part1" -o "$out/no.pfm"
refuses MergeOfAPicture 2 "not a part of a picture" "$vpl" merge "$out/whole.pfm" -o "$out/no.pfm"
refuses MergeOfNothing 2 "cannot open: No such file" "$vpl" merge "$out/none" -o "$out/no.pfm"
refuses MergeOfAFolder 2 "cannot read: Is a directory" "$vpl" merge "$out" -o "$out/no.pfm"
refuses MergeNeedsParts 2 "merge needs parts of a picture" "$vpl" merge -o "$out/no.pfm"
refuses MergeNeedsOutput 2 "merge needs -o FILE" "$vpl" merge "$out/part1"
refuses MergeOfUnknownFormat 2 "unknown picture format" "$vpl" merge "$out/part1" -o "$out/no.xyz"
"$vpl" render "$area" -o "$out/other" --tile 2/3 --method radiosity --patches 101 --size 48x150 --quiet
refuses MergeOfOtherOptions 2 "other" "$vpl" merge "$out/part1" "$out/other" "$out/part3" -o "$out/no.pfm"
head -c 1000 "$out/part1" >"$out/short"
refuses MergeOfAShortPart 2 "short" "$vpl" merge "$out/short" -o "$out/no.pfm"
for value in 0/3 4/3 1 1/ /2 a/b 1/99999; do
    refuses "Tile_$value" 2 "--tile is \"$value\", must be I/N" "$vpl" render "$area" -o "$out/no" --tile "$value"
done
refuses TileWithABudget 2 "a time or an error ends this picture" "$vpl" render "$area" -o "$out/no" --tile 1/2 --budget 50 --quiet
refuses TileWithQuality 2 "a time or an error ends this picture" "$vpl" render "$area" -o "$out/no" --tile 1/2 --quality draft --quiet
refuses TileWithStats 2 "without --stats" "$vpl" render "$area" -o "$out/no" --tile 1/2 --stats "$out/no.json"
rm -f "$out"/*
