#!/usr/bin/env bash
# Installs what `kinesic-firmware-sim check` and its tests need and do not find: emulators, a compiler for the targets where
# no rustup target can be had, a C compiler, Node.js. As root on Debian it installs the packages; otherwise it says what to install and fails.
set -euo pipefail

wanted=()
command -v qemu-system-arm >/dev/null || wanted+=(qemu-system-arm)
command -v qemu-system-riscv32 >/dev/null || wanted+=(qemu-system-misc)
# For the example of the C interface.
command -v arm-none-eabi-gcc >/dev/null || wanted+=(gcc-arm-none-eabi)

# For the emulated RP2040, which is a package of npm.
command -v node >/dev/null || wanted+=(nodejs)
command -v npm >/dev/null || wanted+=(npm)

# For the page of `kinesic view`.
command -v chromium >/dev/null || wanted+=(chromium)

# A compiler for the targets: all rustup targets, or any compiler with its library's sources.
triples=(thumbv6m-none-eabi thumbv7em-none-eabihf thumbv8m.main-none-eabihf riscv32imc-unknown-none-elf wasm32-unknown-unknown)
ready=false
for rustc in rustc /usr/bin/rustc; do
    root=$("$rustc" --print sysroot 2>/dev/null) || continue
    [ -f "$root/lib/rustlib/src/rust/library/Cargo.lock" ] && ready=true
    all=true
    for triple in "${triples[@]}"; do [ -d "$root/lib/rustlib/$triple/lib" ] || all=false; done
    $all && ready=true
done
$ready || wanted+=(rustc-web cargo-web rust-web-src)

# Debian's compiler brings no linker for ELF without a system; a rustup toolchain does.
linker=false
for lld in "$(rustc --print sysroot 2>/dev/null)"/lib/rustlib/*/bin/rust-lld "$(command -v ld.lld || true)"; do
    [ -x "$lld" ] && linker=true
done
$linker || wanted+=(lld)

if [ ${#wanted[@]} -eq 0 ]; then
    echo "firmware-sim: everything is installed"
    exit 0
fi
if [ "$(id -u)" -ne 0 ] || ! command -v apt-get >/dev/null; then
    echo "firmware-sim needs what these Debian packages hold: ${wanted[*]}" >&2
    echo "Install them (apt-get install ${wanted[*]}), or QEMU 7.2 to 8.2 by other means and the compiler's targets with" >&2
    echo "    rustup target add ${triples[*]}" >&2
    exit 1
fi
echo "firmware-sim: installing ${wanted[*]}"
export DEBIAN_FRONTEND=noninteractive
apt-get update -qq
apt-get install -y -qq --no-install-recommends "${wanted[@]}" >/dev/null
