# silt - BSD-3-Clause, see LICENSE
"""Colours, sheets of panels, colour bars, captions: what all pictures have in common."""

from __future__ import annotations

import math
import os
import re
from typing import Optional, Sequence

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.cm import ScalarMappable  # noqa: E402
from matplotlib.colors import Colormap, ListedColormap, Normalize, to_rgb  # noqa: E402
from matplotlib.lines import Line2D  # noqa: E402
from matplotlib.ticker import (FuncFormatter, LogLocator, MaxNLocator, NullLocator,  # noqa: E402
                               ScalarFormatter)

# Numbers at axes and colour bars as they are: 293.1 and 293.2, not 0.1 and 0.2 beside "+2.93e2".
matplotlib.rcParams["axes.formatter.useoffset"] = False

from ..errors import Error  # noqa: E402
from ..names import split_unit  # noqa: E402
from ..series import step_in, time_in_list  # noqa: E402

# Okabe and Ito's colours, which the colour-blind can tell apart.
COLOURS = ["#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#D55E00", "#F0E442", "#555555"]
PLAIN = "#C9A66B"  # bodies without a field
LIQUID = "#7FB2D9"  # points without a radius and a field


def _part(name: str, low: float, high: float) -> ListedColormap:
    return ListedColormap(plt.get_cmap(name)(np.linspace(low, high, 256)), f"part of {name}")


# Without viridis's darkest end, which would hide the shading. All but rainbows are safe for the
# colour-blind.
COLOUR_MAP = _part("viridis", 0.14, 1)
COLOUR_MAPS = {"viridis": COLOUR_MAP, "cividis": plt.get_cmap("cividis"), "magma": _part("magma", 0.12, 1),
               "signed": _part("RdBu_r", 0.06, 0.94), "grey": _part("Greys", 0.2, 0.95)}  # fmt: skip
CHAINS = _part("magma_r", 0.12, 0.9)
DPI = 150
FEW = 200  # values: of fewer, one may be the 99th percentile


def round_long(words: str) -> str:
    """Words in which numbers of many digits have four: '0.10000000000000009 s' -> '0.1 s'."""
    return re.sub(r"\d+\.\d{5,}(?:[eE][-+]?\d+)?", lambda n: f"{float(n[0]):.4g}", words)


def spell_times(times: Sequence[float]) -> list[str]:
    """Times [s] in words, with as few digits as tell them apart and are right to 0.5 %."""
    largest = max(map(abs, times), default=0)
    unit, scale = next(((u, s) for u, s, least in (("s", 1, 0.1), ("ms", 1e3, 1e-4))
                        if largest >= least), ("\u00b5s", 1e6))
    if largest == 0:
        unit, scale = "s", 1
    for decimals in range(10):
        rounded = [round(t * scale, decimals) for t in times]
        if (len(set(rounded)) == len(set(times)) and
                all(abs(r - t * scale) <= 0.005 * abs(t * scale) for r, t in zip(rounded, times))
                and (decimals >= 1 or largest * scale >= 10)):
            break
    return [f"{r:.{decimals}f} {unit}" for r in rounded]


def captions(titles: Optional[Sequence[str]], files: Sequence[str],
             times: Optional[Sequence[Optional[float]]] = None) -> list[str]:
    """The titles, or: the times [s] of files of a series; else the steps in their names; else, of several
    files, their names in words."""
    if titles:
        if len(titles) != len(files):
            raise Error(f"there are {len(titles)} titles for {len(files)} files; give one a file")
        return [round_long(title) for title in titles]
    if times is None:
        times = [time_in_list(path) for path in files]
    known = [time for time in times if time is not None and math.isfinite(time)]
    if len(known) == len(files):
        return spell_times(known)
    steps = [step_in(path) for path in files]
    if None not in steps:
        return [f"step {step}" for step in steps]
    names = [os.path.splitext(os.path.basename(path))[0] for path in files]
    return [name.replace("_", " ") for name in names] if len(files) > 1 else [""]


