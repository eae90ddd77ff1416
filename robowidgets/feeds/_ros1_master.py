"""What a ROS 1 master knows, asked with a timeout: rospy's own calls wait for ever where a master hangs."""

from __future__ import annotations

import http.client
import socket
import xmlrpc.client
from typing import Any, NamedTuple
from urllib.parse import urlsplit
from xml.parsers.expat import ExpatError

SECONDS = 2.0
"""How long an answer may take."""


class MasterError(Exception):
    """A master, or a node that it names, that does not answer as it should; the text is for a person."""


class State(NamedTuple):
    """Who publishes what and who subscribes to it: names of topics to names of nodes, and to types."""

    publishers: dict[str, list[str]]
    subscribers: dict[str, list[str]]
    types: dict[str, str]


class Master:
    """The master at a URI, and the nodes that it knows. Every call raises MasterError when there is no good answer."""

    def __init__(self, uri: str) -> None:
        self.uri = uri

    def state(self) -> State:
        """Everything that is published and subscribed to now."""
        # A type is known as ROS 1 writes it; `*` is what somebody takes who takes anything. Types are asked for first:
        # a topic that appears meanwhile has none yet, and one that has a type is listed.
        types = {name: kind for name, kind in _call(self.uri, "getTopicTypes") if "/" in kind}
        publishers, subscribers, _ = _call(self.uri, "getSystemState")
        return State(dict(publishers), dict(subscribers), types)

    def register_subscriber(self, node: str, topic: str, kind: str, node_uri: str) -> None:
        """Tell the master once more that a node subscribes, and the node who publishes."""
        publishers = _call(self.uri, "registerSubscriber", topic, kind, node_uri, caller=node)
        _call(node_uri, "publisherUpdate", topic, publishers, caller="/master")

    def register_publisher(self, node: str, topic: str, kind: str, node_uri: str) -> None:
        """Tell the master once more that a node publishes."""
        _call(self.uri, "registerPublisher", topic, kind, node_uri, caller=node)

    def unreachable(self, nodes: list[str]) -> str:
        """Why the first of these nodes that cannot be reached from here cannot be; empty when all can."""
        return next(filter(None, map(self._unreachable, nodes)), "")

    def _unreachable(self, node: str) -> str:
        try:
            where = urlsplit(_call(self.uri, "lookupNode", node))
            socket.create_connection((where.hostname or "", where.port or 0), SECONDS).close()
        except MasterError:  # it has just left; the next state does without it
            return ""
        except ConnectionRefusedError:
            return f"its node {node} is not at {where.netloc} any more; rosnode cleanup makes the master forget it"
        except OSError as error:
            return f"its node {node} cannot be reached at {where.netloc} ({error}); set ROS_IP where it runs"
        return ""


class _Timed(xmlrpc.client.Transport):
    def make_connection(self, host: Any) -> http.client.HTTPConnection:
        connection = super().make_connection(host)
        connection.timeout = SECONDS
        return connection


def _call(uri: str, method: str, *args: Any, caller: str = "/robowidgets") -> Any:
    try:
        with xmlrpc.client.ServerProxy(uri, _Timed()) as server:
            code, words, value = getattr(server, method)(caller, *args)
    except TimeoutError:
        raise MasterError(f"no answer within {SECONDS:g} s") from None
    except (OSError, xmlrpc.client.Error, http.client.HTTPException, ExpatError, TypeError, ValueError) as error:
        raise MasterError(str(error) or type(error).__name__) from None
    if code != 1:
        raise MasterError(f"{method}: {words}")
    return value
