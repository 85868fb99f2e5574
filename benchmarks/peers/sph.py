#!/usr/bin/env python3
# silt - BSD-3-Clause, see LICENSE
"""Smoothed particle hydrodynamics in LAMMPS (pair_style sph/taitwater) and silt: time of a step.

A cube of water in a vacuum, with eddies of a twentieth of the speed of sound. Both codes have the same
particles, kernel support, artificial viscosity, time step and one evaluation of the forces a step
(fix sph, VerletTime), without diffusion of density and shifting. silt runs with LAMMPS' kernel (Lucy)
and viscosity, and with its own kernel, in double and in mixed precision. LAMMPS is the one that
./run peers-native compiles, as Debian's is without the package SPH; its skin and newton on or off are
scanned first. Compared are neighbours, the first step of each particle and kinetic energies. All
times are processor times of one core, and runs are taken in turn. A table and summary.json are
written to --out.
"""
import os
import re
import statistics
import sys

import codes
from report import Options, Speed, Summary, in_range, make_folder, refuse, versions, write

SPACING, DENSITY, SOUND = 0.01, 1000, 20  # as in bench_sph.cpp
ALPHA = 0.05  # LAMMPS' h is the support, twice silt's: half of bench_sph's alpha
SKINS = (0.1, 0.2, 0.3, 0.5)  # [-] of the spacing
DIGITS = 1e-9  # both compute the first step in double; LAMMPS' data has 17 digits
FLOAT = 1e-5  # of the largest: digits of float, 6e-8, times what pairs of opposite sign leave of them


class Lammps:
    def __init__(self, program, folder, start, support, step, mass):
        self.program, self.folder = program, folder
        self.values = {"support": support * SPACING, "dt": step, "density": DENSITY, "sound": SOUND,
                       "alpha": ALPHA, "data": os.path.join(folder, "start.data")}
        with open(os.path.join(codes.HERE, "decks", "lammps_sph.in")) as f:
            self.deck = f.read()
        top = max(max(row[:3]) for row in start) + SPACING
        write(self.values["data"], f"water\n\n{len(start)} atoms\n1 atom types\n\n" +
              "".join(f"{-SPACING} {top} {c}lo {c}hi\n" for c in "xyz") +
              f"\nMasses\n\n1 {mass!r}\n\nAtoms\n\n" +
              "".join(f"{n + 1} 1 {r[6]!r} 0 1 {r[0]!r} {r[1]!r} {r[2]!r}\n" for n, r in enumerate(start)) +
              "\nVelocities\n\n" +
              "".join(f"{n + 1} {r[3]!r} {r[4]!r} {r[5]!r}\n" for n, r in enumerate(start)))

    def run(self, skin, newton, warmup, steps, first=""):
        """Processor seconds of the timed steps and the kinetic energy at their end."""
        path = os.path.join(self.folder, "lammps.in")
        write(path, self.deck.format(skin=skin * SPACING, newton=newton, warmup=warmup, steps=steps,
                                     first=first, **self.values))
        out = codes.run([self.program, "-in", path, "-log", "none"], self.folder)
        loops = re.findall(r"Loop time of ([0-9.eE+-]+)", out)
        share = re.findall(r"([0-9.]+)% CPU use", out)
        if len(loops) < 2 or len(share) < len(loops):
            refuse(f"{self.program} did not finish:\n{out[-2000:]}")
        energy = re.findall(r"^\s*\d+\s+\d+\s+([0-9.eE+-]+)\s*$", out, re.M)
        return float(loops[-1]) * float(share[-1]) / 100, float(energy[-1])

    def first(self):
        """Acceleration, density rate and number of neighbours of each particle at the start."""
        path = os.path.join(self.folder, "first.dump")
        self.run(0.2, "on", 0, 0,
                 "compute rate all property/atom drho\n"
                 f"compute near all coord/atom cutoff {self.values['support']}\n"
                 f"dump first all custom 1 {path} id fx fy fz c_rate c_near\n"
                 "dump_modify first format float %.17g sort id\nrun 0\nundump first")
        return [[float(x) for x in row[1:]] for row in codes.rows_of_dump(path)]


def compare(ours, theirs, mass):
    """Largest differences of acceleration and density rate over the largest of all."""
    most = max(abs(f) / mass for row in theirs for f in row[:3])
    most_rate = max(abs(row[3]) for row in theirs)
    a = max(abs(f / mass - b) for row, o in zip(theirs, ours) for f, b in zip(row[:3], o[7:10]))
    return a / most, max(abs(row[3] - o[10]) for row, o in zip(theirs, ours)) / most_rate


