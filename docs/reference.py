"""Makes the reference part of the guide from include/luxfer.h and from the docstrings of the Python package.

A public item without a description is an error, so the reference is complete whenever it can be built.
"""

from __future__ import annotations

import ast
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "bindings" / "python"))

import generate  # noqa: E402  parses the header, for the Python package

PACKAGE = ROOT / "bindings" / "python" / "luxfer"
#: A vertical bar in a cell of a table; an HTML entity would be shown literally in code.
BAR = "\\|"
KINDS = ("constant", "integer", "callback", "opaque", "struct", "function")


class Undocumented(Exception):
    """A public item has no description."""


def slug(title: str) -> str:
    return re.sub(r"\W+", "-", title.lower()).strip("-")


# --------------------------------------------------------------------------------------------------------- the C header


class Header:
    """The sections of the header with their items, and the page on which each item is described."""

    def __init__(self) -> None:
        self.sections: dict[str, dict] = {}
        self.pages: dict[str, str] = {}  # item: page
        self.fields: dict[str, list[generate.Field]] = {}
        missing, section = [], {}
        for match in generate.ITEM.finditer(generate.header_text()):
            item = match.groupdict()
            if item["section"]:
                prose = "\n".join(re.sub(r"^ \* ?", "", line) for line in match[0].split("\n")[1:-1])
                section = self.sections.setdefault(item["section"], {"prose": prose.partition("\n\n")[2], "items": []})
                page = f"reference/c/{slug(item['section'])}.md"
                continue
            kind = next(k for k in KINDS if item[k])
            name, doc = item[kind], generate.uncomment(item["doc"] or "")
            code = re.sub(r"^\s*/\*\*(?:(?!\*/).)*\*/\s*", "", match[0], flags=re.S).strip()
            section["items"].append((kind, name, doc, code))
            self.pages[name] = page
            # The three macros of the version share one comment.
            if not doc and not name.startswith("LUXFER_VERSION_"):
                missing.append(name)
            if kind == "struct":
                self.fields[name] = generate.members(item["body"])
                missing += [f"{name}.{f.name}" for f in self.fields[name] if not f.doc]
        # An inline function stands beside its struct in the header and is described with it.
        pattern = re.compile(r"^static inline luxfer_status (luxfer_\w+)\((luxfer_\w+) \*", re.M)
        headers = sorted((generate.HEADER.parent / "luxfer").glob("*.h"))
        self.inline = dict(pair for header in headers for pair in pattern.findall(header.read_text()))
        self.pages.update({name: self.pages[struct] for name, struct in self.inline.items()})
        if missing:
            raise Undocumented("include/luxfer.h does not describe " + ", ".join(missing))

    # -- prose

    def link(self, name: str, page: str) -> str:
        """Formats a name as code, with a link to its description if there is one."""
        known = self.pages.get(name)
        return f"[`{name}`]({relative(known, page)}#{self.inline.get(name, name)})" if known else f"`{name}`"

    def prose(self, text: str, page: str) -> str:
        """Converts a comment to Markdown: names become links, code is marked as code, and errors get their own
        paragraph."""
        text = re.sub(r"(?<=\.)\n(?=LUXFER_|As luxfer_)", "\n\n", text)
        token = re.compile(r'\b(?:luxfer|LUXFER)_\w+|"[^"\n]*[<>*\[\]|^][^"\n]*"|(?<![\w*])\*\w+|[<>*|]')

        def mark(match: re.Match) -> str:
            found = match[0]
            if found.startswith(("luxfer_", "LUXFER_")):
                return self.link(found, page)
            if len(found) == 1:
                return {"<": "&lt;", ">": "&gt;"}.get(found, "\\" + found)
            return f"`{found}`"

        return token.sub(mark, text)

    def table(self, struct: str, page: str, skip: tuple[str, ...] = ()) -> str:
        """Returns the table of the fields of a struct."""
        rows = ["| field | type | |", "|---|---|---|"]
        for f in self.fields[struct]:
            if f.name not in skip:
                kind = f.type + " " + "*" * f.stars if f.stars else f.type
                kind += "".join(f"[{n}]" for n in f.dims)
                rows.append(f"| `{f.name}` | `{kind.strip()}` | {self.prose(' '.join(f.doc.split()), page)} |")
        return "\n".join(rows) + "\n"

    # -- pages

    def index(self) -> str:
        """Returns the page that lists all items, by section and kind."""
        out = ["# C reference\n", "All functions, structs and callbacks of `luxfer.h`, by section. A section also has its constants.\n"]
        for title, section in self.sections.items():
            page = f"reference/c/{slug(title)}.md"
            names = [name for kind, name, _, _ in section["items"] if kind in ("function", "struct", "callback", "opaque")]
            out.append(f"## [{title}]({slug(title)}.md)\n")
            links = (f"[`{name}`]({relative(page, 'reference/c/')}#{name})" for name in names)
            out.append((", ".join(links) or "Only constants.") + "\n")
        return "\n".join(out)

    def page(self, title: str) -> str:
        section, path = self.sections[title], f"reference/c/{slug(title)}.md"
        out = [f"# {title}\n", self.outline(section["prose"], path)]
        constants: list[tuple[str, str, str]] = []

        def flush() -> None:
            if constants:
                out.append("| constant | value | |\n|---|---|---|")
                for name, value, doc in constants:
                    text = self.prose(" ".join(doc.split()), path)
                    out.append(f'| <span id="{name}"></span>`{name}` | `{value}` | {text} |')
                out.append("")
                constants.clear()

        for kind, name, doc, code in section["items"]:
            if kind == "constant":
                constants.append((name, code.split(None, 2)[2], doc))
                continue
            flush()
            out.append(f"## {name} {{ #{name} }}\n")
            if kind in ("callback", "function"):
                out.append(f"```c\n{code}\n```\n")
            out.append(self.prose(doc, path) + "\n")
            if kind == "struct":
                out.append(self.table(name, path))
        flush()
        return "\n".join(out)

    def outline(self, text: str, page: str) -> str:
        """Returns the introduction of a section; lines that are indented by four spaces are code."""
        parts = []
        for part in text.split("\n\n"):
            parts.append(f"```c\n{part}\n```" if part.startswith("    ") else self.prose(part, page))
        return "\n\n".join(parts) + "\n"


