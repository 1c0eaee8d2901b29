#!/usr/bin/env bash
# Prints the tables of docs/quality.md. About six minutes on two cores. Needs the real clips (KINESIC_DATA).
# usage: docs/quality.sh [xia|swap|eye|strengths|feet|live|strange|actions|child|people|recognition|several]...   (default: all)
set -euo pipefail
cd "$(dirname "$0")/.."
data=$(realpath "${KINESIC_DATA:-../shared/data}")
cargo build --release --locked -q -p kinesic-host
kinesic=${CARGO_TARGET_DIR:-target}/release/kinesic
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# First occurrence of a number in the JSON of the command: the mean over the pairs.
value() { grep -m1 "\"$2\":" "$1" | tr -dc '0-9.-'; }
# angle FILE WHO WHAT: the first mean angle of WHO (error, identity, offset, affine) over WHAT (all, leaves), open ends.
angle() {
    awk -v who="\"$2\": {" -v what="\"$3\":" \
        '/"open_degrees": \{/ { in_degrees = 1 } in_degrees && index($0, who) { in_who = 1 }
         in_who && index($0, what) { gsub(/[^0-9.-]/, ""); print; exit }' "$1"
}
word() { grep -m1 "\"$2\":" "$1" | cut -d'"' -f4; }
number() { printf ' %.1f |' "$(value "$1" "$2")"; }

# Adds numbers of a file to the record that means are taken of.
record() { local file=$1 key; shift; for key in "$@"; do printf '%s ' "$(value "$file" "$key")" >>"$work/all"; done; }
end_record() { echo >>"$work/all"; }

# xia TAKE_TO_TRAIN TAKE_TO_TEST
xia() {
    local clips=$data/xia style form options who what
    echo
    echo "Trained on take $1, tested on take $2; open ends, cm"
    echo
    echo "| style | identity | offset | affine | per joint | whole body | **chosen** | floor | chosen: alignment, model |"
    echo "|---|---|---|---|---|---|---|---|---|"
    : >"$work/all"
    for style in angry childlike depressed old proud sexy strutting; do
        for form in per-joint whole-body auto; do
            "$kinesic" train translate --pair "$clips/neutral_01_$1.bvh" "$clips/${style}_01_$1.bvh" --form $form \
                --out "$work/$form.kin" --json >"$work/$form.train"
            "$kinesic" eval translate "$work/$form.kin" --json \
                --pair "$clips/neutral_01_$2.bvh" "$clips/${style}_01_$2.bvh" >"$work/$form"
        done
        # Doing nothing to one take and comparing with the other: what two takes of a style differ by.
        "$kinesic" eval translate "$work/auto.kin" --json \
            --pair "$clips/${style}_01_$1.bvh" "$clips/${style}_01_$2.bvh" >"$work/floor"
        record "$work/auto" open_identity_cm open_offset_cm open_affine_cm
        for form in per-joint whole-body auto; do record "$work/$form" open_error_cm; done
        record "$work/floor" open_identity_cm
        record "$work/auto" identity_cm offset_cm affine_cm error_cm
        record "$work/floor" identity_cm
        for what in all leaves; do
            for who in identity offset affine error; do printf '%s ' "$(angle "$work/auto" $who $what)" >>"$work/all"; done
            printf '%s ' "$(angle "$work/floor" identity $what)" >>"$work/all"
        done
        end_record
        printf '| %s |' "$style"
        for key in open_identity_cm open_offset_cm open_affine_cm; do number "$work/auto" $key; done
        for form in per-joint whole-body; do number "$work/$form" open_error_cm; done
        printf ' **%.1f** |' "$(value "$work/auto" open_error_cm)"
        number "$work/floor" open_identity_cm
        echo " $(word "$work/auto.train" alignment), $(word "$work/auto.train" model) |"
    done
    awk '{ for (i = 1; i <= NF; i++) sum[i] += $i / 7 }
        END {
            printf "| **mean** | %.2f | %.2f | %.2f | %.2f | %.2f | **%.2f** | %.2f | |\n\n",
                sum[1], sum[2], sum[3], sum[4], sum[5], sum[6], sum[7]
            print "Means over the 7 styles with both measures, cm\n"
            print "| ends | identity | offset | affine | chosen | floor |\n|---|---|---|---|---|---|"
            printf "| open | %.2f | %.2f | %.2f | %.2f | %.2f |\n", sum[1], sum[2], sum[3], sum[6], sum[7]
            printf "| closed | %.2f | %.2f | %.2f | %.2f | %.2f |\n", sum[8], sum[9], sum[10], sum[11], sum[12]
            print "\nMean angle of a joint to its target over the 7 styles, open ends, degrees\n"
            print "| joints | identity | offset | affine | chosen | floor |\n|---|---|---|---|---|---|"
            printf "| all | %.2f | %.2f | %.2f | **%.2f** | %.2f |\n", sum[13], sum[14], sum[15], sum[16], sum[17]
            printf "| leaves: head, hands, toes | %.2f | %.2f | %.2f | **%.2f** | %.2f |\n", sum[18], sum[19], sum[20], sum[21], sum[22]
        }' "$work/all"
}

