#!/usr/bin/env bash
# Recorded walks and waves on real robots, and a style trained on them. Prints the tables of docs/retarget.md.
#
# KINESIC_ROBOTS is a folder of descriptions as docs/robots.sh takes it, KINESIC_DATA the folder of clips. Neither is part of the repository.
set -euo pipefail
cd "$(dirname "$0")/.."
kinesic="${KINESIC:-target/release/kinesic}"
robots="${KINESIC_ROBOTS:-../.mirror}"
data="${KINESIC_DATA:-../shared/data}"
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
walk=xia/neutral_01_000.bvh
wave=bandai2/wave-left-hand_normal_001.bvh

# An arm on a lift that reaches to the robot's right: its head looks along x, its arm is in front of who stands there.
cat > "$work/stretch.toml" <<'END'
forward = "-y"
[limbs]
head = { from = "joint_head_tilt", bone = [1, 0, 0] }
r_arm = { from = "joint_head", to = "joint_wrist_yaw", length = 1.0 }
r_hand = ["joint_wrist_pitch", "joint_grasp_center"]
END
# An arm on a table has no upper arm that hangs down: all of it is the forearm and the hand.
cat > "$work/so101.toml" <<'END'
[limbs]
l_forearm = ["shoulder_lift", "elbow_flex"]
l_hand = ["elbow_flex", "gripper_frame_link"]
END
# Reachy Mini's own inverse kinematics takes a pose; the limits are those of its AGENTS.md, lengths are small.
cat > "$work/mini-servos.toml" <<'END'
name = "reachy mini"
[[servo]]
name = "body_yaw"
unit = "deg"
min = -160
max = 160
[[servo]]
name = "right_antenna"
unit = "rad"
min = -3.14
max = 3.14
[[servo]]
name = "left_antenna"
unit = "rad"
min = -3.14
max = 3.14
[[pose]]
name = "head"
min = [-0.02, -0.02, -0.02, -0.698, -0.698, -3.14]
max = [0.02, 0.02, 0.02, 0.698, 0.698, 3.14]
END
cat > "$work/mini.toml" <<'END'
[limbs]
head = "head_roll"
END

# Name, repository, commit, file, map (or the one of --suggest-map), clips.
cat > "$work/list" <<END
Unitree G1|unitreerobotics/unitree_mujoco|c598f103acb87a5fd3de7c9037f4dab6aa7f232b|unitree_robots/g1/g1_29dof.xml||$walk $wave
Fourier GR1|FFTAI/Wiki-GRx-Models|7d96c758f048fe1bf92b3258864d94771ae0c093|GRX/GR1/gr1t1/basic_urdf/gr1t1.urdf||$walk $wave
Booster T1|BoosterRobotics/booster_gym|da396a06d6eed99e2de72d7749c48ee8748950f9|resources/T1/T1_serial.urdf||$walk $wave
NAO|ros-naoqi/nao_robot|67476469a1371b00b17538eb6ea336367ece7d44|nao_description/urdf/naoV50_generated_urdf/nao.urdf||$walk $wave bandai2/wave-both-hands_active_001.bvh
Open Duck Mini|apirrone/Open_Duck_Mini|bf2adfbb335016d66a57a09dc1164bd5aa3f1e09|mini_bdx/robots/open_duck_mini_v2/robot.urdf||$walk
Reachy 2|pollen-robotics/reachy2_mujoco|96f6c1d3497e0bdb9638e2e5d5df09dff8da253c|reachy2_mujoco/description/original_urdf/reachy2.urdf||$walk $wave
Reachy Mini|||mini.kin|mini|$walk $wave
Stretch 3|hello-robot/stretch_urdf|c8c6e27e1f87db126118049f22611399253cbe2b|stretch_urdf/SE3/stretch_description_SE3_eoa_wrist_dw3_tool_sg3.urdf|stretch|$walk bandai1/guide_normal_001.bvh
SO-101|TheRobotStudio/SO-ARM100|fda892cba81032c46c40976a48c9ceadbf40a9ca|Simulation/SO101/so101_new_calib.urdf|so101|$wave
END

