"""Writing the log on discs that fail, and reading it while it is written."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from services.logs.files import log_numbers, log_path
from services.logs.past import last_lines, wanted_lines
from services.logs.query import Query
from services.logs.reader import LogReader
from services.logs.record import encode
from services.logs.writer import IN_USE, LogWriter
from tests.installed import ROOT
from tests.integration.waiting import until
from tests.log_lines import NOON, numbered, numbers, raw_lines, whole_log

FULL_DISC = """
import resource, signal, sys
from pathlib import Path
from services.logs.writer import LogWriter
from tests.log_lines import numbered

def room(limit):
    resource.setrlimit(resource.RLIMIT_FSIZE, (limit, resource.RLIM_INFINITY))

writer = LogWriter(Path(sys.argv[1]), 10**6, 3)
for number in range(10):
    writer.write(numbered(number, 50))
room(2000)
for number in range(10, 40):
    writer.write(numbered(number, 50))
print(writer.problem)
room(resource.RLIM_INFINITY)
for number in range(40, 45):
    writer.write(numbered(number, 50))
print(writer.problem)
"""


def test_a_full_disc_costs_whole_lines_only_and_is_told_once_there_is_room(tmp_path: Path) -> None:
    result = subprocess.run([sys.executable, "-c", FULL_DISC, str(tmp_path)], cwd=ROOT, capture_output=True, text=True, check=True)
    problem, then = result.stdout.split("\n")[:2]
    assert problem in {"No space left on device", "File too large"}
    assert then == ""
    lines = raw_lines(tmp_path)
    kept = [line["number"] for line in lines if line["event"] == "counted"]
    (told,) = (line for line in lines if line["event"] != "counted")
    assert kept[:10] == list(range(10))
    assert kept[-5:] == list(range(40, 45))
    assert told["lines"] == 45 - len(kept) > 0
    assert [line["event"] for line in lines].index(told["event"]) == len(kept) - 5


def test_a_line_that_a_loss_of_power_cut_off_is_shown_as_damaged_and_the_next_is_whole(tmp_path: Path) -> None:
    whole, torn = encode(numbered(0)), encode(numbered(1))[:40]
    log_path(tmp_path, 4).write_bytes(whole + torn)
    writer = LogWriter(tmp_path, 10**6, 3)
    writer.write(numbered(2))
    writer.close()
    lines = whole_log(tmp_path)
    assert [line.raw for line in lines if line.record is None] == [torn]
    assert numbers(lines) == [0, 2]


def test_a_disc_that_was_mended_is_known_without_another_line(tmp_path: Path) -> None:
    folder = tmp_path / "logs"
    folder.write_text("a file where the folder should be")
    writer = LogWriter(folder, 10**6, 3)
    writer.write(numbered(0))
    writer.try_again(NOON)
    assert writer.problem == "File exists"
    folder.unlink()
    writer.try_again(NOON)
    assert writer.problem == ""
    writer.try_again(NOON)
    writer.close()
    (told,) = raw_lines(folder)
    assert (told["lines"], told["reason"]) == (1, "File exists")


def test_only_one_kinebox_writes_to_a_folder(tmp_path: Path) -> None:
    first, second = LogWriter(tmp_path, 10**6, 3), LogWriter(tmp_path, 10**6, 3)
    assert second.problem == IN_USE
    second.write(numbered(0))
    first.write(numbered(1))
    first.close()
    second.write(numbered(2))
    assert second.problem == ""
    second.close()
    assert numbers(whole_log(tmp_path)) == [1, 2]


def test_a_log_without_number_is_kept_as_the_oldest(tmp_path: Path) -> None:
    (tmp_path / "kinebox.log").write_bytes(encode(numbered(0)))
    writer = LogWriter(tmp_path, 10**6, 3)
    writer.write(numbered(1))
    writer.close()
    assert numbers(whole_log(tmp_path)) == [0, 1]
    assert (tmp_path / "kinebox.log").readlink() == Path("kinebox-000001.log")


def test_files_that_are_deleted_by_hand_do_not_end_the_log_nor_the_following(tmp_path: Path) -> None:
    writer, reader = LogWriter(tmp_path, 10**6, 3), LogReader(tmp_path)
    writer.write(numbered(0))
    assert numbers(list(reader.poll())) == [0]
    for file in tmp_path.iterdir():
        file.unlink()
    writer.write(numbered(1))
    assert numbers(list(reader.poll())) == [1]
    writer.close()


def test_whoever_follows_a_file_that_is_emptied_is_told_and_follows_on(tmp_path: Path) -> None:
    writer, reader = LogWriter(tmp_path, 10**6, 3), LogReader(tmp_path)
    for number in range(5):
        writer.write(numbered(number))
    assert numbers(list(reader.poll())) == list(range(5))
    os.truncate(tmp_path / "kinebox.log", 0)
    writer.write(numbered(5))
    told, line = reader.poll()
    assert told.record is None
    assert b"emptied" in told.raw
    assert (numbers([line]), line.number) == ([5], 1)
    writer.write(numbered(6))
    assert numbers(list(reader.poll())) == [6]
    writer.close()
    reader.close()


@pytest.mark.parametrize("ours", [1, 3])
@pytest.mark.parametrize("theirs", [1, 2])
def test_whoever_follows_a_log_that_was_deleted_and_begun_anew_is_told_and_follows_that(
    tmp_path: Path, ours: int, theirs: int
) -> None:
    folder = tmp_path / "logs"
    log_path(folder, ours).parent.mkdir()
    log_path(folder, ours).write_bytes(encode(numbered(0)))
    reader = LogReader(folder, ours)
    assert numbers(list(reader.poll())) == [0]
    shutil.rmtree(folder)
    assert list(reader.poll()) == []
    # A box that starts finds no log: it counts from 1.
    writer = LogWriter(folder, 1000, 10)
    count = 0
    while log_numbers(folder)[-1] < theirs:
        count += 1
        writer.write(numbered(count))
    count += 1
    writer.write(numbered(count))
    told, *lines = reader.poll()
    assert told.record is None
    assert b"deleted" in told.raw
    assert numbers(lines) == list(range(1, count + 1))
    writer.write(numbered(count + 1))
    assert numbers(list(reader.poll())) == [count + 1]
    writer.close()
    reader.close()


def test_nothing_is_told_twice_because_the_newest_file_was_deleted(tmp_path: Path) -> None:
    writer, reader = LogWriter(tmp_path, 1000, 10), LogReader(tmp_path)
    for number in range(20):
        writer.write(numbered(number))
    followed = numbers(list(reader.poll()))
    *older, newest = log_numbers(tmp_path)
    for file in older:
        os.utime(log_path(tmp_path, file), (0, 0))
    log_path(tmp_path, newest).unlink()
    followed += numbers(list(reader.poll()))
    writer.write(numbered(20))
    followed += numbers(list(reader.poll()))
    assert followed == list(range(21))
    writer.close()
    reader.close()


def test_a_smaller_bound_is_kept_from_the_next_start_on(tmp_path: Path) -> None:
    writer = LogWriter(tmp_path, 1000, 10)
    for number in range(90):
        writer.write(numbered(number))
    writer.close()
    assert len(log_numbers(tmp_path)) == 10
    writer = LogWriter(tmp_path, 1000, 2)
    writer.close()
    assert len(log_numbers(tmp_path)) == 2
    assert numbers(whole_log(tmp_path))[-1] == 89


def test_a_reader_that_is_overtaken_says_what_it_missed(tmp_path: Path) -> None:
    writer, reader = LogWriter(tmp_path, 1000, 2), LogReader(tmp_path)
    writer.write(numbered(0))
    assert numbers(list(reader.poll())) == [0]
    for number in range(1, 100):
        writer.write(numbered(number))
    writer.close()
    lines = list(reader.poll())
    (gap,) = (line for line in lines if line.record is None)
    missed = int(gap.raw.split()[0])
    assert missed == log_numbers(tmp_path)[0] - 2
    assert gap.raw.endswith(b"files were deleted before they could be read")
    assert numbers(lines)[-1] == 99


def test_old_files_are_not_read_for_what_is_newer(tmp_path: Path) -> None:
    writer = LogWriter(tmp_path, 1000, 100)
    for number in range(50):
        writer.write(numbered(number))
    writer.close()
    *old, newer, newest = log_numbers(tmp_path)
    # Were one of them read, it would not go unseen.
    for file in old:
        log_path(tmp_path, file).write_bytes(b"damaged\n")
        os.utime(log_path(tmp_path, file), (0, 0))
    lines, _ = last_lines(tmp_path, Query(since=NOON), 1000, torn=True)
    assert {line.file for line in lines} == {log_path(tmp_path, number).name for number in (newer, newest)}
    assert all(line.record is not None for line in wanted_lines(tmp_path, Query(since=NOON)))
    assert sum(line.record is None for line in wanted_lines(tmp_path, Query())) == len(old)


def test_a_part_of_a_line_is_not_read_before_the_whole_is_there(tmp_path: Path) -> None:
    reader, line = LogReader(tmp_path), encode(numbered(7))
    with log_path(tmp_path, 1).open("wb", buffering=0) as file:
        for place in range(0, len(line) - 1, 20):
            file.write(line[place : min(place + 20, len(line) - 1)])
            assert list(reader.poll()) == []
        file.write(b"\n")
        assert numbers(list(reader.poll())) == [7]
        assert list(reader.poll()) == []


WRITES_ON = """
import sys
from pathlib import Path
from services.logs.writer import LogWriter
from tests.log_lines import numbered

