"""URLs to show and to write: without passwords, signatures and tokens."""

from __future__ import annotations

import re
from collections.abc import Iterator
from hashlib import sha256
from urllib.parse import unquote_plus

_WEB = ("http", "https", "ws", "wss", "webhdfs")
_CONTAINERS = ("abfs", "abfss", "wasb", "wasbs", "az", "adl")
"""Schemes in which ``container@account`` names a place, not a user."""
_LINK = re.compile(r"([A-Za-z][A-Za-z0-9+.-]*)://([^/?#]*)(.*)", re.DOTALL)

_OBJECT = re.compile(
    r"(file|version|revision)?_?id|file(name)?|path|name|object|prefix|version|generation|rev|revision|ref|branch|format|"
    r"export|download|raw|dl|alt|part|page"
)
"""Query parameters that name an object. They are kept."""
_SECRET = re.compile(
    r"^(x-|q-)|sig|token|secret|passw|pwd|auth|cred|hmac|hdn|user|login|session|jwt|expir|policy|accesskey|accessid|"
    r"api_?key|key-?pair|keyname|^(se|sv|sr|st|sp|spr|sip|ss|srt|sks|ske|skt|skv|skoid|sktid|scid|pw|pass|pin|md5)$",
    re.IGNORECASE,
)
"""Query parameters that sign a request or log in. They are removed."""

_USER = re.compile(r"(?<=://)[^/\s?#]*@")
_QUERY = re.compile(r"(://[^\s'\"<>)?]*)\?\w[^\s'\"<>)]*|\?[^\s'\"<>)]*[=&%][^\s'\"<>)]*")


def without_secrets(url: str) -> str:
    """Return a URL without credentials. It still names the same object.

    A user and a password before the host are removed; on servers other than web servers, only the password. In the
    query of a web server, parameters that sign or log in are removed, parameters that name an object are kept, and the
    value of any other becomes a short digest. So two signatures of one object have the same name, and two objects have
    different names.

    Args:
        url: a URL, or a chain of URLs for fsspec (``zip://a.mcap::https://...``).
    """
    return "::".join(map(_public, url.split("::")))


def redacted(text: str) -> str:
    """Return a text, such as the error of a driver, without the queries and passwords of URLs in it."""
    return _USER.sub("", _QUERY.sub(lambda found: found[1] or "", text))


def _public(url: str) -> str:
    found = _LINK.fullmatch(url)
    if found is None:
        return url
    scheme, host, rest = found.groups()
    is_web = scheme.lower() in _WEB
    user, at, place = host.rpartition("@")
    if scheme.lower() in _CONTAINERS and ":" not in user:
        place = host
    elif at and not is_web and user.partition(":")[0]:
        place = f"{user.partition(':')[0]}@{place}"
    path, _, query = (rest.partition("#")[0] if is_web else rest).partition("?")
    if not is_web and "=" not in query:
        return f"{scheme}://{place}{rest}"  # part of a pattern or of a name
    kept = "&".join(_parameters(query))
    return f"{scheme}://{place}{path}{'?' if kept else ''}{kept}"


def _parameters(query: str) -> Iterator[str]:
    for item in query.split("&"):
        name, is_pair, value = item.partition("=")
        plain = unquote_plus(name).strip().lower()
        if not item or (is_pair and _SECRET.search(plain)):
            continue
        if _OBJECT.fullmatch(plain):
            yield item
        elif is_pair:
            yield f"{name}=~{_digest(value)}"
        else:
            yield f"~{_digest(name)}"


def _digest(text: str) -> str:
    return sha256(text.encode("utf-8", "backslashreplace")).hexdigest()[:6]
