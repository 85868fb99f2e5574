#!/usr/bin/env python3
# silt - BSD-3-Clause, see LICENSE
"""Times particles that are no spheres in LIGGGHTS, Yade and silt, each on one core.

  bodies            a settled bed of rigid bodies of eight balls, same law, positions and velocities
                    for all codes
  super-ellipsoids  a settled bed of 1 476 superquadrics (2, 2, 4 mm) of blockiness 2, 4 and 8; silt
                    goes on from LIGGGHTS' bed, or without that from its own
  balls             as many balls of 2.5 mm, in silt as spheres and as super-ellipsoids
  polyhedra         216 random polyhedra that fall on a plane, 0.06 s after the start

What is installed is run, interleaved and repeated, and timed by its own loop clock after as many steps
to warm up for all; reading, set-up and output count for no code. Peers run with the fastest of some
skins, which are printed; silt chooses its own, with its guard on (its limits are raised where peers
have none). Yade and Debian's LIGGGHTS are compiled for any machine of their kind; ./run peers-native
compiles LIGGGHTS, with superquadrics too, for this one, and what it has left in build/peers is timed as
well. Printed are medians in million particle-steps a second with their spread, the ratio to the fastest
peer, and the contacts of the state that each code ends in, counted by silt's geometry for all: of two
balls each for bodies, of two particles else; a contact counts for both. A table and summary.json are
written to --out; checks: no particle lost, contacts and heights alike.
"""
import os
import shutil
import sys
from functools import partial

import codes
from report import Options, Summary, in_range, make_folder, versions, write

DECKS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "decks")


def deck(name):
    with open(os.path.join(DECKS, name)) as f:
        return f.read()


def on_one_core(program):
    return [program, "-n", "-x", "-j1"]


class Scene:
    """A title, particles, steps that are timed, and the codes that run it: each a function that
    returns seconds and a function that measures the state at the end. `alike`: of two codes' ends,
    contacts (relative) and mean heights [m]."""

    def __init__(self, title, particles, steps, alike):
        self.title, self.particles, self.steps, self.alike = title, particles, steps, alike
        self.runs, self.skins, self.apart = {}, {}, set()

    def add(self, name, once, skins, steps):
        """A peer, once(skin, steps); with the fastest of the skins over fewer steps."""
        skin, tried = codes.fastest(skins, lambda one: once(one, steps)[0])
        self.skins[name] = {"skin": skin, "seconds": {f"{k:g}": v for k, v in tried.items()}}
        self.runs[name] = lambda: once(skin, self.steps)


# --- bodies of eight balls ------------------------------------------------------------------------

BODIES = 1000
BODY_WIDTH, BODY_TOP = 0.06, 0.12  # [m] of the box
BODY_FORM = [(x, y, z, 1.2e-3) for x in (-1e-3, 1e-3) for y in (-1e-3, 1e-3) for z in (-1e-3, 1e-3)]


