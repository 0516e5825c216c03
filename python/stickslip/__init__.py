"""Frictional contact: arrays in, judged answers out.

At every contact point, normal first, then one tangent (2D) or two (3D)::

    u = W P + q                                          with floating pieces  u = W P + V λ + q,  Vᵀ P + s = 0
    0 ≤ u_n ⊥ P_n ≥ 0                                    Signorini: gap open > 0, P_n > 0 is compression
    |P_t| ≤ μ P_n,  u_t ≠ 0 ⇒ P_t = −μ P_n u_t/|u_t|     Coulomb

Units are yours as long as W P and q agree; every violation is relative to the problem's own size.
"""

from __future__ import annotations

import csv
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from html import escape
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _stickslip
from ._stickslip import __version__

__all__ = ["Answer", "Case", "Figure", "Folder", "Results", "compare", "judge", "load", "method", "methods", "solve", "study",
           "__version__"]


Method: TypeAlias = str | Callable[..., Any]
Pieces: TypeAlias = tuple[ArrayLike, ArrayLike]
Columns: TypeAlias = dict[str, list[Any]]


@dataclass(frozen=True, eq=False, repr=False)
class Answer:
    """Answer of a method, or of anybody, to a problem, judged."""

    method: str  #: its name, options that are not the default in brackets; `given` of judged forces
    verdict: str  #: `solved`, `approximate: low`, `false-claim`, `gave-up: …`, `refused: …`, `crashed: …`, `timed-out`
    solved: bool  #: whether the contact laws hold to the tolerance, as the judge says
    claim: str  #: the method's own word: `contact laws`, `own laws`, or how it ended
    P: NDArray[np.float64]  #: contact forces (n,); empty without an answer
    jump: NDArray[np.float64]  #: gap and slip W P + V λ + q (n,)
    states: list[str]  #: `open`, `stick` or `slip` by point
    violations: dict[str, float]  #: all that the judge measured [-], and the reference force and jump
    counters: dict[str, int]  #: iterations, factorisations, solves, evaluations of the contact law at a point
    seconds: float  #: time of the method [s]
    reported_seconds: float | None  #: of a function: the part inside its call [s]
    history: NDArray[np.float64]  #: violation by iteration, the start first
    _again: tuple[_stickslip.Problem, Method, float] | None = None

    @property
    def violation(self) -> float:
        """The largest violation of the contact laws [-]; NaN without an answer."""
        return self.violations.get("violation", np.nan)

    @property
    def iterations(self) -> int:
        """As the published algorithm counts them."""
        return self.counters["iterations"]

    @cached_property
    def _why(self) -> tuple[str | None, str | None, str | None]:
        if self._again is None or not self.verdict.startswith(("gave-up", "false-claim")):
            return None, None, None
        problem, method, tol = self._again
        return isinstance(method, str) and problem.why(method, tol, self.verdict) or (None, None, None)

    @property
    def cause(self) -> str | None:
        """Why the method gave up, found out by a second run under observation when first asked for; None if it did not."""
        return self._why[0]

    @property
    def explanation(self) -> str | None:
        """The same in words, with what to change."""
        return self._why[1]

    @property
    def remedy(self) -> str | None:
        """The method that solves the problem instead."""
        return self._why[2]

    def _rows(self) -> dict[str, str]:
        states = ", ".join(f"{self.states.count(state)} {state}" for state in ("open", "stick", "slip"))
        return {"verdict": self.verdict, "points": states, "violation": f"{self.violation:.1e}",
                "iterations": str(self.iterations), "seconds": f"{self.seconds:.1e}"}

    def __repr__(self) -> str:
        return f"<{self.method}: " + ", ".join(f"{name} {value}" for name, value in self._rows().items()) + ">"

    def _repr_html_(self) -> str:
        rows = {"method": self.method, **self._rows()}.items()
        return "<table>" + "".join(f"<tr><th>{name}</th><td>{escape(value)}</td></tr>" for name, value in rows) + "</table>"


