#!/bin/sh
# SPDX-License-Identifier: MIT
# Fuzzes under ASan and UBSan: tests/fuzz/run.sh scene image, FUZZ_SECONDS each (default 600); an input that takes more than
# FUZZ_TIMEOUT seconds (default 60) is reported. Needs clang.
# Inputs that reach new code stay in build/fuzzing/NAME; what crashes or hangs is put beside them as
# NAME-crash-*, NAME-timeout-*. Fix it, then add it to tests/fuzz/corpus/NAME, which `make test` replays.
build=build/fuzzing
seconds=${FUZZ_SECONDS:-600}
flags="-g -O1 -fsanitize-ignorelist=tests/fuzz/ignore.txt"
mkdir -p $build
make --no-print-directory -j"$(nproc)" BUILD=$build CC=clang MODE=debug OPENMP=0 CFLAGS="$flags" \
    SANITIZE=fuzzer-no-link,address,undefined,float-cast-overflow $build/libvpl.a $build/libcli.a >$build/make.log || exit 1

# Blocks beyond 256 MB are refused as if memory had run out: many a broken header asks for gigabytes.
export ASAN_OPTIONS="allocator_may_return_null=1:max_allocation_size_mb=256:$ASAN_OPTIONS"
bad=0
for name in "$@"; do
    dictionary=
    [ -f "tests/fuzz/$name.dict" ] && dictionary=-dict=tests/fuzz/$name.dict
    mkdir -p "$build/$name"
    clang -std=gnu11 $flags -fsanitize=fuzzer,address,undefined,float-cast-overflow -fno-sanitize-recover=all -Iinclude -Isrc \
        -o "$build/fuzz-$name" "tests/fuzz/${name}_fuzz.c" $build/libcli.a $build/libvpl.a $(make -s --no-print-directory libs) || exit 1
    if "$build/fuzz-$name" -max_total_time="$seconds" -timeout="${FUZZ_TIMEOUT:-60}" -malloc_limit_mb=0 -rss_limit_mb=4000 \
        -max_len=4096 -print_final_stats=1 -artifact_prefix="$build/$name-" $dictionary "$build/$name" \
        "tests/fuzz/corpus/$name" >"$build/$name.log" 2>&1; then
        echo "ok $name: $(sed -n 's/^stat::number_of_executed_units: *//p' "$build/$name.log") inputs"
    else
        echo "not ok $name: see the end of $build/$name.log"
        bad=1
    fi
done
exit $bad
