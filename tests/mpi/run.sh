#!/bin/sh
# SPDX-License-Identifier: MIT
# Tests of vpl-mpi: tests/mpi/run.sh BUILD. The bits of one process for 1, 2, 3, 5 and 8 ranks with both implementations, files
# of finished units, faults. Each test has three of five numbers of ranks, each with one of the two; all with both where
# VPL_ALL_RANKS is set. Needs build/vpl-mpi.openmpi and build/vpl-mpi.mpich (make test-mpi builds them).
. tests/mpi/support.sh
room=examples/scenes/room-area.json
runs="openmpi:1 mpich:2 openmpi:3 mpich:5 openmpi:8"
[ -z "$VPL_ALL_RANKS" ] || runs="$runs mpich:1 openmpi:2 mpich:3 openmpi:5 mpich:8"

# Sets `some` to the runs of the next test.
take_runs() {
    some=$runs
    [ -z "$VPL_ALL_RANKS" ] || return 0
    set -- $runs
    some="$1 $2 $3"
    shift 3
    runs="$* $some"
}

# ---- the same bits

same_picture() { # IMPLEMENTATION N OPTION...
    implementation=$1 number=$2
    shift 2
    rm -f "$scratch/ranks.$kind"
    ranks "$implementation" "$number" render -o "$scratch/ranks.$kind" --quiet "$@" &&
        cmp "$scratch/whole.$kind" "$scratch/ranks.$kind"
}
kind=pfm
picture() { # NAME SCENE OPTION...
    name=$1
    shift
    "$build/vpl" render -o "$scratch/whole.$kind" --quiet "$@" || exit 1
    take_runs
    for run in $some; do
        check "${name}_of_${run#*:}_ranks_${run%:*}" same_picture ${run%:*} ${run#*:} "$@"
    done
}
picture Path "$room" --method path --spp 4 --size 64x150 --threads 1
picture Passes "$room" --method keller --particles 20 --passes 5 --size 48x150 --threads 1
picture Interleaved "$room" --method keller --particles 60 --pipeline interleaved --size 48x200 --threads 2
picture Radiosity "$room" --method radiosity --patches 100 --size 48x150 --threads 1
rooms=examples/scenes/six-rooms.json
picture Rooms "$rooms" --method radiosity --patches 400 --size 48x150 --threads 2
picture Jacobi "$rooms" --method radiosity --patches 300 --solver jacobi --size 48x150 --threads 1
picture Shooting "$rooms" --method radiosity --patches 100 --solver shooting --size 48x150 --threads 1
picture Residual "$rooms" --method radiosity --patches 100 --show residual --size 48x150 --threads 1
picture Adaptive "$room" --method radiosity --patches 100 --patch-placement adaptive --size 48x150 --threads 1
picture Links "$rooms" --method radiosity --patches 200 --hierarchy on --size 48x150 --threads 1
picture Ssvp "$room" --method ssvp --first-bounce 16 --second-bounce 16 --size 48x150 --threads 1
picture FilesOfTheScene examples/scenes/textured-room.json --method direct --size 48x150 --threads 1

# Layers, where OpenEXR is built in.
if "$build/vpl" render "$room" -o "$scratch/whole.exr" --size 4x4 --method direct --quiet 2>"$scratch/errors"; then
    kind=exr
    picture LayersOfPaths "$room" --method path --spp 4 --size 48x150 --threads 1 --aov all
    picture LayersOfPasses "$room" --method keller --particles 20 --passes 5 --size 48x150 --threads 1 --aov all
    picture LayersOfPatches "$rooms" --method radiosity --patches 300 --size 48x150 --threads 1 --aov direct,albedo,object
    kind=pfm
fi

same_patches() { # IMPLEMENTATION N OPTION...
    implementation=$1 number=$2
    shift 2
    rm -f "$scratch/ranks.ply"
    ranks "$implementation" "$number" bake -o "$scratch/ranks.ply" --quiet "$@" && cmp "$scratch/whole.ply" "$scratch/ranks.ply"
}
bake="$rooms --method radiosity --patches 300 --threads 1"
"$build/vpl" bake $bake -o "$scratch/whole.ply" --quiet
take_runs
for run in $some; do
    check "Bake_of_${run#*:}_ranks_${run%:*}" same_patches ${run%:*} ${run#*:} $bake
done

# Settings, pictures and errors of a sweep are those of one process; times are those of each rank.
sweep="examples/scenes/closed-room.json --size 16x9 --shadow-map 32 --quiet --seeds 2 --time 100000 --reference-spp 16 \
    --sweeps sampler,min-distance,pipeline,direct --particles 4"
columns() { # FILE: what does not depend on times, sorted
    awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) name[i] = $i; next }
        { line = ""
          for (i = 1; i <= NF; i++) if (name[i] ~ /^(command|seed|image_hash|error|relmse|energy_ratio|rays)$/) line = line $i ","
          print line }' "$1" | sort
}
same_sweep() { # IMPLEMENTATION N
    rm -rf "$scratch/sweep"
    ranks "$1" "$2" tradeoff $sweep -o "$scratch/sweep" && columns "$scratch/sweep/tradeoff.csv" >"$scratch/there" &&
        [ "$(ls "$scratch/sweep" | wc -l)" -eq 5 ] && cmp "$scratch/here" "$scratch/there"
}
"$build/vpl" tradeoff $sweep -o "$scratch/sweep"
columns "$scratch/sweep/tradeoff.csv" >"$scratch/here"
take_runs
for run in $some; do
    [ "${run#*:}" = 8 ] || check "Tradeoff_of_${run#*:}_ranks_${run%:*}" same_sweep ${run%:*} ${run#*:}
done

same_frames() { # IMPLEMENTATION N OPTION...
    implementation=$1 number=$2
    shift 2
    rm -f "$scratch"/ranks-*
    ranks "$implementation" "$number" render -o "$scratch/ranks.png" --quiet "$@" || return 1
    for frame in "$scratch"/whole-*; do
        cmp "$frame" "$scratch/ranks-${frame##*-}" || return 1
    done
}
layers_of_frames() {
    frames="examples/scenes/room-path.json --frames 0:3 --method path --spp 2 --size 48x32 --threads 1 --aov direct,normal --quiet"
    "$build/vpl" render $frames -o "$scratch/alone.exr" && ranks mpich 3 render $frames -o "$scratch/shared.exr" || return 1
    for frame in "$scratch"/alone-*; do
        cmp "$frame" "$scratch/shared-${frame##*-}" || return 1
    done
}
[ ! -e "$scratch/whole.exr" ] || check LayersOfFrames layers_of_frames
sequence="examples/scenes/room-path.json --frames 0:6 --method keller --particles 20 --size 48x32 --threads 1"
"$build/vpl" render $sequence -o "$scratch/whole.png" --quiet
take_runs
for run in $some; do
    check "Sequence_of_${run#*:}_ranks_${run%:*}" same_frames ${run%:*} ${run#*:} $sequence
done
rm -f "$scratch"/whole* "$scratch"/ranks*

options="$room --method path --spp 4 --size 64x150 --threads 1"
"$build/vpl" render $options -o "$scratch/whole.pfm" --quiet
options="$options --bands 12" # as many as there are tiles; the picture is so small that a rank would have one piece
check RankZeroMayWait same_picture openmpi 3 $options --rank-zero-waits
check RanksMayReadTheSceneThemselves same_picture openmpi 3 $options --shared-scene
through_a_pipe() {
    rm -f "$scratch/ranks.pfm"
    ranks openmpi 3 render - ${options#* } -o "$scratch/ranks.pfm" --quiet <"$room" && cmp "$scratch/whole.pfm" "$scratch/ranks.pfm"
}
check SceneOfAPipeReachesAllRanks through_a_pipe

# ---- files of finished pieces

pieces_are_kept() {
    ranks openmpi 3 render $options -o "$scratch/a.pfm" --quiet --checkpoint "$scratch/pieces" &&
        "$build/vpl" merge "$scratch/pieces" -o "$scratch/merged.pfm" && cmp "$scratch/whole.pfm" "$scratch/merged.pfm"
}
check FileOfPiecesIsForMerge pieces_are_kept
resumes() { # IMPLEMENTATION N BYTES: after the first bytes of the file
    head -c "$3" "$scratch/pieces" >"$scratch/part"
    rm -f "$scratch/ranks.pfm"
    ranks "$1" "$2" render $options -o "$scratch/ranks.pfm" --resume "$scratch/part" --checkpoint "$scratch/part" &&
        cmp "$scratch/whole.pfm" "$scratch/ranks.pfm" &&
        "$build/vpl" merge "$scratch/part" -o "$scratch/merged.pfm" && cmp "$scratch/whole.pfm" "$scratch/merged.pfm"
}
size=$(wc -c <"$scratch/pieces")
check ResumesWithOtherRanks resumes mpich 5 $((size / 2))
check ResumesWithOneRank resumes openmpi 1 $((size / 3))
check ResumesWhatIsWhole resumes openmpi 2 "$size"
warns_of_a_truncated_piece() {
    head -c $((size - 10)) "$scratch/pieces" >"$scratch/part"
    ranks openmpi 2 render $options -o "$scratch/ranks.pfm" --resume "$scratch/part" 2>"$scratch/errors"
    grep -q "are no whole piece and are dropped" "$scratch/errors"
}
check TruncatedPieceIsDroppedWithAWarning warns_of_a_truncated_piece

refuses() { # CODE SENTENCE COMMAND...
    code=$1 sentence=$2
    shift 2
    "$@" >"$scratch/out" 2>"$scratch/errors"
    got=$?
    [ $got -eq "$code" ] && grep -q "$sentence" "$scratch/errors" && [ "$(grep -c '^vpl-mpi: ' "$scratch/errors")" -eq 1 ] ||
        { echo "exit code $got, must be $code; on standard error:"; cat "$scratch/errors"; return 1; }
}
# moving_triangle X: a glTF file in which a triangle moves by X, the bytes of a float as printf reads them.
moving_triangle() {
    zero='\000\000\000\000' one='\000\000\200\077'
    data=$(printf "$zero$zero$zero$one$zero$zero$zero$one$zero$zero$one$zero$zero$zero$1$zero$zero" | base64 -w 0)
    cat <<END
{"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
"meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
"buffers": [{"byteLength": 68, "uri": "data:application/octet-stream;base64,$data"}],
"bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 8},
{"buffer": 0, "byteOffset": 44, "byteLength": 24}],
"accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
{"bufferView": 1, "componentType": 5126, "count": 2, "type": "SCALAR", "min": [0], "max": [1]},
{"bufferView": 2, "componentType": 5126, "count": 2, "type": "VEC3"}],
"animations": [{"samplers": [{"input": 1, "output": 2}], "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}]}]}
END
}
frames_of_another_path() {
    moving_triangle '\000\000\200\077' >"$scratch/moves.gltf"
    frames="--frames 0:2 --method direct --size 16x16 --quiet -o $scratch/moves.png"
    ranks openmpi 2 render "$scratch/moves.gltf" $frames --checkpoint "$scratch/list" &&
        ranks openmpi 2 render "$scratch/moves.gltf" $frames --resume "$scratch/list" || return 1
    moving_triangle '\000\000\000\100' >"$scratch/moves.gltf"
    refuses 2 "is no list of frames of this scene" ranks openmpi 2 render "$scratch/moves.gltf" $frames --resume "$scratch/list"
}
check FramesOfAnotherPathAreRefused frames_of_another_path
for implementation in openmpi mpich; do
    check "OtherSceneIsRefused_$implementation" refuses 2 "scene or camera differ" ranks $implementation 2 render \
        examples/scenes/room.json ${options#* } -o "$scratch/no.pfm" --resume "$scratch/pieces"
    check "OtherOptionsAreRefused_$implementation" refuses 2 "options differ" ranks $implementation 2 render \
        $options --seed 9 -o "$scratch/no.pfm" --resume "$scratch/pieces"
    check "OldFileIsNotOverwritten_$implementation" refuses 2 "is there already" ranks $implementation 2 render \
        $options -o "$scratch/no.pfm" --checkpoint "$scratch/pieces"
    check "FileOfPiecesHasNoEnd_$implementation" refuses 2 "it has no end within 256 MiB" ranks $implementation 2 render \
        $options -o "$scratch/no.pfm" --resume /dev/zero
    check "MissingSceneIsToldOnce_$implementation" refuses 2 "cannot open" ranks $implementation 3 render \
        nowhere.json -o "$scratch/no.pfm"
    check "WrongOptionIsToldOnce_$implementation" refuses 2 "unknown option" ranks $implementation 3 render \
        $options -o "$scratch/no.pfm" --sppp 3
    check "BudgetIsToldOnce_$implementation" refuses 2 "a time or an error ends this picture" ranks $implementation 3 render \
        $options --budget 50 -o "$scratch/no.pfm"
    check "OtherCommandsAreRefused_$implementation" refuses 2 "must be render, bake or tradeoff" ranks $implementation 2 compare \
        "$room" -o "$scratch/no"
    check "TradeoffOfNoSceneIsToldOnce_$implementation" refuses 2 "cannot open" ranks $implementation 3 tradeoff nowhere.json \
        -o "$scratch/no"
    check "TradeoffWithoutAFolderIsToldOnce_$implementation" refuses 1 "cannot create the folder" ranks $implementation 3 \
        tradeoff ${sweep%% *} -o "$scratch/no/where"
    check "BakeOfAnotherMethodIsToldOnce_$implementation" refuses 2 "alone" ranks $implementation 3 bake "$room" \
        --method keller -o "$scratch/no.ply"
    check "TooLittleMemoryIsToldOnce_$implementation" refuses 1 "MiB of memory, and 20 MiB are allowed" ranks $implementation 3 \
        render "$rooms" --method radiosity --patches 300 --memory 20 --size 48x48 --threads 1 -o "$scratch/no.pfm"
    check "BadGraceIsRefused_$implementation" refuses 2 "grace is" ranks $implementation 2 render \
        $options -o "$scratch/no.pfm" --grace never
done
full_disk() { # it has room for two pieces and a half
    refuses 1 "cannot write: No space left on device; it keeps what was finished before" ranks "$1" 3 render $options \
        -o "$scratch/no.pfm" --quiet --checkpoint "$scratch/small/part" || return 1
    [ ! -e "$scratch/no.pfm" ] && [ "$(wc -c <"$scratch/small/part")" -eq 24736 ] && cp "$scratch/small/part" "$scratch/part" &&
        rm "$scratch/small/part" &&
        ranks "$1" 2 render $options -o "$scratch/ranks.pfm" --resume "$scratch/part" 2>"$scratch/errors" &&
        ! grep -q "no whole piece" "$scratch/errors" && cmp "$scratch/whole.pfm" "$scratch/ranks.pfm"
}
mkdir "$scratch/small"
if mount -t tmpfs -o size=28k none "$scratch/small" 2>/dev/null; then
    check FullDiskKeepsWhatWasFinished_openmpi full_disk openmpi
    check FullDiskKeepsWhatWasFinished_mpich full_disk mpich
    full_disk_of_a_bake() {
        refuses 1 "No space left on device" ranks "$1" 3 bake $bake -o "$scratch/small/part.ply" --quiet &&
            [ -z "$(ls -A "$scratch/small")" ]
    }
    check FullDiskEndsABake_openmpi full_disk_of_a_bake openmpi
    check FullDiskEndsABake_mpich full_disk_of_a_bake mpich
    umount "$scratch/small"
else
    echo "skipped: FullDiskKeepsWhatWasFinished needs the right to mount a small file system"
fi
counts_every_rank() {
    ranks openmpi 2 render $options -o "$scratch/ranks.pfm" --stats "$scratch/stats.json" &&
        [ "$(grep -c busy_ms "$scratch/stats.json")" -eq 2 ]
}
check StatisticsOfEveryRank counts_every_rank

# ---- memory, and interrupts while ranks share form factors

value() { # NAME FILE: the largest of all numbers of this name
    sed -n "s/.*\"$1\": \([0-9]*\).*/\1/p" "$2" | sort -n | tail -n 1
}
memory="$rooms --method radiosity --patches 3000 --shadow-map 64 --size 48x48 --threads 1"
memory_is_planned() { # a rank holds no more than the plan foretold and 15 %, and less than a third of what one process holds
    ranks mpich 3 render $memory -o "$scratch/ranks.pfm" --stats "$scratch/stats.json" &&
        planned=$(value planned_bytes "$scratch/stats.json") held=$(value peak_bytes "$scratch/stats.json") &&
        "$build/vpl" render $memory -o "$scratch/whole.pfm" --quiet --stats "$scratch/whole.json" &&
        cmp "$scratch/whole.pfm" "$scratch/ranks.pfm" &&
        echo "planned $planned, held $held, by one process $(value peak_bytes "$scratch/whole.json")" &&
        [ $((held * 100)) -lt $((planned * 115)) ] &&
        [ $((3 * held)) -lt "$(value peak_bytes "$scratch/whole.json")" ]
}
check MemoryOfARankIsAsPlanned memory_is_planned
prints_memory() {
    ranks openmpi 3 render $memory --dry-run >"$scratch/plan" && grep -q "most memory  *about" "$scratch/plan" &&
        grep -q "^3 ranks: each needs this memory" "$scratch/plan" && [ "$(grep -c "most memory" "$scratch/plan")" -eq 1 ]
}
check DryRunTellsTheMemoryOfARank prints_memory
ends_in_time() { # IMPLEMENTATION: SIGTERM to all ranks while they compute form factors
    rm -f "$scratch/errors" "$scratch/no.pfm"
    ranks "$1" 3 render "$rooms" --method radiosity --patches 12000 --threads 1 -o "$scratch/no.pfm" -v 2>"$scratch/errors" &
    job=$!
    until [ "$(grep -c 'process [0-9]' "$scratch/errors" 2>/dev/null)" -eq 3 ]; do
        kill -0 $job || return 1
        sleep 0.05
    done
    sleep 2
    kill -TERM $(sed -n 's/.*process \([0-9]*\)$/\1/p' "$scratch/errors")
    sent=$(date +%s)
    wait $job
    code=$?
    took=$(($(date +%s) - sent))
    [ $code -ne 0 ] && [ $took -le 20 ] && grep -q "cancelled" "$scratch/errors" && [ ! -e "$scratch/no.pfm" ] ||
        { echo "exit code $code after $took s"; cat "$scratch/errors"; return 1; }
}
check SigtermEndsSharedFormFactors_openmpi ends_in_time openmpi
check SigtermEndsSharedFormFactors_mpich ends_in_time mpich

check SixKilledJobsAreResumed tests/mpi/kill.sh "$build" 6

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
