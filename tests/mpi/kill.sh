#!/bin/sh
# SPDX-License-Identifier: MIT
# Kills a random rank at a random time: tests/mpi/kill.sh BUILD [RUNS]. What was finished must be in the file, and the resumed
# picture or sequence (every fourth: radiosity, whose form factors ranks share) must have the bits of one process. Every third run sends SIGTERM to all ranks instead, as a scheduler does.
. tests/mpi/support.sh
runs=${2:-50}
options="examples/scenes/room-area.json --method path --spp 48 --size 96x240 --threads 1"
sequence="examples/scenes/room-path.json --frames 0:11 --method path --spp 6 --size 64x48 --threads 1"
patches="examples/scenes/six-rooms.json --method radiosity --patches 2500 --size 96x640 --threads 1"
"$build/vpl" render $options -o "$scratch/picture.pfm" --quiet
"$build/vpl" render $patches -o "$scratch/patches.pfm" --quiet
"$build/vpl" render $sequence -o "$scratch/whole.png" --quiet
seed=${SEED:-$(date +%s)}
echo "seed $seed"
random() { # sets $drawn to a number below $1
    seed=$(((seed * 1103515245 + 12345) % 2147483648))
    drawn=$((seed / 65536 % $1))
}
# start IMPLEMENTATION N ARGUMENT...: in the background; the processes of the ranks are in $pids.
start() {
    : >"$scratch/errors"
    ranks "$@" -v 2>"$scratch/errors" &
    job=$!
    until [ "$(grep -c 'process [0-9]' "$scratch/errors" 2>/dev/null)" -eq "$2" ]; do
        kill -0 $job 2>/dev/null || break
        sleep 0.02
    done
    pids=$(sed -n 's/.*process \([0-9]*\)$/\1/p' "$scratch/errors")
}
finished() { # how much is in the file: bytes of whole pieces, lines of frames
    if [ $kind != sequence ]; then wc -c <"$scratch/file"; else wc -l <"$scratch/file"; fi 2>/dev/null || echo 0
}
resume() {
    [ ! -e "$scratch/file" ] || set -- --resume "$scratch/file"
    if [ $kind != sequence ]; then
        ranks $implementation $other render $words -o "$scratch/ranks.pfm" --checkpoint "$scratch/file" --quiet "$@" &&
            cmp "$scratch/$kind.pfm" "$scratch/ranks.pfm"
    else
        ranks $implementation $other render $sequence -o "$scratch/ranks.png" --checkpoint "$scratch/file" --quiet "$@" || return 1
        for frame in "$scratch"/whole-*; do
            cmp "$frame" "$scratch/ranks-${frame##*-}" || return 1
        done
    fi
}
cut=0
for run in $(seq "$runs"); do
    rm -f "$scratch/file" "$scratch"/ranks*
    random 2
    [ $drawn -eq 0 ] && implementation=openmpi || implementation=mpich
    random 3 && number=$((2 + drawn))
    random 4 && other=$((1 + drawn))
    case $((run % 4)) in
    0) kind=patches words=$patches name=ranks.pfm ;;
    2) kind=sequence words=$sequence name=ranks.png ;;
    *) kind=picture words=$options name=ranks.pfm ;;
    esac
    start $implementation $number render $words -o "$scratch/$name" --checkpoint "$scratch/file" --grace 1
    random 300 && sleep "$(printf %d.%02d $((drawn / 100)) $((drawn % 100)))"
    random "$number" && victim=$(echo "$pids" | sed -n "$((1 + drawn))p") signal=KILL
    [ $((run % 3)) -ne 0 ] || { victim=$pids signal=TERM; }
    kill -$signal $victim 2>/dev/null
    wait $job
    code=$?
    before=$(finished)
    told=yes
    [ $code -eq 0 ] || [ -s "$scratch/errors" ] || told=no
    [ $code -eq 0 ] || cut=$((cut + 1))
    check "run $run: $kind, $number ranks of $implementation, $signal, exit code $code, $before in the file, $other go on" resume
    [ "$(finished)" -ge "$before" ] && [ $told = yes ] || { failed=$((failed + 1)); echo "not ok run $run: lost or silent"; }
done
echo "$cut of $runs jobs were cut short"
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
