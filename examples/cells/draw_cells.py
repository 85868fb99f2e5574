#!/usr/bin/env python3
# silt - BSD-3-Clause, see LICENSE
"""Draws the triaxial test, or the shear cell.

  draw_cells.py triaxial|shear_cell FOLDER
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

COLOURS = {"dense": "#0072B2", "loose": "#D55E00"}


def table(path):
    with open(path) as file:
        rows = list(csv.reader(file))
    return np.array([[float(v) for v in row] for row in rows[1:]]).T


def tidy(axes):
    axes.grid(True, color="0.9", lw=0.8)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)


def triaxial(folder):
    figure, panels = plt.subplots(2, 2, figsize=(9, 7), constrained_layout=True)
    stress, volume, fraction, fabric = panels.flat
    for name, colour in COLOURS.items():
        strain, ratio, compression, _, solid, turned = table(f"{folder}/{name}.csv")
        stress.plot(100 * strain, ratio, color=colour, label=f"{name} sample")
        volume.plot(100 * strain, -100 * compression, color=colour, label=name)
        fraction.plot(100 * strain, solid, color=colour, label=name)
        fabric.plot(100 * strain, turned, color=colour, label=name)
    for axes in panels.flat:
        axes.set(xlabel="axial strain [%]", xlim=(0, None))
        tidy(axes)
    stress.set(ylabel="deviatoric stress over mean stress q/p", ylim=(0, None))
    angles = stress.secondary_yaxis("right", functions=(angle, ratio_of))
    angles.set_ylabel("friction angle [degrees]")
    volume.set(ylabel="dilation [%]")
    fraction.set(ylabel="solid fraction")
    fabric.set(ylabel="anisotropy of the contacts")
    stress.legend(frameon=False, loc="lower right")
    figure.suptitle("Triaxial compression at constant lateral stress")
    figure.savefig(f"{folder}/triaxial.png", dpi=110)


def angle(ratio):
    ratio = np.clip(np.asarray(ratio, float), 0, 2.9)
    return np.degrees(np.arcsin(3 * ratio / (6 + ratio)))


def ratio_of(degrees):
    s = np.sin(np.radians(degrees))
    return 6 * s / (3 - s)


def shear_cell(folder):
    inertial, friction, error, solid, _ = table(f"{folder}/shear_cell.csv")
    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.8), constrained_layout=True)
    numbers = np.logspace(np.log10(inertial.min() / 1.5), np.log10(inertial.max() * 1.5), 100)

    def law(low, high):
        return low + (high - low) / (1 + 0.28 / numbers)

    left.fill_between(numbers, law(0.34, 0.6), law(0.42, 0.7), color="0.9",
                      label="band around Jop et al. (2006), recalled")
    left.plot(numbers, law(0.38, 0.64), color="0.5", lw=1)
    left.errorbar(inertial, friction, yerr=2 * error, fmt="o", color=COLOURS["dense"],
                  label="silt", capsize=3)
    left.set(xscale="log", xlabel="inertial number I", ylabel="shear over normal stress",
             ylim=(0, None))
    left.legend(frameon=False, loc="lower right")
    right.plot(inertial, solid, "o-", color=COLOURS["dense"])
    right.set(xscale="log", xlabel="inertial number I", ylabel="solid fraction")
    for axes in (left, right):
        tidy(axes)
    figure.suptitle("Simple shear at constant normal stress")
    figure.savefig(f"{folder}/shear_cell.png", dpi=110)


if __name__ == "__main__":
    {"triaxial": triaxial, "shear_cell": shear_cell}[sys.argv[1]](sys.argv[2])
