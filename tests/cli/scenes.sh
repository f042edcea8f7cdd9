# SPDX-License-Identifier: MIT
# Bad input: each broken scene of tests/data/broken gives its own sentence with file, line and column.

grep -v '^#' tests/data/broken/expected.csv | tail -n +2 >"$scratch/expected"
while IFS=, read -r file line column message; do
    path=tests/data/broken/$file
    refuses "Broken: $file" 2 "vpl: $path:$line:$column: " "$vpl" render "$path" -o "$out/never.png"
    check "BrokenSentence: $file" grep -qF -- "$message" "$scratch/stderr"
done <"$scratch/expected"
equals EveryBrokenSceneIsListed "$(ls tests/data/broken/*.json | wc -l)" "$(wc -l <"$scratch/expected")"

never=$out/never.png
refuses SceneIsMissing 2 "missing.json: cannot open: No such file" "$vpl" render "$scratch/missing.json" -o "$never"
refuses SceneIsAFolder 2 "cannot read: Is a directory" "$vpl" render "$scratch" -o "$never"
refuses SceneFolderIsAFile 2 "cannot open: Not a directory" "$vpl" render "$room/scene.json" -o "$never"
cp "$room" "$scratch/secret.json"
chmod 000 "$scratch/secret.json"
if [ ! -r "$scratch/secret.json" ]; then # root reads it anyway
    refuses SceneMayNotBeRead 2 "cannot open: Permission denied" "$vpl" render "$scratch/secret.json" -o "$never"
fi
for command in lights info; do
    refuses "BrokenSceneFor_$command" 2 "$(printf 'nan.json:2:28')" "$vpl" $command tests/data/broken/nan.json
done

cat >"$scratch/spot.json" <<'SCENE'
{ "camera": { "eye": [0, 0, 5], "target": [0, 0, 0] }, "objects": [],
  "lights": [{ "type": "spot", "position": [0, 4, 0], "direction": [0, -1, 0], "intensity": [1, 1, 1] }] }
SCENE
cat >"$scratch/dark.json" <<'SCENE'
{ "camera": { "eye": [0, 0, 5], "target": [0, 0, 0] }, "objects": [] }
SCENE
refuses SceneWithoutLights 2 "no emitter" "$vpl" render "$scratch/dark.json" -o "$never" --size 8x8
refuses LightsOfASceneWithoutLights 2 "no emitter" "$vpl" lights "$scratch/dark.json"
refuses ShadowMapWithoutLights 2 "no light" \
    "$vpl" render "$scratch/dark.json" -o "$never" --size 8x8 --method direct --show shadow-map
succeeds InfoOfASceneThatCannotBeRendered "$vpl" info "$scratch/spot.json" --method instant-radiosity --lighting documented
check InfoSaysWhyNot grep -q 'not possible:' "$scratch/stdout"
succeeds ASceneOfNothingIsBlack "$vpl" render "$scratch/dark.json" -o "$out/dark.pfm" --size 8x8 --method direct
rm -f "$out/dark.pfm"

grep -v '^#' tests/data/obj/broken/expected.csv | tail -n +2 >"$scratch/expected"
while IFS=, read -r file where line column found expected; do
    path=tests/data/obj/broken
    refuses "BrokenObj: $file" 2 "vpl: $path/$where:$line:$column: " "$vpl" info "$path/$file"
    check "BrokenObjSentence: $file" grep -qF -- "$found" "$scratch/stderr"
    check "BrokenObjExpects: $file" grep -qF -- "$expected" "$scratch/stderr"
done <"$scratch/expected"
equals EveryBrokenObjIsListed "$(ls tests/data/obj/broken/*.obj | wc -l)" "$(wc -l <"$scratch/expected")"
refuses ObjIsMissing 2 "none.obj: cannot open: No such file" "$vpl" render "$scratch/none.obj" -o "$never"

# Broken PLY, STL and glTF files: the place is line:column, or "byte N" behind a blank.
for kind in ply stl gltf; do
    path=tests/data/$kind/broken
    grep -v '^#' $path/expected.csv | tail -n +2 >"$scratch/expected"
    while IFS=, read -r file where found expected; do
        case $where in byte*) where=" $where" ;; esac
        refuses "Broken_$kind: $file" 2 "vpl: $path/$file:$where: " "$vpl" info --quiet "$path/$file"
        check "Broken_${kind}_Finds: $file" grep -qF -- "$found" "$scratch/stderr"
        check "Broken_${kind}_Expects: $file" grep -qF -- "$expected" "$scratch/stderr"
    done <"$scratch/expected"
    equals "EveryBroken_${kind}_IsListed" "$(($(ls $path | wc -l) - 1))" "$(wc -l <"$scratch/expected")"
done
refuses OtherModelsAreNamed 2 "room.fbx: .fbx files are not read" "$vpl" info room.fbx

