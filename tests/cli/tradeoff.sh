# SPDX-License-Identifier: MIT
# vpl tradeoff: what is refused, what is written, and that figures do not depend on the run.

tiny="--size 16x9 --shadow-map 32 --quiet"
report=$out/t

refuses TradeoffNeedsAFolder 2 "tradeoff needs -o DIR" "$vpl" tradeoff "$closed"
refuses TradeoffNeedsAScene 2 "needs a scene file" "$vpl" tradeoff -o "$report"
refuses TradeoffOfAMissingScene 2 "cannot open: No such file" "$vpl" tradeoff "$out/no.json" -o "$report"
refuses TradeoffHasNoDocumentedTruth 2 "has no truth" "$vpl" tradeoff "$closed" -o "$report" --lighting documented
refuses TradeoffKnowsItsSweeps 2 "--sweeps names \"frontiers\"" "$vpl" tradeoff "$closed" -o "$report" --sweeps path,frontiers
refuses TradeoffHasNoMethod 2 "tradeoff has no option --method" "$vpl" tradeoff "$closed" -o "$report" --method path
refuses TradeoffOfACameraThatIsNone 2 "--camera is 3, the scene has 1" "$vpl" tradeoff "$closed" -o "$report" --camera 3
refuses TradeoffNeedsASeed 2 "--seeds is \"0\"" "$vpl" tradeoff "$closed" -o "$report" --seeds 0
refuses TradeoffInNoTime 1 "the time is too short" "$vpl" tradeoff "$closed" -o "$report" $tiny --time 0
refuses TradeoffWithAMissingReference 2 "cannot open: No such file" \
    "$vpl" tradeoff "$closed" -o "$report" $tiny --reference "$out/none.pfm"
"$vpl" render "$closed" -o "$scratch/other.pfm" --size 15x9 --shadow-map 32
refuses TradeoffWithAReferenceOfAnotherSize 2 "the reference has 15x9 pixels, must have 16x9" \
    "$vpl" tradeoff "$closed" -o "$report" $tiny --reference "$scratch/other.pfm"
"$vpl" render "$closed" -o "$scratch/black.pfm" --size 16x9 --shadow-map 32 --method direct --show indirect
refuses TradeoffWithABlackReference 2 "the reference is black" \
    "$vpl" tradeoff "$closed" -o "$report" $tiny --reference "$scratch/black.pfm"
touch "$out/file"
refuses TradeoffIntoAFile 1 "Not a directory" "$vpl" tradeoff "$closed" -o "$out/file" $tiny
refuses TradeoffIntoAFolderOfNothing 1 "cannot create the folder: No such file" \
    "$vpl" tradeoff "$closed" -o "$out/no/where" $tiny
mkdir -p "$out/taken/report.html"
refuses TradeoffOverAFolder 1 "report.html: cannot write: it is a directory" "$vpl" tradeoff "$closed" -o "$out/taken" $tiny
rm -r "$out/taken" "$out/file"

# A few settings, all of which fit into the time; twice, the second time with the first one's reference.
few="$tiny --seeds 2 --time 100000 --sweeps sampler,min-distance,pipeline,direct --particles 4"
succeeds Tradeoff "$vpl" tradeoff "$closed" -o "$report" $few --reference-spp 16
equals TradeoffFiles "reference-a.pfm reference-b.pfm report.html tradeoff.csv tradeoff.svg " "$(ls -A "$report" | tr '\n' ' ')"
succeeds TradeoffWithReference "$vpl" tradeoff "$closed" -o "$out/u" $few \
    --reference "$report/reference-a.pfm,$report/reference-b.pfm"

# column FILE NAME: the cells below a heading.
column() {
    awk -F, -v name="$2" 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == name) at = i; next } { print $at }' "$1"
}
csv=$report/tradeoff.csv
check TradeoffRowsAreWhole awk -F, 'NR == 1 { n = NF } NF != n || /,,command|nan|inf,/ { exit 1 }' "$csv"
for name in setting family sweeps on_front seed method particles reflectivity sampler min_distance light_shadows \
    shadow_map pcf pipeline spp size camera virtual_lights image_hash error relative_rmse rmse relmse trimmed_relmse \
    ssim flip psnr over_front energy_ratio max_difference cpu_ms total_ms peak_bytes ms_shading command; do
    check "TradeoffHas_$name" test -n "$(column "$csv" $name)"
done
equals TradeoffMeasuresItsSweepsOnly "direct min-distance pipeline sampler" \
    "$(column "$csv" sweeps | tr ' ' '\n' | sort -u | tr '\n' ' ' | sed 's/^ *//;s/ $//')"
