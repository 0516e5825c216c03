"""Own W, q and μ in ten lines, by every method."""

import numpy as np

import stickslip

A = np.random.default_rng(1).normal(size=(60, 60))
W, q, mu = A @ A.T / 60 + np.eye(60), np.tile([-1.0, 0.4, 0.8], 20), np.full(20, 0.5)
answer = stickslip.solve(W, q, mu)
print(answer, {state: answer.states.count(state) for state in ("open", "stick", "slip")})
rows = stickslip.compare(W, q, mu, tols=[1e-9])
for row in sorted(rows, key=lambda row: (row["verdict"], row["seconds"])):
    print(f"{row['method']:22} {row['verdict'][:40]:40} {row['iterations']:6} iterations {row['seconds']:.1e} s")
assert sum(row["verdict"] == "solved" for row in rows) >= 14
