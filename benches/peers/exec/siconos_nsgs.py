#!/usr/bin/python3
"""Siconos as a method from outside, docs/protocol.md; Debian: apt-get install python3-siconos python3-h5py"""
import sys, time
import h5py, numpy as np
import siconos.numerics as sn
problem, reaction, tolerance = sys.argv[1], sys.argv[2], float(sys.argv[3])
file = h5py.File(problem)
f, r = file["fclib_local"], file["guesses/1/r"][:]
if "V" in f: sys.exit(4)                                # a body that floats: declined
q, mu, dim = f["vectors/q"][:], f["vectors/mu"][:], int(f["spacedim"][0])
W = np.zeros((len(q), len(q)), order="F")
W[f["W/i"][:], f["W/p"][:]] = f["W/x"][:]
rho, size = len(q) / np.trace(W), np.linalg.norm(q) or 1.0   # Siconos stops at residuals that have units
scaled = sn.FrictionContactProblem(dim, len(mu), rho * W, q / size, mu)
driver, options = (sn.fc2d_driver, sn.SICONOS_FRICTION_2D_NSGS) if dim == 2 else (sn.fc3d_driver, sn.SICONOS_FRICTION_3D_NSGS)
options = sn.SolverOptions(options)
options.dparam[sn.SICONOS_DPARAM_TOL] = tolerance / 10
options.iparam[sn.SICONOS_IPARAM_MAX_ITER] = 100_000
r, u = r / (rho * size), np.zeros(len(q))
begin = time.perf_counter()
info = driver(scaled, r, u, options)
print(f"seconds = {time.perf_counter() - begin}\niterations = {options.iparam[sn.SICONOS_IPARAM_ITER_DONE]}")
np.savetxt(reaction, r * rho * size)
sys.exit(3 if info else 0)
