#!/usr/bin/env python3
# silt - BSD-3-Clause, see LICENSE
"""A header as Doxygen is to read it: doxygen_filter.py HEADER.

silt's comments are plain text: formulas that are set in, fields such as `Source:`. The filter makes
blocks of code and paragraphs of them, and escapes what Doxygen would take for HTML or for commands.
"""

import re
import sys

FIELD = re.compile(r"^(Sources?|Valid|Units|Shapes|Errors?|Tests?|Threads|Cost|Deviations|Numerics|Memory): *(.*)")


def plain(text):
    """Text in which only `code` is special."""
    parts = re.split(r"(`[^`]*`)", text)
    return "".join(p if p.startswith("`") and len(p) > 1 else re.sub(r"([<>&\\@#$%*|\[\]\"])", r"\\\1", p)
                   for p in parts)


def block(lines, indent):
    out, inside, blanks = [], False, 0
    for text in lines:
        formula = re.match(r"^ {2,}\S", text)
        field = FIELD.match(text)
        continues = formula and out and getattr(block, "in_field", False) and not inside
        if field:
            block.in_field = True
        elif not text.strip():
            block.in_field = False
        if formula and not continues:
            if inside:
                out += [""] * blanks
            blanks = 0
            if not inside:
                out.append("@code{.unparsed}")
                inside = True
            out.append(text)
            continue
        if inside:
            if not text.strip():
                blanks += 1
                continue
            out.append("@endcode")
            blanks = 0
            inside = False
        if re.match(r"^@(name|\{|\})", text):
            out.append(text)
        elif field:
            out += ["", f"**{field[1]}**: {plain(field[2])}"]
        else:
            out.append(plain(text.strip()))
    if inside:
        out.append("@endcode")
    block.in_field = False
    return [f"{indent}/// {text}".rstrip() for text in out]


def main():
    text = open(sys.argv[1]).read().replace("namespace silt::inline SILT_TARGET", "namespace silt")
    # Doxygen does not find the declaration of a member of a variadic template with the dots.
    text = re.sub(r"<(\w+)\.\.\.>(?=::\w+\()", r"<\1>", text)
    out, waiting, indent = [], [], ""
    for line in text.split("\n"):
        found = re.match(r"^(\s*)/// ?(.*)$", line)
        if found:
            indent = found[1]
            waiting.append(found[2])
            continue
        if waiting:
            out += block(waiting, indent)
            waiting = []
        # A comment beside a member belongs to it.
        out.append(re.sub(r"^(\s+\S.*[;,{]\s*)// (?=\[|[a-z>])", lambda m: m[1] + "///< ", line)
                   if re.search(r"[;,]\s+// ", line) and "(" not in line.split("//")[0] and "return" not in line else line)
    print("\n".join(out))


if __name__ == "__main__":
    main()
