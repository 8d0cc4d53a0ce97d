"""What is taught at a site, as its page shows it: read at the start, and again until every file of it can be read."""

from pathlib import Path

from models.config.site import EvaluationConfig
from models.messages.trouble import Trouble
from services.support.teaching_files import load_words
from services.tablet.teaching_words import words_of

AGAIN_AFTER_S = 30.0
"""As long as the supervisor waits at most before it tries again what a person must mend."""


class Taught:
    """The words, and what is wrong with their files. Figure, pupils and the recording's sign wait for no word.

    Args:
        data: the data folder.
        config: of the site.

    Attributes:
        words: of all actions; KineBox's own in the place of those that cannot be read.
        troubles: one for each file that cannot.
    """

    def __init__(self, data: Path, config: EvaluationConfig) -> None:
        self._data = data
        self._config = config
        self.read()

    def read(self) -> None:
        """Read all, as it is now."""
        teachings, damaged = load_words(self._data, self._config.teaching)
        self.words = words_of(teachings, self._config.language)
        self.troubles = tuple(Trouble("words_unreadable", f"the page has KineBox's own words: {line}") for line in damaged)
