#!/usr/bin/env python3
# silt - BSD-3-Clause, see LICENSE
"""Makes a static site of the documentation: build.py [--out out/docs].

It opens from the disk, without a server and without network. Pages are README.md, CHANGELOG.md,
CONTRIBUTING.md and docs/*.md; one page for each policy, made from its header (policies.py); and the
sources that pages link to, with line numbers. The sidebar is the section "By component" of docs/index.md.
Every link and anchor is checked; a broken one ends the build with status 1 and its name. Without the Python
modules that it needs the status is 77.
"""

import argparse
import html
import json
import os
import pathlib
import re
import shutil
import sys
import urllib.parse

try:
    import markdown_it
    import pygments.formatters
    import pygments.lexers
    import pygments.token
except ImportError as missing:
    print(f"silt: the site needs the Python module {missing.name}: apt-get install python3-markdown-it python3-pygments",
          file=sys.stderr)
    sys.exit(77)

import headers
import policies

ROOT = headers.ROOT
HERE = pathlib.Path(__file__).resolve().parent
SOURCES = {".cpp": "cpp", ".hpp": "cpp", ".py": "python", ".sh": "bash", ".txt": "cmake", ".cmake": "cmake", ".json": "json",
           "": "bash"}


def slug(title):
    """As GitHub makes anchors of headings."""
    return re.sub(r"[^\w\- ]", "", title.strip().lower()).replace(" ", "-")


class Highlight:
    formatter = pygments.formatters.HtmlFormatter(nowrap=True)

    @classmethod
    def code(cls, text, language):
        try:
            lexer = pygments.lexers.get_lexer_by_name({"": "text", "sh": "bash"}.get(language, language), stripnl=False)
        except pygments.util.ClassNotFound:
            lexer = pygments.lexers.get_lexer_by_name("text", stripnl=False)
        return pygments.highlight(text, lexer, cls.formatter)

    @staticmethod
    def styles():
        light = pygments.formatters.HtmlFormatter(style="tango").get_style_defs("pre")
        dark = pygments.formatters.HtmlFormatter(style="one-dark" if "one-dark" in list(pygments.styles.get_all_styles())
                                                 else "monokai").get_style_defs("pre")
        keep = lambda css: "\n".join(line for line in css.split("\n") if re.match(r"pre \.\w", line)
                                     and "background" not in line.replace("background-color: transparent", ""))
        return keep(light) + "\n@media (prefers-color-scheme: dark) {\n" + keep(dark) + "\n}\n"


