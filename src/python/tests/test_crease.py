"""The installed package: pip install "NAME.whl[test]"; pytest src/python/tests"""

import gzip
import json
import multiprocessing
import os
import re
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

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


# Begins a program: in the background of a shell, Ctrl-C is ignored, and a program that it starts inherits that.
CTRL_C = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler); "


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
    with pytest.raises(crease.CreaseError, match="unworn: False is for apply=True only"):
        worn.to_glb(unworn=False)


def test_a_compressed_sidecar_is_the_plain_one(worn, tmp_path):
    text = worn.sidecar.to_json()
    content = gzip.compress(text.encode())
    (tmp_path / "worn.crease.json.gz").write_bytes(content)
    for back in (crease.Sidecar.load(tmp_path / "worn.crease.json.gz"), crease.Sidecar.parse(content), crease.Sidecar.parse(text)):
        assert back.to_json() == text
    with pytest.raises(crease.CreaseError, match="sidecar: gzip: is damaged or cut off"):
        crease.Sidecar.parse(content[:-20])


def test_creases_are_curves_on_the_mesh_of_the_sidecar():
    sidecar = crease.transfer("fold-thrice", crease.sheet((0.6, 0.7), (12, 14))).sidecar
    first = sidecar.creases[0]
    count = len(first.triangles)
    assert first.weights.shape == (count, 3) and len(first.angle) == len(first.stiffness_ratio) == count - 1
    places = (first.weights[:, :, None] * sidecar.points[sidecar.triangles[first.triangles]]).sum(axis=1)
    assert np.linalg.norm(np.diff(places, axis=0), axis=1).sum() > 0.04
    assert np.abs(first.angle).max() > 0.2 and 0 < first.width < 0.02
    assert repr(first).startswith("Crease(")


def test_memories_of_the_program_are_transferred_by_name():
    assert "elbow" in crease.memories()
    carried = crease.transfer("fold-thrice", crease.sheet((0.6, 0.7), (12, 14)))
    assert carried.report["sources"][0]["file"] == "fold-thrice"
    assert np.abs(carried.sidecar.rest_angle).max() > 0.1
    with pytest.raises(crease.CreaseError, match="did you mean `elbow`"):
        crease.transfer("elbwo", crease.sheet((0.6, 0.7), (12, 14)))


def test_only_glb_files_are_written_and_none_that_was_read(worn, tmp_path):
    with pytest.raises(crease.CreaseError, match="path: .*worn.obj.*ends in .glb"):
        worn.save(tmp_path / "worn.obj")
    assert list(tmp_path.iterdir()) == []
    worn.save(tmp_path / "new" / "worn.glb")
    again = crease.bake(tmp_path / "new" / "worn.glb", SCRIPT, quality="draft")
    with pytest.raises(crease.CreaseError, match="would be overwritten"):
        again.save(tmp_path / "new" / "worn.glb")


