"""Requests to a ROS 1 master, with a timeout. The functions of rospy wait forever if a master hangs."""

from __future__ import annotations

import http.client
import xmlrpc.client
from typing import Any, NamedTuple
from urllib.parse import urlsplit
from xml.parsers.expat import ExpatError

TIMEOUT = 1.5
"""Seconds to wait for an answer."""


class MasterError(Exception):
    """A master, or a node that it lists, gave no valid answer. The text gives the reason to the user."""


class SystemState(NamedTuple):
    """The publishing nodes, the subscribing nodes and the type of each topic, by topic."""

    publishers: dict[str, list[str]]
    subscribers: dict[str, list[str]]
    types: dict[str, str]


class Master:
    """The master at a URI, and the nodes that it knows. Every method raises MasterError without a valid answer."""

    def __init__(self, uri: str) -> None:
        self.uri = uri

    def state(self) -> SystemState:
        """Return all publishers, subscribers and types."""
        # Types are requested last: a topic that appears in between has a type, but is not listed yet. Without its type,
        # the robot would get a publisher of another type. A subscriber of any type reports `*`.
        publishers, subscribers, _ = call(self.uri, "getSystemState")
        types = {name: kind for name, kind in call(self.uri, "getTopicTypes") if "/" in kind}
        return SystemState(dict(publishers), dict(subscribers), types)

    def register_subscriber(self, node: str, topic: str, kind: str, node_uri: str) -> None:
        """Register a subscriber with the master again, and send the list of publishers to the node."""
        publishers = call(self.uri, "registerSubscriber", topic, kind, node_uri, caller=node)
        call(node_uri, "publisherUpdate", topic, publishers, caller="/master")

    def register_publisher(self, node: str, topic: str, kind: str, node_uri: str) -> None:
        """Register a publisher with the master again."""
        call(self.uri, "registerPublisher", topic, kind, node_uri, caller=node)

    def unreachable(self, nodes: list[str]) -> str:
        """Return the reason why the first unreachable node among these cannot be reached, or empty if all can."""
        return next(filter(None, map(self._unreachable, nodes)), "")

    def has_ended(self, node: str) -> bool:
        """Return True if nothing listens at the address of a node any more. A silent node may still be alive."""
        try:
            call(call(self.uri, "lookupNode", node), "getPid")
        except MasterError as error:
            return isinstance(error.__cause__, ConnectionRefusedError)
        return False

    def _unreachable(self, node: str) -> str:
        try:
            uri = call(self.uri, "lookupNode", node)
        except MasterError:  # the node has just left, and the next state will not contain it
            return ""
        where = urlsplit(uri).netloc
        try:
            # Another program may use the port now, and rospy would wait forever for its answer.
            call(uri, "getPid")
        except MasterError as error:
            if isinstance(error.__cause__, ConnectionRefusedError):
                return f"its node {node} is not at {where} any more; rosnode cleanup makes the master forget it"
            return f"its node {node} cannot be reached at {where} ({error}); set ROS_IP where it runs"
        return ""


def master_of(node_uri: str) -> str:
    """Return the URI of a node's master."""
    return str(call(node_uri, "getMasterUri"))


class _Timed(xmlrpc.client.Transport):
    def make_connection(self, host: Any) -> http.client.HTTPConnection:
        connection = super().make_connection(host)
        connection.timeout = TIMEOUT
        return connection


def call(uri: str, method: str, *args: Any, caller: str = "/robowidgets") -> Any:
    """Return the answer of a master or a node to a call of a method."""
    try:
        with xmlrpc.client.ServerProxy(uri, _Timed()) as server:
            code, text, value = getattr(server, method)(caller, *args)
    except TimeoutError as error:
        raise MasterError(f"no answer within {TIMEOUT:g} s") from error
    except (OSError, xmlrpc.client.Error, http.client.HTTPException, ExpatError, TypeError, ValueError) as error:
        raise MasterError(str(error) or type(error).__name__) from error
    if code != 1:
        raise MasterError(f"{method}: {text}")
    return value
