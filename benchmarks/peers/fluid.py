#!/usr/bin/env python3
# silt - BSD-3-Clause, see LICENSE
"""Times the fluidised bed of OpenFOAM's tutorial DPMFoam/Goldschmidt in DPMFoam and silt, each on
one core: 24 750 spheres of 2.5 mm, 5 400 cells, air at 1.875 m/s.

silt fluidises the tutorial's lattice, which DPMFoam would take half a day for; both go on from that
bed, at rest, for --span, of which the first tenth warms up and is not timed: reading, set-up and first
steps count for neither. Printed are the processor seconds a simulated second (a machine that is shared
does not change them much), medians of --repeat interleaved runs; the pressure under the bed, mean over
the last half, taken every 1 ms or at ten instants in both; and how far the spheres have risen. Both
solve the pressure to 1e-6, DPMFoam twice in a step (its tutorial's PISO), silt once; it takes the
tutorial's contacts, which its own settings resolve in at least 12 steps, silt in 20 or more. DPMFoam is
Debian's, compiled for any machine of its kind, as compiling OpenFOAM takes hours. A table and
summary.json are written to --out; checks: no sphere lost, nothing clipped, pressures and rises alike.
"""
import gzip
import os
import re
import shutil
import subprocess
import sys

import codes
from report import Options, Speed, Summary, in_range, make_folder, refuse, versions, write

TUTORIAL = "/usr/share/doc/openfoam-examples/examples/lagrangian/DPMFoam/Goldschmidt"
SPHERES, DENSITY, VOLUME = 24750, 2526, 8.1812e-9  # [-], [kg/m3], [m3]
CONTROL = """FoamFile {{ version 2.0; format ascii; class dictionary; object controlDict; }}
application DPMFoam;
startFrom startTime;
startTime 0;
stopAt endTime;
endTime {span};
deltaT 2e-5;
writeControl runTime;
writeInterval 1;
writeFormat ascii;
timePrecision 6;
functions
{{
    bottom
    {{
        type surfaceFieldValue;
        libs ("libfieldFunctionObjects.so");
        writeControl runTime;
        writeInterval {every};
        writeFields no;
        log no;
        regionType patch;
        name bottom;
        operation areaAverage;
        fields (p);
    }}
}}
"""


def foam(command, case):
    env = dict(codes.ONE_THREAD)
    env.setdefault("WM_PROJECT_DIR", "/usr/share/openfoam")
    done = subprocess.run([command], cwd=case, env=env, capture_output=True, text=True)
    if done.returncode:
        refuse(f"{command} did not finish:\n{done.stdout[-1000:]}{done.stderr[-2000:]}")
    return done.stdout


def dpmfoam(bed, span, out):
    case = os.path.join(out, "dpmfoam")
    shutil.rmtree(case, ignore_errors=True)
    shutil.copytree(TUTORIAL, case)
    places = os.path.join(case, "constant", "kinematicCloudPositions")
    with gzip.open(places + ".gz", "rt") as f:
        head = f.read().split("(\n", 1)[0]
    os.remove(places + ".gz")
    with open(bed) as rows, open(places, "w") as f:
        f.write(head + "(\n" + "".join(f"({row.strip()})\n" for row in rows) + ")\n")
    with open(os.path.join(case, "system", "controlDict"), "w") as f:
        f.write(CONTROL.format(span=span, every=min(1e-3, span / 10)))
    foam("blockMesh", case)
    log = foam("DPMFoam", case)
    # The processor time at the end of each step.
    clock = [(float(t), float(s)) for t, s in re.findall(
        r"^Time = (\S+)$.*?^ExecutionTime = ([0-9.]+) s", log, re.M | re.S)]
    begun = max((row for row in clock if row[0] <= 0.1 * span + 1e-9), default=clock[0])
    # The cloud's momentum at each of the steps.
    up = [float(x) for x in re.findall(r"Linear momentum +=\s*\(\S+ \S+ (\S+)\)", log)]
    rise = 2e-5 * sum(up) / (SPHERES * DENSITY * VOLUME)
    spheres = int(re.findall(r"Current number of parcels +=\s*(\d+)", log)[-1])
    with open(os.path.join(case, "postProcessing/bottom/0/surfaceFieldValue.dat")) as f:
        rows = [tuple(map(float, row.split())) for row in f if not row.startswith("#")]
    late = [1.2 * p for t, p in rows if t > 0.5 * span]  # DPMFoam's p is over the density
    return ((clock[-1][1] - begun[1]) / (clock[-1][0] - begun[0]),
            lambda: {"pressure_pa": sum(late) / len(late), "rise_m": rise, "spheres": spheres})


def silt(program, bed, span, mode, substeps, out):
    end = os.path.join(out, "end")
    first = mean_height(bed)
    values = codes.result_of(codes.run([program, "time", bed, str(span), mode, str(substeps), end],
                                       out))
    with open(end) as f:
        rows = [tuple(map(float, row.split())) for row in f]
    late = [p for t, p, _ in rows if t > 0.5 * span]
    return (values["seconds"] / values["timed"],
            lambda: {"pressure_pa": sum(late) / len(late), "rise_m": rows[-1][2] - first,
                     "spheres": int(values["spheres"]), "clipped": values["clipped"],
                     "momentum_error": values["momentum_error"],
                     "volume_error": values["volume_error"]})


