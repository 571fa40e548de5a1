"""Tests the web page that reports a comparison: "try this cell" starts the simulation of that cell of the table inside the page."""

import functools
import http.server
import os
import subprocess
import threading


class Quiet(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *args):
        pass


def report(browser, program, pictures, folder, check):
    out = os.path.join(folder, "report")
    subprocess.run([program, "--quiet", "run", "tap", "--law", "fba", "--out", out], check=True)
    size = os.path.getsize(os.path.join(out, "index.html"))
    # Served over HTTP, because the script cannot look into the frame of a page that was opened as a file.
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Quiet, directory=out))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    page = browser(f"http://127.0.0.1:{server.server_address[1]}/index.html")
    inside = "document.querySelector('#live iframe').contentDocument"
    try:
        page.until("document.querySelector('button.try')?.hidden === false")
        page.run("document.querySelector('button.try').click()")
        page.until(f"{inside}?.getElementById('law')?.value === 'fba'", 30)
        page.until(f"/\\d+ ticks a second of 1000/.test({inside}.getElementById('status').textContent)", 10)
        page.wait(1.5)
        said = page.run(f"{inside}.getElementById('status').textContent")
        wrong = page.run(f"{inside}.getElementById('error').textContent")
        pressed = page.run(f"{inside}.getElementById('automatic').getAttribute('aria-pressed')")
        check(wrong == "" and pressed == "true", f"try this cell, in a report of {size} bytes: {said}{wrong}")
        if pictures:
            page.picture(os.path.join(pictures, "report-try.png"))
        page.run("document.querySelector('#live button').click()")
        page.wait(0.3)
        check(page.run("!document.getElementById('live').open && !document.querySelector('#live iframe').hasAttribute('src')"), "and is closed again")
        page.problems[:] = [problem for problem in page.problems if "favicon" not in problem and "404" not in problem]
        check(not page.problems, f"no complaint of {page.name} {page.problems[:3]}")
    finally:
        page.close()
        server.shutdown()
