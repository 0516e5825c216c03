#!/usr/bin/env python3
"""Factorisation of K beside MKL PARDISO (PyPI: pypardiso), in turn, a process of its own for every run.

    python3 -m venv peers && peers/bin/pip install pypardiso
    peers/bin/python benches/peers/pardiso.py benches/scale/cube_30.toml --program target/release/stickslip --out reports/peers

Both factor the same K, symmetric positive definite, and use as many threads as asked for. PARDISO orders by METIS, stickslip by
nested dissection of the grid; it has the Schur complement on the contact rows afterwards.
"""

import argparse
import csv
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time


def pardiso(matrix):
    """Seconds of analysis, numeric factorisation and one solve, and the residual of that."""
    import numpy as np
    import scipy.sparse as sparse
    from pypardiso import PyPardisoSolver

    k = sparse.load_npz(matrix)
    upper = sparse.triu(k).tocsr()
    upper.sort_indices()
    right = np.ones(k.shape[0])
    solver = PyPardisoSolver(mtype=2)
    solver._check_A = lambda *_: None  # it refuses triangles
    seconds = []
    for phase in (11, 22, 33):
        solver.set_phase(phase)
        clock = time.perf_counter()
        x = solver._call_pardiso(upper, right)
        seconds.append(time.perf_counter() - clock)
    residual = np.linalg.norm(k @ x - right) / np.linalg.norm(right)
    print(*seconds, residual, solver.get_iparm(18), solver.get_iparm(19))


def exported(program, case, folder):
    """K of a case as a file of SciPy, and its size."""
    import h5py
    import scipy.sparse as sparse

    subprocess.run([program, "export", case, "--out", folder], check=True, stdout=subprocess.DEVNULL)
    (file,) = pathlib.Path(folder).glob(pathlib.Path(case).stem + ".*.global.hdf5")
    m = h5py.File(file)["fclib_global/M"]
    n, entries = int(m["n"][0]), int(m["nz"][0])
    k = sparse.coo_matrix((m["x"][:entries], (m["i"][:entries], m["p"][:entries])), (n, n)).tocsr()
    path = file.with_suffix(".npz")
    sparse.save_npz(path, k)
    return path, k.shape[0]


def ours(program, case, threads, folder):
    """Seconds of analysis and factorisation, W included."""
    environment = dict(os.environ, RAYON_NUM_THREADS=str(threads))
    command = [program, "run", case, "--method", "hybrid", "--fields", "none", "--out", folder]
    subprocess.run(command, check=True, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    (row,) = csv.DictReader(open(os.path.join(folder, "runs.csv")))
    return float(row["factorisation_s"]) + float(row["condensation_s"])


def theirs(matrix, threads):
    environment = dict(os.environ, MKL_NUM_THREADS=str(threads), OMP_NUM_THREADS=str(threads))
    command = [sys.executable, __file__, "--matrix", str(matrix)]
    found = subprocess.run(command, check=True, env=environment, capture_output=True, text=True)
    analysis, numeric, _, residual, entries, mflop = map(float, found.stdout.split())
    if not residual < 1e-6:
        sys.exit(f"{matrix}: residual {residual}; K of a floating body is singular, which PARDISO does not see")
    return analysis, numeric, entries, mflop


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cases", nargs="*")
    parser.add_argument("--program", default="target/release/stickslip")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--threads", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--out", default="peers")
    parser.add_argument("--matrix", help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.matrix:
        return pardiso(given.matrix)
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for case in given.cases:
            matrix, unknowns = exported(given.program, case, folder)
            for threads in given.threads:
                own, other = [], []
                for _ in range(given.rounds):
                    own.append(ours(given.program, case, threads, os.path.join(folder, pathlib.Path(case).stem)))
                    other.append(theirs(matrix, threads))
                numeric = [o[1] for o in other]
                total = [o[0] + o[1] for o in other]
                rows.append({
                    "case": pathlib.Path(case).stem,
                    "unknowns": unknowns,
                    "threads": threads,
                    "rounds": given.rounds,
                    "own_s": f"{statistics.median(own):.3f}",
                    "own_least_s": f"{min(own):.3f}",
                    "own_most_s": f"{max(own):.3f}",
                    "numeric_s": f"{statistics.median(numeric):.3f}",
                    "numeric_least_s": f"{min(numeric):.3f}",
                    "numeric_most_s": f"{max(numeric):.3f}",
                    "analysis_s": f"{statistics.median(o[0] for o in other):.3f}",
                    "ratio_numeric": f"{statistics.median(a / b for a, b in zip(own, numeric)):.2f}",
                    "ratio_total": f"{statistics.median(a / b for a, b in zip(own, total)):.2f}",
                    "entries": int(other[0][2]),
                    "mflop": int(other[0][3]),
                })
                print(rows[-1])
    os.makedirs(given.out, exist_ok=True)
    with open(os.path.join(given.out, "pardiso.csv"), "w", newline="") as file:
        table = csv.DictWriter(file, rows[0])
        table.writeheader()
        table.writerows(rows)


if __name__ == "__main__":
    main()
