"""Peers of style components, on the same inputs in one run: scikit-learn's SparsePCA, SPLOCS' algorithm (Neumann 2013,
written here in NumPy from the paper), thinned principal components, and PyTorch for the style learning. One thread.

    ./ci.sh bench-peers            makes the virtual environment and runs this
    python benches/peers/components.py target/release/components-bench WORK [made|factor|learn]...
"""

import csv
import os
import subprocess
import sys
from collections import namedtuple

from measure import arguments, head, row, timed  # first: it sets the number of threads

import numpy as np
from sklearn.decomposition import SparsePCA

ALPHAS = (0.1, 0.3, 1.0, 2.0, 4.0, 8.0)
LAMBDAS = (0.03, 0.1, 0.3, 1.0, 3.0, 10.0)
COUNTS = (10, 30, 50)
DENSITIES = (0.05, 0.08, 0.12, 0.2, 0.3, 0.5)
CLIPS = range(10)
# The made motion.
MADE = 10
Point = namedtuple("Point", "method motion count wanted density error seconds")


def refit(M, support, C, rounds=60):
    """Least squares for C on its support and for W, in turn, for every method alike. Relative error."""
    K, N = support.shape
    W = M @ np.linalg.pinv(C)
    last = np.inf
    for _ in range(rounds):
        G, H = W.T @ W, W.T @ M
        C = np.zeros_like(C)
        for j in range(N):
            a = np.flatnonzero(support[:, j])
            if len(a):
                ridge = 1e-9 * np.trace(G) / K * np.eye(len(a))
                C[np.ix_(a, [3 * j, 3 * j + 1, 3 * j + 2])] = np.linalg.solve(
                    G[np.ix_(a, a)] + ridge, H[np.ix_(a, [3 * j, 3 * j + 1, 3 * j + 2])])
        Q = C @ C.T
        W = np.linalg.solve(Q + (1e-9 * np.trace(Q) / K + 1e-300) * np.eye(K), C @ M.T).T
        error = np.linalg.norm(M - W @ C)
        if last - error < 5e-4 * last:
            break
        last = error
    return error / np.linalg.norm(M)


def support_of(C):
    return np.abs(C.reshape(C.shape[0], -1, 3)).sum(2) > 0


def splocs(M, K, lam, iterations=20, admm=10):
    """Sparse localised components without the geodesic support map: greedy start, |w|_inf = 1, ADMM for the l1/l2 term."""
    F, D = M.shape
    R, W, C = M.copy(), np.zeros((F, K)), np.zeros((K, D))
    for k in range(K):
        joint = np.argmax((R.reshape(F, -1, 3) ** 2).sum((0, 2)))
        u, s, vt = np.linalg.svd(R[:, 3 * joint:3 * joint + 3], full_matrices=False)
        w = u[:, 0] * s[0]
        w = w / max(np.abs(w).max(), 1e-12)
        c = w @ R / max(w @ w, 1e-12)
        W[:, k], C[k] = w, c
        R -= np.outer(w, c)
    U = np.zeros_like(C)
    for _ in range(iterations):
        R = M - W @ C
        for k in range(K):
            n = C[k] @ C[k]
            if n <= 1e-8:
                W[:, k] = 0
                continue
            w = (R @ C[k] + W[:, k] * n) / n
            w = w / max(np.abs(w).max(), 1e-12)
            R -= np.outer(w - W[:, k], C[k])
            W[:, k] = w
        G, c = W.T @ W, W.T @ M
        rho = max(10 * np.trace(G) / K, 1e-9)
        inverse = np.linalg.inv(G + rho * np.eye(K))
        Z = C.copy()
        for _ in range(admm):
            C = inverse @ (c + rho * (Z - U))
            V = (C + U).reshape(K, -1, 3)
            size = np.sqrt((V ** 2).sum(2, keepdims=True))
            Z = (V * np.maximum(0, 1 - lam / rho / np.maximum(size, 1e-12))).reshape(K, D)
            U += C - Z
        C = Z
    return C


def bench(*arguments):
    return subprocess.run([sys.argv[1], *arguments], check=True, capture_output=True, text=True).stdout


def motions():
    bench("motions", sys.argv[2])
    return [np.loadtxt(os.path.join(sys.argv[2], f"motion{i}.csv"), delimiter=",") for i in (*CLIPS, MADE)]


def point(M, method, motion, count, wanted, C, seconds):
    S = support_of(C)
    return [Point(method, motion, count, wanted, S.mean(), refit(M, S, C), seconds)] if S.any() else []


def peers(M, motion, count, once, **options):
    """SparsePCA and SPLOCS over their penalties."""
    points = []
    for method, weights, fit in (("sklearn", ALPHAS, lambda w: SparsePCA(count, alpha=w, random_state=0, **options).fit(M).components_),
                                 ("splocs", LAMBDAS, lambda w: splocs(M, count, w))):
        for weight in weights:
            seconds, C = once(lambda: fit(weight))
            points += point(M, method, motion, count, None, C, seconds)
    return points


def ours(motions, wanted):
    """Our factors at wanted densities, and the strongest groups of the principal components."""
    with open(os.path.join(sys.argv[2], "wanted.csv"), "w", newline="") as file:
        csv.writer(file).writerows(wanted)
    bench("factor", sys.argv[2])
    points = []
    for line in csv.DictReader(open(os.path.join(sys.argv[2], "ours.csv"))):
        C = np.loadtxt(os.path.join(sys.argv[2], line["file"]), delimiter=",")
        motion, count = int(line["motion"]), int(line["components"])
        points += point(motions[motion], line["method"], motion, count, float(line["wanted"]), C, float(line["seconds"]))
    return points


