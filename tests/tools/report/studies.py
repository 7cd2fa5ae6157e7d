"""Texts, maps, tables and plots of the page."""
import math
import pathlib
import re
import xml.etree.ElementTree

from case import PageTest


class Texts(PageTest):
    def test_title_and_headings(self):
        self.assertTrue(self.page.run('document.title').startswith('</script><script>window.hacked = 1'))
        self.assertTrue(self.page.run('document.title').endswith(
            'room.pvb, room.json \u2013 room.pvb \u00b7 psf 0.1.0'))
        self.assertEqual(self.texts('h2'), ['Sweep: radii', 'Convergence: rates', 'Ablation: parts', 'Pictures'])

    def test_texts_of_files_are_texts(self):
        self.assertEqual(self.page.run('typeof window.hacked'), 'undefined')
        self.assertIn("<img src=x onerror='window.hacked = 1'>&amp;.json", self.text('h1'))
        self.assertIn("<img src=x onerror='window.hacked = 1'>&amp;.json", self.text('#study-0 .facts'))
        self.assertEqual(self.page.run('document.querySelectorAll("img").length'), 0)

    def test_contents_lead_to_sections(self):
        for name in self.texts('#contents a'):
            self.page.run(f'''[...document.querySelectorAll("#contents a")].find(
                (e) => e.textContent === {name!r}).click()''')
            top = self.page.run('document.querySelector(location.hash).getBoundingClientRect().top')
            self.assertTrue(0 < top < 200, f'{name} at {top}')
            self.page.requests.clear()
            self.page.requests.append(self.url)


class Sweep(PageTest):
    def best(self):
        return self.page.run('[...document.querySelectorAll("td.best")].map((e) => e.getAttribute("aria-label"))')

    def test_maps(self):
        self.assertEqual(self.texts('.heat caption'), ['block 1pass', 'block all'])
        self.assertEqual(self.texts('.heat td[tabindex]'), ['0.12', '0.030', '0.12', '0.080', '0.020', '0.080',
                                                            '0.060', '0.015', '0.060', '0.040', '0.010', '0.040'])
        self.assertEqual(self.texts('.heat tfoot th')[:3], ['4px', '8px', '16px'])
        self.assertEqual(self.texts('.heat tbody th')[:2], ['0.5', '0.2'])
        self.assertEqual(self.best(), ['r\u2080 8px \u00b7 \u03b4 0.2: relMSE 0.0100, the best of all'])
        self.assertEqual(self.text('.summary'), 'The best by relMSE (\u03b5 = 0.01) is r\u2080 8px \u00b7 '
                                                '\u03b4 0.2 \u00b7 block all: 0.0100, 40.0\u00d7 less than unfiltered (0.400).')
        colors = self.page.run('[...document.querySelectorAll(".heat td[tabindex]")].map((e) => e.style.background)')
        self.assertEqual(len(set(colors)), 8)  # as many as there are errors
        self.assertEqual(colors[0], colors[2])

    def test_metrics_and_axes(self):
        self.choose('Metric', 'PSNR')
        self.assertEqual(self.best(), ['r\u2080 8px \u00b7 \u03b4 0.2: PSNR 39.0, the best of all'])
        self.choose('Metric', 'FLIP')
        self.assertEqual(self.text('.summary'), 'No row has a value of FLIP.')
        self.choose('Metric', 'relMSE')
        self.choose('Up', 'block')
        self.assertEqual(self.texts('.heat caption'), ['\u03b4 0.2', '\u03b4 0.5'])
        self.choose('Across', 'delta')
        self.assertEqual(self.texts('.heat caption'), ['r\u2080 4px', 'r\u2080 8px', 'r\u2080 16px'])
        self.assertEqual(self.texts('.heat')[1], 'r\u2080 8pxall0.0100.0151pass0.0200.0300.20.5')

    def test_cells_by_pointer_and_keys(self):
        self.page.mouse('moved', *self.center('td.best'))
        tip = self.text('#tooltip')
        for part in ('r\u2080 8px', 'relMSE0.0100', 'PSNR39.0', '40.0\u00d7 less', 'neighbours64.0', '8.00 to 4.00 px',
                     'row0006'):
            self.assertIn(part, tip)
        self.page.mouse('moved', 5, 300)
        self.assertTrue(self.page.run('document.getElementById("tooltip").hidden'))
        self.page.run('document.querySelector("td.best").focus({focusVisible: true})')
        self.page.key('ArrowUp')
        self.page.key('ArrowRight')
        self.assertTrue(self.page.run('document.activeElement.getAttribute("aria-label")').endswith('relMSE 0.0600'))
        self.assertIn('row0012', self.text('#tooltip'))
        self.page.key('Escape')
        self.assertTrue(self.page.run('document.getElementById("tooltip").hidden'))
        self.page.key('Enter')
        self.expect_text('.tag-b', 'B  r\u2080 16px \u00b7 \u03b4 0.5 \u00b7 block all')
        self.click('td.best')
        self.expect_text('.tag-b', 'B  r\u2080 8px \u00b7 \u03b4 0.2 \u00b7 block all')

    def column(self, k):
        return self.page.run(f'''[...document.querySelectorAll("#study-0 .rows tbody tr")].map(
            (r) => r.cells[{k}].textContent)''')

    def test_table_sorts(self):
        headings = [text.strip() for text in self.texts('#study-0 .rows th')]
        self.assertEqual(headings[:5], ['row', 'r0', 'delta', 'block', 'relMSE'])
        self.assertEqual(self.column(0)[:3], ['0001', '0002', '0003'])
        self.click('#study-0 .rows th:nth-child(5) button')
        self.assertEqual(self.column(0)[:3], ['0006', '0008', '0005'])
        self.page.key('Enter')  # the heading has the focus
        self.assertEqual(self.column(4)[0], '0.120')
        self.assertEqual(self.page.run('document.querySelectorAll("#study-0 .rows th")[4].ariaSort'), 'descending')
        self.click('#study-0 .rows th:nth-child(2) button')
        self.assertEqual(self.column(1), ['4px'] * 4 + ['8px'] * 4 + ['16px'] * 4)
        self.assertEqual(self.page.run('document.querySelector("#study-0 .rows tr.best").cells[0].textContent'), '0006')


