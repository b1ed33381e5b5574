#!/usr/bin/env python3
"""Writes tests/data/scipy_splines.json: splines through points and orientations as SciPy has them.

    pip install scipy==1.17.1
    python scripts/scipy_splines.py > tests/data/scipy_splines.json

Quintic splines of scipy.interpolate.make_interp_spline (natural: third and fourth derivatives zero at the ends; clamped: first
and second), geodesics of scipy.spatial.transform.Slerp, and the cubic RotationSpline (another curve through the same
orientations, which a smooth one approaches as they come closer).
"""

import json

import numpy as np
import scipy
from scipy.interpolate import make_interp_spline
from scipy.spatial.transform import Rotation, RotationSpline, Slerp


def rounded(values):
    return [[float(f"{x:.17g}") for x in row] for row in np.atleast_2d(values)]


def quintic(ends):
    knots = np.array([0.0, 0.15, 0.3, 0.55, 0.6, 0.85, 1.0])
    draw = np.random.default_rng(7)
    points = draw.uniform(-1.0, 1.0, (len(knots), 3))
    boundary = {
        "natural": ([(3, 0.0), (4, 0.0)], [(3, 0.0), (4, 0.0)]),
        "clamped": ([(1, 0.0), (2, 0.0)], [(1, 0.0), (2, 0.0)]),
        "periodic": "periodic",
    }[ends]
    if ends == "periodic":
        points[-1] = points[0]
    if ends != "periodic":
        boundary = tuple([(order, np.zeros(3)) for order, _ in side] for side in boundary)
    spline = make_interp_spline(knots, points, k=5, bc_type=boundary)
    at = np.linspace(0.0, 1.0, 12)
    return {
        "ends": ends,
        "knots": knots.tolist(),
        "points": rounded(points),
        "at": at.tolist(),
        "derivatives": [rounded(spline(at, nu=order)) for order in range(5)],
    }


def orientations():
    knots = np.linspace(0.0, 1.0, 21)

    def smooth(t):
        return Rotation.from_rotvec(np.stack([np.sin(3 * t), 0.5 * np.cos(2 * t), t * t], axis=-1))

    at = np.linspace(0.0, 1.0, 16)
    rotations = smooth(knots)
    spline = RotationSpline(knots, rotations)
    return {
        "knots": knots.tolist(),
        "quaternions": rounded(rotations.as_quat()),
        "at": at.tolist(),
        "slerp": rounded(Slerp(knots, rotations)(at).as_quat()),
        "rotation_spline": rounded(spline(at).as_quat()),
        # In the axes of the moving body.
        "rotation_spline_rate": rounded(spline(at, 1)),
    }


print(json.dumps({
    "source": f"SciPy {scipy.__version__}, scripts/scipy_splines.py",
    "quintic": [quintic(ends) for ends in ["natural", "clamped", "periodic"]],
    "orientations": orientations(),
}, indent=1))
