# silt - BSD-3-Clause, see LICENSE
"""`silt curves`: columns of tables over another column."""

from __future__ import annotations

import itertools
import os
import re

import numpy as np

from ..errors import Error
from ..names import find_start, split_unit
from ..tables import table
from .style import COLOURS, label_few_decades, plt, round_long, save


FEW = 15  # points that stand apart: as many have a mark each
PREFIXES = {"n": 1e-9, "\u00b5": 1e-6, "u": 1e-6, "m": 1e-3, "k": 1e3, "M": 1e6, "G": 1e9}


def factor_to(unit, words):
    """What numbers in `unit` are multiplied by where an axis is called `words`: 1000 from "m" to "size [mm]".
    1 where these have no unit, or one that differs by more than a prefix."""
    wanted = split_unit(words or "")[1]
    if (unit, wanted) == ("-", "%"):
        return 100.0
    for prefix, size in PREFIXES.items():
        if re.match(r"[A-Za-z]+(?![A-Za-z0-9^])", unit) and wanted == prefix + unit:  # of mm2 and m2 it is no factor
            return 1 / size
        if re.match(r"[A-Za-z]+(?![A-Za-z0-9^])", wanted) and unit == prefix + wanted:
            return size
    return 1.0


def file_words(files):
    """What files are called in a legend: their names, and where these are equal, their folders'."""
    names = [os.path.splitext(os.path.basename(path))[0].replace("_", " ") for path in files]
    if len(set(names)) == len(names):
        return names
    folders = [os.path.dirname(os.path.abspath(path)).split(os.sep) for path in files]
    while all(folder and folder[-1] == folders[0][-1] for folder in folders):
        folders = [folder[:-1] for folder in folders]
    named = [f"{folder[-1] if folder else ''}/{name}" for folder, name in zip(folders, names)]
    if len(set(names)) == 1:
        named = [folder[-1] if folder else "" for folder in folders]
    return named if len(set(named)) == len(files) else list(files)


class Columns:
    """The columns of one file that are drawn."""

    def __init__(self, path, options, label):
        read = table(path)
        self.path, self.label = path, label

        def find(words):
            names = [find_start(w, read.names, "column", path) for w in words.split(",")] if words else []
            for name in names:
                if read[name].dtype.kind not in "fiu":
                    raise Error(f"file '{path}': column '{name}' has words, no numbers")
            return names

        self.x_name, self.y_names, self.marks = find(options.x)[0], find(options.y), find(options.marks)
        self.columns = dict(read.columns)
        for name in {*self.y_names, *self.marks}:
            self.columns[name] = self.columns[name] * factor_to(split_unit(name)[1], options.y_label)
        self.x = read.columns[self.x_name] * factor_to(split_unit(self.x_name)[1], options.x_label)

    def are_few(self, log):
        """Whether few points stand apart along the x axis."""
        x = self.x[self.x > 0] if log else self.x
        x = np.log(x) if log else x
        x = x[np.isfinite(x)]
        if len(x) <= 25 or len(x) > 100:
            return len(x) <= 25
        return len(np.unique(np.round(60 * (x - x.min()) / (np.ptp(x) or 1)))) <= FEW

    def compare(self, first):
        for mine, of_first in zip([self.x_name, *self.y_names, *self.marks],
                                  [first.x_name, *first.y_names, *first.marks]):
            if mine != of_first:
                raise Error(f"file '{self.path}' has '{mine}' where file '{first.path}' has "
                              f"'{of_first}'; curves of one picture must have the same units")


def read_tables(options):
    labels = options.labels or file_words(options.files)
    if len(labels) != len(options.files):
        raise Error(f"there are {len(labels)} labels for {len(options.files)} files; give one a file")
    tables = [Columns(path, options, label) for path, label in zip(options.files, labels)]
    for other in tables[1:]:
        other.compare(tables[0])
    return tables


def draw_lines(panel, tables, names, colours, options):
    """The columns `names` of all tables. Returns the colours: one a column of a lone table; of several
    tables one a table, whose columns have styles of their own."""
    used = []
    for one in tables:
        for style, name in zip(itertools.cycle(("-", "--", ":", "-.")), names):
            if len(tables) == 1 or style == "-" and name == names[0]:
                used.append(next(colours))
            word = split_unit(name)[0]
            label = (word if len(tables) == 1 else
                     one.label if len(names) == 1 else f"{one.label}: {word}")
            panel.plot(one.x, one.columns[name], lw=1.8, color=used[-1], label=label, ms=4,
                       ls=style if len(tables) > 1 else "-",
                       marker="o" if one.are_few("x" in options.log) and not options.marks else None)
    return used


