#!/usr/bin/env python3
"""Creates the images of docs/: a report on a desktop and on a phone, and a film.

    scripts/pictures.py STUDY/report.html STUDY/replay/1-positive.html docs
    scripts/pictures.py STUDY/report.html FILE.png    only the first screen
"""
import sys
from pathlib import Path

from browser import Browser


def first_screen(report, file):
    """Captures the first screen of a page."""
    with Browser() as browser:
        page = browser.open(report, 1280, 900)
        if page.js('document.querySelector("#film") !== null'):
            page.wait('document.querySelector("#film").dataset.state')
        page.picture(Path(file))


def main(report, film, folder):
    """Captures the report and the film for docs/."""
    folder = Path(folder)
    with Browser() as browser:
        page = browser.open(report, 1280, 900)
        page.wait('document.querySelector("#film").dataset.state')
        page.picture(folder / "report.png")
        box = page.js("""(() => { const box = document.querySelector("#explore").getBoundingClientRect();
            return [box.x, box.y + scrollY, box.width, box.height]; })()""")
        page.picture(folder / "report-designs.png", clip=box, scale=0.7)
        page = browser.open(report, 390, 844)
        page.wait('document.querySelector("#film").dataset.state')
        page.picture(folder / "report-phone.png")
        page = browser.open(film, 1280, 760)
        # The last frame, which shows both outcomes.
        page.js("""(() => { const time = document.querySelector("#time"); time.value = time.max;
            time.dispatchEvent(new Event("input")); })()""")
        page.wait_for_drawing()
        page.picture(folder / "replay.png")


if __name__ == "__main__":
    (first_screen if len(sys.argv) == 3 else main)(*sys.argv[1:])
