"""Training jobs beside what a user would take today, on the same inputs in one run; one thread, processor seconds.

    ./ci.sh bench-peers            makes the virtual environment and runs this
    python benches/peers/host.py target/release/host-jobs WORK [align|identify|autoencoder|growth]...

Each figure is the median of five runs after one that warms up (the peers' just-in-time compilers included).
"""

from measure import arguments, head, numbers, ours, row, timed  # first: it sets the number of threads

import numba
import numpy as np
from scipy.linalg import solveh_banded
from scipy.spatial.distance import cdist

# Motion warping: dynamic time warping compiled by numba over distances by scipy, the space warp by scipy's banded solver.


@numba.njit(cache=False)
def warp_path(distance):
    n, m = distance.shape
    cost = np.full((n + 1, m + 1), np.inf)
    back = np.zeros((n + 1, m + 1), np.uint8)
    cost[0, 0] = 0.0
    for i in range(n):
        for j in range(m):
            best, way = cost[i, j], 0
            if cost[i, j + 1] < best:
                best, way = cost[i, j + 1], 1
            if cost[i + 1, j] < best:
                best, way = cost[i + 1, j], 2
            cost[i + 1, j + 1] = best + distance[i, j]
            back[i + 1, j + 1] = way
    i, j = n, m
    path = np.empty((n + m, 2), np.int64)
    length = 0
    while i > 0 and j > 0:
        path[length, 0], path[length, 1] = i - 1, j - 1
        length += 1
        way = back[i, j]
        if way == 0:
            i, j = i - 1, j - 1
        elif way == 1:
            i -= 1
        else:
            j -= 1
    return path[:length][::-1]


def smoothness(frames, first, second, ridge):
    """Diagonals 0, 1, 2 of `ridge + first D1'D1 + second D2'D2`."""
    d = np.zeros((3, frames))
    d[0] += ridge
    d[0, 1:] += first
    d[0, :-1] += first
    d[1, :-1] -= first
    d[0, :-2] += second
    d[0, 1:-1] += 4 * second
    d[0, 2:] += second
    d[1, :-2] -= 2 * second
    d[1, 1:-1] -= 2 * second
    d[2, :-2] += second
    return d


def motion_warping(u, v, figures):
    u = (u - u.mean(0)) / u.std(0)
    v = (v - v.mean(0)) / v.std(0)
    n, channels = u.shape
    scale = smoothness(n, *figures["scale"], figures["ridge"])
    offset = smoothness(n, *figures["offset"], figures["ridge"])
    a, b = np.ones_like(u), np.zeros_like(u)
    # Unknowns interleaved: a[0], b[0], a[1], ...; lower form, five diagonals below the main one.
    penalty = np.zeros((5, 2 * n))
    for k in range(3):
        penalty[2 * k, 0::2], penalty[2 * k, 1::2] = scale[k], offset[k]
    for _ in range(figures["iterations"]):
        path = warp_path(cdist(a * u + b, v, "sqeuclidean"))
        count = np.bincount(path[:, 0], minlength=n).astype(float)
        wanted = np.zeros_like(u)
        np.add.at(wanted, path[:, 0], v[path[:, 1]])
        for c in range(channels):
            x = u[:, c]
            system = penalty.copy()
            system[0, 0::2] += count * x * x
            system[0, 1::2] += count
            system[1, 0::2] += count * x
            right = np.empty(2 * n)
            right[0::2] = x * (wanted[:, c] - count * x)
            right[1::2] = wanted[:, c] - count * x
            change = solveh_banded(system, right, lower=True)
            a[:, c], b[:, c] = 1 + change[0::2], change[1::2]
    return a, b, path


def align():
    head("Motion warping, 60 channels, 10 iterations", "frames", "kinesic, s", "SciPy + numba, s", "ratio",
         "kinesic, MiB", "energy / full search's")
    for scale in (1.0, 6000 / 1400):
        folder, figures = ours("align", scale)
        u, v = (numbers(folder, f"{x}.f64", figures["channels"]) for x in "uv")
        seconds, _ = timed(lambda: motion_warping(u, v, figures))
        row(figures["frames"], f"{figures['median']:.3f}", f"{seconds:.2f}", f"{seconds / figures['median']:.1f}",
            f"{figures['peak_mib']:.0f}", f"{figures['energy'] / figures['full_search_energy']:.5f}")


# Identification.


def fit(y, found, settle):
    """100 (1 - |y - found| / |y - mean|), %, mean over the outputs; minus infinity for what grows beyond all bounds."""
    y, found = y[settle:], found[settle:]
    with np.errstate(all="ignore"):
        shares = 100 * (1 - np.linalg.norm(y - found, axis=0) / np.linalg.norm(y - y.mean(0), axis=0))
    return float(np.mean(shares)) if np.isfinite(shares).all() else -np.inf


def simulate(A, B, C, D, u):
    x, out = np.zeros(len(A)), np.empty((len(u), C.shape[0]))
    with np.errstate(all="ignore"):
        for t, value in enumerate(u):
            out[t] = C @ x + D @ value
            x = A @ x + B @ value
    return out


def sippy(u, y, order):
    import sippy_unipi
    # It asks for horizons above the order.
    model = sippy_unipi.system_identification(y.T, u.T, "N4SID", SS_fixed_order=order, SS_f=order + 1, SS_p=order + 1,
                                              SS_D_required=True)
    return model.A, model.B, model.C, model.D


