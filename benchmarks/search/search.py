#!/usr/bin/env python3
# silt - BSD-3-Clause, see LICENSE
"""Runs bench_search, prints its tables, fits growth exponents and draws log-log plots.

Times are processor time of one thread, build and query together, in ns a sphere (of which build, of
searches that have it apart): the least of --repeat rounds, which are interleaved. "In order": the
spheres have been sorted by the search's own order() before, as a Verlet list does. The lists of LAMMPS
and LIGGGHTS, if they are installed, are built on the same spheres in that order and with the same
reach, and timed by their own clocks ("Neigh"), the least of as many rounds; they are compared with
HashedGrid in order, the k-d tree, which has the spheres as they come, with HashedGrid on the same.
LAMMPS and LIGGGHTS as ./run peers-native compiles them have rows of their own; Debian's are compiled
for any machine of their kind.

Results: OUT/summary.json, *.png. Checks: all searches find the same pairs, the peers as many; spheres
that collide touch as many others with each search.
"""
import collections
import json
import math
import os
import re
import shutil
import subprocess
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "peers"))
import codes  # noqa: E402
from report import Options, Summary, in_range, make_folder, refuse, versions  # noqa: E402

COLOURS = ["#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#D55E00", "#F0E442", "#555555"]
SUBS = ["sub-grid 1/%d" % k for k in (1, 2, 3, 4, 5, 6, 8, 10)]
PIECES = "HashedGrid, pieces"  # does not look for all pairs
NEARLY_THE_SAME = [PIECES, "HashedGrid, in order", "HashedGrid, one level", "CellGrid, in order"]  # in a plot
PEER = """
units si
atom_style {style}
{map}boundary f f f
newton off
comm_modify vel yes
{soft}read_data {data}
neighbor 0.1 bin
neigh_modify every 1 delay 0 check no
{law}
fix i all nve/sphere
timestep 1e-12
thermo 1000000
thermo_modify lost ignore norm no
run 20
"""
LIGGGHTS_LAW = """fix m1 all property/global youngsModulus peratomtype 1e6
fix m2 all property/global poissonsRatio peratomtype 0.3
fix m3 all property/global coefficientRestitution peratomtypepair 1 0.5
fix m4 all property/global coefficientFriction peratomtypepair 1 0.4
pair_style gran model hertz tangential history
pair_coeff * *"""


def run_bench(program, pattern, seconds):
    out = subprocess.run([program, "--benchmark_filter=" + pattern, "--benchmark_format=json",
                          f"--benchmark_min_time={seconds}"], capture_output=True, text=True)
    if out.returncode != 0:
        refuse(f"bench_search did not finish: {out.stderr}")
    return json.loads(out.stdout)["benchmarks"]


def collect(rounds):
    """results[group][search][n] = {ns, bytes, pairs}, the least time of all rounds."""
    results = collections.defaultdict(lambda: collections.defaultdict(dict))
    for row in (row for one in rounds for row in one):
        kind, group, rest = row["name"].split("/", 2)
        if kind == "drive":
            key, name, n = "drive " + group, rest, 20000
        else:
            key, (name, n) = group, rest.rsplit("/", 1)
        one = results[key][name].setdefault(int(n), {"ns": math.inf})
        one["ns"] = min(one["ns"], 1e9 / row["items_per_second"])
        for field in ("bytes", "pairs", "sum", "touching", "label"):
            if field in row:
                one[field] = row[field]
        if "build" in row:
            one["build"] = min(one.get("build", math.inf), row["build"])
    return results


def exponent(points):
    """Slope of log(total time) over log(n), least squares; needs two sizes."""
    xs = [math.log(n) for n in points]
    ys = [math.log(n * p["ns"]) for n, p in points.items()]
    if len(xs) < 2:
        return None
    mx, my = sum(xs) / len(xs), sum(ys) / len(ys)
    return sum((x - mx) * (y - my) for x, y in zip(xs, ys)) / sum((x - mx) ** 2 for x in xs)


def print_growth(results):
    for scene in ("dense bed", "cloud", "jets"):
        if scene not in results:
            continue
        sizes = sorted({n for of in results[scene].values() for n in of})
        print(f"\n{scene}: ns a sphere at N = {', '.join(f'{n:g}' for n in sizes)}, of which build; "
              "bytes a sphere; exponent from 1e4 on")
        for name, of in results[scene].items():
            slope = exponent({n: p for n, p in of.items() if n >= 10000})
            cells = " ".join((f"{of[n]['ns']:7.1f}" + (f" ({of[n]['build']:5.1f})" if "build" in of[n]
                                                       else " " * 8)) if n in of else " " * 15
                             for n in sizes)
            held = of[max(of)].get("bytes", 0)
            print(f"  {name:24s} {cells}  " + (f"{held:8.1f} B" if held else " " * 10)
                  + (f"  {slope:5.2f}" if slope else ""))


