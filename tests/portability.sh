#!/bin/sh
# Builds the library, program, unit tests and golden pictures for other machines and runs them there or in an emulator: all
# golden pictures must have the recorded bits. tests/portability.sh [TARGET...]: default musl i386 s390x; mingw does not build yet. Installs what
# is missing, as root; a target whose compiler or libraries cannot be had is skipped with a sentence. tests/portability.md
# has the results, and the reasons for what is left out. VPL_GOLDEN_ONLY=1 leaves out the unit tests.
here=build/portability
mkdir -p "$here"
here=$(cd "$here" && pwd)
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
    [ -z "$missing" ] || DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends $missing \
        >"$here/install.log" 2>&1
}

# Adds a Debian architecture whose libraries are wanted.
architecture() {
    dpkg --print-foreign-architectures | grep -qx "$1" || { dpkg --add-architecture "$1" && apt-get update; } >/dev/null 2>&1
}

# OpenEXR's headers cannot be installed for two architectures: its packages are unpacked to a folder.
unpack_exr() {
    [ -e "$here/$1-root/usr/include/OpenEXR/openexr.h" ] && return
    mkdir -p "$here/$1-debs" && for package in libopenexr-dev libopenexr-3-1-30 zlib1g; do
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
        cp jansson-*/src/jansson.h cmocka-*/include/cmocka.h /usr/include/jansson_config.h "$root/include/" &&
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

# count NAME COMMAND...: runs something that ends with "N passed, N failed".
count() {
    name=$1
    shift
    "$@" >"$here/log" 2>&1
    code=$?
    line=$(tr -d '\r' <"$here/log" | grep -E '^[0-9]+ passed, [0-9]+ failed$' | tail -n 1)
    good=$(echo "$line" | sed -n 's/ passed.*//p')
    bad=$(echo "$line" | sed -n 's/.*, \([0-9]*\) failed/\1/p')
    [ -n "$line" ] && { [ "$code" -eq 0 ] || [ "$bad" -ne 0 ]; } || bad=$((${bad:-0} + 1)) # it died
    passed=$((passed + ${good:-0}))
    failed=$((failed + bad))
    echo "$name: ${good:-0} passed, $bad failed"
    [ "$bad" -eq 0 ] || grep -aE 'FAILED|ERROR|LINE|^not ok|rror' "$here/log" | head -n 30
}

# run NAME RUNNER SUFFIX "TESTS" MAKE-VARIABLES...: builds a target and runs what was built.
run() {
    target=$1 runner=$2 suffix=$3 tests=$4 build=build/portability/$1
    shift 4
    if ! make -j"$jobs" --no-print-directory BUILD="$build" "$@" "$build/libvpl.a" "$build/vpl" "$build/vpl-tests" \
        "$build/vpl-golden" >"$here/$target.log" 2>&1; then
        echo "$target: not built, see build/portability/$target.log"
        grep -m 5 -E 'rror|undefined' "$here/$target.log"
        failed=$((failed + 1))
        return
    fi
    warnings=$(grep -c 'warning:' "$here/$target.log")
    echo "$target: built, $warnings warnings"
    [ -n "$runner" ] || return
    [ "$runner" != native ] || runner=
    $runner "$build/vpl$suffix" --version
    count "$target golden pictures" $runner "$build/vpl-golden$suffix" check golden "$build/golden"
    [ -n "$VPL_GOLDEN_ONLY" ] || count "$target unit tests" $runner "$build/vpl-tests$suffix" --quick $tests
}

# musl has no OpenEXR and its gcc no OpenMP.
musl() {
    { install musl-tools && from_sources musl musl-gcc; } || { skip musl "it needs musl-tools and the sources of jansson and cmocka"; return; }
    run musl native "" "-memory -Threads" CC=musl-gcc OPENMP=0 EXR=0 CFLAGS="-O1 -isystem $here/musl-root/include -isystem $here/musl-root/include/stb" \
        LDLIBS="-L$here/musl-root/lib -ljansson -lm"
}

# Suites of files, hashes and arithmetic: what a machine's byte order and word size can change.
FILES="image exr ply ply_read gltf gltf_scene files math obj obj_parts textures layers scene hits TheHashOfTheCallersView -Threads"

# The kernel may be unable to run programs of 32 bits: qemu always is.
i386() {
    architecture i386
    { install gcc-i686-linux-gnu qemu-user-static libjansson-dev:i386 libcmocka-dev:i386 libgomp1:i386 && unpack_exr i386; } ||
        { skip i386 "it needs gcc-i686-linux-gnu, qemu-user-static and Debian's i386 libraries"; return; }
    emulated i386 i386-linux-gnu i686-linux-gnu-gcc ""
}

s390x() {
    architecture s390x
    { install gcc-s390x-linux-gnu qemu-user-static libjansson-dev:s390x libcmocka-dev:s390x && unpack_exr s390x; } ||
        { skip s390x "it needs gcc-s390x-linux-gnu, qemu-user-static and Debian's s390x libraries"; return; }
    emulated s390x s390x-linux-gnu s390x-linux-gnu-gcc OPENMP=0
}

# emulated NAME TRIPLET COMPILER MAKE-VARIABLE
emulated() {
    root=$here/$1-root
    run "$1" "qemu-$1-static -E LD_LIBRARY_PATH=$root/usr/lib/$2:$root/lib/$2" "" "$FILES" CC="$3" $4 EXR=1 \
        CFLAGS="-O1 -isystem $root/usr/include" LDLIBS="-L/usr/lib/$2 -L$root/usr/lib/$2 -Wl,-rpath-link,$root/lib/$2 -ljansson -lOpenEXRCore -lm"
}

mingw() {
    cross=x86_64-w64-mingw32
    { install mingw-w64 && from_sources mingw $cross-gcc; } || { skip mingw "it needs mingw-w64 and the sources of jansson and cmocka"; return; }
    install wine64
    wine=
    for name in wine64 wine /usr/lib/wine/wine64; do
        [ -n "$wine" ] || wine=$(command -v $name)
    done
    [ -n "$wine" ] || echo "mingw: built only, wine64 cannot be installed"
    export WINEDEBUG=-all
    run mingw "$wine" .exe "image math obj obj_parts hits scene" CC=$cross-gcc OPENMP=0 EXR=0 \
        CFLAGS="-O1 -isystem $here/mingw-root/include -isystem $here/mingw-root/include/stb" \
        LDLIBS="-L$here/mingw-root/lib -ljansson -lm"
}

for name in ${*:-musl i386 s390x}; do
    case $name in
    musl | i386 | s390x | mingw) $name ;;
    *) echo "tests/portability.sh: no target $name; there are musl, i386, s390x and mingw" >&2; exit 2 ;;
    esac
done
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
