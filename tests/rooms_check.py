#!/usr/bin/env python3
# silt - BSD-3-Clause, see LICENSE
"""Reads every #include of the library against the order of its rooms.

A room may include itself and the rooms before it in ROOMS, never a later one. Rooms below `engine`
are shut: only `simulation` opens them; tests and benchmarks may look in. Intrinsics stand in `core`
alone. Scenes of the large examples include silt and parts of the scene alone. `rooms_check.py
--self-test` shows that each of these rules can fail; `--draw` draws the rooms anew
(docs/pictures/rooms.svg), which the check wants to be those of today.
"""

import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent

# In order: each may include those before it. docs/architecture.md says what lies in each.
ROOMS = """
core files parallel boundary shape contact motion search fill bond breakage fluid coupling sph module
engine/state engine/ranks engine/lists engine/contact engine/spheres engine/convex engine/stages engine/advance
engine/checks engine/population engine simulation measure io study umbrella
""".split()
# The picture: floors from the top down, each room with what lies in it.
FLOORS = [
    [("io", "observers, checkpoints, CSV and VTK"), ("study", "error against run time")],
    [("measure", "stress, coordination, wall loads, coarse-grained fields")],
    [("simulation", "Simulation: policies, the loop, what users read and set")],
    [("engine", "the state, and each stage of a step as a function")],
    [("engine/population", "inlets, outlets"), ("engine/checks", "guard, time step"),
     ("engine/advance", "integration"), ("engine/stages", "forces of modules")],
    [("engine/spheres", "geometry of spheres, in lanes"),
     ("engine/convex", "geometry of convex parts")],
    [("engine/contact", "the contact stage: law, rolling, energy, events, fluxes")],
    [("engine/lists", "who may touch soon; what contacts remember"),
     ("engine/ranks", "who owns what, ghosts, migration")],
    [("engine/state", "composition, columns, rows")],
    [("coupling", "drag, averaging"), ("sph", "free surfaces"), ("module", "Field, BodyForce"),
     ("fluid", "flow solver"), ("bond", "models of bonds"), ("breakage", "strengths, fragments")],
    [("contact", "laws"), ("search", "NBS, grids"), ("motion", "integrators"),
     ("fill", "particles"), ("shape", "narrow phases")],
    [("boundary", "domains, walls, meshes"), ("parallel", "ranks and what moves bytes between them"),
     ("files", "CSV, VTK, archives")],
    [("core", "vectors, lanes, threads")],
]
# Files that stand at the top of include/silt.
AT_TOP = {"simulation.hpp": "simulation", "silt.hpp": "umbrella", "fluid.hpp": "umbrella",
          "sph.hpp": "umbrella", "ranks.hpp": "umbrella", "mpi.hpp": "umbrella", "eigen.hpp": "umbrella",
          "declare_simulation.hpp": "umbrella", "precompiled.hpp": "umbrella", "precompiled_fluid.hpp": "umbrella"}
PICTURE = ROOT / "docs" / "pictures" / "rooms.svg"
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


def faults_of_scene(name, text):
    """What the scene of a large example may not include: it is to be copied with silt alone."""
    folder = name.split("/")[1] + "/"
    return [f"{name} includes {other}: a scene is copied with silt, the standard library and other "
            "parts of the scene in its folder alone"
            for other in re.findall(r'#include "([^"]+)"', text)
            if not other.startswith(folder) or other.endswith(("measure.hpp", "report.hpp"))]


