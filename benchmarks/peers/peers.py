#!/usr/bin/env python3
# silt - BSD-3-Clause, see LICENSE
"""Times the same bed or hopper with the same contact law in LAMMPS, LIGGGHTS and silt.

Four states: a settled bed; the collapse of a loose lattice with all its list rebuilds ("filling"); the
settled bed under gravity tilted by 45 degrees, which flows against a side wall ("flowing"); and a square
hopper with walls at 45 degrees after a fifth of its spheres has left it ("hopper").
silt makes the positions and velocities once; every code starts from the same file and is timed by its
own loop clock after 200 steps to warm up, filling from the first step on. What comes
before the loop (reading, set-up, a peer's first list) and what comes after it (output) counts for no
code. LAMMPS and LIGGGHTS run with the fastest of the --skins, each for itself in each scene; silt
chooses its own, with its guard on. Runs are interleaved and repeated. Printed are medians in million
particle-steps a second with their spread, the ratio to the fastest peer on as many cores, and the state
each code ends in, measured by one program for all. A table, a plot and summary.json are written to
--out; checks: all codes have done the same work (no sphere lost; contacts, overlaps, heights and
energies alike; as many spheres out of the hopper).

With --cores 2 the peers run on two processes, LAMMPS with or without its balancing (`fix balance` by
recursive bisection), whichever is faster; LIGGGHTS-PUBLIC has none. silt runs on two threads,
and, with --silt-ranks, on two processes of one thread.

Debian's LAMMPS and LIGGGHTS are compiled for any machine of their kind. ./run peers-native compiles
both for this one; what it has left in build/peers is timed as further rows.
"""
import os
import sys

import codes
from report import Options, Summary, in_range, make_folder, versions, write

DIAMETER = 4.3e-3  # [m] mean
WEIGHT = 9.81 * 2500 * 3.14159265 / 6 * DIAMETER**3  # [N] of a sphere

# The law of LIGGGHTS and silt in LAMMPS' terms. Its `damping tsuji` takes Tsuji's polynomial, which is
# for the mass of one sphere, with the reduced mass of two: 0.5 would rebound with 0.616. 0.36665 gives
# the dashpot of 0.5. 0.9075: tangential dashpot over normal one, sqrt(8 G* / 2 E*). Stiffnesses are
# given as 4/3 E* and 8 G* for E = 1e6 and 0.3, as walls take E / 2(1 - nu) for E* from a material. "pre
# no" below: each start of a run puts the restitution of walls through the polynomial once more.
LAW = "hertz 732600.7 0.36665 tangential mindlin 904977.4 0.9075 0.4 damping tsuji"
LAMMPS = f"""
atom_style sphere
boundary f f f
processors * * 1
newton off
comm_modify vel yes
units si
read_data {{data}}
neighbor {{skin}} bin
neigh_modify delay 0 every 1 check yes
pair_style granular
pair_coeff * * {LAW}
{{balance}}
fix x1 all wall/gran granular {LAW} xplane 0.0 {{width}}
fix y1 all wall/gran granular {LAW} yplane 0.0 {{width}}
fix z1 all wall/gran granular {LAW} zplane 0.0 NULL
{{funnel}}
fix g all gravity 9.81 vector {{gravity}}
fix i all nve/sphere
timestep 0.00002
thermo 100000000
thermo_style custom step atoms ke
thermo_modify lost ignore norm no
run {{warmup}}
run {{steps}} pre no
write_dump all custom {{end}} id x y z radius
"""
LIGGGHTS = """
atom_style granular
atom_modify map array
boundary f f f
processors * * 1
newton off
communicate single vel yes
units si
soft_particles yes
read_data {data}
neighbor {skin} bin
neigh_modify delay 0
fix m1 all property/global youngsModulus peratomtype 1e6
fix m2 all property/global poissonsRatio peratomtype 0.3
fix m3 all property/global coefficientRestitution peratomtypepair 1 0.5
fix m4 all property/global coefficientFriction peratomtypepair 1 0.4
pair_style gran model hertz tangential history
pair_coeff * *
{balance}
fix x1 all wall/gran model hertz tangential history primitive type 1 xplane 0.0
fix x2 all wall/gran model hertz tangential history primitive type 1 xplane {width}
fix y1 all wall/gran model hertz tangential history primitive type 1 yplane 0.0
fix y2 all wall/gran model hertz tangential history primitive type 1 yplane {width}
fix z1 all wall/gran model hertz tangential history primitive type 1 zplane 0.0
{funnel}
fix g all gravity 9.81 vector {gravity}
fix i all nve/sphere
timestep 0.00002
thermo 100000000
thermo_style custom step atoms ke
thermo_modify lost ignore norm no
run {warmup}
run {steps}
write_dump all custom {end} id x y z radius
"""

