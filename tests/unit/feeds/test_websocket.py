from __future__ import annotations

import asyncio
import itertools
import json
import os
import socket
import threading
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import pytest

from robowidgets import DriveWidget, feeds
from robowidgets.feeds import Feed, FeedError, _websocket
from robowidgets.feeds.foxglove import Foxglove
from robowidgets.feeds.middleware import CLOSE_TIMEOUT, SEND_TIMEOUT
from robowidgets.runtime.clock import RealClock

from ..clocks import ManualClock
from ..waiting import wait_for
from .ears import Ears
from .fox import OldFoxglove, cdr, channel
from .servers import Server

# A connection behaves the same with every protocol: here it is foxglove.

TICK = 1 / 1024
"""Seconds, for times that add without rounding."""

TWIST = "geometry_msgs/msg/Twist"
TAKES: dict[str, Any] = {"capabilities": ["clientPublish"], "supportedEncodings": ["json"]}
"""The greeting of a server that takes messages."""


@pytest.fixture
def ears() -> Ears:
    return Ears()


@pytest.fixture
def clock() -> ManualClock:
    return ManualClock()


def close(middleware: Foxglove, clock: ManualClock) -> None:
    """Close a connection while time passes."""
    closing = clock.beside(middleware.close)
    clock.advance(CLOSE_TIMEOUT)
    closing.join()


@pytest.fixture
def scanning(ears: Ears) -> Iterator[tuple[OldFoxglove, Foxglove]]:
    with OldFoxglove([channel(1)]) as server:
        middleware = Foxglove(server.address)
        middleware.follow(frozenset({"/scan"}))  # before it is opened is as good as after
        middleware.open(ears)
        wait_for(lambda: server.subscribed, "it subscribed")
        yield server, middleware
        middleware.close()


class Raw:
    """A listening socket that passes each connection to a function in its own thread."""

    def __init__(self, answer: Callable[[socket.socket], object]) -> None:
        self._listening = socket.create_server(("127.0.0.1", 0))
        self.address = f"ws://127.0.0.1:{self._listening.getsockname()[1]}"
        self._answer = answer
        self._taken: list[socket.socket] = []
        threading.Thread(target=self._serve, daemon=True).start()

    def __enter__(self) -> Raw:
        return self

    def __exit__(self, *_: object) -> None:
        self._listening.close()
        for taken in self._taken:
            taken.close()

    def _serve(self) -> None:
        while True:
            try:
                taken, _ = self._listening.accept()
            except OSError:
                return
            self._taken.append(taken)
            try:
                self._answer(taken)
            except OSError:
                continue


@pytest.mark.parametrize("address", ["robot", "http://robot:8765", "ws://", "ws://robot:x", " ws://robot", "ws://a\nb"])
def test_an_invalid_address_is_refused_with_a_valid_one(address: str) -> None:
    words = r"address: expected one like ws://192.168.1.5:8765 \(wss:// for an encrypted one\), got "
    with pytest.raises(ValueError, match=words):
        Foxglove(address)


def test_an_address_that_is_not_a_text_is_refused() -> None:
    with pytest.raises(TypeError, match=r"address: expected one like ws://192.168.1.5:8765, got 8765"):
        Foxglove(8765)  # type: ignore[arg-type]


def test_without_tornado_opening_says_what_to_install(monkeypatch: pytest.MonkeyPatch, ears: Ears) -> None:
    monkeypatch.setitem(__import__("sys").modules, "tornado.websocket", None)
    with pytest.raises(FeedError, match="websockets need the package tornado, which is not installed: pip install"):
        Foxglove().open(ears)


def test_an_unanswered_attempt_shows_what_to_compare_while_it_goes_on(ears: Ears, clock: ManualClock) -> None:
    with Raw(lambda taken: taken.recv(1)) as silent:
        middleware = Foxglove(silent.address, clock)
        middleware.open(ears)
        clock.advance(1.5 - TICK)
        assert ears.nobody == ""
        clock.advance(TICK)
        words = "is the robot on, and in this network? Is the address right? Does a firewall block the port?"
        assert ears.nobody == f"no answer from {silent.address} yet: {words}"
        assert ears.lost == []
        clock.advance(3.5)
        assert ears.lost == [f"no answer from {silent.address} within 5 s: {words}"]
        ears.nobody = ""
        clock.advance(5.5)
        assert len(ears.lost) == 2
        assert ears.nobody == "", "the reason of the first one is on show meanwhile"
        close(middleware, clock)


