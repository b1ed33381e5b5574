"""Work against precision: kinstep beside CVODE and SciPy's solvers, on the same problems in one run.

    cargo run --release --example work_precision 20 > kinstep.csv
    python scripts/work_precision.py kinstep.csv        # needs numpy, scipy, scikit-sundae

Prints a table in Markdown for docs/ode.md: evaluations of the right-hand side that each takes to come as close as kinstep does at the
tolerance, found by interpolation (logarithms) over the tolerances from 1e-4 to 1e-12. Times are not compared: those of the others are
times of Python.
"""

import csv
import sys

import numpy as np
from scipy.integrate import solve_ivp
from sksundae.cvode import CVODE

NEAREST = np.sqrt(1.3 / 0.7)


def kepler(t, x):
    cube = (x[0] ** 2 + x[1] ** 2) ** 1.5
    return [x[2], x[3], -x[0] / cube, -x[1] / cube]


def lotka_volterra(t, x):
    return [2 * (x[0] - x[0] * x[1]), -(x[1] - x[0] * x[1])]


def robertson(t, x):
    first, third = -0.04 * x[0] + 1e4 * x[1] * x[2], 3e7 * x[1] ** 2
    return [first, -first - third, third]


def van_der_pol(t, x):
    return [x[1], 1000 * (1 - x[0] ** 2) * x[1] - x[0]]


def hires(t, y):
    r = 280 * y[5] * y[7]
    return [
        -1.71 * y[0] + 0.43 * y[1] + 8.32 * y[2] + 0.0007,
        1.71 * y[0] - 8.75 * y[1],
        -10.03 * y[2] + 0.43 * y[3] + 0.035 * y[4],
        8.32 * y[1] + 1.71 * y[2] - 1.12 * y[3],
        -1.745 * y[4] + 0.43 * y[5] + 0.43 * y[6],
        -r + 0.69 * y[3] + 1.71 * y[4] - 0.43 * y[5] + 0.69 * y[6],
        r - 1.81 * y[6],
        -r + 1.81 * y[6],
    ]


def oregonator(t, x):
    return [
        77.27 * (x[1] + x[0] * (1 - 8.375e-6 * x[0] - x[1])),
        (x[2] - (1 + x[0]) * x[1]) / 77.27,
        0.161 * (x[0] - x[2]),
    ]


HIRES = [
    0.7371312573325668e-3, 0.1442485726316185e-3, 0.5888729740967575e-4, 0.1175651343283149e-2,
    0.2386356198831331e-2, 0.6238968252742796e-2, 0.2849998395185769e-2, 0.2850001604814231e-2,
]
PROBLEMS = {
    "kepler": (kepler, [0.7, 0, 0, NEAREST], 2 * np.pi, [0.7, 0, 0, NEAREST], 1, False),
    "lotka_volterra": (lotka_volterra, [1, 3], 20.0, [0.6761876008576667, 0.1860816099640036], 1, False),
    "robertson": (robertson, [1, 0, 0], 40.0, [0.7158270687193941, 9.185534764557618e-6, 0.2841637457458413], 1e-4, True),
    "van_der_pol_stiff": (van_der_pol, [2, 0], 2000.0, [1.706167732170483, -0.8928097010247975e-3], 1, True),
    "hires": (hires, [1, 0, 0, 0, 0, 0, 0, 0.0057], 321.8122, HIRES, 1, True),
    "oregonator": (oregonator, [1, 2, 3], 360.0, [1.000814870318523, 1228.178521549917, 132.0554942846706], 1, True),
}
SOLVERS = {False: ["CVODE Adams", "LSODA", "DOP853"], True: ["CVODE BDF", "LSODA", "Radau"]}


def run(solver, problem, tolerance):
    """Evaluations and the largest error at the end."""
    f, x0, end, known, scale, _ = PROBLEMS[problem]
    count = 0

    def counted(t, x):
        nonlocal count
        count += 1
        return f(t, x)

    if solver.startswith("CVODE"):
        def write(t, x, derivative):
            derivative[:] = counted(t, x)

        cvode = CVODE(write, method=solver.split()[1], rtol=tolerance, atol=tolerance * scale, max_num_steps=10**6)
        x = cvode.solve(np.array([0.0, end]), np.array(x0, float)).y[-1]
    else:
        solution = solve_ivp(
            counted, (0.0, end), x0, method=solver, rtol=max(tolerance, 3e-14), atol=tolerance * scale
        )
        x = solution.y[:, -1]
    return count, np.max(np.abs(x - np.array(known)))


def evaluations_at(error, points):
    """Evaluations that lead to an error, between the points that were measured; None beyond them."""
    points = sorted((e, n) for n, e in points if e > 0)
    errors, counts = np.log([e for e, _ in points]), np.log([n for _, n in points])
    if not errors[0] <= np.log(error) <= errors[-1]:
        return None
    return int(round(np.exp(np.interp(np.log(error), errors, counts))))


def main():
    with open(sys.argv[1]) as file:
        rows = [row for row in csv.DictReader(file) if row["solver"] == "kinstep"]
    print("| problem | tolerance | error | off by tolerances | kinstep | time [µs] | others, for that error |")
    print("|---|---|--:|--:|--:|--:|---|")
    for problem, (*_, is_stiff) in PROBLEMS.items():
        measured = {
            solver: [run(solver, problem, 10.0**-power) for power in range(3, 14)] for solver in SOLVERS[is_stiff]
        }
        for row in (row for row in rows if row["problem"] == problem):
            if row["tolerance"] not in ("1e-5", "1e-7", "1e-9", "1e-11"):
                continue
            error = float(row["error"])
            found = {solver: evaluations_at(error, points) for solver, points in measured.items()}
            others = ", ".join(f"{solver} {count if count else '-'}" for solver, count in found.items())
            print(
                f"| {problem} | {row['tolerance']} | {error:.1e} | {float(row['error_over_tolerance']):.1f} "
                f"| {row['evaluations']} | {float(row['microseconds']):.0f} | {others} |"
            )


main()
