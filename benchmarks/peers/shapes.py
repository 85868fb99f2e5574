#!/usr/bin/env python3
# silt - BSD-3-Clause, see LICENSE
"""Times particles that are no spheres in LIGGGHTS, Yade and silt, each on one core.

  bodies            a settled bed of rigid bodies of eight balls, same law, positions and velocities
                    for all codes
  super-ellipsoids  a settled bed of 1 476 superquadrics (2, 2, 4 mm) of blockiness 2, 4 and 8
  balls             as many balls of 2.5 mm, in silt as spheres and as super-ellipsoids
  polyhedra         216 random polyhedra that fall on a plane, 0.06 s after the start

What is installed is run, interleaved and repeated, and timed by its own loop clock. Printed are
medians in million particle-steps a second with their spread, the ratio to the fastest peer, and the
contacts of the state that each code ends in: of two balls each for bodies, of two particles else; a
contact counts for both. A table and summary.json are written to --out.
"""
import argparse
import json
import os
import shutil
import sys
from functools import partial

import codes

DECKS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "decks")


def deck(name):
    with open(os.path.join(DECKS, name)) as f:
        return f.read()


def on_one_core(program):
    return [program, "-n", "-x", "-j1"]


# --- bodies of eight balls ------------------------------------------------------------------------

BODIES = 1000
BODY_WIDTH, BODY_TOP = 0.06, 0.12  # [m] of the box
BODY_FORM = [(x, y, z, 1.2e-3) for x in (-1e-3, 1e-3) for y in (-1e-3, 1e-3) for z in (-1e-3, 1e-3)]


def bodies(a):
    silt = os.path.join(a.silt, "bench_bodies")
    data, form = os.path.join(a.out, f"bodies.{BODIES}"), os.path.join(a.out, "bodies.form")
    warmup, steps = 500, max(50, int(5000 * a.work))
    if not os.path.exists(data):
        codes.run([silt, "settle", str(BODIES), "20000", data], a.out)
    with open(form, "w") as f:
        f.writelines("{} {} {} {}\n".format(*ball) for ball in BODY_FORM)

    def measure(balls):
        return lambda: codes.values_of(codes.run([silt, "measure", balls], a.out))

    def liggghts(program):
        insertions = removals = ""
        with open(data) as f:
            for k, line in enumerate(f):
                words = line.split()
                region = " ".join(f"{float(x) - 1e-9:.12g} {float(x) + 1e-9:.12g}" for x in words[:3])
                insertions += (
                    f"region r{k} block {region} units box volume_limit 1e-30\n"
                    f"fix i{k} all insert/pack seed 32452843 distributiontemplate d "
                    "insert_every once overlapcheck no all_in no verbose no "
                    f"vel constant {' '.join(words[7:10])} omega constant {' '.join(words[10:13])} "
                    f"orientation constant {' '.join(words[3:7])} "
                    f"region r{k} particles_in_region 1 ntry_mc 1001\n")
                removals += f"unfix i{k}\n"

        def once():
            seconds, _, end = codes.run_deck(
                program, deck("liggghts_bodies.in"), a.out, width=BODY_WIDTH, top=BODY_TOP,
                form=form, insertions=insertions, removals=removals, warmup=warmup, steps=steps)
            balls = end + ".balls"
            with open(balls, "w") as f:
                for row in sorted(codes.rows_of_dump(end), key=lambda row: int(row[0])):
                    f.write(" ".join(row[1:]) + "\n")
            return seconds, measure(balls)
        return once

    def yade():
        end = os.path.join(a.out, "yade.balls")
        out = codes.run(on_one_core(a.yade) + [os.path.join(DECKS, "yade_bodies.py"), data, form,
                                               str(BODY_WIDTH), str(warmup), str(steps), end], a.out)
        return codes.result_of(out)["seconds"], measure(end)

    def with_silt(precision, share):
        def once():
            end = os.path.join(a.out, "silt.balls")
            out = codes.run([silt, "time", data, str(warmup), str(steps), precision, share, end],
                            a.out)
            return codes.result_of(out)["seconds"], measure(end)
        return once

    runs = {}
    if a.liggghts:
        runs["LIGGGHTS"] = liggghts(a.liggghts)
    if a.liggghts_superquadrics:
        runs["LIGGGHTS, own build"] = liggghts(a.liggghts_superquadrics)
    if a.yade:
        runs["Yade"] = yade
    for precision in ("double", "mixed"):
        runs[f"silt {precision}"] = with_silt(precision, "whole")
        runs[f"silt {precision}, shared"] = with_silt(precision, "shared")
    yield f"{BODIES} bodies of eight balls", BODIES, steps, runs