def test_a_connection_that_is_cut_is_made_again_and_what_was_asked_for_comes(
    scanning: tuple[OldFoxglove, Foxglove], ears: Ears
) -> None:
    server, _ = scanning
    server.subscribed = {}
    server.drop()
    wait_for(lambda: server.subscribed, "it subscribed again")
    server.log(1, cdr())
    wait_for(lambda: ears.messages, "a message came")
    assert ears.lost == ["the connection ended"]
    assert ears.connected == 2


def test_the_farewell_of_a_robot_is_quoted(scanning: tuple[OldFoxglove, Foxglove], ears: Ears) -> None:
    server, _ = scanning
    server.loop.call_soon_threadsafe(lambda: server.clients[0].close(1001, "battery\nlow"))
    wait_for(lambda: ears.lost, "it was lost")
    assert ears.lost == ["the connection ended: battery low"]


def test_a_robot_that_falls_silent_is_given_up_after_ten_seconds(ears: Ears, clock: ManualClock) -> None:
    with OldFoxglove([channel(1)]) as server:
        middleware = Foxglove(server.address, clock)
        middleware.open(ears)
        # The topics come before the first ping.
        wait_for(lambda: ears.topics and server.pings and not _unanswered(middleware), "it is connected, and answered")
        go_on = server.stall()
        clock.advance(1.0)  # until it is asked again
        clock.advance(10.0 - TICK)
        assert ears.lost == []
        clock.advance(TICK)
        assert ears.lost == ["the robot did not answer for 10 s"]
        go_on()
        clock.advance(0.5)
        wait_for(lambda: ears.connected == 2, "it is back")
        close(middleware, clock)


def test_a_robot_that_answers_but_says_nothing_is_not_given_up(ears: Ears, clock: ManualClock) -> None:
    with OldFoxglove([]) as server:
        middleware = Foxglove(server.address, clock)
        middleware.open(ears)
        for count in range(1, 22):
            # The server counts a ping after it has answered it.
            wait_for(lambda: len(server.pings) >= count and not _unanswered(middleware), "it answered")  # noqa: B023
            clock.advance(1.0)
        wait_for(lambda: not _unanswered(middleware), "it answered")
        assert len(server.pings) <= 22, "one a second"
        close(middleware, clock)
    assert ears.lost == []


@pytest.fixture
def taking(ears: Ears, clock: ManualClock) -> Iterator[tuple[OldFoxglove, Foxglove]]:
    """A server that takes messages, and a connection to it that has answered its first ping."""
    with OldFoxglove([channel(1)], **TAKES) as server:
        middleware = Foxglove(server.address, clock)
        middleware.open(ears)
        # The topics come before the first ping.
        wait_for(lambda: ears.topics and server.pings and not _unanswered(middleware), "it is connected, and answered")
        yield server, middleware
        close(middleware, clock)


def late(middleware: Foxglove, clock: ManualClock, fields: dict[str, Any]) -> Exception | None:
    """Return the error of a message that is published, but not taken or answered until `SEND_TIMEOUT` has passed.

    None if it was taken at once.
    """
    errors: list[Exception] = []

    def publish() -> None:
        try:
            middleware.publish("/cmd_vel", TWIST, fields)
        except (FeedError, OSError) as error:
            errors.append(error)

    publishing = clock.beside(publish)
    clock.advance(SEND_TIMEOUT - TICK)
    assert errors == []
    if publishing.is_alive():
        clock.advance(TICK)
    publishing.join()
    return errors[0] if errors else None


def sent(server: OldFoxglove) -> list[Any]:
    return [json.loads(said[5:]) for said in server.heard if isinstance(said, bytes)]


