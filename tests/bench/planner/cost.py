#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What does the planner cost? tests/bench/planner/cost.py BUILD SIZE GOALS SEEDS SCENE...: renders each scene with 34
settings and by --max-error for each goal ("0.2 0.1") and seed, on one thread, and compares all with two path-traced pictures
whose noise cancels (those of goals.sh; SPP paths per pixel each, default 512). Prints, for each goal, the median of the
processor time over that of the cheapest setting with an error below the goal, and below the error that was reached.
Settings are measured once and kept in BUILD/planner."""
import json
import os
import resource
import statistics
import subprocess
import sys
import tempfile
from array import array
from pathlib import Path

SETTINGS = ['--method direct', '--method direct --antialias 8', '--method radiosity --patches 300',
            '--method radiosity --patches 1000 --antialias 8', '--method radiosity --patches 4000 --antialias 8',
            '--method radiosity --patches 1000 --gather 16 --antialias 8', '--method radiosity --patches 4000 --gather 64 --antialias 8']
SETTINGS += [f'--method {method} --particles {n} --interleave {k} --light-shadows ray --antialias {a}'
             for method in ('keller', 'instant-radiosity') for n, k, a in
             ((60, 8, 1), (250, 8, 1), (250, 8, 8), (1000, 8, 1), (1000, 8, 8), (1000, 4, 8), (4000, 8, 8), (4000, 4, 16), (16000, 4, 16))]
SETTINGS += [f'--method path --spp {n}' for n in (1, 2, 4, 8, 16, 32, 64, 128, 256)]


def pixels(path):
    """The values of a PFM file, whose header has three lines."""
    return array('f', Path(path).read_bytes().split(b'\n', 3)[3])


def render(build, scene, size, words, out):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([f'{build}/vpl', 'render', scene, *words.split(), '--size', size, '-o', out, '--quiet', '--threads', '1'],
                          capture_output=True, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode:
        return None
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


class Scene:
    def __init__(self, build, size, path):
        self.build, self.size, self.path, self.name = build, size, path, Path(path).stem
        kept = Path(build) / 'planner'
        kept.mkdir(exist_ok=True)
        self.kept = kept / f'cost-{self.name}-{size}.json'
        self.halves = []
        for half in (1, 2):
            truth = kept / f'{self.name}-{size}-{half}.pfm'
            if not truth.exists():
                render(build, path, size, f"--method path --spp {os.environ.get('SPP', '512')} --seed {1000 + half}", str(truth))
            self.halves.append(pixels(truth))
        self.mean = sum(self.halves[0]) / len(self.halves[0])

    def measure(self, words):
        """Relative error and seconds of processor time; None if the render failed."""
        with tempfile.TemporaryDirectory() as folder:
            out = f'{folder}/p.pfm'
            seconds = render(self.build, self.path, self.size, words, out)
            if seconds is None or not os.path.exists(out):
                return None
            x = pixels(out)
        a, b = self.halves
        square = sum((p - q) * (p - r) for p, q, r in zip(x, a, b)) / len(x)
        return max(square, 0) ** 0.5 / self.mean, seconds

    def settings(self):
        if self.kept.exists():
            return json.loads(self.kept.read_text())
        measured = {}
        for words in SETTINGS:
            found = self.measure(words + ' --seed 77')
            if found:
                measured[words] = found
        self.kept.write_text(json.dumps(measured))
        return measured


def cheapest(measured, error):
    fits = [(seconds, words) for words, (e, seconds) in measured.items() if e <= error]
    return min(fits) if fits else (float('nan'), 'none')


def main(build, size, goals, seeds, *paths):
    for path in paths:
        scene = Scene(build, size, path)
        measured = scene.settings()
        for goal in map(float, goals.split()):
            runs = [scene.measure(f'--max-error {goal} --seed {seed}') for seed in seeds.split()]
            seconds = statistics.median(s for _, s in runs)
            reached = statistics.median(e for e, _ in runs)
            asked, same = cheapest(measured, goal), cheapest(measured, reached)
            print(f'{scene.name} {goal} error {reached:.4f} largest {max(e for e, _ in runs):.4f} cpu {seconds:.2f} s, '
                  f'over the cheapest {seconds / asked[0]:.2f} ({asked[1]}), of its error {seconds / same[0]:.2f} ({same[1]})',
                  flush=True)


if __name__ == '__main__':
    main(*sys.argv[1:])
