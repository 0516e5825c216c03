#!/usr/bin/env python3
"""Puts the best solver of Siconos beside the best exact method of stickslip, problem by problem.

    /usr/bin/python3 benches/peers/siconos.py problems/*.local.hdf5 --out peers
    for k in 1 2 3; do stickslip solve problems/*.local.hdf5 --out ours/$k; done
    /usr/bin/python3 benches/peers/compare.py problems peers/siconos.csv ours/*/runs.csv --out reports/peers

Both sides start from W, q and μ of the same file and must reach a natural map of 1e-9; the time is that of the solver
alone, the best of all repeats, one thread. `ratio` is their time over ours: above 1 stickslip is faster. `difference` is
the largest difference of the reactions relative to the largest reaction, `jump_difference` that of the jumps W r + q
relative to the largest of q: where W is nearly singular, reactions may differ that leave all jumps the same.
"""

import argparse
import csv
from pathlib import Path

import h5py
import numpy as np

COLUMNS = [
    "problem", "dim", "points", "method", "iterations", "natural_map", "time_s", "peer", "peer_iterations",
    "peer_natural_map", "peer_time_s", "ratio", "difference", "jump_difference",
]
TARGET = 1e-9


def rows(path):
    with open(path, newline="") as file:
        yield from csv.DictReader(file)


def best_of_ours(paths):
    """Fastest solved run per problem and method over all repeats, then the fastest method."""
    fastest = {}
    for path in paths:
        for row in rows(path):
            if row["verdict"] != "solved" or float(row["natural_map"]) > TARGET:
                continue
            key = (row["case"], row["method"])
            if key not in fastest or float(row["solve_s"]) < float(fastest[key]["solve_s"]):
                fastest[key] = row
    best = {}
    for (case, _), row in fastest.items():
        if case not in best or float(row["solve_s"]) < float(best[case]["solve_s"]):
            best[case] = row
    return best


def best_of_theirs(paths):
    best = {}
    for path in paths:
        for row in rows(path):
            row["folder"] = Path(path).parent
            case = Path(row["file"]).name.removesuffix(".hdf5")
            if row["status"] != "solved":
                continue
            if case not in best or float(row["time_s"]) < float(best[case]["time_s"]):
                best[case] = row
    return best


def vector(path):
    """A MatrixMarket array."""
    lines = [line for line in Path(path).read_text().splitlines() if not line.startswith("%")]
    return np.array([float(line) for line in lines[1:]])


def differences(problem, theirs):
    """Of the reactions and of the jumps."""
    with h5py.File(problem, "r") as file:
        ours, q = np.array(file["solution/r"]), np.array(file["fclib_local/vectors/q"])
        rows, columns, values = (np.array(file[f"fclib_local/W/{name}"]) for name in "ipx")
    reaction = Path(theirs["reaction"])
    found = vector(reaction if reaction.exists() else theirs["folder"] / reaction.name)
    step = found - ours
    jump = np.zeros(len(q))
    np.add.at(jump, rows, values * step[columns])
    return np.abs(step).max() / np.abs(ours).max(), np.abs(jump).max() / np.abs(q).max()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("problems", type=Path, help="folder of the FCLIB local problems")
    parser.add_argument("csv", nargs="+", help="siconos.csv and runs.csv files")
    parser.add_argument("--out", type=Path, default=Path("peers"))
    arguments = parser.parse_args()
    ours = best_of_ours([path for path in arguments.csv if Path(path).name == "runs.csv"])
    theirs = best_of_theirs([path for path in arguments.csv if Path(path).name == "siconos.csv"])
    table = []
    for problem in sorted(arguments.problems.glob("*.local.hdf5")):
        case = problem.name.removesuffix(".hdf5")
        our, their = ours.get(case), theirs.get(case)
        row = {"problem": case.removesuffix(".local"), "method": "none", "peer": "none"}
        if our:
            row |= {
                "points": our["points"], "method": our["method"], "iterations": our["iterations"],
                "natural_map": our["natural_map"], "time_s": our["solve_s"],
            }
        if their:
            reactions, jumps = differences(problem, their)
            row |= {
                "dim": their["dim"], "points": their["points"], "peer": their["solver"],
                "peer_iterations": their["iterations"], "peer_natural_map": f"{float(their['natural_map']):.1e}",
                "peer_time_s": f"{float(their['time_s']):.4g}", "difference": f"{reactions:.1e}",
                "jump_difference": f"{jumps:.1e}",
            }
        if our and their:
            row["ratio"] = f"{float(their['time_s']) / float(our['solve_s']):.2f}"
        table.append(row)
    arguments.out.mkdir(parents=True, exist_ok=True)
    with open(arguments.out / "siconos_comparison.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, restval="")
        writer.writeheader()
        writer.writerows(table)
    lines = ["| " + " | ".join(COLUMNS) + " |", "|" + " :--- |" * len(COLUMNS)]
    lines += ["| " + " | ".join(str(row.get(column, "")) for column in COLUMNS) + " |" for row in table]
    (arguments.out / "siconos_comparison.md").write_text("\n".join(lines) + "\n")
    print("\n".join(lines))


if __name__ == "__main__":
    main()
