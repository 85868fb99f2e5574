#!/usr/bin/env python3
# silt - BSD-3-Clause, see LICENSE
"""Times the fluidised bed of OpenFOAM's tutorial DPMFoam/Goldschmidt in DPMFoam and silt, each on
one core: 24 750 spheres of 2.5 mm, 5 400 cells, air at 1.875 m/s.

silt fluidises the tutorial's lattice, which DPMFoam would take half a day for; both go on from that
bed, at rest, for --span. Printed are the processor seconds a simulated second (a machine that is
shared does not change them much), the pressure under the bed, mean over the last half, and how far
the spheres have risen. A table is written to --out.
"""
import argparse
import gzip
import os
import re
import shutil
import subprocess
import sys

import codes

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
        writeControl timeStep;
        writeInterval 1;
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
        sys.exit(f"{command} did not finish:\n{done.stdout[-1000:]}{done.stderr[-2000:]}")
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
        f.write(CONTROL.format(span=span))
    foam("blockMesh", case)
    log = foam("DPMFoam", case)
    seconds = float(re.findall(r"ExecutionTime = ([0-9.]+) s", log)[-1])
    # The cloud's momentum at each of the steps.
    up = [float(x) for x in re.findall(r"Linear momentum +=\s*\(\S+ \S+ (\S+)\)", log)]
    rise = 2e-5 * sum(up) / (SPHERES * DENSITY * VOLUME)
    with open(os.path.join(case, "postProcessing/bottom/0/surfaceFieldValue.dat")) as f:
        rows = [tuple(map(float, row.split())) for row in f if not row.startswith("#")]
    late = [1.2 * p for t, p in rows if t > 0.5 * span]  # DPMFoam's p is over the density
    return seconds / span, sum(late) / len(late), rise


def silt(program, bed, span, mode, substeps, out):
    end = os.path.join(out, "end")
    first = mean_height(bed)
    values = codes.result_of(codes.run([program, "time", bed, str(span), mode, str(substeps), end],
                                       out))
    with open(end) as f:
        rows = [tuple(map(float, row.split())) for row in f]
    late = [p for t, p, _ in rows if t > 0.5 * span]
    return values["seconds"] / rows[-1][0], sum(late) / len(late), rows[-1][2] - first


def mean_height(bed):
    with open(bed) as f:
        heights = [float(row.split()[2]) for row in f]
    return sum(heights) / len(heights)


def main():
    p = argparse.ArgumentParser(description=__doc__,
                                formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--silt", required=True, help="the program bench_goldschmidt")
    p.add_argument("--span", type=float, default=0.01, help="simulated [s]; DPMFoam: 6 min")
    p.add_argument("--out", default="out/peers-fluid")
    a = p.parse_args()
    program, out = os.path.abspath(a.silt), os.path.abspath(a.out)
    os.makedirs(out, exist_ok=True)
    bed = os.path.join(out, "bed.txt")
    if not os.path.exists(bed):
        print("silt fluidises the bed, which takes two minutes", flush=True)
        codes.run([program, "settle", bed], out)
    runs = [("silt, as DPMFoam: centre, 2e-5 s", "centre", 4), ("silt, Kernel, 2e-5 s", "kernel", 4),
            ("silt, Kernel, its own steps", "kernel", 0)]
    results = [(name, *silt(program, bed, a.span, mode, n, out)) for name, mode, n in runs]
    if shutil.which("DPMFoam") and os.path.isdir(TUTORIAL):
        print(f"DPMFoam runs {a.span} s", flush=True)
        results.insert(0, ("DPMFoam", *dpmfoam(bed, a.span, out)))
    else:
        print("DPMFoam or its tutorials are not there (Debian: openfoam, openfoam-examples)")
    lines = [f"{SPHERES} spheres, {a.span} s, one core",
             "                                    s/simulated s  faster  pressure [Pa]  rise [mm]"]
    for name, cost, pressure, rise in results:
        ratio = results[0][1] / cost if results[0][0] == "DPMFoam" else float("nan")
        lines.append(f"  {name:34s}{cost:13.0f}{ratio:8.1f}{pressure:15.0f}{1e3 * rise:11.3f}")
    print("\n".join(lines))
    with open(os.path.join(out, "table.txt"), "w") as f:
        f.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
