"""What goes wrong on the way to a server or there, as exceptions."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator

import grpc
import grpc.aio

from .. import Error


class ServerError(Error):
    """An error of a server, or of the way to it. `code` is the name of a status; the text says what to do."""

    def __init__(self, code: str, message: str) -> None:
        super().__init__(message)
        self.code = code


def unavailable(address: str, reason: str) -> ServerError:
    return ServerError("UNAVAILABLE", f"no Pleat server answers at '{address}'; start one with `pleatd` or name "
                                      f"another ({reason})")


def another_version(address: str, reason: str) -> ServerError:
    return ServerError("UNIMPLEMENTED", f"the server at '{address}' does not have what this version of the package "
                                        f"asks for (pleat.v1): it is no Pleat server, or one of another version; "
                                        f"install the package of the server's release ({reason})")


@contextlib.contextmanager
def translated(address: str) -> Iterator[None]:
    """Raises ServerError for the errors of gRPC."""
    try:
        yield
    except grpc.RpcError as error:
        code, words = error.code(), error.details() or ""
        if code == grpc.StatusCode.UNIMPLEMENTED:
            raise another_version(address, words) from error
        if code == grpc.StatusCode.UNAVAILABLE and ("connect" in words or "resolution" in words):
            raise unavailable(address, words) from error
        if code == grpc.StatusCode.DEADLINE_EXCEEDED:
            words = f"the server at '{address}' did not answer in time: {words}; call again, or give more time"
        raise ServerError(code.name, words) from error