def nfoursid(u, y, order):
    import pandas
    from nfoursid.nfoursid import NFourSID
    names = [f"u{k}" for k in range(3)], [f"y{k}" for k in range(3)]
    frame = pandas.DataFrame(np.hstack([u, y]), columns=names[0] + names[1])
    found = NFourSID(frame, output_columns=names[1], input_columns=names[0], num_block_rows=order // 3 + 2)
    found.subspace_identification()
    model, _ = found.system_identification(rank=order)
    return model.a, model.b, model.c, model.d


def judged(folder, figures, method):
    """Seconds, fit on unseen frames (none if it diverges), and spectral radius of a peer's model."""
    u, y = (numbers(folder, f"{x}.f64", 3) for x in "uy")
    frames = figures["frames"]
    seconds, model = timed(lambda: method(u[:frames], y[:frames], figures["order"]))
    return seconds, fit(y[frames:], simulate(*model, u[frames:]), figures["settle"]), np.abs(np.linalg.eigvals(model[0])).max()


PEERS = (("SIPPY N4SID", sippy), ("nfoursid", nfoursid))


def identify():
    head("Identification, order 40, 3 inputs, 3 outputs: a made system", "method", "s", "kinesic is faster", "fit, %",
         "spectral radius")
    folder, figures = ours("identify")
    row(f"kinesic, {figures['frames']} frames", f"{figures['median']:.4f}", "", f"{figures['fit']:.2f}", f"{figures['radius']:.3f}")
    for name, method in PEERS:
        seconds, quality, radius = judged(folder, figures, method)
        row(name, f"{seconds:.3f}", f"{seconds / figures['median']:.0f} times", f"{quality:.2f}", f"{radius:.3f}")

    folder, pairs = ours("identify-real")
    head("Recorded pairs: fit, %", "method", *(f"{style}, {p['frames']}" for style, p in pairs.items()), "median", "unstable",
         "s, median", "kinesic is faster")
    least = np.median([p["median"] for p in pairs.values()])

    def show(name, found, faster):
        seconds, fits, radii = np.array(found).T
        row(name, *(f"{f:.1f}" if f > -100 else "diverges" for f in fits), f"{np.median(fits):.1f}", int((radii >= 1).sum()),
            f"{np.median(seconds):.4f}", f"{np.median(seconds) / least:.1f} times" if faster else "")

    show("kinesic", [(p["median"], p["fit"], p["radius"]) for p in pairs.values()], False)
    for name, method in PEERS:
        show(name, [judged(f"{folder}/{style}", p, method) for style, p in pairs.items()], True)


# Autoencoder.


def autoencoder():
    import torch
    torch.set_num_threads(1)
    folder, figures = ours("autoencoder")
    width, hidden, batch = figures["width"], figures["hidden"], figures["batch"]
    data, test = (torch.from_numpy(numbers(folder, f"{x}.f32", width, np.float32)) for x in ("data", "test"))
    start = [numbers(folder, f"start-{k}.f32", kind=np.float32) for k in range(4)]
    shapes = [(hidden, width), (hidden,), (width, hidden), (width,)]

    def epoch():
        torch.manual_seed(4)
        net = torch.nn.Sequential(torch.nn.Linear(width, hidden), torch.nn.Tanh(), torch.nn.Linear(hidden, width))
        with torch.no_grad():
            for parameter, values, shape in zip(net.parameters(), start, shapes):
                parameter.copy_(torch.from_numpy(values.reshape(shape)))
        optimiser = torch.optim.Adam(net.parameters(), lr=figures["rate"])
        steps = -(-len(data) // batch)
        schedule = torch.optim.lr_scheduler.CosineAnnealingLR(optimiser, steps)
        for chosen in torch.randperm(len(data)).split(batch):
            x = data[chosen]
            optimiser.zero_grad()
            torch.nn.functional.mse_loss(net(x), x).backward()
            optimiser.step()
            schedule.step()
        return net

    seconds, net = timed(epoch)
    with torch.no_grad():
        error = torch.nn.functional.mse_loss(net(test), test).item()
    head(f"Autoencoder {width}-{hidden}-{width}, one epoch of {figures['samples']} samples, batches of {batch}",
         "", "s", "test error")
    row("kinesic", f"{figures['median']:.3f}", f"{figures['test_error']:.5f}")
    row(f"PyTorch {torch.__version__}", f"{seconds:.3f}", f"{error:.5f}")
    row("ratio", f"{seconds / figures['median']:.1f}", "")


def growth():
    head("How cost grows", "job", "1x, s", "4x, s", "16x, s", "exponent", "1x, MiB", "4x, MiB", "16x, MiB", "exponent")
    for job in ("align", "identify", "autoencoder", "rank", "regress", "pca", "sparse", "learn"):
        # 16 times as many frames than a quarter of the table's job.
        found = [ours(job, scale)[1] for scale in (0.25, 1.0, 4.0)]
        cells = []
        for key, digits in (("median", 3), ("peak_mib", 0)):
            values = [f[key] for f in found]
            cells += [f"{v:.{digits}f}" for v in values]
            cells.append(f"{np.log(values[2] / values[0]) / np.log(16):.2f}")
        row(job, *cells)


if __name__ == "__main__":
    for job in arguments(__doc__, {"align": align, "identify": identify, "autoencoder": autoencoder, "growth": growth}):
        job()
