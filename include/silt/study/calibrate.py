#!/usr/bin/env python3
# silt - BSD-3-Clause, see LICENSE
"""Draws a calibration: calibrate.py FOLDER makes FOLDER/calibration.png from what silt::Calibration
wrote there (calibration.json, calibration.csv, posterior.csv): chi^2 of the surrogates over pairs of
parameters with all runs, the credible region and the recommended values; targets beside what was
measured; sensitivities; chi^2 over the runs. Needs numpy and matplotlib."""

import csv
import json
import os
import sys

try:
    import matplotlib
    import numpy as np
except ModuleNotFoundError as absent:
    sys.exit(f"{sys.argv[0]}: {sys.executable} has no {absent.name}; install it (Debian: apt-get install "
             f"python3-{absent.name}, for /usr/bin/python3)")

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.lines import Line2D  # noqa: E402
from matplotlib.ticker import FuncFormatter, MaxNLocator  # noqa: E402

# Okabe and Ito's colours, which the colour-blind can tell apart.
COLOURS = ["#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#D55E00", "#F0E442", "#000000"]
BEST, REGION = "#D55E00", "#CC79A7"


def short(name):
    """Without the unit."""
    return name.split(" [")[0]


def read(folder):
    with open(os.path.join(folder, "calibration.json"), encoding="utf-8") as file:
        all_of_it = json.load(file)
    with open(os.path.join(folder, "calibration.csv"), encoding="utf-8", newline="") as file:
        runs = list(csv.DictReader(file))
    with open(os.path.join(folder, "posterior.csv"), encoding="utf-8", newline="") as file:
        rows = list(csv.reader(file))[1:]
    return all_of_it, runs, np.array(rows, float)


def to_axis(parameter, values):
    """Where linear steps are even ones of the calibration: logarithms for a logarithmic parameter."""
    return np.log10(values) if parameter["logarithmic"] else np.asarray(values, float)


def label(axis, parameter):
    if parameter["logarithmic"]:
        axis.set_major_formatter(FuncFormatter(lambda x, _: f"$10^{{{x:g}}}$"))
        axis.set_major_locator(MaxNLocator(5, integer=True))
    else:
        axis.set_major_locator(MaxNLocator(5))
    axis.set_label_text(parameter["name"], fontsize=10)


