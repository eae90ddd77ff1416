"""Recordings in object storage: a real S3 server on this machine."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import robowidgets
from robowidgets import conditions

from ..recordings import long_drive
from .executors import Here

pytest.importorskip("s3fs")
moto_server = pytest.importorskip("moto.server")

pytestmark = pytest.mark.slow

SAMPLE = Path(robowidgets.SAMPLE)
MANY = 6
NEAR = conditions.nearest_below(0.5)


@pytest.fixture(scope="module")
def endpoint() -> Iterator[str]:
    server = moto_server.ThreadedMotoServer(ip_address="127.0.0.1", port=0)
    server.start()
    host, port = server.get_host_and_port()
    yield f"http://{host}:{port}"
    server.stop()


@pytest.fixture
def bucket(endpoint: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Any]:
    """A bucket named drives, with nothing in it."""
    for name, value in {
        "AWS_ACCESS_KEY_ID": "key",
        "AWS_SECRET_ACCESS_KEY": "secret",
        "AWS_DEFAULT_REGION": "us-east-1",
        "AWS_ENDPOINT_URL": endpoint,
        "ROBOWIDGETS_CACHE": str(tmp_path / "cache"),
    }.items():
        monkeypatch.setenv(name, value)
    import boto3
    from s3fs import S3FileSystem

    S3FileSystem.clear_instance_cache()
    made = boto3.resource("s3").Bucket("drives")
    made.create()
    yield made
    made.objects.all().delete()
    made.delete()
    S3FileSystem.clear_instance_cache()


def copies(tmp_path: Path) -> list[Path]:
    return [*(tmp_path / "cache/remote").glob("*/*.mcap")]


def test_many_recordings_give_the_rows_of_the_same_files_here(bucket: Any, tmp_path: Path) -> None:
    data, here = SAMPLE.read_bytes(), tmp_path / "runs"
    here.mkdir()
    for number in range(MANY):
        part = data if number % 3 else data[: len(data) * 2 // 3]  # some of them were cut off
        (here / f"{number:03}.mcap").write_bytes(part)
        bucket.put_object(Key=f"runs/{number:03}.mcap", Body=part)
    bucket.put_object(Key="runs/notes.txt", Body=b"of the drives")
    local = robowidgets.find(NEAR, here, executor=Here())
    there = robowidgets.find(NEAR, "s3://drives/runs/*.mcap")
    assert len(there.files) == MANY
    assert len(local)
    assert [hit._replace(file=Path(hit.file).name) for hit in there] == [
        hit._replace(file=Path(hit.file).name) for hit in local
    ]
    assert there[0].file == "s3://drives/runs/000.mcap"
    assert len(copies(tmp_path)) == MANY
    # Unchanged files are neither fetched nor read again; a prefix is a folder.
    for copy in copies(tmp_path):
        copy.unlink()
    assert [*robowidgets.find(NEAR, "s3://drives/runs")] == [*there]


def test_an_object_that_changed_is_searched_again(bucket: Any) -> None:
    data = SAMPLE.read_bytes()
    bucket.put_object(Key="drive.mcap", Body=data)
    before = robowidgets.find(NEAR, "s3://drives/drive.mcap")
    bucket.put_object(Key="drive.mcap", Body=data[: len(data) // 3])
    after = robowidgets.find(NEAR, "s3://drives/drive.mcap")
    assert not before.problems
    assert after.problems


def test_what_cannot_be_read_becomes_a_row_and_stops_nothing(bucket: Any) -> None:
    bucket.put_object(Key="a.mcap", Body=b"no recording")
    bucket.put_object(Key="b.mcap", Body=SAMPLE.read_bytes())
    hits = robowidgets.find(NEAR, "s3://drives/a.mcap", "s3://drives/b.mcap", "s3://drives/c.mcap", "s3://none/*.mcap")
    assert {hit.file for hit in hits} == {"s3://drives/b.mcap"}
    problems = dict(hits.unread)
    assert "no such object" in problems["s3://drives/c.mcap"]
    assert "s3://drives/a.mcap" in problems
    assert "s3://none/*.mcap" in problems


def test_no_permission_is_reported(bucket: Any) -> None:
    from moto.core import set_initial_no_auth_action_count

    bucket.put_object(Key="drive.mcap", Body=SAMPLE.read_bytes())

    @set_initial_no_auth_action_count(0)
    def opened() -> None:
        robowidgets.open("s3://drives/drive.mcap")

    with pytest.raises(robowidgets.RecordingError, match=r"drive\.mcap: no permission to read it .*~/\.aws/cred"):
        opened()


def test_the_whole_folder_of_rosbag2_is_fetched(bucket: Any) -> None:
    data = SAMPLE.read_bytes()
    metadata = "rosbag2_bagfile_information:\n  relative_file_paths:\n    - a_0.mcap\n"
    bucket.put_object(Key="runs/bag/a_0.mcap", Body=data)
    bucket.put_object(Key="runs/bag/metadata.yaml", Body=metadata.encode())
    with robowidgets.open("s3://drives/runs/bag") as recording, robowidgets.open(SAMPLE) as here:
        assert recording.topics == here.topics
    summary = robowidgets.fleet.summary("s3://drives/runs")
    assert list(summary.files) == ["s3://drives/runs/bag"]
    assert not summary.unread


def test_the_check_up_takes_urls(bucket: Any) -> None:
    bucket.put_object(Key="a.mcap", Body=SAMPLE.read_bytes())
    bucket.put_object(Key="b.mcap", Body=SAMPLE.read_bytes())
    check_up = robowidgets.fleet.doctor("s3://drives/")
    assert not check_up.unread
    assert not check_up.kinds


@pytest.fixture
def calls(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The calls of S3, each with its range."""
    from s3fs import S3FileSystem

    found: list[str] = []
    call = S3FileSystem._call_s3

    async def noted(self: Any, method: str, *args: Any, **kwargs: Any) -> Any:
        found.append(f"{method} {kwargs.get('Range', '')}".strip())
        return await call(self, method, *args, **kwargs)

    monkeypatch.setattr(S3FileSystem, "_call_s3", noted)
    return found


