#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What would it cost to build what the planner leaves out? tests/bench/planner/forced.py BUILD SIZE ERROR SCENE...: renders each
scene by --max-error ERROR, replays its plan with one thing more at a time, and prints a row of a table: how much the picture
changes (rmse over its mean) and the processor time over that of the plan, one thread, median of three runs each."""
import statistics
import sys
import tempfile
from pathlib import Path

from cost import pixels, render

MORE = {'shadow maps': '--light-shadows map', 'every light at every pixel': '--pipeline deferred',
        'lights placed by view': '--placement view', '16 samples at edges': '--antialias 16',
        'short rays': '--compensation rays'}
MORE_OF = {'keller': MORE, 'instant-radiosity': MORE,
           'radiosity': {'a gather': '--gather 16', 'links': '--hierarchy on', 'adaptive patches': '--patch-placement adaptive',
                         'sides without light': '--faint-sides keep'},
           'direct': {'reflected light': '--method keller --particles 1000 --pipeline interleaved --interleave 8'},
           'path': {'16 light vertices': '--light-vertices 16'}}


def option(plan, name):
    """The value of an option in the text of a plan."""
    return plan.split(f'"{name}": "', 1)[1].split('"', 1)[0]


def measure(build, scene, size, plan, out, words):
    times = [render(build, scene, size, f'--plan {plan} {words}', out) for _ in range(3)]
    return (None, None) if None in times else (statistics.median(times), pixels(out))


def main(build, size, error, *scenes):
    for scene in scenes:
        with tempfile.TemporaryDirectory() as folder:
            plan, out = f'{folder}/plan.json', f'{folder}/p.pfm'
            render(build, scene, size, f'--max-error {error} --plan-out {plan}', out)
            text = Path(plan).read_text()
            method = option(text, 'method')
            usual, picture = measure(build, scene, size, plan, out, '')
            mean = sum(picture) / len(picture)
            cells = []
            for name, words in MORE_OF[method].items():
                first, value = words.split()[:2]
                if option(text, first[2:]) == value:
                    continue
                seconds, other = measure(build, scene, size, plan, out, words)
                if seconds is None:
                    cells.append(f'{name} refused')
                    continue
                change = (sum((a - b) ** 2 for a, b in zip(picture, other)) / len(picture)) ** 0.5 / mean
                cells.append(f'{name} {100 * change:.2g} %, {seconds / usual:.2g} times')
            print(f'| {Path(scene).stem} | {method}, {usual:.2f} s | {"; ".join(cells)} |', flush=True)


main(*sys.argv[1:])
