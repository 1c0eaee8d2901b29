"""The part of docs/robots.sh that compares: joints and link frames of real robots, kinesic against yourdfpy and MuJoCo."""

import json
import os
import subprocess
import sys
import xml.etree.ElementTree as ET

import numpy as np

KINESIC, CLONES, DATA, WORK = sys.argv[1:]
WALK = "xia/neutral_01_000.bvh"
WAVE = "bandai2/wave-both-hands_active_001.bvh"

# name, repository, commit, file, has limbs of a person
G1, BOOSTER = "unitreerobotics/unitree_rl_gym", "BoosterRobotics/booster_gym"
ROBOTS = [
    ("Unitree G1", G1, "276801e4", "resources/robots/g1_description/g1_29dof.urdf", True),
    ("Unitree G1", "unitreerobotics/unitree_mujoco", "c598f103", "unitree_robots/g1/g1_29dof.xml", True),
    ("Unitree H1-2", G1, "276801e4", "resources/robots/h1_2/h1_2.urdf", True),
    ("Booster T1", BOOSTER, "da396a06", "resources/T1/T1_serial.urdf", True),
    ("Booster T1", BOOSTER, "da396a06", "resources/T1/T1_serial.xml", True),
    ("Romeo", "Gepetto/example-robot-data", "39aa9437", "robots/romeo_description/urdf/romeo.urdf", True),
    ("iCub", "Gepetto/example-robot-data", "39aa9437", "robots/icub_description/robots/icub.urdf", True),
    ("Open Duck Mini 2", "apirrone/Open_Duck_Mini", "bf2adfbb", "mini_bdx/robots/open_duck_mini_v2/robot.urdf", True),
    ("Open Duck Mini 2", "apirrone/Open_Duck_Mini", "bf2adfbb", "mini_bdx/robots/open_duck_mini_v2/robot.xml", True),
    ("Reachy Mini", "pollen-robotics/reachy_mini", "70a7c0b1", "src/reachy_mini/descriptions/reachy_mini/urdf/robot.urdf", False),
    ("Reachy Mini", "pollen-robotics/reachy_mini", "70a7c0b1", "src/reachy_mini/descriptions/reachy_mini/mjcf/reachy_mini.xml", False),
    ("SO-101", "TheRobotStudio/SO-ARM100", "fda892cb", "Simulation/SO101/so101_new_calib.urdf", True),
    ("SO-101", "TheRobotStudio/SO-ARM100", "fda892cb", "Simulation/SO101/so101_new_calib.xml", True),
    ("Stretch 3", "hello-robot/stretch_urdf", "c8c6e27e", "stretch_urdf/SE3/stretch_description_SE3_eoa_wrist_dw3_tool_sg3.urdf", False),
    ("Panda", "Gepetto/example-robot-data", "39aa9437", "robots/panda_description/urdf/panda.urdf", False),
]


def files(repository, commit, path):
    """Copies the description, and what is beside it in text, out of the clone. Gives its path."""
    clone = f"{CLONES}/{repository.replace('/', '+')}/repo"
    git = lambda *args: subprocess.run(["git", f"--git-dir={clone}", *args], capture_output=True, check=True).stdout
    if not git("rev-parse", "HEAD").decode().startswith(commit):
        git("cat-file", "-e", commit)
    folder = os.path.dirname(path)
    out = f"{WORK}/{repository.replace('/', '+')}"
    for name in git("ls-tree", "-r", "--name-only", commit, folder + "/").decode().split("\n"):
        if name.endswith((".urdf", ".xml")):
            os.makedirs(os.path.dirname(f"{out}/{name}"), exist_ok=True)
            with open(f"{out}/{name}", "wb") as file:
                file.write(git("show", f"{commit}:{name}"))
    return f"{out}/{path}"


