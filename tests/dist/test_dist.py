"""Tests of the scripts that pack the library (bindings/dist), without building it: equal contents give equal archives,
and the bill of materials lists what is linked, as Cargo.lock and the notices of the licences have it."""

import json
import os
import re
import struct
import subprocess
import sys
import tarfile
import tempfile
import tomllib
import unittest
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
DIST = ROOT / "bindings" / "dist"
TRIPLE = "x86_64-unknown-linux-gnu"


class Archives(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)

    def pack(self, place, names, ending, epoch="1700000000"):
        """Packs a folder whose files are made in the order of `names`; the modification times are those of now."""
        top = self.folder / place / "luxfer-1"
        (top / "lib").mkdir(parents=True)
        for name in names:
            (top / name).write_text(f"content of {name}")
        (top / "lib" / "tool").chmod(0o700)
        (top / "lib" / "libluxfer.so").symlink_to("b")
        archive = self.folder / place / f"packed{ending}"
        environment = {**os.environ, "SOURCE_DATE_EPOCH": epoch}
        subprocess.run([sys.executable, DIST / "archive.py", top, archive], check=True, env=environment)
        return archive

    def test_equal_contents_give_equal_bytes(self):
        for ending in (".tar.gz", ".zip"):
            first = self.pack("one" + ending, ["a", "lib/b", "lib/tool"], ending).read_bytes()
            self.assertEqual(first, self.pack("two" + ending, ["lib/tool", "lib/b", "a"], ending).read_bytes())
            self.assertNotEqual(first, self.pack("later" + ending, ["a", "lib/b", "lib/tool"], ending, "1800000000").read_bytes())

    def test_links_modes_and_contents(self):
        with tarfile.open(self.pack("tar", ["lib/b", "lib/tool"], ".tar.gz")) as tar:
            self.assertEqual(tar.getmember("luxfer-1/lib/libluxfer.so").linkname, "b")
            self.assertEqual(tar.getmember("luxfer-1/lib/tool").mode, 0o755)
            self.assertEqual(tar.getmember("luxfer-1/lib/b").mode, 0o644)
            self.assertEqual({m.uid for m in tar} | {m.gid for m in tar}, {0})
        with zipfile.ZipFile(self.pack("zip", ["lib/b", "lib/tool"], ".zip")) as packed:
            self.assertEqual(packed.read("luxfer-1/lib/libluxfer.so"), b"content of lib/b")


class Bill(unittest.TestCase):
    def bill(self, triple):
        return subprocess.run([sys.executable, DIST / "sbom.py", triple], check=True, capture_output=True).stdout

    def test_it_lists_the_linked_crates(self):
        text = self.bill(TRIPLE)
        self.assertEqual(text, self.bill(TRIPLE))
        bill = json.loads(text)
        self.assertEqual((bill["bomFormat"], bill["specVersion"]), ("CycloneDX", "1.5"))
        components = {(c["name"], c["version"]): c for c in bill["components"]}
        # The notices that are packed beside it also name macros, which are not linked, and what they need.
        notices = subprocess.run([ROOT / "bindings" / "third_party.sh"], check=True, capture_output=True, text=True).stdout
        named = set(re.findall(r"^==== (\S+) v(\S+) \(", notices, re.M))
        self.assertGreater(len(named), 50)
        self.assertEqual({k for k in components if k[0] != "rust-std"} - named, set())
        names = {name for name, _ in components}
        self.assertLessEqual({"exr", "image", "gltf", "glam", "rayon-core", "rust-std"}, names)
        self.assertFalse({"syn", "quote", "serde_derive", "cbindgen", "luxfer"} & names)

        sums = {(p["name"], p["version"]): p.get("checksum") for p in tomllib.loads((ROOT / "Cargo.lock").read_text())["package"]}
        for key, component in components.items():
            self.assertTrue(component["licenses"][0]["expression"], key)
            if key[0] != "rust-std":
                self.assertEqual(component["hashes"][0]["content"], sums[key])

    def test_references_lead_somewhere(self):
        bill = json.loads(self.bill(TRIPLE))
        known = {c["bom-ref"] for c in bill["components"]} | {bill["metadata"]["component"]["bom-ref"]}
        self.assertEqual(len(known), len(bill["components"]) + 1)
        for edge in bill["dependencies"]:
            self.assertIn(edge["ref"], known)
            self.assertLessEqual(set(edge["dependsOn"]), known)


