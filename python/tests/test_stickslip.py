"""The door: what goes in is refused or solved, what comes out is judged."""

import json
import os
import random
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest
import scipy.sparse as sp

import stickslip
from stickslip import _stickslip

HERE = Path(__file__).parent
EXACT = [row["name"] for row in stickslip.methods() if row["exact"]]


def posed(points, dim=3, seed=0, mu=0.4):
    """W = I + A Aᵀ/n, pressed and sheared."""
    rng = np.random.default_rng(seed)
    n = points * dim
    A = rng.normal(size=(n, n)) / np.sqrt(n)
    q = rng.normal(size=n)
    q[::dim] -= 0.5
    return np.eye(n) + A @ A.T, q, np.full(points, mu)


def test_a_block_on_two_springs_slips_as_by_hand():
    """W = diag(1/2, 1/5), pressed by 4 N and pulled by 3 N: P_n = 4, P_t = −μ 4 = −2 at μ = 0.5."""
    answer = stickslip.solve(np.diag([0.5, 0.2]), [-2.0, 0.6], [0.5])
    assert answer.verdict == "solved" and answer.solved and answer.states == ["slip"]
    np.testing.assert_allclose(answer.P, [4.0, -2.0], rtol=1e-12)
    np.testing.assert_allclose(answer.jump, [0.0, 0.2], atol=1e-15)
    assert answer.claim == "contact laws" and answer.cause is None and answer.remedy is None


@pytest.mark.parametrize("method", EXACT)
def test_every_exact_method_finds_the_same_forces(method):
    W, q, mu = posed(12)
    answer = stickslip.solve(W, q, mu, method=method)
    known = stickslip.solve(W, q, mu, tol=1e-12)
    assert answer.verdict == "solved" and answer.violation <= 1e-9
    assert np.linalg.norm(answer.P - known.P) <= 1e-7 * np.linalg.norm(known.P)
    assert answer.history[-1] <= 1e-9 and answer.counters["iterations"] == answer.iterations > 0 < answer.seconds


@pytest.mark.parametrize("dim", [2, 3])
def test_the_form_of_an_array_changes_nothing(dim):
    W, q, mu = posed(10, dim, mu=0.4)
    known = stickslip.solve(W, q, mu).P
    read_only = W.copy()
    read_only.flags.writeable = False
    forms = [np.asfortranarray(W), read_only, np.repeat(np.repeat(W, 2, 0), 2, 1)[::2, ::2], W.tolist(), sp.csr_array(W),
             sp.coo_array(W), sp.csc_matrix(W), sp.lil_array(W)]
    for form in forms:
        np.testing.assert_array_equal(stickslip.solve(form, q, mu).P, known)
    for form in (q.reshape(-1, dim), q.tolist(), np.repeat(q, 3)[::3]):
        np.testing.assert_array_equal(stickslip.solve(W, form, mu).P, known)
    np.testing.assert_array_equal(stickslip.solve(W, q, 0.4, dim=dim).P, known)
    assert stickslip.solve(W.astype("float32"), q, mu).solved and stickslip.solve(10 * np.eye(len(q), dtype=int), q, mu).solved


def test_an_unsymmetric_operator_is_taken_as_it_stands():
    W, q, mu = posed(8)
    W[0, 5] += 0.1
    for form in (W, sp.csr_array(W)):
        answer = stickslip.solve(form, q, mu, method="nsgs")
        assert answer.solved
        np.testing.assert_allclose(answer.jump, W @ answer.P + q, atol=1e-12)
        refused = stickslip.solve(form, q, mu, method="socp")
        assert refused.verdict.startswith("refused: W is unsymmetric") and np.isnan([refused.seconds, refused.violation]).all()


