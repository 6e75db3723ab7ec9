"""Helpers of the tests of the whole daemon."""

from hostlib.daemon import Daemon, Motor, State, check_environment
from hostlib.program import Program, eventually, processes_of

__all__ = ["Daemon", "Motor", "Program", "State", "check_environment", "eventually", "processes_of"]
