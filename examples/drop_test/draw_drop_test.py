#!/usr/bin/env python3
# silt - BSD-3-Clause, see LICENSE
"""Draws what examples/drop_test/drop_test.cpp leaves: shares that break, fatigue, sizes, the grains.

  draw_drop_test.py FOLDER DIAMETER SPEED    [m], [m/s] of the grains of after.vtp
"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "python"))
from silt import needs  # noqa: E402

needs.or_exit()
import numpy as np  # noqa: E402
import silt  # noqa: E402
from silt import drawing as draw  # noqa: E402
from silt.drawing import COLOURS, DPI, Canvas, plt  # noqa: E402

WHOLE, FRAGMENT = (0.62, 0.66, 0.72), (0.84, 0.45, 0.10)


def finish(panel):
    panel.grid(True, color="0.9", lw=0.8)
    panel.set_axisbelow(True)
    panel.spines[["top", "right"]].set_visible(False)


def shares(folder):
    figure, (once, again) = plt.subplots(1, 2, figsize=(12.5, 4.8), constrained_layout=True)
    points = silt.table(f"{folder}/drop_test.csv").rows
    law = silt.table(f"{folder}/drop_test_law.csv").rows
    sizes = np.unique(points[:, 0])[::-1]
    for size, colour in zip(sizes, COLOURS):
        mine, line = points[points[:, 0] == size], law[law[:, 0] == size]
        once.plot(line[:, 1], line[:, 2], color=colour, lw=1.3)
        once.errorbar(mine[:, 1], mine[:, 4], mine[:, 6], fmt="o", ms=5, mfc="white", color=colour, capsize=3)
        once.plot([], [], "-o", ms=5, mfc="white", color=colour, lw=1.3, label=f"{1e3 * size:g} mm")
    speeds = points[:, 1]
    once.set(xscale="log", xlim=(0.8 * speeds.min(), 1.25 * speeds.max()), ylim=(0, 1),
             xlabel="speed of the impact [m/s]", ylabel="share that breaks",
             title=f"One impact: points {points[0, 2]:.0f} grains, 3 σ; lines the selection function")
    draw.label_few_decades(once.xaxis, once.get_xlim())
    once.legend(frameon=False, loc="upper left")

    table = silt.table(f"{folder}/fatigue.csv").rows
    for speed, colour in zip(np.unique(table[:, 0])[::-1], COLOURS[2:]):
        mine = table[table[:, 0] == speed]
        again.plot(mine[:, 1], mine[:, 3], color=colour, lw=1.3)
        mine = mine[::-(-len(mine) // 20)]
        again.errorbar(mine[:, 1], mine[:, 2], mine[:, 4], fmt="o", ms=4, mfc="white", color=colour, capsize=2,
                       lw=0.9)
        again.plot([], [], "-o", ms=4, mfc="white", color=colour, lw=1.3, label=f"{speed:.1f} m/s")
    again.set(xlim=(0, None), ylim=(0, None), xlabel="impacts of the same grain", ylabel="share that is broken",
              title=f"{1e3 * sizes[0]:g} mm again and again: points with 3 σ; lines the fatigue law")
    again.legend(frameon=False, loc="lower right")
    for panel in (once, again):
        finish(panel)
    draw.save(figure, f"{folder}/drop_test.png")


def fragments(folder, diameter, speed):
    figure, (curve, picture) = plt.subplots(1, 2, figsize=(12.5, 4.8))
    figure.subplots_adjust(0.07, 0.13, 0.99, 0.92, 0.08)
    table = silt.table(f"{folder}/sizes.csv").rows
    table = table[table[:, 0] > 0.004 * diameter]
    curve.plot(1e3 * table[:, 0], table[:, 2], color=COLOURS[0], lw=1.3, label="breakage function")
    curve.errorbar(1e3 * table[:, 0], table[:, 1], 3 * table[:, 3], fmt="o", ms=5, mfc="white", color=COLOURS[5],
                   capsize=3, lw=0.9, label="fragments and dust, bars 3 σ")
    curve.axvspan(curve.get_xlim()[0], 200 * diameter, color="0.94", lw=0)
    curve.text(190 * diameter, 0.02, "dust ", ha="right", va="bottom", color="0.4")
    curve.set(xscale="log", xlim=(900 * table[0, 0], 1.1e3 * diameter), ylim=(0, 1.03), xlabel="size x [mm]",
              ylabel="share of the mass finer than x", title=f"What grains of {1e3 * diameter:g} mm break into")
    curve.legend(frameon=False, loc="upper left")
    finish(curve)

    # A corner of the plate from above: 6 by 4 grains.
    axes = draw.view_axes("top")
    grains = silt.read(f"{folder}/after.vtp")
    places, radii = grains.points @ axes.T, grains["radius"].astype(float)
    bounds = [-1.5 * diameter, 16.5 * diameter, -1.5 * diameter, 10.5 * diameter]
    seen = np.all((places[:, :2] > [bounds[0], bounds[2]]) & (places[:, :2] < [bounds[1], bounds[3]]), axis=1)
    places, radii = places[seen], radii[seen]
    colours = np.where((radii > 0.499 * diameter)[:, None], WHOLE, FRAGMENT)
    canvas = Canvas(bounds, round(6 * DPI))
    canvas.draw_spheres(places, radii, colours)
    picture.imshow(canvas.picture(), extent=bounds, interpolation="none")
    picture.set_axis_off()
    picture.set_title(f"After an impact at {speed:.1f} m/s, from above")
    draw.save(figure, f"{folder}/sizes.png")


if __name__ == "__main__":
    try:
        shares(sys.argv[1])
        fragments(sys.argv[1], float(sys.argv[2]), float(sys.argv[3]))
    except silt.Error as refusal:
        sys.exit(f"draw_drop_test.py: {refusal}")
