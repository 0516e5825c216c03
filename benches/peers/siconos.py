#!/usr/bin/env python3
"""Runs the solvers of Siconos on FCLIB problems and writes one CSV row per file and solver.

    stickslip export plate_mesh1 --friction 0.8 --out problems
    /usr/bin/python3 benches/peers/siconos.py problems/*.local.hdf5 --out peers

Every solver starts from r = 0. Its own tolerance is tightened until the natural map of stickslip, recomputed here from
W, q, μ and the reaction alone, reaches the target; the time is that of the solver call at that tolerance, best of the
repeats. README.md beside this file says how to read the numbers. Without Siconos the script says so and ends with 0.
"""

import ctypes
import os
import subprocess
import sys
import tempfile
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

SWEEPS, STEPS = 1_000_000, 1_000
# Iterations allowed, by names in Siconos after SICONOS_FRICTION_2D_ and SICONOS_GLOBAL_FRICTION_3D_.
PLANE = {"NSGS": SWEEPS, "CPG": SWEEPS, "LEMKE": SWEEPS}
WHOLE_BODY = {"GLOBAL_NSN_AC": STEPS, "GLOBAL_ADMM": 100_000, "GLOBAL_IPM": STEPS}
# In space: the solver, by its name after SICONOS_FRICTION_3D_, iterations allowed, and integer parameters by the names that Siconos
# documents (fc3d_Solvers).
RULES = {"": "CONSTANT", "_NORM": "SPECTRAL_NORM", "_SPLIT": "SPLIT_SPECTRAL_NORM", "_COND": "SPLIT_SPECTRAL_NORM_COND"}
SEARCHES = {"": "GOLDSTEINPRICE", "_PLAIN": "NO"}
NEWTON = {
    f"NSN_AC{rule}{search}": ("NSN_AC", STEPS, {
        "NSN_RHO_STRATEGY": f"NSN_FORMULATION_RHO_STRATEGY_{RULES[rule]}", "NSN_LINESEARCH": f"NSN_LINESEARCH_{SEARCHES[search]}",
    })
    for rule in RULES for search in SEARCHES
} | {
    "NSN_AC_TEST": ("NSN_AC_TEST", STEPS, {}),
    "NSN_AC_TEST_PLAIN": ("NSN_AC_TEST", STEPS, {"NSN_LINESEARCH": "NSN_LINESEARCH_NO"}),
    "NSN_AC_HYBRID": ("NSN_AC", STEPS, {"NSN_HYBRID_STRATEGY": "NSN_HYBRID_STRATEGY_VI_EG_NSN"}),
    "NSN_AC_GENERATED": ("NSN_AC", STEPS, {"NSN_FORMULATION": "NSN_FORMULATION_ALARTCURNIER_GENERATED"}),
    "NSN_JM": ("NSN_AC", STEPS, {"NSN_FORMULATION": "NSN_FORMULATION_JEANMOREAU_STD"}),
    "NSN_FB": ("NSN_FB", STEPS, {}),
    "NSN_NM": ("NSN_NM", STEPS, {}),
}
FIRST_ORDER = {
    "NSGS": ("NSGS", SWEEPS, {}),
    "NSGS_LIGHT": ("NSGS", SWEEPS, {"IPARAM_ERROR_EVALUATION": "NSGS_ERROR_EVALUATION_LIGHT"}),
    "ADMM": ("ADMM", SWEEPS, {}),
    "VI_EG": ("VI_EG", SWEEPS, {}),
    "VI_FPP": ("VI_FPP", SWEEPS, {}),
    "PROX": ("PROX", STEPS, {}),
}
SPACE = NEWTON | FIRST_ORDER

# A call in C: the interface of Python takes 0.3 to 0.7 µs, a quarter of the smallest problems.
CALL = """
#include <string.h>
#include <time.h>
double timed(int (*driver)(void *, double *, double *, void *), void *problem, double *r, double *u, int rows, void *options, int *info) {
    struct timespec from, to;
    memset(r, 0, rows * sizeof *r);
    memset(u, 0, rows * sizeof *u);
    clock_gettime(CLOCK_MONOTONIC, &from);
    *info = driver(problem, r, u, options);
    clock_gettime(CLOCK_MONOTONIC, &to);
    return (to.tv_sec - from.tv_sec) + 1e-9 * (to.tv_nsec - from.tv_nsec);
}
"""


def compiled():
    """The call, compiled by `gcc`, and the library of the drivers."""
    with tempfile.TemporaryDirectory() as folder:
        library = Path(folder, "call.so")
        subprocess.run(["gcc", "-O2", "-shared", "-fPIC", "-x", "c", "-", "-o", library], input=CALL, text=True, check=True)
        call = ctypes.CDLL(str(library)).timed
    call.restype = ctypes.c_double
    return call, ctypes.CDLL("libsiconos_numerics.so.7")


TIMED, DRIVERS = compiled()


def solvers(problem):
    """All that apply, with the iterations allowed: Newton methods for points in space also take plane problems, as `Problem.in_space`
    puts them."""
    if problem.dim == 2:
        return PLANE | {f"3D_{name}": own[1] for name, own in NEWTON.items()}
    return {name: own[1] for name, own in SPACE.items()} | (WHOLE_BODY if whole_body(problem) else {})


def whole_body(problem):
    """The file with the same increment on all unknowns, if there is one: that of a case, or the one given."""
    for path in (problem.path, Path(str(problem.path).replace(".local.", ".global."))):
        if path.exists():
            with h5py.File(path, "r") as file:
                if "fclib_global" in file:
                    return path
    return None


def wide(a):
    """With the indices that Siconos expects."""
    a = sparse.csc_matrix(a)
    return sparse.csc_matrix((a.data, a.indices.astype(np.int64), a.indptr.astype(np.int64)), a.shape)


def stored(w, solver, lifted):
    """A sparse W as the solver takes it."""
    if not sparse.issparse(w):
        return w
    if lifted:
        return wide(w)
    return sn.SBM_from_csparse(2, wide(w))[1] if solver == "NSGS" else w.toarray(order="F")


def solve(problem, solver, tolerance, iterations, repeats):
    """See peer.py."""
    if solver.startswith("GLOBAL_"):
        return timed(global_call(problem), f"SICONOS_{with_space(solver)}", {}, tolerance, iterations, repeats)
    lifted = problem.dim == 3 or solver.startswith("3D_")
    dim = 3 if lifted else 2
    solver, _, names = SPACE.get(solver.removeprefix("3D_"), (solver, 0, {})) if lifted else (solver, 0, {})
    prefix = f"SICONOS_FRICTION_{dim}D_"
    w, q = problem.in_space() if lifted else problem.scaled()
    # Its constructors with arguments take no sparse matrix.
    data = sn.FrictionContactProblem()
    data.dimension, data.numberOfContacts = dim, problem.points
    data.M, data.q, data.mu = stored(w, solver, lifted), q, problem.mu
    driver = ctypes.cast(getattr(DRIVERS, f"fc{dim}d_driver"), ctypes.c_void_p)

    def call(options):
        r, u, info = np.empty(len(q)), np.empty(len(q)), ctypes.c_int()
        at = [ctypes.c_void_p(place) for place in (int(data.this), r.ctypes.data, u.ctypes.data, int(options.this))]
        seconds = TIMED(driver, *at[:3], len(q), at[3], ctypes.byref(info))
        return seconds, info.value, r

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
