#!/bin/sh
# Mutation testing: changes one operator, constant or bound of src at a time and looks whether the tests notice.
# tests/mutate.sh [COUNT [SEED]]: default 200 1. ALL=1 in the environment also runs slow and command-line tests where quick
# ones pass (a quarter of an hour for each such mutation). Prints a line for each mutation, then "N of M killed".
# A mutation is killed if a test fails, crashes or does not end. One that does not compile is replaced by another.
# build/mutation/results keeps the lines, so that an interrupted run goes on where it was.
count=${1:-200} seed=${2:-1}
root=$(cd "$(dirname "$0")/.." && pwd)
tree=$root/build/mutation/tree
results=$root/build/mutation/results
export OMP_WAIT_POLICY=passive CMOCKA_TEST_ABORT=1

mkdir -p "$tree"
cd "$root" && git archive HEAD | tar -x -C "$tree" && cd "$tree" || exit 1
make -j"$(nproc)" --no-print-directory build/vpl build/vpl-tests build/vpl-golden >build.log 2>&1 || exit 1

# Lists every site: file, line, column, length, and the text to put there instead; shuffled by the seed.
sites() {
    find src -name '*.[ch]' | sort | xargs awk '
        function put(at, length_, text) { printf "%s\t%d\t%d\t%d\t%s\n", FILENAME, FNR, at, length_, text }
        function each(token, text,   at, from) {
            for (from = 1; (at = index(substr(line, from), token)) > 0; from += at + length(token) - 1)
                put(from + at - 1, length(token), text)
        }
        /^[ \t]*(#|\/\/|static const char|\/\*)/ || /^[^ \t}]/ { next }
        {
            line = $0
            sub(/\/\/.*/, "", line)
            while (match(line, /"[^"]*"/)) { # strings are not code; blanks keep the columns
                blank = sprintf("%" RLENGTH "s", "")
                line = substr(line, 1, RSTART - 1) blank substr(line, RSTART + RLENGTH)
            }
            each(" < ", " <= "); each(" <= ", " < "); each(" > ", " >= "); each(" >= ", " > ")
            each(" == ", " != "); each(" != ", " == "); each(" + ", " - "); each(" - ", " + ")
            each(" * ", " / "); each(" / ", " * "); each(" && ", " || "); each(" || ", " && ")
            each(" += ", " -= "); each(" -= ", " += "); each("true", "false"); each("false", "true")
            for (from = 1; match(substr(line, from), /[^A-Za-z0-9_.][0-9]+(\.[0-9]+)?f?[^A-Za-z0-9_.]/); from = at + RLENGTH - 1) {
                at = from + RSTART - 1
                put(at + 1, RLENGTH - 2, "(" substr(line, at + 1, RLENGTH - 2) " + 1)")
                at = at + 1
                RLENGTH -= 1
            }
        }' | awk -v seed="$seed" 'BEGIN { x = seed * 7919 + 17 } { x = (x * 16807) % 2147483647; print x "\t" $0 }' | sort -n | cut -f 2-
}

# killers FILE: what to run, the fastest and most likely killers first; suites that include the header of the file are likely.
killers() {
    header=$(echo "$1" | sed 's/^src\///; s/\(_kernel\)*\.[ch]$/.h/')
    suites=$(grep -l "\"$header\"" tests/test_*.c | sed 's/.*test_\(.*\)\.c/\1/' | tr '\n' ' ')
    [ -n "$suites" ] && echo "build/vpl-tests --quick $suites"
    echo "build/vpl-golden check golden build/golden"
    echo "build/vpl-tests --quick -memory" # failing allocations: see ALL
    [ -n "$ALL" ] && echo "tests/cli/run.sh build/vpl" && echo "build/vpl-tests" && echo "tests/project.sh build"
}

# judge FILE: prints what killed the mutation, or "survived", or "not built".
judge() {
    timeout 600 make -j"$(nproc)" --no-print-directory build/vpl build/vpl-tests build/vpl-golden >build.log 2>&1 || {
        echo "not built"
        return
    }
    killers "$1" >killers.txt
    while read -r command; do
        if ! timeout 900 $command >test.log 2>&1 </dev/null; then
            echo "killed by ${command#build/}" | cut -c 1-60
            return
        fi
    done <killers.txt
    echo survived
}

touch "$results"
sites >sites.txt
tab=$(printf '\t')
done_=0
while [ "$done_" -lt "$count" ] && IFS=$tab read -r file line column length text <&3; do
    known=$(grep -F "$file:$line:$column:" "$results" | head -n 1)
    if [ -z "$known" ]; then
        cp "$file" original
        awk -v at="$line" -v column="$column" -v length_="$length" -v text="$text" '
            NR == at { $0 = substr($0, 1, column - 1) text substr($0, column + length_) } { print }' original >"$file"
        code=$(sed -n "${line}s/^ *//p" "$file")
        known="$file:$line:$column: $(judge "$file"): $code"
        cp original "$file"
        echo "$known" >>"$results"
        echo "$known"
    fi
    case $known in *": not built: "*) ;; *) done_=$((done_ + 1)) ;; esac
done 3<sites.txt
killed=$(grep -c ': killed by' "$results")
echo "$killed of $(grep -c -v ': not built: ' "$results") killed"
