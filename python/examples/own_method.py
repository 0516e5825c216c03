"""A method of one's own, Uzawa's, on the increment of a body, in a figure of time against error beside ours."""

import sys

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


body = stickslip.Case("plate_mesh1").increment(friction=0.8)
exact = stickslip.solve(body["W"], body["q"], body["mu"], tol=1e-12).P
dots = []
for method in (uzawa, "nsgs", "latin", "admm", "newton-ac"):
    for tol in (1e-3, 1e-6, 1e-9):
        answer = stickslip.solve(body["W"], body["q"], body["mu"], method=method, tol=tol)
        error = max(float(np.linalg.norm(answer.P - exact) / np.linalg.norm(exact)), 1e-16)
        dots.append((answer.method, 1e3 * answer.seconds, error))
        print(f"{answer.method:10} to {tol:.0e}: {answer.verdict}, error {error:.1e}, {1e3 * answer.seconds:.3f} ms")
        assert answer.solved
points = "".join(
    f'<g><title>{name}</title><circle cx="{60 + 80 * (np.log10(ms) + 3):.0f}" cy="{20 - 18 * np.log10(error):.0f}" r="4"/>'
    f'<text x="{66 + 80 * (np.log10(ms) + 3):.0f}" y="{24 - 18 * np.log10(error):.0f}" font-size="10">{name}</text></g>'
    for name, ms, error in dots
)
figure = stickslip.Figure(
    f'<svg xmlns="http://www.w3.org/2000/svg" width="640" height="340" font-family="sans-serif">{points}'
    '<text x="320" y="335" font-size="11">time [log ms, from 1e-3]</text><text x="4" y="14" font-size="11">error of P, 1 to 1e-16</text></svg>'
)
figure.save(sys.argv[1] if len(sys.argv) > 1 else "own_method.svg")
