# SPDX-License-Identifier: MIT
# Files: what cannot be written is refused before the work where possible, and nothing is left half done.

small="--size 16x12 --shadow-map 16"
echo old >"$out/old.png"
echo old >"$out/old.pfm"
mkdir "$out/folder.png"
ln -s /dev/full "$out/full.png"
ln -s /dev/full "$out/full.json"
ln -s "$scratch/nothing.png" "$out/dangling.png"

refuses OutputFolderIsMissing 1 "cannot write: directory $out/none: No such file" \
    "$vpl" render "$room" -o "$out/none/a.png" $small
refuses OutputFolderIsAFile 1 "cannot write: directory $out/old.png: Not a directory" \
    "$vpl" render "$room" -o "$out/old.png/a.png" $small
refuses OutputIsAFolder 1 "folder.png: cannot write: it is a directory" \
    "$vpl" render "$room" -o "$out/folder.png" $small
refuses OutputIsADanglingLink 1 "dangling.png: cannot write: symbolic link: No such file" \
    "$vpl" render "$room" -o "$out/dangling.png" $small
refuses LongNameKeepsItsReason 2 "cannot open: File name too long" "$vpl" info "$(printf '%05000d' 0)"
refuses StatsFolderIsMissing 1 "cannot write: directory $out/none: No such file" \
    "$vpl" render "$room" -o "$out/a.png" --stats "$out/none/s.json" $small
refuses HeatmapFolderIsMissing 1 "cannot write: directory $out/none: No such file" \
    "$vpl" compare "$out/a.png" "$out/a.png" --heatmap "$out/none/h.png"
refuses PictureToCompareIsMissing 2 "cannot open: No such file" "$vpl" compare "$out/no.png" "$out/no.png"
refuses PictureToCompareIsNone 2 "old.png: cannot read the picture" "$vpl" compare "$out/old.png" "$out/old.png"
refuses PictureToCompareIsNoPfm 2 "old.pfm: not a PFM picture" "$vpl" compare "$out/old.pfm" "$out/old.pfm"
refuses PictureToCompareIsUnknown 2 "unknown picture format" "$vpl" compare "$room" "$room"
refuses FailedRenderKeepsTheOldFile 2 "camera is 9" "$vpl" render "$room" -o "$out/old.png" --camera 9 $small

mkdir "$scratch/locked"
chmod 555 "$scratch/locked"
if [ ! -w "$scratch/locked" ]; then # root writes anyway
    refuses OutputFolderIsReadOnly 1 "Permission denied" "$vpl" render "$room" -o "$scratch/locked/a.png" $small
fi

if [ -c /dev/full ]; then
    refuses DiskIsFull 1 "full.png: cannot write: No space left" "$vpl" render "$room" -o "$out/full.png" $small
    "$vpl" lights "$room" >"$out/full.json" 2>"$scratch/stderr"
    equals DiskIsFullForStdout "1 vpl: cannot write to standard output: No space left on device" \
        "$? $(cat "$scratch/stderr")"
    "$vpl" render "$room" -o "$scratch/a.png" --stats "$out/full.json" $small 2>"$scratch/stderr"
    equals DiskIsFullForStats "1 vpl: $out/full.json: cannot write: No space left on device" \
        "$? $(cat "$scratch/stderr")"
fi

# A scene may come from a pipe, which may have no end, or nothing to say.
if [ -c /dev/zero ]; then
    refuses SceneHasNoEnd 2 "cannot read: it has no end within 256 MiB" "$vpl" info /dev/zero
    refuses PartHasNoEnd 2 "cannot read: it has no end within 256 MiB" "$vpl" merge /dev/zero -o "$out/a.pfm"
fi
if command -v timeout >/dev/null 2>&1; then
    mkfifo "$scratch/silent"
    exec 9<>"$scratch/silent" # open for writing, so that readers wait
    for command in info "render -o $out/a.png" "tradeoff -o $out/a" "bake -o $out/a.ply"; do
        # shellcheck disable=SC2086 # the words of a command
        timeout -s TERM -k 5 0.3 "$vpl" $command "$scratch/silent" 2>"$scratch/stderr"
        equals "ASilentPipeIsInterrupted: $command" "124 " "$? $(cat "$scratch/stderr")"
    done
    mkfifo "$scratch/silent.pfm"
    for command in "render -o $out/a.pfm --method path --resume $scratch/silent" \
        "render -o $out/a.pfm --method path --resume $scratch/silent.pfm" \
        "merge -o $out/a.pfm $scratch/silent" \
        "tradeoff -o $out/a --reference $scratch/silent.pfm"; do # the latter has no writer yet
        # shellcheck disable=SC2086 # the words of a command
        timeout -s TERM -k 5 1 "$vpl" $command "$room" 2>"$scratch/stderr"
        equals "ASilentPipeIsInterruptedOnce: $command" "124 vpl: cancelled, nothing was written" "$? $(cat "$scratch/stderr")"
    done
    exec 9>&-
    (sleep 0.2 && cat "$room" >"$scratch/silent") &
    succeeds ASceneMayComeLate "$vpl" info "$scratch/silent"
fi

# A file beyond the size limit fails in the middle of writing, as a disk that fills up does.
limited() {
    (ulimit -f 4 && exec "$@")
}
refuses WritingFailsHalfway 1 "b.pfm: cannot write: File too large" \
    limited "$vpl" render "$room" -o "$out/b.pfm" --size 200x200 --shadow-map 16
refuses WritingOverAnOldFileFailsHalfway 1 "old.pfm: cannot write: File too large" \
    limited "$vpl" render "$room" -o "$out/old.pfm" --size 200x200 --shadow-map 16

{
    "$vpl" lights "$room" --particles 20000 2>"$scratch/stderr"
    echo $? >"$scratch/code"
} | head -n 1 >/dev/null
equals ClosedPipe "1 vpl: cannot write to standard output: Broken pipe" "$(cat "$scratch/code" "$scratch/stderr" | tr '\n' ' ' | sed 's/ $//')"
"$vpl" lights "$room" >&- 2>"$scratch/stderr"
equals ClosedStdout "1 vpl: cannot write to standard output: Bad file descriptor" "$? $(cat "$scratch/stderr")"

# Minutes of work, interrupted in the first second.
if command -v timeout >/dev/null 2>&1; then
    for signal in INT TERM; do
        refuses "Interrupted_SIG$signal" 1 "cancelled, nothing was written" \
            timeout --preserve-status -s $signal -k 60 1 \
            "$vpl" render "$room" -o "$out/old.png" --particles 20000 --size 4096x4096
    done
fi

cp "$room" "$scratch/link-target.png"
ln -s ../link-target.png "$out/link.png"
succeeds OutputThroughASymbolicLink "$vpl" render "$room" -o "$out/link.png" --stats "$out/s.json" $small
check TheLinkStaysALink test -h "$out/link.png"
check TheTargetIsAPicture "$vpl" compare "$scratch/link-target.png" "$out/link.png"
rm "$out/link.png"
touch "$out/t.json.tmp"
succeeds OutputReplacesAnOldFile "$vpl" render "$room" -o "$out/old.png" --stats "$out/t.json" $small
equals NoTemporaryFilesStay "dangling.png folder.png full.json full.png old.pfm old.png s.json t.json t.json.tmp " \
    "$(ls -A "$out" | tr '\n' ' ')"
rm -rf "$out"
mkdir "$out"
