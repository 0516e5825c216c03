#!/usr/bin/env python3
"""Pinocchio as a method from outside, docs/protocol.md; python3 -m venv V && V/bin/pip install pin h5py, then V/bin first in PATH"""
import sys, time
import h5py, numpy as np, pinocchio as pin
problem, reaction, tolerance = sys.argv[1], sys.argv[2], float(sys.argv[3])
f = h5py.File(problem)["fclib_local"]
q, mu, dim = f["vectors/q"][:], f["vectors/mu"][:], f["spacedim"][0]
W = np.zeros((len(q), len(q)))
W[f["W/i"][:], f["W/p"][:]] = f["W/x"][:]
if "V" in f or abs(W - W.T).max() > 1e-12 * abs(W).max(): sys.exit(4)   # a body that floats, or W is not symmetric: declined
rho, size = len(q) / np.trace(W), np.linalg.norm(q) or 1.0   # its tolerances have units
# Normal last there, and always three components: in 2D the third is coupled to nothing.
at = (3 * np.arange(len(mu))[:, None] + [2, 0, 1][:dim]).ravel()
G, g = np.eye(3 * len(mu)), np.zeros(3 * len(mu))
G[np.ix_(at, at)], g[at] = rho * W, q / size
models, datas, model = pin.StdVec_ConstraintModel(), pin.StdVec_ConstraintData(), pin.Model()
for one in mu:
    contact = pin.PointContactConstraintModel(model)
    contact.setFriction(one)
    models.append(pin.ConstraintModel(contact))
    datas.append(models[len(models) - 1].createData())
solver, settings, result = pin.ADMMConstraintSolver(), pin.ADMMSolverSettings(), pin.ADMMSolverResult()
settings.absolute_feasibility_tol = settings.absolute_complementarity_tol = tolerance / 10
settings.relative_feasibility_tol, settings.relative_complementarity_tol, settings.max_iterations = 0.0, 0.0, 100_000
begin = time.perf_counter()
done = solver.solve(pin.DelassusOperatorDense(G), g, models, datas, settings, result)
print(f"seconds = {time.perf_counter() - begin}\niterations = {result.iterations}")
np.savetxt(reaction, result.retrieveConstraintImpulses()[at] * rho * size)
sys.exit(0 if done else 3)
