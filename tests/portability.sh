#!/bin/sh
# Builds the library, program, unit tests and golden pictures for other machines and runs them there or in an emulator: all
# golden pictures must have the recorded bits, and the program must write the bytes that this machine's does.
# tests/portability.sh [TARGET...]: default musl i386 s390x mingw. Installs what is missing, as root; a target whose compiler
# or libraries cannot be had is skipped with a sentence. tests/portability.md has the results, and the reasons for what is
# left out. VPL_FILES_ONLY=1 takes only the unit tests of files, hashes and arithmetic. Times are processor time.
here=build/portability
mkdir -p "$here"
here=$(cd "$here" && pwd)
native=build/vpl
passed=0
failed=0
jobs=${JOBS:-$(nproc)}
export OMP_WAIT_POLICY=passive

skip() {
    echo "$1: skipped, $2"
}

# install PACKAGE...: whether they are there in the end.
install() {
    missing=
    for package in "$@"; do
        dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'install ok installed' || missing="$missing $package"
    done
    [ -z "$missing" ] && return
    set -- env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends $missing
    "$@" >"$here/install.log" 2>&1 || { apt-get update && "$@"; } >>"$here/install.log" 2>&1
}

# Adds a Debian architecture whose libraries are wanted.
architecture() {
    dpkg --print-foreign-architectures | grep -qx "$1" || { dpkg --add-architecture "$1" && apt-get update; } >/dev/null 2>&1
}

# OpenEXR's headers cannot be installed for two architectures: its packages are unpacked to a folder.
unpack_exr() {
    [ -e "$here/$1-root/usr/include/OpenEXR/openexr.h" ] && return
    library=$(apt-cache depends "libopenexr-dev:$1" | sed -n 's/.*Depends: \(libopenexr-[0-9][^:]*\).*/\1/p' | head -n 1)
    mkdir -p "$here/$1-debs" && for package in libopenexr-dev $library zlib1g; do
        (cd "$here/$1-debs" && apt-get download "$package:$1" >/dev/null 2>&1) || return 1
    done
    for deb in "$here/$1-debs"/*.deb; do dpkg -x "$deb" "$here/$1-root" || return 1; done
}

# Jansson and cmocka from Debian's sources, for targets of which Debian has no libraries: from_sources NAME COMPILER.
from_sources() {
    root=$here/$1-root
    [ -e "$root/lib/libcmocka.a" ] && return
    mkdir -p "$here/sources/lists" "$root/lib" "$root/include/stb"
    echo "deb-src http://deb.debian.org/debian $(. /etc/os-release && echo "$VERSION_CODENAME") main" >"$here/sources/list"
    set -- "$1" "$2" -o Dir::Etc::sourcelist="$here/sources/list" -o Dir::Etc::sourceparts=/dev/null \
        -o Dir::State::lists="$here/sources/lists" -o Dir::Cache::srcpkgcache= -o Dir::Cache::pkgcache=
    compiler=$2
    shift 2
    (
        cd "$here/sources" || exit 1
        ls -d jansson-*/src cmocka-*/src >/dev/null 2>&1 || {
            apt-get "$@" update && apt-get "$@" source --download-only jansson cmocka &&
                for archive in *.orig.tar.?z; do tar xf "$archive" || exit 1; done
        } || exit 1
        cp jansson-*/src/jansson.h cmocka-*/include/cmocka*.h /usr/include/jansson_config.h "$root/include/" &&
            cp -r /usr/include/stb/. "$root/include/stb/" && : >"$root/include/jansson_private_config.h" || exit 1
        mkdir -p "$root/jansson" && cd "$root/jansson" || exit 1
        "$compiler" -O2 -DHAVE_STDINT_H -DHAVE_SYS_TIME_H -DHAVE_SYS_TYPES_H -DHAVE_UNISTD_H -DHAVE_FCNTL_H \
            -DHAVE_SYNC_BUILTINS -DHAVE_ATOMIC_BUILTINS -DHAVE_LOCALE_H -DHAVE_LOCALECONV -DHAVE_SNPRINTF \
            -DINITIAL_HASHTABLE_ORDER=3 -I"$root/include" -c "$here"/sources/jansson-*/src/*.c || exit 1
        ar rcs "$root/lib/libjansson.a" ./*.o
        "$compiler" -O2 -DHAVE_SIGNAL_H -DHAVE_INTTYPES_H -DHAVE_STRUCT_TIMESPEC=1 -I"$root/include" -c \
            "$here"/sources/cmocka-*/src/cmocka.c -o "$root/cmocka.o" && ar rcs "$root/lib/libcmocka.a" "$root/cmocka.o"
    ) >"$here/sources.log" 2>&1
}

