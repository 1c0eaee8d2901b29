#!/bin/sh
# Runs every command of the cases' INDEX.tsv and prints: input, right value, value now (one line a case).
# usage: docs/cases.sh [KINESIC]; the cases are in $KINESIC_CASES (default ../shared/cases), the faces in $KINESIC_DATA.
set -u
here=$(cd "$(dirname "$0")/.." && pwd)
kinesic=${1:-kinesic}
cases=${KINESIC_CASES:-$here/../shared/cases}
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
portraits=$(find "${KINESIC_DATA:-$here/../shared/data}" -name portraits_landmarks68.csv 2>/dev/null | head -1)
[ -n "$portraits" ] && "$kinesic" train face --landmarks "$portraits" --attribute smile --out "$out/smile.kin" >/dev/null 2>&1
cd "$cases" || exit 1
tail -n +2 INDEX.tsv | while IFS="$(printf '\t')" read -r file kind command right rest; do
    line=$(printf '%s' "$command" | sed -e "s#^kinesic#'$kinesic'#" -e "s#WEARY#'$here/models/weary.kin'#" -e "s#OUT/#$out/#g" -e "s#smile.kin#$out/smile.kin#")
    rm -f "$out"/c.*
    said=$(eval "timeout 120 $line" 2>&1 </dev/null)
    code=$?
    case $line in
        *" inspect "*) said=$(printf '%s' "$said" | grep -v '^joints  ') ;;
        *" limits "*) said=$(printf '%s' "$said" | grep -E 'note|LeftArm|LeftForeArm|Error|×|help') ;;
    esac
    if [ -f "$out/c.bvh" ]; then
        said="$said; $("$kinesic" inspect "$out/c.bvh" 2>/dev/null | grep ^height)"
    fi
    printf '%s | %s | %s | rc %s: %s\n' "$file" "$kind" "$right" "$code" "$(printf '%s' "$said" | tr -s ' \n|' ' ' | cut -c1-420)"
done
