#!/bin/sh
# Runs every test of a built configuration: tests/run.sh BUILD. Ends with "N passed, N failed".
# Programs and scripts that count by themselves end with such a line, too; their counts are added up. Two halves run side by
# side, because most tests use one processor.
build=${1:-build}
export OMP_WAIT_POLICY=passive # threads that spin while they wait take ten times the processor time of small tests
passed=0
failed=0
all=$(mktemp -d)
trap 'rm -rf "$all"' EXIT

# count NAME COMMAND...: runs something that ends with "N passed, N failed".
count() {
    name=$1
    shift
    if "$@" >"$scratch/log" 2>&1; then code=0; else code=$?; fi
    line=$(grep -E '^[0-9]+ passed, [0-9]+ failed$' "$scratch/log" | tail -n 1)
    good=$(echo "$line" | sed -n 's/ passed.*//p')
    bad=$(echo "$line" | sed -n 's/.*, \([0-9]*\) failed/\1/p')
    if [ -z "$line" ] || { [ "$code" -ne 0 ] && [ "$bad" -eq 0 ]; }; then
        bad=$((${bad:-0} + 1)) # it died before it could count
    fi
    passed=$((passed + ${good:-0}))
    failed=$((failed + bad))
    echo "$name: ${good:-0} passed, $bad failed"
    if [ "$bad" -ne 0 ]; then # which, however many suites came after it
        grep -E 'FAILED|ERROR|LINE|^not ok' "$scratch/log" | head -n 40
        tail -n 60 "$scratch/log"
    fi
}

# one NAME COMMAND...: a single test that passes if the command succeeds.
one() {
    name=$1
    shift
    if "$@" >"$scratch/log" 2>&1; then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
        echo "$name: failed"
        tail -n 30 "$scratch/log"
    fi
}

# half NAME: one of the two; leaves what it counted in a file.
half() {
    scratch=$all/$1
    mkdir "$scratch"
    "$1"
    echo "$passed $failed" >"$scratch/counts"
}

units_and_pictures() {
    count "unit tests, odd" "$build/vpl-tests" --odd
    if [ -e "$build/nulls" ]; then
        count "wrong arguments" "$build/nulls"
    else
        echo "wrong arguments: skipped, need python3"
    fi
    count "golden pictures" "$build/vpl-golden" check golden "$build/golden"
    count "interrupts" tests/signals.sh "$build/vpl"
    count "project" tests/project.sh "$build"
}

units_and_program() {
    count "unit tests, even" "$build/vpl-tests" --even
    count "program" tests/cli/run.sh "$build/vpl"
    for replay in "$build"/fuzz/*_replay; do
        kind=$(basename "$replay" _replay)
        one "corpus of $kind" "$replay" "tests/fuzz/corpus/$kind"
    done
    if [ -x "$build/vpl-mpi.openmpi" ] && [ -x "$build/vpl-mpi.mpich" ]; then
        echo "vpl-mpi: make test-mpi tests it"
    else
        echo "skipped: vpl-mpi needs two MPIs; make test-mpi installs them and tests it"
    fi
    one "random renders" "$build/soak" 300
}

half units_and_program &
half units_and_pictures &
wait
for name in units_and_program units_and_pictures; do
    good=0 bad=1 # it died before it could count
    [ -e "$all/$name/counts" ] && read -r good bad <"$all/$name/counts"
    passed=$((passed + good))
    failed=$((failed + bad))
done
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
