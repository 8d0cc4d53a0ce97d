"""`kinebox run`: start the box, keep it running, end it.

One loop on the main thread, ten times a second: pass on what the processes say, bury and restart those that ended, kill those
that hang, and say on the bus how things stand. The policy is in `policy` and `silence`; here is what touches the system.
"""

import os
import select
import time
from collections.abc import Iterable
from pathlib import Path
from threading import Event

from models.camera.rig import Rig
from models.config.site import Site
from models.errors import USER_ERROR_CODE, UserError
from models.messages.health import State, SupervisorHealth
from models.messages.trouble import Trouble
from models.process import EDGE, EVALUATION, RECORDER, REPLAY, ROUTER, Check, Playback
from services.logs.files import STARTED, log_folder
from services.supervisor import page, start_order
from services.supervisor.bus_link import BusLink
from services.supervisor.child import Child, ChildSpec
from services.supervisor.journal import Journal
from services.supervisor.machine_watch import MachineWatch
from services.supervisor.post import Post, describe_exit
from services.supervisor.preflight import check_everything
from services.supervisor.silence import Silence
from services.supervisor.spares import KEPT_FOR, Spares
from services.support.called import called
from services.support.environment import process_environment
from services.support.machine import MachineMeter
from services.support.signals import stop_on_signals
from services.support.version import kinebox_version

TICK_S = 0.1
HELD_UP_S = 0.5
"""If a tick took longer than this, the supervisor itself was held up and nobody else is to blame."""
_LEVELS: dict[State, str] = {"starting": "info", "ok": "info", "degraded": "warning", "failed": "error"}
END_WITHIN_S = 5.0
"""Longer than an inference takes on a box under load: whoever can end cleanly shall."""


def supervise(site_file: Path, data: Path, checks: Iterable[Check], playback: Playback | None = None) -> None:
    """Run the box until SIGINT or SIGTERM, or until what is played is over.

    Args:
        site_file: the site file.
        data: folder with networks, footage and, from now on, logs.
        checks: what the parts want checked before anything is started.
        playback: a lesson to play in the place of fusion and the cameras.

    Raises:
        UserError: something is wrong with the site or what it needs; nothing was started.
    """
    stop = stop_on_signals()
    site, rig = check_everything(site_file, data, checks)
    replay = playback is not None
    command = f"{called()} logs{' --replay' if replay else ''}"
    journal = Journal(log_folder(data, replay=replay), config=site.logs, command=command)
    journal.note(STARTED, site=str(site_file.resolve()), version=kinebox_version())
    try:
        Supervisor(site_file, data, site, rig, journal, playback).run(stop)
    except UserError:
        raise
    except Exception as error:
        journal.broke(error)
        raise
    finally:
        journal.close()


def posts_of(site: Site, playback: Playback | None = None) -> list[Post]:
    """What has to run for a site, or for a replay in it; the router first, since all others wait for it."""
    if playback is not None:
        return [Post(ChildSpec(entry, playback=playback)) for entry in (REPLAY, "tablet", EVALUATION)]
    cameras = [ChildSpec(EDGE, camera.name) for camera in site.cameras]
    return [Post(spec) for spec in (ChildSpec(ROUTER), *cameras, *map(ChildSpec, ("tablet", EVALUATION, RECORDER)))]


