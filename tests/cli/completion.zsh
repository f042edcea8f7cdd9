# SPDX-License-Identifier: MIT
# zsh -f completion.zsh FOLDER WORDS: types WORDS and a Tab into an interactive zsh that finds completions in FOLDER, and
# prints its line.
zmodload zsh/zpty || exit 1
zpty -b inner "TERM=dumb zsh -f -i"
zpty -w inner "PS1= PROMPT= RPROMPT=; unsetopt beep prompt_sp"
zpty -w inner "fpath=(${(q)1} \$fpath); autoload -U compinit; compinit -u -D"
# The key behind the Tab prints the line. Its marks are written in halves here, so that the echo of these commands has none.
zpty -w inner 'show() { print -r -- "@""LINE[$BUFFER]@"; BUFFER= }; zle -N show'
zpty -w inner 'bindkey "^T" show; bindkey "^I" complete-word; print -r -- @"READY"@'
zpty -r inner echoed '*@READY@*'
zpty -w -n inner "$2"$'\t'$'\x14'
zpty -r -m inner shown '*@LINE\[*\]@*'
print -r -- "${${shown##*@LINE\[}%%\]@*}"
zpty -d inner