def test_python_and_the_tool_make_the_same_bytes(tmp_path, monkeypatch):
    tool = [sys.executable, "-m", "crease"]
    run = lambda *words: subprocess.run([*tool, *words], check=True, capture_output=True, cwd=tmp_path)
    sheet = crease.bake(crease.sheet((0.3, 0.3), (16, 16)), {**SCRIPT, "actions": [{"settle": {"for": 0.1}}]}, quality="draft")
    sheet.save(tmp_path / "sheet.glb")
    (tmp_path / "sheet.crease.json").unlink()
    (tmp_path / "wear.json").write_text(json.dumps(SCRIPT))

    def same(name, worn):
        worn.save(tmp_path / "python" / name)
        for file in (name, name.replace(".glb", ".crease.json")):
            assert (tmp_path / file).read_bytes() == (tmp_path / "python" / file).read_bytes(), file
        report = json.loads((tmp_path / name.replace(".glb", ".report.json")).read_text())
        # The cure is worded for each: a call here, a command there.
        said = lambda warnings: sorted(text.split(" To have both:")[0] for text in warnings)
        assert said(worn.warnings) == said(report["warnings"])
        assert worn.report.keys() == report.keys()

    once = ["bake", "sheet.glb", "--wear", "wear.json", "--quality", "draft"]
    run(*once, "-o", "once.glb")
    monkeypatch.chdir(tmp_path)
    same("once.glb", crease.bake("sheet.glb", "wear.json", quality="draft"))
    # Worn again, a garment begins with what it remembers.
    run("bake", "once.glb", *once[2:], "-o", "twice.glb")
    twice = crease.bake("once.glb", "wear.json", quality="draft")
    same("twice.glb", twice)
    fresh = crease.bake("once.glb", "wear.json", quality="draft", forget=True)
    assert (fresh.sidecar.stiffness_ratio != twice.sidecar.stiffness_ratio).any()
    crease.bake(crease.sheet((0.3, 0.3), (12, 12)), "wear.json", quality="draft").save("other.glb")
    run("transfer", "once.glb", "--to", "other.glb", "-o", "carried.glb")
    same("carried.glb", crease.transfer("once.glb", "other.glb"))
    run(*once, "--no-grading", "--no-hems", "--no-seams", "--up", "y", "--weld", "0.5", "--strength", "0.7", "-o", "plain.glb")
    plain = crease.bake(
        "sheet.glb", "wear.json", quality="draft", grading=False, hems=False, seams=False, up="y", weld_mm=0.5, strength=0.7
    )
    same("plain.glb", plain)
    run("transfer", "once.glb", "--to", "other.glb", "--only", "creases", "--mirror", "x", "--strength", "0.5", "-o", "part.glb")
    same("part.glb", crease.transfer("once.glb", "other.glb", only="creases", mirror="x", strength=0.5))
    with pytest.raises(crease.CreaseError, match="_MASK"):
        crease.transfer("once.glb", "other.glb", mask="_MASK")
    with pytest.raises(crease.CreaseError, match="_SEWN.*sewing_mask takes one of"):
        crease.bake("sheet.glb", "wear.json", sewing_mask="_SEWN")


def test_memory_goes_to_another_mesh(worn):
    other = crease.transfer(worn.sidecar, crease.sheet((0.3, 0.3), (24, 24)), match_by="surface")
    assert np.abs(other.sidecar.rest_angle).max() > 0.1
    assert other.report["confidence"] > 0.5 and other.failure is None
    none = crease.transfer([worn.sidecar], crease.sheet((0.3, 0.3), (8, 8)), match_by="surface", strength=0.0)
    assert np.abs(none.sidecar.rest_angle).max() < 1e-6
    same = crease.transfer(worn.sidecar, crease.sheet((0.3, 0.3), (16, 16)))
    np.testing.assert_array_equal(same.displacement, worn.displacement)


def test_what_did_not_go_as_asked_is_said(worn):
    assert worn.converged and worn.failure is None
    nothing = crease.bake(crease.sheet((0.3, 0.3), (8, 8)), SCRIPT, quality="draft", memory=False)
    assert nothing.sidecar.simulated is None or not nothing.sidecar.simulated.rest_angle.any()


def test_an_action_that_does_not_take_place_is_a_failure(tmp_path):
    """A sheet as stiff as a board does not fold: the tool would end with exit code 3, so the result must not pass for a success."""
    board = {"format": "crease-fabric/1", "name": "board", "based_on": "cotton-jersey", "bend_warp_un_m": 1e6, "bend_weft_un_m": 1e6}
    (tmp_path / "board.json").write_text(json.dumps(board))
    fold = {**SCRIPT, "actions": SCRIPT["actions"][:2]}
    stiff = crease.bake(crease.sheet((0.3, 0.3), (4, 4)), fold, fabric=tmp_path / "board.json", quality="draft")
    assert "wear: actions[1] (fold): the flap did not turn over" in stiff.failure, stiff.failure
    assert any(stiff.failure in warning for warning in stiff.warnings), stiff.warnings
    assert stiff.displacement.shape == (25, 3)