class Site:
    def __init__(self, out):
        self.out = out
        self.policies = policies.all_policies()
        self.by_name = {}
        for p in self.policies:
            for name in sorted(p.names()):
                self.by_name.setdefault(name, p)
        self.pages = {}  # path below ROOT of a markdown file: its address in the site
        for path in sorted((ROOT / "docs").glob("*.md")):
            self.pages[path.relative_to(ROOT).as_posix()] = path.stem + ".html"
        for name in ("README.md", "CHANGELOG.md", "CONTRIBUTING.md"):
            if (ROOT / name).exists():
                self.pages[name] = name[:-3].lower() + ".html"
        self.anchors = {}  # address: set of ids
        self.links = []  # (page, address, anchor)
        self.index = []
        self.sources = {}  # path below ROOT: address
        self.faults = []
        self.groups = self.read_groups()
        self.titles = {}

    # The sidebar.

    def read_groups(self):
        text = (ROOT / "docs" / "index.md").read_text().split("## By component")[1]
        groups, listed = [], set()
        for part in re.split(r"^### ", text, flags=re.M)[1:]:
            title, _, rest = part.partition("\n")
            links = re.findall(r"^- \[([^\]]+)\]\(([^)]+)\)", rest, re.M)
            entries = []
            for name, target in links:
                path = os.path.normpath(os.path.join("docs", target))
                if path not in self.pages:
                    self.faults.append(f"docs/index.md lists {target}, which is not there")
                    continue
                entries.append((name, self.pages[path]))
                listed.add(path)
            groups.append((title.strip(), entries))
        for path in self.pages:
            if path not in listed:
                self.faults.append(f"{path} is in no group of docs/index.md, 'By component'")
        return groups

    def sidebar(self, here, root):
        rows = []
        link = lambda name, address: (f'<li><a href="{root}{address}"' + (' class="here"' if address == here else "")
                                      + f">{html.escape(name)}</a></li>")
        for title, entries in self.groups:
            rows.append(f"<h2>{html.escape(title)}</h2><ul>" + "".join(link(*e) for e in entries) + "</ul>")
        rows.append("<h2>Policies</h2><ul>" + link("All policies", "policies.html") + "</ul>")
        for axis in policies.AXES:
            own = [p for p in self.policies if p.axis == axis]
            rows.append(f"<details><summary>{html.escape(axis)}</summary><ul>"
                        + "".join(link(p.name, self.address_of(p)) for p in own) + "</ul></details>")
        api = self.out / "api" / "index.html"
        if api.exists():
            rows.append(f'<h2>API</h2><ul><li><a href="{root}api/index.html">Types and functions (Doxygen)</a></li></ul>')
        return "".join(rows)

    @staticmethod
    def address_of(policy):
        return f"policies/{policy.name}.html"

    # One page.

    def write(self, address, title, body, sections, kind="page", wide=False):
        root = "../" * address.count("/")
        toc = "".join(f'<a class="h{level}" href="#{anchor}">{html.escape(name)}</a>' for level, name, anchor in sections
                      if level in (2, 3))
        toc = f"<aside><b>On this page</b>{toc}</aside>" if toc.count("<a") > 1 and not wide else ""
        order = [e for _, entries in self.groups for e in entries]
        at = next((k for k, e in enumerate(order) if e[1] == address), None)
        turn = ""
        if at is not None:
            back = f'<a href="{root}{order[at - 1][1]}">&larr; {html.escape(order[at - 1][0])}</a>' if at > 0 else "<span></span>"
            on = f'<a href="{root}{order[at + 1][1]}">{html.escape(order[at + 1][0])} &rarr;</a>' if at + 1 < len(order) else ""
            turn = f'<div class="turn">{back}{on}</div>'
        path = self.out / address
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(f"""<!DOCTYPE html>
<html lang="en" data-root="{root}">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<title>{html.escape(title)} - silt</title>
<link rel="stylesheet" href="{root}assets/style.css">
</head>
<body>
<header>
<button id="menu" aria-label="Pages">&#9776;</button>
<a class="name" href="{root}index.html">silt<span>.</span></a><span class="version">{html.escape(self.version())}</span>
<span class="space"></span>
<div class="search"><input id="search" type="search" placeholder="Search ( / )" autocomplete="off" aria-label="Search"><div id="found"></div></div>
</header>
<div class="frame">
<nav class="pages">{self.sidebar(address, root)}</nav>
<main{' class="source"' if kind == 'source' else ''}><article{' style="max-width:none"' if wide else ''}>
{body}
</article>{turn}<footer>Made from the markdown and the headers of silt. BSD-3-Clause.</footer></main>
{toc}
</div>
<script src="{root}assets/search_index.js"></script>
<script src="{root}assets/site.js"></script>
</body>
</html>
""")

    def version(self):
        found = re.search(r"project\(silt VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text())
        return found[1] if found else ""

    # Markdown.

    def render(self, text, source, address):
        """(html, title, sections) of markdown; `source` is its path below ROOT."""
        parser = markdown_it.MarkdownIt("commonmark").enable("table")
        tokens = parser.parse(text)
        root = "../" * address.count("/")
        ids, sections, title, seen = set(), [], None, {}
        index_at, words = None, []

        def close_section():
            if index_at is not None:
                self.index.append([self.titles.get(address, index_at[0]), index_at[0], address + index_at[1],
                                   " ".join(" ".join(words).split()), "log" if "changelog" in address else "page"])

        for k, token in enumerate(tokens):
            if token.type == "heading_open":
                inline = tokens[k + 1]
                name = "".join(c.content for c in inline.children if c.type in ("text", "code_inline"))
                anchor = slug(name)
                seen[anchor] = seen.get(anchor, -1) + 1
                if seen[anchor]:
                    anchor += f"-{seen[anchor]}"
                ids.add(anchor)
                token.attrSet("id", anchor)
                level = int(token.tag[1])
                if title is None:
                    title = name
                    self.titles[address] = name
                close_section()
                index_at, words = (name, f"#{anchor}" if level > 1 else ""), []
                sections.append((level, name, anchor))
                mark = type(token)("html_inline", "", 0)
                mark.content = f'<a class="anchor" href="#{anchor}">#</a>'
                inline.children.append(mark)
            elif token.type == "inline":
                depth, heading = 0, tokens[k - 1].type == "heading_open"
                for child in token.children:
                    if child.type == "link_open":
                        depth += 1
                        child.attrSet("href", self.resolve(child.attrGet("href"), source, address))
                    elif child.type == "link_close":
                        depth -= 1
                    elif child.type == "image":
                        child.attrSet("src", self.picture(child.attrGet("src"), source, root))
                        child.attrSet("loading", "lazy")
                    elif child.type == "code_inline" and not depth and not heading:
                        found = re.match(r"(?:silt::)?(\w+)(?:[{<].*)?$", child.content)
                        name = found[1] if found else ""
                        if name in self.by_name and self.address_of(self.by_name[name]) != address:
                            link = self.address_of(self.by_name[name])
                            child.type = "html_inline"
                            child.content = f'<a href="{root}{link}"><code>{html.escape(child.content)}</code></a>'
                    if child.type in ("text", "code_inline") and not heading:
                        words.append(child.content)
                    elif child.type == "html_inline" and "<code>" in child.content:
                        words.append(html.unescape(re.sub(r"<[^>]+>", "", child.content)))
                if not heading:
                    words.append(" ")
            elif token.type in ("fence", "code_block"):
                words.append(token.content)
                language = token.info.strip().split()[0] if token.info.strip() else ""
                token.type = "html_block"
                token.content = (f'<div class="block{"" if language else " formula"}"><pre><code>'
                                 f'{Highlight.code(token.content, language)}</code></pre></div>\n')
        close_section()
        self.anchors[address] = ids
        body = parser.renderer.render(tokens, parser.options, {})
        body = body.replace("<table>", '<div class="wide"><table>').replace("</table>", "</table></div>")
        return body, title or address, sections

    def resolve(self, target, source, address):
        """The address of a link as the site has it."""
        if re.match(r"(https?|mailto):", target):
            return target
        path, _, anchor = urllib.parse.unquote(target).partition("#")
        root = "../" * address.count("/")
        if not path:
            self.links.append((source, address, anchor))
            return "#" + anchor
        place = os.path.normpath(os.path.join(os.path.dirname(source), path))
        if place in self.pages:
            self.links.append((source, self.pages[place], anchor))
            return root + self.pages[place] + ("#" + anchor if anchor else "")
        if not (ROOT / place).exists():
            self.faults.append(f"{source} links to {target}, which is not there")
            return target
        return root + self.source_page(place)

    def source_page(self, place):
        """The address of the page of a source file or folder."""
        if place not in self.sources:
            self.sources[place] = "source/" + place.rstrip("/") + ("/index.html" if (ROOT / place).is_dir() else ".html")
        return self.sources[place]

    def picture(self, target, source, root):
        place = os.path.normpath(os.path.join(os.path.dirname(source), target))
        if not (ROOT / place).exists():
            self.faults.append(f"{source} shows {target}, which is not there")
            return target
        name = "pictures/" + re.sub(r"^docs/(pictures/)?", "", place)
        (self.out / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(ROOT / place, self.out / name)
        return root + name

    def write_sources(self):
        done = set()
        while len(done) < len(self.sources):
            for place, address in list(self.sources.items()):
                if place in done:
                    continue
                done.add(place)
                path = ROOT / place
                root = "../" * address.count("/")
                if path.is_dir():
                    rows = [f'<li><a href="{root}{self.source_page(f"{place}/{c.name}")}">{html.escape(c.name)}</a></li>'
                            for c in sorted(path.iterdir()) if c.is_file() and c.suffix in SOURCES and c.name != ".clang-format"]
                    body = f"<h1>{html.escape(place)}</h1><ul>{''.join(rows)}</ul>"
                else:
                    language = SOURCES.get(path.suffix, "text")
                    lines = Highlight.code(path.read_text(errors="replace"), language).rstrip("\n").split("\n")
                    rows = "\n".join(f'<span class="row" id="L{n}"><span class="line">{n}</span>{line}</span>'
                                     for n, line in enumerate(lines, 1))
                    body = f'<h1>{html.escape(place)}</h1><div class="block"><pre><code>{rows}</code></pre></div>'
                    self.anchors[address] = {f"L{n}" for n in range(1, len(lines) + 1)}
                self.write(address, place, body, [], "source", wide=True)

    # Policies.

    def programs(self):
        """[(path, text)] of compiled programs, the simplest first."""
        if not hasattr(self, "programs_"):
            self.programs_ = []
            for folder in ("examples/first_steps", "docs/code", "examples", "tests"):
                for path in sorted((ROOT / folder).rglob("*.cpp")):
                    if "/compile/" not in path.as_posix():
                        self.programs_.append((path.relative_to(ROOT).as_posix(), path.read_text()))
        return self.programs_

    def snippet(self, policy):
        """(place, lines) of the first statement that names the policy in a program of the docs, an example or a test."""
        names = sorted(policy.names(), key=lambda n: (n != policy.name, n))
        for name in names:
            for place, whole in self.programs():
                if name in whole:
                    lines = whole.split("\n")
                    for at, line in enumerate(lines):
                        code = line.split("//")[0]
                        if re.search(rf"\b(?:silt::)?{name}\b", code) and "static_assert" not in code and "TEST_CASE" not in code \
                                and not code.lstrip().startswith(("#", '"', "template", "using")) \
                                and re.search(rf"\b{name}\b[<{{(: ]", re.sub(r'"[^"]*"', "", code)):
                            first = at
                            while first > 0 and at - first < 8 and not re.search(r"[;{}]\s*(//.*)?$|^\s*(//.*)?$", lines[first - 1]):
                                first -= 1
                            last = at
                            depth = lambda a, b: sum(l.split("//")[0].count("{") + l.split("//")[0].count("(")
                                                     - l.split("//")[0].count("}") - l.split("//")[0].count(")") for l in lines[a:b + 1])
                            while last + 1 < len(lines) and last - first < 14 and (
                                    depth(first, last) > 0 or not re.search(r"[;}]\s*(//.*)?$", lines[last])):
                                last += 1
                            if last - first >= 14 or depth(first, last) != 0:
                                continue
                            piece = lines[first:last + 1]
                            indent = min(len(l) - len(l.lstrip()) for l in piece if l.strip())
                            return place, first + 1, "\n".join(l[indent:] for l in piece)
        return None

    def block_markdown(self, text):
        """Markdown of a doc block: lines that are set in are formulas or code."""
        rows, kind = [], None  # of the block that is open: "" or "cpp"
        for line in text.split("\n"):
            if not re.match(r"^ {2,}\S", line):
                if kind is not None and line.strip():
                    rows += ["```", ""]
                    kind = None
                elif kind is not None:  # a blank line ends a block; another may follow
                    rows += ["```"]
                    kind = None
                rows.append(line if "`" in line else line.replace("<", "&lt;"))
                continue
            if kind is None:
                code = "silt::" in line or re.match(r"^ +(static|struct|template|void|double|flow|sim|water)\b", line)
                kind = "cpp" if code else ""
                rows += ["", "```" + kind]
            rows.append(line)
        if kind is not None:
            rows.append("```")
        return "\n".join(rows)

    @staticmethod
    def declarators(text):
        """[(name, default, type)] of a declaration such as `double a = 1, b{2}`."""
        parts, depth, start = [], 0, 0
        for at, letter in enumerate(text):
            depth += (letter in "<({[") - (letter in ">)}]")
            if letter == "," and depth == 0:
                parts.append(text[start:at].strip())
                start = at + 1
        parts.append(text[start:].strip())
        out, kind = [], ""
        for k, part in enumerate(parts):
            found = re.match(r"(?:mutable )?(.*?)\s*\b(\w+)\s*(?:=\s*(.*)|(\{.*\}))?$", part, re.S)
            if not found:
                return [(part, "", "")]
            kind = found[1].strip() if k == 0 else kind
            out.append((found[2], (found[3] or found[4] or "").strip(), kind))
        return out

    def members_table(self, owner, title):
        rows = []
        for m in owner.members:
            if m.kind != "variable" or not m.public or m.text.startswith(("static", "constexpr", "using")) or "detail::" in m.text:
                continue
            words = m.beside or " ".join(m.comment.split())
            unit = re.match(r"\[([^\]]+)\][,;]?\s*(.*)", words)
            for name, value, kind in self.declarators(m.text):
                row = [f"`{name}`", unit[1] if unit else "", "none" if value == "{}" else f"`{value}`" if value else "",
                       (unit[2] if unit else words).replace("<", "&lt;"), f"`{kind}`"]
                rows.append("| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |")
        if not rows:
            return ""
        return f"\n## {title}\n\n| member | unit | default | meaning | type |\n|---|---|---|---|---|\n" + "\n".join(rows) + "\n"

    def policy_page(self, policy):
        address = self.address_of(policy)
        header = policy.declaration.header
        line = policy.declaration.line
        place = "include/" + header
        source = self.source_page(place)
        self.links.append((address, source, f"L{line}"))
        page = self.pages["docs/" + policy.page]
        text = [f"# {policy.name}\n"]
        crumb = (f'<p class="crumb"><a href="../policies.html#{slug(policy.axis)}">{policy.axis}</a> &middot; explained in '
                 f'<a href="../{page}">{html.escape(self.titles.get(page, page))}</a> &middot; header '
                 f'<a href="../{source}#L{line}"><code>&lt;{header}&gt;</code></a></p>\n')
        if policy.group:
            text.append(f"*{policy.group}*\n")
        text.append(self.block_markdown(policy.body))
        order = [f for f in ("Valid", "Units", "Shapes", "Source", "Deviations", "Numerics", "Memory", "Cost", "Errors", "Tests")
                 if policy.field(f)]
        rows = []
        for word in order:
            value = html.escape(policy.field(word))
            value = re.sub(r"`([^`]+)`", r"<code>\1</code>", value)
            if word == "Tests":
                def linked(found):
                    if (ROOT / found[0]).exists():
                        return f'<a href="../{self.source_page(found[0].rstrip("/"))}">{found[0]}</a>'
                    return found[0]
                value = re.sub(r"tests/[\w/]+(?:\.cpp)?", linked, value)
            rows.append(f"<dt>{word}</dt><dd>{value}</dd>")
        text.append(f'\n<dl class="fields">{"".join(rows)}</dl>\n')
        if policy.aliases:
            text.append("\n## Names\n\n```cpp\n" + "\n".join(a.text + ";" for a in policy.aliases) + "\n```\n")
        for m in policy.declaration.members:
            if m.kind == "type" and m.public and m.name in ("Material", "Pair", "Form", "Setup", "Options", "Part"):
                text.append(self.members_table(m, m.name))
            if m.kind == "enum" and m.public:
                rows = "".join(f"| `{e.name}` | {e.beside} |\n" for e in m.members)
                text.append(f"\n## {m.name}\n\n| value | meaning |\n|---|---|\n{rows}")
        text.append(self.members_table(policy.declaration, "Members"))
        found = self.snippet(policy)
        if found:
            where, number, code = found
            where_address = self.source_page(where)
            text.append(f"\n## Use\n\nFrom [{where}](../{where_address}#L{number}), which is compiled:\n\n```cpp\n{code}\n```\n")
            self.links.append((address, where_address, f"L{number}"))
        body, title, sections = self.render_policy("\n".join(text), address)
        body = body.replace("</h1>", "</h1>\n" + crumb, 1)
        self.write(address, policy.name, body, sections)
        members = " ".join(f"{m.name} {m.beside}" for owner in [policy.declaration, *policy.declaration.members]
                           for m in owner.members if m.kind == "variable" and m.public and not m.text.startswith("static"))
        self.index.append([policy.name, policy.name, address,
                           " ".join((policy.axis + ". " + policy.body + " " + " ".join(f"{w}: {policy.field(w)}" for w in order)
                                     + " " + members).split()), "policy"])

    def render_policy(self, text, address):
        keep = self.resolve
        self.resolve = lambda target, *_: target  # addresses of the site already
        kept = list(self.index)
        try:
            return self.render(text, address, address)
        finally:
            self.resolve = keep
            self.index = kept

    def overview(self):
        rows = ["# Policies\n", "Each policy has a page, made from the comment above it in its header: formula, validity, units, source, "
                "errors, tests, members with units and defaults, and where it is used in a compiled program. "
                "What goes with what: [components](components.html).\n"]
        for axis, (what, page, _) in policies.AXES.items():
            rows.append(f"\n## {axis}\n\n{what} See [{self.titles.get(self.pages['docs/' + page], page)}]({self.pages['docs/' + page]}).\n\n"
                        "| policy | |\n|---|---|\n")
            for p in self.policies:
                if p.axis == axis:
                    summary = p.summary.replace("|", "\\|").replace("<", "&lt;")
                    group = f"*{p.group.split(':')[0]}.* " if p.group else ""
                    rows.append(f"| [`{p.name}`]({self.address_of(p)}) | {group}{summary} |\n")
        body, title, sections = self.render_policy("".join(rows), "policies.html")
        self.write("policies.html", "Policies", body, sections)
        for axis, (what, _, _) in policies.AXES.items():
            own = ", ".join(p.name for p in self.policies if p.axis == axis)
            self.index.append(["Policies", axis, f"policies.html#{slug(axis)}", f"{what} {own}", "policy"])

    # All.

    def build(self):
        if self.out.exists():
            others = [c.name for c in self.out.iterdir() if c.name != "api"]
            if others and not (self.out / "assets" / "search_index.js").exists():
                sys.exit(f"silt: {self.out} holds other files than the site's, as '{others[0]}'; name an empty folder")
            for child in self.out.iterdir():
                if child.name != "api":
                    shutil.rmtree(child) if child.is_dir() else child.unlink()
        assets = self.out / "assets"
        assets.mkdir(parents=True, exist_ok=True)
        for source in self.pages:  # titles first: pages name each other
            first = re.search(r"^# (.*)$", (ROOT / source).read_text(), re.M)
            self.titles[self.pages[source]] = re.sub("`", "", first[1]) if first else source
        for source, address in self.pages.items():
            body, title, sections = self.render((ROOT / source).read_text(), source, address)
            self.write(address, title, body, sections)
        for policy in self.policies:
            self.policy_page(policy)
        self.overview()
        self.write_sources()
        self.write("find.html", "Search", '<h1>Search</h1><p><input id="page-search" type="search" placeholder="Words" '
                   'autocomplete="off" aria-label="Words"></p><p class="crumb" id="number"></p><div id="results"></div>', [])
        shutil.copyfile(HERE / "site.js", assets / "site.js")
        (assets / "style.css").write_text((HERE / "style.css").read_text() + Highlight.styles())
        (assets / "search_index.js").write_text("const SILT_INDEX = " + json.dumps(self.index, ensure_ascii=False) + ";\n")
        self.check()
        return self.faults

    def check(self):
        """Every link within the site leads to a page, and every anchor to an element of it."""
        for source, address, anchor in self.links:
            if not (self.out / address).exists():
                self.faults.append(f"{source} links to {address}, which is not made")
            elif anchor and anchor not in self.anchors.get(address, set()):
                self.faults.append(f"{source} links to {address}#{anchor}, but that page has no such heading")
        # And once more as a reader has them: in the pages that were written.
        ids, wanted = {}, []
        for path in self.out.rglob("*.html"):
            if "api" in path.relative_to(self.out).parts[:1]:
                continue
            text = path.read_text()
            ids[path] = set(re.findall(r'\bid="([^"]+)"', text))
            for target in re.findall(r'\b(?:href|src)="([^"]+)"', text):
                if not re.match(r"(https?|mailto|data):", target):
                    wanted.append((path, target))
        for path, target in wanted:
            place, _, anchor = html.unescape(target).partition("#")
            to = path if not place else pathlib.Path(os.path.normpath(path.parent / place.split("?")[0]))
            if not to.exists():
                self.faults.append(f"{path.relative_to(self.out)} links to {target}, which is not there")
            elif anchor and to in ids and anchor not in ids[to]:
                self.faults.append(f"{path.relative_to(self.out)} links to {target}, which has no such anchor")
        self.counted = len(wanted)


def main():
    options = argparse.ArgumentParser(description="Makes a static site of silt's documentation.")
    options.add_argument("--out", default=str(ROOT / "out" / "docs"), help="folder of the site (out/docs)")
    chosen = options.parse_args()
    site = Site(pathlib.Path(chosen.out).resolve())
    faults = sorted(set(site.build()))
    for fault in faults:
        print(f"silt: {fault}", file=sys.stderr)
    pages = sum(1 for _ in site.out.rglob("*.html"))
    print(f"silt: {pages} pages, {len(site.policies)} of them policies, {site.counted} links, {len(site.index)} sections to search"
          f"{', ' + str(len(faults)) + ' faults' if faults else ''}: {site.out / 'index.html'}")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
