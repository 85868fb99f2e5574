#!/usr/bin/env python3
# silt - BSD-3-Clause, see LICENSE
"""declare.py INCLUDE OUT

Headers for programs that link silt::precompiled. A header-only library costs each program the functions it does not
use: the compiler parses them and instantiates what they call. From the headers in INCLUDE this makes

  OUT/declared   the same headers, in which functions that are no templates are only declared
  OUT/defined    the same headers, in which these functions are marked [[gnu::used]]: compiled even if nothing calls them
  OUT/bodies.cpp a source file for the library, to be compiled with OUT/defined

Left whole: templates and members of class templates, constexpr functions, functions with a deduced return type, friends,
virtual functions, functions that are always inlined, and bodies of fewer than SHORTEST tokens, since a call may cost more
than they do. Lines keep their numbers. A header that this program cannot read is copied as it is, and named in the
output.
"""
import os
import re
import shutil
import sys

SHORTEST = 24  # [tokens] bodies of at least this length are left out
UMBRELLAS = ("silt/silt.hpp", "silt/fluid.hpp", "silt/sph.hpp", "silt/ranks.hpp")  # what these do not include stays whole
MACROS = ("silt/precompiled.hpp", "silt/precompiled_fluid.hpp", "silt/declare_simulation.hpp")  # likewise

TOKEN = re.compile(r"""
    (?P<skip> \s+ | //[^\n]* | /\*.*?\*/ | ^[ \t]*\#(?:[^\n\\]|\\.|\\\n)*)
  | (?P<raw> R"(?P<mark>[^(\s]*)\(.*?\)(?P=mark)")
  | "(?:[^"\\\n]|\\.)*" | '(?:[^'\\\n]|\\.)*'
  | \.?\d(?:'?[\w.]|[eEpP][+-])*
  | [A-Za-z_]\w*
  | -> | :: | .
  """, re.S | re.M | re.X)
CLOSING = {"{": "}", "(": ")", "[": "]"}
NO_FUNCTIONS = ("using", "static_assert", "friend", "enum", "concept", "typedef", "extern")
BEHIND_PARAMETERS = ("{", "const", "noexcept", "override", "final", "&", "->", "requires")
KEPT_WHOLE = {"constexpr", "consteval", "friend", "virtual", "always_inline", "override", "final", "requires", "decltype"}


class Unreadable(Exception):
    pass


