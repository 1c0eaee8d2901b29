#!/usr/bin/env bash
# Prints the table of docs/choose.md. About a minute on two cores. Needs the real clips (KINESIC_DATA).
set -euo pipefail
cd "$(dirname "$0")/.."
data=$(realpath "${KINESIC_DATA:-../shared/data}")
cargo build --release --locked -q -p kinesic-host --bin kinesic
kinesic=${CARGO_TARGET_DIR:-target}/release/kinesic
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# The same content, another content of the same action, another action.
contents=(xia/neutral_01_001 cmu31/07_01 bandai1/bow_normal_001)
styles=(angry childlike depressed old proud sexy strutting)

# apply PACK CLIP OPTIONS...: the figures of the clip and of the result, and both as positions.
apply() {
    local pack=$1 clip=$2
    shift 2
    "$kinesic" apply "$pack" "$clip" --out "$work/out.bvh" --on pack --feet free "$@" --json 2>/dev/null >"$work/applied"
    "$kinesic" apply "$pack" "$clip" --out "$work/in.bvh" --on pack --feet free --strength 0 --json 2>/dev/null >/dev/null
    for name in in out; do "$kinesic" export "$work/$name.bvh" --out "$work/$name.positions.csv" >/dev/null 2>&1; done
}

# to TARGET: distance of out.bvh to a clip, as eval of a pair reports doing nothing.
to() {
    "$kinesic" eval translate "$work/translate.kin" --pair "$work/out.bvh" "$1" --json 2>/dev/null >"$work/eval"
}

measure() { # ENGINE CLIP
    python3 - "$1" "$2" "$work" <<'PYTHON' >>"$work/all"
import csv, json, math, sys
engine, clip, work = sys.argv[1:]
applied = json.load(open(f"{work}/applied"))
def positions(name):
    rows = list(csv.reader(open(f"{work}/{name}.positions.csv")))
    head = rows[0]
    return head, [[float(x) for x in row] for row in rows[1:]]
head, before = positions("in")
_, after = positions("out")
first = next(i for i, name in enumerate(head) if name.lower().endswith("x"))
count = (len(head) - first) // 3
root = lambda row: row[first:first + 3]
# How far the root is from where the clip's is, cm, and the joints' own movement about the root: how alike it is in both.
path = [math.hypot(root(a)[0] - root(b)[0], root(a)[2] - root(b)[2]) for a, b in zip(before, after)]
alike = []
for joint in range(1, count):
    for axis in range(3):
        at = first + 3 * joint + axis
        a = [row[at] - root(row)[axis] for row in before]
        b = [row[at] - root(row)[axis] for row in after]
        ma, mb = sum(a) / len(a), sum(b) / len(b)
        aa, bb = sum((x - ma) ** 2 for x in a), sum((x - mb) ** 2 for x in b)
        # What moves less than 2 cm has no movement to keep.
        if aa / len(a) > 0.02 ** 2:
            alike.append((sum((x - ma) * (y - mb) for x, y in zip(a, b)) / math.sqrt(aa * bb or 1.0), aa))
weight = sum(w for _, w in alike) or 1.0
content = sum(c * w for c, w in alike) / weight
source, styled = applied["source"], applied["styled"]
try:
    evaluated = json.load(open(f"{work}/eval"))
    distance, degrees = evaluated["open_identity_cm"], evaluated["open_degrees"]["identity"]["all"]
except FileNotFoundError:
    distance = degrees = float("nan")
print(engine, clip, distance, degrees, content, 100 * math.sqrt(sum(x * x for x in path) / len(path)),
      abs(styled["steps_a_minute"] - source["steps_a_minute"]), styled["foot_slide_cm_s"] - source["foot_slide_cm_s"],
      styled["jerk_m_s3"] / max(source["jerk_m_s3"], 1e-9))
PYTHON
}

: >"$work/all"
for style in "${styles[@]}"; do
    "$kinesic" train translate --pair "$data/xia/neutral_01_000.bvh" "$data/xia/${style}_01_000.bvh" --out "$work/translate.kin" --no-report --json >/dev/null
    "$kinesic" train components --content "$data/xia/neutral_01_000.bvh" --style "$data/xia/${style}_01_000.bvh" --smooth 1 --out "$work/components.kin" --no-report --json >/dev/null
    for clip in "${contents[@]}"; do
        for engine in nothing translate components; do
            rm -f "$work/eval"
            case $engine in
            nothing) apply "$work/translate.kin" "$data/$clip.bvh" --strength 0 ;;
            *) apply "$work/$engine.kin" "$data/$clip.bvh" ;;
            esac
            [ "$clip" = "${contents[0]}" ] && to "$data/xia/${style}_01_001.bvh"
            measure $engine "$clip"
        done
    done
done
python3 - "$work/all" <<'PYTHON'
import sys
rows = [line.split() for line in open(sys.argv[1])]
clips, engines = [], []
for row in rows:
    clips += [row[1]] if row[1] not in clips else []
    engines += [row[0]] if row[0] not in engines else []
print("| clip | engine | to the target, cm | degrees | movement kept | path off, cm | steps a minute off | slide more, cm/s | jerk |")
print("|---|---|---|---|---|---|---|---|---|")
for clip in clips:
    for engine in engines:
        found = [[float(x) for x in row[2:]] for row in rows if row[:2] == [engine, clip]]
        mean = [sum(column) / len(column) for column in zip(*found)]
        # Nothing is minus zero.
        cell = lambda x, digits: "-" if x != x else f"{round(x, digits) + 0.0:.{digits}f}"
        print(f"| {clip} | {engine} | " + " | ".join(map(cell, mean, [1, 1, 2, 0, 0, 1, 2])) + " |")
PYTHON
