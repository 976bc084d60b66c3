"""Direct collocation with IPOPT beside shapebot's plans, on Table II's task: 2 m in 5 s.

Trapezoidal rule on 101 points; all coordinates, rates and accelerations are unknowns, the unactuated
equations of motion hold at every point. Run by run.sh.
"""

import argparse
import csv
import time
from pathlib import Path
from statistics import median

import casadi as ca
import numpy as np

from models import SYSTEMS

DISTANCE, DURATION = 2.0, 5.0
POINTS = 101
# Solves to take the median time of: as many as fit into so many seconds, from three.
SOLVES, SECONDS = 15, 20.0
# Steps of the re-integration, for everyone.
STEPS = 10000
# Weight of the squared shape acceleration beside the squared error in metres: without it the shape
# chatters from point to point.
REGULARISATION = 1e-5


def desired(times):
    """The smooth step of ninth degree."""
    tau = np.clip(times / DURATION, 0.0, 1.0)
    return DISTANCE * tau**5 * (126 + tau * (-420 + tau * (540 + tau * (-315 + tau * 70))))


class Collocation:
    """The nonlinear program of a system."""

    def __init__(self, system):
        self.system = system
        self.count, self.positions = system.q.numel(), len(system.position)
        self.residual = system.residual()
        self.output = ca.Function("output", [system.q], [system.output])
        names = ("q", "qd", "qdd")
        q, qd, qdd = (ca.MX.sym(name, self.count, POINTS) for name in names)
        step = DURATION / (POINTS - 1)
        constraints = [
            ca.vec(q[:, 1:] - q[:, :-1] - step / 2 * (qd[:, 1:] + qd[:, :-1])),
            ca.vec(qd[:, 1:] - qd[:, :-1] - step / 2 * (qdd[:, 1:] + qdd[:, :-1])),
            ca.vec(self.residual.map(POINTS)(q, qd, qdd)),
            q[:, 0], qd[:, 0], q[self.positions:, -1], qd[:, -1],
        ]
        target = np.zeros((len(system.outputs), POINTS))
        target[0] = desired(np.linspace(0.0, DURATION, POINTS))
        error = self.output.map(POINTS)(q) - target
        constraints.append(error[:, -1])
        cost = step * (ca.sumsqr(error) + REGULARISATION * ca.sumsqr(qdd[self.positions:, :]))
        unknowns = ca.vertcat(ca.vec(q), ca.vec(qd), ca.vec(qdd))
        self.program = {"x": unknowns, "f": cost, "g": ca.vertcat(*constraints)}
        self.solvers = {}

    def solver(self, warm):
        if warm not in self.solvers:
            ipopt = {"print_level": 0, "sb": "yes", "max_iter": 300, "tol": 1e-8}
            if warm:
                ipopt |= {"warm_start_init_point": "yes", "mu_init": 1e-6}
            options = {"ipopt": ipopt, "print_time": False}
            self.solvers[warm] = ca.nlpsol("solver", "ipopt", self.program, options)
        return self.solvers[warm]

    def solve(self, guess=None):
        """q, qd, qdd at the points; seconds of processor time; iterations; whether it converged."""
        solver = self.solver(guess is not None)
        size = 3 * self.count * POINTS
        start = np.zeros(size) if guess is None else np.concatenate([g.T.ravel() for g in guess])
        times = []
        while len(times) < 3 or (len(times) < SOLVES and sum(times) < SECONDS):
            begin = time.process_time()
            result = solver(x0=start, lbg=0, ubg=0)
            times.append(time.process_time() - begin)
        stats = solver.stats()
        parts = np.array(result["x"]).ravel().reshape(3, POINTS, self.count)
        return [part.T for part in parts], median(times), stats["iter_count"], stats["success"]

    def error_at_points(self, trajectory):
        """What the program itself believes: errors at its points."""
        output = np.array(self.output.map(POINTS)(trajectory[0]))
        return root_mean(output, np.linspace(0.0, DURATION, POINTS))

    def error_integrated(self, trajectory):
        """Error of the output when the shape is tracked exactly: Gamma integrated twice."""
        times = np.linspace(0.0, DURATION, STEPS + 1)
        shape = hermite([part[self.positions:] for part in trajectory], times)
        # The unactuated rows are linear in the accelerations: solve them for those of q_x.
        q, qd = self.system.q, self.system.qd
        qdd = ca.SX.sym("qdd", self.count)
        rows = self.residual(q, qd, qdd)
        matrix = ca.jacobian(rows, qdd[:self.positions])
        zeros = ca.SX.zeros(self.positions)
        rest = ca.substitute(rows, qdd[:self.positions], zeros)
        gamma = ca.Function("gamma", [q, qd, qdd], [-ca.solve(matrix, rest)])
        full = [np.vstack([np.zeros((self.positions, STEPS + 1)), part]) for part in shape]
        acceleration = np.array(gamma.map(STEPS + 1)(*full))
        position = integrate(acceleration, times[1])
        output = np.array(self.output.map(STEPS + 1)(np.vstack([position, shape[0]])))
        return root_mean(output, times)