def test_a_speed_and_a_zero_are_published_while_time_stands_still(taking: tuple[OldFoxglove, Foxglove]) -> None:
    server, middleware = taking
    for speed in 10 * [1.0, 0.0]:
        middleware.publish("/cmd_vel", TWIST, {"linear": {"x": speed}})
    wait_for(lambda: [message["linear"]["x"] for message in sent(server)][:20] == 10 * [1.0, 0.0], "all came")


def test_a_zero_that_a_new_publisher_of_the_bridge_may_lose_is_repeated_unless_a_speed_follows(
    taking: tuple[OldFoxglove, Foxglove], clock: ManualClock
) -> None:
    server, middleware = taking
    zero, speed = {"linear": {"x": 0.0}}, {"linear": {"x": 0.2}}
    middleware.publish("/cmd_vel", TWIST, zero)
    assert sent(server) == [zero], "it has been answered"
    clock.advance(0.3)
    wait_for(lambda: sent(server) == [zero, zero], "it is repeated")
    middleware.publish("/cmd_vel", TWIST, zero)  # subscribers have found the publisher by now
    middleware.publish("/other/cmd_vel", TWIST, zero)
    middleware.publish("/other/cmd_vel", TWIST, speed)
    clock.advance(0.6)
    middleware.publish("/cmd_vel", TWIST, zero)  # it comes after everything sent before
    assert sent(server) == [zero, zero, zero, zero, speed, zero]


def test_to_a_robot_that_does_not_answer_a_zero_is_sent_and_reported_as_unanswered(
    taking: tuple[OldFoxglove, Foxglove], clock: ManualClock
) -> None:
    server, middleware = taking
    go_on = server.stall()
    error = late(middleware, clock, {"linear": {"x": 0.0}})
    assert isinstance(error, TimeoutError)
    assert str(error) == f"{server.address} has not answered for 0.5 s"
    go_on()
    wait_for(lambda: sent(server)[:1] == [{"linear": {"x": 0.0}}], "it came, for a robot may be slow to answer")


def refusal(middleware: Foxglove, fields: dict[str, Any]) -> str:
    """The reason why something could not be published, or an empty text."""
    try:
        middleware.publish("/cmd_vel", TWIST, fields)
    except FeedError as error:
        return str(error)
    return ""


def test_to_a_robot_that_has_not_answered_for_a_second_no_speed_is_sent(
    taking: tuple[OldFoxglove, Foxglove], clock: ManualClock
) -> None:
    server, middleware = taking
    go_on = server.stall()
    tried = 0
    while not (words := refusal(middleware, {"linear": {"x": 1.0 + tried}})):
        tried += 1
        clock.advance(1 / 64)
    assert tried == 64
    assert words == f"{server.address} has not answered for 1.0 s: until it answers, only zero is sent"
    go_on()
    middleware.publish("/cmd_vel", TWIST, {"linear": {"x": 0.0}})
    wait_for(lambda: sent(server)[-1] == {"linear": {"x": 0.0}}, "the zero came")
    assert [message["linear"]["x"] for message in sent(server)] == [*(1.0 + i for i in range(tried)), 0.0]


