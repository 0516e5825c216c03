"""What the scripts of all peers share: problems, accuracy, times, the table.

A peer is a module with `NAME`, `VERSION`, `solvers(problem)` -> {name: iterations allowed} and
`solve(problem, solver, tolerance, iterations, repeats)` -> {"info", "iterations", "residual", "time_s", "r"}, from r = 0, r in
the units of the file, `time_s` the fastest of the repeats. `info` is 0 where the solver itself reports success.
README.md beside this file says how to read the numbers.

`peer.py FILE OUT` writes the problem of a file, local or global, as a local one: what the peers see.
"""

import argparse
import csv
import multiprocessing
import os
import sys
from pathlib import Path

import h5py
import numpy as np
import scipy.sparse as sparse
from scipy.sparse.linalg import splu

# Part of the entries below which a matrix is held by these alone.
SPARSE = 0.1
# Given to a solver in turn.
TOLERANCES = [1e-4, 1e-6, *(10.0**-k for k in range(8, 17))]
COLUMNS = [
    "file", "dim", "points", "solver", "target", "tolerance", "status", "info", "iterations",
    "residual", "natural_map", "reached", "time_s", "repeats", "attempts", "reaction",
]


class Refused(Exception):
    """A file, or a solver, that the peer cannot take."""


class Problem:
    """u = W r + q with the cones of μ, in the units of the file; a global problem is condensed."""

    def __init__(self, path):
        with h5py.File(path, "r") as file:
            own = file["fclib_local" if "fclib_local" in file else "fclib_global"]
            if "V" in own and own["V/n"][0] > 0:
                raise Refused("it has unknowns beside the reactions (V, s), which these solvers lack")
            self.dim = int(own["spacedim"][0])
            self.mu = own["vectors/mu"][:].astype(float)
            if "W" in own:
                self.w, self.q = stored(own["W"]), own["vectors/q"][:].astype(float)
            else:
                # M v = H r + f, u = Hᵀ v + w.
                m, h = sparse.csc_matrix(stored(own["M"])), sparse.csc_matrix(stored(own["H"]))
                moved = splu(m).solve(np.column_stack([h.toarray(), own["vectors/f"][:]]))
                w = sparse.csc_matrix(h.T @ moved[:, :-1])
                self.w = w if w.nnz < SPARSE * w.shape[0] ** 2 else w.toarray()
                self.q = own["vectors/w"][:] + h.T @ moved[:, -1]
        self.points = len(self.mu)
        # Points without friction have only their normal row, as in stickslip.
        self.used = np.ones(len(self.q), bool).reshape(self.points, self.dim)
        self.used[self.mu == 0, 1:] = False
        self.used = self.used.ravel()
        self.rho = self.used.sum() / self.w.diagonal()[self.used].sum()
        self.size = np.linalg.norm(self.q) or 1.0
        self.path = path

    def scaled(self):
        """W' = ρ W and q' = q/|q|, in column-major order: r = ρ |q| r', because the laws are homogeneous.

        Solvers stop at residuals that depend on units, so they get none: W' has a mean diagonal of 1.
        """
        w = self.w * self.rho
        return w if sparse.issparse(w) else np.asfortranarray(w), self.q / self.size

    def in_space(self):
        """The same in 3D: a plane problem gets a second tangent along which nothing pushes and nothing is coupled."""
        w, q = self.scaled()
        if self.dim == 3:
            return w, q
        rows = np.arange(3 * self.points).reshape(-1, 3)[:, :2].ravel()
        far = np.zeros(3 * self.points)
        far[rows] = q
        if sparse.issparse(w):
            w, shape = w.tocoo(), (3 * self.points, 3 * self.points)
            third = np.arange(2, 3 * self.points, 3)
            places = np.append(rows[w.row], third), np.append(rows[w.col], third)
            return sparse.csc_matrix((np.append(w.data, np.ones(self.points)), places), shape), far
        lifted = np.eye(3 * self.points, order="F")
        lifted[np.ix_(rows, rows)] = w
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