def test_a_result_without_memory_is_a_failure(worn):
    lay, fold = {"lay": {"facing": "up"}}, {"fold": {"line": [[0.5, 0.0], [0.5, 1.0]], "side": "left", "over": 0.5}}
    brief = crease.bake(crease.sheet((0.3, 0.3), (4, 4)), {**SCRIPT, "actions": [lay, fold]}, quality="draft")
    assert brief.failure.startswith("nothing is remembered") and brief.failure in brief.warnings, brief.failure
    points, triangles = crease.sheet((0.3, 0.3), (8, 8))
    away = crease.transfer(worn.sidecar, (points + [5, 0, 0], triangles), align="none", match_by="surface")
    assert away.failure.startswith("nothing was transferred") and away.failure in away.warnings, away.failure


def test_torn_cloth_ends_the_bake(tmp_path):
    """There is no garment to return, as the tool writes none."""
    dough = {"format": "crease-fabric/1", "name": "dough", "based_on": "cotton-jersey", "stretch_warp_n_per_m": 0.5,
             "stretch_weft_n_per_m": 0.5, "shear_n_per_m": 0.5}
    (tmp_path / "dough.json").write_text(json.dumps(dough))
    hang = {**SCRIPT, "actions": [{"hang": {"by": "hook", "for": 3}}]}
    with pytest.raises(crease.ConvergenceError, match="hang: the cloth is torn: .* times its length"):
        crease.bake(crease.sheet((0.5, 0.5), (4, 4)), hang, fabric=tmp_path / "dough.json", quality="draft")


def test_recovery_goes_towards_the_initial_rest():
    def released(**initial):
        state = crease.MemoryState([0.0])
        crease.advance_memory(state, 2.5, 2.5, 10.0)
        held = state.rest[0]
        crease.advance_memory(state, held, held, 3600.0, **initial)
        return held, state.rest[0]

    held, to_new = released()
    assert held > 0.5 and to_new < held
    assert released(initial_rest=0.0) == (held, to_new)
    _, to_half = released(initial_rest=[0.5 * held])
    assert to_new < to_half < held
    assert released(initial_rest=held) == (held, held)


def test_the_memory_law_is_that_of_the_paper():
    state = crease.MemoryState(np.zeros(3))
    events = crease.advance_memory(state, [0, 0, 0], [0.1, 0.8, 2.5], 1.0, fabric="kow-tshirt")
    assert events == (0, 0)
    gradual, critical = crease.advance_memory(state, [0.1, 0.8, 2.5], [0.1, 0.8, 2.5], 10.0, fabric="kow-tshirt")
    assert gradual > 0 and critical > 0
    assert state.rest[0] == 0 and 0 < state.rest[1] < state.rest[2]
    assert state.stiffness_ratio[0] == 1 and len(state) == 3
    # One long step and many short ones are the same.
    short = crease.MemoryState(np.zeros(3))
    crease.advance_memory(short, [0, 0, 0], [0.1, 0.8, 2.5], 1.0, fabric="kow-tshirt")
    for _ in range(100):
        crease.advance_memory(short, [0.1, 0.8, 2.5], [0.1, 0.8, 2.5], 0.1, fabric="kow-tshirt")
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


def test_arrays_have_a_unit_and_any_size():
    points, triangles = crease.sheet((0.3, 0.3), (2, 2))
    worn = crease.bake((points * 100, triangles), SCRIPT, unit="cm", up="y", weld_mm=0.1)
    assert worn.displacement.shape == points.shape
    worn = crease.bake((points / 10, triangles), SCRIPT, force_size=True)
    assert worn.displacement.shape == points.shape


def advance(before=0.0, after=1.0, duration=1.0, **options):
    return crease.advance_memory(crease.MemoryState([0, 0]), before, after, duration, **options)


