"""Executes the notebooks with small budgets."""

from __future__ import annotations

import base64
import os
from pathlib import Path

import pytest

NOTEBOOKS = sorted((Path(__file__).parents[1] / "notebooks").glob("*.ipynb"))


@pytest.mark.notebooks
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebooks_run_and_draw_figures(path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    nbformat = pytest.importorskip("nbformat")
    nbclient = pytest.importorskip("nbclient")
    pytest.importorskip("matplotlib")
    if "ABBE_NOTEBOOKS_IN_FULL" not in os.environ:
        monkeypatch.setenv("ABBE_QUICK", "1")
    notebook = nbformat.read(path, as_version=4)
    nbclient.NotebookClient(notebook, timeout=600, resources={"metadata": {"path": path.parent}}).execute()
    figures = [
        output["data"]["image/png"]
        for cell in notebook.cells
        for output in cell.get("outputs", [])
        if "image/png" in output.get("data", {})
    ]
    assert len(figures) >= 3
    # With this variable, the figures are kept for a look at them.
    folder = Path(os.environ.get("ABBE_NOTEBOOK_FIGURES", tmp_path))
    for i, figure in enumerate(figures):
        (folder / f"{path.stem}-{i}.png").write_bytes(base64.b64decode(figure))


def test_there_are_three_notebooks() -> None:
    assert len(NOTEBOOKS) == 3