def solve(W: Any, q: ArrayLike, mu: ArrayLike, *, method: Method = "hybrid", tol: float = 1e-9, start: ArrayLike | None = None,
          dim: int | None = None, pieces: Pieces | None = None, callback: Callable[[int, float], object] | None = None,
          seconds: float | None = None) -> Answer:
    """Solves a contact problem and judges the answer.

    W: (n, n) array or SciPy sparse matrix, the Delassus operator, symmetric or not. q: (n,) or (points, dim), gaps and slips
    without contact forces. mu: (points,), or one number with `dim`. method: `NAME`, `NAME:option=value,…`, `exec:PROGRAM`, or a
    function (W, q, mu, tol) -> P. tol: violation accepted, 1e-14 to 1e-3. start: forces to begin from. pieces: (V, s) of
    floating pieces, V (n, k), s (k,). callback(iteration, violation): what it raises ends the run. seconds: time limit.

    Raises ValueError or TypeError naming the array, the index, the value and what is allowed. A method that fails is no
    exception: see `Answer.verdict`, `Answer.cause`, `Answer.remedy`.
    """
    problem = _stickslip.Problem(W, q, mu, dim, pieces, start)
    return Answer(**problem.solve(method, tol, callback, seconds), _again=(problem, method, tol))


def judge(W: Any, q: ArrayLike, mu: ArrayLike, P: ArrayLike, *, tol: float = 1e-9, dim: int | None = None,
          pieces: Pieces | None = None, rigid: ArrayLike | None = None) -> Answer:
    """The verdict on anybody's contact forces P (n,): `solved`, or `false-claim`. rigid: λ (k,) where pieces float."""
    return Answer(**_stickslip.Problem(W, q, mu, dim, pieces, None).judge(P, rigid, tol))


def methods() -> list[dict[str, Any]]:
    """All methods: dicts with name, summary, reference, exact, options."""
    return _stickslip.methods()


def compare(W: Any, q: ArrayLike, mu: ArrayLike, methods: Iterable[Method] | None = None,
            tols: Iterable[float] = (1e-3, 1e-6, 1e-9), *, dim: int | None = None, pieces: Pieces | None = None,
            seconds: float | None = None) -> list[dict[str, Any]]:
    """Runs methods (all by default) at tolerances: a list of dicts, one a run, as `pandas.DataFrame` takes them."""
    if methods is None:
        methods = [row["name"] for row in _stickslip.methods()]
    problem, tols = _stickslip.Problem(W, q, mu, dim, pieces, None), list(tols)
    answers = [(tol, Answer(**problem.solve(method, tol, None, seconds))) for method in methods for tol in tols]
    return [
        {"method": a.method, "tol": tol, "verdict": a.verdict, "violation": a.violation, "iterations": a.iterations,
         "factorisations": a.counters["factorisations"], "seconds": a.seconds, "reported_seconds": a.reported_seconds}
        for tol, a in answers
    ]


class method:
    """Decorator: makes a function (W, q, mu, tol) -> P a method for `solve`, `compare` and `Case.run`.

    W (n, n), q (n,), mu (points,); None gives up. Where pieces float it is called with V (n, k), s (k,) besides and returns
    (P, λ). Its answer is judged and timed like any other; `Answer.reported_seconds` is the time inside the call.
    """

    def __init__(self, function: Callable[..., Any], name: str | None = None) -> None:
        self.function = function
        self.name = name or getattr(function, "__name__", type(function).__name__)
        self.__doc__ = function.__doc__

    def __call__(self, *arguments: Any) -> Any:
        return self.function(*arguments)


