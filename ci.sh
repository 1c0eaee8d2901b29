#!/usr/bin/env bash
# The one entry for every check. `./ci.sh` or `./ci.sh test` runs what must pass before a change lands.
set -euo pipefail
cd "$(dirname "$0")"

usage() {
    cat <<EOF
usage: ./ci.sh [COMMAND]

  test      everything below, in this order (the default)
  lint      formatting, clippy and documentation, without warnings
  unit      all tests of the workspace, on the real clips where they are (KINESIC_DATA, default ../shared/data)
  firmware  images for every target, run in the emulator, against the budgets

  header    makes c/include/kinesic.h from c/src
  bench-peers  training jobs beside the Python packages used today (installed into target/peers): docs/training-speed.md
EOF
}

need() {
    command -v "$1" >/dev/null && return
    echo "ci.sh: $1 is missing. $2" >&2
    exit 1
}

lint() {
    cargo fmt --all --check
    # Crates for microcontrollers are workspaces of their own.
    for crate in c docs/board firmware-sim/image firmware-sim/plugin tests/no-std-link; do
        cargo fmt --manifest-path "$crate/Cargo.toml" --check
    done
    cargo clippy --release --workspace --all-targets --locked -- -D warnings
    RUSTDOCFLAGS="-D warnings" cargo doc --release --workspace --no-deps --locked
}

unit() {
    local skipped
    skipped=$(mktemp)
    KINESIC_SKIPPED=$skipped cargo test --release --workspace --locked --no-fail-fast
    if [ -s "$skipped" ]; then
        echo "SKIPPED for want of the real clips: $(wc -l <"$skipped") tests"
        sed 's/^/  /' "$skipped"
    fi
    rm -f "$skipped"
}

firmware() {
    local folder
    firmware-sim/setup.sh
    cargo build --release --locked -p kinesic-firmware-sim --tests
    folder=$(mktemp -d)
    cargo run --release --locked -p kinesic-firmware-sim -- check --json "$folder/first.json"
    cargo run --release --locked -p kinesic-firmware-sim -- check --json "$folder/second.json" >/dev/null
    cmp "$folder/first.json" "$folder/second.json"
    echo "A second run measured the same, to the digit."
    : >"$folder/skipped"
    # Ignored tests are those that need the emulator.
    KINESIC_SKIPPED="$folder/skipped" cargo test --release --locked -p kinesic-firmware-sim -- --include-ignored
    if [ -s "$folder/skipped" ]; then
        echo "SKIPPED for want of the real clips: $(wc -l <"$folder/skipped") tests"
        sed 's/^/  /' "$folder/skipped"
    fi
    rm -r "$folder"
}

header() {
    KINESIC_HEADER=write cargo test --release --locked -p kinesic-firmware-sim --test c the_header_is_that_of_the_crate
}

bench_peers() {
    local work=target/peers
    need python3 "apt-get install python3 python3-venv"
    [ -x "$work/bin/python" ] || python3 -m venv "$work"
    "$work/bin/pip" install --quiet --requirement benches/peers/requirements.txt
    cargo build --release --locked -p kinesic-benches --bins
    cargo build --release --locked -p kinesic-host --example components_bench
    "$work/bin/python" benches/peers/host.py target/release/host-jobs "$work/jobs"
    "$work/bin/python" benches/peers/components.py target/release/examples/components_bench "$work/jobs"
}

need cargo "Install Rust: https://rustup.rs"
need cc "Install a C linker: apt-get install gcc"
case "${1:-test}" in
# Not joined by &&: that would switch `set -e` off inside them.
test)
    lint
    unit
    firmware
    ;;
lint | unit | firmware | header) "$1" ;;
bench-peers) bench_peers ;;
-h | --help) usage ;;
*)
    usage >&2
    exit 2
    ;;
esac
