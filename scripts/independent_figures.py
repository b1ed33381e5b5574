"""Writes tests/data/independent_<name>.json: tip poses from models that this project did not write.

Usage:  python scripts/independent_figures.py [--out DIR] [NAME ...]

They guard the numbers in robots/*.urdf: a wrong link length, axis, zero position or joint range can not pass. Sources:

- panda    the URDF in example-robot-data (by way of Pinocchio), hand and both fingers, and the modified
           Denavit-Hartenberg table of Franka's control documentation (Craig's convention, flange at d = 0.107 m);
- baxter   the URDF in example-robot-data (by way of Pinocchio), both arms, and the right tip seen from the left;
- iiwa14   KUKA's lengths 0.36, 0.42, 0.4, 0.126 m in a standard Denavit-Hartenberg table with twists of a quarter turn;
- ur5e     Universal Robots' Denavit-Hartenberg table (base -> tool0), and the URDF in airo-models (base_link -> tool0);
- ur10e    Universal Robots' Denavit-Hartenberg table (base -> tool0).

How frames are related: Franka's table ends at the flange, our panda_link8. The Denavit-Hartenberg base of a UR arm is
our `base`, which is `base_link` turned by pi about z; its last frame is tool0. KUKA's base and flange are
iiwa_link_0 and iiwa_link_ee. Joint zeros and signs are equal throughout: no offsets are applied.

Twenty configurations per chain, uniform within the limits below (the vendors', written again here so that this script
reads nothing of ours), from a generator seeded by the chain's name.

Needs: Python 3.10+, from PyPI numpy, pin, example-robot-data and airo-models (the last with `pip install --no-deps`).
The committed files were made with numpy 2.4.6, pin 4.1.0, example-robot-data 6.0.0 and airo-models 0.0.12.
"""

import argparse
import importlib.metadata
import importlib.util
import math
import pathlib
import sys

import numpy

import oracle

ROOT = pathlib.Path(__file__).resolve().parent.parent
SAMPLES = 20
QUARTER = math.pi / 2


def rotation_z_then_x(theta, alpha, offset):
    """The 4x4 matrix Rot(z, theta) * Trans(offset) * Rot(x, alpha)."""
    c, s, ca, sa = math.cos(theta), math.sin(theta), math.cos(alpha), math.sin(alpha)
    matrix = numpy.eye(4)
    turn = numpy.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    matrix[:3, :3] = turn @ numpy.array([[1.0, 0.0, 0.0], [0.0, ca, -sa], [0.0, sa, ca]])
    matrix[:3, 3] = turn @ numpy.asarray(offset)
    return matrix


def standard_dh(table, q):
    """Tip pose of a standard Denavit-Hartenberg table: Rz(q) Tz(d) Tx(a) Rx(alpha), rows (a, d, alpha)."""
    pose = numpy.eye(4)
    for (a, d, alpha), angle in zip(table, q, strict=True):
        pose = pose @ rotation_z_then_x(angle, alpha, (a, 0.0, d))
    return pose


def modified_dh(table, flange, q):
    """Tip pose of a modified (Craig) table: Rx(alpha) Tx(a) Rz(q) Tz(d), rows (a, d, alpha), then Tz(flange)."""
    pose = numpy.eye(4)
    for (a, d, alpha), angle in zip(table, q, strict=True):
        pose = pose @ rotation_z_then_x(0.0, alpha, (a, 0.0, 0.0)) @ rotation_z_then_x(angle, 0.0, (0.0, 0.0, d))
    return pose @ rotation_z_then_x(0.0, 0.0, (0.0, 0.0, flange))


def degrees(*limits):
    return [(-math.radians(limit), math.radians(limit)) for limit in limits]


PANDA_LIMITS = [
    (-2.8973, 2.8973),
    (-1.7628, 1.7628),
    (-2.8973, 2.8973),
    (-3.0718, -0.0698),
    (-2.8973, 2.8973),
    (-0.0175, 3.7525),
    (-2.8973, 2.8973),
]
PANDA_TABLE = [
    (0.0, 0.333, 0.0),
    (0.0, 0.0, -QUARTER),
    (0.0, 0.316, QUARTER),
    (0.0825, 0.0, QUARTER),
    (-0.0825, 0.384, -QUARTER),
    (0.0, 0.0, QUARTER),
    (0.088, 0.0, QUARTER),
]
IIWA_TABLE = [
    (0.0, 0.36, -QUARTER),
    (0.0, 0.0, QUARTER),
    (0.0, 0.42, QUARTER),
    (0.0, 0.0, -QUARTER),
    (0.0, 0.4, -QUARTER),
    (0.0, 0.0, QUARTER),
    (0.0, 0.126, 0.0),
]
UR_LIMITS = degrees(360, 360, 180, 360, 360, 360)
UR_JOINTS = ["shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3"]


def ur_table(d1, a2, a3, d4, d5, d6):
    twists = [QUARTER, 0.0, 0.0, QUARTER, -QUARTER, 0.0]
    return list(zip([0.0, a2, a3, 0.0, 0.0, 0.0], [d1, 0.0, 0.0, d4, d5, d6], twists, strict=True))


def record(source, frames, chain, joints, limits, samples):
    """A chain's record as it is written."""
    return {
        "source": source,
        "frames": frames,
        "base": chain[0],
        "tip": chain[1],
        "joints": joints,
        "limits": [list(limit) for limit in limits],
        "samples": samples,
    }


