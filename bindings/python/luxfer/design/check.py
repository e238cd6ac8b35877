"""Checks requirements in a lit scene: each with its value, interval, and the confidence that it is met.

A requirement passes if that confidence reaches the wanted one, fails if the confidence that it is not met reaches it,
and is undecided otherwise. Undecided requirements are computed anew with four times the paths, with another seed, up to
a limit. Each look spends an equal share of the allowed error, so that stopping at a favourable look does not bias the
result.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from dataclasses import field as of
from typing import TYPE_CHECKING

import numpy as np

from .areas import horizontal
from .measure import Field, Rating, mean_with_bias, measure, modelling, paths_needed, rate, worst
from .standard import OF_AREAS

if TYPE_CHECKING:
    from ..scene import Scene
    from .areas import Area
    from .intervals import Estimate
    from .luminaires import Luminaire
    from .observers import Observers
    from .standard import Requirement

#: Factor of the paths from one look to the next, and seeds from one look to the next. [convention]
GROWTH, SEED_STEP = 4, 7919
#: Added to the seeds of the cylindrical illuminance, it gives the seeds of the horizontal illuminance for modelling, so
#: that the two are independent. [convention]
FLAT_SEED = 500_009
#: Share of the looked-at illuminance that light left out of a glare rating may have. [rounding]
UNRATED = 1e-3


@dataclass(frozen=True)
class Settings:
    """Settings of a check."""

    maintenance: float
    """Maintenance factor in (0, 1]: maintained over initial illuminance. There is no default, because the results
    depend on it."""
    confidence: float = 0.975
    """Confidence at which a requirement passes or fails."""
    samples: int = 256
    """Paths for each point at the first look."""
    max_samples: int = 16384
    """Paths for each point at the last look."""
    seed: int = 1
    """Seed of the paths."""

    def __post_init__(self) -> None:
        if not 0 < self.maintenance <= 1:
            raise ValueError(f"maintenance = {self.maintenance} is not in (0, 1]")
        if not 0.5 < self.confidence < 1:
            raise ValueError(f"confidence = {self.confidence} is not in (0.5, 1)")
        if not 16 <= self.samples <= self.max_samples:
            raise ValueError(f"samples = {self.samples} is not in [16, max_samples = {self.max_samples}]")

    @property
    def looks(self) -> int:
        """Number of looks from samples to max_samples."""
        return 1 + int(math.log(self.max_samples / self.samples, GROWTH) + 1e-9)

    @property
    def look_confidence(self) -> float:
        """Confidence that each look needs so that all together have the wanted one."""
        return 1 - (1 - self.confidence) / self.looks


@dataclass(frozen=True)
class Finding:
    """A requirement and its result."""

    requirement: Requirement
    value: float
    """The computed number; NaN if it is unknown."""
    low: float
    """Lower end of the two-sided interval in which the number lies with 2 * confidence - 1."""
    high: float
    """Upper end."""
    probability: float
    """Confidence that the requirement is met."""
    outcome: str
    """ "passes", "fails", "undecided", or "unknown" if the number cannot be computed."""
    samples: int = 0
    """Paths for each point of the look that decided; 0 for exact numbers."""
    note: str = ""
    """A note about the number."""

    @property
    def reserve(self) -> float:
        """Distance to the limit as a share of it, negative if it is missed."""
        gap = self.value - self.requirement.limit
        sign = 1 if self.requirement.is_minimum else -1
        return sign * gap / self.requirement.limit

    def missed_by(self, before: str) -> str:
        """The share of the limit by which it is missed, after the given words; empty if no number states this share."""
        return f"{before}{abs(self.reserve) * 100:.1f} %" if math.isfinite(self.reserve) else ""

    def __str__(self) -> str:
        r = self.requirement
        head = f"{r}: {self.value:.4g} {r.unit}".rstrip()
        if self.high > self.low:
            head += f" [{self.low:.4g}, {self.high:.4g}]"
        sure = percent(self.probability, exact=self.samples == 0)
        tail = {"passes": f"passes with {sure}", "fails": f"fails{self.missed_by(' by ')}"}
        return f"{head}, {tail.get(self.outcome, self.outcome)}" + (f" ({self.note})" if self.note else "")


@dataclass(frozen=True)
class Checked:
    """All findings of a design, with the fields behind them."""

    findings: tuple[Finding, ...]
    fields: Mapping[str, Field]
    """Maintained illuminance of each area that a requirement asks for."""
    ratings: Mapping[str, Sequence[Rating]]
    """Glare of each group of observers that a requirement asks for."""
    settings: Settings
    notes: tuple[str, ...] = of(default=())
    """Parts of these areas that were not checked, such as a wall without points."""

    @property
    def passes(self) -> bool:
        """Whether there are requirements, and all pass."""
        return bool(self.findings) and all(f.outcome == "passes" for f in self.findings)

    @property
    def binding(self) -> Finding | None:
        """The requirement that is missed most, or met with the least reserve; None without requirements."""
        known = [f for f in self.findings if not math.isnan(f.value)]
        return min(known, key=lambda f: f.reserve, default=None)

    def verdict(self) -> str:
        """One sentence for all."""
        if not self.findings:
            return "nothing was checked: the design has no requirements"
        failed = [f for f in self.findings if f.outcome == "fails"]
        open_ = [f for f in self.findings if f.outcome in ("undecided", "unknown")]
        if failed:
            worst_one = min(failed, key=lambda f: f.reserve)
            return (
                f"{len(failed)} of {len(self.findings)} requirements fail; {worst_one.requirement} is missed most"
                f"{worst_one.missed_by(', by ')}"
            )
        if open_:
            return f"{len(open_)} of {len(self.findings)} requirements are not decided: {open_[0]}"
        return f"all {len(self.findings)} requirements pass, each with at least {percent(self.settings.confidence)}"


def check(
    scene: Scene,
    luminaires: Sequence[Luminaire],
    requirements: Sequence[Requirement],
    areas: Sequence[Area],
    observers: Sequence[Observers] = (),
    *,
    floor_area: float,
    settings: Settings,
    energy: float | None = None,
) -> Checked:
    """Checks the requirements. The scene is already lit by the luminaires, at their initial flux (see lit_scene);
    `energy` is the LENI of the design, where a requirement limits it."""
    by_name = {a.name: a for a in areas}
    groups = {o.name: o for o in observers}
    wanted_areas = _known(requirements, OF_AREAS, by_name, "area")
    wanted_groups = _known(requirements, ("glare",), groups, "group of observers")
    modelled = {r.area: horizontal(by_name[r.area]) for r in requirements if r.quantity == "modelling"}
    fields: dict[str, Field] = {}
    flat: dict[str, Field] = {}
    ratings: dict[str, Sequence[Rating]] = {}
    taken: dict[str, int] = {}
    for look in range(settings.looks):
        samples, seed = settings.samples * GROWTH**look, settings.seed + look * SEED_STEP
        for name in wanted_areas:
            fields[name] = measure(scene, by_name[name], samples, seed).scaled(settings.maintenance)
            taken[name] = samples
            if name in modelled:
                flat[name] = measure(scene, modelled[name], samples, seed + FLAT_SEED).scaled(settings.maintenance)
        for name in wanted_groups:
            ratings[name] = rate(scene, groups[name], samples, seed)
            taken[name] = samples
        found = _Found(fields, flat, ratings, taken)
        findings = [_find(r, luminaires, found, floor_area, settings, energy) for r in requirements]
        open_names = {f.requirement.area for f in findings if f.outcome == "undecided"}
        wanted_areas = [n for n in wanted_areas if n in open_names]
        wanted_groups = [n for n in wanted_groups if n in open_names]
        if not open_names:
            break
    notes = tuple(note for name in fields for note in by_name[name].notes)
    return Checked(tuple(findings), fields, ratings, settings, notes)


def _known(requirements: Sequence[Requirement], quantities: Sequence[str], names: Mapping, what: str) -> list[str]:
    """The areas or observers that requirements of these quantities name."""
    wanted = list(dict.fromkeys(r.area for r in requirements if r.quantity in quantities))
    for name in wanted:
        if name not in names:
            raise ValueError(f"a requirement names the {what} {name!r}: there are {', '.join(names) or 'none'}")
    return wanted


@dataclass(frozen=True)
class _Found:
    """The measured fields, and the number of paths for each point."""

    fields: Mapping[str, Field]
    flat: Mapping[str, Field]
    ratings: Mapping[str, Sequence[Rating]]
    taken: Mapping[str, int]


def _find(
    r: Requirement,
    luminaires: Sequence[Luminaire],
    found: _Found,
    floor_area: float,
    settings: Settings,
    energy: float | None,
) -> Finding:
    """The finding of one requirement."""
    if r.quantity == "energy":
        return _energy(r, energy)
    if r.quantity in ("rendering", "density", "flux"):
        return _exact(r, luminaires, floor_area)
    samples, level = found.taken[r.area], settings.look_confidence
    if r.quantity == "glare":
        return _glare(r, found.ratings[r.area], level, samples)
    field = found.fields[r.area]
    if r.quantity == "mean":
        finding = _estimated(r, *mean_with_bias(field), level, samples)
        need = paths_needed(field, r.limit, level, samples) if finding.outcome == "undecided" else 0
        note = f"{need:.2g} paths per point would decide" if 0 < need < math.inf else ""
        return replace(finding, note=note)
    if r.quantity == "modelling":
        flat = found.flat[r.area]
        lit = flat.values > 0
        ratios = field.values[lit] / flat.values[lit]
        note = f"single points {ratios.min():.2f} to {ratios.max():.2f}" if lit.any() else ""
        return replace(_estimated(r, *modelling(field, flat), level, samples), note=note)
    if r.quantity in ("minimum", "diversity"):
        return _extreme(r, field, level, samples)
    return _uniform(r, field, level, samples)


def _estimated(r: Requirement, estimate: Estimate, bias: float, level: float, samples: int) -> Finding:
    """The finding of a number with a standard error, and an absolute error that this leaves out."""
    low, high = estimate.interval(2 * level - 1)
    if r.is_minimum:
        met = estimate.probability_at_least(r.limit + bias)
        missed = 1 - estimate.probability_at_least(r.limit - bias)
    else:
        met = 1 - estimate.probability_at_least(r.limit - bias)
        missed = estimate.probability_at_least(r.limit + bias)
    return Finding(r, estimate.value, low - bias, high + bias, met, _outcome(met, missed, level), samples)


def _extreme(r: Requirement, field: Field, level: float, samples: int) -> Finding:
    """The finding of the smallest illuminance, or of the largest over the smallest."""
    extremes, wide = field.extremes, 2 * level - 1
    if r.quantity == "minimum":
        # The planes of cylindrical illuminance have an error of their own.
        met, missed = (
            extremes.smallest_at_least(r.limit * f)[i] for i, f in ((0, 1 + field.bias), (1, 1 - field.bias))
        )
        value, (low, high) = extremes.smallest, extremes.interval_of_smallest(wide)
        low, high = low * (1 - field.bias), high * (1 + field.bias)
    else:
        met, missed = (
            extremes.diversity_at_most(r.limit * f)[i] for i, f in ((0, 1 - 2 * field.bias), (1, 1 + 2 * field.bias))
        )
        value, (low, high) = extremes.diversity, extremes.interval_of_diversity(wide)
        low, high = low * (1 - 2 * field.bias), high * (1 + 2 * field.bias)
    return Finding(r, value, low, high, met, _outcome(met, missed, level), samples)


def _energy(r: Requirement, energy: float | None) -> Finding:
    """The finding of LENI."""
    if energy is None or math.isnan(energy):
        note = "luminaires have no stated power" if energy is not None else "no light scene has hours of use"
        return Finding(r, math.nan, math.nan, math.nan, 0, "unknown", 0, note)
    return _decided(r, energy)


def with_energy(checked: Checked, energy: float | None) -> Checked:
    """The findings with another LENI."""
    findings = (_energy(f.requirement, energy) if f.requirement.quantity == "energy" else f for f in checked.findings)
    return replace(checked, findings=tuple(findings))


def _decided(r: Requirement, value: float) -> Finding:
    """The finding of an exact number."""
    met = value >= r.limit * (1 - 1e-9) if r.is_minimum else value <= r.limit * (1 + 1e-9)  # [rounding]
    return Finding(r, value, value, value, float(met), "passes" if met else "fails")


def _uniform(r: Requirement, field: Field, level: float, samples: int) -> Finding:
    """The finding of a uniformity."""
    uniformity = field.uniformity
    low, high = uniformity.interval(2 * level - 1)
    low, high = low * (1 - 2 * field.bias), high * (1 + 2 * field.bias)
    met = uniformity.probability_at_least(r.limit * (1 + 2 * field.bias))
    missed = uniformity.probability_below(r.limit * (1 - 2 * field.bias))
    if not r.is_minimum:
        met, missed = missed, met
    return Finding(r, uniformity.value, low, high, met, _outcome(met, missed, level), samples)


def _glare(r: Requirement, found: Sequence[Rating], level: float, samples: int) -> Finding:
    """The finding of the worst observer. All observers must pass, and the probability that one of them fails by chance
    grows with their number: so the error of the worst observer counts once for each of them."""
    rating = worst(found)
    # Each end of the interval is the largest among the observers.
    low = max(x.interval(1 - 2 * (1 - level) / len(found))[0] for x in found)
    high = max(x.interval(2 * level - 1)[1] for x in found)
    met = float(np.min([x.probability_at_most(r.limit) for x in found]))  # unlike min, NaN if any is
    missed = math.nan if math.isnan(met) else max(0.0, 1 - len(found) * met)
    seen = max(x.background.value for x in found) * math.pi
    if any(x.unrated > UNRATED * max(seen, x.unrated) for x in found):
        note = "light that the rating leaves out reaches an eye: of the environment, lights without opening, or glow"
        outcome = "fails" if missed >= level else "unknown"
        return Finding(r, rating.ugr, low, math.inf, 0, outcome, samples, note)
    count = sum(x.outside_range for x in found)
    note = f"{count} views of sources outside the range of solid angles of CIE 117" if count else ""
    return Finding(r, rating.ugr, low, high, met, _outcome(met, missed, level), samples, note)


def _exact(r: Requirement, luminaires: Sequence[Luminaire], floor_area: float) -> Finding:
    """The finding of a number that follows from the luminaires alone."""
    lit = [lamp for lamp in luminaires if lamp.flux > 0]
    note = ""
    if r.quantity == "rendering":
        values = [lamp.product.rendering for lamp in lit]
        value = min(values, default=math.nan)
        unknown = sum(v == 0 for v in values)
        note = f"{unknown} luminaires have no stated Ra" if unknown else ""
    elif r.quantity == "density":
        unknown = sum(lamp.product.watts == 0 for lamp in lit)
        value = sum(lamp.watts for lamp in lit) / floor_area
        note = f"{unknown} luminaires have no stated power" if unknown else ""
    else:
        values = [lamp.flux for lamp in lit]
        value = (min if r.is_minimum else max)(values, default=math.nan)
    if note or math.isnan(value):
        return Finding(r, math.nan, math.nan, math.nan, 0, "unknown", 0, note or "there is no luminaire")
    return _decided(r, value)


def _outcome(met: float, missed: float, level: float) -> str:
    if math.isnan(met) or math.isnan(missed):
        return "unknown"
    return "passes" if met >= level else "fails" if missed >= level else "undecided"


def percent(probability: float, exact: bool = False) -> str:
    """A confidence as a report prints it: 100 % only for numbers that are exact.

    >>> percent(0.975), percent(0.99999), percent(1.0, exact=True)
    ('97.5 %', '> 99.9 %', '100 %')
    """
    if probability > 0.999 and not exact:
        return "> 99.9 %"
    return f"{100 * probability:.4g} %"
