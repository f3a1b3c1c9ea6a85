# SPDX-License-Identifier: Apache-2.0
"""A real Chromium without a screen, and the questions that a test asks a page in it: Selenium, Chromium's driver."""
import json
import os
import pathlib

CHROMIUM = "/usr/bin/chromium"
DRIVER = "/usr/bin/chromedriver"
SIZES = {"wall": (1920, 1080), "laptop": (1280, 720), "phone": (390, 844)}
KEPT = os.environ.get("STILLHAND_SCREENSHOTS")  # folder for pictures of the page

# Records what the page shows, with the time, each time it changes: the strip with the alarms' text, and each alarm. So a
# test sees also what the page shows only for a moment, between two questions.
WATCH = """
window.seen = [];
const look = () => window.seen.push([Date.now(), document.getElementById("strip").innerText + "\\n" +
                                     document.getElementById("alarms").innerText,
                                     [...document.querySelectorAll("#alarms li")].map(({ textContent }) => textContent)]);
for (const id of ["strip", "alarms"])
  new MutationObserver(look).observe(document.getElementById(id), { childList: true, subtree: true, characterData: true });
// The table of topics changes with each snapshot of a session, ten times a second.
window.drawn = [];
new MutationObserver(() => window.drawn.push(Date.now())).observe(
  document.getElementById("topics"), { childList: true, subtree: true, characterData: true });
"""
# The name of the element that has the focus, and whether it shows the focus.
FOCUSED = """
const node = document.activeElement, style = getComputedStyle(node), box = node.getBoundingClientRect();
return { name: node.id || node.dataset.ask || node.getAttribute("aria-labelledby") || node.textContent.trim().slice(0, 40),
         body: node === document.body, shown: style.outlineStyle !== "none" && parseFloat(style.outlineWidth) >= 2,
         visible: box.width > 0 && box.height > 0 };
"""
OPERABLE = """
return [...document.querySelectorAll("a[href], button:not(:disabled), input:not(:disabled), summary, [tabindex='0']")]
  .filter((node) => node.checkVisibility() && !node.closest("[hidden]"))
  .map((node) => node.id || node.dataset.ask || node.getAttribute("aria-labelledby") || node.textContent.trim().slice(0, 40));
"""
AXE = """
const done = arguments[arguments.length - 1];
axe.run(document, { resultTypes: ["violations"] }).then(({ violations }) => done(violations.map(({ id, impact, help, nodes }) =>
  ({ id, impact, help, nodes: nodes.map(({ target, failureSummary }) => `${target}: ${failureSummary}`) }))),
  (error) => done([{ id: "axe", impact: "critical", help: String(error), nodes: [] }]));
"""


def missing():
    """Why there is no browser here, or ""."""
    for program in (CHROMIUM, DRIVER):
        if not pathlib.Path(program).is_file():
            return f"no {program}"
    try:
        import selenium  # noqa: F401
    except ImportError:
        return "no Selenium for this Python"
    return ""


class Browser:
    """One page; close() ends the browser."""

    def __init__(self, address):
        from selenium import webdriver
        from selenium.webdriver.chrome.service import Service
        options = webdriver.ChromeOptions()
        options.binary_location = CHROMIUM
        for word in ("--headless=new", "--disable-gpu", "--disable-dev-shm-usage", "--disable-background-networking"):
            options.add_argument(word)
        if os.geteuid() == 0:
            options.add_argument("--no-sandbox")  # without it, it refuses root
        options.set_capability("goog:loggingPrefs", {"performance": "ALL", "browser": "ALL"})
        self.driver = webdriver.Chrome(service=Service(DRIVER), options=options)
        self.address = address
        self.errors, self.requests = [], []
        self.resize("laptop")
        self.driver.get(address)
        self.driver.execute_script(WATCH)

    def resize(self, size, dark=False):
        width, height = SIZES[size]
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {
            "width": width, "height": height, "deviceScaleFactor": 1, "mobile": size == "phone"})
        self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {
            "features": [{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}]})

    def run(self, script, *arguments):
        return self.driver.execute_script(script, *arguments)

    def text(self, element):
        return self.run("return document.getElementById(arguments[0])?.innerText ?? ''", element)

    def press(self, key):
        from selenium.webdriver.common.action_chains import ActionChains
        ActionChains(self.driver).send_keys(key).perform()

    def click(self, selector):
        node = self.driver.find_element("css selector", selector)
        self.run("arguments[0].scrollIntoView({ block: 'center' })", node)
        node.click()

    def first_seen(self, after_ms, shown):
        """When the page first showed what a condition on its text asks for [ms since 1970], or None."""
        return next((at for at, text, _ in self.run("return window.seen") if at >= after_ms and shown(text)), None)

    def first_alarms_seen(self, after_ms, shown):
        """When a condition on the texts of the page's alarms was first true [ms since 1970], or None."""
        return next((at for at, _, alarms in self.run("return window.seen") if at >= after_ms and shown(alarms)), None)

    def drawn_between(self, from_ms, to_ms):
        """How many snapshots the page drew in this time [ms since 1970]: its own clock, which a busy machine slows down too."""
        return self.run("return window.drawn.filter((at) => at > arguments[0] && at <= arguments[1]).length", from_ms, to_ms)

    def pictures(self):
        """Every canvas of the page, as its pixels."""
        return self.run("return [...document.querySelectorAll('canvas')].map((canvas) => canvas.toDataURL())")

    def gather(self):
        """Adds the browser's log since the last call to `errors` and `requests`."""
        self.errors += [entry["message"] for entry in self.driver.get_log("browser")
                        if entry["level"] in ("SEVERE", "WARNING")]
        for entry in self.driver.get_log("performance"):
            message = json.loads(entry["message"])["message"]
            if message["method"] == "Network.requestWillBeSent":
                self.requests.append(message["params"]["request"]["url"])

    def findings(self, axe):
        """Serious and critical ones of axe-core, whose script is given."""
        if not self.run("return typeof axe !== 'undefined'"):
            self.run(axe + "\nwindow.axe = axe;")
        self.driver.set_script_timeout(60)
        return [found for found in self.driver.execute_async_script(AXE) if found["impact"] in ("serious", "critical")]

    def walk(self, most=150):
        """Every place that Tab reaches, from the top until it leaves the page."""
        self.run("document.activeElement.blur(); window.scrollTo(0, 0)")
        places = []
        for _ in range(most):
            self.press("\ue004")
            place = self.run(FOCUSED)
            if place["body"]:
                break
            places.append(place)
        return places

    def operable(self):
        return self.run(OPERABLE)

    def overflows(self):
        """By how many pixels the page is wider than its window."""
        return self.run("return document.documentElement.scrollWidth - window.innerWidth")

    def keep(self, name):
        """Saves a picture of the whole page in each size and colour, if STILLHAND_SCREENSHOTS is set."""
        if not KEPT:
            return
        folder = pathlib.Path(KEPT)
        folder.mkdir(parents=True, exist_ok=True)
        for size in SIZES:
            for dark in (False, True):
                self.resize(size, dark)
                self.run("window.scrollTo(0, 0); return new Promise((then) => setTimeout(then, 400))")
                self.driver.save_screenshot(str(folder / f"{name}-{size}-{'dark' if dark else 'light'}.png"))
        self.resize("laptop")

    def close(self):
        self.driver.quit()
