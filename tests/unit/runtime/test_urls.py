"""URLs without secrets: signatures, tokens and passwords are removed, the name of the object stays."""

from __future__ import annotations

import pytest

from robowidgets import feeds
from robowidgets.runtime.urls import redacted, without_secrets

SECRET = "hunter2SECRET"


@pytest.mark.parametrize(
    ("url", "name"),
    [
        ("s3://bucket/runs/a.mcap", "s3://bucket/runs/a.mcap"),
        ("s3://bucket/run?.mcap", "s3://bucket/run?.mcap"),
        (f"https://h/a.mcap?X-Amz-Algorithm=AWS4&X-Amz-Signature={SECRET}&X-Amz-Expires=60", "https://h/a.mcap"),
        (f"https://h/a.mcap?X-Goog-Credential=x&X-Goog-Signature={SECRET}", "https://h/a.mcap"),
        (f"https://h/a.mcap?AWSAccessKeyId={SECRET}&Signature={SECRET}&Expires=1", "https://h/a.mcap"),
        (f"https://h/a.mcap?Policy={SECRET}&Key-Pair-Id={SECRET}&Signature={SECRET}", "https://h/a.mcap"),
        (f"https://b.blob.core/c/a.bag?sv=2022&st=1&se=2&sr=b&sp=r&sig={SECRET}%3D", "https://b.blob.core/c/a.bag"),
        (f"https://h/dl?id=42&access_token={SECRET}#token={SECRET}", "https://h/dl?id=42"),
        (f"https://h/a.mcap?versionId=7&s%69g={SECRET}", "https://h/a.mcap?versionId=7"),
        (f"https://ada:{SECRET}@h:8080/a.mcap", "https://h:8080/a.mcap"),
        (f"https://ada:{SECRET}@x@h/a.mcap", "https://h/a.mcap"),
        (f"https://{SECRET}@h/a.mcap", "https://h/a.mcap"),
        (f"sftp://ada:{SECRET}@h/a.mcap", "sftp://ada@h/a.mcap"),
        (f"ftp://:{SECRET}@h/a.mcap", "ftp://h/a.mcap"),
        (f"abfs://box:{SECRET}@account.dfs/a.mcap", "abfs://box@account.dfs/a.mcap"),
        ("abfs://box@account.dfs/a.mcap", "abfs://box@account.dfs/a.mcap"),
        (f"zip://in.mcap::https://u:{SECRET}@h/a.zip?sig={SECRET}", "zip://in.mcap::https://h/a.zip"),
        (f"s3://bucket/a.mcap?versionId=3&token={SECRET}", "s3://bucket/a.mcap?versionId=3"),
        ("wss://robot/bridge?auth=" + SECRET, "wss://robot/bridge"),
    ],
)
def test_what_signs_or_logs_in_goes_and_what_names_the_object_stays(url: str, name: str) -> None:
    assert without_secrets(url) == name
    assert without_secrets(name) == name


def test_a_parameter_that_may_be_either_becomes_a_digest_so_that_two_objects_have_two_names() -> None:
    first, second = (without_secrets(f"https://h/get?drive={drive}") for drive in (SECRET, "other"))
    assert SECRET not in first
    assert first != second
    assert first.startswith("https://h/get?drive=~")
    bare = without_secrets(f"https://h/get?{SECRET}")
    assert bare.startswith("https://h/get?~")
    assert SECRET not in bare


def test_the_error_of_a_driver_has_no_query_and_no_password_of_any_url_in_it() -> None:
    text = f"403, url='https://a:{SECRET}@h/x?sig={SECRET}&b' (is it there?) see wss://h/y?{SECRET}."
    assert redacted(text) == "403, url='https://h/x' (is it there?) see wss://h/y"


@pytest.mark.parametrize("connect", [feeds.foxglove, feeds.rosbridge])
def test_a_feed_shows_its_address_without_the_password(connect: object) -> None:
    with connect(f"ws://ada:{SECRET}@127.0.0.1:1/?token={SECRET}") as feed:  # type: ignore[operator]
        assert feed.where.startswith("ws://127.0.0.1:1/")
        for shown in (feed.where, feed.status, repr(feed)):
            assert SECRET not in shown
    with pytest.raises(ValueError, match="expected one like") as error:
        connect(f"http://ada:{SECRET}@127.0.0.1/")  # type: ignore[operator]
    assert SECRET not in str(error.value)