def test_its_silence_counts_from_the_first_speed_without_an_answer_and_is_reported_until_it_answers(
    taking: tuple[OldFoxglove, Foxglove], ears: Ears, monkeypatch: pytest.MonkeyPatch, clock: ManualClock
) -> None:
    server, middleware = taking
    monkeypatch.setattr(_websocket, "ROBOT_GONE", 1000.0)  # only the pings of speeds
    clock.advance(1.0)  # to the end of the interval that began before
    wait_for(lambda: not _unanswered(middleware), "it answered")
    assert refusal(middleware, {"linear": {"x": 1.0}}) == ""
    wait_for(lambda: not _unanswered(middleware), "it answered")
    go_on = server.stall()
    clock.advance(5.0)
    assert refusal(middleware, {"linear": {"x": 1.0}}) == ""
    clock.advance(1.0 - TICK)
    assert ears.unheard == {}
    assert refusal(middleware, {"linear": {"x": 1.0}}) == ""
    clock.advance(TICK)
    assert ears.unheard == {"/cmd_vel": f"{server.address} does not answer: until it does, only zero is sent"}
    assert refusal(middleware, {"linear": {"x": 1.0}})
    count = len(sent(server))
    assert isinstance(late(middleware, clock, {"linear": {"x": 0.0}}), TimeoutError)
    assert refusal(middleware, {"linear": {"x": 2.0}})
    go_on()
    wait_for(lambda: ears.unheard["/cmd_vel"] == "", "it is well again")
    wait_for(lambda: not refusal(middleware, {"linear": {"x": 3.0}}), "a speed is sent")
    wait_for(lambda: sent(server)[-1:] == [{"linear": {"x": 3.0}}], "it came")
    assert [message["linear"]["x"] for message in sent(server)[count:]][-2:] == [0.0, 3.0]
    assert {"linear": {"x": 2.0}} not in sent(server)


def test_a_connection_that_ends_while_it_is_silent_is_reported_only_as_ended(
    taking: tuple[OldFoxglove, Foxglove], ears: Ears, clock: ManualClock
) -> None:
    server, middleware = taking
    go_on = server.stall()
    refusal(middleware, {"linear": {"x": 1.0}})
    clock.advance(1.0)
    assert ears.unheard["/cmd_vel"]
    server.drop()
    go_on()
    wait_for(lambda: ears.lost, "the connection ended")
    assert ears.unheard["/cmd_vel"] == ""


def _unanswered(middleware: Foxglove) -> bool:
    """True if it is not connected, or a ping waits for its answer."""
    link = middleware._socket
    return link is None or not link.is_open or bool(link._unanswered)


def _refused(feed: Feed) -> str:
    try:
        feed.drive(0.1)
    except FeedError as error:
        return str(error)
    return ""


def test_a_pad_says_that_a_robot_does_not_answer() -> None:
    with OldFoxglove([channel(1)], **TAKES) as server, feeds.foxglove(server.address) as feed:
        pad = DriveWidget()
        pad.connect(feed)
        feed.drive(0.1)
        go_on = server.stall()
        wait_for(lambda: "until it answers, only zero is sent" in _refused(feed), "speeds end")
        words = f"{server.address} does not answer: until it does, only zero is sent"
        wait_for(lambda: words in pad.get_state()["_state"]["status"], "the pad says so")
        go_on()
        wait_for(lambda: words not in pad.get_state()["_state"]["status"], "it is well again")


def follow(server: OldFoxglove, middleware: Foxglove, clock: ManualClock) -> None:
    middleware.follow(frozenset({"/scan"}))
    wait_for(lambda: clock.advance(TICK) or server.subscribed, "it subscribed, a moment after the advertisement")


PONG = 0xA
"""The accept key of RFC 6455."""


def pong_of(server: OldFoxglove) -> Callable[[bytes], object]:
    """Sends a pong to the first client."""
    return partial(server.clients[0].ws_connection._write_frame, True, PONG)  # type: ignore[union-attr]


@pytest.fixture
def hung(taking: tuple[OldFoxglove, Foxglove], clock: ManualClock) -> Iterator[tuple[OldFoxglove, Foxglove]]:
    """A server that still sends scans, and pongs for messages read before, but reads one more message and no ping."""
    server, middleware = taking
    follow(server, middleware, clock)
    pings: list[bytes] = []
    server.clients[0].on_ping = pings.append  # type: ignore[method-assign]
    middleware.publish("/cmd_vel", TWIST, {"linear": {"x": 0.0}})
    wait_for(lambda: pings, "it was asked whether it read that")
    server.hang()
    over, answer = threading.Event(), pong_of(server)

    def send() -> None:
        while not over.wait(0.005):
            server.log(1, cdr())
            server.loop.call_soon_threadsafe(answer, pings[-1])

    sending = threading.Thread(target=send)
    sending.start()
    yield server, middleware
    over.set()
    sending.join()


