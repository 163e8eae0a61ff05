"""Tasks from one's own parts: STL and STEP."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
import step_files

import finger_opt as fo

MESHES = Path(__file__).parents[2] / "examples" / "meshes"


@pytest.fixture
def meshes():
    return [MESHES / "keyed-plug.stl", MESHES / "keyed-socket.stl"]


@pytest.fixture
def occ():
    pytest.importorskip("cascadio", reason="without the extra step")


@pytest.fixture
def parts(meshes):
    """Plug above its socket, both off the origin."""
    plug, socket = map(step_files.stl, meshes)
    return {"plug": (plug, (5, 0, 30)), "socket": (socket, (5, 0, -2))}


def imported(fake, folder, *files, **settings):
    found = fo.import_parts(*files, **{"out": folder / "mine.toml", **settings, **fake})
    return found, found.task


def shapes(task):
    return task.to_toml().split("[plug]")[1].split("[grip]")[0]


def test_meshes_are_imported_as_on_the_command_line(meshes, fake, tmp_path, command_json):
    found, task = imported(fake, tmp_path, *meshes, unit="mm")
    words = ["--plug", str(meshes[0]), "--socket", str(meshes[1]), "--unit", "mm", "--engine", "fake"]
    same = command_json("task", "import", *words, "--out", str(tmp_path / "same.toml"))
    assert {**found.to_dict(), "out": None} == {**same, "out": None}
    assert found.plug_parts > 0 and Path(found.out).exists()
    assert [pose.insert_along for pose in found.poses] == [found.insert_along]
    with pytest.raises(fo.InputError, match="pose 2: must lie between 1 and 1"):
        imported(fake, tmp_path, *meshes, unit="mm", pose=2, out=tmp_path / "second.toml")
    assert shapes(task) == shapes(fo.Task.from_toml(tmp_path / "same.toml"))


def test_values_that_meshes_do_not_need_are_checked_or_deprecated(meshes, fake, tmp_path):
    for tolerance_mm in (-5, 0, float("nan")):
        with pytest.raises(fo.InputError, match="tolerance_mm: .* within 0.0001 to 1 mm"):
            imported(fake, tmp_path, *meshes, unit="mm", tolerance_mm=tolerance_mm)
    with pytest.warns(DeprecationWarning, match="resolution has no effect"):
        imported(fake, tmp_path, *meshes, unit="mm", resolution=5)


@pytest.mark.parametrize(("unit", "schema"), [("mm", "AP214"), ("in", "AP242")])
def test_step_gives_the_task_of_the_same_meshes(occ, parts, meshes, fake, tmp_path, unit, schema):
    for folder in ("mesh", "one", "two"):
        (tmp_path / folder).mkdir()
    found, task = imported(fake, tmp_path / "mesh", *meshes, unit="mm")
    both = step_files.write(tmp_path / "both.step", parts, unit, schema)
    files = [step_files.write(tmp_path / f"{name}.stp", {name: parts[name]}, unit, schema) for name in parts]
    for same, its_task in [
        imported(fake, tmp_path / "one", both, plug_body="plug"),
        imported(fake, tmp_path / "two", *files),
    ]:
        # The parts follow the triangles, which are others; what they make up is the same.
        assert same.clearance_mm == pytest.approx(found.clearance_mm, abs=1e-3)
        assert its_task.plug.mass_g == pytest.approx(task.plug.mass_g, rel=1e-3)
    assert "both.step" in (tmp_path / "one" / "mine.toml").read_text()


def test_an_assembly_is_taken_apart(occ, parts, fake, tmp_path):
    # 8 mm below the top of the socket.
    mated = {"plug": (parts["plug"][0], (5, 0, -10)), "socket": parts["socket"]}
    file = step_files.write(tmp_path / "mated.step", mated)
    with pytest.raises(fo.InputError, match="give plug and socket, or assembly"):
        fo.import_parts(file, assembly=file)
    found, task = imported(fake, tmp_path, assembly=file)
    assert found.insert_along == "-z"
    assert any("`plug`" in why for why in found.found)
    named, _ = imported(fake, tmp_path, assembly=file, plug_body=["plug"], out=tmp_path / "named.toml")
    assert named.clearance_mm == found.clearance_mm
    with pytest.raises(fo.InputError, match="no body `pulg`"):
        imported(fake, tmp_path, assembly=file, plug_body="pulg")


def test_what_names_no_plug_is_told_the_bodies(occ, parts, fake, tmp_path):
    both = step_files.write(tmp_path / "both.step", parts)
    for name in (None, "pulg", "assembly"):
        with pytest.raises(fo.InputError, match=r"`plug` \(8.0 x 12.0 x 26.0 mm\), `socket`"):
            imported(fake, tmp_path, both, plug_body=name)
    with pytest.raises(fo.InputError, match="unknown body `pins`; available: `plug`"):
        imported(fake, tmp_path, both, plug_body="plug", leave_out="pins")
    with pytest.raises(fo.InputError, match="leaves nothing of"):
        imported(fake, tmp_path, both, plug_body="plug", leave_out="assembly")
    with pytest.raises(fo.InputError, match="contains its unit"):
        imported(fake, tmp_path, both, plug_body="plug", unit="in")
    found, _ = imported(fake, tmp_path, both, socket_body="socket")
    assert found.clearance_mm == pytest.approx(0.2, abs=0.03)


def test_bodies_can_be_left_out(occ, parts, fake, tmp_path):
    pin = (parts["plug"][0] / 2, (40, 0, 0))
    both = step_files.write(tmp_path / "both.step", {**parts, "pin": pin})
    found, _ = imported(fake, tmp_path, both, plug_body="plug", leave_out=["pin"])
    assert found.clearance_mm == pytest.approx(0.2, abs=0.03)


@pytest.mark.parametrize("wrong", ["half", "empty", "stl", "huge", "open"])
def test_wrong_files_are_refused(occ, parts, meshes, fake, tmp_path, wrong):
    file = step_files.write(tmp_path / "plug.step", {"plug": parts["plug"]})
    if wrong == "huge":
        step_files.write(file, {"plug": (parts["plug"][0] * 1000, (0, 0, 0))})
    elif wrong == "open":
        step_files.write(file, {"plug": (parts["plug"][0][:9], (0, 0, 0))})
    else:
        content = {"half": file.read_bytes()[:9000], "empty": b"", "stl": meshes[0].read_bytes()}
        file.write_bytes(content[wrong])
    with pytest.raises(fo.InputError, match="plug.step.*(whole STEP file|3 to 300 mm long|along any|walls on four sides)"):
        imported(fake, tmp_path, file, meshes[1])
    assert not (tmp_path / "mine.toml").exists()


def test_what_open_cascade_says_moves_no_cursor(occ, meshes, fake, tmp_path):
    from finger_opt._step import plain

    file = tmp_path / "bodiless.step"
    file.write_text("ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('a','2020-01-01',(''),(''),'','','');\n"
                    "FILE_SCHEMA(('AUTOMOTIVE_DESIGN'));\nENDSEC;\nDATA;\nENDSEC;\nEND-ISO-10303-21;\n")
    with pytest.raises(fo.InputError, match="Open Cascade") as raised:
        imported(fake, tmp_path, file, meshes[1])
    assert str(raised.value).isprintable()
    assert plain("\x1b[31;1mred\x1b[0m, \x9b2J, \x1b]0;title\x07 and \u202eturned") == "red,  2J,  ]0;title  and  turned"


def test_the_program_reads_step_by_the_package(occ, parts, meshes, tmp_path, command, monkeypatch):
    monkeypatch.setenv("FINGER_OPT_PYTHON", sys.executable)
    plug = step_files.write(tmp_path / "plug.step", {"plug": parts["plug"]})
    socket = step_files.write(tmp_path / "socket.stp", {"socket": parts["socket"]})
    words = ["--plug", str(plug), "--socket", str(socket), "--engine", "fake", "--out", str(tmp_path / "mine.toml")]
    code, _, errors = command("task", "import", *words)
    assert code == 0, errors
    code, _, errors = command("task", "import", *words[:-1], str(tmp_path / "in.toml"), "--unit", "in")
    assert code == 2 and "STEP files contain their unit" in errors


def test_the_program_and_a_lack_of_open_cascade_name_the_extra(parts, meshes, fake, tmp_path, command, monkeypatch):
    file = step_files.write(tmp_path / "plug.step", {"plug": parts["plug"]})
    words = ["--plug", str(file), "--socket", str(meshes[1]), "--unit", "mm", "--out", str(tmp_path / "mine.toml")]
    (tmp_path / "cascadio.py").write_text("raise ModuleNotFoundError(\"No module named 'cascadio'\")")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    code, _, errors = command("task", "import", *words)
    assert code == 2 and "pip install cascadio" in errors
    with pytest.raises(ImportError, match="pip install cascadio"):
        imported(fake, tmp_path, file, meshes[1])
