"""luxfer studio: a photo and a room side by side in the browser, on this machine alone.

    python -m luxfer.studio [photo] [scene] [--project FILE]

It needs `pip install luxfer[studio]`. The page is TypeScript in bindings/studio; `make studio` builds it into static/.

| file | job |
|---|---|
| command | the options of the command line |
| app | the web application: its routes, its start |
| security | which requests are accepted (token, Host, Origin), and which files may be read |
| opening | opens the page in the browser without its address on a command line |
| outbox | messages that wait to be sent to a page |
| files | photos, scenes and project files, by the hash of their content |
| session | one user: the current project, and the connections to the page |
| jobs | threads that do the newest work and cancel outdated work |
| live | masks while strokes are painted, at a small size |
| light | the steps from the photo to the lit room; a step runs only if its input has changed |
| grid | the camera of the photo by the grid that the user has dragged |
| mix | the factor of each kind of lamp |
| measure | the plane on which the page shows the illuminance, and its numbers |
| room | its corners, its work plane, the brightness of its pictures |
| rooms | rooms in USD, as GLB |
| painting | the stylisation: the artwork on the ball, the painted picture, the sheet |
| pictures | images as bytes for the page |
| project | the entries of a project and their checks |
| results | writes the files of results |
| program | converts a project to a Python program |
| program_c | converts a project to a C program, by program.c |
| program_cpp | converts a project to a C++ program, by program.cpp |
"""

from __future__ import annotations

import sys


def main(argv: list[str] | None = None) -> int:
    """Starts the studio and serves it until it is interrupted; returns the exit code."""
    from ..cli.exits import Exit
    from .command import parser

    asked = parser().parse_args(argv)
    try:
        from .app import serve
    except ImportError as missing:
        if missing.name not in ("starlette", "uvicorn", "websockets", "anyio"):
            raise
        print(f"the studio needs the package {missing.name}: pip install 'luxfer[studio]'", file=sys.stderr)
        return Exit.FAILED
    return serve(asked)
