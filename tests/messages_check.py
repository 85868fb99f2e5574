#!/usr/bin/env python3
# silt - BSD-3-Clause, see LICENSE
"""Messages that the docs quote stand in the headers.

In docs/troubleshooting.md and docs/components.md the column `message` of a table has what silt says, in
`code`; `...` stands for what varies. Each piece of it must stand in the literals of one header. In
docs/components.md a file of tests/compile/refused that is named must exist and expect that message.
`messages_check.py --self-test` shows that it can fail.
"""

import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGES = ("docs/troubleshooting.md", "docs/components.md")


def literals(source):
    """The text of all literals of a header; neighbours are joined as the compiler does."""
    source = re.sub(r"^\s*//[^\n]*|(?<=[;,{(\s])//\s[^\n]*", "", source, flags=re.M)
    out = []
    for run in re.findall(r'(?:"(?:[^"\\\n]|\\.)*"\s*)+', source):
        out.append("".join(re.findall(r'"((?:[^"\\\n]|\\.)*)"', run)).replace('\\"', '"').replace("`", ""))
    # What a call joins stands near each other: pieces may be looked for across literals.
    return "\n".join(out)


def pieces(message):
    return [p.strip(" ;,:'") for p in message.split("...") if len(p.strip(" ;,:'[].=")) > 2]


def stands_in(message, headers):
    """True if one header has all pieces."""
    wanted = pieces(message)
    return bool(wanted) and any(all(p in text for p in wanted) for text in headers)


def quoted(page):
    """[(line, message, whole row)] of the tables that have a column `message`."""
    found, column = [], None
    for number, line in enumerate(page.split("\n"), 1):
        if not line.startswith("|"):
            column = None
            continue
        cells = [c.strip() for c in re.split(r"(?<!\\)\|", line)[1:-1]]
        if column is None:
            column = cells.index("message") if "message" in cells else -1
        elif column >= 0 and not set(cells[0]) <= set("-:"):
            found += [(number, m, line) for m in re.findall(r"`([^`]+)`", cells[column])]
    return found


def self_test():
    headers = [literals('require(x, "Simulation::time_step = ", x, " [s] is above the "\n   "limit ", y);')]
    assert stands_in("Simulation::time_step = ... is above the limit", headers)
    assert not stands_in("is below the limit", headers)
    assert not stands_in("...", headers)
    page = "| message | cause |\n|---|---|\n| `a thing` | b |\n\n| law | x |\n|---|---|\n| `no message` | b |\n"
    assert [m for _, m, _ in quoted(page)] == ["a thing"]


def main():
    if "--self-test" in sys.argv[1:]:
        return self_test()
    headers = [literals(p.read_text()) for p in sorted((ROOT / "include").rglob("*.hpp"))]
    faults, count = [], 0
    for name in PAGES:
        for number, message, row in quoted((ROOT / name).read_text()):
            count += 1
            if not stands_in(message, headers):
                faults.append(f"{name}:{number}: no header says '{message}' any more; quote what it says now")
            for test in re.findall(r"\b(\w+)\.cpp\b", row) if name.endswith("components.md") else []:
                path = ROOT / "tests" / "compile" / "refused" / f"{test}.cpp"
                if not path.exists():
                    faults.append(f"{name}:{number}: tests/compile/refused/{test}.cpp is not there")
                elif not any(w in message or message in w for w in re.findall(r"// refused: (.*)", path.read_text())):
                    faults.append(f"{name}:{number}: {test}.cpp expects another sentence than '{message}'")
    print("\n".join(faults) if faults else f"{count} quoted messages stand in the headers")
    return 1 if faults or count == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
