#!/usr/bin/env python3
# silt - BSD-3-Clause, see LICENSE
"""Draws what examples/shear_box/shear_box.cpp leaves: the curves of the tests, and the sheared box.

  draw_shear_box.py FOLDER LENGTH WIDTH SPLIT TRAVEL ABOVE    [m] of the box
"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "python"))
from silt import needs  # noqa: E402

needs.or_exit()
import numpy as np  # noqa: E402
from matplotlib.cm import ScalarMappable  # noqa: E402
from matplotlib.collections import LineCollection  # noqa: E402
from matplotlib.colors import ListedColormap, Normalize  # noqa: E402
import silt  # noqa: E402
from silt import drawing as draw  # noqa: E402
from silt.drawing import DPI, Canvas, plt  # noqa: E402

SHADES = {"dense": ("#7FB8DA", "#2E86C1", "#0B3C5D"), "loose": ("#F5B183", "#DD6B20", "#8A3208")}


def tests(folder):
    """Rows of tests.csv, with name, shade and curve of each."""
    rows = silt.table(f"{folder}/tests.csv").rows
    seen = {"dense": 0, "loose": 0}
    for row in rows:
        name = "dense" if row[0] else "loose"
        shades = SHADES[name]
        shade = shades[min(seen[name], len(shades) - 1)]
        seen[name] += 1
        yield name, shade, row, silt.table(f"{folder}/{name}_{row[1]:g}kPa.csv").rows


def curves(folder):
    figure, ((ratio, line), (rise, rule)) = plt.subplots(2, 2, figsize=(11.5, 8), constrained_layout=True)
    found = list(tests(folder))
    for name, shade, row, curve in found:
        ratio.plot(curve[:, 0], curve[:, 1], color=shade, lw=1.5, label=f"{name}, {row[1]:g} kPa")
        rise.plot(curve[:, 0], curve[:, 2], color=shade, lw=1.5)
    ratio.set(ylabel="shear over normal stress", ylim=(0, None), title="Shear on the plane of the split")
    ratio.legend(frameon=False, ncol=2, fontsize=10, loc="lower right")
    rise.set(ylabel="rise of the lid [mm]", title="Dilatancy")
    for panel in (ratio, rise):
        panel.set(xlabel="displacement of the lower half [mm]", xlim=(0, None))

    table = np.array([row for _, _, row, _ in found])
    dense, loose = table[table[:, 0] == 1], table[table[:, 0] == 0]
    shown = (("dense, peak", dense, 2, SHADES["dense"][1], "o"),
             ("loose, peak", loose, 2, SHADES["loose"][1], "s"),
             ("residual, both", table, 4, "0.25", "^"))
    reach = np.array([0, 1.08 * table[:, [2, 4]].max()])
    for label, some, column, colour, mark in shown:
        slope, offset = np.polyfit(some[:, column], some[:, column + 1], 1)
        line.plot(some[:, column], some[:, column + 1], mark, color=colour, mfc="white", ms=7)
        line.plot(reach, offset + slope * reach, color=colour, lw=1.4, marker=mark, mfc="white", markevery=[],
                  label=f"{label}: {np.degrees(np.arctan(slope)):.1f}°, c = {offset:.1f} kPa")
    line.set(xlabel="normal stress on the plane [kPa]", ylabel="shear stress [kPa]", xlim=(0, reach[1]),
             ylim=(0, None), title="Mohr and Coulomb")
    line.legend(frameon=False, fontsize=10, loc="upper left")

    residual = np.polyfit(table[:, 4], table[:, 5], 1)[0]
    for name, shade, row, _ in found:
        rule.plot(row[6], row[3] / row[2], "o" if name == "dense" else "s", color=shade, ms=8)
    reach = np.array([min(0, table[:, 6].min() - 0.05), table[:, 6].max() + 0.08])
    rule.plot(reach, residual + reach, "k--", lw=1.2, label="Taylor: residual + dilatancy")
    rule.axhline(residual, color="0.6", lw=1, label="residual")
    rule.set(xlabel="dilatancy at the peak: rise over displacement",
             ylabel="shear over normal stress at the peak", xlim=reach, title="Strength from dilatancy")
    rule.legend(frameon=False, fontsize=10, loc="upper left")
    for panel in (ratio, line, rise, rule):
        panel.grid(True, color="0.9", lw=0.8)
        panel.set_axisbelow(True)
        panel.spines[["top", "right"]].set_visible(False)
    figure.suptitle("Direct shear test of spheres", fontsize=14)
    draw.save(figure, f"{folder}/shear_box.png")


def outline(L, split, travel, above):
    """The halves of the box from the front, and their flanges, as lines."""
    flange = 0.35 * travel
    lower = [[(-flange, 0), (travel, 0)], [(travel, 0), (travel, -split)],
             [(travel, -split), (travel + L, -split)], [(travel + L, -split), (travel + L, 0)]]
    upper = [[(0, 1.35 * above), (0, 0)], [(L, 1.35 * above), (L, 0)], [(L, 0), (L + travel + flange, 0)]]
    return np.array(lower), np.array(upper)


def box(folder, L, W, split, travel, above):
    axes = draw.view_axes("front")
    bounds = [-0.5 * travel, L + 1.5 * travel, -split * 1.06, 1.4 * above]
    height = 3.4
    width = height * (bounds[1] - bounds[0]) / (bounds[3] - bounds[2])
    figure, panels = plt.subplots(1, 2, figsize=(2 * width + 0.5, height + 1.2))
    figure.subplots_adjust(0.01, 0.2, 0.99, 0.92, 0.03)
    grains = draw.Bed(f"{folder}/end.vtp", "displacement", axes, draw.Cut(f"y={W / 2}", axes))
    lid = (grains.places[:, 1] + grains.radii).max()
    norm = Normalize(0, 1e3 * travel)
    canvas = Canvas(bounds, round(width * DPI))
    canvas.draw_spheres(grains.places, grains.radii, draw.COLOUR_MAP(norm(grains.values))[:, :3])
    panels[0].imshow(canvas.picture(), extent=bounds, aspect="equal", interpolation="none")
    panels[0].set_title("Grains, cut in the middle", fontsize=13)

    thirds = [draw.Cut(f"y>{W / 3}", axes), draw.Cut(f"y<{2 * W / 3}", axes)]
    lines, force = draw.pressing(silt.read(f"{folder}/contacts.vtp"), thirds)
    strong = np.quantile(force, 0.995)
    forces, chains = Normalize(0, strong), ListedColormap(plt.get_cmap("magma_r")(np.linspace(0.12, 0.9, 256)))
    share = np.minimum(force / strong, 1)
    panels[1].add_collection(LineCollection((lines @ axes.T)[:, :, :2], linewidths=0.15 + 2.6 * share,
                                            colors=chains(share), capstyle="round"))
    panels[1].set_title("Contact forces in the middle third", fontsize=13)
    lower, upper = outline(L, split, travel, above)
    for panel, scale, colours, label in ((panels[0], norm, draw.COLOUR_MAP, "displacement along the motion [mm]"),
                                         (panels[1], forces, chains, "normal force [N]")):
        panel.add_collection(LineCollection(lower, colors="black", linewidths=2))
        panel.add_collection(LineCollection(upper, colors="#B03A2E", linewidths=2))
        panel.plot([0, L], [lid, lid], color="0.45", lw=3)
        panel.set(xlim=bounds[:2], ylim=bounds[2:], aspect="equal")
        panel.set_axis_off()
        place = panel.get_position()
        bar = figure.colorbar(ScalarMappable(scale, colours), orientation="horizontal",
                              cax=figure.add_axes([place.x0 + 0.06, 0.14, place.width - 0.12, 0.03]))
        bar.set_label(label, fontsize=12)
        draw.tick_apart(bar, figure)
    draw.save(figure, f"{folder}/box.png")


if __name__ == "__main__":
    try:
        curves(sys.argv[1])
        box(sys.argv[1], *(float(n) for n in sys.argv[2:7]))
    except silt.Error as refusal:
        sys.exit(f"draw_shear_box.py: {refusal}")
