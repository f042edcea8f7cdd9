#!/bin/sh
# SPDX-License-Identifier: MIT
# Interrupts commands of every kind with SIGINT or SIGTERM at random moments: tests/signals.sh path/to/vpl [N] [SEED].
# Each must end within half a second of processor time (of all its threads; other programs disturb the wall clock), with
# the exit code of an interrupt (1, or by the signal itself before files are written) or of a command that was done, and
# leave whole files only. Prints the longest times and "N passed, M failed". The moments follow from SEED; where in the
# program they fall depends on the machine.
case $1 in
/*) vpl=$1 ;;
*) vpl=$PWD/$1 ;;
esac
commands=27
count=${2:-$commands}
seed=${3:-1}
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
export XDG_CACHE_HOME="$scratch/cache" OMP_WAIT_POLICY=passive
mkdir "$scratch/cache"
out=$scratch/out
room=$PWD/examples/scenes/room-area.json
point=$PWD/tests/data/room.json
passed=0
failed=0
longest=0
longest_wall=0
ticks=$(getconf CLK_TCK)
limit=500 # milliseconds
grep -qE '__(asan|tsan|ubsan)_' "$vpl" && limit=15000 # sanitizers are slow

# A number below $1 from a generator of its own (Lehmer: Park and Miller, Random Number Generators, CACM 1988).
draw() {
    seed=$((seed * 48271 % 2147483647))
    drawn=$((seed % $1))
}
draw 1 # small seeds begin with small numbers
draw 1

# Sets spent to the milliseconds of processor time of all programs that ended.
add_up() {
    times >"$scratch/times"
    spent=$(tail -n 1 "$scratch/times" | tr 'ms' '  ' | awk '{printf "%d", 1000 * (60 * ($1 + $3) + $2 + $4)}')
}

# Writes the words of command number $1.
words_of() {
    case $1 in
    0) echo "render $room -o $out/a.png --method path --spp 1000 --stats $out/a.json" ;;
    1) echo "render $point -o $out/a.pfm --method keller --particles 3000 --passes 9 --size 640x400" ;;
    2) echo "render $point -o $out/a.hdr --method instant-radiosity --particles 3000 --lighting documented" ;;
    3) echo "render $room -o $out/a.exr --aov all --method keller --passes 40 --size 300x200" ;;
    4) echo "render $point -o $out/a.png --method ssvp --clusters 200 --first-bounce 40000" ;;
    5) echo "render $room -o $out/a.png --method radiosity --patches 6000" ;;
    6) echo "render $room -o $out/a.png --method radiosity --patches 3000 --hierarchy on --patch-placement adaptive" ;;
    7) echo "render $room -o $out/a.png --budget 20000 --checkpoint $out/state --checkpoint-every 0" ;;
    8) echo "render $room -o $out/a.pfm --max-error 0.001 --error-map $out/e.pfm" ;;
    9) echo "render $PWD/examples/scenes/room-path.json -o $out/f.png --frames 0:99 --size 200x150" ;;
    10) echo "bake $room -o $out/a.ply --patches 6000 --stats $out/a.json" ;;
    11) echo "lights $room --particles 200000 --method keller" ;;
    12) echo "info $room --plan-out $out/p.json --budget 1000" ;;
    13) echo "render $room -o $out/a.png --dry-run --plan-out $out/p.json" ;;
    14) echo "tradeoff $point -o $out/trade --time 20 --size 64x48" ;;
    15) echo "bench --runs 1" ;;
    16) echo "compare $scratch/big.pfm $scratch/big.pfm --heatmap $out/h.png --heatmap-of flip" ;;
    17) echo "render $point -o $out/a.png --method direct --size 4000x3000 --supersample 4" ;;
    18) echo "render $point -o $out/a.pfm --resume $scratch/silent --method path" ;;
    19) echo "merge $scratch/big.part -o $out/a.png" ;;
    20) echo "merge $scratch/silent -o $out/a.pfm" ;;
    21) echo "render $room -o $out/a.part --tile 2/3 --method path --spp 200 --size 640x400" ;;
    22) echo "render $scratch/big.obj -o $out/a.png --method keller" ;;
    23) echo "render $scratch/big.ply -o $out/a.pfm --method direct --antialias 8" ;;
    24) echo "render $PWD/tests/data/gltf/everything.gltf -o $out/a.png --method keller --passes 50" ;;
    25) echo "render $PWD/examples/scenes/textured-room.json -o $out/a.hdr --method path --spp 400" ;;
    *) echo "render $PWD/examples/scenes/loft.json -o $out/a.png --method keller --quality good" ;;
    esac
}

# ends_with TEXT FILE: true if the last line of the file ends with the text.
ends_with() {
    tail -n 1 "$2" | grep -q "$1\$" && [ "$(tail -c 1 "$2" | od -An -tx1)" = " 0a" ]
}

# is_file_whole FILE: true if the program reads it, or if its end is there.
is_file_whole() {
    case $1 in
    *.png) "$vpl" compare "$1" "$1" && [ "$(tail -c 4 "$1" | od -An -tx1)" = " ae 42 60 82" ] ;; # of its last chunk
    *.pfm | *.hdr | *.exr) "$vpl" compare "$1" "$1" ;;
    *.json) [ "$(tail -c 2 "$1" | tr -d '\n')" = "}" ] ;;
    *.ply) "$vpl" info "$1" ;;
    */state) "$vpl" render "$room" -o "$scratch/resumed.pfm" --budget 1 --resume "$1" ;;
    *.part) "$vpl" merge "$1" -o "$scratch/merged.pfm" 2>&1 | grep "pieces of the picture are missing" ;;
    *.html) ends_with "</html>" "$1" ;;
    *.svg) ends_with "</svg>" "$1" ;;
    *.csv) ends_with "" "$1" && awk -F, 'NR == 1 { columns = NF } NF < columns { bad = 1 } END { exit bad }' "$1" ;;
    *) false ;; # a kind of file that this test does not know
    esac >"$scratch/log" 2>&1
}

