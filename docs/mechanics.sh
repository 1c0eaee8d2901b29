#!/bin/sh
# The applications of docs/mechanics.md: BVHs into OUT (default target/mechanics), contact sheets into docs/mechanics.
# Run from the repository's root, with KINESIC_DATA (default ../shared/data) and, if set, CARGO_TARGET_DIR.
set -eu
data=${KINESIC_DATA:-../shared/data}
out=${OUT:-target/mechanics}
target=${CARGO_TARGET_DIR:-target}
mkdir -p "$out" docs/mechanics
cargo build --release -p kinesic-host --bins
kinesic="$target/release/kinesic"
pack=models/mechanics.kin
cmu="$data/cmu31"

decouple() {
    "$kinesic" decouple "$pack" "$2" --mechanics "$out/$1-mechanics.bvh" --expressive "$out/$1-expressive.bvh"
    "$kinesic" sheet "$2" "$out/$1-mechanics.bvh" "$out/$1-expressive.bvh" --frames 10 --out "docs/mechanics/$1.png"
}
decouple boxing "$data/m21/content/box-1.bvh"
decouple basketball "$cmu/06_02.bvh"
decouple dance "$cmu/05_02.bvh"
decouple traffic "$cmu/cmux_train_directing_traffic_4.bvh"

jump="$cmu/cmuc_jumping_118_481.bvh"
"$kinesic" mix "$pack" --mechanics "$jump" --expressive "$cmu/cmux_train_directing_traffic_4.bvh" --expressive-start 5 --mask LHipJoint+=0 --mask RHipJoint+=0 --mask LowerBack=0 --out "$out/jump-signal.bvh"
"$kinesic" sheet "$jump" "$out/jump-signal.bvh" --frames 10 --out docs/mechanics/jump-signal.png
"$kinesic" mix "$pack" --mechanics "$cmu/29_01.bvh" --expressive "$cmu/cmua_AngryTalk_1_A.bvh" --out "$out/walk-talk.bvh"
"$kinesic" sheet "$cmu/29_01.bvh" "$cmu/cmua_AngryTalk_1_A.bvh" "$out/walk-talk.bvh" --frames 10 --out docs/mechanics/walk-talk.png

blend() {
    "$kinesic" blend "$pack" "$cmu/07_01.bvh" "$cmu/06_02.bvh" --mechanics-window 1..1.5 --expressive-window "$2" --out "$out/$1.bvh"
}
blend blend-together 1..1.5
blend blend-apart 2..3
"$kinesic" sheet "$out/blend-together.bvh" "$out/blend-apart.bvh" --frames 12 --out docs/mechanics/blend.png

"$kinesic" modulate "$pack" "$cmu/05_02.bvh" --amount 0.5 --out "$out/dance-half.bvh"
"$kinesic" modulate "$pack" "$cmu/05_02.bvh" --amount 1.5 --out "$out/dance-more.bvh"
"$kinesic" sheet "$out/dance-half.bvh" "$cmu/05_02.bvh" "$out/dance-more.bvh" --frames 10 --out docs/mechanics/modulate.png
