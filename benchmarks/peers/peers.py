#!/usr/bin/env python3
# silt - BSD-3-Clause, see LICENSE
"""Times the same settled bed with the same contact law in LAMMPS, LIGGGHTS and silt.

silt settles the bed once; every code then starts from the same positions, runs 200 steps to warm up
and is timed by its own loop clock over the next ones. Runs are interleaved and repeated; printed are
medians in million particle-steps per second, the ratio to the faster peer, and the state each ends in.
"""
import argparse
import json
import os
import re
import shutil
import statistics
import subprocess
import sys
import tempfile

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
fix x1 all wall/gran granular {LAW} xplane 0.0 0.15
fix y1 all wall/gran granular {LAW} yplane 0.0 0.15
fix z1 all wall/gran granular {LAW} zplane 0.0 NULL
fix g all gravity 9.81 vector 0 0 -1
fix i all nve/sphere
timestep 0.00002
thermo 100000
thermo_style custom step atoms ke
thermo_modify lost ignore norm no
run 200
run {{steps}}
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
fix x2 all wall/gran model hertz tangential history primitive type 1 xplane 0.15
fix y1 all wall/gran model hertz tangential history primitive type 1 yplane 0.0
fix y2 all wall/gran model hertz tangential history primitive type 1 yplane 0.15
fix z1 all wall/gran model hertz tangential history primitive type 1 zplane 0.0
fix g all gravity 9.81 vector 0 0 -1
fix i all nve/sphere
timestep 0.00002
thermo 100000
thermo_style custom step atoms ke
thermo_modify lost ignore norm no
run 200
run {steps}
"""


def run_deck(program, deck, data, steps, folder):
    path = os.path.join(folder, program + ".in")
    with open(path, "w") as f:
        f.write(deck.format(data=data, steps=steps))
    out = subprocess.run([program, "-in", path, "-log", "none"], capture_output=True, text=True,
                         cwd=folder, env=dict(os.environ, OMP_NUM_THREADS="1",
                                              OMPI_ALLOW_RUN_AS_ROOT="1",
                                              OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1"))
    loops = re.findall(r"Loop time of ([0-9.eE+-]+)", out.stdout)
    energy = re.findall(r"^\s*\d+\s+\d+\s+([0-9.eE+-]+)", out.stdout, re.M)
    if len(loops) != 2:
        sys.exit(f"{program} did not finish:\n{out.stdout[-2000:]}{out.stderr[-2000:]}")
    return float(loops[1]), float(energy[-1])


def run_silt(program, data, steps, threads):
    out = subprocess.run([program, "time", data, str(steps), str(threads)], capture_output=True,
                         text=True)
    if out.returncode != 0:
        sys.exit(f"silt did not finish: {out.stderr}")
    words = out.stdout.split()
    values = dict(zip(words[::2], map(float, words[1::2])))
    return values["seconds"], values["kinetic_energy"]


def main():
    p = argparse.ArgumentParser(description=__doc__)
    p.add_argument("--silt", required=True, help="the program bench_bed")
    p.add_argument("--repeat", type=int, default=5)
    p.add_argument("--out", default="out/peers")
    p.add_argument("sizes", type=int, nargs="*", default=[5000, 50000])
    a = p.parse_args()
    for program in ("lmp", "liggghts"):
        if not shutil.which(program):
            sys.exit(f"{program} is not installed; ./run peers installs it on Debian")
    os.makedirs(a.out, exist_ok=True)
    silt = os.path.abspath(a.silt)
    results = []
    with tempfile.TemporaryDirectory() as folder:
        for n in a.sizes:
            data = os.path.join(folder, f"bed.{n}")
            settle, steps = 20000, max(50, 2000000 // n)
            print(f"settling {n} spheres", flush=True)
            subprocess.run([silt, "settle", str(n), str(settle), data], check=True)
            times = {"LAMMPS granular": [], "LIGGGHTS": [], "silt": []}
            energy = {}
            for _ in range(a.repeat):
                for name, result in (
                    ("LAMMPS granular", lambda: run_deck("lmp", LAMMPS, data, steps, folder)),
                    ("LIGGGHTS", lambda: run_deck("liggghts", LIGGGHTS, data, steps, folder)),
                    ("silt", lambda: run_silt(silt, data, steps, 1)),
                ):
                    seconds, energy[name] = result()
                    times[name].append(seconds)
            speed = {k: n * steps / statistics.median(v) / 1e6 for k, v in times.items()}
            peer = max(speed["LAMMPS granular"], speed["LIGGGHTS"])
            print(f"\n{n} spheres, one core, {steps} steps, median of {a.repeat} interleaved runs")
            for name in times:
                spread = [n * steps / t / 1e6 for t in (max(times[name]), min(times[name]))]
                print(f"  {name:16s} {speed[name]:7.2f} M/s  ({spread[0]:.2f} to {spread[1]:.2f})"
                      f"  kinetic energy {energy[name]:.3g} J")
            print(f"  silt over the faster peer: {speed['silt'] / peer:.2f}\n", flush=True)
            results.append({"particles": n, "steps": steps, "million_particle_steps_per_s": speed,
                            "ratio_to_faster_peer": speed["silt"] / peer, "kinetic_energy_j": energy})
    with open(os.path.join(a.out, "summary.json"), "w") as f:
        json.dump({"results": results}, f, indent=2)
    print(f"written: {a.out}/summary.json")


if __name__ == "__main__":
    main()
