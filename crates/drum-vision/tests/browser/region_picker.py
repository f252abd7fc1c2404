"""Uses the region page in headless Chromium and measures with the side-car that it saved. See README.md."""

import json
import pathlib
import random
import re
import subprocess
import sys
import tempfile
import time

from selenium import webdriver
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By

binary = sys.argv[1]
folder = pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else tempfile.mkdtemp()).resolve()
print(subprocess.run([binary, "page", folder], check=True, capture_output=True, text=True).stdout.strip())
truth = json.loads((folder / "truth.json").read_text())

options = webdriver.ChromeOptions()
for argument in ("--headless=new", "--no-sandbox", "--disable-gpu", "--window-size=1300,1200"):
    options.add_argument(argument)
options.add_experimental_option("prefs", {"download.default_directory": str(folder)})
driver = webdriver.Chrome(options=options)
try:
    driver.get((folder / "powder.html").as_uri())
    for _ in range(100):
        if driver.execute_script("return document.body.dataset.ready") == "yes":
            break
        time.sleep(0.1)
    canvas = driver.find_element(By.ID, "picture")
    size = driver.execute_script("const c = arguments[0]; return [c.width, c.height, c.clientWidth, c.clientHeight]", canvas)
    scale = size[2] / size[0]
    hand = random.Random(4)
    for x, y in truth["corners"]:
        # A person hits a corner to a pixel or two.
        x, y = x + hand.gauss(0, 1.0), y + hand.gauss(0, 1.0)
        left = min(max((x + 0.5) * scale, 1), size[2] - 2) - size[2] / 2
        down = min(max((y + 0.5) * scale, 1), size[3] - 2) - size[3] / 2
        ActionChains(driver).move_to_element_with_offset(canvas, round(left), round(down)).click().perform()
    # One corner too many, taken back.
    ActionChains(driver).move_to_element_with_offset(canvas, 0, 0).click().perform()
    driver.find_element(By.ID, "undo").click()
    assert driver.find_element(By.ID, "count").text == f"{len(truth['corners'])} corners"
    for slider, value in (("low", 60), ("high", 254)):
        driver.execute_script(
            "const s = document.getElementById(arguments[0]); s.value = arguments[1]; s.dispatchEvent(new Event('input'))",
            slider,
            value,
        )
    requests = driver.execute_script("return performance.getEntriesByType('resource').map(e => e.name)")
    outside = [name for name in requests if not name.startswith(("data:", "blob:", "file:"))]
    assert not outside, outside
    driver.save_screenshot(str(folder / "page.png"))
    driver.find_element(By.ID, "save").click()
    shown = json.loads(driver.find_element(By.ID, "sidecar").text)
    saved = folder / "powder.region.json"
    for _ in range(100):
        if saved.exists():
            break
        time.sleep(0.1)
    if not saved.exists():
        raise SystemExit("the side-car was not downloaded")
finally:
    driver.quit()

assert json.loads(saved.read_text()) == shown
out = subprocess.run([binary, "measure", folder, saved], check=True, capture_output=True, text=True).stdout
print(out.strip())
figures = [float(v) for v in re.findall(r"(?:aor_\w+|drawn) (-?[\d.]+)", out)]
errors = [abs(figures[0] - figures[1]), abs(figures[2] - figures[3])]
print(f"errors {errors[0]:.2f} and {errors[1]:.2f} deg; files in {folder}")
sys.exit(max(errors) >= 1.0)
