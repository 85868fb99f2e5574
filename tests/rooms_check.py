#!/usr/bin/env python3
# silt - BSD-3-Clause, see LICENSE
"""Reads every #include of the library against the order of its rooms.

A room may include itself and the rooms before it in ROOMS, never a later one. Rooms below `engine`
are shut: only `simulation` opens them; tests and benchmarks may look in. Intrinsics stand in `core`
alone. `rooms_check.py --self-test` shows that each of these rules can fail.
"""

import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent

# In order: each may include those before it. docs/architecture.md says what lies in each.
ROOMS = """
core files boundary shape contact motion search fill fluid coupling module
engine/state engine/lists engine/contact engine/spheres engine/convex engine/stages engine/advance
engine/checks engine/population engine simulation io study umbrella
""".split()
# Files that stand at the top of include/silt.
AT_TOP = {"simulation.hpp": "simulation", "silt.hpp": "umbrella", "fluid.hpp": "umbrella"}
INTRINSICS = re.compile(r"#include <(immintrin|x86intrin|arm_neon|xsimd/)|\b_mm\d*_\w+\(")


def room_of(header):
    """The room of a header, given by its path below include/silt; None where there is none."""
    parts = header.split("/")
    if len(parts) == 1:
        return AT_TOP.get(header)
    for name in ("/".join(parts[:2]), parts[0]):
        if name in ROOMS:
            return name
    return None


def faults_of(header, text):
    """What a header of the library may not include, in sentences."""
    room = room_of(header)
    if room is None:
        return [f"include/silt/{header} stands in no room; ROOMS in tests/rooms_check.py has them"]
    faults = []
    for other in re.findall(r'#include [<"]silt/([^>"]+)[>"]', text):
        to = room_of(other)
        if to is None:
            faults.append(f"include/silt/{header} includes silt/{other}, which stands in no room")
        elif ROOMS.index(to) > ROOMS.index(room) and not is_rest_of(header, other):
            faults.append(f"include/silt/{header} (room {room}) includes silt/{other} (room {to}), "
                          "which lies above it")
        elif to.startswith("engine") and not room.startswith("engine") and room != "simulation":
            faults.append(f"include/silt/{header} (room {room}) includes silt/{other}: the engine is "
                          "reached through silt/simulation.hpp alone")
    if room != "core" and INTRINSICS.search(text):
        faults.append(f"include/silt/{header} (room {room}) has intrinsics, which stand in core alone")
    return faults


def is_rest_of(header, other):
    """A part of the same class in a file of its own: simulation/ and simulation.hpp."""
    return room_of(header) == room_of(other)


def faults_of_user(name, text):
    """What an example or a program of the docs may not include."""
    return [f"{name} includes silt/{other}: the engine is reached through silt/simulation.hpp alone"
            for other in re.findall(r'#include [<"]silt/(engine/[^>"]+)[>"]', text)]


def self_test():
    assert faults_of("core/vec3.hpp", "#include <silt/search/nbs.hpp>")
    assert faults_of("engine/lists/pair_list.hpp", "#include <silt/engine/checks/guard.hpp>")
    assert faults_of("io/progress.hpp", "#include <silt/engine/checks/guard.hpp>")
    assert faults_of("attic/old.hpp", "")
    assert faults_of("search/nbs.hpp", "#include <silt/attic/old.hpp>")
    assert faults_of("search/nbs.hpp", "auto x = _mm256_add_pd(a, b);")
    assert faults_of_user("examples/a.cpp", "#include <silt/engine/checks/guard.hpp>")
    assert not faults_of("simulation/axes.hpp", "#include <silt/engine/checks/guard.hpp>")
    assert not faults_of("engine/checks/guard.hpp", "#include <silt/engine/lists/pair_list.hpp>")
    assert not faults_of("core/row4.hpp", "#include <immintrin.h>")


def main():
    if "--self-test" in sys.argv[1:]:
        return self_test()
    faults = []
    include = ROOT / "include" / "silt"
    for path in sorted(include.rglob("*.hpp")):
        faults += faults_of(path.relative_to(include).as_posix(), path.read_text())
    for folder in ("examples", "docs/code"):
        for path in sorted((ROOT / folder).rglob("*.[ch]pp")):
            faults += faults_of_user(path.relative_to(ROOT).as_posix(), path.read_text())
    print("\n".join(faults) if faults else f"{len(ROOMS)} rooms, no include leads upward")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