@pytest.mark.parametrize(
    "call, kind, words",
    [
        # Wrong types.
        (lambda m: crease.bake(5, SCRIPT), TypeError, "garment: needs the path of a file, or a pair .* not int"),
        (lambda m: crease.bake(m[0], SCRIPT), TypeError, "garment: needs .* not ndarray"),
        (lambda m: crease.bake(m, 5), TypeError, "wear: needs .* not int"),
        (lambda m: crease.bake(m, {"actions": {1, 2}}), TypeError, "wear: .*set"),
        (lambda m: crease.bake(m, SCRIPT, fabric=3), TypeError, "fabric: needs .* not int"),
        (lambda m: crease.bake(m, SCRIPT, memory="off"), TypeError, "memory"),
        (lambda m: crease.bake(m, SCRIPT, progress=True), TypeError, "progress: needs a function, not bool"),
        (lambda m: crease.bake(m, SCRIPT, fabrics="denim"), TypeError, "fabrics"),
        (lambda m: crease.bake("a.glb", SCRIPT, unit=[1]), TypeError, "unit: needs a number"),
        (lambda m: crease.transfer(5, m), TypeError, "sidecars: needs .* not int"),
        (lambda m: crease.transfer([None], m), TypeError, "sidecars: needs .* not NoneType"),
        (lambda m: crease.advance_memory([0.0], 0, 0, 1), TypeError, "state"),
        # Wrong values.
        (lambda m: crease.bake(("a", m[1]), SCRIPT), crease.CreaseError, "positions: is no array of numbers"),
        (lambda m: crease.bake((m[0] * np.nan, m[1]), SCRIPT), crease.CreaseError, "position 0: not finite"),
        (lambda m: crease.bake((m[0][:0], m[1][:0]), SCRIPT), crease.CreaseError, "."),
        (lambda m: crease.bake((m[0], m[1] + 0.5), SCRIPT), crease.CreaseError, "triangles: needs integers"),
        (lambda m: crease.bake((m[0], m[1].astype(int) - 1), SCRIPT), crease.CreaseError, "triangles: row 0 names the position -1"),
        (lambda m: crease.bake((m[0], m[1] + 1), SCRIPT), crease.CreaseError, "there are 9, numbered from 0"),
        (lambda m: crease.bake((m[0], m[1].ravel()), SCRIPT), crease.CreaseError, r"triangles: .*\(n, 3\), not \(24,\)"),
        (lambda m: crease.bake((m[0] * 100, m[1]), SCRIPT), crease.CreaseError, "m"),
        (lambda m: crease.bake(m, SCRIPT, unit=0.01), crease.CreaseError, "in size, which no garment is"),
        (lambda m: crease.bake(m, SCRIPT, part="sleeve"), crease.CreaseError, "part: is for files only"),
        (lambda m: crease.bake("a.glb", SCRIPT, unit="ft"), crease.CreaseError, "unit: ft: expected m, dm, cm"),
        (lambda m: crease.bake("a.glb", SCRIPT, unit=-1), crease.CreaseError, "unit: -1"),
        (lambda m: crease.bake("a.glb", SCRIPT, unit=float("nan")), crease.CreaseError, "unit: NaN"),
        (lambda m: crease.bake("a.glb", SCRIPT, up="x"), crease.CreaseError, "up: x is none of y, z"),
        (lambda m: crease.bake("a.glb", SCRIPT, weld_mm=0), crease.CreaseError, "weld_mm: 0 is no number above 0"),
        (lambda m: crease.bake("a.glb", SCRIPT, weld_mm=float("nan")), crease.CreaseError, "weld_mm: NaN"),
        (lambda m: crease.bake((m[0].astype(str), m[1]), SCRIPT), crease.CreaseError, "positions: is no array of numbers: .*<U"),
        (lambda m: crease.bake((m[0] + 1j, m[1]), SCRIPT), crease.CreaseError, "positions: .*complex128"),
        (lambda m: crease.bake((m[0], m[1][:0]), SCRIPT), crease.CreaseError, "triangle"),
        (lambda m: crease.bake(m, {**SCRIPT, "actions": [{"settle": {"for": float("nan")}}]}), crease.CreaseError, "wear: "),
        (lambda m: crease.bake(m, {**SCRIPT, "actions": [{"settle": {"for": -1}}]}), crease.CreaseError, "wear: .*for"),
        (lambda m: crease.bake(m, {"format": "crease-wear/1", "actions": [{"fold": 3}]}), crease.CreaseError, "wear: "),
        (lambda m: crease.transfer([], m), crease.CreaseError, "sidecars: there is none"),
        (lambda m: crease.transfer("none.crease.json", m), crease.CreaseError, "none.crease.json: there is no such file"),
        (lambda m: crease.transfer([], m, strength=float("nan")), crease.CreaseError, "strength: NaN is no number of at least 0"),
        (lambda m: crease.transfer([], m, strength=-1), crease.CreaseError, "strength: -1 is no number of at least 0"),
        (lambda m: crease.transfer([], m, match_by="name"), crease.CreaseError, "match_by: name is none of auto, uv, surface, same"),
        (lambda m: crease.transfer([], m, only="folds"), crease.CreaseError, "only: folds is none of creases, bagging"),
        (lambda m: crease.transfer([], m, mirror="y"), crease.CreaseError, "mirror: y is none of x"),
        (lambda m: crease.Sidecar.parse("{}"), crease.CreaseError, "format"),
        (lambda m: crease.MemoryState([0, np.inf]), crease.CreaseError, "rest: entry 1 is inf"),
        (lambda m: crease.MemoryState("x"), crease.CreaseError, "rest: is no array of numbers"),
        (lambda m: crease.MemoryState("1.5"), crease.CreaseError, "rest: is no array of numbers"),
        (lambda m: crease.MemoryState(None), crease.CreaseError, "rest: "),
        (lambda m: crease.MemoryState([[0, 1], [2]]), crease.CreaseError, "rest: is no array of numbers"),
        (lambda m: crease.MemoryState([[0, 1]]), crease.CreaseError, r"rest: needs a number or a list .* not .* \(1, 2\)"),
        (lambda m: crease.MemoryState([1j]), crease.CreaseError, "rest: .*complex"),
        (lambda m: advance(duration=-1.0), crease.CreaseError, "duration: -1 is no number of at least 0"),
        (lambda m: advance(duration=float("nan")), crease.CreaseError, "duration: NaN"),
        (lambda m: advance(duration=float("inf")), crease.CreaseError, "duration: inf"),
        (lambda m: advance(kind="angle"), crease.CreaseError, "kind: angle is none of angles, lengths"),
        (lambda m: advance(before=[0, np.nan]), crease.CreaseError, "before: entry 1 is NaN, not a finite number"),
        (lambda m: advance(after=[[0, 1]]), crease.CreaseError, r"after: needs .* \(1, 2\)"),
        (lambda m: advance(after=[0, 1, 2]), crease.CreaseError, "after: has 3 entries for the 2 elements"),
        (lambda m: advance(gain=0), crease.CreaseError, "gain: entry 0 is 0, not a number above 0"),
        (lambda m: advance(gain=[1, -2]), crease.CreaseError, "gain: entry 1 is -2, not a number above 0"),
        (lambda m: advance(gain=[1, 2, 3]), crease.CreaseError, "gain: has 3 entries"),
        (lambda m: advance(gain=float("nan")), crease.CreaseError, "gain: entry 0 is NaN"),
        (lambda m: advance(initial_rest=[0, np.inf]), crease.CreaseError, "initial_rest: entry 1 is inf"),
        (lambda m: advance(initial_rest=[0, 1, 2]), crease.CreaseError, "initial_rest: has 3 entries"),
        (lambda m: advance(kind="lengths"), crease.CreaseError, "before: entry 0 is 0, not a number above 0"),
        (lambda m: advance(1, 1, kind="lengths"), crease.CreaseError, "state.rest: entry 0 is 0, not a number above 0"),
        (lambda m: crease.sheet((0.3, 0.3), (100_000, 100_000)), crease.CreaseError, "cells: "),
        (lambda m: crease.sheet((0.3, 0.3), (0, 3)), crease.CreaseError, "cells: "),
        (lambda m: crease.sheet((0.3, 0.3), (-2, 3)), crease.CreaseError, "cells: -2 x 3"),
        (lambda m: crease.sheet((0.3, 0.3), (1.5, 3)), TypeError, "cells"),
        (lambda m: crease.sheet((float("nan"), 0.3), (2, 3)), crease.CreaseError, "size: NaN is no number above 0"),
        (lambda m: crease.sheet((0.3, -0.3), (2, 3)), crease.CreaseError, "size: -0.3 is no number above 0"),
        (lambda m: crease.run_tool("bake"), TypeError, "words"),
    ],
)
def test_wrong_arguments_are_named(call, kind, words):
    with pytest.raises(kind, match=words):
        call(crease.sheet((0.3, 0.3), (2, 2)))


