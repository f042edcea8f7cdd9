# SPDX-License-Identifier: MIT
# What the checks share. Sourced by run.sh, which sets vpl, room, closed, scratch, out, passed and failed.

ok() {
    passed=$((passed + 1))
    echo "ok $1"
}

not_ok() {
    failed=$((failed + 1))
    echo "not ok $1: $2"
}

# check NAME COMMAND...: passes if the command succeeds.
check() {
    name=$1
    shift
    if "$@" >"$scratch/check" 2>&1; then
        ok "$name"
    else
        not_ok "$name" "$(tail -n 3 "$scratch/check" | tr '\n' ' ')"
    fi
}

# Names, sizes and contents of the output folder.
snapshot() {
    (cd "$out" && find . -type f -exec cksum {} + | sort && find . -type l -o -type d | sort)
}

# What is wrong with stderr of a failure: one sentence, ours, is wanted.
wrong_sentence() {
    if grep -qE 'Sanitizer|runtime error|Assertion|core dumped|Segmentation' "$scratch/stderr"; then
        echo "crash text: $(head -n 3 "$scratch/stderr" | tr '\n' ' ')"
    elif [ "$(wc -l <"$scratch/stderr")" -ne 1 ]; then
        echo "$(wc -l <"$scratch/stderr") lines on stderr instead of one: $(head -n 3 "$scratch/stderr" | tr '\n' ' ')"
    elif ! grep -q '^vpl: [^ ]' "$scratch/stderr"; then
        echo "no sentence of ours: $(cat "$scratch/stderr")"
    elif ! grep -qF -- "$1" "$scratch/stderr"; then
        echo "\"$(cat "$scratch/stderr")\" lacks \"$1\""
    fi
}

# runs COMMAND...: its exit code in $code and its words in files. On a slow machine a render of more than ten seconds tells
# how far it is: those lines are taken out.
runs() {
    "$@" >"$scratch/stdout" 2>"$scratch/stderr"
    code=$?
    sed -i '/^vpl: [0-9]* %, [0-9]*:[0-9][0-9] left$/d' "$scratch/stderr"
}

# refuses NAME CODE TEXT COMMAND...: the command ends with CODE, says one sentence that contains TEXT, prints
# nothing to stdout and leaves the output folder as it was.
refuses() {
    name=$1
    want=$2
    text=$3
    shift 3
    before=$(snapshot)
    runs "$@"
    sentence=$(wrong_sentence "$text")
    if [ "$code" -ne "$want" ]; then
        not_ok "$name" "exit code $code instead of $want: $(head -n 1 "$scratch/stderr")"
    elif [ -n "$sentence" ]; then
        not_ok "$name" "$sentence"
    elif [ -s "$scratch/stdout" ]; then
        not_ok "$name" "stdout is not empty: $(head -n 1 "$scratch/stdout")"
    elif [ "$(snapshot)" != "$before" ]; then
        not_ok "$name" "files changed: $(ls -A "$out" | tr '\n' ' ')"
    else
        ok "$name"
    fi
}

# succeeds NAME COMMAND...: exit code 0 and not a word on stderr. stdout stays in $scratch/stdout.
succeeds() {
    name=$1
    shift
    runs "$@"
    if [ "$code" -ne 0 ]; then
        not_ok "$name" "exit code $code: $(head -n 1 "$scratch/stderr")"
    elif [ -s "$scratch/stderr" ]; then
        not_ok "$name" "stderr is not empty: $(head -n 1 "$scratch/stderr")"
    else
        ok "$name"
    fi
}

# field FILE KEY: the value of a key in JSON, without spaces, arrays whole.
field() {
    tr -d ' \n' <"$1" | sed -n "s/.*\"$2\":\(\[[^]]*\]\|[^,}]*\).*/\1/p"
}

# equals NAME WANTED FOUND
equals() {
    if [ "$2" = "$3" ]; then
        ok "$1"
    else
        not_ok "$1" "\"$3\" instead of \"$2\""
    fi
}
