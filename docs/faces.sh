#!/usr/bin/env bash
# The tables of docs/faces.md. About a minute without the peer. Pictures go to the folder FACES_SHEETS, which must lie outside the
# repository: the portraits are other people's.
# usage: docs/faces.sh [people|synthetic|across|portraits|sheets|svm]...   (default: all but svm)
set -euo pipefail
cd "$(dirname "$0")/.."
data=$(realpath "${KINESIC_DATA:-../shared/data}")
export KINESIC_DATA=$data
faces=$data/faces
cargo build --release --locked -q -p kinesic-host --bins --example face_bench
target=${CARGO_TARGET_DIR:-target}/release
kinesic=$target/kinesic
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
sheets=${FACES_SHEETS:-$work/sheets}
mkdir -p "$sheets"

"$kinesic" train face --landmarks "$faces/wild_landmarks68.csv" --attribute smile --out "$work/smile.kin" >"$work/people.txt"
for table in "${@:-people synthetic across portraits sheets}"; do
    for table in $table; do
        echo "== $table"
        case $table in
        people) cat "$work/people.txt" ;;
        synthetic)
            "$kinesic" train face --landmarks "$faces/synthetic_landmarks68.csv" --attribute smile --hold-out 0.5 --out "$work/made.kin"
            ;;
        across)
            for name in synthetic portraits; do
                echo "$name, with the pack trained on wild_landmarks68.csv"
                "$kinesic" eval face "$work/smile.kin" --landmarks "$faces/${name}_landmarks68.csv" >"$work/eval.txt"
                sed -n 1,4p "$work/eval.txt"
            done
            ;;
        portraits) "$target/examples/face_bench" "$work/smile.kin" "$faces/portraits" "$faces/portraits_landmarks68.csv" ;;
        sheets)
            images=()
            for picture in $(find "$faces/portraits" -name '*_neutral.jpg' | sort | sed -n 1,20p); do images+=(--image "$picture"); done
            "$kinesic" face "$work/smile.kin" "${images[@]}" --landmarks "$faces/portraits_landmarks68.csv" \
                --change 0.8 --sheet --out "$sheets/neutral.png" | tail -1
            "$kinesic" face "$work/smile.kin" "${images[@]//neutral/smiling}" --landmarks "$faces/portraits_landmarks68.csv" \
                --change 0.8 --sheet --out "$sheets/smiling.png" | tail -1
            ;;
        svm) "${PYTHON:-python3}" benches/peers/faces.py "$kinesic" "$work/svm" ;;
        *) echo "docs/faces.sh: no table is called $table" >&2; exit 1 ;;
        esac
    done
done
