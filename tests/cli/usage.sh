# SPDX-License-Identifier: MIT
# Wrong usage: exit code 2 and one sentence that says what to type instead. Help and version.

png=$out/never.png

# wrong TEXT WORDS...: named after the words.
wrong() {
    text=$1
    shift
    refuses "WrongUsage: vpl $(echo "$*" | sed "s|$PWD/||g; s|$scratch/||g")" 2 "$text" "$vpl" "$@"
}

wrong "no command"
wrong "no command \"rendr\", did you mean render?" rendr
wrong "no command \"frob\"" help frob
wrong "needs a scene file" render
wrong "needs a scene file" lights
wrong "needs a scene file" info
wrong "needs two pictures" compare
wrong "needs two pictures" compare a.png
wrong "one word too many: \"second.json\"" render "$room" second.json -o "$png"
wrong "one word too many: \"c.png\"" compare a.png b.png c.png
wrong "one word too many: \"x\"" bench x
wrong "render needs -o FILE" render "$room"
wrong "must end in .png, .hdr" render "$room" -o "$out/never.txt"
wrong "must end in .png, .hdr" render "$room" -o "$out/never"
wrong "--aov writes layers into .exr files only" render "$room" -o "$png" --aov all
wrong "--aov is \"depht\", must be one or more of none|direct|indirect|albedo|normal|depth|object|all" render "$room" -o "$png" --aov depht
wrong "--aov is \"depth,\"" render "$room" -o "$png" --aov depth,
wrong "both the picture and the statistics" render "$room" -o "$png" --stats "$png"

wrong "unknown option --particels, did you mean --particles?" render "$room" -o "$png" --particels 5
wrong "unknown option --thread, did you mean --threads?" lights "$room" --thread=2
wrong "unknown option --reflect, did you mean --reflectivity?" lights "$room" --reflect 0.5
wrong "unknown option --parrticcles, did you mean --particles?" render "$room" -o "$png" --parrticcles 5
wrong "unknown option --prtcls" render "$room" -o "$png" --prtcls 5
check ThreeMistakesAreTooMany sh -c "! grep -q 'did you mean' '$scratch/stderr'"
wrong "unknown option --xyzzy" render "$room" -o "$png" --xyzzy
wrong "unknown option -x" info "$room" -x
wrong "lights has no option --stats" lights "$room" --stats x.json
wrong "compare has no option --seed" compare a.png b.png --seed 1
wrong "--particles needs a value: N" render "$room" -o "$png" --particles
wrong "--particles needs a value: N" render "$room" -o "$png" --particles --quiet
wrong "-o needs a value: FILE" render "$room" -o
wrong "--quiet takes no value" render "$room" -o "$png" --quiet=yes
wrong "-o is empty" render "$room" -o ""