class Supervisor:
    """The running box."""

    def __init__(
        self, site_file: Path, data: Path, site: Site, rig: Rig, journal: Journal, playback: Playback | None = None
    ) -> None:
        self._site_file = site_file
        self._data = data
        self._site = site
        self._journal = journal
        self._posts = posts_of(site, playback)
        self._first = start_order.first([post.spec for post in self._posts], rig)
        self._head_start = start_order.HeadStart(self._first, time.monotonic())
        self._name = site.name if playback is None else f"The replay of {playback.title or 'the lesson'}"
        self._environment = dict(os.environ) | process_environment(data)
        # Now, not later: a source begins with the picture that is due when it is ready, so waiting would gain nothing.
        self._start_ns = time.monotonic_ns()
        self._version = kinebox_version()
        self._silence = Silence(self._posts[0].name)
        self._spares = Spares(self._begin_spare, journal)
        self._machine = MachineWatch(MachineMeter(data))
        self._page_answers = False
        self._over = False

    def run(self, stop: Event) -> None:
        """Man every post until `stop` is set or what is played is over, then end all.

        Raises:
            UserError: what is played cannot be played on.
        """
        try:
            self._journal.say(f"starting {', '.join(post.name for post in self._posts)}")
            for post in self._posts:
                if post.name in self._first:
                    self._start(post)
                else:
                    post.waits = True
            link = BusLink(self._site.bus.endpoint)
            try:
                self._watch(stop, link)
            finally:
                link.close()
        finally:
            self._end_all()
        for post in self._posts:
            if post.given_up and post.spec.entry == REPLAY:
                raise UserError(post.given_up)

    def _watch(self, stop: Event, link: BusLink) -> None:
        before_s = time.monotonic()
        while not stop.is_set() and not self._over:
            self._wait(TICK_S)
            now_s = time.monotonic()
            held_up, before_s = now_s - before_s > HELD_UP_S, now_s
            self._stand_in(link, now_s)
            self._hear(link, now_s)
            self._start_others(link, now_s)
            if held_up:
                self._silence.restart_clocks(now_s)
            for post in self._posts:
                self._attend(post, now_s)
                if self._site.supervisor.spares and post.name in KEPT_FOR and post.child is not None:
                    self._spares.keep(post.spec, post.works_since_s, now_s)
            self._kill_hung(now_s)
            self._look_at_machine(now_s)
            self._journal.settle()
            self._speak(link)
            self._welcome()

    def _wait(self, timeout_s: float) -> None:
        """Until a process ends, at most `timeout_s`."""
        poller = select.poll()
        for post in self._posts:
            if post.child is not None:
                poller.register(post.child, select.POLLIN)
        poller.poll(timeout_s * 1e3)

    def _start(self, post: Post) -> None:
        now_s = time.monotonic()
        try:
            child = self._spares.take(post.name) or self._begin(post.spec, spare=False)
        except OSError as error:  # The machine is short of something: those that run go on.
            post.not_started(error, now_s, self._site.supervisor)
            self._tell(post)
            return
        post.manned_by(child)
        self._silence.start(post.name, now_s, ready=child.ready)

    def _start_others(self, link: BusLink, now_s: float) -> None:
        waiting = [post for post in self._posts if post.waits]
        if waiting and self._head_start.is_over(link.present, now_s):
            for post in waiting:
                post.waits = False
                self._start(post)

    def _begin(self, spec: ChildSpec, *, spare: bool) -> Child:
        command = spec.command(self._site_file, self._data, self._start_ns, spare=spare)
        return Child(command, self._environment, spec.niceness, waits=spare)

    def _begin_spare(self, spec: ChildSpec) -> Child:
        return self._begin(spec, spare=True)

    def _attend(self, post: Post, now_s: float) -> None:
        if post.child is not None:
            self._pass_on(post, post.child)
            if (code := post.child.poll()) is not None:
                self._bury(post, post.child, code, now_s)
        if post.child is None and post.start_at_s is not None and now_s >= post.start_at_s:
            self._start(post)

    def _bury(self, post: Post, child: Child, code: int, now_s: float) -> None:
        self._pass_on(post, child)
        child.close()
        self._silence.forget(post.name)
        if post.spec.entry == REPLAY and code == 0:
            post.child, self._over = None, True
            return
        post.ended(code, child.user_error, now_s, self._site.supervisor)
        self._tell(post)

    def _tell(self, post: Post) -> None:
        """Of a post that fell vacant: whether it will be manned again."""
        if post.given_up:
            self._journal.say(f"{post.name} is given up: {post.given_up}", level="error")
            self._over = self._over or post.spec.entry == REPLAY  # There is nothing else to see.
        else:
            self._journal.say(post.trouble, level="warning")

    def _pass_on(self, post: Post, child: Child) -> None:
        for line in child.lines():
            self._journal.child_said(post.name, line)

    def _stand_in(self, link: BusLink, now_s: float) -> None:
        """Once the router is given up, have everybody heard through us."""
        router = self._posts[0]
        if router.given_up:
            link.route()
            if link.routes:
                self._silence.hear(router.name, now_s)

    def _hear(self, link: BusLink, now_s: float) -> None:
        posts = {post.name: post for post in self._posts}
        for name, beat in link.beats():
            post = posts.get(name)
            if post is not None and post.child is not None and post.child.pid == beat.pid:
                (self._silence.last_beat if beat.last else self._silence.beat)(name, now_s)
        for health in link.heard():
            post = posts.get(health.process)
            # What an earlier process of that name said, or we on its behalf, is no sign of life.
            if post is None or post.child is None or post.child.pid != health.pid:
                continue
            if health.state == "starting":
                self._silence.get_ready(post.name, now_s)
            else:
                self._runs(post, now_s)
            if post.reports(health.state, (trouble.code for trouble in health.troubles), now_s):
                why = f": {health.reason}" if health.reason else ""
                self._journal.say(f"{post.name} is {health.state}{why}", level=_LEVELS[health.state])

    def _runs(self, post: Post, now_s: float) -> None:
        self._silence.hear(post.name, now_s)
        if post.trouble:
            post.trouble = ""
            self._journal.say(f"{post.name} runs again")

    def _kill_hung(self, now_s: float) -> None:
        silent = self._silence.hung(now_s)
        for post in self._posts:
            if post.child is None or post.hangs:
                continue
            if post.name in silent:
                self._end_hung(post, post.child, "nothing heard for too long")
            elif post.first_heard_s is None and post.child.stopped:
                # Its silence would be put down to its start for two minutes.
                self._end_hung(post, post.child, "a signal stopped it before it was heard")

    def _end_hung(self, post: Post, child: Child, why: str) -> None:
        self._journal.say(f"{post.name} hangs: {why}; ending it", level="warning")
        post.hangs = True
        child.kill()
        self._silence.forget(post.name)

    def _speak(self, link: BusLink) -> None:
        absent = {post.name: absence for post in self._posts if (absence := post.absence) is not None}
        restarting = (Trouble("restarting", post.trouble) for post in self._posts if post.trouble)
        log = (self._journal.trouble,) if self._journal.trouble is not None else ()
        restarts = tuple(restarts for post in self._posts if (restarts := post.restarts) is not None)
        own = SupervisorHealth(self._version, self._start_ns, restarts)
        link.say((*restarting, *self._machine.troubles, *log), absent, self._machine.newest, own)

    def _look_at_machine(self, now_s: float) -> None:
        for trouble in self._machine.look(now_s):
            self._journal.say(f"{trouble.words}; {trouble.remedy}", level="warning")

    def _welcome(self) -> None:
        if not self._page_answers and page.answers(self._site.tablet):
            self._page_answers = True
            self._journal.welcome(page.welcome(self._name, self._site.tablet))

    def _end_all(self) -> None:
        """SIGTERM to all, SIGKILL to those that still run `END_WITHIN_S` later; done as soon as all have ended."""
        self._journal.say("ending")
        self._spares.dismiss()
        children = {post.name: post.child for post in self._posts if post.child is not None}
        for child in children.values():
            child.ask_to_end()
        deadline_s = time.monotonic() + END_WITHIN_S
        while any(child.poll() is None for child in children.values()) and time.monotonic() < deadline_s:
            time.sleep(TICK_S / 5)
            for post in self._posts:
                if post.child is not None:
                    self._pass_on(post, post.child)
        for name, child in children.items():
            if child.poll() is None:
                self._journal.say(f"{name} did not end within {END_WITHIN_S:g} s and is killed", level="warning")
                child.kill()
        for post in self._posts:
            if post.child is not None:
                code = self._end(post, post.child)
                if code not in (0, USER_ERROR_CODE) and code > 0:
                    self._journal.say(f"{post.name} {describe_exit(code)} while ending", level="warning")
        self._journal.say("ended")

    def _end(self, post: Post, child: Child) -> int:
        code = child.wait()
        self._pass_on(post, child)
        child.close()
        post.child = None
        return code
