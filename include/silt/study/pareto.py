#!/usr/bin/env python3
# silt - BSD-3-Clause, see LICENSE
"""Draws a study: pareto.py FOLDER makes FOLDER/pareto.png from the summary.json that silt::Study
wrote there: for each error a panel, error over cost, with the Pareto front, the accepted error and
the recommended variant. Needs matplotlib."""

import json
import math
import os
import sys

try:
    import matplotlib
except ModuleNotFoundError:
    sys.exit(f"{sys.argv[0]}: {sys.executable} has no matplotlib; install it (Debian: apt-get install "
             "python3-matplotlib, for /usr/bin/python3)")

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter, NullLocator  # noqa: E402

# Okabe and Ito's colours, which the colour-blind can tell apart.
FRONT, OTHER, BEST, BOUND = "#0072B2", "#888888", "#D55E00", "#009E73"
MOST_PANELS = 6


def cost_scale(costs):
    """A unit in which the least cost is at least 1."""
    for seconds, name in ((1, "s"), (1e-3, "ms")):
        if min(costs) >= seconds:
            return seconds, name
    return 1e-6, "us"


def log_limits(values, margin):
    low, high = math.log(min(values)), math.log(max(values))
    room = margin * max(high - low, 0.7)
    return math.exp(low - room), math.exp(high + room)


def log_axis(axis, limits):
    """Ticks at 1, 2, 5 over few decades, else at powers of ten; written as plain numbers."""
    decades = math.log10(limits[1] / limits[0])
    few = decades < 2.5
    axis.set_major_locator(LogLocator(10, subs=(1, 2, 5) if few else (1,), numticks=9))
    axis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
    axis.set_minor_formatter(NullFormatter())
    if few:
        axis.set_minor_locator(NullLocator())


def place_labels(figure, axes, points, names, best_name, lines):
    """Writes each name beside its point where it covers no other name, point or line, as far as
    there is room; the points with the most neighbours are placed first."""
    figure.canvas.draw()
    renderer = figure.canvas.get_renderer()
    pixels = axes.transData.transform(points)
    frame = axes.get_window_extent(renderer)
    radius = [12 if name == best_name else 5 for name in names]
    taken = [(x - r, y - r, x + r, y + r) for (x, y), r in zip(pixels, radius)]
    line_points = []
    for line in lines:
        ends = axes.transData.transform(line)
        for (xa, ya), (xb, yb) in zip(ends[:-1], ends[1:]):
            n = max(2, int(math.hypot(xb - xa, yb - ya) / 6))
            line_points += [(xa + (xb - xa) * k / n, ya + (yb - ya) * k / n) for k in range(n + 1)]

    def crowd(k):
        return sum(math.hypot(*(pixels[k] - other)) < 60 for other in pixels)

    for k in sorted(range(len(names)), key=crowd, reverse=True):
        label = axes.annotate(names[k], points[k], (0, 0), textcoords="offset points", fontsize=9,
                              color="0.2", annotation_clip=False)
        box = label.get_window_extent(renderer)
        width, height = box.width, box.height
        best = None
        for distance in (radius[k] + gap for gap in (5, 12, 24, 38, 54)):
            for turn in range(16):
                angle = turn * math.pi / 8 + math.pi / 4
                x = pixels[k][0] + distance * math.cos(angle)
                y = pixels[k][1] + distance * math.sin(angle)
                left = x - width * (1 - math.cos(angle)) / 2
                low = y - height * (1 - math.sin(angle)) / 2
                place = (left, low, left + width, low + height)
                cost = 0.4 * distance + 0.02 * turn
                for a in taken:
                    cost += 40 * max(0, min(place[2], a[2]) - max(place[0], a[0])) \
                        * max(0, min(place[3], a[3]) - max(place[1], a[1])) / height ** 2
                cost += sum(4 for px, py in line_points
                            if place[0] - 2 < px < place[2] + 2 and place[1] < py < place[3])
                inside = (frame.x0 + 2 < place[0] and place[2] < frame.x1 - 2
                          and frame.y0 + 2 < place[1] and place[3] < frame.y1 - 2)
                cost += 0 if inside else 1000
                if best is None or cost < best[0]:
                    best = cost, place, distance
        _, place, distance = best
        taken.append(place)
        label.xyann = ((place[0] - pixels[k][0]) * 72 / figure.dpi,
                       (place[1] - pixels[k][1]) * 72 / figure.dpi)
        if distance > radius[k] + 12:
            end = axes.transData.inverted().transform(
                (min(max(pixels[k][0], place[0]), place[2]),
                 min(max(pixels[k][1], place[1]), place[3])))
            axes.plot([points[k][0], end[0]], [points[k][1], end[1]], color="0.7", lw=0.7, zorder=1)


