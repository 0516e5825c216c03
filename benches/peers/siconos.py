#!/usr/bin/env python3
"""Runs the solvers of Siconos on FCLIB local problems and writes one CSV row per file and solver.

    stickslip export plate_mesh1 --friction 0.8 --out problems
    /usr/bin/python3 benches/peers/siconos.py problems/*.local.hdf5 --out peers

Every solver starts from r = 0. Its own tolerance is tightened until the natural map of stickslip, recomputed here from
W, q, μ and the reaction alone, reaches the target; the time is that of the solver call at that tolerance, best of the
repeats. README.md beside this file says how to read the numbers. Without Siconos the script says so and ends with 0.
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
    import h5py
    import numpy as np
    import scipy.sparse as sparse
    import siconos.numerics as sn
except ImportError as missing:
    print(f"skipped: {missing} (Debian: apt-get install python3-siconos python3-h5py python3-scipy)")
    sys.exit(0)

sys.path.append(str(here))
import peer  # noqa: E402

NAME, VERSION = "siconos", getattr(sn, "__version__", "")

# Names in Siconos after SICONOS_FRICTION_2D_, SICONOS_FRICTION_3D_ or SICONOS_GLOBAL_FRICTION_3D_, and iterations allowed.
PLANE = {"NSGS": 1_000_000, "CPG": 1_000_000, "LEMKE": 1_000_000}
SPACE = {
    "NSGS": 1_000_000, "NSGS_LIGHT": 1_000_000, "NSN_AC": 1_000, "NSN_AC_HYBRID": 1_000, "NSN_JM": 1_000,
    "NSN_FB": 1_000, "NSN_NM": 1_000, "ADMM": 1_000_000,
}
WHOLE_BODY = {"GLOBAL_NSN_AC": 1_000, "GLOBAL_ADMM": 100_000, "GLOBAL_IPM": 1_000}
# Variants: the solver, and integer parameters by the names that Siconos documents (fc3d_Solvers).
VARIANTS = {
    "NSGS_LIGHT": ("NSGS", {"IPARAM_ERROR_EVALUATION": "NSGS_ERROR_EVALUATION_LIGHT"}),
    "NSN_AC_HYBRID": ("NSN_AC", {"NSN_HYBRID_STRATEGY": "NSN_HYBRID_STRATEGY_VI_EG_NSN"}),
    "NSN_JM": ("NSN_AC", {"NSN_FORMULATION": "NSN_FORMULATION_JEANMOREAU_STD"}),
}


def solvers(problem):
    """All that apply: those for points in space also take plane problems, as `Problem.in_space` puts them."""
    if problem.dim == 2:
        return PLANE | {f"3D_{name}": limit for name, limit in SPACE.items() if name.startswith("NSN")}
    return SPACE | (WHOLE_BODY if whole_body(problem).exists() else {})


def whole_body(problem):
    """The file with the same increment on all unknowns."""
    return Path(str(problem.path).replace(".local.", ".global."))


def solve(problem, solver, tolerance, iterations, repeats):
    """See peer.py."""
    if solver.startswith("GLOBAL_"):
        return timed(global_call(problem), f"SICONOS_{with_space(solver)}", {}, tolerance, iterations, repeats)
    lifted = problem.dim == 3 or solver.startswith("3D_")
    solver, names = VARIANTS.get(solver.removeprefix("3D_"), (solver.removeprefix("3D_"), {}))
    prefix = f"SICONOS_FRICTION_{3 if lifted else 2}D_"
    w, q = problem.in_space() if lifted else problem.scaled()
    dim = 3 if lifted else 2
    data = sn.FrictionContactProblem(dim, problem.points, w, q, problem.mu)
    driver = sn.fc3d_driver if lifted else sn.fc2d_driver

    def call(options):
        r, u = np.zeros(len(q)), np.zeros(len(q))
        begin = time.perf_counter()
        info = driver(data, r, u, options)
        return time.perf_counter() - begin, info, r

    parameters = {prefix + key: prefix + value for key, value in names.items()}
    answer = timed(call, prefix + solver, parameters, tolerance, iterations, repeats)
    r = answer["r"]
    answer["r"] = problem.from_space(r) if lifted else r * problem.rho * problem.size
    return answer


def with_space(solver):
    """GLOBAL_NSN_AC as Siconos calls it."""
    return solver.replace("GLOBAL_", "GLOBAL_FRICTION_3D_")


def global_call(problem):
    """M v = H r + f, u = Hᵀ v + w, in the scale of `Problem.scaled`: M/ρ, f/(ρ|q|), w/|q|."""
    with h5py.File(whole_body(problem), "r") as file:
        group = file["fclib_global"]
        stored = lambda name: sparse.coo_matrix(
            (group[f"{name}/x"][:], (group[f"{name}/i"][:], group[f"{name}/p"][:])),
            shape=(group[f"{name}/m"][0], group[f"{name}/n"][0]),
        ).tocsc()
        wide = lambda a: sparse.csc_matrix((a.data, a.indices.astype(np.int64), a.indptr.astype(np.int64)), a.shape)
        m, h = wide(stored("M") / problem.rho), wide(stored("H"))
        f = group["vectors/f"][:] / (problem.rho * problem.size)
        offset = group["vectors/w"][:] / problem.size
    # Its constructors with arguments crash in 4.4.
    data = sn.GlobalFrictionContactProblem()
    data.dimension, data.numberOfContacts = 3, problem.points
    data.M, data.H, data.q, data.b, data.mu = m, h, f, offset, problem.mu

    def call(options):
        r, u, v = np.zeros(h.shape[1]), np.zeros(h.shape[1]), np.zeros(h.shape[0])
        begin = time.perf_counter()
        info = sn.gfc3d_driver(data, r, u, v, options)
        return time.perf_counter() - begin, info, r * problem.rho * problem.size

    return call


def timed(call, solver, parameters, tolerance, iterations, repeats):
    """The answer with the time of the fastest call, every one with options of its own."""
    if not hasattr(sn, solver):
        raise peer.Refused(f"Siconos has no {solver}")
    best = None
    for _ in range(repeats):
        options = sn.SolverOptions(getattr(sn, solver))
        for name, value in parameters.items():
            options.iparam[getattr(sn, name)] = getattr(sn, value)
        options.dparam[sn.SICONOS_DPARAM_TOL] = tolerance
        options.iparam[sn.SICONOS_IPARAM_MAX_ITER] = iterations
        seconds, info, r = call(options)
        best = seconds if best is None else min(best, seconds)
    return {
        "info": info,
        "iterations": int(options.iparam[sn.SICONOS_IPARAM_ITER_DONE]),
        "residual": float(options.dparam[sn.SICONOS_DPARAM_RESIDU]),
        "time_s": best,
        "r": r,
    }


if __name__ == "__main__":
    peer.main(sys.modules[__name__])