"$kinesic" robot import "$work/mini-servos.toml" --out "$work/mini.kin" > "$work/log"
echo "| robot | clip, frames | limbs: median, 95 % | at a limit, share of frames | of a speed limit | beyond |"
echo "|---|---|---|---|---|---|"
while IFS='|' read -r name repository commit file map clips; do
    robot="$work/$(basename "$file")"
    if [ -n "$repository" ]; then
        git="$robots/${repository/\//+}/repo"
        [ -e "$git" ] || git="$robots/${repository##*/}"
        if ! git -C "$git" show "$commit:$file" > "$robot" 2> /dev/null; then
            echo "missing: $repository at $commit in $robots (git clone https://github.com/$repository)" >&2
            exit 1
        fi
    fi
    for clip in $clips; do
        "$kinesic" robot retarget "$robot" "$data/$clip" ${map:+--map "$work/$map.toml"} --out "$work/moves.csv" --json > "$work/report.json"
        python3 - "$name" "$clip" "$work/report.json" "$robot" "$work/moves.csv" <<'END'
import csv
import json
import sys
import xml.etree.ElementTree as tree

name, clip, path, robot, moves = sys.argv[1:]
report = json.load(open(path))
limbs = {}
for limb in report["limbs"]:
    side, _, part = limb["limb"].partition("_")
    key = (part, side.upper()) if side in ("l", "r") else (limb["limb"], "")
    length = f" (length {100 * limb['length_p95']:.0f} %)" if "length_p95" in limb else ""
    limbs.setdefault(key[0].replace("_", " "), []).append(f"{key[1]} {limb['median']:.1f}, {limb['p95']:.1f}{length}".strip())
cells = "; ".join(f"{part} {' '.join(sides)}" for part, sides in limbs.items())
at = ", ".join(f"{x['joint']} {100 * x['share']:.0f} %" for x in report["at_limit"]) or "-"
quickest = report["quickest"]
speed = f"{100 * quickest['share']:.0f} % ({quickest['joint']})" if quickest else "none given"
beyond = report["limits_exceeded"] + report["speeds_exceeded"]
# A URDF's limits once more, against what was written.
if robot.endswith(".urdf"):
    header, *rows = csv.reader(open(moves))
    times, *columns = zip(*(map(float, row) for row in rows))
    values = {name.rsplit("_", 1)[0]: column for name, column in zip(header[1:], columns)}
    for joint in tree.parse(robot).getroot().findall("joint"):
        limit, own = joint.find("limit"), values.get(joint.get("name"))
        if limit is None or own is None:
            continue
        if joint.get("type") != "continuous":
            beyond += sum(not float(limit.get("lower", 0)) <= x <= float(limit.get("upper", 0)) for x in own)
        most = float(limit.get("velocity", 0)) or float("inf")
        steps = zip(own, own[1:], times, times[1:])
        beyond += sum(abs(b - a) > most * (u - t) for a, b, t, u in steps)
print(f"| {name} | `{clip.split('/')[1][:-4]}`, {report['frames']} | {cells} | {at} | {speed} | {beyond} |")
for line in report["cannot"]:
    print(f"{name}, {clip}: cannot: {line}", file=sys.stderr)
END
        # Every value is read back with the robot's own pack, and none is outside its range.
        case "$robot" in
            *.kin) pack="$robot" ;;
            *) pack="$work/robot.kin" && "$kinesic" robot import "$robot" --out "$pack" --overwrite > "$work/log" ;;
        esac
        if "$kinesic" inspect "$work/moves.csv" --robot "$pack" | grep "outside its range"; then exit 1; fi
    done
done < "$work/list"

# A style on NAO: neutral walks and sad ones, a pair that was not trained on.
"$kinesic" robot import "$work/nao.urdf" --out "$work/nao.kin" > "$work/log"
for style in neutral depressed; do
    for take in 01_000 01_001; do
        "$kinesic" robot retarget "$work/nao.urdf" "$data/xia/${style}_$take.bvh" --robot "$work/nao.kin" --fps 50 \
            --out "$work/${style}_$take.csv" > "$work/log" 2>&1
    done
done
"$kinesic" train translate --robot "$work/nao.kin" --pair "$work/neutral_01_000.csv" "$work/depressed_01_000.csv" --out "$work/sad.kin" \
    > "$work/log" 2>&1
echo
"$kinesic" eval translate "$work/sad.kin" --pair "$work/neutral_01_001.csv" "$work/depressed_01_001.csv"
"$kinesic" apply "$work/sad.kin" "$work/neutral_01_001.csv" --out "$work/sad.csv"
