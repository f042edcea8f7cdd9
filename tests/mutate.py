#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Mutation tests: changes one operator, constant or bound of src at a time and looks whether the tests notice.

tests/mutate.py [COUNT [FIRST [SEED]]]: default 200 0 1. Judges COUNT mutations, from number FIRST on. A number and a seed
mean the same mutation of the same sources. src/cli/bench, which measures, is left out. A mutation is killed if a test
fails, crashes or takes 10 s longer than in the first build, which is about three times as slow. Mutations that do not
compile, or compile to the same code, are skipped and not counted: all of src/mpi, src/windows and src/image/exr*.c, too.

Works on a clone of HEAD in build/mutants. A first build counts which lines every suite runs; this takes half an hour, and
build/mutants.json keeps it until src changes. A mutation is judged by the suites that run its line only, the likeliest and
fastest first. Suites are: the quick tests of each tests/test_*.c, failing allocations, wrong arguments, golden pictures,
the parts of tests/cli and the corpora of the fuzzers. Where no quick test notices, slow ones near the file follow.
SUITES="obj gltf" in the environment runs the named suites, slow tests too, instead of those that the first build found.
WITHIN=60 ends with CANDIDATE after suites that took so many seconds in the first build: the rest is not tried.
"""
import itertools, json, os, random, re, subprocess, sys, time
from pathlib import Path

COUNT, FIRST, SEED = [int(word) for word in sys.argv[1:]] + [200, 0, 1][len(sys.argv) - 1:]
ROOT = Path(__file__).resolve().parent.parent
TREE, MAP = ROOT / 'build/mutants', ROOT / 'build/mutants.json'
MAKE = ['make', '-j1', '--no-print-directory', 'EXR=0']
SWAPS = {'<': '<=', '<=': '<', '>': '>=', '>=': '>', '==': '!=', '!=': '==', '+': '-', '-': '+', '*': '/', '/': '*', '&&': '||',
         '||': '&&', '+=': '-=', '-=': '+=', 'true': 'false', 'false': 'true', 'fminf': 'fmaxf', 'fmaxf': 'fminf',
         'vplMin': 'vplMax', 'vplMax': 'vplMin'}
TOKEN = re.compile(r'(?<= )(?:[<>=!]=|[<>+*/-]|&&|\|\||[+-]=)(?= )|\b(?:true|false|fminf|fmaxf|vplMin|vplMax)\b'
                   r'|(?<![\w.])\d+(?:\.\d+)?f?(?![\w.])')
ENVIRONMENT = dict(os.environ, OMP_WAIT_POLICY='passive', CMOCKA_TEST_ABORT='1')
FAILURES = ['FailedAlloc', 'EveryFailed', 'AtAnyByte'] # tests that fail every allocation or byte in turn


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
            found = [(str(path.relative_to(TREE)), number, m.start(), m.group(), SWAPS.get(m.group(), f'({m.group()} + 1)'))
                     for m in TOKEN.finditer(code)]
            lines += [found] if found else []
    return lines


def all_jobs(build):
    """The commands that test everything but slow tests: {name: [program, argument...]}."""
    jobs = {path.stem[5:]: [f'{build}/vpl-tests', '--quick', path.stem[5:], *('-' + word for word in FAILURES)]
            for path in sorted((TREE / 'tests').glob('test_*.c'))}
    jobs |= {word: [f'{build}/vpl-tests', '--quick', word] for word in FAILURES}
    jobs['nulls'] = [f'{build}/nulls']
    jobs['golden'] = [f'{build}/vpl-golden', 'check', 'golden', f'{build}/golden']
    parts = re.search(r'\$\{\*:-(.*?)\}', (TREE / 'tests/cli/run.sh').read_text())[1].split()
    jobs |= {f'cli/{part}': ['tests/cli/run.sh', f'{build}/vpl', part] for part in parts}
    return jobs | {f'corpus/{path.name}': [f'{build}/fuzz/{path.name}_replay', f'tests/fuzz/corpus/{path.name}']
                   for path in (TREE / 'tests/fuzz/corpus').iterdir()}


def program(command):
    return command[1] if command[0].endswith('.sh') else command[0]


def make(flags, *targets):
    return subprocess.run([*MAKE, f'CFLAGS={flags}', *targets], cwd=TREE, capture_output=True).returncode == 0


def run(command, seconds):
    """What went wrong, '' if nothing did. Children of scripts are ended with it."""
    process = subprocess.Popen(command, cwd=TREE, env=ENVIRONMENT, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                               stderr=subprocess.DEVNULL, start_new_session=True)
    try:
        return '' if process.wait(seconds) == 0 else 'failed'
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, 9)
        process.wait()
        return 'too slow'


def objects(folder, path):
    """The objects of a source file; kernels have one for each instruction set."""
    return sorted((TREE / folder / Path(path).parent).glob(Path(path).stem + '.*o'))


def lines_run(files, runs):
    """Adds the lines that the counts of the last run name to runs, {file: {line: whether it ran}}; forgets the counts."""
    counts = [str(path) for file in files for path in (TREE / 'build/cover/obj' / file).parent.glob(Path(file).stem + '.*gcda')]
    text = subprocess.run(['gcov', '-t', *counts], cwd=TREE, capture_output=True, text=True).stdout if counts else ''
    file = ''
    for line in text.split('\n'):
        count, number, rest = (line.split(':', 2) + ['', ''])[:3]
        if number.strip() == '0':
            file = rest[7:] if rest.startswith('Source:') else file
        elif file in files and number.strip().isdigit() and count.strip() != '-':
            known = runs.setdefault(file, {})
            known[int(number)] = known.get(int(number), False) or count.strip()[0] not in '#='
    for path in (TREE / 'build/cover').rglob('*.gcda'):
        path.unlink()


def measure(files, source):
    """Runs everything once: {name: [seconds, {file: {line: whether it ran}}]}, from MAP if it fits the sources."""
    kept = json.loads(MAP.read_text()) if MAP.exists() else {}
    if kept.get('source') == source and set(files) <= set(kept['files']):
        return kept['suites']
    subprocess.run('rm -rf build/cover; mkdir build/cover; cp -a build/obj build/cover', shell=True, cwd=TREE, check=True)
    for path in [path for file in files for path in objects('build/cover/obj', file)]:
        path.unlink()
    jobs, result = all_jobs('build/cover'), {}
    assert make('-O1 --coverage', 'BUILD=build/cover', *{program(command) for command in jobs.values()})
    for name, command in jobs.items():
        start, runs = time.time(), {}
        wrong = run(command, 1000)
        seconds = time.time() - start
        lines_run(files, runs)
        wrong = wrong and run(all_jobs('build')[name], 1000) # counts that cannot be written are an error on stderr
        print(f'{name}: {seconds:.1f} s', wrong and f'{wrong} without a mutation: left out', flush=True)
        if not wrong:
            result[name] = [seconds, {file: {str(line): ran for line, ran in lines.items()} for file, lines in runs.items()}]
    MAP.write_text(json.dumps({'source': source, 'files': files, 'suites': result}))
    return result


def runs_line(runs, text, number):
    """Whether a suite ran a line. For one without code, the nearest lines of its function count; for tables, the file."""
    start = max((n for n in range(number + 1) if text[n].startswith(('{', '}'))), default=0)
    end = min((n for n in range(number, len(text)) if text[n].startswith('}')), default=number)
    if not text[start].startswith('{'):
        return any(runs.values())
    above = next((n for n in range(number, start, -1) if str(n + 1) in runs), number)
    below = next((n for n in range(number, end + 1) if str(n + 1) in runs), number)
    return runs.get(str(above + 1), False) or runs.get(str(below + 1), False)


def near(path, jobs):
    """Suites that include the header of the file, or whose name shares a word with it."""
    stem = re.sub(r'_kernel$', '', Path(path).stem)
    words = {word.rstrip('s') for word in stem.split('_') if len(word) > 2} | {Path(path).parent.name.rstrip('s')}
    header = f'{Path(path).parent.name}/{stem}.h'
    return {name for name in jobs if words & {word.rstrip('s') for word in re.split('[_/]', name)} or
            (TREE / f'tests/test_{name}.c').exists() and header in (TREE / f'tests/test_{name}.c').read_text()}


def judge(path, number, text, measured):
    """The verdict on the mutation that the tree has now, and how many suites were run."""
    jobs, likely = all_jobs('build'), near(path, measured)
    names = [name for name, (_, runs) in measured.items() if runs_line(runs.get(path, {}), text, number)]
    names.sort(key=lambda name: measured[name][0] * (0.05 if name == 'golden' or name in likely else 1))
    runs = [(name, jobs[name], measured[name][0]) for name in names]
    runs += [(f'{name}, slow', [word for word in jobs[name] if word[0] != '-'], 120) for name in names if name in likely and
             f'tests/test_{name}.c' in SLOW]
    if 'SUITES' in os.environ:
        runs = [(name, [word for word in jobs[name] if word[0] != '-'], 60) for name in os.environ['SUITES'].split()]
    built, left, all_runs = set(), float(os.environ.get('WITHIN', 'inf')), len(runs)
    runs = [r for r, spent in zip(runs, itertools.accumulate(r[2] for r in runs)) if spent <= left or r == runs[0]]
    for count, (name, command, seconds) in enumerate(runs):
        if program(command) not in built and not make('', program(command)):
            return 'not built', 0
        built.add(program(command))
        wrong = run(command, seconds + 10)
        if wrong:
            return f'killed by {name}' + (' (too slow)' if wrong == 'too slow' else ''), count + 1
    return 'CANDIDATE' if len(runs) < all_runs else 'SURVIVED' if runs else 'SURVIVED, no suite runs it', len(runs)


def main():
    global SLOW
    if not TREE.exists():
        subprocess.run(['git', 'clone', '-q', ROOT, TREE], check=True)
    subprocess.run('git fetch -q origin HEAD && git reset -q --hard FETCH_HEAD', shell=True, cwd=TREE, check=True)
    SLOW = subprocess.run(['git', 'grep', '-l', 'SLOW)', 'tests/'], cwd=TREE, capture_output=True, text=True).stdout.split()
    assert make('', *{program(command) for command in all_jobs('build').values()})
    dice = random.Random(SEED)
    mutations = [dice.choice(found) for found in sites()]
    dice.shuffle(mutations)
    mutations = [m for m in list(enumerate(mutations))[FIRST:] if not m[1][0].startswith('src/cli/bench/')]
    source = subprocess.check_output(['git', 'rev-parse', 'HEAD:src'], cwd=TREE, text=True).strip()
    measured = measure(sorted({m[1][0] for m in mutations[:2 * COUNT]}), source)
    killed = counted = 0
    for number, (path, line, column, old, new) in mutations:
        start, file, text = time.time(), TREE / path, (TREE / path).read_text()
        before = {name: name.read_bytes() for name in objects('build/obj', path)}
        lines = text.split('\n')
        code = lines[line][:column] + new + lines[line][column + len(old):]
        file.write_text('\n'.join(lines[:line] + [code] + lines[line + 1:]))
        verdict, count = 'not built', 0
        if before and make('', *(str(name.relative_to(TREE)) for name in before)):
            same = all(name.read_bytes() == bits for name, bits in before.items())
            verdict, count = ('same code', 0) if same else judge(path, line, lines, measured)
        file.write_text(text)
        for name, bits in before.items():
            name.write_bytes(bits)
        print(f'{number} {path}:{line + 1}: {old} -> {new}: {verdict} ({count} suites, {time.time() - start:.0f} s): {code.strip()}',
              flush=True)
        killed += verdict.startswith('killed')
        counted += verdict not in ('not built', 'same code')
        if counted == COUNT:
            break
    print(f'{killed} of {counted} killed')


main()
