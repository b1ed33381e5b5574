"""Writes tests/data/robot_<name>.json: poses and Jacobians of the robots in robots/, as Pinocchio computes them.

Usage:  python scripts/reference_figures.py [--robots DIR] [--out DIR] [NAME ...]

The figures come from our own URDF files, so they check the kinematics code, not the numbers in the files; those are
checked by independent_figures.py against models that others wrote. Twenty configurations per chain, uniform within the
joint limits (continuous joints: half a turn either way), from a generator seeded by the chain's name. Same input, same
file; on another processor the last digits may differ, the tests ask for 1e-12.

Needs: Python 3.10+, numpy and pin from PyPI. The committed files were made with pin 4.1.0 and numpy 2.4.6.
"""

import argparse
import pathlib

import oracle

ROOT = pathlib.Path(__file__).resolve().parent.parent
SAMPLES = 20

# Every chain as (base, tip). Beside the arms: reversed chains, chains between two hands, between inner links, and
# chains whose tip is moved by a mimic joint.
CHAINS = {
    "planar4": [("base", "tip"), ("tip", "base"), ("link1", "link3")],
    "panda": [
        ("panda_link0", "panda_hand_tcp"),
        ("panda_link0", "panda_link8"),
        ("panda_hand_tcp", "panda_link0"),
        ("panda_link0", "panda_leftfinger"),
        ("panda_link0", "panda_rightfinger"),
        ("panda_leftfinger", "panda_rightfinger"),
        ("panda_rightfinger", "panda_link4"),
    ],
    "iiwa14": [("iiwa_link_0", "iiwa_link_ee"), ("iiwa_link_ee", "iiwa_link_0"), ("iiwa_link_2", "iiwa_link_6")],
    "ur5e": [("base_link", "tool0"), ("base", "tool0"), ("tool0", "base_link")],
    "ur10e": [("base_link", "tool0"), ("base", "tool0"), ("tool0", "base_link")],
    "baxter": [
        ("base", "left_gripper"),
        ("base", "right_gripper"),
        ("left_gripper", "base"),
        ("left_gripper", "right_gripper"),
        ("right_lower_elbow", "left_hand"),
    ],
    "torso14": [
        ("floor", "left_tool"),
        ("floor", "right_tool"),
        ("right_tool", "floor"),
        ("left_tool", "right_tool"),
        ("column", "left_tool"),
        ("left_palm", "right_forearm"),
    ],
}


def chain_figures(robot, name, base, tip):
    """One chain's record: its joints and SAMPLES of (q, position, rotation, jacobian)."""
    drivers = oracle.chain_joints(robot.joints, base, tip)
    generator = oracle.sampler(name, base, tip)
    samples = []
    for _ in range(SAMPLES):
        q = oracle.sample(generator, drivers)
        position, rotation, jacobian = robot.pose_and_jacobian(base, tip, drivers, q)
        samples.append({"q": q, "position": position, "rotation": rotation, "jacobian": jacobian})
    return {"base": base, "tip": tip, "joints": [joint.name for joint in drivers], "samples": samples}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("names", nargs="*", help="robots to write (default: all)")
    parser.add_argument("--robots", type=pathlib.Path, default=ROOT / "robots")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "tests" / "data")
    arguments = parser.parse_args()
    for name in sorted(arguments.names or CHAINS):
        robot = oracle.PinocchioRobot(arguments.robots / f"{name}.urdf")
        head = {"robot": name, "source": f"Pinocchio {robot.pin.__version__}, scripts/reference_figures.py"}
        chains = [chain_figures(robot, name, base, tip) for base, tip in CHAINS[name]]
        oracle.write_chains(arguments.out / f"robot_{name}.json", head, chains)


if __name__ == "__main__":
    main()