class Universal(unittest.TestCase):
    """Libraries for macOS, each of a header and its load commands, joined into one."""

    def library(self, processor, length):
        def command(kind, name):
            text = name.encode() + b"\0"
            text = text.ljust(-(-len(text) // 8) * 8, b"\0")
            return struct.pack("<IIIIII", kind, 24 + len(text), 24, 2, 0, 0) + text

        commands = [command(0xC, "/usr/lib/libSystem.B.dylib"), command(0xD, "@rpath/libluxfer.1.dylib")]
        head = struct.pack("<8I", 0xFEEDFACF, processor, 3, 6, len(commands), sum(map(len, commands)), 0, 0)
        return (head + b"".join(commands)).ljust(length, b"\1")

    def test_joined_parts_are_found_again(self):
        parts = [self.library(0x0100000C, 20000), self.library(0x01000007, 300)]
        with tempfile.TemporaryDirectory() as folder:
            paths = [Path(folder, name) for name in ("arm", "x86", "both")]
            for path, part in zip(paths, parts):
                path.write_bytes(part)
            tool = [sys.executable, DIST / "universal.py"]
            subprocess.run([*tool, "join", paths[2], *paths[:2]], check=True)
            joined = paths[2].read_bytes()
            shown = subprocess.run([*tool, "show", paths[2]], check=True, capture_output=True, text=True).stdout
        magic, count = struct.unpack_from(">II", joined)
        self.assertEqual((magic, count), (0xCAFEBABE, 2))
        for k, part in enumerate(parts):
            processor, version, offset, length, alignment = struct.unpack_from(">5I", joined, 8 + 20 * k)
            self.assertEqual((processor, version), struct.unpack_from("<II", part, 4))
            self.assertEqual(offset % (1 << alignment), 0)
            self.assertEqual(joined[offset : offset + length], part)
        needs = "@rpath/libluxfer.1.dylib needs /usr/lib/libSystem.B.dylib"
        self.assertEqual(shown, f"arm64 {needs}\nx86_64 {needs}\n")

    def test_other_files_are_refused(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "other")
            path.write_bytes(bytes(100))
            for arguments in (["join", Path(folder, "out"), path], ["show", path], []):
                run = subprocess.run([sys.executable, DIST / "universal.py", *arguments], capture_output=True)
                self.assertNotEqual(run.returncode, 0)


class Crate(unittest.TestCase):
    """The files that cargo packs into the crate."""

    def test_it_contains_what_a_build_reads_and_no_more(self):
        command = ["cargo", "package", "--list", "--allow-dirty", "--offline"]
        run = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
        self.assertNotIn("manifest has no", run.stderr)
        names = {name for name in run.stdout.split() if (ROOT / name).exists()}
        others = {n for n in names if not re.match(r"(src|include)/.*\.(rs|h)$", n)}
        wanted = {"Cargo.toml", "Cargo.lock", "build.rs", "README.md", "CHANGELOG.md", "LICENSE-APACHE", "LICENSE-MIT"}
        self.assertEqual(others, wanted)
        sources = {p.relative_to(ROOT).as_posix() for folder in ("src", "include") for p in (ROOT / folder).rglob("*.*")}
        self.assertEqual(names - wanted, sources)
        self.assertLess(sum((ROOT / n).stat().st_size for n in names), 8e6, "crates.io allows 10 MB, packed")
        # No source includes a file that is not packed.
        for name in names:
            if name.endswith(".rs"):
                text = (ROOT / name).read_text()
                for included in re.findall(r'include(?:_str|_bytes)?!\("([^"]+)"\)', text):
                    path = os.path.normpath(os.path.join(os.path.dirname(name), included))
                    self.assertIn(path, names, f"{name} includes {included}")


class Extension(unittest.TestCase):
    """The Blender extension from the wheel of any platform; a text stands in for the library."""

    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)
        self.version = tomllib.loads((ROOT / "Cargo.toml").read_text())["package"]["version"]

    def build(self, tag, library, version=None, out="out", epoch="1700000000"):
        """Builds the extension from a wheel with this tag and this library."""
        wheel = self.folder / f"luxfer-{version or self.version}-py3-none-{tag}.whl"
        with zipfile.ZipFile(wheel, "w") as packed:
            packed.writestr(zipfile.ZipInfo(f"luxfer/{library}"), "the library")
        command = [sys.executable, ROOT / "bindings" / "blender" / "build.py", self.folder / out, "--wheel", wheel]
        environment = {**os.environ, "SOURCE_DATE_EPOCH": epoch}
        return wheel, subprocess.run(command, capture_output=True, text=True, env=environment)

    def test_its_contents_for_each_platform(self):
        for tag, library, platform in (
            ("win_amd64", "luxfer.dll", "windows-x64"),
            ("win_arm64", "luxfer.dll", "windows-arm64"),
            ("manylinux_2_17_x86_64", "libluxfer.so", "linux-x64"),
            ("linux_x86_64", "libluxfer.so", "linux-x64"),
            ("manylinux_2_17_aarch64", "libluxfer.so", "linux-arm64"),
            ("macosx_11_0_arm64", "libluxfer.dylib", "macos-arm64"),
        ):
            with self.subTest(tag):
                wheel, run = self.build(tag, library)
                self.assertEqual(run.returncode, 0, run.stderr)
                made = Path(run.stdout.strip())
                self.assertEqual(made, self.folder / "out" / f"luxfer_lighting-{self.version}-{platform}.zip")
                with zipfile.ZipFile(made) as packed:
                    names = packed.namelist()
                    manifest = tomllib.loads(packed.read("blender_manifest.toml").decode())
                    self.assertEqual(packed.read(f"wheels/{wheel.name}"), wheel.read_bytes())
                self.assertEqual(manifest["platforms"], [platform])
                self.assertEqual(manifest["wheels"], [f"./wheels/{wheel.name}"])
                self.assertEqual((manifest["id"], manifest["version"]), ("luxfer_lighting", self.version))
                add_on = {p.name for p in (ROOT / "bindings" / "blender" / "luxfer_lighting").glob("*.py")}
                wanted = add_on | {"blender_manifest.toml", "LICENSE-MIT", "LICENSE-APACHE", f"wheels/{wheel.name}"}
                self.assertEqual(sorted(names), sorted(wanted))

    def test_equal_wheels_give_equal_bytes(self):
        def made(**options):
            return Path(self.build("win_amd64", "luxfer.dll", **options)[1].stdout.strip()).read_bytes()

        self.assertEqual(made(), made(out="other"))
        self.assertNotEqual(made(), made(out="later", epoch="1800000000"))

    def test_wrong_wheels_are_refused(self):
        for tag, library, version, message in (
            ("win_amd64", "libluxfer.so", None, "luxfer/luxfer.dll"),
            ("any", "luxfer.dll", None, "PLATFORM"),
            ("win_amd64", "luxfer.dll", "9.9.9", "version 9.9.9"),
        ):
            with self.subTest(tag):
                _, run = self.build(tag, library, version)
                self.assertNotEqual(run.returncode, 0)
                self.assertIn(message, run.stderr)
                self.assertFalse((self.folder / "out").exists())


if __name__ == "__main__":
    unittest.main()