def region_levels(x, y, share, limits):
    """A smoothed histogram of points and the level that encloses this share of them."""
    bins = 60
    counts, xe, ye = np.histogram2d(x, y, bins=bins, range=limits)
    for axis, (values, (low, high)) in enumerate(zip((x, y), limits)):
        # Silverman's width as of 400 independent points, in bins; sides do not lose what lies beyond them.
        spread = max(0.8, 400 ** (-1 / 6) * np.std(values) / (high - low) * bins)
        kernel = np.exp(-0.5 * (np.arange(-bins // 2 + 1, bins // 2) / spread) ** 2)
        whole = np.convolve(np.ones(bins), kernel, "same")
        counts = np.apply_along_axis(lambda line: np.convolve(line, kernel, "same") / whole, axis, counts)
    order = np.sort(counts.ravel())[::-1]
    place = np.searchsorted(np.cumsum(order), share * order.sum())
    middle = [0.5 * (edges[1:] + edges[:-1]) for edges in (xe, ye)]
    return middle[0], middle[1], counts.T, order[min(place, len(order) - 1)]


def draw_pair(panel, result, runs, sample, surface):
    a, b = (result["parameters"][surface[k]] for k in ("first", "second"))
    x, y = to_axis(a, surface["x"]), to_axis(b, surface["y"])
    chi2 = np.array(surface["chi2"]).reshape(len(x), len(y)).T
    shown = np.log10(np.maximum(chi2, 1e-2))
    low = max(np.floor(shown.min() * 2) / 2, -1)
    levels = np.linspace(low, max(np.ceil(shown.max() * 2) / 2, low + 0.5), 16)
    filled = panel.contourf(x, y, np.clip(shown, levels[0], levels[-1]), levels, cmap="Blues_r", alpha=0.9)
    px, py = to_axis(a, sample[:, surface["first"]]), to_axis(b, sample[:, surface["second"]])
    gx, gy, density, level = region_levels(px, py, result["credible"], [(x[0], x[-1]), (y[0], y[-1])])
    if density.max() > level > 0:
        panel.contour(gx, gy, density, [level], colors=REGION, linewidths=2)
    at = {"good": [], "failed": []}
    for run in runs:
        at["failed" if run["failure"] else "good"].append((float(run[a["name"]]), float(run[b["name"]])))
    for kind, marker in (("good", dict(marker="o", s=14, facecolor="white", edgecolor="0.2", linewidth=0.8)),
                         ("failed", dict(marker="x", s=26, color="0.1", linewidth=1.2))):
        if at[kind]:
            points = np.array(at[kind])
            panel.scatter(to_axis(a, points[:, 0]), to_axis(b, points[:, 1]), zorder=3, **marker)
    panel.plot(to_axis(a, a["recommended"]), to_axis(b, b["recommended"]), "o", ms=12, mfc="none", mec=BEST,
               mew=2.2, zorder=4, clip_on=False)
    panel.set(xlim=(x[0], x[-1]), ylim=(y[0], y[-1]))
    label(panel.xaxis, a)
    label(panel.yaxis, b)
    bar = panel.figure.colorbar(filled, ax=panel, pad=0.02)
    bar.set_ticks([t for t in range(-3, 20) if levels[0] <= t <= levels[-1]])
    bar.ax.yaxis.set_major_formatter(FuncFormatter(lambda v, _: f"{10.0 ** v:g}"))
    bar.ax.set_title("χ²", fontsize=10)


def draw_line(panel, result, runs, sample, surface):
    """One parameter: chi^2 over it."""
    a = result["parameters"][0]
    panel.plot(to_axis(a, surface["x"]), surface["chi2"], color=COLOURS[0], lw=1.6, label="surrogate")
    good = [run for run in runs if not run["failure"]]
    panel.plot(to_axis(a, [float(r[a["name"]]) for r in good]), [float(r["chi2 [-]"]) for r in good], "o", ms=4,
               mfc="white", mec="0.2")
    panel.axvspan(to_axis(a, a["low"]), to_axis(a, a["high"]), color=REGION, alpha=0.25)
    panel.axvline(to_axis(a, a["recommended"]), color=BEST, lw=1.8)
    panel.set_yscale("log")
    panel.set_ylim(bottom=1e-2)
    panel.set_ylabel("χ² [-]")
    label(panel.xaxis, a)


def draw_targets(panel, result):
    targets = result["targets"]
    for k, t in enumerate(targets):
        height = len(targets) - 1 - k
        predicted, confirmed = ((v - t["measured"]) / t["error"] if v is not None else None
                                for v in (t["predicted"], t["confirmed"]))
        panel.errorbar(predicted, height + 0.08, xerr=t["deviation"] / t["error"], fmt="s", ms=5, color=COLOURS[0],
                       capsize=3)
        if confirmed is not None:
            panel.plot(confirmed, height - 0.12, "o", ms=6, mfc="white", mec=BEST, mew=1.8)
    panel.axvspan(-1, 1, color="0.9", zorder=0)
    panel.axvline(0, color="0.6", lw=1, zorder=0)
    reach = 1.15 * max(abs(limit) for limit in panel.get_xlim())
    panel.set(xlim=(-max(reach, 2.2), max(reach, 2.2)), ylim=(-0.7, len(targets) - 0.3),
              xlabel="(computed − measured) / error [-]")
    panel.set_yticks(range(len(targets)), [f"{short(t['name'])}\n{t['measured']:.4g} ± {t['error']:g}"
                                           for t in targets[::-1]], fontsize=9)
    panel.set_title("Targets at the recommended values", fontsize=11)
    panel.legend(handles=[Line2D([], [], color=COLOURS[0], marker="s", ms=5, lw=1.5, label="surrogate"),
                          Line2D([], [], color=BEST, marker="o", mfc="white", mew=1.8, ms=6, lw=0, label="run"),
                          ], frameon=False, fontsize=9, loc="upper center", bbox_to_anchor=(0.5, -0.17), ncol=2)


def draw_sensitivities(panel, result):
    parameters, targets = result["parameters"], result["targets"]
    height = 0.8 / len(parameters)
    for k, p in enumerate(parameters):
        at = [len(targets) - 1 - t + 0.4 - (k + 0.5) * height for t in range(len(targets))]
        panel.barh(at, [t["total"][k] for t in targets], 0.9 * height, color=COLOURS[k % 8], alpha=0.4)
        panel.barh(at, [t["first"][k] for t in targets], 0.9 * height, color=COLOURS[k % 8], label=short(p["name"]))
    panel.set_yticks(range(len(targets)), [short(t["name"]) for t in targets[::-1]], fontsize=9)
    panel.set(xlim=(0, 1.02), xlabel="Sobol' index: first order dark, total light [-]")
    panel.set_title("Sensitivities", fontsize=11)
    panel.legend(frameon=False, fontsize=9, loc="upper center", bbox_to_anchor=(0.5, -0.17),
                 ncol=min(4, len(parameters)))


def draw_progress(panel, runs):
    good = [(k + 1, float(r["chi2 [-]"]), r["kind"]) for k, r in enumerate(runs) if not r["failure"]]
    kinds = {"design": COLOURS[4], "filling": COLOURS[3], "proposal": COLOURS[0], "confirmation": BEST}
    for kind, colour in kinds.items():
        mine = [(k, c) for k, c, of in good if of == kind]
        if mine:
            panel.plot(*zip(*mine), "o", ms=4.5, color=colour, label=kind)
    panel.plot([k for k, _, _ in good], np.minimum.accumulate([c for _, c, _ in good]), color="0.5", lw=1.2,
               drawstyle="steps-post", zorder=0)
    panel.set(yscale="log", xlabel="run [-]", ylabel="χ² of the run [-]")
    panel.xaxis.set_major_locator(MaxNLocator(6, integer=True))
    panel.set_title("Progress", fontsize=11)
    panel.legend(frameon=False, fontsize=9, loc="upper center", bbox_to_anchor=(0.5, -0.17), ncol=4,
                 handletextpad=0.1, columnspacing=1)


def draw(folder):
    result, runs, sample = read(folder)
    surfaces = result["surfaces"]
    columns = min(3, max(1, len(surfaces)))
    rows = -(-len(surfaces) // columns)
    figure = plt.figure(figsize=(15.5, 4.9 * rows + 0.42 * len(result["targets"]) + 3.6), dpi=100,
                        constrained_layout=True)
    upper, lower = figure.subfigures(2, 1, height_ratios=[4.9 * rows, 0.42 * len(result["targets"]) + 3.2])
    if columns == 1:  # a single panel, not drawn out over the page
        panels = [upper.add_subplot(1, 2, 1)]
        notes = upper.add_subplot(1, 2, 2)
        notes.set_axis_off()
        write_values(notes, result)
    else:
        panels = upper.subplots(rows, columns, squeeze=False).ravel()
        for panel in panels[len(surfaces):]:
            panel.set_axis_off()
        if len(panels) > len(surfaces):
            write_values(panels[-1], result)
    for panel, surface in zip(panels, surfaces):
        (draw_pair if surface["y"] else draw_line)(panel, result, runs, sample, surface)
    share = f"{100 * result['credible']:g} %"
    handles = [Line2D([], [], marker="o", mfc="none", mec=BEST, mew=2.2, ms=10, lw=0, label="recommended"),
               Line2D([], [], color=REGION, lw=2, label=f"credible region, {share}"),
               Line2D([], [], marker="o", mfc="white", mec="0.2", ms=4, lw=0, label="runs")]
    if result["failures"]:
        handles.append(Line2D([], [], marker="x", color="0.1", ms=5, lw=0, label="failed runs"))
    upper.legend(handles=handles, loc="upper center", ncol=4, frameon=False, fontsize=10,
                 bbox_to_anchor=(0.5, 1.0))
    upper.suptitle(" ", fontsize=14)
    below = lower.subplots(1, 3)
    draw_targets(below[0], result)
    draw_sensitivities(below[1], result)
    draw_progress(below[2], runs)
    for panel in below:
        panel.grid(True, axis="x", color="0.9", lw=0.8)
        panel.set_axisbelow(True)
        panel.spines[["top", "right"]].set_visible(False)
    path = os.path.join(folder, "calibration.png")
    figure.savefig(path + ".partial", format="png", facecolor="white")
    os.replace(path + ".partial", path)


def write_values(panel, result):
    """The recommended values as text, where a panel is free."""
    share = f"{100 * result['credible']:g} %"
    lines = [f"{p['name']}: {p['recommended']:.4g}\n    {share}: {p['low']:.4g} to {p['high']:.4g}"
             for p in result["parameters"]]
    lines.append(f"χ² = {result['chi2']:.3g} of {len(result['targets'])} targets, {result['runs']} runs")
    panel.text(0.04, 0.95, "\n\n".join(lines), va="top", fontsize=12, transform=panel.transAxes, linespacing=1.4)


def main():
    if len(sys.argv) != 2:
        sys.stderr.write(__doc__ + "\n")
        return 2
    try:
        draw(sys.argv[1])
    except (OSError, ValueError, KeyError) as error:
        sys.stderr.write(f"calibrate.py: {sys.argv[1]}: {error}\n")
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
