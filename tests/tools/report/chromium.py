"""Drives a headless Chromium over its debugging pipe, with nothing but Python's standard library."""
import base64
import fcntl
import json
import os
import select
import shutil
import signal
import subprocess
import tempfile
import time

PATIENCE = 600  # seconds for an answer; a busy machine is slow
KEY_CODES = {'ArrowLeft': 37, 'ArrowUp': 38, 'ArrowRight': 39, 'ArrowDown': 40, 'Enter': 13, 'Tab': 9, ' ': 32,
             'Escape': 27}


def find():
    """The browser's path, or None."""
    return shutil.which('chromium') or shutil.which('chromium-browser')


def _pipe_apart():
    """The two ends of a pipe, apart from 3 and 4: the browser wants to be given those."""
    ends = os.pipe()
    try:
        return [fcntl.fcntl(end, fcntl.F_DUPFD_CLOEXEC, 10) for end in ends]
    finally:
        for end in ends:
            os.close(end)


class Chromium:
    """One page. Everything that the console says, and every request but the page itself, is kept."""

    def __init__(self, width=1400, height=900):
        self.profile = tempfile.mkdtemp(prefix='psf-chromium-')
        to_browser, self.write_end = _pipe_apart()
        self.read_end, from_browser = _pipe_apart()
        flags = ['--headless', '--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run', '--disable-sync',
                 '--disable-background-networking', '--disable-component-update', '--disable-dev-shm-usage',
                 '--force-device-scale-factor=1', '--hide-scrollbars', '--remote-debugging-pipe',
                 f'--window-size={width},{height}', f'--user-data-dir={self.profile}', 'about:blank']
        self.process = subprocess.Popen(
            ['bash', '-c', f'exec "$@" 3<&{to_browser} 4>&{from_browser}', 'bash', find(), *flags],
            pass_fds=(to_browser, from_browser), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
            stdin=subprocess.DEVNULL, start_new_session=True, env={**os.environ, 'HOME': self.profile})
        os.close(to_browser)
        os.close(from_browser)
        self.buffer, self.count, self.session = b'', 0, None
        self.console, self.requests, self.loaded = [], [], 0
        targets = self.call('Target.getTargets')['targetInfos']
        page = next(target for target in targets if target['type'] == 'page')
        self.session = self.call('Target.attachToTarget', targetId=page['targetId'], flatten=True)['sessionId']
        for domain in ('Page', 'Runtime', 'Log', 'Network'):
            self.call(domain + '.enable')
        self.resize(width, height)

    def close(self):
        """Ends the browser, all its processes and its profile."""
        os.close(self.write_end)
        try:
            self.process.wait(10)
        except subprocess.TimeoutExpired:
            os.killpg(self.process.pid, signal.SIGKILL)
            self.process.wait()
        os.close(self.read_end)
        shutil.rmtree(self.profile, ignore_errors=True)

    def call(self, method, **parameters):
        """Sends a command and returns its result; events that come before are noted."""
        self.count += 1
        number = self.count
        message = {'id': number, 'method': method, 'params': parameters}
        if self.session:
            message['sessionId'] = self.session
        data = json.dumps(message).encode() + b'\0'
        while data:
            data = data[os.write(self.write_end, data):]
        while True:
            answer = self._receive(method)
            if answer.get('id') != number:
                self._note(answer)
                continue
            if 'error' in answer:
                raise RuntimeError(f'{method}: {answer["error"]["message"]}')
            return answer['result']

    def _receive(self, waiting_for):
        end = time.monotonic() + PATIENCE
        while b'\0' not in self.buffer:
            ready, _, _ = select.select([self.read_end], [], [], max(0, end - time.monotonic()))
            data = os.read(self.read_end, 1 << 20) if ready else b''
            if not data:
                raise RuntimeError(f'{waiting_for}: Chromium gave no answer')
            self.buffer += data
        message, self.buffer = self.buffer.split(b'\0', 1)
        return json.loads(message)

    def _note(self, event):
        method, parameters = event.get('method'), event.get('params', {})
        if method == 'Runtime.consoleAPICalled':
            self.console.append(f'{parameters["type"]}: {[arg.get("value") for arg in parameters["args"]]}')
        elif method == 'Runtime.exceptionThrown':
            self.console.append('exception: ' + json.dumps(parameters['exceptionDetails'])[:600])
        elif method == 'Log.entryAdded':
            self.console.append(f'{parameters["entry"]["level"]}: {parameters["entry"]["text"]}')
        elif method == 'Network.requestWillBeSent':
            self.requests.append(parameters['request']['url'])
        elif method == 'Page.loadEventFired':
            self.loaded += 1

    def resize(self, width, height):
        self.call('Emulation.setDeviceMetricsOverride', width=width, height=height, deviceScaleFactor=1, mobile=False)

    def prefer(self, scheme):
        """'dark' or 'light', as the system would say."""
        self.call('Emulation.setEmulatedMedia', features=[{'name': 'prefers-color-scheme', 'value': scheme}])

    def download_to(self, folder):
        self.call('Page.setDownloadBehavior', behavior='allow', downloadPath=folder)

    def open(self, url):
        before = self.loaded
        self.call('Page.navigate', url=url)
        while self.loaded == before:
            self._note(self._receive('Page.navigate'))

    def run(self, expression):
        """The value of a JavaScript expression; waits for promises."""
        result = self.call('Runtime.evaluate', expression=expression, returnByValue=True, awaitPromise=True)
        if 'exceptionDetails' in result:
            details = result['exceptionDetails']
            raise RuntimeError(f'{expression}: {details.get("exception", {}).get("description", details["text"])}')
        return result['result'].get('value')

    def wait(self, expression, seconds=PATIENCE):
        """Until the expression is true."""
        end = time.monotonic() + seconds
        while not self.run(expression):
            if time.monotonic() > end:
                raise AssertionError(f'never came true: {expression}')
            time.sleep(0.02)

    def mouse(self, kind, x, y, buttons=0, **more):
        """kind: moved, pressed, released, wheel."""
        button = 'left' if buttons or kind == 'released' else 'none'
        self.call('Input.dispatchMouseEvent', type='mouse' + kind.capitalize(), x=x, y=y, button=button,
                  buttons=buttons, clickCount=1 if kind in ('pressed', 'released') else 0, **more)

    def click(self, x, y):
        self.mouse('moved', x, y)
        self.mouse('pressed', x, y, 1)
        self.mouse('released', x, y)

    def key(self, key, shift=False, down=True, up=True):
        event = {'key': key, 'code': 'Space' if key == ' ' else key, 'modifiers': 8 if shift else 0,
                 'windowsVirtualKeyCode': KEY_CODES.get(key, ord(key[0].upper()))}
        text = {'Enter': '\r'}.get(key, key if len(key) == 1 else '')
        if down:
            self.call('Input.dispatchKeyEvent', type='keyDown', text=text, **event)
        if up:
            self.call('Input.dispatchKeyEvent', type='keyUp', **event)

    def screenshot(self, path, whole=False):
        data = self.call('Page.captureScreenshot', format='png', captureBeyondViewport=whole)['data']
        with open(path, 'wb') as out:
            out.write(base64.b64decode(data))