# feet_table SKELETON FEET...
feet_table() {
    local on=$1
    shift
    local clips=$data/xia styles=(angry childlike depressed old proud sexy strutting) style clip feet strength
    for style in "${styles[@]}"; do
        "$kinesic" train translate --pair "$clips/neutral_01_000.bvh" "$clips/${style}_01_000.bvh" --out "$work/$style.kin" --json >"$work/train"
    done
    echo
    echo "Feet: xia's styles on other walks, on the skeleton of the $on, strengths .5 and 1; mean and worst of 14 results"
    echo
    echo "| clip | feet | in step, mean | worst | slide, mean | worst | jerk, mean | worst |"
    echo "|---|---|---|---|---|---|---|---|"
    for clip in cmu31/07_01 cmu31/08_01 cmu31/35_01 m21/style/DEPRESSED m21/style/STRUTTING-1; do
        for feet in "$@"; do
            : >"$work/all"
            for style in "${styles[@]}"; do
                for strength in 0.5 1; do
                    "$kinesic" apply "$work/$style.kin" "$data/$clip.bvh" --out "$work/out.bvh" --strength $strength --on "$on" --feet $feet --json \
                        2>/dev/null >"$work/one"
                    python3 - "$work/one" >>"$work/all" <<'PYTHON'
import json, sys
result = json.load(open(sys.argv[1]))
before, after = result["source"], result["styled"]
ratio = lambda key: after[key] / max(before[key], 1e-9)
print(min(x for x in result["step"] if x is not None), ratio("foot_slide_cm_s"), ratio("jerk_m_s3"))
PYTHON
                done
            done
            awk -v clip="$clip" -v feet="$feet" 'NR == 1 { low = $1 }
                { step += $1; slide += $2; jerk += $3; if ($1 < low) low = $1; if ($2 > far) far = $2; if ($3 > rough) rough = $3 }
                END { printf "| %s | %s | %.2f | %.2f | %.2f | %.2f | %.2f | %.2f |\n", clip, feet, step / NR, low, slide / NR, far, jerk / NR, rough }' "$work/all"
        done
    done
}