def test_scans_and_old_answers_do_not_confirm_a_zero_and_let_no_speed_pass(
    hung: tuple[OldFoxglove, Foxglove], ears: Ears, clock: ManualClock
) -> None:
    server, middleware = hung
    error = late(middleware, clock, {"linear": {"x": 0.0}})
    assert isinstance(error, TimeoutError)
    assert str(error) == f"{server.address} has not answered for 0.5 s"
    clock.advance(0.5)
    words = f"{server.address} has not answered for 1.0 s: until it answers, only zero is sent"
    assert refusal(middleware, {"linear": {"x": 1.0}}) == words
    wait_for(lambda: ears.messages, "scans come")


def test_a_robot_whose_data_come_is_not_given_up_though_it_answers_late(
    hung: tuple[OldFoxglove, Foxglove], ears: Ears, clock: ManualClock
) -> None:
    _, middleware = hung
    for _ in range(30):
        before = len(ears.messages)
        wait_for(lambda: len(ears.messages) > before, "a scan came")  # noqa: B023
        clock.advance(1.0)
    assert ears.lost == []
    assert refusal(middleware, {"linear": {"x": 1.0}})


def test_a_robot_may_answer_only_the_last_of_several_pings(
    taking: tuple[OldFoxglove, Foxglove], monkeypatch: pytest.MonkeyPatch, clock: ManualClock
) -> None:
    server, middleware = taking
    answering: Any = server.clients[0].ws_connection
    pings: list[bytes] = []
    write = answering._write_frame

    def keep_pongs(fin: bool, opcode: int, data: bytes, *flags: Any, **more: Any) -> asyncio.Future[None]:
        if opcode != PONG:
            return write(fin, opcode, data, *flags, **more)
        pings.append(data)
        done = server.loop.create_future()
        done.set_result(None)
        return done

    monkeypatch.setattr(answering, "_write_frame", keep_pongs)
    for _ in range(2):
        assert isinstance(late(middleware, clock, {"linear": {"x": 0.0}}), TimeoutError)
    assert refusal(middleware, {"linear": {"x": 1.0}})
    monkeypatch.undo()
    assert len(set(pings)) > 1
    server.loop.call_soon_threadsafe(pong_of(server), pings[-1])
    wait_for(lambda: not refusal(middleware, {"linear": {"x": 1.0}}), "a speed is sent")


def test_closing_takes_half_a_second_while_the_robot_does_not_answer(
    taking: tuple[OldFoxglove, Foxglove], clock: ManualClock
) -> None:
    server, middleware = taking
    go_on = server.stall()
    closing = clock.beside(middleware.close)
    clock.advance(0.5 - TICK)
    assert closing.is_alive()
    clock.advance(TICK)
    closing.join()
    wait_for(lambda: _threads() == [], "its thread ends, too")
    go_on()


def test_publishing_without_a_subscriber_is_an_error_and_never_sent(
    taking: tuple[OldFoxglove, Foxglove], ears: Ears, clock: ManualClock
) -> None:
    server, middleware = taking
    server.drop()
    wait_for(lambda: ears.lost, "it was lost")
    with pytest.raises(FeedError, match=f"not connected to {server.address}"):
        middleware.publish("/cmd_vel", TWIST, {"linear": {"x": 1.0}})
    clock.advance(0.5)
    wait_for(lambda: ears.connected == 2, "it is back")
    middleware.publish("/cmd_vel", TWIST, {"linear": {"x": 0.0}})
    wait_for(lambda: sent(server), "what is published now came")
    assert sent(server) == [{"linear": {"x": 0.0}}]


def test_a_connection_that_ends_while_something_is_published_is_an_error_at_once(
    taking: tuple[OldFoxglove, Foxglove], monkeypatch: pytest.MonkeyPatch
) -> None:
    server, middleware = taking
    go_on = server.stall()
    server.drop()
    frame_on = Foxglove._frame_on

    def frame_and_drop(*args: Any, **kwargs: Any) -> bytes:
        threading.Timer(0.1, go_on).start()
        return frame_on(*args, **kwargs)

    monkeypatch.setattr(Foxglove, "_frame_on", frame_and_drop)
    with pytest.raises(ConnectionError, match=f"the connection to {server.address} ended"):
        middleware.publish("/cmd_vel", TWIST, {})


