#!/bin/sh
# Static checks of src: cppcheck, and clang-tidy with the checks of .clang-tidy, where they are installed.
# tests/lint.sh --quick leaves out clang-tidy, which takes six minutes of a processor. Conversions that lose values are warnings
# of every build. Fails if anything is found.
failed=0
# Findings that were judged and are wrong, each with its reason.
judged=$(mktemp)
trap 'rm -f "$judged"' EXIT
cat >"$judged" <<'END'
# Headers of the system are not read.
missingIncludeSystem
# Planes of a tile hold floats or triangles, and are read as they were written.
invalidPointerCast
# Shifts of negative numbers keep the sign in gcc and clang, and the tests count on it.
shiftTooManyBitsSigned
# Limits are above; cppcheck takes the value before it.
floatConversionOverflow:src/raster/setup.h
# Filled by a function, or by the loop above.
uninitvar:src/cli/calibration.c
uninitvar:src/geometry/bvh_split.c
uninitvar:src/geometry/triangle.c
uninitvar:src/scene/model_look.c
uninitvar:src/scene/model_scene.c
uninitStructMember:src/geometry/trace.c
# The block stays in the structure.
memleak:src/cli/tradeoff/text.c
# k ends at 0 in the loop, the divisor is a prime.
zerodivcond:src/math/sampling.c
# An empty heap has no child.
arrayIndexOutOfBoundsCond:src/shading/lightcuts_kernel.c
# a < b orders equal priorities; it is no bound.
arrayIndexThenCheck:src/geometry/patch_refine.c
# An initializer after a cast.
constStatement:src/shading/interleave_filter_edges.h
END
if command -v cppcheck >/dev/null 2>&1; then
    cppcheck --enable=warning,performance,portability --error-exitcode=1 --quiet --std=c11 -j"$(nproc)" \
        -DVPL_KERNEL_ISA=scalar -DVPL_EXR=1 -D__STDC_VERSION__=201112L -Iinclude -Isrc --suppressions-list="$judged" src || failed=1
else
    echo "no cppcheck"
fi
# The analyzer takes loops that fill arrays to leave elements out, and does not know what callers promise: sizes of elements
# are above 0, a chunk that is missing has been refused, and the end of a line is set before lines are read. The copies of a long
# message end with its own NUL. What is received or sent without waiting is awaited by other functions.
tidy() {
    find src -name '*.c' | sort | xargs -P "$(nproc)" -I FILE clang-tidy --quiet FILE -- -std=gnu11 -Iinclude -Isrc \
        -isystem /usr/include/stb $(printf -- '-isystem %s ' /usr/include/*/mpich) -DVPL_KERNEL_ISA=scalar -DVPL_EXR=1 2>/dev/null | grep -E 'error:|warning:' |
        grep -v -E '/usr/include/|/(exr(_read|_write)?|flip|light_set|interleaved_kernel)\.c:.*(Undefined|uninitialized|CallAndMessage)' |
        grep -v -E 'base/rng.h:.*Undefined|/image\.c:.*CallAndMessage|/context\.c:.*not-null-terminated' |
        grep -v -E '/gltf_accessor\.c:.*DivideZero|/(gltf_file|ply_header)\.c:.*NonNullParamChecker|/mpi/work\.c:.*MPI-Checker'
}
if [ "$1" != --quick ] && command -v clang-tidy >/dev/null 2>&1 && tidy; then
    failed=1
fi
exit $failed