def save(figure, path: str, dpi: int = DPI) -> None:
    """Writes a picture in the format of its ending (png without one); it is whole or not there."""
    ending = os.path.splitext(path)[1].lower().lstrip(".") or "png"
    formats = sorted(figure.canvas.get_supported_filetypes())
    if ending not in formats:
        raise Error(f"file '{path}' cannot be written: pictures have the endings {', '.join(formats)}")
    if os.path.exists(path) and not os.path.isfile(path):
        raise Error(f"file '{path}' cannot be written: it is a folder, a device or a pipe; name a file")
    partial = path + ".partial"
    try:
        figure.savefig(partial, format=ending, dpi=dpi, facecolor="white")
        os.replace(partial, path)
        plt.close(figure)
    except OSError as error:
        if os.path.exists(partial):
            os.remove(partial)
        raise Error(f"file '{path}' cannot be written: {error.strerror}")


def usual(finite: np.ndarray) -> tuple[float, float]:
    """The ends of a colour bar: the extremes; in place of one that is farther than 3 times the range of
    the 1st to 99th percentile beyond these, the percentile."""
    if len(finite) == 0:
        return 0, 1
    low, high = float(finite.min()), float(finite.max())
    if len(finite) < FEW:
        return low, high
    first, last = float(np.quantile(finite, 0.01)), float(np.quantile(finite, 0.99))
    far = 3 * (last - first)
    if far <= 0:
        return low, high
    return (first if first - low > far else low), (last if high - last > far else high)


class ColourScale:
    """Colours of values: one for each of a few whole numbers, else a continuous map."""

    def __init__(self, values: np.ndarray, label: str, limits: Optional[Sequence[float]] = None,
                 names: Optional[Sequence[str]] = None, colour_map: Colormap = COLOUR_MAP) -> None:
        self.label, self.map, self.names = label, colour_map, names
        finite = values[np.isfinite(values)] if len(values) else np.zeros(1)
        self.whole = len(finite) > 0 and bool((finite == np.round(finite)).all())
        self.kinds = None
        # Doubles with a unit are measured, not counted: 300 K and 310 K are ends of a bar.
        counted = np.issubdtype(values.dtype, np.integer) or names is not None or not split_unit(label)[1]
        if label and self.whole and counted and limits is None and len(values) > 0:
            kinds = np.unique(finite)
            self.kinds = kinds if len(kinds) <= len(COLOURS) else None
        if names is not None and len(values) > 0:
            self._check_names(names, finite, limits)
        low, high = limits or usual(finite)
        if limits is None and colour_map is COLOUR_MAPS["signed"]:  # 0 is its pale middle
            low, high = -max(abs(low), abs(high)), max(abs(low), abs(high))
        self.norm = Normalize(low, high if high > low else low + (abs(low) or 1))
        below, above = bool((finite < low).any()), bool((finite > high).any())
        self.extend = {(0, 0): "neither", (1, 0): "min", (0, 1): "max",
                       (1, 1): "both"}[below, above]

    def _check_names(self, names: Sequence[str], finite: np.ndarray, limits: Optional[Sequence[float]]) -> None:
        kinds = self.kinds
        if kinds is not None and kinds.min() >= 0 and kinds.max() < len(names):
            return
        odd = finite[finite != np.round(finite)]
        field = f"'{split_unit(self.label)[0]}'"
        raise Error("--names gives words for the whole numbers 0, 1, ... of the field of "
                    f"--colour, at most {len(COLOURS)}: " + (
                        "there is no --colour" if not self.label else
                        f"there are {len(names)} words, and {field} has the values {', '.join(f'{k:g}' for k in kinds)}"
                        if kinds is not None else
                        "--range makes it a colour bar, leave it out" if limits is not None else
                        f"{field} has the value {odd[0]:g}" if len(odd) else
                        f"{field} has {len(np.unique(finite))} values"))

    def colours(self, values):
        if not self.label:
            return np.tile(to_rgb(PLAIN), (len(values), 1))
        if self.kinds is not None:
            table = np.array([to_rgb(c) for c in COLOURS])
            known = np.isfinite(values)
            place = np.searchsorted(self.kinds, np.where(known, values, self.kinds[0]))
            return np.where(known[:, None], table[place], 0.8)
        return self.map(self.norm(values))[:, :3]

    def add_to(self, figure, box):
        """Puts the legend or the colour bar into `box` (left, bottom, width, height)."""
        axes = figure.add_axes(box)
        if self.kinds is not None:
            axes.set_axis_off()
            word = split_unit(self.label)[0]
            words = [self.names[int(kind)] if self.names else f"{kind:g}" for kind in self.kinds]
            marks = [Line2D([], [], ls="", marker="o", ms=9, color=COLOURS[k], label=words[k])
                     for k in range(len(self.kinds))]
            for columns in range(len(marks), 0, -1):  # as many side by side as there is room for
                legend = axes.legend(handles=marks, title=word if self.names is None else None,
                                     loc="center", ncol=columns, frameon=False, fontsize=11,
                                     title_fontsize=11, handletextpad=0.2, columnspacing=1.2)
                figure.canvas.draw()
                half = min(figure.bbox.x1 - axes.bbox.x0 - axes.bbox.width / 2,
                           axes.bbox.width / 2 + 0.1 * figure.dpi)
                if legend.get_window_extent().width <= 2 * half:
                    break
        else:
            axes.remove()
            add_bar(figure, self.norm, self.map, self.label, box, self.extend, self.whole)


