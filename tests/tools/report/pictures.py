"""The viewer and the contact sheet of the page."""
import math
import re

from case import BYTES, HEIGHT, WIDTH, PageTest, half, radiance, shown


class Viewer(PageTest):
    def setUp(self):
        super().setUp()
        self.page.wait('document.querySelector(".stage").dataset.ready')
        self.page.run('document.querySelector(".stage").scrollIntoView({block: "center"})')
        self.choose('A', '0')  # the reference
        self.choose('B', '5')
        self.settle()
        self.page.run('document.querySelector(".stage").focus({preventScroll: true})')
        self.scale = 1 + self.row_number() / 16

    def row_number(self):
        """Of the picture in B, by the row's place in the sample."""
        label = self.text('.tag-b')
        radius, delta = re.search('(\\d+)px', label)[1], re.search('\u03b4 ([\\d.]+)', label)[1]
        return (1 + 4 * ['4', '8', '16'].index(radius) + 2 * ['0.2', '0.5'].index(delta) +
                ['block 1pass', 'block all'].index(re.search('block \\w+', label)[0]))

    def settle(self):
        """Until what was asked for is drawn: two frames and all decoding."""
        self.page.run('Promise.all(report.sections.flatMap((s) => s.pictures.map(decodePicture))).then('
                 '() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))))')

    def keys(self, *keys, **more):
        for key in keys:
            self.page.key(key, **more)
        self.settle()

    def view(self):
        """(zoom, left, top) of the picture on the stage, found from what is drawn: the stage's backdrop is clear."""
        return self.page.run('''(() => {
            const [c, d] = (%s)('.stage canvas');
            let left = c.width, right = -1, top = c.height, bottom = -1;
            for (let y = 0; y < c.height; ++y) for (let x = 0; x < c.width; ++x) if (d[4 * (y * c.width + x) + 3] > 0) {
              left = Math.min(left, x); right = Math.max(right, x);
              top = Math.min(top, y); bottom = Math.max(bottom, y);
            }
            return [left, top, right + 1 - left, bottom + 1 - top];
        })()''' % BYTES)

    def pixel(self, x, y):
        """The bytes that show a pixel of the picture."""
        left, top, width, _ = self.view()
        zoom = width / WIDTH
        return self.canvas_pixel('.stage canvas', int(left + (x + 0.5) * zoom), int(top + (y + 0.5) * zoom))

    def expect(self, x, y, scale, exposure=0):
        """(5, 3) is white at exposure 0, whatever the scale: other pixels tell A from B."""
        self.assertEqual(self.pixel(x, y), [shown(scale * c, exposure) for c in radiance(x, y)])

    def test_wipe_shows_both_in_the_tone_curve_of_psf(self):
        for x, y in ((5, 3), (0, 0), (12, 20)):
            self.expect(x, y, 1)
        for x, y in ((39, 0), (30, 17)):
            self.expect(x, y, self.scale)
        _, _, width, height = self.view()
        self.assertEqual(width * HEIGHT, height * WIDTH)
        self.assertEqual(width % WIDTH, 0)

    def test_divider(self):
        x, y = self.page.run('(() => { const b = document.querySelector(".divider").getBoundingClientRect(); '
                        'return [b.left + b.width / 2, b.top + b.height / 2]; })()')
        self.page.mouse('moved', x, y)
        self.page.mouse('pressed', x, y, 1)
        self.page.mouse('moved', x - 4000, y, 1)
        self.page.mouse('released', x - 4000, y)
        self.assertEqual(self.page.run('document.querySelector(".divider").getAttribute("aria-valuenow")'), '0')
        self.expect(12, 20, self.scale)
        self.keys(*['.'] * 50)
        self.expect(39, 0, 1)
        self.page.run('document.querySelector(".divider").focus()')
        self.keys(*['ArrowLeft'] * 49)
        self.assertEqual(self.page.run('document.querySelector(".divider").getAttribute("aria-valuenow")'), '2')
        self.keys(',')
        self.assertEqual(self.page.run('document.querySelector(".divider").getAttribute("aria-valuenow")'), '0')
        self.expect(12, 20, self.scale)

    def test_flick(self):
        self.page.key(' ', up=False)
        self.expect(12, 20, self.scale)
        self.expect(39, 0, self.scale)
        self.page.key(' ', down=False)
        self.expect(12, 20, 1)
        self.keys('f')
        self.expect(39, 0, 1)
        self.keys('f')
        self.expect(12, 20, self.scale)
        self.page.key(' ', up=False)
        self.expect(12, 20, 1)
        self.page.key(' ', down=False)
        self.keys('w')
        self.expect(12, 20, 1)
        self.expect(39, 0, self.scale)
        self.click_text('.panel', 'B alone')
        self.expect(12, 20, self.scale)
        self.click_text('.panel', 'A alone')
        self.expect(39, 0, 1)
        self.click_text('.panel', 'Wipe')
        x, y = self.center('.hold')
        self.page.mouse('moved', x, y)
        self.page.mouse('pressed', x, y, 1)
        self.expect(12, 20, self.scale)
        self.page.mouse('released', x, y)
        self.expect(12, 20, 1)
        self.page.run('document.querySelector(".hold").focus()')
        self.page.key(' ', up=False)
        self.expect(12, 20, self.scale)
        self.page.key(' ', down=False)
        self.expect(12, 20, 1)

    def test_swap_and_step(self):
        before = self.text('.tag-b')[1:]
        self.keys('x')
        self.assertEqual(self.text('.tag-a')[1:], before)
        self.expect(12, 20, self.scale)
        self.click_text('.panel', 'Swap')
        self.settle()
        self.assertEqual(self.text('.tag-b')[1:], before)
        self.page.run('document.querySelector(".stage").focus({preventScroll: true})')
        self.keys('n')
        self.assertNotEqual(self.text('.tag-b')[1:], before)
        self.expect(39, 0, 1 + self.row_number() / 16)
        self.keys('p')
        self.assertEqual(self.text('.tag-b')[1:], before)

    def test_exposure(self):
        self.keys(']', ']', ']')
        self.assertEqual(self.text('.exposure output'), '+1.5 stops')
        self.expect(0, 0, 1, 1.5)
        self.keys('0', *['['] * 8)
        self.expect(12, 20, 1, -4)
        self.expect(5, 3, 1, -4)  # bright: with less exposure, below the shoulder
        self.click_text('.exposure', 'Reset')
        self.settle()
        self.expect(12, 20, 1)
        self.page.run('document.getElementById("exposure").focus()')
        self.page.key('ArrowRight')
        self.settle()
        self.expect(12, 20, 1, 0.5)

    def test_errors_in_false_colour(self):
        self.keys('e')
        self.assertEqual(self.pixel(12, 20), [0, 0, 4])  # the reference has none
        bright = self.pixel(39, 0)
        error = sum(((self.scale - 1) * c) ** 2 / (c * c + 0.01) for c in radiance(39, 0)) / 3
        place = round(255 * (math.log10(error) + 4) / 5)
        self.assertEqual(bright, self.page.run(f'falseTable[{place}]'))
        self.assertTrue(self.page.run('document.getElementById("exposure").disabled'))
        self.click_text('.panel', 'Colours')
        self.settle()
        self.expect(12, 20, 1)
        self.click_text('.panel', 'Errors')
        self.settle()
        self.assertEqual(self.pixel(12, 20), [0, 0, 4])

    def test_values_under_the_pointer(self):
        left, top, width, _ = self.view()
        box = self.corner('.stage')
        zoom = width / WIDTH
        self.page.mouse('moved', box[0] + left + 12.5 * zoom, box[1] + top + 20.5 * zoom)
        self.assertEqual(self.text('.readout caption'), 'Linear values of pixel 12, 20')

        def expect(x, y):
            cells = self.texts('.readout td')
            error = sum(((half(self.scale * c) - c) ** 2 / (c * c + 0.01)) for c in radiance(x, y)) / 3
            wanted = [*radiance(x, y), 0, *(half(self.scale * c) for c in radiance(x, y)), error, *radiance(x, y)]
            for cell, value in zip(cells, wanted):
                self.assertAlmostEqual(float(cell.replace('\u2212', '-')), value, delta=0.006 * value)
            self.assertEqual(cells[-1], '\u2013')
        expect(12, 20)
        self.page.key('ArrowLeft', shift=True)
        self.page.key('ArrowUp', shift=True)
        self.assertEqual(self.text('.readout caption'), 'Linear values of pixel 11, 19')
        expect(11, 19)
        self.page.key('ArrowRight', shift=True)
        self.page.key('ArrowDown', shift=True)
        expect(12, 20)

    def test_zoom_and_pan(self):
        fit = self.view()
        zoom = fit[2] / WIDTH
        self.keys('1')
        self.assertEqual(self.view()[2:], [WIDTH, HEIGHT])
        self.keys('+')
        self.assertEqual(self.view()[2:], [2 * WIDTH, 2 * HEIGHT])
        self.keys('-')
        before = self.view()
        self.keys('ArrowRight')
        self.assertEqual(self.view(), [before[0] - 40, *before[1:]])
        self.keys('ArrowDown')
        self.assertEqual(self.view(), [before[0] - 40, before[1] - 40, *before[2:]])
        box = self.corner('.stage')
        self.page.mouse('moved', box[0] + 30, box[1] + 200)
        self.page.mouse('pressed', box[0] + 30, box[1] + 200, 1)
        self.page.mouse('moved', box[0] + 80, box[1] + 215, 1)
        self.page.mouse('released', box[0] + 80, box[1] + 215)
        self.assertEqual(self.view(), [before[0] + 10, before[1] - 25, *before[2:]])
        self.keys('z')
        self.assertEqual(self.view(), fit)
        for name, wanted in (('+', 2 * zoom), ('Fit', zoom), ('\u2212', zoom / 2), ('1:1', 1)):
            self.click_text('.panel', name)
            self.assertEqual(self.text('.zoom-text'), f'{100 * wanted:,.0f}\u202f%')
        self.click_text('.panel', 'Fit')
        self.assertEqual(self.view(), fit)
        # The wheel zooms where the pointer is, but only with the focus.
        self.page.run('document.activeElement.blur()')
        at = (box[0] + fit[0] + fit[2] / 4, box[1] + fit[1] + fit[3] / 4)
        self.page.mouse('wheel', *at, deltaX=0, deltaY=1)
        self.assertEqual(self.view(), fit)
        self.page.run('document.querySelector(".stage").focus({preventScroll: true})')
        box = self.corner('.stage')
        at = (box[0] + fit[0] + fit[2] / 4, box[1] + fit[1] + fit[3] / 4)
        self.page.mouse('wheel', *at, deltaX=0, deltaY=240)
        self.page.wait(f'document.querySelector(".zoom-text").textContent !== "{100 * zoom:,.0f}\u202f%"')
        left, top, width, _ = self.view()
        self.assertEqual(width, fit[2] / 2)
        self.assertLessEqual(abs(left - (fit[0] + fit[2] / 8)), 1)


