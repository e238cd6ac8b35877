"""Plans: chooses settings for a given error or time before the work starts, and predicts the time and the error of
relighting and rendering, or of a stylisation."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

from . import _abi, _params
from .job import Job, Progress, StageBase
from .types import PlanReport

if TYPE_CHECKING:
    from .render import Render
    from .stylize import Stylize
    from .transfer import Transfer
    from .types import RelightParams, RenderParams, StylizeParams, TransferParams


class Plan(StageBase):
    """Chooses settings for one goal: either target_error (the noise of the picture relative to its mean) or
    time_budget_ms.

    >>> render = Render(context, lit_room)
    >>> plan = Plan(context).run_render(render, target_error=0.5, settings={"width": 32, "height": 24})
    >>> render.run(**plan.render_params).report.error < 1
    True
    """

    kind = "plan"

    def start_render(
        self, render: Render, *, target_error: float = 0.0, time_budget_ms: int = 0, settings: RenderParams | None = None
    ) -> Job[Plan]:
        """Starts to plan a rendering with the scene and the camera of render."""
        goal = {"target_error": target_error, "time_budget_ms": time_budget_ms}
        params = _params.fill(_abi.luxfer_render_params, settings or {}, [])
        return self._job("start_render", render, params, _params.fill(_abi.luxfer_plan_params, goal, []))

    def run_render(self, render: Render, progress: Progress | None = None, **goal: Any) -> Plan:
        """Plans a rendering and waits for the plan."""
        return self.start_render(render, **goal).wait(progress)

    def start_transfer(
        self,
        transfer: Transfer,
        *,
        target_error: float = 0.0,
        time_budget_ms: int = 0,
        settings: TransferParams | None = None,
    ) -> Job[Plan]:
        """Starts to plan the stages RELIGHT and RENDER of a transfer whose stage EMISSION has run."""
        keep: list[Any] = []
        goal = {"target_error": target_error, "time_budget_ms": time_budget_ms}
        params = _params.fill(_abi.luxfer_transfer_params, settings or {}, keep)
        return self._job("start_transfer", transfer, params, _params.fill(_abi.luxfer_plan_params, goal, []))

    def run_transfer(self, transfer: Transfer, progress: Progress | None = None, **goal: Any) -> Plan:
        """Plans the stages RELIGHT and RENDER of a transfer and waits for the plan."""
        return self.start_transfer(transfer, **goal).wait(progress)

    def start_stylize(
        self, stylize: Stylize, *, target_error: float = 0.0, time_budget_ms: int = 0, settings: StylizeParams | None = None
    ) -> Job[Plan]:
        """Starts to plan a stylisation; target_error bounds the square root of the energy in the report of stylize."""
        goal = {"target_error": target_error, "time_budget_ms": time_budget_ms}
        params = _params.fill(_abi.luxfer_stylize_params, settings or {}, [])
        return self._job("start_stylize", stylize, params, _params.fill(_abi.luxfer_plan_params, goal, []))

    def run_stylize(self, stylize: Stylize, progress: Progress | None = None, **goal: Any) -> Plan:
        """Plans a stylisation and waits for the plan."""
        return self.start_stylize(stylize, **goal).wait(progress)

    @property
    def report(self) -> PlanReport:
        """The predictions of the plan."""
        return cast(PlanReport, self._read("get_report", _abi.luxfer_plan_report))

    @property
    def render_params(self) -> RenderParams:
        """The chosen settings of the rendering."""
        params = self._fill("get_render_params", _abi.luxfer_render_params)
        return cast("RenderParams", _params.settings(params))

    @property
    def relight_params(self) -> RelightParams:
        """The chosen settings of the relighting."""
        params = self._fill("get_relight_params", _abi.luxfer_relight_params)
        return cast("RelightParams", _params.settings(params))

    @property
    def stylize_params(self) -> StylizeParams:
        """The chosen settings of the stylisation."""
        params = self._fill("get_stylize_params", _abi.luxfer_stylize_params)
        return cast("StylizeParams", _params.settings(params))
