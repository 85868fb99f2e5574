#!/usr/bin/env python3
# silt - BSD-3-Clause, see LICENSE
"""Draws what examples/crater/crater.cpp leaves: cuts through the bed, depth over height, deceleration.

  draw_crater.py FOLDER LEVEL DIAMETER    of the bed's surface (dashes) and of the ball [m]
"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "python"))
from silt import needs  # noqa: E402

needs.or_exit()
import numpy as np  # noqa: E402
from matplotlib.cm import ScalarMappable  # noqa: E402
from matplotlib.colors import Normalize  # noqa: E402
import silt  # noqa: E402
from silt import drawing as draw  # noqa: E402
from silt.drawing import COLOURS, COLOUR_MAP, DPI, Canvas, plt  # noqa: E402

BODY = 2  # the number of this wall
STEEL = (0.60, 0.63, 0.68)


def name_of(density, height):
    return f"{density:.0f}_{np.floor(1e3 * height + 0.5):.0f}"


def cut(panel, name, colour, norm, bounds, level, pixels):
    """Grains behind the plane through the axis, coloured by a field, and the whole ball."""
    axes = draw.view_axes("front")
    grains = draw.Bed(f"{name}.vtp", colour, axes, draw.Cut("y=0", axes))
    canvas = Canvas(bounds, pixels)
    canvas.draw_spheres(grains.places, grains.radii, COLOUR_MAP(norm(grains.values))[:, :3])
    walls = silt.read(f"{name}_walls.vtp")
    points, triangles = walls.points, walls.wall(BODY)
    seen = points @ axes.T
    middle = seen[np.unique(triangles)].mean(axis=0)
    corners = seen[triangles]
    flat = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    triangles = triangles[flat[:, 2] > 0]
    normals = seen[triangles] - middle
    normals /= np.linalg.norm(normals, axis=2, keepdims=True)
    canvas.draw_triangles(seen, triangles, normals, np.tile(STEEL, (len(points), 1)))
    panel.imshow(canvas.picture(), extent=bounds, interpolation="none")
    ball = 1.1 * np.abs(seen[np.unique(triangles), 0] - middle[0]).max()
    for ends in ([bounds[0], middle[0] - ball], [middle[0] + ball, bounds[1]]):
        panel.plot(ends, [level, level], color=COLOURS[5], lw=1.3, ls=(0, (5, 4)))
    panel.set(xlim=bounds[:2], ylim=bounds[2:])
    panel.set_axis_off()


def bar_below(figure, panel, norm, label, extend):
    sheet = figure.get_size_inches()[1]
    place = panel.get_position()
    bar = figure.colorbar(ScalarMappable(norm, COLOUR_MAP), orientation="horizontal", extend=extend,
                          cax=figure.add_axes([place.x0 + 0.1 * place.width, place.y0 - 0.30 / sheet,
                                               0.8 * place.width, 0.16 / sheet]))
    bar.set_label(label, fontsize=11)
    draw.tick_apart(bar, figure)


def cuts(folder, level, size, drops):
    light, heavy = drops[:, 0].min(), drops[:, 0].max()
    low, high = drops[:, 1].min(), drops[:, 1].max()
    points = silt.read(f"{folder}/early.vtp").points
    wide = np.hypot(points[:, 0], points[:, 1]).max()
    bounds = [-1.05 * wide, 1.05 * wide, -0.02 * level, level + 0.9 * size]
    width = 6.2
    height = width * (bounds[3] - bounds[2]) / (bounds[1] - bounds[0])
    sheet = 2 * height + 2.5
    figure, panels = plt.subplots(2, 2, figsize=(2 * width + 0.5, sheet))
    figure.subplots_adjust(0.01, 0.9 / sheet, 0.99, 1 - 0.35 / sheet, 0.03, 1.25 / height)
    pixels = round(width * DPI)

    ends = [(panels[0, 1], heavy, high), (panels[1, 0], light, low), (panels[1, 1], heavy, low)]
    moved = [silt.read(f"{folder}/{name_of(d, h)}.vtp")["moved"] for _, d, h in ends]
    speeds = silt.read(f"{folder}/early.vtp")["|velocity|"]
    norm = Normalize(0, float(f"{np.percentile(speeds, 99):.1g}"))
    cut(panels[0, 0], f"{folder}/early", "velocity", norm, bounds, level, pixels)
    panels[0, 0].set_title(f"{heavy:.0f} kg/m\u00b3 from {1e3 * high:.0f} mm, at half its speed", fontsize=13)
    bar_below(figure, panels[0, 0], norm, "speed of grains [m/s]", "max")
    norm = Normalize(0, float(f"{1e3 * np.percentile(moved[0], 97):.1g}"))
    for panel, density, fall in ends:
        name = f"{folder}/{name_of(density, fall)}"
        cut(panel, name, "moved", lambda v, n=norm: n(1e3 * v), bounds, level, pixels)
        panel.set_title(f"{density:.0f} kg/m\u00b3 from {1e3 * fall:.0f} mm, at rest", fontsize=13)
        bar_below(figure, panel, norm, "displacement of grains [mm]", "max")
    draw.save(figure, f"{folder}/crater.png")


def curves(folder, drops):
    figure, panels = plt.subplots(1, 3, figsize=(16, 4.6), constrained_layout=True)
    depth, speed, slowed = panels
    styles = ["-", "--", "-.", ":"]
    densities = np.unique(drops[:, 0])
    for k, density in enumerate(densities):
        mine = drops[drops[:, 0] == density]
        colour = COLOURS[[0, 5, 2, 3][k % 4]]
        depth.plot(1e3 * mine[:, 2], 1e3 * mine[:, 3], "o", color=colour, ms=7, label=f"{density:.0f} kg/m\u00b3")
        depth.plot(1e3 * mine[:, 2], 1e3 * mine[:, 5], color=colour, lw=1.4)
        depth.plot(1e3 * mine[:, 2], 1e3 * mine[:, 4], color=colour, lw=1.2, ls="--")
        for n, height in enumerate(mine[:, 1]):
            time, _, fast, gees = silt.table(f"{folder}/{name_of(density, height)}.csv").rows.T
            words = f"{density:.0f} kg/m\u00b3, {1e3 * height:.0f} mm"
            speed.plot(1e3 * time, fast, color=colour, lw=1.3, ls=styles[n % 4], label=words)
            if density == densities[-1]:
                slowed.plot(1e3 * time, gees, color=COLOURS[n % len(COLOURS)], lw=1.3,
                            label=f"from {1e3 * height:.0f} mm")
    depth.plot([], [], color="0.3", lw=1.4, label="fit of all")
    depth.plot([], [], color="0.3", lw=1.2, ls="--", label="law of Uehara et al.")
    depth.set(xscale="log", yscale="log", xlabel="height of fall, depth included [mm]",
              ylabel="depth [mm]", title="Depth at rest")
    for axis in (depth.xaxis, depth.yaxis):
        draw.label_few_decades(axis, axis.get_view_interval())
    speed.set(xlabel="time since the impact [ms]", ylabel="speed downwards [m/s]", title="Speed")
    slowed.set(xlabel="time since the impact [ms]", ylabel="deceleration [g]",
               title=f"Deceleration, {densities[-1]:.0f} kg/m\u00b3")
    for panel in panels:
        panel.grid(True, color="0.9", lw=0.8)
        panel.set_axisbelow(True)
        panel.spines[["top", "right"]].set_visible(False)
        panel.legend(fontsize=10, frameon=False)
    end = 1.1e3 * drops[:, 7].max()
    speed.set(xlim=(-5, end)), slowed.set(xlim=(-5, end))
    draw.save(figure, f"{folder}/depth.png")


if __name__ == "__main__":
    try:
        where = sys.argv[1]
        table = silt.table(f"{where}/depths.csv").rows
        cuts(where, float(sys.argv[2]), float(sys.argv[3]), table)
        curves(where, table)
    except silt.Error as refusal:
        sys.exit(f"draw_crater.py: {refusal}")