class Sheet(PageTest):
    def test_cards(self):
        names = self.texts('.card-name')
        self.assertEqual(len(names), 14 + 13 + 9)
        self.assertEqual(names[:3], ['reference', 'unfiltered', 'r\u2080 8px \u00b7 \u03b4 0.2 \u00b7 block all'])
        self.assertIn('\u03b4 0.2 \u00b7 n 8', names)
        self.assertEqual(self.texts('.card .note')[1:3], ['relMSE 0.400', 'relMSE 0.0100'])
        for canvas in range(len(names)):
            self.page.run(f'document.querySelectorAll(".card canvas")[{canvas}].scrollIntoView()')
            self.page.wait(f'document.querySelectorAll(".card canvas")[{canvas}].dataset.drawn')
        self.assertEqual(self.canvas_pixel('.card:nth-child(3) canvas', 5, 3),
                         [shown(c * (1 + 6 / 16)) for c in (8, 4, 2)])
        self.assertEqual(self.texts('#pictures-note'), [''])

    def test_choosing(self):
        self.click('.card:nth-child(1) .card-sides button')
        self.click('.card:nth-child(4) .card-sides button:last-child')
        self.expect_text('.tag-a', 'A  reference')
        self.expect_text('.tag-b', 'B  ' + self.texts('.card-name')[3])
        self.page.wait('document.querySelectorAll(".card.in-use").length === 2')
        self.assertEqual(self.page.run('document.querySelectorAll(".card-sides [aria-pressed=true]").length'), 2)
        self.click('.card:nth-child(6) canvas')
        self.expect_text('.tag-b', 'B  ' + self.texts('.card-name')[5])
