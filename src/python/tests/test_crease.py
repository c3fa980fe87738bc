"""The installed package: pip install dist/crease_bake-*.whl pytest; pytest src/python/tests"""

import json
import subprocess
import sys

import numpy as np
import pytest

import crease

SCRIPT = {
    "format": "crease-wear/1",
    "actions": [
        {"lay": {"facing": "up"}},
        {"fold": {"line": [[0.5, 0.0], [0.5, 1.0]], "side": "left", "hold": 2.0}},
        {"press": {"pressure": 2000, "for": 5}},
        {"unfold": {"all": True}},
        {"settle": {"for": 1}},
    ],
}


@pytest.fixture(scope="module")
def worn():
    return crease.bake(crease.sheet((0.3, 0.3), (16, 16)), SCRIPT, quality="draft")


def test_a_sheet_remembers_its_fold(worn):
    points, triangles = crease.sheet((0.3, 0.3), (16, 16))
    assert points.shape == (17 * 17, 3) and triangles.shape == (512, 3)
    assert worn.displacement.shape == points.shape
    assert 1e-3 < np.linalg.norm(worn.displacement, axis=1).max() < 0.2
    sidecar = worn.sidecar
    change = np.abs(sidecar.rest_angle - sidecar.source_angle)
    middle = sidecar.points[sidecar.hinge_points[change.argmax(), :2]].mean(axis=0)
    assert abs(middle[0] - 0.15) < 0.02, "the strongest hinge is on the fold line"
    assert worn.report["steps"] > 0 and worn.report["points"] > 0


def test_files_are_written_and_read(worn, tmp_path):
    path = tmp_path / "worn.glb"
    worn.save(path)
    back = crease.Sidecar.load(tmp_path / "worn.crease.json")
    np.testing.assert_array_equal(back.rest_angle, worn.sidecar.rest_angle)
    assert path.read_bytes()[:4] == b"glTF"
    names = lambda glb: json.loads(glb[20:20 + int.from_bytes(glb[12:16], "little")])["meshes"][0]["extras"].get("targetNames")
    assert names(worn.to_glb()) == ["worn"]
    assert names(worn.to_glb(apply=True)) == ["unworn"]
    assert names(worn.to_glb(apply=True, unworn=False)) is None


def test_memory_goes_to_another_mesh(worn):
    other = crease.transfer(worn.sidecar, crease.sheet((0.3, 0.3), (24, 24)), match_by="surface")
    assert np.abs(other.sidecar.rest_angle).max() > 0.1
    none = crease.transfer([worn.sidecar], crease.sheet((0.3, 0.3), (8, 8)), match_by="surface", strength=0.0)
    assert np.abs(none.sidecar.rest_angle).max() < 1e-6


def test_the_memory_law_is_that_of_the_paper():
    state = crease.MemoryState(np.zeros(3))
    events = crease.advance_memory(state, [0, 0, 0], [0.1, 0.8, 2.5], 1.0)
    assert events == (0, 0)
    gradual, critical = crease.advance_memory(state, [0.1, 0.8, 2.5], [0.1, 0.8, 2.5], 10.0)
    assert gradual > 0 and critical > 0
    assert state.rest[0] == 0 and 0 < state.rest[1] < state.rest[2]
    assert state.stiffness_ratio[0] == 1 and len(state) == 3
    # One long step and many short ones are the same.
    short = crease.MemoryState(np.zeros(3))
    crease.advance_memory(short, [0, 0, 0], [0.1, 0.8, 2.5], 1.0)
    for _ in range(100):
        crease.advance_memory(short, [0.1, 0.8, 2.5], [0.1, 0.8, 2.5], 0.1)
    np.testing.assert_allclose(short.rest, state.rest, atol=1e-9)


def test_mistakes_are_exceptions_with_a_cure(tmp_path):
    mesh = crease.sheet((0.3, 0.3), (2, 2))
    for call, words in (
        (lambda: crease.bake(mesh, "fold-trice"), "fold-thrice"),
        (lambda: crease.bake(mesh, SCRIPT, fabric="demin"), "denim"),
        (lambda: crease.bake(mesh, SCRIPT, quality="best"), "draft"),
        (lambda: crease.bake((mesh[0][:, :2], mesh[1]), SCRIPT), "positions"),
        (lambda: crease.bake(mesh, {"format": "crease-wear/1", "actions": [{"bend": {"joint": "a", "axis": "x", "angle": 9}}]}), "body"),
        (lambda: crease.transfer([], mesh, align="up"), "joints"),
        (lambda: crease.advance_memory(crease.MemoryState([0, 0]), [0, 0, 0], [0, 0], 1.0), "before"),
    ):
        with pytest.raises(crease.CreaseError, match=words):
            call()
    with pytest.raises(crease.CreaseError, match="no such file"):
        crease.bake(tmp_path / "none.glb", "fold-thrice")


def test_progress_is_told_and_stops_the_bake():
    told = []
    with pytest.raises(KeyboardInterrupt):
        crease.bake(crease.sheet((0.4, 0.4), (40, 40)), "fold-thrice", progress=lambda *now: told.append(now) or len(told) < 3)
    assert len(told) == 3 and told[0][2] > 30


def test_the_tool_is_in_the_package(tmp_path):
    tool = [sys.executable, "-m", "crease"]
    run = lambda *words: subprocess.run([*tool, *words], capture_output=True, text=True, cwd=tmp_path)
    assert run("--version").stdout.strip() == f"crease {crease.__version__}"
    assert run("example", "handkerchief", "-o", ".").returncode == 0
    assert "points" in run("inspect", "handkerchief.glb").stdout
    assert run("inspect", "none.glb").returncode == 1
    assert run("no-such-command").returncode == 2
    jobs = {"format": "crease-batch/1", "garments": ["handkerchief.glb"], "wear": ["press.json"], "fabrics": ["denim"],
            "output": "out", "bake": ["--quality", "draft"]}
    (tmp_path / "press.json").write_text(json.dumps(SCRIPT))
    (tmp_path / "jobs.json").write_text(json.dumps(jobs))
    batch = run("batch", "jobs.json")
    assert batch.returncode == 0, batch.stderr
    assert list(tmp_path.glob("out/*.glb"))
