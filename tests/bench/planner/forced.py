#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What would it cost to build what the planner leaves out? tests/bench/planner/forced.py BUILD SIZE ERROR SCENE...: renders each
scene by --max-error ERROR, replays its plan with one thing more at a time, and prints a row of a table: how much the picture
changes (rmse over its mean) and the processor time over that of the plan, one thread, median of three runs each."""
import resource
import statistics
import subprocess
import sys
import tempfile
from array import array
from pathlib import Path

MORE = {'shadow maps': '--light-shadows map', 'every light at every pixel': '--pipeline deferred',
        'lights placed by view': '--placement view', '16 samples at edges': '--antialias 16',
        'short rays': '--compensation rays'}
MORE_OF = {'keller': MORE, 'instant-radiosity': MORE,
           'radiosity': {'a gather': '--gather 16', 'links': '--hierarchy on', 'adaptive patches': '--patch-placement adaptive',
                         'sides without light': '--faint-sides keep'},
           'direct': {'reflected light': '--method keller --particles 1000 --pipeline interleaved --interleave 8'},
           'path': {'16 light vertices': '--light-vertices 16'}}


def pixels(path):
    """The values of a PFM file, whose header has three lines."""
    return array('f', Path(path).read_bytes().split(b'\n', 3)[3])


def render(build, scene, out, words):
    """Processor seconds of a render; None if it is refused."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([f'{build}/vpl', 'render', scene, '-o', out, '--quiet', '--threads', '1', *words],
                          stderr=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return None if done.returncode else after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def option(plan, name):
    """The value of an option in the text of a plan."""
    return plan.split(f'"{name}": "', 1)[1].split('"', 1)[0]


def measure(build, scene, plan, out, words):
    times = [render(build, scene, out, ['--plan', plan, *words]) for _ in range(3)]
    return (None, None) if None in times else (statistics.median(times), pixels(out))


def main(build, size, error, *scenes):
    for scene in scenes:
        with tempfile.TemporaryDirectory() as folder:
            plan, out = f'{folder}/plan.json', f'{folder}/p.pfm'
            render(build, scene, out, ['--size', size, '--max-error', error, '--plan-out', plan])
            text = Path(plan).read_text()
            method = option(text, 'method')
            usual, picture = measure(build, scene, plan, out, [])
            mean = sum(picture) / len(picture)
            cells = []
            for name, words in MORE_OF[method].items():
                words = words.split()
                if option(text, words[0][2:]) == words[1]:
                    continue
                seconds, other = measure(build, scene, plan, out, words)
                if seconds is None:
                    cells.append(f'{name} refused')
                    continue
                change = (sum((a - b) ** 2 for a, b in zip(picture, other)) / len(picture)) ** 0.5 / mean
                cells.append(f'{name} {100 * change:.2g} %, {seconds / usual:.2g} times')
            print(f'| {Path(scene).stem} | {method}, {usual:.2f} s | {"; ".join(cells)} |', flush=True)


main(*sys.argv[1:])
