"""What the scripts beside it share: one thread, processor seconds, our jobs, tables."""

import json
import os
import statistics
import subprocess
import sys
import time
import warnings

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS", "RAYON_NUM_THREADS"):
    os.environ[name] = "1"
# Set on some machines for old OpenBLAS builds; they slow the peers down.
for name in ("OPENBLAS_CORETYPE", "OPENBLAS_L2_SIZE"):
    os.environ.pop(name, None)

import numpy as np  # noqa: E402

warnings.filterwarnings("ignore")
RUNS = 5
# A peer's job that takes longer is run once and not again: its own share of noise is small.
LONG = 10.0


def arguments(doc, jobs):
    """The chosen functions of a script called with HOST-JOBS WORK [JOB]...; all if none is named."""
    if len(sys.argv) < 3 or not set(sys.argv[3:]) <= set(jobs):
        sys.exit(doc)
    return [jobs[name] for name in sys.argv[3:] or jobs]


def ours(job, scale=1.0):
    """Runs one of our jobs: its folder of inputs, and its figures (by part, where a job has several)."""
    folder = os.path.join(sys.argv[2], job)
    os.makedirs(folder, exist_ok=True)
    figures = json.loads(subprocess.check_output([sys.argv[1], job, folder, str(scale)], text=True))
    for part in [figures] if "seconds" in figures else figures.values():
        part["median"] = statistics.median(part["seconds"])
    return folder, figures


def timed(job, runs=RUNS):
    """Median processor seconds of so many runs after one that warms up, and the last result. Of the first run if it is long, or
    if none are asked for."""
    seconds = []
    for _ in range(runs + 1):
        start = time.process_time()
        result = job()
        seconds.append(time.process_time() - start)
        if seconds[0] > LONG:
            break
    return statistics.median(seconds[1:] or seconds), result


def numbers(folder, name, columns=None, kind=np.float64):
    """An input of ours."""
    values = np.fromfile(os.path.join(folder, name), kind)
    return values if columns is None else values.reshape(-1, columns)


def row(*cells):
    print("| " + " | ".join(str(cell) for cell in cells) + " |", flush=True)


def head(title, *cells):
    print(f"\n{title}\n")
    row(*cells)
    row(*["---"] * len(cells))