def draw_panel(figure, axes, study, error, scale):
    results = study["results"]
    ran = [v for v in results["variants"] if "failure" not in v]
    errors = [v["errors"][error] for v in ran]
    positive = [e for e in errors if e > 0]
    floor = min(positive) / 10 if positive else 1e-16
    shown = {v["name"]: (v["cost_s"] / scale[0], max(e, floor)) for v, e in zip(ran, errors)}
    low = [v["cheapest_round_s"] / scale[0] for v in ran]
    high = [v["dearest_round_s"] / scale[0] for v in ran]
    bound = study["inputs"]["accepted"].get(error)
    front = results["fronts"][error]
    best = results["recommended"]

    axes.set_xscale("log")
    axes.set_yscale("log")
    heights = [y for _, y in shown.values()] + ([bound] if bound else [])
    axes.set_xlim(log_limits(low + high, 0.15))
    axes.set_ylim(log_limits(heights, 0.15))
    log_axis(axes.xaxis, axes.get_xlim())
    log_axis(axes.yaxis, axes.get_ylim())
    if 0 in errors:  # no place on a logarithmic axis
        limits = axes.get_ylim()
        ticks = [t for t in axes.get_yticks() if 2 * floor < t < limits[1]]
        axes.set_yticks([floor] + ticks, ["0"] + [f"{t:g}" for t in ticks])
        axes.yaxis.set_minor_locator(NullLocator())
        axes.set_ylim(limits)
    bars = [[(a, y), (b, y)] for (_, y), a, b in zip(shown.values(), low, high)]
    for bar in bars:
        axes.plot(*zip(*bar), color="0.75", lw=2, zorder=1, solid_capstyle="butt")
    line = [shown[name] for name in front]
    if line:
        axes.plot(*zip(*line), color=FRONT, lw=1.5, zorder=2, label="Pareto front")
    controls = {v["name"] for v in ran if v.get("control")}
    for name, (x, y) in shown.items():
        if name in controls:
            axes.plot(x, y, "s", ms=6, mfc="white", mec=OTHER, zorder=3, label="control")
        else:
            axes.plot(x, y, "o", ms=6, color=FRONT if name in front else OTHER, zorder=3)
    if best:
        axes.plot(*shown[best], "o", ms=14, mfc="none", mec=BEST, mew=2, zorder=4,
                  label="recommended")
    if bound:
        axes.axhline(bound, color=BOUND, ls="--", lw=1.3, zorder=0, label=f"accepted: {bound:g}")
    axes.set_xlabel(f"cost: {study['inputs']['clock']} [{scale[1]}]", fontsize=11)
    axes.set_ylabel(f"{error} [{results['units'][error]}]", fontsize=11)
    axes.grid(True, color="0.9", lw=0.8)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(labelsize=10)
    place_labels(figure, axes, list(shown.values()), list(shown), best,
                 ([line] if line else []) + bars)


def draw(folder):
    with open(os.path.join(folder, "summary.json"), encoding="utf-8") as file:
        study = json.load(file)
    results = study["results"]
    ran = [v for v in results["variants"] if "failure" not in v]
    errors = list(results["units"])[:MOST_PANELS]
    scale = cost_scale([v["cost_s"] for v in ran])
    columns = min(len(errors), 2 if len(errors) in (2, 4) else 3)
    rows = -(-len(errors) // columns)
    width, height = (7.2 if columns == 1 else 5.2 * columns), 4.2 * rows + 1.1  # [in]
    figure, all_axes = plt.subplots(rows, columns, squeeze=False, dpi=110, figsize=(width, height))
    figure.subplots_adjust(left=0.85 / width, right=1 - 0.2 / width, bottom=0.95 / height,
                           top=1 - 0.65 / height, wspace=0.28, hspace=0.28)
    failed = [v["name"] for v in results["variants"] if "failure" in v]
    title = study["study"] + (f"\nfailed: {', '.join(failed)}" if failed else "")
    figure.suptitle(title, fontsize=12)
    for axes in list(all_axes.flat)[len(errors):]:
        axes.set_axis_off()
    panels = list(zip(all_axes.flat, errors))
    handles = {}
    for axes, error in panels:
        draw_panel(figure, axes, study, error, scale)
        for handle, label in zip(*axes.get_legend_handles_labels()):
            handles.setdefault(label.partition(":")[0], (handle, label.partition(":")[0]))
    figure.legend(*zip(*handles.values()), loc="lower center", ncol=len(handles), frameon=False,
                  fontsize=10)
    path = os.path.join(folder, "pareto.png")
    figure.savefig(path + ".partial", format="png", facecolor="white")
    os.replace(path + ".partial", path)


def main():
    if len(sys.argv) != 2:
        sys.stderr.write(__doc__ + "\n")
        return 2
    try:
        draw(sys.argv[1])
    except (OSError, ValueError, KeyError) as error:
        sys.stderr.write(f"pareto.py: {sys.argv[1]}: {error}\n")
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
