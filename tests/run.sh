#!/bin/sh
# Runs every test of a built configuration: tests/run.sh BUILD. Ends with "N passed, N failed".
# Programs and scripts that count by themselves end with such a line, too; their counts are added up.
build=${1:-build}
export OMP_WAIT_POLICY=passive # threads that spin while they wait take ten times the processor time of small tests
passed=0
failed=0
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

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

count "unit tests" "$build/vpl-tests"
if [ -e "$build/nulls" ]; then
    count "wrong arguments" "$build/nulls"
else
    echo "wrong arguments: skipped, need python3"
fi
count "golden pictures" "$build/vpl-golden" check golden "$build/golden"
count "program" tests/cli/run.sh "$build/vpl"
count "interrupts" tests/signals.sh "$build/vpl" 20
count "project" tests/project.sh "$build"
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

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
