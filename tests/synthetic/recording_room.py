"""A room in which a recorder records: what fusion says, the clock and the disk are the test's own."""

from pathlib import Path

import pytest

from models.config.site import LessonsConfig
from models.messages.lesson import SegmentRequest
from models.messages.trouble import one_line
from services.lesson import recorder as module
from services.lesson.folder_lock import lock
from services.lesson.lesson_file import LessonWriter
from services.lesson.lesson_header import LessonHeader
from services.lesson.recorder import Recorder
from services.lesson.recovery import Left
from tests.synthetic.lesson import BEGIN_NS, SECOND_NS, header, part


class Room:
    """Also what the recorder says of itself."""

    def __init__(self, folder: Path, monkeypatch: pytest.MonkeyPatch, *, automatic: bool = False) -> None:
        self.now_ns = BEGIN_NS
        self.free_mb = 10_000.0
        self.folder = folder
        lock(folder).close()
        monkeypatch.setattr(module, "free_disk_mib", lambda _folder: self.free_mb * 1e6 / 2**20)
        self.left = Left(folder)
        self.recorder = self.started(automatic=automatic)

    def started(self, unfinished: LessonWriter | None = None, *, automatic: bool = False, run_ns: int | None = None) -> Recorder:
        """A recorder of the run of the box that lessons name, or of another one."""
        run_ns = header().run_ns if run_ns is None else run_ns
        config = LessonsConfig(automatic=automatic)
        return Recorder(self.folder, config, self._header, run_ns, self.left, unfinished, lambda: self.now_ns)

    def asks(self) -> SegmentRequest | None:
        """What fusion is asked for once the recorder has looked after its disk."""
        self.recorder.look_after()
        return self.recorder.request

    def record(self, parts: int) -> None:
        request = self.asks()
        assert request is not None
        for k in range(request.sequence, request.sequence + parts):
            self.now_ns += SECOND_NS // 2
            self.recorder.take(part(request.segment_ns or request.t_ns + 1, k))

    def fusion_begins_anew(self) -> None:
        segment_ns = self.now_ns + 1
        self.now_ns += SECOND_NS
        self.recorder.take(part(segment_ns, 0))

    def files(self, suffix: str) -> list[str]:
        return sorted(path.name for path in self.folder.iterdir() if path.name.endswith(suffix))

    @property
    def trouble(self) -> str:
        """The recorder's trouble as people read it."""
        trouble = self.recorder.trouble
        return "" if trouble is None else one_line((trouble,))

    @property
    def waiting(self) -> str:
        """What is said of lessons that wait to be finished."""
        trouble = self.left.trouble
        return "" if trouble is None else trouble.words

    def _header(self, title: str) -> LessonHeader:
        return header(title)