# Sets `spent` to the seconds of processor time since the call before, of programs that have ended.
before=0
measure() {
    times >"$here/times"
    now=$(sed -n '2{s/m/ /g;s/s//g;p}' "$here/times" | awk '{printf "%.0f", 60 * ($1 + $3) + $2 + $4}')
    spent=$((now - before)) before=$now
}

# Adds up what passed and failed, and prints it: tell NAME PASSED FAILED.
tell() {
    measure
    passed=$((passed + $2))
    failed=$((failed + $3))
    echo "$1: $2 passed, $3 failed ($spent s)"
}

# count NAME COMMAND...: runs something that ends with "N passed, N failed".
count() {
    name=$1
    shift
    "$@" >"$here/$target.tests" 2>&1
    code=$?
    line=$(tr -d '\r' <"$here/$target.tests" | grep -E '^[0-9]+ passed, [0-9]+ failed$' | tail -n 1)
    good=$(echo "$line" | sed -n 's/ passed.*//p')
    bad=$(echo "$line" | sed -n 's/.*, \([0-9]*\) failed/\1/p')
    [ -n "$line" ] && { [ "$code" -eq 0 ] || [ "$bad" -ne 0 ]; } || bad=$((${bad:-0} + 1)) # it died
    tell "$name" "${good:-0}" "$bad"
    [ "$bad" -eq 0 ] || grep -aE 'FAILED|ERROR|LINE|^not ok|rror' "$here/$target.tests" | head -n 30
}

# same NAME A B: two files must have the same bytes.
same() {
    if cmp -s "$2" "$3"; then good=$((good + 1)); else bad=$((bad + 1)) && echo "not ok $1"; fi
}

