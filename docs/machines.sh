#!/usr/bin/env bash
# Trains one small pack of each kind here, and with the instructions of two other processors, emulated, and compares the numbers in them: the table of
# docs/reliability.md, "The same bytes on every machine". Needs qemu-x86_64 (apt-get install qemu-user) and python3. About ten minutes.
# usage: docs/machines.sh [translator-joint|translator-body|components|mechanics|emotion|face]...   (default: all)
set -euo pipefail
cd "$(dirname "$0")/.."
if ! command -v qemu-x86_64 >/dev/null; then
    echo "SKIPPED: there is no qemu-x86_64, so nothing was trained or compared. Install it: apt-get install qemu-user" >&2
    exit 1
fi
kinesic=${KINESIC:-target/release/kinesic}
[ -x "$kinesic" ] || cargo build --release --locked -q
kinesic=$(realpath "$kinesic")
folder=$PWD/docs
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
"$kinesic" demo --out demo >/dev/null
# Two seconds, and every second frame, are enough for the others.
mkdir short
for name in neutral weary; do
    awk '/^Frames:/ { $2 = 60 } /^Frame Time:/ { $3 = 1 / 30; frames = NR } !frames || NR <= frames || (NR - frames) % 2 && NR - frames < 121' \
        "demo/$name.bvh" >"short/$name.bvh"
done
# Emotions want several takes of each label.
mkdir takes
printf 'file\tlabel\ttake\n' >labels.tsv
for seed in 1 2 3; do
    "$kinesic" demo --out "takes/$seed" --seed "$seed" >/dev/null
    for label in neutral weary; do printf '%s\t%s\t%s\n' "takes/$seed/$label.bvh" "$label" "$seed" >>labels.tsv; done
done
# Made landmarks: a face of 68 points, a mouth that widens and rises with the smile, noise.
python3 - <<'PYTHON'
import math, random
random.seed(1)
base = [(100 + 60 * math.sin(math.pi * (i - 8) / 16), 100 + 70 * math.cos(math.pi * (i - 8) / 16)) for i in range(17)]
base += [(55 + 9 * i, 70 - 4 * math.sin(math.pi * i / 4)) for i in range(5)] + [(109 + 9 * i, 70 - 4 * math.sin(math.pi * i / 4)) for i in range(5)]
base += [(100, 80 + 10 * i) for i in range(4)] + [(90 + 5 * i, 116 + 2 * (i == 2)) for i in range(5)]
for x in (75, 125):
    base += [(x + 9 * math.cos(a), 85 - 5 * math.sin(a)) for a in (math.pi, 2.2, 1, 0, -1, -2.2)]
for rx, ry, n in ((22, 9, 12), (16, 4, 8)):
    base += [(100 - rx * math.cos(2 * math.pi * i / n), 138 - ry * math.sin(2 * math.pi * i / n)) for i in range(n)]
with open('faces.csv', 'w') as out:
    print('image,subject,smile,' + ','.join(f'x{i},y{i}' for i in range(68)), file=out)
    for row in range(400):
        smile, yaw = random.choice([0, 0.25, 0.5, 0.75, 1]), random.uniform(-0.4, 0.4)
        cells = []
        for i, (x, y) in enumerate(base):
            dx = x - 100
            if i >= 48:
                dx, y = dx * (1 + 0.3 * smile), y - 0.02 * smile * dx * dx
            cells += [100 + dx * math.cos(yaw) + 10 * math.sin(yaw) + random.gauss(0, 0.4), y + random.gauss(0, 0.4)]
        print(f'f{row},s{row // 4},{smile},' + ','.join(f'{c:.3f}' for c in cells), file=out)
PYTHON

train() {
    local kind=$1 out=$2
    shift 2
    case $kind in
    translator-joint | translator-body)
        local form=per-joint
        [ "$kind" = translator-joint ] || form=whole-body
        "$@" "$kinesic" train translate --pair short/neutral.bvh short/weary.bvh --align in-step --form "$form" --order 12 --no-report --out "$out"
        ;;
    components) "$@" "$kinesic" train components --content short/neutral.bvh --style short/weary.bvh --no-report --out "$out" ;;
    mechanics)
        "$@" "$kinesic" train mechanics --clips short/neutral.bvh --pool short/weary.bvh --hidden 8 --feature-hidden 8 --epochs 2 --hold-out 0 --force \
            --no-report --out "$out"
        ;;
    emotion) "$@" "$kinesic" train emotion --labels labels.tsv --order 'weary>neutral' --hold-out 0 --no-report --out "$out" ;;
    face) "$@" "$kinesic" train face --landmarks faces.csv --attribute smile --hold-out 0 --clusters 2 --no-report --out "$out" ;;
    *) echo "no kind '$kind'" >&2 && return 1 ;;
    esac >"$out.log" 2>&1 || { cat "$out.log" >&2 && return 1; }
}

kinds=("$@")
[ $# -gt 0 ] || kinds=(translator-joint translator-body components mechanics emotion face)
echo "| kind | compared | numbers | differ | largest difference of a tensor, as a share of its largest number |"
echo "|---|---|---|---|---|"
for kind in "${kinds[@]}"; do
    for cpu in Haswell Nehalem; do
        train "$kind" "$kind-$cpu.kin" qemu-x86_64 -cpu "$cpu"
    done
    train "$kind" "$kind-here.kin" env
    train "$kind" "$kind-again.kin" env
    for pair in "here again" "here Haswell" "here Nehalem" "Haswell Nehalem"; do
        read -r a b <<<"$pair"
        python3 "$folder/machines.py" "$kinesic" "$kind" "$kind-$a.kin" "$kind-$b.kin" "$pair"
    done
done
