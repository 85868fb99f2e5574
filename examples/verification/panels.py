# silt - BSD-3-Clause, see LICENSE
"""Sheets of panels in the style of silt's pictures, and where their data come from."""

import csv
import os
import sys

here = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(here, "..", "..", "python"))
from silt import needs  # noqa: E402

needs.or_exit()
import numpy as np  # noqa: E402
from silt import Error, table  # noqa: E402
from silt.drawing import COLOURS, plt, save  # noqa: E402,F401


class Folder:
    """Tables by name, columns by name with or without unit."""

    def __init__(self, path):
        self.path = path

    def columns(self, name, *wanted):
        read = table(os.path.join(self.path, name + ".csv"))
        return [read[w] for w in wanted]

    def save(self, figure, name):
        save(figure, os.path.join(self.path, name + ".png"), 100)  # dpi: the pictures stand in the docs
        plt.close(figure)


def published(figure, series):
    path = os.path.join(here, "reference", "published.csv")
    with open(path, encoding="utf-8") as file:
        points = [(float(r[2]), float(r[3])) for r in csv.reader(file)
                  if r[0] == figure and r[1] == series]
    if not points:
        raise Error(f"file '{path}' has no points of '{figure}', '{series}'")
    return np.array(points).T


def sheet(panels, title, width=4.3, height=3.7):
    figure, axes = plt.subplots(1, panels, figsize=(width * panels, height), squeeze=False,
                                constrained_layout=True)
    if title:
        figure.suptitle(title, fontsize=12)
    for axis in axes[0]:
        axis.grid(True, color="0.9", lw=0.8)
        axis.set_axisbelow(True)
        axis.spines[["top", "right"]].set_visible(False)
        axis.tick_params(labelsize=9)
    return figure, axes[0]


def name_axes(axis, x, y):
    axis.set_xlabel(x, fontsize=10)
    axis.set_ylabel(y, fontsize=10)


def legend(axis, **more):
    axis.legend(fontsize=8, frameon=True, framealpha=0.9, edgecolor="none", **more)


def silt(axis, x, y, colour, label, marker="o", every=1):
    axis.plot(x[::every], y[::every], marker, color=colour, ms=4.5, label=label, zorder=4)


def line(axis, x, y, label, style="-", colour="black", lw=1.3):
    axis.plot(x, y, style, color=colour, lw=lw, label=label, zorder=3)


def points(axis, figure, series, label, marker="s", colour="0.35"):
    x, y = published(figure, series)
    axis.plot(x, y, marker, mfc="white", mec=colour, mew=1.1, ms=6, label=label, zorder=2)