# The program's files against those of this machine's program, and files of one that the other reads: program RUNNER... VPL.
program() {
    [ -x "$native" ] || make -j"$jobs" --no-print-directory "$native" >"$here/native.log" 2>&1
    other="$*" good=0 bad=0 out=$here/$target-files
    rm -rf "$out" && mkdir -p "$out"
    room=examples/scenes/room.json textured=examples/scenes/textured-room.json
    path="examples/scenes/room-area.json --method path --size 48x100 --quiet"
    for kind in native other; do
        eval "vpl=\$$kind"
        $vpl render - -o - --size 40x30 --quiet <$room >"$out/$kind.png" 2>"$out/$kind.log"
        $vpl render $textured -o "$out/$kind.pfm" --size 40x30 --quiet 2>>"$out/$kind.log"
        $vpl lights $textured --particles 50 >"$out/$kind.csv" 2>>"$out/$kind.log"
        $vpl help render >"$out/$kind.help" 2>>"$out/$kind.log"
        $vpl info missing.json >"$out/$kind.words" 2>&1
        echo "code $?" | cat "$out/$kind.words" - | tr -d '\r' >"$out/$kind.refusal" # Windows ends lines so
        $vpl render $path --spp 8 -o "$out/$kind-whole.pfm" 2>>"$out/$kind.log"
        $vpl render $path --spp 4 -o "$out/$kind-half.pfm" --checkpoint "$out/$kind.state" 2>>"$out/$kind.log"
    done
    same "a PNG at standard output of a scene at standard input" "$out/native.png" "$out/other.png"
    same "a PFM of a scene with pictures" "$out/native.pfm" "$out/other.pfm"
    same "a table of virtual lights" "$out/native.csv" "$out/other.csv"
    same "the help" "$out/native.help" "$out/other.help"
    same "a refusal and its code" "$out/native.refusal" "$out/other.refusal"
    same "a picture of paths" "$out/native-whole.pfm" "$out/other-whole.pfm"
    same "the state of a render" "$out/native.state" "$out/other.state"
    $native render $path --spp 8 --resume "$out/other.state" -o "$out/here.pfm"
    $other render $path --spp 8 --resume "$out/native.state" -o "$out/there.pfm"
    same "a render that goes on here" "$out/native-whole.pfm" "$out/here.pfm"
    same "a render that goes on there" "$out/native-whole.pfm" "$out/there.pfm"
    $native render $path --spp 8 --tile 1/2 -o "$out/tile1" && $other render $path --spp 8 --tile 2/2 -o "$out/tile2"
    $native merge "$out/tile1" "$out/tile2" -o "$out/here.pfm" && $other merge "$out/tile1" "$out/tile2" -o "$out/there.pfm"
    same "parts that are merged here" "$out/native-whole.pfm" "$out/here.pfm"
    same "parts that are merged there" "$out/native-whole.pfm" "$out/there.pfm"
    tell "$target program" "$good" "$bad"
    [ "$bad" -eq 0 ] || cat "$out/other.log"
}

# run NAME RUNNER SUFFIX "TESTS" MAKE-VARIABLES...: builds a target and runs what was built. RUNNER "none" only builds.
run() {
    target=$1 runner=$2 suffix=$3 tests=$4 build=build/portability/$1
    shift 4
    [ -z "$VPL_FILES_ONLY" ] || tests=$FILES
    measure
    if ! make -j"$jobs" --no-print-directory BUILD="$build" PACKED=1 SUITES="$tests" "$@" "$build/libvpl.a" "$build/vpl" \
        "$build/vpl-golden" "$build/vpl-tests" >"$here/$target.log" 2>&1; then
        echo "$target: not built, see build/portability/$target.log"
        grep -m 5 -E 'rror|undefined' "$here/$target.log"
        failed=$((failed + 1))
        return
    fi
    measure
    echo "$target: built, $(grep -c 'warning:' "$here/$target.log") warnings ($spent s)"
    [ "$runner" != none ] || return
    program $runner "$build/vpl$suffix"
    count "$target golden pictures" $runner "$build/vpl-golden$suffix" check golden "$build/golden"
    count "$target unit tests" $runner "$build/vpl-tests$suffix" --quick $tests
}

# musl has no OpenEXR and its gcc no OpenMP.
musl() {
    { install musl-tools && from_sources musl musl-gcc; } || { skip musl "it needs musl-tools and the sources of jansson and cmocka"; return; }
    run musl "" "" "$WHOLE" CC=musl-gcc OPENMP=0 EXR=0 WIDE= CFLAGS="-O1 -isystem $here/musl-root/include -isystem $here/musl-root/include/stb" \
        LDLIBS="-L$here/musl-root/lib -ljansson -lm"
}

# Suites of files, hashes and arithmetic: what a machine's byte order and word size can change. Whole renders are left to the
# golden pictures and to what is done with the program.
FILES="image exr ply ply_read gltf gltf_scene files math obj obj_parts textures layers scene hits pieces checkpoint plan_file
    -Threads -Everywhere -OneRender -FinalGather -ALoadedRender -GoesOnToMore -IsReplayedToo -AddUp -ThatEmit"
# All quick tests but those of failing allocations, which check_all.sh runs, and of one picture by many numbers of threads.
WHOLE="-memory -Threads -Everywhere"

