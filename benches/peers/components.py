"""Peers of style components, on the same inputs in one run: scikit-learn's SparsePCA, SPLOCS' algorithm (Neumann 2013,
written here in NumPy from the paper), thinned principal components, and PyTorch for the style learning. One thread.

    python -m venv V && V/bin/pip install numpy scipy scikit-learn torch
    V/bin/python benches/peers/components.py target/release/examples/components_bench WORK [factor|learn]
"""

import csv
import os
import statistics
import subprocess
import sys
import time
import warnings

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"

# Set on some machines for old OpenBLAS builds; they slow the peers down.
for name in ("OPENBLAS_CORETYPE", "OPENBLAS_L2_SIZE"):
    os.environ.pop(name, None)

import numpy as np  # noqa: E402

warnings.filterwarnings("ignore")
ALPHAS = (0.1, 0.3, 1.0, 2.0, 4.0, 8.0)
LAMBDAS = (0.03, 0.1, 0.3, 1.0, 3.0, 10.0)


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


def factor(bench, work):
    subprocess.run([bench, "factor", work], check=True)
    from sklearn.decomposition import SparsePCA
    rows = list(csv.DictReader(open(os.path.join(work, "ours.csv"))))
    clips = sorted({int(r["clip"]) for r in rows})
    counts = sorted({int(r["components"]) for r in rows})
    points = []  # method, clip, K, density, error, ms
    motions = {i: np.loadtxt(os.path.join(work, f"motion{i}.csv"), delimiter=",") for i in clips}
    for row in rows:
        M = motions[int(row["clip"])]
        C = np.loadtxt(os.path.join(work, row["file"]), delimiter=",")
        S = support_of(C)
        points.append((row["method"], int(row["clip"]), int(row["components"]), S.mean(), refit(M, S, C), float(row["milliseconds"])))
    for clip in clips:
        M = motions[clip]
        for K in counts:
            for alpha in ALPHAS:
                start = time.process_time()
                model = SparsePCA(K, alpha=alpha, random_state=0, max_iter=200, tol=1e-4)
                model.fit(M)
                ms = 1e3 * (time.process_time() - start)
                S = support_of(model.components_)
                if S.any():
                    points.append(("sklearn", clip, K, S.mean(), refit(M, S, model.components_), ms))
            for lam in LAMBDAS:
                start = time.process_time()
                C = splocs(M, K, lam)
                ms = 1e3 * (time.process_time() - start)
                S = support_of(C)
                if S.any():
                    points.append(("splocs", clip, K, S.mean(), refit(M, S, C), ms))
        print("clip", clip, "done", file=sys.stderr, flush=True)

    def at(method, clip, K, density):
        """log error at a density, between the two nearest points; None outside what the method reached."""
        curve = sorted((d, e) for m, c, k, d, e, _ in points if (m, c, k) == (method, clip, K))
        if not curve or density < curve[0][0] - 1e-9 or density > curve[-1][0] + 1e-9:
            return None
        best = np.minimum.accumulate([e for _, e in curve])
        return float(np.exp(np.interp(density, [d for d, _ in curve], np.log(np.maximum(best, 1e-6)))))

    methods = ("kinesic", "pca", "sklearn", "splocs")
    print("| K | density | clips | kinesic | thinned PCA | SparsePCA | SPLOCS | no worse than the best |")
    print("|---|---|---|---|---|---|---|---|")
    for K in counts:
        for density in (0.05, 0.08, 0.12, 0.2, 0.3, 0.5):
            cells, wins, compared = {m: [] for m in methods}, 0, 0
            for clip in clips:
                values = {m: at(m, clip, K, density) for m in methods}
                if values["kinesic"] is None or values["sklearn"] is None:
                    continue
                compared += 1
                others = [v for m, v in values.items() if m != "kinesic" and v is not None]
                wins += values["kinesic"] <= min(others) * 1.001
                for m, v in values.items():
                    if v is not None:
                        cells[m].append(v)
            mean = {m: f"{np.mean(v):.4f}" if v else "-" for m, v in cells.items()}
            if compared:
                print(f"| {K} | {density} | {compared} | {mean['kinesic']} | {mean['pca']} | {mean['sklearn']} | {mean['splocs']} | {wins} of {compared} |")
    print()
    print("| K | kinesic, ms | SparsePCA, ms | SPLOCS, ms | SparsePCA / kinesic |")
    print("|---|---|---|---|---|")
    for K in counts:
        # At SparsePCA's density and no larger error: the fastest of ours that reaches both.
        ratios, ours, theirs = [], [], []
        for m, clip, k, density, error, ms in points:
            if (m, k) != ("sklearn", K):
                continue
            reach = [(t, d, e) for mm, c, kk, d, e, t in points if (mm, c, kk) == ("kinesic", clip, K) and d <= density + 1e-9 and e <= error]
            theirs.append(ms)
            if reach:
                t = min(reach)[0]
                ours.append(t)
                ratios.append(ms / t)
        peer = statistics.median(ms for m, _, k, _, _, ms in points if (m, k) == ("splocs", K))
        print(f"| {K} | {statistics.median(ours):.1f} | {statistics.median(theirs):.0f} | {peer:.0f} | median {statistics.median(ratios):.0f}, least {min(ratios):.0f}, reached in {len(ratios)} of {len(theirs)} |")


def learn(bench, work):
    out = subprocess.run([bench, "learn", work], check=True, capture_output=True, text=True).stdout
    _, seconds, value = out.strip().split(",")
    import torch
    torch.set_num_threads(1)
    load = lambda n: torch.tensor(np.loadtxt(os.path.join(work, n + ".csv"), delimiter=",", ndmin=2), dtype=torch.float32)
    W, CC, G, start, mean, table = map(load, ("weights", "content", "gram", "start", "mean", "bones"))
    parent, child, rest = table[:, 0].long(), table[:, 1].long(), table[:, 2]

    def run():
        C = start.clone().requires_grad_(True)
        adam = torch.optim.Adam([C], lr=0.1)
        for _ in range(500):
            adam.zero_grad()
            P = (mean + W @ C).view(W.shape[0], -1, 3)
            length = (P[:, child] - P[:, parent]).norm(dim=2)
            value = ((CC - C) ** 2).sum() + 0.01 * ((C.T @ C - G) ** 2).sum() + 10 * ((length - rest) ** 2).sum() / W.shape[0]
            value.backward()
            adam.step()
        return float(value.detach())

    times, last = [], 0.0
    for _ in range(5):
        begin = time.process_time()
        last = run()
        times.append(time.process_time() - begin)
    theirs = statistics.median(times)
    print("| 500 Adam steps, K = 30 | processor seconds (median of 5) | objective |")
    print("|---|---|---|")
    print(f"| kinesic, f64 | {float(seconds):.3f} | {float(value):.4f} |")
    print(f"| PyTorch {torch.__version__}, f32, one thread | {theirs:.3f} | {last:.4f} |")
    print(f"| ratio | {theirs / float(seconds):.1f} | |")


if __name__ == "__main__":
    bench, work = sys.argv[1:3]
    for job in sys.argv[3:] or ("factor", "learn"):
        {"factor": factor, "learn": learn}[job](bench, work)
        print()
