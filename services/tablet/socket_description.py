"""The socket's messages in the OpenAPI description, which leaves sockets out, so that the page's types cover them."""

from typing import Any

from fastapi import FastAPI
from pydantic.json_schema import models_json_schema

from services.tablet.messages import Ack, Anew, AttemptList, Choose, Correction, Ping, Pong, Status, Turn


def describe_socket(app: FastAPI) -> None:
    """Add them to an application's description."""
    describe = app.openapi

    def openapi() -> dict[str, Any]:
        document = describe()
        modes: list[tuple[type[Any], Any]] = [
            (Status, "serialization"),
            (Pong, "serialization"),
            (AttemptList, "serialization"),
            (Ack, "validation"),
            (Choose, "validation"),
            (Turn, "validation"),
            (Correction, "validation"),
            (Anew, "validation"),
            (Ping, "validation"),
        ]
        _, definitions = models_json_schema(modes, ref_template="#/components/schemas/{model}")
        document.setdefault("components", {}).setdefault("schemas", {}).update(definitions["$defs"])
        return document

    app.openapi = openapi  # type: ignore[method-assign]  # FastAPI's documented way to extend the description
