"""Ranking, regression and principal components of emotion strength beside what is used today, on the same made inputs in one run.

    ./ci.sh bench-peers            makes the virtual environment and runs this
    python benches/peers/emotion.py target/release/host-jobs WORK [rank|regress|pca]...
"""

from measure import arguments, head, numbers, ours, row, timed  # first: it sets the number of threads

import numpy as np
from scipy.optimize import minimize
from scipy.sparse import csr_matrix
from sklearn.decomposition import PCA
from sklearn.neural_network import MLPRegressor
from sklearn.svm import LinearSVC

# Ranking: 1/2 |w|^2 + C (sum over ordered max(0, 1 - w d)^2 + sum over similar (w d)^2), d the difference of a pair.


def incidence(pairs, motions):
    """+1 at the one that shows more, -1 at the other: a row a pair."""
    count = len(pairs)
    cells = np.tile([1.0, -1.0], count), pairs.ravel(), np.arange(0, 2 * count + 1, 2)
    return csr_matrix(cells, shape=(count, motions))


def value(w, X, O, S, C):
    scores = X @ w
    return 0.5 * w @ w + C * (np.square(np.maximum(0, 1 - O @ scores)).sum() + np.square(S @ scores).sum())


def newton(X, O, S, C):
    """Newton in the primal (Chapelle 2007) on the graph of pairs, conjugate gradients, exact line search."""
    w, scores, first = np.zeros(X.shape[1]), np.zeros(X.shape[0]), None
    for _ in range(60):
        short = 1 - O @ scores
        active = short > 0
        gradient = w + 2 * C * (X.T @ (S.T @ (S @ scores) - O.T @ np.where(active, short, 0)))
        size = np.linalg.norm(gradient)
        first = first or size
        if size <= 1e-5 * first:
            break
        A = O[active]
        step, residual = np.zeros_like(w), -gradient
        direction, energy = residual.copy(), size * size
        for _ in range(2 * len(w)):
            moved = X @ direction
            image = direction + 2 * C * (X.T @ (A.T @ (A @ moved) + S.T @ (S @ moved)))
            length = energy / (direction @ image)
            step += length * direction
            residual -= length * image
            after = residual @ residual
            if np.sqrt(after) <= min(0.1, np.sqrt(size / first)) * size:
                break
            direction = residual + after / energy * direction
            energy = after
        moved = X @ step
        apart, alike, t = O @ moved, S @ moved, 1.0
        for _ in range(20):
            short = 1 - O @ scores - t * apart
            active = short > 0
            slope = (w + t * step) @ step + 2 * C * (alike @ (S @ scores + t * alike) - short[active] @ apart[active])
            bend = step @ step + 2 * C * (alike @ alike + apart[active] @ apart[active])
            t -= slope / bend
            if abs(slope / bend) < 1e-6:
                break
        w, scores = w + t * step, scores + t * moved
    return w


def lbfgs(X, O, S, C):
    def both(w):
        scores = X @ w
        short, alike = np.maximum(0, 1 - O @ scores), S @ scores
        gradient = w + 2 * C * (X.T @ (S.T @ alike - O.T @ short))
        return 0.5 * w @ w + C * (short @ short + alike @ alike), gradient
    start = np.zeros(X.shape[1])
    enough = 1e-5 * np.abs(both(start)[1]).max()
    return minimize(both, start, jac=True, method="L-BFGS-B",
                    options={"maxiter": 5000, "maxfun": 10000, "gtol": enough, "ftol": 1e-12}).x


def liblinear(X, O, C):
    """On the differences of pairs, every second one turned round, as one must: liblinear's L2-regularised squared hinge, primal."""
    differences = O @ X
    sign = np.where(np.arange(len(differences)) % 2, -1.0, 1.0)
    differences *= sign[:, None]
    return LinearSVC(C=C, loss="squared_hinge", dual=False, fit_intercept=False).fit(differences, sign).coef_[0]


def rank():
    head("Ranking, 1,000 motions, 100,000 pairs", "numbers a motion, pairs", "method", "s", "kinesic is faster", "objective / kinesic's",
         "pair accuracy, unseen")
    for job, label in (("rank", "{columns}, ordered"), ("rank-similar", "{columns}, {ordered} ordered, {similar} similar"),
                       ("rank-full", "{columns}, ordered")):
        folder, figures = ours(job)
        X, test = (numbers(folder, f"{name}.f64", figures["columns"]) for name in ("train", "test"))
        O, S, held = (incidence(numbers(folder, f"{name}.u32", 2, np.uint32), figures["motions"])
                      for name in ("ordered", "similar", "held"))
        C, least = figures["cost"], figures["objective"]
        row(label.format(**figures), "kinesic", f"{figures['median']:.3f}", "", "1", f"{figures['accuracy']:.4f}")
        row("", "kinesic, with the choice of C", f"{figures['median'] + np.median(figures['choosing']):.2f}", "", "", "")
        methods = [("Newton, NumPy", newton, (X, O, S, C)), ("L-BFGS, SciPy", lbfgs, (X, O, S, C))]
        if not figures["similar"]:
            methods.append(("LinearSVC, scikit-learn", liblinear, (X, O, C)))
        for name, method, given in methods:
            seconds, w = timed(lambda: method(*given))
            accuracy = (held @ (test @ w) > 0).mean()
            row("", name, f"{seconds:.2f}", f"{seconds / figures['median']:.1f} times", f"{value(w, X, O, S, C) / least:.6f}",
                f"{accuracy:.4f}")
        print(f"C = {C:.3g}, by validation: {figures['validated']:.4f}; kinesic at most {figures['peak_mib']:.0f} MiB\n", flush=True)


