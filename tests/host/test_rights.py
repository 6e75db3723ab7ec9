"""rc10d where it may not be real-time: it refuses or says so, as the configuration wants."""

from __future__ import annotations

from hostlib import Daemon

# Root without the capabilities that go beyond the limits, so that it can still read the build tree.
NO_LIMITS = ("prlimit", "--rtprio=0", "--memlock=65536", "--")
NO_RIGHTS = (*NO_LIMITS, "setpriv", "--bounding-set=-sys_nice,-ipc_lock", "--")
NO_PRIORITY = (*NO_LIMITS, "setpriv", "--bounding-set=-sys_nice", "--")


def test_required_refuses_to_start_without_locked_memory() -> None:
    with Daemon(realtime="required", prefix=NO_RIGHTS) as daemon:
        assert daemon.program.wait() == 1
        output = daemon.program.output
        assert "RLIMIT_MEMLOCK is 64 KiB" in output
        assert "LimitMEMLOCK=infinity" in output
        assert daemon.processes() == {}


def test_required_refuses_to_start_without_priority() -> None:
    with Daemon(realtime="required", prefix=NO_PRIORITY) as daemon:
        assert daemon.program.wait() == 1
        output = daemon.program.output
        assert "SCHED_FIFO" in output
        assert "RLIMIT_RTPRIO is 0" in output
        assert "LimitRTPRIO=" in output
        assert "realtime: preferred" in output
        assert daemon.processes() == {}


def test_preferred_starts_and_says_so() -> None:
    with Daemon(prefix=NO_RIGHTS) as daemon:
        state = daemon.wait_ready()
        assert state["realtime"] is False
        notices = " ".join(daemon.stats()["notices"])
        assert "RLIMIT_MEMLOCK" in notices
        assert "RLIMIT_RTPRIO" in notices
        assert "LimitRTPRIO=" in notices
        assert "NOT REAL-TIME" in daemon.must("watch", "--count", "1")
        # It drives all the same.
        daemon.must("enable", "wheel")
        with daemon.drive("set", "wheel", "velocity", "60", "--for", "60s"):
            daemon.wait_motor("wheel", lambda m: m["velocity_rpm"] > 50, "turns")