def test_a_mistake_in_a_script_shows_its_line(tmp_path):
    path = tmp_path / "wear.json"
    path.write_text('{"format": "crease-wear/1", "actions": [\n  {"fold": {"lin": 3}}\n]}')
    with pytest.raises(crease.CreaseError) as caught:
        crease.bake(crease.sheet((0.3, 0.3), (2, 2)), path)
    text = str(caught.value)
    assert f"{path}: line 2" in text and '{"fold": {"lin": 3}}' in text and "^" in text, text


def test_progress_is_told_and_stops_the_bake():
    told = []
    with pytest.raises(KeyboardInterrupt):
        crease.bake(crease.sheet((0.4, 0.4), (40, 40)), "fold-thrice", progress=lambda *now: told.append(now) or len(told) < 3)
    assert len(told) == 3 and told[0][2] > 30


def test_an_exception_of_progress_ends_the_bake():
    def fails(stage, time, end):
        raise RuntimeError(stage)

    with pytest.raises(RuntimeError):
        crease.bake(crease.sheet((0.4, 0.4), (40, 40)), "fold-thrice", progress=fails)


@pytest.mark.skipif(os.name == "nt", reason="signals of Unix")
@pytest.mark.parametrize("by, ending", [("module", -signal.SIGINT), ("tool", 130)])
def test_ctrl_c_ends_a_bake(by, ending, tmp_path):
    mesh = crease.sheet((0.4, 0.4), (60, 60))
    settle = {"format": "crease-wear/1", "actions": [{"settle": {"for": 0.1}}]}
    crease.bake(mesh, settle, quality="draft").save(tmp_path / "a.glb")
    program = CTRL_C + "import crease; crease.bake('a.glb', 'fold-thrice', forget=True, progress=lambda *now: print(now[0], flush=True))"
    words = {
        "module": ["-c", program],
        "tool": ["-m", "crease", "bake", "a.glb", "--wear", "fold-thrice", "-o", "b.glb", "--forget"],
    }[by]
    run = subprocess.Popen(
        [sys.executable, *words], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, cwd=tmp_path
    )
    lines = []
    while not any(line.startswith("fold") for line in lines):
        lines.append(run.stdout.readline())
        assert lines[-1], "ended before it was stopped: " + "".join(lines)
    run.send_signal(signal.SIGINT)
    asked = time.monotonic()
    message, _ = run.communicate(timeout=60)
    assert time.monotonic() - asked < 20 and run.returncode == ending, message
    assert ("KeyboardInterrupt" in message) == (by == "module"), message


