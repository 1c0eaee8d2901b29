"""Travel and reach of the wrists of a result beside those of its clip, from two .positions.csv: `strange.py BEFORE AFTER`.

Prints the travel from first to last frame of both, m, and the standard deviation of the place of the wrist that moves more in the clip, against
the root, of the result over that of the clip."""

import csv
import math
import sys


def read(path):
    with open(path, newline="") as file:
        rows = csv.reader(file)
        names = next(rows)
        return names, [[float(value) for value in row] for row in rows]


def travel(rows, root):
    return math.hypot(rows[-1][root] - rows[0][root], rows[-1][root + 2] - rows[0][root + 2])


def spread(rows, root, wrist):
    total = 0.0
    for axis in range(3):
        values = [row[wrist + axis] - row[root + axis] for row in rows]
        mean = sum(values) / len(values)
        total += sum((value - mean) ** 2 for value in values) / len(values)
    return math.sqrt(total)


names, before = read(sys.argv[1])
_, after = read(sys.argv[2])
# Columns of a joint are NAME.x, NAME.y, NAME.z; the root is the first one.
root = next(i for i, name in enumerate(names) if name.endswith(".x"))
wrists = [i for i, name in enumerate(names) if name.lower() in ("lefthand.x", "righthand.x", "hand_l.x", "hand_r.x")]
wrist = max(wrists, key=lambda wrist: spread(before, root, wrist))
print(travel(before, root), travel(after, root), spread(after, root, wrist) / spread(before, root, wrist))