def stored(group):
    """A matrix, whichever way it is stored: sparse where few of its entries are not 0."""
    m, n, nz = (int(group[name][0]) for name in ("m", "n", "nz"))
    p, i, x = (group[name][:] for name in ("p", "i", "x"))
    if nz >= 0:
        matrix = sparse.coo_matrix((x[:nz], (i[:nz], p[:nz])), (m, n)).tocsc()
    else:
        matrix = (sparse.csc_matrix if nz == -1 else sparse.csr_matrix)((x[: p[-1]], i[: p[-1]], p), (m, n)).tocsc()
    return matrix if matrix.nnz < SPARSE * m * n else matrix.toarray()


def write_local(problem, path):
    """The problem as an FCLIB file."""
    w = sparse.coo_matrix(problem.w)
    whole = lambda *values: np.array(values, dtype="i4")
    with h5py.File(path, "w") as file:
        file["fclib_local/spacedim"] = whole(problem.dim)
        sizes = {"m": w.shape[0], "n": w.shape[1], "nz": w.nnz, "nzmax": w.nnz}
        parts = {name: whole(size) for name, size in sizes.items()} | {"i": w.row, "p": w.col, "x": w.data}
        for name, values in parts.items():
            file[f"fclib_local/W/{name}"] = values
        file["fclib_local/vectors/q"], file["fclib_local/vectors/mu"] = problem.q, problem.mu


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
    """Tightens the tolerance of the solver until the natural map is small enough to be timed, and then as far as it follows."""
    row, solved, reached = {}, {}, np.inf
    for attempts, tolerance in enumerate(TOLERANCES, 1):
        answer, status = attempt(peer, problem, solver, tolerance, iterations, 1, arguments.limit)
        row = {"status": status, "tolerance": tolerance, "attempts": attempts}
        if answer is None:
            break
        natural_map = problem.natural_map(answer["r"])
        reached = min(reached, natural_map)
        # Reports success, or did not even reach what it was asked for.
        row |= answer | {"natural_map": natural_map, "status": "gave-up" if answer["info"] != 0 else "not-reached"}
        if natural_map <= arguments.target:
            solved = solved or row | {"status": "solved"}
        if natural_map <= arguments.reach or answer["info"] != 0:
            break
    row = (solved or row) | {"reached": reached, "repeats": 1}
    # Long calls are timed as often as a part of the limit allows.
    repeats = min(arguments.repeats, int(0.1 * arguments.limit / max(row.get("time_s", 0.0), 1e-9)))
    if solved and repeats > 1:
        answer, _ = attempt(peer, problem, solver, row["tolerance"], iterations, repeats, arguments.limit)
        if answer is not None:
            row |= {"time_s": min(answer["time_s"], row["time_s"]), "repeats": repeats}
    return row


def write_vector(path, values):
    """A line a number, every digit."""
    with open(path, "w") as file:
        file.writelines(f"{float(value)!r}\n" for value in values)


def main(peer):
    """The command line of a peer."""
    parser = argparse.ArgumentParser(description=peer.__doc__.split("\n")[0])
    parser.add_argument("files", nargs="+", type=Path, help="FCLIB problems (HDF5)")
    parser.add_argument("--solver", action="append", help="e.g. NSGS, NSN_AC; may be repeated; default: all listed")
    parser.add_argument("--target", type=float, default=1e-9, help="natural map to reach (1e-9)")
    parser.add_argument("--reach", type=float, default=1e-12, help="natural map from which on no smaller one is looked for (1e-12)")
    parser.add_argument("--repeats", type=int, default=5, help="timed calls, the best counts (5)")
    parser.add_argument("--limit", type=float, default=60.0, help="seconds per call, and for all repeats (60)")
    parser.add_argument("--out", type=Path, default=Path("peers"), help="folder for the reactions and the table, to which rows are added")
    arguments = parser.parse_args()

    arguments.out.mkdir(parents=True, exist_ok=True)
    table = arguments.out / f"{peer.NAME}.csv"
    with open(table, "a", newline="") as file:
        rows = csv.DictWriter(file, COLUMNS, restval="")
        if file.tell() == 0:
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


if __name__ == "__main__":
    write_local(Problem(Path(sys.argv[1])), sys.argv[2])
