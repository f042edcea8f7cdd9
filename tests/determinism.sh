#!/bin/sh
# The golden pictures by every compiler, level of optimisation, number of threads and instruction set: prints a table of how
# many of them have the recorded bits. Fails unless all have. What the machine lacks is "-".
# tests/determinism.sh [NAME...]: default gcc clang aarch64, where the compilers and qemu are installed. LEVELS, THREADS,
# SETS and PLAIN=0 (no rows without OpenMP) in the environment make the table shorter. Unoptimised code is ten times as slow: -O0 has
# a row for SLOW_THREADS only, with SLOW_SETS, and none without OpenMP; cells that are left out are empty. JOBS processors
# compile.
levels=${LEVELS:-3 2 0}
threads=${THREADS:-1 2 3 5 16}
slow_threads=${SLOW_THREADS:-3}
slow_sets=${SLOW_SETS:-scalar avx2}
plain=${PLAIN:-1}
names=${*:-gcc clang aarch64}
sets="scalar sse2 avx2 avx512"
kinds=${SETS:-$sets}
failed=0
runner=
jobs=${JOBS:-$(nproc)}
export OMP_WAIT_POLICY=passive
mkdir -p build/determinism

# cell BUILD THREADS SET: the count of pictures that are right.
cell() {
    if ! $runner "build/determinism/$1/vpl-golden" check golden "build/determinism/$1/golden" "$2" "$3" >"build/determinism/log" 2>&1 &&
        ! grep -q passed build/determinism/log; then
        echo - # the machine lacks the instruction set
        return
    fi
    sed -n 's/^\([0-9]*\) passed, 0 failed$/\1/p; s/^\([0-9]*\) passed, \([1-9][0-9]*\) failed$/\1 (\2 differ)/p' build/determinism/log
}

# row NAME THREADS SETS MAKE-VARIABLES...: builds a configuration and prints a row for each number of threads.
row() {
    name=$1 counts=$2 chosen=$3
    shift 3
    make -j"$jobs" --no-print-directory BUILD="build/determinism/$name" "$@" "build/determinism/$name/vpl-golden" \
        >"build/determinism/$name.log" 2>&1 || { echo "| $name | not built, see build/determinism/$name.log |"; failed=1; return; }
    for count in $counts; do
        line="| $name | $count |"
        for kind in $sets; do
            case " $chosen " in *" $kind "*) ;; *) line="$line  |"; continue ;; esac
            got=$(cell "$name" "$count" "$kind")
            case $got in *differ* | "") failed=1 ;; esac
            line="$line $got |"
        done
        echo "$line"
    done
}

echo "| build | threads |$(for kind in $sets; do printf ' %s |' "$kind"; done)"
echo "| --- | ---: |$(for kind in $sets; do printf ' ---: |'; done)"
for level in $levels; do
    for compiler in $names; do
        command -v "$compiler" >/dev/null 2>&1 || continue
        if [ "$level" -eq 0 ]; then
            row "$compiler-O0" "$slow_threads" "$slow_sets" CC="$compiler" CFLAGS="-O0"
            continue
        fi
        row "$compiler-O$level" "$threads" "$kinds" CC="$compiler" CFLAGS="-O$level"
        [ "$plain" -eq 0 ] || row "$compiler-O$level-plain" 1 "$kinds" CC="$compiler" CFLAGS="-O$level" OPENMP=0 EXR=0
    done
done
case " $names " in *" aarch64 "*) ;; *) exit $failed ;; esac
if command -v aarch64-linux-gnu-gcc >/dev/null 2>&1 && command -v qemu-aarch64-static >/dev/null 2>&1; then
    export QEMU_LD_PREFIX=/usr/aarch64-linux-gnu
    runner="qemu-aarch64-static -E LD_LIBRARY_PATH=/usr/lib/aarch64-linux-gnu"
    row aarch64 1 "scalar sse2" CC=aarch64-linux-gnu-gcc OPENMP=0 EXR=0 LDLIBS="-L/usr/lib/aarch64-linux-gnu -ljansson -lm"
fi
exit $failed
