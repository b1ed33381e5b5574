"""Writes tests/data/relative_pinocchio.json: relative poses, errors and Jacobians of two arms as Pinocchio has them.

    pip install pin
    python scripts/relative_figures.py

A Panda and an iiwa (robots/*.urdf) are joined to one model. The relative Jacobian is that of the spatial velocity of the second tip
less that of the first, moved into the frame of the first (`actInv`) and from there to the origin of the second tip.
"""

import json
import pathlib

import numpy as np
import pinocchio as pin

ROOT = pathlib.Path(__file__).parent.parent
MOUNT = pin.SE3(pin.rpy.rpyToMatrix(0.1, -0.2, 3.0), np.array([1.2, 0.3, 0.1]))
TIPS = ("panda_hand_tcp", "iiwa_link_ee")


def arm(name, fingers=()):
    model = pin.buildModelFromUrdf(str(ROOT / "robots" / f"{name}.urdf"))
    held = [model.getJointId(joint) for joint in fingers]
    return pin.buildReducedModel(model, held, pin.neutral(model)) if held else model


def sample(model, q, reference_q):
    def tips(at):
        data = model.createData()
        pin.computeJointJacobians(model, data, at)
        pin.updateFramePlacements(model, data)
        ids = [model.getFrameId(name) for name in TIPS]
        placements = [data.oMf[i].copy() for i in ids]
        return placements, [pin.getFrameJacobian(model, data, i, pin.ReferenceFrame.WORLD) for i in ids]

    (first, second), (j_first, j_second) = tips(q)
    relative = first.actInv(second)
    (first_d, second_d), _ = tips(reference_q)
    reference = first_d.actInv(second_d)
    jacobian = first.inverse().toActionMatrix() @ (j_second - j_first)
    jacobian[:3] += np.array([np.cross(column[3:], relative.translation) for column in jacobian.T]).T
    turn = pin.log3(relative.rotation @ reference.rotation.T)
    return {
        "q": [list(q[:7]), list(q[7:])],
        "q_reference": [list(reference_q[:7]), list(reference_q[7:])],
        "position": list(relative.translation),
        "rotation": relative.rotation.tolist(),
        "error": list(relative.translation - reference.translation) + list(turn),
        "jacobian": jacobian.tolist(),
    }


def main():
    panda = arm("panda", ("panda_finger_joint1", "panda_finger_joint2"))
    model = pin.appendModel(panda, arm("iiwa14"), 0, MOUNT)
    assert model.nq == 14, [model.names[i] for i in range(model.njoints)]
    random = np.random.default_rng(7)
    draw = lambda: random.uniform(-1.0, 1.0, 14)
    document = {
        "source": f"Pinocchio {pin.__version__}, scripts/relative_figures.py",
        "mount": {"xyz": list(MOUNT.translation), "rpy": [0.1, -0.2, 3.0]},
        "samples": [sample(model, draw(), draw()) for _ in range(5)],
    }
    (ROOT / "tests/data/relative_pinocchio.json").write_text(json.dumps(document) + "\n")


main()
