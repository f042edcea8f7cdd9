# SPDX-License-Identifier: MIT
"""Error of Keller's method against its number of particles: error_curve.py SCENE [PICTURE] draws the curve by
matplotlib, or prints the numbers where that is missing. Cells are marked as notebooks of editors do."""
import sys
import time

import numpy

import vpl

# %% the truth
scene = vpl.Scene(sys.argv[1])
size = (160, 90)
truth = scene.render(method="path", spp=256, size=size, seed=1)

# %% the curve: relative root-mean-square error, mean of three seeds
counts = [100, 200, 400, 800, 1600, 3200]
errors, seconds = [], []
for count in counts:
    start = time.process_time()
    squares = [numpy.mean((scene.render(method="keller", particles=count, size=size, seed=seed) - truth) ** 2)
               for seed in (1, 2, 3)]
    seconds.append((time.process_time() - start) / 3)
    errors.append(numpy.sqrt(numpy.mean(squares)) / numpy.mean(truth))
    print("%5d particles: %5.1f %% error, %.2f s" % (count, 100 * errors[-1], seconds[-1]))

# %% the picture
try:
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot
except ImportError:
    sys.exit(0)
pyplot.loglog(seconds, [100 * error for error in errors], "o-")
for count, x, y in zip(counts, seconds, errors):
    pyplot.annotate(str(count), (x, 100 * y), textcoords="offset points", xytext=(4, 4))
pyplot.xlabel("processor time, s")
pyplot.ylabel("error, % of the mean")
pyplot.title("Keller, by number of particles")
pyplot.grid(True, which="both", alpha=0.3)
pyplot.savefig(sys.argv[2] if len(sys.argv) > 2 else "error-curve.png", dpi=120)
