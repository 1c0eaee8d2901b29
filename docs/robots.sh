#!/bin/sh
# Reads real robots with kinesic and with independent readers (MuJoCo, yourdfpy), and prints the table of docs/robot.md.
# usage: docs/robots.sh [KINESIC]
# Repositories are bare or whole clones in $KINESIC_ROBOTS (default /work/.mirror), as OWNER+NAME/repo or OWNER+NAME.
# Needs: python3 with `pip install mujoco yourdfpy numpy`; $PYTHON names it. Nothing of the robots is kept.
set -u
here=$(cd "$(dirname "$0")" && pwd)
kinesic=${1:-kinesic}
robots=${KINESIC_ROBOTS:-/work/.mirror}
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
echo "| robot | repository, commit | file | joints read | worst link, mm | worst link, degrees |"
echo "|---|---|---|---|---|---|"
while IFS='|' read -r name repository commit file; do
    [ -n "$name" ] || continue
    folder=$robots/$(echo "$repository" | tr / +)
    [ -d "$folder/repo" ] && folder=$folder/repo
    root=$out/$name
    mkdir -p "$root"
    # An MJCF may include files beside it.
    beside=$(dirname "$file")
    git -C "$folder" ls-tree --name-only "$commit" "$beside/" | grep -E '\.(xml|urdf)$' | while read -r path; do
        git -C "$folder" show "$commit:$path" >"$root/$(basename "$path")"
    done
    "${PYTHON:-python3}" "$here/robots.py" "$kinesic" "$root/$(basename "$file")" >"$out/row" 2>"$out/error" ||
        echo "not checked: $(tail -1 "$out/error") | |" >"$out/row"
    echo "| $name | $repository @ $(echo "$commit" | cut -c1-10) | \`$file\` | $(cat "$out/row") |"
done <<'END'
Unitree G1 (29)|unitreerobotics/unitree_mujoco|c598f103acb87a5fd3de7c9037f4dab6aa7f232b|unitree_robots/g1/g1_29dof.xml
Unitree G1 with hands|unitreerobotics/unitree_rl_gym|276801e46c5d433564f24658bac64f254b7d2d4b|resources/robots/g1_description/g1_29dof_with_hand.urdf
Unitree H1|unitreerobotics/unitree_rl_gym|276801e46c5d433564f24658bac64f254b7d2d4b|resources/robots/h1/urdf/h1.urdf
Fourier GR3|FFTAI/Wiki-GRx-Models|7d96c758f048fe1bf92b3258864d94771ae0c093|GRX/GR3/gr3v2_1_1/mjcf/gr3v2_1_1.xml
Fourier GR1T2|FFTAI/Wiki-GRx-Models|7d96c758f048fe1bf92b3258864d94771ae0c093|GRX/GR1/gr1t2/urdf/gr1t2_fourier_hand_6dof.urdf
Booster T1|BoosterRobotics/booster_gym|da396a06d6eed99e2de72d7749c48ee8748950f9|resources/T1/T1_serial.xml
Open Duck Mini|apirrone/Open_Duck_Playground|f82b5e7d1d010fa5e518215019034a3346e7b9fc|playground/open_duck_mini_v2/xmls/open_duck_mini_v2.xml
Open Duck Mini (URDF)|apirrone/Open_Duck_Mini|bf2adfbb335016d66a57a09dc1164bd5aa3f1e09|mini_bdx/robots/open_duck_mini_v2/robot.urdf
Reachy Mini|pollen-robotics/reachy_mini|70a7c0b12779d5bf5ee17568221f0cab6b2eda4d|src/reachy_mini/descriptions/reachy_mini/mjcf/reachy_mini.xml
Reachy Mini (URDF)|pollen-robotics/reachy_mini|70a7c0b12779d5bf5ee17568221f0cab6b2eda4d|src/reachy_mini/descriptions/reachy_mini/urdf/robot.urdf
Reachy 2|pollen-robotics/reachy2_mujoco|96f6c1d3497e0bdb9638e2e5d5df09dff8da253c|reachy2_mujoco/description/mjcf/reachy2.xml
SO-ARM100|TheRobotStudio/SO-ARM100|fda892cba81032c46c40976a48c9ceadbf40a9ca|Simulation/SO100/so100.urdf
SO-ARM101|TheRobotStudio/SO-ARM100|fda892cba81032c46c40976a48c9ceadbf40a9ca|Simulation/SO101/so101_new_calib.xml
Stretch 3 (sliders)|hello-robot/stretch_mujoco|d107e094cc295d92f7461bd233daef96e9e22fab|stretch_mujoco/models/stretch.xml
Stretch SE3 (URDF)|hello-robot/stretch_urdf|c8c6e27e1f87db126118049f22611399253cbe2b|stretch_urdf/SE3/stretch_description_SE3_eoa_wrist_dw3_tool_sg3.urdf
Franka Panda with gripper|Gepetto/example-robot-data|39aa94379908fa743da90b21dc9e1fb8308f746b|robots/panda_description/urdf/panda.urdf
Romeo|Gepetto/example-robot-data|39aa94379908fa743da90b21dc9e1fb8308f746b|robots/romeo_description/urdf/romeo.urdf
TALOS|Gepetto/example-robot-data|39aa94379908fa743da90b21dc9e1fb8308f746b|robots/talos_data/robots/talos_full_v2.urdf
END
