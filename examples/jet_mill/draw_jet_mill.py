#!/usr/bin/env python3
# silt - BSD-3-Clause, see LICENSE
"""Draws a run of the jet mill: the grains and the gas from above; sizes, breakage and impacts.

  draw_jet_mill.py FOLDER RADIUS OUTLET POST NOZZLE OFFSET    [m] of the chamber
"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
import needs  # noqa: E402,F401
import draw  # noqa: E402
import numpy as np  # noqa: E402
from draw import COLOUR_MAP, COLOURS, plt  # noqa: E402
from matplotlib.collections import EllipseCollection  # noqa: E402
from matplotlib.patches import Circle  # noqa: E402


def finish(panel):
    panel.grid(True, color="0.9", lw=0.8)
    panel.set_axisbelow(True)
    panel.spines[["top", "right"]].set_visible(False)


def chamber(panel, radius, outlet, post, nozzle, offset):
    """The chamber [mm] from above, with its four slots."""
    ends = [np.arcsin((offset + side * nozzle) / radius) for side in (-1, 1)]
    edge = radius + 2
    for quarter in range(4):
        turn = quarter * np.pi / 2
        # The slot of this quarter comes along +x at y = -offset, turned.
        c, s = np.cos(turn), np.sin(turn)
        for side, angle in zip((-1, 1), ends):
            y = -(offset + side * nozzle)
            x = np.array([-edge, -radius * np.cos(angle)])
            panel.plot(c * x - s * y, s * x + c * y, color="0.25", lw=1)
        wall = np.linspace(np.pi + ends[1], 1.5 * np.pi + ends[0], 60) + turn
        panel.plot(radius * np.cos(wall), radius * np.sin(wall), color="0.25", lw=1)
    panel.add_patch(Circle((0, 0), outlet, fill=False, ls="--", lw=1, ec="0.25"))
    panel.add_patch(Circle((0, 0), post, fc="0.8", lw=1, ec="0.25", zorder=3))
    panel.set(aspect="equal", xlim=(-edge, edge), ylim=(-edge, edge), xlabel="x [mm]", ylabel="y [mm]")
    panel.spines[["top", "right"]].set_visible(False)


def mill(folder, shape):
    figure, (grains, gas) = plt.subplots(1, 2, figsize=(13, 5.9), constrained_layout=True)
    points, fields, _ = draw.read_vtp(f"{folder}/end.vtp")
    speed = np.linalg.norm(fields["velocity"], axis=1)
    # The large ones below, so that all are seen.
    order = np.argsort(-fields["radius"])
    sizes = 2e3 * fields["radius"][order]
    shown = EllipseCollection(sizes, sizes, np.zeros_like(sizes), units="xy", offsets=1e3 * points[order, :2],
                              offset_transform=grains.transData, cmap=COLOUR_MAP, lw=0)
    shown.set_array(speed[order])
    shown.set_clim(0, np.percentile(speed, 99) if len(speed) else 1)
    grains.add_collection(shown)
    figure.colorbar(shown, ax=grains, label="speed of the grains [m/s]", extend="max", shrink=0.85)
    grains.set_title(f"{len(points)} grains from above")
    chamber(grains, *shape)

    rows = draw.read_csv(f"{folder}/gas.csv")[1]
    xs, ys = np.unique(rows[:, 0]), np.unique(rows[:, 1])
    u, v, w = (np.full((len(ys), len(xs)), np.nan) for _ in range(3))
    at = np.searchsorted(ys, rows[:, 1]), np.searchsorted(xs, rows[:, 0])
    u[at], v[at], w[at] = rows[:, 2], rows[:, 3], rows[:, 4]
    field = gas.pcolormesh(1e3 * xs, 1e3 * ys, np.sqrt(u * u + v * v + w * w), cmap=COLOUR_MAP, shading="nearest")
    gas.streamplot(1e3 * xs, 1e3 * ys, np.nan_to_num(u), np.nan_to_num(v), density=1.3, color="w", linewidth=0.6,
                   arrowsize=0.7)
    figure.colorbar(field, ax=gas, label="speed of the gas [m/s]", shrink=0.85)
    gas.set_title("Gas at half height, mean of the second half")
    chamber(gas, *shape)
    draw.save(figure, f"{folder}/mill.png")


def curve(panel, path, label, colour):
    table = draw.read_csv(path)[1]
    if len(table):
        panel.plot(1e6 * np.append(table[0, 0], table[:, 1]), np.append(0, table[:, 4]), "-o", ms=3, color=colour,
                   label=label)


def milling(folder):
    figure, panels = plt.subplots(2, 2, figsize=(12.5, 8.6), constrained_layout=True)
    (over_time, rates), (sizes, energies) = panels
    table = draw.read_csv(f"{folder}/sizes_over_time.csv")[1]
    for first, name, colour in ((4, "grains in the mill", COLOURS[0]), (1, "dust", COLOURS[5])):
        t = 1e3 * table[:, 0]
        over_time.fill_between(t, 1e6 * table[:, first], 1e6 * table[:, first + 2], color=colour, alpha=0.2, lw=0)
        over_time.plot(t, 1e6 * table[:, first + 1], color=colour, label=f"{name}: x50, band x10 to x90")
    over_time.set(yscale="log", xlabel="time [ms]", ylabel="size [µm]", title="Sizes by mass", xlim=(0, None))
    over_time.set_ylim(top=3 * over_time.get_ylim()[1])
    over_time.legend(frameon=False, loc="upper right")

    table = draw.read_csv(f"{folder}/breakage.csv")[1]
    t, step = 1e3 * table[1:, 0], np.diff(table[:, 0])
    rates.plot(t, 1e-3 * np.diff(table[:, 2]) / step, color=COLOURS[0], label="at walls")
    rates.plot(t, 1e-3 * np.diff(table[:, 3]) / step, color=COLOURS[5], label="in pairs")
    rates.set(xlabel="time [ms]", ylabel="grains that break in a millisecond", title="Breakage", xlim=(0, None))
    rates.set_ylim(0, 1.25 * rates.get_ylim()[1])
    grains = rates.twinx()
    grains.plot(t, table[1:, 1], color="0.5", ls="--", lw=1)
    grains.set(ylabel="grains in the mill (dashed)", ylim=(0, None))
    rates.legend(frameon=False, loc="upper left")

    curve(sizes, f"{folder}/grains.csv", "grains in the mill", COLOURS[0])
    curve(sizes, f"{folder}/product.csv", "product: dust and what left", COLOURS[5])
    sizes.set(xscale="log", ylim=(0, 1.03), xlabel="size x [µm]", ylabel="share of the mass finer than x",
              title="Sizes at the end")
    sizes.legend(frameon=False, loc="upper left")

    table = draw.read_csv(f"{folder}/impacts.csv")[1]
    at = np.sqrt(table[:, 0] * table[:, 1])
    for first, name, colour in ((2, "at walls", COLOURS[0]), (3, "in pairs", COLOURS[5])):
        energies.plot(at, np.where(table[:, first] > 0, table[:, first], np.nan), color=colour, label=name)
    energies.set(xscale="log", yscale="log", xlabel="energy of the impact m* v²/2 [J]",
                 ylabel="impacts a second, by factors of 2", title="Impacts")
    energies.legend(frameon=False, loc="upper left")
    for panel in panels.flat:
        finish(panel)
    draw.save(figure, f"{folder}/milling.png")


if __name__ == "__main__":
    mill(sys.argv[1], [1e3 * float(word) for word in sys.argv[2:7]])
    milling(sys.argv[1])
