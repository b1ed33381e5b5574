#!/usr/bin/env python3
"""Runs integrators of SciPy and SUNDIALS at a fixed gap and writes their samples for the order studies.

    pip install scipy scikit-sundae
    python scripts/other_integrators.py > crates/study/tests/data/other_integrators.json

The problem is x' = x cos t, x(0) = 1 on [0, 6]; its solution is exp(sin t). Tolerances are so loose that no step is
ever refused, and the gap is held by its bounds: what remains is the fixed method. Steps start at the exact state.
CVODE chooses its order by itself, up to the highest that is allowed, and with loose tolerances it stays at one
whatever is allowed. So it is run with highest order one, where there is nothing to choose.
"""

import json
import sys

import numpy as np
import scipy
from scipy.integrate import DOP853, RK23, RK45

DURATION = 6.0
# Steps of the runs: the higher the order, the sooner it meets the rounding.
LADDERS = {1: [96, 192, 384, 768], 3: [48, 96, 192, 384], 5: [32, 64, 128, 256], 8: [8, 12, 16, 24, 32]}


def f(t, x):
    return x * np.cos(t)


def one_step(solver):
    """A Runge-Kutta method of SciPy, step by step."""

    def run(steps):
        sigma = DURATION / steps
        stepper = solver(f, 0.0, [1.0], 1e9, rtol=1e6, atol=1e6, first_step=sigma, max_step=sigma)
        states = [1.0]
        for n in range(steps):
            stepper.step()
            assert abs(stepper.t - (n + 1) * sigma) < 1e-12, (stepper.t, n, sigma)
            states.append(float(stepper.y[0]))
        return states

    return run


def cvode(method, order):
    """CVODE of SUNDIALS, its gap held between equal bounds."""
    from sksundae.cvode import CVODE

    def right_hand_side(t, x, derivative):
        derivative[0] = x[0] * np.cos(t)

    def run(steps):
        sigma = DURATION / steps
        solver = CVODE(right_hand_side, method=method, max_order=order, rtol=1e3, atol=1e3,
                       first_step=sigma, min_step=sigma, max_step=sigma, max_num_steps=10 * steps,
                       max_nonlin_iters=20)
        solution = solver.solve(np.arange(steps + 1) * sigma, [1.0])
        return [float(x[0]) for x in solution.y]

    return run


def slopes(run, ladder):
    errors = []
    for steps in ladder:
        t = np.arange(steps + 1) * (DURATION / steps)
        states = np.array(run(steps))
        assert len(states) == steps + 1, (len(states), steps)
        errors.append(np.abs(states - np.exp(np.sin(t))).max())
    ratios = np.log(np.array(ladder[1:]) / np.array(ladder[:-1]))
    return errors, np.log(np.array(errors[:-1]) / np.array(errors[1:])) / ratios


def main():
    import sksundae

    runs = [
        ("SciPy RK23", 3, one_step(RK23)),
        ("SciPy RK45", 5, one_step(RK45)),
        ("SciPy DOP853", 8, one_step(DOP853)),
        ("SUNDIALS CVODE BDF, order 1", 1, cvode("BDF", 1)),
        ("SUNDIALS CVODE Adams, order 1", 1, cvode("Adams", 1)),
    ]
    document = {"scipy": scipy.__version__, "scikit-sundae": sksundae.__version__,
                "sundials": sksundae.SUNDIALS_VERSION, "duration": DURATION, "runs": []}
    for name, order, run in runs:
        try:
            errors, seen = slopes(run, LADDERS[order])
        except Exception as problem:  # noqa: BLE001 - a missing solver is said, not hidden
            print(f"{name}: {problem}", file=sys.stderr)
            continue
        print(f"{name}: order {order}, errors {errors}, slopes {seen}", file=sys.stderr)
        document["runs"].append({"name": name, "order": order,
                                 "samples": {str(steps): run(steps) for steps in LADDERS[order]}})
    json.dump(document, sys.stdout, separators=(",", ":"))
    print()


if __name__ == "__main__":
    main()
