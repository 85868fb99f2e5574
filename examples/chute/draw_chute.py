#!/usr/bin/env python3
# silt - BSD-3-Clause, see LICENSE
"""Draws what examples/chute/chute.cpp leaves: the chute by its wear, and wear over place and angle.

  draw_chute.py FOLDER SCALE     SCALE: from depths in the VTK files [m] to mm after 100 000 t
"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "python"))
from silt import needs  # noqa: E402

needs.or_exit()
import numpy as np  # noqa: E402
from matplotlib.cm import ScalarMappable  # noqa: E402
from matplotlib.colors import LinearSegmentedColormap, Normalize  # noqa: E402
import silt  # noqa: E402
from silt import drawing as draw  # noqa: E402
from silt.drawing import COLOURS, DPI, LIGHT, Canvas, plt  # noqa: E402

WORN = LinearSegmentedColormap.from_list("worn", ["#C9CED6", "#E8C07A", "#D9772B", "#A3221F", "#4A0D18"])


def view():
    """Rows: right, up, towards the viewer, who looks up the chute from its lower end."""
    turn, tilt = np.radians([35, 32])
    right = np.array([np.cos(turn), np.sin(turn), 0])
    flat = np.array([np.sin(turn), -np.cos(turn), 0])
    viewer = np.cos(tilt) * flat + np.sin(tilt) * np.array([0, 0, 1])
    return np.array([right, np.cross(viewer, right), viewer])


def wear(folder, scale):
    axes = view()
    grains = draw.Bed(f"{folder}/flow.vtp", "velocity", axes, None)
    worn = silt.read(f"{folder}/sliding.vtp")
    points, triangles = worn.points, worn.triangles
    edges = draw.wall_edges(points, triangles, axes[2])
    seen = points @ axes.T
    low, high = seen[:, :2].min(axis=0), seen[:, :2].max(axis=0)
    high[1] += 0.1 * (high[1] - low[1])  # some of the grains that come
    margin = 0.02 * (high - low).max()
    bounds = [low[0] - margin, high[0] + margin, low[1] - margin, high[1] + margin]
    height = 6.2
    width = height * (bounds[1] - bounds[0]) / (bounds[3] - bounds[2])
    figure, panels = plt.subplots(1, 3, figsize=(3 * width + 0.6, height + 1.1))
    figure.subplots_adjust(0.01, 0.14, 0.99, 0.94, 0.03)

    def finish(panel, canvas, title, norm, colours, label):
        canvas.draw_lines(edges @ axes.T)
        panel.imshow(canvas.picture(), aspect="equal", interpolation="none")
        panel.set_axis_off()
        panel.set_title(title, fontsize=13)
        place = panel.get_position()
        bar = figure.colorbar(ScalarMappable(norm, colours), orientation="horizontal",
                              cax=figure.add_axes([place.x0 + 0.03, 0.09, place.width - 0.06, 0.022]))
        bar.set_label(label, fontsize=12)
        draw.tick_apart(bar, figure)

    pixels = round(width * DPI)
    canvas = Canvas(bounds, pixels)
    norm = Normalize(0, np.ceil(grains.values.max()))
    canvas.draw_spheres(grains.places, grains.radii, draw.COLOUR_MAP(norm(grains.values))[:, :3])
    canvas.draw_walls(seen[triangles])
    finish(panels[0], canvas, "Ore, 4 to 6 mm", norm, draw.COLOUR_MAP, "speed [m/s]")
    for panel, name, title in ((panels[1], "sliding", "Worn by sliding (Archard)"),
                               (panels[2], "impacts", "Worn by impacts (Finnie)")):
        chute = draw.Bed(f"{folder}/{name}.vtp", "worn depth", axes, None)
        depth = np.repeat((chute.values * scale).reshape(-1, 6).mean(axis=1), 6)  # of two triangles
        norm = Normalize(0, np.percentile(depth, 99.5))
        canvas = Canvas(bounds, pixels)
        canvas.draw_triangles(chute.places, chute.triangles, chute.normals + 2 * LIGHT,
                              WORN(norm(depth))[:, :3])  # less shade: colours are what matters
        finish(panel, canvas, title, norm, WORN, "depth after 100 000 t [mm]")
    draw.save(figure, f"{folder}/wear.png")


def profile(folder):
    rows = silt.table(f"{folder}/profile.csv").rows
    place, slid, contacts, block, cut, events = rows.T
    angle, share = silt.table(f"{folder}/angles.csv").rows.T
    figure, panels = plt.subplots(1, 3, figsize=(13, 4), constrained_layout=True)
    panels[0].plot(place, slid, color=COLOURS[0], lw=1.8, label="silt::Wear<Archard>")
    panels[0].plot(place, contacts, "o", color=COLOURS[0], mfc="white", ms=4, label="from contacts read every 0.5 ms")
    panels[0].plot(place[block > 0], block[block > 0], "k--", lw=1.3, label="a block that slides down")
    panels[1].plot(place, cut, color=COLOURS[5], lw=1.8, label="silt::Wear<Finnie>")
    panels[1].plot(place, events, "o", color=COLOURS[5], mfc="white", ms=4, label="from ContactEvents")
    for panel, title in ((panels[0], "Sliding"), (panels[1], "Impacts")):
        panel.set(title=title, xlabel="way from the upper end [m]", ylabel="depth of the floor after 100 000 t [mm]",
                  ylim=(0, 1.35 * panel.dataLim.y1))  # room for the legend
        panel.legend(fontsize=10, frameon=False, loc="upper right")
    panels[2].bar(angle, share, width=4.4, color=COLOURS[5])
    panels[2].set(title="Impacts at which angle wear", xlabel="angle to the wall [degrees]",
                  ylabel="share of Finnie's wear [%]", xlim=(0, 90))
    for panel in panels:
        panel.grid(True, color="0.9", lw=0.8)
        panel.set_axisbelow(True)
        panel.spines[["top", "right"]].set_visible(False)
    draw.save(figure, f"{folder}/profile.png")


if __name__ == "__main__":
    try:
        wear(sys.argv[1], float(sys.argv[2]))
        profile(sys.argv[1])
    except silt.Error as refusal:
        sys.exit(f"draw_chute.py: {refusal}")