@pytest.fixture
def drive(bucket: Any, tmp_path: Path) -> Path:
    """A drive of more than 64 MB, which is also in the bucket."""
    path = long_drive.write(tmp_path / "drive.mcap", 80, image=900_000, others=3)
    bucket.upload_file(str(path), "drive.mcap")
    return path


def test_a_large_drive_is_read_in_parts_with_the_rows_of_the_file_here(
    drive: Path, calls: list[str], tmp_path: Path
) -> None:
    with robowidgets.open(drive) as here, robowidgets.open("s3://drives/drive.mcap") as there:
        assert there.topics == here.topics
        assert there.duration == here.duration
        assert len(calls) <= 10
        before = len(calls)
        assert there.at("/scan", 40.0).sample.ranges.tolist() == here.at("/scan", 40.0).sample.ranges.tolist()
        assert len(calls) - before <= 2
        assert [*there.find(NEAR)] == [*here.find(NEAR)]
    assert not copies(tmp_path)
    hits = robowidgets.find(NEAR, "s3://drives/drive.mcap")
    assert [hit[1:] for hit in hits] == [hit[1:] for hit in robowidgets.find(NEAR, drive)]
    assert not hits.unread


def test_a_large_folder_of_rosbag2_is_read_in_parts(drive: Path, bucket: Any, calls: list[str], tmp_path: Path) -> None:
    metadata = "rosbag2_bagfile_information:\n  relative_file_paths:\n    - drive_0.mcap\n"
    bucket.upload_file(str(drive), "bag/drive_0.mcap")
    bucket.put_object(Key="bag/metadata.yaml", Body=metadata.encode())
    calls.clear()
    with robowidgets.open(drive) as here, robowidgets.open("s3://drives/bag") as there:
        assert there.topics == here.topics
        assert len(calls) <= 12
        assert np.array_equal(there.scans().ranges, here.scans().ranges)
        drive.write_bytes(drive.read_bytes() + b" ")
        bucket.upload_file(str(drive), "bag/drive_0.mcap")
        with pytest.raises(robowidgets.RecordingError, match=r"drive_0\.mcap: it has changed since it was opened"):
            list(there.messages("/camera"))
    assert not copies(tmp_path)


def test_an_object_that_changes_while_it_is_read_is_reported(drive: Path, bucket: Any) -> None:
    with robowidgets.open("s3://drives/drive.mcap") as recording:
        long_drive.write(drive, 81, image=900_000, others=3)
        bucket.upload_file(str(drive), "drive.mcap")
        with pytest.raises(robowidgets.RecordingError, match="it has changed since it was opened: open it again"):
            list(recording.samples())


@pytest.mark.parametrize("is_open", [False, True])
def test_a_token_that_expired_is_named(drive: Path, monkeypatch: pytest.MonkeyPatch, is_open: bool) -> None:
    from botocore.exceptions import ClientError
    from s3fs import S3FileSystem
    from s3fs.errors import translate_boto_error

    async def expired(self: Any, method: str, *args: Any, **kwargs: Any) -> Any:
        answer = {"Error": {"Code": "ExpiredToken", "Message": "The provided token has expired."}}
        raise translate_boto_error(ClientError(answer, method))

    recording = robowidgets.open("s3://drives/drive.mcap") if is_open else None
    monkeypatch.setattr(S3FileSystem, "_call_s3", expired)
    with pytest.raises(
        robowidgets.RecordingError, match=r"drive\.mcap: its credentials have expired.* \(.*token has expired"
    ):
        list(recording.samples()) if recording else robowidgets.open("s3://drives/drive.mcap")