def root_mean(output, times):
    """Root of the mean squared distance to the desired motion."""
    error = output.copy()
    error[0] -= desired(times)
    return np.sqrt(np.mean(np.sum(error**2, axis=0)))


def hermite(parts, times):
    """Quintic pieces through values, rates and accelerations at equidistant points."""
    value, rate, second = parts
    pieces = value.shape[1] - 1
    step = DURATION / pieces
    index = np.minimum((times / step).astype(int), pieces - 1)
    tau = times / step - index
    at = lambda part, offset: part[:, index + offset]
    p0, p1 = at(value, 0), at(value, 1)
    v0, v1 = step * at(rate, 0), step * at(rate, 1)
    a0, a1 = step**2 * at(second, 0), step**2 * at(second, 1)
    way = p1 - p0
    coefficients = [
        p0, v0, a0 / 2,
        10 * way - 6 * v0 - 4 * v1 - 1.5 * a0 + 0.5 * a1,
        -15 * way + 8 * v0 + 7 * v1 + 1.5 * a0 - a1,
        6 * way - 3 * v0 - 3 * v1 - 0.5 * a0 + 0.5 * a1,
    ]
    derivatives = []
    for order in range(3):
        derivatives.append(sum(c * tau**k for k, c in enumerate(coefficients)) / step**order)
        coefficients = [k * c for k, c in enumerate(coefficients)][1:]
    return derivatives


def integrate(acceleration, step):
    """Twice from rest at zero, exactly for an acceleration that is linear from sample to sample."""
    before, after = acceleration[:, :-1], acceleration[:, 1:]
    rest = np.zeros((acceleration.shape[0], 1))
    velocity = np.hstack([rest, np.cumsum(step / 2 * (before + after), axis=1)])
    moved = np.cumsum(step * velocity[:, :-1] + step**2 * (before / 3 + after / 6), axis=1)
    return np.hstack([rest, moved])


def read_rows(path):
    with open(path, encoding="utf-8") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def read_plan(folder, name, system, method, samples):
    """q, qd, qdd of a plan file at its samples."""
    rows = read_rows(folder / f"{name}_{method}_{samples}.csv")
    names = system.position + system.shape
    return [np.array([[float(row[name + suffix]) for row in rows] for name in names])
            for suffix in ("", "_d", "_dd")]


def lines(name, folder):
    """Rows of the table for one system: planner, points, seconds, iterations, two errors, a note."""
    begin = time.perf_counter()
    program = Collocation(SYSTEMS[name]())
    program.solver(False)
    note = f"setting up {time.perf_counter() - begin:.1f} s"
    guesses = {"cold": None}
    for row in read_rows(folder / "times.csv"):
        if row["system"] != name:
            continue
        method, samples = row["method"], int(row["samples"])
        plan = read_plan(folder, name, program.system, method, samples)
        if samples == POINTS:
            guesses[f"from {method}"] = plan
        errors = float(row["rmse"]), program.error_integrated(plan)
        yield f"shapebot, {method}", samples, float(row["seconds"]), "", *errors, ""
    for label, guess in guesses.items():
        program.solver(guess is not None)
        trajectory, seconds, iterations, success = program.solve(guess)
        errors = program.error_at_points(trajectory), program.error_integrated(trajectory)
        note = note if success else "not converged"
        yield f"collocation, {label}", POINTS, seconds, str(iterations), *errors, note
        note = ""


def in_unit(seconds):
    for factor, unit in ((1.0, "s"), (1e3, "ms")):
        if seconds * factor >= 1.0:
            return f"{seconds * factor:.3g} {unit}"
    return f"{seconds * 1e6:.3g} µs"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--plans", type=Path, required=True, help="where the plans of both methods are")
    parser.add_argument("--arms", action="store_true", help="the ballbot with arms as well: takes minutes")
    arguments = parser.parse_args()
    print(f"{DISTANCE:g} m in {DURATION:g} s; collocation: CasADi {ca.__version__}, IPOPT, "
          f"{POINTS} points, regularisation {REGULARISATION:g}")
    print("times: medians, of the collocation processor time; ratio: to the refined plan at "
          f"{POINTS} points")
    print("RMSE in metres: as the planner says, and re-integrated alike for everyone\n")
    print(f"{'system':<16}{'planner':<28}{'points':>7}{'time':>10}{'ratio':>9}{'iterations':>12}"
          f"{'own RMSE':>10}{'integrated':>12}")
    for name in SYSTEMS:
        if name.endswith("_arms") and not arguments.arms:
            continue
        table = list(lines(name, arguments.plans))
        refined = next(row[2] for row in table if row[:2] == ("shapebot, refined", POINTS))
        for planner, points, seconds, iterations, own, integrated, note in table:
            ratio = f"{seconds / refined:.3g}" if seconds < 1e3 * refined else f"{seconds / refined:.0f}"
            row = (f"{name:<16}{planner:<28}{points:>7}{in_unit(seconds):>10}{ratio:>9}{iterations:>12}"
                   f"{own:>10.5f}{integrated:>12.5f}")
            print(f"{row}  {note}".rstrip(), flush=True)


if __name__ == "__main__":
    main()
