"""Packs a folder into an archive whose bytes depend on nothing but the names, contents and modes of its files.

    archive.py FOLDER ARCHIVE    ARCHIVE ends in .tar.gz or .zip; its top folder has the name of FOLDER

All files get the time SOURCE_DATE_EPOCH (seconds since 1970) and belong to no particular user.
"""

from __future__ import annotations

import gzip
import io
import os
import stat
import sys
import tarfile
import time
import zipfile
from pathlib import Path

WHEN = int(os.environ.get("SOURCE_DATE_EPOCH", "1735689600"))


def entries(folder: Path) -> list[Path]:
    """All files, links and folders in it, in an order that does not depend on the file system."""
    return sorted(folder.rglob("*"), key=lambda path: path.relative_to(folder).as_posix())


def mode(path: Path) -> int:
    return 0o755 if path.is_dir() or path.stat().st_mode & stat.S_IXUSR else 0o644


def write_tar(folder: Path, archive: Path) -> None:
    content = io.BytesIO()
    with tarfile.open(fileobj=content, mode="w", format=tarfile.GNU_FORMAT) as tar:
        for path in entries(folder):
            info = tar.gettarinfo(path, f"{folder.name}/{path.relative_to(folder).as_posix()}")
            info.mtime, info.uid, info.gid, info.uname, info.gname = WHEN, 0, 0, "", ""
            info.mode = 0o777 if info.issym() else mode(path)
            with open(path, "rb") if info.isreg() else io.BytesIO() as file:
                tar.addfile(info, file)
    with open(archive, "wb") as file, gzip.GzipFile("", "wb", 9, file, mtime=WHEN) as packed:
        packed.write(content.getvalue())


def write_zip(folder: Path, archive: Path) -> None:
    """Links become copies, because Windows creates links for administrators only."""
    when = time.gmtime(WHEN)[:6]
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as packed:
        for path in entries(folder):
            if path.is_dir():
                continue
            info = zipfile.ZipInfo(f"{folder.name}/{path.relative_to(folder).as_posix()}", when)
            info.external_attr = (stat.S_IFREG | mode(path)) << 16
            info.compress_type = zipfile.ZIP_DEFLATED
            packed.writestr(info, path.read_bytes(), compresslevel=9)


def main(arguments: list[str]) -> None:
    if len(arguments) != 2 or not arguments[1].endswith((".tar.gz", ".zip")):
        raise SystemExit(__doc__)
    folder, archive = Path(arguments[0]).resolve(), Path(arguments[1])
    (write_zip if archive.suffix == ".zip" else write_tar)(folder, archive)


if __name__ == "__main__":
    main(sys.argv[1:])
