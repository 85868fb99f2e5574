#!/usr/bin/env python3
# silt - BSD-3-Clause, see LICENSE
"""Counts the lines of headers and functions where a step of the simulation is made.

In include/silt/engine and include/silt/simulation a header has 400 lines at most and a function 60,
counted from the first line of its head (template <...> included, comments above not) to its closing
brace; lambdas and local classes belong to the function that they stand in. EXCEPTIONS names what is
better whole, with the reason. `lengths_check.py --self-test` shows that each limit can fail;
`--list` prints the longest headers and functions.
"""

import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
INCLUDE = ROOT / "include" / "silt"
PLACES = ["engine", "simulation", "simulation.hpp"]
MOST_OF_HEADER, MOST_OF_FUNCTION = 400, 60
# "engine/contact/some_header.hpp" or "engine/contact/some_header.hpp: function": why it stays whole.
EXCEPTIONS = {}

NO_CODE = re.compile(
    r'//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"'
    r"|(?<!\w)'(?:\\.|[^'\\\n])+'|^[ \t]*#(?:\\\n|[^\n])*", re.DOTALL | re.MULTILINE)
TEMPLATE = re.compile(r"template\s*<(?:[^<>]|<(?:[^<>]|<(?:[^<>]|<[^<>]*>)*>)*>)*>")
SCOPE = re.compile(r"^(inline\s+)?namespace\b|^extern\b")
TYPE = re.compile(r"\b(class|struct|union|enum)\b")
# What a function's head ends with, where it also has such a word: a parameter `struct stat s`.
END_OF_HEAD = re.compile(r"\)\s*(const|noexcept|->[^{]*|requires[^{]*)?\s*$")
# A member in an initialiser list: `Part(int n) : size_` before `{n}`.
INITIALISER = re.compile(r"\)[^()]*(?<!:):(?!:)(?:.*,)?\s*\w+(?:<.*>)?$", re.DOTALL)
NAME = re.compile(r"((?:\w+::)?~?\w+|operator\s*[^\s\w]+)\s*\(")


def code_of(text):
    """The text with blanks for comments, strings and directives, of the same lines."""
    return NO_CODE.sub(lambda m: re.sub(r"[^\n]", " ", m.group()), text)


def functions_of(text):
    """(name, first line, lines) of each function that is defined in a file."""
    code = re.sub(r"__attribute__\(\(\w+\)\)", lambda m: " " * len(m.group()), code_of(text))
    found, open_braces, head, first, parentheses = [], [], 0, None, 0
    for at, c in enumerate(code):
        within = first is not None
        if not within and c in "()":
            parentheses += 1 if c == "(" else -1
        elif c == "{" and not within and parentheses > 0:  # a default argument
            open_braces.append("value")
        elif c == "{":
            whole = code[head:at]
            words = TEMPLATE.sub("", whole).strip()
            if within:
                open_braces.append("inside")
            elif SCOPE.match(words) or (TYPE.search(words) and not END_OF_HEAD.search(words)):
                open_braces.append("scope")
                head = at + 1
            elif "(" in words and "concept " not in words and not INITIALISER.search(words):
                open_braces.append("function")
                first = head + len(whole) - len(whole.lstrip())
                named = NAME.search(words)
                name = named.group(1) if named else words.split()[0]
            else:
                open_braces.append("value")
        elif c == "}":
            if not open_braces:
                raise ValueError("a closing brace too many")
            kind = open_braces.pop()
            if kind == "function":
                line = code.count("\n", 0, first) + 1
                found.append((name, line, code.count("\n", 0, at) + 2 - line))
                first = None
            if kind in ("function", "scope"):
                head = at + 1
        elif not within and parentheses == 0 and (c == ";" and (not open_braces or open_braces[-1] == "scope") or
                             c == ":" and re.search(r"\b(public|private|protected)\s*$",
                                                    code[max(head, at - 12):at])):
            head = at + 1
    if open_braces:
        raise ValueError("a closing brace too few")
    return found


