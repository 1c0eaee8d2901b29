#!/usr/bin/env bash
# Prints the tables of docs/precision.md: how far quantised packs are from f32 on clips that they were not trained on.
# Needs the recorded clips (KINESIC_DATA, default ../shared/data). Some two minutes on two cores.
set -euo pipefail
cd "$(dirname "$0")/.."
data=${KINESIC_DATA:-../shared/data}
cargo build --release --locked -q -p kinesic-host
kinesic=${CARGO_TARGET_DIR:-target}/release/kinesic
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# A number of a JSON file by its key.
number() { grep -o "\"$1\": *[0-9.e-]*" "$2" | head -1 | sed 's/.*: *//'; }

row() { # name, pack, clips...
    local name=$1 pack=$2
    shift 2
    "$kinesic" quantize "$pack" --clips "$@" --out "$work/small.kin" --json >"$work/small.json"
    printf '| %s | %s | %s | %s | %.4f | %.4f | %.4f |\n' "$name" "$(number bytes_f32 "$work/small.json")" \
        "$(number bytes "$work/small.json")" "$(number frames "$work/small.json")" "$(number mean_deg "$work/small.json")" \
        "$(number p99_deg "$work/small.json")" "$(number worst_deg "$work/small.json")"
}

echo "| pack | f32, B | smaller, B | frames | mean, deg | 99 % below | worst |"
echo "|---|---|---|---|---|---|---|"
# Trained on take 000 of a style; measured on another take of the same walk, and on other actions and a long recording of somebody else.
far=("$data"/xia/neutral_13_000.bvh "$data"/xia/neutral_16_000.bvh "$data"/cmu31/03_03.bvh)
for style in angry childlike depressed old proud sexy strutting; do
    for form in whole-body per-joint; do
        order=64
        [ $form = per-joint ] && order=40
        "$kinesic" train translate --pair "$data/xia/neutral_01_000.bvh" "$data/xia/${style}_01_000.bvh" --form $form \
            --order $order --out "$work/$style.kin" --json >/dev/null 2>&1
        row "translator, $style, $form, int16, another take" "$work/$style.kin" "$data"/xia/neutral_01_001.bvh
        row "the same, other actions and people" "$work/$style.kin" "${far[@]}"
    done
done
# The clips of the pool that the shipped network's pack does not name among its inputs.
"$kinesic" inspect models/mechanics.kin --json >"$work/inspect.json"
held=()
while read -r file; do
    grep -q "$file" "$work/inspect.json" || held+=("$data/$file")
done < <(awk -F'\t' '$1 ~ /^cmu31\// && $9 == "body-mechanics" { print $1 }' "$data/manifest.tsv")
row "body mechanics, ${#held[@]} held-back clips, int8" models/mechanics.kin "${held[@]}"
