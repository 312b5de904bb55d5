"""Parts of a picture on a cluster of Dask, merged to the picture of a single run."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import abbe


def command(*words: object) -> None:
    done = subprocess.run([sys.executable, "-m", "abbe", *map(str, words)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def render_part(scene: str, folder: str, part: int, parts: int, passes: int) -> str:
    """Renders a part, and returns its file. A repeated call continues from the checkpoint."""
    import subprocess
    import sys
    from pathlib import Path

    result, run = Path(folder, f"part-{part}.exr"), Path(folder, f"run-{part}.exr")
    if not result.exists():
        resume = ["--resume"] if run.with_suffix(".checkpoint.exr").exists() else []
        words = ["render", scene, "--passes", str(passes), "--part", f"{part}/{parts}", "-o", str(run)]
        options = ["--keep-checkpoint", "--quiet", "--threads", "1", *resume]
        subprocess.run([sys.executable, "-m", "abbe", *words, *options], check=True)
        run.replace(result)
    return str(result)


def test_dask_renders_the_picture_of_a_single_run(scene: dict[str, Any], tmp_path: Path) -> None:
    distributed = pytest.importorskip("distributed")
    file = tmp_path / "scene.json"
    file.write_text(json.dumps(scene))
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, dashboard_address=None, processes=True
    ) as cluster, distributed.Client(cluster) as client:
        tasks = [client.submit(render_part, str(file), str(tmp_path), part, 4, 12, pure=False) for part in range(4)]
        parts = client.gather(tasks)
    command("merge", *parts, "-o", tmp_path / "merged.exr", "--quiet")
    # Files hold single precision, so both pictures are compared as files.
    abbe.render(scene, passes=12).save(tmp_path / "single.exr")
    merged, single = abbe.read(tmp_path / "merged.exr"), abbe.read(tmp_path / "single.exr")
    for name in ("xyz", "noise", "bias"):
        assert np.array_equal(getattr(merged, name), getattr(single, name), equal_nan=True), name
