#!/bin/sh
# Models that others made: tests/bench/foreign.sh BUILD FOLDER... runs `vpl info` and a small render for each OBJ, PLY, STL and
# glTF file below the folders. Prints the counts of what was read, refused and crashed, the median of the seconds, and each
# reason of a refusal once, with its count. .sh3f furniture libraries must be unpacked (they are zip files).
build=$1
shift
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT

find "$@" -type f \( -iname '*.obj' -o -iname '*.ply' -o -iname '*.stl' -o -iname '*.gltf' -o -iname '*.glb' \) | sort >"$out/files"
while read -r file; do
    start=$(date +%s%N)
    timeout 300 "$build/vpl" info "$file" >/dev/null 2>"$out/info"
    info=$?
    timeout 300 "$build/vpl" render "$file" -o "$out/picture.png" --size 64x36 --particles 300 --quiet 2>"$out/render" </dev/null
    code=$?
    end=$(date +%s%N)
    echo "$((info > code ? info : code)) $(((end - start) / 1000000)) $file" >>"$out/results"
    if [ "$info" -ne 0 ]; then
        tail -n 1 "$out/info" | sed "s|$(dirname "$file")/||" >>"$out/reasons"
    elif [ "$code" -ne 0 ]; then
        tail -n 1 "$out/render" | sed "s|$(dirname "$file")/||" >>"$out/reasons"
    fi
done <"$out/files"

awk '$1 == 0 { good++ } $1 == 2 || $1 == 1 { refused++ } $1 > 2 { crashed++; print "crashed or too slow: " $0 }
     END { printf "%d files: %d read and rendered, %d refused, %d crashed or took over 300 s\n", NR, good, refused, crashed }' "$out/results"
sort -n -k2 "$out/results" | awk '{ ms[NR] = $2; name[NR] = $3 } END { printf "median %.2f s, longest %.1f s: %s\n", ms[int((NR + 1) / 2)] / 1000, ms[NR] / 1000, name[NR] }'
[ ! -e "$out/reasons" ] || sort "$out/reasons" | uniq -c | sort -rn
