#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Saves a picture of the dashboard's page of a recording, at one instant: photograph.py ADDRESS SECONDS FILE"""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tests" / "integration"))
from browser import Browser  # noqa: E402  (the browser that the tests use)
from selenium.webdriver.support.wait import WebDriverWait  # noqa: E402

LIMIT_S = 20
CHOOSE = """
const slider = document.getElementById("instant");
slider.value = arguments[0];
slider.dispatchEvent(new Event("input"));
"""


def main():
    address, seconds, file = sys.argv[1:]
    page = Browser(address)
    wait = WebDriverWait(page.driver, LIMIT_S)
    try:
        page.resize("laptop")
        wait.until(lambda _: " s of " in page.text("when"))  # the page has its first snapshot
        page.run(CHOOSE, seconds)
        wait.until(lambda _: page.text("when").startswith(seconds))
        page.driver.save_screenshot(file)
    finally:
        page.close()


if __name__ == "__main__":
    main()
