# silt - BSD-3-Clause, see LICENSE
"""Reads the declarations of silt's headers, with their comments, for the documentation and its tests.

This is no C++ parser: it follows braces, namespaces and classes in the one style that .clang-format
gives silt's headers, and takes each declaration with the `///` lines above it or the comment beside it.
"""

import pathlib
import re
from dataclasses import dataclass, field

ROOT = pathlib.Path(__file__).resolve().parents[2]
INCLUDE = ROOT / "include" / "silt"


@dataclass
class Declaration:
    name: str
    kind: str  # type, enum, concept, function, alias, variable, enumerator
    text: str  # the declaration without its body
    doc: str  # lines of `///` above it, without the slashes
    beside: str  # the comment behind it on its last line
    header: str  # below include/
    line: int
    scope: tuple = ()  # names of namespaces (but silt) and classes around it
    public: bool = True
    members: list = field(default_factory=list)


@dataclass
class _Scope:
    kind: str  # namespace, type, enum
    name: str
    public: bool
    owner: Declaration = None


def _blank(source):
    """The source with comments, literals and preprocessor lines blanked, and the comments by line."""
    out, comments, at = [], {}, 0
    line = 1
    pattern = re.compile(
        r'//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|(?<![0-9a-fA-F])\'(?:\\.|[^\'\\\n])+\''
        r"|^[ \t]*#(?:\\\n|[^\n])*", re.S | re.M)
    for found in pattern.finditer(source):
        out.append(source[at:found.start()])
        line += source.count("\n", at, found.start())
        text = found.group()
        if text.startswith("//"):
            comments[line] = (text, source[source.rfind("\n", 0, found.start()) + 1:found.start()].strip() == "")
        if text.startswith('"') or text.startswith('R"'):
            out.append('""' + re.sub(r"[^\n]", " ", text[2:]))
        else:
            out.append(re.sub(r"[^\n]", " ", text))
        line += text.count("\n")
        at = found.end()
    out.append(source[at:])
    return "".join(out), comments


def _without_brackets(text):
    """Without what stands between < > of templates and in brackets, so that names are found."""
    previous = None
    while previous != text:
        previous = text
        text = re.sub(r"<[^<>()]*>", "", text)
    return text


def _split_template(text):
    """Takes template<...> and requires-clauses off the front of a declaration."""
    text = text.strip()
    while text.startswith("template"):
        depth, at = 0, text.index("<")
        for at in range(at, len(text)):
            if text[at] == "<":
                depth += 1
            elif text[at] == ">" and text[at - 1] != "-":
                depth -= 1
                if depth == 0:
                    break
        text = text[at + 1:].strip()
        if text.startswith("requires"):
            # What follows a constraint begins with a specifier or a type of the return value.
            ends = re.search(r"(?:[)>}\w]\s*)(?=\b(?:struct|class|concept|using|constexpr|inline|SILT_INLINE|static|auto|"
                             r"explicit|friend|void|bool|double|Real|Vec3\w*|std::\w+)\b)", text[8:])
            text = text[8 + ends.end():].strip() if ends else text
    return text


TYPE = re.compile(r"^(?:enum\s+)?(?:class|struct|union|enum)\b\s*([A-Za-z_]\w*)(\s*<.*>)?")


def _named(text):
    """(kind, name) of a declaration; (None, None) for what declares nothing of its own."""
    text = _split_template(re.sub(r"\s+", " ", text).strip())
    text = re.sub(r"^(?:public|private|protected)\s*:\s*", "", text)
    text = re.sub(r"\[\[[^\]]*\]\]\s*|\balignas\((?:[^()]|\([^()]*\))*\)\s*", "", text)
    if not text or re.match(r"(static_assert|friend|using namespace|extern|SILT_\w+\()", text):
        return None, None
    if found := re.match(r"using (\w+) =", text):
        return "alias", found[1]
    if text.startswith("using "):
        return None, None
    if found := re.match(r"concept (\w+)", text):
        return "concept", found[1]
    if (found := TYPE.match(text)) and "(" not in text.split(":")[0]:
        if found[2]:
            return None, None  # a specialisation
        return ("enum" if text.startswith("enum") else "type"), found[1]
    bare = text
    if found := re.search(r"operator\s*(\(\)|\[\]|[^\s(\w]+|\w+)\s*\(", bare):
        return "function", "operator" + found[1]
    bare = re.sub(r"^(?:(?:inline|static|constexpr|consteval|explicit|mutable|virtual|SILT_INLINE|SILT_NOINLINE|const|volatile)\s+)+", "", bare)
    bare = _without_brackets(re.sub(r"decltype\([^()]*(?:\([^()]*\)[^()]*)*\)", "auto", bare))
    head = re.split(r"[={\[]", bare, 1)[0]
    if "(" in head:
        found = re.search(r"([~\w:]+)\s*\(", head)
        if not found or "::" in found[1].strip(":") and not found[1].startswith("std"):
            return None, None
        return "function", found[1]
    if found := re.search(r"(\w+(?:\s*,\s*\w+)*)\s*$", head):
        if re.search(r"::\s*\w+\s*$", head):
            return None, None
        return "variable", found[1]
    return None, None


