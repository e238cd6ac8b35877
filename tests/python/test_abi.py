"""Tests that the package agrees with the header: bindings are up to date and complete, structs have the C compiler's
layout."""

import ctypes
import re
import shutil
import subprocess
import sys
import unittest

from support import PACKAGE, ROOT, Case, luxfer

from luxfer import abi, errors, types

# Functions that no module of the package uses; programs may call them through luxfer.library.
ABI_ONLY = {"luxfer_retain", "luxfer_status_get_name", "luxfer_warning_get_name"}


class Drift(Case):
    def test_what_is_generated_is_what_the_header_says(self):
        check = subprocess.run([sys.executable, PACKAGE / "generate.py", "--check"], capture_output=True, text=True)
        self.assertEqual(check.returncode, 0, check.stderr)

    def test_functions_that_are_to_go_are_read_too(self):
        sys.path.insert(0, str(PACKAGE))
        import generate

        text = '/** Does it. */\nLUXFER_DEPRECATED("use luxfer_new(x);")\nluxfer_status luxfer_old(int32_t number);\n'
        header = generate.read(text)
        self.assertEqual(list(header.functions), ["luxfer_old"])
        self.assertEqual(header.docs["luxfer_old"], "Does it.")

    def test_every_function_is_bound_with_as_many_arguments_as_it_has(self):
        header = re.sub(r"/\*.*?\*/", "", "".join(p.read_text() for p in (ROOT / "include" / "luxfer").glob("*.h")), flags=re.S)
        declared = dict(re.findall(r"\b(luxfer_\w+)\(([^()]*)\);", header))
        self.assertGreater(len(declared), 190)
        self.assertEqual(set(declared), set(abi.FUNCTIONS))
        for name, arguments in declared.items():
            count = 0 if arguments.strip() == "void" else arguments.count(",") + 1
            self.assertEqual(len(getattr(luxfer.library, name).argtypes), count, name)

    def test_every_function_is_used_by_the_modules(self):
        """All functions except those in ABI_ONLY; Python's objects count references themselves."""
        source = "".join(p.read_text() for p in (PACKAGE / "luxfer").glob("*.py") if p.name not in ("_abi.py", "types.py"))
        kinds = re.findall(r'kind = "(\w+)"', source)
        verbs = set(re.findall(r'_(?:call|read|fill|job|get_image|get_text|add)\(\s*"(\w+)"', source))
        unused = []
        for name in abi.FUNCTIONS:
            kind = max((k for k in kinds if name.startswith(f"luxfer_{k}_")), key=len, default=None)
            verb = name.removeprefix(f"luxfer_{kind}_") if kind else ""
            generic = verb == "create"
            if not generic and name not in source and verb not in verbs:
                unused.append(name)
        self.assertEqual(set(unused), ABI_ONLY, "add them to a module, or to ABI_ONLY")

    def test_every_status_has_an_exception(self):
        self.assertEqual(set(errors.BY_STATUS), set(types.Status) - {types.Status.OK})
        for status in types.Status:
            self.assertEqual(luxfer.library.luxfer_status_get_name(status).decode(), f"LUXFER_{status.name}")

    def test_structs_have_the_layout_of_the_c_compiler(self):
        compiler = shutil.which("cc") or shutil.which("gcc")
        if not compiler:
            self.skipTest("there is no C compiler")
        lines, expected = [], []
        for name, struct in vars(abi).items():
            if isinstance(struct, type) and issubclass(struct, ctypes.Structure) and hasattr(struct, "_fields_"):
                lines.append(f'printf("{name} %zu\\n", sizeof({name}));')
                expected.append(f"{name} {ctypes.sizeof(struct)}")
                for field, *_ in struct._fields_:
                    lines.append(
                        f'printf("{name}.{field} %zu %zu\\n", offsetof({name}, {field}), sizeof((({name} *)0)->{field}));'
                    )
                    member = getattr(struct, field)
                    expected.append(f"{name}.{field} {member.offset} {member.size}")
        self.assertGreater(len(expected), 200)
        (self.folder / "a.c").write_text(
            '#include "luxfer.h"\n#include <stdio.h>\nint main(void) {\n' + "\n".join(lines) + "\nreturn 0;\n}\n"
        )
        subprocess.run([compiler, "-I", ROOT / "include", "a.c", "-o", "a"], cwd=self.folder, check=True)
        printed = subprocess.run(["./a"], cwd=self.folder, check=True, capture_output=True, text=True).stdout
        self.assertEqual(printed.split("\n")[:-1], expected)


if __name__ == "__main__":
    unittest.main()
