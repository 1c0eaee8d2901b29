#!/usr/bin/env bash
# Prints the tables of "Real robots" in docs/robot.md: public descriptions against independent readers, and a real walk on the humanoids.
# Descriptions are read at the commits named in docs/robots.py from bare clones OWNER+NAME/repo below $KINESIC_ROBOTS (default
# /work/.mirror), clips from $KINESIC_DATA. Needs Python with numpy, mujoco and yourdfpy: $PYTHON.
# usage: docs/robots.sh [KINESIC]
set -euo pipefail
cd "$(dirname "$0")/.."
kinesic=${1:-${CARGO_TARGET_DIR:-target}/release/kinesic}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"${PYTHON:-python3}" docs/robots.py "$(realpath "$kinesic")" "${KINESIC_ROBOTS:-/work/.mirror}" \
    "$(realpath "${KINESIC_DATA:-../shared/data}")" "$work"