def draw_marks(panel, tables, unit, used, options):
    same_unit = [name for name in tables[0].marks if split_unit(name)[1] == unit]
    for k, one in enumerate(tables):
        for name, colour in zip(same_unit, itertools.cycle(used if len(tables) == 1 else [used[k]])):
            panel.plot(one.x, one.columns[name], "o", color=colour, mfc="white", ms=6)
    if same_unit:
        panel.plot([], [], "o", color="black", mfc="white", ms=6, label=options.marks_label)


def draw_references(panel, x, options):
    for style, words in zip(("--", ":", "-."), options.reference or []):
        label, _, numbers = words.rpartition(":")
        try:
            slope, offset = (float(n) for n in numbers.split(","))
        except ValueError:
            raise Error(f"--reference '{words}' must be label:slope,offset")
        limits = panel.get_ylim()
        panel.plot(x, slope * x + offset, style, color="black", lw=1.3, label=label)
        if slope != 0:  # such a line may leave the picture, the data and levels may not
            panel.set_ylim(limits)


def add_legend(panel, figure):
    """Inside, where it covers no curve; else above."""
    legend = panel.legend(fontsize=11, frameon=True, framealpha=0.9, edgecolor="none")
    figure.canvas.draw()
    box = legend.get_window_extent()
    for line in panel.lines:
        points = panel.transData.transform(line.get_xydata().astype(float))
        steps = np.linspace(0, 1, 20)[:, None, None]
        along = (points[None, :-1] + steps * (points[None, 1:] - points[None, :-1])).reshape(-1, 2)
        if len(along) and box.count_contains(along[np.isfinite(along).all(axis=1)]) > 0:
            panel.legend(fontsize=11, frameon=False, loc="lower left", bbox_to_anchor=(0, 1),
                         ncol=2, borderaxespad=0.2)
            return


def axis_title(words, unit):
    """The words, with the unit where they have none."""
    return words if "[" in words or not unit else f"{words} [{unit}]".strip()


def draw_curves(options):
    tables = read_tables(options)
    x_name, y_names = tables[0].x_name, tables[0].y_names
    units = list(dict.fromkeys(split_unit(name)[1] for name in y_names))
    figure, panels = plt.subplots(len(units), 1, sharex=True, squeeze=False,
                                  figsize=(7.5, 1.4 + 3.2 * len(units)), constrained_layout=True)
    colours = itertools.cycle(COLOURS)
    for panel, unit in zip(panels[:, 0], units):
        mine = [name for name in y_names if split_unit(name)[1] == unit]
        if "x" in options.log:
            panel.set_xscale("log")
        if "y" in options.log:
            panel.set_yscale("log")
        if len(tables) > 1:
            colours = itertools.cycle(COLOURS)  # of a file in all panels
        used = draw_lines(panel, tables, mine, colours, options)
        draw_marks(panel, tables, unit, used, options)
        if panel is panels[0, 0]:
            draw_references(panel, np.sort(np.concatenate([one.x for one in tables])), options)
        for axis, low_high in ((panel.xaxis, panel.get_xlim()), (panel.yaxis, panel.get_ylim())):
            if axis.get_scale() == "log":
                label_few_decades(axis, low_high)
        panel.set_ylabel(axis_title(options.y_label or (mine[0] if len(mine) == 1 else ""), unit), fontsize=12)
        panel.grid(True, color="0.88", lw=0.8)
        panel.set_axisbelow(True)
        panel.spines[["top", "right"]].set_visible(False)
        panel.tick_params(labelsize=11)
        panel.margins(x=0.01)
        if len(panel.lines) > 1:
            add_legend(panel, figure)
    panels[-1, 0].set_xlabel(axis_title(options.x_label or x_name, split_unit(x_name)[1]), fontsize=12)
    if options.title:
        figure.suptitle(round_long(options.title), fontsize=13)
    save(figure, options.out)
