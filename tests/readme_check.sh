#!/bin/sh
# SPDX-License-Identifier: MIT
# What README files say must be true: tests/readme_check.sh WHAT VPL README, where WHAT is
#   links      every relative link leads to a file, every anchor to a heading
#   commands   every command and option of vpl, every benchmark, script and make target that stands in code exists
#   places     no path outside the repository
# Prints what is wrong; succeeds if nothing is.
what=$1
vpl=$2
readme=$3

# The code of a README, one line each: lines of blocks, joined where they end in \, and spans between backticks.
code() {
    awk '
        /^```/ { block = !block; next }
        block || /^    / {
            sub(/^ +/, "")
            if (sub(/\\$/, "")) { line = line $0 } else { print line $0; line = "" }
            next
        }
        { text = text " " $0 }
        END { n = split(text, part, "`"); for (i = 2; i <= n; i += 2) print part[i] }' "$1"
}

headings() {
    sed -n 's/^##* //p' "$1" | tr 'A-Z' 'a-z' | sed 's/[^a-z0-9 _-]//g; s/ /-/g'
}

links() {
    folder=$(dirname "$readme")
    sed 's/`[^`]*`//g' "$readme" | grep -o '](<*[^)> ]*' | sed 's/^](<*//' | while read -r link; do
        case $link in
        http://* | https://* | mailto:*) continue ;;
        esac
        path=${link%%#*}
        target=$readme
        [ -z "$path" ] || target=$folder/$path
        if [ ! -e "$target" ]; then
            echo "$readme: no $link"
        elif [ "$link" != "${link#*#}" ] && ! headings "$target" | grep -qx -- "${link#*#}"; then
            echo "$readme: no heading ${link#*#} in $target"
        fi
    done
}

# The options that a command has. Those of rendering have a page of their own.
options_of() {
    {
        "$vpl" help "$1"
        case $1 in
        compare | bench | merge | completion) ;;
        *) "$vpl" help options ;;
        esac
    } 2>/dev/null | grep -o -- '--[a-z][a-z0-9-]*'
    printf '%s\n' --help --version
}

commands() {
    known=$("$vpl" help | sed -n 's/^  vpl \([a-z][a-z]*\) .*/\1/p' | sort -u)
    # vpl-mpi and mpirun, which tests/mpi/run.sh runs, have options of their own.
    mpi=$(sed -n '/^static const char USAGE/,/;$/p' src/mpi/main.c | grep -o -- '--[a-z][a-z0-9-]*')
    all=$({ for command in $known; do options_of "$command"; done; printf '%s\n' $mpi --bind-to; } | sort -u)
    code "$readme" | sed -n 's/^\(build\/\)*vpl  *//p; s/^\(--[a-z]\)/\1/p' | while read -r command rest; do
        options=$all
        case $command in
        --*) rest="$command $rest" ;;
        *)
            echo "$known" | grep -qx -- "$command" || { echo "$readme: no command vpl $command" && continue; }
            options=$(options_of "$command")
            ;;
        esac
        for option in $(echo "$rest" | grep -o -- '\(^\|[ [(]\)--[a-z][a-z0-9-]*' | tr -d ' [('); do
            echo "$options" | grep -qx -- "$option" || echo "$readme: no option $option: $rest"
        done
    done
    code "$readme" | grep -o 'build/bench/[a-z_][a-z_]*' | sort -u | while read -r bench; do
        [ -e "tests/bench/${bench##*/}.c" ] || echo "$readme: no $bench"
    done
    code "$readme" | grep -o '\(tests\|\.ci\)/[a-z_/]*\.sh' | sort -u | while read -r script; do
        [ -x "$script" ] || echo "$readme: no $script"
    done
    code "$readme" | sed -n 's/^make  *\([a-z][a-z-]*\).*/\1/p' | sort -u | while read -r target; do
        grep -q "^$target:" Makefile || echo "$readme: no target $target"
    done
}

places() {
    grep -n '\.\./shared\|/work/\|/tmp/' "$readme" | sed "s|^|$readme:|"
}

wrong=$("$what")
[ -z "$wrong" ] || { echo "$wrong" && exit 1; }
