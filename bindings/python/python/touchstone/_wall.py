"""The class of virtual walls, with settings from a dict."""

from __future__ import annotations

from typing import Any, Mapping

from . import _native
from ._text import text


class Wall(_native.Wall):
    """A whole virtual wall: velocity estimator, control law and energy guard, in the firmware's fixed-point arithmetic, with equal results to the last bit.

    ``settings`` maps paths of scenes to values: ``{"wall.k_desired_n_m_per_rad": 5, "law.kind": "tdpa"}``; ``touchstone config schema``
    lists them. Settings that are left out are those of the shipped simulated knob: give your own rate, inertia, damping, delay and encoder.
    ``preset="thesis"`` starts from the settings in the DLR thesis on displaying high stiffness. Raises ``ValueError`` that names the setting and its range.
    """

    def __new__(
        cls,
        settings: Mapping[str, Any] | None = None,
        *,
        counts_per_rev: int = 40_000,
        surface_rad: float = 0.0,
        preset: str = "shipped",
    ) -> Wall:
        rows = [(path, text(value)) for path, value in (settings or {}).items()]
        return super().__new__(cls, rows, counts_per_rev=counts_per_rev, surface_rad=surface_rad, preset=preset)
