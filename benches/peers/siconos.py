#!/usr/bin/env python3
"""Runs the solvers of Siconos on FCLIB local problems and writes one CSV row per file and solver.

    stickslip export plate_mesh1 --friction 0.8 --out problems
    python3 benches/peers/siconos.py problems/*.local.hdf5 --out peers

Every solver starts from r = 0. Its own tolerance is tightened until the natural map of stickslip, recomputed here from
W, q, μ and the reaction alone, reaches the target; the time is that of the solver call at that tolerance, best of the
repeats. README.md beside this file says how to read the numbers. Without Siconos the script says so and ends with 0.
"""

import argparse
import csv
import multiprocessing
import os
import sys
import time
from pathlib import Path

# This file is named like the package it imports, which Python would look for beside it first.
sys.path = [entry for entry in sys.path if Path(entry or ".").resolve() != Path(__file__).resolve().parent]

# One thread, as the methods of stickslip.
for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

try:
    import h5py
    import numpy as np
    import siconos.numerics as sn
except ImportError as missing:
    print(f"skipped: {missing} (Debian: apt-get install python3-siconos python3-h5py)")
    sys.exit(0)

# Names in Siconos after SICONOS_FRICTION_2D_ or _3D_, and iterations allowed.
SOLVERS = {
    2: {"NSGS": 1_000_000, "CPG": 1_000_000, "LEMKE": 1_000_000},
    3: {"NSGS": 1_000_000, "NSN_AC": 1_000, "NSN_FB": 1_000, "ADMM": 1_000_000},
}
SMALLEST_TOLERANCE = 1e-16
COLUMNS = [
    "file", "dim", "points", "solver", "target", "tolerance", "status", "info", "iterations",
    "siconos_residual", "natural_map", "time_s", "repeats", "attempts", "reaction",
]


class Refused(Exception):
    """A file that Siconos' local solvers cannot take."""


class Problem:
    """u = W r + q with the cones of μ, in the units of the file."""

    def __init__(self, path):
        with h5py.File(path, "r") as file:
            if "fclib_local" not in file:
                raise Refused("no /fclib_local in it: export or give the local problem")
            group = file["fclib_local"]
            if "V" in group and group["V/n"][0] > 0:
                raise Refused("it has unknowns beside the reactions (V, s), which these solvers lack")
            self.dim = int(group["spacedim"][0])
            self.q = group["vectors/q"][:].astype(float)
            self.mu = group["vectors/mu"][:].astype(float)
            self.w = dense(group["W"])
        self.points = len(self.mu)
        # Points without friction have only their normal row, as in stickslip.
        self.used = np.ones(len(self.q), bool).reshape(self.points, self.dim)
        self.used[self.mu == 0, 1:] = False
        self.used = self.used.ravel()
        self.rho = self.used.sum() / np.trace(self.w[np.ix_(self.used, self.used)])

    def natural_map(self, r):
        """|P − proj(P − ρ ṽ)| / max(ρ |q|, |P|), ṽ = (g + μ |d|, d), ρ = rows / trace(W)."""
        used = self.used
        p = np.where(used, r, 0.0)
        v = np.where(used, self.w @ p + self.q, 0.0).reshape(self.points, self.dim)
        v[:, 0] += self.mu * np.linalg.norm(v[:, 1:], axis=1)
        z = p.reshape(self.points, self.dim) - self.rho * v
        e = np.linalg.norm(p - projected(z, self.mu).ravel())
        # Forces the law forbids count too.
        e = np.hypot(e, np.linalg.norm(r[~used]))
        reference = max(self.rho * np.linalg.norm(self.q[used]), np.linalg.norm(p))
        return 0.0 if e == 0 else e / reference


def dense(group):
    """A stored matrix, whichever way it is stored."""
    m, n, nz = (int(group[name][0]) for name in ("m", "n", "nz"))
    p, i, x = (group[name][:] for name in ("p", "i", "x"))
    matrix = np.zeros((m, n))
    if nz >= 0:
        np.add.at(matrix, (i[:nz], p[:nz]), x[:nz])
        return matrix
    lines = np.repeat(np.arange(len(p) - 1), np.diff(p))
    inner, x = i[: p[-1]], x[: p[-1]]
    np.add.at(matrix, (inner, lines) if nz == -1 else (lines, inner), x)
    return matrix


def projected(z, mu):
    """Projection of every row of z on |z_t| <= μ z_n."""
    t = np.linalg.norm(z[:, 1:], axis=1)
    inside = (z[:, 0] >= 0) & (t <= mu * z[:, 0])
    polar = mu * t <= -z[:, 0]
    c = (z[:, 0] + mu * t) / (1 + mu**2)
    out = np.empty_like(z)
    out[:, 0] = c
    out[:, 1:] = z[:, 1:] * (mu * c / np.where(t > 0, t, 1.0))[:, None]
    out[polar] = 0.0
    out[inside] = z[inside]
    return out