def test_other_python_threads_run_during_a_bake():
    counted = []
    done = threading.Event()

    def count():
        while not done.wait(0.01):
            counted.append(time.monotonic())

    counter = threading.Thread(target=count)
    counter.start()
    started = time.monotonic()
    crease.bake(crease.sheet((0.3, 0.3), (16, 16)), SCRIPT, quality="draft")
    ended = time.monotonic()
    done.set()
    counter.join()
    assert len(counted) > 0.1 * (ended - started) / 0.01
    assert max(b - a for a, b in zip([started, *counted], [*counted, ended])) < 0.5 * (ended - started)


def of_fork(queue, mesh, worn):
    for call in (
        lambda: crease.sheet((0.3, 0.3), (4, 4)),
        lambda: crease.bake(mesh, SCRIPT, quality="draft"),
        lambda: crease.transfer(worn.sidecar, mesh),
        lambda: worn.to_glb(),
    ):
        try:
            call()
            queue.put("nothing was raised")
        except crease.CreaseError as error:
            queue.put(str(error))


@pytest.mark.skipif("fork" not in multiprocessing.get_all_start_methods(), reason="forks of Unix")
@pytest.mark.filterwarnings("ignore:This process:DeprecationWarning")
def test_a_fork_after_a_bake_is_refused_and_does_not_hang(worn):
    context = multiprocessing.get_context("fork")
    queue = context.Queue()
    child = context.Process(target=of_fork, args=(queue, crease.sheet((0.3, 0.3), (4, 4)), worn), daemon=True)
    child.start()
    for _ in range(4):
        assert "spawn" in queue.get(timeout=30)
    child.join(timeout=30)
    assert child.exitcode == 0


