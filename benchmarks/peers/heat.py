#!/usr/bin/env python3
# silt - BSD-3-Clause, see LICENSE
"""Heat conduction in LIGGGHTS (fix heat/gran/conduction) and silt: the same bed, the same numbers?

A cubic arrangement of equal spheres, displaced at random so that some pairs overlap and others do not,
starts with its lower half at 400 K and the rest at 300 K; nothing moves. silt runs with LIGGGHTS'
circle, which cuts both spheres (benchmarks/peers/bench_heat.cpp), as its own is Hertz'. Compared are
the temperatures of all particles after some time. A table and summary.json are written to --out.
"""
import os
import random
import sys

import codes
from report import Options, Summary, make_folder, versions, write

RADIUS, DENSITY, CONDUCTIVITY, CAPACITY = 1e-3, 2500, 1.1, 840
DT = 1e-3  # [s]
DIGITS = 1e-6  # [K] Euler's steps of both differ by rounding alone; LIGGGHTS writes 15 digits


def main():
    p = Options(__doc__, "out/peers-heat")
    p.add_argument("--silt", required=True, help="silt's bench_heat")
    a = p.parse_args()
    side, steps = (6, 2000) if a.quick else (12, 20000)
    a.out = make_folder(a.out)
    silt, liggghts = codes.program(a.silt, "--silt"), codes.program("liggghts")
    rng, spacing = random.Random(1), 1.99 * RADIUS
    places = [[(n + 0.5) * spacing + rng.uniform(-1, 1) * 0.02 * RADIUS for n in (i, j, k)]
              for i in range(side) for j in range(side) for k in range(side)]
    hot = 0.5 * side * spacing
    bed, data = os.path.join(a.out, "bed"), os.path.join(a.out, "bed.data")
    write(bed, "".join("{:.17g} {:.17g} {:.17g} {}\n".format(*x, 400 if x[2] < hot else 300)
                       for x in places))
    top = side * spacing + 5e-3
    write(data, f"spheres\n\n{len(places)} atoms\n1 atom types\n\n" +
          "".join(f"-0.005 {top} {c}lo {c}hi\n" for c in "xyz") + "\nAtoms\n\n" +
          "".join("{} 1 {} {} {:.17g} {:.17g} {:.17g}\n".format(n + 1, 2 * RADIUS, DENSITY, *x)
                  for n, x in enumerate(places)))
    with open(os.path.join(codes.HERE, "decks", "liggghts_heat.in")) as f:
        deck = f.read()
    seconds, _, end = codes.run_deck(liggghts, deck, a.out, data=data, hot=hot, dt=DT, steps=steps,
                                     conductivity=CONDUCTIVITY, capacity=CAPACITY)
    theirs = [float(T) for _, T in sorted(((int(r[0]), r[1]) for r in codes.rows_of_dump(end)))]
    ours_file = os.path.join(a.out, "silt.temperatures")
    ours = codes.result_of(codes.run(
        [silt, bed, *map(str, (RADIUS, DENSITY, CONDUCTIVITY, CAPACITY, DT, steps)), ours_file], a.out))
    with open(ours_file) as f:
        T = [float(line) for line in f]
    found = versions(silt)
    found["LIGGGHTS"] = codes.version_of(liggghts)
    summary = Summary({"particles": len(places), "steps": steps, "quick": a.quick}, found)
    worst = max(abs(x - y) for x, y in zip(T, theirs))
    flowed = max(abs(x - (400 if q[2] < hot else 300)) for x, q in zip(T, places))
    summary.results.update(largest_difference=worst, largest_change=flowed, contacts=ours["contacts"],
                           seconds={"silt": ours["seconds"], "LIGGGHTS": seconds})
    summary.at_most("particles that are missing", abs(len(T) - len(theirs)), 0)
    summary.at_most("largest difference of a temperature [K]", worst, DIGITS)
    summary.at_least("largest change of a temperature [K]", flowed, 5)
    text = codes.head(found) + [
        f"{len(places)} spheres, {ours['contacts']:.0f} contacts, {steps} steps of {DT} s",
        f"largest difference of a temperature  {worst:.2g} K, of changes up to {flowed:.3g} K",
        f"seconds: silt {ours['seconds']:.3g}, LIGGGHTS {seconds:.3g}"]
    print("\n".join(text))
    write(os.path.join(a.out, "table.txt"), "\n".join(text))
    return summary.end(a.out)


if __name__ == "__main__":
    sys.exit(main())
