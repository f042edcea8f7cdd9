# SPDX-License-Identifier: MIT
# Radiosity from outside: the report's counts, what info foretells, stages for eyes, and meshes.

box=$PWD/examples/scenes/testmodel.json
s=$out/s.json
tiny="--method radiosity --size 16x12 --shadow-map 16"

# The report's 30, 60, 120, 192, 304, 464, 784 patches (its figures 8 to 11), and no more in a seventh round.
for pair in 0:30 1:60 2:120 3:192 4:304 5:464 6:784 7:784; do
    succeeds "BoxIsDivided_$pair" "$vpl" render "$box" $tiny --patch-size 0.45 --subdivisions "${pair%:*}" --show patches \
        -o "$out/a.pfm" --stats "$s"
    equals "BoxHasPatches_$pair" "${pair#*:}" "$(field "$s" patches)"
    equals "InfoForetellsPatches_$pair" "${pair#*:}" \
        "$("$vpl" info "$box" --method radiosity --patch-size 0.45 --subdivisions "${pair%:*}" --json >"$scratch/i" && field "$scratch/i" patches)"
done
for words in "--patches 100" "--patches 100 --antialias 3" "--patches 100 --hierarchy on" "--patch-size 1"; do
    succeeds "Radiosity: $words" "$vpl" render "$room" $tiny $words -o "$out/a.pfm" --stats "$s"
    succeeds "Info: radiosity $words" "$vpl" info "$room" --method radiosity --shadow-map 16 $words --json
    for key in patches lit_patches patch_sides draw_calls triangles; do
        equals "InfoForetells_$key: $words" "$(field "$s" $key)" "$(field "$scratch/stdout" $key)"
    done
done
for key in iterations residual spectral_radius form_factor_sums links; do
    "$vpl" render "$room" $tiny --patches 100 --hierarchy on -o "$out/a.pfm" --stats "$s"
    check "RadiosityStatsHave_$key" test -n "$(field "$s" $key)"
done
succeeds InfoOfRadiosity "$vpl" info "$room" --method radiosity --patches 100
check InfoHasPatches grep -qE '^ +patches +[0-9]+, edges up to [0-9.]+ m$' "$scratch/stdout"
check InfoHasLitPatches grep -qE '^ +lit patches +[0-9]+$' "$scratch/stdout"
check InfoHasSides grep -qE '^ +sides +[0-9]+ of [0-9]+ that light reaches$' "$scratch/stdout"
check InfoHasFormFactors grep -qE '^ +form factors +[0-9.]+ KiB$' "$scratch/stdout"
# Groups are named where there are some, and as many as foretold.
rooms=$PWD/examples/scenes/six-rooms.json
"$vpl" render "$rooms" $tiny --patches 300 --gather 0 -o "$out/a.pfm" --stats "$s"
"$vpl" info "$rooms" --method radiosity --patches 300 --gather 0 >"$scratch/i"
equals InfoForetellsGroups "$(field "$s" patch_groups) of the patches are groups of $(field "$s" grouped_triangles) triangles" \
    "$(sed -n 's/^ *groups *//p' "$scratch/i")"
"$vpl" render "$rooms" $tiny --patches 300 --gather 0 --patch-groups off -o "$out/a.pfm" --stats "$s"
equals NoGroupsAreNotNamed "" "$(grep -E 'patch_groups|grouped_triangles' "$s")"
# An empty hall around a lit room, which a hole of 10 x 10 cm lights: the picture of the room does not need it, a mesh does.
hall="$PWD/tests/data/hall.json"
wide="--method radiosity --patches 2000 --size 32x18"
"$vpl" render "$hall" $wide --faint-sides keep -o "$out/b.pfm" --stats "$s"
kept=$(field "$s" patch_sides)
succeeds FaintSidesAreLeftOut "$vpl" render "$hall" $wide -o "$out/a.pfm" --stats "$s"
check FaintSidesAreMany test $((4 * $(field "$s" patch_sides))) -lt $((3 * kept))
"$vpl" compare "$out/a.pfm" "$out/b.pfm" >"$scratch/i"
check FaintSidesMakeNoDifference awk '/^relative_rmse/ { exit !($2 < 0.005) }' "$scratch/i"
"$vpl" info "$hall" --method radiosity --patches 2000 >"$scratch/i"
check FaintSidesAreInThePlan grep -q "^ *--faint-sides leave .* of $kept sides" "$scratch/i"
"$vpl" bake "$hall" --patches 2000 -o "$out/a.ply" --stats "$s"
equals MeshesKeepFaintSides "$kept" "$(field "$s" patch_sides)"
rm -f "$out/a.ply"
for show in picture indirect direct depth patches patch-radiosity form-factor-sums residual; do
    succeeds "RadiosityShows_$show" "$vpl" render "$room" $tiny --patches 50 --show $show -o "$out/a.png"
done

cat >"$scratch/white.json" <<'END'
{ "camera": { "eye": [0, 0, 0.4], "target": [0, 0, 0] },
  "materials": { "white": { "diffuse": [0.9, 0.9, 0.9] } },
  "objects": [ { "type": "box", "material": "white" } ],
  "lights": [ { "type": "point", "position": [0, 0.2, 0], "intensity": [1, 1, 1] } ] }
END
refuses IncentresThatDivergeAreSaid 2 "row-sums" "$vpl" render "$scratch/white.json" $tiny --patches 12 --form-factors incentre \
    -o "$out/never.png"
refuses TooManyPairsAreSaid 2 "bytes" "$vpl" render "$room" $tiny --patches 40000 --hierarchy off --memory 2000 -o "$out/never.png"
refuses PatchesOfOthersAreSaid 2 "only radiosity" "$vpl" render "$room" --method keller --show residual -o "$out/never.png"
refuses NoPatchesAreSaid 2 "--patches is \"0\"" "$vpl" render "$room" $tiny --patches 0 -o "$out/never.png"

# Meshes.
succeeds RoomIsBaked "$vpl" bake "$room" --patches 200 -o "$out/room.ply" --stats "$s"
equals PlyBegins ply "$(head -n 1 "$out/room.ply")"
equals PlyIsBinary "format binary_little_endian 1.0" "$(sed -n 2p "$out/room.ply" | tr -d '\000')"
vertices=$(head -c 600 "$out/room.ply" | tr -d '\000' | sed -n 's/^element vertex //p')
faces=$(head -c 600 "$out/room.ply" | tr -d '\000' | sed -n 's/^element face //p')
check PlyHasItsPatches test "$faces" -ge 200 -a "$vertices" -ge 100
refuses BakeNeedsAName 2 "bake needs -o FILE" "$vpl" bake "$room"
refuses BakeWritesPlyOnly 2 "ends in .ply" "$vpl" bake "$room" -o "$out/room.obj"
refuses BakeFindsNoFolder 1 "cannot write" "$vpl" bake "$room" -o "$out/none/room.ply"
refuses BakeHasOneMethod 2 "bake writes the patches of --method radiosity alone" "$vpl" bake "$room" -o "$out/b.ply" --method keller
"$vpl" bake "$room" -o "$out/b.ply" --patches 50 --size 8x8 2>"$scratch/stderr"
equals BakeHasNoSize "0 vpl: warning: --size has no effect with vpl bake" "$? $(cat "$scratch/stderr")"
rm -f "$out"/*