def test_types_are_those_of_the_stubs():
    pytest.importorskip("mypy")
    check = lambda *words: subprocess.run([sys.executable, "-m", "mypy", "--strict", *words], capture_output=True, text=True)
    for words in (["-p", "crease"], [str(Path(__file__).with_name("typed_use.py"))]):
        checked = check(*words, "--cache-dir", os.devnull)
        assert checked.returncode == 0, checked.stdout + checked.stderr
    compared = subprocess.run([sys.executable, "-m", "mypy.stubtest", "crease"], capture_output=True, text=True)
    assert compared.returncode == 0, compared.stdout + compared.stderr


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


def test_the_tool_runs_repeatedly_in_one_process(tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    crease.bake(crease.sheet((0.3, 0.3), (16, 16)), {**SCRIPT, "actions": [{"settle": {"for": 0.1}}]}, quality="draft").save("sheet.glb")
    Path("wear.json").write_text(json.dumps(SCRIPT))
    bake = ["bake", "sheet.glb", "--wear", "wear.json", "--quality", "draft", "--forget", "--quiet", "-o"]
    codes = []
    codes.append(crease.run_tool([*bake, "first.glb", "--threads", "1"]))
    codes.append(crease.run_tool([*bake, "again.glb", "--threads", "1"]))
    # Other numbers of threads, and another thread of Python.
    other = threading.Thread(target=lambda: codes.append(crease.run_tool([*bake, "other.glb", "--threads", "3"])))
    other.start()
    other.join()
    codes.append(crease.run_tool(["transfer", "first.glb", "--to", "sheet.glb", "--quiet", "-o", "carried.glb"]))
    assert codes == [0, 0, 0, 0], capfd.readouterr().err
    for name in ("again", "other"):
        for old, new in (("first.glb", f"{name}.glb"), ("first.crease.json", f"{name}.crease.json")):
            same = Path(old).read_bytes().replace(b"first.", b"") == Path(new).read_bytes().replace(f"{name}.".encode(), b"")
            assert same, new
    crease.bake("sheet.glb", "wear.json", quality="draft", forget=True).save("module.glb")
    assert Path("module.crease.json").read_bytes() == Path("first.crease.json").read_bytes()
    assert crease.run_tool(["bake", "none.glb", "--wear", "wear.json", "-o", "none-worn.glb"]) == 1
    assert "none.glb" in capfd.readouterr().err
    assert crease.run_tool([]) == 2


@pytest.mark.skipif(os.name == "nt", reason="signals of Unix")
@pytest.mark.parametrize("name, ending", [("SIGINT", 0), ("SIGTERM", -signal.SIGTERM)])
def test_signals_are_those_of_python_after_a_run_of_the_tool(name, ending, tmp_path):
    """The tool ends the process at a signal while it has nothing to save; after the run, Ctrl-C is a KeyboardInterrupt again."""
    program = CTRL_C + f"""
import crease, os
for _ in range(2):
    assert crease.run_tool(["bake", "none.glb", "--wear", "fold-thrice", "-o", "worn.glb"]) == 1
    try:
        os.kill(os.getpid(), signal.{name})
    except KeyboardInterrupt:
        print("interrupted")
"""
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, cwd=tmp_path)
    assert run.returncode == ending, run.stderr
    assert run.stdout == ("" if ending else "interrupted\n" * 2)


def test_the_readme_has_every_option_of_the_tool():
    words = set(re.findall(r"--[a-z-]+", (Path(__file__).parents[1] / "README.md").read_text()))
    for command in ("bake", "transfer"):
        run = subprocess.run([sys.executable, "-m", "crease", command, "--help"], capture_output=True, text=True, check=True)
        options = set(re.findall(r"^ +(?:-\w, )?(--[a-z-]+)", run.stdout, re.MULTILINE)) - {"--help"}
        assert len(options) > 15 and options <= words, options - words
