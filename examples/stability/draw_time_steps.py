#!/usr/bin/env python3
# silt - BSD-3-Clause, see LICENSE
"""Draws time_steps.csv of the stability suite: the worst error of an impact over the time step.

  draw_time_steps.py time_steps.csv time_steps.png
"""
import csv
import sys

import matplotlib
matplotlib.use("Agg")
import matplotlib.pyplot as plt

COLOURS = ["#0072b2", "#56b4e9", "#009e73", "#7f7f7f", "#e69f00", "#cc79a7", "#d55e00", "#000000"]


def main(table, picture):
    laws = {}
    with open(table) as file:
        for row in csv.DictReader(file):
            laws.setdefault(row["law"], []).append(row)
    figure, axes = plt.subplots(figsize=(7.5, 4.6), constrained_layout=True)
    axes.axvspan(1, 12, color="0.93", lw=0)
    for colour, (law, rows) in zip(COLOURS, laws.items()):
        run = [r for r in rows if r["stopped"] == "0"]
        axes.loglog([float(r["step over limit [-]"]) for r in run],
                    [max(float(r["error [-]"]), 1e-6) for r in run], "-o", ms=3, lw=1.4,
                    color=colour, label=law)
        last = run[-1]
        if len(run) < len(rows):  # from the next one on it is stopped
            axes.plot(float(last["step over limit [-]"]), max(float(last["error [-]"]), 1e-6), "X",
                      ms=10, color=colour, mec="white", mew=0.8)
    axes.axvline(1, color="black", lw=1.2)
    axes.axvline(8 / 20, color="black", lw=1, ls=":")
    top = axes.get_ylim()[1]
    axes.text(1.05, top * 0.8, "over the limit:\nrefused, unless lifted", va="top", fontsize=9)
    axes.text(8 / 20 * 0.95, top * 0.8, "chosen by silt", va="top", ha="right", fontsize=9)
    axes.set(xlim=(0.009, 12), xlabel="time step over the guard's limit, an eighth of a contact [-]",
             ylabel="error of the speed after the impact\nover that before, worst phase [-]")
    axes.plot([], [], "X", ms=9, color="0.3", mec="white", label="stopped by max_rate beyond")
    axes.grid(True, which="major", color="0.88", lw=0.8)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(fontsize=8.5, frameon=True, framealpha=0.9, edgecolor="none", loc="lower right")
    figure.savefig(picture, dpi=110)


if __name__ == "__main__":
    main(*sys.argv[1:3])
