"""What is drawn, and what a notebook shows."""

from __future__ import annotations

import json

import pytest

import finger_opt as fo

pyplot = pytest.importorskip("matplotlib.pyplot", reason="without the extra plot")


@pytest.fixture
def axes():
    pyplot.switch_backend("agg")
    figure, axes = pyplot.subplots()
    yield axes
    figure.canvas.draw()
    pyplot.close("all")


FOUND = {
    "window": lambda fake: fo.evaluate("usb", 20, 10, **fake),
    "force": lambda fake: fo.trial("usb", 20, 10),
    "map": lambda fake: fo.capture_map("usb", 20, 10, **fake),
    "levers": lambda fake: fo.levers("usb", 20, 10, **fake),
    "importances": lambda fake: fo.sensitivity("usb", samples=8, **fake),
    "stiffness": lambda fake: fo.stiffness(),
}


@pytest.mark.parametrize("what", FOUND)
def test_it_draws_into_the_axes_given_or_new_ones(what, fake, axes):
    found = FOUND[what](fake)
    assert found.plot(axes) is axes and axes.has_data()
    assert axes.get_xlabel() and (axes.get_ylabel() or axes.get_yticklabels())
    assert found.plot() is not axes
    assert found._repr_html_()


def test_a_map_names_the_classes_with_their_numbers(fake, axes):
    fo.capture_map("usb", 20, 10, **fake).plot(axes)
    words = [text.get_text() for text in axes.get_legend().get_texts()]
    assert "inserted" in words
    assert all("(class " in text for text in words if text not in ("inserted", "diverged"))


def test_a_study_draws_its_course_and_its_designs(fake, tmp_path, axes):
    study = fo.Study.create("usb", budget=8, out=tmp_path / "study", no_cache=True, no_levers=True, **fake)
    study.run(progress=False)
    with pytest.raises(fo.InputError, match="study has no levers of its recommended finger; call run()"):
        study.plot_importances()
    study = fo.load_study(study.path).run(progress=False)
    names = [label.get_text() for label in study.plot_importances().get_yticklabels()]
    stored = json.loads((tmp_path / "study" / "levers.json").read_text())["found"]["levers"]
    assert len(names) == len(stored) > 1 and "tilt, °" in names and names[-1].startswith(stored[0]["name"])
    assert study.plot(axes) is axes and axes.has_data()
    assert study.plot_surface().get_xlabel() == "infill density, percent"
    assert study.answer._repr_html_() == study._repr_html_()


@pytest.mark.parametrize("settings", [{"objective": "slip"}, {"objective": ["range", "peak-force"]}, {"task": ["usb", "rj45"]}])
def test_studies_of_other_goals_draw_them(settings, fake, tmp_path):
    settings = {"task": "usb", "budget": 6, "no_cache": True, "out": tmp_path / "cost$^$2", **settings}
    study = fo.Study.create(**settings, **fake).run(progress=False)
    for axes in (study.plot(), study.plot_surface()):
        axes.figure.canvas.draw()
    assert ("slip, mm" in study.plot().get_ylabel()) == (settings["objective"] == "slip" if "objective" in settings else False)


def test_tuning_draws_what_was_tried(fake, tmp_path, axes):
    found = fo.tune_task("ket8", out=tmp_path / "mine.toml", **fake)
    assert found.plot(axes) is axes and found.by.what in axes.get_title()


def test_a_film_plays_by_itself(tmp_path):
    trial = fo.trial("usb", 20, 10, film=True)
    page = trial.replay()
    assert "<script" in page.html and "://" not in page.html.replace("http://www.w3.org", "")
    assert "sandbox" in page._repr_html_() and "<script" not in page._repr_html_()
    page.save(tmp_path / "film.html")
    with pytest.raises(fo.InputError, match="film=True"):
        fo.trial("usb", 20, 10).replay()


@pytest.mark.parametrize("what", ["finger", "check", "compare"])
def test_what_else_has_a_drawing(what, fake, tmp_path):
    if what == "compare":
        folders = [fo.Study.create("usb", budget=4, seed=seed, out=tmp_path / str(seed), no_cache=True, **fake)
                   .run(progress=False) for seed in (1, 2)]
    shown = {"finger": lambda: fo.finger(20, 20), "check": lambda: fo.check_task("usb"),
             "compare": lambda: fo.compare(folders)}[what]()
    assert "<svg" in shown._repr_html_()
