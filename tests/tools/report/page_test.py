#!/usr/bin/env python3
"""Uses every control of psf report's page in a headless Chromium: page_test.py PSF PSF-REPORT-SAMPLE [TEST...]

Exits with 77 where there is no Chromium. With PSF_SCREENSHOTS=FOLDER it also leaves pictures of the page to look at.
"""
import sys
import unittest

import case
import chromium


def main():
    if chromium.find() is None:
        print('skipped: there is no chromium; tools/install --tests installs it')
        return 77
    tests = unittest.defaultTestLoader.loadTestsFromNames(sys.argv[3:] or ['studies', 'pictures', 'reach'])
    case.PageTest.start(*sys.argv[1:3])
    try:
        return 0 if unittest.TextTestRunner().run(tests).wasSuccessful() else 1
    finally:
        case.PageTest.stop()


if __name__ == '__main__':
    sys.exit(main())
