#!/usr/bin/env python3
"""Puts the solvers of each peer beside the exact methods of stickslip, problem by problem and over all.

    /usr/bin/python3 benches/peers/compare.py OUT --out reports/peers

OUT is a folder that `run.sh` filled. All start from W, q and μ of the same file.

`peer_comparison`: times to a natural map of 1e-9, of the solver alone, the best of its repeats, one thread. A ratio is the time of
the fastest solver of a peer over that of stickslip: above 1 stickslip is faster. `difference` is the largest difference of the reactions
of the first peer relative to the largest reaction, `jump_difference` that of the jumps W r + q relative to the largest of q: where W is
nearly singular, reactions may differ that leave all jumps the same.

`success`: how many problems of a size are solved to a natural map from 1e-4 to 1e-12. Of every solver the least map counts that it reached
within its limit, whatever it said of it. `best`: by any of them.
"""

import argparse
import csv
from pathlib import Path

import h5py
import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

TARGET = 1e-9
DEFAULT = "hybrid"
APPROXIMATE = {"penalty", "barrier", "nitsche"}
TOLERANCES = [10.0**-k for k in range(4, 13)]
SIZES = [(0, 100), (100, 1000), (1000, np.inf)]
# Best rates published, of other problems (global ones of FCLIB, up to 5840 points): IPM-ANM, Nguyen, Acary & Armand (2025).
PUBLISHED_AT = [1e-4, 1e-6, 1e-8, 1e-10, 1e-12]
PUBLISHED = [[1.0] * 5, [1.0] * 5, [0.99, 0.96, 0.90, 0.74, 0.67]]


def rows(path):
    with open(path, newline="") as file:
        yield from csv.DictReader(file)


def least(rows, time):
    """The fastest of some rows; None of none."""
    return min(rows, key=lambda row: float(row[time]), default=None)


def differences(problem, found):
    """Of the reactions and of the jumps, where the file holds a solution."""
    with h5py.File(problem, "r") as file:
        if "solution/r" not in file or "fclib_local" not in file:
            return ()
        ours, q = np.array(file["solution/r"]), np.array(file["fclib_local/vectors/q"])
        rows, columns, values = (np.array(file[f"fclib_local/W/{name}"]) for name in "ipx")
    step = found - ours
    jump = np.zeros(len(q))
    np.add.at(jump, rows, values * step[columns])
    return (f"{value:.1e}" for value in (np.abs(step).max() / np.abs(ours).max(), np.abs(jump).max() / np.abs(q).max()))


def compared(case, points, own, peers, folder):
    """The row of a problem; `own`: of stickslip, solved, `peers`: rows by name."""
    best, default = least(own, "solve_least_s"), least([row for row in own if row["method"] == DEFAULT], "solve_least_s")
    row = {"problem": case.removesuffix(".local"), "points": points, "method": "none"}
    if best:
        row |= {"method": best["method"], "iterations": best["iterations"], "time_s": best["solve_least_s"]}
    if default:
        row |= {"default_iterations": default["iterations"], "default_time_s": default["solve_least_s"]}
    for name, theirs in peers.items():
        row |= {"dim": theirs[0]["dim"]} if theirs else {}
        fastest = least([other for other in theirs if other["status"] == "solved"], "time_s")
        row[name] = fastest["solver"] if fastest else "none"
        if not fastest:
            continue
        time = float(fastest["time_s"])
        row |= {f"{name}_iterations": fastest["iterations"], f"{name}_time_s": f"{time:.4g}"}
        for ours, ratio in ((best, f"{name}_ratio"), (default, f"{name}_default_ratio")):
            if ours:
                row[ratio] = f"{time / float(ours['solve_least_s']):.2f}"
        if "difference" not in row:
            found = np.loadtxt(folder / fastest["reaction"])
            row |= zip(("difference", "jump_difference"), differences(folder / "problems" / f"{case}.hdf5", found))
    return row


def called(low, high):
    """A size in words."""
    return f"{low + 1} to {high}" if high < np.inf else f"over {low}"


def rates(reached, cases):
    """Part of the cases whose least map, by case, is at most each tolerance."""
    maps = np.array([reached.get(case, np.inf) for case in cases])
    return [float((maps <= tolerance).mean()) for tolerance in TOLERANCES]


def write(path, columns, table):
    """As CSV."""
    with open(path, "w", newline="") as file:
        writer = csv.DictWriter(file, columns, restval="")
        writer.writeheader()
        writer.writerows(table)


def write_readable(path, columns, table):
    """In Markdown."""
    lines = ["| " + " | ".join(columns) + " |", "|" + " :--- |" * len(columns)]
    lines += ["| " + " | ".join(str(row.get(column, "")) for column in columns) + " |" for row in table]
    path.write_text("\n".join(lines) + "\n")