def beside(points, motions, count):
    """SparsePCA's runs, and for each the fastest of ours that is at least as sparse and at least as exact, or none."""
    for peer in points:
        if peer.method == "sklearn" and peer.count == count and peer.motion in motions:
            reach = [p for p in points if (p.method, p.motion, p.count) == ("kinesic", peer.motion, count)
                     and p.density <= peer.density + 1e-9 and p.error <= peer.error]
            yield peer, min(reach, key=lambda p: p.seconds, default=None)


def wanted(points):
    """The very densities of SparsePCA's runs, and a little more room."""
    return [(p.motion, p.count, p.density) for p in points if p.method == "sklearn"]


def made():
    """The made motion; SparsePCA as its defaults are."""
    count, all_motions = 25, motions()
    M = all_motions[MADE]
    points = peers(M, MADE, count, timed)
    points += ours(all_motions, wanted(points))
    head(f"Sparse components, made, {M.shape[0]} x {M.shape[1]}, K = {count}, SparsePCA at its defaults", "SparsePCA's density",
         "its error", "kinesic's density", "error", "SparsePCA, s", "kinesic, s", "ratio")
    for peer, us in beside(points, [MADE], count):
        cells = (f"{us.density:.3f}", f"{us.error:.4f}", f"{peer.seconds:.3f}", f"{us.seconds:.5f}",
                 f"{peer.seconds / us.seconds:.0f}") if us else ("-", "-", f"{peer.seconds:.3f}", "-", "-")
        row(f"{peer.density:.3f}", f"{peer.error:.4f}", *cells)
    print("\nSPLOCS:", ", ".join(f"density {p.density:.3f}, error {p.error:.4f}, {p.seconds:.3f} s" for p in points if p.method == "splocs"))


def factor():
    all_motions, points = motions(), []
    for clip in CLIPS:
        for count in COUNTS:
            points += peers(all_motions[clip], clip, count, lambda job: timed(job, runs=0), max_iter=200, tol=1e-4)
        print("clip", clip, "done", file=sys.stderr, flush=True)
    points += ours(all_motions, [(clip, count, d) for clip in CLIPS for count in COUNTS for d in DENSITIES] + wanted(points))

    def at(method, clip, count, density):
        """log error at a density, between the two nearest points; None outside what the method reached."""
        curve = sorted((p.density, p.error) for p in points if (p.method, p.motion, p.count) == (method, clip, count)
                       and p.wanted in (None, *DENSITIES))
        if not curve or density < curve[0][0] - 1e-9 or density > curve[-1][0] + 1e-9:
            return None
        best = np.minimum.accumulate([e for _, e in curve])
        return float(np.exp(np.interp(density, [d for d, _ in curve], np.log(np.maximum(best, 1e-6)))))

    methods = ("kinesic", "pca", "sklearn", "splocs")
    head("Sparse components, ten clips: error at a density", "K", "density", "clips", "kinesic", "thinned PCA", "SparsePCA", "SPLOCS",
         "no worse than the best")
    for count in COUNTS:
        for density in DENSITIES:
            cells, wins, compared = {m: [] for m in methods}, 0, 0
            for clip in CLIPS:
                values = {m: at(m, clip, count, density) for m in methods}
                if values["kinesic"] is None or values["sklearn"] is None:
                    continue
                compared += 1
                others = [v for m, v in values.items() if m != "kinesic" and v is not None]
                wins += values["kinesic"] <= min(others) * 1.001
                for m, v in values.items():
                    if v is not None:
                        cells[m].append(v)
            if compared:
                means = (f"{np.mean(cells[m]):.4f}" if cells[m] else "-" for m in methods)
                row(count, density, compared, *means, f"{wins} of {compared}")
    head("Time", "K", "kinesic, ms", "SparsePCA, ms", "SPLOCS, ms", "SparsePCA / kinesic: median", "a tenth is below", "least",
         "at its density and error or better")
    for count in COUNTS:
        pairs = list(beside(points, CLIPS, count))
        found = [(peer.seconds, us.seconds) for peer, us in pairs if us]
        ratios = [theirs / own for theirs, own in found]
        splocs_ms = np.median([p.seconds for p in points if (p.method, p.count) == ("splocs", count)])
        row(count, *(f"{1e3 * t:.1f}" for t in (np.median([u for _, u in found]), np.median([p.seconds for p, _ in pairs]), splocs_ms)),
            *(f"{r:.0f}" for r in (np.median(ratios), np.quantile(ratios, 0.1), min(ratios))), f"{len(found)} of {len(pairs)} runs")


def learn():
    work = sys.argv[2]
    _, seconds, value = bench("learn", work).strip().split(",")
    import torch
    torch.set_num_threads(1)
    load = lambda n: torch.tensor(np.loadtxt(os.path.join(work, n + ".csv"), delimiter=",", ndmin=2), dtype=torch.float32)
    CC, G, start = map(load, ("content", "gram", "start"))

    def run():
        C = start.clone().requires_grad_(True)
        adam = torch.optim.Adam([C], lr=0.1)
        for _ in range(500):
            adam.zero_grad()
            value = ((CC - C) ** 2).sum() + 0.01 * ((C.T @ C - G) ** 2).sum()
            value.backward()
            adam.step()
        return float(value.detach())

    theirs, last = timed(run)
    head("500 Adam steps, K = 30", "", "processor seconds", "objective")
    row("kinesic, f64", f"{float(seconds):.3f}", f"{float(value):.4f}")
    row(f"PyTorch {torch.__version__}, f32, one thread", f"{theirs:.3f}", f"{last:.4f}")
    row("ratio", f"{theirs / float(seconds):.1f}", "")


if __name__ == "__main__":
    for job in arguments(__doc__, {"made": made, "factor": factor, "learn": learn}):
        job()
