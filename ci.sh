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

  wasm      makes host/src/view/assets/kinesic.wasm from wasm/ and core/
  header    makes c/include/kinesic.h from c/src
  bench-peers  training jobs beside the Python packages used today (installed into target/peers): docs/training-speed.md
  fuzz [SECONDS]
            every fuzz target for so long (default 60), from the corpus in fuzz/; what it finds is left in fuzz/artifacts
  deny      licences, sources and known vulnerabilities of all dependencies, by cargo-deny and deny.toml
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
    for crate in c docs/board firmware-sim/image firmware-sim/plugin fuzz tests/no-std-link wasm; do
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

wasm() {
    firmware-sim/setup.sh
    KINESIC_WASM=write cargo test --release --locked -p kinesic-firmware-sim --test page the_core_in_the_page -- --ignored
}

header() {
    KINESIC_HEADER=write cargo test --release --locked -p kinesic-firmware-sim --test c the_header_is_that_of_the_crate
}

bench_peers() {
    local work=target/peers
    need python3 "apt-get install python3 python3-venv"
    [ -x "$work/bin/python" ] || python3 -m venv "$work"
    "$work/bin/pip" install --quiet --requirement benches/peers/requirements.txt
    cargo build --release --locked -p kinesic-benches -p kinesic-host --bins
    "$work/bin/python" benches/peers/host.py target/release/host-jobs "$work/jobs"
    "$work/bin/python" benches/peers/emotion.py target/release/host-jobs "$work/jobs"
    "$work/bin/python" benches/peers/components.py target/release/components-bench "$work/jobs"
    "$work/bin/python" benches/peers/faces.py target/release/kinesic "$work/faces"
}

# Coverage by the compiler's own pass, on the stable toolchain; without a sanitizer, since nothing here is unsafe code of ours.
# With cargo-fuzz and a nightly toolchain: cargo fuzz run pack
fuzz() {
    local seconds=$1 host target log found=0
    need c++ "Install a C++ compiler, which libFuzzer is built by: apt-get install g++"
    host=$(rustc -vV | sed -n 's/^host: //p')
    # A target of its own keeps these flags from build scripts and macros.
    RUSTFLAGS="--cfg fuzzing -Ccodegen-units=1 -Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4 \
-Cllvm-args=-sanitizer-coverage-inline-8bit-counters -Cllvm-args=-sanitizer-coverage-pc-table \
-Cllvm-args=-sanitizer-coverage-trace-compares" \
        cargo build --release --locked --manifest-path fuzz/Cargo.toml --target "$host"
    mkdir -p fuzz/artifacts fuzz/target/corpus
    log=$(mktemp)
    for target in pack bvh csv map urdf; do
        # What is new goes to fuzz/target, so that later runs go on from there and the repository stays small.
        mkdir -p "fuzz/target/corpus/$target" "fuzz/artifacts/$target" "fuzz/regressions/$target"
        if "fuzz/target/$host/release/$target" -max_total_time="$seconds" -timeout=20 -rss_limit_mb=4096 -print_final_stats=1 \
            -artifact_prefix="fuzz/artifacts/$target/" "fuzz/target/corpus/$target" "fuzz/corpus/$target" \
            "fuzz/regressions/$target" >"$log" 2>&1; then
            echo "$target: $(sed -n 's/^stat::number_of_executed_units: *//p' "$log") executions, nothing found"
        else
            found=1
            echo "$target: FOUND, see fuzz/artifacts/$target; mend it and put the input into fuzz/regressions/$target"
            tail -n 40 "$log"
        fi
    done
    rm -f "$log"
    return "$found"
}

deny() {
    if ! cargo deny --version >/dev/null 2>&1; then
        echo "ci.sh: cargo-deny is missing. Install it: cargo install --locked cargo-deny" >&2
        echo "Licences and sources are also checked without it: cargo test --release -p kinesic-tests --test dependencies" >&2
        exit 1
    fi
    local manifest
    for manifest in Cargo.toml {c,docs/board,firmware-sim/image,firmware-sim/plugin,fuzz,tests/no-std-link,wasm}/Cargo.toml; do
        echo "$manifest"
        cargo deny --locked --manifest-path "$manifest" --config "$PWD/deny.toml" check \
            --allow license-not-encountered --allow license-exception-not-encountered licenses sources bans
    done
    # Advisories need the database of RustSec, which is fetched from the network.
    cargo deny check advisories
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
bench-peers) bench_peers ;;
lint | unit | firmware | wasm | header | deny) "$1" ;;
fuzz) fuzz "${2:-60}" ;;
-h | --help) usage ;;
*)
    usage >&2
    exit 2
    ;;
esac