wrong "--particles is \"-1\", must be a whole number in [0, 16777216]" lights "$room" --particles -1
wrong "--particles is \"16777217\"" lights "$room" --particles 16777217
wrong "--particles is \"99999999999999999999\"" lights "$room" --particles 99999999999999999999
wrong "--particles is \"ten\"" lights "$room" --particles ten
wrong "--particles is \"10.5\"" lights "$room" --particles 10.5
wrong "--particles is \"\"" lights "$room" --particles=
wrong "--reflectivity is \"1\", must be less than 1" lights "$room" --reflectivity 1
wrong "--reflectivity is \"-0.1\", must be a number in [0, 1), auto or usual" lights "$room" --reflectivity -0.1
wrong "--reflectivity is \"nan\"" lights "$room" --reflectivity nan
wrong "--reflectivity is \"often\"" lights "$room" --reflectivity often
wrong "needs more than" lights "$room" --particles 10 --reflectivity 0.99999999
wrong "leave more than 16777216 virtual lights" lights "$room" --particles 16777216 --reflectivity 0.5
wrong "--seed is \"-1\"" lights "$room" --seed -1
wrong "--seed is \"18446744073709551616\"" lights "$room" --seed 18446744073709551616
wrong "--threads is \"1025\"" lights "$room" --threads 1025
wrong "--threads is \"1,2\"" lights "$room" --threads 1,2
wrong "--sampler is \"sobol\", must be one of auto|random|halton|hammersley" lights "$room" --sampler sobol
wrong "--method is \"\"" lights "$room" --method=
wrong "--method is \"photon\"" render "$room" -o "$png" --method photon
wrong "--lighting is \"physica\"" render "$room" -o "$png" --lighting physica
wrong "--bounce is" lights "$room" --bounce refract
wrong "--pipeline is" render "$room" -o "$png" --pipeline forward
wrong "--isa is \"mmx\"" render "$room" -o "$png" --isa mmx
wrong "--tonemap is \"filmic\", must be one of usual|none|reinhard|aces|agx" render "$room" -o "$png" --tonemap filmic
wrong "--batch is \"0\"" render "$room" -o "$png" --batch 0
wrong "--interleave is \"17\"" render "$room" -o "$png" --interleave 17
wrong "--shadow-map is \"0\"" render "$room" -o "$png" --shadow-map 0
wrong "--shadow-map is \"8193\"" render "$room" -o "$png" --shadow-map 8193
wrong "--pcf is \"0\"" render "$room" -o "$png" --pcf 0
wrong "--pcf is \"257\"" render "$room" -o "$png" --pcf 257
wrong "--pcf-offset is \"-1\"" render "$room" -o "$png" --pcf-offset -1
wrong "--bias is \"some\"" render "$room" -o "$png" --bias some
wrong "--bias-slope is \"inf\"" render "$room" -o "$png" --bias-slope inf
wrong "--min-distance is \"-2\"" render "$room" -o "$png" --min-distance -2
wrong "--exposure is \"65\"" render "$room" -o "$png" --exposure 65
wrong "--exposure is \"1e400\"" render "$room" -o "$png" --exposure 1e400
wrong "--exposure is \"nan\", must be a number in [-64, 64] or auto" render "$room" -o "$png" --exposure nan
wrong "--exposure is \"auto\", must be a number in [-64, 64]" bake "$room" -o "$out/never.ply" --exposure auto
wrong "camera is 1, must be in [0, 0]" render "$room" -o "$png" --camera 1
wrong "--camera is \"-1\"" render "$room" -o "$png" --camera -1
for size in 0x10 10x0 10x+9 16385x1 1x16385 10 10x 10y10 10x10x10 x -4x4 1e3x2 99999999999999999999x1; do
    wrong "--size is \"$size\", must be WIDTHxHEIGHT" render "$room" -o "$png" --size $size
done
wrong "|form-factor-sums|residual" render "$room" -o "$png" --show everything
wrong "--show is \"light:\"" render "$room" -o "$png" --show light:
wrong "--show is \"light:K\"" render "$room" -o "$png" --show light:K
wrong "--show is \"light:-1\"" render "$room" -o "$png" --show light:-1
wrong "virtual light 18 does not exist, there are 18 (from 0)" \
    render "$closed" -o "$png" --size 8x8 --shadow-map 16 --method instant-radiosity --show light:18
for option in particles seed reflectivity size bias min-distance w1 budget sampler; do # " 10" is no number
    wrong "--$option is \" 10\", must be" render "$room" -o "$png" --$option=" 10"
done
wrong "--exposure is \" 1\", must be a number in [-64, 64]" render "$room" -o "$png" --exposure=" 1"
wrong "--checkpoint-every is \"	1\", must be a number" render "$room" -o "$png" --checkpoint-every="	1"
wrong "--size is \"10x 9\", must be" render "$room" -o "$png" --size "10x 9"
wrong "--runs is \" 1\", must be a whole number" bench --runs=" 1"
wrong "unknown option --height" render "$room" -o "$png" --height 10 # a part of --size
wrong "no option and no subject \"frob\"" help options frob
wrong "--heat-scale is \"-1\"" compare a.png b.png --heat-scale -1
wrong "--heatmap-of is \"noise\", must be one of difference|relative|ssim|flip" compare a.png b.png --heatmap-of noise
wrong "--ppd is \"0.5\", must be a number in [1, 1000]" compare a.png b.png --ppd 0.5
wrong "--ppd is \"nan\"" compare a.png b.png --ppd nan
for region in 1,2,3 1,2,3,0 1,2,0,3 -1,0,2,2 1,2,3,4,5 1,2,3,x 1x2x3x4 0,0,99999,1 ""; do
    wrong "--region is \"$region\", must be X,Y,WIDTH,HEIGHT" compare a.png b.png --region="$region"