class Header:
    """Finds the functions of one header that are no templates."""

    def __init__(self, text):
        self.text = text
        found = [m for m in TOKEN.finditer(text) if not m.group("skip")]
        self.tokens = [m.group() for m in found]
        self.begins = [m.start() for m in found]
        self.ends = [m.end() for m in found]
        self.functions = []  # (first token, first token of the body or of the initialisers, last token, is a definition
        #                       of a member outside of its class)
        self.scope(0, len(self.tokens), in_class=False, in_template=False)

    def closing(self, i):
        """The token that closes the bracket at i."""
        opening, closing, depth = self.tokens[i], CLOSING[self.tokens[i]], 0
        for j in range(i, len(self.tokens)):
            if self.tokens[j] == opening:
                depth += 1
            elif self.tokens[j] == closing:
                depth -= 1
                if depth == 0:
                    return j
        raise Unreadable(f"no {closing} for the {opening} of {self.place(i)}")

    def place(self, i):
        return f"line {self.text.count(chr(10), 0, self.begins[i]) + 1}"

    def after_angles(self, i):
        """The token after the > that closes the < at i."""
        depth = 0
        while True:
            if self.tokens[i] in CLOSING:
                i = self.closing(i)
            elif self.tokens[i] == "<":
                depth += 1
            elif self.tokens[i] == ">":
                depth -= 1
                if depth == 0:
                    return i + 1
            i += 1

    def after_requirement(self, i):
        """The class behind a requirement that begins at i, or what else comes."""
        begin = i
        while self.tokens[i] not in ("{", ";"):
            if self.tokens[i] in ("class", "struct", "union"):
                return i
            i = self.after_angles(i) if self.tokens[i] == "<" else self.closing(i) + 1 if self.tokens[i] == "(" else i + 1
        return begin

    def after_semicolon(self, i):
        while self.tokens[i] != ";":
            i = self.closing(i) + 1 if self.tokens[i] in CLOSING else i + 1
        return i + 1

    def scope(self, i, end, in_class, in_template):
        while i < end:
            if self.tokens[i] in (";", "}"):
                i += 1
            elif in_class and self.tokens[i] in ("public", "private", "protected") and self.tokens[i + 1] == ":":
                i += 2
            else:
                i = self.declaration(i, in_class, in_template)

    def declaration(self, i, in_class, in_template):
        """Reads the declaration at i; returns the token after it."""
        first = i
        while self.tokens[i] == "[":
            i = self.closing(i) + 1
        while self.tokens[i] == "template" and self.tokens[i + 1] == "<":
            i = self.after_angles(i + 1)
            in_template = True
        if self.tokens[i] == "requires":
            i = self.after_requirement(i + 1)
        word = self.tokens[i]
        if word == "namespace" or (word == "inline" and self.tokens[i + 1] == "namespace"):
            while self.tokens[i] not in ("{", ";", "="):
                i += 1
            if self.tokens[i] != "{":
                return self.after_semicolon(i)
            end = self.closing(i)
            self.scope(i + 1, end, False, in_template)
            return end + 1
        if word in NO_FUNCTIONS:
            return self.after_semicolon(i)
        if word in ("class", "struct", "union"):
            while self.tokens[i] not in ("{", ";"):
                i = self.closing(i) + 1 if self.tokens[i] in ("(", "[") else i + 1
            if self.tokens[i] == ";":
                return i + 1
            end = self.closing(i)
            self.scope(i + 1, end, True, in_template)
            return self.after_semicolon(end + 1)
        return self.function_or_variable(first, i, in_class, in_template)

    def function_or_variable(self, first, i, in_class, in_template):
        name, parameters_end, assigned = -1, -1, False
        while True:
            word = self.tokens[i]
            if word == ";":
                return i + 1
            if word == "operator":
                name = i
                i += 3 if self.tokens[i + 1:i + 3] == ["(", ")"] else 1
                while self.tokens[i] != "(":
                    i += 1
                parameters_end = self.closing(i)
                i = parameters_end + 1
            elif word == "(":
                if not assigned and self.tokens[i - 1] not in ("noexcept", "decltype"):
                    if parameters_end < 0:
                        name = i - 1
                    parameters_end = self.closing(i)
                i = self.closing(i) + 1
            elif word == "[":
                i = self.closing(i) + 1
            elif word == "=":
                assigned = True
                i += 1
            elif word == ":" and parameters_end >= 0 and not assigned:
                body = self.after_initialisers(i + 1)
                return self.function(first, name, i, body, in_class, in_template)
            elif word == "{":
                if parameters_end >= 0 and not assigned and self.tokens[parameters_end + 1] in BEHIND_PARAMETERS:
                    return self.function(first, name, i, i, in_class, in_template)
                i = self.closing(i) + 1
            else:
                i += 1

    def after_initialisers(self, i):
        """The { of a constructor's body, whose initialisers begin at i."""
        while True:
            while self.tokens[i] not in ("(", "{"):
                i = self.after_angles(i) if self.tokens[i] == "<" else i + 1
            i = self.closing(i) + 1
            if self.tokens[i] == ".":  # a pack: ...
                i += 3
            if self.tokens[i] == "{":
                return i
            if self.tokens[i] != ",":
                raise Unreadable(f"initialisers of a constructor in {self.place(i)}")
            i += 1

    def function(self, first, name, begin, body, in_class, in_template):
        """Notes the function whose body, or initialisers, begin at a token; returns the token after it."""
        end = self.closing(body)
        head = self.tokens[first:begin]
        words = [w for w in head if w not in ("inline", "static", "explicit", "[", "]", "nodiscard", "const")]
        deduced = words[0] == "auto" and "->" not in head or "auto" in head[head.index("("):]
        macro = any(w.startswith("SILT_") for w in head)
        whole = in_template or KEPT_WHOLE & set(head) or deduced or macro or not (in_class or "inline" in head)
        if not whole and end - begin >= SHORTEST:
            before = name - 2 if self.tokens[name - 1] == "~" else name - 1
            self.functions.append((first, begin, end, self.tokens[before] == "::"))
        return end + 1

    def declared(self):
        """The text without bodies."""
        text = self.text
        for first, begin, end, is_member in reversed(self.functions):
            lines = "\n" * text.count("\n", self.ends[begin - 1], self.ends[end])
            head = "" if is_member else self.without_inline(first, begin) + ";"
            if is_member:
                lines += "\n" * text.count("\n", self.begins[first], self.ends[begin - 1])
            text = text[:self.begins[first]] + head + lines + text[self.ends[end]:]
        return text

    def without_inline(self, first, begin):
        head = self.text[self.begins[first]:self.ends[begin - 1]]
        return re.sub(r"\binline ", "", head, count=1)

    def defined(self):
        """The text with functions that are compiled even if nothing calls them."""
        text = self.text
        for first, *_ in reversed(self.functions):
            text = text[:self.begins[first]] + "[[gnu::used]] " + text[self.begins[first]:]
        return text


def write(path, text):
    os.makedirs(os.path.dirname(path), exist_ok=True)
    if os.path.exists(path):
        with open(path, encoding="utf-8") as file:
            if file.read() == text:
                return  # nothing to compile anew
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)


def included(source, name, found):
    """Adds header NAME and what it includes to FOUND."""
    if name in found or name in MACROS:
        return
    found.add(name)
    with open(os.path.join(source, name), encoding="utf-8") as file:
        for other in re.findall(r"^#include <(silt/[^>]+)>", file.read(), re.M):
            included(source, other, found)


def main(source, out):
    of_library, count = set(), 0
    for umbrella in UMBRELLAS:
        included(source, umbrella, of_library)
    for folder, _, files in sorted(os.walk(source)):
        for file in sorted(files):
            if not file.endswith(".hpp"):
                continue
            path = os.path.join(folder, file)
            name = os.path.relpath(path, source)
            with open(path, encoding="utf-8") as opened:
                text = opened.read()
            declared = defined = text
            if name in of_library:
                try:
                    header = Header(text)
                    declared, defined = header.declared(), header.defined()
                    count += len(header.functions)
                except (Unreadable, IndexError) as error:
                    print(f"silt: {name} stays whole: {error}")
            write(os.path.join(out, "declared", name), declared)
            write(os.path.join(out, "defined", name), defined)
    write(os.path.join(out, "bodies.cpp"), "".join(f"#include <{name}>\n" for name in UMBRELLAS))
    print(f"silt: {count} functions of {len(of_library)} headers are declared only")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
