#!/usr/bin/env python3
# silt - BSD-3-Clause, see LICENSE
"""Draws what examples/dam_break/dam_break.cpp leaves: the liquid by pressure and by speed; front, height, energy.

  draw_dam_break.py FOLDER WIDTH SPACING UNIT LATE    [m] of the column, of particles; [s] of T; by how much
                                                      (in T) the measured front is late
"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "python"))
from silt import needs  # noqa: E402

needs.or_exit()
import numpy as np  # noqa: E402
from matplotlib.cm import ScalarMappable  # noqa: E402
from matplotlib.collections import EllipseCollection  # noqa: E402
from matplotlib.colors import Normalize  # noqa: E402
import silt  # noqa: E402
from silt import drawing as draw  # noqa: E402
from silt.drawing import COLOURS, COLOUR_MAP, plt  # noqa: E402

TIMES = (1.0, 2.0, 3.0, 4.0)  # T
DENSITY, GRAVITY = 1000, 9.81


def frames(folder, unit):
    """Files of the series by T."""
    series = silt.open(f"{folder}/vtk/liquid.pvd")
    return list(zip(series.times / unit, series.files))


def liquid(path, spacing):
    """Places (n, 2), speeds, pressures; in 3D of the layer in the middle."""
    frame = silt.read(path)
    points = frame.points
    low, high = points[:, 1].min(), points[:, 1].max()
    seen = np.ones(len(points), bool)
    if high > low:
        seen = np.abs(points[:, 1] - 0.5 * (low + high)) < 0.6 * spacing
    return points[seen][:, [0, 2]], frame["|velocity|"][seen], frame["pressure"][seen]


def snapshots(folder, width, spacing, unit):
    series = frames(folder, unit)
    chosen = [min(series, key=lambda f: abs(f[0] - T)) for T in TIMES]
    states = [(T, *liquid(path, spacing)) for T, path in chosen]
    # Colours to what most of the liquid has.
    kinds = [("pressure over that of 2 a of water", 3, 2 * DENSITY * GRAVITY * width, 1.0),
             ("speed over that of a fall from 2 a", 2, (4 * GRAVITY * width) ** 0.5, None)]
    length = max(s[1][:, 0].max() for s in states) / width + 0.1
    high = 2.1
    panel = 5.6
    figure, panels = plt.subplots(len(states), 2, figsize=(2 * panel + 0.8, len(states) * panel * high / length + 1.5),
                                  sharex=True, sharey=True)
    figure.subplots_adjust(0.05, 0.16, 0.99, 0.96, 0.04, 0.16)
    for column, (word, which, one, most) in enumerate(kinds):
        top = most or np.ceil(10 * max(s[which].max() for s in states) / one) / 10
        scale = Normalize(0, top)
        for axes, state in zip(panels[:, column], states):
            d = np.full(len(state[1]), 1.3 * spacing / width)
            axes.add_collection(EllipseCollection(d, d, np.zeros(len(d)), units="xy", offsets=state[1] / width,
                                                  offset_transform=axes.transData, lw=0,
                                                  facecolors=COLOUR_MAP(scale(state[which] / one))))
            axes.plot([0, 0, length], [high, 0, 0], color="0.2", lw=1.5, clip_on=False)
            axes.set(xlim=(0, length), ylim=(0, high), aspect="equal", xticks=range(int(length) + 1), yticks=[0, 1, 2])
            axes.spines[["top", "right", "left", "bottom"]].set_visible(False)
            axes.text(length - 0.1, high - 0.1, f"T = {state[0]:.1f}", ha="right", va="top", fontsize=12)
        panels[-1, column].set_xlabel("x/a")
        box = panels[-1, column].get_position()
        under = [box.x0 + 0.1 * box.width, 0.065, 0.8 * box.width, 0.015]
        bar = figure.colorbar(ScalarMappable(scale, COLOUR_MAP), orientation="horizontal",
                              extend="max" if most else "neither", cax=figure.add_axes(under))
        bar.set_label(word)
    draw.save(figure, f"{folder}/dam_break.png")


def tidy(axes):
    axes.grid(True, color="0.9", lw=0.8)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(frameon=False)


def curves(folder, late):
    column = silt.table(f"{folder}/dam_break.csv")
    T = column["T"]
    marks = {name: silt.table(f"{folder}/{name}.csv").rows for name in
             ("front_martin_moyce", "front_koshizuka_oka", "height_martin_moyce")}
    figure, (front, height, energy) = plt.subplots(1, 3, figsize=(14, 4.6), constrained_layout=True)
    front.plot(T, column["front"], color=COLOURS[0], label="silt")
    front.plot(T + late, column["front"], color=COLOURS[0], ls="--", lw=1.1, label=f"silt, {late:.2f} later")
    front.plot(T, column["deep front"], color=COLOURS[1], lw=1.4, label="silt, where it is 0.2 a deep")
    for name, colour, mark, label in (("front_martin_moyce", COLOURS[5], "o", "Martin and Moyce"),
                                      ("front_koshizuka_oka", COLOURS[2], "s", "Koshizuka and Oka")):
        front.plot(*marks[name].T, mark, color=colour, mfc="white", label=label)
    last = 1.1 * max(m[-1, 0] for m in marks.values() if m[-1, 0] < 4)
    front.set(xlim=(0, last), ylim=(1, 1.15 * marks["front_martin_moyce"][-1, 1]), xlabel="T = t √(2g/a)",
              ylabel="front x/a")
    height.plot(T, column["height"], color=COLOURS[0], label="silt")
    height.plot(*marks["height_martin_moyce"].T, "o", color=COLOURS[5], mfc="white", label="Martin and Moyce")
    height.set(xlim=(0, T[-1]), ylim=(0, 1.03), xlabel="T = t √(2g/a)", ylabel="height at the wall z/2a")
    whole = sum(column[f"{kind} energy"] for kind in ("kinetic", "potential", "elastic"))
    for kind, colour in (("kinetic", COLOURS[5]), ("potential", COLOURS[2]), ("elastic", COLOURS[3])):
        energy.plot(T, column[f"{kind} energy"], color=colour, label=kind)
    energy.plot(T, whole, color=COLOURS[0], label="all")
    energy.set(xlim=(0, T[-1]), ylim=(0, 1.05), xlabel="T = t √(2g/a)", ylabel="energy over that at the start")
    for axes in (front, height, energy):
        tidy(axes)
    draw.save(figure, f"{folder}/curves.png")


if __name__ == "__main__":
    try:
        snapshots(sys.argv[1], *map(float, sys.argv[2:5]))
        curves(sys.argv[1], float(sys.argv[5]))
    except silt.Error as refusal:
        sys.exit(f"draw_dam_break.py: {refusal}")
