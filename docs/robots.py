"""Compares `kinesic robot show` with an independent reader at 20 random poses; prints cells of the table of docs/robots.sh.

usage: robots.py KINESIC FILE
"""
import json
import math
import pathlib
import random
import subprocess
import sys
import xml.etree.ElementTree as tree

import numpy as np

POSES = 20


def show(kinesic, path, values):
    command = [kinesic, "robot", "show", path, "--json"]
    if values:
        command += ["--at", ",".join(f"{name}={value!r}" for name, value in values.items())]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        words = " ".join(done.stderr.replace("│", " ").split())
        print("refused: " + words.split(pathlib.Path(path).name + ": ")[-1].split(" help:")[0] + " | |")
        sys.exit()
    return json.loads(done.stdout)


def matrix(position, quaternion):
    w, x, y, z = quaternion
    turn = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    frame = np.eye(4)
    frame[:3, :3], frame[:3, 3] = turn, position
    return frame


class Mujoco:
    """MuJoCo, without the meshes, pictures and motors that frames do not need."""

    def __init__(self, path):
        import mujoco

        self.mujoco = mujoco
        root = self.whole(tree.parse(path).getroot(), pathlib.Path(path).parent)
        drop = ["asset", "actuator", "sensor", "contact", "tendon", "keyframe", "visual", "statistic", "custom", "deformable"]
        for tag in drop:
            for node in root.findall(tag):
                root.remove(node)
        for parent in list(root.iter()):
            for node in list(parent):
                if node.tag in ("geom", "site", "camera", "light", "mesh", "material", "inertial", "replicate", "general",
                                "motor", "position", "velocity"):
                    parent.remove(node)
        # Loops through sites went with the sites.
        for parent in root.findall("equality"):
            for node in list(parent):
                if node.tag != "joint":
                    parent.remove(node)
        for body in root.iter("body"):
            tree.SubElement(body, "inertial", pos="0 0 0", mass="1", diaginertia="1 1 1")
        self.model = mujoco.MjModel.from_xml_string(tree.tostring(root, encoding="unicode"))
        self.data = mujoco.MjData(self.model)
        kinds = {2: "slide", 3: "hinge"}
        self.joints = {
            self.model.joint(j).name: int(self.model.jnt_qposadr[j])
            for j in range(self.model.njnt)
            if int(self.model.jnt_type[j]) in kinds and self.model.joint(j).name
        }
        self.unnamed = sum(int(t) in kinds for t in self.model.jnt_type) - len(self.joints)

    def whole(self, root, folder):
        for parent in list(root.iter()):
            for at, node in reversed(list(enumerate(list(parent)))):
                if node.tag == "include":
                    parent.remove(node)
                    inner = self.whole(tree.parse(folder / node.get("file")).getroot(), folder)
                    for child in reversed(list(inner)):
                        parent.insert(at, child)
        return root

    def frames(self, values):
        for name, value in values.items():
            self.data.qpos[self.joints[name]] = value
        self.mujoco.mj_kinematics(self.model, self.data)
        names = range(self.model.nbody)
        return {self.model.body(b).name: matrix(self.data.xpos[b], self.data.xquat[b]) for b in names}

    def movable(self):
        return list(self.joints)


class Yourdfpy:
    def __init__(self, path):
        import yourdfpy

        self.robot = yourdfpy.URDF.load(path, load_meshes=False, build_scene_graph=True, load_collision_meshes=False)

    def frames(self, values):
        self.robot.update_cfg({name: values[name] for name in self.robot.actuated_joint_names})
        return {link: self.robot.get_transform(link, self.robot.base_link) for link in self.robot.link_map}

    def movable(self):
        moving = ("revolute", "continuous", "prismatic")
        return [name for name, joint in self.robot.joint_map.items() if joint.type in moving]


def main():
    kinesic, path = sys.argv[1:]
    mjcf = tree.parse(path).getroot().tag == "mujoco"
    other = Mujoco(path) if mjcf else Yourdfpy(path)
    ours = show(kinesic, path, {})
    joints = {j["name"]: j for j in ours["joints"] if j["type"] in ("hinge", "slide", "revolute", "continuous", "prismatic")}
    leading = [name for name, joint in joints.items() if not joint["follows"]]
    found = [name for name in other.movable() if name in joints]
    rng = random.Random(1)
    worst, turned, links = 0.0, 0.0, set()
    for _ in range(POSES):
        values = {}
        for name in leading:
            # Joints without a name in the file stay at 0 in both.
            if name not in found:
                continue
            lower, upper = joints[name]["lower"], joints[name]["upper"]
            values[name] = rng.uniform(-3.0 if lower is None else lower, 3.0 if upper is None else upper)
        ours = show(kinesic, path, values)
        # Followers too: a constraint of MuJoCo's is soft, its frames do not follow by themselves.
        theirs = other.frames({j["name"]: j["value"] for j in ours["joints"] if j["name"] in found})
        mine = {link["link"]: matrix(link["position"], link["quaternion"]) for link in ours["links"]}
        root = np.linalg.inv(theirs[ours["root"]])
        links = {name for name in theirs if name in mine}
        for name in links:
            left = root @ theirs[name]
            worst = max(worst, float(np.linalg.norm(left[:3, 3] - mine[name][:3, 3])))
            # Twice the arc sine of half the chord: exact for small angles.
            chord = float(np.linalg.norm(left[:3, :3] - mine[name][:3, :3]))
            turned = max(turned, math.degrees(2 * math.asin(min(1.0, chord / math.sqrt(8)))))
    print(f"{len(found)} of {len(other.movable())}, {len(links)} links | {worst * 1000:.6f} | {turned:.6f}")


main()
