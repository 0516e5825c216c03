#!/usr/bin/env python3
"""Puts the best solver of each peer beside the best exact method of stickslip and beside its default, problem by problem.

    /usr/bin/python3 benches/peers/compare.py problems ours/runs.csv peers/*.csv --out reports/peers

All start from W, q and μ of the same file and must reach a natural map of 1e-9; the time is that of the solver alone, the
best of its repeats, one thread. A ratio is the time of the peer over that of stickslip: above 1 stickslip is faster.
`difference` is the largest difference of the reactions of the first peer relative to the largest reaction,
`jump_difference` that of the jumps W r + q relative to the largest of q: where W is nearly singular, reactions may differ that
leave all jumps the same.
"""

import argparse
import csv
from pathlib import Path

import h5py
import numpy as np

TARGET = 1e-9
DEFAULT = "hybrid"


def rows(path):
    with open(path, newline="") as file:
        yield from csv.DictReader(file)


def least(rows, time):
    """The fastest of some rows; None of none."""
    return min(rows, key=lambda row: float(row[time]), default=None)


def differences(problem, found):
    """Of the reactions and of the jumps."""
    with h5py.File(problem, "r") as file:
        ours, q = np.array(file["solution/r"]), np.array(file["fclib_local/vectors/q"])
        rows, columns, values = (np.array(file[f"fclib_local/W/{name}"]) for name in "ipx")
    step = found - ours
    jump = np.zeros(len(q))
    np.add.at(jump, rows, values * step[columns])
    return np.abs(step).max() / np.abs(ours).max(), np.abs(jump).max() / np.abs(q).max()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("problems", type=Path, help="folder of the FCLIB local problems")
    parser.add_argument("ours", type=Path, help="runs.csv of `stickslip solve`")
    parser.add_argument("peers", nargs="+", type=Path, help="tables of the peers")
    parser.add_argument("--out", type=Path, default=Path("peers"))
    arguments = parser.parse_args()

    solved = [
        row for row in rows(arguments.ours)
        if row["verdict"] == "solved" and float(row["natural_map"]) <= TARGET
    ]
    names = [path.stem for path in arguments.peers]
    columns = ["problem", "dim", "points", "method", "iterations", "time_s", "default_iterations", "default_time_s"]
    for name in names:
        columns += [name, f"{name}_iterations", f"{name}_time_s", f"{name}_ratio", f"{name}_default_ratio"]
    columns += ["difference", "jump_difference"]
    table = []
    for problem in sorted(arguments.problems.glob("*.local.hdf5")):
        case = problem.name.removesuffix(".hdf5")
        own = [row for row in solved if row["case"] == case]
        best = least(own, "solve_least_s")
        default = least([row for row in own if row["method"] == DEFAULT], "solve_least_s")
        row = {"problem": case.removesuffix(".local"), "method": "none"}
        if best:
            row |= {"method": best["method"], "iterations": best["iterations"], "time_s": best["solve_least_s"]}
        if default:
            row |= {"default_iterations": default["iterations"], "default_time_s": default["solve_least_s"]}
        for name, path in zip(names, arguments.peers):
            theirs = [other for other in rows(path) if other["file"] == case]
            fastest = least([other for other in theirs if other["status"] == "solved"], "time_s")
            row |= {key: other[key] for other in theirs[:1] for key in ("dim", "points")}
            row[name] = "none"
            if not fastest:
                continue
            row |= {
                name: fastest["solver"], f"{name}_iterations": fastest["iterations"],
                f"{name}_time_s": f"{float(fastest['time_s']):.4g}",
            }
            for ours, ratio in ((best, f"{name}_ratio"), (default, f"{name}_default_ratio")):
                if ours:
                    row[ratio] = f"{float(fastest['time_s']) / float(ours['solve_s']):.2f}"
            if "difference" not in row:
                found = differences(problem, np.loadtxt(path.parent / fastest["reaction"]))
                row |= zip(("difference", "jump_difference"), (f"{value:.1e}" for value in found))
        table.append(row)
    arguments.out.mkdir(parents=True, exist_ok=True)
    with open(arguments.out / "peer_comparison.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, columns, restval="")
        writer.writeheader()
        writer.writerows(table)
    lines = ["| " + " | ".join(columns) + " |", "|" + " :--- |" * len(columns)]
    lines += ["| " + " | ".join(str(row.get(column, "")) for column in columns) + " |" for row in table]
    (arguments.out / "peer_comparison.md").write_text("\n".join(lines) + "\n")
    print("\n".join(lines))


if __name__ == "__main__":
    main()