def success(points, reached):
    """Rates of success by size, program and solver; `reached`: the least natural map by (program, solver) and case."""
    programs = {}
    for (program, _), own in reached.items():
        best = programs.setdefault(program, {})
        for case, value in own.items():
            best[case] = min(best.get(case, np.inf), value)
    reached = {(program, "best"): own for program, own in programs.items()} | reached
    table = []
    for low, high in SIZES:
        cases = [case for case, own in points.items() if low < own <= high]
        for (program, solver), own in reached.items():
            row = {"points": called(low, high), "problems": len(cases), "program": program}
            table.append(row | {"solver": solver} | {f"{t:.0e}": f"{rate:.3f}" for t, rate in zip(TOLERANCES, rates(own, cases))})
    return table


def draw(table, path):
    """A panel a size: best of each program, its most successful solver, and the default here."""
    plt.rcParams.update({"svg.hashsalt": "peers", "font.size": 9, "axes.spines.top": False, "axes.spines.right": False})
    figure, panels = plt.subplots(1, len(SIZES), figsize=(9.6, 3.4), sharey=True)
    colours = {"stickslip": "#0072b2", "siconos": "#d55e00", "pinocchio": "#666666"}
    total = lambda own: sum(float(row[f"{t:.0e}"]) * row["problems"] for row in own for t in TOLERANCES)
    shown = {}
    for program in dict.fromkeys(row["program"] for row in table):
        solvers = dict.fromkeys(row["solver"] for row in table if row["program"] == program and row["solver"] != "best")
        most = max(solvers, key=lambda name: total([row for row in table if (row["program"], row["solver"]) == (program, name)]))
        shown[program] = ["best", DEFAULT if program == "stickslip" else most]
    for panel, size, published in zip(panels, SIZES, PUBLISHED):
        name = called(*size)
        own = [row for row in table if row["points"] == name]
        for program, solvers in shown.items():
            for solver, style in zip(solvers, ("-", "--")):
                row = next(row for row in own if (row["program"], row["solver"]) == (program, solver))
                label = f"{program}: any" if solver == "best" else f"{program}: {solver}"
                values = [100 * float(row[f"{t:.0e}"]) for t in TOLERANCES]
                panel.semilogx(TOLERANCES, values, style, color=colours[program], label=label, marker=".", markersize=4)
        panel.plot(PUBLISHED_AT, [100 * rate for rate in published], "k*", markersize=6, label="published, IPM-ANM on other problems")
        panel.set_title(f"{name} points ({own[0]['problems']} problems)", fontsize=9)
        panel.set_xlabel("natural map asked for")
        panel.set_xticks(PUBLISHED_AT)
        panel.set_xticks(TOLERANCES, minor=True, labels=[])
        panel.invert_xaxis()
        panel.grid(alpha=0.3)
        panel.set_ylim(0, 104)
    panels[0].set_ylabel("problems solved [%]")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="lower center", ncols=4, frameon=False, fontsize=8.5)
    figure.tight_layout(rect=(0, 0.12, 1, 1))
    figure.savefig(path, metadata={"Date": None})


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, help="filled by run.sh")
    parser.add_argument("--out", type=Path, default=Path("peers"))
    arguments = parser.parse_args()
    folder = arguments.folder

    peers = {path.stem: list(rows(path)) for path in (folder / "siconos.csv", folder / "pinocchio.csv") if path.exists()}
    ours = [row for path in sorted(folder.glob("ours/*/runs.csv")) for row in rows(path) if row["method"] not in APPROXIMATE]
    timed = [row for row in ours if float(row["tolerance"]) == TARGET]
    points = {row["case"]: int(row["points"]) for row in timed}
    solved = [row for row in timed if row["verdict"].startswith("solved") and float(row["natural_map"]) <= TARGET]

    columns = ["problem", "dim", "points", "method", "iterations", "time_s", "default_iterations", "default_time_s"]
    for name in peers:
        columns += [name, f"{name}_iterations", f"{name}_time_s", f"{name}_ratio", f"{name}_default_ratio"]
    table = [
        compared(
            case, points[case], [row for row in solved if row["case"] == case],
            {name: [row for row in own if row["file"] == case] for name, own in peers.items()}, folder,
        )
        for case in sorted(points)
    ]
    arguments.out.mkdir(parents=True, exist_ok=True)
    columns += ["difference", "jump_difference"]
    write(arguments.out / "peer_comparison.csv", columns, table)
    write_readable(arguments.out / "peer_comparison.md", columns, table)

    reached = {}
    found = [("stickslip", row["method"], row["case"], row["natural_map"]) for row in ours]
    found += [(name, row["solver"], row["file"], row["reached"]) for name, own in peers.items() for row in own]
    for program, solver, case, value in found:
        if case in points and value:
            own = reached.setdefault((program, solver.removeprefix("3D_")), {})
            own[case] = min(own.get(case, np.inf), float(value))
    table = success(points, reached)
    write(arguments.out / "peer_success.csv", list(table[0]), table)
    draw(table, arguments.out / "success_against_tolerance.svg")


if __name__ == "__main__":
    main()
