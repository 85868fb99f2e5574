# silt - BSD-3-Clause, see LICENSE
"""What the scripts that write reports share: options, summary.json with its checks, digits."""
import argparse
import json
import math
import os
import re
import statistics
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))


class Options(argparse.ArgumentParser):
    """Refuses arguments with one sentence and status 2, as the other programs do."""

    def __init__(self, description, out):
        super().__init__(description=description, allow_abbrev=False,
                         formatter_class=argparse.RawDescriptionHelpFormatter)
        self.add_argument("--out", default=out, help="folder for results")
        self.add_argument("--quick", action="store_true", help="a small run of the same, for a look")

    def error(self, message):
        refuse(f"{message}; --help lists the options")


def refuse(sentence):
    print(sentence, file=sys.stderr)
    sys.exit(2)


def in_range(kind, least, most):
    """For add_argument(type=...): a number in [least, most]."""
    def number(text):
        try:
            value = kind(text)
        except ValueError:
            value = math.nan
        if not least <= value <= most:
            raise argparse.ArgumentTypeError(f"{text} is no number in {least} to {most}")
        return value
    return number


def make_folder(path):
    try:
        os.makedirs(path, exist_ok=True)
    except OSError as e:
        refuse(f"cannot make the folder {path}: {e.strerror}")
    return os.path.abspath(path)


def write(path, text):
    """All of it or nothing."""
    with open(path + ".new", "w") as f:
        f.write(text)
        f.flush()
        os.fsync(f.fileno())
    os.replace(path + ".new", path)


def processor(cpuinfo="/proc/cpuinfo"):
    """Its name, and what tells apart those that are sold under one name; the widest lanes it has."""
    found = {}
    try:
        with open(cpuinfo) as f:
            for line in f:
                name, _, value = line.partition(":")
                found.setdefault(name.strip(), value.strip())
    except OSError:
        pass
    if "model name" not in found:
        return "unknown processor"
    flags = found.get("flags", "").split()
    lanes = next((name for flag, name in (("avx512f", "AVX-512"), ("avx2", "AVX2")) if flag in flags),
                 "SSE2")
    return (f"{found['model name']}, family {found.get('cpu family', '?')} model "
            f"{found.get('model', '?')}, {lanes}")


def versions(silt_program=None):
    """Of silt, of its program's build, and the processor."""
    found = {"silt": "unknown", "processor": processor()}
    with open(os.path.join(HERE, "..", "CMakeLists.txt")) as f:
        match = re.search(r"project\(silt VERSION ([0-9.]+)", f.read())
    if match:
        found["silt"] = match[1]
    folder = os.path.dirname(os.path.abspath(silt_program)) if silt_program else "/"
    while folder != "/" and not os.path.exists(os.path.join(folder, "CMakeCache.txt")):
        folder = os.path.dirname(folder)
    if folder != "/":
        with open(os.path.join(folder, "CMakeCache.txt")) as f:
            cache = dict(re.findall(r"^([A-Za-z_]+):[A-Z]+=(.*)$", f.read(), re.M))
        found["silt_flags"] = " ".join(
            [cache.get("CMAKE_CXX_FLAGS_" + cache.get("CMAKE_BUILD_TYPE", "").upper(), "")]
            + [f"-march={cache['SILT_MARCH']}"] * bool(cache.get("SILT_MARCH")))
        compiler = subprocess.run([cache.get("CMAKE_CXX_COMPILER", "c++"), "--version"],
                                  capture_output=True, text=True).stdout.splitlines()
        found["compiler"] = compiler[0] if compiler else "unknown"
    return found


class Summary:
    """Inputs, versions, results and checks of a run; ends as summary.json, in the form in which the
    examples write theirs."""

    def __init__(self, inputs, versions_):
        self.inputs, self.versions, self.results, self.checks = inputs, versions_, {}, []

    def at_most(self, name, value, limit):
        self._check(name, value, "<=", limit, value <= limit)

    def at_least(self, name, value, limit):
        self._check(name, value, ">=", limit, value >= limit)

    def within(self, name, value, reference, tolerance, reason):
        self._check(name, value, "within", tolerance, abs(value - reference) <= tolerance,
                    reference=reference, deviation=value - reference, reason=reason)

    def _check(self, name, value, relation, limit, holds, **more):
        # What is no number holds nothing, and JSON knows none.
        value = value if math.isfinite(value) else str(value)
        self.checks.append({"name": name, "value": value, "must_be": relation, "limit": limit,
                            **{k: v if isinstance(v, str) or math.isfinite(v) else str(v)
                               for k, v in more.items()}, "holds": bool(holds)})

    def all_hold(self):
        return bool(self.checks) and all(c["holds"] for c in self.checks)

    def write(self, folder):
        write(os.path.join(folder, "summary.json"),
              json.dumps({"inputs": self.inputs, "versions": self.versions, "results": self.results,
                          "checks": self.checks}, indent=2) + "\n")

    def print_checks(self):
        failed = [c for c in self.checks if not c["holds"]]
        print(f"{len(self.checks)} checks, {len(failed)} of them fail" if self.checks
              else "no check could be made")
        for c in failed:
            print(f"  FAIL {c['name']}: {c['value']}, must be "
                  + (f"within {c['limit']} of {c['reference']} ({c['reason']})"
                     if c["must_be"] == "within" else f"{c['must_be']} {c['limit']}"))

    def end(self, folder):
        """Writes and prints; the exit status."""
        self.write(folder)
        self.print_checks()
        return 0 if self.all_hold() else 1


# --- digits no finer than the spread --------------------------------------------------------------

def rounded(value, error):
    """`value` to the digit that half of `error` still reaches; two digits where error is unknown (0)."""
    if not math.isfinite(value) or value == 0:
        return str(value)
    two = math.floor(math.log10(abs(value))) - 1
    last = two if error <= 0 else min(math.floor(math.log10(2 * error)),
                                      math.floor(math.log10(abs(value))))
    last = max(last, math.floor(math.log10(abs(value))) - 3)  # four digits at most
    return f"{round(value, -last):.{max(0, -last)}f}"


class Speed:
    """Median, least and most of repeated runs."""

    def __init__(self, values):
        self.median, self.least, self.most = statistics.median(values), min(values), max(values)
        self.runs = len(values)

    def error(self):
        return (self.most - self.least) / 2 if self.runs > 1 else 0

    def text(self):
        return rounded(self.median, self.error())

    def spread(self):
        if self.runs == 1:
            return "(one run)"
        return f"({rounded(self.least, self.error())} to {rounded(self.most, self.error())})"

    def over(self, other):
        """The ratio of the medians as text, with the digits that both spreads leave."""
        ratio = self.median / other.median
        if self.runs == 1 or other.runs == 1:
            return rounded(ratio, 0)
        return rounded(ratio, ratio * (self.error() / self.median + other.error() / other.median))

    def as_dict(self):
        return {"median": self.median, "least": self.least, "most": self.most, "runs": self.runs}
