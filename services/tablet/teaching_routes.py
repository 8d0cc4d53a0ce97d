"""What the page asks for over HTTP about attempts: the words, the list, and each one's slow replay."""

from collections.abc import Callable

from fastapi import APIRouter, HTTPException, Response

from services.tablet import attempt_replay
from services.tablet.attempts import Attempts
from services.tablet.messages import Attempt, Teaching


def routes(attempts: Attempts, teaching: Callable[[], Teaching]) -> APIRouter:
    """The routes, for `server.create_app`; `teaching` gives the words as they are now."""
    router = APIRouter(prefix="/api")

    @router.get("/teaching")
    async def read_teaching() -> Teaching:
        """What can be chosen, and what is said about it, in every language."""
        return teaching()

    @router.get("/attempts")
    async def read_attempts() -> list[Attempt]:
        """The newest attempts, the oldest of them first."""
        return attempts.shown

    @router.get(
        "/attempts/{attempt_id}/replay",
        response_class=Response,
        responses={
            200: {"content": {attempt_replay.MEDIA_TYPE: {"schema": {"type": "string", "format": "binary"}}}},
            404: {"description": "not kept (any more)"},
        },
    )
    async def read_replay(attempt_id: int) -> Response:
        """One attempt, frame by frame, in the binary layout of `services/tablet/attempt_replay.py`."""
        replay = attempts.replay(attempt_id)
        if replay is None:
            raise HTTPException(404, "no such attempt is kept")
        return Response(replay, media_type=attempt_replay.MEDIA_TYPE)

    return router
