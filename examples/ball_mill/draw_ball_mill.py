#!/usr/bin/env python3
# silt - BSD-3-Clause, see LICENSE
"""Draws what examples/ball_mill leaves: heat map with the line of repose, balls, power, impacts; the wet surface.

  draw_ball_mill.py dry FOLDER RADIUS ANGLE RECORDED CASE    [m], [degrees]
  draw_ball_mill.py wet FOLDER RADIUS SPACING CASE           [m]
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
from silt.drawing import COLOURS, COLOUR_MAP, DPI, Canvas, plt  # noqa: E402

LIFTERS, HEIGHT = 8, 5  # [mm]


def read_grey(path):
    """A PGM file of bytes as shares, row 0 the lowest."""
    with open(path, "rb") as file:
        kind, size, most, data = file.read().split(b"\n", 3)
    if kind != b"P5" or most != b"255":
        raise silt.Error(f"file '{path}' is no PGM file of bytes")
    columns, rows = map(int, size.split())
    return np.frombuffer(data, np.uint8).reshape(rows, columns)[::-1] / 255


def outline(panel, radius, lifters=None):
    """The shell [mm], and lifters turned by an angle [rad]."""
    angle = np.linspace(0, 2 * np.pi, 400)
    panel.plot(radius * np.cos(angle), radius * np.sin(angle), color="0.25", lw=1.5)
    if lifters is not None:
        for k in range(LIFTERS):
            turn = lifters + 2 * np.pi * (k + 0.5) / LIFTERS
            out, along = np.array([np.cos(turn), np.sin(turn)]), np.array([-np.sin(turn), np.cos(turn)])
            corners = np.array([out * r + along * t for r, t in
                                ((radius, -0.5 * HEIGHT), (radius - HEIGHT, -0.5 * HEIGHT),
                                 (radius - HEIGHT, 0.5 * HEIGHT), (radius, 0.5 * HEIGHT))])
            panel.fill(*corners.T, color="0.25", lw=0)
    edge = 1.03 * radius
    panel.set(aspect="equal", xlim=(-edge, edge), ylim=(-edge, edge), xlabel="x [mm]", ylabel="z [mm]")
    panel.spines[["top", "right"]].set_visible(False)


def phase(folder):
    """How far the lifters of drum.vtp have turned from where they began [rad]."""
    points = silt.read(f"{folder}/drum.vtp").points
    angles = np.arctan2(points[:, 2], points[:, 0])
    pitch = 2 * np.pi / LIFTERS
    return np.angle(np.exp(1j * LIFTERS * (angles - 0.5 * pitch)).mean()) / LIFTERS


def balls(panel, folder, radius):
    bed = draw.Bed(f"{folder}/end.vtp", "velocity", draw.view_axes("front"), None)
    bounds = [-1.03 * radius, 1.03 * radius] * 2
    canvas = Canvas(bounds, round(5 * DPI))
    norm = Normalize(0, max(np.percentile(bed.values, 99), 1e-9))
    canvas.draw_spheres(bed.places, bed.radii, COLOUR_MAP(norm(np.minimum(bed.values, norm.vmax)))[:, :3])
    panel.imshow(canvas.picture(), extent=[1e3 * b for b in bounds], interpolation="none")
    return ScalarMappable(norm, COLOUR_MAP)


def mill(folder, radius, angle, recorded, case):
    figure, (heat, bed) = plt.subplots(1, 2, figsize=(12.6, 5.6), constrained_layout=True)
    share = read_grey(f"{folder}/heat.pgm")
    side = 1e3 * radius
    shown = heat.imshow(100 * share, origin="lower", extent=[-side, -side + share.shape[1], -side,
                                                              -side + share.shape[0]], cmap="Greys_r", vmin=0, vmax=100)
    figure.colorbar(shown, ax=heat, label="frames in which a ball is there [%]", shrink=0.85)
    rows = silt.table(f"{folder}/surface.csv").rows
    x, z, used, line = 1e3 * rows[:, 0], 1e3 * rows[:, 1], rows[:, 2] > 0, 1e3 * rows[:, 3]
    heat.plot(x[~used], z[~used], ".", ms=3, color=COLOURS[4], label="highest pixel of a column")
    heat.plot(x[used], z[used], ".", ms=3, color=COLOURS[1], label="... from 60 mm beside the highest on")
    heat.plot(x[used], line[used], color=COLOURS[5], lw=2, label=f"line, {angle:.1f}°; recording {recorded:.2f}°")
    outline(heat, side)
    heat.legend(loc="upper right", fontsize=8.5, framealpha=0.9)
    heat.set_title(f"Where balls are, {case} mm drum")
    scale = balls(bed, folder, radius)
    outline(bed, side, phase(folder))
    figure.colorbar(scale, ax=bed, label="speed of the balls [m/s]", shrink=0.85, extend="max")
    bed.set_title("Balls at the end")
    draw.save(figure, f"{folder}/mill.png")


def finish(panel):
    panel.grid(True, color="0.9", lw=0.8)
    panel.set_axisbelow(True)
    panel.spines[["top", "right"]].set_visible(False)


def curves(folder):
    figure, (power, impacts) = plt.subplots(1, 2, figsize=(12.6, 4.6), constrained_layout=True)
    rows = silt.table(f"{folder}/torque.csv").rows
    power.plot(rows[:, 1], rows[:, 3], color=COLOURS[0], lw=1.1, label="of the drum: torque times speed")
    power.plot(rows[:, 1], rows[:, 4], color=COLOURS[1], lw=1.1, label="dissipated, by the ledger")
    power.axhline(np.mean(rows[:, 3]), color="0.4", lw=1, ls="--", label=f"mean {np.mean(rows[:, 3]):.1f} W")
    power.set(xlabel="turns of the drum", ylabel="power [W]", title="Power", ylim=(0, None), xlim=(0, rows[-1, 1]))
    power.legend(frameon=False, fontsize=9.5, loc="lower right")
    finish(power)
    rows = silt.table(f"{folder}/impacts.csv").rows
    for column, name, colour in ((1, "between balls", COLOURS[0]), (2, "at the drum", COLOURS[5])):
        seen = rows[:, column] > 0
        impacts.plot(rows[seen, 0], rows[seen, column], "-o", ms=3.5, lw=1.2, color=colour, label=name)
    impacts.set(xscale="log", yscale="log", xlabel="energy lost in a contact [J]",
                ylabel="contacts a ball and class [1/s]", title="Impact energy spectrum, classes of a quarter decade")
    impacts.legend(frameon=False)
    finish(impacts)
    draw.save(figure, f"{folder}/curves.png")


def wet(folder, radius, spacing, case):
    figure, (slurry, surface) = plt.subplots(1, 2, figsize=(12.6, 5.6), constrained_layout=True)
    side = 1e3 * radius
    drops_at = silt.read(f"{folder}/slurry.vtp")
    points = drops_at.points
    middle = 0.5 * (points[:, 1].min() + points[:, 1].max())
    speed = drops_at["|velocity|"]
    balls_at = silt.read(f"{folder}/end.vtp")
    spheres = balls_at.points
    away = np.abs(spheres[:, 1] - middle)
    cut = np.sqrt(np.maximum(balls_at["radius"] ** 2 - away ** 2, 0))
    cut = np.where(away < balls_at["radius"], cut, 0)
    seen = cut > 0
    sizes = 2e3 * cut[seen]
    slurry.add_collection(EllipseCollection(sizes, sizes, np.zeros_like(sizes), units="xy",
                                            offsets=1e3 * spheres[seen][:, [0, 2]], offset_transform=slurry.transData,
                                            fc="0.75", ec="0.45", lw=0.6))
    near = np.abs(points[:, 1] - middle) < 0.75 * spacing
    sizes = np.full(near.sum(), 0.8e3 * spacing)
    drops = EllipseCollection(sizes, sizes, np.zeros_like(sizes), units="xy", offsets=1e3 * points[near][:, [0, 2]],
                              offset_transform=slurry.transData, cmap=COLOUR_MAP, lw=0)
    drops.set_array(speed[near])
    drops.set_clim(0, np.percentile(speed, 99))
    slurry.add_collection(drops)
    figure.colorbar(drops, ax=slurry, label="speed of the slurry [m/s]", shrink=0.85, extend="max")
    outline(slurry, side, phase(folder))
    slurry.set_title(f"Slurry and cut balls in the middle, {case} mm drum")
    rows = silt.table(f"{folder}/highest.csv").rows
    surface.plot(1e3 * rows[:, 0], 1e3 * rows[:, 1], ".", ms=2, color=COLOURS[4], alpha=0.5,
                 label="highest slurry of a column, median to third quartile")
    fit = 1e3 * silt.table(f"{folder}/surface.csv").rows
    surface.fill_between(fit[:, 0], fit[:, 1] - fit[:, 3], fit[:, 1] + fit[:, 3], color=COLOURS[1], alpha=0.3, lw=0,
                         label="95 % of the points")
    surface.plot(fit[:, 0], fit[:, 1], color=COLOURS[5], lw=2, label="quadratic")
    outline(surface, side)
    surface.legend(loc="upper right", fontsize=8.5, framealpha=0.9)
    surface.set_title("Free surface")
    draw.save(figure, f"{folder}/wet.png")


if __name__ == "__main__":
    try:
        if sys.argv[1] == "dry":
            mill(sys.argv[2], *map(float, sys.argv[3:6]), sys.argv[6])
            curves(sys.argv[2])
        else:
            wet(sys.argv[2], float(sys.argv[3]), float(sys.argv[4]), sys.argv[5])
    except silt.Error as refusal:
        sys.exit(f"draw_ball_mill.py: {refusal}")