done
for grid in 0x1 1x0 4 4x 4,4 99999x1; do
    wrong "--regions is \"$grid\", must be COLUMNSxROWS" compare a.png b.png --regions $grid
done
wrong "must end in .png, .hdr" compare a.png b.png --heatmap map.gif

succeeds VersionIsPrinted "$vpl" --version
check VersionHasThreeNumbers grep -qxE 'vpl [0-9]+\.[0-9]+\.[0-9]+' "$scratch/stdout"
for command in render lights compare info tradeoff bench; do
    succeeds "HelpOf_$command" "$vpl" help $command
    cp "$scratch/stdout" "$scratch/help"
    check "HelpOf_${command}_NamesItsUsage" grep -q "^vpl $command" "$scratch/help"
    succeeds "OptionHelpOf_$command" "$vpl" $command --help
    check "OptionHelpOf_${command}_IsTheSame" cmp "$scratch/stdout" "$scratch/help"
done
# The help by subject has every option of the table once.
sed -n 's/^    "\([a-z0-9-]*\)", *".*/\1/p; s/^    "\([a-z0-9-]*\)",$/\1/p' include/vpl/options.def | grep -vx -e height -e show-index | sort >"$scratch/table"
succeeds HelpOfOptions "$vpl" help options
sed -n 's/^  --\([a-z0-9-]*\).*/\1/p' "$scratch/stdout" | sort >"$scratch/helped"
check HelpHasEveryOptionOnce cmp "$scratch/table" "$scratch/helped"
check HelpHasManyOptions test "$(wc -l <"$scratch/table")" -ge 60
tr -s " \n" " " <"$scratch/stdout" >"$scratch/flat"
check HelpNamesDefaults grep -q "cube shadow map; default 1024" "$scratch/flat"
check HelpNamesMethods grep -q "ask for; default auto \[path\]" "$scratch/flat"
check HelpNamesPipelines grep -q "default auto \[instant-radiosity, keller, ssvp, radiosity\] \[--pipeline interleaved\]" "$scratch/flat"
equals HelpHasSubjects "$(grep -c '^// ---- ' include/vpl/options.def)" "$(grep -c '^[A-Z]' "$scratch/stdout")"
succeeds HelpOfASubject "$vpl" help options ssvp
equals HelpOfASubjectHasItsOptions "SSVP --clusters" "$(sed -n '2p; 3s/^  \(--[a-z]*\).*/\1/p' "$scratch/stdout" | tr '\n' ' ' | sed 's/ $//')"
succeeds HelpOfAnOption "$vpl" help options --pcf
equals HelpOfAnOptionIsThat "  --pcf S" "$(grep '^  --' "$scratch/stdout")"
for command in render bake lights info tradeoff; do
    "$vpl" help $command | sed '1,/^All options of rendering/d' | grep '^      ' | tr ' ' '\n' | sed -n 's/^--//p' | sort >"$scratch/helped"
    check "HelpOf_${command}_ListsEveryOption" cmp "$scratch/table" "$scratch/helped"
done