def mean_height(bed):
    with open(bed) as f:
        heights = [float(row.split()[2]) for row in f]
    return sum(heights) / len(heights)


CENTRE = "silt, as DPMFoam: centre, 2e-5 s"


def check(summary, ends, span):
    """That spheres, volume and momentum are kept, and that all have computed the same bed."""
    weight = SPHERES * VOLUME * DENSITY * 9.81 / (0.015 * 0.15)  # [Pa] on the floor
    middle = ends.get("DPMFoam") or ends["silt, Kernel, 2e-5 s"]
    for name, e in ends.items():
        summary.within(f"{name}: spheres", e["spheres"], SPHERES, 0, "none may be lost")
        # The gas starts with a jerk; what is left after it lifts or drops no sphere by more.
        summary.within(f"{name}: rise [m]", e["rise_m"], middle["rise_m"],
                       max(5e-5, 0.2 * 9.81 * span**2 / 2), "a fifth of free fall, or 2 % of a diameter")
        if name.startswith("silt"):
            summary.at_most(f"{name}: volume error", e["volume_error"], 1e-10)
            summary.at_most(f"{name}: momentum error", e["momentum_error"], 1e-9)
            # Whole spheres in the cells of their centres overfill some: 0.6 % was seen.
            summary.at_most(f"{name}: solids clipped", e["clipped"], 1e-2 if name == CENTRE else 1e-3)
        if name != CENTRE:  # whose pressure jumps, docs/fluid.md
            summary.within(f"{name}: pressure over weight", e["pressure_pa"] / weight,
                           middle["pressure_pa"] / weight, 0.2 * middle["pressure_pa"] / weight,
                           "20 %: volumes in the centres' cells and by a kernel differ by 8 to 14 %")


def main():
    p = Options(__doc__, "out/peers-fluid")
    p.add_argument("--silt", required=True, help="the program bench_goldschmidt")
    p.add_argument("--span", type=in_range(float, 2e-4, 10), default=0.01,
                   help="simulated [s]; DPMFoam: 6 min a run at 0.01")
    p.add_argument("--repeat", type=in_range(int, 1, 1000), default=3)
    a = p.parse_args()
    if a.quick:
        a.span, a.repeat = min(a.span, 1e-3), 1
    program, out = codes.program(a.silt, "--silt"), make_folder(a.out)
    found = versions(program)
    bed = os.path.join(out, "bed.txt")
    if not os.path.exists(bed):
        print("silt fluidises the bed, which takes two minutes", flush=True)
        codes.run([program, "settle", bed], out)
    runs = {}
    if shutil.which("DPMFoam") and os.path.isdir(TUTORIAL):
        found["DPMFoam"] = "OpenFOAM, Debian's " + subprocess.run(
            ["dpkg-query", "-W", "openfoam"], capture_output=True, text=True).stdout.strip().replace("\t", " ")
        runs["DPMFoam"] = lambda: dpmfoam(bed, a.span, out)
    else:
        print("DPMFoam or its tutorials are not there (Debian: openfoam, openfoam-examples)")
    for name, mode, n in ((CENTRE, "centre", 4), ("silt, Kernel, 2e-5 s", "kernel", 4),
                          ("silt, Kernel, its own steps", "kernel", 0)):
        runs[name] = lambda mode=mode, n=n: silt(program, bed, a.span, mode, n, out)
    print("\n".join(codes.head(found)), flush=True)
    times, ends = codes.interleaved(runs, a.repeat)
    cost = {name: Speed(of) for name, of in times.items()}
    lines = codes.head(found) + [
        f"{SPHERES} spheres, {a.span} s, one core, median of {a.repeat} interleaved runs",
        "                                    s/simulated s  (spread)              faster"
        "  pressure [Pa]  rise [mm]"]
    for name, e in ends.items():
        s = cost[name]
        ratio = cost["DPMFoam"].over(s) if "DPMFoam" in cost else ""
        lines.append(f"  {name:34s}{s.text():>13s}  {s.spread()}".ljust(71)
                     + f"{ratio:>8s}{e['pressure_pa']:15.0f}{1e3 * e['rise_m']:11.3f}")
    print("\n".join(lines[len(codes.head(found)):]))
    write(os.path.join(out, "table.txt"), "\n".join(lines) + "\n")
    summary = Summary({"span_s": a.span, "repeat": a.repeat, "quick": a.quick}, found)
    summary.results = {"unit": "processor seconds a simulated second",
                       "cost": {name: s.as_dict() for name, s in cost.items()}, "ends": ends}
    check(summary, ends, a.span)
    status = summary.end(out)
    print(f"Look at: {a.out}/table.txt, summary.json")
    return status


if __name__ == "__main__":
    sys.exit(main())
