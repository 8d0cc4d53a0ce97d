"""What a teacher saw of a fault: a figure that stood still in colour, which must not be, and for how long none was live."""

from playwright.sync_api import Page

# Notes when motion comes, and every 50 ms for how long the figure has been in colour without any, and for how long none was live.
_WATCH = """
window.watched = { motionMs: performance.now(), liveMs: performance.now(), stillMs: 0, awayMs: 0 };
window.WebSocket = class extends window.WebSocket {
    constructor(...of) {
        super(...of);
        this.addEventListener('message', ({ data }) => {
            if (typeof data !== 'string') window.watched.motionMs = performance.now();
        });
    }
};
setInterval(() => {
    const shown = document.querySelector('.page')?.dataset, watched = window.watched, nowMs = performance.now();
    if (!shown) return;
    if (shown.stage !== 'replay' && Number(shown.coloured) > 0)
        watched.stillMs = Math.max(watched.stillMs, nowMs - watched.motionMs);
    if (shown.phase === 'live' && (shown.stage === 'replay' || Number(shown.coloured) > 0)) watched.liveMs = nowMs;
    watched.awayMs = Math.max(watched.awayMs, nowMs - watched.liveMs);
}, 50);
"""


class PageWatch:
    """Watches a page that is yet to be opened."""

    def __init__(self, page: Page) -> None:
        self.page = page
        page.add_init_script(_WATCH)

    def begin(self) -> None:
        """Forget what was."""
        self.page.evaluate("() => Object.assign(window.watched, { stillMs: 0, awayMs: 0 })")

    @property
    def still_s(self) -> float:
        """The longest time for which the figure was in colour although no motion came."""
        return float(self.page.evaluate("() => window.watched.stillMs")) / 1e3

    @property
    def away_s(self) -> float:
        """The longest time for which the page showed no live figure: grey, or interrupted."""
        return float(self.page.evaluate("() => window.watched.awayMs")) / 1e3