class Figure:
    """A figure: SVG, which a notebook shows."""

    def __init__(self, svg: str) -> None:
        self.svg = svg

    def _repr_svg_(self) -> str:
        return self.svg

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes it to a file."""
        Path(path).write_text(self.svg, encoding="utf-8")


def _columns(rows: Sequence[dict[str, Any]]) -> Columns:
    return {name: [row[name] for row in rows] for name in (rows[0] if rows else ())}


class Results:
    """What runs of a case gave: tables by name as columns, figures by file name."""

    def __init__(self, inner: _stickslip.Results) -> None:
        self._inner = inner

    def table(self, name: str) -> Columns:
        """`runs`, `increments`, `quantities`, `history`, `points` or `expectations`: a dict of columns."""
        return _columns(json.loads(self._inner.table(name)))

    @property
    def figures(self) -> dict[str, Figure]:
        """Figures by file name."""
        return {name: Figure(svg) for name, svg in self._inner.figures().items()}

    def __repr__(self) -> str:
        return repr(self._inner)


class Case:
    """A case: the name of a shipped one, a TOML file, or a dict of the same keys (docs/case-format.md)."""

    def __init__(self, case: str | os.PathLike[str] | dict[str, Any], name: str = "case") -> None:
        if isinstance(case, dict):
            self._inner = _stickslip.Case(name, json.dumps(case))
        else:
            self._inner = _stickslip.Case(os.fspath(case))

    @property
    def name(self) -> str:
        """Name in tables."""
        return self._inner.name

    @property
    def increments(self) -> int:
        """Number of load increments."""
        return self._inner.increments

    def check(self) -> dict[str, Any]:
        """Discretises it: mesh, unknowns, contact points, residual of uniform stress [-], what a run by `hybrid` takes."""
        return self._inner.check()

    def run(self, methods: Iterable[Method] = ("hybrid",), *, seconds: float | None = None) -> Results:
        """Follows the load path by every method, functions included, and judges every increment."""
        return Results(self._inner.run(list(methods), seconds))

    def increment(self, number: int | None = None, *, friction: float | None = None, method: Method = "hybrid") -> dict[str, Any]:
        """One increment (the last by default) as arrays: K, B, W (SciPy CSR), f, offset, q, mu, P, pieces, dim."""
        from scipy.sparse import csr_array  # type: ignore[import-untyped]

        found = self._inner.increment(self.increments if number is None else number, friction, method)
        for name in ("K", "B", "W"):
            if name in found:
                shape, rows, columns, values = found[name]
                found[name] = csr_array((values, (rows, columns)), shape=shape)
        return found

    def __repr__(self) -> str:
        return repr(self._inner)


class Folder:
    """A folder of results: records of a study, its tables and figures."""

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = Path(path)
        if not self.path.is_dir():
            raise FileNotFoundError(f"folder: got {str(self.path)!r}, allowed: a folder of results")

    @property
    def records(self) -> list[dict[str, Any]]:
        """All records, the last of every task."""
        found: dict[str, dict[str, Any]] = {}
        for file in sorted(self.path.glob("records/*.jsonl")):
            for line in file.read_text(encoding="utf-8").split("\n")[:-1]:
                record = json.loads(line)
                found[record["id"]] = record
        return list(found.values())

    @property
    def tables(self) -> list[str]:
        """Names of its tables."""
        return sorted(file.stem for file in self.path.glob("*.csv"))

    def table(self, name: str) -> Columns:
        """A table as columns; cells that are numbers are numbers."""
        def cell(text: str) -> float | str:
            try:
                return float(text)
            except ValueError:
                return text

        with open(self.path / f"{name}.csv", newline="", encoding="utf-8") as file:
            return _columns([{key: cell(text) for key, text in row.items()} for row in csv.DictReader(file)])

    @property
    def figures(self) -> dict[str, Figure]:
        """Figures by file name."""
        return {file.name: Figure(file.read_text(encoding="utf-8")) for file in sorted(self.path.glob("figures/*.svg"))}


def load(folder: str | os.PathLike[str]) -> Folder:
    """The results in a folder."""
    return Folder(folder)


def study(cases: Iterable[str | os.PathLike[str]], methods: Iterable[str] = ("hybrid",),
          tolerances: Iterable[float] = (1e-3, 1e-6, 1e-9), *, out: str | os.PathLike[str], timed: bool = True) -> Folder:
    """Measures methods on cases (names or files) at tolerances, in processes of their own: `stickslip study`. Ctrl-C keeps what
    is measured; the same call goes on from there. Returns the folder `out`."""
    quoted = [json.dumps(str(Path(case).resolve()) if Path(case).exists() else str(case)) for case in cases]
    text = (f'title = "study"\n[[cells]]\ncases = [{", ".join(quoted)}]\nmethods = {json.dumps(list(methods))}\n'
            f"tolerances = [{', '.join(f'{tol:e}' for tol in tolerances)}]\n")
    with tempfile.TemporaryDirectory() as folder:
        sweep = Path(folder) / "study.toml"
        sweep.write_text(text, encoding="utf-8")
        command = [sys.executable, "-m", "stickslip", "study", str(sweep), "--out", str(out), "--quiet"]
        done = subprocess.run(command + ([] if timed else ["--untimed"]), stderr=subprocess.PIPE, text=True)
    if done.returncode == 2:
        raise ValueError(done.stderr.strip())
    return Folder(out)
