#!/usr/bin/env bash
# The one entry for every check. `./ci.sh` or `./ci.sh test` runs what must pass before a change lands.
set -euo pipefail
cd "$(dirname "$0")"

usage() {
    cat <<EOF
usage: ./ci.sh [COMMAND]

  test      the four stages below, in this order (the default); every stage runs, and what failed is listed at the end
  fetch     downloads the crates of every workspace, for the platforms that are built here
  lint      formatting, clippy and documentation, without warnings
  unit      all tests of the workspace, on the real clips where they are (KINESIC_DATA, default ../shared/data)
  firmware  images for every target, run in the emulator, against the budgets

  wasm      makes host/src/view/assets/kinesic.wasm from wasm/ and core/
  header    makes c/include/kinesic.h from c/src
  bench-peers  training jobs beside the Python packages used today (installed into target/peers): docs/training-speed.md
  fuzz [SECONDS]
            every fuzz target for so long (default 60), from the corpus in fuzz/; what it finds is left in fuzz/artifacts
  deny      licences, sources and known vulnerabilities of all dependencies, by cargo-deny and deny.toml

With CI=true, \`test\` starts like a new machine: its cargo home holds the configuration of yours and nothing else, and its target
folder is empty. Both are temporary.
EOF
}

need() {
    command -v "$1" >/dev/null && return
    echo "ci.sh: $1 is missing. $2" >&2
    exit 1
}

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
failed=()

# `step TITLE COMMAND...` runs one check, and remembers it if it fails: the title, what failed in it, how to repeat it.
step() {
    local title=$1 started=$SECONDS log="$scratch/step.log" line
    shift
    echo "== $title"
    if "$@" 2>&1 | tee "$log"; then
        echo "== $title: passed in $((SECONDS - started)) s"
        return
    fi
    echo "== $title: FAILED after $((SECONDS - started)) s"
    failed+=("$title")
    while read -r line; do
        failed+=("    $line")
    done < <(sed -nE 's/^test (.*) \.\.\. FAILED$/test \1/p; s/^(FAILED: .*)$/\1/p; s/^(error: could not compile .*)$/\1/p' "$log" | sort -u)
    # Cargo names the test binaries that failed; a budget, its target and workload.
    while read -r line; do
        failed+=("    repeat: $line")
    done < <({
        sed -nE 's/^    `(-p .*)`$/cargo test --release --locked \1/p' "$log" | sed "s/\$/${repeat_with:-}/"
        sed -nE 's/^FAILED: ([a-z0-9]+), ([a-z0-9-]+): .*/cargo run --release --locked -p kinesic-firmware-sim -- check --target \1 --workload \2/p' "$log" | sort -u
    } | grep . || echo "${repeat_as:-$*}")
}

# Prints what failed, and returns 1 if anything did.
verdict() {
    [ ${#failed[@]} -eq 0 ] && return
    echo
    echo "FAILED:"
    printf '  %s\n' "${failed[@]}"
    return 1
}

# A cargo home and a target folder as on a machine that has never built this, so that a hidden download or tool shows.
new_machine() {
    local file home=${CARGO_HOME:-$HOME/.cargo}
    mkdir "$scratch/cargo"
    for file in config config.toml credentials credentials.toml; do
        if [ -f "$home/$file" ]; then cp -p "$home/$file" "$scratch/cargo/"; fi
    done
    export CARGO_HOME=$scratch/cargo CARGO_TARGET_DIR=$scratch/target
    echo "CI=true: an empty cargo home and an empty target folder in $scratch"
}

# Workspaces of their own: crates for microcontrollers, browsers and the emulator.
others=(c docs/board firmware-sim/image firmware-sim/plugin fuzz tests/no-std-link wasm)

# The crates of one workspace, for the platforms that it is built for.
fetch_one() {
    local platform platforms=("--target" "$(rustc -vV | sed -n 's/^host: //p')")
    case $1 in
    c | docs/board | firmware-sim/image | tests/no-std-link)
        for platform in "${bare_metal[@]}"; do platforms+=(--target "$platform"); done
        ;;
    wasm) platforms+=(--target wasm32-unknown-unknown) ;;
    esac
    cargo fetch --locked --quiet --manifest-path "$1/Cargo.toml" "${platforms[@]}" && return
    echo "ci.sh: not all crates of '$1' are here, and they cannot be downloaded. With a network: cargo fetch --locked --manifest-path $1/Cargo.toml" >&2
    return 1
}
bare_metal=(thumbv6m-none-eabi thumbv7em-none-eabihf thumbv8m.main-none-eabihf riscv32imc-unknown-none-elf)

fetch() {
    local workspace
    for workspace in . "${others[@]}"; do
        repeat_as="cargo fetch --locked --manifest-path $workspace/Cargo.toml" \
            step "fetch: crates of $workspace" fetch_one "$workspace"
    done
}

lint() {
    local crate
    step "lint: formatting" cargo fmt --all --check
    for crate in "${others[@]}"; do
        step "lint: formatting of $crate" cargo fmt --manifest-path "$crate/Cargo.toml" --check
    done
    step "lint: clippy" cargo clippy --release --workspace --all-targets --locked -- -D warnings
    step "lint: documentation" env RUSTDOCFLAGS="-D warnings" cargo doc --release --workspace --no-deps --locked
}

# Tests that need the real clips, or Blender, name themselves in a file where these are missing.
skipped() {
    [ -s "$KINESIC_SKIPPED" ] || return 0
    echo "SKIPPED for want of the real clips or of a program: $(wc -l <"$KINESIC_SKIPPED") tests"
    sed 's/^/  /' "$KINESIC_SKIPPED"
}

unit() {
    export KINESIC_SKIPPED=$scratch/skipped
    : >"$KINESIC_SKIPPED"
    step "unit: tests of the workspace" cargo test --release --workspace --locked --no-fail-fast
    skipped
}

firmware() {
    local simulate=(cargo run --release --locked -p kinesic-firmware-sim --)
    export KINESIC_SKIPPED=$scratch/skipped
    : >"$KINESIC_SKIPPED"
    step "firmware: emulators, compilers and browser" firmware-sim/setup.sh
    step "firmware: budgets" "${simulate[@]}" check --json "$scratch/budgets.json"
    # Which images run twice changes with every commit.
    if [ -f "$scratch/budgets.json" ]; then
        step "firmware: the same to the digit, in a second run" \
            "${simulate[@]}" check --again "$scratch/budgets.json" --seed "$(git rev-parse HEAD 2>/dev/null || echo none)"
    fi
    # Ignored tests are those that need the emulator.
    repeat_with=" -- --include-ignored" \
        step "firmware: tests in the emulator" cargo test --release --locked --no-fail-fast -p kinesic-firmware-sim -- --include-ignored
    skipped
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
    "$work/bin/python" benches/peers/bvh.py target/release/kinesic "${KINESIC_DATA:-../shared/data}/cmu31/01_01.bvh" "$work/clips"
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
    for target in pack bvh gltf fbx csv map urdf robot servos moves limbs; do
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
    for manifest in Cargo.toml "${others[@]/%//Cargo.toml}"; do
        echo "$manifest"
        cargo deny --locked --manifest-path "$manifest" --config "$PWD/deny.toml" check \
            --allow license-not-encountered --allow license-exception-not-encountered licenses sources bans
    done
    # Advisories need the database of RustSec, which is fetched from the network.
    cargo deny check advisories
}

need cargo "Install Rust: https://rustup.rs"
need rustc "Install Rust: https://rustup.rs"
need cc "Install a C linker: apt-get install gcc"
case "${1:-test}" in
test)
    if [ "${CI:-}" = true ]; then new_machine; fi
    fetch
    lint
    unit
    firmware
    verdict
    echo "Everything passed in $((SECONDS / 60)) min $((SECONDS % 60)) s."
    ;;
fetch | lint | unit | firmware)
    "$1"
    verdict
    ;;
bench-peers) bench_peers ;;
wasm | header | deny) "$1" ;;
fuzz) fuzz "${2:-60}" ;;
-h | --help) usage ;;
*)
    usage >&2
    exit 2
    ;;
esac