def kinesic(*args):
    done = subprocess.run([KINESIC, *args], capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError(done.stderr)
    return json.loads(done.stdout)


def urdf_frames(path, poses):
    import yourdfpy

    robot = yourdfpy.URDF.load(path, load_meshes=False, load_collision_meshes=False, build_scene_graph=True)
    result = []
    for pose in poses:
        robot.update_cfg({name: value for name, value in pose.items() if name in robot.actuated_joint_names})
        result.append({link: robot.get_transform(link, robot.base_link) for link in robot.link_map})
    return len(robot.joint_map), result


def mjcf_frames(path, poses, root):
    import mujoco

    tree = ET.parse(path).getroot()
    folder = os.path.dirname(path)

    def include(node):
        for child in list(node):
            if child.tag == "include":
                at = list(node).index(child)
                node.remove(child)
                for k, inner in enumerate(ET.parse(f"{folder}/{child.get('file')}").getroot()):
                    node.insert(at + k, inner)
                return include(node)
            include(child)

    include(tree)

    # Meshes are not there, and frames need none of what follows.
    def strip(node):
        for child in list(node):
            if child.tag in ("geom", "asset", "sensor", "actuator", "contact", "tendon", "keyframe", "mesh", "connect", "weld"):
                node.remove(child)
            else:
                strip(child)

    strip(tree)
    for compiler in tree.iter("compiler"):
        for key in ("meshdir", "texturedir", "inertiafromgeom"):
            compiler.attrib.pop(key, None)
    ET.SubElement(tree, "compiler", boundmass="0.001", boundinertia="0.00001", balanceinertia="true")
    model = mujoco.MjModel.from_xml_string(ET.tostring(tree, encoding="unicode"))
    data = mujoco.MjData(model)
    result = []
    joint = lambda name: mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, name)
    for pose in poses:
        mujoco.mj_resetData(model, data)
        for name, value in pose.items():
            if joint(name) >= 0:
                data.qpos[model.jnt_qposadr[joint(name)]] = value
        for k in np.flatnonzero(model.jnt_type == mujoco.mjtJoint.mjJNT_BALL):
            # kinesic reads a ball as three hinges about x, y and z, one after the other.
            ball, name = np.array([1.0, 0, 0, 0]), mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_JOINT, k)
            for axis, letter in zip(np.eye(3), "xyz"):
                turn, product = np.zeros(4), np.zeros(4)
                mujoco.mju_axisAngle2Quat(turn, axis, pose[f"{name}_{letter}"])
                mujoco.mju_mulQuat(product, ball, turn)
                ball = product
            data.qpos[model.jnt_qposadr[k] : model.jnt_qposadr[k] + 4] = ball
        for k in range(model.neq):
            if model.eq_type[k] == mujoco.mjtEq.mjEQ_JOINT and model.eq_obj2id[k] >= 0:
                a, b = (model.jnt_qposadr[i] for i in (model.eq_obj1id[k], model.eq_obj2id[k]))
                data.qpos[a] = model.qpos0[a] + model.eq_data[k][0] + model.eq_data[k][1] * (data.qpos[b] - model.qpos0[b])
        mujoco.mj_kinematics(model, data)
        body = lambda k: np.vstack([np.column_stack([data.xmat[k].reshape(3, 3), data.xpos[k]]), [0, 0, 0, 1]])
        base = np.linalg.inv(body(mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, root)))
        names = {mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_BODY, k): k for k in range(1, model.nbody)}
        result.append({name: base @ body(k) for name, k in names.items()})
    free = int(np.sum(model.jnt_type == mujoco.mjtJoint.mjJNT_FREE))
    return model.njnt - free, result


def matrix(frame):
    x, y, z, w, i, j, k = frame
    turn = [
        [1 - 2 * (j * j + k * k), 2 * (i * j - k * w), 2 * (i * k + j * w)],
        [2 * (i * j + k * w), 1 - 2 * (i * i + k * k), 2 * (j * k - i * w)],
        [2 * (i * k - j * w), 2 * (j * k + i * w), 1 - 2 * (i * i + j * j)],
    ]
    return np.vstack([np.column_stack([turn, [x, y, z]]), [0, 0, 0, 1]])


def compare(path):
    shown = kinesic("robot", "show", path, "--json")
    random = np.random.default_rng(1)
    moving = [joint for joint in shown["joints"] if joint["kind"] in ("revolute", "continuous", "prismatic", "hinge", "slide", "ball")]
    leads = [joint for joint in moving if not joint["mimic"]]
    far = lambda joint: 0.1 if joint["kind"] in ("prismatic", "slide") else np.pi
    bound = lambda joint, end, sign: sign * far(joint) if joint[end] is None else joint[end]
    poses = [{j["name"]: random.uniform(bound(j, "lower", -1), bound(j, "upper", 1)) for j in leads} for _ in range(20)]
    with open(f"{WORK}/poses.json", "w") as file:
        json.dump(poses, file)
    own = kinesic("robot", "show", path, "--poses", f"{WORK}/poses.json", "--json")["frames"]
    if path.endswith(".urdf"):
        count, theirs = urdf_frames(path, poses)
        read = len(shown["joints"])
    else:
        count, theirs = mjcf_frames(path, poses, shown["root"])
        read = len(moving) - 2 * sum(joint["kind"] == "ball" for joint in moving) // 3
    far, turned, links = 0.0, 0.0, 0
    for mine, other in zip(own, theirs):
        links = len(other) - 1
        for link, frame in other.items():
            # A body without a name has one of kinesic's own.
            if link is None or link == shown["root"]:
                continue
            mine_frame = matrix(mine[link])
            far = max(far, 1000 * np.linalg.norm(mine_frame[:3, 3] - frame[:3, 3]))
            turn = mine_frame[:3, :3].T @ frame[:3, :3]
            sine = np.linalg.norm([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]]) / 2
            turned = max(turned, np.degrees(np.arctan2(sine, (np.trace(turn) - 1) / 2)))
    return read, count, len(leads), links, far, turned


print("| robot | repository, commit | file | joints read | that lead | links | mm | degrees |")
print("|---|---|---|---|---|---|---|---|")
for name, repository, commit, path, _ in ROBOTS:
    read, count, leads, links, far, turned = compare(files(repository, commit, path))
    print(f"| {name} | {repository}, {commit} | {os.path.basename(path)} | {read} of {count} | {leads} | {links} | {far:.5f} | {turned:.5f} |")

for clip in (WALK, WAVE):
    print(f"\n{clip}: median and 95th percentile, degrees; in brackets the median of the robot that stays at zero\n")
    print("| robot | limbs | joints at a limit (> 20 % of frames) | values beyond a limit |")
    print("|---|---|---|---|")
    for name, repository, commit, path, person in ROBOTS:
        if person:
            report = kinesic("robot", "retarget", files(repository, commit, path), f"{DATA}/{clip}", "--json")
            limbs = [f"{x['limb']} {x['median']:.1f}, {x['p95']:.1f} ({x['zero_median']:.0f})" for x in report["limbs"]]
            at = [f"{x['joint']} {x['limit']}" for x in report["at_limit"]]
            print(f"| {name}, {os.path.basename(path)} | {'; '.join(limbs)} | {', '.join(at) or '-'} | {report['limits_exceeded']} |")
