"""TokenBucket: how many requests are served in a time, by tokens that drip into a bucket."""

import time
from collections.abc import Callable

__all__ = ["TokenBucket"]


class TokenBucket:
    """Lets ``rate`` requests a second pass, and ``burst`` at once.

    Args:
        rate: tokens a second.
        burst: tokens that it holds, and begins with.
        clock: seconds.

    Example:
        >>> now = [0.0]
        >>> bucket = TokenBucket(rate=1, burst=2, clock=lambda: now[0])
        >>> [bucket.take() for _ in range(3)]
        [True, True, False]
        >>> now[0] = 1.0
        >>> bucket.take(), bucket.take()
        (True, False)
    """

    def __init__(self, rate: float, burst: float, clock: Callable[[], float] = time.monotonic) -> None:
        self._rate, self._burst, self._clock = rate, burst, clock
        self._tokens, self._seen = burst, clock()

    def take(self) -> bool:
        """Take a token, and return whether there was one."""
        now = self._clock()
        self._tokens = min(self._burst, self._tokens + self._rate * (now - self._seen))
        self._seen = now
        if self._tokens < 1:
            return False
        self._tokens -= 1
        return True