writer = LogWriter(Path(sys.argv[1]), 20_000, 10_000)
number = int(sys.argv[2])
while True:
    writer.write(numbered(number, number * 37 % 900))
    assert not writer.problem
    print(number, flush=True)
    number += 1
"""


@pytest.mark.slow
def test_following_over_new_files_and_killed_writers_loses_and_doubles_nothing(tmp_path: Path) -> None:
    folder, said = tmp_path / "logs", tmp_path / "said"
    reader = LogReader(folder)
    followed: list[int] = []
    first = 0
    for round_ in range(8):
        with said.open("wb") as output:
            process = subprocess.Popen([sys.executable, "-c", WRITES_ON, str(folder), str(first)], cwd=ROOT, stdout=output)
        try:
            enough = len(followed) + 400 + 97 * round_

            def has_followed(enough: int = enough) -> bool:
                followed.extend(numbers(list(reader.poll())))
                return len(followed) >= enough

            until(has_followed, f"{enough} lines")
        finally:
            process.kill()
            process.wait()
        followed.extend(numbers(list(reader.poll())))
        told = [int(line) for line in said.read_bytes().split(b"\n")[:-1]]
        # What was written but not told any more is in the log, too: at most one line.
        assert followed[first:] == list(range(first, first + len(followed) - first))
        assert 0 <= followed[-1] - told[-1] <= 1
        first = followed[-1] + 1
    assert len(log_numbers(folder)) > 10
    # A writer that is killed while it writes may leave half a line, which it has told nobody of.
    assert [line["number"] for line in raw_lines(folder, torn=True)] == followed == list(range(first))


def test_the_follower_of_a_log_that_does_not_exist_yet_sees_its_first_line(tmp_path: Path) -> None:
    reader = LogReader(tmp_path / "logs")
    assert list(reader.poll()) == []
    writer = LogWriter(tmp_path / "logs", 10**6, 2)
    writer.write(numbered(0))
    assert numbers(list(reader.poll())) == [0]
    writer.close()