class Converge(PageTest):
    def lines(self, chart, kind='.line'):
        """Of a plot, as [[x, y], ...] a line."""
        paths = self.page.run(f'''[...[...document.querySelectorAll('.chart')].find(
            (e) => e.querySelector('b').textContent === {chart!r}).querySelectorAll('.plot path{kind}')].map(
                (e) => e.getAttribute('d'))''')
        return [[[float(v) for v in point.split(',')] for point in re.split('[ML]', path.rstrip('Z'))[1:]]
                for path in paths]

    def assertSame(self, a, b):
        self.assertEqual(len(a), len(b))
        for p, q in zip(a, b):
            self.assertLess(math.dist(p, q), 0.01)

    def test_lines_and_theory(self):
        self.assertEqual(self.texts('.chart figcaption b'),
                         ['Error against n', 'Error against time', 'Bias\u00b2', 'Variance', 'Neighbours M(n)',
                          'Radius', 'Speed-up at equal time', 'Speed-up at equal error'])
        # The sample follows theory, so the guides lie on the lines.
        self.assertSame(self.lines('Error against n')[0], self.lines('Error against n', '.guide')[0])
        self.assertSame(self.lines('Error against time')[0], self.lines('Error against time', '.guide')[0])
        self.choose('Theory for', '\u03b4 0.5')
        self.assertSame(self.lines('Bias\u00b2')[1], self.lines('Bias\u00b2', '.guide')[0])
        self.assertSame(self.lines('Variance')[2], self.lines('Variance', '.guide')[0])
        self.choose('Theory for', '\u03b4 0.2')
        smooth, edge = self.lines('Bias\u00b2', '.guide')
        self.assertSame(self.lines('Bias\u00b2')[0], smooth)
        self.assertLess(smooth[0][1], edge[0][1])  # higher where they begin: steeper
        self.assertSame(self.lines('Variance')[1], self.lines('Variance', '.guide')[0])
        # Equal steps of a power of two are equal steps on both axes.
        (x0, y0), (x1, y1), (x2, y2) = self.lines('Radius')[1][:3]
        self.assertAlmostEqual(x1 - x0, x2 - x1, 2)
        self.assertAlmostEqual(y1 - y0, y2 - y1, 2)
        self.assertEqual(len(self.lines('Variance', '.band')), 3)
        self.assertEqual(len(self.lines('Bias\u00b2', '.band')), 2)

    def test_metric(self):
        self.choose('Metric', 'PSNR', '#study-1')
        self.assertEqual(len(self.lines('Error against n', '.guide')), 0)
        error = 0.1 * 8 ** -0.8 + 0.01 * 8 ** -0.4  # at n = 8, delta 0.2
        self.assertEqual(self.text('#study-1 .summary'),
                         f'At n = 8 the best by PSNR is \u03b4 0.2: {40 - 100 * error:.1f}; unfiltered 27.5.')
        self.choose('Metric', 'FLIP', '#study-1')
        self.assertFalse(self.page.run('document.querySelector("#study-1 .chart > .note").hidden'))
        self.choose('Metric', 'relMSE', '#study-1')
        self.assertEqual(len(self.lines('Error against n')), 3)

    def test_legend(self):
        self.click_text('.legend', '\u03b4 0.2')
        self.assertEqual(len(self.lines('Error against n')), 2)
        self.assertEqual(len(self.lines('Bias\u00b2', '.guide')), 0)
        self.click_text('.legend', 'none')
        self.assertEqual(len(self.lines('Error against n')), 1)
        self.click_text('.legend', 'all')
        self.assertEqual(len(self.lines('Error against n')), 3)

    def test_points_by_pointer_and_keys(self):
        svg = '#study-1 .chart svg[role]'
        x, y = self.center(svg)
        box = self.corner(svg)
        point = self.lines('Error against n')[0][2]
        self.page.mouse('moved', box[0] + 62 + point[0] + 3, box[1] + 12 + point[1] - 3)
        for part in ('unfiltered', 'n4', 'relMSE0.250', 'variance0.250', 'time2.04'):
            self.assertIn(part, self.text('#tooltip'))
        self.page.mouse('moved', x, 5)
        self.assertTrue(self.page.run('document.getElementById("tooltip").hidden'))
        self.page.run(f'document.querySelector({svg!r}).focus()')
        for key in ('ArrowLeft', 'ArrowDown', 'ArrowRight'):
            self.page.key(key)
        for part in ('\u03b4 0.2', 'n4', 'bias\u00b20.00574'):
            self.assertIn(part, self.text('#tooltip'))
        self.page.key('ArrowUp')
        self.page.key('ArrowLeft')
        self.assertIn('n2', self.text('#tooltip'))

    def test_plots_are_saved_for_paper(self):
        self.page.prefer('dark')
        self.page.download_to(self.folder.name)
        self.click('.chart:nth-child(3) .save')
        saved = pathlib.Path(self.folder.name) / 'bias.svg'
        self.wait_for(saved.exists)
        root = xml.etree.ElementTree.parse(saved).getroot()
        self.assertEqual(root.tag, '{http://www.w3.org/2000/svg}svg')
        paths = {path.get('d'): path.get('style') for path in root.iter('{http://www.w3.org/2000/svg}path')}
        for d in self.page.run('[...document.querySelectorAll(".chart:nth-child(3) path")].map('
                               '(e) => e.getAttribute("d"))'):
            self.assertIn('stroke:', paths[d])
        self.assertIn('stroke:rgb(31, 111, 178)', ' '.join(paths.values()))  # of the light theme
        self.assertEqual(self.page.run('document.documentElement.dataset.theme'), 'dark')

    def test_tables_and_verdict(self):
        self.click('#study-1 details summary')
        rows = self.page.run('[...document.querySelectorAll("#study-1 details[open] tbody tr")].map('
                        '(r) => [...r.cells].map((c) => c.textContent))')
        self.assertEqual(len(rows), 9)
        self.assertEqual(rows[3], ['\u03b4 0.2', '1', '2', '\u22120.90', '\u22120.40', '\u22120.40', '\u22120.10',
                                   '\u22120.80', '\u22120.80', '100', '8.00'])
        self.click('#study-1 details:last-child summary')
        self.assertEqual(self.page.run('document.querySelectorAll("#study-1 details:last-child tbody tr").length'), 12)
        self.assertEqual(self.text('.verdict b'), 'The slopes agree with theory.')
        self.assertEqual(self.texts('.verdict tbody tr'), ['\u03b4 0.5bias\u00b2\u22121.04\u22121.00agrees'])


