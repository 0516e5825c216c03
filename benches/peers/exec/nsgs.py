#!/usr/bin/env python3
"""Nonsmooth Gauss-Seidel in NumPy as a method from outside, docs/protocol.md: stickslip solve FILE --method exec:nsgs.py"""
import sys, time, h5py, numpy as np
problem, reaction, tolerance = sys.argv[1], sys.argv[2], float(sys.argv[3])
f = h5py.File(problem)["fclib_local"]
if "V" in f: sys.exit(4)                                # a body that floats: declined
q, mu, dim = f["vectors/q"][:], f["vectors/mu"][:], f["spacedim"][0]
r, W = np.zeros(len(q)), np.zeros((len(q), len(q)))
W[f["W/i"][:], f["W/p"][:]] = f["W/x"][:]
begin, rho = time.perf_counter(), len(q) / np.trace(W)
points = [(slice(dim * i, dim * i + dim), mu[i]) for i in range(len(mu))]
def mapped(r, v, mu, step):                             # projection of r - step (v + mu |v_t| n) on |r_t| <= mu r_n
    z = r - step * (v + mu * np.linalg.norm(v[1:]) * np.eye(len(v))[0])
    size = np.linalg.norm(z[1:])
    if size <= mu * z[0]: return z
    normal = max(z[0] + mu * size, 0) / (1 + mu**2)
    return np.append(normal, mu * normal / (size or 1) * z[1:])
for sweep in range(1, 10001):
    for p, m in points:                                 # the law of each point with all others held: a fixed point
        v, step = W[p] @ r + q[p], 1 / np.trace(W[p, p])
        for _ in range(10):
            change = mapped(r[p], v, m, step) - r[p]
            r[p], v = r[p] + change, v + W[p, p] @ change
    v = W @ r + q
    error = np.linalg.norm([np.linalg.norm(r[p] - mapped(r[p], v[p], m, rho)) for p, m in points])
    if done := error <= tolerance / 2 * max(rho * np.linalg.norm(q), np.linalg.norm(r)): break
np.savetxt(reaction, r)
print(f"iterations = {sweep}\nseconds = {time.perf_counter() - begin}")
sys.exit(0 if done else 3)
