#!/usr/bin/env python3
# silt - BSD-3-Clause, see LICENSE
"""declared_headers_check.py: what cmake/precompiled/declare.py leaves of functions, and that it can read all of silt's
headers. A function left out by mistake does not link; one kept by mistake costs every program its compilation."""
import contextlib
import io
import os
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
sys.path.insert(0, os.path.join(ROOT, "cmake", "precompiled"))
sys.dont_write_bytecode = True
import declare  # noqa: E402

LONG_BODY = "{\n  if (a > 1) throw std::runtime_error(\"{\");\n  for (int k = 0; k < a; ++k) a += k * k;\n  return a;\n}"
GAP = "\n\n\n\n"  # as many lines as the body had

# What comes in, and what is declared: the same if it must stay whole.
DECLARED = {
    "a function": ("inline int f(int a) " + LONG_BODY, "int f(int a);" + GAP),
    "in a namespace": ("namespace a::inline b {\ninline int f(int a) " + LONG_BODY + "\n}",
                       "namespace a::inline b {\nint f(int a);" + GAP + "\n}"),
    "with attributes": ("[[nodiscard]] inline int f(int a = 1) noexcept " + LONG_BODY,
                        "[[nodiscard]] int f(int a = 1) noexcept;" + GAP),
    "a trailing return type": ("inline auto f(int a) -> int " + LONG_BODY, "auto f(int a) -> int;" + GAP),
    "a member": ("class C {\n public:\n  int f(int a) const " + LONG_BODY + "\n  int n = 0;\n};",
                 "class C {\n public:\n  int f(int a) const;" + GAP + "\n  int n = 0;\n};"),
    "an operator": ("struct C {\n  int operator()(int a) const " + LONG_BODY + "\n};",
                    "struct C {\n  int operator()(int a) const;" + GAP + "\n};"),
    "a constructor": ("struct C : B<int> {\n  explicit C(int a)\n      : B<int>{a}, n_(a) " + LONG_BODY + "\n  int n_;\n};",
                      "struct C : B<int> {\n  explicit C(int a);\n" + GAP + "\n  int n_;\n};"),
    "a member outside of its class": ("inline std::vector<int> C::f(int a) " + LONG_BODY, GAP),
    "a destructor outside of its class": ("inline C::~C() " + LONG_BODY, GAP),
    "that returns a name with ::": ("inline std::vector<int> f(int a) " + LONG_BODY, "std::vector<int> f(int a);" + GAP),
    "a short function": ("inline int f(int a) { return a; }", None),
    "a template": ("template <class T>\ninline int f(T a) " + LONG_BODY, None),
    "a template with a requirement": ("template <class T>\nrequires(sizeof(T) > 1) int f(T a) " + LONG_BODY, None),
    "a member of a class template": ("template <class T, bool b = (2 > 1)>\nclass C {\n  int f(int a) " + LONG_BODY + "\n};",
                                     None),
    "a member of a constrained template": ("template <class T>\nrequires Has<T>\nstruct C {\n  int f(int a) " + LONG_BODY + "\n};",
                                           None),
    "a deduced type": ("inline auto f(int a) " + LONG_BODY, None),
    "a function of any type": ("inline int f(int a, const auto& b) " + LONG_BODY, None),
    "a constant function": ("constexpr int f(int a) " + LONG_BODY, None),
    "a virtual function": ("struct C {\n  int f(int a) override " + LONG_BODY + "\n};", None),
    "a friend": ("struct C {\n  friend int f(int a) " + LONG_BODY + "\n};", None),
    "always inlined": ("SILT_INLINE int f(int a) " + LONG_BODY, None),
    "a variable": ("inline const std::function<int(int)> f{[](int a) " + LONG_BODY + "};", None),
    "an assigned variable": ("inline const auto f = [](int a) " + LONG_BODY + ";", None),
    "an enumeration": ("enum class E { A, B };\nusing F = int (*)(int);", None),
    "a string with a brace": ('inline const char* text = R"(int f() {)";', None),
}


def check_cases():
    for name, (text, expected) in DECLARED.items():
        header = declare.Header(text)
        got = header.declared()
        if got != (text if expected is None else expected):
            sys.exit(f"declared_headers_check: {name}: got\n{got}")
        used = header.defined().count("[[gnu::used]]")
        if used != (expected is not None):
            sys.exit(f"declared_headers_check: {name}: {used} functions are marked as used")
    try:
        declare.Header("inline int f(int a) {\n  if (a) {\n")
    except declare.Unreadable as error:
        if "line 1" not in str(error):
            sys.exit(f"declared_headers_check: an open bracket is said to be: {error}")
    else:
        sys.exit("declared_headers_check: a header with an open bracket is read")


def check_headers():
    said = io.StringIO()
    with tempfile.TemporaryDirectory() as out:
        with contextlib.redirect_stdout(said):
            declare.main(os.path.join(ROOT, "include"), out)
        with open(os.path.join(out, "declared/silt/files/vtk.hpp"), encoding="utf-8") as file:
            declared = file.read()
        with open(os.path.join(ROOT, "include/silt/files/vtk.hpp"), encoding="utf-8") as file:
            lines = file.read().count("\n")
    if "stays whole" in said.getvalue():
        sys.exit(f"declared_headers_check: {said.getvalue()}")
    if declared.count("\n") != lines:
        sys.exit("declared_headers_check: silt/files/vtk.hpp has other lines than before")


check_cases()
check_headers()
