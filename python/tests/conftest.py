"""Fixtures and paths of the tests."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[2]
SCENES = ROOT / "scenes"


@pytest.fixture
def scene() -> dict[str, Any]:
    """A grey floor under a point light."""
    return {
        "camera": {"from": [0, 1, 5], "at": [0, 1, 0], "lens": {"pinhole": {"fov": 40}}},
        "film": {"width": 16, "height": 9},
        "materials": {"grey": {"diffuse": {"reflectance": 0.5}}},
        "objects": [{"shape": {"rectangle": {"width": 10, "height": 10}}, "material": "grey"}],
        "lights": [{"point": {"at": [0, 3, 0], "spectrum": "D65", "power": 10}}],
    }
