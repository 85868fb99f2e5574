#!/usr/bin/env python3
# silt - BSD-3-Clause, see LICENSE
"""Loops over lanes that fill or read an array of rows must stand behind SILT_UNROLL (core/lanes.hpp).

g++ unrolls them by itself with -O3 only. With -O2, the flags of CMake's RelWithDebInfo, the rows went
through memory and a step took 2 to 2.5 times as long. `unrolled_check.py --self-test` shows that the
check can fail.
"""

import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
LOOP = re.compile(r"^\s*for \(std::size_t (\w+) = 0; \1 < (?:W|V|Chunks); \+\+\1\)(.*)$")
ROWS = re.compile(r"\b(rows?|velocity)\[\w+\]\s*(=|\.store)")


def faults(name, text):
    lines = text.split("\n")
    for number, line in enumerate(lines):
        loop = LOOP.match(line)
        if not loop:
            continue
        body = loop.group(2) if loop.group(2).strip() else lines[number + 1]
        if ROWS.search(body) and lines[number - 1].strip() != "SILT_UNROLL":
            yield f"{name}:{number + 1}: write SILT_UNROLL before the loop: {line.strip()}"


def self_test():
    loop = "  for (std::size_t lane = 0; lane < W; ++lane)\n    rows[lane] = Row::load(at[lane]);\n"
    kept = "  for (std::size_t lane = 0; lane < W; ++lane) most = max(most, lanes[lane]);\n"
    return (len(list(faults("a", "\n" + loop))) == 1 and not list(faults("a", "  SILT_UNROLL\n" + loop))
            and not list(faults("a", "\n" + kept)))


def main():
    if "--self-test" in sys.argv:
        return 0 if self_test() else print("unrolled_check.py: the self-test failed") or 1
    found = [fault for path in sorted((ROOT / "include/silt").rglob("*.hpp"))
             for fault in faults(path.relative_to(ROOT), path.read_text())]
    print("\n".join(found) or "all loops over rows of lanes are unrolled")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
