#!/usr/bin/env python3
# silt - BSD-3-Clause, see LICENSE
"""Times the same bed with the same contact law in LAMMPS, LIGGGHTS and silt.

Two states: a settled bed, and the collapse of a loose lattice with all its list rebuilds ("filling").
silt makes the positions and velocities once; every code starts from the same file and is timed by its
own loop clock: settled beds after 200 steps to warm up, filling from the first step on. Runs are
interleaved and repeated. Printed are medians in million particle-steps a second with their spread, the
ratio to the faster peer on as many cores, and the state each code ends in. A table, a plot and
summary.json are written to --out.
"""
import argparse
import json
import os
import shutil
import sys

import codes

LAW = "hertz/material 1e6 0.5 0.3 tangential mindlin 1e6 1.0 0.4 damping tsuji"
LAMMPS = f"""
atom_style sphere
boundary f f f
newton off
comm_modify vel yes
units si
read_data {{data}}
neighbor 0.0006 bin
neigh_modify delay 0 every 1 check yes
pair_style granular
pair_coeff * * {LAW}
fix x1 all wall/gran granular {LAW} xplane 0.0 {{width}}
fix y1 all wall/gran granular {LAW} yplane 0.0 {{width}}
fix z1 all wall/gran granular {LAW} zplane 0.0 NULL
fix g all gravity 9.81 vector 0 0 -1
fix i all nve/sphere
timestep 0.00002
thermo 100000000
thermo_style custom step atoms ke
thermo_modify lost ignore norm no
run {{warmup}}
run {{steps}}
write_dump all custom {{end}} id x y z radius
"""
LIGGGHTS = """
atom_style granular
atom_modify map array
boundary f f f
newton off
communicate single vel yes
units si
soft_particles yes
read_data {data}
neighbor 0.0006 bin
neigh_modify delay 0
fix m1 all property/global youngsModulus peratomtype 1e6
fix m2 all property/global poissonsRatio peratomtype 0.3
fix m3 all property/global coefficientRestitution peratomtypepair 1 0.5
fix m4 all property/global coefficientFriction peratomtypepair 1 0.4
pair_style gran model hertz tangential history
pair_coeff * *
fix x1 all wall/gran model hertz tangential history primitive type 1 xplane 0.0
fix x2 all wall/gran model hertz tangential history primitive type 1 xplane {width}
fix y1 all wall/gran model hertz tangential history primitive type 1 yplane 0.0
fix y2 all wall/gran model hertz tangential history primitive type 1 yplane {width}
fix z1 all wall/gran model hertz tangential history primitive type 1 zplane 0.0
fix g all gravity 9.81 vector 0 0 -1
fix i all nve/sphere
timestep 0.00002
thermo 100000000
thermo_style custom step atoms ke
thermo_modify lost ignore norm no
run {warmup}
dump d all custom {steps} {end}.* id x y z radius
dump_modify d first no
run {steps}
"""
PEERS = ("LAMMPS granular", "LIGGGHTS")


def run_silt(program, cores, precision, folder, data, warmup, steps):
    end = os.path.join(folder, "silt.end")
    values = codes.values_of(codes.run(
        [program, "time", data, str(warmup), str(steps), str(cores), precision, end], folder))
    return values["seconds"], values["kinetic_energy"], end


def measure(program, end):
    """Coordination number and mean overlap of the state in a dump or data file."""
    if not end.endswith("silt.end"):
        with open(end + ".data", "w") as to:
            to.write("Atoms\n\n")
            for k, x, y, z, r in codes.rows_of_dump(end):
                to.write(f"{k} 1 {2 * float(r)} 2500 {x} {y} {z}\n")
        end += ".data"
    return codes.values_of(codes.run([program, "measure", end], None))


def plot(results, path):
    try:
        import matplotlib
        matplotlib.use("Agg")
        import matplotlib.pyplot as plt
    except ImportError:
        return False
    states = [s for s in ("settled", "filling") if any(r["state"] == s for r in results)]
    cores = sorted({r["cores"] for r in results})
    colour = {"LAMMPS granular": "#8a8a8a", "LIGGGHTS": "#b9a26c", "LAMMPS native": "#4d4d4d",
              "silt double": "#1f6fb2", "silt mixed": "#c1440e"}
    fig, axes = plt.subplots(1, len(states), figsize=(5.2 * len(states), 4), squeeze=False)
    for ax, state in zip(axes[0], states):
        for name in colour:
            for c in cores:
                points = [(r["particles"], r["speed"][name]["median"]) for r in results
                          if r["state"] == state and r["cores"] == c and name in r["speed"]]
                if points:
                    ax.plot(*zip(*points), marker="o", color=colour[name],
                            linestyle="-" if c == cores[0] else "--",
                            label=f"{name}, {c} core" + ("s" if c > 1 else ""))
        ax.set_xscale("log"), ax.set_yscale("log")
        sizes = sorted({r["particles"] for r in results if r["state"] == state})
        ax.set_xticks(sizes, [f"{n:,}".replace(",", " ") for n in sizes], minor=False)
        ax.set_xticks([], minor=True)
        speeds = [s["median"] for r in results if r["state"] == state for s in r["speed"].values()]
        ticks = [t for t in (1, 2, 5, 10, 20, 50, 100, 200, 500)
                 if min(speeds) / 2.5 < t < max(speeds) * 2.5]
        ax.set_ylim(min(speeds) / 1.3, max(speeds) * 1.3)
        ax.set_yticks(ticks, [str(t) for t in ticks]), ax.set_yticks([], minor=True)
        ax.set_xlabel("spheres"), ax.set_title(f"{state} bed")
        ax.grid(True, which="both", alpha=0.25)
    axes[0][0].set_ylabel("million particle-steps / s")
    axes[0][-1].legend(fontsize=7, loc="center left", bbox_to_anchor=(1.01, 0.5), frameon=False)
    fig.tight_layout()
    fig.savefig(path, dpi=150)
    return True