# True if all files are whole and none is temporary.
is_whole() {
    [ -z "$(find "$out" "$scratch/cache" -name '*.tmp')" ] || return 1
    for file in $(find "$out" -type f); do
        is_file_whole "$file" || return 1
    done
    return 0
}

# Writes a hilly ground of 80,000 triangles: hills obj|ply
hills() {
    awk -v kind="$1" 'BEGIN {
        n = 200
        if (kind == "ply") {
            printf "ply\nformat ascii 1.0\nelement vertex %d\n", (n + 1) * (n + 1)
            print "property float x\nproperty float y\nproperty float z"
            printf "element face %d\nproperty list uchar int vertex_indices\nend_header\n", n * n
        }
        for (i = 0; i <= n; i++) {
            for (j = 0; j <= n; j++) {
                printf "%s%g %g %g\n", kind == "obj" ? "v " : "", i / n, 0.1 * sin(i / 9) * sin(j / 9), j / n
            }
        }
        for (i = 0; i < n; i++) {
            for (j = 0; j < n; j++) {
                at = i * (n + 1) + j + (kind == "obj")
                printf "%s %d %d %d %d\n", kind == "obj" ? "f" : 4, at, at + 1, at + n + 2, at + n + 1
            }
        }
    }'
}

"$vpl" render "$point" --method direct --size 1500x1000 -o "$scratch/big.pfm" --quiet
"$vpl" render "$point" --method direct --size 1500x1000 -o "$scratch/big.part" --tile 1/1 --quiet
hills obj >"$scratch/big.obj"
hills ply >"$scratch/big.ply"
mkfifo "$scratch/silent"
tried=0
while [ "$tried" -lt "$count" ]; do
    words=$(words_of $((tried % commands)))
    tried=$((tried + 1))
    rm -rf "$out"
    mkdir "$out"
    draw 2
    signal=$([ "$drawn" = 0 ] && echo INT || echo TERM)
    draw 1500
    wait_ms=$drawn
    [ "$((tried % 3))" = 0 ] && wait_ms=$((drawn / 20)) # while it starts
    # In a shell without job control background commands ignore SIGINT; env restores it.
    # shellcheck disable=SC2086 # the words of a command
    env --default-signal=INT "$vpl" $words >"$scratch/stdout" 2>"$scratch/stderr" &
    process=$!
    sleep "$(printf '%d.%03d' $((wait_ms / 1000)) $((wait_ms % 1000)))"
    add_up # before the command ends, so that it is the only one that is added until then
    before=$spent
    start=$(date +%s%N)
    used=$(awk -v ticks="$ticks" '{print int(1000 * ($14 + $15) / ticks)}' "/proc/$process/stat" 2>/dev/null)
    kill -$signal $process 2>/dev/null && hit=1 || hit=0
    wait $process 2>/dev/null
    code=$?
    wall=$((($(date +%s%N) - start) / 1000000))
    add_up
    took=$((spent - before - ${used:-0}))
    [ "$hit" = 1 ] && [ "$took" -gt "$longest" ] && longest=$took && slowest="$words"
    [ "$hit" = 1 ] && [ "$wall" -gt "$longest_wall" ] && longest_wall=$wall
    case $code in
    0 | 1 | 130 | 143) ends=1 ;;
    *) ends=0 ;;
    esac
    if [ "$ends" = 0 ] || ! is_whole || { [ "$hit" = 1 ] && { [ "$took" -gt $limit ] || [ "$wall" -gt 60000 ]; }; }; then
        failed=$((failed + 1))
        echo "not ok SIG$signal after $wait_ms ms: vpl $words: code $code, $took ms of $wall, $(find "$out" "$scratch/cache" -type f | tr '\n' ' ')$(head -n 1 "$scratch/stderr")"
    else
        passed=$((passed + 1))
    fi
done
echo "the longest time to end was $longest ms of processor time, $longest_wall ms by the clock: vpl $slowest"
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