# What a file is, where its name says something else.
kind() { # kind BYTES NAME FOUND
    printf "$1" >"$scratch/$2"
    refuses "FileOfAnotherKindIsNamed: $2 has $3" 2 "$2:1:1: found $3, expected " "$vpl" info "$scratch/$2"
}
kind 'glTF\002\000\000\000' kind.json "a binary glTF file"
kind '\211PNG\r\n\032\n' kind.json "a PNG picture"
kind '# a mesh\nv 0 0 0\n' kind.gltf "an OBJ model"
kind 'ply\nformat ascii 1.0\n' kind.obj "a PLY model"
kind '\n {"asset":{"version":"2.0"}}' kind.ply "a JSON file"
kind '\037\213\010\000' kind.stl "a gzip archive"
kind '<?xml version="1.0"?><COLLADA/>' kind.glb "an XML file"
printf '{"asset":{"version":"2.0"}}' >"$scratch/kind.json"
refuses GltfFileNamedJsonIsNamed 2 "asset is a key of glTF files, whose names end in .gltf" "$vpl" info "$scratch/kind.json"
printf '{"camera":{}}' >"$scratch/kind.png"
refuses SceneIsNoPicture 2 "kind.png:1:1: found a JSON file, expected a PNG picture" "$vpl" compare "$scratch/kind.png" "$scratch/kind.png"

# One triangle in each format gives one picture.
for file in ply/odd/crlf.ply ply/odd/cr-binary.ply stl/odd/solid-binary.stl stl/odd/upper-case-name.STL gltf/odd/binary.glb; do
    "$vpl" render "tests/data/$file" -o "$out/triangle.pfm" --size 32x24 --method direct --quiet
    equals "ModelIsRendered: $file" 0 $?
    [ "$file" != ply/odd/cr-binary.ply ] || continue # its first corner is 1e-44 m elsewhere
    [ -e "$scratch/triangle.pfm" ] || cp "$out/triangle.pfm" "$scratch/triangle.pfm"
    check "ModelsHaveTheSameBits: $file" cmp "$out/triangle.pfm" "$scratch/triangle.pfm"
done
"$vpl" info tests/data/gltf/odd/range.gltf >"$scratch/stdout" 2>"$scratch/stderr"
check GltfLightsAreCounted grep -q 'lights  *1 (1 point' "$scratch/stdout"
check GltfRangeIsWarnedOf grep -q 'range.gltf: 1 lights have a range, which has no effect' "$scratch/stderr"
rm -f "$out/triangle.pfm"

# A mesh in a scene, and by itself: the program says what it added, unless told to be quiet.
succeeds InfoOfASceneOfMeshes "$vpl" info tests/data/obj/meshes.json --json
equals InfoCountsObjectsOfMeshes 3 "$(field "$scratch/stdout" mesh)"
equals InfoCountsTrianglesOfMeshes 11 "$(tr -d ' \n' <"$scratch/stdout" | sed -n 's/.*"meshes":{[^}]*"triangles":\([0-9]*\).*/\1/p')"
succeeds ASceneOfMeshesIsRendered "$vpl" render tests/data/obj/meshes.json -o "$out/meshes.pfm" --size 32x24 --method direct
"$vpl" render tests/data/obj/square.obj -o "$out/square.pfm" --size 32x24 --method direct 2>"$scratch/said"
equals ObjAloneIsRendered 0 $?
check ObjAloneSaysItsCamera grep -q 'square.obj: the file has no camera; one looks from' "$scratch/said"
check ObjAloneSaysItsLight grep -q 'square.obj: nothing emits light; a square key lamp of' "$scratch/said"
check ObjAloneSaysItsGround grep -q 'square.obj: it stands on a grey ground of' "$scratch/said"
equals ObjAloneSaysNoMore 4 "$(wc -l <"$scratch/said")"
cp "$out/square.pfm" "$scratch/square.pfm"
succeeds ObjAloneIsSilentWhenQuiet "$vpl" render tests/data/obj/square.obj -o "$out/square.pfm" --size 32x24 --method direct --quiet
check ObjAloneHasTheSameBits cmp "$out/square.pfm" "$scratch/square.pfm"
"$vpl" render tests/data/obj/square.obj -o "$out/square.pfm" --size 24x32 --method direct --no-ground 2>"$scratch/narrow"
equals ObjAloneNeedsNoGround 0 $?
equals NoGroundSaysNone 0 "$(grep -c ground "$scratch/narrow")"
equals ObjAloneIsFittedToTheSize 2 "$(grep -h 'looks from' "$scratch/said" "$scratch/narrow" | sort -u | wc -l)"
"$vpl" render tests/data/obj/square.obj -o "$out/square.pfm" --size 32x24 --method direct --lighting documented 2>"$scratch/said"
equals ObjAloneHasDocumentedLight 0 $?
check DocumentedLightIsAPoint grep -q 'square.obj: nothing emits light; a point light of' "$scratch/said"
"$vpl" info "$room" --no-ground >/dev/null 2>"$scratch/said"
check NoGroundHasNoEffectOnSceneFiles grep -q 'warning: --no-ground has no effect with' "$scratch/said"
rm -f "$out/meshes.pfm" "$out/square.pfm"