def test_floating_pieces_need_the_forces_that_balance_them():
    """One point pressed by 1 N on a piece that floats along its normal."""
    W, q, V, s = np.eye(2), np.zeros(2), np.array([[1.0], [0.0]]), [-1.0]
    answer = stickslip.solve(W, q, [0.3], pieces=(V, s))
    assert answer.solved
    np.testing.assert_allclose(answer.P, [1.0, 0.0], atol=1e-12)
    assert stickslip.judge(W, q, [0.3], [1.0, 0.0], pieces=(V, s), rigid=[-1.0]).verdict == "solved"
    assert stickslip.judge(W, q, [0.3], [1.0, 0.0], pieces=(V, s), rigid=[1.0]).verdict == "false-claim"
    mine = stickslip.solve(W, q, [0.3], pieces=(V, s), method=lambda W, q, mu, tol, V, s: ([1.0, 0.0], [-V[0, 0]]))
    assert mine.solved
    pulled = stickslip.solve(W, q, [0.3], pieces=(V, [1.0]))
    assert pulled.verdict == "gave-up: no-equilibrium" and pulled.cause == "no-solution"


def test_anybodys_forces_are_judged_alike():
    W, q, mu = posed(30)
    P = stickslip.solve(W, q, mu).P
    assert stickslip.judge(W, q, mu, P).verdict == "solved"
    for wrong in (0 * P, 1.01 * P, -P, P[::-1].copy()):
        judged = stickslip.judge(W, q, mu, wrong)
        assert judged.verdict == "false-claim" and judged.violation > 1e-4 and not judged.solved
    assert stickslip.judge(W, q, mu, P + 1e-5 * np.abs(P).max(), tol=1e-3).verdict == "solved"


def test_who_gives_up_has_a_cause_and_a_remedy():
    W, q, mu = posed(40)
    answer = stickslip.solve(W, q, mu, method="nsgs:max_iterations=2")
    assert answer.verdict == "gave-up: max-iterations" and answer.cause and answer.remedy
    assert stickslip.solve(W, q, mu, method=answer.remedy).solved
    assert answer.remedy in answer.explanation
    assert stickslip.solve(W, q, mu, method="nsgs", seconds=1e-9).verdict == "timed-out"


def test_functions_are_methods_and_their_time_is_their_own():
    W, q, mu = posed(15, 2)
    known = stickslip.solve(W, q, mu).P

    @stickslip.method
    def oracle(W, q, mu, tol):
        assert W.shape == (30, 30) and q.shape == (30,) and mu.shape == (15,) and tol == 5e-10
        return known

    answer = stickslip.solve(W, q, mu, method=oracle)
    assert answer.method == "own:oracle" and answer.solved and 0 < answer.reported_seconds < answer.seconds
    rows = stickslip.compare(W, q, mu, methods=[oracle, "hybrid"], tols=[1e-9])
    assert [row["verdict"] for row in rows] == ["solved", "solved"] and rows[1]["reported_seconds"] is None
    wrong = {"false-claim": lambda *a: 0 * known, "gave-up: unexplained": lambda *a: None,
             "crashed": lambda *a: known[:-1], "crashed: ZeroDivisionError": lambda *a: 1 / 0}
    for verdict, function in wrong.items():
        assert stickslip.solve(W, q, mu, method=function).verdict.startswith(verdict)
    results = stickslip.Case("plate_mesh1").run([lambda W, q, mu, tol: stickslip.solve(W, q, mu, tol=tol).P])
    assert results.table("runs")["verdict"] == ["solved"] * 3


def test_a_callback_sees_iterations_and_may_end_them():
    W, q, mu = posed(30)
    seen = []
    answer = stickslip.solve(W, q, mu, method="nsgs", callback=lambda i, violation: seen.append((i, violation)))
    assert len(seen) > 5 and [violation for _, violation in seen] == list(answer.history[: len(seen)])

    def enough(iteration, violation):
        if iteration == 3:
            raise StopIteration("enough")

    with pytest.raises(StopIteration, match="enough"):
        stickslip.solve(W, q, mu, method="nsgs", callback=enough)


def test_ctrl_c_ends_a_run():
    # What runs in the background of a shell ignores it.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    W, q, mu = posed(300, mu=0.9)
    interrupt = threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT))
    with pytest.raises(KeyboardInterrupt):
        interrupt.start()
        for _ in range(1000):
            stickslip.solve(W, q, mu, method="projection:max_iterations=1000000", tol=1e-14)
    interrupt = threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGINT))
    # What it computes does not depend on what else the machine does.
    begin = time.process_time()
    with pytest.raises(KeyboardInterrupt):
        interrupt.start()
        stickslip.Case("partial_slip_cycle").run([f"nsgs:max_iterations={n}" for n in range(100_000, 101_000)])
    assert time.process_time() - begin < 5.0