def faults_of(header, text, exceptions=EXCEPTIONS):
    """What is too long in a header, given by its path below include/silt, in sentences."""
    lines, faults = text.count("\n"), []
    if lines > MOST_OF_HEADER and header not in exceptions:
        faults.append(f"include/silt/{header} has {lines} lines, more than {MOST_OF_HEADER}: divide "
                      "it by what its parts do")
    try:
        functions = functions_of(text)
    except ValueError as error:
        return faults + [f"include/silt/{header}: {error}, where directives and strings are left out"]
    for name, line, count in functions:
        if count > MOST_OF_FUNCTION and f"{header}: {name}" not in exceptions:
            faults.append(f"include/silt/{header}:{line}: {name}() has {count} lines, more than "
                          f"{MOST_OF_FUNCTION}: divide it into steps with names")
    return faults


def headers():
    for place in PLACES:
        path = INCLUDE / place
        for header in [path] if path.is_file() else sorted(path.rglob("*.hpp")):
            yield header.relative_to(INCLUDE).as_posix(), header.read_text()


def self_test():
    long = "  x = 1;\n"
    body = "{\n" + 60 * long + "}\n"
    short = "{\n" + 58 * long + "}\n"
    cases = {
        "a": "void a() ", "b": "template <class T>\nstruct S {\n  int b(T t = {}) const ",
        "S::c": "namespace n {\nauto S::c(struct stat s) -> S ", "d": "enum class E { one, two };\nvoid d() ",
        "e": "class S {\n public:\n  e(int n) : a_{n}, b_(n), c_{} ", "f": "int k{3};\nint f() requires(true) ",
        "g": "__attribute__((flatten)) void g(int (&n)[2]) ", "operator()": "struct S {\n  void operator()(int n) ",
    }
    for name, head in cases.items():
        ends = "};\n" if "S {" in head else "}\n" if "namespace" in head else ""
        found = functions_of(head + body + ends)
        assert [one[0] for one in found] == [name] or name == "operator()" and len(found) == 1, (name, found)
        assert faults_of("engine/x.hpp", head + body + ends), name
        assert not faults_of("engine/x.hpp", (head + short + ends).replace("template <class T>\n", "")), name
        assert not faults_of("engine/x.hpp", head + body + ends, {f"engine/x.hpp: {found[0][0]}": "why"})
    assert functions_of('const char* s = "{"; // {\nint n = 1\'000; /* { */\nvoid g() {}\n') == [("g", 3, 1)]
    assert [f[2] for f in functions_of("void a() {\n  const auto f = [] {\n    g();\n  };\n}\n")] == [5]
    assert faults_of("engine/x.hpp", 401 * "\n") and not faults_of("engine/x.hpp", 400 * "\n")
    assert not faults_of("engine/x.hpp", 401 * "\n", {"engine/x.hpp": "why"})
    assert faults_of("engine/x.hpp", "void a() {") and faults_of("engine/x.hpp", "}")


def main():
    if "--self-test" in sys.argv[1:]:
        return self_test()
    faults, functions, lengths = [], [], []
    for header, text in headers():
        faults += faults_of(header, text)
        functions += [(count, f"{name}, include/silt/{header}:{line}")
                      for name, line, count in functions_of(text)]
        lengths.append((text.count("\n"), f"include/silt/{header}"))
    if "--list" in sys.argv[1:]:
        for longest in (lengths, functions):
            for count, where in sorted(longest, reverse=True)[:15]:
                print(f"{count:4} {where}")
    whole = {header for header, _ in headers()}
    faults += [f"EXCEPTIONS in tests/lengths_check.py names {one}, which is not there"
               for one in EXCEPTIONS if one.split(":")[0] not in whole]
    if len(functions) < 5 * len(lengths):
        faults.append(f"only {len(functions)} functions found in {len(lengths)} headers: "
                      "functions_of() in tests/lengths_check.py has missed some")
    print("\n".join(faults) if faults else
          f"{len(lengths)} headers and {len(functions)} functions, none too long")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
