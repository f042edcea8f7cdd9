#!/bin/sh
# Tests of the project itself: layers, headers, examples, README files, installation. tests/project.sh BUILD.
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

# Windows takes these names for devices, whatever the extension.
no_name_is_a_device() {
    ! git ls-files | grep -iE '(^|/)(nul|con|aux|prn|com[0-9]|lpt[0-9])(\.|/|$)|[:*?"<>|\\]'
}
check NoFileHasTheNameOfAWindowsDevice no_name_is_a_device

# windows.h defines near, far, small and interface as macros.
windows="-Dnear= -Dfar= -Dsmall=char -Dinterface=struct"
for header in include/vpl/*.h; do
    name=$(basename "$header" .h)
    echo "#include <vpl/$name.h>" >"$scratch/alone.c"
    cp "$scratch/alone.c" "$scratch/alone.cpp"
    check "Header_${name}_CompilesAsC11" "$cc" -std=c11 -pedantic -Wall -Wextra -Werror -Iinclude -fsyntax-only "$scratch/alone.c"
    check "Header_${name}_CompilesAsC17" "$cc" -std=c17 -pedantic -Wall -Wextra -Werror -Iinclude -fsyntax-only "$scratch/alone.c"
    check "Header_${name}_CompilesAsCpp17" "$cc" -x c++ -std=c++17 -Wall -Wextra -Werror -Iinclude -fsyntax-only "$scratch/alone.cpp"
    check "Header_${name}_CompilesBesideWindowsMacros" "$cc" -std=c11 -Wall -Wextra -Werror $windows -Iinclude -fsyntax-only "$scratch/alone.c"
done

# Who renders includes vpl.h and sees no stage; stages.h declares everything.
declares() { # declares HEADER: the exported functions that a program sees which includes this header alone
    echo "#include <vpl/$1>" | "$cc" -std=c11 -Iinclude -E -P -x c - | grep -oE '\bvpl[A-Za-z0-9_]+\(' | tr -d '(' |
        LC_ALL=C sort -u | LC_ALL=C comm -12 - tests/data/symbols.txt
}
renders_by_few_functions() {
    declares vpl.h >"$scratch/few"
    wc -l <"$scratch/few"
    # Contexts, scenes, options, pictures, plans and renders: 65, of which 12 make defs.
    [ "$(wc -l <"$scratch/few")" -ge 50 ] && [ "$(wc -l <"$scratch/few")" -le 65 ] && grep -qx vplRender "$scratch/few" &&
        grep -q "the $(wc -l <"$scratch/few") functions that rendering needs, .*all $(wc -l <tests/data/symbols.txt)" README.md &&
        ! grep -E '^vpl(Geometry|Raster|Ray|Shadow|CubeMap|Patch|FormFactor|Simulate)' "$scratch/few"
}
stages_declare_all() {
    declares stages.h | LC_ALL=C diff tests/data/symbols.txt -
}
check HeaderVplDeclaresWhatRenderingNeeds renders_by_few_functions
check HeaderStagesDeclaresEveryFunction stages_declare_all

scene=examples/scenes/closed-room.json
writes() {
    picture=$1
    shift
    "$@" && [ -s "$picture" ]
}
check ExampleHelloRuns writes "$scratch/hello.png" "$build/examples/hello" $scene "$scratch/hello.png"
check ExampleStagesRuns writes "$scratch/stages.png" "$build/examples/stages" $scene "$scratch/stages.png"
check ExampleSceneByHandRuns writes "$scratch/hand.png" "$build/examples/scene_by_hand" "$scratch/hand.png"
check ExamplePatternsRuns writes "$scratch/leaf.png" "$build/examples/patterns" "$scratch"
check ExampleRasterizerRuns writes "$scratch/raster.png" "$build/examples/rasterizer" "$scratch/raster.png"
check ExampleDeadlineRuns writes "$scratch/deadline.png" "$build/examples/deadline" $scene "$scratch/deadline.png" 3000
bakes_points() {
    [ "$("$build/examples/bake_points" $scene 20 | awk -F, 'NF == 6 && $4 >= 0 && $4 < 1e6 { n++ } END { print n }')" -eq 20 ]
}
check ExampleBakePointsRuns bakes_points
walks() { # the keys change the picture; without a terminal the last one is printed
    printf '' | "$build/examples/interactive" $scene >"$scratch/still" && printf 'wwl' |
        "$build/examples/interactive" $scene >"$scratch/moved" && [ "$(wc -l <"$scratch/moved")" -eq 22 ] &&
        ! cmp -s "$scratch/still" "$scratch/moved"
}
check ExampleInteractiveRuns walks
walks_in_a_terminal() {
    (sleep 4 && printf 'wq') | timeout 60 script -qec "$build/examples/interactive $scene" /dev/null | grep -aq '[0-9] passes'
}
! command -v script >/dev/null || check ExampleInteractiveRunsInATerminal walks_in_a_terminal
# Ten tasks: each program checks what comes out, and the table of examples/README.md has its number of lines.
does_task() { # does_task NAME WORDS...
    task=$1
    shift
    lines=$(grep -vcE '^[[:space:]]*(//.*)?$|^#' "examples/tasks/$task.c")
    grep -qE "^\| \[$task\]\(tasks/$task.c\)[^|]*\| *[0-9]+ \| $lines \|" examples/README.md || {
        echo "examples/README.md does not have $task with its $lines lines"
        return 1
    }
    "$build/examples/tasks/$task" "$@"
}
check TaskMeshToPicture does_task mesh_to_picture "$scratch/mesh.png"
check TaskProgressive does_task progressive $scene
check TaskOwnShader does_task own_shader
check TaskBakePoints does_task bake_points $scene
check TaskPcfFactor does_task pcf_factor
check TaskPlaneBias does_task plane_bias
check TaskKMeans does_task k_means
check TaskFormFactor does_task form_factor
check TaskComparePictures does_task compare_pictures "$scratch/mesh.png" "$scratch/mesh.png"
check TaskComparePicturesRefusesOtherSizes refuses does_task compare_pictures "$scratch/mesh.png" "$scratch/hand.png"
check TaskChangeMaterial does_task change_material
every_task() {
    [ "$(ls examples/tasks/*.c | wc -l)" -eq 10 ] && [ "$(grep -c '](tasks/.*\.c)' examples/README.md)" -eq 10 ]
}
check TasksAreAllInTheTable every_task
examples_name_failures() {
    for example in hello stages; do
        ! "$build/examples/$example" nowhere.json "$scratch/nowhere.png" 2>"$scratch/errors" &&
            grep -q nowhere.json "$scratch/errors" || return 1
    done
    for example in scene_by_hand rasterizer; do
        ! "$build/examples/$example" "$scratch/no/folder.png" 2>"$scratch/errors" &&
            grep -q no/folder.png "$scratch/errors" || return 1
    done
}
check ExamplesNameWhatFailed examples_name_failures

# README files: C blocks are programs that compile and run, sh blocks of README.md run, commands, options and links exist.
# Scenes are beside what runs.
mkdir -p "$scratch/commands/build" "$scratch/commands/examples/scenes"
cp "$build/vpl" "$scratch/commands/build/vpl"
cp -r examples/scenes/* "$scratch/commands/examples/scenes"
cp -r examples/scenes/* "$scratch"

# blocks README LANGUAGE: writes the blocks of a language to block-1.c, block-2.c and so on, and prints how many.
blocks() {
    rm -f "$scratch"/block-*
    awk -v start="\`\`\`$2" -v name="$scratch/block-" -v end=".$2" '
        $0 == start { count++; inside = 1; next }
        /^```/ { inside = 0 }
        inside { print > (name count end) }
        END { print count + 0 }' "$1"
}
readme_programs() {
    count=$(blocks "$1" c)
    [ "$count" -ge "$2" ] || { echo "$1 has $count C programs, must have $2" && return 1; }
    for block in "$scratch"/block-*.c; do
        [ -e "$block" ] || continue
        "$cc" -std=gnu11 -Wall -Wextra -Werror -Iinclude "$block" "$build/libvpl.a" -fopenmp \
            $(make -s --no-print-directory libs) -o "$scratch/readme" &&
            (cd "$scratch" && rm -f ./*.png && ./readme && ls ./*.png) || return 1
    done
}
readme_commands() {
    sed -n '/^```sh$/,/^```$/p' README.md | grep '^build/vpl' >"$scratch/commands/list"
    [ "$(wc -l <"$scratch/commands/list")" -ge 5 ] && (cd "$scratch/commands" && sh -ex list)
}
readme_scenes() {
    [ "$(blocks examples/scenes/README.md json)" -ge 1 ] && "$build/vpl" info "$scratch/block-1.json"
}
two_screens() {
    [ "$(wc -l <README.md)" -le 150 ]
}
for readme in $(find . -name README.md -not -path './build*' | sort); do
    folder=$(dirname "$readme" | sed 's/^\.$/.\/top/; s/^\.\///' | tr / _)
    check "Readme_${folder}_LinksLeadSomewhere" tests/readme_check.sh links "$build/vpl" "$readme"
    check "Readme_${folder}_CommandsExist" tests/readme_check.sh commands "$build/vpl" "$readme"
    check "Readme_${folder}_StaysInTheRepository" tests/readme_check.sh places "$build/vpl" "$readme"
    least=0
    [ "$readme" != ./README.md ] || least=1
    [ -n "$SANITIZE_FLAGS" ] || check "Readme_${folder}_ProgramsRun" readme_programs "$readme" $least
done
check ReadmeCommandsRun readme_commands
check ReadmeSceneIsRead readme_scenes
check ReadmeHasTwoScreens two_screens
printf 'See [that](nowhere.md), [there](#nowhere), `vpl render a.json --nothing 1`, `--never` and `vpl paint`.\n' >"$scratch/README.md"
printf 'In ../shared/scenes.\n' >>"$scratch/README.md"
for what in links commands places; do
    check "ReadmeCheckCatchesWrong_$what" refuses tests/readme_check.sh $what "$build/vpl" "$scratch/README.md"
done

# An inner make takes part of the jobs of the outer one.
shares_jobs() {
    ! env -u MAKEFLAGS -u MFLAGS make -n -j2 BUILD="$scratch/make" all 2>&1 | grep jobserver
}
check InnerMakesShareTheJobs shares_jobs

# Plain make installs nothing and names what it lacks; make test installs.
installs() {
    make -n --no-print-directory "$@" | grep -q install-deps
}
check PlainMakeInstallsNothing refuses installs BUILD="$scratch/make" all
check MakeTestInstalls installs BUILD="$scratch/make" test
check MakeDemoInstalls installs BUILD="$scratch/make" demo
names_what_is_missing() {
    make --no-print-directory BUILD="$scratch/make" CC=false all 2>&1 | grep -q 'apt-get install.*libjansson-dev'
}
check PlainMakeNamesWhatIsMissing names_what_is_missing

# The shared library exports what the public headers declare and nothing else. After a change of the API write the list
# anew: nm -D --defined-only build/libvpl.so | awk '{ print $3 }' | LC_ALL=C sort >tests/data/symbols.txt
exports() {
    nm -D --defined-only "$build/libvpl.so" | awk '{ print $3 }' | LC_ALL=C sort
}
same_symbols() {
    exports | diff tests/data/symbols.txt -
}
declared_symbols() {
    for symbol in $(exports); do
        grep -qw "$symbol" include/vpl/*.h || { echo "no header declares $symbol" && return 1; }
    done
}
[ -n "$SANITIZE_FLAGS" ] || check SharedLibraryExportsTheListedSymbols same_symbols
[ -n "$SANITIZE_FLAGS" ] || check HeadersDeclareWhatIsExported declared_symbols

# The ABI stays as it is while the soname does, where abidiff is there to compare it.
same_abi() {
    tests/abi.sh check "$build"
}
abi_check_finds_changes() {
    tests/abi.sh self "$build"
}
if [ -n "$SANITIZE_FLAGS" ]; then
    echo "skipped: the ABI is not compared under a sanitizer"
else
    tests/abi.sh check "$build" | grep '^skipped' || {
        check AbiStaysWithTheSoname same_abi
        check AbiCheckFindsChanges abi_check_finds_changes
    }
fi

# The Python package, with NumPy and without it, and its script.
python_package() {
    VPL_LIBRARY=$(realpath "$build/libvpl.so") PYTHONPATH=examples/python PYTHONDONTWRITEBYTECODE=1 \
        "$@" examples/python/test_vpl.py "$build/vpl" $scene
}
python_script() {
    VPL_LIBRARY=$(realpath "$build/libvpl.so") PYTHONPATH=examples/python PYTHONDONTWRITEBYTECODE=1 \
        "$python" examples/python/error_curve.py $scene "$scratch/curve.png" | awk '
            { last = $3 } NR == 1 { first = $3 } END { print first, last; exit !(NR == 6 && last + 0 < first / 2) }'
}
# The three lines of its README, without a network, where there is nothing but a built library. Arguments of venv may be added.
python_lines() { # python_lines PYTHON [ARGUMENT]
    rm -rf "$scratch/python" && mkdir -p "$scratch/python/build" "$scratch/python/include" "$scratch/python/examples" || return 1
    cp -r include/vpl "$scratch/python/include" && cp -r examples/python examples/scenes "$scratch/python/examples" &&
        ln -s "$(realpath "$build/libvpl.so")" "$scratch/python/build/libvpl.so" || return 1
    sed -n '/^```sh$/,/^```$/p' examples/python/README.md | grep -v '^```' | sed "s|^python3 -m venv|$1 -m venv $2|" \
        >"$scratch/python/lines"
    [ "$(wc -l <"$scratch/python/lines")" -eq 3 ] &&
        (cd "$scratch/python" && unset PYTHONPATH VPL_LIBRARY && PIP_NO_INDEX=1 PYTHONDONTWRITEBYTECODE=1 sh -ex lines) &&
        [ -s "$scratch/python/build/room.png" ]
}
python_lines_with_numpy() {
    python_lines "$python" --system-site-packages && (cd "$scratch/python" && build/env/bin/python -c '
import numpy, os, vpl
assert "build/env" in vpl.__file__ and os.path.exists(os.path.join(os.path.dirname(vpl.__file__), "libvpl.so"))
assert isinstance(vpl.render("examples/scenes/room.json", method="direct", size=(32, 18)), numpy.ndarray)')
}
python=
for candidate in python3 /usr/bin/python3; do
    ! "$candidate" -c 'import numpy' 2>/dev/null || python=$candidate
done
if [ -n "$SANITIZE_FLAGS" ] || ! command -v python3 >/dev/null; then
    echo "skipped: PythonPackage needs python3 and no sanitizer"
else
    check PythonPackageWithoutNumPy python_package python3 -S
    if python3 -c 'import ensurepip, venv' 2>/dev/null; then
        check PythonReadmeRunsInAnEmptyEnvironment python_lines python3
    else
        echo "skipped: PythonReadmeRunsInAnEmptyEnvironment needs python3-venv"
    fi
    if [ -n "$python" ]; then
        check PythonPackageWithNumPy python_package "$python"
        check PythonErrorCurveFalls python_script
        ! "$python" -c 'import ensurepip, venv' 2>/dev/null || check PythonReadmeRunsWithNumPy python_lines_with_numpy
    else
        echo "skipped: PythonPackageWithNumPy needs python3-numpy"
    fi
fi

# Installation: programs find the library by pkg-config or CMake alone, and nothing is left when it is removed.
installs_and_finds() {
    prefix=$scratch/root/usr
    make --no-print-directory BUILD="$build" PREFIX="$prefix" install &&
        export PKG_CONFIG_PATH="$prefix/lib/pkgconfig" LD_LIBRARY_PATH="$prefix/lib" || return 1
    # Static first: it must not need the shared library.
    "$cc" -std=gnu11 examples/hello.c $(pkg-config --cflags libvpl) "$prefix/lib/libvpl.a" \
        $(pkg-config --libs --static libvpl | sed 's/-lvpl//') -o "$scratch/static" &&
        "$cc" -std=gnu11 examples/hello.c $(pkg-config --cflags --libs libvpl) -o "$scratch/shared" &&
        "$cc" -std=gnu11 examples/stages.c $(pkg-config --cflags --libs libvpl) -o "$scratch/stages" &&
        readelf -d "$scratch/shared" | grep -qF "[$(readlink "$build/libvpl.so")]" &&
        "$scratch/static" $scene "$scratch/static.pfm" && "$scratch/shared" $scene "$scratch/shared.pfm" &&
        cmp "$scratch/static.pfm" "$scratch/shared.pfm" && [ -s "$prefix/share/man/man1/vpl.1" ]
}
packaged_program() {
    cmake -S examples/embed/package -B "$scratch/package" -DCMAKE_PREFIX_PATH="$prefix" &&
        cmake --build "$scratch/package" && "$scratch/package/hello-vpl" $scene "$scratch/vpl.pfm" &&
        "$scratch/package/hello-vpl_static" $scene "$scratch/vpl_static.pfm" && cmp "$scratch/vpl.pfm" "$scratch/vpl_static.pfm"
}
embedded_by_cmake() {
    cmake -S examples/embed/cmake -B "$scratch/cmake" -DBUILD="$(realpath "$build")" && cmake --build "$scratch/cmake" &&
        "$scratch/cmake/hello" $scene "$scratch/cmake.png"
}
leaves_nothing() {
    make --no-print-directory BUILD="$build" PREFIX="$prefix" uninstall && ! find "$prefix" -name '*vpl*' | grep .
}
# A project with libvpl's sources inside takes its objects from the build under test, or it would compile all of them.
embedded_program() {
    mkdir -p "$scratch/embedded" && cp -a "$build/obj" "$build/libvpl.a" "$scratch/embedded" &&
        make -C examples/embed/make BUILD="$scratch/embedded" CC="$cc" && "$scratch/embedded/hello" $scene "$scratch/embedded.png"
}
if [ -z "$SANITIZE_FLAGS" ]; then
    check InstalledLibrariesAreFoundByPkgConfig installs_and_finds
    check SourcesInsideAnotherProjectBuildByThreeLines embedded_program
    if command -v cmake >/dev/null; then
        check InstalledLibrariesAreFoundByCMake packaged_program
        check SourcesInsideAnotherProjectBuildByCMake embedded_by_cmake
    else
        echo "skipped: InstalledLibrariesAreFoundByCMake needs cmake"
    fi
    check UninstallLeavesNothing leaves_nothing
fi

# The man page names every option of rendering and of the program once, under the heading that the help has.
options_in_man_page() {
    make -s --no-print-directory BUILD="$build" "$build/vpl.1" || return 1
    { "$build/vpl" help options; for command in render bake lights compare merge info tradeoff bench; do
        "$build/vpl" help $command
    done; } | sed -n 's/^  \(-[a-z0-9-]*\).*/\1/p' | sort -u >"$scratch/options"
    [ "$(wc -l <"$scratch/options")" -gt 90 ] && while read -r option; do
        wanted=1
        [ "$option" = -o ] && wanted=4 # rows of the table
        [ "$option" = --exposure ] && wanted=2
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
