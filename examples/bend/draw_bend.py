#!/usr/bin/env python3
# silt - BSD-3-Clause, see LICENSE
"""Draws a run of the bend: particles of both models, where they cross the pipe, and how fast.

  draw_bend.py FOLDER hv|vh|hh
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
import numpy as np  # noqa: E402
import silt  # noqa: E402
from silt.drawing import COLOUR_MAP  # noqa: E402

MODELS = ["simplified", "traditional"]
COLOURS = ["#0072B2", "#D55E00"]
D = 0.05  # [m]
SECTIONS = {"hv": (3, 5), "vh": (1, 3), "hh": (0, 7, 9)}
TITLE = {"hv": "from horizontal to vertical", "vh": "from vertical to horizontal",
         "hh": "from horizontal to horizontal, seen from above"}


def table(path):
    with open(path) as file:
        rows = list(csv.reader(file))
    return np.array([[float(v) for v in row] for row in rows[1:]])


def rope(axes, path, case, title, most):
    particles = silt.read(path)
    speed, points = particles["|velocity|"], particles.points
    x, y = points[:, 0] / D, points[:, 1] / D
    across, up = (x, y) if case == "hv" else (y, x)
    shown = axes.scatter(across, up, c=speed, s=3, lw=0, cmap=COLOUR_MAP, vmin=0, vmax=most)
    t = np.linspace(0, np.pi / 2, 40)
    for side in (-0.5, 0.5):
        r = 1 + side
        wall_x = np.concatenate(([x.min()], -0 + r * np.sin(t), [1 + side]))
        wall_y = np.concatenate(([-side], 1 - r * np.cos(t), [y.max()]))
        a, b = (wall_x, wall_y) if case == "hv" else (wall_y, wall_x)
        axes.plot(a, b, color="0.3", lw=0.8)
    axes.set(aspect="equal", title=title)
    axes.set_xlabel(("x" if case == "hv" else "y") + "/D")
    axes.set_ylabel(("y" if case == "hv" else "x") + "/D")
    return shown


def tidy(axes):
    axes.grid(True, color="0.9", lw=0.8)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)


def headroom(axes):
    """For the legend."""
    axes.set_ylim(0, 1.3 * axes.get_ylim()[1])
    axes.legend(fontsize=8, frameon=False, loc="upper center", ncols=2, columnspacing=1)
    tidy(axes)


def distribution(axes, across, sections):
    for at, style in zip(sections, ("-", "--", ":")):
        for m, model in enumerate(MODELS):
            rows = across[(across[:, 0] == m) & (across[:, 1] == at)]
            axes.plot(rows[:, 2], 100 * rows[:, 3], style, marker="o", ms=3, color=COLOURS[m],
                      label=f"{model}, {at} D")
    axes.set(xlabel="place across, 0: inner wall, 1: outer wall", ylabel="share of particles [%]",
             xlim=(0, 1), ylim=(0, None))
    headroom(axes)


def profile(axes, across):
    at = min(10, int(across[:, 1].max()))
    for m, model in enumerate(MODELS):
        rows = across[(across[:, 0] == m) & (across[:, 1] == at)]
        axes.plot(rows[:, 2], rows[:, 4], "-o", ms=3, color=COLOURS[m], label=model)
    axes.set(xlabel=f"place across, {at} D behind the bend", ylabel="speed along the pipe [m/s]",
             xlim=(0, 1), ylim=(0, None))
    headroom(axes)


def along(axes, rows):
    for m, model in enumerate(MODELS):
        axes.plot(rows[:, 0], rows[:, 1 + m], "-o", ms=3, color=COLOURS[m], label=model)
    axes.set(xlabel="distance behind the bend [D]", ylabel="mean speed along the pipe [m/s]",
             ylim=(0, None), xlim=(0, None))
    headroom(axes)


def crossing(axes, points, model, at):
    rows = points[(points[:, 0] == model) & (points[:, 1] == at)]
    t = np.linspace(0, 2 * np.pi, 100)
    axes.plot(0.5 + 0.5 * np.cos(t), 0.5 * np.sin(t), color="0.3", lw=0.8)
    axes.scatter(rows[:, 2], rows[:, 3], s=4, lw=0, color=COLOURS[model])
    axes.set(aspect="equal", xlim=(-0.03, 1.03), ylim=(-0.53, 0.53), xticks=[], yticks=[])
    axes.set_title(f"{MODELS[model]}, {at} D", fontsize=9)
    axes.axis("off")


def main(folder, case):
    across, speeds, points = (table(f"{folder}/{name}.csv") for name in ("across", "along", "points"))
    last = int(across[:, 1].max())
    sections = [at for at in SECTIONS[case] if at <= last] or [last]
    tall = case == "hv"
    figure = plt.figure(figsize=(10.5, 7.5) if tall else (12, 7), constrained_layout=True)
    if tall:
        upper, lower = figure.subfigures(1, 2, width_ratios=(1.2, 1))
    else:
        upper, lower = figure.subfigures(2, 1, height_ratios=(1, 1.2))
    pictures = upper.subplots(1, 2, sharey=True)
    most = max(8, np.ceil(np.nanmax(speeds[:, 1:])))
    for m, model in enumerate(MODELS):
        shown = rope(pictures[m], f"{folder}/{model}.vtp", case, f"{model} model", most)
    upper.colorbar(shown, ax=pictures, label="speed of the particles [m/s]", shrink=0.7,
                   location="bottom")
    figure.suptitle("A bend " + TITLE[case])
    if case == "hh":
        left, right = lower.subfigures(1, 2, width_ratios=(1.3, 1))
        cells = left.subplots(2, len(sections), squeeze=False)
        for m in range(2):
            for k, at in enumerate(sections):
                crossing(cells[m][k], points, m, at)
        left.suptitle("particles at cross-sections: outer wall on the right, gravity downwards",
                      fontsize=9)
        along(right.subplots(), speeds)
    else:
        charts = lower.subplots(3, 1) if tall else lower.subplots(1, 3)
        distribution(charts[0], across, sections)
        profile(charts[1], across)
        along(charts[2], speeds)
    figure.savefig(f"{folder}/bend.png", dpi=110)


if __name__ == "__main__":
    main(*sys.argv[1:3])
