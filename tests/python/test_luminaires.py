"""Compares IES and EULUMDAT files of public collections with independent readers.

`LUXFER_TEST_CORPORA` names a folder that has a subfolder `luminaires` (docs/notes/corpora.md lists the origins of its
files). Without it the tests are skipped. Each test prints a line of counts for the table in the guide.

The independent readers are the packages `eulumdat` for IES files, `photompy` for their absolute intensities, and
`eulumdat-py` for EULUMDAT files.
"""

from __future__ import annotations

import unittest
from collections import Counter
from pathlib import Path

from support import Case, context, luxfer, np
from test_corpora import CORPORA, files, report

#: Steps of the integral of an intensity over gamma, in each interval of a file.
STEPS = 16


def read_ldt(path: Path) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
    """Reads an EULUMDAT file: angles C and gamma, and intensities in candela per 1000 lm of the lamps; None if
    refused."""
    import pyldt

    try:
        file = pyldt.LdtReader.read(str(path))
    except Exception:  # of any type: the reader refuses even some ordinary files
        return None
    # Take the angles that the file lists, because a step of 0 in its header means unequal steps.
    return np.array(file.header.c_angles), np.array(file.header.g_angles), np.array(file.intensities)


def read_ies(path: Path) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
    import eulumdat

    try:
        file = eulumdat.Eulumdat.from_ies_file(str(path))
    except Exception:
        return None
    c, gamma = np.array(file.c_angles), np.array(file.g_angles)
    return c, gamma, np.array([[file.sample(a, b) for b in gamma] for a in c])


def peak_of_ies(path: Path) -> float | None:
    """The highest intensity in candela, by a reader that does not scale intensities."""
    import photompy

    try:
        return float(np.max(photompy.IESFile.read(str(path)).photometry.values))
    except Exception:
        return None


def flux(c: np.ndarray, gamma: np.ndarray, candela: np.ndarray) -> float:
    """Luminous flux in lumens: integrates an intensity that is linear between the angles, over the full circle of
    C."""
    edges = np.append(c, c[0] + 360)
    widths = np.radians(np.diff(edges)) if len(c) > 1 else np.array([2 * np.pi])
    weights = (widths + np.roll(widths, 1)) / 2
    by_gamma = (weights[:, None] * candela).sum(axis=0)
    fine = np.concatenate([np.linspace(a, b, STEPS, endpoint=False) for a, b in zip(gamma, gamma[1:])] + [gamma[-1:]])
    return float(np.trapezoid(np.interp(fine, gamma, by_gamma) * np.sin(np.radians(fine)), np.radians(fine)))


@unittest.skipUnless(CORPORA, "LUXFER_TEST_CORPORA names no folder")
class Luminaires(Case):
    def compare(self, path: Path, lamp: luxfer.Distribution, theirs: tuple[np.ndarray, np.ndarray, np.ndarray]) -> None:
        c, gamma, intensities = theirs
        ours = np.array([[lamp.intensity(a, b) for b in gamma] for a in c])
        peak = ours.max(initial=0)
        # Both readers give intensities per 1000 lm of the lamps, or of the luminaire in absolute files, so scale them.
        scale = peak / max(intensities.max(), 1e-30)
        np.testing.assert_allclose(ours, intensities * scale, atol=1e-5 * peak, err_msg=str(path))
        if lamp.report.lamp_flux > 0:
            np.testing.assert_allclose(scale, lamp.report.lamp_flux / 1000, rtol=1e-5, err_msg=str(path))
        # Compare the flux if the file has planes for the full circle, or is symmetric about the axis.
        if len(c) == 1 or c[-1] > 180:
            np.testing.assert_allclose(lamp.report.flux, flux(c, gamma, ours), rtol=2e-3, err_msg=str(path))

    def collection(self, ending: str, read) -> None:
        counts: Counter[str] = Counter()
        for path in files("luminaires", ending):
            with self.subTest(str(path.relative_to(CORPORA))):
                theirs = read(path)
                try:
                    lamp = luxfer.Distribution.load_memory(context(), path.read_bytes(), ending[1:])
                except (luxfer.errors.FormatError, luxfer.errors.Unsupported) as error:
                    counts[f"refused ({type(error).__name__})"] += 1
                    if theirs is not None:
                        counts["of these read by the other reader"] += 1
                        self.assertIsInstance(error, luxfer.errors.Unsupported, f"{path}: {error}")
                    continue
                with lamp:
                    if theirs is None:
                        counts["read, but not by the other reader"] += 1
                        continue
                    self.compare(path, lamp, theirs)
                    counts["equal"] += 1
                    peak = peak_of_ies(path) if ending == ".ies" else None
                    if peak is not None:
                        ours = max(lamp.intensity(c, gamma) for c in theirs[0] for gamma in theirs[1])
                        np.testing.assert_allclose(ours, peak, rtol=1e-5, err_msg=str(path))
                        counts["of these of equal candela by a third reader"] += 1
        report(f"luminaires, {ending}", counts)
        self.assertGreater(counts["equal"], 0, "the collection is not there")

    def test_ies(self) -> None:
        self.collection(".ies", read_ies)

    def test_eulumdat(self) -> None:
        self.collection(".ldt", read_ldt)


if __name__ == "__main__":
    unittest.main()
