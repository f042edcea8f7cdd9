# SPDX-License-Identifier: MIT
# The report of vpl tradeoff in headless Chromium: no message on the console, and a slider that compares pictures.
# Skipped where there is no Chromium.

browser=$(command -v chromium || command -v chromium-browser || command -v google-chrome || true)

# browse PAGE OPTIONS...: opens a page with an own profile; the console goes to $scratch/console.
browse() {
    page=$1
    shift
    timeout 120 "$browser" --headless --no-sandbox --disable-gpu --hide-scrollbars --user-data-dir="$scratch/chromium" \
        --window-size=800,600 --enable-logging=stderr --v=0 "$@" "file://$page" 2>"$scratch/console"
}

# The lines that scripts and the page itself caused, uncaught exceptions among them.
messages() {
    grep ':CONSOLE' "$scratch/console"
}

# with SCRIPT: the report with one more script at its end, as $scratch/page.html.
with() {
    { cat "$out/b/report.html" && printf '<script>%s</script>\n' "$1"; } >"$scratch/page.html"
}

# attribute NAME: its value in the element #found of the page that was read last.
attribute() {
    grep -o 'id="found"[^>]*' "$scratch/dom" | sed -n "s/.* $1=\"\([^\"]*\)\".*/\1/p"
}

look_at_report() {
    succeeds ReportForTheBrowser "$vpl" tradeoff "$closed" -o "$out/b" --size 32x18 --shadow-map 32 --quiet --seeds 1 \
        --time 20 --reference-spp 64 --sweeps direct,path,auto
    browse "$out/b/report.html" --dump-dom >"$scratch/dom"
    check BrowserReadsTheReport grep -q 'class="stage"' "$scratch/dom"
    equals ReportLogsNothing "" "$(messages)"

    # The test can fail: complaints and exceptions are noticed.
    with 'console.error("complaint"); throw new Error("on purpose");'
    browse "$scratch/page.html" --dump-dom >"$scratch/dom"
    equals BrowserTestNotices 2 "$(messages | grep -cE 'complaint|on purpose')"

    # The divider: at 20 % four fifths of the left picture are cut off; keys end in the same event. Dragging on the
    # picture moves it, too. The choices are all pictures with a name, and a choice changes what is shown.
    with 'var range = document.querySelector("#slider input"), stage = document.querySelector(".stage"),
        under = stage.querySelector("img"), over = stage.querySelector(".over"),
        select = document.querySelectorAll("#slider select"), left = stage.getBoundingClientRect().left,
        found = document.body.appendChild(document.createElement("p")), was = under.src;
        found.id = "found";
        found.setAttribute("before", over.style.clipPath);
        range.value = 20;
        range.dispatchEvent(new Event("input"));
        found.setAttribute("after", over.style.clipPath);
        stage.setPointerCapture = function () {}; // there is no such pointer
        stage.dispatchEvent(new PointerEvent("pointerdown", {buttons: 1, clientX: left + stage.clientWidth / 4}));
        found.setAttribute("dragged", range.value);
        found.setAttribute("all", select[0].options.length === document.querySelectorAll("img[data-name]").length);
        select[1].selectedIndex = 0;
        select[1].dispatchEvent(new Event("change"));
        found.setAttribute("other", under.src !== was && under.src.startsWith("data:image/png"));'
    browse "$scratch/page.html" --dump-dom >"$scratch/dom"
    equals SliderLogsNothing "" "$(messages)"
    equals SliderStartsInTheMiddle "inset(0px 50% 0px 0px)" "$(attribute before)"
    equals SliderMovesTheDivider "inset(0px 80% 0px 0px)" "$(attribute after)"
    equals SliderIsDragged 25 "$(attribute dragged)"
    equals SliderOffersAllPictures true "$(attribute all)"
    equals SliderShowsWhatIsChosen true "$(attribute other)"

    # Pixels: screenshots of the slider alone at its ends differ.
    for end in 0 100; do
        with "var r = document.querySelector('#slider input'), s = document.querySelector('.stage');
            r.value = $end;
            r.dispatchEvent(new Event('input'));
            document.body.replaceChildren(s);"
        browse "$scratch/page.html" --screenshot="$scratch/end$end.png" >"$scratch/dom"
        check "SliderIsDrawnAt_$end" test -s "$scratch/end$end.png"
    done
    check SliderChangesWhatIsShown test "$(cksum <"$scratch/end0.png")" != "$(cksum <"$scratch/end100.png")"
}

if [ -n "$browser" ]; then
    look_at_report
else
    echo "skipped: the report in a browser, because there is no chromium"
fi
rm -rf "$out"
mkdir "$out"
