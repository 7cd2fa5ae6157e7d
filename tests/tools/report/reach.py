"""What holds of the whole page: themes, contrast, the keyboard, narrow windows."""
import os

from case import PageTest



CONTRAST = '''(() => {
  const channel = (v) => v <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4;
  const parse = (c) => c.match(/[\\d.]+/g).map(Number);
  const light = (c) => d3.zip([0.2126, 0.7152, 0.0722], c).reduce((sum, [w, v]) => sum + w * channel(v / 255), 0);
  const under = (e) => {
    for (; e; e = e.parentElement) {
      const c = getComputedStyle(e).backgroundColor;
      if (c.startsWith('rgb(')) return parse(c);
    }
    return [255, 255, 255];
  };
  const worst = [];
  for (const e of document.querySelectorAll('main *, header *, footer *')) {
    const own = [...e.childNodes].some((n) => n.nodeType === 3 && n.textContent.trim());
    if (!own || !e.getClientRects().length || e.closest(':disabled, .tag, svg, option, .rows tr.best')) continue;
    const a = light(parse(getComputedStyle(e).color)), b = light(under(e));
    const contrast = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
    if (contrast < 4.5) worst.push(`${e.tagName}.${e.className} ${e.textContent.slice(0, 30)} ${contrast.toFixed(2)}`);
  }
  return worst;
})()'''

FOCUSABLE = '''[...document.querySelectorAll('a[href], button, select, input, summary, [tabindex="0"]')].filter(
    (e) => e.getClientRects().length && !e.disabled)'''


class Reach(PageTest):
    def test_themes(self):
        theme = 'document.documentElement.dataset.theme'
        self.assertEqual(self.page.run(theme), 'light')
        light = self.page.run('getComputedStyle(document.body).backgroundColor')
        self.assertEqual(self.page.run(CONTRAST), [])
        self.page.prefer('dark')
        self.page.wait(theme + ' === "dark"')
        self.assertNotEqual(self.page.run('getComputedStyle(document.body).backgroundColor'), light)
        self.assertEqual(self.page.run(CONTRAST), [])
        self.click('#theme')
        self.assertEqual(self.page.run(theme), 'light')
        self.click('#theme')
        self.assertEqual(self.page.run(theme), 'dark')

    def test_tab_reaches_everything_and_shows_where_it_is(self):
        self.page.run('document.querySelectorAll("details").forEach((e) => e.open = true)')
        self.page.run(f'{FOCUSABLE}.forEach((e, k) => e.dataset.order = k); document.activeElement.blur()')
        count = self.page.run(f'{FOCUSABLE}.length')
        self.assertGreater(count, 60)
        reached = set()
        for _ in range(count + 3):
            self.page.key('Tab')
            at = self.page.run('[document.activeElement.dataset.order, document.activeElement.outerHTML.slice(0, 80), '
                          'getComputedStyle(document.activeElement).outlineStyle]')
            if at[0] is not None:
                reached.add(int(at[0]))
                self.assertNotEqual(at[2], 'none', at[1])
        self.assertEqual(sorted(set(range(count)) - reached), [])

    def test_everything_has_a_name(self):
        nameless = self.page.run(f'''{FOCUSABLE}.filter((e) => !(e.textContent.trim() || e.getAttribute('aria-label') ||
            (e.id && document.querySelector(`label[for="${{e.id}}"]`)))).map((e) => e.outerHTML.slice(0, 80))''')
        self.assertEqual(nameless, [])

    def test_nothing_is_wider_than_the_window(self):
        for width in (1400, 800, 420):
            self.page.resize(width, 900)
            self.page.run('new Promise((done) => setTimeout(done, 200))')
            self.assertLessEqual(self.page.run('document.documentElement.scrollWidth'), width)
            for theme in ('light', 'dark'):
                self.page.prefer(theme)
                if 'PSF_SCREENSHOTS' in os.environ:
                    self.page.screenshot(f'{os.environ["PSF_SCREENSHOTS"]}/{width}-{theme}.png', whole=True)