def test_other_threads_run_while_a_method_does():
    W, q, mu = posed(250)
    ticks, done = [], threading.Event()
    thread = threading.Thread(target=lambda: ticks.extend(iter(lambda: done.wait(0.001), True)))
    thread.start()

    def during():
        before = len(ticks)
        stickslip.solve(W, q, mu, method="nsgs", tol=1e-12)
        return len(ticks) - before

    # Whoever holds the interpreter lets others have a turn at the beginning and at the end alone.
    others = any(during() > 4 for _ in range(1000))
    done.set()
    thread.join()
    assert others


def test_a_panic_is_an_exception():
    with pytest.raises(RuntimeError, match="internal error: planted"):
        _stickslip._panic()


REFUSED = [
    (dict(W=np.eye(3)), r"W: got shape \[3, 3\], allowed: \(4, 4\)"),
    (dict(W=np.where(np.eye(4) > 0, np.nan, 0)), r"W\[0, 0\]: got NaN, allowed: finite"),
    (dict(W=np.eye(4) + np.diag([1, 1, np.inf], -1)), r"W\[3, 2\]: got inf"),
    (dict(W=np.eye(4, dtype=complex)), r"W: got dtype complex128"),
    (dict(W=np.ma.masked_less(np.eye(4), 0.5)), r"W: got a masked array"),
    (dict(W=np.tril(np.ones((4, 4)))), r"W: got one triangle"),
    (dict(W=sp.csr_array(np.tril(np.ones((4, 4))))), r"W: got one triangle"),
    (dict(W=sp.csr_array(np.diag([1.0, np.nan, 1.0, 1.0]))), r"W.data\[1\]: got NaN"),
    (dict(q=[1.0, np.nan, 0.0, 0.0]), r"q\[1\]: got NaN"),
    (dict(q=[[0.0, 1.0], [np.inf, 0.0]]), r"q\[1, 0\]: got inf"),
    (dict(mu=[0.3, -0.1]), r"mu\[1\]: got -0.1, allowed: finite numbers >= 0"),
    (dict(mu=0.3), r"dim: got None, allowed: 2 or 3"),
    (dict(tol=0.0), r"tol: got 0, allowed: 1e-14 to 1e-3"),
    (dict(start=[0.0]), r"start: got 1 numbers, allowed: 4"),
    (dict(method="newton"), r"unknown method `newton`"),
    (dict(method="nsgs:max_iterations=-1"), r"max_iterations"),
    (dict(seconds=-1.0), r"seconds: got -1"),
    (dict(pieces=np.eye(4)), r"pieces: got"),
    (dict(pieces=(np.ones((3, 1)), [1.0])), r"V: got shape \[3, 1\], allowed: 4 rows"),
    (dict(pieces=(np.ones((4, 1)), [1.0, 2.0])), r"s: got 2 numbers, allowed: 1"),
]


@pytest.mark.parametrize("change, words", REFUSED)
def test_what_is_refused_names_array_index_value_and_what_is_allowed(change, words):
    with pytest.raises((ValueError, TypeError), match=words):
        stickslip.solve(**{"W": np.eye(4), "q": [-1.0, 0.1, -1.0, 0.1], "mu": [0.3, 0.3], **change})


