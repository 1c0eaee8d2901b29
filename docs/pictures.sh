#!/usr/bin/env bash
# Writes docs/pictures/: the pictures of the README, from the program's own walks and faces. Screenshots need Chromium
# (firmware-sim/setup.sh).
set -euo pipefail
cd "$(dirname "$0")/.."
mkdir -p docs/pictures
KINESIC_PICTURES=write cargo test --release --locked -p kinesic-firmware-sim --test pictures -- --include-ignored
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cargo run --release --locked -q -- demo --out "$work" > "$work/log"
cargo run --release --locked -q -- sheet "$work/neutral.bvh" "$work/weary.bvh" --out docs/pictures/sheet.png
ls -l docs/pictures
