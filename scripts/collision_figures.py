"""Writes tests/data/collision_coal.json: distances of random pairs of shapes as the library coal computes them.

Coal is the collision library of Pinocchio (formerly hpp-fcl). It iterates (GJK and EPA) where kinstep has closed forms, to the
tolerance that is asked for here. Run with `pip install coal==3.0.3 numpy` from the root of the repository.
"""

import json
import random

import coal
import numpy as np


def pose(draw, place):
    quaternion = np.array([draw.gauss(0, 1) for _ in range(4)])
    quaternion /= np.linalg.norm(quaternion)
    x, y, z, w = quaternion
    rotation = np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ])
    return rotation, np.array([draw.uniform(-place, place) for _ in range(3)])


def capsule(draw):
    """A capsule along its own z, or a sphere, with its ends in the world."""
    rotation, middle = pose(draw, 0.5)
    half = draw.choice([0.0, draw.uniform(0.02, 0.4)])
    radius = draw.uniform(0.02, 0.2)
    shape = coal.Capsule(radius, 2 * half) if half else coal.Sphere(radius)
    ends = [list(middle - half * rotation[:, 2]), list(middle + half * rotation[:, 2])]
    return shape, (rotation, middle), {"from": ends[0], "to": ends[1], "radius": radius}


def box(draw):
    rotation, middle = pose(draw, 0.5)
    sides = [draw.uniform(0.05, 0.8) for _ in range(3)]
    record = {"rotation": rotation.tolist(), "center": list(middle), "size": sides}
    return coal.Box(*sides), (rotation, middle), record


def half_space(draw):
    normal = np.array([draw.gauss(0, 1) for _ in range(3)])
    normal /= np.linalg.norm(normal)
    offset = draw.uniform(-0.5, 0.5)
    record = {"point": list(offset * normal), "normal": list(normal)}
    return coal.Halfspace(normal, offset), (np.eye(3), np.zeros(3)), record


def distance(first, second):
    request = coal.DistanceRequest()
    request.gjk_tolerance = 1e-10
    request.epa_tolerance = 1e-10
    request.gjk_max_iterations = 10000
    request.epa_max_iterations = 10000
    result = coal.DistanceResult()
    (a, pose_a, _), (b, pose_b, _) = first, second
    coal.distance(a, coal.Transform3s(*pose_a), b, coal.Transform3s(*pose_b), request, result)
    return {"distance": result.min_distance, "normal": list(-np.array(result.normal))}


def main():
    draw = random.Random(14)
    kinds = {"capsule": capsule, "box": box, "half_space": half_space}
    pairs = []
    for number in range(120):
        kind = list(kinds)[number % 3]
        first, second = capsule(draw), kinds[kind](draw)
        pairs.append({"capsule": first[2], kind: second[2], **{"other": kind}, **distance(first, second)}
                     if kind != "capsule" else
                     {"capsule": first[2], "second": second[2], "other": kind, **distance(first, second)})
    source = f"coal {coal.__version__}, scripts/collision_figures.py"
    with open("tests/data/collision_coal.json", "w") as file:
        rows = ",\n".join(json.dumps(pair) for pair in pairs)
        file.write(f'{{"source": {json.dumps(source)}, "pairs": [\n{rows}\n]}}\n')
    print(sum(pair["distance"] < 0 for pair in pairs), "of", len(pairs), "overlap")


main()