# --- super-ellipsoids -----------------------------------------------------------------------------

SUPERQUADRICS = 1476
NEW_BOX = "region reg block 0 0.06 0 0.06 0.0 0.4 units box\ncreate_box 1 reg"
NEW_SUPERQUADRICS = """lattice sc 0.0085
region ins block 0.004 0.056 0.004 0.056 0.005 0.35 units box
create_atoms 1 region ins
set group all shape 0.002 0.002 0.004 blockiness {blockiness} {blockiness} density 2500
set group all quat/random 4711"""
SETTLE = "run 30000\nwrite_restart {restart}"
TIME = """compute c all pair/gran/local id
run 200
run {steps}
dump d all local 1 {end} c_c[1] c_c[2]
run 0"""


def settle_superquadrics(a, blockiness, restart):
    path = restart + ".in"
    with open(path, "w") as f:
        f.write(deck("liggghts_superquadrics.in").format(
            box=NEW_BOX, particles=NEW_SUPERQUADRICS.format(blockiness=blockiness),
            task=SETTLE.format(restart=restart)))
    codes.run([a.liggghts_superquadrics, "-in", path, "-log", "none"], a.out)


def time_superquadrics(a, steps, restart):
    timed = deck("liggghts_superquadrics.in").replace("{task}", TIME)
    seconds, _, end = codes.run_deck(a.liggghts_superquadrics, timed, a.out, particles="",
                                     box=f"read_restart {restart}", steps=steps)
    pairs = sum(1 for _ in codes.rows_of_dump(end, "ENTRIES"))
    return seconds, lambda: {"contacts": 2 * pairs / SUPERQUADRICS}


def with_silt_bed(a, form, steps):
    """A bed of bench_super_ellipsoids_bed, which settles it once."""
    silt = os.path.join(a.silt, "bench_super_ellipsoids_bed")
    bed = os.path.join(a.out, f"bed.{form}.silt")
    if not os.path.exists(bed):
        codes.run([silt, "settle", form, bed], a.out)

    def once():
        values = codes.result_of(codes.run([silt, "time", form, bed, str(steps)], a.out))
        return values["seconds"], lambda: {"contacts": values["contacts"]}
    return once


def super_ellipsoids(a):
    steps = max(50, int(1000 * a.work))
    for blockiness in (2, 4, 8):
        restart = os.path.join(a.out, f"superquadrics.{blockiness}")
        runs = {}
        if a.liggghts_superquadrics:
            if not os.path.exists(restart):
                print(f"making {restart}", flush=True)
                settle_superquadrics(a, blockiness, restart)
            runs["LIGGGHTS"] = partial(time_superquadrics, a, steps, restart)
        runs["silt double"] = with_silt_bed(a, str(blockiness), steps)
        yield f"{SUPERQUADRICS} super-ellipsoids, blockiness {blockiness}", SUPERQUADRICS, steps, runs


def balls(a):
    steps = max(50, int(1000 * a.work))
    runs = {"silt Sphere": with_silt_bed(a, "sphere", steps),
            "silt SuperEllipsoid": with_silt_bed(a, "ball", steps)}
    yield f"{SUPERQUADRICS} balls, as spheres and as super-ellipsoids", SUPERQUADRICS, steps, runs


# --- polyhedra ------------------------------------------------------------------------------------

POLYHEDRA = 216


