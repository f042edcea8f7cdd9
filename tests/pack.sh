#!/bin/sh
# Writes C files that include the given sources, up to 16 each: tests/pack.sh FOLDER SOURCE.c... prints their names within FOLDER.
# A file includes sources of one directory only, and none that define the same name at file scope. Half of the processor time of
# compiling the library is starting compilers and reading headers, which this saves.
folder=$1
shift
mkdir -p "$folder"
awk -v out="$folder" -v here="$PWD" '
    function name(word) { names[++count] = word }
    # Puts the file that was read into the first pack of its directory that has none of its names.
    function place(    pack, i, fits) {
        if (file == "") return
        dir = file; sub(/[^\/]*$/, "", dir)
        for (pack = 1; ; pack++) {
            fits = size[dir, pack] < 16
            for (i = 1; i <= count && fits; i++) fits = !((dir, pack, names[i]) in taken)
            if (fits) break
        }
        for (i = 1; i <= count; i++) taken[dir, pack, names[i]] = 1
        path = dir "pack" pack (file ~ /_kernel\.c$/ ? "_kernel.c" : ".c")
        size[dir, pack]++
        lines[path] = lines[path] "#include \"" here "/" file "\"\n"
        count = 0
    }
    FNR == 1 { place(); file = FILENAME; inEnum = 0 }
    /^#define/ { split($2, part, "("); name(part[1]) }
    /^static / { split($0, part, /[([=;]/); n = split(part[1], part, /[ *]+/); name(part[n] != "" ? part[n] : part[n - 1]) }
    /^(typedef )?(struct|union) [A-Za-z]+ \{/ { name($1 == "typedef" ? $3 : $2) }
    /^\} [A-Za-z]+;/ { sub(/;.*/, "", $2); name($2) }
    /^(typedef )?enum/ { inEnum = 1 }
    inEnum { n = split($0, part, /[^A-Za-z0-9_]+/); for (i = 1; i <= n; i++) if (part[i] ~ /^[A-Z][A-Z0-9_]*$/) name(part[i]) }
    /\}/ { inEnum = 0 }
    END {
        place()
        for (path in lines) {
            print path
            whole = out "/" path
            dir = whole; sub(/[^\/]*$/, "", dir)
            system("mkdir -p " dir)
            old = ""
            while ((getline line < whole) > 0) old = old line "\n"
            close(whole)
            if (old != lines[path]) printf "%s", lines[path] >whole # an old one keeps its time
        }
    }' "$@"
