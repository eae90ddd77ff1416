"""Errors of the drivers of file systems, as errors for users. Each driver has different ones."""

from __future__ import annotations

import re
from collections.abc import Callable
from contextlib import suppress
from typing import Any, NoReturn

from ..messages.decoding import one_line
from ..repair import RecordingError, RemoteError
from ..runtime.urls import redacted

_WEB = re.compile(r"(.*::)?https?://", re.IGNORECASE)
_EXPIRED = re.compile(r"expired", re.IGNORECASE)
_CREDENTIALS = (
    "give credentials as its driver takes them (for s3: ~/.aws/credentials or AWS_ACCESS_KEY_ID and "
    "AWS_SECRET_ACCESS_KEY; FSSPEC_S3_ANON=true for what is public)"
)
_SIGNATURE = "give its whole URL, with credentials or a valid signature: URLs are stored and shown without them"
_NO_CREDENTIALS = (
    "NoCredentialsError",
    "PartialCredentialsError",
    "DefaultCredentialsError",
    "ClientAuthenticationError",
)


def asked(ask: Callable[[], Any], shown: str) -> Any:
    """Return the result of a function that calls a driver; raise its errors as `fail` does."""
    try:
        return ask()
    except Exception as error:
        fail(error, shown)


def fail(error: Exception, shown: str, when: str = "", *, is_open: bool = False) -> NoReturn:
    """Raise the error of a driver as an error for users.

    Args:
        error: the error of the driver.
        shown: the URL without secrets.
        when: the place at which reading failed, after a space, or empty.
        is_open: True if parts of the file were read before.

    Raises:
        RecordingError: always; RemoteError if ``is_open``.
    """
    causes: list[BaseException] = [error]
    while (cause := causes[-1].__cause__) is not None and cause not in causes:
        causes.append(cause)
    codes = {code for cause in causes if (code := status_of(cause)) is not None}
    text = redacted(one_line(causes[-1] if isinstance(causes[-1], Exception) else error))
    kinds = {type(cause).__name__ for cause in causes}
    remedy = _SIGNATURE if _WEB.match(shown) else _CREDENTIALS
    is_refused = any(isinstance(cause, PermissionError) for cause in causes) or codes & {401, 403}
    if any(_EXPIRED.search(str(cause)) for cause in causes) or (is_refused and is_open):
        has = "have expired" if not is_open else "have expired since it was opened, or were withdrawn"
        text = f"its credentials {has} ({text}): {remedy}"
    elif is_refused or kinds & {*_NO_CREDENTIALS}:
        text = f"no permission to read it ({text}): {remedy}"
    elif codes & {404, 410} or (isinstance(error, FileNotFoundError) and len(causes) == 1):
        text = "it does not exist any more" if is_open else "no such object, nor a folder with any"
    else:
        text = f"cannot be read{when}: {type(causes[-1]).__name__}: {text}"
    raise (RemoteError if is_open else RecordingError)(f"{shown}: {text}") from None


def status_of(error: BaseException) -> int | None:
    """Return the HTTP status in an error of a driver, or None."""
    with suppress(Exception):
        code = getattr(error, "status", None) or error.response["ResponseMetadata"]["HTTPStatusCode"]  # type: ignore[attr-defined]
        return int(code)
    return None
