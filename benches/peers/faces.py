"""A linear SVM from scikit-learn on the same 98 numbers, same people, same clusters of head pose, in one run with ours.

    python -m venv V && V/bin/pip install numpy scipy scikit-learn
    V/bin/python benches/peers/faces.py target/release/kinesic WORK

The 98 numbers are computed here a second time, from the description in docs/faces.md. `KINESIC_DATA` names the data folder.
"""

import csv
import json
import os
import subprocess
import sys
import time
import warnings
from pathlib import Path

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"

import numpy as np  # noqa: E402
from sklearn.model_selection import GroupKFold  # noqa: E402
from sklearn.svm import LinearSVC  # noqa: E402

warnings.filterwarnings("ignore")
SPLITS = (1, 2, 3)
COSTS = (1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2, 1e-1)
REGIONS = ([*range(17, 22), *range(36, 42)], [*range(22, 27), *range(42, 48)], list(range(27, 36)),
           [i for i in range(48, 68) if i not in (60, 64)])
MOVING = sum(REGIONS, [])


def read(path, label):
    rows = [row for row in csv.DictReader(open(path)) if row[label] != ""]
    points = np.array([[[float(row[f"x{i}"]), float(row[f"y{i}"])] for i in range(68)] for row in rows])
    return rows, points, np.array([float(row[label]) for row in rows])


def numbers(points):
    """Rolled so that the eyes are level, unit: root mean square distance of the moving landmarks; every region from its mean."""
    across = points[:, 42:48].mean(1) - points[:, 36:42].mean(1)
    cos, sin = (across / np.linalg.norm(across, axis=1)[:, None]).T
    x, y = np.moveaxis(points - points[:, MOVING].mean(1)[:, None], -1, 0)
    points = np.stack([cos[:, None] * x + sin[:, None] * y, cos[:, None] * y - sin[:, None] * x], -1)
    points /= np.sqrt((points[:, MOVING] ** 2).sum(2).mean(1))[:, None, None]
    local = [points[:, region] - points[:, region].mean(1)[:, None] for region in REGIONS]
    return np.concatenate(local, 1).reshape(len(points), -1)


def right(labels, scores):
    """Pairs of a face labelled 1 and one labelled 0, and how many are in order; a tie counts half."""
    low, high = np.sort(scores[labels == 0]), scores[labels == 1]
    below, up_to = np.searchsorted(low, high, "left"), np.searchsorted(low, high, "right")
    return len(low) * len(high), below.sum() + 0.5 * (up_to - below).sum()


def svm(values, labels, people):
    """The cost by validation on people held out, then all."""
    def accuracy(cost):
        pairs = hits = 0
        for fit, held in GroupKFold(4).split(values, labels, people):
            w = LinearSVC(C=cost, dual=False).fit(values[fit], labels[fit]).coef_[0]
            n, r = right(labels[held], values[held] @ w)
            pairs, hits = pairs + n, hits + r
        return hits / max(pairs, 1)
    return LinearSVC(C=max(COSTS, key=accuracy), dual=False).fit(values, labels)


def split(table, seed, work):
    rows = list(csv.reader(open(table)))
    column = rows[0].index("subject")
    people = sorted({row[column] for row in rows[1:]})
    np.random.RandomState(seed).shuffle(people)
    kept = set(people[: len(people) // 2])
    for name, half in (("train.csv", True), ("test.csv", False)):
        with open(work / name, "w", newline="") as file:
            csv.writer(file).writerows([rows[0]] + [row for row in rows[1:] if (row[column] in kept) == half])


def ours(kinesic, work, seed):
    start = time.time()
    subprocess.run([kinesic, "train", "face", "--landmarks", work / "train.csv", "--attribute", "smile", "--hold-out", "0",
                    "--seed", str(seed), "--no-report", "--out", work / "smile.kin"], check=True, capture_output=True)
    seconds = time.time() - start
    scores = {}
    for name in ("train", "test"):
        done = subprocess.run([kinesic, "eval", "face", work / "smile.kin", "--landmarks", work / f"{name}.csv", "--json",
                               "--scores", work / f"{name}-scores.csv"], check=True, capture_output=True, text=True)
        report = json.loads(done.stdout)
        rows = [row for row in csv.DictReader(open(work / f"{name}-scores.csv")) if row["label"] != ""]
        scores[name] = (np.array([int(row["cluster"]) for row in rows]), np.array([float(row["strength"]) for row in rows]))
    return seconds, report, scores


def main(kinesic, work):
    work = Path(work)
    work.mkdir(parents=True, exist_ok=True)
    data = Path(os.environ.get("KINESIC_DATA", "../shared/data")) / "faces"
    table = []
    for seed in SPLITS:
        split(data / "wild_landmarks68.csv", seed, work)
        seconds, report, scores = ours(kinesic, work, seed)
        (rows, points, labels), (_, test_points, test_labels) = (read(work / f"{n}.csv", "smile") for n in ("train", "test"))
        people = np.array([row["subject"] for row in rows])
        values, test = numbers(points), numbers(test_points)
        mean, deviation = values.mean(0), values.std(0)
        values, test = (values - mean) / deviation, (test - mean) / deviation
        (cluster, _), (test_cluster, strength) = scores["train"], scores["test"]
        pairs, hits = right(test_labels, strength)
        assert pairs == report["pairs"] and abs(hits / pairs - report["pair_accuracy"]) < 1e-9, "two counts of the same pairs"
        start = time.time()
        one = svm(values, labels, people).decision_function(test)
        single = time.time() - start
        start = time.time()
        each = np.zeros(len(test))
        for c in range(cluster.max() + 1):
            a, b = cluster == c, test_cluster == c
            if b.any():
                each[b] = svm(values[a], labels[a], people[a]).decision_function(test[b])
        many = time.time() - start
        for name, score, spent in (("kinesic", strength, seconds), ("SVM a cluster", each, many), ("one SVM", one, single)):
            within = [right(test_labels[test_cluster == c], score[test_cluster == c]) for c in range(cluster.max() + 1)]
            n, r = np.sum(within, 0)
            by_cluster = [f"{100 * r / n:.1f}" if n else "-" for n, r in within]
            n_all, r_all = right(test_labels, score)
            table.append((seed, name, n_all, 100 * r_all / n_all, 100 * r / n, spent, by_cluster))
            print(f"| {seed} | {name} | {n_all} | {100 * r_all / n_all:.2f} | {100 * r / n:.2f} | {' '.join(by_cluster)} | {spent:.1f} |",
                  flush=True)
    print()
    for name in ("kinesic", "SVM a cluster", "one SVM"):
        mean = np.mean([row[3:5] for row in table if row[1] == name], 0)
        print(f"| mean | {name} | | {mean[0]:.2f} | {mean[1]:.2f} | | |")


if __name__ == "__main__":
    print("| split | method | pairs | all pairs, % right | pairs within clusters, % right | by cluster | seconds |")
    print("|---|---|---|---|---|---|---|")
    main(*sys.argv[1:])
