#!/usr/bin/env python3
# silt - BSD-3-Clause, see LICENSE
"""Every C++ block of README.md, CONTRIBUTING.md and docs/*.md must stand, line by line, in a program that is compiled,
every file and heading that they link to must exist, docs/index.md must name every page, and docs/validation.md must
say (long) where a test is of the long set."""
import glob
import os
import re
import sys

root = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..")
programs = glob.glob(root + "/examples/*/*.cpp") + glob.glob(root + "/docs/code/*.cpp")


def anchors_of(page):
    """What GitHub and the site make of a page's headings."""
    text = re.sub(r"```.*?```", "", open(page).read(), flags=re.S)
    found = []
    for title in re.findall(r"^#+ (.*)$", text, re.M):
        title = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", title).replace("`", "")
        anchor = re.sub(r"[^\w\- ]", "", title.strip().lower()).replace(" ", "-")
        found.append(anchor + (f"-{found.count(anchor)}" if anchor in found else ""))
    return found


sources = {p: "\n".join(line.rstrip() for line in open(p)) for p in programs}
failed = 0
blocks = 0
for page in [root + "/README.md", root + "/CONTRIBUTING.md"] + sorted(glob.glob(root + "/docs/*.md")):
    content = open(page).read()
    name = os.path.relpath(page, root)
    for block in re.findall(r"```cpp\n(.*?)```", content, re.S):
        blocks += 1
        wanted = "\n".join(line.rstrip() for line in block.rstrip("\n").split("\n"))
        if not any(wanted in text for text in sources.values()):
            failed += 1
            print(f"{name}: this block stands in no compiled program:\n{block}")
    prose = re.sub(r"```.*?```", "", content, flags=re.S)
    for target, anchor in re.findall(r"\]\(([^)#:]*)(#[^)\s]*)?\)", prose):
        place = os.path.join(os.path.dirname(page), target) if target else page
        if not os.path.exists(place):
            failed += 1
            print(f"{name}: links to {target}, which is not there")
        elif anchor and place.endswith(".md") and anchor[1:] not in anchors_of(place):
            failed += 1
            print(f"{name}: links to {target}{anchor}, but that page has no such heading")
index = open(root + "/docs/index.md").read().split("## By component")[1]
for page in sorted(glob.glob(root + "/docs/*.md")):
    if f"]({os.path.basename(page)})" not in index:
        failed += 1
        print(f"docs/index.md, 'By component', does not name {os.path.basename(page)}")
# A file of the long set by its name, with or without its room.
cmake = open(root + "/tests/CMakeLists.txt").read()
long_files = re.search(r"set\(silt_long_files([^)]*)\)", cmake)[1].split()
long_files += re.findall(r"if\(SILT_LONG_TESTS\)\n +add_executable\(\w+ ([a-z_]+/[a-z_0-9]+)\.cpp\)", cmake)
# Files of which the long set alone has some cases or lines.
parts = {path for path in glob.glob(root + "/tests/*/*.cpp")
         if "#ifdef SILT_LONG_TESTS" in open(path).read() and "/compile/" not in path}
marked, named = set(), set()
for number, line in enumerate(open(root + "/docs/validation.md").read().split("\n"), 1):
    whole = line.startswith("| (long)")
    room = ""
    for tests, folder, file, rest, partly in re.findall(
            r"(tests/)?((?:[a-z_]+/)?)([a-z_0-9]+)\.cpp( \(long\))?( \(partly long\))?", line):
        room = folder or ("" if tests else room)
        if line.startswith("|"):
            (marked if partly else named).add(f"{root}/tests/{room}{file}.cpp")
        if line.startswith("|") and (room + file in long_files) != (whole or bool(rest)):
            failed += 1
            print(f"docs/validation.md:{number}: {room}{file}.cpp is"
                  + (" not" if whole or rest else "") + " of the long set")
for path in sorted(parts & named - marked | marked - parts):
    failed += 1
    print(f"{path} has {'cases' if path in parts else 'no cases'} of the long set alone: docs/validation.md"
          f" {'lacks' if path in parts else 'says'} (partly long)")
print(f"{blocks} code blocks looked at, {failed} problems")
sys.exit(1 if failed or blocks == 0 else 0)
