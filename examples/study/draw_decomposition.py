#!/usr/bin/env python3
# silt - BSD-3-Clause, see LICENSE
"""Draws what the study `decomposition` leaves: loads of four ranks, imbalance and ghosts, speed-ups.

  draw_decomposition.py FOLDER
"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "python"))
from silt import needs  # noqa: E402

needs.or_exit()
import numpy as np  # noqa: E402
import silt  # noqa: E402
import silt  # noqa: E402
from silt.drawing import DPI, plt  # noqa: E402

WORDS = {"static_z": "static slabs across z", "static_x": "static slabs across x",
         "moving": "moving slabs", "bisection": "bisection"}
COLOURS = {"static_z": "#C0392B", "static_x": "#DD8A2B", "moving": "#2E86C1", "bisection": "#1E8449"}
RANKS = ["#0B3C5D", "#2E86C1", "#DD8A2B", "#C0392B"]


def column(table, word):
    """The column that begins with a word."""
    return table[next(name for name in table.names if name.startswith(word))]


def save(figure, path):
    figure.savefig(path, dpi=DPI)
    plt.close(figure)


def loads(folder):
    shown = ("static_z", "moving", "bisection")
    figure, panels = plt.subplots(3, 3, figsize=(12, 8.5), sharex=True, sharey="row", constrained_layout=True)
    for k, name in enumerate(shown):
        table = silt.table(f"{folder}/ranks/{name}_4.csv")
        time = column(table, "time")
        for j, (what, unit) in enumerate((("particles", 1e3), ("contacts", 1e3), ("work", 1e3))):
            panel = panels[j, k]
            for r in range(4):
                panel.plot(time, column(table, f"{what} rank {r} ") / unit, color=RANKS[r], lw=1.3,
                           label=f"rank {r}")
            panel.set_ylim(0, None)
            if k == 0:
                panel.set_ylabel(f"{what}, thousands")
        panels[0, k].set_title(WORDS[name])
        panels[2, k].set(xlabel="time after opening [s]", xlim=(0, time[-1]))
    panels[0, 2].legend(frameon=False, ncol=2, fontsize=10, loc="upper right")
    save(figure, f"{folder}/loads.png")


def balance(folder, found):
    figure, (even, ghosts) = plt.subplots(1, 2, figsize=(12, 4.6), constrained_layout=True)
    for name, table in found.items():
        ranks = column(table, "ranks")
        look = {"color": COLOURS[name], "marker": "o", "mfc": "white", "lw": 1.6, "label": WORDS[name]}
        even.plot(ranks, column(table, "imbalance"), **look)
        ghosts.plot(ranks, column(table, "ghosts over"), **look)
    even.axhline(1.05, color="0.5", lw=1, ls="--", label="1.05")
    even.set(ylabel="largest over mean work, in time average", yscale="log", title="Imbalance")
    most = 1.1 * max(column(table, "imbalance").max() for table in found.values())
    ticks = [tick for tick in (1, 1.2, 1.5, 2, 3, 5, 10, 20, 40) if tick < most]
    even.set_yticks(ticks, [f"{tick:g}" for tick in ticks])
    even.set_ylim(0.98, most)
    even.minorticks_off()
    ghosts.set(ylabel="sent over needed", title="Ghosts", ylim=(1, None))
    for panel in (even, ghosts):
        panel.set(xlabel="ranks", xscale="log")
        panel.set_xticks([2, 4, 8, 16, 48], ["2", "4", "8", "16", "48"])
        panel.xaxis.set_minor_locator(plt.NullLocator())
    even.legend(frameon=False, fontsize=10, loc="upper left")
    save(figure, f"{folder}/balance.png")


def speed_ups(folder, found):
    figure, panels = plt.subplots(1, 3, figsize=(13, 4.8), sharey=True, constrained_layout=True)
    shown = (("speed-up without", "messages that cost nothing"), ("speed-up [", "a cluster's network"),
             ("speed-up on gigabit", "gigabit Ethernet"))
    for panel, (word, title) in zip(panels, shown):
        for name, table in found.items():
            panel.plot(np.append(1, column(table, "ranks")), np.append(1, column(table, word)),
                       color=COLOURS[name], marker="o", mfc="white", lw=1.6, label=WORDS[name])
        panel.plot([1, 48], [1, 48], color="0.5", lw=1, ls="--", label="ideal")
        panel.set(xlabel="ranks", xscale="log", yscale="log", title=title)
        for axis in (panel.xaxis, panel.yaxis):
            axis.set_minor_locator(plt.NullLocator())
        panel.set_xticks([1, 2, 4, 8, 16, 48], ["1", "2", "4", "8", "16", "48"])
    least = min(column(table, word).min() for table in found.values() for word, _ in shown)
    ticks = [tick for tick in (0.125, 0.25, 0.5, 1, 2, 4, 8, 16, 48) if tick >= min(1, least)]
    panels[0].set_yticks(ticks, [f"{tick:g}" for tick in ticks])
    panels[0].set_ylabel("speed-up, predicted by a model")
    panels[0].legend(frameon=False, fontsize=10, loc="upper left")
    save(figure, f"{folder}/speed_up.png")


def main():
    folder = sys.argv[1]
    found = {name: silt.table(f"{folder}/{name}.csv") for name in WORDS}
    loads(folder)
    balance(folder, found)
    speed_ups(folder, found)


if __name__ == "__main__":
    main()