equals TradeoffSeeds "1 2" "$(column "$csv" seed | sort -u | tr '\n' ' ' | sed 's/ $//')"
equals TradeoffSamplers "auto halton hammersley random" "$(column "$csv" sampler | sort -u | tr '\n' ' ' | sed 's/ $//')"
for name in setting seed image_hash error rmse relmse energy_ratio virtual_lights command; do
    equals "TradeoffRepeats_$name" "$(column "$csv" $name | cksum)" "$(column "$out/u/tradeoff.csv" $name | cksum)"
done
equals PipelinesMakeOnePicture 1 "$(awk -F, '$5 == 1 && $3 ~ /pipeline/' "$csv" | grep -oE ',[0-9a-f]{16},' | sort -u | wc -l)"
equals PipelinesAreThree 3 "$(awk -F, '$5 == 1 && $3 ~ /pipeline/' "$csv" | wc -l)"

# The command of a row makes the row's picture.
column "$csv" command | while read -r command; do
    hash=$(grep -F ",$command" "$csv" | grep -oE '[0-9a-f]{16}' | head -n 1)
    "$vpl" render "$closed" $command -o "$scratch/again.pfm" --stats "$scratch/again.json" --quiet
    [ "$(field "$scratch/again.json" image_hash)" = "\"$hash\"" ] || echo "$command: $hash"
done >"$scratch/commands"
equals TradeoffCommandsMakeTheirPictures "" "$(cat "$scratch/commands")"

html=$report/report.html
# The plot of the clamp has two panels: errors are percents, energies are ratios.
sed -n '/>error<\/text>/,/>energy: all/p' "$html" >"$scratch/errors"
check ClampHasErrors grep -q 'class="grid".* %</text>' "$scratch/errors"
equals ClampErrorsArePercents 0 "$(grep 'class="grid"' "$scratch/errors" | grep -vc ' %</text>')"
# Below it each distance is told once.
grep -oE 'x="[0-9.]*" y="[0-9]*" text-anchor="middle">[0-9.e-]* m[ <]' "$html" | cut -d'"' -f2 >"$scratch/distances"
check ClampHasDistances test "$(wc -l <"$scratch/distances")" -ge 3
equals ClampTellsEachDistanceOnce "" "$(sort "$scratch/distances" | uniq -d)"
check ReportAnswersTheQuestion grep -qE '5 % error (costs|was not reached|cannot be judged)' "$html"
for limit in 20 10 5 2 1; do
    check "ReportHasARowFor_$limit" grep -q "<th>$limit %</th>" "$html"
done
check PlotHasTheBase grep -q "<title>the base: " "$report/tradeoff.svg"
check ReportHasPictures grep -q 'src="data:image/png;base64,iVBORw0KGgo' "$html"
check ReportNeedsNoOtherFile test -z "$(grep -oE '(src|href)="[^"]*' "$html" | grep -v '^src="data:image/png;base64,')"
check ReportNeedsNoNetwork test -z "$(grep -oE '<script [^>]*|<link|@import|url\(|fetch\(|XMLHttp|https?://[^"]*' "$html" | grep -v 'http://www.w3.org/2000/svg')"
check ReportHasNoNans test -z "$(sed 's/base64,[^"]*//g' "$html" | grep -owE 'nan|inf|-nan')"
if command -v xmllint >/dev/null 2>&1; then
    check PlotIsXml xmllint --noout "$report/tradeoff.svg"
else
    check PlotIsSvg grep -q '</svg>' "$report/tradeoff.svg"
fi

# Legends: every point of the plot lies below the last row of the legend, and within the axes.
check LegendIsBesideThePlot awk '
    match($0, /class="axis" d="M72 [0-9.]+/) { top = substr($0, RSTART + 20, RLENGTH - 20) + 0 }
    /^<path class="f[0-9]" transform/ { # rows of the legend begin with a marker
        n = split($0, rows, "translate\\([0-9.]+ ")
        for (i = 2; i <= n; i++) if (rows[i] + 0 > legend) legend = rows[i] + 0
    }
    /^<g><title>/ { split($0, parts, "translate\\([0-9.]+ "); points++; if (least == 0 || parts[2] + 0 < least) least = parts[2] + 0 }
    END { exit !(top > 0 && points > 3 && legend > 0 && legend + 12 < top && least >= top) }' "$report/tradeoff.svg"

# The planner: what was asked is in the command, and judged by the others; it is not judged by itself. The times are
# over those of the cheapest setting with as little error.
succeeds TradeoffOfThePlanner "$vpl" tradeoff "$closed" -o "$out/a" --size 32x18 --seeds 1 --time 40 --quiet \
    --sweeps auto,direct,path --reference-spp 64
auto=$out/a/tradeoff.csv
for asked in "--max-error 0.2" "--max-error 0.05" "--budget 200" "--budget 1000"; do
    check "PlannerWasAsked_${asked#--}" grep -q -- ",--method auto .*$asked\$" "$auto"
done
check PlannerIsNotOnTheFront test -z "$(grep -E '^[0-9]+,the planner.*' "$auto" | awk -F, '$4 != 0')"
check PlannerLeavesOutTheBase test -z "$(grep -E -- ',--method auto .*(--particles|--reflectivity|--pcf|--shadow-map)' "$auto")"
check PlannerHasATable grep -q 'what was asked, and what it reached' "$out/a/report.html"
check PlannerSaysThatBudgetsDiffer grep -q 'has other bits on a faster or slower machine' "$out/a/report.html"
check PlannerIsInThePlot grep -q 'class="asked".*20.0 %' "$out/a/tradeoff.svg"
check TheFrontIsOverItselfOnce awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == "over_front") at = i; next }
    $4 == 1 && $at != 1 { exit 1 }' "$auto"

