#!/usr/bin/env python3
# silt - BSD-3-Clause, see LICENSE
"""Draws what examples/mixer/mixer.cpp leaves: curves of both runs, and the bed.

  draw_mixer.py FOLDER RADIUS TORQUE MORE    [m] of the vessel, [N m] of the servo, first and last
"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "python"))
from silt import needs  # noqa: E402

needs.or_exit()
import numpy as np  # noqa: E402
from matplotlib.colors import to_rgb  # noqa: E402
from matplotlib.lines import Line2D  # noqa: E402
import silt  # noqa: E402
from silt import drawing as draw  # noqa: E402
from silt.drawing import COLOURS, DPI, Canvas, plt  # noqa: E402

RUNS = (("speed", "fixed speed", COLOURS[0]), ("torque", "fixed torque", COLOURS[5]))
SMOOTH = 5  # rows
BLADE = 1  # the number of the wall


def blade(folder, run):
    """Time [s], torque [N m], speed [1/min] and power [W] on the grains, means over SMOOTH rows."""
    table = silt.table(f"{folder}/blade_{run}.csv")
    time, torque, angle = table["time"], table["torque z"], table["angle z"]
    keep = slice(0, None, SMOOTH)
    work = np.concatenate(([0], np.cumsum(-torque[1:] * np.diff(angle))))[keep]
    twist = np.concatenate(([0], np.cumsum(-torque[1:] * np.diff(time))))[keep]
    t, a = time[keep], angle[keep]
    step = np.diff(t)
    middle = 0.5 * (t[1:] + t[:-1]) - time[0]
    return middle, np.diff(twist) / step, np.diff(a) / step * 30 / np.pi, np.diff(work) / step


def curves(folder, torque, more):
    figure, ((load, speed), (power, index)) = plt.subplots(2, 2, figsize=(11.5, 7.6), constrained_layout=True)
    for run, name, colour in RUNS:
        time, load_now, speed_now, power_now = blade(folder, run)
        load.plot(time, load_now, color=colour, lw=1.3, label=name)
        speed.plot(time, speed_now, color=colour, lw=1.3)
        power.plot(time, power_now, color=colour, lw=1.3)
        rows = silt.table(f"{folder}/index_{run}.csv").rows
        index.plot(rows[:, 1], rows[:, 2], color=colour, lw=1.7, label=f"{name}: colours, side by side")
        index.plot(rows[:, 1], rows[:, 3], color=colour, lw=1.4, ls="--", label=f"{name}: layers")
    for value in (torque, more):
        load.axhline(value, color="0.6", lw=1, zorder=0)
    load.set(ylabel="torque on the grains [N m]", title="Torque; grey: of the servo", ylim=(0, None))
    load.legend(frameon=False, fontsize=10, loc="upper left")
    speed.set(ylabel="speed of the blades [1/min]", title="Speed")
    power.set(ylabel="power on the grains [W]", title="Power")
    for panel in (load, speed, power):
        panel.set(xlabel="time [s]", xlim=(0, None))
    index.axhline(1, color="0.6", lw=1, zorder=0)
    index.set(xlabel="turns of the blades", ylabel="Lacey's index", title="Mixing", xlim=(0, None), ylim=(0, 1.04))
    index.legend(frameon=False, fontsize=10, loc="lower right")
    for panel in (load, speed, power, index):
        panel.grid(True, color="0.9", lw=0.8)
        panel.set_axisbelow(True)
        panel.spines[["top", "right"]].set_visible(False)
    draw.save(figure, f"{folder}/mixer.png")


def bed(folder, radius):
    """Colours from above, and layers behind a cut through the axis."""
    shown = (("start", "at the start"), ("one", "after one turn"), ("mixed", "then the blades are raised"),
             ("end", "at the end, upright"))
    table = np.array([to_rgb(COLOURS[0]), to_rgb(COLOURS[1])])
    width = 3.1
    tall = 1.05 * radius
    figure, panels = plt.subplots(2, 4, figsize=(4 * width + 0.4, width * (1 + 0.5 * tall / radius) + 1.2),
                                  height_ratios=(1, 0.5 * tall / radius))
    figure.subplots_adjust(0.01, 0.07, 0.99, 0.93, 0.03, 0.06)
    for (above, section), (name, title) in zip(panels.T, shown):
        walls = silt.read(f"{folder}/{name}_walls.vtp")
        points, blades = walls.points, walls.wall(BLADE)
        for panel, view, colour, cut, bounds in (
                (above, "top", "colour", None, [-1.04 * radius, 1.04 * radius] * 2),
                (section, "front", "layer", "y=0", [-1.04 * radius, 1.04 * radius, -0.04 * radius, tall])):
            axes = draw.view_axes(view)
            half = draw.Cut(cut, axes) if cut else None
            grains = draw.Bed(f"{folder}/{name}.vtp", colour, axes, half)
            edges, faces = draw.wall_edges(points, blades, axes[2]), points[blades]
            if half:
                edges, faces = half.clip(edges), half.clip_triangles(faces)
            canvas = Canvas(bounds, round(width * DPI))
            canvas.draw_spheres(grains.places, grains.radii, table[grains.values.astype(int)])
            canvas.draw_walls(faces @ axes.T)
            canvas.draw_lines(edges @ axes.T)
            panel.imshow(canvas.picture(), extent=bounds, aspect="equal", interpolation="none")
            panel.set_axis_off()
        angle = np.linspace(0, 2 * np.pi, 200)
        above.plot(radius * np.cos(angle), radius * np.sin(angle), color="0.3", lw=1.5)
        section.plot([-radius, -radius, radius, radius], [tall, 0, 0, tall], color="0.3", lw=1.5)
        above.set_title(title, fontsize=12)
    marks = [Line2D([], [], ls="", marker="o", ms=9, color=table[k], label=label)
             for k, label in enumerate(("left (above) and below (cut through the axis) at the start",
                                        "right (above) and on top (cut) at the start"))]
    figure.legend(handles=marks, loc="lower center", ncol=2, frameon=False, fontsize=11, handletextpad=0.2)
    draw.save(figure, f"{folder}/bed.png")


if __name__ == "__main__":
    try:
        curves(sys.argv[1], float(sys.argv[3]), float(sys.argv[4]))
        bed(sys.argv[1], float(sys.argv[2]))
    except silt.Error as refusal:
        sys.exit(f"draw_mixer.py: {refusal}")
