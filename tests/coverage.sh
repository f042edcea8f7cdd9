#!/bin/sh
# Share of the lines of src that the tests run: tests/coverage.sh [LEAST]. Prints it for each folder and lists the lines that
# are not run in build/coverage/missed. Fails below LEAST percent (default 92). A line of a kernel counts if any instruction
# set runs it. QUICK=1 in the environment leaves slow tests out: a quarter of an hour instead of more than an hour.
least=${1:-92}
build=build/coverage
mkdir -p $build
make -j"$(nproc)" --no-print-directory BUILD=$build CC=gcc MODE=debug CFLAGS="-O1 --coverage" \
    test-programs >$build.log 2>&1 || exit 1
find $build -name '*.gcda' -delete
if [ -n "$QUICK" ]; then
    {
        $build/vpl-tests --quick
        $build/vpl-golden check golden $build/golden
        tests/cli/run.sh $build/vpl
    } >$build/tests.log 2>&1
else
    tests/run.sh $build >$build/tests.log 2>&1
fi
grep -E '^[0-9]+ passed' $build/tests.log
find $build/obj/src -name '*.gcda' | sort | while read -r data; do
    gcov -t "$data" 2>/dev/null
done | awk -F: -v missed=$build/missed '
    $2 + 0 == 0 && $3 == "Source" { file = $4; next }
    file !~ /^src\// { next }
    { count = $1; gsub(/[ \t]/, "", count); line = file ":" $2 + 0 }
    count == "-" { next }
    !(line in run) { run[line] = 0 }
    count !~ /^[#=]/ { run[line] = 1 }
    END {
        for (line in run) {
            split(line, part, ":")
            folder = part[1]
            sub(/\/[^\/]*$/, "", folder)
            all[folder]++
            ran[folder] += run[line]
            if (!run[line]) print line | "sort -t: -k1,1 -k2n >" missed
        }
        for (folder in all) {
            printf "%6.1f %%  %6d  %s\n", 100 * ran[folder] / all[folder], all[folder], folder | "sort -k4"
            total += all[folder]; good += ran[folder]
        }
        close("sort -k4")
        printf "%6.1f %%  %6d  all\n", 100 * good / total, total
    }' | tee $build/table
awk -v least="$least" '$4 == "all" && $1 + 0 < least + 0 { exit 1 }' $build/table