# Regression: outputs = bias + slope s + W tanh(v s + b).


def projection(s, Y, figures):
    """Variable projection: SciPy's BFGS over the hidden parameters, with the output layer eliminated."""
    count, units = len(s), figures["hidden"]
    z = (s - (s.max() + s.min()) / 2) / ((s.max() - s.min()) / 2)
    ridge = np.diag([figures["ridge"] * count] * units + [0.0, 0.0])
    total, decay = np.square(Y).sum(), figures["decay"] * np.square(Y - Y.mean(0)).sum() / units

    def both(p):
        v, b = p.reshape(2, units)
        T = np.tanh(np.outer(z, v) + b)
        B = np.column_stack([T, np.ones(count), z])
        cross = B.T @ Y
        W = np.linalg.solve(B.T @ B + ridge, cross)
        seen = (Y @ W[:units].T - B @ (W @ W[:units].T)) * (1 - T * T)
        gradient = np.concatenate([-2 * z @ seen, -2 * seen.sum(0)]) + 2 * decay * p
        return total - np.vdot(cross, W) + decay * p @ p, gradient

    random = np.random.RandomState(1)
    steep = 0.7 * units
    start = np.concatenate([steep * random.choice([-1.0, 1.0], units),
                            steep * (2 * (np.arange(units) + random.rand(units)) / units - 1)])
    # The same end as ours: an objective that is lowered by less than 1e-5 of itself.
    found = minimize(both, start, jac=True, method="L-BFGS-B", options={"maxiter": 2000, "ftol": 1e-7, "gtol": 0.0})
    v, b = found.x.reshape(2, units)
    middle, half = (s.max() + s.min()) / 2, (s.max() - s.min()) / 2

    def basis(s):
        z = (s - middle) / half
        return np.column_stack([np.tanh(np.outer(z, v) + b), np.ones(len(s)), z])

    B = basis(s)
    W = np.linalg.solve(B.T @ B + ridge, B.T @ Y)
    return lambda s: basis(s) @ W


def network(s, Y, figures, solver):
    """scikit-learn's network of the same width; strengths and outputs in deviations, as its manual asks."""
    mean, deviation = Y.mean(0), Y.std()
    middle, spread = s.mean(), s.std()
    net = MLPRegressor(hidden_layer_sizes=(figures["hidden"],), activation="tanh", solver=solver, max_iter=5000, random_state=1, alpha=1e-4)
    net.fit(((s - middle) / spread)[:, None], (Y - mean) / deviation)
    return lambda s: mean + deviation * net.predict(((s - middle) / spread)[:, None])


def regress():
    folder, figures = ours("regress")
    count, outputs = figures["motions"], figures["outputs"]
    s, Y = numbers(folder, "strengths.f64"), numbers(folder, "values.f64", outputs)
    head(f"Regression, strength -> {outputs} numbers, {figures['hidden']} units, {count} motions; noise {figures['noise'] ** 2:.4f}",
         "method", "s", "kinesic is faster", "mean square error", "of unseen motions")
    row("kinesic", f"{figures['median']:.3f}", "", f"{figures['error']:.5f}", f"{figures['unseen']:.5f}")
    for name, method in (("variable projection, SciPy", lambda: projection(s[:count], Y[:count], figures)),
                         ("MLPRegressor, L-BFGS, scikit-learn", lambda: network(s[:count], Y[:count], figures, "lbfgs")),
                         ("MLPRegressor, Adam, scikit-learn", lambda: network(s[:count], Y[:count], figures, "adam"))):
        seconds, apply = timed(method)
        errors = [np.square(apply(s[part]) - Y[part]).mean() for part in (slice(0, count), slice(count, None))]
        row(name, f"{seconds:.2f}", f"{seconds / figures['median']:.1f} times", *(f"{e:.5f}" for e in errors))


def fitted(model, X):
    model.fit_transform(X)
    return model


def pca():
    head("Principal components, 40", "rows x columns", "kinesic, s", "scikit-learn, s", "ratio", "explained, kinesic", "scikit-learn")
    for job in ("pca", "pca-clip"):
        folder, figures = ours(job)
        X = numbers(folder, "rows.f64", figures["columns"])
        seconds, model = timed(lambda: fitted(PCA(figures["components"]), X))
        row(f"{figures['rows']} x {figures['columns']}", f"{figures['median']:.4f}", f"{seconds:.4f}", f"{seconds / figures['median']:.1f}",
            f"{figures['explained']:.6f}", f"{model.explained_variance_ratio_.sum():.6f}")


if __name__ == "__main__":
    for job in arguments(__doc__, {"rank": rank, "regress": regress, "pca": pca}):
        job()
