from __future__ import annotations

import asyncio
import gc
import json
import os
import socket
import struct
import threading
import time
import weakref
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import pytest

from robowidgets import DriveWidget, feeds
from robowidgets.feeds import Feed, FeedError, _other_bridge, _websocket
from robowidgets.feeds.foxglove import Foxglove
from robowidgets.feeds.middleware import CLOSE_TIMEOUT

from ..waiting import wait_for
from .ears import Ears
from .fox import OldFoxglove, cdr, channel
from .servers import Server, free_port

# A connection does the same whatever is spoken on it: here it is foxglove.

TWIST = "geometry_msgs/msg/Twist"


@pytest.fixture
def ears() -> Ears:
    return Ears()


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
    """A listening socket whose connections are handed to a function, in a thread of their own each."""

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
def test_an_address_that_is_none_is_refused_with_one_that_is(address: str) -> None:
    words = r"address: expected one like ws://192.168.1.5:8765 \(wss:// for an encrypted one\), got "
    with pytest.raises(ValueError, match=words):
        Foxglove(address)


def test_an_address_that_is_no_text_is_refused() -> None:
    with pytest.raises(TypeError, match=r"address: expected one like ws://192.168.1.5:8765, got 8765"):
        Foxglove(8765)  # type: ignore[arg-type]


def test_without_tornado_opening_says_what_to_install(monkeypatch: pytest.MonkeyPatch, ears: Ears) -> None:
    monkeypatch.setitem(__import__("sys").modules, "tornado.websocket", None)
    with pytest.raises(FeedError, match="websockets need the package tornado, which is not installed: pip install"):
        Foxglove().open(ears)


def test_closing_twice_or_before_opening_does_nothing(ears: Ears) -> None:
    middleware = Foxglove(f"ws://127.0.0.1:{free_port()}")
    middleware.close()
    middleware.open(ears)
    middleware.close()
    middleware.close()
    assert ears.connected == 0


def test_it_may_be_closed_in_a_callback(scanning: tuple[OldFoxglove, Foxglove], ears: Ears) -> None:
    server, middleware = scanning
    ears.then = lambda *_: middleware.close()
    server.log(1, cdr())
    wait_for(lambda: not server.clients, "the connection ended")
    wait_for(lambda: _threads() == [], "its thread ended")
    assert len(ears.messages) == 1
    assert ears.lost == []


