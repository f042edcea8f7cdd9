#!/bin/sh
# SPDX-License-Identifier: MIT
# Leaves in the corpora the fewest inputs that reach all that they and those of build/fuzzing/NAME reach, beside the seeds and
# finds, whose names are words: tests/fuzz/least.sh scene image. Programs are those that tests/fuzz/run.sh built. An input that
# takes more than FUZZ_TIMEOUT seconds (default 60) is left out.
build=build/fuzzing
export ASAN_OPTIONS="allocator_may_return_null=1:max_allocation_size_mb=256:$ASAN_OPTIONS"
bad=0
for name in "$@"; do
    corpus=tests/fuzz/corpus/$name least=$build/$name-least
    rm -rf "$least" && mkdir -p "$least" "$build/$name" || exit 1
    if ! "$build/fuzz-$name" -set_cover_merge=1 -timeout="${FUZZ_TIMEOUT:-60}" -malloc_limit_mb=0 -rss_limit_mb=4000 \
        -max_len=4096 -artifact_prefix="$build/$name-" "$least" "$corpus" "$build/$name" >"$build/$name-least.log" 2>&1; then
        echo "not ok $name: see the end of $build/$name-least.log"
        bad=1
        continue
    fi
    before=$(ls "$corpus" | wc -l)
    for file in "$corpus"/*; do # names in $least are SHA-1 sums
        sum=$(sha1sum "$file" | cut -d ' ' -f 1)
        if [ -f "$least/$sum" ]; then
            rm "$least/$sum"
        elif basename "$file" | grep -qE '^([0-9a-f]{12}|[0-9a-f]{40})$'; then
            rm "$file"
        fi
    done
    for file in "$least"/*; do
        [ -f "$file" ] && cp "$file" "$corpus/$(basename "$file" | cut -c 1-12)"
    done
    echo "ok $name: $before inputs, now $(ls "$corpus" | wc -l)"
done
exit $bad