def add_bar(figure, norm, colours, label, box, extend="neither", whole=False):
    """A horizontal colour bar in `box`, or to the right of it and shorter where what stands there
    already (the scale bar) would run into its numbers. With `whole` numbers at whole values alone."""
    bar = figure.colorbar(ScalarMappable(norm, colours), cax=figure.add_axes(box),
                          orientation="horizontal", extend=extend)
    bar.formatter = ScalarFormatter(useOffset=False)
    bar.set_label(label, fontsize=11)
    bar.ax.tick_params(labelsize=10)
    bar.outline.set_linewidth(0.5)
    others = [axes for axes in figure.axes if axes is not bar.ax]
    for _ in range(20):
        tick_apart(bar, figure, whole)
        # A common factor stands at the label, not under the last number where the label may be.
        factor = bar.ax.xaxis.get_offset_text()
        if factor.get_text():
            word, unit = split_unit(label)
            bar.set_label(f"{word} [{factor.get_text()} {unit}]".replace(" ]", "]"), fontsize=11)
            factor.set_visible(False)
            figure.canvas.draw()
        mine = bar.ax.get_tightbbox(figure.canvas.get_renderer())
        beside = [axes.get_tightbbox(figure.canvas.get_renderer()) for axes in others]
        beyond = max([b.x1 - mine.x0 for b in beside if b is not None and b.overlaps(mine)], default=0)
        over = mine.x1 - figure.bbox.x1
        left, bottom, width, height = bar.ax.get_position().bounds
        if beyond <= 0 and over <= 0 or width < 0.1:
            return bar
        shift = (beyond + 4) / figure.bbox.width if beyond > 0 else 0
        cut = shift + ((over + 4) / figure.bbox.width if over > 0 else 0)
        bar.ax.set_position([left + shift, bottom, max(width - cut, 0.09), height])
    return bar


def tick_apart(bar, figure, whole=False):
    """As many numbers at a horizontal colour bar as leave a gap between each other; whole ones."""
    for most in (8, 6, 5, 4, 3, 2):
        bar.locator = MaxNLocator(most, integer=whole)
        bar.update_ticks()
        figure.canvas.draw()
        boxes = [label.get_window_extent() for label in bar.ax.get_xticklabels() if label.get_text()]
        gap = 0.5 * max((box.height for box in boxes), default=0)
        if all(a.x1 + gap < b.x0 for a, b in zip(boxes, boxes[1:])):
            return