def call(pipe, problem, solver, tolerance, iterations, repeats):
    """In a process of its own: a solver that crashes takes nothing with it."""
    dim, points = problem.dim, problem.points
    # Siconos stops at residuals that depend on units, so it gets none: W' = ρ W has a mean diagonal of 1, q' = q/|q|.
    # The laws are homogeneous, hence r = ρ |q| r'.
    size = np.linalg.norm(problem.q) or 1.0
    w = np.asfortranarray(problem.w * problem.rho)
    scaled = sn.FrictionContactProblem(dim, points, w, problem.q / size, problem.mu)
    driver = sn.fc2d_driver if dim == 2 else sn.fc3d_driver
    number = getattr(sn, f"SICONOS_FRICTION_{dim}D_{solver}")
    best = None
    for _ in range(repeats):
        options = sn.SolverOptions(number)
        options.dparam[sn.SICONOS_DPARAM_TOL] = tolerance
        options.iparam[sn.SICONOS_IPARAM_MAX_ITER] = iterations
        r, u = np.zeros(len(problem.q)), np.zeros(len(problem.q))
        begin = time.perf_counter()
        info = driver(scaled, r, u, options)
        seconds = time.perf_counter() - begin
        best = seconds if best is None else min(best, seconds)
    pipe.send({
        "info": info,
        "iterations": int(options.iparam[sn.SICONOS_IPARAM_ITER_DONE]),
        "siconos_residual": float(options.dparam[sn.SICONOS_DPARAM_RESIDU]),
        "time_s": best,
        "r": r * problem.rho * size,
    })


def attempt(problem, solver, tolerance, iterations, repeats, limit):
    """The answer of one call, or the reason there is none."""
    fork = multiprocessing.get_context("fork")
    here, there = fork.Pipe(duplex=False)
    child = fork.Process(target=call, args=(there, problem, solver, tolerance, iterations, repeats))
    child.start()
    there.close()
    answer, status = None, "time-limit"
    if here.poll(limit):
        try:
            answer = here.recv()
        except EOFError:
            child.join()
            status = f"crashed: exit code {child.exitcode}"
    if child.is_alive() and answer is None:
        child.kill()
    child.join()
    return answer, status


def run(problem, solver, arguments):
    """Tightens the tolerance of Siconos until the natural map is small enough."""
    iterations = SOLVERS[problem.dim].get(solver, 1_000_000)
    tolerance, attempts, last = arguments.tolerance, 0, None
    while tolerance >= SMALLEST_TOLERANCE:
        attempts += 1
        answer, status = attempt(problem, solver, tolerance, iterations, 1, arguments.limit)
        if answer is None:
            last = {"status": status, "tolerance": tolerance, "attempts": attempts}
            break
        answer["natural_map"] = problem.natural_map(answer["r"])
        last = {**answer, "tolerance": tolerance, "attempts": attempts, "status": "not-reached"}
        if answer["natural_map"] <= arguments.target:
            last["status"] = "solved"
            break
        if answer["info"] != 0:
            # It did not even reach what it was asked for.
            last["status"] = "gave-up"
            break
        tolerance *= 0.1
    if last["status"] != "solved" or arguments.repeats <= 1:
        last["repeats"] = 1
        return last
    answer, _ = attempt(
        problem, solver, tolerance, iterations, arguments.repeats, arguments.limit * arguments.repeats
    )
    if answer is not None:
        last.update(time_s=answer["time_s"])
        last["repeats"] = arguments.repeats
    return last


def write_vector(path, values):
    """MatrixMarket, every digit."""
    with open(path, "w") as file:
        file.write(f"%%MatrixMarket matrix array real general\n{len(values)} 1\n")
        file.writelines(f"{float(value)!r}\n" for value in values)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("files", nargs="+", type=Path, help="FCLIB local problems (HDF5)")
    parser.add_argument("--solver", action="append", help="e.g. NSGS, NSN_AC; may be repeated; default: all listed")
    parser.add_argument("--target", type=float, default=1e-9, help="natural map to reach (1e-9)")
    parser.add_argument("--tolerance", type=float, default=1e-8, help="first tolerance given to Siconos (1e-8)")
    parser.add_argument("--repeats", type=int, default=5, help="timed calls, the best counts (5)")
    parser.add_argument("--limit", type=float, default=60.0, help="seconds per call (60)")
    parser.add_argument("--out", type=Path, default=Path("peers"), help="folder for siconos.csv and the reactions")
    arguments = parser.parse_args()

    arguments.out.mkdir(parents=True, exist_ok=True)
    table = arguments.out / "siconos.csv"
    with open(table, "w", newline="") as file:
        rows = csv.DictWriter(file, COLUMNS, restval="")
        rows.writeheader()
        for path in arguments.files:
            name = path.name.removesuffix(".hdf5")
            try:
                problem = Problem(path)
            except (Refused, OSError, KeyError) as reason:
                rows.writerow({"file": name, "status": f"refused: {reason}"})
                print(f"{name}: refused: {reason}")
                continue
            for solver in arguments.solver or SOLVERS[problem.dim]:
                row = {"file": name, "dim": problem.dim, "points": problem.points, "solver": solver}
                row["target"] = arguments.target
                if hasattr(sn, f"SICONOS_FRICTION_{problem.dim}D_{solver}"):
                    row.update(run(problem, solver, arguments))
                else:
                    row["status"] = f"refused: Siconos has no {solver} in {problem.dim}D"
                reaction = row.pop("r", None)
                if reaction is not None:
                    row["reaction"] = f"{name}.{solver}.r.mtx"
                    write_vector(arguments.out / row["reaction"], reaction)
                if row["status"] != "solved":
                    # A time is published only beside a right answer.
                    row.pop("time_s", None)
                rows.writerow(row)
                numbers = [f"{key} {row[key]:.3g}" for key in ("natural_map", "tolerance", "time_s") if key in row]
                print(f"{name} {solver}: {row['status']}, {row.get('iterations', '-')} iterations", *numbers, sep=", ")
    print(f"Siconos {getattr(sn, '__version__', '')} results: {table}".replace("  ", " "))


if __name__ == "__main__":
    main()
