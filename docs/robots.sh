#!/usr/bin/env bash
# Real robots: joints read, forward kinematics against an independent reader, and the pack of each. Prints the table of docs/robot-models.md.
#
# The descriptions are not part of the repository. KINESIC_ROBOTS is a folder with a git clone (or bare repository) of each, named as below
# or as OWNER+NAME/repo; the commit is taken from it. Needs Python with mujoco and yourdfpy: pip install mujoco yourdfpy
set -euo pipefail
cd "$(dirname "$0")/.."
export KINESIC="${KINESIC:-target/release/kinesic}"
robots="${KINESIC_ROBOTS:-../.mirror}"
python="${PYTHON:-python3}"
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT

# What it is for, repository, commit, file.
cat > "$work/list" <<'END'
humanoid, canted shoulders|unitreerobotics/unitree_mujoco|c598f103acb87a5fd3de7c9037f4dab6aa7f232b|unitree_robots/g1/g1_29dof.xml
humanoid, canted shoulders|FFTAI/Wiki-GRx-Models|7d96c758f048fe1bf92b3258864d94771ae0c093|GRX/GR1/gr1t1/basic_urdf/gr1t1.urdf
humanoid|BoosterRobotics/booster_gym|da396a06d6eed99e2de72d7749c48ee8748950f9|resources/T1/T1_serial.urdf
humanoid, parallel hinges at zero|ros-naoqi/nao_robot|67476469a1371b00b17538eb6ea336367ece7d44|nao_description/urdf/naoV50_generated_urdf/nao.urdf
biped with antennas|apirrone/Open_Duck_Mini|bf2adfbb335016d66a57a09dc1164bd5aa3f1e09|mini_bdx/robots/open_duck_mini_v2/robot.urdf
biped with antennas, MJCF|apirrone/Open_Duck_Mini|bf2adfbb335016d66a57a09dc1164bd5aa3f1e09|mini_bdx/robots/open_duck_mini_v2/robot.xml
head on a platform|pollen-robotics/reachy_mini|70a7c0b12779d5bf5ee17568221f0cab6b2eda4d|src/reachy_mini/descriptions/reachy_mini/urdf/robot_no_collision.urdf
arm with sliders|hello-robot/stretch_urdf|c8c6e27e1f87db126118049f22611399253cbe2b|stretch_urdf/SE3/stretch_description_SE3_eoa_wrist_dw3_tool_sg3.urdf
desk arm|TheRobotStudio/SO-ARM100|fda892cba81032c46c40976a48c9ceadbf40a9ca|Simulation/SO101/so101_new_calib.urdf
desk arm, MJCF|TheRobotStudio/SO-ARM100|fda892cba81032c46c40976a48c9ceadbf40a9ca|Simulation/SO101/so101_new_calib.xml
two arms and a head|pollen-robotics/reachy2_mujoco|96f6c1d3497e0bdb9638e2e5d5df09dff8da253c|reachy2_mujoco/description/original_urdf/reachy2.urdf
END

echo "| robot | file | commit | joints, moving, coordinates | farthest link, mm | degrees |"
echo "|---|---|---|---|---|---|"
while IFS='|' read -r what repository commit file; do
    git="$robots/${repository/\//+}/repo"
    [ -e "$git" ] || git="$robots/${repository##*/}"
    name="$work/robot.${file##*.}"
    if ! git -C "$git" show "$commit:$file" > "$name" 2> /dev/null; then
        echo "missing: $repository at $commit in $robots (git clone https://github.com/$repository)" >&2
        exit 1
    fi
    # An MJCF may include files of its folder.
    git -C "$git" ls-tree --name-only "$commit" "$(dirname "$file")/" | while read -r other; do
        case "$other" in *.xml) git -C "$git" show "$commit:$other" > "$work/$(basename "$other")" ;; esac
    done
    "$KINESIC" robot import "$name" --out "$work/robot.kin" --json --overwrite > "$work/import.json"
    "$python" docs/robots.py "$name" "$work/import.json" "$what" "$repository" "$commit" "$file"
done < "$work/list"