def read(path, source=None):
    """All declarations of one header at namespace scope, with their members; of `source` if given."""
    source = path.read_text() if source is None else source
    code, comments = _blank(source)
    header = path.relative_to(INCLUDE.parent).as_posix()
    found, scopes, rows = [], [], source.split("\n")
    starts = [0]
    for at, letter in enumerate(code):
        if letter == "\n":
            starts.append(at + 1)

    def line_of(at):
        low, high = 0, len(starts)
        while high - low > 1:
            middle = (low + high) // 2
            low, high = (middle, high) if starts[middle] <= at else (low, middle)
        return low + 1

    def doc_above(line):
        lines = []
        while line > 1 and rows[line - 2].startswith("#"):
            line -= 1  # a condition between the comment and what it tells of
        while (comment := comments.get(line - 1)) and comment[1] and not comment[0].startswith("/// @"):
            line -= 1
            lines.append(comment[0])
        lines.reverse()
        kept = [re.sub(r"^///? ?", "", text) for text in lines if text.startswith("///")]
        return "\n".join(kept)

    def plain_above(line):
        lines = []
        while (comment := comments.get(line - 1)) and comment[1]:
            line -= 1
            lines.append(re.sub(r"^//+ ?", "", comment[0]))
        return "\n".join(reversed(lines))

    def declare(begin, end, extra_end=None):
        text = code[begin:end]
        kind, name = _named(text)
        if not name:
            return None
        stripped = begin + len(text) - len(text.lstrip())
        # An access label before the first member belongs to the class.
        label = re.match(r"\s*(?:(?:public|private|protected)\s*:\s*)+", text)
        if label:
            stripped = begin + label.end()
        first, last = line_of(stripped), line_of(extra_end if extra_end is not None else end)
        beside = comments.get(last)
        beside = re.sub(r"^//+<? ?", "", beside[0]) if beside and not beside[1] else ""
        if beside:  # a comment that goes on below
            after = last + 1
            column = source.split("\n")[last - 1].find("//")
            while (more := comments.get(after)) and more[1] and source.split("\n")[after - 1].find("//") == column > 6:
                beside += " " + re.sub(r"^//+ ?", "", more[0])
                after += 1
        # Of the source, as literals are blanked in the code.
        shown = re.sub(r"//[^\n]*", "", source[stripped:end])
        one = Declaration(name, kind, re.sub(r"\s+", " ", shown).strip(), doc_above(first), beside, header, first,
                          tuple(s.name for s in scopes if s.name != "silt"), scopes[-1].public if scopes else True)
        one.comment = one.doc or plain_above(first)
        owner = scopes[-1].owner if scopes else None
        (owner.members if owner else found).append(one)
        return one

    def skip_braces(at):
        depth = 0
        while at < len(code):
            if code[at] == "{":
                depth += 1
            elif code[at] == "}":
                depth -= 1
                if depth == 0:
                    return at
            at += 1
        return at

    begin, at = 0, 0
    while at < len(code):
        letter = code[at]
        if letter == ":" and scopes and scopes[-1].kind == "type":
            label = re.search(r"(?:^|[\s;{}])(public|private|protected)\s*$", code[begin:at])
            if label and code[at + 1] != ":":
                scopes[-1].public = label[1] == "public"
                begin = at + 1
        elif letter == ";":
            if not scopes or scopes[-1].kind != "enum":
                text = re.sub(r"\s+", " ", code[begin:at]).strip()
                forward = re.match(r"^(?:template.*)?(?:class|struct|enum class)\s+\w+$", text)
                guide = re.match(r"^(?:template.*> )?\w+\(.*\)\s*->\s*\w+\s*(<.*>)?$", text)
                if not guide and not (forward and not doc_above(line_of(begin + len(code[begin:at]) - len(code[begin:at].lstrip())))):
                    declare(begin, at, at)
            begin = at + 1
        elif letter == "}":
            if scopes:
                closed = scopes.pop()
                if closed.kind == "enum":
                    _enumerators(closed.owner, code[begin:at], begin, line_of, comments)
                if closed.kind == "type" and ";" in code[at:at + 40].split("\n")[0]:
                    at = code.index(";", at)
            begin = at + 1
        elif letter == "{":
            text = re.sub(r"\s+", " ", code[begin:at]).strip()
            text = re.sub(r"^(?:(?:public|private|protected)\s*:\s*)+", "", text)
            if name := re.match(r"(?:inline )?namespace(?: ([\w:]+))?(?:::inline \w+)?$", text.replace("::inline SILT_TARGET", "")):
                scopes.append(_Scope("namespace", name[1] or "", True))
                begin = at + 1
            else:
                kind, _ = _named(text)
                body = _split_template(text)
                bare = re.sub(r"\[\[[^\]]*\]\]\s*|\balignas\((?:[^()]|\([^()]*\))*\)\s*", "", body)
                if TYPE.match(bare) and "(" not in bare.split(":")[0] and "=" not in body:
                    one = declare(begin, at)
                    is_enum = body.startswith("enum")
                    parent = scopes[-1] if scopes else None
                    visible = (parent is None or parent.public)
                    if one is None:  # a specialisation: its members are not read
                        at = skip_braces(at)
                        begin = at + 1
                    else:
                        one.public = visible
                        scopes.append(_Scope("enum" if is_enum else "type", one.name,
                                             not body.startswith("class"), one))
                        begin = at + 1
                else:
                    end = skip_braces(at)
                    rest = code[end + 1:end + 400].lstrip()
                    asks = re.search(r"requires\s*(\([^{}]*\))?\s*$", code[begin:at])
                    value = re.search(r"(?<![=!<>+\-*/|&])=(?!=)", re.sub(r"operator\s*[=!<>+\-*/]+|<[^<>]*>|\([^()]*\)", "", text))
                    concept = re.search(r"\bconcept\b", text)
                    if asks or value or concept or rest[:1] in (";", ",", "{") or "(" not in text or (
                            re.search(r"\)[^()]*:\s*[\w:<>, ]*$", text) and rest[:1] in (",", "{")):
                        at = end  # braces within a declaration that goes on
                    else:
                        declare(begin, at)
                        at = end
                        begin = at + 1
        at += 1
    return found