def table_chain(source, frames, base, tip, joints, limits, pose):
    """A chain's record from a function q -> 4x4 pose."""
    generator = oracle.sampler("independent", source, base, tip)
    samples = []
    for _ in range(SAMPLES):
        q = [generator.uniform(lower, upper) for lower, upper in limits]
        matrix = pose(q)
        samples.append({"q": q, "position": matrix[:3, 3], "rotation": matrix[:3, :3]})
    return record(source, frames, (base, tip), joints, limits, samples)


def urdf_chain(source, frames, path, chain, ours):
    """A chain's record from somebody else's URDF: `chain` in its link names, `ours` in ours."""
    robot = oracle.PinocchioRobot(path)
    drivers = oracle.chain_joints(robot.joints, *chain)
    generator = oracle.sampler("independent", source, *ours)
    samples = []
    for _ in range(SAMPLES):
        q = oracle.sample(generator, drivers)
        position, rotation, _ = robot.pose_and_jacobian(*chain, drivers, q)
        samples.append({"q": q, "position": position, "rotation": rotation})
    limits = [(joint.lower, joint.upper) for joint in drivers]
    return record(source, frames, ours, [joint.name for joint in drivers], limits, samples)


def example_robot_data(relative):
    """(source, path) of a URDF in the example-robot-data package."""
    folder = pathlib.Path("share") / "example-robot-data" / "robots"
    for place in map(pathlib.Path, sys.path):
        path = place / "cmeel.prefix" / folder / relative
        if path.exists():
            return f"example-robot-data {importlib.metadata.version('example-robot-data')}, {relative}", path
    raise SystemExit(f"{relative} not found: install the package example-robot-data")


def airo_models(relative):
    """(source, path) of a URDF in the airo-models package."""
    specification = importlib.util.find_spec("airo_models")
    if specification is None:
        raise SystemExit("airo-models not found: install it with pip install --no-deps airo-models")
    path = pathlib.Path(specification.submodule_search_locations[0]) / relative
    return f"airo-models {importlib.metadata.version('airo-models')}, {relative}", path


def panda():
    source, path = example_robot_data("panda_description/urdf/panda.urdf")
    chain = ("panda_link0", "panda_hand_tcp")
    table = table_chain(
        "Franka Control Interface documentation, Denavit-Hartenberg parameters",
        "modified Denavit-Hartenberg table; its flange frame is panda_link8",
        "panda_link0",
        "panda_link8",
        [f"panda_joint{i}" for i in range(1, 8)],
        PANDA_LIMITS,
        lambda q: modified_dh(PANDA_TABLE, 0.107, q),
    )
    fingers = [("panda_link0", "panda_leftfinger"), ("panda_link0", "panda_rightfinger")]
    return [urdf_chain(source, "links of the same names", path, each, each) for each in (chain, *fingers)] + [table]


def baxter():
    source, path = example_robot_data("baxter_description/urdf/baxter.urdf")
    chains = [("base", "left_gripper"), ("base", "right_gripper"), ("left_gripper", "right_gripper")]
    return [urdf_chain(source, "links of the same names", path, chain, chain) for chain in chains]


def iiwa14():
    return [
        table_chain(
            "KUKA LBR iiwa 14 R820 data sheet: 0.36, 0.42, 0.4, 0.126 m",
            "standard Denavit-Hartenberg table; first frame iiwa_link_0, last frame iiwa_link_ee",
            "iiwa_link_0",
            "iiwa_link_ee",
            [f"iiwa_joint_{i}" for i in range(1, 8)],
            degrees(170, 120, 170, 120, 170, 120, 175),
            lambda q: standard_dh(IIWA_TABLE, q),
        )
    ]


def universal_robots(model, lengths):
    """The arm from the controller's base, and from base_link."""
    source = f"Universal Robots, DH parameters for calculations of kinematics and dynamics, {model}"
    joints = [f"{joint}_joint" for joint in UR_JOINTS]
    table, half_turn = ur_table(*lengths), rotation_z_then_x(math.pi, 0.0, (0.0, 0.0, 0.0))

    def from_base(q):
        return standard_dh(table, q)

    def from_base_link(q):
        return half_turn @ standard_dh(table, q)

    frames = "standard Denavit-Hartenberg table; first frame base, last frame tool0"
    turned = f"{frames}; base_link is base turned by pi about z"
    return [
        table_chain(source, frames, "base", "tool0", joints, UR_LIMITS, from_base),
        table_chain(source, turned, "base_link", "tool0", joints, UR_LIMITS, from_base_link),
    ]


def ur5e():
    source, path = airo_models("arms/ur5e/ur5e.urdf")
    chain = ("base_link", "tool0")
    table = universal_robots("UR5e", (0.1625, -0.425, -0.3922, 0.1333, 0.0997, 0.0996))
    return [*table, urdf_chain(source, "links of the same names", path, chain, chain)]


def ur10e():
    return universal_robots("UR10e", (0.1807, -0.6127, -0.57155, 0.17415, 0.11985, 0.11655))


ROBOTS = {"baxter": baxter, "iiwa14": iiwa14, "panda": panda, "ur10e": ur10e, "ur5e": ur5e}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("names", nargs="*", help="robots to write (default: all)")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "tests" / "data")
    arguments = parser.parse_args()
    for name in sorted(arguments.names or ROBOTS):
        note = "tip poses from models that this project did not write; see scripts/independent_figures.py"
        head = {"robot": name, "note": note}
        oracle.write_chains(arguments.out / f"independent_{name}.json", head, ROBOTS[name]())


if __name__ == "__main__":
    main()