def bodies(a):
    silt = os.path.join(a.silt, "bench_bodies")
    data, form = os.path.join(a.out, f"bodies.{BODIES}"), os.path.join(a.out, "bodies.form")
    warmup = 50 if a.quick else 500
    scene = Scene(f"{BODIES} bodies of eight balls", BODIES, max(50, int(5000 * a.work)),
                  {"contacts": 0.03, "height": 1e-4})
    if not os.path.exists(data):
        codes.run([silt, "settle", str(BODIES), "20000", data + ".new"], a.out)  # at rest: some seconds
        os.replace(data + ".new", data)
    write(form, "".join("{} {} {} {}\n".format(*ball) for ball in BODY_FORM))

    def measure(balls):
        return lambda: codes.values_of(codes.run([silt, "measure", balls], a.out))

    def liggghts(program, skin, steps):
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
        seconds, _, end = codes.run_deck(
            program, deck("liggghts_bodies.in"), a.out, width=BODY_WIDTH, top=BODY_TOP, skin=skin,
            form=form, insertions=insertions, removals=removals, warmup=warmup, steps=steps)
        balls = end + ".balls"
        with open(balls, "w") as f:
            for row in sorted(codes.rows_of_dump(end), key=lambda row: int(row[0])):
                f.write(" ".join(row[1:]) + "\n")
        return seconds, measure(balls)

    def yade(skin, steps):
        end = os.path.join(a.out, "yade.balls")
        out = codes.run(on_one_core(a.yade) + [os.path.join(DECKS, "yade_bodies.py"), data, form,
                                               str(BODY_WIDTH), str(warmup), str(steps), str(skin),
                                               end], a.out)
        return codes.result_of(out)["seconds"], measure(end)

    def with_silt(precision, share):
        end = os.path.join(a.out, "silt.balls")
        out = codes.run([silt, "time", data, str(warmup), str(scene.steps), precision, share, end],
                        a.out)
        return codes.result_of(out)["seconds"], measure(end)

    skins = [1e-4] if a.quick else [0.5e-4, 1e-4, 2e-4, 4e-4]
    for name, program in a.liggghts.items():
        scene.add(name, partial(liggghts, program), skins, scene.steps // 5)
    if a.yade:
        scene.add("Yade, Debian", yade, [0.05] if a.quick else [0.02, 0.05, 0.1, 0.2],
                  scene.steps // 10)
    for precision in ("double", "mixed"):
        scene.runs[f"silt {precision}"] = partial(with_silt, precision, "whole")
        scene.runs[f"silt {precision}, shared"] = partial(with_silt, precision, "shared")
        scene.apart.add(f"silt {precision}, shared")  # softer: it comes to rest with more contacts
    yield scene


# --- super-ellipsoids -----------------------------------------------------------------------------

SUPERQUADRICS = 1476
NEW_BOX = "region reg block 0 0.06 0 0.06 0.0 0.4 units box\ncreate_box 1 reg"
NEW_SUPERQUADRICS = """lattice sc 0.0085
region ins block 0.004 0.056 0.004 0.056 0.005 0.35 units box
create_atoms 1 region ins
set group all shape 0.002 0.002 0.004 blockiness {blockiness} {blockiness} density 2500
set group all quat/random 4711"""
ROW = "x y z quat1 quat2 quat3 quat4 vx vy vz omegax omegay omegaz"
SETTLE = f"run 30000\nwrite_restart {{restart}}\nwrite_dump all custom {{restart}}.dump id {ROW}"
TIME = f"run {{warmup}}\nrun {{steps}}\nwrite_dump all custom {{end}} id {ROW}"


def rows_to_file(dump, path):
    """A dump of LIGGGHTS as bench_super_ellipsoids_bed reads it."""
    rows = sorted(codes.rows_of_dump(dump), key=lambda row: int(row[0]))
    write(path, "".join(" ".join(row[1:]) + "\n" for row in rows))
    return path


def settle_superquadrics(a, program, blockiness, restart):
    path = restart + ".in"
    write(path, deck("liggghts_superquadrics.in").format(
        box=NEW_BOX, particles=NEW_SUPERQUADRICS.format(blockiness=blockiness), skin=1e-3,
        task=SETTLE.format(restart=restart + ".new")))
    codes.run([program, "-in", path, "-log", "none"], a.out)
    rows_to_file(restart + ".new.dump", restart + ".rows")
    os.replace(restart + ".new", restart)


def silt_bed(a, form):
    return os.path.join(a.silt, "bench_super_ellipsoids_bed"), os.path.join(a.out, f"bed.{form}.rows")


def measure_bed(a, form, rows):
    return lambda: codes.values_of(codes.run([silt_bed(a, form)[0], "measure", form, rows], a.out))


def time_superquadrics(a, program, form, restart, warmup, skin, steps):
    timed = deck("liggghts_superquadrics.in").replace("{task}", TIME)
    seconds, _, end = codes.run_deck(program, timed, a.out, particles="", skin=skin, warmup=warmup,
                                     box=f"read_restart {restart}", steps=steps)
    return seconds, measure_bed(a, form, rows_to_file(end, end + ".rows"))


def with_silt_bed(a, form, warmup, steps, rows=None):
    """A bed of bench_super_ellipsoids_bed, which settles it once; or from a file."""
    program, own = silt_bed(a, form)
    if not rows and not os.path.exists(own):
        codes.run([program, "settle", form, own], a.out)

    def once():
        end = os.path.join(a.out, f"silt.{form}.end")
        values = codes.result_of(codes.run([program, "time", form, rows or own, str(warmup),
                                            str(steps), end], a.out))
        return values["seconds"], measure_bed(a, form, end)
    return once


def super_ellipsoids(a):
    warmup = 50 if a.quick else 500
    for blockiness in ("2",) if a.quick else ("2", "4", "8"):
        scene = Scene(f"{SUPERQUADRICS} super-ellipsoids, blockiness {blockiness}", SUPERQUADRICS,
                      max(50, int(2000 * a.work)), {"contacts": 0.03, "height": 1e-4})
        restart = os.path.join(a.out, f"superquadrics.{blockiness}")
        if a.superquadrics:
            if not os.path.exists(restart):
                print(f"making {restart}", flush=True)
                settle_superquadrics(a, a.superquadrics, blockiness, restart)
            scene.add("LIGGGHTS, native",
                      partial(time_superquadrics, a, a.superquadrics, blockiness, restart, warmup),
                      [1e-3] if a.quick else [0.25e-3, 0.5e-3, 1e-3, 2e-3], scene.steps // 5)
        scene.runs["silt double"] = with_silt_bed(a, blockiness, warmup, scene.steps,
                                                  restart + ".rows" if a.superquadrics else None)
        yield scene


def balls(a):
    scene = Scene(f"{SUPERQUADRICS} balls, as spheres and as super-ellipsoids", SUPERQUADRICS,
                  max(50, int(5000 * a.work)), {"contacts": 0.05, "height": 5e-4})
    scene.runs = {"silt Sphere": with_silt_bed(a, "sphere", 500, scene.steps),
                  "silt SuperEllipsoid": with_silt_bed(a, "ball", 500, scene.steps)}
    yield scene


# --- polyhedra ------------------------------------------------------------------------------------

POLYHEDRA = 216


def polyhedra(a):
    state, warmup = os.path.join(a.out, "polyhedra.yade.gz"), 5 if a.quick else 50
    start, end = os.path.join(a.out, "polyhedra.bodies"), os.path.join(a.out, "polyhedra.end")
    silt = os.path.join(a.silt, "bench_polyhedra_bed")
    # Two laws of force: Yade's goes with the volume of the intersection.
    scene = Scene(f"{POLYHEDRA} polyhedra", POLYHEDRA, max(20, int(200 * a.work)),
                  {"contacts": 0.2, "height": 2e-4})

    def yade(skin, steps):
        if not os.path.exists(state):
            print(f"making {state}, which takes minutes", flush=True)
        out = codes.run(on_one_core(a.yade) + [os.path.join(DECKS, "yade_polyhedra.py"), state,
                                               str(warmup), str(steps), str(skin), start, end], a.out)
        return (codes.result_of(out)["seconds"],
                lambda: codes.values_of(codes.run([silt, "measure", end], a.out)))

    def with_silt():
        values = codes.result_of(codes.run([silt, "time", start, str(warmup), str(scene.steps)],
                                           a.out))
        return values["seconds"], lambda: values

    if a.yade:
        scene.add("Yade, Debian", yade, [0] if a.quick else [0, 2e-4, 1e-3], scene.steps // 10)
        scene.runs["silt double"] = with_silt
    yield scene


CASES = {"bodies": bodies, "super-ellipsoids": super_ellipsoids, "balls": balls,
         "polyhedra": polyhedra}


def table(scene, speed, ends, repeat):
    peers = [s for name, s in speed.items() if not name.startswith("silt")]
    best = max(peers, key=lambda s: s.median) if peers else None
    lines = [f"{scene.title}, {scene.steps} steps, median of {repeat} interleaved runs",
             "                               M/s  (spread)            over peer  contacts a particle"
             "  mean height   skin"]
    for name, s in speed.items():
        skin = scene.skins.get(name)
        line = f"  {name:23s}{s.text():>9s}  {s.spread()}".ljust(56)
        line += f"{s.over(best):>9s}" if best else " " * 9
        lines.append(line + f"  {ends[name]['contacts']:19.3f}  {1e3 * ends[name]['height']:8.3f} mm   "
                     + (f"{skin['skin']:g}" if skin else "its own"))
    return lines


def check(summary, scene, ends, quick):
    """That no code has lost particles, and that all have ended alike."""
    same = {name: e for name, e in ends.items() if name not in scene.apart}
    middle = {key: sorted(e[key] for e in same.values())[len(same) // 2]
              for key in ("contacts", "height")}
    for name, e in ends.items():
        at = f"{scene.title}, {name}: "
        number = next(e[key] for key in ("bodies", "particles") if key in e)
        summary.within(at + "particles", number, scene.particles, 0, "none may be lost")
        if name not in same:
            if not quick:  # some dozens of steps after the change it is still on its way
                summary.at_least(at + "contacts a particle", e["contacts"], middle["contacts"])
            continue
        summary.within(at + "contacts a particle", e["contacts"], middle["contacts"],
                       scene.alike["contacts"] * middle["contacts"],
                       "of the median of all codes")
        summary.within(at + "mean height [m]", e["height"], middle["height"], scene.alike["height"],
                       "of the median of all codes")


def main():
    p = Options(__doc__, "out/peers-shapes")
    p.add_argument("--silt", required=True, help="the folder of silt's benchmarks")
    p.add_argument("--repeat", type=in_range(int, 1, 1000), default=3)
    p.add_argument("--work", type=in_range(float, 1e-6, 1e6), default=1,
                   help="multiplies the number of steps that are timed")
    p.add_argument("--liggghts-superquadrics", metavar="PROGRAM",
                   help="a LIGGGHTS compiled with superquadrics; default: what ./run peers-native "
                        "has compiled")
    p.add_argument("--native", metavar="FOLDER", default=codes.NATIVE,
                   help="of LIGGGHTS as ./run peers-native compiles it")
    p.add_argument("--cases", nargs="+", choices=CASES, default=list(CASES))
    a = p.parse_args()
    if a.quick:
        a.repeat, a.work = 1, min(a.work, 0.02)
    a.silt = os.path.abspath(a.silt)
    for program in ("bench_bodies", "bench_super_ellipsoids_bed", "bench_polyhedra_bed"):
        codes.program(os.path.join(a.silt, program), "--silt")
    a.yade = shutil.which("yade")
    a.liggghts = {name: path for name, path in (("LIGGGHTS, Debian", shutil.which("liggghts")),
                                                ("LIGGGHTS, native", codes.native("liggghts", a.native)))
                  if path}
    a.superquadrics = (codes.program(a.liggghts_superquadrics, "--liggghts-superquadrics")
                       if a.liggghts_superquadrics
                       else codes.native("liggghts_superquadrics", a.native))
    a.out = make_folder(a.out)
    found = versions(os.path.join(a.silt, "bench_bodies"))
    found.update((name, codes.version_of(path)) for name, path in
                 [*a.liggghts.items(), ("LIGGGHTS, superquadrics", a.superquadrics),
                  ("Yade, Debian", a.yade)] if path)
    summary = Summary({"cases": a.cases, "work": a.work, "repeat": a.repeat, "quick": a.quick}, found)
    summary.results["unit"] = "million particle-steps per second"
    results = summary.results["scenes"] = []
    text = codes.head(found)
    print("\n".join(text), flush=True)
    for case in a.cases:
        for scene in CASES[case](a):
            if not scene.runs:
                print(f"{scene.title}: no code installed that runs it\n", flush=True)
                continue
            times, ends = codes.interleaved(scene.runs, a.repeat)
            speed = codes.speeds(times, scene.particles * scene.steps)
            lines = table(scene, speed, ends, a.repeat)
            print("\n".join(lines) + "\n", flush=True)
            text += lines + [""]
            check(summary, scene, ends, a.quick)
            results.append({"case": case, "title": scene.title, "particles": scene.particles,
                            "steps": scene.steps, "skins": scene.skins, "ends": ends,
                            "speed": {name: s.as_dict() for name, s in speed.items()}})
    write(os.path.join(a.out, "table.txt"), "\n".join(text))
    status = summary.end(a.out)
    print(f"Look at: {a.out}/table.txt, summary.json")
    return status


if __name__ == "__main__":
    sys.exit(main())