def parse_numbers(option: str, words: str, count: int) -> list[float]:
    try:
        numbers = [float(word) for word in words.split(",")]
    except ValueError:
        numbers = []
    rising = all(a < b for a, b in zip(numbers[::2], numbers[1::2]))
    if len(numbers) != count or not rising or not all(map(math.isfinite, numbers)):
        raise Error(f"{option} '{words}' must be {count} numbers with commas between, the lower "
                      "one of each pair first")
    return numbers


class Sheet:
    """Where panels, captions, colour bars and scale bar stand, in inches."""

    SIDE, BELOW, GAP = 0.25, 0.80, 0.25

    def __init__(self, titles: Sequence[str], aspect: float, bars: int = 1) -> None:
        panels, best = len(titles), None
        self.caption = 0.56 if any(titles) else 0.15  # a caption has up to two lines
        for columns in range(1, panels + 1):  # the arrangement with the largest panels
            rows = math.ceil(panels / columns)
            width = min((13 - 2 * self.SIDE + self.GAP) / columns - self.GAP,
                        ((8.5 - self.BELOW) / rows - self.caption) * aspect, 7)
            if best is None or width > best[0] * 1.001:
                best = (width, columns, rows)
        self.panel_width, self.columns, self.rows = best
        self.panel_height = self.panel_width / aspect
        used = self.columns * (self.panel_width + self.GAP) - self.GAP
        self.width = max(used, 4.5 + 2.6 * max(bars - 1, 0)) + 2 * self.SIDE
        self.left = (self.width - used) / 2
        self.height = self.rows * (self.panel_height + self.caption) + self.BELOW

    def panel(self, k: int) -> list[float]:
        row, column = divmod(k, self.columns)
        x = self.left + column * (self.panel_width + self.GAP)
        y = self.height - (row + 1) * (self.panel_height + self.caption)
        return self.box(x, y, self.panel_width, self.panel_height)

    def bar(self, k: int, bars: int, is_legend: bool = False) -> list[float]:
        """Of a colour bar or a legend; a lone one stands in the middle where there is room."""
        room = self.width - 2.6
        width = min(4.0, room / bars - 0.4 * (bars > 1))
        left = max((self.width - width) / 2, 2.2) if bars == 1 else 2.2 + k * room / bars
        return self.box(left, 0.05 if is_legend else 0.50, width, 0.70 if is_legend else 0.14)

    def box(self, x: float, y: float, width: float, height: float) -> list[float]:
        return [x / self.width, y / self.height, width / self.width, height / self.height]


def draw_scale_bar(figure, sheet, span):
    """A bar of 1, 2 or 5 times a power of ten in mm, about a quarter of a panel."""
    most = 1e3 * span * min(1, 1.6 / sheet.panel_width)  # [mm]
    power = 10 ** math.floor(math.log10(most))
    length = max(n * power for n in (1, 2, 5) if n * power <= most)
    inches = length * 1e-3 / span * sheet.panel_width
    axes = figure.add_axes(sheet.box(sheet.SIDE + 0.1, 0.30, inches, 0.10))
    axes.set_axis_off()
    axes.set(xlim=(0, 1), ylim=(-1, 1))
    axes.plot([0, 0, 0, 1, 1, 1], [-1, 1, 0, 0, -1, 1], color="black", lw=1.4, clip_on=False)
    axes.annotate(f"{length:g} mm", (0.5, 1), (0, 3), textcoords="offset points", ha="center",
                  fontsize=11)


def label_few_decades(axis, limits):
    """Over few decades: ticks at 1, 2, 5, written as plain numbers."""
    if limits[1] < 300 * limits[0]:
        axis.set_major_locator(LogLocator(10, subs=(1, 2, 5), numticks=9))
        axis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
        axis.set_minor_locator(NullLocator())
