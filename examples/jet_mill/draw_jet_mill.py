#!/usr/bin/env python3
# silt - BSD-3-Clause, see LICENSE
"""Draws a run of the jet mill: the grains and the gas from above; sizes, breakage and impacts.

  draw_jet_mill.py FOLDER RADIUS OUTLET POST NOZZLE OFFSET    [m] of the chamber
"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "python"))
from silt import needs  # noqa: E402

needs.or_exit()
import numpy as np  # noqa: E402
from matplotlib.collections import EllipseCollection  # noqa: E402
from matplotlib.colors import ListedColormap  # noqa: E402
from matplotlib.patches import Circle  # noqa: E402
import silt  # noqa: E402
from silt import drawing as draw  # noqa: E402
from silt.drawing import COLOURS, COLOUR_MAP, plt  # noqa: E402

LEAST = 0.12  # [mm] smaller grains are drawn as large as that: two pixels
DARK = ListedColormap(plt.get_cmap("viridis")(np.linspace(0, 0.85, 256)), "viridis without its light end")


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
    bed = silt.read(f"{folder}/end.vtp")
    points, speed = bed.points, bed["|velocity|"]
    # The large ones below, so that all are seen.
    order = np.argsort(-bed["radius"])
    sizes = np.maximum(2e3 * bed["radius"][order], LEAST)
    shown = EllipseCollection(sizes, sizes, np.zeros_like(sizes), units="xy", offsets=1e3 * points[order, :2],
                              offset_transform=grains.transData, cmap=DARK, lw=0)
    shown.set_array(speed[order])
    shown.set_clim(0, np.percentile(speed, 99) if len(speed) else 1)
    grains.add_collection(shown)
    figure.colorbar(shown, ax=grains, label="speed of the grains [m/s]", extend="max", shrink=0.85)
    grains.set_title(f"{len(points)} grains from above, those below {LEAST:g} mm drawn as {LEAST:g} mm")
    chamber(grains, *shape)

    rows = silt.table(f"{folder}/gas.csv").rows
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
    table = silt.table(path).rows
    if len(table):
        panel.plot(1e6 * np.append(table[0, 0], table[:, 1]), np.append(0, table[:, 4]), "-o", ms=3, color=colour,
                   label=label)


def milling(folder):
    figure, panels = plt.subplots(2, 2, figsize=(12.5, 8.6), constrained_layout=True)
    (over_time, counts), (sizes, energies) = panels
    table = silt.table(f"{folder}/sizes_over_time.csv").rows
    t, ten, half, ninety = 1e3 * table[:, 0], *(1e6 * table[:, k] for k in (4, 5, 6))
    over_time.fill_between(t, ten, ninety, color=COLOURS[0], alpha=0.2, lw=0, label="x10 to x90")
    over_time.plot(t, half, color=COLOURS[0], label="x50")
    over_time.set(xlabel="time [ms]", ylabel="size [µm]", title="Grains in the mill, sizes by mass", xlim=(0, None))
    over_time.set_ylim(0, 1.25 * np.nanmax(ninety))
    over_time.legend(frameon=False, loc="upper right", ncol=2)

    table = silt.table(f"{folder}/breakage.csv").rows
    t = 1e3 * table[:, 0]
    counts.plot(t, table[:, 1], color="0.5", ls="--", lw=1.2, label="grains in the mill")
    counts.plot(t, table[:, 2], color=COLOURS[0], label="broken so far at walls")
    counts.plot(t, table[:, 3], color=COLOURS[5], label="broken so far in pairs")
    counts.set(xlabel="time [ms]", ylabel="grains", title="Breakage", xlim=(0, None), ylim=(0, None))
    counts.legend(frameon=False, loc="upper left")

    curve(sizes, f"{folder}/grains.csv", "grains in the mill", COLOURS[0])
    curve(sizes, f"{folder}/product.csv", "product: dust and what left", COLOURS[5])
    sizes.set(xscale="log", ylim=(0, 1.03), xlabel="size x [µm]", ylabel="share of the mass finer than x",
              title="Sizes at the end")
    sizes.legend(frameon=False, loc="upper left")

    table = silt.table(f"{folder}/impacts.csv").rows
    # Classes of a factor of 2, as steps: an empty one goes down to the axis.
    edges = np.append(table[:, 0], table[-1:, 1])
    least = table[:, 2:4][table[:, 2:4] > 0].min(initial=np.inf)
    for first, name, colour in ((2, "at walls", COLOURS[0]), (3, "in pairs", COLOURS[5])):
        energies.stairs(table[:, first], edges, baseline=None, color=colour, lw=1.5, label=name)
    energies.set(xscale="log", yscale="log", xlabel="energy of the impact m* v²/2 [J]",
                 ylabel="impacts a second in classes of a factor of 2", title="Impacts")
    if np.isfinite(least):
        energies.set_ylim(bottom=0.5 * least)  # half of one impact
    energies.legend(frameon=False, loc="upper left")
    for panel in panels.flat:
        finish(panel)
    draw.save(figure, f"{folder}/milling.png")


if __name__ == "__main__":
    mill(sys.argv[1], [1e3 * float(word) for word in sys.argv[2:7]])
    milling(sys.argv[1])
