"""What the scripts of all peers share: problems, accuracy, times, the table.

A peer is a module with `NAME`, `VERSION`, `solvers(problem)` -> {name: iterations allowed} and
`solve(problem, solver, tolerance, iterations, repeats)` -> {"info", "iterations", "residual", "time_s", "r"}, from r = 0, r in
the units of the file, `time_s` the fastest of the repeats. `info` is 0 where the solver itself reports success.
README.md beside this file says how to read the numbers.
"""

import argparse
import csv
import multiprocessing
import os
from pathlib import Path

import h5py
import numpy as np

SMALLEST_TOLERANCE = 1e-16
COLUMNS = [
    "file", "dim", "points", "solver", "target", "tolerance", "status", "info", "iterations",
    "residual", "natural_map", "time_s", "repeats", "attempts", "reaction",
]


class Refused(Exception):
    """A file, or a solver, that the peer cannot take."""


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
        self.size = np.linalg.norm(self.q) or 1.0
        self.path = path

    def scaled(self):
        """W' = ρ W and q' = q/|q|, in column-major order: r = ρ |q| r', because the laws are homogeneous.

        Solvers stop at residuals that depend on units, so they get none: W' has a mean diagonal of 1.
        """
        return np.asfortranarray(self.w * self.rho), self.q / self.size

    def in_space(self):
        """The same in 3D: a plane problem gets a second tangent along which nothing pushes and nothing is coupled."""
        w, q = self.scaled()
        if self.dim == 3:
            return w, q
        rows = np.arange(3 * self.points).reshape(-1, 3)[:, :2].ravel()
        lifted, far = np.eye(3 * self.points, order="F"), np.zeros(3 * self.points)
        lifted[np.ix_(rows, rows)], far[rows] = w, q
        return lifted, far

    def from_space(self, r):
        """Reactions of `in_space` in the units and dimensions of the file."""
        return r.reshape(-1, 3)[:, : self.dim].ravel() * self.rho * self.size

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


def answer_of(pipe, peer, *arguments):
    """In a process of its own: a solver that crashes takes nothing with it, and one that talks is not heard."""
    for stream in (1, 2):
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream)
    try:
        pipe.send(peer.solve(*arguments))
    except Refused as reason:
        pipe.send({"refused": str(reason)})


def attempt(peer, problem, solver, tolerance, iterations, repeats, limit):
    """The answer of one call, or the reason there is none."""
    fork = multiprocessing.get_context("fork")
    here, there = fork.Pipe(duplex=False)
    child = fork.Process(target=answer_of, args=(there, peer, problem, solver, tolerance, iterations, repeats))
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
    if answer and "refused" in answer:
        return None, f"refused: {answer['refused']}"
    return answer, status


def run(peer, problem, solver, iterations, arguments):
    """Tightens the tolerance of the solver until the natural map is small enough."""
    tolerance, attempts, last = arguments.tolerance, 0, None
    while tolerance >= SMALLEST_TOLERANCE:
        attempts += 1
        answer, status = attempt(peer, problem, solver, tolerance, iterations, 1, arguments.limit)
        if answer is None:
            return {"status": status, "tolerance": tolerance, "attempts": attempts, "repeats": 1}
        answer["natural_map"] = problem.natural_map(answer["r"])
        last = {**answer, "tolerance": tolerance, "attempts": attempts, "status": "not-reached", "repeats": 1}
        if answer["natural_map"] <= arguments.target:
            last["status"] = "solved"
            break
        if answer["info"] != 0:
            # It did not even reach what it was asked for.
            last["status"] = "gave-up"
            break
        tolerance *= 0.1
    # Long calls are timed as often as the limit allows.
    repeats = min(arguments.repeats, int(arguments.limit / max(last["time_s"], 1e-9)))
    if last["status"] == "solved" and repeats > 1:
        again = (peer, problem, solver, tolerance, iterations, repeats, 2 * arguments.limit)
        answer, _ = attempt(*again)
        if answer is not None:
            last.update(time_s=answer["time_s"], repeats=repeats)
    return last


def write_vector(path, values):
    """A line a number, every digit."""
    with open(path, "w") as file:
        file.writelines(f"{float(value)!r}\n" for value in values)


def main(peer):
    """The command line of a peer."""
    parser = argparse.ArgumentParser(description=peer.__doc__.split("\n")[0])
    parser.add_argument("files", nargs="+", type=Path, help="FCLIB local problems (HDF5)")
    parser.add_argument("--solver", action="append", help="e.g. NSGS, NSN_AC; may be repeated; default: all listed")
    parser.add_argument("--target", type=float, default=1e-9, help="natural map to reach (1e-9)")
    parser.add_argument("--tolerance", type=float, default=1e-8, help="first tolerance given to the solver (1e-8)")
    parser.add_argument("--repeats", type=int, default=5, help="timed calls, the best counts (5)")
    parser.add_argument("--limit", type=float, default=60.0, help="seconds per call, and for all repeats (60)")
    parser.add_argument("--out", type=Path, default=Path("peers"), help="folder for the table and the reactions")
    arguments = parser.parse_args()

    arguments.out.mkdir(parents=True, exist_ok=True)
    table = arguments.out / f"{peer.NAME}.csv"
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
            solvers = peer.solvers(problem)
            for solver in arguments.solver or solvers:
                row = {"file": name, "dim": problem.dim, "points": problem.points, "solver": solver}
                row["target"] = arguments.target
                row.update(run(peer, problem, solver, solvers.get(solver, 1_000_000), arguments))
                reaction = row.pop("r", None)
                if reaction is not None:
                    row["reaction"] = f"{name}.{solver}.r.txt"
                    write_vector(arguments.out / row["reaction"], reaction)
                if row["status"] != "solved":
                    # A time is published only beside a right answer.
                    row.pop("time_s", None)
                rows.writerow(row)
                file.flush()
                numbers = [f"{key} {row[key]:.3g}" for key in ("natural_map", "tolerance", "time_s") if key in row]
                print(f"{name} {solver}: {row['status']}, {row.get('iterations', '-')} iterations", *numbers, sep=", ")
    print(f"{peer.NAME} {peer.VERSION}: {table}")
