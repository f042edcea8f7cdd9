#!/bin/sh
# Compares the ABI of the shared library of a build with that of the last commits which had the same soname:
#   tests/abi.sh check BUILD [REVISION...]   against tests/data/SONAME.abi.gz of the working tree and of revisions, usually
#                                            HEAD and its parent
#   tests/abi.sh write BUILD                 writes this file anew: the soname is new, or functions are
#   tests/abi.sh self BUILD                  checks that changes are found
# New functions pass. All else needs another soname, which follows from VPL_VERSION_MINOR in include/vpl/base.h.
# The file is what abidw (Debian: abigail-tools) finds in the debug information of x86-64, without types inside of the library.
command=$1
build=$2
[ $# -lt 2 ] || shift 2
revisions=${*:-HEAD HEAD^}
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

skip() {
    echo "skipped: the ABI is not compared, $1"
    exit 0
}
command -v abidw >/dev/null && command -v abidiff >/dev/null || skip "which needs abigail-tools"
readelf -h "$build/libvpl.so" | grep -q 'Machine:.*X86-64' || skip "because its record is of x86-64"
readelf -S "$build/libvpl.so" | grep -q debug_info || skip "because the library has no debug information"

soname=$(readelf -d "$build/libvpl.so" | sed -n 's/.*soname: \[\(.*\)\]/\1/p')
file=tests/data/$soname.abi.gz
abidw --headers-dir include/vpl --drop-private-types --exported-interfaces-only --no-corpus-path --no-comp-dir-path \
    --no-show-locs --no-elf-needed --no-parameter-names --out-file "$scratch/now.abi" "$build/libvpl.so" || exit 1

# Types that the headers only declare: programs know none of their fields.
for name in $(sed -nE 's/^typedef struct (\w+) \1;.*/\1/p' include/vpl/*.h); do
    grep -q "^struct $name {" include/vpl/*.h || printf '[suppress_type]\n  name = %s\n' "$name"
done >"$scratch/opaque"

# breaks RECORD: prints what changed since, and succeeds if a program built then may not run now.
breaks() {
    ! abidiff --suppressions "$scratch/opaque" --no-added-syms "$1" "$scratch/now.abi"
}

what_to_do() {
    cat <<END
The ABI of $soname has changed since $1: programs that were built with it break. Either undo the changes above, or raise
VPL_VERSION_MINOR and VPL_VERSION_STRING in include/vpl/base.h, VERSION in examples/python/vpl/__init__.py and the version in
examples/embed/package/CMakeLists.txt, build, run tests/abi.sh write $build, and remove tests/data/$soname.abi.gz.
END
}

# against NAME RECORD.GZ
against() {
    gzip -dc "$2" >"$scratch/then.abi" || exit 1
    if breaks "$scratch/then.abi"; then
        what_to_do "$1"
        exit 1
    fi
    echo "$soname has the ABI of $1"
}

# committed REVISION: the record in a commit, where there is one; a clone without history has no parent.
committed() {
    if git show "$1:$file" >"$scratch/committed.gz" 2>/dev/null; then
        against "$1" "$scratch/committed.gz"
    else
        echo "$1 has no record of the ABI of $soname"
    fi
}

# found NAME: the record then.abi differs from the library, and breaks says so.
found() {
    breaks "$scratch/then.abi" >"$scratch/found" || { echo "$1: not found" && exit 1; }
    echo "$1: found"
}

case $command in
check)
    [ -e "$file" ] || {
        echo "There is no $file: the soname is new. Run tests/abi.sh write $build, and remove the file of the soname before."
        exit 1
    }
    against "$file" "$file"
    for revision in $revisions; do
        committed "$revision"
    done
    abidiff --suppressions "$scratch/opaque" "$scratch/then.abi" "$scratch/now.abi" | grep -A 1000 Added ||
        true # not a failure; tests/abi.sh write adds them to the record
    ;;
write)
    committed HEAD
    gzip -9nc "$scratch/now.abi" >"$file"
    echo "wrote $file"
    ;;
self)
    sed 's/vplGetVersion/vplGetNumber/g' "$scratch/now.abi" >"$scratch/then.abi"
    found "a function that is gone"
    awk '/class-decl name=.vplPixelsDef/ { sub(/size-in-bits=.[0-9]*/, "size-in-bits=\0478") } { print }' \
        "$scratch/now.abi" >"$scratch/then.abi"
    found "a struct of another size"
    grep -v "elf-symbol name='vplGetVersion'" "$scratch/now.abi" | sed "s/ elf-symbol-id='vplGetVersion'//" >"$scratch/then.abi"
    ! breaks "$scratch/then.abi" >"$scratch/found" || { cat "$scratch/found" && exit 1; }
    echo "a new function: allowed"
    ;;
*)
    echo "usage: tests/abi.sh check|write|self BUILD" >&2
    exit 2
    ;;
esac
