"""Compares kinesic's forward kinematics of one robot with mujoco's (MJCF) or yourdfpy's (URDF) at 20 random poses; prints a row."""

import json
import os
import subprocess
import sys
import xml.etree.ElementTree as tree

import numpy as np

path, imported, what, repository, commit, file = sys.argv[1:]
random = np.random.default_rng(5)


def ours(values):
    """Frame of every link, 4 x 4, in the root link's."""
    at = [f"--at={name}={x!r}" for name, x in values.items()]
    shown = json.loads(subprocess.run([os.environ["KINESIC"], "robot", "show", path, "--json", *at], capture_output=True, check=True).stdout)
    frames = {}
    for joint in shown["joints"]:
        x, y, z, w = joint["rotation"]
        frame = np.eye(4)
        frame[:3, :3] = [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
        frame[:3, 3] = joint["position"]
        frames[joint["link"]] = frame
    return shown, frames


def urdf():
    """The same by yourdfpy: a function of joint values."""
    import yourdfpy

    robot = yourdfpy.URDF.load(path, load_meshes=False, build_scene_graph=True, load_collision_meshes=False)

    def frames(values):
        robot.update_cfg({name: x for name, x in values.items() if name in robot.actuated_joint_names})
        return {link: robot.get_transform(link) for link in robot.link_map}

    return frames


def mjcf():
    """The same by mujoco, without what only draws."""
    import mujoco

    root = tree.parse(path).getroot()

    def included(node):
        for child in list(node):
            if child.tag == "include":
                inner = tree.parse(os.path.join(os.path.dirname(path), child.get("file"))).getroot()
                at = list(node).index(child)
                node.remove(child)
                for new in reversed(list(inner)):
                    node.insert(at, new)
            included(child)

    included(root)
    keep = {"geom", "camera", "light", "site"}
    for node in root.iter():
        for child in [child for child in node if child.tag in keep and node.tag not in ("default",)]:
            node.remove(child)
    for tag in ("asset", "sensor", "actuator", "contact", "keyframe", "visual", "tendon", "statistic"):
        for node in root.findall(tag):
            root.remove(node)
    for body in root.iter("body"):
        if body.find("inertial") is None:
            tree.SubElement(body, "inertial", pos="0 0 0", mass="1", diaginertia="1 1 1")
    model = mujoco.MjModel.from_xml_string(tree.tostring(root, encoding="unicode"))
    data = mujoco.MjData(model)

    def frames(values):
        data.qpos[:] = model.qpos0
        for name, x in values.items():
            at = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, name)
            if at >= 0:
                data.qpos[model.jnt_qposadr[at]] = x
        mujoco.mj_kinematics(model, data)
        found = {}
        for body in range(1, model.nbody):
            frame = np.eye(4)
            frame[:3, :3], frame[:3, 3] = data.xmat[body].reshape(3, 3), data.xpos[body]
            found[mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_BODY, body)] = frame
        return found

    return frames


theirs = mjcf() if path.endswith(".xml") else urdf()
shown, _ = ours({})
free = [j for j in shown["joints"] if j["kind"] not in ("fixed", "floating", "free") and "follows" not in j]
# yourdfpy leaves followers of followers at 0: what hangs on them is not compared.
leaders = {j["name"]: j.get("follows") for j in shown["joints"]}
unknown = set()
for joint in shown["joints"]:
    if joint["parent_link"] in unknown or leaders.get(joint.get("follows")):
        unknown.add(joint["link"])
millimetres = degrees = 0.0
compared = 0
for _ in range(20):
    values = {j["name"]: random.uniform(max(j.get("lower", -1), -3), min(j.get("upper", 1), 3)) for j in free}
    _, mine = ours(values)
    other = theirs(values)
    root = other.get(shown["root"], np.eye(4))
    for link in (mine.keys() & other.keys()) - unknown:
        compared += 1
        own, found = mine[link], np.linalg.inv(root) @ other[link]
        millimetres = max(millimetres, 1000 * np.linalg.norm(own[:3, 3] - found[:3, 3]))
        turn = own[:3, :3].T @ found[:3, :3]
        angle = np.arctan2(np.linalg.norm([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]]), np.trace(turn) - 1)
        degrees = max(degrees, np.degrees(angle))
assert compared >= 20 * len(free), f"only {compared // 20} links are known to both readers"
counts = f"{len(shown['joints'])}, {len(free)}, {len(json.load(open(imported))['coordinates'])}"
print(f"| {what} | {repository}: `{os.path.basename(file)}` | `{commit[:7]}` | {counts} | {millimetres:.4f} | {degrees:.5f} |")