# Every 500 steps, where a process has 2 % more spheres than the mean. LIGGGHTS-PUBLIC 3.8 has no fix balance.
BALANCE = {LAMMPS: ["", "comm_style tiled\nfix b all balance 500 1.02 rcb"], LIGGGHTS: [""]}


def lammps_funnel(stl):
    """The four sloping walls of the hopper in this STL file for LAMMPS, which has no mesh: slabs, whose
    upper faces and rims are those of the mesh. A sphere touches the nearest point of a slab's surface,
    rims included."""
    with open(stl) as f:
        corners = [[float(word) for word in line.split()[1:]] for line in f if line.split()[:1] == ["vertex"]]
    low, high = (pick(z for _, _, z in corners) for pick in (min, max))
    width = max(x for x, _, _ in corners)
    near = min(x for x, _, z in corners if z == low)  # from the box to the orifice
    far, thick = width - near, 5 * DIAMETER
    slabs = [f"{near - thick} {near} 0 {width} {low} {high} 0 {-near} 0",
             f"{far} {far + thick} 0 {width} {low} {high} 0 {near} 0",
             f"0 {width} {near - thick} {near} {low} {high} 0 0 {-near}",
             f"0 {width} {far} {far + thick} {low} {high} 0 0 {near}"]
    return "\n".join(f"region f{k} prism {slab} side out\nfix f{k} all wall/gran/region granular {LAW} region f{k}"
                     for k, slab in enumerate(slabs))


def liggghts_funnel(stl):
    return (f"fix f0 all mesh/surface file {stl} type 1\n"
            "fix f1 all wall/gran model hertz tangential history mesh n_meshes 1 meshes f0")


FUNNEL = {LAMMPS: lammps_funnel, LIGGGHTS: liggghts_funnel}
SCENE = {"settled": "level", "filling": "level", "flowing": "tilted", "hopper": "hopper"}  # of bench_bed


def run_silt(program, cores, precision, folder, data, warmup, steps, scene, ranks=False):
    end = os.path.join(folder, "silt.end")
    values = codes.result_of(codes.run(
        (codes.on_processes(cores) if ranks else []) + [program, "time", data, str(warmup), str(steps), str(cores), precision, end, scene], folder))
    return values["seconds"], values["kinetic_energy"], end


def measure(program, end):
    """Spheres, contacts a sphere, mean overlap, mean height and spheres out of the hopper of the state in
    a dump or data file."""
    if os.path.basename(end) in ("lmp.end", "liggghts.end"):
        with open(end + ".data", "w") as to:
            to.write("Atoms\n\n")
            for k, x, y, z, r in codes.rows_of_dump(end):
                to.write(f"{k} 1 {2 * float(r)} 2500 {x} {y} {z}\n")
        end += ".data"
    return codes.values_of(codes.run([program, "measure", end], None))


STATES = ("settled", "filling", "flowing", "hopper")


