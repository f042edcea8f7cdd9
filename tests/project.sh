#!/bin/sh
# Tests of the project itself: layers, headers, examples, README, installation. tests/project.sh BUILD.
build=$1
passed=0
failed=0
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cc=${CC:-cc}

check() {
    name=$1
    shift
    if "$@" >"$scratch/log" 2>&1; then
        echo "ok $name"
        passed=$((passed + 1))
    else
        echo "not ok $name"
        tail -n 20 "$scratch/log"
        failed=$((failed + 1))
    fi
}

refuses() {
    ! "$@"
}

# A wrong include must be caught, or the layer check checks nothing.
mkdir -p "$scratch/tree/src/math"
echo '#include "render/render.h"' >"$scratch/tree/src/math/bad.c"
check LayersIncludeOnlyTheLayersBelow tests/check_layers.sh
check LayerCheckCatchesAWrongInclude refuses tests/check_layers.sh "$scratch/tree"

for header in include/vpl/*.h; do
    name=$(basename "$header" .h)
    echo "#include <vpl/$name.h>" >"$scratch/alone.c"
    cp "$scratch/alone.c" "$scratch/alone.cpp"
    check "Header_${name}_CompilesAsC11" "$cc" -std=c11 -pedantic -Wall -Wextra -Werror -Iinclude -fsyntax-only "$scratch/alone.c"
    check "Header_${name}_CompilesAsC17" "$cc" -std=c17 -pedantic -Wall -Wextra -Werror -Iinclude -fsyntax-only "$scratch/alone.c"
    check "Header_${name}_CompilesAsCpp17" "$cc" -x c++ -std=c++17 -Wall -Wextra -Werror -Iinclude -fsyntax-only "$scratch/alone.cpp"
done

scene=examples/scenes/closed-room.json
writes() {
    picture=$1
    shift
    "$@" && [ -s "$picture" ]
}
check ExampleHelloRuns writes "$scratch/hello.png" "$build/examples/hello" $scene "$scratch/hello.png"
check ExampleStagesRuns writes "$scratch/stages.png" "$build/examples/stages" $scene "$scratch/stages.png"
check ExampleSceneByHandRuns writes "$scratch/hand.png" "$build/examples/scene_by_hand" "$scratch/hand.png"
check ExampleRasterizerRuns writes "$scratch/raster.png" "$build/examples/rasterizer" "$scratch/raster.png"

# README: its C program is compiled and run, its commands are run.
sed -n '/^```c$/,/^```$/p' README.md | sed '/^```/d' >"$scratch/readme.c"
readme_program() {
    [ -s "$scratch/readme.c" ] &&
        "$cc" -std=gnu11 -Wall -Werror -Iinclude "$scratch/readme.c" "$build/libvpl.a" $SANITIZE_FLAGS -fopenmp $(make -s --no-print-directory libs) -o "$scratch/readme" &&
        cp $scene "$scratch/room.json" && (cd "$scratch" && ./readme) && [ -s "$scratch/room.png" ]
}
[ -n "$SANITIZE_FLAGS" ] || check ReadmeProgramCompilesAndRuns readme_program
readme_commands() {
    mkdir -p "$scratch/commands/build" "$scratch/commands/examples/scenes"
    cp "$build/vpl" "$scratch/commands/build/vpl"
    cp examples/scenes/* "$scratch/commands/examples/scenes"
    sed -n '/^```sh$/,/^```$/p' README.md | grep '^build/vpl' >"$scratch/commands/list"
    [ -s "$scratch/commands/list" ] && (cd "$scratch/commands" && sh -e list)
}
check ReadmeCommandsRun readme_commands

# Installation: a program finds the library by pkg-config alone.
installed_program() {
    make --no-print-directory BUILD="$build" DESTDIR="$scratch/root" PREFIX=/usr install &&
        sed -i "s|^prefix=.*|prefix=$scratch/root/usr|" "$scratch/root/usr/lib/pkgconfig/libvpl.pc" &&
        flags=$(PKG_CONFIG_PATH="$scratch/root/usr/lib/pkgconfig" pkg-config --cflags --libs libvpl) &&
        "$cc" -std=gnu11 examples/hello.c $flags -o "$scratch/installed" &&
        "$scratch/installed" $scene "$scratch/installed.png" && [ -s "$scratch/installed.png" ] &&
        [ -s "$scratch/root/usr/share/man/man1/vpl.1" ]
}
[ -n "$SANITIZE_FLAGS" ] || check InstalledLibraryIsFoundByPkgConfig installed_program

# The man page names every option of rendering and of the program once, under the heading that the help has.
options_in_man_page() {
    make -s --no-print-directory BUILD="$build" "$build/vpl.1" || return 1
    { "$build/vpl" help options; for command in render bake lights compare info tradeoff bench; do
        "$build/vpl" help $command
    done; } | sed -n 's/^  \(-[a-z0-9-]*\).*/\1/p' | sort -u >"$scratch/options"
    [ "$(wc -l <"$scratch/options")" -gt 90 ] && while read -r option; do
        wanted=1
        [ "$option" = -o ] && wanted=3
        [ "$(grep -c -- "^\.BI \"*$(echo "$option" | sed 's/-/\\\\-/g')\( \|$\)" "$build/vpl.1")" -eq $wanted ] ||
            { echo "vpl.1 does not have $option $wanted times"; return 1; }
    done <"$scratch/options"
}
check ManPageNamesEveryOption options_in_man_page

if command -v clang-format >/dev/null 2>&1; then
    check SourcesAreFormatted clang-format --dry-run -Werror $(git ls-files '*.c' '*.h')
fi

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
