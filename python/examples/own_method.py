"""A method of one's own, Uzawa's, on the increment of a body, in a figure of time against error beside ours."""

import numpy as np
from numpy.typing import NDArray

import stickslip

Vector = NDArray[np.float64]


@stickslip.method
def uzawa(W: Vector, q: Vector, mu: Vector, tol: float) -> Vector:
    """P ← Π(P − v/(5 W_ii)), Π the return map (Arrow, Hurwicz & Uzawa 1958); stops when steps are small."""
    P, r = np.zeros_like(q), 0.2 / np.diag(W)
    for _ in range(200_000):
        old, P = P, P - r * (W @ P + q)
        P[::2] = np.maximum(P[::2], 0)
        P[1::2] = np.clip(P[1::2], -mu * P[::2], mu * P[::2])
        if np.linalg.norm(P - old) <= 1e-2 * tol * np.linalg.norm(P):
            break
    return P


results = stickslip.Case("plate_mesh1").study([uzawa, "nsgs", "latin", "admm", "newton-ac"], [1e-3, 1e-5, 1e-7, 1e-9])
runs = results.table("runs")
for row in zip(runs["friction"], runs["method"], runs["tolerance"], runs["verdict"], runs["error_energy"], runs["enforcement_s"]):
    print("mu = {} {:10} to {:.0e}: {}, error {:.1e}, {:.1e} s".format(*row))
assert set(runs["verdict"]) == {"solved"}
name, figure = next(own for own in results.figures.items() if own[0].startswith("time_against_solver_error"))
results.save("own_method")  # a notebook shows `figure` itself
print(name, len(figure.svg))
