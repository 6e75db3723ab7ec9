"""Fixtures, and the way into a private network namespace."""

from __future__ import annotations

import functools
import os
import signal
import subprocess
import sys
from collections.abc import Iterator

import pytest

import rc10
from fake_daemon import FakeDaemon
from virtual_link import VirtualLink

# A shell that runs this in the background ignores Ctrl-C, and programs inherit that.
signal.signal(signal.SIGINT, signal.default_int_handler)

_INSIDE = "RC10_TEST_INSIDE_NETNS"
_UNSHARE = ("unshare", "--net", "--map-root-user")
_ROUTE = "ip route add 239.255.76.67/32 dev lo src 127.0.0.1"


@pytest.fixture
def link() -> VirtualLink:
    return VirtualLink()


@pytest.fixture
def daemon(link: VirtualLink) -> FakeDaemon:
    return FakeDaemon("demo", link)


@pytest.fixture
def robot(link: VirtualLink, daemon: FakeDaemon) -> Iterator[rc10.Robot]:
    """A client and a daemon on one memq link, in a time that passes only while both wait."""
    with rc10.Robot("demo", link, client="tester", priority=7) as robot:
        yield robot
        daemon.reset()


@functools.lru_cache
def _why_no_netns() -> str | None:
    try:
        subprocess.run([*_UNSHARE, "ip", "link"], check=True, capture_output=True, text=True)
    except FileNotFoundError as error:
        return f"{error.filename} is not installed"
    except subprocess.CalledProcessError as error:
        return f"no network namespace: {error.stderr.strip()}"
    return None


@pytest.hookimpl(tryfirst=True)
def pytest_pyfunc_call(pyfuncitem: pytest.Function) -> bool | None:
    """Runs a test marked `netns` by a pytest of its own inside a new namespace."""
    marker = pyfuncitem.get_closest_marker("netns")
    if marker is None or os.environ.get(_INSIDE):
        return None
    reason = _why_no_netns()
    if reason is not None:
        pytest.skip(reason)
    setup = ["ip link set lo up"] + ([_ROUTE] if marker.kwargs.get("route", True) else [])
    inside = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", pyfuncitem.nodeid]
    result = subprocess.run(
        [*_UNSHARE, "sh", "-c", " && ".join([*setup, 'exec "$@"']), "sh", *inside],
        cwd=pyfuncitem.config.rootpath,
        env={**os.environ, _INSIDE: "1"},
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    if result.returncode != 0:
        pytest.fail(f"in its namespace:\n{result.stdout}{result.stderr}", pytrace=False)
    if "1 skipped" in result.stdout:
        pytest.skip(result.stdout)
    return True
