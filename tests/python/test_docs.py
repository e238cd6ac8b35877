"""Tests the documentation: every example runs, and everything public has a docstring and annotations."""

import ast
import doctest
import importlib
import inspect
import os
import pkgutil
import re
import unittest

from support import PACKAGE, Case, context, demo, lit_room, luxfer, np


def modules():
    """The modules of the package and of its command line."""
    import luxfer.cli

    names = [f"luxfer.{m.name}" for m in pkgutil.iter_modules(luxfer.__path__)]
    names += [f"luxfer.cli.{m.name}" for m in pkgutil.iter_modules(luxfer.cli.__path__)]
    return [importlib.import_module(name) for name in names]


class Documentation(Case):
    def test_docstring_examples(self):
        photo, strokes = demo()
        names = {name: getattr(luxfer, name) for name in luxfer.__all__}
        names |= {"np": np, "context": context(), "photo": photo, "strokes": strokes, "lit_room": lit_room()}
        for name, scene in (("room", "target-room"), ("ball", "sphere-on-table"), ("still_life", "still-life")):
            names[name] = luxfer.Scene.demo(context(), scene)
        attempted = 0
        for module in modules():
            result = doctest.testmod(module, extraglobs=names)
            self.assertEqual(result.failed, 0, module.__name__)
            attempted += result.attempted
        self.assertGreater(attempted, 40)

    def test_readme_examples(self):
        self.assertGreater(self.run_blocks(PACKAGE / "README.md"), 4)
        self.assertEqual({p.name for p in self.folder.iterdir()}, {"lit.png", "lit.glb", "layers.exr"})

    def test_the_example_of_the_projects_readme(self):
        photo, strokes = demo()
        photo.save(self.folder / "photo.png")
        strokes.save(self.folder / "strokes.png")
        luxfer.Scene.demo(context(), "target-room").export(self.folder / "scene.glb")
        smaller = {"photo.jpg": "photo.png", "640": "64", "360": "36"}
        self.assertEqual(self.run_blocks(PACKAGE.parent.parent / "README.md", smaller), 1)
        self.assertEqual(luxfer.Image.load(context(), self.folder / "lit.png").size[:2], (64, 36))

    def test_the_first_screen_of_the_readme_shows_the_studio(self):
        """The pictures of the README exist, are wide enough to read and small enough to load."""
        root = PACKAGE.parent.parent
        text = (root / "README.md").read_text()
        pictures = re.findall(r"!\[[^]]+\]\(([^)]+)\)", text)
        self.assertEqual(pictures[0], "docs/studio.jpg")
        self.assertLess(text.partition(pictures[0])[0].count("\n"), 10)
        for name in pictures:
            data = (root / name).read_bytes()
            self.assertLess(len(data), 400_000, name)
            width, height, _ = luxfer.Image.from_bytes(context(), data).size
            self.assertGreaterEqual(width, 1200, name)
            self.assertGreater(height, 400, name)

    def run_blocks(self, page, instead=()):
        """Runs the Python blocks of a page in the test's folder, with words replaced by `instead`; returns their
        number."""
        blocks = re.findall(r"```python\n(.*?)```", page.read_text(), re.S)
        names: dict = {"print": lambda *_: None}
        before = os.getcwd()
        os.chdir(self.folder)
        try:
            for block in blocks:
                for word in instead:
                    self.assertIn(word, block)
                    block = block.replace(word, instead[word])
                exec(block, names)
        finally:
            os.chdir(before)
        return len(blocks)

    def test_names_of_enumerations_are_right(self):
        """Docstrings of functions with an enumeration parameter name only existing members; those of `image` name
        all."""
        tested = 0
        for path in (PACKAGE / "luxfer").glob("[a-z]*.py"):
            for node in ast.walk(ast.parse(path.read_text())):
                doc = ast.get_docstring(node) if isinstance(node, ast.FunctionDef) else None
                for name in set(re.findall(r"\bmember\((\w+),", ast.unparse(node))) if doc else ():
                    if not (kind := getattr(luxfer.types, name, None)):
                        continue
                    names = {member.name.lower().replace("_", "-") for member in kind}
                    named = {word for text in re.findall(r'"([^"\n]+)"', doc.partition(">>>")[0]) for word in text.split("|")}
                    named = {word for word in named if re.fullmatch("[a-z-]+", word)}
                    self.assertLessEqual(named, names, f"{path.stem}.{node.name}")
                    if node.name == "image":
                        self.assertEqual(named, names, f"{path.stem}.{node.name}")
                    tested += bool(named)
        self.assertGreater(tested, 20)

    def test_everything_is_described_and_annotated(self):
        missing = []
        for module in modules():
            if not module.__doc__:
                missing.append(module.__name__)
            for name, item in vars(module).items():
                if (
                    name.startswith("_")
                    or getattr(item, "__module__", None) != module.__name__
                    or module.__name__.endswith("_abi")
                ):
                    continue
                missing += self.lacking(f"{module.__name__}.{name}", item, module.__name__.rpartition(".")[2].startswith("_"))
        self.assertEqual(missing, [])
        self.assertTrue((PACKAGE / "luxfer" / "py.typed").exists())

    def lacking(self, path, item, is_private):
        """Paths of the parts of an item that lack a docstring (private ones need none) or an annotation."""
        if inspect.isclass(item):
            out = [] if item.__doc__ or is_private else [path]
            for name, member in vars(item).items():
                function = member.fget if isinstance(member, property) else getattr(member, "__func__", member)
                if (
                    not inspect.isfunction(function)
                    or function.__module__ != item.__module__
                    or path.startswith("luxfer.types.")
                ):
                    continue
                if "lambda" not in function.__qualname__ and (not name.startswith("__") or name == "__init__"):
                    if function.__code__.co_filename != "<string>":  # not made by dataclass
                        out += self.lacking(f"{path}.{name}", function, is_private or name.startswith("_"))
            return out
        if not inspect.isfunction(item):
            return []
        out = [] if item.__doc__ or is_private else [path]
        for parameter in inspect.signature(item).parameters.values():
            if parameter.name not in ("self", "cls") and parameter.annotation is parameter.empty:
                out.append(f"{path}({parameter.name})")
        if inspect.signature(item).return_annotation is inspect.Signature.empty:
            out.append(f"{path} ->")
        return out


if __name__ == "__main__":
    unittest.main()
