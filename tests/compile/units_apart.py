#!/usr/bin/env python3
# silt - BSD-3-Clause, see LICENSE
"""units_apart.py PROGRAM PLAIN_OBJECT AVX_OBJECT: PROGRAM is linked from both objects, the plain one
first. The objects must share no function of silt but the destructors and type information of its errors, which
must be without AVX in both; and what PLAIN_OBJECT defines must hold no
instruction beyond SSE2 in PROGRAM: there the linker has chosen among functions of the same name."""
import re
import subprocess
import sys


def output(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def readable(names):
    text = subprocess.run(["c++filt"], input="\n".join(names), capture_output=True, text=True).stdout
    return "\n".join("  " + line[:200] for line in text.split("\n"))


def functions(file):
    """Names of all functions and inline variables that the linker can see."""
    lines = (line.split() for line in output("nm", "--defined-only", file).splitlines())
    return {words[2] for words in lines if len(words) == 3 and words[1] in "TWVu"}


def with_avx(file):
    """Names of all functions with an instruction that SSE2 lacks: AVX, FMA and AVX-512 begin with v."""
    found, name = set(), None
    for line in output("objdump", "-d", "--no-show-raw-insn", file).splitlines():
        if head := re.match(r"[0-9a-f]+ <(.+)>:$", line):
            name = head[1]
        elif re.match(r"\s+[0-9a-f]+:\s+(v(?!er[rw])|k[a-z]+[bwdq]\s)", line):
            found.add(name)
    return found


# core/error_types.hpp: one type in all units, so that its plain name is shown and any unit catches it. What
# catches one refers to its type by a pointer of its own (DW.ref.), which is data.
ERROR = re.compile(r"(DW\.ref\.)?_Z(N|T[VIS]N?|TIN?)4silt\d+(Error|InputError|FileError|SimulationError|FlowStepError)"
                   r"(D[0-2]Ev|E)$")

program, plain, avx = sys.argv[1:]
plain_functions, avx_functions = functions(plain), functions(avx)
errors = {n for n in plain_functions & avx_functions if ERROR.match(n)}
shared = sorted(n for n in plain_functions & avx_functions - errors if re.search(r"\d+silt", n))
foreign = sorted(plain_functions & with_avx(program) | errors & with_avx(avx))
own = {n for n in plain_functions if re.search(r"\d+silt", n)}
assert len(own) > 50 and len(with_avx(avx)) > 50, "this test looks at nothing"
assert len(errors) > 5, "the errors of silt are not shared: their names show an instruction set"
if shared:
    print(f"{len(shared)} functions of silt have one name in both units:\n" + readable(shared))
if foreign:
    print(f"{len(foreign)} functions of {plain} are for AVX in {program}:\n" + readable(foreign))
print(f"{len(plain_functions)} and {len(avx_functions)} functions looked at")
sys.exit(1 if shared or foreign else 0)
