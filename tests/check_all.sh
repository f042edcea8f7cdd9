#!/bin/sh
# The unit tests and golden pictures under every configuration: compilers, optimisation, without OpenMP,
# sanitizers, threads, another architecture. The bits must be the same in all.
jobs=$(nproc)
RUNNER=
EXCLUDE=
# Long statistics, which have nothing new to say where the bits are the same; one configuration runs all.
STATISTICS="-AllWaysOfFindingLight -ErrorEstimatePredicts -EveryKindOfLightIsGivenBack -LossIsWhatCompensation
    -MorePassesAreBetter -FurnaceIsRight -PicturesAreThoseOfPlain -NoPixelErrs -TenfoldLights"
LONG="-memory -MatchesTheTable -FurnaceGlows -EnergyIsThatOfPath $STATISTICS"

# check NAME: the tests of a configuration that was built.
check() {
    if $RUNNER "build/$1/vpl-tests" $EXCLUDE >>"build/$1.log" 2>&1 &&
        $RUNNER "build/$1/vpl-golden" check golden "build/$1/golden" >>"build/$1.log" 2>&1; then
        echo "ok $1"
    else
        fails "$1"
    fi
}

fails() {
    echo "not ok $1: the end of build/$1.log:"
    tail -n 20 "build/$1.log"
    touch build/check-all-failed
}

# run NAME [MAKE VARIABLES...]: builds one configuration while the one before is tested, most of it on one thread,
# then tests it in the background.
run() {
    name=$1
    shift
    if make -j"$jobs" --no-print-directory BUILD="build/$name" "$@" "build/$name/vpl-tests" "build/$name/vpl-golden" \
        >"build/$name.log" 2>&1; then
        wait
        check "$name" &
    else
        fails "$name"
    fi
}

mkdir -p build
rm -f build/check-all-failed
run gcc-release CC=gcc
EXCLUDE=$LONG
run gcc-debug CC=gcc MODE=debug
run gcc-serial CC=gcc OPENMP=0
run gcc-no-exr CC=gcc EXR=0
if command -v clang >/dev/null 2>&1; then
    run clang-release CC=clang
    run clang-debug CC=clang MODE=debug
    # libomp is not built for the thread sanitizer, so threads come from the tests' own parallelFor.
    run clang-tsan CC=clang OPENMP=0 SANITIZE=thread CFLAGS="-g -O1 -DVPL_TEST_PTHREADS"
fi
EXCLUDE=$STATISTICS # allocation failures are for the address sanitizer
run gcc-asan-ubsan CC=gcc MODE=debug CFLAGS="-g -O1" SANITIZE=address,undefined
if command -v aarch64-linux-gnu-gcc >/dev/null 2>&1 && command -v qemu-aarch64-static >/dev/null 2>&1 &&
    [ -e /usr/lib/aarch64-linux-gnu/libcmocka.so ]; then
    export QEMU_LD_PREFIX=/usr/aarch64-linux-gnu
    RUNNER="qemu-aarch64-static -E LD_LIBRARY_PATH=/usr/lib/aarch64-linux-gnu"
    # Emulated, threads of the host's own never come back to life; there is one instruction set, and no OpenMP.
    EXCLUDE="$LONG -AHostsOwnScheduler -ThreadsAndInstructionSets -ChoicesDoNotDepend"
    run aarch64 CC=aarch64-linux-gnu-gcc OPENMP=0 LDLIBS="-L/usr/lib/aarch64-linux-gnu -ljansson -lm"
fi
wait
[ ! -e build/check-all-failed ]
