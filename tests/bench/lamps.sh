#!/bin/sh
# SPDX-License-Identifier: MIT
# Processor time (user and system, s) and most memory (MiB) of each method against the number of lamps, 160x120:
#     tests/bench/lamps.sh BUILD [points|spots|quads] [COUNTS]
build=$1
kind=${2:-points}
counts=${3:-1 10 100 1000 100000}
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
folder=$(dirname "$0")
printf '%-18s' method
printf ' %14s' $counts
printf '\n'
for n in $counts; do
    sh "$folder/lamps_scene.sh" "$n" "$kind" >"$scratch/$n.json"
done
for method in direct keller instant-radiosity radiosity ssvp path; do
    printf '%-18s' $method
    for n in $counts; do
        spp=$([ $method = path ] && echo "--spp 16")
        result=$(/usr/bin/time -f '%U %S %M' timeout 120 "$build/vpl" render "$scratch/$n.json" --method $method $spp \
            --size 160x120 --quiet -o "$scratch/$n.pfm" 2>&1 | tail -1)
        printf ' %14s' "$(echo "$result" | awk '{printf "%.2f s %.0f M", $1 + $2, $3 / 1024}')"
    done
    printf '\n'
done