def test_what_a_robot_does_not_take_in_time_is_an_error_and_not_sent_later(
    taking: tuple[OldFoxglove, Foxglove], clock: ManualClock
) -> None:
    server, middleware = taking
    link = middleware._socket
    assert link is not None
    for stream in (server.clients[0].ws_connection.stream, link._stream):  # type: ignore[union-attr]
        for buffer in (socket.SO_RCVBUF, socket.SO_SNDBUF):
            stream.socket.setsockopt(socket.SOL_SOCKET, buffer, 65_536)
    go_on = server.stall()
    errors = [late(middleware, clock, {"data": 4_000_000 * "x", "i": i}) for i in range(6)]
    assert {str(error) for error in errors} == {f"{server.address} does not accept data"}
    begun, *dropped = map(type, errors)
    assert begun is TimeoutError, "a part of it is sent, and the rest follows"
    assert set(dropped) == {FeedError}
    go_on()
    wait_for(lambda: not refusal(middleware, {"i": 6}), "it takes messages again")
    wait_for(lambda: sent(server)[-1:] == [{"i": 6}], "the last one came")
    assert [message["i"] for message in sent(server)] == [0, 6]


def test_a_server_that_never_answers_is_reported(ears: Ears, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_websocket, "CONNECT_TIMEOUT_S", 0.2)
    with Raw(lambda _: None) as server:
        middleware = Foxglove(server.address)
        middleware.open(ears)
        wait_for(lambda: ears.lost, "it gave up")
        middleware.close()
    assert ears.lost[0].startswith(f"no answer from {server.address} within 0.2 s: is the robot on, ")


def test_closing_does_not_wait_for_an_answer(ears: Ears, clock: ManualClock) -> None:
    called = threading.Event()
    with Raw(lambda _: called.set()) as server:
        middleware = Foxglove(server.address, clock)
        middleware.open(ears)
        assert called.wait(120)
        close(middleware, clock)
        wait_for(lambda: _threads() == [], "its thread ends")


@pytest.mark.parametrize(
    ("answer", "words"),
    [
        (b"HTTP/1.1 400 Bad <b>Request</b>\r\nContent-Length: 0\r\n\r\n", "HTTP 400: Bad <b>Request</b>"),
        (b"HTTP/1.1 200 OK\r\nContent-Length: 0\r\n\r\n", "Non-websocket response"),
        (b"HTTP/1.1 101 OK\r\nX: " + b"x" * 1_000_000 + b"\r\n\r\n", ""),
        (b"HTTP/1.1 101 OK\r\n\r\n", ""),
        (b"SSH-2.0-OpenSSH_9.2\r\n\r\n", ""),
    ],
)
def test_a_server_that_is_not_a_websocket_server_is_reported(
    answer: bytes, words: str, ears: Ears, clock: ManualClock
) -> None:
    def talk(client: socket.socket) -> None:
        client.recv(4096)
        client.sendall(answer)
        client.shutdown(socket.SHUT_WR)

    is_mute = answer.startswith(b"SSH")
    with Raw(talk) as server:
        middleware = Foxglove(server.address, clock)
        middleware.open(ears)
        wait_for(lambda: (is_mute and clock.advance(1.0)) or ears.lost, "it gave up")
        close(middleware, clock)
    told = f"{server.address} cannot be connected to: {words}"
    # Tornado before 6.6, the newest for Python 3.10, keeps waiting if no HTTP comes.
    silent = f"no answer from {server.address} within 5 s"
    assert ears.lost[0].startswith((told, silent) if is_mute else told)
    assert ears.connected == 0


