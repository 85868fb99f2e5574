# silt - BSD-3-Clause, see LICENSE
"""Running peers and silt on the same scene: what peers.py, shapes.py and fluid.py share."""
import os
import re
import shutil
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(HERE))
import report  # noqa: E402

NATIVE = os.path.join(HERE, "..", "..", "build", "peers")  # where native.sh puts what it compiles

ONE_THREAD = dict(os.environ, OMP_NUM_THREADS="1", OMPI_ALLOW_RUN_AS_ROOT="1",
                  OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")


def run(command, folder):
    """What the program prints; ends with its last lines where it fails."""
    out = subprocess.run(command, capture_output=True, text=True, cwd=folder, env=ONE_THREAD)
    if out.returncode != 0:
        report.refuse(f"{command[0]} did not finish:\n{out.stdout[-2000:]}{out.stderr[-2000:]}")
    return out.stdout


def program(name, option=None):
    """The path of a program that an option names; refuses what is not there."""
    found = shutil.which(name)
    if not found:
        report.refuse(f"{option} {name}: there is no such program" if option else
                      f"{name} is not installed; ./run installs it on Debian")
    return os.path.abspath(found)


def native(name, folder):
    """A peer that native.sh has compiled, or None."""
    path = os.path.join(folder, name)
    return os.path.abspath(path) if os.access(path, os.X_OK) and os.path.isfile(path) else None


def version_of(path):
    """Of LAMMPS, LIGGGHTS or Yade, as the program itself says it; with the compiler's options, where
    native.sh has compiled it."""
    try:
        with tempfile.TemporaryDirectory() as folder:  # for its log
            out = subprocess.run([path, "--version" if "yade" in os.path.basename(path) else "-h"],
                                 capture_output=True, text=True, env=ONE_THREAD, timeout=60,
                                 input="", cwd=folder).stdout
    except (OSError, subprocess.TimeoutExpired) as e:
        return f"unknown ({e})"
    for pattern in (r"Parallel Simulator - ([^\n]+)", r"LIGGGHTS-[^,\n]*", r"Yade version: ([^,\n]+)"):
        match = re.search(pattern, out)
        if match:
            version = match[0] if not match.groups() else match[1]
            break
    else:
        version = "unknown"
    owner = subprocess.run(["dpkg-query", "-S", os.path.realpath(path)], capture_output=True,
                           text=True).stdout.partition(":")[0] if shutil.which("dpkg-query") else ""
    if owner:
        version += ", Debian's " + subprocess.run(["dpkg-query", "-W", owner], capture_output=True,
                                                  text=True).stdout.strip().replace("\t", " ")
    if os.path.exists(path + ".flags"):
        with open(path + ".flags") as f:
            version += ", compiled here with " + f.read().strip()
    return version


def on_processes(number):
    """The words before a program that start it on so many, each on a core of its own."""
    return ["mpirun", "-np", str(number), "--bind-to", "core"]


def run_deck(program, deck, folder, cores=1, **values):
    """Runs a deck of LAMMPS or LIGGGHTS: a run to warm up, then the one that is timed, and what it
    writes to files called {end}... afterwards. Returns seconds, kinetic energy [J] and the last such
    file."""
    name = os.path.basename(program)
    path, end = os.path.join(folder, name + ".in"), os.path.join(folder, name + ".end")
    with open(path, "w") as f:
        f.write(deck.format(end=end, **values))
    for old in os.listdir(folder):
        if old.startswith(name + ".end"):
            os.remove(os.path.join(folder, old))
    command = [program, "-in", path, "-log", "none"]
    if cores > 1:
        command = on_processes(cores) + command
    out = run(command, folder)
    loops = [(m.start(), float(m[1])) for m in re.finditer(r"Loop time of ([0-9.eE+-]+)", out)]
    ends = sorted(file for file in os.listdir(folder) if file.startswith(name + ".end"))
    if len(loops) < 2 or not ends:
        report.refuse(f"{program} did not finish:\n{out[-2000:]}")
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
    """Medians and spreads, in million of `work` a second."""
    return {name: report.Speed([work / t / 1e6 for t in of]) for name, of in times.items()}


def fastest(settings, once):
    """Runs once(setting) for each of the settings by turns, twice if there are several, and returns
    the fastest one and the least seconds of all."""
    if len(settings) == 1:
        return settings[0], {}
    least = {}
    for _ in range(2):
        for setting in settings:
            least[setting] = min(once(setting), least.get(setting, float("inf")))
    return min(least, key=least.get), least


def head(found):
    """Lines for the top of a table: the processor and all versions."""
    return [found["processor"]] + [f"  {name}: {value}" for name, value in found.items()
                                   if name != "processor"] + [""]