def check(summary, scene, n, ends):
    """That all codes have done the same work: a code that loses spheres or contacts is fast."""
    kinetic = {name: e["kinetic_energy_j"] / (n * WEIGHT * DIAMETER) for name, e in ends.items()}
    middle = {key: sorted(e[key] for e in ends.values())[len(ends) // 2]
              for key in ("coordination", "mean_overlap_over_d", "mean_height_m")}
    kinetic_middle = sorted(kinetic.values())[len(kinetic) // 2]
    # In a bed at rest the codes part by rounding and by the order of their steps alone; in one that
    # collapses or flows, contacts come and go, and their count is as good as its root.
    if ", settled," in scene:
        contacts, overlap, level, rest = 0.002, 0.002, 0.001, 1e-6
        reason = "0.2 % of the median of all codes: none comes or goes in a bed at rest"
    else:
        root = max(1.0, middle["coordination"] * n / 2) ** 0.5
        contacts, overlap, level, rest = 0.01 + 1 / root, 0.02 + 0.5 / root, 0.05, 1e-4
        reason = "1 or 2 % of the median of all codes, and what their number leaves open"
    # Spheres slide down the hopper's walls, where the codes' friction differs: without friction LAMMPS
    # and LIGGGHTS agree to 0.2 % after 2 200 steps of 20 000 spheres, with it they are 2.2 % apart, and
    # silt is between them.
    moving = 0.03 if ", hopper," in scene else 0.01
    for name, e in ends.items():
        at = f"{scene}, {name}: "
        summary.within(at + "spheres", e["spheres"], n, 0, "none may be lost")
        summary.within(at + "contacts a sphere", e["coordination"], middle["coordination"],
                       contacts * middle["coordination"], reason)
        summary.within(at + "mean overlap over d", e["mean_overlap_over_d"],
                       middle["mean_overlap_over_d"],
                       overlap * middle["mean_overlap_over_d"] + 1e-6, reason)
        summary.within(at + "mean height over d", e["mean_height_m"] / DIAMETER,
                       middle["mean_height_m"] / DIAMETER, level, "of a diameter")
        summary.within(at + "kinetic energy over weight times d", kinetic[name], kinetic_middle,
                       moving * kinetic_middle + rest,
                       f"{100 * moving:g} % of the median of all codes, or as good as at rest")
        if "left" in e:
            left = sorted(other["left"] for other in ends.values())[len(ends) // 2]
            summary.within(at + "spheres that left the hopper", e["left"], left, 2 + 0.02 * left,
                           "2 % of the median of all codes, and two that are about to")


def plot(results, path):
    try:
        import matplotlib
        matplotlib.use("Agg")
        import matplotlib.pyplot as plt
    except ImportError:
        return False
    states = [s for s in STATES if any(r["state"] == s for r in results)]
    cores = sorted({r["cores"] for r in results})
    colour = {"LAMMPS, Debian": "#8a8a8a", "LIGGGHTS, Debian": "#b9a26c", "LAMMPS, native": "#4d4d4d",
              "LIGGGHTS, native": "#7a6420", "silt double": "#1f6fb2", "silt mixed": "#c1440e",
              "silt double, AVX2": "#78aede", "silt mixed, AVX2": "#e59b7d",
              "silt double, ranks": "#17476f", "silt mixed, ranks": "#7d2b0a"}
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
        ax.set_xlabel("spheres"), ax.set_title(state if state == "hopper" else f"{state} bed")
        ax.grid(True, which="both", alpha=0.25)
    axes[0][0].set_ylabel("million particle-steps / s")
    axes[0][-1].legend(fontsize=7, loc="center left", bbox_to_anchor=(1.01, 0.5), frameon=False)
    fig.tight_layout()
    fig.savefig(path, dpi=150)
    return True


def timed(silt, start, *arguments, **values):
    """A code as codes.interleaved runs it."""
    def once():
        seconds, energy, end = start(*arguments, **values)
        return seconds, lambda: dict(kinetic_energy_j=energy, **measure(silt, end))
    return once


def bed_of(silt, folder, n, state):
    """The file of a bed in this state, made where it is not there."""
    data = os.path.join(folder, f"{state}.{n}")
    if os.path.exists(data):
        return data
    if state == "hopper":
        make = ["discharge", str(n), data + ".new", data + ".stl"]
    elif state == "flowing":  # for 0.06 s: by then all of it moves
        make = ["flow", bed_of(silt, folder, n, "settled"), "3000", data + ".new"]
    else:
        make = ["settle", str(n), "20000" if state == "settled" else "0", data + ".new"]
    print(f"making {data}", flush=True)
    codes.run([silt, *make], folder)
    os.replace(data + ".new", data)
    return data


def run_scene(a, folder, peers, silts, n, state, cores):
    """Times all codes on one scene: speeds, ends and skins."""
    silt = silts[0][1]
    data = bed_of(silt, folder, n, state)
    warmup = 0 if state == "filling" else 200
    # Filling: all of it for 5 000, the first impacts and the collapse of larger ones. Hopper: a hundredth
    # of 50 000 leaves, and not all of 5 000.
    work = {"filling": 1.25e8, "hopper": min(5e7, n * n / 10)}.get(state, 1e7)
    steps = max(50, int(a.work * work / n))
    before = measure(silt, data)["out"] if state == "hopper" else None
    common = dict(data=data, warmup=warmup, steps=steps)
    gravity = "0.70710678 0 -0.70710678" if state == "flowing" else "0 0 -1"
    runs, skins = {}, {}
    for name, program, deck in peers:
        funnel = FUNNEL[deck](data + ".stl") if state == "hopper" else ""
        values = dict(funnel=funnel, width=0.15 * max(1.0, n / 50000) ** 0.5, cores=cores, gravity=gravity, **common)
        skin, tried = codes.fastest(a.skins, lambda one: codes.run_deck(
            program, deck, folder, skin=one * 1e-3, balance="", **values)[0])
        values["skin"] = skin * 1e-3
        balance, balance_tried = codes.fastest(BALANCE[deck] if cores > 1 else [""], lambda one: codes.run_deck(
            program, deck, folder, balance=one, **values)[0])
        skins[name] = {"mm": skin, "seconds": {f"{k:g}": v for k, v in tried.items()},
                       "balanced": balance != "",
                       "seconds_without_and_with_balancing": list(balance_tried.values())}
        runs[name] = timed(silt, codes.run_deck, program, deck, folder, balance=balance, **values)
    for label, program in silts:
        for precision in ("double", "mixed"):
            runs[f"silt {precision}{label}"] = timed(
                silt, run_silt, program, cores, precision, folder,
                scene=SCENE[state], **common)
            if a.silt_ranks and label == "" and cores > 1:
                runs[f"silt {precision}, ranks"] = timed(
                    silt, run_silt, a.silt_ranks, cores, precision, folder, ranks=True,
                    scene=SCENE[state], **common)
    times, ends = codes.interleaved(runs, a.repeat)
    if state == "hopper":
        for e in ends.values():
            e["left"] = e["out"] - before
    return steps, codes.speeds(times, n * steps), ends, skins


def main():
    p = Options(__doc__, "out/peers")
    p.add_argument("--silt", required=True, help="the program bench_bed")
    p.add_argument("--silt-avx2", metavar="PROGRAM",
                   help="bench_bed compiled for AVX2, timed as further rows")
    p.add_argument("--silt-ranks", metavar="PROGRAM",
                   help="bench_bed_ranks, timed as further rows where there is more than one core")
    p.add_argument("--repeat", type=in_range(int, 1, 1000), default=5)
    p.add_argument("--cores", type=in_range(int, 1, 4096), nargs="+", default=[1])
    p.add_argument("--states", nargs="+", choices=STATES, default=STATES[:3])
    p.add_argument("--work", type=in_range(float, 1e-6, 1e6), default=1,
                   help="multiplies the number of steps that are timed")
    p.add_argument("--skins", type=in_range(float, 1e-3, 10), nargs="+", metavar="MM",
                   default=[0.2, 0.4, 0.6, 0.9, 1.3],
                   help="[mm] for the peers; more than one: all are tried, twice, and the fastest "
                        "taken")
    p.add_argument("--native", metavar="FOLDER", default=codes.NATIVE,
                   help="of LAMMPS and LIGGGHTS as ./run peers-native compiles them")
    p.add_argument("sizes", type=in_range(int, 100, 10**8), nargs="*", default=[])
    a = p.parse_args()
    if a.quick:
        a.repeat, a.work, a.skins = min(a.repeat, 2), min(a.work, 0.02), a.skins[:2]
    a.sizes = a.sizes or ([5000] if a.quick else [5000, 50000])
    silts = [("", codes.program(a.silt, "--silt"))]
    if a.silt_avx2:
        silts.append((", AVX2", codes.program(a.silt_avx2, "--silt-avx2")))
    if max(a.cores) > 1:
        codes.program("mpirun")
    if a.silt_ranks:
        a.silt_ranks = codes.program(a.silt_ranks, "--silt-ranks")
    peers = [("LAMMPS, Debian", codes.program("lmp"), LAMMPS),
             ("LIGGGHTS, Debian", codes.program("liggghts"), LIGGGHTS)]
    for name, program, deck in (("LAMMPS, native", "lmp", LAMMPS),
                                ("LIGGGHTS, native", "liggghts", LIGGGHTS)):
        if codes.native(program, a.native):
            peers.append((name, codes.native(program, a.native), deck))
    folder = make_folder(a.out)
    found = versions(silts[0][1])
    found.update((name, codes.version_of(program)) for name, program, _ in peers)
    summary = Summary({"particles": a.sizes, "states": a.states, "cores": a.cores, "work": a.work,
                       "repeat": a.repeat, "skins_mm": a.skins, "quick": a.quick}, found)
    summary.results["unit"] = "million particle-steps per second"
    results = summary.results["scenes"] = []
    table = codes.head(found)
    print("\n".join(table), flush=True)
    for n in a.sizes:
        for state in a.states:
            for cores in a.cores:
                steps, speed, ends, skins = run_scene(a, folder, peers, silts, n, state, cores)
                best = max((speed[name] for name, _, _ in peers), key=lambda s: s.median)
                scene = f"{n} spheres, {state}, {cores} core{'s' * (cores > 1)}"
                lines = [f"{scene}, {steps} steps, median of {a.repeat} interleaved runs",
                         "                        M/s  (spread)          over peer  kinetic energy  "
                         "contacts a sphere  mean overlap/d  skin"]
                for name, s in speed.items():
                    e = ends[name]
                    lines.append(
                        f"  {name:18s}{s.text():>9s}  {s.spread()}".ljust(47)
                        + f"{s.over(best):>9s}  {e['kinetic_energy_j']:12.4g} J  "
                        f"{e['coordination']:17.4f}  {e['mean_overlap_over_d']:14.5f}  "
                        + (f"{skins[name]['mm']:g} mm" + ", balanced" * skins[name]["balanced"]
                           if name in skins else "its own")
                        + (f", {e['left']:.0f} left" if "left" in e else ""))
                print("\n".join(lines) + "\n", flush=True)
                table += lines + [""]
                check(summary, scene, n, ends)
                results.append({"particles": n, "state": state, "cores": cores, "steps": steps,
                                "speed": {name: s.as_dict() for name, s in speed.items()},
                                "ends": ends, "skins": skins,
                                "double_over_fastest_peer": speed["silt double"].median / best.median,
                                "mixed_over_fastest_peer": speed["silt mixed"].median / best.median})
    write(os.path.join(folder, "table.txt"), "\n".join(table))
    drawn = plot(results, os.path.join(folder, "peers.png"))
    status = summary.end(folder)
    print(f"Look at: {a.out}/table.txt, summary.json" + (", peers.png" if drawn else ""))
    return status


if __name__ == "__main__":
    sys.exit(main())