def test_hostile_calls_are_exceptions_or_judged():
    """2000 random calls of every kind: nothing but ValueError, TypeError and MemoryError, and no answer that is not one."""
    rng = random.Random(7)
    junk = [None, "x", b"y", 3, -1, 1e308, np.nan, [], {}, object(), np.array(5.0), np.zeros((0, 0)), np.zeros(0), [[]], [None],
            np.ones((2, 2, 2)), np.ones(4, complex), np.array(["a"]), np.ones(4, bool), np.ma.masked_all(4), 10**400,
            np.array([1e308] * 4), np.array([1e-320] * 4), sp.csr_array((4, 4)), sp.csr_array((0, 0)), np.datetime64("2020"),
            np.full((4, 4), 1e200), -np.eye(4), np.zeros((4, 4)), np.ones((4, 4)), 1e-300 * np.eye(4), range(4), np.float16(1)]
    shaped = {
        "W": [np.zeros((4, 4)), np.ones((4, 4)), -np.eye(4), np.full((4, 4), 1e200), 1e-300 * np.eye(4), np.diag([1, 1e-16, 1, 1e16]),
              np.eye(4)[::-1], np.eye(4, dtype="int8"), sp.csr_array((4, 4)), sp.eye_array(4), np.triu(np.ones((4, 4)), -1),
              np.array([[1, -9, 0, 0], [9, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]]), np.eye(4) * [[1e308]], np.eye(4) * 5e-324],
        "q": [np.zeros(4), np.full(4, 1e308), np.full(4, -1e308), np.full(4, 1e-320), [-1, 1e-9, -1e9, 1], [-1e200, 0, 1, 0], [1] * 4],
        "mu": [[0, 0], [1e10, 1e10], [1e308, 0], [0, 5.0], [5e-324, 1]],
        "start": [np.full(4, 1e308), -np.ones(4), np.zeros(4)],
        "pieces": [(np.eye(4)[:, :1], [1.0]), (np.zeros((4, 1)), [0.0]), (np.ones((4, 2)), [1.0, 1.0]), (np.eye(4), [-1, 0, -1, 0])],
        "method": [row["name"] for row in stickslip.methods()] + [lambda *a: np.full(4, 1e308), lambda *a: "x", lambda *a: (1, 2)],
        "tol": [1e-14, 1e-3], "dim": [2, 3], "seconds": [1e-9, 10.0],
    }
    solved = refused = other = 0
    for _ in range(2000):
        W, q, mu = posed(2, 2, rng.randrange(99))
        given = {"W": W, "q": q, "mu": mu}
        for name in rng.sample(sorted(shaped), rng.choice([1, 2, 3])):
            given[name] = rng.choice(junk if rng.random() < 0.2 else shaped[name])
        try:
            answer = stickslip.solve(**given)
        except (ValueError, TypeError, MemoryError, OverflowError):
            refused += 1
            continue
        repr(answer), answer.violations, answer.cause
        if answer.verdict != "solved":
            other += 1
            continue
        solved += 1
        W = given["W"].toarray() if sp.issparse(given["W"]) else np.asarray(given["W"], float)
        q, u, P = np.asarray(given["q"], float).ravel(), answer.jump, answer.P
        assert np.isfinite(P).all() and np.isfinite(u).all(), given
        with np.errstate(all="ignore"):
            if given.get("pieces") is None and np.abs(q).max() < 1e300:
                size = np.abs(u) + np.abs(q) + np.abs(W) @ np.abs(P)
                assert (np.abs(W @ P + q - u) <= 1e-9 * size.max()).all(), given
            assert (P[::2] >= -1e-6 * np.abs(P).max()).all(), given
    assert solved > 700 and refused > 300 and other > 100, (solved, refused, other)


def test_a_case_is_checked_run_and_taken_apart():
    case = stickslip.Case("cyclic")
    size = case.check()
    assert case.name == "cyclic" and case.increments == 16 and size["points"] == 12 and size["uniform_stress"] < 1e-9
    results = case.run(["hybrid", "nsgs"])
    assert results.table("increments")["verdict"] == ["solved"] * 34
    assert any(name.endswith(".loop.svg") for name in results.figures)
    assert next(iter(results.figures.values()))._repr_svg_().startswith("<svg")
    own = case.increment(7)
    K, B, W = own["K"], own["B"], own["W"]
    condensed = B @ sp.linalg.spsolve(K.tocsc(), B.T.toarray())
    assert np.abs(condensed - W.toarray()).max() <= 1e-9 * np.abs(condensed).max()
    assert stickslip.judge(W, own["q"], own["mu"], own["P"]).solved
    with pytest.raises(ValueError, match="^increment 17: `cyclic` has the increments 1 to 16"):
        case.increment(17)
    with pytest.raises(ValueError, match="methods: got own:<lambda> twice, allowed: each once"):
        case.run([lambda *a: None, lambda *a: 0])


