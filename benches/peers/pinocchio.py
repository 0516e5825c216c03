#!/usr/bin/env python3
"""Runs the contact solvers of Pinocchio on FCLIB local problems and writes one CSV row per file and solver.

    python3 -m venv peers && peers/bin/pip install pin h5py scipy # PyPI; brings NumPy
    peers/bin/python benches/peers/pinocchio.py problems/*.local.hdf5 --out peers

As siconos.py: from the same files, from r = 0, to the same natural map. Its points have their normal last and live in space.
"""

import os
import sys
import time
from pathlib import Path

# One thread, as the methods of stickslip.
for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(variable, "1")
# This file is named like the package it imports, which Python would look for beside it first.
here = Path(__file__).resolve().parent
sys.path = [entry for entry in sys.path if Path(entry or ".").resolve() != here]

try:
    import h5py  # noqa: F401
    import numpy as np
    import pinocchio as pin
    import scipy.sparse as sparse
except ImportError as missing:
    print(f"skipped: {missing} (PyPI: pip install pin h5py scipy)")
    sys.exit(0)

sys.path.append(str(here))
import peer  # noqa: E402

NAME, VERSION = "pinocchio", pin.__version__

# A dense W of so many rows takes 0.8 GB, and there are copies.
MOST_ROWS = 10_000
SOLVERS = {"PGS": 1_000_000, "ADMM": 1_000_000, "ADMM_SPECTRAL": 1_000_000, "ADMM_ANDERSON": 1_000_000}
# What the settings of a variant differ in.
VARIANTS = {
    "ADMM_SPECTRAL": {"admm_update_rule": pin.ADMMUpdateRule.SPECTRAL},
    "ADMM_ANDERSON": {"anderson_capacity": 10},
}


def solvers(_):
    """All of them take every problem."""
    return SOLVERS


def solve(problem, solver, tolerance, iterations, repeats):
    """See peer.py."""
    family = solver.split("_")[0]
    w, q = problem.in_space()
    if sparse.issparse(w):
        if len(q) > MOST_ROWS:
            raise peer.Refused(f"its W is dense: {len(q)} rows take more memory than there may be")
        w = w.toarray()
    order = np.arange(len(q)).reshape(-1, 3)[:, [1, 2, 0]].ravel()
    w, q = np.asfortranarray(w[np.ix_(order, order)]), q[order]
    model = pin.Model()
    points, data = pin.StdVec_ConstraintModel(), pin.StdVec_ConstraintData()
    for mu in problem.mu:
        point = pin.PointContactConstraintModel(model)
        point.setFriction(float(mu))
        points.append(pin.ConstraintModel(point))
        data.append(points[len(points) - 1].createData())
    settings = getattr(pin, f"{family}SolverSettings")()
    settings.max_iterations = iterations
    for quantity in ("feasibility", "complementarity"):
        setattr(settings, f"absolute_{quantity}_tol", tolerance)
        setattr(settings, f"relative_{quantity}_tol", tolerance)
    for name, value in VARIANTS.get(solver, {}).items():
        setattr(settings, name, value)
    best = None
    for _ in range(repeats):
        method, result = (getattr(pin, f"{family}{kind}")() for kind in ("ConstraintSolver", "SolverResult"))
        # Its factorisations belong to the solver: an operator that was damped and factored before must not help it.
        delassus = pin.DelassusOperatorDense(w)
        begin = time.perf_counter()
        converged = method.solve(delassus, q, points, data, settings, result)
        seconds = time.perf_counter() - begin
        best = seconds if best is None else min(best, seconds)
    found = np.empty(len(q))
    found[order] = result.retrieveConstraintImpulses()
    return {
        "info": 0 if converged else 1,
        "iterations": result.iterations,
        "residual": max(result.primal_feasibility, result.dual_feasibility, result.complementarity),
        "time_s": best,
        "r": problem.from_space(found),
    }


if __name__ == "__main__":
    peer.main(sys.modules[__name__])