def print_sizes(results):
    groups = [g for g in results if ":" in g]
    for kind in ("two sizes", "fragments"):
        mine = [g for g in groups if g.startswith(kind)]
        if not mine:
            continue
        print(f"\n{kind}: ns a sphere by size ratio {', '.join(g.split(' 1:')[1] for g in mine)}")
        names = list(dict.fromkeys(n for g in mine for n in results[g]))
        for name in names:
            values = [min(p["ns"] for p in results[g][name].values()) if name in results[g] else None
                      for g in mine]
            print(f"  {name:24s} " + " ".join(f"{v:9.1f}" if v else " " * 9 for v in values))
        one, levels = ([min(p["ns"] for p in results[g][n].values()) for g in mine]
                       for n in ("HashedGrid, one level", "HashedGrid"))
        print(f"  {'levels over one level':24s} " + " ".join(f"{a / b:8.1f}x" for a, b in zip(one, levels)))


def print_drive(results):
    groups = [g for g in results if g.startswith("drive ")]
    if not groups:
        return
    print(f"\n20 000 spheres that collide: ns a step and sphere, by travel a step over diameter "
          f"{', '.join(g.split()[1] for g in groups)}")
    for name in results[groups[0]]:
        print(f"  {name:24s} " + " ".join(f"{results[g][name][20000]['ns']:9.1f}" for g in groups))


def time_peers(program, folder, scene, n, rounds, native):
    """ns a sphere of one build of the neighbour list, by each peer's own clock, and how many pairs a
    sphere the list holds."""
    data = os.path.join(folder, "points.data")
    codes.run([program, "points", scene, str(n), data], folder)
    lammps = dict(style="sphere", map="", soft="", law="pair_style gran/hertz/history "
                  "1e6 NULL 0 NULL 0.4 1\npair_coeff * *")
    liggghts = dict(style="granular", map="atom_modify map array\n", soft="soft_particles yes\n",
                    law=LIGGGHTS_LAW)
    peers = {"LAMMPS, Debian": (shutil.which("lmp"), lammps),
             "LIGGGHTS, Debian": (shutil.which("liggghts"), liggghts),
             "LAMMPS, native": (codes.native("lmp", native), lammps),
             "LIGGGHTS, native": (codes.native("liggghts", native), liggghts)}
    found = {}
    for name, (peer, settings) in (one for _ in range(rounds) for one in peers.items()):
        if not peer:
            continue
        text = PEER.format(data=data, **settings)
        if settings is liggghts:
            text = text.replace("comm_modify vel yes", "communicate single vel yes")
        deck = os.path.join(folder, os.path.basename(peer) + ".in")
        with open(deck, "w") as f:
            f.write(text)
        out = codes.run([peer, "-in", deck, "-log", "none"], folder)
        seconds = re.search(r"^Neigh\s*(?:\||time \(%\) =)\s*([0-9.e+-]+)", out, re.M)
        builds = re.search(r"^Neighbor list builds = (\d+)", out, re.M)
        pairs = re.search(r"^Total # of neighbors = (\d+)", out, re.M)
        if not seconds or not builds or not pairs:
            refuse(f"{peer} did not print what it does: {out[-500:]}")
        one = found.setdefault(name, {"ns": math.inf, "program": peer})
        one["ns"] = min(one["ns"], 1e9 * float(seconds[1]) / int(builds[1]) / n)
        one["pairs"] = int(pairs[1]) / n
    return found


def print_peers(results, peers):
    for (scene, n), found in peers.items():
        ours = {name: of[n] for name, of in results[scene].items() if n in of}
        print(f"\n{scene}, {n} spheres, ns a sphere, and over HashedGrid on spheres that lie alike")
        rows = [("k-d tree (nanoflann)", ours.get("k-d tree (nanoflann)"), "HashedGrid")]
        rows += [(f"{name}, list build", one, "HashedGrid, in order") for name, one in found.items()]
        for name, one, to in rows:
            if one and to in ours:
                print(f"  {name:28s} {one['ns']:9.1f}  {one['ns'] / ours[to]['ns']:6.1f}x  "
                      f"({to}: {ours[to]['ns']:.1f})")


def check(summary, results, peers):
    """All searches must have found the same pairs, whatever their times."""
    for group, searches in results.items():
        field = "touching" if group.startswith("drive ") else "sum"
        for n in sorted({n for of in searches.values() for n in of}):
            found = {name: of[n] for name, of in searches.items() if n in of and name != PIECES}
            values = collections.Counter(one.get(field) for one in found.values())
            usual = values.most_common(1)[0][0]
            others = [name for name, one in found.items() if one.get(field) != usual]
            what = "touch other pairs" if field == "touching" else "find other pairs"
            summary.at_most(f"{group}, {n}: searches of {len(found)} that {what}"
                            + (f" ({', '.join(others)})" if others else ""), len(others), 0)
    for (scene, n), found in peers.items():
        mine = results.get(scene, {}).get("HashedGrid", {}).get(n)
        for name, one in found.items():
            if mine:
                summary.within(f"{scene}, {n}, {name}: pairs a sphere", one["pairs"], mine["pairs"],
                               1e-4 * mine["pairs"], "the same spheres and reach")