def main():
    p = Options(__doc__, "out/peers-sph")
    p.add_argument("--silt", required=True, help="silt's bench_sph")
    p.add_argument("--native", default=codes.NATIVE, help="folder of native.sh's LAMMPS")
    p.add_argument("--repeat", type=in_range(int, 1, 99), default=5, help="runs of each, in turn (5)")
    p.add_argument("--supports", type=in_range(float, 2.43, 6.9), nargs="+", default=[2.6, 3.118, 4.157],
                   help="of the kernel, in spacings (2.6 3.118 4.157; the second is silt's default)")
    p.add_argument("--sides", type=in_range(int, 10, 200), nargs="+", help="particles along the cube (30 60)")
    a = p.parse_args()
    sides, repeat = (a.sides or [12], 2) if a.quick else (a.sides or [30, 60], a.repeat)
    a.out = make_folder(a.out)
    silt, lammps = codes.program(a.silt, "--silt"), codes.native("lmp", a.native)
    if lammps is None:
        refuse("there is no LAMMPS with the package SPH: ./run peers-native compiles one")
    found = versions(silt)
    found["LAMMPS"] = codes.version_of(lammps)
    summary = Summary({"sides": sides, "supports": a.supports, "repeat": repeat, "quick": a.quick}, found)
    text = codes.head(found)
    for side in sides:
        for support in a.supports:
            text += one(summary, a, silt, lammps, side, support, repeat)
            write(os.path.join(a.out, "table.txt"), "\n".join(text))
    print("\n".join(text))
    return summary.end(a.out)


def one(summary, a, silt, lammps, side, support, repeat):
    scene, count = f"{side}^3, support {support}", side**3
    warmup, steps = 10, min(100, 6_000_000 // count)
    first = os.path.join(a.out, "first")

    def ours(kernel, precision, threads=1, file="-", warm=warmup, n=steps):
        return codes.result_of(codes.run([silt, *map(str, (side, support, warm, n, kernel, precision,
                                                          threads, file))], a.out))

    def rows():
        with open(first) as f:
            return [[float(x) for x in line.split()] for line in f]

    known = ours("lucy", "double", file=first, warm=1, n=1)
    start, mass, step = rows(), known["mass"], known["step"]
    peer = Lammps(lammps, a.out, start, support, step, mass)
    theirs = peer.first()
    summary.at_most(f"{scene}: neighbours a particle, difference",
                    abs(known["neighbours"] - sum(r[4] for r in theirs) / count), 1e-9)
    for precision, limit in (("double", DIGITS), ("mixed", FLOAT)):
        ours("lucy", precision, file=first, warm=1, n=1)
        da, dr = compare(rows(), theirs, mass)
        summary.at_most(f"{scene}: first accelerations, {precision} over LAMMPS, of the largest", da, limit)
        summary.at_most(f"{scene}: first density rates, {precision} over LAMMPS, of the largest", dr, limit)
    few = max(5, steps // 4)
    settings = [(skin, newton) for skin in SKINS for newton in ("on", "off")]
    best, _ = codes.fastest(settings, lambda s: peer.run(*s, warmup, few)[0])
    table = {"LAMMPS": [], "silt double": [], "silt mixed": [], "silt double, Wendland": [],
             "silt mixed, Wendland": []}
    for _ in range(repeat):
        for name in table:
            if name == "LAMMPS":
                seconds = peer.run(*best, warmup, steps)[0]
            else:
                seconds = ours("wendland" if "Wendland" in name else "lucy",
                               name.split()[1].strip(","))["seconds"]
            table[name].append(1e9 * seconds / count / steps)
    # Both after so many steps that the terms in which they differ (densities of pairs) and the kinds of
    # Verlet's steps have not parted them: the flow is the same.
    energy = peer.run(*best, 5, 5)[1]
    for precision in ("double", "mixed"):
        summary.at_most(f"{scene}: kinetic energy after 10 steps, {precision} over LAMMPS",
                        abs(ours("lucy", precision, warm=5, n=5)["kinetic"] / energy - 1), 0.01)
    speeds = {name: Speed(v) for name, v in table.items()}
    ratios = {name: [t / s for t, s in zip(table["LAMMPS"], v)] for name, v in table.items()}
    summary.results[scene] = {"ns": {n: s.as_dict() for n, s in speeds.items()}, "ratios": ratios,
                              "neighbours": known["neighbours"], "entries": known["entries"],
                              "lanes": known["lanes"], "skin": best[0], "newton": best[1], "steps": steps}
    lines = [f"{count} particles, support {support} spacings, {known['neighbours']:.1f} neighbours, {steps} steps; "
             f"processor time, ns a particle and step; LAMMPS with skin {best[0]} spacings, newton {best[1]}"]
    for name, s in speeds.items():
        r = ratios[name]
        lines.append(f"  {name:24s} {s.text():>7s}  {s.spread():22s}" + (
            "" if name == "LAMMPS" else f"  {statistics.median(r):.2f} times as fast "
            f"({min(r):.2f} to {max(r):.2f})"))
    lines.append(f"  silt's lists: {known['entries']:.1f} entries a particle; "
                 f"{100 * known['neighbours'] / known['lanes']:.0f} % of lanes work on neighbours")
    return lines + [""]


if __name__ == "__main__":
    sys.exit(main())