# What walks taught, on what is no walk.
# Packs of walks on other actions of the same actors.
actions_table() {
    local clips=$data/bandai2 styles=(active elderly exhausted feminine masculine youthful) style action
    for style in "${styles[@]}"; do
        "$kinesic" train translate --pair "$clips/walk_normal_001.bvh" "$clips/walk_${style}_001.bvh" \
            --pair "$clips/walk_normal_002.bvh" "$clips/walk_${style}_002.bvh" --out "$work/$style.kin" >/dev/null 2>&1
    done
    echo
    echo "Bandai-2's walks on other actions of the same actors, six styles, open ends, cm"
    echo
    echo "| action | doing nothing | **pack of walks** | worst against doing nothing | unlike, % |"
    echo "|---|---|---|---|---|"
    for action in walk walk-turn-left run wave-left-hand wave-both-hands raise-up-right-hand raise-up-both-hands; do
        : >"$work/all"
        for style in "${styles[@]}"; do
            "$kinesic" eval translate "$work/$style.kin" --pair "$clips/${action}_normal_003.bvh" \
                "$clips/${action}_${style}_003.bvh" --json >"$work/one" 2>/dev/null
            "$kinesic" apply "$work/$style.kin" "$clips/${action}_normal_003.bvh" --out "$work/o.bvh" --overwrite --json >"$work/two" 2>/dev/null
            echo "$(value "$work/one" open_identity_cm) $(value "$work/one" open_error_cm) $(value "$work/two" unfamiliar_percent)" >>"$work/all"
        done
        awk -v action="$action" '{ none += $1; error += $2; unlike += $3; if (NR == 1 || $2 - $1 > worst) worst = $2 - $1 }
            END { printf "| %s | %.1f | **%.1f** | %+.1f | %.0f |\n", action, none / NR, error / NR, worst, unlike / NR }' "$work/all"
    done
}
strange_table() {
    local clips=$data/xia styles=(angry childlike depressed old proud sexy strutting) style clip path
    for style in "${styles[@]}"; do
        "$kinesic" train translate --pair "$clips/neutral_01_000.bvh" "$clips/${style}_01_000.bvh" --out "$work/$style.kin" >/dev/null 2>&1
    done
    # A walk played backwards.
    awk '/^Frame Time/ { print; motion = 1; next } !motion { print; next } NF { row[n++] = $0 } END { while (n) print row[--n] }' \
        "$data/cmu31/07_01.bvh" >"$work/backwards.bvh"
    echo
    echo "Xia's walks on other motions, seven styles: unlike the training, travel, range of the wrist that moves more, jerk over the clip's"
    echo
    echo "| clip | unlike, % | travel, clip, m | least | most | wrist, least | most | jerk, mean | worst |"
    echo "|---|---|---|---|---|---|---|---|---|"
    for clip in m21/content/box-1 bandai2/wave-left-hand_normal_001 bandai2/wave-both-hands_normal_001 bandai1/punch_normal_001 \
        bandai1/slash_normal_001 bandai1/bye_normal_001 bandai1/respond_normal_001 backwards cmu31/07_01; do
        path=$data/$clip.bvh
        [ $clip = backwards ] && path=$work/backwards.bvh
        "$kinesic" apply "$work/angry.kin" "$path" --strength 0 --out "$work/before.positions.csv" >/dev/null 2>&1
        : >"$work/all"
        for style in "${styles[@]}"; do
            "$kinesic" apply "$work/$style.kin" "$path" --out "$work/after.positions.csv" --json 2>/dev/null >"$work/one"
            echo "$(python3 docs/strange.py "$work/before.positions.csv" "$work/after.positions.csv") $(python3 -c '
import json, sys
result = json.load(open(sys.argv[1]))
print(result["unfamiliar_percent"], result["styled"]["jerk_m_s3"] / result["source"]["jerk_m_s3"])' "$work/one")" >>"$work/all"
        done
        awk -v clip="$clip" 'NR == 1 { near = far = $2; low = high = $3 }
            { if ($2 < near) near = $2; if ($2 > far) far = $2; if ($3 < low) low = $3; if ($3 > high) high = $3
              unlike += $4; jerk += $5; if ($5 > rough) rough = $5 }
            END { printf "| %s | %.0f | %.2f | %.2f | %.2f | %.2f | %.2f | %.2f | %.2f |\n",
                clip, unlike / NR, $1, near, far, low, high, jerk / NR, rough }' "$work/all"
    done
}

