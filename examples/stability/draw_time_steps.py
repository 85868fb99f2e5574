#!/usr/bin/env python3
# silt - BSD-3-Clause, see LICENSE
"""Draws time_steps.csv of the stability suite: the worst error of an impact over the time step.

  draw_time_steps.py time_steps.csv time_steps.png
"""
import csv
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "python"))
from silt import needs  # noqa: E402

needs.or_exit()
import matplotlib  # noqa: E402
matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

COLOURS = ["#0072b2", "#56b4e9", "#009e73", "#7f7f7f", "#e69f00", "#cc79a7", "#d55e00", "#000000"]


def main(table, picture):
    laws = {}
    with open(table) as file:
        for row in csv.DictReader(file):
            laws.setdefault(row["law"], []).append(row)
    figure, axes = plt.subplots(figsize=(7.5, 4.6), constrained_layout=True)
    axes.axvspan(1, 12, color="0.93", lw=0)
    share = lambda rows: [float(r["step over limit [-]"]) for r in rows]
    error = lambda rows: [max(float(r["error [-]"]), 1e-6) for r in rows]
    for colour, (law, rows) in zip(COLOURS, laws.items()):
        run = [r for r in rows if r["stopped"] == "0"]
        axes.loglog(share(run), error(run), "-o", ms=3, lw=1.5, color=colour, label=law)
        if len(run) < len(rows):  # from the next one on it is stopped
            axes.plot(share(run[-1:]), error(run[-1:]), "X", ms=9, color=colour, mec="white", mew=0.8)
            beyond = rows[len(run) - 1:]
            axes.plot(share(beyond), error(beyond), ":", lw=1.2, color=colour)
    axes.axvline(1, color="black", lw=1.2)
    axes.axvline(8 / 20, color="black", lw=1, ls=":")
    axes.set(xlim=(0.009, 12), ylim=(2e-6, 300),
             xlabel="time step over the guard's limit, an eighth of a contact [-]",
             ylabel="error of the speed after the impact\nover that before, worst phase [-]")
    axes.text(1.06, 200, "refused, unless lifted", va="top", fontsize=9)
    axes.text(0.38, 200, "chosen by silt", va="top", ha="right", fontsize=9)
    axes.axhline(1, color="0.6", lw=0.8)
    axes.plot([], [], "X", ms=9, color="0.3", mec="white", label="last before max_rate stops it")
    axes.plot([], [], ":", color="0.3", label="without the guard")
    axes.grid(True, which="major", color="0.88", lw=0.8)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(fontsize=8.5, frameon=True, framealpha=0.9, edgecolor="none", loc="upper left", bbox_to_anchor=(0.0, 0.93))
    figure.savefig(picture, dpi=100)


if __name__ == "__main__":
    main(*sys.argv[1:3])
