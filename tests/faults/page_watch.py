"""Whether a page ever showed in colour a figure that had stood still: what a teacher must not take for what the pupil does."""

from playwright.sync_api import Page

# Notes when motion comes, and every 50 ms how long the live figure has been in colour without any.
_WATCH = """
window.watched = { motionMs: performance.now(), stillMs: 0, greyed: false };
window.WebSocket = class extends window.WebSocket {
    constructor(...of) {
        super(...of);
        this.addEventListener('message', ({ data }) => {
            if (typeof data !== 'string') window.watched.motionMs = performance.now();
        });
    }
};
setInterval(() => {
    const shown = document.querySelector('.page')?.dataset, watched = window.watched;
    if (!shown || shown.stage === 'replay') return;
    if (Number(shown.coloured) === 0) watched.greyed = true;
    else watched.stillMs = Math.max(watched.stillMs, performance.now() - watched.motionMs);
}, 50);
"""


class PageWatch:
    """Watches a page that is yet to be opened."""

    def __init__(self, page: Page) -> None:
        self._page = page
        page.add_init_script(_WATCH)

    def begin(self) -> None:
        """Forget what was."""
        self._page.evaluate("() => Object.assign(window.watched, { stillMs: 0, greyed: false })")

    @property
    def still_s(self) -> float:
        """The longest time for which the figure was in colour although no motion came."""
        return float(self._page.evaluate("() => window.watched.stillMs")) / 1e3

    @property
    def greyed(self) -> bool:
        """Whether the figure was grey at any time."""
        return bool(self._page.evaluate("() => window.watched.greyed"))
