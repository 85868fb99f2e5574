#!/usr/bin/env python3
# silt - BSD-3-Clause, see LICENSE
"""Bonded spheres in Yade (cohesive contacts that bear moments) and silt (ParallelBond): time of a step.

A cube of spheres on a lattice, each bonded to its neighbours, swings along x. Both have the same bonds,
masses and stiffness, and one core; runs are taken in turn. Compared is also the kinetic energy at the
end. Yade is Debian's package, which is compiled for any processor, silt for this one. A table and
summary.json are written to --out.
"""
import os
import statistics
import sys

import codes
from report import Options, Summary, make_folder, versions, write


def compare(a, side, steps, silt, yade, summary):
    """One size of cube, in turn; returns lines for the table."""
    words = [str(x) for x in (side, 20 if a.quick else 50, steps)]
    deck = os.path.join(codes.HERE, "decks", "yade_bonds.py")
    ours, theirs = [], []
    for _ in range(a.repeat):
        ours.append(codes.result_of(codes.run([silt, *words], a.out)))
        theirs.append(codes.result_of(codes.run([yade, "-n", "-x", "-j1", deck, *words], a.out)))
    n = side**3
    per_step = 1e9 / steps / n  # [ns] of a second
    s = [per_step * r["seconds"] for r in ours]
    y = [per_step * r["seconds"] for r in theirs]
    ratios = [b / c for b, c in zip(y, s)]
    summary.results.update({f"{n}_bonds": ours[0]["bonds"], f"{n}_silt_ns": s, f"{n}_yade_ns": y,
                            f"{n}_ratios": ratios, f"{n}_median_ratio": statistics.median(ratios)})
    summary.at_most(f"{n} spheres: bonds that one has and the other not",
                    abs(ours[0]["bonds"] - theirs[0]["bonds"]), 0)
    # Yade's bonds begin with its first step: an error of first order in that one.
    summary.at_most(f"{n} spheres: difference of the kinetic energies over that at the start [-]",
                    abs(ours[0]["kinetic"] - theirs[0]["kinetic"]) / ours[0]["start"], 1e-3)
    return [f"{n} spheres, {ours[0]['bonds']:.0f} bonds, {steps} steps, one core; ns a sphere and step",
            f"silt  {statistics.median(s):8.1f}  ({min(s):.1f} to {max(s):.1f})",
            f"Yade  {statistics.median(y):8.1f}  ({min(y):.1f} to {max(y):.1f})",
            f"silt is {statistics.median(ratios):.1f} times as fast ({min(ratios):.1f} to {max(ratios):.1f})"]


def main():
    p = Options(__doc__, "out/peers-bonds")
    p.add_argument("--silt", required=True, help="silt's bench_bonds")
    p.add_argument("--sides", type=int, nargs="+", default=[6, 20],
                   help="spheres along an edge of the cube (6 20; with --quick 6)")
    p.add_argument("--repeat", type=int, default=5, help="runs of each, in turn (5; with --quick 2)")
    a = p.parse_args()
    if a.quick:
        a.sides, a.repeat = [6], 2
    a.out = make_folder(a.out)
    silt, yade = codes.program(a.silt, "--silt"), codes.program("yade")
    found = versions(silt)
    found["Yade"] = codes.version_of(yade)
    summary = Summary({"sides": a.sides, "repeat": a.repeat, "quick": a.quick}, found)
    text = codes.head(found)
    for side in a.sides:
        # As many steps as keep a run of silt above a tenth of a second, if it is not a quick one.
        steps = 100 if a.quick else max(500, 4_000_000 // side**3)
        text += ["", *compare(a, side, steps, silt, yade, summary)]
    print("\n".join(text))
    write(os.path.join(a.out, "table.txt"), "\n".join(text))
    return summary.end(a.out)


if __name__ == "__main__":
    sys.exit(main())