def test_an_attempt_that_nobody_answers_says_what_to_compare_while_it_goes_on(
    ears: Ears, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert _websocket.SILENT < 2.0
    monkeypatch.setattr(_websocket, "SILENT", 0.05)
    monkeypatch.setattr(_websocket, "PATIENCE", 1.0)
    with Raw(lambda taken: taken.recv(1)) as silent:
        middleware = Foxglove(silent.address)
        middleware.open(ears)
        wait_for(lambda: ears.nobody, "it is told")
        assert ears.lost == []
        words = "is the robot on, and in this network? Is the address right? Does a firewall block the port?"
        assert ears.nobody == f"no answer from {silent.address} yet: {words}"
        wait_for(lambda: ears.lost, "the attempt has ended")
        assert ears.lost == [f"no answer from {silent.address} within 1 s: {words}"]
        ears.nobody = ""
        wait_for(lambda: len(ears.lost) == 2, "the next one has, too")
        assert ears.nobody == "", "the reason of the first one is on show meanwhile"
        middleware.close()


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


def test_a_robot_that_says_goodbye_is_quoted(scanning: tuple[OldFoxglove, Foxglove], ears: Ears) -> None:
    server, _ = scanning
    server._loop.call_soon_threadsafe(lambda: server.clients[0].close(1001, "battery\nlow"))
    wait_for(lambda: ears.lost, "it was lost")
    assert ears.lost == ["the connection ended: battery low"]


def test_a_robot_that_falls_silent_is_given_up_when_it_is_promised(ears: Ears, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_websocket, "ROBOT_GONE", 2.0)
    with OldFoxglove([channel(1)]) as server:
        middleware = Foxglove(server.address)
        middleware.open(ears)
        wait_for(lambda: ears.topics, "it is connected")
        go_on = server.stall()
        began = time.monotonic()
        wait_for(lambda: ears.lost, "it was lost")
        assert 1.5 < time.monotonic() - began < 3.0
        go_on()
        wait_for(lambda: ears.connected == 2, "it is back")
        middleware.close()
    assert ears.lost[0] == "the robot did not answer for 2 s"


def test_a_robot_that_answers_but_says_nothing_is_not_given_up(ears: Ears, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_websocket, "ROBOT_GONE", 0.5)
    pings = []
    with OldFoxglove([]) as server:
        middleware = Foxglove(server.address)
        middleware.open(ears)
        wait_for(lambda: server.clients, "it is connected")
        server.clients[0].on_ping = lambda data: pings.append(data)  # type: ignore[method-assign]
        wait_for(lambda: len(pings) > 20, "it was asked for longer than that")
        middleware.close()
    assert ears.lost == []


@pytest.fixture
def taking(ears: Ears) -> Iterator[tuple[OldFoxglove, Foxglove]]:
    """A server that takes messages, and a connection to it."""
    info: dict[str, Any] = {"capabilities": ["clientPublish"], "supportedEncodings": ["json"]}
    with OldFoxglove([channel(1)], **info) as server:
        middleware = Foxglove(server.address)
        middleware.open(ears)
        wait_for(lambda: ears.topics, "it is connected")
        yield server, middleware
        middleware.close()


def sent(server: OldFoxglove) -> list[Any]:
    return [json.loads(said[5:]) for said in server.heard if isinstance(said, bytes)]


def test_a_speed_and_a_zero_are_published_at_once(taking: tuple[OldFoxglove, Foxglove]) -> None:
    server, middleware = taking
    seconds = []
    for speed in 10 * [1.0, 0.0]:
        began = time.monotonic()
        middleware.publish("/cmd_vel", TWIST, {"linear": {"x": speed}})
        seconds.append(time.monotonic() - began)
    assert sorted(seconds)[10] < 0.1
    wait_for(lambda: [message["linear"]["x"] for message in sent(server)][:20] == 10 * [1.0, 0.0], "all came")


def test_a_zero_that_a_new_publisher_of_the_bridge_may_lose_is_repeated_unless_a_speed_follows(
    taking: tuple[OldFoxglove, Foxglove],
) -> None:
    server, middleware = taking
    zero, speed = {"linear": {"x": 0.0}}, {"linear": {"x": 0.2}}
    middleware.publish("/cmd_vel", TWIST, zero)
    wait_for(lambda: sent(server) == [zero, zero], "it is repeated")
    middleware.publish("/cmd_vel", TWIST, zero)  # subscribers have found the publisher by now
    middleware.publish("/other/cmd_vel", TWIST, zero)
    middleware.publish("/other/cmd_vel", TWIST, speed)
    time.sleep(0.6)
    assert sent(server) == [zero, zero, zero, zero, speed]


def test_to_a_robot_that_does_not_answer_a_zero_is_sent_and_said_not_to_be_answered(
    taking: tuple[OldFoxglove, Foxglove],
) -> None:
    server, middleware = taking
    go_on = server.stall()
    began = time.monotonic()
    with pytest.raises(TimeoutError, match=f"{server.address} has not answered for 0.5 s"):
        middleware.publish("/cmd_vel", TWIST, {"linear": {"x": 0.0}})
    assert 0.4 < time.monotonic() - began < 1.0
    go_on()
    wait_for(lambda: sent(server)[:1] == [{"linear": {"x": 0.0}}], "it came, for a robot may be slow to answer")


def refusal(middleware: Foxglove, fields: dict[str, Any]) -> str:
    """Why something could not be published; empty when it could."""
    try:
        middleware.publish("/cmd_vel", TWIST, fields)
    except FeedError as error:
        return str(error)
    return ""


def test_to_a_robot_that_has_not_answered_for_a_while_no_speed_is_sent(taking: tuple[OldFoxglove, Foxglove]) -> None:
    server, middleware = taking
    go_on = server.stall()
    began = time.monotonic()
    tried = 0
    while not (words := refusal(middleware, {"linear": {"x": 1.0 + tried}})):
        tried += 1
        time.sleep(0.02)  # the pace of a program
        assert time.monotonic() - began < 3.0
    assert words.startswith(f"{server.address} has not answered for ")
    go_on()
    middleware.publish("/cmd_vel", TWIST, {"linear": {"x": 0.0}})
    wait_for(lambda: sent(server)[-1] == {"linear": {"x": 0.0}}, "the zero came")
    assert [message["linear"]["x"] for message in sent(server)] == [*(1.0 + i for i in range(tried)), 0.0]


def test_its_silence_counts_from_the_first_speed_without_an_answer_and_is_told_until_it_answers(
    taking: tuple[OldFoxglove, Foxglove], ears: Ears, monkeypatch: pytest.MonkeyPatch
) -> None:
    server, middleware = taking
    monkeypatch.setattr(_websocket, "ROBOT_GONE", 1000.0)  # no ping but those of speeds
    wait_for(lambda: not refusal(middleware, {"linear": {"x": 1.0}}) and not _unanswered(middleware), "it answered")
    go_on = server.stall()
    wait_for(
        lambda: "until it answers, only zero is sent" in refusal(middleware, {"linear": {"x": 1.0}}), "it is silent"
    )
    words = f"{server.address} does not answer: until it does, only zero is sent"
    wait_for(lambda: ears.unheard.get("/cmd_vel") == words, "it is told")
    count = len(sent(server))
    with pytest.raises(TimeoutError):
        middleware.publish("/cmd_vel", TWIST, {"linear": {"x": 0.0}})
    assert refusal(middleware, {"linear": {"x": 2.0}})
    go_on()
    wait_for(lambda: ears.unheard["/cmd_vel"] == "", "it is well again")
    wait_for(lambda: not refusal(middleware, {"linear": {"x": 3.0}}), "a speed is sent")
    wait_for(lambda: sent(server)[-1:] == [{"linear": {"x": 3.0}}], "it came")
    assert [message["linear"]["x"] for message in sent(server)[count:]][-2:] == [0.0, 3.0]
    assert {"linear": {"x": 2.0}} not in sent(server)


def test_a_connection_that_ends_while_it_is_silent_is_told_by_its_end_alone(
    taking: tuple[OldFoxglove, Foxglove], ears: Ears, monkeypatch: pytest.MonkeyPatch
) -> None:
    server, middleware = taking
    monkeypatch.setattr(_websocket, "ROBOT_SILENCE", 0.05)
    go_on = server.stall()
    refusal(middleware, {"linear": {"x": 1.0}})
    wait_for(lambda: ears.unheard.get("/cmd_vel"), "it is told")
    server.drop()
    go_on()
    wait_for(lambda: ears.lost, "the connection ended")
    assert ears.unheard["/cmd_vel"] == ""


def _unanswered(middleware: Foxglove) -> bool:
    assert middleware._socket is not None
    return bool(middleware._socket._unanswered)


def _refused(feed: Feed) -> str:
    try:
        feed.drive(0.1)
    except FeedError as error:
        return str(error)
    return ""


def test_a_pad_says_that_a_robot_does_not_answer() -> None:
    info: dict[str, Any] = {"capabilities": ["clientPublish"], "supportedEncodings": ["json"]}
    with OldFoxglove([channel(1)], **info) as server, feeds.foxglove(server.address) as feed:
        pad = DriveWidget()
        pad.connect(feed)
        feed.drive(0.1)
        go_on = server.stall()
        wait_for(lambda: "until it answers, only zero is sent" in _refused(feed), "speeds end")
        words = f"{server.address} does not answer: until it does, only zero is sent"
        wait_for(lambda: words in pad.get_state()["_state"]["status"], "the pad says so")
        go_on()
        wait_for(lambda: words not in pad.get_state()["_state"]["status"], "it is well again")


PONG = 0xA
"""Of RFC 6455."""


def pong_of(server: OldFoxglove) -> Callable[[bytes], object]:
    """Sends a pong to the first client."""
    return partial(server.clients[0].ws_connection._write_frame, True, PONG)  # type: ignore[union-attr]


@pytest.fixture
def hung(taking: tuple[OldFoxglove, Foxglove]) -> Iterator[tuple[OldFoxglove, Foxglove]]:
    """A server that still sends scans, and pongs to what it read before, but reads one more message and no ping."""
    server, middleware = taking
    middleware.follow(frozenset({"/scan"}))
    wait_for(lambda: server.subscribed, "it subscribed")
    pings: list[bytes] = []
    server.clients[0].on_ping = pings.append  # type: ignore[method-assign]
    middleware.publish("/cmd_vel", TWIST, {"linear": {"x": 0.0}})
    wait_for(lambda: pings, "it was asked whether it read that")
    server.hang()
    over, answer = threading.Event(), pong_of(server)

    def send() -> None:
        while not over.wait(0.005):
            server.log(1, cdr())
            server._loop.call_soon_threadsafe(answer, pings[-1])

    sending = threading.Thread(target=send)
    sending.start()
    yield server, middleware
    over.set()
    sending.join()


def test_scans_and_old_answers_do_not_confirm_a_zero_and_let_no_speed_pass(
    hung: tuple[OldFoxglove, Foxglove], ears: Ears
) -> None:
    server, middleware = hung
    with pytest.raises(TimeoutError, match=f"{server.address} has not answered for 0.5 s"):
        middleware.publish("/cmd_vel", TWIST, {"linear": {"x": 0.0}})
    words = f"{server.address} has not answered for "
    wait_for(lambda: refusal(middleware, {"linear": {"x": 1.0}}).startswith(words), "no speed is sent", 3.0)
    assert ears.messages


def test_a_robot_whose_data_come_is_not_given_up_though_it_answers_late(
    monkeypatch: pytest.MonkeyPatch, taking: tuple[OldFoxglove, Foxglove], ears: Ears, request: pytest.FixtureRequest
) -> None:
    monkeypatch.setattr(_websocket, "ROBOT_GONE", 1.0)
    _, middleware = request.getfixturevalue("hung")
    time.sleep(3.0)
    assert ears.lost == []
    assert refusal(middleware, {"linear": {"x": 1.0}})


def test_a_robot_may_answer_only_the_last_of_several_pings(
    taking: tuple[OldFoxglove, Foxglove], ears: Ears, monkeypatch: pytest.MonkeyPatch
) -> None:
    server, middleware = taking
    monkeypatch.setattr(_websocket, "SEND_TIMEOUT", 0.1)
    answering: Any = server.clients[0].ws_connection
    pings: list[bytes] = []
    write = answering._write_frame

    def keep_pongs(fin: bool, opcode: int, data: bytes, *flags: Any, **more: Any) -> asyncio.Future[None]:
        if opcode != PONG:
            return write(fin, opcode, data, *flags, **more)
        pings.append(data)
        done = server._loop.create_future()
        done.set_result(None)
        return done

    monkeypatch.setattr(answering, "_write_frame", keep_pongs)
    for _ in range(2):
        with pytest.raises(TimeoutError, match=f"{server.address} has not answered for "):
            middleware.publish("/cmd_vel", TWIST, {"linear": {"x": 0.0}})
    monkeypatch.undo()
    assert len(set(pings)) > 1
    server._loop.call_soon_threadsafe(pong_of(server), pings[-1])
    wait_for(lambda: not refusal(middleware, {"linear": {"x": 1.0}}), "a speed is sent")


def test_closing_takes_no_longer_than_promised_while_the_robot_does_not_answer(
    taking: tuple[OldFoxglove, Foxglove],
) -> None:
    server, middleware = taking
    go_on = server.stall()
    began = time.monotonic()
    middleware.close()
    assert time.monotonic() - began < CLOSE_TIMEOUT
    assert _threads() == []
    go_on()


def test_what_is_published_while_nobody_is_there_is_an_error_and_never_sent(
    taking: tuple[OldFoxglove, Foxglove], ears: Ears
) -> None:
    server, middleware = taking
    server.drop()
    wait_for(lambda: ears.lost, "it was lost")
    with pytest.raises(FeedError, match=f"there is no connection to {server.address}"):
        middleware.publish("/cmd_vel", TWIST, {"linear": {"x": 1.0}})
    wait_for(lambda: ears.connected == 2, "it is back")
    middleware.publish("/cmd_vel", TWIST, {"linear": {"x": 0.0}})
    wait_for(lambda: sent(server), "what is published now came")
    assert sent(server) == [{"linear": {"x": 0.0}}]


def test_a_connection_that_ends_while_something_is_published_is_an_error_at_once(
    taking: tuple[OldFoxglove, Foxglove], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(_websocket, "SEND_TIMEOUT", 20.0)
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
    ears: Ears, monkeypatch: pytest.MonkeyPatch, taking: tuple[OldFoxglove, Foxglove]
) -> None:
    monkeypatch.setattr(_websocket, "ROBOT_GONE", 1000.0)  # it is not asked whether it is there
    monkeypatch.setattr(_websocket, "SEND_TIMEOUT", 0.2)
    server, middleware = taking
    server.drop()
    wait_for(lambda: ears.connected == 2, "it is connected anew")
    wait_for(lambda: not refusal(middleware, {}), "it takes messages")
    go_on = server.stall()
    errors: dict[int, Exception] = {}
    for i in range(60):
        try:
            middleware.publish("/cmd_vel", TWIST, {"data": 1_000_000 * "x", "i": i})
        except (FeedError, TimeoutError) as error:
            errors[i] = error
        if len(errors) == 6:
            break
    assert {str(error) for error in errors.values()} == {f"{server.address} does not take what is sent"}
    begun, *dropped = errors
    assert isinstance(errors[begun], TimeoutError), "a part of it is sent, and the rest follows"
    go_on()
    wait_for(lambda: not refusal(middleware, {"i": 60}), "it takes messages again")
    wait_for(lambda: sent(server)[-1].get("i") == 60, "the last one came")
    assert not {message.get("i") for message in sent(server)}.intersection(dropped)


def test_a_server_that_never_answers_is_told(ears: Ears, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_websocket, "PATIENCE", 0.2)
    with Raw(lambda _: None) as server:
        middleware = Foxglove(server.address)
        middleware.open(ears)
        wait_for(lambda: ears.lost, "it gave up")
        middleware.close()
    assert ears.lost[0].startswith(f"no answer from {server.address} within 0.2 s: is the robot on, ")


def test_closing_does_not_wait_for_an_answer(ears: Ears) -> None:
    called = threading.Event()
    with Raw(lambda _: called.set()) as server:
        middleware = Foxglove(server.address)
        middleware.open(ears)
        assert called.wait(20)
        middleware.close()
        assert _threads() == []


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
def test_a_server_that_is_no_websocket_server_is_told(answer: bytes, words: str, ears: Ears) -> None:
    def talk(client: socket.socket) -> None:
        client.recv(4096)
        client.sendall(answer)
        client.shutdown(socket.SHUT_WR)

    with Raw(talk) as server:
        middleware = Foxglove(server.address)
        middleware.open(ears)
        wait_for(lambda: ears.lost, "it gave up")
        middleware.close()
    told = f"{server.address} cannot be connected to: {words}"
    # Tornado before 6.6, the newest for Python 3.10, waits on where no HTTP comes.
    silent = f"no answer from {server.address} within 5 s"
    assert ears.lost[0].startswith((told, silent) if answer.startswith(b"SSH") else told)
    assert ears.connected == 0


def test_a_server_of_another_protocol_is_told(ears: Ears, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_other_bridge, "PATIENCE", 0.1)
    with Server() as server:
        middleware = Foxglove(server.address)
        middleware.open(ears)
        wait_for(lambda: ears.lost, "it gave up")
        middleware.close()
        wait_for(lambda: not server.clients, "the connection ended")
    spoken = "foxglove.sdk.v1, foxglove.websocket.v1"
    assert ears.lost[0] == f"{server.address} supports none of {spoken}: another program listens there"
    assert ears.connected == 0


def test_a_name_that_nobody_knows_is_told(ears: Ears, monkeypatch: pytest.MonkeyPatch) -> None:
    def unknown(*_: object, **__: object) -> None:
        raise socket.gaierror(-2, "Name or service not known")

    monkeypatch.setattr(socket, "getaddrinfo", unknown)
    middleware = Foxglove("ws://robot.invalid:8765")
    middleware.open(ears)
    wait_for(lambda: ears.lost, "it gave up")
    middleware.close()
    assert ears.lost[0] == "the name robot.invalid cannot be resolved; try the robot's IP address"


def test_a_server_that_takes_calls_and_drops_them_is_called_ever_more_rarely(ears: Ears) -> None:
    with OldFoxglove([]) as server:
        server.on_open = lambda client: client.close()  # type: ignore[method-assign]
        middleware = Foxglove(server.address)
        middleware.open(ears)
        wait_for(lambda: len(ears.pauses) == 3, "it was lost three times")
        middleware.close()
    assert ears.pauses[0] < ears.pauses[1] < ears.pauses[2]


def test_a_hundred_opens_and_closes_leave_no_thread_no_socket_and_no_memory(ears: Ears) -> None:
    there: list[weakref.ref[Foxglove]] = []
    with OldFoxglove([channel(1)]) as server:

        def once(wait: bool) -> None:
            middleware = Foxglove(server.address)
            middleware.follow(frozenset({"/scan"}))
            before = ears.connected
            middleware.open(ears)
            if wait:
                wait_for(lambda: ears.connected > before, "it is connected")
            middleware.close()
            there.append(weakref.ref(middleware))

        once(True)
        wait_for(lambda: not server.clients, "the server knows of it")
        before = _descriptors()
        for i in range(100):
            once(i % 2 == 0)
        wait_for(lambda: not server.clients, "every connection ended")
        assert _threads() == []
        wait_for(lambda: _descriptors() <= before, "every socket is closed", 5)
    gc.collect()
    assert [ref for ref in there if ref() is not None] == []


def test_frames_that_come_without_a_pause_keep_nobody_from_publishing_and_closing(
    taking: tuple[OldFoxglove, Foxglove], ears: Ears, monkeypatch: pytest.MonkeyPatch
) -> None:
    server, middleware = taking
    middleware.follow(frozenset({"/scan"}))
    wait_for(lambda: server.subscribed, "it subscribed")
    monkeypatch.setattr(_websocket, "_GOODBYE", 0.05)
    monkeypatch.setattr(_websocket, "SEND_TIMEOUT", 20.0)  # the answer comes behind all frames that wait in the network
    message = struct.pack("<BIQ", 1, server.subscribed[1], 0) + cdr()
    assert len(message) < 126
    frames = 50_000 * (bytes([0x82, len(message)]) + message)  # as they are on the wire

    async def flood() -> None:
        stream = server.clients[0].ws_connection.stream  # type: ignore[union-attr]
        while not stream.closed():
            await stream.write(frames)

    asyncio.run_coroutine_threadsafe(flood(), server._loop)
    wait_for(lambda: len(ears.messages) > 5, "messages are handed on meanwhile")
    for speed in (1.0, 0.0):
        middleware.publish("/cmd_vel", TWIST, {"linear": {"x": speed}})
    middleware.close()
    assert _threads() == []


def _threads() -> list[str]:
    return [thread.name for thread in threading.enumerate() if thread.name.startswith("robowidgets ws")]


def _descriptors() -> int:
    return len(os.listdir("/proc/self/fd"))
