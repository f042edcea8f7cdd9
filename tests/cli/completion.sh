# SPDX-License-Identifier: MIT
# Completions by the shells themselves. Sourced by run.sh.
wrong "completion is for bash, zsh or fish" completion tcsh
mkdir -p "$scratch/complete/zsh" "$scratch/complete/fish" "$scratch/complete/files"
for shell in bash zsh fish; do
    succeeds "Completion_${shell}_IsPrinted" "$vpl" completion $shell
    case $shell in
    bash) cp "$scratch/stdout" "$scratch/complete/bash" ;;
    zsh) cp "$scratch/stdout" "$scratch/complete/zsh/_vpl" ;;
    fish) cp "$scratch/stdout" "$scratch/complete/fish/vpl.fish" ;;
    esac
done
cp "$room" "$scratch/complete/files/lonely.json"

# offers_SHELL WORDS: what the shell offers for a command line, of which WORDS is what was typed.
offers_bash() {
    bash -c '. "$0"; COMP_WORDS=($1); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _vpl
        [ "${#COMPREPLY[@]}" -gt 0 ] || COMPREPLY=($(compgen -f -- "${COMP_WORDS[COMP_CWORD]}")) # complete -o default
        printf "%s\n" "${COMPREPLY[@]}"' "$scratch/complete/bash" "$1"
}
# zsh writes the only word that fits into its line, as at a terminal.
offers_zsh() {
    timeout 60 zsh -f "$folder/completion.zsh" "$scratch/complete/zsh" "$1" </dev/null | tr ' ' '\n'
}
# fish reads completions of programs that it finds.
offers_fish() {
    PATH=$(dirname "$vpl"):$PATH timeout 60 fish --no-config -c 'set fish_complete_path $argv[1]; complete -C $argv[2]' \
        "$scratch/complete/fish" "$1" </dev/null | cut -f 1
}
completes() { # completes WANTED WORDS
    (cd "$scratch/complete/files" && "offers_$shell" "$2") | grep -qx -- "$1"
}
for shell in bash zsh fish; do
    if ! command -v $shell >/dev/null; then
        echo "skipped: completions of $shell, which is not installed"
        continue
    fi
    check "Completion_${shell}_KnowsCommands" completes render "vpl re"
    check "Completion_${shell}_CompletesOptions" completes --checkpoint-every "vpl render lonely.json --checkpoint-"
    check "Completion_${shell}_KnowsMethods" completes keller "vpl render lonely.json --method kel"
    check "Completion_${shell}_KnowsScenes" completes lonely.json "vpl render lon"
    check "Completion_${shell}_KnowsFilesOfOptions" completes lonely.json "vpl render a.json --environment lon"
    check "Completion_${shell}_KnowsShells" completes fish "vpl completion f"
    check "Completion_${shell}_OffersNoOptionOfAnother" eval '! completes --heatmap-of "vpl render lonely.json --heatmap-"'
done

