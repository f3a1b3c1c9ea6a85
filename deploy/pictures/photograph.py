#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Saves a picture of the dashboard's page as soon as it shows a session: photograph.py ADDRESS FILE"""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tests" / "integration"))
from browser import Browser  # noqa: E402  (the browser that the tests use)
from selenium.webdriver.support.wait import WebDriverWait  # noqa: E402

LIMIT_S = 20


def main():
    address, file = sys.argv[1:]
    page = Browser(address)
    try:
        page.resize("laptop")
        # A row of the table of topics: the page has its first snapshot, and has drawn it.
        WebDriverWait(page.driver, LIMIT_S).until(
            lambda driver: "stillhand/sensed" in driver.find_element("tag name", "body").text)
        page.driver.save_screenshot(file)
    finally:
        page.close()


if __name__ == "__main__":
    main()