def polyhedra(a):
    steps, state = max(50, int(200 * a.work)), os.path.join(a.out, "polyhedra.yade.gz")
    bodies = os.path.join(a.out, "polyhedra.bodies")

    def yade():
        if not os.path.exists(state):
            print(f"making {state}, which takes minutes", flush=True)
        out = codes.run(on_one_core(a.yade) + [os.path.join(DECKS, "yade_polyhedra.py"), state,
                                               str(steps), bodies], a.out)
        values = codes.result_of(out)
        return values["seconds"], lambda: {"contacts": values["contacts"]}

    def silt():
        out = codes.run([os.path.join(a.silt, "bench_polyhedra_bed"), bodies, str(steps)], a.out)
        values = codes.result_of(out)
        return values["seconds"], lambda: {"contacts": values["contacts"]}

    yield (f"{POLYHEDRA} polyhedra", POLYHEDRA, steps,
           {"Yade": yade, "silt double": silt} if a.yade else {})


# A case yields its scenes: a title, the number of particles, the steps timed, and the codes that run
# it, each a function that returns seconds and a function that measures the state at the end.
CASES = {"bodies": bodies, "super-ellipsoids": super_ellipsoids, "balls": balls,
         "polyhedra": polyhedra}


def table(title, particles, steps, speed, ends, repeat):
    peers = [s["median"] for name, s in speed.items() if not name.startswith("silt")]
    lines = [f"{title}, {steps} steps, median of {repeat} interleaved runs",
             "                          M/s  (spread)            over peer  contacts a particle"]
    for name, s in speed.items():
        line = f"  {name:21s}{s['median']:8.3g}  ({s['least']:.3g} to {s['most']:.3g})".ljust(50)
        line += f"{s['median'] / max(peers):9.2f}" if peers else " " * 9
        lines.append(line + f"  {ends[name]['contacts']:19.3f}")
    return lines


def main():
    p = argparse.ArgumentParser(description=__doc__,
                                formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--silt", required=True, help="the folder of silt's benchmarks")
    p.add_argument("--repeat", type=int, default=3)
    p.add_argument("--work", type=float, default=1,
                   help="multiplies the number of steps that are timed")
    p.add_argument("--liggghts-superquadrics", metavar="PROGRAM",
                   help="a LIGGGHTS compiled with superquadrics, docs/performance.md says how; also "
                        "timed on bodies")
    p.add_argument("--out", default="out/peers-shapes")
    p.add_argument("--cases", nargs="+", choices=CASES, default=list(CASES))
    a = p.parse_args()
    a.silt, a.out = os.path.abspath(a.silt), os.path.abspath(a.out)
    a.liggghts, a.yade = shutil.which("liggghts"), shutil.which("yade")
    if a.liggghts_superquadrics:
        found = shutil.which(a.liggghts_superquadrics)
        if not found:
            sys.exit(f"--liggghts-superquadrics {a.liggghts_superquadrics}: there is no such program")
        a.liggghts_superquadrics = os.path.abspath(found)
    os.makedirs(a.out, exist_ok=True)
    results, text = [], []
    for case in a.cases:
        for title, particles, steps, runs in CASES[case](a):
            if not runs:
                print(f"{title}: no code installed that runs it\n", flush=True)
                continue
            times, ends = codes.interleaved(runs, a.repeat)
            speed = codes.speeds(times, particles * steps)
            lines = table(title, particles, steps, speed, ends, a.repeat)
            print("\n".join(lines) + "\n", flush=True)
            text += lines + [""]
            results.append({"case": case, "title": title, "particles": particles, "steps": steps,
                            "speed": speed, "ends": ends})
    with open(os.path.join(a.out, "summary.json"), "w") as f:
        json.dump({"unit": "million particle-steps per second", "results": results}, f, indent=2)
    with open(os.path.join(a.out, "table.txt"), "w") as f:
        f.write("\n".join(text))
    print(f"Look at: {a.out}/table.txt, summary.json")


if __name__ == "__main__":
    main()