eye_table() {
    local clips=$data/xia style
    for style in angry childlike depressed old proud sexy strutting; do
        "$kinesic" train translate --pair "$clips/neutral_01_000.bvh" "$clips/${style}_01_000.bvh" --out "$work/$style.kin" --json >"$work/train"
        "$kinesic" eval translate "$work/$style.kin" --pair "$clips/neutral_01_001.bvh" "$clips/${style}_01_001.bvh" --json >"$work/$style.eye"
    done
    echo
    echo "What the eye sees first, take 001, mean of the 7 styles; feet free"
    echo
    python3 - "$work"/*.eye <<'PYTHON'
import json, sys
found = [json.load(open(path))["quality"] for path in sys.argv[1:]]
mean = lambda of: sum(map(of, found)) / len(found)
print("| motion | foot slide, cm/s | standing, % | steps a minute | jerk, m/s^3 | lean, degrees | posture, degrees |")
print("|---|---|---|---|---|---|---|")
for name in ["source", "target", "result"]:
    keys = [("foot_slide_cm_s", 1), ("standing_percent", 0), ("steps_a_minute", 0), ("jerk_m_s3", 0), ("lean_degrees", 1)]
    cells = [f"{mean(lambda q: q[name][key]):.{digits}f}" for key, digits in keys]
    key = f"{name}_posture_degrees"
    cells.append(f"{mean(lambda q: q[key]):.1f}" if key in found[0] else "-")
    print(f"| {name} | " + " | ".join(cells) + " |")
PYTHON
}

strengths_table() {
    local clips=$data/xia style row=()
    cargo build --release --locked -q -p kinesic-host --example plausible
    for style in angry childlike depressed old proud sexy strutting; do
        "$kinesic" train translate --pair "$clips/neutral_01_000.bvh" "$clips/${style}_01_000.bvh" --out "$work/$style.kin" --json >"$work/train"
        row+=("$clips/neutral_01_000.bvh" "$clips/${style}_01_000.bvh" "$work/$style.kin")
    done
    echo
    echo "Plausible strengths, from 0 to"
    echo
    "${kinesic%/*}/examples/plausible" "${row[@]}"
}

# child PERSON: trained on everybody else
child() {
    local table=(--pairs "$data/pairs.tsv" --where style=child)
    "$kinesic" train translate "${table[@]}" --where "neutral!~$1" --out "$work/child.kin" --json >"$work/train"
    "$kinesic" eval translate "$work/child.kin" "${table[@]}" --where "neutral~$1" --json >"$work/eval"
}

child_table() {
    local table=(--pairs "$data/pairs.tsv" --where style=child)
    child p734
    echo
    echo "Adult -> child: trained on six pairs of people (75 pairs of clips), tested on p734 -> p723; closed ends, cm"
    echo "Chosen: $(word "$work/train" alignment), $(word "$work/train" model)"
    echo
    echo "| action | identity | offset | affine | **chosen** | other children |"
    echo "|---|---|---|---|---|---|"
    local action key child others
    : >"$work/all"
    for action in $(grep -o 'p734_[^/"]*\.csv' "$work/eval" | sort -u | sed 's/p734_//; s/\.csv//'); do
        "$kinesic" eval translate "$work/child.kin" "${table[@]}" --where neutral~p734 --where "content=$action" --json >"$work/one"
        others=()
        for child in p103 p106 p169 p290 p337 p644; do
            [ -f "$data/kindergator/child/${child}_$action.csv" ] || continue
            others+=(--pair "$data/kindergator/child/${child}_$action.csv" "$data/kindergator/child/p723_$action.csv")
        done
        "$kinesic" eval translate "$work/child.kin" "${others[@]}" --json >"$work/others"
        printf '| %s |' "$action"
        for key in identity_cm offset_cm affine_cm; do number "$work/one" $key; done
        printf ' **%.1f** |' "$(value "$work/one" error_cm)"
        number "$work/others" identity_cm
        echo
        record "$work/one" identity_cm offset_cm affine_cm error_cm
        record "$work/others" identity_cm
        end_record
    done
    awk '{ for (i = 1; i <= 5; i++) sum[i] += $i }
        END { printf "| **mean** | %.2f | %.2f | %.2f | **%.2f** | %.2f |\n", sum[1] / NR, sum[2] / NR, sum[3] / NR, sum[4] / NR, sum[5] / NR }' "$work/all"
}

people_table() {
    echo
    echo "Every pair of people held back in turn; closed ends, cm"
    echo
    echo "| held back | identity | offset | affine | chosen | model |"
    echo "|---|---|---|---|---|---|"
    : >"$work/all"
    for person in p565 p577 p604 p734 p876 p934 p970; do
        child $person
        printf '| %s |' $person
        for key in identity_cm offset_cm affine_cm error_cm; do
            number "$work/eval" $key
            record "$work/eval" $key
        done
        end_record
        echo " $(word "$work/train" model) |"
    done
    awk '{ for (i = 1; i <= 4; i++) sum[i] += $i / 7 }
        END { printf "| **mean** | %.2f | %.2f | %.2f | %.2f | |\n", sum[1], sum[2], sum[3], sum[4] }' "$work/all"
}

for part in "${@:-xia swap eye strengths feet live strange actions child people recognition several}"; do
    for table in $part; do
        case $table in
        xia) xia 000 001 ;;
        swap) xia 001 000 ;;
        eye) eye_table ;;
        strengths) strengths_table ;;
        feet) feet_table clip lock free ;;
        live) feet_table pack lock live free ;;
        strange) strange_table ;;
        actions) actions_table ;;
        child) child_table ;;
        people) people_table ;;
        recognition) KINESIC_DATA=$data cargo run --release --locked -q -p kinesic-benches --bin recognition ;;
        several) KINESIC_DATA=$data cargo run --release --locked -q -p kinesic-benches --bin recognition -- several ;;
        *) echo "no table $table" >&2; exit 2 ;;
        esac
    done
done