def picture():
    """The rooms as SVG: a room may include its own floor's left side and all that lies below."""
    width, height, gap, left = 960, 46, 10, 20
    rows, top = [], 56
    for floor in FLOORS:
        each = (width - 2 * left - gap * (len(floor) - 1)) / len(floor)
        for place, (room, words) in enumerate(floor):
            x, middle = left + place * (each + gap), left + place * (each + gap) + each / 2
            kind = ("core" if room == "core" else "engine" if room.startswith("engine") else
                    "face" if room in ("simulation", "measure", "io", "study") else "field")
            rows.append(f'<rect class="{kind}" x="{x:g}" y="{top}" width="{each:g}" '
                        f'height="{height}" rx="6"/>'
                        f'<text class="name" x="{middle:g}" y="{top + 20}">{room}</text>'
                        f'<text class="words" x="{middle:g}" y="{top + 36}">{words}</text>')
        top += height + gap
    return "\n".join([
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {top + 10}" '
        'font-family="sans-serif">',
        '<style>rect{stroke:#4a5568;stroke-width:1}.core{fill:#e2e8f0}.field{fill:#e6fffa}'
        '.engine{fill:#fefcbf}.face{fill:#ebf4ff}text{text-anchor:middle;fill:#1a202c}'
        '.name{font-size:15px;font-weight:bold}.words{font-size:12px}</style>',
        f'<rect x="0" y="0" width="{width}" height="{top + 10}" style="fill:white;stroke:none"/>',
        f'<text class="name" x="{width / 2:g}" y="26">The directories of silt</text>',
        f'<text class="words" x="{width / 2:g}" y="44">A directory may include those below it, '
        'never those above. Yellow: included by simulation alone.</text>',
        *rows, "</svg>", ""])


def faults_of_picture():
    drawn = [room for floor in FLOORS for room, _ in floor]
    faults = [f"room {room} is in ROOMS, but not in FLOORS (tests/rooms_check.py)"
              for room in ROOMS if room not in drawn and room != "umbrella"]
    if not PICTURE.exists() or PICTURE.read_text() != picture():
        faults.append(f"{PICTURE.relative_to(ROOT)} is not of these rooms: rooms_check.py --draw")
    return faults


def self_test():
    assert faults_of("core/vec3.hpp", "#include <silt/search/nbs.hpp>")
    assert faults_of("engine/lists/pair_list.hpp", "#include <silt/engine/checks/guard.hpp>")
    assert faults_of("io/progress.hpp", "#include <silt/engine/checks/guard.hpp>")
    assert faults_of("attic/old.hpp", "")
    assert faults_of("search/nbs.hpp", "#include <silt/attic/old.hpp>")
    assert faults_of("search/nbs.hpp", "auto x = _mm256_add_pd(a, b);")
    assert faults_of_user("examples/a.cpp", "#include <silt/engine/checks/guard.hpp>")
    assert faults_of_scene("examples/mill/scene.hpp", '#include "support/example.hpp"')
    assert faults_of_scene("examples/mill/wet_scene.hpp", '#include "mill/measure.hpp"')
    assert not faults_of_scene("examples/mill/scene.hpp", '#include "mill/drum.hpp"')
    assert not faults_of("simulation/axes.hpp", "#include <silt/engine/checks/guard.hpp>")
    assert not faults_of("engine/checks/guard.hpp", "#include <silt/engine/lists/pair_list.hpp>")
    assert not faults_of("core/row4.hpp", "#include <immintrin.h>")


def main():
    if "--self-test" in sys.argv[1:]:
        return self_test()
    if "--draw" in sys.argv[1:]:
        PICTURE.write_text(picture())
    faults = faults_of_picture()
    include = ROOT / "include" / "silt"
    for path in sorted(include.rglob("*.hpp")):
        faults += faults_of(path.relative_to(include).as_posix(), path.read_text())
    for folder in ("examples", "docs/code"):
        for path in sorted((ROOT / folder).rglob("*.[ch]pp")):
            faults += faults_of_user(path.relative_to(ROOT).as_posix(), path.read_text())
    for path in sorted((ROOT / "examples").rglob("*scene.hpp")):
        faults += faults_of_scene(path.relative_to(ROOT).as_posix(), path.read_text())
    print("\n".join(faults) if faults else f"{len(ROOMS)} rooms, no include leads upward")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