# Most kernels of x86-64 run programs of 32 bits: then the whole suite can be run, else what is quick enough in qemu.
i386() {
    architecture i386
    { install gcc-i686-linux-gnu libc6-dev-i386-cross libjansson-dev:i386 libcmocka-dev:i386 libgomp1:i386 && unpack_exr i386; } ||
        { skip i386 "it needs gcc-i686-linux-gnu and Debian's i386 libraries"; return; }
    if echo 'int main(void) { return 0; }' | i686-linux-gnu-gcc -x c - -o "$here/i386-probe" && "$here/i386-probe"; then
        foreign i386 i386-linux-gnu "env LD_LIBRARY_PATH=" "$WHOLE" i686-linux-gnu-gcc OPENMP=1
    elif install qemu-user-static; then
        foreign i386 i386-linux-gnu "qemu-i386-static -E LD_LIBRARY_PATH=" "$FILES" i686-linux-gnu-gcc OPENMP=1
    else
        skip i386 "the kernel runs no program of 32 bits, and there is no qemu-user-static"
    fi
}

s390x() {
    architecture s390x
    { install gcc-s390x-linux-gnu libc6-dev-s390x-cross qemu-user-static libjansson-dev:s390x libcmocka-dev:s390x &&
        unpack_exr s390x; } ||
        { skip s390x "it needs gcc-s390x-linux-gnu, qemu-user-static and Debian's s390x libraries"; return; }
    # The loader must be of the same libc as the libraries: that of libc6:s390x, not the cross compiler's.
    foreign s390x s390x-linux-gnu "qemu-s390x-static -E LD_LIBRARY_PATH=" "$FILES" s390x-linux-gnu-gcc OPENMP=0
}

# foreign NAME TRIPLET RUNNER-UP-TO-LIBRARY-PATH TESTS COMPILER MAKE-VARIABLE
foreign() {
    root=$here/$1-root
    run "$1" "$3$root/usr/lib/$2:$root/lib/$2:/usr/lib/$2" "" "$4" CC="$5" "$6" EXR=1 CFLAGS="-O1 -isystem $root/usr/include" \
        LDLIBS="-L/usr/lib/$2 -L$root/usr/lib/$2 -Wl,-rpath-link,$root/lib/$2 -ljansson -lOpenEXRCore -lm"
}

# Windows. Wine runs its programs; the folder that wine makes is removed in the end.
mingw() {
    cross=x86_64-w64-mingw32
    { install gcc-mingw-w64-x86-64-win32 && from_sources mingw $cross-gcc; } ||
        { skip mingw "it needs gcc-mingw-w64-x86-64-win32 and the sources of jansson and cmocka"; return; }
    install wine64
    wine=none
    for name in /usr/lib/wine/wine64 wine64 wine; do
        [ "$wine" != none ] || wine=$(command -v "$name" || echo none)
    done
    [ "$wine" != none ] || echo "mingw: built only, wine64 cannot be installed"
    export WINEDEBUG=-all WINEPREFIX="$here/wine"
    run mingw "$wine" .exe "$WHOLE" CC=$cross-gcc OPENMP=1 EXR=0 \
        CFLAGS="-O1 -isystem $here/mingw-root/include -isystem $here/mingw-root/include/stb" \
        LDLIBS="-L$here/mingw-root/lib -ljansson -lpthread -lm"
    for server in /usr/lib/wine/wineserver64 wineserver; do
        ! command -v "$server" >/dev/null || { "$server" -k; break; }
    done
    rm -rf "$WINEPREFIX"
}

for name in ${*:-musl i386 s390x mingw}; do
    case $name in
    musl | i386 | s390x | mingw) $name ;;
    *) echo "tests/portability.sh: no target $name; there are musl, i386, s390x and mingw" >&2; exit 2 ;;
    esac
done
[ $((passed + failed)) -eq 0 ] || echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
