#!/usr/bin/env bash
# The tables of docs/components.md, and its contact sheet into docs/components. About a minute without the peers.
# usage: docs/components.sh [penalty|explained|transfer|pairs|count|curve|sheet]...   (default: all)
set -euo pipefail
cd "$(dirname "$0")/.."
data=$(realpath "${KINESIC_DATA:-../shared/data}")
export KINESIC_DATA=$data
cargo build --release --locked -q -p kinesic-host --bins
cargo build --release --locked -q -p kinesic-benches --bin components-bench
target=${CARGO_TARGET_DIR:-target}/release
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

for table in "${@:-penalty explained transfer pairs count curve sheet}"; do
    for table in $table; do
        echo
        case $table in
        pairs)
            for pair in bandai1/guide_normal_001:bandai1/guide_angry_001 bandai1/bow_normal_001:bandai1/bow_active_001 \
                bandai1/bye_normal_001:bandai1/bye_angry_001 xia/neutral_01_000:xia/angry_01_000 \
                xia/neutral_01_000:xia/old_01_000; do
                echo "$pair"
                "$target/kinesic" train components --content "$data/${pair%:*}.bvh" --style "$data/${pair#*:}.bvh" \
                    -k 30 --smooth 1 --out "$work/pair.kin" | grep distance
                "$target/kinesic" eval components "$work/pair.kin" | grep -E 'before|after|turned|moved|jerk ratio'
            done
            ;;
        curve)
            "$target/kinesic" train components --content "$data/xia/neutral_01_000.bvh" --style "$data/xia/proud_01_000.bvh" \
                -k 30 --smooth 1 --posture 0 --curve --out "$work/proud.kin"
            ;;
        sheet)
            mkdir -p docs/components
            "$target/kinesic" train components --content "$data/cmu31/07_01.bvh" --style "$data/m21/style/OLD-1.bvh" \
                -k 30 --smooth 1 --out "$work/old.kin"
            "$target/kinesic" apply "$work/old.kin" --stored --out "$work/old.bvh"
            "$target/kinesic" sheet "$data/cmu31/07_01.bvh" "$data/m21/style/OLD-1.bvh" "$work/old.bvh" \
                --frames 10 --out docs/components/old.png
            ;;
        *) "$target/components-bench" "$table" ;;
        esac
    done
done
