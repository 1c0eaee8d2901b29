#!/usr/bin/env bash
# The tables of docs/emotion.md. Label tables are made from the data's manifest.tsv into a temporary folder; motions, if wanted, go to
# the folder EMOTION_MOTIONS, which must lie outside the repository: they are made from other people's clips.
# usage: docs/emotion.sh [accuracy|blends|keyframes|synthesis|units|mix|turns|playback]...   (default: all)
set -euo pipefail
cd "$(dirname "$0")/.."
data=$(realpath "${KINESIC_DATA:-../shared/data}")
export KINESIC_DATA=$data
cargo build --release --locked -q -p kinesic-host --bins --example emotion_bench --example emotion_sweep
target=${CARGO_TARGET_DIR:-target}/release
kinesic=$target/kinesic
bench=$target/examples/emotion_bench
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# styles SOURCE ACTION: file and label of every clip of an action.
styles() {
    awk -F'\t' -v source="$1" -v action="$2" -v data="$data" '
        NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; print "file\tlabel"; next }
        index($at["file"], source "/") == 1 && $at["action"] == action { print data "/" $at["file"] "\t" $at["style"] }
    ' "$data/manifest.tsv" >"$work/$1-$2.tsv"
}

# blends: the aalto clips by gait, and by whether all weights are 0, 1/2 and 1 (corners) or not (inside).
blends() {
    awk -F'\t' -v work="$work" -v data="$data" '
        NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
        index($at["file"], "aalto/") != 1 { next }
        {
            split("", gaits); angry = sad = gaits_used = 0; part = "corners"
            n = split($at["style"], parts, "+")
            for (i = 1; i <= n; i++) {
                split(parts[i], pair, ":"); weight = pair[2]; split(pair[1], name, "_")
                if (weight > 0 && !(name[1] in gaits)) { gaits[name[1]]; gaits_used++; gait = name[1] }
                if (name[2] == "angry") angry += weight
                if (name[2] == "sad") sad += weight
                if (weight != 0 && weight != 0.5 && weight != 1) part = "inside"
            }
            if (gaits_used > 1) gait = "both"
            row = data "/" $at["file"] "\t" angry "\t" sad
            print row >>(work "/" gait "-" part)
            print row >>(work "/" gait "-all")
            if (gait != "run") { print row >>(work "/any-" part); print row >>(work "/any-all") }
        }' "$data/manifest.tsv"
    for rows in "$work"/*-corners "$work"/*-inside "$work"/*-all; do
        { printf 'file\tangry\tsad\n'; cat "$rows"; } >"$rows.tsv"
    done
}

actions="raise-up-both-hands raise-up-right-hand run walk walk-turn-left wave-both-hands wave-left-hand"
for action in $actions; do styles bandai2 "$action"; done
for action in walk bow bye guide dash run; do styles bandai1 "$action"; done
blends
motions=${EMOTION_MOTIONS:-$work}

# Packs that several tables use; everything is trained on.
"$kinesic" train emotion --labels "$work/bandai1-walk.tsv" --order 'anger:angry>normal>sad' --hold-out 0 \
    --out "$motions/anger.kin" >"$work/anger.txt"
"$kinesic" train emotion --labels "$work/walk-all.tsv" --attribute angry --attribute sad --hold-out 0 \
    --out "$motions/blends.kin" >"$work/blends.txt"

for table in "${@:-accuracy blends keyframes synthesis units mix turns playback}"; do
    for table in $table; do
        echo "== $table"
        case $table in
        accuracy)
            echo "| action | most of it | components | 10 % | 30 % | 50 % | 70 % | 90 % of the pairs |"
            echo "|---|---|---|---|---|---|---|---|"
            for action in $actions; do
                "$bench" accuracy "$work/bandai2-$action.tsv" 'active>normal>exhausted' 'youthful>normal>elderly' 'feminine>normal>masculine'
            done 2>/dev/null | tee "$work/accuracy.txt"
            echo "mean over actions and orders:"
            awk -F'|' '{ for (i = 5; i <= 9; i++) sum[$4, i] += $i; n[$4]++ }
                END { for (k in n) { printf "|%s", k; for (i = 5; i <= 9; i++) printf "| %.1f ", sum[k, i] / n[k]; print "|" } }' "$work/accuracy.txt" | sort
            ;;
        blends)
            echo "| trained on | tested on | of | clips | Spearman | pairs right, % | speed of the root | speed of the hands | labels shuffled |"
            echo "|---|---|---|---|---|---|---|---|---|"
            for pair in "walk-corners walk-inside" "limp-corners limp-inside" "any-corners any-inside" "walk-all limp-all" "limp-all walk-all"; do
                read -r trained tested <<<"$pair"
                "$bench" transfer "$work/$trained.tsv" "$work/$tested.tsv" angry sad
            done
            ;;
        keyframes)
            for name in bandai1-walk bandai2-raise-up-both-hands bandai2-wave-left-hand; do
                order='active>normal>exhausted'
                [[ $name == bandai1-walk ]] && order='angry>normal>sad'
                echo "$name, cm | keyframes | uniform | the same for all, found in each | each motion's own |"
                "$bench" keyframes "$work/$name.tsv" "$order" 2>/dev/null
            done
            ;;
        synthesis)
            cat "$work/anger.txt"
            "$bench" synthesis "$motions/anger.kin"
            ;;
        units)
            for units in 3 10; do
                for action in raise-up-both-hands wave-left-hand run walk; do
                    "$kinesic" train emotion --labels "$work/bandai2-$action.tsv" --order 'active>normal>exhausted' --hold-out 0 \
                        --hidden "$units" --out "$motions/$action-$units.kin" >/dev/null
                    echo "$units units, bandai2, $action:"
                    "$bench" synthesis "$motions/$action-$units.kin" | tail -1
                done
                "$kinesic" train emotion --labels "$work/bandai1-walk.tsv" --order 'happy>normal>sad' \
                    --order 'anger:angry>normal=happy=sad' --hold-out 0 --hidden "$units" --out "$motions/two-$units.kin" >/dev/null
                echo "$units units, bandai1, walk, two attributes:"
                "$bench" synthesis "$motions/two-$units.kin" | grep Spearman
            done
            ;;
        mix)
            cat "$work/blends.txt"
            "$bench" mix "$motions/blends.kin"
            "$kinesic" train emotion --labels "$work/bandai1-walk.tsv" --order 'happy>normal>sad' \
                --order 'anger:angry>normal=happy=sad' --hold-out 0 --out "$motions/two.kin" >/dev/null
            "$bench" mix "$motions/two.kin"
            ;;
        turns)
            "$bench" turns "$motions/anger.kin" "$work/bandai1-walk.tsv" 'anger:angry>normal>sad'
            for action in walk raise-up-both-hands wave-left-hand; do
                "$kinesic" train emotion --labels "$work/bandai2-$action.tsv" --order 'active>normal>exhausted' --hold-out 0 \
                    --out "$motions/$action.kin" >/dev/null
                "$bench" turns "$motions/$action.kin" "$work/bandai2-$action.tsv" 'active>normal>exhausted'
            done
            ;;
        playback)
            for action in walk raise-up-both-hands wave-left-hand; do
                "$kinesic" train emotion --labels "$work/bandai2-$action.tsv" --order 'exhausted>normal>youthful' --hold-out 0 \
                    --out "$motions/tired-$action.kin" >/dev/null
            done
            "$target/examples/emotion_sweep" "$motions"/tired-*.kin "$motions/anger.kin" "$motions/blends.kin"
            ;;
        *) echo "docs/emotion.sh: no table is called $table" >&2; exit 1 ;;
        esac
    done
done
