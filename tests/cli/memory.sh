# SPDX-License-Identifier: MIT
# The program where malloc fails, also in jansson, stb and OpenEXR: it says so and ends with 1, or has the whole result. Files are the whole
# ones or none. Tries the first allocations one by one and later ones at growing distances (with VPL_EVERY_FAULT all), each alone and with all after it.

no_memory=$(dirname "$vpl")/no-memory.so

# without_memory NAME WORDS...: runs the program without failures first, then with each.
without_memory() {
    name=$1
    shift
    rm -rf "$scratch/whole" "$out"/*
    runs "$vpl" "$@"
    cp -r "$out" "$scratch/whole"
    cp "$scratch/stdout" "$scratch/whole-stdout"
    wrong=
    failures=0
    for on in "" yes; do
        n=0
        while :; do
            rm -rf "$out"/* "$scratch/failed"
            runs timeout 60 env VPL_FAIL_AT=$n VPL_FAIL_ON=$on VPL_FAILED="$scratch/failed" LD_PRELOAD="$no_memory" "$vpl" "$@"
            [ -e "$scratch/failed" ] || break
            failures=$((failures + 1))
            if [ "$code" -eq 1 ]; then
                found=$(grep -vE '^(vpl: .*memory.*|libgomp: .*|)$' "$scratch/stderr")
                [ -s "$scratch/stderr" ] || found="not a word"
                [ -n "$on" ] || [ "$(grep -c '^vpl: ' "$scratch/stderr")" -le 1 ] || found="several sentences"
            elif [ "$code" -ne 0 ]; then
                found="exit code $code: $(head -n 1 "$scratch/stderr")"
            else
                found=$(cmp "$scratch/stdout" "$scratch/whole-stdout" 2>&1)$(diff -rq "$out" "$scratch/whole" 2>&1)
            fi
            [ -n "$found" ] || found=$(diff -rq "$out" "$scratch/whole" 2>&1 | grep -vF "Only in $scratch/whole")
            [ -z "$found" ] || wrong="$wrong; $n${on:+ on}: $found"
            [ -n "$VPL_EVERY_FAULT" ] && n=$((n + 1)) || n=$((n + 1 + n / 8))
        done
    done
    rm -rf "$out"/*
    if [ -n "$wrong" ]; then
        not_ok "$name" "$wrong"
    elif [ $failures -lt 20 ]; then
        not_ok "$name" "only $failures allocations failed"
    else
        ok "$name"
        echo "# $failures failed allocations"
    fi
}

if [ -e "$no_memory" ]; then
    tiny="--size 8x6 --threads 1 --quiet"
    few="--method keller --particles 4 --shadow-map 4"
    textured=$PWD/examples/scenes/textured-room.json
    "$vpl" render "$room" $tiny $few -o "$scratch/a.exr"
    "$vpl" render "$room" $tiny $few -o "$scratch/a.png"
    "$vpl" render "$room" $tiny $few --dry-run --plan-out "$scratch/plan" >"$scratch/stdout"
    "$vpl" render "$room" $tiny $few --passes 2 --checkpoint "$scratch/state" -o "$scratch/b.pfm"
    "$vpl" render "$room" $tiny $few --tile 1/2 -o "$scratch/part-1.pfm"
    "$vpl" render "$room" $tiny $few --tile 2/2 -o "$scratch/part-2.pfm"
    without_memory ExrWithoutMemory render "$room" $tiny $few -o "$out/o.exr"
    without_memory PngWithoutMemory render "$textured" $tiny $few -o "$out/o.png"
    without_memory HdrWithoutMemory render "$room" $tiny --plan "$scratch/plan" -o "$out/o.hdr"
    without_memory AutoWithoutMemory render "$room" $tiny -o "$out/o.pfm"
    without_memory SsvpWithoutMemory render "$room" $tiny --method ssvp --first-bounce 4 --second-bounce 4 --oversampling 1 \
        --max-clusters 4 -o "$out/o.pfm"
    without_memory RadiosityWithoutMemory render "$room" $tiny --method radiosity --patches 60 -o "$out/o.pfm"
    without_memory ModelWithoutMemory render examples/scenes/testmodel.obj $tiny $few -o "$out/o.pfm"
    without_memory GltfWithoutMemory render tests/data/gltf/everything.gltf $tiny $few -o "$out/o.pfm"
    without_memory ResumedWithoutMemory render "$room" $tiny $few --passes 4 --resume "$scratch/state" -o "$out/o.pfm"
    without_memory MergeWithoutMemory merge "$scratch/part-1.pfm" "$scratch/part-2.pfm" -o "$out/o.pfm"
    without_memory CompareWithoutMemory compare "$scratch/a.exr" "$scratch/a.png" --threads 1 --json --regions 2x2 \
        --heatmap "$out/o.png"
    without_memory InfoWithoutMemory info "$room" --json
    without_memory PlanWithoutMemory render "$room" $tiny $few --dry-run --plan-out "$out/plan"
    without_memory BakeWithoutMemory bake "$room" --threads 1 --quiet --patches 60 -o "$out/o.ply"
    without_memory LightsWithoutMemory lights "$room" --threads 1 --particles 4
    # What include/vpl/base.h says of the stack; threads of OpenMP get as much.
    for method in auto keller ssvp radiosity path; do
        succeeds "StackOf256KiBIsEnough_$method" sh -c 'ulimit -s 256; exec "$@"' sh \
            "$vpl" render "$textured" --size 64x48 --quiet --method $method -o "$out/o.pfm"
    done
    rm -f "$out"/*
else
    echo "skipped: no allocation of the program can be made to fail in this build"
fi
