#!/bin/sh
# The unit tests and golden pictures under the configurations that `make test` leaves out: sanitizers, of threads too; another
# compiler; another architecture, without OpenMP and EXR. The bits must be the same in all. Slow tests are left out, and what a
# configuration is not about.
jobs=$(nproc)
RUNNER=
# What one thread can say of arithmetic: another compiler or machine may change that, and golden pictures say the rest.
ARITHMETIC="bench clusters cluster_results draw_patches emission exr gather geometry hemi_maps hits image lights
    math metrics regions obj obj_parts obj_scene packets paraboloids patch_mesh patch_priority ply raster
    raster_truth rays rsm samples scene scene_checks shadow_maps second_bounce tone triangle_factors point_factors visibility
    -Threads -Everywhere -ChoicesDoNotDepend -AHostsOwnScheduler"
export OMP_WAIT_POLICY=passive # configurations are tested side by side: threads that wait must not spin

# check NAME: the tests of a configuration that was built, in two processes side by side, and their time.
check() {
    start=$(date +%s)
    log=build/$1.log
    good=true
    $RUNNER "build/$1/vpl-tests" --quick --even $TESTS >"build/$1-even.log" 2>&1 &
    even=$!
    # A fork of a process under the address sanitizer has its checks, too.
    { [ ! -e "build/$1/nulls" ] || "build/$1/nulls" >>"$log" 2>&1; } &&
        $RUNNER "build/$1/vpl-tests" --quick --odd $TESTS >>"$log" 2>&1 &&
        { [ ! -e "build/$1/vpl-golden" ] || $RUNNER "build/$1/vpl-golden" check golden "build/$1/golden" >>"$log" 2>&1; } ||
        good=false
    wait $even || good=false
    cat "build/$1-even.log" >>"$log"
    if $good; then
        echo "ok $1, $(($(date +%s) - start)) s"
    else
        fails "$1"
    fi
}

fails() {
    echo "not ok $1: first failures and the end of build/$1.log:"
    grep -a -n -m 3 -B 2 -A 12 -E "ERROR: |WARNING: ThreadSanitizer|runtime error:|FAILED|^not ok|rror:" "build/$1.log"
    tail -n 20 "build/$1.log"
    touch build/check-all-failed
}

# suites_of WORDS...: each word names a suite or is a part of the names of tests, whose suites are printed.
suites_of() {
    for word in "$@"; do
        { ls "tests/test_$word.c" || grep -lE "^TEST[A-Z_]*\([A-Za-z]*$word" tests/test_*.c; } 2>/dev/null
    done | sed 's|.*/test_\(.*\)\.c|\1|' | sort -u | tr '\n' ' '
}

# run NAME [MAKE VARIABLES...]: builds one configuration while those before are tested, then tests it in the background.
run() {
    name=$1
    shift
    if make -j"$jobs" --no-print-directory BUILD="build/$name" PACKED=1 SUITES="$(suites_of $TESTS)" "$@" \
        "build/$name/vpl-tests" $ALSO >"build/$name.log" 2>&1; then
        check "$name" &
    else
        fails "$name"
    fi
}

mkdir -p build
rm -f build/check-all-failed
# The longest first, so that the others are built meanwhile. Memory is watched, not values: tests that render the same again and
# again, or compare means of many pictures, are left to the others.
TESTS="-SameBits -Everywhere -ChangeNoBit -AddUp -IsKept -PassesThatGrow -PeakBytes -OfLampsAre -ThatEmitIsDirect
    -StillLights -PredictedTime -ManyEmittersAre -SpeedsChange -ObjectsInOnePlane -IsThereTwice -FurnaceIsGathered
    -MethodsThatGoOn -KeepACopy -CancelledAnywhereEndsTheSame -BitsDependOnNeither -TrianglesHaveTheMean -EmittersChangeNoMean
    -EachOfManyLamps -PointsLieOnCompact -CentroidsInMidAir -TracedEdges -ErrorHoldsWhere -PiecesHaveTheBits -TeamsHaveTheBits
    -SealedRoomsAreBlack -PanesLet -MapsAndRaysAgree -SameAtAnySize -PassesHaveNothing -WhereLampsOutnumber -FewerLightsThan
    -RenderThatWasSaved -TheCountHolds -TheEstimateOfLinks -ThroughASlot -MapsThatWereNotNeeded -AnInfiniteClampDistanceEnd
    -ChosenTrianglesLight -NothingIsLeftTo -TJunctionsAre -AConvexBody -AFurnaceWith -PixelOfAContrast -PixelsThatDiffer
    -TreeAgreesWith -FurnaceIsUniform -DoublingTheEmitter -DocumentedLightsIn -ShadowOfALeaf -BackgroundFills -ServeBothDirections
    -KeepsAllLight -FaintSidesThat -AnUncertainTruthBeside -MorePixelsConfirm -LowersTheBound -WhereThatIsAGain -DividedBeforeThey
    -TinyPicturesBegin -FloatsKeepTheirPictures -ASymmetricRoom -PatchesAreChosenWhere -PatchesAreNotLeftFor"
ALSO="build/gcc-asan-ubsan/vpl-golden build/gcc-asan-ubsan/nulls"
export VPL_GOLDEN_STEP=2
run gcc-asan-ubsan CC=gcc MODE=debug CFLAGS="-g1 -O1" SANITIZE=address,undefined
ALSO=
if command -v clang >/dev/null 2>&1; then
    # libomp is not built for the thread sanitizer, so threads come from the tests' own parallelFor. Golden pictures have one thread.
    TESTS="Threads Everywhere SameBits ChoicesDoNotDepend AHostsOwnScheduler Cancel StepsGive -CancelledAnywhere -ACancelledPass
        -PredictedTime -KeepACopy -DependOnNeither"
    run clang-tsan CC=clang OPENMP=0 WIDE= SANITIZE=thread CFLAGS="-g1 -O1 -DVPL_TEST_PTHREADS"
fi
unset VPL_GOLDEN_STEP
# aarch64 before clang's release: its tests run in an emulator, while the other one is built.
TESTS="$ARITHMETIC -MapsAndRaysAgree"
if command -v aarch64-linux-gnu-gcc >/dev/null 2>&1 && command -v qemu-aarch64-static >/dev/null 2>&1 &&
    [ -e /usr/lib/aarch64-linux-gnu/libcmocka.so ]; then
    export QEMU_LD_PREFIX=/usr/aarch64-linux-gnu VPL_GOLDEN_STEP=3
    ALSO=build/aarch64/vpl-golden
    RUNNER="qemu-aarch64-static -E LD_LIBRARY_PATH=/usr/lib/aarch64-linux-gnu"
    run aarch64 CC=aarch64-linux-gnu-gcc OPENMP=0 EXR=0 CFLAGS= LDLIBS="-L/usr/lib/aarch64-linux-gnu -ljansson -lm"
    RUNNER=
    unset VPL_GOLDEN_STEP
else
    ALSO=build/gcc-plain/vpl-golden
    run gcc-plain CC=gcc MODE=debug OPENMP=0 EXR=0
fi
TESTS=$ARITHMETIC
ALSO=build/clang-release/vpl-golden
if command -v clang >/dev/null 2>&1; then
    run clang-release CC=clang CFLAGS=
fi
wait
[ ! -e build/check-all-failed ]
