#!/usr/bin/env bash
# Writes docs/pictures/: the pictures of the README, from the program's own walks and faces. Screenshots need Chromium
# (firmware-sim/setup.sh).
set -euo pipefail
cd "$(dirname "$0")/.."
mkdir -p docs/pictures
KINESIC_PICTURES=write cargo test --release --locked -p kinesic-firmware-sim --test pictures -- --include-ignored
ls -l docs/pictures
