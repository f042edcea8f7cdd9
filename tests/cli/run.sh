#!/bin/sh
# SPDX-License-Identifier: MIT
# Tests of the program from the outside: tests/cli/run.sh path/to/vpl [PART...], from the top of the checkout. Prints one
# line per check and "N passed, N failed" at the end. The checks are in the other files of this folder, its parts; default all.
case $1 in
/*) vpl=$1 ;;
*) vpl=$PWD/$1 ;;
esac
if [ ! -x "$vpl" ]; then
    echo "usage: tests/cli/run.sh path/to/vpl [PART...] (from the top of the checkout)" >&2
    exit 2
fi
room=$PWD/tests/data/room.json
closed=$PWD/tests/data/room-closed.json
folder=$PWD/tests/cli
shift
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
mkdir "$scratch/out"
out=$scratch/out # where pictures go; must be as it was after every failure
export XDG_CACHE_HOME=$scratch/cache # the user's own stays as it is
passed=0
failed=0

. "$folder/support.sh"
for part in ${*:-usage completion scenes files numbers plan pictures sky frames goals save memory parts radiosity tradeoff browser bench speeds}; do
    . "$folder/$part.sh"
done

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
