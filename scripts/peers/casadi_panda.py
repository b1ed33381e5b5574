"""Writes C code for the Panda by CasADi: `casadi_panda.py URDF FOLDER`.

Two functions with all sizes known: pose and Jacobian of the flange, and the evaluation of a control step (kinematics,
Jacobian, residual, one L D L^T solve of the normal equations for feedforward and feedback together). Expressions are expanded to scalars, so
that common subexpressions are shared and known zeros vanish: what CasADi is chosen for.
"""

import math
import pathlib
import sys
import xml.etree.ElementTree as ElementTree

import casadi as ca

JOINTS = [f"panda_joint{i}" for i in range(1, 9)]


def numbers(element, attribute):
    return [float(number) for number in element.get(attribute, "0 0 0").split()]


def turn(axis, angle):
    """The rotation about a coordinate axis; whole quarter turns of a rounded angle become exact."""
    if isinstance(angle, ca.SX):
        sine, cosine = ca.sin(angle), ca.cos(angle)
    else:
        exact = [math.sin(angle), math.cos(angle)]
        sine, cosine = (round(value) if abs(value - round(value)) < 1e-9 else value for value in exact)
    rows = {
        0: [[1, 0, 0], [0, cosine, -sine], [0, sine, cosine]],
        1: [[cosine, 0, sine], [0, 1, 0], [-sine, 0, cosine]],
        2: [[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]],
    }[axis]
    return ca.vertcat(*[ca.horzcat(*[ca.SX(entry) for entry in row]) for row in rows])


def kinematics(urdf, q):
    """Position, rotation and geometric Jacobian (linear rows first) of the flange."""
    joints = {joint.get("name"): joint for joint in ElementTree.parse(urdf).getroot().iter("joint")}
    position, rotation, axes = ca.SX.zeros(3), ca.SX.eye(3), []
    for i, name in enumerate(JOINTS):
        origin = joints[name].find("origin")
        xyz = numbers(origin, "xyz") if origin is not None else [0, 0, 0]
        roll, pitch, yaw = numbers(origin, "rpy") if origin is not None else [0, 0, 0]
        position = position + rotation @ ca.SX(xyz)
        rotation = rotation @ turn(2, yaw) @ turn(1, pitch) @ turn(0, roll)
        if i < 7:
            axes.append((rotation[:, 2], position))
            rotation = rotation @ turn(2, q[i])
    columns = [ca.vertcat(ca.cross(axis, position - origin), axis) for axis, origin in axes]
    return position, rotation, ca.horzcat(*columns)


def residual(position, rotation, wanted, wanted_rotation):
    """The position error, and the orientation error by the series of the logarithm for small errors."""
    relative = rotation @ wanted_rotation.T
    sine = 0.5 * ca.vertcat(
        relative[2, 1] - relative[1, 2], relative[0, 2] - relative[2, 0], relative[1, 0] - relative[0, 1]
    )
    square = ca.dot(sine, sine)
    factor = ca.SX(63 / 2816)
    for coefficient in (35 / 1152, 5 / 112, 3 / 40, 1 / 6, 1):
        factor = factor * square + coefficient
    return ca.vertcat(position - wanted, sine * factor)


def solve(gram, side):
    """The solution of `gram y = side` by L D L^T."""
    size = gram.shape[0]
    lower, pivots = [[0] * size for _ in range(size)], [0] * size
    for i in range(size):
        for j in range(i):
            rest = gram[i, j] - sum(lower[i][k] * lower[j][k] * pivots[k] for k in range(j))
            lower[i][j] = rest / pivots[j]
        pivots[i] = gram[i, i] - sum(lower[i][k] ** 2 * pivots[k] for k in range(i))
    y = [side[i] for i in range(size)]
    for i in range(size):
        for j in range(i):
            y[i] = y[i] - lower[i][j] * y[j]
    y = [entry / pivot for entry, pivot in zip(y, pivots)]
    for i in reversed(range(size)):
        for j in range(i + 1, size):
            y[i] = y[i] - lower[j][i] * y[j]
    return ca.vertcat(*y)


def main():
    urdf, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    q, wanted, wanted_rotation = ca.SX.sym("q", 7), ca.SX.sym("p", 3), ca.SX.sym("r", 3, 3)
    twist, gain = ca.SX.sym("v", 6), ca.SX.sym("k")
    position, rotation, jacobian = kinematics(urdf, q)
    pose = ca.Function("pose", [q], [position, rotation, jacobian])
    error = residual(position, rotation, wanted, wanted_rotation)
    inputs = [q, wanted, wanted_rotation, twist, gain]
    outputs = [jacobian.T @ solve(jacobian @ jacobian.T, twist - gain * error)]
    evaluation = ca.Function("evaluation", inputs, outputs, {"cse": True})
    generator = ca.CodeGenerator("panda_generated.c", {"with_header": True})
    generator.add(pose)
    generator.add(evaluation)
    generator.generate(f"{folder}/")


if __name__ == "__main__":
    main()