# An option that was given and has no effect warns; the picture is made all the same.
# unused TEXT WORDS...
unused() {
    text=$1
    shift
    "$vpl" "$@" -o "$out/u.pfm" >"$scratch/stdout" 2>"$scratch/stderr"
    equals "NoEffect: $text" "0 vpl: warning: $text" "$? $(cat "$scratch/stderr")"
}
tiny="--size 8x8 --shadow-map 8"
unused "--clusters has no effect with --method keller" render "$room" $tiny --clusters 8
unused "--particles has no effect with --method direct" render "$room" $tiny --particles=3 --method direct
unused "--batch has no effect with --pipeline interleaved" render "$room" $tiny --batch 3
unused "--interleave has no effect with --pipeline deferred" render "$room" $tiny --particles 10 --interleave 3 --pipeline deferred
unused "--interleave has no effect with --pipeline lightcuts" render "$room" $tiny --pipeline lightcuts --interleave 3 --interleave 4
unused "--exposure has no effect on $out/u.pfm, which holds linear values" render "$room" $tiny --exposure auto
unused "--tonemap has no effect on $out/u.pfm, which holds linear values" render "$room" $tiny --tonemap=usual
"$vpl" render "$room" $tiny --method direct --bias 0 --bias-slope 0 -o "$out/u.pfm" 2>"$scratch/stderr"
equals NoBiasWarns 1 "$(grep -c "^vpl: warning: --bias 0: surfaces lie in their own shadow" "$scratch/stderr")"
succeeds NoEffectIsQuiet "$vpl" render "$room" $tiny --clusters 8 --quiet -o "$out/u.pfm"
succeeds EffectOfTheUsualPipeline "$vpl" render "$room" --size 8x8 --method ssvp --interleave 2 --rsm-size 32 -o "$out/u.pfm"
succeeds InterleaveIsAPipeline "$vpl" render "$room" $tiny --method keller --particles 9 --interleave 2 -o "$out/u.pfm" --plan-out "$out/u.json"
check InterleaveIsInThePlan grep -q '"pipeline": "interleaved"' "$out/u.json"
rm "$out/u.json"
succeeds DefaultsDoNotWarn "$vpl" render "$room" $tiny -o "$out/u.pfm"
"$vpl" info "$room" --method keller --spp 3 >"$scratch/stdout" 2>"$scratch/stderr"
equals NoEffectInInfo "vpl: warning: --spp has no effect with --method keller" "$(cat "$scratch/stderr")"
rm "$out/u.pfm"
succeeds HelpListsCommands "$vpl" help
check HelpNamesExitCodes grep -q '^Exit codes: 0' "$scratch/stdout"
sed 's/"intensity": *\[[^]]*\]/"intensity": [0, 0, 0]/' "$room" >"$scratch/dark.json"
refuses NoReflectiveMapOfADarkLight 2 "the scene has no light with a reflective map" \
    "$vpl" render "$scratch/dark.json" --method ssvp --show rsm --size 40x30 -o "$scratch/dark.png"
refuses GrowingPassesNeedAnEnd 2 "grow-from needs passes, budget or max-error" \
    "$vpl" render "$room" -o "$out/a.pfm" --method keller --grow-from 4

# ---- shells

wrong "did you mean info?" inf
wrong "one picture without layers" render "$room" -o - --frames 0:2
wrong "only -o writes to standard output" render "$room" -o "$png" --stats -

# ---- standard input and output

small="--method direct --size 16x9"
from_stdin() {
    "$vpl" render "$room" -o "$scratch/by-name.pfm" $small && "$vpl" render - -o "$scratch/by-stdin.pfm" $small <"$room" &&
        cmp "$scratch/by-name.pfm" "$scratch/by-stdin.pfm"
}
to_stdout() {
    for format in png pfm hdr; do
        "$vpl" render "$room" -o "$scratch/by-name.$format" $small &&
            "$vpl" render "$room" -o -.$format $small | cmp - "$scratch/by-name.$format" || return 1
    done
    "$vpl" render "$room" -o - $small | cmp - "$scratch/by-name.png"
}
check SceneComesFromStdin from_stdin
check PictureGoesToStdout to_stdout
refuses FullStdoutIsReported 1 "cannot write to standard output" sh -c '"$0" render "$1" -o - --method direct --size 640x360 >/dev/full' "$vpl" "$room"