def draw(results, folder):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    def finish(figure, axes, name):
        for ax in axes:
            ax.grid(True, which="major", color="0.88", lw=0.8)
            ax.set_axisbelow(True)
            ax.spines[["top", "right"]].set_visible(False)
        axes[-1].legend(fontsize=8, loc="center left", bbox_to_anchor=(1.01, 0.5), frameon=False)
        figure.tight_layout()
        figure.savefig(os.path.join(folder, name), dpi=150)
        plt.close(figure)

    scenes = [s for s in ("dense bed", "cloud", "jets") if s in results]
    if scenes:
        figure, axes = plt.subplots(1, len(scenes), figsize=(4.2 * len(scenes) + 1.5, 4), sharey=True,
                                    squeeze=False)
        names = [n for n in results[scenes[0]] if n not in NEARLY_THE_SAME]
        for ax, scene in zip(axes[0], scenes):
            for k, name in enumerate(names):
                of = results[scene].get(name, {})
                ax.loglog(sorted(of), [1e-9 * n * of[n]["ns"] for n in sorted(of)], marker="o", ms=4,
                          color=COLOURS[k % 8], ls="-" if k < 8 else "--", label=name)
            ax.set_xlabel("spheres"), ax.set_title(scene)
        axes[0][0].set_ylabel("time of a search [s]")
        finish(figure, axes[0], "growth.png")
    for kind in ("two sizes", "fragments"):
        mine = [g for g in results if g.startswith(kind)]
        if not mine:
            continue
        figure, (left, right) = plt.subplots(1, 2, figsize=(10.5, 4))
        ratios = [int(g.split(":")[1]) for g in mine]
        names = [n for n in results[mine[0]] if n not in SUBS
                 and (n not in NEARLY_THE_SAME or n == "HashedGrid, one level")]
        for k, name in enumerate(names):
            ys = [min((p["ns"] for p in results[g][name].values()), default=math.nan) for g in mine]
            left.loglog(ratios, ys, marker="o", ms=4, color=COLOURS[k % 8],
                        ls="-" if k < 8 else "--", label=name)
        left.set_xticks(ratios, [str(r) for r in ratios]), left.minorticks_off()
        left.set_xlabel("largest over smallest diameter"), left.set_ylabel("ns a sphere")
        left.legend(fontsize=7, frameon=False)
        for k, g in enumerate(mine):
            points = [(1 / int(s.split("/")[1]), min(p["ns"] for p in results[g][s].values()))
                      for s in SUBS if s in results[g]]
            if points:
                right.loglog(*zip(*points), marker="o", ms=4, color=COLOURS[k % 8], label=g)
        widths = [1, 0.5, 0.25, 0.125]
        right.set_xticks(widths, ["1", "1/2", "1/4", "1/8"]), right.minorticks_off()
        right.set_xlabel("width of the sub-grid's cells over those of the coarse")
        right.set_ylabel("ns a sphere")
        finish(figure, [left, right], kind.replace(" ", "_") + ".png")


def main():
    parser = Options(__doc__, "out/search")
    parser.add_argument("--bench", required=True, help="the program bench_search")
    parser.add_argument("--repeat", type=in_range(int, 1, 1000), default=3)
    parser.add_argument("--alone", action="store_true", help="without LAMMPS and LIGGGHTS")
    parser.add_argument("--native", metavar="FOLDER", default=codes.NATIVE,
                        help="of LAMMPS and LIGGGHTS as ./run peers-native compiles them")
    options = parser.parse_args()
    bench = codes.program(options.bench, "--bench")
    folder = make_folder(options.out)
    rounds = 1 if options.quick else options.repeat
    largest = 10000 if options.quick else 100000
    patterns = (["search/(dense bed|cloud|jets)/.*/(1000|10000)$",
                 "search/.*:(1|10)/(Hashed|Cell|Nbs|Auto|sub-grid 1/[48])", "drive/.*01/"]
                if options.quick else ["."])
    results = collect([run_bench(bench, p, 0.002 if options.quick else 0.1)
                       for _ in range(rounds) for p in patterns])
    peers = {} if options.alone else {
        (s, largest): time_peers(bench, folder, s, largest, rounds, options.native)
        for s in ("dense bed",)}
    found = versions(bench)
    found.update((name, codes.version_of(one["program"])) for of in peers.values()
                 for name, one in of.items())
    print("\n".join(codes.head(found)))
    print_growth(results), print_sizes(results), print_drive(results), print_peers(results, peers)
    for name, of in (("dense bed", results["dense bed"]), ("cloud", results["cloud"])):
        if "AutoSearch" in of:
            print(f"\nAutoSearch, {name}: {of['AutoSearch'][max(of['AutoSearch'])].get('label')}")
    summary = Summary({"quick": options.quick, "repeat": rounds}, found)
    summary.results = {"unit": "ns a sphere", "searches": results,
                       "peers": [{"scene": s, "n": n, **v} for (s, n), v in peers.items()]}
    check(summary, results, peers)
    try:
        draw(results, folder)
    except ImportError:
        print("no plots: matplotlib is missing (Debian: apt-get install python3-matplotlib)")
    print()
    status = summary.end(folder)
    print(f"Look at: {options.out}/summary.json, *.png")
    return status


if __name__ == "__main__":
    sys.exit(main())
