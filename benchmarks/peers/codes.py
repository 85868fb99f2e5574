# silt - BSD-3-Clause, see LICENSE
"""Running peers and silt on the same scene: what peers.py and shapes.py share."""
import os
import re
import statistics
import subprocess
import sys

ONE_THREAD = dict(os.environ, OMP_NUM_THREADS="1", OMPI_ALLOW_RUN_AS_ROOT="1",
                  OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")


def run(command, folder):
    """What the program prints; ends with its last lines where it fails."""
    out = subprocess.run(command, capture_output=True, text=True, cwd=folder, env=ONE_THREAD)
    if out.returncode != 0:
        sys.exit(f"{command[0]} did not finish:\n{out.stdout[-2000:]}{out.stderr[-2000:]}")
    return out.stdout


def run_deck(program, deck, folder, cores=1, **values):
    """Runs a deck of LAMMPS or LIGGGHTS: a run to warm up, then the one that is timed, and what it
    writes to files called {end}... . Returns seconds, kinetic energy [J] and the last such file."""
    name = os.path.basename(program)
    path, end = os.path.join(folder, name + ".in"), os.path.join(folder, name + ".end")
    with open(path, "w") as f:
        f.write(deck.format(end=end, **values))
    for old in os.listdir(folder):
        if old.startswith(name + ".end"):
            os.remove(os.path.join(folder, old))
    command = [program, "-in", path, "-log", "none"]
    if cores > 1:
        command = ["mpirun", "-np", str(cores), "--bind-to", "core"] + command
    out = run(command, folder)
    loops = [(m.start(), float(m[1])) for m in re.finditer(r"Loop time of ([0-9.eE+-]+)", out)]
    ends = sorted(file for file in os.listdir(folder) if file.startswith(name + ".end"))
    if len(loops) < 2 or not ends:
        sys.exit(f"{program} did not finish:\n{out[-2000:]}")
    at, seconds = loops[1]
    energy = re.findall(r"^\s*\d+\s+\d+\s+([0-9.eE+-]+)", out[:at], re.M)
    return seconds, float(energy[-1]), os.path.join(folder, ends[-1])


def rows_of_dump(path, kind="ATOMS"):
    """The lines of a dump of LAMMPS or LIGGGHTS, as words."""
    with open(path) as f:
        rows = False
        for line in f:
            if rows:
                yield line.split()
            rows = rows or line.startswith("ITEM: " + kind)


def values_of(line):
    words = line.split()
    return dict(zip(words[::2], map(float, words[1::2])))


def result_of(out):
    """The values of the line 'seconds ...' that a program has printed among others."""
    return values_of(next(line for line in out.splitlines() if line.startswith("seconds ")))


def interleaved(codes, repeat):
    """Runs all codes by turns. A code is a function that returns seconds and a function that
    measures the state it has left behind. Returns the seconds of all runs and the first states."""
    times, ends = {name: [] for name in codes}, {}
    for _ in range(repeat):
        for name, code in codes.items():
            seconds, measure = code()
            times[name].append(seconds)
            if name not in ends:
                ends[name] = measure()
    return times, ends


def speeds(times, work):
    """Median and spread, in million of `work` a second."""
    return {name: {"median": work / statistics.median(t) / 1e6, "least": work / max(t) / 1e6,
                   "most": work / min(t) / 1e6} for name, t in times.items()}
