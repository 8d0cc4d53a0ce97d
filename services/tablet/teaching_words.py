"""What is taught as the page needs it: the words of every action in all languages."""

import hashlib
from collections.abc import Mapping
from typing import get_args

from models.teaching.schema import Language, Text
from models.teaching.schema import Teaching as TaughtAction
from services.tablet.messages import ActionWords, FaultWords, MeasureWords, Teaching

_REVISION_LETTERS = 16


def words_of(teachings: Mapping[str, TaughtAction], language: Language) -> Teaching:
    """The words of all actions.

    Args:
        teachings: by the action's name.
        language: of the site; the first in the list.
    """
    others = (code for code in get_args(Language) if code != language)
    return Teaching(languages=[language, *others], actions={name: _action(one) for name, one in teachings.items()})


def revision(teaching: Teaching) -> str:
    """Differs where anything differs that is said, and is the same again for the same words, also after a restart."""
    return hashlib.sha256(teaching.model_dump_json().encode()).hexdigest()[:_REVISION_LETTERS]


def _action(taught: TaughtAction) -> ActionWords:
    return ActionWords(
        title=_words(taught.title),
        faults={fault.name: FaultWords(cue=_words(fault.cue), praise=_words(fault.praise)) for fault in taught.fault},
        measures={shown.name: MeasureWords(title=_words(shown.title), unit=shown.unit) for shown in taught.shown},
    )


def _words(text: Text) -> dict[str, str]:
    return {code: text.of(code) for code in get_args(Language)}