def main():
    p = argparse.ArgumentParser(description=__doc__,
                                formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--silt", required=True, help="the program bench_bed")
    p.add_argument("--repeat", type=int, default=5)
    p.add_argument("--cores", type=int, nargs="+", default=[1])
    p.add_argument("--states", nargs="+", choices=["settled", "filling"],
                   default=["settled", "filling"])
    p.add_argument("--work", type=float, default=1,
                   help="multiplies the number of steps that are timed")
    p.add_argument("--native-lammps", metavar="PROGRAM",
                   help="a LAMMPS compiled for this machine, timed as a further row")
    p.add_argument("--out", default="out/peers")
    p.add_argument("sizes", type=int, nargs="*", default=[5000, 50000])
    a = p.parse_args()
    for program in ("lmp", "liggghts", "mpirun"):
        if not shutil.which(program):
            sys.exit(f"{program} is not installed; ./run peers installs it on Debian")
    if a.native_lammps and not shutil.which(a.native_lammps):
        sys.exit(f"--native-lammps {a.native_lammps}: there is no such program")
    folder = os.path.abspath(a.out)
    os.makedirs(folder, exist_ok=True)
    silt = os.path.abspath(a.silt)
    results, table = [], []
    for n in a.sizes:
        width = 0.15 * max(1.0, n / 50000) ** 0.5
        for state in a.states:
            data = os.path.join(folder, f"{state}.{n}")
            warmup, settle = (200, 20000) if state == "settled" else (0, 0)
            # Filling: all of it for 5 000, the first impacts and the collapse of larger ones.
            work = 1e7 if state == "settled" else 1.25e8
            steps = max(50, int(a.work * work / n))
            if not os.path.exists(data):
                print(f"making {data}", flush=True)
                codes.run([silt, "settle", str(n), str(settle), data], folder)
            common = dict(data=data, warmup=warmup, steps=steps)
            for cores in a.cores:
                def code(start, *arguments, **values):
                    def once():
                        seconds, energy, end = start(*arguments, **values)
                        return seconds, lambda: dict(kinetic_energy_j=energy, **measure(silt, end))
                    return once

                deck = dict(width=width, cores=cores, **common)
                runs = {
                    "LAMMPS granular": code(codes.run_deck, "lmp", LAMMPS, folder, **deck),
                    "LIGGGHTS": code(codes.run_deck, "liggghts", LIGGGHTS, folder, **deck),
                    "silt double": code(run_silt, silt, cores, "double", folder, **common),
                    "silt mixed": code(run_silt, silt, cores, "mixed", folder, **common),
                }
                if a.native_lammps:
                    native = os.path.abspath(shutil.which(a.native_lammps))
                    runs["LAMMPS native"] = code(codes.run_deck, native, LAMMPS, folder, **deck)
                times, ends = codes.interleaved(runs, a.repeat)
                speed = codes.speeds(times, n * steps)
                peer = max(speed[name]["median"] for name in PEERS)
                lines = [f"{n} spheres, {state}, {cores} core{'s' * (cores > 1)}, {steps} steps, "
                         f"median of {a.repeat} interleaved runs",
                         "                    M/s  (spread)          over peer  kinetic energy  "
                         "contacts a sphere  mean overlap/d"]
                for name, s in speed.items():
                    e = ends[name]
                    lines.append(f"  {name:16s}{s['median']:7.2f}  ({s['least']:.2f} to {s['most']:.2f})"
                                 .ljust(42) + f"{s['median'] / peer:9.2f}  "
                                 f"{e['kinetic_energy_j']:12.4g} J  {e['coordination']:17.4f}  "
                                 f"{e['mean_overlap_over_d']:14.5f}")
                print("\n".join(lines) + "\n", flush=True)
                table += lines + [""]
                results.append({"particles": n, "state": state, "cores": cores, "steps": steps,
                                "speed": speed, "ends": ends,
                                "double_over_faster_peer": speed["silt double"]["median"] / peer,
                                "mixed_over_faster_peer": speed["silt mixed"]["median"] / peer})
    with open(os.path.join(a.out, "summary.json"), "w") as f:
        json.dump({"unit": "million particle-steps per second", "results": results}, f, indent=2)
    with open(os.path.join(a.out, "table.txt"), "w") as f:
        f.write("\n".join(table))
    drawn = plot(results, os.path.join(a.out, "peers.png"))
    print(f"Look at: {a.out}/table.txt, summary.json" + (", peers.png" if drawn else ""))


if __name__ == "__main__":
    main()