def test_a_server_of_another_protocol_is_reported(ears: Ears) -> None:
    with Server() as server:
        middleware = Foxglove(server.address)
        middleware.open(ears)
        wait_for(lambda: ears.lost, "it gave up")
        middleware.close()
        wait_for(lambda: not server.clients, "the connection ended")
    refused = f"{server.address} supports none of foxglove.sdk.v1, foxglove.websocket.v1"
    assert ears.lost[0] == f"{refused}: another program listens there; {middleware.hint}"
    assert ears.connected == 0


def test_an_attempt_that_succeeds_after_closing_is_ended(ears: Ears, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_websocket, "NO_ANSWER", 0.0)
    monkeypatch.setattr(_websocket, "_GOODBYE", 120.0)
    leave = _websocket.close_when_connected
    with Server() as server:
        go_on = server.stall()

        async def go_on_and_leave(connecting: Any, seconds: float) -> None:
            go_on()
            await leave(connecting, seconds)

        monkeypatch.setattr(_websocket, "close_when_connected", go_on_and_leave)
        middleware = Foxglove(server.address)
        middleware.open(ears)
        wait_for(lambda: ears.nobody, "the attempt runs")
        middleware.close()
        wait_for(lambda: server.opened and not server.clients, "the connection ended")


def test_an_unknown_name_is_reported(ears: Ears, monkeypatch: pytest.MonkeyPatch) -> None:
    def unknown(*_: object, **__: object) -> None:
        raise socket.gaierror(-2, "Name or service not known")

    monkeypatch.setattr(socket, "getaddrinfo", unknown)
    middleware = Foxglove("ws://robot.invalid:8765")
    middleware.open(ears)
    wait_for(lambda: ears.lost, "it gave up")
    middleware.close()
    assert ears.lost[0] == "the name robot.invalid cannot be resolved; try the robot's IP address"


def test_a_server_that_takes_calls_and_drops_them_is_called_ever_more_rarely(ears: Ears, clock: ManualClock) -> None:
    with OldFoxglove([]) as server:
        server.on_open = lambda client: client.close()  # type: ignore[method-assign]
        middleware = Foxglove(server.address, clock)
        middleware.open(ears)
        for pauses in ([0.5], [0.5, 1.0], [0.5, 1.0, 2.0], [0.5, 1.0, 2.0, 4.0], [0.5, 1.0, 2.0, 4.0, 8.0]):
            wait_for(lambda: ears.pauses == pauses, "it was lost")  # noqa: B023
            clock.advance(pauses[-1] - TICK)
            assert server.opened == len(pauses)
            clock.advance(TICK)
        wait_for(lambda: ears.pauses[5:] == [8.0], "the longest pause stays")
        close(middleware, clock)


class TickingClock(RealClock):
    """A clock whose reading takes half a millisecond."""

    def __init__(self) -> None:
        self._looks = itertools.count()

    def now(self) -> float:  # type: ignore[override]
        return next(self._looks) / 2000


def test_frames_that_wait_hold_up_every_other_call_in_the_thread_for_five_milliseconds_at_most(ears: Ears) -> None:
    with OldFoxglove([channel(1)]) as server:
        middleware = Foxglove(server.address, TickingClock())
        middleware.follow(frozenset({"/scan"}))
        middleware.open(ears)
        wait_for(lambda: server.subscribed, "it subscribed")
        is_held, go_on = threading.Event(), threading.Event()
        ears.then = lambda *_: is_held.set() or go_on.wait(120)
        server.log(1, cdr())
        assert is_held.wait(120)
        for _ in range(200):
            server.log(1, cdr())
        sent = threading.Event()
        server.loop.call_soon_threadsafe(sent.set)
        assert sent.wait(120)
        go_on.set()
        last = cdr(distance=7.0)
        server.log(1, last)
        wait_for(lambda: float(ears.messages[-1][1].ranges[0]) == 7.0, "all are read")
        middleware.close()
    # They are decoded in a call like any other: about ten frames were read between two of these.
    assert len(ears.messages) > 12


def _threads() -> list[str]:
    return [thread.name for thread in threading.enumerate() if thread.name.startswith("robowidgets ws")]


def _descriptors() -> int:
    return len(os.listdir("/proc/self/fd"))