def relative(target: str, page: str) -> str:
    """Returns the relative path from one page to another."""
    up = page.count("/")
    return "../" * up + target


# --------------------------------------------------------------------------------------------------- the Python package


def python_pages() -> dict[str, tuple[str, str]]:
    """Returns title and text of each page, by path."""
    exported = ast.parse((PACKAGE / "__init__.py").read_text())
    names = exported_names(exported)
    out = {"reference/python/index.md": ("Overview", f"# The Python package\n\n{ast.get_docstring(exported)}\n")}
    described = {"abi", "library"}  # the modules of the C interface, which the header describes
    for path in sorted(PACKAGE.glob("[a-z]*.py")):
        tree = ast.parse(path.read_text())
        listed = path.stem in ("types", "errors")
        items = [
            node
            for node in tree.body
            if isinstance(node, (ast.ClassDef, ast.FunctionDef))
            and not node.name.startswith("_")
            and (listed or node.name in names or node.name in ("Level",))
        ]
        if not items:
            continue
        described |= {node.name for node in items} | {path.stem}
        text = [f"# luxfer.{path.stem}\n", docstring(tree, path.stem), ""]
        for node in items:
            text.append(klass(node) if isinstance(node, ast.ClassDef) else function(node, "##", ""))
        out[f"reference/python/{path.stem}.md"] = (path.stem, "\n".join(text))
    if missing := names - described:
        raise Undocumented(f"no page describes these names of luxfer.__all__: {missing}")
    out["reference/python/design.md"] = ("design", design_page())
    title, overview = out["reference/python/index.md"]
    listed = "".join(f"- [luxfer.{name}]({path.rpartition('/')[2]})\n" for path, (name, _) in out.items() if name != title)
    out["reference/python/index.md"] = (title, f"{overview}\n## Modules\n\n{listed}")
    return out


