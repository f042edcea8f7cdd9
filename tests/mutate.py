#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Mutation tests: changes one operator, constant or bound of src at a time and looks whether the tests notice.

tests/mutate.py [COUNT [FIRST [SEED]]]: default 200 0 1. Mutations are numbered from FIRST; a number and a seed always mean the
same mutation of the same sources. Works on a copy of HEAD in build/mutants/FIRST, so two runs may go on at once. Prints a line
for each mutation. Those that do not compile, or compile to the same code, are skipped and not counted. A mutation is killed
if a test fails, crashes or takes more than three times its time. The likeliest and fastest suites run first; golden
pictures follow, then all other quick suites, the command line and the replayed corpora. Slow tests and those of failing allocations are
left out, so that a survivor may still be found by the whole `make test`: SLOW=1 runs them as well. FAST=1 runs only the
likeliest suites and the golden pictures, each for a minute at most, to find candidates that are judged afterwards.
"""
import os, random, re, subprocess, sys, time
from pathlib import Path

COUNT, FIRST, SEED = [int(word) for word in sys.argv[1:]] + [200, 0, 1][len(sys.argv) - 1:]
ROOT = Path(__file__).resolve().parent.parent
TREE = ROOT / 'build/mutants' / str(FIRST)
MAKE = ['make', '-j1', '--no-print-directory', 'EXR=0', 'CFLAGS=-O1']
PROGRAMS = ['build/vpl', 'build/vpl-tests', 'build/vpl-golden']
SWAPS = {'<': '<=', '<=': '<', '>': '>=', '>=': '>', '==': '!=', '!=': '==', '+': '-', '-': '+', '*': '/', '/': '*', '&&': '||',
         '||': '&&', '+=': '-=', '-=': '+=', 'true': 'false', 'false': 'true', 'fminf': 'fmaxf', 'fmaxf': 'fminf',
         'vplMin': 'vplMax', 'vplMax': 'vplMin'}
TOKEN = re.compile(r'(?<= )(?:[<>=!]=|[<>+*/-]|&&|\|\||[+-]=)(?= )|\b(?:true|false|fminf|fmaxf|vplMin|vplMax)\b'
                   r'|(?<![\w.])\d+(?:\.\d+)?f?(?![\w.])')
ENVIRONMENT = dict(os.environ, OMP_WAIT_POLICY='passive', CMOCKA_TEST_ABORT='1')


def sites():
    """All mutations of lines of code: lists of (file, line number, column, old, new), one list for each line."""
    lines = []
    for path in sorted((TREE / 'src').rglob('*.c')):
        comment = False
        for number, line in enumerate(path.read_text().split('\n')):
            comment = (comment or line.lstrip().startswith('/*')) and '*/' not in line
            code = re.sub(r'"(?:[^"\\]|\\.)*"', lambda text: '"' + ' ' * (len(text.group()) - 2) + '"', line).split('//')[0]
            if comment or not re.match(r'    |enum|static const (?!char)|#define \w+ ', code):
                continue
            found = [(path.relative_to(TREE), number, m.start(), m.group(), SWAPS.get(m.group(), f'({m.group()} + 1)'))
                     for m in TOKEN.finditer(code)]
            lines += [found] if found else []
    return lines


def run(command, seconds):
    """True if the command succeeds in time. Children of scripts are ended with it."""
    process = subprocess.Popen(command, cwd=TREE, env=ENVIRONMENT, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                               stderr=subprocess.DEVNULL, start_new_session=True)
    try:
        return process.wait(seconds) == 0
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, 9)
        process.wait()
        return False


def measure():
    """The commands that test everything, each with its time: {name: (command, seconds)}."""
    slow = [] if os.environ.get('SLOW') else ['--quick', '-FailedAlloc', '-EveryFailed', '-AtAnyByte']
    fast = os.environ.get('FAST')
    names = sorted(path.stem[5:] for path in (TREE / 'tests').glob('test_*.c'))
    jobs = {name: ['build/vpl-tests', name, *slow] for name in names}
    jobs['golden'] = ['build/vpl-golden', 'check', 'golden', 'build/golden']
    jobs['program'] = ['tests/cli/run.sh', 'build/vpl']
    for name, command in list(jobs.items()):
        if fast:
            jobs[name] = (command, 19)
            continue
        start = time.time()
        good = run(command, 1000)
        jobs[name] = (command, time.time() - start)
        if not good:
            print(f'{name} fails without a mutation, and is left out', flush=True)
            del jobs[name]
    return jobs


def likely(path, jobs):
    """Suites that include the header of the file, or whose name shares a word with it."""
    stem = re.sub(r'_kernel$', '', path.stem)
    words = {word.rstrip('s') for word in re.split('_', stem) if len(word) > 2} | {path.parent.name.rstrip('s')}
    header = f'{path.parent.name}/{stem}.h'
    return {name for name in jobs if words & {word.rstrip('s') for word in name.split('_')} or
            (TREE / f'tests/test_{name}.c').exists() and header in (TREE / f'tests/test_{name}.c').read_text()}


def objects(path):
    return {path.with_suffix('').name + end for end in ('.o', '.scalar.o', '.sse2.o', '.avx2.o', '.avx512.o')}


def code_of(path):
    folder = TREE / 'build/obj' / path.parent
    return {name: (folder / name).read_bytes() for name in objects(path) if (folder / name).exists()}


def judge(path, before, jobs):
    if subprocess.run([*MAKE, *PROGRAMS], cwd=TREE, capture_output=True).returncode:
        return 'not built'
    if code_of(path) == before:
        return 'same code'
    first = likely(path, jobs)
    fast = os.environ.get('FAST')
    for name in sorted((name for name in jobs if not fast or name in first or name == 'golden'),
                       key=lambda name: (name == 'program', name not in first, jobs[name][1])):
        command, seconds = jobs[name]
        if not run(command, 3 * seconds + 3):
            return f'killed by {name}'
    return 'SURVIVED'


def main():
    TREE.mkdir(parents=True, exist_ok=True)
    subprocess.run(f'git archive HEAD | tar -x -C {TREE}', shell=True, cwd=ROOT, check=True)
    subprocess.run([*MAKE, *PROGRAMS], cwd=TREE, check=True, stdout=subprocess.DEVNULL)
    jobs = measure()
    dice = random.Random(SEED)
    mutations = [dice.choice(found) for found in sites()]
    dice.shuffle(mutations)
    killed = counted = 0
    originals = {}
    for number, (path, line, column, old, new) in enumerate(mutations[FIRST:], FIRST):
        file = TREE / path
        before = originals.setdefault(path, code_of(path))
        text = file.read_text()
        lines = text.split('\n')
        code = lines[line] = lines[line][:column] + new + lines[line][column + len(old):]
        file.write_text('\n'.join(lines))
        verdict = judge(path, before, jobs)
        file.write_text(text)
        print(f'{number} {path}:{line + 1}: {old} -> {new}: {verdict}: {code.strip()}', flush=True)
        killed += verdict.startswith('killed')
        counted += verdict not in ('not built', 'same code')
        if counted == COUNT:
            break
    print(f'{killed} of {counted} killed')


main()
