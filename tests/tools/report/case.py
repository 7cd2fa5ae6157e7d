"""What the tests of the page share: the page of the sample, opened anew for each test, and ways to use it."""
import math
import pathlib
import struct
import subprocess
import tempfile
import time
import unittest

import chromium

WIDTH, HEIGHT = 40, 30  # of the sample's pictures


def radiance(x, y):
    """The sample's reference, as report_sample.h has it."""
    return [8, 4, 2] if (x, y) == (5, 3) else [0.125 + x / 64, 0.125 + y / 64, 0.25]


def half(value):
    return struct.unpack('<e', struct.pack('<e', value))[0]


def shown(linear, exposure=0):
    """The byte that psf filter's PNG has for it."""
    x = half(linear) * 2 ** exposure
    x = x if x < 0.7 else 1 - 0.3 * math.exp(-(x - 0.7) / 0.3)
    return round(255 * (12.92 * x if x <= 0.0031308 else 1.055 * x ** (1 / 2.4) - 0.055))


# The canvas of a selector and its bytes, without touching its own context.
BYTES = '''(selector) => {
    const canvas = document.querySelector(selector);
    const context = new OffscreenCanvas(canvas.width, canvas.height).getContext('2d', {willReadFrequently: true});
    context.drawImage(canvas, 0, 0);
    return [canvas, context.getImageData(0, 0, canvas.width, canvas.height).data];
}'''


class PageTest(unittest.TestCase):
    """Whatever a test does, the console must stay empty and nothing be fetched."""
    page = url = folder = None

    @classmethod
    def start(cls, psf, sample):
        """Writes the sample and its page and starts the browser, for all tests."""
        cls.folder = tempfile.TemporaryDirectory(prefix='psf-report-')
        out = pathlib.Path(cls.folder.name) / 'report.html'
        subprocess.run([sample, cls.folder.name], check=True)
        subprocess.run([psf, 'report', cls.folder.name + '/radii', cls.folder.name + '/rates',
                        cls.folder.name + '/parts', '-o', str(out), '--quiet'], check=True, stdout=subprocess.DEVNULL)
        cls.url = out.as_uri()
        cls.page = chromium.Chromium()

    @classmethod
    def stop(cls):
        cls.page.close()
        cls.folder.cleanup()

    def setUp(self):
        self.page.resize(1400, 900)
        self.page.prefer('light')
        self.page.requests.clear()
        self.page.console.clear()
        self.page.open(self.url)
        self.page.wait('document.querySelectorAll(".plot svg").length === 8')
        self.page.wait('document.querySelector(".stage").dataset.ready')  # it changes the height of the page
        self.addCleanup(self.check_silence)

    def check_silence(self):
        self.page.run('1')  # so that all events are here
        self.assertEqual(self.page.console, [])
        self.assertEqual(self.page.requests, [self.url])

    def text(self, selector):
        return self.page.run(f'document.querySelector({selector!r}).textContent')

    def expect_text(self, selector, text):
        """Soon: pictures are decoded first."""
        self.page.wait(f'document.querySelector({selector!r}).textContent === {text!r}')

    def wait_for(self, condition):
        end = time.monotonic() + chromium.PATIENCE
        while not condition():
            self.assertLess(time.monotonic(), end, 'never came true')
            time.sleep(0.02)

    def texts(self, selector):
        return self.page.run(f'[...document.querySelectorAll({selector!r})].map((e) => e.textContent)')

    def corner(self, selector):
        """Its left upper one."""
        return self.page.run(f'''(() => {{
            const b = document.querySelector({selector!r}).getBoundingClientRect();
            return [b.left, b.top];
        }})()''')

    def center(self, selector):
        """Of the first visible element, scrolled into sight, once the page moves no more."""
        return self.page.run(f'''(async () => {{
            const e = document.querySelector({selector!r});
            for (let before = null;;) {{
                e.scrollIntoView({{block: 'center', behavior: 'instant'}});
                await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
                const b = e.getBoundingClientRect();
                const now = [b.left + b.width / 2, b.top + b.height / 2];
                if (before && before.every((x, k) => x === now[k])) return now;
                before = now;
            }}
        }})()''')

    def click(self, selector):
        self.page.click(*self.center(selector))

    def click_text(self, within, text):
        """The button of that text."""
        self.page.run(f'''document.querySelectorAll('[data-test]').forEach((e) => e.removeAttribute('data-test'));
            [...document.querySelectorAll({within + ' button'!r})].find(
                (e) => e.textContent === {text!r}).setAttribute('data-test', '')''')
        self.click('[data-test]')

    def choose(self, label, value, within='body'):
        """In the list of that label, as a user's change does it."""
        self.page.run(f'''(() => {{
            const label = [...document.querySelectorAll({within + ' .choice label'!r})].find(
                (e) => e.textContent === {label!r});
            const select = document.getElementById(label.htmlFor);
            const option = [...select.options].find((o) => o.value === {value!r} || o.text === {value!r});
            if (!option) throw new Error('no such choice');
            select.focus();
            select.value = option.value;
            select.dispatchEvent(new Event('change', {{bubbles: true}}));
        }})()''')

    def canvas_pixel(self, selector, x, y):
        return self.page.run('''(() => {
            const [canvas, bytes] = (%s)(%r), at = 4 * (%d * canvas.width + %d);
            return [bytes[at], bytes[at + 1], bytes[at + 2]];
        })()''' % (BYTES, selector, y, x))