class Ablation(PageTest):
    def rows(self, table):
        return self.page.run(f'''[...document.querySelectorAll("#study-2 table")[{table}].querySelectorAll("tbody tr")]
            .map((r) => [...r.cells].map((c) => c.textContent))''')

    def test_a_table_for_each_part(self):
        self.assertEqual(self.texts('#study-2 h3'),
                         ['Weights one after another', 'Blocks filtered apart', 'Iterations on one pass'])
        weights = self.rows(0)
        self.assertEqual([row[0] for row in weights], ['unfiltered, 16 passes', 'no weights', '+ normal 0.95'])
        self.assertEqual([row[1] for row in weights], ['0.400', '0.0200', '0.0100'])
        self.assertEqual([row[2] for row in weights], ['\u2013', '20.0', '40.0'])
        self.assertEqual(weights[1][4], '\u22120.12\u202f%')
        # Each against the same passes without filter.
        self.assertEqual([row[2] for row in self.rows(1)], ['13.3', '26.7'])
        self.assertEqual([row[2] for row in self.rows(2)], ['\u2013', '40.0', '80.0'])
        self.assertEqual(self.texts('#study-2 tr.best td:first-child'),
                         ['+ normal 0.95', '1 block of 16 passes', 'iteration 2'])

    def test_bars_are_shares_of_the_largest_filtered_error(self):
        widths = self.page.run('''[...document.querySelectorAll("#study-2 .bar-fill")].map((e) =>
            Math.round(100 * e.getBoundingClientRect().width / e.parentElement.getBoundingClientRect().width))''')
        self.assertEqual(widths, [100, 100, 50, 100, 50, 100, 100, 50])
        self.assertEqual(self.page.run('document.querySelectorAll("#study-2 .bar-fill.beyond").length'), 2)

    def test_metrics(self):
        self.choose('Metric', 'PSNR', '#study-2')
        self.assertEqual(self.rows(0)[2][1], '39.0')
        self.choose('Metric', 'FLIP', '#study-2')
        self.assertEqual(self.page.run('document.querySelectorAll("#study-2 tr.best").length'), 0)

    def test_pictures_have_the_labels(self):
        cards = self.texts('.sheet:last-child .card-name')
        self.assertEqual(cards[:3], ['reference', 'unfiltered, 16 passes', 'no weights'])
        self.assertEqual(cards[-3:], ['unfiltered, 1 pass', 'iteration 1', 'iteration 2'])
