"""Everything that the client raises on purpose."""

from __future__ import annotations

from rc10.printable import printable


class Rc10Error(Exception):
    """Base of all errors of this package.

    Its text is one line that acts on no terminal, whatever names and words it quotes.
    """

    def __str__(self) -> str:
        return printable(super().__str__())


class LinkError(Rc10Error, ConnectionError):
    """LCM could not be started: usually there is no multicast route."""


class Timeout(Rc10Error, TimeoutError):
    """The daemon did not answer, or published nothing, in time."""


class NotReceived(Rc10Error, LookupError):
    """A message of this kind has not been received yet."""


class UnknownMotor(Rc10Error, LookupError):
    """The robot has no motor of this name."""


class InvalidSetpoint(Rc10Error, ValueError):
    """A target that no motor can be given: not a finite number, or out of its range."""


class CommandRefused(Rc10Error):
    """A setpoint that rc10d would skip, or has refused: the message names motor and remedy."""


class MotorStopped(Rc10Error):
    """A motor to which a loop sends targets was stopped or taken: the message says by what."""


class RequestError(Rc10Error):
    """The daemon answered a request with something other than "done".

    Attributes:
        operation: what was asked for, for example "enable".
        target: the motors it was asked for, separated by commas; empty for all.
        message: the daemon's own words.
    """

    _verdict = "not done"

    def __init__(self, operation: str, target: str, message: str) -> None:
        subject = f"{operation} {target}" if target else operation
        super().__init__(f"{subject}: {self._verdict}: {message}")
        self.operation = operation
        self.target = target
        self.message = message


class RequestRefused(RequestError):
    """The daemon did not try: unknown operation or target, or not allowed now."""

    _verdict = "refused"


class RequestFailed(RequestError):
    """The daemon tried, and the message says for each motor what failed.

    Other motors of the same request may have succeeded.
    """

    _verdict = "failed"


class ServiceError(Rc10Error):
    """A call of a service between programs was not answered with success."""


class ServiceTimeout(ServiceError, TimeoutError):
    """No answer: the message says what to check."""


class ServiceRefused(ServiceError):
    """The server did not try."""


class ServiceFailed(ServiceError):
    """The server tried, and says why it failed."""


class UnknownSignal(Rc10Error, LookupError):
    """A motor has no number of this name."""


class MissingPackage(Rc10Error, ImportError):
    """Something was asked for that needs a package which is not installed.

    Args:
        what: what needs it.
        package: its name.
        extra: the extra of rc10 that brings it.
    """

    def __init__(self, what: str, package: str, extra: str) -> None:
        super().__init__(
            f"{what} needs {package}, which is not installed: pip install {package} "
            f"(or, in a clone of rc10d, the tried version: pip install './python[{extra}]')"
        )