# The best within a time: never worse within a longer one.
check BestWithinATimeImproves awk '/Best within a time/ { on = 1 } /The dearest setting/ { on = 0 }
    on && match($0, /<tr><th>[0-9.]+ s<.th><td class="n"><strong>(&le; )?[0-9.]+ %/) {
        split(substr($0, RSTART, RLENGTH), parts, "<strong>"); sub(/&le; /, "", parts[2]); rows++
        if (rows > 1 && parts[2] + 0 > last) exit 1
        last = parts[2] + 0 } END { exit rows == 0 }' "$out/a/report.html"

# Placement is swept for Keller's method, among the points and as a knob.
succeeds TradeoffOfPlacement "$vpl" tradeoff "$closed" -o "$out/l" $tiny --seeds 1 --time 60 --sweeps placement \
    --reference-spp 16
for place in rsm view; do
    check "KellerIsPlacedBy_$place" grep -q -- "--method keller .*--placement $place" "$out/l/tradeoff.csv"
done

# Too little time: the base and the cheap ones are there, and what was left out adds up by its reasons.
succeeds TradeoffInLittleTime "$vpl" tradeoff "$closed" -o "$out/s" --size 160x90 --quiet --seeds 1 --time 6
sed -n 's/.*<li>\([0-9]*\) settings measured, \([0-9]*\) left out in the time of 6 s: \(.*\)\.<.li>.*/\1 \2 \3/p' \
    "$out/s/report.html" >"$scratch/left"
check LeftOutAddsUp awk -v csv="$(column "$out/s/tradeoff.csv" setting | sort -u | wc -l)" '
    { measured = $1; all = $2; $1 = $2 = ""; n = split($0, parts, "; ")
      for (i = 1; i <= n; i++) sum += parts[i] } END { exit !(NR == 1 && all > 0 && sum == all && measured == csv) }' "$scratch/left"
check LittleTimeSeesManyKinds test "$(awk -F, 'NR > 1 { print $2 }' "$out/s/tradeoff.csv" | sort -u | wc -l)" -ge 5

# Paths judged by other paths: sixteen a pixel (row 6, after the base, 1, 2, 4 and 8) have less than half the error
# of one.
succeeds TradeoffOfPaths "$vpl" tradeoff "$closed" -o "$out/p" $tiny --seeds 1 --time 5 --sweeps path --reference-spp 64
check PathsHaveTheirStage test -n "$(column "$out/p/tradeoff.csv" ms_paths)"
check SixteenPathsBeatOne awk -v one="$(column "$out/p/tradeoff.csv" error | sed -n 2p)" \
    -v sixteen="$(column "$out/p/tradeoff.csv" error | sed -n 6p)" 'BEGIN { exit !(sixteen > 0 && sixteen < one / 2) }'

# Interrupted: what was measured is there and whole, and the exit code says so. The time is far too long otherwise.
if command -v timeout >/dev/null 2>&1; then
    timeout --preserve-status -s INT -k 60 3 "$vpl" tradeoff "$closed" -o "$out/i" $tiny --time 100000 \
        --reference "$report/reference-a.pfm" 2>"$scratch/stderr"
    equals TradeoffInterrupted "1 vpl: interrupted; what had been measured is in $out/i/report.html" "$? $(cat "$scratch/stderr")"
    check InterruptedReportIsWhole grep -q '</html>' "$out/i/report.html"
    check InterruptedReportSaysSo grep -q 'Interrupted: only what was measured' "$out/i/report.html"
fi
rm -rf "$out"
mkdir "$out"
