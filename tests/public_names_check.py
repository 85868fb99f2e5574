#!/usr/bin/env python3
# silt - BSD-3-Clause, see LICENSE
"""Every public name of silt has a doc comment, or is named in the docs.

Public are types, functions, enums, aliases, concepts and constants in namespace silt (not in a namespace
detail) that silt.hpp, fluid.hpp, sph.hpp, mpi.hpp or a header of study/ reach. A comment of one overload
is one for all of the same header. `public_names_check.py --self-test` shows that it can fail.
"""

import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "docs" / "site"))
import headers  # noqa: E402

UMBRELLAS = ("silt.hpp", "fluid.hpp", "sph.hpp", "mpi.hpp")


def undocumented(declarations, named):
    """Those without a comment whose name is not in `named`; operators and aliases of std types included."""
    told = {d.name for d in declarations if d.doc or d.beside}
    return [d for d in declarations if not headers.is_detail(d) and d.name not in told and d.name not in named
            and not d.name.startswith("operator")]


def names_in_docs():
    """Identifiers in `code` and in code blocks of the docs."""
    found = set()
    for page in [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]:
        text = page.read_text()
        for code in re.findall(r"```.*?```|`[^`\n]+`", text, re.S):
            found |= set(re.findall(r"[A-Za-z_]\w*", code))
    return found


def self_test():
    read = headers.read(headers.INCLUDE / "probe.hpp",
                        "#pragma once\nnamespace silt::inline SILT_TARGET {\n/// Told.\nstruct Told {\n  int x;\n};\n"
                        "struct Untold {};\ninline int untold(int x) {\n  return x;\n}\nusing Other = int;  // an alias\n"
                        "namespace detail {\nstruct Hidden {};\n}  // namespace detail\n"
                        "enum class Mood { Good };\n/// A function.\nint told(double);\nint told(int);\n}  // namespace silt\n")
    assert [d.name for d in undocumented(read, set())] == ["Untold", "untold", "Mood"], undocumented(read, set())
    assert [d.name for d in undocumented(read, {"Mood"})] == ["Untold", "untold"]


def main():
    if "--self-test" in sys.argv[1:]:
        return self_test()
    reached = headers.reachable(*UMBRELLAS)
    reached = sorted(set(reached) | set(headers.reachable(*(p.relative_to(headers.INCLUDE).as_posix()
                                                            for p in (headers.INCLUDE / "study").glob("*.hpp")))))
    named, count, faults = names_in_docs(), 0, []
    for path in reached:
        declarations = headers.read(path)
        count += sum(not headers.is_detail(d) for d in declarations)
        faults += [f"include/{d.header}:{d.line}: {d.kind} {d.name} has no `///` comment, and no page of docs/ names it"
                   for d in undocumented(declarations, named)]
    print("\n".join(faults) if faults else f"{count} public names of {len(reached)} headers, all with a comment or in the docs")
    return 1 if faults or count == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