def exported_names(module: ast.Module) -> set[str]:
    """Returns the names in a module's __all__."""
    return next(
        {c.value for c in ast.walk(node.value) if isinstance(c, ast.Constant)}
        for node in module.body
        if isinstance(node, ast.Assign) and getattr(node.targets[0], "id", "") == "__all__"
    )


#: Modules of luxfer.design that are exported as such, by the files whose items they have.
OWNERS = {n: n for n in ("areas", "emergency", "observers", "radiance", "schedule")}
OWNERS |= {"ifc_read": "ifc", "ifc_write": "ifc"}


def design_page() -> str:
    """Returns the page of luxfer.design: the items that the package exports, and all public functions of its
    modules."""
    exported = ast.parse((PACKAGE / "design" / "__init__.py").read_text())
    names, described = exported_names(exported), set()
    text = ["# luxfer.design\n", docstring(exported, "design"), ""]
    for path in sorted((PACKAGE / "design").glob("[a-z]*.py")):
        tree = ast.parse(path.read_text())
        described |= {path.stem}
        for node in tree.body:
            if not isinstance(node, (ast.ClassDef, ast.FunctionDef)) or node.name.startswith("_"):
                continue
            # A name that belongs to an exported module is shown with the name of the module.
            owner = OWNERS.get(path.stem, "")
            if node.name in names or owner:
                described |= {node.name, owner} - {""}
                text.append(klass(node) if isinstance(node, ast.ClassDef) else function(node, "##", owner))
    if missing := names - described:
        raise Undocumented(f"no page describes these names of luxfer.design.__all__: {missing}")
    return "\n".join(text)


def docstring(node: ast.AST, name: str) -> str:
    """Converts a docstring to Markdown, with its examples as code."""
    text = ast.get_docstring(node)
    if not text:
        raise Undocumented(f"{name} of the Python package has no docstring")
    parts = []
    for part in text.split("\n\n"):
        parts.append(f"```pycon\n{part}\n```" if part.startswith(">>>") else escape(part))
    return "\n\n".join(parts) + "\n"


def escape(text: str) -> str:
    return re.sub(r"([*<>|])", r"\\\1", text)


def klass(node: ast.ClassDef) -> str:
    out = [f"## {node.name}\n", docstring(node, node.name)]
    rows = []
    for item, following in zip(node.body, [*node.body[1:], ast.Pass()]):
        doc = following.value.value if isinstance(following, ast.Expr) and isinstance(following.value, ast.Constant) else ""
        if isinstance(item, ast.AnnAssign) and not item.target.id.startswith("_"):
            rows.append((item.target.id, ast.unparse(item.annotation), doc))
        elif isinstance(item, ast.Assign) and doc:
            rows.append((item.targets[0].id, ast.unparse(item.value), doc))
    if rows:
        out.append("| | | |\n|---|---|---|")
        out += [f"| `{name}` | `{kind.replace('|', BAR)}` | {escape(' '.join(doc.split()))} |" for name, kind, doc in rows]
        out[-1] += "\n"
    for item in node.body:
        if isinstance(item, ast.FunctionDef) and (item.name == "__init__" or not item.name.startswith("_")):
            out.append(function(item, "###", node.name))
    return "\n".join(out)


def function(node: ast.FunctionDef, level: str, owner: str) -> str:
    decorators = [ast.unparse(d) for d in node.decorator_list]
    arguments = ast.unparse(node.args).removeprefix("self, ").removeprefix("cls, ")
    arguments = "" if arguments in ("self", "cls") else arguments
    path = f"{owner}.{node.name}" if owner else node.name
    if node.name == "__init__":
        return f"```python\n{owner}({arguments})\n```\n"
    result = f" -> {ast.unparse(node.returns)}" if node.returns else ""
    shown = f"{path}{result.replace(' ->', ':')}" if "property" in decorators else f"{path}({arguments}){result}"
    return f"{level} {path} {{ #{path} }}\n\n```python\n{shown}\n```\n\n{docstring(node, path)}"
