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
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property
from html import escape
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _stickslip
from ._stickslip import __version__

__all__ = ["Answer", "Case", "Figure", "Results", "compare", "judge", "load", "method", "methods", "solve", "study",
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


_JUDGED = ("violation", "natural_map", "penetration", "adhesion", "complementarity", "cone", "slip_direction", "equilibrium",
           "claimed", "reference_force", "reference_jump")
_WORK = ("iterations", "factorisations", "solves", "local_solves")


def _answer(parts: Any, again: tuple[_stickslip.Problem, Method, float] | None = None) -> Answer:
    said, (P, jump, states, judged), work, spent = parts
    fields: tuple[Any, ...] = (*said, P, jump, states, dict(zip(_JUDGED, judged)), dict(zip(_WORK, work)), *spent, again)
    return Answer(*fields)


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
    return _answer(problem.solve(method, tol, callback, seconds), (problem, method, tol))


def judge(W: Any, q: ArrayLike, mu: ArrayLike, P: ArrayLike, *, tol: float = 1e-9, dim: int | None = None,
          pieces: Pieces | None = None, rigid: ArrayLike | None = None) -> Answer:
    """The verdict on anybody's contact forces P (n,): `solved`, or `false-claim`. rigid: λ (k,) where pieces float."""
    return _answer(_stickslip.Problem(W, q, mu, dim, pieces, None).judge(P, rigid, tol))


def methods() -> list[dict[str, Any]]:
    """All methods: dicts with name, summary, reference, exact, options."""
    found: list[dict[str, Any]] = json.loads(_stickslip.methods())
    return found


def compare(W: Any, q: ArrayLike, mu: ArrayLike, methods: Iterable[Method] | None = None,
            tols: Iterable[float] = (1e-3, 1e-6, 1e-9), *, dim: int | None = None, pieces: Pieces | None = None,
            seconds: float | None = None) -> list[dict[str, Any]]:
    """Runs methods (all by default) at tolerances: a list of dicts, one a run, as `pandas.DataFrame` takes them."""
    if methods is None:
        methods = [row["name"] for row in globals()["methods"]()]
    problem, tols = _stickslip.Problem(W, q, mu, dim, pieces, None), list(tols)
    answers = [(tol, _answer(problem.solve(method, tol, None, seconds))) for method in methods for tol in tols]
    return [
        {"method": a.method, "tol": tol, "verdict": a.verdict, "violation": a.violation, "iterations": a.iterations,
         "factorisations": a.counters["factorisations"], "seconds": a.seconds, "reported_seconds": a.reported_seconds}
        for tol, a in answers
    ]


class method:
    """Decorator: makes a function (W, q, mu, tol) -> P a method, `own:NAME`, of `solve`, `compare`, `Case.run` and `Case.study`.

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


class Results:
    """Tables as columns, figures, records of a study, and all files (VTU fields too) of runs."""

    def __init__(self, files: dict[str, bytes]) -> None:
        self.files = files

    @property
    def tables(self) -> list[str]:
        """Names of its tables."""
        return [name[:-4] for name in sorted(self.files) if name.endswith(".csv")]

    def table(self, name: str) -> Columns:
        """A table as a dict of columns; cells that are numbers are numbers. What they mean: `stickslip show schema`."""
        if name not in self.tables:
            raise ValueError(f"table: got {name!r}, allowed: {', '.join(self.tables)}")

        def cell(text: str) -> float | str:
            try:
                return float(text)
            except ValueError:
                return text

        header, *rows = csv.reader(self.files[f"{name}.csv"].decode().splitlines())
        return {key: [cell(row[k]) for row in rows] for k, key in enumerate(header)}

    @property
    def figures(self) -> dict[str, Figure]:
        """Figures by file name."""
        return {Path(name).name: Figure(svg.decode()) for name, svg in sorted(self.files.items()) if name.endswith(".svg")}

    @property
    def records(self) -> list[dict[str, Any]]:
        """All records of a study, the last of every task."""
        lines = [line for name in sorted(self.files) if name.endswith(".jsonl") for line in self.files[name].split(b"\n")[:-1]]
        return list({record["id"]: record for record in map(json.loads, lines)}.values())

    def save(self, folder: str | os.PathLike[str]) -> None:
        """Writes all files."""
        for name, contents in self.files.items():
            path = Path(folder) / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(contents)


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

    def study(self, methods: Iterable[Method] = ("hybrid",), tolerances: Iterable[float] = (1e-3, 1e-6, 1e-9), *,
              seconds: float | None = None) -> Results:
        """Methods, functions included, at tolerances, repeated in turn for their times: figures of time against error."""
        return Results(self._inner.study(list(methods), list(tolerances), seconds))

    def increment(self, number: int | None = None, *, friction: float | None = None, method: Method = "hybrid") -> dict[str, Any]:
        """One increment (the last by default) as arrays: K, B, W (SciPy CSR), f, offset, q, mu, P, dim, pieces."""
        from scipy.sparse import csr_array  # type: ignore[import-untyped]

        found = self._inner.increment(self.increments if number is None else number, friction, method)
        for name in {"K", "B", "W", "V"} & found.keys():
            shape, rows, columns, values = found[name]
            found[name] = csr_array((values, (rows, columns)), shape=shape)
        found["pieces"] = (found.pop("V").toarray(), found.pop("s")) if "V" in found else None
        return found

    def __repr__(self) -> str:
        return f"<case {self.name}, {self.increments} increments>"


def load(folder: str | os.PathLike[str]) -> Results:
    """Tables, figures and records in a folder of results."""
    path = Path(folder)
    if not path.is_dir():
        raise FileNotFoundError(f"folder: got {str(path)!r}, allowed: a folder of results")
    files = [file for kind in ("*.csv", "figures/*.svg", "records/*.jsonl") for file in path.glob(kind)]
    return Results({file.relative_to(path).as_posix(): file.read_bytes() for file in files})


def study(cases: Iterable[str | os.PathLike[str]], methods: Iterable[str] = ("hybrid",),
          tolerances: Iterable[float] = (1e-3, 1e-6, 1e-9), *, out: str | os.PathLike[str], timed: bool = True) -> Results:
    """Measures methods on cases (names or files) at tolerances, in processes of their own: `stickslip study`. Ctrl-C keeps what
    is measured; the same call goes on from there. Returns what lies in `out`."""
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
    return load(out)