def _enumerators(owner, text, begin, line_of, comments):
    at = 0
    for part in text.split(","):
        if name := re.search(r"\w+", part):
            line = line_of(begin + at + name.start())
            beside = comments.get(line)
            above = comments.get(line - 1)
            words = (beside[0] if beside and not beside[1] else
                     above[0] if above and above[1] else "")
            owner.members.append(Declaration(name.group(), "enumerator", part.strip(), "",
                                             re.sub(r"^//+<? ?", "", words), owner.header, line))
        at += len(part) + 1


def is_detail(declaration):
    return any(s == "" or "detail" in s for s in declaration.scope)


def reachable(*umbrellas):
    """The headers of silt that these include, themselves included."""
    seen, todo = set(), [INCLUDE / u for u in umbrellas]
    while todo:
        path = todo.pop()
        if path in seen or not path.exists():
            continue
        seen.add(path)
        todo += [INCLUDE.parent / i for i in re.findall(r'#include [<"](silt/[^>"]+)[>"]', path.read_text())]
    return sorted(seen)


if __name__ == "__main__":
    import sys
    for name in sys.argv[1:]:
        for one in read(INCLUDE / name):
            print(one.kind, "::".join(one.scope + (one.name,)), "|", one.doc.split("\n")[0][:60], "|", one.beside[:40])
            for member in one.members:
                print("   ", "" if member.public else "(private)", member.kind, member.name, "|", member.text[:70], "|", member.comment[:30], "|", member.beside[:60])