def test_a_case_may_be_a_dict_or_a_file_and_its_faults_are_told(tmp_path):
    text = {"title": "two blocks", "model": "plane-strain", "material": {"young_pa": 1e9, "poisson": 0.3},
            "mesh": {"box": {"min_m": [0, 0], "max_m": [2, 1], "cells": [9, 5]}},
            "crack": [{"points_m": [[-1.0, 0.47], [3.0, 0.52]], "friction": 0.4}],
            "support": [{"on": "bottom", "displacement_m": [0, 0]}, {"on": "top", "displacement_m": [1e-4, -1e-3]}]}
    assert stickslip.Case(text).run(["hybrid"]).table("runs")["verdict"] == ["solved"]
    with pytest.raises(ValueError, match="material.poisson: out of range: got 0.75, allowed: 0 <= poisson < 0.5"):
        stickslip.Case({**text, "material": {"young_pa": 1e9, "poisson": 0.75}})
    with pytest.raises(FileNotFoundError, match="nowhere.toml"):
        stickslip.Case(tmp_path / "nowhere.toml")
    (tmp_path / "broken.toml").write_text("title = 3\n")
    with pytest.raises(ValueError, match="broken.toml:1:1: title: missing `model`"):
        stickslip.Case(tmp_path / "broken.toml")


def test_a_study_is_measured_and_read_back(tmp_path):
    own = stickslip.Case("plate_mesh1").study([stickslip.method(lambda W, q, mu, tol: stickslip.solve(W, q, mu).P, "mine")], [1e-6])
    assert [record["found"]["verdict"] for record in own.records] == ["solved"] * 3 and own.figures
    folder = stickslip.study(["plate_mesh1"], ["hybrid", "latin"], [1e-3, 1e-9], out=tmp_path / "study", timed=False)
    records = folder.records
    assert len(records) == 12 and {record["found"]["verdict"] for record in records} == {"solved"}
    assert "success" in folder.tables and set(folder.table("success")["method"]) == {"hybrid", "latin"}
    assert stickslip.load(tmp_path / "study").records == records
    with pytest.raises(ValueError, match="unknown method `newton`"):
        stickslip.study(["plate_mesh1"], ["newton"], out=tmp_path / "other")


def command(*arguments, cwd=None):
    done = subprocess.run([sys.executable, "-m", "stickslip", *arguments], capture_output=True, text=True, cwd=cwd)
    return done.returncode, done.stdout, done.stderr


def test_the_program_is_in_the_wheel(tmp_path):
    assert command("--version") == (0, f"stickslip {stickslip.__version__}\n", "")
    code, _, told = command("run", "nowhere", cwd=tmp_path)
    assert code == 2 and "nowhere" in told
    code, shown, _ = command("run", "plate_mesh1", "-m", "hybrid", "--json", "--out", "out", cwd=tmp_path)
    rows = json.loads(shown.split("\n")[0])["rows"]
    assert code == 0 and [row["verdict"] for row in rows] == ["solved"] * 3


def test_the_verdict_is_that_of_the_command_line(tmp_path):
    command("export", "plate_mesh1", "--friction", "0.8", "--out", ".", cwd=tmp_path)
    own = stickslip.Case("plate_mesh1").increment(friction=0.8)
    for name, P in [("right", own["P"]), ("wrong", 1.001 * own["P"])]:
        np.savetxt(tmp_path / "P.txt", P)
        program = tmp_path / name
        program.write_text(f"#!/bin/sh\ncp {tmp_path}/P.txt \"$2\"\n")
        program.chmod(0o755)
        file = str(next(tmp_path.glob("*.local.hdf5")))
        _, shown, _ = command("solve", file, "-m", f"exec:./{name}", "--json", "--out", name + "-out", cwd=tmp_path)
        tables = [json.loads(line) for line in shown.splitlines()]
        verdict = next(own for own in tables if own.get("table") == "runs")["rows"][0]["verdict"]
        assert stickslip.judge(own["W"], own["q"], own["mu"], P).verdict == verdict


@pytest.mark.parametrize("name", ["own_problem", "table1", "own_method"])
def test_examples_run(name, tmp_path):
    subprocess.run([sys.executable, HERE.parent / f"examples/{name}.py"], cwd=tmp_path, check=True)


def test_types_are_right():
    pytest.importorskip("mypy")
    subprocess.run([sys.executable, "-m", "mypy", "--strict", "stickslip", "examples"], cwd=HERE.parent, check=True)
